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
mod objects;
mod plan;

use crate::Weave;
use crate::weave::WeaveScratch;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use group::{Found, Group, Memory, Row, load, whole};
use normal::Hits;
use objects::Objects;
use plan::{Common, Plan};
use rayweave_model::{
    Crossing, Evaluator, FirstHits, HitRows, Limit, Program, Query, RayAnswer, Rays, RegionId, Sink, Window,
    dress,
};
use rayweave_shape::lanes::{LANES, Lanes, splat};
use std::sync::Arc;

/// Up to so many comparisons of stretches a model is asked as a whole for lists; beyond that the weave is faster.
const TOGETHER: usize = 256;

/// From so many comparisons on the solids of a union are asked one by one for first hits.
const APART: usize = 64;

/// The evaluator for daily use: lanes where they are sure, [`Weave`] elsewhere.
#[derive(Clone, Debug)]
pub struct Packets {
    weave: Weave,
    plan: Option<Box<Plan>>,
    objects: Option<Box<Objects>>,
    level: Level,
}

/// Memory of a thread.
#[derive(Clone, Debug, Default)]
pub struct PacketsScratch {
    weave: WeaveScratch,
    memory: Option<Box<Memory>>,
    stack: Vec<u32>,
    crossings: Vec<Crossing>,
}

impl Packets {
    /// An evaluator of a compiled model.
    pub fn new(program: Arc<Program>) -> Packets {
        Packets::with_level(program, Level::new())
    }

    /// The same with instructions of a given level, for comparisons: the answers do not depend on it.
    pub fn with_level(program: Arc<Program>, level: Level) -> Packets {
        let model = Common::new(&program);
        let plan = model.as_ref().and_then(|model| Plan::new(&program, model));
        let comparisons = plan.as_ref().map_or(usize::MAX, Plan::comparisons);
        let objects = model.as_ref().filter(|_| comparisons > APART);
        let objects = objects.and_then(|model| Objects::new(&program, model));
        let plan = plan.filter(|_| comparisons <= TOGETHER);
        Packets {
            plan: plan.map(Box::new),
            objects: objects.map(Box::new),
            weave: Weave::new(program),
            level,
        }
    }

    /// True if the model is one for lanes.
    pub fn uses_lanes(&self) -> bool {
        self.plan.is_some() || self.objects.is_some()
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
        let (t, face) = (
            group.memory.ends[code].0[lane],
            plan.model.faces[whole(group.memory.faces[code].0[lane]) as usize],
        );
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
    RegionId(plan.regions.winner(group.holds_after(plan, lane, t)))
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
                *face = group.code(k, lane).map_or(-1, |code| whole(group.memory.faces[code].0[lane]));
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
                self.put_one(ray);
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
        let (mut t, mut face) = (Row([f64::INFINITY; LANES]), Row([-1.0; LANES]));
        let mut after = Row(found.starts);
        for lane in 0..LANES {
            if let Some(code) = group.code(0, lane) {
                t.0[lane] = group.memory.ends[code].0[lane];
                face.0[lane] = group.memory.faces[code].0[lane];
                after.0[lane] = 1.0 - after.0[lane];
            }
        }
        self.write(group.simd, &plan.model, at, [t, face], [Row(found.starts), after]);
    }

    /// Writes eight answers: times and faces, regions before and after.
    #[inline(always)]
    fn write<S: Simd>(
        &mut self,
        simd: S,
        model: &Common,
        at: usize,
        [t, face]: [Row; 2],
        [before, after]: [Row; 2],
    ) {
        let here = at..at + LANES;
        let hits = &mut *self.hits;
        hits.t[here.clone()].copy_from_slice(&t.0);
        hits.placement[here.clone()].fill(0);
        let faces = &mut hits.face[here.clone()];
        let (befores, afters) = (&mut hits.before[here.clone()], &mut hits.after[here.clone()]);
        for lane in 0..LANES {
            faces[lane] = whole(face.0[lane]);
            befores[lane] = whole(before.0[lane]) as u32;
            afters[lane] = whole(after.0[lane]) as u32;
        }
        let Some([x, y, z]) = &mut hits.normal else { return };
        let zero = splat(simd, 0.0);
        let leaves = Lanes::load_array_ref(simd, &after.0).simd_le(zero);
        let hit = Lanes::load_array_ref(simd, &face.0).simd_ge(zero).to_bitmask();
        let (origin, direction) = (load(simd, self.rays.origins, at), load(simd, self.rays.directions, at));
        let found = Hits { origin, direction, t: Lanes::load_array_ref(simd, &t.0), face, leaves, hit };
        let (normals, mut others) = found.normals(simd, &model.slopes);
        normals.x.store_slice(&mut x[here.clone()]);
        normals.y.store_slice(&mut y[here.clone()]);
        normals.z.store_slice(&mut z[here]);
        while others != 0 {
            let lane = others.trailing_zeros() as usize;
            others &= others - 1;
            let face = model.faces[face.0[lane] as usize];
            let [before, after] = [before, after].map(|row| RegionId(row.0[lane] as u32));
            let crossing = Crossing { t: t.0[lane], face, left: face, entered: face, before, after };
            let normal = dress::normal(self.weave.program(), &self.rays.get(at + lane), &crossing);
            (x[at + lane], y[at + lane], z[at + lane]) = (normal.x, normal.y, normal.z);
        }
    }

    /// What rays meet first among many solids.
    #[inline(always)]
    fn among<S: Simd>(&mut self, simd: S, objects: &Objects, memory: &mut Memory, stack: &mut Vec<u32>) {
        let mut group = Group::new(simd, memory);
        for at in (0..self.rays.len()).step_by(LANES) {
            let count = LANES.min(self.rays.len() - at);
            let whole = count == LANES;
            let first = match whole {
                true => objects.first(&mut group, stack, self.rays, at, self.query.window),
                false => None,
            };
            if let Some(first) = &first {
                let outside = Row([0.0; LANES]);
                self.write(simd, &objects.model, at, [first.t, first.face], [outside, first.region]);
            }
            let doubt = first.map_or(!0, |first| first.doubt);
            for lane in (0..count).filter(|lane| doubt >> lane & 1 == 1) {
                self.put_one(at + lane);
            }
        }
    }

    /// Asks the weave about a ray.
    fn put_one(&mut self, ray: usize) {
        let (rays, hits, program) = (&self.rays, &mut *self.hits, self.weave.program());
        one_by_one(self.weave, self.rays, ray, &self.query, &mut self.scratch.weave, |answer| {
            hits.put(program, rays, &answer);
        });
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
        let query = Query { window, limit: Limit::First, starts: None };
        if let Some(objects) = &self.objects {
            let mut memory = scratch.memory.take().unwrap_or_default();
            let mut stack = std::mem::take(&mut scratch.stack);
            let mut firsts = Firsts { weave: &self.weave, rays, query, scratch, hits };
            dispatch!(self.level, simd => firsts.among(simd, objects, &mut memory, &mut stack));
            (scratch.memory, scratch.stack) = (Some(memory), stack);
            return;
        }
        let Some(plan) = &self.plan else {
            return self.weave.nearest(rays, window, &mut scratch.weave, hits);
        };
        let mut memory = scratch.memory.take().unwrap_or_default();
        let mut take = Firsts { weave: &self.weave, rays, query, scratch, hits };
        dispatch!(self.level, simd => run(simd, plan, &mut memory, rays, window, plan.is_plain, &mut take));
        scratch.memory = Some(memory);
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut PacketsScratch, out: &mut [RegionId]) {
        self.weave.regions_at(points, &mut scratch.weave, out);
    }
}
