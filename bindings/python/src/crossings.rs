//! Crossings of rays as columns.

use std::iter::zip;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard};

use numpy::{PyArrayMethods, PyReadwriteArray1};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};
use rayweave::AnyEvaluator;
use rayweave::model::memory::Growth;
use rayweave::model::{Crossing, Evaluator, Query, RayAnswer, Window, attributes};
use rayweave::shape::Ray;
use rayweave::space::{Curve, CurveTrace, curve_normal, curve_point};

use crate::answer::{Answer, Rows, column, medium_of, take};
use crate::arrays::{MANY, fresh, no_memory, room};
use crate::device::Chosen;
use crate::engine::{Chunking, Engine, QueryOptions, Worker, run_query, share, surface};
use crate::error::bad_value;
use crate::rays::{Columns, RayArrays, RayRows};

/// A crossing with all its columns.
struct Row {
    t: f64,
    point: [f64; 3],
    normal: [f64; 3],
    before: u32,
    after: u32,
    surface: i32,
    placement: i32,
    enters: bool,
}

/// Crossings of consecutive rays.
#[derive(Default)]
pub struct Table {
    /// Number of crossings of each ray.
    counts: Vec<usize>,
    start_inside: Vec<bool>,
    start_region: Vec<u32>,
    /// Row by row: rows that are buffered are written and read once.
    rows: Vec<Row>,
}

impl Table {
    fn push(&mut self, engine: &Engine, ray: &Ray, answer: &RayAnswer<'_>) {
        let program = &engine.program;
        self.start(answer.start.0, engine.is_inside(answer.start), answer.crossings.len());
        self.rows.extend(answer.crossings.iter().map(|crossing| {
            let (point, normal) =
                (attributes::point(ray, crossing), attributes::normal(program, ray, crossing));
            row(engine, [point.to_array(), normal.to_array()], crossing)
        }));
    }

    /// Crossings of one curve.
    pub fn of_curve(engine: &Engine, curve: &dyn Curve<3>, found: &CurveTrace) -> Table {
        let mut table = Table::default();
        table.start(found.start.0, engine.is_inside(found.start), found.crossings.len());
        table.rows.extend(found.crossings.iter().map(|crossing| {
            let dressed = [curve_point(curve, crossing), curve_normal(&engine.program, curve, crossing)];
            row(engine, dressed, crossing)
        }));
        table
    }

    fn start(&mut self, region: u32, is_inside: bool, crossings: usize) {
        self.counts.push(crossings);
        self.start_inside.push(is_inside);
        self.start_region.push(region);
    }

    /// Removes the crossings and keeps the memory.
    fn clear(&mut self) {
        self.counts.clear();
        self.start_inside.clear();
        self.start_region.clear();
        self.rows.clear();
    }

    /// Copies the rows to their buffers.
    fn put_rows(&self, engine: &Engine, to: &mut Rows<'_>) {
        // column by column: this writes to few memory regions at a time
        put(&self.rows, to.t, |row| row.t);
        put(&self.rows, to.point, |row| row.point);
        put(&self.rows, to.normal, |row| row.normal);
        put(&self.rows, to.enters, |row| row.enters);
        put(&self.rows, to.surface, |row| row.surface);
        put(&self.rows, to.placement, |row| row.placement);
        to.put_regions(engine, self.rows.iter().map(|row| [row.before, row.after]));
    }

    /// Writes whether the rays start inside, and the end of the rows of each; `first` is the number
    /// of the first row.
    fn put_rays(&self, first: usize, start_inside: &mut [bool], ends: &mut [i64]) {
        start_inside.copy_from_slice(&self.start_inside);
        let mut end = first;
        for (to, &count) in zip(ends, &self.counts) {
            end += count;
            *to = end as i64;
        }
    }
}

fn row(engine: &Engine, [point, normal]: [[f64; 3]; 2], crossing: &Crossing) -> Row {
    let enters = engine.is_inside(crossing.after);
    Row {
        t: crossing.t,
        point,
        // the normal refers to regions, and a region may have the medium of the world: leaving it
        // is not leaving the solid
        normal: if enters == crossing.enters() { normal } else { normal.map(|x| -x) },
        before: crossing.before.0,
        after: crossing.after.0,
        surface: surface(&engine.program, crossing),
        placement: crossing.face.placement.0 as i32,
        enters,
    }
}

fn put<T>(rows: &[Row], to: &mut [T], of: impl Fn(&Row) -> T) {
    zip(to, rows).for_each(|(to, row)| *to = of(row));
}

/// The size of buffered tables, checked against the available memory.
#[derive(Default)]
struct TableSize {
    rows: usize,
    growth: Growth,
}

impl TableSize {
    fn add(&mut self, table: &Table) -> PyResult<()> {
        self.rows += table.rows.len();
        let grown = self.growth.check((self.rows * size_of::<Row>()) as u64);
        grown.map_err(|shortage| no_memory("the crossings", &shortage))
    }
}

/// The arguments of the query.
struct QueryArguments<'a, 'py> {
    py: Python<'py>,
    engine: &'a Engine,
    evaluator: Chosen<'a>,
    rays: RayArrays<'py>,
    window: Window,
    chunking: Chunking,
}

impl<'a, 'py> QueryArguments<'a, 'py> {
    fn new(engine: &'a Engine, rays: [&Bound<'py, PyAny>; 2], options: &QueryOptions) -> PyResult<Self> {
        let py = rays[0].py();
        let rays = RayArrays::new(rays)?;
        let evaluator = engine.chosen(py, options)?;
        // small tables stay in the L1 or L2 cache
        let chunking = options.chunking(rays.len(), &evaluator).small();
        Ok(QueryArguments { py, engine, evaluator, rays, window: options.window, chunking })
    }

    /// Computes the crossings of every chunk into a table from `table`, and passes the tables to
    /// `take` in order.
    fn run(
        &self,
        table: impl Fn() -> Table + Send + Sync,
        merge: impl FnMut(Table) -> PyResult<()> + Send,
    ) -> PyResult<()> {
        let (rays, window) = (self.rays.rows(), self.window);
        let work = |worker: &mut Worker<'_, Columns>, range| {
            append_crossings(self.engine, worker, rays, range, window, table())
        };
        if run_query(self.py, &self.evaluator, self.chunking, self.chunking.ranges(), work, merge)? {
            Ok(())
        } else {
            Err(self.rays.invalid_input(self.evaluator.program()))
        }
    }

    fn tables(&self) -> PyResult<Vec<Table>> {
        let mut tables = room(self.chunking.chunks())?;
        let mut size = TableSize::default();
        self.run(Table::default, |table| {
            size.add(&table)?;
            tables.push(table);
            Ok(())
        })?;
        Ok(tables)
    }

    /// An upper estimate of the number of rows, extrapolated from sample rays spread over all of them.
    fn guess(&self) -> usize {
        let step = (self.chunking.len / SAMPLE).max(1);
        let (rays, count) = (self.rays.rows().every(step), self.chunking.len.div_ceil(step));
        let (evaluator, window): (&AnyEvaluator, _) = (&self.evaluator, self.window);
        let engine = self.engine;
        let sampled = self.py.detach(|| {
            let (memory, scratch) = (evaluator.scratch(), Columns::default());
            let mut worker = Worker { evaluator, memory, scratch };
            let table = append_crossings(engine, &mut worker, rays, 0..count, window, Table::default());
            // invalid rays are reported when all rays are processed
            table.map_or(0, |table| table.rows.len())
        });
        let likely = sampled as f64 / count as f64 * self.chunking.len as f64;
        // pages that are never written take no physical memory
        (1.25 * likely) as usize + MANY
    }
}

/// Appends the crossings of some rays to a table; `None` if one of the rays is invalid.
fn append_crossings(
    engine: &Engine,
    worker: &mut Worker<'_, Columns>,
    rays: RayRows<'_>,
    range: Range<usize>,
    window: Window,
    mut table: Table,
) -> Option<Table> {
    let (program, query) = (worker.evaluator.program(), Query { window, ..Query::default() });
    let block = worker.block();
    for start in range.clone().step_by(block) {
        let rays = worker.scratch.rays(rays, start..range.end.min(start + block), program)?;
        let mut sink = |answer: RayAnswer<'_>| table.push(engine, &rays.get(answer.ray), &answer);
        worker.evaluator.crossings(rays, &query, &mut worker.memory, &mut sink);
    }
    Some(table)
}

/// Number of rays that are traced first, to estimate the number of rows of all rays.
const SAMPLE: usize = 1024;

/// All crossings of every ray as a Python object.
pub fn crossings<'py>(
    engine: &Engine,
    rays: [&Bound<'py, PyAny>; 2],
    options: &QueryOptions,
) -> PyResult<Bound<'py, PyAny>> {
    let arguments = QueryArguments::new(engine, rays, options)?;
    match arguments.chunking.chunks() {
        0..LONG => into_python(arguments.py, engine, arguments.tables()?, arguments.chunking),
        _ => placed(engine, &arguments),
    }
}

/// The number of chunks from which on the arrays are allocated for an estimated number of rows.
/// Tables are then copied to them while they are in cache, and their memory is reused; the cost is
/// that sample rays are traced twice.
const LONG: usize = 16;

/// A table and its buffers.
struct Job<'a> {
    table: Table,
    first: usize,
    rows: Rows<'a>,
    start_inside: &'a mut [bool],
    ends: &'a mut [i64],
}

impl Job<'_> {
    /// Copies the table to its buffers, and returns it empty.
    fn run(mut self, engine: &Engine) -> Table {
        self.table.put_rows(engine, &mut self.rows);
        self.table.put_rays(self.first, self.start_inside, self.ends);
        self.table.clear();
        self.table
    }
}

/// State shared by threads; valid even if one of them panicked.
fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// The buffers that are not assigned to a table yet.
struct Places<'a> {
    rows: Rows<'a>,
    start_inside: &'a mut [bool],
    ends: &'a mut [i64],
    /// The rows of all tables so far.
    total: usize,
    /// Tables that exceed the buffers, each with the number of its first row.
    rest: Vec<(usize, Table)>,
    size: TableSize,
}

impl<'a> Places<'a> {
    /// Assigns the next buffers to a table, if there are enough rows left.
    fn take(&mut self, table: Table) -> PyResult<Option<Job<'a>>> {
        let (first, count, rays) = (self.total, table.rows.len(), table.counts.len());
        self.total += count;
        let (start_inside, ends) = (take(&mut self.start_inside, rays), take(&mut self.ends, rays));
        if self.rest.is_empty() && count <= self.rows.len() {
            return Ok(Some(Job { table, first, rows: self.rows.take(count), start_inside, ends }));
        }
        self.size.add(&table)?;
        table.put_rays(first, start_inside, ends);
        self.rest.push((first, table));
        Ok(None)
    }
}

/// Crossings in arrays of an estimated number of rows.
fn placed<'py>(engine: &Engine, arguments: &QueryArguments<'_, 'py>) -> PyResult<Bound<'py, PyAny>> {
    let answer = Answer::new(arguments.py, engine, [arguments.guess(), arguments.chunking.len])?;
    let offsets = fresh::<i64>(arguments.py, arguments.chunking.len + 1)?;
    let (total, rest) = answer.fill(|rows, start_inside| {
        let mut offsets = offsets.readwrite();
        let ends = begun(&mut offsets)?;
        let mut places =
            Places { rows, start_inside, ends, total: 0, rest: Vec::new(), size: TableSize::default() };
        fill_places(engine, arguments, &mut places)?;
        Ok((places.total, places.rest))
    })?;
    answer.resize(total)?;
    answer.fill(|mut rows, _| {
        rows.take(rest.first().map_or(total, |(first, _)| *first));
        rest.iter().for_each(|(_, table)| table.put_rows(engine, &mut rows.take(table.rows.len())));
        Ok(())
    })?;
    answer.into_python(engine, Some(offsets))
}

fn fill_places<'a>(
    engine: &Engine,
    arguments: &QueryArguments<'_, '_>,
    places: &mut Places<'a>,
) -> PyResult<()> {
    let jobs = Mutex::new(Vec::<Job<'a>>::new());
    // a thread that needs an empty table first copies a full one to its buffers, and reuses it
    let table = || {
        let job = lock(&jobs).pop();
        job.map_or_else(Table::default, |job| job.run(engine))
    };
    arguments.run(table, |table| {
        lock(&jobs).extend(places.take(table)?);
        Ok(())
    })?;
    let left = std::mem::take(&mut *lock(&jobs));
    arguments.py.detach(|| left.into_iter().for_each(|job| _ = job.run(engine)));
    Ok(())
}

/// The offsets of the rows of each ray, after the first offset, which is 0.
fn begun<'a>(offsets: &'a mut PyReadwriteArray1<'_, i64>) -> PyResult<&'a mut [i64]> {
    match offsets.as_slice_mut().map_err(bad_value)? {
        [first, ends @ ..] => {
            *first = 0;
            Ok(ends)
        }
        [] => Ok(&mut []),
    }
}

/// Converts crossings to the Python object.
pub fn into_python<'py>(
    py: Python<'py>,
    engine: &Engine,
    tables: Vec<Table>,
    chunking: Chunking,
) -> PyResult<Bound<'py, PyAny>> {
    let rows = tables.iter().map(|table| table.rows.len()).sum();
    let rays = tables.iter().map(|table| table.counts.len()).sum::<usize>();
    let answer = Answer::new(py, engine, [rows, rays])?;
    let offsets = fresh::<i64>(py, rays + 1)?;
    answer.fill(|mut rows, mut start_inside| {
        let mut offsets = offsets.readwrite();
        let (mut ends, mut end) = (begun(&mut offsets)?, 0);
        let jobs = tables.into_iter().map(move |table| {
            let (rays, first) = (table.counts.len(), end);
            end += table.rows.len();
            let rows = rows.take(table.rows.len());
            let (start_inside, ends) = (take(&mut start_inside, rays), take(&mut ends, rays));
            Job { table, first, rows, start_inside, ends }
        });
        share(py, chunking, jobs, |job| _ = job.run(engine))
    })?;
    answer.into_python(engine, Some(offsets))
}

/// The offset of the rows of each ray, and the total number of rows at the end.
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

/// The index of each row's ray, for `rows` rows.
pub fn rows_of(counts: &[usize], rows: usize) -> PyResult<Vec<i64>> {
    let mut rays = room(rows)?;
    for (ray, &count) in counts.iter().enumerate() {
        rays.resize(rays.len() + count, ray as i64);
    }
    Ok(rays)
}

/// The segments of every ray between crossings as a Python object.
pub fn partition<'py>(
    engine: &Engine,
    rays: [&Bound<'py, PyAny>; 2],
    options: &QueryOptions,
    by: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let (py, tables) = (rays[0].py(), QueryArguments::new(engine, rays, options)?.tables()?);
    let pieces = Pieces::new(&tables, options.window)?;
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
    fields.set_item("by", by)?;
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    CLASS.import(py, "rayweave._answers", "Partition")?.call((), Some(&fields))
}

/// Segments of rays between crossings, in columns.
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
        let len = tables.iter().map(|table| table.rows.len()).sum::<usize>() + rays;
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
            for crossing in &table.rows[row..row + count] {
                self.push(ray, [start, crossing.t], region);
                (start, region) = (crossing.t, crossing.after);
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
