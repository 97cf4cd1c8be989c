//! Crossings: where, when and how rays pass from one medium into another, in columns.

use std::iter::zip;

use numpy::PyArrayMethods;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};
use rayweave::model::{Crossing, Evaluator, Program, Query, RayAnswer, Window, dress};
use rayweave::shape::Ray;
use rayweave::space::{Curve, CurveTrace, curve_normal, curve_point};

use crate::answer::{Answer, Rows, column, medium_of, take};
use crate::arrays::{fresh, room};
use crate::engine::{BLOCK, Cut, Engine, How, Worker, ask as ask_rays, inside, share, surface};
use crate::error::bad_value;
use crate::rays::{Columns, RayArrays};

/// Crossings of rays that follow each other.
#[derive(Default)]
pub struct Table {
    /// How many each ray has.
    counts: Vec<usize>,
    start_inside: Vec<bool>,
    start_region: Vec<u32>,
    t: Vec<f64>,
    point: Vec<[f64; 3]>,
    normal: Vec<[f64; 3]>,
    enters: Vec<bool>,
    surface: Vec<i32>,
    leaf: Vec<i32>,
    placement: Vec<i32>,
    before: Vec<u32>,
    after: Vec<u32>,
}

impl Table {
    fn push(&mut self, program: &Program, ray: &Ray, answer: &RayAnswer<'_>) {
        self.start(answer.start.0, inside(program, answer.start), answer.crossings.len());
        for crossing in answer.crossings {
            let (point, normal) = (dress::point(ray, crossing), dress::normal(program, ray, crossing));
            self.crossing(program, [point.to_array(), normal.to_array()], crossing);
        }
    }

    /// What one curve meets.
    pub fn of_curve(program: &Program, curve: &dyn Curve<3>, found: &CurveTrace) -> Table {
        let mut table = Table::default();
        table.start(found.start.0, inside(program, found.start), found.crossings.len());
        for crossing in &found.crossings {
            let dressed = [curve_point(curve, crossing), curve_normal(program, curve, crossing)];
            table.crossing(program, dressed, crossing);
        }
        table
    }

    fn start(&mut self, region: u32, is_inside: bool, crossings: usize) {
        self.counts.push(crossings);
        self.start_inside.push(is_inside);
        self.start_region.push(region);
    }

    fn crossing(&mut self, program: &Program, [point, normal]: [[f64; 3]; 2], crossing: &Crossing) {
        let enters = inside(program, crossing.after);
        // the normal looks at regions: out of a region of the world's medium is not out of the solid
        let normal = if enters == crossing.enters() { normal } else { normal.map(|x| -x) };
        self.t.push(crossing.t);
        self.point.push(point);
        self.normal.push(normal);
        self.enters.push(enters);
        self.surface.push(surface(program, crossing));
        self.leaf.push(crossing.face.leaf.0 as i32);
        self.placement.push(crossing.face.placement.0 as i32);
        self.before.push(crossing.before.0);
        self.after.push(crossing.after.0);
    }

    /// Writes the rows into their places.
    fn put(&self, engine: &Engine, rows: &mut Rows<'_>) {
        rows.t.copy_from_slice(&self.t);
        rows.point.copy_from_slice(&self.point);
        rows.normal.copy_from_slice(&self.normal);
        rows.enters.copy_from_slice(&self.enters);
        rows.surface.copy_from_slice(&self.surface);
        rows.leaf.copy_from_slice(&self.leaf);
        rows.placement.copy_from_slice(&self.placement);
        rows.put_regions(engine, &self.before, &self.after);
    }
}

/// Asks for all crossings of every ray: a table for each chunk.
pub fn ask<'py>(engine: &Engine, rays: [&Bound<'py, PyAny>; 2], how: &How) -> PyResult<(Vec<Table>, Cut)> {
    let py = rays[0].py();
    let rays = RayArrays::new(rays)?;
    // small tables grow within what the allocator keeps
    let (cut, evaluator) = (how.cut(rays.len()).small(), engine.chosen(py, how)?);
    let (rows, query) = (rays.rows(), Query { window: how.window, ..Query::default() });
    let mut tables = room(cut.chunks())?;
    let work = |worker: &mut Worker<'_, Columns>, chunk: std::ops::Range<usize>| {
        let (mut table, program) = (Table::default(), worker.evaluator.program());
        for start in chunk.clone().step_by(BLOCK) {
            let rays = worker.scratch.rays(rows, start..chunk.end.min(start + BLOCK))?;
            let mut sink = |answer: RayAnswer<'_>| table.push(program, &rays.get(answer.ray), &answer);
            worker.evaluator.crossings(rays, &query, &mut worker.memory, &mut sink);
        }
        Some(table)
    };
    let merge = |table| {
        tables.push(table);
        Ok(())
    };
    if ask_rays(py, &evaluator, cut, cut.ranges(), work, merge)? {
        Ok((tables, cut))
    } else {
        Err(rays.refusal())
    }
}

/// Crossings as the object that Python sees.
pub fn into_python<'py>(
    py: Python<'py>,
    engine: &Engine,
    tables: Vec<Table>,
    cut: Cut,
) -> PyResult<Bound<'py, PyAny>> {
    let rows = tables.iter().map(|table| table.t.len()).sum();
    let rays = tables.iter().map(|table| table.counts.len()).sum::<usize>();
    let answer = Answer::new(py, engine, [rows, rays])?;
    let offsets = fresh::<i64>(py, rays + 1)?;
    answer.fill(|mut rows, mut start_inside| {
        let mut offsets = offsets.readwrite();
        let [first, rest @ ..] = offsets.as_slice_mut().map_err(bad_value)? else { return Ok(()) };
        *first = 0;
        let (mut offsets, mut end) = (rest, 0);
        let chunks = tables.into_iter().map(move |table| {
            let (rays, first) = (table.counts.len(), end);
            end += table.t.len() as i64;
            let places = (rows.take(table.t.len()), take(&mut start_inside, rays), take(&mut offsets, rays));
            (table, first, places)
        });
        share(py, cut, chunks, |(table, mut end, (mut rows, start_inside, offsets))| {
            table.put(engine, &mut rows);
            start_inside.copy_from_slice(&table.start_inside);
            for (offset, &count) in zip(offsets, &table.counts) {
                end += count as i64;
                *offset = end;
            }
        })
    })?;
    answer.into_python(engine, Some(offsets))
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

/// The pieces between crossings as the object that Python sees.
pub fn into_partition<'py>(
    py: Python<'py>,
    engine: &Engine,
    tables: &[Table],
    window: Window,
) -> PyResult<Bound<'py, PyAny>> {
    let pieces = Pieces::new(tables, window)?;
    let fields = PyDict::new(py);
    let medium = pieces.region.iter().map(|&region| medium_of(engine, region as u32)).collect();
    fields.set_item("ray", column(py, pieces.ray))?;
    fields.set_item("t_start", column(py, pieces.t_start))?;
    fields.set_item("t_end", column(py, pieces.t_end))?;
    fields.set_item("medium", column(py, medium))?;
    fields.set_item("region", column(py, pieces.region))?;
    fields.set_item("offsets", column(py, pieces.offsets))?;
    fields.set_item("medium_names", engine.medium_names(py)?)?;
    fields.set_item("region_names", engine.region_names(py)?)?;
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    CLASS.import(py, "rayweave._answers", "Partition")?.call((), Some(&fields))
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
    fn new(tables: &[Table], window: Window) -> PyResult<Self> {
        let rays = tables.iter().map(|table| table.counts.len()).sum::<usize>();
        let len = tables.iter().map(|table| table.t.len()).sum::<usize>() + rays;
        let mut pieces = Pieces {
            ray: room(len)?,
            t_start: room(len)?,
            t_end: room(len)?,
            region: room(len)?,
            offsets: room(rays + 1)?,
        };
        pieces.offsets.push(0);
        tables.iter().for_each(|table| pieces.append(table, window));
        Ok(pieces)
    }

    fn append(&mut self, table: &Table, window: Window) {
        let mut row = 0;
        for (&count, &region) in zip(&table.counts, &table.start_region) {
            let (ray, mut start, mut region) = (self.offsets.len() - 1, window.t_min(), region);
            for k in row..row + count {
                self.push(ray, [start, table.t[k]], region);
                (start, region) = (table.t[k], table.after[k]);
            }
            self.push(ray, [start, window.t_max()], region);
            self.offsets.push(self.ray.len() as i64);
            row += count;
        }
    }

    fn push(&mut self, ray: usize, [start, end]: [f64; 2], region: u32) {
        self.ray.push(ray as i64);
        self.t_start.push(start);
        self.t_end.push(end);
        self.region.push(region as i32);
    }
}
