//! Point membership queries.

use numpy::PyArrayMethods;
use pyo3::prelude::*;
use rayweave::model::{Evaluator, RegionId};

use crate::arrays::fresh_flags;
use crate::engine::{Engine, QueryOptions, Worker, inside, run_query};
use crate::error::bad_value;
use crate::rays::{Columns, Rows, Vectors, invalid_input};

type PointWorker<'e> = Worker<'e, (Columns, Vec<RegionId>)>;

/// Whether each point is inside: bool (N,), or (...) for a grid of points (..., 3).
pub fn contains<'py>(
    engine: &Engine,
    points: &Bound<'py, PyAny>,
    options: &QueryOptions,
) -> PyResult<Bound<'py, PyAny>> {
    let py = points.py();
    let vectors = Vectors::points(points, "points")?;
    let (evaluator, rows) = (engine.chosen(py, options)?, vectors.rows());
    let chunking = options.chunking(vectors.len(), &evaluator);
    let answer = fresh_flags(py, vectors.len())?;
    let mut flags = answer.try_readwrite().map_err(bad_value)?;
    let mut rest = flags.as_slice_mut().map_err(bad_value)?;
    let chunks = chunking
        .ranges()
        .map(move |range| (range.start, rest.split_off_mut(..range.len()).unwrap_or_default()));
    let work = |worker: &mut PointWorker<'_>, chunk| write(worker, rows, chunk);
    if !run_query(py, &evaluator, chunking, chunks, work, |()| Ok(()))? {
        return Err(invalid_input(&[&vectors]));
    }
    drop(flags);
    match vectors.shape() {
        [] | [_] => Ok(answer.into_any()),
        grid => Ok(answer.reshape(grid.to_vec())?.into_any()),
    }
}

/// Writes the results of the points from `first` on.
fn write(worker: &mut PointWorker<'_>, points: Rows<'_>, (first, flags): (usize, &mut [bool])) -> Option<()> {
    let block = worker.block();
    let (evaluator, (columns, regions)) = (worker.evaluator, &mut worker.scratch);
    for (k, flags) in flags.chunks_mut(block).enumerate() {
        let start = first + k * block;
        let points = columns.points(points, start..start + flags.len())?;
        regions.clear();
        regions.resize(flags.len(), RegionId(0));
        evaluator.regions_at(points, &mut worker.memory, regions);
        for (flag, &region) in flags.iter_mut().zip(&*regions) {
            *flag = inside(evaluator.program(), region);
        }
    }
    Some(())
}
