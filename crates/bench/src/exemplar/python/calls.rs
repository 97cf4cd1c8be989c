//! Rust calls that are equivalent to the calls from Python, with results in the same kind of
//! memory: existing or newly allocated.

use super::{QueryKind, text};
use crate::answer::{FirstTable, HitTable, ahead};
use crate::exemplar::die::ROWS;
use crate::exemplar::question::{CHUNK, components, hits, into_table_on_threads, on_threads, pieces};
use crate::interleaved::{Candidate, Role};
use rayweave::model::{
    FirstHits, HitArrayRows, Limit, Program, Query, RayAnswer, RayBatch, Rays, RegionId, attributes,
};
use rayweave::{AnyEvaluator, Evaluator, Window};
use std::hint::black_box;

/// The name of the candidates.
const NAME: &str = "Rust";

/// One call for all rays.
pub fn many<'a>(
    kind: QueryKind,
    evaluator: &'a AnyEvaluator,
    rays: Rays<'a>,
    threads: usize,
) -> Result<Candidate<'a>, String> {
    let of = |table| into_table_on_threads(NAME, evaluator, rays, table, threads);
    let anew =
        |run: Box<dyn FnMut() + 'a>| Candidate::here(NAME, Role::Ours, rays.len(), run).threads(threads);
    Ok(match kind {
        QueryKind::Hits => of(HitTable::of_times(ROWS, rays.len())),
        QueryKind::Surfaces => of(HitTable::new(ROWS, rays.len())),
        QueryKind::Nearest => {
            let window = ahead().map_err(text)?;
            anew(Box::new(move || nearest(evaluator, rays, window, threads)))
        }
        QueryKind::Crossings => anew(Box::new(move || crossings(evaluator, rays, threads))),
        QueryKind::Contains => anew(Box::new(move || contains(evaluator, rays.origins, threads))),
    })
}

fn nearest(evaluator: &AnyEvaluator, rays: Rays<'_>, window: Window, threads: usize) {
    let mut table = FirstTable::new(rays.len());
    let mut points = [(); 3].map(|()| vec![0.0; rays.len()]);
    let [x, y, z] = &mut points;
    let chunks = pieces(rays).zip(hits(table.hits())).zip(components([x, y, z]));
    on_threads(evaluator, threads, chunks, |scratch, ((rays, mut hits), mut points)| {
        evaluator.nearest(rays, window, scratch, &mut hits);
        put_points(rays, &hits, &mut points);
    });
    black_box((table, points));
}

fn put_points(rays: Rays<'_>, hits: &FirstHits<'_>, points: &mut [&mut [f64]; 3]) {
    for (k, column) in points.iter_mut().enumerate() {
        for (((to, t), o), d) in column.iter_mut().zip(&*hits.t).zip(rays.origins[k]).zip(rays.directions[k])
        {
            *to = if *t < f64::INFINITY { o + t * d } else { f64::NAN };
        }
    }
}

/// Crossings in columns.
#[derive(Default)]
struct Columns {
    t: Vec<f64>,
    point: Vec<[f64; 3]>,
    normal: Vec<[f64; 3]>,
    enters: Vec<bool>,
    /// Face, leaf, placement.
    ids: [Vec<u32>; 3],
    /// The end of the rows of each ray.
    ends: Vec<usize>,
    start_inside: Vec<bool>,
}

impl Columns {
    fn put(&mut self, program: &Program, rays: &Rays<'_>, answer: &RayAnswer<'_>) {
        let ray = rays.get(answer.ray);
        for crossing in answer.crossings {
            self.t.push(crossing.t);
            self.point.push(attributes::point(&ray, crossing).to_array());
            self.normal.push(attributes::normal(program, &ray, crossing).to_array());
            self.enters.push(crossing.enters());
            let (leaf, placement) = (crossing.face.leaf, crossing.face.placement);
            let face = program.face_number(leaf, crossing.face.facet);
            self.ids.iter_mut().zip([face, leaf.0, placement.0]).for_each(|(column, id)| column.push(id));
        }
        self.ends.push(self.t.len());
        self.start_inside.push(answer.start.0 != 0);
    }

    fn append(&mut self, other: &Columns) {
        let rows = self.t.len();
        self.t.extend_from_slice(&other.t);
        self.point.extend_from_slice(&other.point);
        self.normal.extend_from_slice(&other.normal);
        self.enters.extend_from_slice(&other.enters);
        self.ids.iter_mut().zip(&other.ids).for_each(|(to, from)| to.extend_from_slice(from));
        self.ends.extend(other.ends.iter().map(|end| rows + end));
        self.start_inside.extend_from_slice(&other.start_inside);
    }
}

fn crossings(evaluator: &AnyEvaluator, rays: Rays<'_>, threads: usize) {
    let program = evaluator.program();
    if threads == 1 {
        let mut columns = Columns::default();
        let mut sink = |answer: RayAnswer<'_>| columns.put(program, &rays, &answer);
        evaluator.crossings(rays, &Query::default(), &mut evaluator.scratch(), &mut sink);
        black_box(columns);
        return;
    }
    let tables = on_threads(evaluator, threads, pieces(rays), |scratch, rays| {
        let mut columns = Columns::default();
        let mut sink = |answer: RayAnswer<'_>| columns.put(program, &rays, &answer);
        evaluator.crossings(rays, &Query::default(), scratch, &mut sink);
        columns
    });
    let mut whole = Columns::default();
    tables.iter().for_each(|table| whole.append(table));
    black_box(whole);
}

fn contains(evaluator: &AnyEvaluator, points: [&[f64]; 3], threads: usize) {
    let (program, len) = (evaluator.program(), points[0].len());
    let mut flags = vec![false; len];
    let starts = (0..len).step_by(CHUNK).zip(flags.chunks_mut(CHUNK));
    on_threads(evaluator, threads, starts, |scratch, (start, flags)| {
        let mut regions = vec![RegionId(0); flags.len()];
        let points = points.map(|column| &column[start..start + flags.len()]);
        evaluator.regions_at(points, scratch, &mut regions);
        flags.iter_mut().zip(regions).for_each(|(flag, region)| *flag = program.medium_of(region) != 0);
    });
    black_box(flags);
}

/// One call per ray, with reused memory.
pub fn one_by_one<'a>(
    kind: QueryKind,
    evaluator: &'a AnyEvaluator,
    rays: Rays<'a>,
) -> Result<Candidate<'a>, String> {
    let batches: Vec<RayBatch> = (0..rays.len()).map(|i| RayBatch::from_iter([rays.get(i)])).collect();
    let (mut scratch, window) = (evaluator.scratch(), ahead().map_err(text)?);
    let (mut table, mut first) = (HitTable::of_times(ROWS, 1), FirstTable::new(1));
    let query = Query { limit: Limit::All, ..Query::default() };
    let one = move |batch: &RayBatch| match kind {
        QueryKind::Nearest => evaluator.nearest(batch.rays(), window, &mut scratch, &mut first.hits()),
        QueryKind::Crossings => {
            let mut columns = Columns::default();
            let mut sink = |answer: RayAnswer<'_>| columns.put(evaluator.program(), &batch.rays(), &answer);
            evaluator.crossings(batch.rays(), &query, &mut scratch, &mut sink);
            black_box(columns);
        }
        _ => {
            let (mut times, mut faces) = table.rows();
            let mut rows = HitArrayRows { times: &mut times, faces: &mut faces };
            evaluator.hits(batch.rays(), Window::ALL, &mut scratch, &mut rows);
        }
    };
    let mut one = one;
    Ok(Candidate::here(NAME, Role::Ours, batches.len(), move || batches.iter().for_each(&mut one)))
}
