//! Crossings: where, when and how rays pass from one medium into another, in columns.

use std::ops::Range;

use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};
use rayweave::math::Vec3;
use rayweave::model::{Crossing, Evaluator, Limit, Program, Query, RayAnswer, RegionId, Window, dress};
use rayweave::shape::Ray;
use rayweave::space::{Curve, CurveTrace, curve_normal, curve_point};

use crate::arrays::room;
use crate::engine::{Engine, How, Question, inside, surface};
use crate::rays::{Columns, RayRows, Vectors};

/// All crossings of every ray, or the first of each.
pub struct CrossingsQuestion<'a> {
    rays: RayRows<'a>,
    window: Window,
    first: bool,
}

/// Crossings in columns.
#[derive(Default)]
pub struct Table {
    counts: Vec<usize>,
    start_inside: Vec<bool>,
    start_region: Vec<i32>,
    t: Vec<f64>,
    point: Vec<f64>,
    normal: Vec<f64>,
    enters: Vec<bool>,
    surface: Vec<i32>,
    leaf: Vec<i32>,
    placement: Vec<i32>,
    before: Vec<i32>,
    after: Vec<i32>,
}

impl Table {
    fn push(&mut self, program: &Program, ray: &Ray, answer: &RayAnswer<'_>, first: bool) {
        let count = if first { answer.crossings.len().min(1) } else { answer.crossings.len() };
        self.counts.push(if first { 1 } else { count });
        self.start_inside.push(inside(program, answer.start));
        self.start_region.push(answer.start.0 as i32);
        for crossing in &answer.crossings[..count] {
            let (point, normal) = (dress::point(ray, crossing), dress::normal(program, ray, crossing));
            self.crossing(program, [point.to_array(), normal.to_array()], crossing);
        }
        if first && count == 0 {
            self.miss(answer.start);
        }
    }

    /// What one curve meets.
    pub fn of_curve(program: &Program, curve: &dyn Curve<3>, found: &CurveTrace) -> Table {
        let mut table = Table::default();
        table.counts.push(found.crossings.len());
        table.start_inside.push(inside(program, found.start));
        table.start_region.push(found.start.0 as i32);
        for crossing in &found.crossings {
            let dressed = [curve_point(curve, crossing), curve_normal(program, curve, crossing)];
            table.crossing(program, dressed, crossing);
        }
        table
    }

    fn crossing(&mut self, program: &Program, [point, normal]: [[f64; 3]; 2], crossing: &Crossing) {
        let enters = inside(program, crossing.after);
        // the normal looks at regions: out of a region of the world's medium is not out of the solid
        let normal = if enters == crossing.enters() { normal } else { normal.map(|x| -x) };
        self.t.push(crossing.t);
        self.point.extend(point);
        self.normal.extend(normal);
        self.enters.push(enters);
        self.surface.push(surface(program, crossing));
        self.leaf.push(crossing.face.leaf.0 as i32);
        self.placement.push(crossing.face.placement.0 as i32);
        self.before.push(crossing.before.0 as i32);
        self.after.push(crossing.after.0 as i32);
    }

    /// The row of a ray that crosses nothing.
    fn miss(&mut self, region: RegionId) {
        self.t.push(f64::INFINITY);
        self.point.extend(Vec3::NAN.to_array());
        self.normal.extend(Vec3::NAN.to_array());
        self.enters.push(false);
        self.surface.push(-1);
        self.leaf.push(-1);
        self.placement.push(-1);
        self.before.push(region.0 as i32);
        self.after.push(region.0 as i32);
    }

    /// The rows of other rays after these.
    pub fn append(&mut self, mut other: Table) {
        self.counts.append(&mut other.counts);
        self.start_inside.append(&mut other.start_inside);
        self.start_region.append(&mut other.start_region);
        self.t.append(&mut other.t);
        self.point.append(&mut other.point);
        self.normal.append(&mut other.normal);
        self.enters.append(&mut other.enters);
        self.surface.append(&mut other.surface);
        self.leaf.append(&mut other.leaf);
        self.placement.append(&mut other.placement);
        self.before.append(&mut other.before);
        self.after.append(&mut other.after);
    }
}

impl Question for CrossingsQuestion<'_> {
    type Answer = Table;
    type Scratch = Columns;

    fn len(&self) -> usize {
        self.rays.len()
    }

    fn answer<E: Evaluator>(
        &self,
        evaluator: &E,
        chunk: Range<usize>,
        memory: &mut E::Scratch,
        columns: &mut Columns,
    ) -> Table {
        let limit = if self.first { Limit::First } else { Limit::All };
        let query = Query { window: self.window, limit, starts: None };
        let rays = columns.rays(self.rays, chunk);
        let mut table = Table::default();
        let mut sink = |answer: RayAnswer<'_>| {
            table.push(evaluator.program(), &rays.get(answer.ray), &answer, self.first);
        };
        evaluator.crossings(rays, &query, memory, &mut sink);
        table
    }
}

/// Asks for all crossings of every ray, or for the first of each.
pub fn ask<'py>(
    engine: &Engine,
    [origins, directions]: [&Bound<'py, PyAny>; 2],
    how: &How,
    first: bool,
) -> PyResult<Table> {
    let py = origins.py();
    let (origins, directions) =
        (Vectors::new(origins, "origins")?, Vectors::directions(directions, "directions")?);
    let question =
        CrossingsQuestion { rays: RayRows::new(&origins, &directions)?, window: how.window, first };
    let mut table = Table { counts: room(question.len())?, ..Table::default() };
    engine.ask(py, how, &question, |chunk| table.append(chunk))?;
    Ok(table)
}

/// Where each ray's rows begin, and their total at the end.
pub fn offsets(counts: &[usize]) -> PyResult<Vec<i64>> {
    let mut offsets = room(counts.len() + 1)?;
    let mut end = 0;
    offsets.push(end);
    for &count in counts {
        end += count as i64;
        offsets.push(end);
    }
    Ok(offsets)
}

/// The number of each row's ray; there are so many rows.
pub fn rows_of(counts: &[usize], rows: usize) -> PyResult<Vec<i64>> {
    let mut rays = room(rows)?;
    for (ray, &count) in counts.iter().enumerate() {
        rays.resize(rays.len() + count, ray as i64);
    }
    Ok(rays)
}

impl Table {
    /// The columns as the object that Python sees.
    pub fn into_python<'py>(self, py: Python<'py>, engine: &Engine) -> PyResult<Bound<'py, PyAny>> {
        let fields = PyDict::new(py);
        fields.set_item("ray", column(py, rows_of(&self.counts, self.t.len())?))?;
        fields.set_item("offsets", column(py, offsets(&self.counts)?))?;
        fields.set_item("t", column(py, self.t))?;
        fields.set_item("point", column(py, self.point).reshape([self.leaf.len(), 3])?)?;
        fields.set_item("normal", column(py, self.normal).reshape([self.leaf.len(), 3])?)?;
        fields.set_item("enters", column(py, self.enters))?;
        fields.set_item("surface", column(py, self.surface))?;
        fields.set_item("leaf", column(py, self.leaf))?;
        fields.set_item("placement", column(py, self.placement))?;
        fields.set_item("start_inside", column(py, self.start_inside))?;
        fields.set_item("surface_names", engine.surface_names(py)?)?;
        let Some(media) = &engine.media else {
            static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
            return CLASS.import(py, "rayweave._answers", "Crossings")?.call((), Some(&fields));
        };
        let medium = |regions: &[i32]| regions.iter().map(|&region| medium_of(engine, region)).collect();
        fields.set_item("medium_before", column(py, medium(&self.before)))?;
        fields.set_item("medium_after", column(py, medium(&self.after)))?;
        fields.set_item("region_before", column(py, self.before))?;
        fields.set_item("region_after", column(py, self.after))?;
        fields.set_item("medium_names", PyTuple::new(py, media.iter())?)?;
        fields.set_item("region_names", region_names(py, engine)?)?;
        static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
        CLASS.import(py, "rayweave._answers", "ModelCrossings")?.call((), Some(&fields))
    }

    /// The pieces between the crossings as the object that Python sees.
    pub fn into_partition<'py>(
        self,
        py: Python<'py>,
        engine: &Engine,
        window: Window,
    ) -> PyResult<Bound<'py, PyAny>> {
        let pieces = Pieces::new(&self, window)?;
        let fields = PyDict::new(py);
        let medium = pieces.region.iter().map(|&region| medium_of(engine, region)).collect();
        fields.set_item("ray", column(py, pieces.ray))?;
        fields.set_item("t_start", column(py, pieces.t_start))?;
        fields.set_item("t_end", column(py, pieces.t_end))?;
        fields.set_item("medium", column(py, medium))?;
        fields.set_item("region", column(py, pieces.region))?;
        fields.set_item("offsets", column(py, pieces.offsets))?;
        fields.set_item(
            "medium_names",
            PyTuple::new(py, engine.media.iter().flat_map(|media| media.iter()).collect::<Vec<_>>())?,
        )?;
        fields.set_item("region_names", region_names(py, engine)?)?;
        static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
        CLASS.import(py, "rayweave._answers", "Partition")?.call((), Some(&fields))
    }
}

/// Pieces of rays between crossings, in columns.
struct Pieces {
    ray: Vec<i64>,
    t_start: Vec<f64>,
    t_end: Vec<f64>,
    region: Vec<i32>,
    offsets: Vec<i64>,
}

impl Pieces {
    fn new(table: &Table, window: Window) -> PyResult<Self> {
        let len = table.counts.len() + table.t.len();
        let mut pieces = Pieces {
            ray: room(len)?,
            t_start: room(len)?,
            t_end: room(len)?,
            region: room(len)?,
            offsets: room(table.counts.len() + 1)?,
        };
        pieces.offsets.push(0);
        let mut row = 0;
        for (ray, &count) in table.counts.iter().enumerate() {
            let (mut start, mut region) = (window.t_min(), table.start_region[ray]);
            for k in row..row + count {
                pieces.push(ray, [start, table.t[k]], region);
                (start, region) = (table.t[k], table.after[k]);
            }
            pieces.push(ray, [start, window.t_max()], region);
            pieces.offsets.push(pieces.ray.len() as i64);
            row += count;
        }
        Ok(pieces)
    }

    fn push(&mut self, ray: usize, [start, end]: [f64; 2], region: i32) {
        self.ray.push(ray as i64);
        self.t_start.push(start);
        self.t_end.push(end);
        self.region.push(region);
    }
}

fn medium_of(engine: &Engine, region: i32) -> i32 {
    engine.program.medium_of(RegionId(region as u32)) as i32
}

/// The names of the regions by their numbers; number 0 is the world.
fn region_names<'py>(py: Python<'py>, engine: &Engine) -> PyResult<Bound<'py, PyTuple>> {
    let regions = engine.program.regions().iter().map(|region| region.name.as_str());
    PyTuple::new(py, std::iter::once("world").chain(regions).collect::<Vec<_>>())
}

fn column<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_vec(py, values)
}
