//! Entry and exit times of rays, as hit arrays.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use numpy::ndarray::{Array2, ArrayViewMut2, s};
use numpy::{Element, PyArray2, PyArrayMethods, PyReadwriteArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyTuple};
use rayweave::model::{Evaluator, HitArrayRows, Rays, Window};
use rayweave::{AnyEvaluator, AnyScratch};

use crate::arrays::{fresh_table, is_from_numpy, room, shape_text};
use crate::device::Chosen;
use crate::engine::{Chunking, Engine, QueryOptions, Worker, run_query};
use crate::error::{bad_type, bad_value};
use crate::rays::{Columns, RayArrays, RayRows};

/// Buffers for the hits of consecutive rays: a slice of each row of the hit arrays.
#[derive(Default)]
struct HitBuffers<'a> {
    times: Vec<&'a mut [f64]>,
    /// One slice per row of `times`; empty if surfaces are not requested.
    faces: Vec<&'a mut [i32]>,
}

impl<'a> HitBuffers<'a> {
    /// The rows of hit arrays; `None` if they are not contiguous.
    fn new(
        times: &'a mut ArrayViewMut2<'_, f64>,
        faces: Option<&'a mut ArrayViewMut2<'_, i32>>,
    ) -> Option<Self> {
        let times = times.outer_iter_mut().map(|row| row.into_slice()).collect::<Option<_>>()?;
        let faces = faces.into_iter().flat_map(|faces| faces.outer_iter_mut());
        Some(HitBuffers { times, faces: faces.map(|row| row.into_slice()).collect::<Option<_>>()? })
    }

    /// Splits off the columns of the first `count` rays, or of all if there are fewer.
    fn take(&mut self, count: usize) -> Self {
        let count = count.min(self.len());
        HitBuffers { times: take(&mut self.times, count), faces: take(&mut self.faces, count) }
    }

    fn len(&self) -> usize {
        self.times.first().map_or(0, |row| row.len())
    }
}

fn take<'a, T>(rows: &mut [&'a mut [T]], count: usize) -> Vec<&'a mut [T]> {
    rows.iter_mut().filter_map(|row| row.split_off_mut(..count)).collect()
}

/// Query for the entries and exits of rays.
struct HitsQuery<'a> {
    rays: RayRows<'a>,
    window: Window,
    /// True: hits that do not fit in the rows go to an overflow block. False: they are only counted.
    keep_overflow: bool,
    /// The largest known number of hits (entries and exits) per ray.
    most: AtomicUsize,
}

/// Hits of consecutive rays that did not fit in the output rows.
struct OverflowBlock {
    first: usize,
    times: Array2<f64>,
    faces: Option<Array2<i32>>,
}

/// Times and faces of the hits of a block.
type BlockHits = (Array2<f64>, Option<Array2<i32>>);

type HitsWorker<'e> = Worker<'e, Columns>;

impl HitsQuery<'_> {
    /// Processes one ray per buffer column, starting at ray `first`; `None` if one of them is invalid.
    fn process(
        &self,
        worker: &mut HitsWorker<'_>,
        (mut first, mut buffers): (usize, HitBuffers<'_>),
    ) -> Option<PyResult<Vec<OverflowBlock>>> {
        let mut overflow = Vec::new();
        while buffers.len() > 0 {
            let block = buffers.take(worker.block());
            let len = block.len();
            let rays = worker.scratch.rays(self.rays, first..first + len, worker.evaluator.program())?;
            let mut tracer = (worker.evaluator, &mut worker.memory);
            match self.block(&mut tracer, rays, block) {
                Ok(block) => {
                    overflow.extend(block.map(|(times, faces)| OverflowBlock { first, times, faces }))
                }
                Err(error) => return Some(Err(error)),
            }
            first += len;
        }
        Some(Ok(overflow))
    }

    /// Writes the hits of one block to its buffers, or to an overflow block if they have too few rows.
    fn block(
        &self,
        tracer: &mut (&AnyEvaluator, &mut AnyScratch),
        rays: Rays<'_>,
        buffers: HitBuffers<'_>,
    ) -> PyResult<Option<BlockHits>> {
        let (rows, with_faces) = (buffers.times.len(), !buffers.faces.is_empty());
        if !self.keep_overflow || self.most.load(Relaxed) <= rows {
            let most = self.write(tracer, rays, buffers);
            if !self.keep_overflow || most <= rows {
                return Ok(None);
            }
        }
        loop {
            let rows = row_count(self.most.load(Relaxed));
            let mut times = filled(rows, rays.len(), f64::INFINITY)?;
            let mut faces = with_faces.then(|| filled(rows, rays.len(), -1)).transpose()?;
            let (mut times_view, mut faces_view) =
                (times.view_mut(), faces.as_mut().map(|faces| faces.view_mut()));
            let buffers = HitBuffers::new(&mut times_view, faces_view.as_mut()).unwrap_or_default();
            if self.write(tracer, rays, buffers) <= rows {
                return Ok(Some((times, faces)));
            }
        }
    }

    /// Computes the hits of a block; returns the maximum number of hits (entries and exits) per ray.
    fn write(
        &self,
        (evaluator, memory): &mut (&AnyEvaluator, &mut AnyScratch),
        rays: Rays<'_>,
        mut buffers: HitBuffers<'_>,
    ) -> usize {
        let mut rows = HitArrayRows { times: &mut buffers.times, faces: &mut buffers.faces };
        let most = evaluator.hits(rays, self.window, memory, &mut rows);
        self.most.fetch_max(most, Relaxed);
        most
    }
}

/// The smallest even number of rows, at least 2, for this number of hits per ray.
fn row_count(hits: usize) -> usize {
    hits.next_multiple_of(2).max(2)
}

/// A (rows, columns) array filled with one value, or a `MemoryError`.
fn filled<T: Clone>(rows: usize, columns: usize, value: T) -> PyResult<Array2<T>> {
    let too_large = || {
        let problem = format!("the hit array is too large: {rows} x {columns} elements.");
        PyMemoryError::new_err(format!("{problem} Trace fewer rays per call."))
    };
    let len = rows.checked_mul(columns).ok_or_else(too_large)?;
    let mut data = room(len)?;
    data.resize(len, value);
    Array2::from_shape_vec((rows, columns), data).map_err(bad_value)
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

/// NumPy hit arrays: the times, and the faces if requested.
type PyHitArrays<'py> = (Bound<'py, PyArray2<f64>>, Option<Bound<'py, PyArray2<i32>>>);

impl<'py> QueryArguments<'_, 'py> {
    /// Writes the hits of all rays to buffers; returns the maximum number of hits (entries and exits) per ray,
    /// and the hits that did not fit in the rows.
    fn write(
        &self,
        mut buffers: HitBuffers<'_>,
        keep_overflow: bool,
    ) -> PyResult<(usize, Vec<OverflowBlock>)> {
        let mut overflow = Vec::new();
        let rays = self.rays.rows();
        let query = HitsQuery { rays, window: self.window, keep_overflow, most: AtomicUsize::new(0) };
        let chunks = self.chunking.ranges().map(move |range| (range.start, buffers.take(range.len())));
        let work = |worker: &mut HitsWorker<'_>, chunk| query.process(worker, chunk);
        let merge = |chunk: PyResult<Vec<OverflowBlock>>| {
            overflow.extend(chunk?);
            Ok(())
        };
        if !run_query(self.py, &self.evaluator, self.chunking, chunks, work, merge)? {
            return Err(self.rays.invalid_input(&self.engine.program));
        }
        Ok((query.most.into_inner(), overflow))
    }

    /// Estimated number of rows of the hit array, from the last query and from sample rays.
    fn estimated_rows(&self) -> usize {
        let last = row_count(self.engine.rows.load(Relaxed));
        let count = (self.chunking.len / SAMPLE_INTERVAL).min(MAX_SAMPLES);
        if count == 0 {
            return last;
        }
        let rays = self.rays.rows().every(self.chunking.len / count);
        let query = HitsQuery { rays, window: self.window, keep_overflow: false, most: AtomicUsize::new(0) };
        let evaluator: &AnyEvaluator = &self.evaluator;
        self.py.detach(|| {
            let (memory, scratch) = (evaluator.scratch(), Columns::default());
            let mut row = vec![0.0; count];
            let buffers = HitBuffers { times: vec![&mut row], faces: Vec::new() };
            // invalid rays are reported when all rays are processed
            let _ = query.process(&mut Worker { evaluator, memory, scratch }, (0, buffers));
        });
        let sampled = row_count(query.most.into_inner());
        // too many rows waste memory, too few need a second pass: the last count is used only if it is at most
        // twice the sampled one, since the last query may differ from this one
        if last <= 2 * sampled { last.max(sampled) } else { sampled }
    }

    /// The hits in new arrays with the smallest possible number of rows, and the maximum number of hits per ray.
    fn new_arrays(&self, surfaces: bool) -> PyResult<(PyHitArrays<'py>, usize)> {
        let shape = [self.estimated_rows(), self.chunking.len];
        let times = fresh_table(self.py, shape)?;
        let faces = surfaces.then(|| fresh_table(self.py, shape)).transpose()?;
        if self.chunking.len == 0 {
            return Ok(((times, faces), 0));
        }
        let arrays = (times, faces);
        let (most, overflow) = with_buffers(&arrays, ["times", "surfaces"], |buffers| match buffers {
            Some(buffers) => self.write(buffers, true),
            None => Err(bad_value("the new array is not contiguous")),
        })?;
        self.engine.rows.store(most, Relaxed);
        let (times, faces) = arrays;
        let times = resized(times, row_count(most), f64::INFINITY)?;
        let faces = faces.map(|faces| resized(faces, row_count(most), -1)).transpose()?;
        for OverflowBlock { first, times: some, faces: with } in overflow {
            put(&times, first, &some)?;
            faces.iter().zip(with).try_for_each(|(faces, some)| put(faces, first, &some))?;
        }
        Ok(((times, faces), most))
    }

    /// Writes the hits to arrays of the caller.
    fn fill(&self, arrays: &PyHitArrays<'py>, names: [&str; 2]) -> PyResult<()> {
        self.check_shape(arrays.0.shape(), names[0], None)?;
        if self.chunking.len == 0 {
            return Ok(());
        }
        let most = with_buffers(arrays, names, |buffers| match buffers {
            Some(buffers) => self.write(buffers, false).map(|(most, _)| Some(most)),
            None => Ok(None),
        })?;
        if let Some(most) = most {
            return self.check_shape(arrays.0.shape(), names[0], Some(most));
        }
        let (fresh, most) = self.new_arrays(arrays.1.is_some())?;
        self.check_shape(arrays.0.shape(), names[0], Some(most))?;
        copy(&fresh.0, &arrays.0, f64::INFINITY)?;
        arrays.1.iter().zip(&fresh.1).try_for_each(|(to, from)| copy(from, to, -1))
    }

    /// Checks the shape of an output array for rays with at most `most` hits, if their number is known.
    fn check_shape(&self, shape: &[usize], name: &str, most: Option<usize>) -> PyResult<()> {
        let least = row_count(most.unwrap_or(0));
        if shape[0] >= least && shape[0].is_multiple_of(2) && shape[1] == self.chunking.len {
            return Ok(());
        }
        let (shape, columns) = (shape_text(shape), self.chunking.len);
        let reason = most.map(|most| format!(", since a ray has {most} hits")).unwrap_or_default();
        let rows = format!("an even number of rows, at least {least}{reason}");
        Err(bad_value(format!("{name} has shape {shape}: it must have {columns} columns and {rows}.")))
    }
}

/// One ray in this many is traced first, to estimate the number of rows of the hit array.
const SAMPLE_INTERVAL: usize = 500;

/// The maximum number of sample rays.
const MAX_SAMPLES: usize = 4096;

/// Calls a function with the rows of arrays as buffers, or with `None` if their rows are not contiguous.
fn with_buffers<R>(
    (times, faces): &PyHitArrays<'_>,
    names: [&str; 2],
    call: impl FnOnce(Option<HitBuffers<'_>>) -> PyResult<R>,
) -> PyResult<R> {
    let mut times = writable(times, names[0])?;
    let mut faces = faces.as_ref().map(|faces| writable(faces, names[1])).transpose()?;
    let (mut times, mut faces) = (times.as_array_mut(), faces.as_mut().map(|faces| faces.as_array_mut()));
    call(HitBuffers::new(&mut times, faces.as_mut()))
}

/// Borrows the array for writing.
fn writable<'py, T: Element>(
    array: &Bound<'py, PyArray2<T>>,
    name: &str,
) -> PyResult<PyReadwriteArray2<'py, T>> {
    let strides = array.strides();
    if !array.is_aligned() || !strides.iter().all(|stride| stride % size_of::<T>() as isize == 0) {
        let problem = "is not aligned, or has strides that are not multiples of the element size";
        return Err(bad_value(format!("{name} {problem}. Pass an aligned array.")));
    }
    let array = array.try_readwrite().map_err(|error| bad_value(format!("{name}: {error}")))?;
    // the distance between elements along an axis, and from the first to beyond the last
    let spans = std::iter::zip(strides, array.shape()).filter(|&(_, &len)| len > 1);
    let mut spans: Vec<_> = spans.map(|(s, len)| (s.unsigned_abs(), s.unsigned_abs() * len)).collect();
    spans.sort_unstable();
    if spans.iter().any(|span| span.0 == 0) || spans.windows(2).any(|pair| pair[0].1 > pair[1].0) {
        return Err(bad_value(format!("{name} has elements that share memory: each hit needs its own.")));
    }
    Ok(array)
}

/// Resizes an array that has no other references, and fills new rows with a value.
fn resized<'py, T: Element + Copy>(
    array: Bound<'py, PyArray2<T>>,
    rows: usize,
    value: T,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let [before, columns] = [array.shape()[0], array.shape()[1]];
    if before == rows {
        return Ok(array);
    }
    if !is_from_numpy(&array) {
        let mut table = filled(rows, columns, value)?;
        let kept = rows.min(before);
        table.slice_mut(s![..kept, ..]).assign(&array.readonly().as_array().slice(s![..kept, ..]));
        return Ok(PyArray2::from_owned_array(array.py(), table));
    }
    // the memory is released, or grows without a copy
    let options = [("refcheck", false)].into_py_dict(array.py())?;
    array.call_method("resize", ((rows, columns),), Some(&options))?;
    if rows > before {
        writable(&array, "the hit array")?.as_array_mut().slice_mut(s![before.., ..]).fill(value);
    }
    Ok(array)
}

/// Copies a block of hits, which may have fewer rows, to the columns from `first` on.
fn put<T: Element + Copy>(to: &Bound<'_, PyArray2<T>>, first: usize, table: &Array2<T>) -> PyResult<()> {
    let mut to = writable(to, "the hit array")?;
    to.as_array_mut().slice_mut(s![..table.nrows(), first..first + table.ncols()]).assign(table);
    Ok(())
}

/// Copies a hit array to one that may have more rows, which are filled with a value.
fn copy<T: Element + Copy>(
    from: &Bound<'_, PyArray2<T>>,
    to: &Bound<'_, PyArray2<T>>,
    value: T,
) -> PyResult<()> {
    let from = from.try_readonly().map_err(bad_value)?;
    let (from, mut to) = (from.as_array(), writable(to, "out")?);
    let mut to = to.as_array_mut();
    to.fill(value);
    to.slice_mut(s![..from.nrows(), ..]).assign(&from);
    Ok(())
}

/// The hits of every ray as an array (H, N), and the surfaces hit if requested.
pub fn hits<'py>(
    engine: &Engine,
    rays: [&Bound<'py, PyAny>; 2],
    options: &QueryOptions,
    surfaces: bool,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = rays[0].py();
    let rays = RayArrays::new(rays)?;
    let evaluator = engine.chosen(py, options)?;
    let chunking = options.chunking(rays.len(), &evaluator);
    let arguments = QueryArguments { py, engine, evaluator, rays, window: options.window, chunking };
    let (times, faces) = match out {
        None => arguments.new_arrays(surfaces)?.0,
        Some(out) => {
            let (arrays, names) = output_arrays(out, surfaces)?;
            arguments.fill(&arrays, names)?;
            arrays
        }
    };
    match faces {
        Some(faces) => Ok(PyTuple::new(py, [times.into_any(), faces.into_any()])?.into_any()),
        None => Ok(times.into_any()),
    }
}

/// The output arrays of the caller, one for the times or a pair with one for the surfaces, and
/// their names in messages.
fn output_arrays<'py>(
    out: &Bound<'py, PyAny>,
    surfaces: bool,
) -> PyResult<(PyHitArrays<'py>, [&'static str; 2])> {
    let table = |array: &Bound<'py, PyAny>, name: &str| match array.cast::<PyArray2<f64>>() {
        Ok(array) => Ok(array.clone()),
        Err(_) => {
            Err(bad_type(format!("{name} must be a two-dimensional float64 array: hits are written to it.")))
        }
    };
    let Ok(pair) = out.cast::<PyTuple>() else {
        let times = table(out, "out")?;
        let shape = [times.shape()[0], times.shape()[1]];
        let faces = surfaces.then(|| fresh_table(out.py(), shape)).transpose()?;
        return Ok(((times, faces), ["out", "surfaces"]));
    };
    if !surfaces || pair.len() != 2 {
        return Err(bad_type(format!(
            "out is a tuple of {}: pass one array, or with return_surfaces a pair (times, surfaces).",
            pair.len()
        )));
    }
    let (times, faces) = (table(&pair.get_item(0)?, "out[0]")?, pair.get_item(1)?);
    let Ok(faces) = faces.cast_into::<PyArray2<i32>>() else {
        return Err(bad_type("out[1] must be a two-dimensional int32 array: surfaces are written to it."));
    };
    if faces.shape() != times.shape() {
        let (first, second) = (shape_text(times.shape()), shape_text(faces.shape()));
        return Err(bad_value(format!("out has shapes {first} and {second}: both must be the same.")));
    }
    Ok(((times, Some(faces)), ["out[0]", "out[1]"]))
}
