//! The first crossing of each ray, in columns.

use pyo3::prelude::*;
use rayweave::model::{Evaluator, FirstHits, Program, Rays, RegionId, Window};

use crate::answer::{Answer, Rows, take};
use crate::engine::{BLOCK, Engine, How, Worker, ask, inside};
use crate::rays::{Columns, RayArrays, RayRows};

/// What a thread needs to answer a block.
#[derive(Default)]
struct Scratch {
    columns: Columns,
    placement: Vec<u32>,
    regions: [Vec<u32>; 2],
    normal: [Vec<f64>; 3],
}

/// Places for the answers about the rays from the first on.
struct Places<'a> {
    first: usize,
    rows: Rows<'a>,
    start_inside: &'a mut [bool],
}

/// The first crossing of each ray in the window.
pub fn nearest<'py>(
    engine: &Engine,
    rays: [&Bound<'py, PyAny>; 2],
    how: &How,
) -> PyResult<Bound<'py, PyAny>> {
    let py = rays[0].py();
    let rays = RayArrays::new(rays)?;
    let (cut, evaluator) = (how.cut(rays.len()), engine.chosen(py, how)?);
    let question = Question { engine, rays: rays.rows(), window: how.window };
    let answer = Answer::new(py, engine, [rays.len(); 2])?;
    let done = answer.fill(|mut rows, mut start_inside| {
        let chunks = cut.ranges().map(move |range| Places {
            first: range.start,
            rows: rows.take(range.len()),
            start_inside: take(&mut start_inside, range.len()),
        });
        let work = |worker: &mut Worker<'_, Scratch>, places: Places<'_>| question.answer(worker, places);
        ask(py, &evaluator, cut, chunks, work, |()| Ok(()))
    })?;
    if done { answer.into_python(engine, None) } else { Err(rays.refusal()) }
}

struct Question<'a> {
    engine: &'a Engine,
    rays: RayRows<'a>,
    window: Window,
}

impl Question<'_> {
    /// Answers as far as there are places; `None` if a ray cannot be used.
    fn answer(&self, worker: &mut Worker<'_, Scratch>, mut places: Places<'_>) -> Option<()> {
        while places.rows.len() > 0 {
            let rows = places.rows.take(BLOCK);
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
        let rays = columns.rays(self.rays, first..first + len)?;
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
        let program = worker.evaluator.program();
        put_points(&rays, rows.t, rows.point);
        put_normals(program, normal, after, rows.normal);
        for (i, &t) in rows.t.iter().enumerate() {
            rows.enters[i] = t < f64::INFINITY && inside(program, RegionId(after[i]));
            start_inside[i] = inside(program, RegionId(before[i]));
        }
        self.put_faces(placement, &mut rows);
        rows.put_regions(self.engine, before, after);
        Some(())
    }

    /// The leaves that the faces belong to, and their placements; -1 for a miss.
    fn put_faces(&self, placement: &[u32], rows: &mut Rows<'_>) {
        let leaves = self.engine.leaves();
        for (i, &face) in rows.surface.iter().enumerate() {
            let leaf = usize::try_from(face).ok().and_then(|face| leaves.get(face));
            rows.leaf[i] = leaf.copied().unwrap_or(-1);
            rows.placement[i] = if face < 0 { -1 } else { placement[i] as i32 };
        }
    }
}

/// Where the rays are at their times; NaN for a miss.
fn put_points(rays: &Rays<'_>, t: &[f64], points: &mut [[f64; 3]]) {
    for k in 0..3 {
        let (origins, directions) = (rays.origins[k], rays.directions[k]);
        for (((point, &t), o), d) in points.iter_mut().zip(t).zip(origins).zip(directions) {
            point[k] = if t < f64::INFINITY { o + t * d } else { f64::NAN };
        }
    }
}

/// The normals, outward of the solid: those of the evaluator look at regions, and out of a region of the world's medium is
/// not out of the solid.
fn put_normals(program: &Program, normal: &[Vec<f64>; 3], after: &[u32], normals: &mut [[f64; 3]]) {
    let [x, y, z] = normal;
    for ((((to, &x), &y), &z), &after) in normals.iter_mut().zip(x).zip(y).zip(z).zip(after) {
        let is_turned = after != 0 && !inside(program, RegionId(after));
        *to = if is_turned { [-x, -y, -z] } else { [x, y, z] };
    }
}
