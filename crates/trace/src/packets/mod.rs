//! Evaluator for small models: a bundle of eight rays is processed at a time, one ray per SIMD lane.
//!
//! Along a ray a leaf is a span from one time to another, less the gaps that some facets cut out. An end of a
//! span is a crossing if the boolean function of the *other* spans at that time makes it one: comparisons and
//! masks, no sweep and no branch. The number of comparisons grows with the square of the number of leaves. For
//! first hits, larger models are therefore decomposed if they are unions of solids, placed or not, each of
//! which is small or carved (`carved`); in unions of leaves, the hits of rays that are far apart are found with
//! a ray and a leaf of its own in each lane (`shapes/first`). All crossings with a union of placed solids are found ray by ray, with
//! eight copies of a solid in the lanes (`objects/copies`), and all crossings with other large models with eight leaves in the lanes
//! (`shapes`). [`Weave`] traces all other models. It also traces each
//! ray whose lane is uncertain: two events occur at the same time, two crossings are so close that they may have to be welded,
//! or the ray may lie in a face.

mod carved;
mod group;
mod hit_block;
mod logic;
mod network;
mod normal;
mod objects;
mod places;
mod plan;
mod remainder;
mod shapes;
mod starts;

use crate::Weave;
use crate::weave::WeaveScratch;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd};
use group::{BundleEvaluation, Found, Memory, Row, WHOLE, load};
use hit_block::HitBlock;
use normal::{Hits, Slopes};
use objects::{CopiesScratch, First, Objects, Walk};
use plan::{APART, Common, LARGE, Plan, SMALL};
use rayweave_bvh::BundleTraversal;
use rayweave_math::Vec3;
use rayweave_model::{
    BoxCells, Crossing, Evaluator, Face, FirstHits, HitArrayRows, Limit, Program, Query, RayAnswer, Rays,
    RegionId, Sink, StartLists, Window, attributes,
};
use rayweave_shape::dispatch_wide;
use rayweave_shape::lanes::{LANES, Lanes, Mask, Vec3Lanes, WideLevel, splat};
use shapes::{Listed, Shapes, ShapesScratch};
use starts::Begin;
use std::sync::{Arc, OnceLock};

/// Number of span comparisons above which the weave computes lists of crossings faster than a plan of the
/// whole model.
const TOGETHER: usize = 256;

/// Number of rays after which copies of solids are left to the weave if most of these rays were.
const FIRST_RAYS: usize = 16;

/// The default evaluator: eight rays at a time where lanes are certain, [`Weave`] for the rest.
///
/// Without a [`WideLevel`], [`Weave`] traces all rays.
#[derive(Clone, Debug)]
pub struct Packets {
    weave: Weave,
    plan: Option<Box<Plan>>,
    /// For rays that start outside of all solids.
    objects: Option<Arc<Objects>>,
    /// For rays that may start inside.
    layers: Option<Arc<Objects>>,
    /// For all crossings with copies of solids.
    copies: Option<Arc<Objects>>,
    /// For all crossings with large models of shapes: made on first use, as first hits and pictures do without.
    shapes: OnceLock<Option<Arc<Shapes>>>,
    level: Option<WideLevel>,
}

/// Scratch memory of a thread for [`Packets`].
#[derive(Clone, Debug, Default)]
pub struct PacketsScratch {
    weave: WeaveScratch,
    memory: Option<Box<Memory>>,
    ahead: [BundleTraversal; 2],
    walk: Walk,
    copies: CopiesScratch,
    shapes: ShapesScratch,
    hit_block: HitBlock,
    crossings: Vec<Crossing>,
}

impl PacketsScratch {
    /// Number of leaves that [`Weave`] has intersected with this scratch: on uncertain lanes, and on all rays
    /// where the model has no plan for lanes.
    pub fn fallback_leaf_count(&self) -> u64 {
        self.weave.intersected_leaves()
    }
}

impl Packets {
    /// An evaluator of a compiled model.
    pub fn new(program: Arc<Program>) -> Packets {
        Packets::with_level(program, Level::new())
    }

    /// An evaluator with a given SIMD instruction set, for comparisons. The answers do not depend on it.
    pub fn with_level(program: Arc<Program>, level: Level) -> Packets {
        let level = WideLevel::of_level(level);
        let model = level.and_then(|_| Common::new(&program));
        let plan = model.as_ref().and_then(|model| Plan::new(&program, model));
        let comparisons = plan.as_ref().map_or(usize::MAX, Plan::comparisons);
        let objects = model.as_ref().filter(|_| comparisons > APART || program.regions().len() > 1);
        let objects = objects.and_then(|model| Objects::new(&program, model)).map(Arc::new);
        let layers = objects.clone().filter(|objects| objects.is_layered());
        let copies = objects.clone().filter(|objects| plan.is_none() && objects.has_copies());
        // measured: among more solids, first hits of rays that are far apart take the weave less time
        let objects = objects.filter(|objects| objects.count() <= LARGE);
        let objects =
            objects.filter(|objects| comparisons > SMALL || (comparisons > APART && objects.count() > 1));
        let plan = plan.filter(|_| comparisons <= TOGETHER);
        let plan = plan.map(Box::new);
        let shapes = OnceLock::new();
        Packets { plan, objects, layers, copies, shapes, weave: Weave::new(program), level }
    }

    /// All crossings of rays with copies of solids.
    fn among_copies(
        &self,
        objects: &Objects,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut PacketsScratch,
        mut answer: impl FnMut(RayAnswer<'_>),
    ) {
        let Some(level) = self.level else { return };
        let PacketsScratch { weave, memory, copies, crossings, .. } = scratch;
        let memory = memory.get_or_insert_default();
        // where copies overlap, the search in lanes is in vain
        let (mut traced, mut uncertain) = (0, 0);
        for ray in 0..rays.len() {
            let line = (rays.get(ray), query.window);
            let start = match 2 * uncertain > traced + FIRST_RAYS {
                true => None,
                false => dispatch_wide!(level, simd => {
                    objects.list((simd, &mut *memory), &self.weave, line, copies, crossings)
                }),
            };
            traced += 1;
            match start {
                Some(start) => answer(RayAnswer { ray, start, crossings }),
                None => {
                    uncertain += 1;
                    one_by_one(&self.weave, rays, ray, query, weave, &mut answer);
                }
            }
        }
    }

    /// The tables for all crossings with a large model of shapes; `None` for other models.
    fn shapes(&self) -> Option<&Shapes> {
        if self.level.is_none() || self.plan.is_some() || self.copies.is_some() {
            return None;
        }
        self.shapes.get_or_init(|| Shapes::new(self.weave.program()).map(Arc::new)).as_deref()
    }

    /// The tables for the first hits of rays that are far apart in a union of shapes; `None` for other models.
    fn shapes_with_first_hits(&self) -> Option<&Shapes> {
        self.shapes().filter(|shapes| shapes.finds_first_hits())
    }

    /// All crossings of rays with a large model of shapes.
    fn among_shapes(
        &self,
        shapes: &Shapes,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut PacketsScratch,
        take: &mut impl TakeShapes,
    ) {
        let Some(level) = self.level else { return };
        for at in (0..rays.len()).step_by(LANES) {
            dispatch_wide!(level, simd => {
                let prepared = shapes.prepare(simd, rays, at);
                for ray in at..rays.len().min(at + LANES) {
                    let starts = query.starts.map_or(&[][..], |lists| lists.of(ray));
                    let line = (rays.get(ray), query, starts);
                    let PacketsScratch { shapes: own, weave, .. } = &mut *scratch;
                    match shapes.list(simd, &self.weave, (&prepared, ray - at), line, (own, weave)) {
                        Some(Listed::Counted(starts_inside)) => {
                            take.changes(shapes, ray, starts_inside, &scratch.shapes.changes);
                        }
                        Some(Listed::Swept(start)) => {
                            take.answer(RayAnswer { ray, start, crossings: &scratch.weave.crossings });
                        }
                        None => one_by_one(&self.weave, rays, ray, query, weave, |answer| take.answer(answer)),
                    }
                }
            });
        }
    }

    /// True if the model is traced in lanes of eight rays.
    pub fn uses_lanes(&self) -> bool {
        self.plan.is_some()
            || self.objects.is_some()
            || self.layers.is_some()
            || self.copies.is_some()
            || self.shapes().is_some()
    }
}

/// Receives the crossings of rays with a large model of shapes.
trait TakeShapes {
    /// The times of the changes of a ray that starts inside or outside, each with its event.
    fn changes(&mut self, shapes: &Shapes, ray: usize, starts_inside: bool, changes: &[(f64, u64)]);
    /// Any other answer.
    fn answer(&mut self, answer: RayAnswer<'_>);
}

/// Receiver for lists of crossings.
struct ShapeLists<'a> {
    program: &'a Program,
    sink: &'a mut dyn Sink,
    crossings: Vec<Crossing>,
}

impl TakeShapes for ShapeLists<'_> {
    fn changes(&mut self, shapes: &Shapes, ray: usize, starts_inside: bool, changes: &[(f64, u64)]) {
        let start = RegionId(u32::from(starts_inside));
        let mut before = start;
        self.crossings.clear();
        self.crossings.extend(changes.iter().map(|&(t, event)| {
            let face = shapes.face(self.program, event);
            let after = RegionId(1 - before.0);
            let before = std::mem::replace(&mut before, after);
            Crossing { t, face, left: face, entered: face, before, after }
        }));
        self.sink.ray(RayAnswer { ray, start, crossings: &self.crossings });
    }

    fn answer(&mut self, answer: RayAnswer<'_>) {
        self.sink.ray(answer);
    }
}

/// Receiver for hit arrays.
struct ShapeArrays<'a, 'r, 'c> {
    program: &'a Program,
    rows: &'a mut HitArrayRows<'r, 'c>,
    block: HitBlock,
}

impl TakeShapes for ShapeArrays<'_, '_, '_> {
    fn changes(&mut self, shapes: &Shapes, ray: usize, starts_inside: bool, changes: &[(f64, u64)]) {
        let start = starts_inside.then_some((f64::NEG_INFINITY, -1));
        let changes = changes.iter().map(|&(t, event)| (t, shapes.face_number(event) as i32));
        self.block.put(ray, start.into_iter().chain(changes), self.rows);
    }

    fn answer(&mut self, answer: RayAnswer<'_>) {
        self.block.put(answer.ray, HitArrayRows::entries(self.program, &answer), self.rows);
    }
}

/// Receives the results of the rays `at..at + count`.
trait Take {
    fn take<S: Simd>(
        &mut self,
        plan: &Plan,
        group: &BundleEvaluation<'_, S>,
        found: &Found,
        at: usize,
        count: usize,
    );
}

#[inline(always)]
fn run<S: Simd, T: Take>(
    simd: S,
    plan: &Plan,
    memory: &mut Memory,
    rays: Rays<'_>,
    query: &Query<'_>,
    first: bool,
    take: &mut T,
) {
    let mut group = BundleEvaluation::new(simd, memory);
    for at in (0..rays.len()).step_by(LANES) {
        let count = LANES.min(rays.len() - at);
        let found = match query.starts {
            None => group.run(plan, rays, at, query.window, first),
            Some(_) => group.run_from(plan, rays, at, &Begin::new(query, at, count), first),
        };
        take.take(plan, &group, &found, at, count);
    }
}

/// Traces one ray with the weave.
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
    let entries = query.starts.map_or(&[][..], |lists| lists.of(ray));
    let first = [0, entries.len() as u32];
    let starts = (!entries.is_empty()).then_some(StartLists { first: &first, entries });
    let query = Query { starts, ..*query };
    weave.crossings(one, &query, scratch, &mut |found: RayAnswer<'_>| answer(RayAnswer { ray, ..found }));
}

/// Receiver for lists of crossings.
struct Lists<'a> {
    weave: &'a Weave,
    rays: Rays<'a>,
    query: &'a Query<'a>,
    scratch: &'a mut PacketsScratch,
    sink: &'a mut dyn Sink,
}

impl Take for Lists<'_> {
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        plan: &Plan,
        group: &BundleEvaluation<'_, S>,
        found: &Found,
        at: usize,
        count: usize,
    ) {
        for lane in 0..count {
            let ray = at + lane;
            if found.uncertain >> lane & 1 == 1 {
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

/// Writes the crossings of a lane. Returns the region in which it starts.
#[inline(always)]
fn list<S: Simd>(
    program: &Program,
    plan: &Plan,
    group: &BundleEvaluation<'_, S>,
    found: &Found,
    lane: usize,
    limit: Limit,
    crossings: &mut Vec<Crossing>,
) -> RegionId {
    crossings.clear();
    let start = RegionId(found.starts[lane] as u32);
    let mut before = start;
    for k in 0..found.most {
        let (t, number) = (group.memory.times[k].0[lane], group.memory.numbers[k][lane]);
        let Ok(number) = usize::try_from(number) else { break };
        let face = plan.model.faces[number];
        let after = if plan.is_plain { RegionId(1 - before.0) } else { owner_after(plan, group, lane, t) };
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

fn owner_after<S: Simd>(plan: &Plan, group: &BundleEvaluation<'_, S>, lane: usize, t: f64) -> RegionId {
    RegionId(plan.owner(group.holds_after(plan, lane, t)))
}

/// Receiver for hit arrays.
struct Arrays<'a, 'r, 'c> {
    weave: &'a Weave,
    rays: Rays<'a>,
    query: Query<'a>,
    scratch: &'a mut PacketsScratch,
    rows: &'a mut HitArrayRows<'r, 'c>,
    most: usize,
}

impl Take for Arrays<'_, '_, '_> {
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        plan: &Plan,
        group: &BundleEvaluation<'_, S>,
        found: &Found,
        at: usize,
        count: usize,
    ) {
        let is_simple = plan.is_plain && found.starts == [0.0; LANES];
        if is_simple && found.uncertain == 0 {
            self.most = self.most.max(found.most);
            return self.columns(group, found, at, count);
        }
        for lane in 0..count {
            let ray = at + lane;
            if found.uncertain >> lane & 1 == 1 {
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
    /// Writes rays that start outside and are all certain.
    #[inline(always)]
    fn columns<S: Simd>(&mut self, group: &BundleEvaluation<'_, S>, found: &Found, at: usize, count: usize) {
        let (simd, memory, HitArrayRows { times, faces }) = (group.simd, &*group.memory, &mut *self.rows);
        let (used, free) = times.split_at_mut(found.most.min(times.len()));
        for (row, times) in used.iter_mut().zip(&memory.times) {
            copy(Lanes::load_array_ref(simd, &times.0), &mut row[at..at + count]);
        }
        for row in free {
            copy(splat(simd, f64::INFINITY), &mut row[at..at + count]);
        }
        let (used, free) = faces.split_at_mut(found.most.min(faces.len()));
        for (row, numbers) in used.iter_mut().zip(&memory.numbers) {
            copy_faces(numbers, &mut row[at..at + count]);
        }
        for row in free {
            copy_faces(&[-1; LANES], &mut row[at..at + count]);
        }
    }
}

/// Receiver for first hits.
struct Firsts<'a, 'c> {
    weave: &'a Weave,
    rays: Rays<'a>,
    query: Query<'a>,
    scratch: &'a mut PacketsScratch,
    hits: &'a mut FirstHits<'c>,
    /// The region in which each ray probably starts: see [`Evaluator::nearest_in`]. Empty without such a guess.
    regions: &'a [u32],
    /// Crossings whose two sides belong to different faces.
    between: &'a mut Vec<(usize, Crossing)>,
}

impl Take for Firsts<'_, '_> {
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        plan: &Plan,
        group: &BundleEvaluation<'_, S>,
        found: &Found,
        at: usize,
        count: usize,
    ) {
        let program = self.weave.program();
        if count == LANES {
            let mut firsts = Eight::nothing(found.starts);
            match plan.is_plain {
                true => plain_firsts(group, found, &mut firsts),
                false => other_firsts(program, plan, group, found, &mut firsts),
            }
            self.columns(plan, group, &firsts, at);
        }
        let mut uncertain = found.uncertain & (!0 >> (64 - count));
        while uncertain != 0 {
            self.put_one(at + uncertain.trailing_zeros() as usize);
            uncertain &= uncertain - 1;
        }
        if count == LANES {
            return;
        }
        for lane in 0..count {
            let ray = at + lane;
            if found.uncertain >> lane & 1 == 0 {
                let crossings = &mut self.scratch.crossings;
                let start = list(program, plan, group, found, lane, Limit::First, crossings);
                self.hits.put(program, &self.rays, &RayAnswer { ray, start, crossings });
            }
        }
    }
}

/// Eight first hits: times and faces, regions before and after, placements.
struct Eight {
    t: Row,
    face: Row,
    before: Row,
    after: Row,
    placement: Row,
}

impl Eight {
    /// Eight misses.
    #[inline(always)]
    fn nothing(starts: [f64; LANES]) -> Eight {
        let (t, face) = (Row([f64::INFINITY; LANES]), Row([-1.0; LANES]));
        Eight { t, face, before: Row(starts), after: Row(starts), placement: Row([0.0; LANES]) }
    }
}

/// First hits in a model of one region; uncertain lanes are misses.
#[inline(always)]
fn plain_firsts<S: Simd>(group: &BundleEvaluation<'_, S>, found: &Found, eight: &mut Eight) {
    let simd = group.simd;
    let is_hit = group.time(0).simd_lt(f64::INFINITY) & Mask::from_bitmask(simd, !found.uncertain);
    let face = Lanes::load_array_ref(simd, &group.memory.face.0);
    let starts = Lanes::load_array_ref(simd, &found.starts);
    is_hit.select(group.time(0), splat(simd, f64::INFINITY)).store_array(&mut eight.t.0);
    is_hit.select(face, splat(simd, -1.0)).store_array(&mut eight.face.0);
    is_hit.select(splat(simd, 1.0) - starts, starts).store_array(&mut eight.after.0);
}

/// First hits in a model of several regions; uncertain lanes are misses.
fn other_firsts<S: Simd>(
    program: &Program,
    plan: &Plan,
    group: &BundleEvaluation<'_, S>,
    found: &Found,
    eight: &mut Eight,
) {
    for lane in (0..LANES).filter(|lane| found.uncertain >> lane & 1 == 0) {
        let mut before = RegionId(found.starts[lane] as u32);
        for k in 0..found.most {
            let (t, number) = (group.memory.times[k].0[lane], group.memory.numbers[k][lane]);
            if number < 0 {
                break;
            }
            let after = owner_after(plan, group, lane, t);
            if program.medium_of(before) != program.medium_of(after) {
                (eight.t.0[lane], eight.face.0[lane]) = (t, f64::from(number));
                (eight.before.0[lane], eight.after.0[lane]) = (f64::from(before.0), f64::from(after.0));
                break;
            }
            before = after;
        }
    }
}

impl Firsts<'_, '_> {
    /// Writes eight rays; the caller overwrites uncertain lanes.
    #[inline(always)]
    fn columns<S: Simd>(&mut self, plan: &Plan, group: &BundleEvaluation<'_, S>, eight: &Eight, at: usize) {
        self.write(group.simd, eight, at, LANES);
        if self.hits.normal.is_some() {
            let hits = self.hits(group.simd, eight, at);
            let (normals, others) = hits.normals(group.simd, &plan.model.slopes);
            self.write_normals(normals, at, LANES);
            self.write_attributes(others, at, |lane| plan.model.faces[eight.face.0[lane] as usize]);
        }
    }

    /// Writes everything but the normals.
    #[inline(always)]
    fn write<S: Simd>(&mut self, simd: S, eight: &Eight, at: usize, count: usize) {
        let here = at..at + count;
        let hits = &mut *self.hits;
        copy(Lanes::load_array_ref(simd, &eight.t.0), &mut hits.t[here.clone()]);
        copy_numbers(whole_lanes(simd, &eight.face), &mut hits.face[here.clone()], |number| number as i32);
        copy_numbers(whole_lanes(simd, &eight.before), &mut hits.before[here.clone()], |number| number);
        copy_numbers(whole_lanes(simd, &eight.after), &mut hits.after[here.clone()], |number| number);
        copy_numbers(whole_lanes(simd, &eight.placement), &mut hits.placement[here], |number| number);
    }

    /// The input of the normals.
    #[inline(always)]
    fn hits<S: Simd>(&self, simd: S, eight: &Eight, at: usize) -> Hits<S> {
        let zero = splat(simd, 0.0);
        let leaves = Lanes::load_array_ref(simd, &eight.after.0).simd_le(zero);
        let hit = Lanes::load_array_ref(simd, &eight.face.0).simd_ge(zero).to_bitmask();
        let (origin, direction) = (load(simd, self.rays.origins, at), load(simd, self.rays.directions, at));
        let t = Lanes::load_array_ref(simd, &eight.t.0);
        Hits { origin, direction, t, face: eight.face, leaves, hit }
    }

    #[inline(always)]
    fn write_normals<S: Simd>(&mut self, normals: Vec3Lanes<S>, at: usize, count: usize) {
        let Some([x, y, z]) = &mut self.hits.normal else { return };
        copy(normals.x, &mut x[at..at + count]);
        copy(normals.y, &mut y[at..at + count]);
        copy(normals.z, &mut z[at..at + count]);
    }

    /// Computes the normals of some lanes one by one, from their hits, which have already been written.
    fn write_attributes(&mut self, mut lanes: u64, at: usize, face: impl Fn(usize) -> Face) {
        let Some([x, y, z]) = &mut self.hits.normal else { return };
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let (ray, face) = (at + lane, face(lane));
            let [before, after] = [self.hits.before[ray], self.hits.after[ray]].map(RegionId);
            let crossing = Crossing { t: self.hits.t[ray], face, left: face, entered: face, before, after };
            let normal = attributes::normal(self.weave.program(), &self.rays.get(ray), &crossing);
            (x[ray], y[ray], z[ray]) = (normal.x, normal.y, normal.z);
        }
    }

    /// First hits among many solids.
    #[inline(always)]
    fn among<S: Simd>(
        &mut self,
        simd: S,
        (objects, packets): (&Objects, &Packets),
        memory: &mut Memory,
        ahead: &mut [BundleTraversal; 2],
    ) {
        let mut group = BundleEvaluation::new(simd, memory);
        for at in (0..self.rays.len()).step_by(LANES) {
            let count = LANES.min(self.rays.len() - at);
            if objects.are_apart(simd, self.rays, at)
                && let Some(shapes) = packets.shapes_with_first_hits()
            {
                self.alone(simd, (shapes, Some(&objects.model.slopes)), at, count);
                continue;
            }
            let program = self.weave.program();
            let first = objects.first(&mut group, ahead, program, self.rays, at, self.query.window);
            self.put_first(simd, objects, &first, at, count);
            for lane in (0..count).filter(|lane| first.uncertain >> lane & 1 == 1) {
                self.put_one(at + lane);
            }
        }
    }

    /// First hits of rays in a union of leaves, each ray on its own. A separate function, since it has two callers.
    fn alone<S: Simd>(&mut self, simd: S, tables: (&Shapes, Option<&Slopes>), at: usize, count: usize) {
        simd.vectorize(
            #[inline(always)]
            || self.alone_here(simd, tables, at, count),
        );
    }

    #[inline(always)]
    fn alone_here<S: Simd>(
        &mut self,
        simd: S,
        (shapes, slopes): (&Shapes, Option<&Slopes>),
        at: usize,
        count: usize,
    ) {
        let (rays, window) = (self.rays, self.query.window);
        let found = shapes.first_hits(simd, self.weave, rays, (at, count), window, &mut self.scratch.shapes);
        let mut eight = Eight::nothing([0.0; LANES]);
        eight.t = found.t;
        let mut hits = 0;
        for lane in (0..count).filter(|&lane| found.t.0[lane] < f64::INFINITY) {
            eight.face.0[lane] = f64::from(shapes.face_number(found.codes[lane]));
            eight.after.0[lane] = 1.0;
            hits |= 1 << lane;
        }
        self.write(simd, &eight, at, count);
        if self.hits.normal.is_some() {
            let (normals, others) = match slopes {
                Some(slopes) => self.hits(simd, &eight, at).normals(simd, slopes),
                None => (Vec3Lanes::splat(simd, Vec3::NAN), hits),
            };
            self.write_normals(normals, at, count);
            let program = self.weave.program();
            self.write_attributes(others & hits & !found.uncertain, at, |lane| {
                shapes.face(program, found.codes[lane])
            });
        }
        for lane in (0..count).filter(|lane| found.uncertain >> lane & 1 == 1) {
            self.put_one(at + lane);
        }
    }

    /// Writes first hits among many solids; the caller overwrites uncertain lanes.
    #[inline(always)]
    fn put_first<S: Simd>(&mut self, simd: S, objects: &Objects, first: &First, at: usize, count: usize) {
        let First { t, face, before, region: after, placement, .. } = *first;
        let eight = Eight { t, face, before, after, placement };
        self.write(simd, &eight, at, count);
        if self.hits.normal.is_some() {
            let hits = self.hits(simd, &eight, at);
            let (normals, others) = objects.normals(simd, self.weave.program(), first, &hits);
            self.write_normals(normals, at, count);
            let there = !0 >> (64 - count);
            self.write_attributes(others & there & !first.uncertain, at, |lane| objects.face(first, lane));
        }
    }

    /// Traces one ray with the weave and writes its first hit.
    fn put_one(&mut self, ray: usize) {
        let (rays, hits, program) = (&self.rays, &mut *self.hits, self.weave.program());
        let between = &mut *self.between;
        one_by_one(self.weave, self.rays, ray, &self.query, &mut self.scratch.weave, |answer| {
            hits.put(program, rays, &answer);
            between.extend(answer.crossings.first().filter(|found| found.is_between()).map(|c| (ray, *c)));
        });
    }
}

/// Writes the first lanes to a slice of at most eight numbers.
#[inline(always)]
fn copy<S: Simd>(lanes: Lanes<S>, out: &mut [f64]) {
    match out.first_chunk_mut() {
        Some(out) => lanes.store_array(out),
        None => out.copy_from_slice(&lanes.as_slice()[..out.len()]),
    }
}

/// Writes the first of eight faces to a slice of at most eight.
#[inline(always)]
fn copy_faces(faces: &[i32; LANES], out: &mut [i32]) {
    match out.first_chunk_mut() {
        Some(out) => *out = *faces,
        None => out.copy_from_slice(&faces[..out.len()]),
    }
}

/// Writes the first of eight whole numbers to a slice of at most eight.
#[inline(always)]
fn copy_numbers<T>(numbers: [u32; LANES], out: &mut [T], convert: impl Fn(u32) -> T) {
    out.iter_mut().zip(numbers).for_each(|(out, number)| *out = convert(number));
}

/// [`whole`] of eight numbers.
#[inline(always)]
fn whole_lanes<S: Simd>(simd: S, row: &Row) -> [u32; LANES] {
    let (low, high) = (Lanes::load_array_ref(simd, &row.0) + WHOLE).to_bits().split();
    let mut numbers = [0; LANES];
    low.narrow(high).store_array(&mut numbers);
    numbers
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

    fn box_cells(&self) -> Option<&BoxCells> {
        self.layers.as_ref()?.box_cells()
    }

    fn crossings(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut PacketsScratch,
        sink: &mut dyn Sink,
    ) {
        let (Some(level), Some(plan)) = (self.level, &self.plan) else {
            return match &self.copies {
                Some(objects) if query.limit == Limit::All && query.starts.is_none() => {
                    self.among_copies(objects, rays, query, scratch, |answer| sink.ray(answer));
                }
                _ => match self.shapes() {
                    Some(shapes) if query.limit == Limit::All => {
                        let crossings = std::mem::take(&mut scratch.crossings);
                        let mut take = ShapeLists { program: self.weave.program(), sink, crossings };
                        self.among_shapes(shapes, rays, query, scratch, &mut take);
                        scratch.crossings = take.crossings;
                    }
                    _ => self.weave.crossings(rays, query, &mut scratch.weave, sink),
                },
            };
        };
        // the first change of region may leave the medium unchanged
        let first = query.limit == Limit::First && plan.is_plain;
        let mut memory = scratch.memory.take().unwrap_or_default();
        let mut take = Lists { weave: &self.weave, rays, query, scratch, sink };
        dispatch_wide!(level, simd => run(simd, plan, &mut memory, rays, query, first, &mut take));
        scratch.memory = Some(memory);
    }

    fn hits(
        &self,
        rays: Rays<'_>,
        window: Window,
        scratch: &mut PacketsScratch,
        rows: &mut HitArrayRows<'_, '_>,
    ) -> usize {
        let query = Query { window, ..Query::default() };
        let (Some(level), Some(plan)) = (self.level, &self.plan) else {
            if let Some(shapes) = self.shapes() {
                let mut block = std::mem::take(&mut scratch.hit_block);
                block.begin();
                let mut take = ShapeArrays { program: self.weave.program(), rows, block };
                self.among_shapes(shapes, rays, &query, scratch, &mut take);
                let ShapeArrays { rows, mut block, .. } = take;
                let most = block.finish(rays.len(), rows);
                scratch.hit_block = block;
                return most;
            }
            let Some(objects) = &self.copies else {
                return self.weave.hits(rays, window, &mut scratch.weave, rows);
            };
            let (program, mut block) = (self.weave.program(), std::mem::take(&mut scratch.hit_block));
            block.begin();
            self.among_copies(objects, rays, &query, scratch, |answer| {
                block.put(answer.ray, HitArrayRows::entries(program, &answer), rows);
            });
            let most = block.finish(rays.len(), rows);
            scratch.hit_block = block;
            return most;
        };
        let mut memory = scratch.memory.take().unwrap_or_default();
        let mut take = Arrays { weave: &self.weave, rays, query, scratch, rows, most: 0 };
        dispatch_wide!(level, simd => run(simd, plan, &mut memory, rays, &query, false, &mut take));
        let most = take.most;
        scratch.memory = Some(memory);
        most
    }

    fn nearest_from(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut PacketsScratch,
        hits: &mut FirstHits<'_>,
        between: &mut Vec<(usize, Crossing)>,
    ) {
        self.nearest_in(rays, (query, &[]), scratch, hits, between);
    }

    fn nearest_in(
        &self,
        rays: Rays<'_>,
        (query, regions): (&Query<'_>, &[u32]),
        scratch: &mut PacketsScratch,
        hits: &mut FirstHits<'_>,
        between: &mut Vec<(usize, Crossing)>,
    ) {
        let query = Query { limit: Limit::First, ..*query };
        if let (Some(level), Some(objects), None) = (self.level, &self.objects, query.starts) {
            let mut memory = scratch.memory.take().unwrap_or_default();
            let mut ahead = std::mem::take(&mut scratch.ahead);
            let mut firsts = Firsts { weave: &self.weave, rays, query, scratch, hits, regions, between };
            dispatch_wide!(level, simd => firsts.among(simd, (objects, self), &mut memory, &mut ahead));
            (scratch.memory, scratch.ahead) = (Some(memory), ahead);
            return;
        }
        if let (Some(level), Some(layers), Some(_)) = (self.level, &self.layers, query.starts) {
            let mut memory = scratch.memory.take().unwrap_or_default();
            let mut walk = std::mem::take(&mut scratch.walk);
            let mut firsts = Firsts { weave: &self.weave, rays, query, scratch, hits, regions, between };
            dispatch_wide!(level, simd => firsts.within(simd, layers, &mut memory, &mut walk));
            (scratch.memory, scratch.walk) = (Some(memory), walk);
            return;
        }
        let (Some(level), Some(plan)) = (self.level, &self.plan) else {
            if let (Some(level), None, Some(shapes)) =
                (self.level, query.starts, self.shapes_with_first_hits())
            {
                let mut firsts = Firsts { weave: &self.weave, rays, query, scratch, hits, regions, between };
                for at in (0..rays.len()).step_by(LANES) {
                    let count = LANES.min(rays.len() - at);
                    dispatch_wide!(level, simd => firsts.alone(simd, (shapes, None), at, count));
                }
                return;
            }
            return self.weave.nearest_from(rays, &query, &mut scratch.weave, hits, between);
        };
        let mut memory = scratch.memory.take().unwrap_or_default();
        let mut take = Firsts { weave: &self.weave, rays, query, scratch, hits, regions, between };
        dispatch_wide!(level, simd => run(simd, plan, &mut memory, rays, &query, plan.is_plain, &mut take));
        scratch.memory = Some(memory);
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut PacketsScratch, out: &mut [RegionId]) {
        self.weave.regions_at(points, &mut scratch.weave, out);
    }
}
