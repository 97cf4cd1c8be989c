//! The first crossing of each ray, as columns.

use std::iter::zip;

use pyo3::prelude::*;
use rayweave::model::{Evaluator, FirstHits, Window};

use crate::answer::{Answer, Rows, take};
use crate::engine::{Engine, QueryOptions, Worker, run_query};
use crate::layout::{interleave, points_at};
use crate::rays::{Columns, RayArrays, RayRows};

/// State of a thread that processes a block.
#[derive(Default)]
struct Scratch {
    columns: Columns,
    placement: Vec<u32>,
    regions: [Vec<u32>; 2],
    normal: [Vec<f64>; 3],
}

/// Buffers for the results of consecutive rays.
struct Places<'a> {
    first: usize,
    rows: Rows<'a>,
    start_inside: &'a mut [bool],
}

/// The first crossing of each ray in the window.
pub fn nearest<'py>(
    engine: &Engine,
    rays: [&Bound<'py, PyAny>; 2],
    options: &QueryOptions,
) -> PyResult<Bound<'py, PyAny>> {
    let py = rays[0].py();
    let rays = RayArrays::new(rays)?;
    let evaluator = engine.chosen(py, options)?;
    let chunking = options.chunking(rays.len(), &evaluator);
    let question = Question { engine, rays: rays.rows(), window: options.window };
    let answer = Answer::new(py, engine, [rays.len(); 2])?;
    let done = answer.fill(|mut rows, mut start_inside| {
        let chunks = chunking.ranges().map(move |range| Places {
            first: range.start,
            rows: rows.take(range.len()),
            start_inside: take(&mut start_inside, range.len()),
        });
        let work = |worker: &mut Worker<'_, Scratch>, places: Places<'_>| question.answer(worker, places);
        run_query(py, &evaluator, chunking, chunks, work, |()| Ok(()))
    })?;
    if done { answer.into_python(engine, None) } else { Err(rays.invalid_input(&engine.program)) }
}

struct Question<'a> {
    engine: &'a Engine,
    rays: RayRows<'a>,
    window: Window,
}

impl Question<'_> {
    /// Processes as many rays as there are buffers; `None` if a ray is invalid.
    fn answer(&self, worker: &mut Worker<'_, Scratch>, mut places: Places<'_>) -> Option<()> {
        while places.rows.len() > 0 {
            let rows = places.rows.take(worker.block());
            let (len, first) = (rows.len(), places.first);
            self.block(worker, first, rows, take(&mut places.start_inside, len))?;
            places.first += len;
        }
        Some(())
    }

    fn block(
        &self,
        worker: &mut Worker<'_, Scratch>,
        first: usize,
        mut rows: Rows<'_>,
        start_inside: &mut [bool],
    ) -> Option<()> {
        let (len, Scratch { columns, placement, regions: [before, after], normal }) =
            (rows.len(), &mut worker.scratch);
        let rays = columns.rays(self.rays, first..first + len, &self.engine.program)?;
        [&mut *placement, &mut *before, &mut *after].into_iter().for_each(|column| column.resize(len, 0));
        normal.iter_mut().for_each(|column| column.resize(len, 0.0));
        let mut hits = FirstHits {
            t: rows.t,
            face: rows.surface,
            placement,
            before,
            after,
            normal: Some(normal.each_mut().map(Vec::as_mut_slice)),
        };
        worker.evaluator.nearest(rays, self.window, &mut worker.memory, &mut hits);
        points_at(rays.origins, rays.directions, rows.t, rows.point);
        interleave(normal.each_ref().map(Vec::as_slice), rows.normal);
        self.engine.put_inside(before, start_inside);
        self.engine.put_inside(after, rows.enters);
        self.turn_normals(after, &mut rows);
        // if a ray starts inside and crosses nothing, the region behind is inside, too
        zip(&mut *rows.enters, &*rows.t).for_each(|(enters, &t)| *enters &= t < f64::INFINITY);
        for ((to, &placement), &face) in zip(&mut *rows.placement, &*placement).zip(&*rows.surface) {
            *to = if face < 0 { -1 } else { placement as i32 };
        }
        rows.put_regions(self.engine, zip(before, after).map(|(before, after)| [*before, *after]));
        Some(())
    }

    /// Orients normals outward of the solid. The evaluator's normals refer to regions, and a region
    /// may have the medium of the world: leaving it is not leaving the solid. `enters` states
    /// whether the ray enters a region there.
    fn turn_normals(&self, after: &[u32], rows: &mut Rows<'_>) {
        if self.engine.is_plain() {
            return;
        }
        for ((normal, &enters), &after) in zip(&mut *rows.normal, &*rows.enters).zip(after) {
            if after != 0 && !enters {
                *normal = normal.map(|x| -x);
            }
        }
    }
}
