//! Packets: eight rays at a time through small models.
//!
//! Along a ray a leaf is a stretch from one time to another (less what some facets cut out). Each end of a stretch is
//! kept if the boolean of the *other* stretches at that time makes it a change: comparisons and masks, no sweep and no
//! branch. That takes a number of comparisons that grows with the square of the number of leaves, so models of more
//! than a few leaves, and those with placed solids, are left to [`Weave`]; so is every single ray about which lanes
//! cannot be certain: where two events come at the same time, where two crossings are so near each other that they may
//! have to be welded, where a ray may lie in a face.

mod group;
mod logic;
mod network;
mod normal;
mod plan;

use crate::Weave;
use crate::weave::WeaveScratch;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use group::{Found, Group, Memory, Row, load};
use normal::Hits;
use plan::Plan;
use rayweave_model::{
    Crossing, Evaluator, FirstHits, HitRows, Limit, Program, Query, RayAnswer, Rays, RegionId, Sink, Window,
    dress,
};
use rayweave_shape::lanes::{LANES, Lanes, splat};
use std::sync::Arc;

/// The evaluator for daily use: lanes where they are sure, [`Weave`] elsewhere.
#[derive(Clone, Debug)]
pub struct Packets {
    weave: Weave,
    plan: Option<Plan>,
    level: Level,
}

/// Memory of a thread.
#[derive(Clone, Debug, Default)]
pub struct PacketsScratch {
    weave: WeaveScratch,
    memory: Option<Box<Memory>>,
    crossings: Vec<Crossing>,
}

impl Packets {
    /// An evaluator of a compiled model.
    pub fn new(program: Arc<Program>) -> Packets {
        Packets::with_level(program, Level::new())
    }

    /// The same with instructions of a given level, for comparisons: the answers do not depend on it.
    pub fn with_level(program: Arc<Program>, level: Level) -> Packets {
        Packets { plan: Plan::new(&program), weave: Weave::new(program), level }
    }

    /// True if the model is one for lanes.
    pub fn uses_lanes(&self) -> bool {
        self.plan.is_some()
    }
}

/// Takes what was found on the rays `at..at + count`.
trait Take {
    fn take<S: Simd>(&mut self, plan: &Plan, group: &Group<'_, S>, found: &Found, at: usize, count: usize);
}

#[inline(always)]
fn run<S: Simd, T: Take>(
    simd: S,
    plan: &Plan,
    memory: &mut Memory,
    rays: Rays<'_>,
    window: Window,
    first: bool,
    take: &mut T,
) {
    let mut group = Group::new(simd, memory);
    for at in (0..rays.len()).step_by(LANES) {
        let found = group.run(plan, rays, at, window, first);
        take.take(plan, &group, &found, at, LANES.min(rays.len() - at));
    }
}

/// Asks the weave about a ray.
fn one_by_one(
    weave: &Weave,
    rays: Rays<'_>,
    ray: usize,
    query: &Query<'_>,
    scratch: &mut WeaveScratch,
    mut answer: impl FnMut(RayAnswer<'_>),
) {
    let [ox, oy, oz] = rays.origins.map(|column| &column[ray..=ray]);
    let [dx, dy, dz] = rays.directions.map(|column| &column[ray..=ray]);
    let one = Rays { origins: [ox, oy, oz], directions: [dx, dy, dz] };
    weave.crossings(one, query, scratch, &mut |found: RayAnswer<'_>| answer(RayAnswer { ray, ..found }));
}

/// Lists of crossings.
struct Lists<'a> {
    weave: &'a Weave,
    rays: Rays<'a>,
    query: &'a Query<'a>,
    scratch: &'a mut PacketsScratch,
    sink: &'a mut dyn Sink,
}

impl Take for Lists<'_> {
    #[inline(always)]
    fn take<S: Simd>(&mut self, plan: &Plan, group: &Group<'_, S>, found: &Found, at: usize, count: usize) {
        for lane in 0..count {
            let ray = at + lane;
            if found.doubt >> lane & 1 == 1 {
                let PacketsScratch { weave, .. } = &mut *self.scratch;
                one_by_one(self.weave, self.rays, ray, self.query, weave, |answer| self.sink.ray(answer));
                continue;
            }
            let crossings = &mut self.scratch.crossings;
            let start = list(self.weave.program(), plan, group, found, lane, self.query.limit, crossings);
            self.sink.ray(RayAnswer { ray, start, crossings });
        }
    }
}

/// The crossings of a lane and the region that it starts in.
#[inline(always)]
fn list<S: Simd>(
    program: &Program,
    plan: &Plan,
    group: &Group<'_, S>,
    found: &Found,
    lane: usize,
    limit: Limit,
    crossings: &mut Vec<Crossing>,
) -> RegionId {
    crossings.clear();
    let start = RegionId(found.starts[lane] as u32);
    let mut before = start;
    for k in 0..found.most {
        let Some(code) = group.code(k, lane) else { break };
        let (t, face) =
            (group.memory.ends[code].0[lane], plan.faces[group.memory.faces[code].0[lane] as usize]);
        let after = if plan.is_plain { RegionId(1 - before.0) } else { winner_after(plan, group, lane, t) };
        if plan.is_plain || program.medium_of(before) != program.medium_of(after) {
            crossings.push(Crossing { t, face, left: face, entered: face, before, after });
            if limit == Limit::First {
                break;
            }
        }
        before = after;
    }
    start
}

fn winner_after<S: Simd>(plan: &Plan, group: &Group<'_, S>, lane: usize, t: f64) -> RegionId {
    let held = plan.regions.evaluate(group.holds_after(plan, lane, t));
    RegionId(held.iter().rposition(|&inside| inside).map_or(0, |k| k as u32 + 1))
}

/// Hit arrays.
struct Arrays<'a, 'r, 'c> {
    weave: &'a Weave,
    rays: Rays<'a>,
    query: Query<'a>,
    scratch: &'a mut PacketsScratch,
    rows: &'a mut HitRows<'r, 'c>,
    most: usize,
}

impl Take for Arrays<'_, '_, '_> {
    #[inline(always)]
    fn take<S: Simd>(&mut self, plan: &Plan, group: &Group<'_, S>, found: &Found, at: usize, count: usize) {
        let is_simple = plan.is_plain && found.starts == [0.0; LANES];
        if is_simple && found.doubt == 0 {
            self.most = self.most.max(found.most);
            return self.columns(group, found, at, count);
        }
        for lane in 0..count {
            let ray = at + lane;
            if found.doubt >> lane & 1 == 1 {
                let (rows, most) = (&mut *self.rows, &mut self.most);
                let program = self.weave.program();
                one_by_one(self.weave, self.rays, ray, &self.query, &mut self.scratch.weave, |answer| {
                    *most = (*most).max(rows.put(program, &answer));
                });
                continue;
            }
            let program = self.weave.program();
            let crossings = &mut self.scratch.crossings;
            let start = list(program, plan, group, found, lane, Limit::All, crossings);
            self.most = self.most.max(self.rows.put(program, &RayAnswer { ray, start, crossings }));
        }
    }
}

impl Arrays<'_, '_, '_> {
    /// Rays that start outside, all of them sure.
    #[inline(always)]
    fn columns<S: Simd>(&mut self, group: &Group<'_, S>, found: &Found, at: usize, count: usize) {
        for (k, row) in self.rows.times.iter_mut().enumerate() {
            let row = &mut row[at..at + count];
            if k >= found.most {
                row.fill(f64::INFINITY);
                continue;
            }
            for (lane, t) in row.iter_mut().enumerate() {
                *t = group.code(k, lane).map_or(f64::INFINITY, |code| group.memory.ends[code].0[lane]);
            }
        }
        for (k, row) in self.rows.faces.iter_mut().enumerate() {
            let row = &mut row[at..at + count];
            if k >= found.most {
                row.fill(-1);
                continue;
            }
            for (lane, face) in row.iter_mut().enumerate() {
                *face = group.code(k, lane).map_or(-1, |code| group.memory.faces[code].0[lane] as i32);
            }
        }
    }
}

/// First hits.
struct Firsts<'a, 'c> {
    weave: &'a Weave,
    rays: Rays<'a>,
    query: Query<'a>,
    scratch: &'a mut PacketsScratch,
    hits: &'a mut FirstHits<'c>,
}

impl Take for Firsts<'_, '_> {
    #[inline(always)]
    fn take<S: Simd>(&mut self, plan: &Plan, group: &Group<'_, S>, found: &Found, at: usize, count: usize) {
        if plan.is_plain && found.doubt == 0 && count == LANES {
            return self.columns(plan, group, found, at);
        }
        let program = self.weave.program();
        for lane in 0..count {
            let ray = at + lane;
            if found.doubt >> lane & 1 == 1 {
                let (rays, hits) = (&self.rays, &mut *self.hits);
                one_by_one(self.weave, self.rays, ray, &self.query, &mut self.scratch.weave, |answer| {
                    hits.put(program, rays, &answer);
                });
                continue;
            }
            let crossings = &mut self.scratch.crossings;
            let start = list(program, plan, group, found, lane, Limit::First, crossings);
            self.hits.put(program, &self.rays, &RayAnswer { ray, start, crossings });
        }
    }
}

impl Firsts<'_, '_> {
    /// Eight rays, all of them sure.
    #[inline(always)]
    fn columns<S: Simd>(&mut self, plan: &Plan, group: &Group<'_, S>, found: &Found, at: usize) {
        let (mut t, mut face, mut hit) = (Row([f64::INFINITY; LANES]), Row([-1.0; LANES]), 0);
        for lane in 0..LANES {
            if let Some(code) = group.code(0, lane) {
                t.0[lane] = group.memory.ends[code].0[lane];
                face.0[lane] = group.memory.faces[code].0[lane];
                hit |= 1 << lane;
            }
        }
        let here = at..at + LANES;
        let FirstHits { t: times, face: faces, placement, before, after, normal } = &mut *self.hits;
        times[here.clone()].copy_from_slice(&t.0);
        placement[here.clone()].fill(0);
        let (faces, before, after) =
            (&mut faces[here.clone()], &mut before[here.clone()], &mut after[here.clone()]);
        for lane in 0..LANES {
            faces[lane] = face.0[lane] as i32;
            before[lane] = found.starts[lane] as u32;
            after[lane] = before[lane] ^ (hit >> lane & 1) as u32;
        }
        let Some([x, y, z]) = normal else { return };
        let simd = group.simd;
        let starts = Lanes::load_array(simd, found.starts);
        let leaves = starts.simd_gt(splat(simd, 0.0));
        let (origin, direction) = (load(simd, self.rays.origins, at), load(simd, self.rays.directions, at));
        let hits = Hits { origin, direction, t: Lanes::load_array_ref(simd, &t.0), face, leaves, hit };
        let (normals, mut others) = hits.normals(simd, &plan.slopes);
        normals.x.store_slice(&mut x[here.clone()]);
        normals.y.store_slice(&mut y[here.clone()]);
        normals.z.store_slice(&mut z[here]);
        while others != 0 {
            let lane = others.trailing_zeros() as usize;
            others &= others - 1;
            let face = plan.faces[face.0[lane] as usize];
            let [from, to] = [before[lane], after[lane]].map(RegionId);
            let crossing =
                Crossing { t: t.0[lane], face, left: face, entered: face, before: from, after: to };
            let ray = self.rays.get(at + lane);
            let normal = dress::normal(self.weave.program(), &ray, &crossing);
            (x[at + lane], y[at + lane], z[at + lane]) = (normal.x, normal.y, normal.z);
        }
    }
}

impl Evaluator for Packets {
    type Scratch = PacketsScratch;

    fn name(&self) -> &'static str {
        "packets"
    }

    fn program(&self) -> &Program {
        self.weave.program()
    }

    fn scratch(&self) -> PacketsScratch {
        PacketsScratch::default()
    }

    fn crossings(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut PacketsScratch,
        sink: &mut dyn Sink,
    ) {
        let Some(plan) = self.plan.as_ref().filter(|_| query.starts.is_none()) else {
            return self.weave.crossings(rays, query, &mut scratch.weave, sink);
        };
        // the first change of region need not be one of medium
        let first = query.limit == Limit::First && plan.is_plain;
        let mut memory = scratch.memory.take().unwrap_or_default();
        let mut take = Lists { weave: &self.weave, rays, query, scratch, sink };
        dispatch!(self.level, simd => run(simd, plan, &mut memory, rays, query.window, first, &mut take));
        scratch.memory = Some(memory);
    }

    fn hits(
        &self,
        rays: Rays<'_>,
        window: Window,
        scratch: &mut PacketsScratch,
        rows: &mut HitRows<'_, '_>,
    ) -> usize {
        let Some(plan) = &self.plan else {
            return self.weave.hits(rays, window, &mut scratch.weave, rows);
        };
        let query = Query { window, ..Query::default() };
        let mut memory = scratch.memory.take().unwrap_or_default();
        let mut take = Arrays { weave: &self.weave, rays, query, scratch, rows, most: 0 };
        dispatch!(self.level, simd => run(simd, plan, &mut memory, rays, window, false, &mut take));
        let most = take.most;
        scratch.memory = Some(memory);
        most
    }

    fn nearest(
        &self,
        rays: Rays<'_>,
        window: Window,
        scratch: &mut PacketsScratch,
        hits: &mut FirstHits<'_>,
    ) {
        let Some(plan) = &self.plan else {
            return self.weave.nearest(rays, window, &mut scratch.weave, hits);
        };
        let query = Query { window, limit: Limit::First, starts: None };
        let mut memory = scratch.memory.take().unwrap_or_default();
        let mut take = Firsts { weave: &self.weave, rays, query, scratch, hits };
        dispatch!(self.level, simd => run(simd, plan, &mut memory, rays, window, plan.is_plain, &mut take));
        scratch.memory = Some(memory);
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut PacketsScratch, out: &mut [RegionId]) {
        self.weave.regions_at(points, &mut scratch.weave, out);
    }
}
