//! Point membership queries.

use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use rayweave::model::{Evaluator, RegionId};

use crate::arrays::{fresh, fresh_flags};
use crate::engine::{Engine, QueryOptions, Worker, run_query};
use crate::error::bad_value;
use crate::rays::{Columns, Rows, Vectors, invalid_input};

type PointWorker<'e> = Worker<'e, (Columns, Vec<RegionId>)>;

/// Whether each point is inside: bool (N,), or (...) for a grid of points (..., 3).
pub fn contains<'py>(
    engine: &Engine,
    points: &Bound<'py, PyAny>,
    options: &QueryOptions,
) -> PyResult<Bound<'py, PyAny>> {
    answer(engine, points, options, fresh_flags, |region| engine.is_inside(region))
}

/// The region of each point: int32 (N,), or (...) for a grid of points (..., 3).
pub fn regions_at<'py>(
    engine: &Engine,
    points: &Bound<'py, PyAny>,
    options: &QueryOptions,
) -> PyResult<Bound<'py, PyAny>> {
    answer(engine, points, options, fresh::<i32>, |region| region.0 as i32)
}

/// Computes a value for the region of each point, in an array of the shape of the points.
fn answer<'py, T: Element + Send>(
    engine: &Engine,
    points: &Bound<'py, PyAny>,
    options: &QueryOptions,
    fresh: impl Fn(Python<'py>, usize) -> PyResult<Bound<'py, PyArray1<T>>>,
    value: impl Fn(RegionId) -> T + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let py = points.py();
    let vectors = Vectors::points(points, "points")?;
    let (evaluator, rows) = (engine.chosen(py, options)?, vectors.rows());
    let chunking = options.chunking(vectors.len(), &evaluator);
    let answer = fresh(py, vectors.len())?;
    let mut values = answer.try_readwrite().map_err(bad_value)?;
    let mut rest = values.as_slice_mut().map_err(bad_value)?;
    let chunks = chunking
        .ranges()
        .map(move |range| (range.start, rest.split_off_mut(..range.len()).unwrap_or_default()));
    let work = |worker: &mut PointWorker<'_>, chunk| write(worker, rows, chunk, &value);
    if !run_query(py, &evaluator, chunking, chunks, work, |()| Ok(()))? {
        return Err(invalid_input(&[&vectors]));
    }
    drop(values);
    match vectors.shape() {
        [] | [_] => Ok(answer.into_any()),
        grid => Ok(answer.reshape(grid.to_vec())?.into_any()),
    }
}

/// Writes the results of the points from `first` on.
fn write<T>(
    worker: &mut PointWorker<'_>,
    points: Rows<'_>,
    (first, values): (usize, &mut [T]),
    value: impl Fn(RegionId) -> T,
) -> Option<()> {
    let block = worker.block();
    let (evaluator, (columns, regions)) = (worker.evaluator, &mut worker.scratch);
    for (k, values) in values.chunks_mut(block).enumerate() {
        let start = first + k * block;
        let points = columns.points(points, start..start + values.len())?;
        regions.clear();
        regions.resize(values.len(), RegionId(0));
        evaluator.regions_at(points, &mut worker.memory, regions);
        for (to, &region) in values.iter_mut().zip(&*regions) {
            *to = value(region);
        }
    }
    Some(())
}
