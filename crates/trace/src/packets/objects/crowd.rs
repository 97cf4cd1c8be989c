//! First hits of rays that start in a solid with many others within it, such as a tank of phototubes.
//!
//! Such rays have few boxes in common: each goes its own way through the tree of the others, or, where rays pass few boxes, all go
//! through it node by node. Eight of them are under way at a time. When each has arrived at the box of a solid, all eight are intersected together, and a ray that has found its first
//! hit gives its lane to the next one. The hit is certain if no other change follows it closely; all other rays are left to
//! the general search.

use super::super::Firsts;
use super::super::group::{BundleEvaluation, Row};
use super::super::places::{Step, slabs};
use super::cells::{Crowd, CrowdTree};
use super::within::{
    Departures, Eight, FirstStarts, Passage, Passages, Starts, Walk, cell_of, number, solids_in,
};
use super::{First, Objects, lanes_of};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_bvh::{RayStreams, RayTraversals, SlabRay, SlabRays, StreamPlace, StreamRay, StreamRays};
use rayweave_model::{Evaluator, MARGIN};
use rayweave_shape::lanes::{LANES, LaneRay, Lanes, Mask, Vec3Lanes, splat};

/// Rays that start among many solids, with the memory for their search.
#[derive(Clone, Debug, Default)]
pub(super) struct Seekers {
    /// The numbers of the rays, with those of their cells in the upper halves: each has a crowd of its own.
    pub rays: Vec<u64>,
    traversals: RayTraversals,
    /// The solids on the ways of all rays of a sparse crowd.
    streams: RayStreams,
    starts: Starts,
    /// The rays that wait for a lane.
    waiting: Vec<Seeker>,
    /// These rays prepared for the tree, in a dense or in a sparse crowd.
    slabs: Vec<SlabRay>,
    streaming: Vec<StreamRay>,
    /// The first hits of rays that leave the solid in which they start, and of those that enter another one.
    done: [Vec<Done>; 2],
}

/// A ray that waits for a lane.
#[derive(Clone, Copy, Debug)]
struct Seeker {
    ray: u32,
    cell: u32,
    /// As in [`Lane8`].
    given: [f64; GIVEN],
    /// The surface and the placement on which it starts, -1 for none, and whether f < 0 just after the start.
    start: ([f64; 2], bool),
    /// The time at which it leaves its solid, that of the change after it, and the face.
    exit: [f64; 3],
    /// True if the exit may be welded to a change behind it.
    is_near: bool,
    /// See [`StreamRays::ray`](rayweave_bvh::StreamRays::ray).
    pace: f64,
}

/// The first hit of a ray.
#[derive(Clone, Copy, Debug)]
struct Done {
    ray: u32,
    object: u32,
    t: f64,
    face: f64,
    before: f64,
    after: f64,
}

impl Seeker {
    /// The time up to which solids matter.
    fn until(&self) -> f64 {
        self.exit[0] + self.given[GIVEN - 1]
    }

    /// The exit from the solid in which the ray starts, as the first hit of a ray that meets no other solid, if it is certain.
    #[inline(always)]
    fn exit(&self, objects: &Objects) -> Option<Done> {
        let [t, next, face] = self.exit;
        let is_certain = !self.is_near && next >= t + self.given[GIVEN - 1];
        let cell = objects.cells.get(self.cell);
        is_certain.then(|| Done {
            ray: self.ray,
            object: objects.cells.list(cell)[0],
            t,
            face,
            before: cell.region,
            after: cell.base,
        })
    }
}

/// Eight rays prepared for the tree of a crowd.
enum Prepared {
    Slabs(SlabRays),
    Streaming(StreamRays),
}

/// The number of components of a ray with its bounds.
const GIVEN: usize = 8;

/// Number of solids from which on their data do not fit into the cache.
const LARGE: usize = 1000;

/// Eight rays under way.
struct Lane8 {
    /// Bit mask of the lanes in use.
    active: u64,
    /// Bit mask of the rays whose first hit is uncertain.
    uncertain: u64,
    /// Bit mask of the rays whose first hit may be welded to a change behind it.
    near: u64,
    ray: [u32; LANES],
    /// The solid in which each ray starts.
    own: [u32; LANES],
    /// The components of the origin and the direction, the lower bound of t, and the length behind a hit within which other
    /// changes make it uncertain.
    given: [Row; GIVEN],
    starts: Starts,
    /// The regions in which the rays start, and those behind the first hits so far.
    before: Row,
    after: Row,
    /// The first two changes so far.
    first: Row,
    second: Row,
    /// The face and the solid of the first one.
    face: Row,
    object: Row,
    /// The time up to which other solids matter.
    until: Row,
    /// As in [`Seeker`].
    pace: Row,
}

impl Lane8 {
    fn new() -> Lane8 {
        let row = Row([0.0; LANES]);
        // rays of lanes that are not in use are finite and have a direction
        let mut given = [row; GIVEN];
        given[3] = Row([1.0; LANES]);
        Lane8 {
            active: 0,
            uncertain: 0,
            near: 0,
            ray: [0; LANES],
            own: [0; LANES],
            given,
            starts: Starts::default(),
            before: row,
            after: row,
            first: row,
            second: row,
            face: row,
            object: row,
            until: row,
            pace: row,
        }
    }

    /// Puts a ray into a lane.
    #[inline(always)]
    fn put(&mut self, lane: usize, objects: &Objects, seeker: &Seeker) {
        let cell = objects.cells.get(seeker.cell);
        let own = objects.cells.list(cell)[0];
        let bit = 1 << lane;
        self.active |= bit;
        self.uncertain &= !bit;
        self.near = self.near & !bit | u64::from(seeker.is_near) << lane;
        (self.ray[lane], self.own[lane]) = (seeker.ray, own);
        for k in 0..GIVEN {
            self.given[k].0[lane] = seeker.given[k];
        }
        let ([surface, placement], inside) = seeker.start;
        let FirstStarts { surface: surfaces, placement: placements, inside: sides } = &mut self.starts.first;
        (surfaces.0[lane], placements.0[lane]) = (surface, placement);
        *sides = *sides & !bit | u64::from(inside) << lane;
        let [exit, next, face] = seeker.exit;
        (self.before.0[lane], self.after.0[lane]) = (cell.region, cell.base);
        (self.first.0[lane], self.second.0[lane]) = (exit, next);
        (self.face.0[lane], self.object.0[lane]) = (face, f64::from(own));
        (self.until.0[lane], self.pace.0[lane]) = (seeker.until(), seeker.pace);
    }

    /// The first hit of the ray of a lane, if it is certain.
    #[inline(always)]
    fn hit(&self, lane: usize) -> Option<Done> {
        let t = self.first.0[lane];
        let is_certain =
            self.uncertain >> lane & 1 == 0 && self.second.0[lane] >= t + self.given[GIVEN - 1].0[lane];
        is_certain.then(|| Done {
            ray: self.ray[lane],
            object: self.object.0[lane] as u32,
            t,
            face: self.face.0[lane],
            before: self.before.0[lane],
            after: self.after.0[lane],
        })
    }

    /// Intersects the rays with solids, each ray with one of them.
    #[inline(always)]
    fn meet<S: Simd>(
        &mut self,
        objects: &Objects,
        group: &mut BundleEvaluation<'_, S>,
        items: &[u32; LANES],
        t_max: f64,
    ) {
        let simd = group.simd;
        let [x, y, z, dx, dy, dz, from, behind] = &self.given;
        let origin = Vec3Lanes { x: row(simd, x), y: row(simd, y), z: row(simd, z) };
        let direction = Vec3Lanes { x: row(simd, dx), y: row(simd, dy), z: row(simd, dz) };
        let (from, behind) = (row(simd, from), row(simd, behind));
        let (ray, _) = LaneRay::new(simd, origin, direction, &objects.model.limits);
        let active = Mask::from_bitmask(simd, self.active);
        let rays = Departures { ray: &ray, starts: &self.starts, queried: active, from, t_max };
        let Passages { passage, region, near, .. } =
            objects.pass_each(group, items, self.active, &rays, behind);
        let (first, second) = (row(simd, &self.first), row(simd, &self.second));
        let is_hit = passage.first.simd_lt(f64::INFINITY);
        let closer = passage.first.simd_lt(first);
        // a ray that starts in another solid, or meets one that does not replace its own, has more to be compared
        let unsure = passage.uncertain | passage.inside;
        let unsure = unsure | (is_hit & region.simd_le(row(simd, &self.before)));
        self.uncertain |= unsure.to_bitmask() & self.active;
        let near = near | passage.grazes;
        self.near = self.near & !closer.to_bitmask() | (near & closer).to_bitmask();
        let second = closer.select(first.min(passage.second), second.min(passage.first));
        let first = closer.select(passage.first, first);
        first.store_array(&mut self.first.0);
        second.store_array(&mut self.second.0);
        closer.select(passage.face, row(simd, &self.face)).store_array(&mut self.face.0);
        closer.select(row(simd, &solids_in(items)), row(simd, &self.object)).store_array(&mut self.object.0);
        closer.select(region, row(simd, &self.after)).store_array(&mut self.after.0);
        (first + behind).store_array(&mut self.until.0);
    }
}

#[inline(always)]
fn row<S: Simd>(simd: S, row: &Row) -> Lanes<S> {
    Lanes::load_array_ref(simd, &row.0)
}

impl Objects {
    /// Reads the data of solids of a crowd. Of thousands they are not in the cache, and a loop without any other work waits for many
    /// of these reads at once.
    fn read_ahead(&self, crowd: &Crowd, places: impl Iterator<Item = u32>) {
        if crowd.solids.len() < LARGE {
            return;
        }
        let mut all = 0.0;
        for place in places {
            let object = &self.objects[crowd.solids[place as usize] as usize];
            all += object.region + self.steps(object).first().map_or(0.0, Step::path);
        }
        std::hint::black_box(all);
    }
}

impl Firsts<'_, '_> {
    /// First hits of rays that start among many solids; those that are uncertain or start elsewhere are appended to `others`.
    #[inline(always)]
    pub(super) fn among_many<S: Simd>(
        &mut self,
        simd: S,
        objects: &Objects,
        group: &mut BundleEvaluation<'_, S>,
        walk: &mut Walk,
        others: &mut Vec<u64>,
    ) {
        let seekers = &mut walk.seekers;
        let mut rays = std::mem::take(&mut seekers.rays);
        if rays.iter().any(|&ray| cell_of(ray) != cell_of(rays[0])) {
            rays.sort_unstable();
        }
        for rays in rays.chunk_by_mut(|&a, &b| cell_of(a) == cell_of(b)) {
            let number = cell_of(rays[0]);
            let crowd = objects.cells.crowd(objects.cells.get(number).crowd);
            if let CrowdTree::Dense(_) = crowd.tree {
                objects.order(&self.rays, rays);
            }
            self.among_crowd(simd, objects, (number, crowd, rays), group, seekers, others);
        }
        for done in &mut seekers.done {
            self.put_done(simd, objects, done);
        }
        seekers.rays = rays;
    }

    /// First hits of rays that start in a cell, among the solids of its crowd.
    #[inline(always)]
    fn among_crowd<S: Simd>(
        &mut self,
        simd: S,
        objects: &Objects,
        (cell, crowd, rays): (u32, &Crowd, &[u64]),
        group: &mut BundleEvaluation<'_, S>,
        seekers: &mut Seekers,
        others: &mut Vec<u64>,
    ) {
        let (mut eights, mut lanes, mut items) = (rays.chunks(LANES), Lane8::new(), [0; LANES]);
        let t_max = self.query.window.t_max();
        // for each lane, its place among the solids on the way of its ray in a sparse crowd
        let mut places = [StreamPlace::END; LANES];
        if let CrowdTree::Sparse(tree) = &crowd.tree {
            seekers.streaming.clear();
            for numbers in eights.by_ref() {
                self.prepare(simd, objects, group, (cell, crowd, numbers), seekers, others);
            }
            seekers.streams.find(simd, tree, &mut seekers.streaming);
            objects.read_ahead(crowd, seekers.streams.items());
        }
        loop {
            for lane in 0..LANES {
                loop {
                    if lanes.active >> lane & 1 == 1 {
                        let is_open = lanes.uncertain >> lane & 1 == 0;
                        let next = |until| match &crowd.tree {
                            CrowdTree::Sparse(_) => {
                                seekers.streams.next(&mut places[lane], until, lanes.pace.0[lane])
                            }
                            CrowdTree::Dense(tree) => seekers.traversals.next(simd, tree, lane, until),
                        };
                        if let Some(place) = Some(lanes.until.0[lane]).filter(|_| is_open).and_then(next) {
                            items[lane] = crowd.solids[place as usize];
                            break;
                        }
                        self.finish(simd, objects, lane, &lanes, &mut seekers.done, others);
                        lanes.active &= !(1 << lane);
                    }
                    let Some(seeker) = seekers.waiting.pop() else {
                        let Some(numbers) = eights.next() else { break };
                        self.prepare(simd, objects, group, (cell, crowd, numbers), seekers, others);
                        continue;
                    };
                    match &crowd.tree {
                        CrowdTree::Sparse(_) => {
                            let Some(place) = seekers.streams.of_ray(seekers.waiting.len()) else {
                                others.push(u64::from(seeker.ray));
                                continue;
                            };
                            places[lane] = place;
                            if place == StreamPlace::END
                                && let Some(exit) = seeker.exit(objects)
                            {
                                self.put(simd, objects, exit, &mut seekers.done[0]);
                                continue;
                            }
                        }
                        CrowdTree::Dense(tree) => {
                            let Some(slabs) = seekers.slabs.pop() else { break };
                            seekers.traversals.begin_one(simd, tree, lane, slabs, seeker.until());
                        }
                    }
                    lanes.put(lane, objects, &seeker);
                }
            }
            if lanes.active == 0 {
                break;
            }
            lanes.meet(objects, group, &items, t_max);
        }
    }

    /// Intersects up to eight rays with the solid of the cell in which they start.
    fn prepare<S: Simd>(
        &mut self,
        simd: S,
        objects: &Objects,
        group: &mut BundleEvaluation<'_, S>,
        (cell, crowd, numbers): (u32, &Crowd, &[u64]),
        seekers: &mut Seekers,
        others: &mut Vec<u64>,
    ) {
        // a separate function, since it has two callers
        simd.vectorize(
            #[inline(always)]
            || {
                let eight = Eight::new(simd, &self.rays, &self.query, numbers);
                let starts = &mut seekers.starts;
                starts.read(&self.query, numbers);
                let (ray, uncertain) =
                    LaneRay::new(simd, eight.origin, eight.direction, &objects.model.limits);
                let behind = splat(simd, objects.cells.slack) / ray.direction.taxicab();
                let queried = Mask::from_bitmask(simd, (1 << numbers.len()) - 1);
                let own = objects.cells.list(objects.cells.get(cell))[0];
                let t_max = self.query.window.t_max();
                let rays = Departures { ray: &ray, starts, queried, from: eight.from, t_max };
                let (passage, near) = objects.pass_one(group, own, &rays, behind);
                let unsure = uncertain.always | passage.uncertain;
                let near = (near | passage.grazes).to_bitmask();
                let leaves = passage.inside & passage.first.simd_lt(f64::INFINITY) & !unsure;
                let several = starts.others.iter().fold(0, |all: u64, other| all | 1 << other.lane);
                let known = leaves.to_bitmask() & !several;
                let Passage { first, second, face, .. } = &passage;
                let (o, d) = (&eight.origin, &eight.direction);
                let prepared = match &crowd.tree {
                    CrowdTree::Sparse(tree) => {
                        let window = [eight.from, passage.first + behind];
                        Prepared::Streaming(tree.rays(simd, [o.x, o.y, o.z], [d.x, d.y, d.z], window))
                    }
                    CrowdTree::Dense(_) => {
                        let margin = ray.origin.taxicab() * (objects.condition * MARGIN);
                        Prepared::Slabs(SlabRays::new(&slabs(simd, ray.origin, ray.direction, margin)))
                    }
                };
                let columns = [&o.x, &o.y, &o.z, &d.x, &d.y, &d.z, &eight.from, &behind, first, second, face];
                let mut rows = [Row([0.0; LANES]); 11];
                for k in 0..columns.len() {
                    columns[k].store_array(&mut rows[k].0);
                }
                for (lane, &entry) in numbers.iter().enumerate().rev() {
                    if known >> lane & 1 == 0 {
                        others.push(number(entry) as u64);
                        continue;
                    }
                    let FirstStarts { surface, placement, inside } = &starts.first;
                    let at = |k: usize| rows[k].0[lane];
                    let mut pace = 1.0;
                    match &prepared {
                        Prepared::Slabs(slabs) => seekers.slabs.push(slabs.ray(lane, at(6))),
                        Prepared::Streaming(rays) => {
                            let Some((streaming, own)) = rays.ray(lane) else {
                                others.push(number(entry) as u64);
                                continue;
                            };
                            seekers.streaming.push(streaming);
                            pace = own;
                        }
                    }
                    seekers.waiting.push(Seeker {
                        ray: number(entry) as u32,
                        cell,
                        given: [at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)],
                        start: ([surface.0[lane], placement.0[lane]], inside >> lane & 1 == 1),
                        exit: [at(8), at(9), at(10)],
                        is_near: near >> lane & 1 == 1,
                        pace,
                    });
                }
            },
        );
    }

    /// Takes a ray out of its lane.
    #[inline(always)]
    fn finish<S: Simd>(
        &mut self,
        simd: S,
        objects: &Objects,
        lane: usize,
        lanes: &Lane8,
        done: &mut [Vec<Done>; 2],
        others: &mut Vec<u64>,
    ) {
        let ray = lanes.ray[lane];
        let is_resolved = |hit: &Done| {
            let face = objects.face_of(f64::from(hit.object), hit.face);
            let (line, next) = (self.rays.get(ray as usize), hit.t + lanes.given[GIVEN - 1].0[lane]);
            let model = (self.weave.program(), self.query.window);
            lanes.near >> lane & 1 == 0 || objects.is_resolved((face, hit.t), &line, next, model)
        };
        let Some(hit) = lanes.hit(lane).filter(is_resolved) else { return others.push(u64::from(ray)) };
        // hits of one kind together have normals of one kind
        self.put(simd, objects, hit, &mut done[usize::from(hit.object != lanes.own[lane])]);
    }

    /// Adds a hit to those of its kind, which are written together.
    #[inline(always)]
    fn put<S: Simd>(&mut self, simd: S, objects: &Objects, hit: Done, done: &mut Vec<Done>) {
        done.push(hit);
        if done.len() == LANES {
            self.put_done(simd, objects, done);
        }
    }

    /// Writes the hits of up to eight rays, and forgets them.
    fn put_done<S: Simd>(&mut self, simd: S, objects: &Objects, done: &mut Vec<Done>) {
        simd.vectorize(
            #[inline(always)]
            || {
                let mut numbers = [0; LANES];
                let none = Row([-1.0; LANES]);
                let mut first = First {
                    t: none,
                    face: none,
                    before: none,
                    region: none,
                    placement: none,
                    object: none,
                    uncertain: 0,
                };
                for lane in lanes_of((1 << done.len()) - 1) {
                    let hit = &done[lane];
                    numbers[lane] = u64::from(hit.ray);
                    (first.t.0[lane], first.face.0[lane]) = (hit.t, hit.face);
                    (first.before.0[lane], first.region.0[lane]) = (hit.before, hit.after);
                    first.object.0[lane] = f64::from(hit.object);
                    first.placement.0[lane] = f64::from(objects.objects[hit.object as usize].placement);
                }
                if let numbers @ [_, ..] = &numbers[..done.len()] {
                    let eight = Eight::new(simd, &self.rays, &self.query, numbers);
                    self.put_within(simd, objects, &first, &eight);
                }
                done.clear();
            },
        );
    }
}
