//! The table of hits: one row for each crossing.

use rayweave_model::{Occurrence, Program, RayAnswer, Rays, RegionId, Sink, attributes};
use rayweave_scene::Compiled;
use rayweave_table::{Chunk, Column, DType, Schema, TableError, Values};
use std::collections::HashMap;
use std::sync::Arc;

/// The table of the crossings of many rays.
///
/// The columns, in this order:
///
/// - `ray`: the number of the ray in its file, from 0; `crossing`: that of the crossing on its ray, from 0;
/// - `t`, in units of the ray's direction; `x`, `y`, `z`: the point;
/// - `nx`, `ny`, `nz`: the unit normal, outward of the region that is entered or left;
/// - `enters`: true where a region is entered, false where the ray leaves for the world;
/// - `surface`: the crossed face, for example `rim.side`; `solid`: the region entered, or the one left for
///   the world;
/// - `medium_before`, `medium_after`;
/// - only [with occurrences](HitSchema::with_occurrences), `occurrence`: the path of names and copy numbers of the
///   crossed shape, for example `tower[3]/brick[12]/rim`.
#[derive(Clone, Debug)]
pub struct HitSchema {
    schema: Schema,
    has_occurrences: bool,
}

impl HitSchema {
    /// The table for a model, with its names of faces, regions and media.
    ///
    /// # Errors
    ///
    /// If the table already has the column `occurrence`.
    pub fn new(compiled: &Compiled) -> Result<HitSchema, TableError> {
        let program = &compiled.program;
        let faces: Arc<[String]> = program.face_names().collect();
        let solids: Arc<[String]> = program.regions().iter().map(|r| r.name.clone()).collect();
        let mut columns = vec![Column::new("ray", DType::I64), Column::new("crossing", DType::I64)];
        let numbers = ["t", "x", "y", "z", "nx", "ny", "nz"];
        columns.extend(numbers.map(|name| Column::new(name, DType::F64)));
        columns.push(Column::new("enters", DType::Bool));
        columns.push(Column::names("surface", faces));
        columns.push(Column::names("solid", solids));
        columns.push(Column::names("medium_before", compiled.media.clone()));
        columns.push(Column::names("medium_after", compiled.media.clone()));
        Ok(HitSchema { schema: Schema::new(columns)?, has_occurrences: false })
    }

    /// The table with the column `occurrence` at the end.
    ///
    /// # Errors
    ///
    /// None in practice: the names of the columns are fixed.
    pub fn with_occurrences(self) -> Result<HitSchema, TableError> {
        let mut columns = self.schema.columns().to_vec();
        columns.push(Column::new("occurrence", DType::Text));
        Ok(HitSchema { schema: Schema::new(columns)?, has_occurrences: true })
    }

    /// The columns.
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// Empty rows for the crossings of a batch of rays; `first` is the number of the first ray in the file.
    pub fn rows<'a>(&self, program: &'a Program, rays: Rays<'a>, first: u64) -> HitRowSink<'a> {
        HitRowSink {
            program,
            rays,
            first,
            integers: Default::default(),
            numbers: Default::default(),
            enters: Vec::new(),
            names: Default::default(),
            occurrences: self.has_occurrences.then(Occurrences::default),
        }
    }
}

/// The rows of a batch of rays, in the columns of the table.
#[derive(Debug)]
pub struct HitRowSink<'a> {
    program: &'a Program,
    rays: Rays<'a>,
    first: u64,
    /// `ray` and `crossing`.
    integers: [Vec<i64>; 2],
    /// `t`, the point and the normal.
    numbers: [Vec<f64>; 7],
    enters: Vec<bool>,
    /// `surface`, `solid` and the media.
    names: [Vec<u32>; 4],
    occurrences: Option<Occurrences>,
}

/// The column `occurrence`. Each path is computed once.
#[derive(Debug, Default)]
struct Occurrences {
    paths: Vec<Arc<str>>,
    known: HashMap<Occurrence, Arc<str>>,
}

impl Occurrences {
    fn push(&mut self, program: &Program, occurrence: Occurrence) {
        let path = || program.occurrence_path(occurrence).to_string().into();
        self.paths.push(self.known.entry(occurrence).or_insert_with(path).clone());
    }
}

impl HitRowSink<'_> {
    /// The rows as a chunk of the table.
    ///
    /// # Errors
    ///
    /// None: the columns grow together.
    pub fn finish(self) -> Result<Chunk, TableError> {
        let mut columns: Vec<Values> = Vec::with_capacity(15);
        columns.extend(self.integers.map(Values::from));
        columns.extend(self.numbers.map(Values::from));
        columns.push(self.enters.into());
        columns.extend(self.names.map(Values::from));
        columns.extend(self.occurrences.map(|occurrences| Values::from(occurrences.paths)));
        Chunk::new(columns)
    }
}

impl Sink for HitRowSink<'_> {
    fn ray(&mut self, answer: RayAnswer<'_>) {
        let ray = self.rays.get(answer.ray);
        let number = self.first + answer.ray as u64;
        for (k, crossing) in answer.crossings.iter().enumerate() {
            let point = attributes::point(&ray, crossing).to_array();
            let normal = attributes::normal(self.program, &ray, crossing).to_array();
            let RegionId(solid) = match crossing.enters() {
                true => crossing.after,
                false => crossing.before,
            };
            let face = crossing.face;
            let names = [
                self.program.face_number(face.leaf, face.facet),
                solid - 1, // a crossing has a region on one side at least
                self.program.medium_of(crossing.before),
                self.program.medium_of(crossing.after),
            ];
            push_all(&mut self.integers, [number as i64, k as i64]);
            let values = [crossing.t].into_iter().chain(point).chain(normal);
            push_all(&mut self.numbers, values);
            self.enters.push(crossing.enters());
            push_all(&mut self.names, names);
            if let Some(occurrences) = &mut self.occurrences {
                occurrences.push(self.program, face.occurrence());
            }
        }
    }
}

fn push_all<T>(columns: &mut [Vec<T>], values: impl IntoIterator<Item = T>) {
    for (column, value) in columns.iter_mut().zip(values) {
        column.push(value);
    }
}
