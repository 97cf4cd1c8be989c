//! First hits of eight rays that may start inside solids and on their surfaces.
//!
//! A point belongs to the last region that holds it, and each region is a union of solids. If each has a medium of its own,
//! the first change along a ray is the exit from the solid that owns its start, or the entry into a solid of a later region,
//! whichever comes first. A ray falls back to the weave if several solids begin or end at the same or nearly the same time,
//! or if the first two changes along its way through a solid do not suffice.

use super::super::Firsts;
use super::super::group::{BundleEvaluation, CODE, Memory, Row, whole};
use super::super::normal::Hits;
use super::super::places::{Carried, slabs};
use super::cells::{Cell, NONE};
use super::crowd::Seekers;
use super::{First, Method, Objects, Part, Search, lanes_of, latest};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_bvh::{BundleSlabs, BundleTraversal, BundleWindow, RayTraversals};
use rayweave_math::Vec3;
use rayweave_model::{
    Crossing, Evaluator, MARGIN, Program, Query, RayAnswer, Rays, RegionId, Start, StartLists, attributes,
};
use rayweave_shape::lanes::{LANES, LaneRay, LaneStarts, Lanes, Mask, Vec3Lanes, splat};

/// Scratch memory of a thread.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Walk {
    ahead: BundleTraversal,
    apart: RayTraversals,
    met: Vec<Met>,
    starts: Starts,
    pub(super) seekers: Seekers,
    /// The rays in the order in which they are traced, as sort keys in the upper half and numbers in the lower one.
    order: Vec<u64>,
    /// The rays that start in a cell, with its number in the upper half.
    listed: Vec<u64>,
    /// Memory for sorting them.
    unsorted: Vec<u64>,
    counts: Vec<u32>,
}

/// For each ray of a bundle, a solid that it may pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    /// The indices of the solids; undefined for none.
    pub object: Row,
    /// The regions of the solids; 0 for none.
    pub region: Row,
    /// The times of the first two changes after the start, +inf for none, and the face of the first one.
    pub first: Row,
    pub second: Row,
    pub face: Row,
    /// Bit mask of the rays that start inside.
    pub inside: u64,
    /// Bit mask of the rays that graze a surface.
    grazes: u64,
    /// Bit mask of the rays with no more than two changes.
    pub single: u64,
}

/// The ways of eight rays through solids with one part.
pub(super) struct Passage<S: Simd> {
    /// As in [`Met`].
    pub first: Lanes<S>,
    pub second: Lanes<S>,
    pub face: Lanes<S>,
    pub inside: Mask<S>,
    pub grazes: Mask<S>,
    /// The rays that fall back to the weave.
    pub uncertain: Mask<S>,
    is_single: bool,
}

/// The ways of eight rays, each through a solid of its own.
pub(super) struct Passages<S: Simd> {
    pub passage: Passage<S>,
    /// The regions of the solids.
    pub region: Lanes<S>,
    /// Bit mask of the rays with no more than two changes.
    single: u64,
    /// The rays whose first change may be welded to another one within a distance behind it.
    pub near: Mask<S>,
}

/// The rays of a bundle that are traced, with the surfaces on which they start and the intervals of t.
pub(super) struct Departures<'e, S: Simd> {
    pub ray: &'e LaneRay<S>,
    pub starts: &'e Starts,
    pub queried: Mask<S>,
    pub from: Lanes<S>,
    pub t_max: f64,
}

/// The surfaces that eight rays start on: the first of each ray in lanes, and a list of the others.
#[derive(Clone, Debug, Default)]
pub(super) struct Starts {
    pub first: FirstStarts,
    pub others: Vec<LaneStart>,
}

/// The first start surfaces of eight rays, with -1 for none.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstStarts {
    pub surface: Row,
    pub placement: Row,
    /// Bit mask of the rays with f < 0 just after the start.
    pub inside: u64,
}

impl Default for FirstStarts {
    fn default() -> Self {
        let none = Row([-1.0; LANES]);
        FirstStarts { surface: none, placement: none, inside: 0 }
    }
}

/// A surface that one of eight rays starts on.
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneStart {
    pub lane: usize,
    start: Start,
}

impl Met {
    /// The solid for the rays in a bit mask only.
    #[inline(always)]
    fn of_rays<S: Simd>(self, simd: S, rays: u64) -> Met {
        let (some, infinity) = (Mask::from_bitmask(simd, rays), splat(simd, f64::INFINITY));
        let or = |row: &Row, none: Lanes<S>| {
            Row(some.select(Lanes::load_array_ref(simd, &row.0), none).to_array())
        };
        Met {
            region: or(&self.region, splat(simd, 0.0)),
            first: or(&self.first, infinity),
            second: or(&self.second, infinity),
            inside: self.inside & rays,
            ..self
        }
    }
}

impl Starts {
    pub fn read(&mut self, query: &Query<'_>, numbers: &[u64]) {
        self.first = FirstStarts::default();
        self.others.clear();
        let Some(lists) = query.starts else { return };
        for (lane, &entry) in numbers.iter().enumerate() {
            let [start, others @ ..] = lists.of(number(entry)) else { continue };
            let lane = lane % LANES;
            self.first.surface.0[lane] = f64::from(start.surface.0);
            self.first.placement.0[lane] = f64::from(start.placement.0);
            self.first.inside |= u64::from(start.inside) << lane;
            self.others.extend(others.iter().map(|&start| LaneStart { lane, start }));
        }
    }
}

/// Largest number of solids that a bundle of rays may come near; otherwise the weave traces its rays.
const MAX_MET: usize = 96;

/// Distance behind a hit, in radii of the model, up to which solids are still searched: less than the gap between solids that
/// nearly touch, and far above the length of a weld. A separate check proves that no weld reaches farther.
const BEHIND: f64 = 2e-4;

/// Eight rays of a batch.
pub(super) struct Eight<'n, S: Simd> {
    /// The numbers of the rays, in the low halves; the last ray fills the remaining lanes.
    pub numbers: &'n [u64],
    pub origin: Vec3Lanes<S>,
    pub direction: Vec3Lanes<S>,
    /// The lower bounds of t.
    pub from: Lanes<S>,
}

/// The lowest bit of a sort key that belongs to the place, not to the direction.
const PLACE_SHIFT: u32 = 32 + 15;

/// Number of cells per ray above which the rays are sorted by comparisons.
const MOST_COUNTS: usize = 4;

/// Sorts entries of rays in ascending order, which have the number of a cell in their upper halves, by cells.
fn sort_by_cell(entries: &[u64], cells: usize, counts: &mut Vec<u32>, sorted: &mut Vec<u64>) {
    counts.clear();
    counts.resize(cells + 1, 0);
    for &entry in entries {
        counts[cell_of(entry) as usize + 1] += 1;
    }
    for cell in 1..counts.len() {
        counts[cell] += counts[cell - 1];
    }
    sorted.resize(entries.len(), 0);
    for &entry in entries {
        let place = &mut counts[cell_of(entry) as usize];
        sorted[*place as usize] = entry;
        *place += 1;
    }
}

/// The cell of an entry of [`Walk::listed`] or [`Seekers::rays`].
pub(super) fn cell_of(entry: u64) -> u32 {
    (entry >> 32) as u32
}

pub(super) fn number(entry: u64) -> usize {
    (entry & u64::from(u32::MAX)) as usize
}

/// The numbers of eight solids as numbers in lanes.
#[inline(always)]
pub(super) fn solids_in(items: &[u32; LANES]) -> Row {
    let mut row = Row([0.0; LANES]);
    for lane in 0..LANES {
        row.0[lane] = f64::from(items[lane]);
    }
    row
}

impl<'n, S: Simd> Eight<'n, S> {
    #[inline(always)]
    pub fn new(simd: S, rays: &Rays<'_>, query: &Query<'_>, numbers: &'n [u64]) -> Self {
        let count = rays.len();
        let [ox, oy, oz] = rays.origins.map(|column| &column[..count]);
        let [dx, dy, dz] = rays.directions.map(|column| &column[..count]);
        let t_min = query.window.t_min();
        // t = 0 is included for rays with start lists: see `Query::is_past`
        let firsts = query.starts.filter(|_| t_min <= 0.0).map(|lists| &lists.first[..=count]);
        let (mut rows, last) = ([[t_min; LANES]; 7], numbers.len() - 1);
        for lane in 0..LANES {
            let ray = number(numbers[lane.min(last)]);
            (rows[0][lane], rows[1][lane], rows[2][lane]) = (ox[ray], oy[ray], oz[ray]);
            (rows[3][lane], rows[4][lane], rows[5][lane]) = (dx[ray], dy[ray], dz[ray]);
            if let Some(firsts) = firsts
                && firsts[ray + 1] > firsts[ray]
            {
                rows[6][lane] = -f64::from_bits(1);
            }
        }
        let load = |k: usize| Lanes::load_array_ref(simd, &rows[k]);
        Eight {
            numbers,
            origin: Vec3Lanes { x: load(0), y: load(1), z: load(2) },
            direction: Vec3Lanes { x: load(3), y: load(4), z: load(5) },
            from: load(6),
        }
    }

    /// True if the rays start so close to each other, in directions so similar, that they have most boxes in common.
    #[inline(always)]
    fn is_together(&self, simd: S, solids: usize) -> bool {
        let places =
            [self.numbers.first(), self.numbers.last()].map(|entry| entry.map(|key| key >> PLACE_SHIFT));
        // the squared angle between the first ray and the others, for unit vectors
        let at = |column: Lanes<S>| column.as_slice()[0];
        let direction = self.direction;
        let lead = Vec3::new(at(direction.x), at(direction.y), at(direction.z));
        let squares = (splat(simd, 1.0) - direction.dot(Vec3Lanes::splat(simd, lead))) * 2.0;
        places[0] == places[1] && latest(squares) * solids as f64 <= CROWDED
    }
}

/// Product of the number of solids and of the squared angle between rays from one place, in radians, above which the rays have
/// few boxes in common: the number of solids between them if these lie all around is 1/16 of it.
const CROWDED: f64 = 64.0;

/// Bit masks of rays of cells whose first hits are not found in lanes.
struct Unsure {
    /// The rays that start elsewhere.
    elsewhere: u64,
    /// The uncertain rays with two changes close to each other, but without any other reason.
    close: u64,
}

/// State of a search.
struct Progress<S: Simd> {
    /// The last region found so far that holds the start.
    owner: Lanes<S>,
    /// Upper bound of the time of the first change if no later region holds the start.
    bound: Lanes<S>,
    uncertain: Mask<S>,
}

impl Firsts<'_, '_> {
    /// First hits of rays that may start inside solids.
    #[inline(always)]
    pub(in super::super) fn within<S: Simd>(
        &mut self,
        simd: S,
        objects: &Objects,
        memory: &mut Memory,
        walk: &mut Walk,
    ) {
        let mut group = BundleEvaluation::new(simd, memory);
        objects.split(&self.query, (self.rays.len(), self.regions), walk);
        let (mut order, listed) = (std::mem::take(&mut walk.order), std::mem::take(&mut walk.listed));
        self.among_many(simd, objects, &mut group, walk, &mut order);
        let class = |entry: &u64| objects.cells.get(cell_of(*entry)).class;
        for numbers in listed.chunk_by(|a, b| class(a) == class(b)).flat_map(|same| same.chunks(LANES)) {
            let program = self.weave.program();
            let eight = Eight::new(simd, &self.rays, &self.query, numbers);
            let (first, unsure) = objects.first_in_cell(&mut group, walk, program, &eight, &self.query);
            self.put_within(simd, objects, &first, &eight);
            let some = !0 >> (64 - numbers.len());
            for lane in lanes_of((unsure.elsewhere | first.uncertain) & some) {
                let ray = number(numbers[lane]);
                if unsure.elsewhere >> lane & 1 == 1 {
                    order.push(ray as u64);
                } else if !(unsure.close >> lane & 1 == 1 && self.put_close(objects, &first, lane, ray, walk))
                {
                    self.put_one(ray);
                }
            }
        }
        walk.listed = listed;
        objects.order(&self.rays, &mut order);
        for numbers in order.chunks(LANES) {
            let program = self.weave.program();
            let eight = Eight::new(simd, &self.rays, &self.query, numbers);
            let first = objects.first_within(&mut group, walk, program, &eight, &self.query);
            self.put_within(simd, objects, &first, &eight);
            for (lane, &entry) in numbers.iter().enumerate() {
                if first.uncertain >> lane & 1 == 1 {
                    self.put_one(number(entry));
                }
            }
        }
        walk.order = order;
    }

    /// Writes the hit of a ray of a cell with two changes close to each other; false if it is uncertain.
    fn put_close(&mut self, objects: &Objects, first: &First, lane: usize, ray: usize, walk: &Walk) -> bool {
        let (program, line) = (self.weave.program(), self.rays.get(ray));
        let limits = &objects.model.limits;
        let horizon = first.t.0[lane] + objects.cells.slack / line.direction.abs().element_sum();
        let end = line.closest_time(limits.centre) + limits.radius / line.direction.length();
        let ends = (horizon, end.min(self.query.window.t_max()));
        let Some(found) = objects.welded_exit(program, &line, (first, lane), &walk.met, ends) else {
            return false;
        };
        let answer = RayAnswer { ray, start: found.before, crossings: &[found] };
        self.hits.put(program, &self.rays, &answer);
        self.between.extend(found.is_between().then_some((ray, found)));
        true
    }

    /// Writes the certain hits.
    #[inline(always)]
    pub(super) fn put_within<S: Simd>(
        &mut self,
        simd: S,
        objects: &Objects,
        first: &First,
        eight: &Eight<'_, S>,
    ) {
        let hits = &mut *self.hits;
        for (lane, &entry) in eight.numbers.iter().enumerate() {
            let ray = number(entry);
            hits.t[ray] = first.t.0[lane];
            hits.face[ray] = whole(first.face.0[lane]);
            hits.before[ray] = whole(first.before.0[lane]) as u32;
            hits.after[ray] = whole(first.region.0[lane]) as u32;
            hits.placement[ray] = whole(first.placement.0[lane]) as u32;
        }
        let Some([x, y, z]) = &mut hits.normal else { return };
        let zero = splat(simd, 0.0);
        let leaves = Lanes::load_array_ref(simd, &first.region.0).simd_le(zero);
        let hit = Lanes::load_array_ref(simd, &first.face.0).simd_ge(zero).to_bitmask() & !first.uncertain;
        let t = Lanes::load_array_ref(simd, &first.t.0);
        let found =
            Hits { origin: eight.origin, direction: eight.direction, t, face: first.face, leaves, hit };
        let program = self.weave.program();
        let (normals, others) = objects.normals(simd, program, first, &found);
        for (lane, &entry) in eight.numbers.iter().enumerate() {
            let ray = number(entry);
            let mut normal =
                [normals.x.as_slice()[lane], normals.y.as_slice()[lane], normals.z.as_slice()[lane]];
            if others >> lane & 1 == 1 {
                let face = objects.face(first, lane);
                let [before, after] = [hits.before[ray], hits.after[ray]].map(RegionId);
                let crossing = Crossing { t: hits.t[ray], face, left: face, entered: face, before, after };
                normal = attributes::normal(program, &self.rays.get(ray), &crossing).to_array();
            }
            [x[ray], y[ray], z[ray]] = normal;
        }
    }
}

impl Objects {
    /// Sorts the rays along a space-filling curve (Morton 1966), so that neighbours start close to each other, and those
    /// that start in one place have similar directions.
    pub(super) fn order(&self, rays: &Rays<'_>, order: &mut [u64]) {
        if self.is_few {
            return;
        }
        let limits = &self.model.limits;
        let low = limits.centre - Vec3::splat(limits.radius);
        let scale = 16.0 / limits.radius;
        let cell = |value: f64| SPREAD[value.clamp(0.0, 31.0) as usize];
        let place = |k: usize, ray: usize| cell((rays.origins[k][ray] - low[k]) * scale) << k;
        // directions are mostly unit vectors
        let towards = |k: usize, ray: usize| cell(16.0 * rays.directions[k][ray] + 16.0) << k;
        for entry in &mut *order {
            let ray = number(*entry);
            let places = place(0, ray) | place(1, ray) | place(2, ray);
            let directions = towards(0, ray) | towards(1, ray) | towards(2, ray);
            *entry = places << PLACE_SHIFT | directions << 32 | ray as u64;
        }
        order.sort_unstable();
    }

    /// Lists the rays that start in a cell, sorted by cells, those that start among many solids, and the others. `regions` are
    /// the regions in which rays without a start list probably are.
    fn split(&self, query: &Query<'_>, (count, regions): (usize, &[u32]), walk: &mut Walk) {
        let Walk { order, listed, unsorted, counts, seekers, .. } = walk;
        listed.clear();
        order.clear();
        seekers.rays.clear();
        let Some(lists) = query.starts.filter(|_| !self.cells.is_empty() && query.window.t_min() <= 0.0)
        else {
            return order.extend(0..count as u64);
        };
        unsorted.clear();
        for ray in 0..count {
            match self.cell_of(&lists, regions, ray) {
                NONE => order.push(ray as u64),
                cell => match self.cells.get(cell).crowd {
                    NONE => unsorted.push(u64::from(cell) << 32 | ray as u64),
                    _ => seekers.rays.push(u64::from(cell) << 32 | ray as u64),
                },
            }
        }
        if self.cells.count() > MOST_COUNTS * unsorted.len() {
            std::mem::swap(listed, unsorted);
            return listed.sort_unstable();
        }
        sort_by_cell(unsorted, self.cells.count(), counts, listed);
    }

    /// The number of the cell in which a ray probably starts; [`NONE`] if there is none.
    #[inline(always)]
    pub(super) fn cell_of(&self, lists: &StartLists<'_>, regions: &[u32], ray: usize) -> u32 {
        match lists.of(ray) {
            [] => regions.get(ray).map_or(NONE, |&region| self.cells.of_region(region)),
            starts => self.cells.of(starts),
        }
    }

    /// The first hits of eight rays that start in cells of one class.
    #[inline(always)]
    fn first_in_cell<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        walk: &mut Walk,
        program: &Program,
        eight: &Eight<'_, S>,
        query: &Query<'_>,
    ) -> (First, Unsure) {
        let simd = group.simd;
        let Walk { met, starts, .. } = walk;
        met.clear();
        starts.read(query, eight.numbers);
        let (ray, uncertain) = LaneRay::new(simd, eight.origin, eight.direction, &self.model.limits);
        let some = (1 << eight.numbers.len()) - 1;
        let (from, t_max) = (eight.from, query.window.t_max());
        let queried = Mask::from_bitmask(simd, some);
        let last = eight.numbers.len() - 1;
        let mut cells: [&Cell; LANES] = [self.cells.get(cell_of(eight.numbers[0])); LANES];
        for (cell, &entry) in cells.iter_mut().zip(eight.numbers) {
            *cell = self.cells.get(cell_of(entry));
        }
        let (mut base, mut region, mut own) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            (base[lane], region[lane]) = (cells[lane].base, cells[lane].region);
            own[lane] = f64::from(self.cells.list(cells[lane])[0]);
        }
        let [base, region, own] = [base, region, own].map(|row| Lanes::load_array(simd, row));
        let mut progress =
            Progress { owner: base, bound: splat(simd, f64::INFINITY), uncertain: uncertain.always };
        let rays = Departures { ray: &ray, starts, queried, from, t_max };
        let is_one = cell_of(eight.numbers[0]) == cell_of(eight.numbers[last]);
        for (k, &item) in self.cells.list(cells[0]).iter().enumerate() {
            let found = match is_one {
                true => self.meet(group, item, &rays, &mut progress),
                false => {
                    let mut items = [item; LANES];
                    for (item, cell) in items.iter_mut().zip(&cells) {
                        *item = self.cells.list(cell)[k];
                    }
                    self.meet_each(group, &items, some, &rays, &mut progress)
                }
            };
            met.extend(found);
        }
        // of several copies of one region, the solid of the cell must be the one
        let is_own = met.first().map_or(Mask::splat(simd, false), |met| {
            let object = Lanes::load_array_ref(simd, &met.object.0);
            Mask::from_bitmask(simd, met.inside) & object.simd_eq(own)
        });
        let elsewhere = !(progress.owner.simd_eq(region) & is_own) & queried;
        progress.uncertain &= !elsewhere;
        let (mut search, before, after) = first_change(simd, met, &progress, (queried & !elsewhere, base));
        let other_reasons = (search.always | search.grazes).to_bitmask();
        search.always |= search.tied;
        let behind = splat(simd, self.cells.slack) / ray.direction.taxicab();
        let mut first = self.found(simd, &ray, &search, behind, (program, query.window));
        (first.before, first.region) = (Row(before.to_array()), Row(after.to_array()));
        let close = first.uncertain & !other_reasons;
        (first, Unsure { elsewhere: elsewhere.to_bitmask(), close })
    }

    /// The first hits of eight rays, each in the region in which it starts.
    #[inline(always)]
    fn first_within<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        walk: &mut Walk,
        program: &Program,
        eight: &Eight<'_, S>,
        query: &Query<'_>,
    ) -> First {
        let simd = group.simd;
        let Walk { ahead, apart, met, starts, .. } = walk;
        met.clear();
        starts.read(query, eight.numbers);
        let (ray, uncertain) = LaneRay::new(simd, eight.origin, eight.direction, &self.model.limits);
        let margin = ray.origin.taxicab() * (self.condition * MARGIN);
        let slabs = slabs(simd, ray.origin, ray.direction, margin);
        let behind = splat(simd, BEHIND * self.model.limits.radius) / ray.direction.taxicab();
        let some = (1 << eight.numbers.len()) - 1;
        let window = query.window;
        let (from, t_max) = (eight.from, window.t_max());
        let queried = Mask::from_bitmask(simd, some);
        let intervals =
            BundleWindow { rays: queried, from: (from, window.t_min()), until: (splat(simd, t_max), t_max) };
        let mut progress = Progress {
            owner: splat(simd, 0.0),
            bound: splat(simd, f64::INFINITY),
            uncertain: uncertain.always,
        };
        let rays = Departures { ray: &ray, starts, queried, from, t_max };
        let boxes = (&slabs, intervals, behind);
        match self.is_few || eight.is_together(simd, self.objects.len()) {
            true => self.pass_together(group, ahead, &rays, boxes, met, &mut progress),
            false => self.pass_apart(group, apart, &rays, boxes, met, &mut progress),
        }
        let (mut search, before, after) = first_change(simd, met, &progress, (queried, splat(simd, 0.0)));
        search.always |= search.tied;
        let mut first = self.found(simd, &ray, &search, behind, (program, window));
        (first.before, first.region) = (Row(before.to_array()), Row(after.to_array()));
        first
    }

    /// Finds the solids that the rays may pass by a common way through the tree.
    #[inline(always)]
    fn pass_together<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        ahead: &mut BundleTraversal,
        rays: &Departures<'_, S>,
        (slabs, mut intervals, behind): (&BundleSlabs<S>, BundleWindow<S>, Lanes<S>),
        met: &mut Vec<Met>,
        progress: &mut Progress<S>,
    ) {
        let simd = group.simd;
        let bundle = slabs.bundle(simd, rays.queried.to_bitmask());
        let end = splat(simd, rays.t_max);
        ahead.begin(simd, &self.boxes, &bundle, &intervals);
        while let Some(item) = ahead.next(simd, &self.boxes, (slabs, &bundle), &intervals) {
            if met.len() == MAX_MET {
                progress.uncertain = rays.queried;
                break;
            }
            if let Some(found) = self.meet(group, item, rays, progress) {
                met.push(found);
                let until = (progress.bound + behind).min(end);
                intervals.until = (until, latest(rays.queried.select(until, rays.from)));
            }
        }
    }

    /// Finds the solids that the rays may pass, each ray on its own way through the tree. In each round every ray
    /// meets its next solid; those that are copies of one solid are intersected together.
    #[inline(always)]
    fn pass_apart<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        apart: &mut RayTraversals,
        rays: &Departures<'_, S>,
        (slabs, intervals, behind): (&BundleSlabs<S>, BundleWindow<S>, Lanes<S>),
        met: &mut Vec<Met>,
        progress: &mut Progress<S>,
    ) {
        let simd = group.simd;
        let end = splat(simd, rays.t_max);
        let (mut until, mut left) = (Row([rays.t_max; LANES]), rays.queried.to_bitmask());
        apart.begin(simd, &self.boxes, slabs, &intervals);
        let mut items = [0; LANES];
        loop {
            for lane in lanes_of(left) {
                match apart.next(simd, &self.boxes, lane, until.0[lane]) {
                    Some(item) => items[lane] = item,
                    None => left &= !(1 << lane),
                }
            }
            if left == 0 {
                break;
            }
            if met.len() == MAX_MET {
                progress.uncertain |= Mask::from_bitmask(simd, left);
                break;
            }
            let first = items[left.trailing_zeros() as usize % LANES];
            let found = match lanes_of(left).all(|lane| items[lane] == first) {
                true => self.meet(group, first, rays, progress),
                false => self.meet_each(group, &items, left, rays, progress),
            };
            if let Some(found) = found {
                // rays that have ended their ways may have met the solid before
                met.push(found.of_rays(simd, left));
                until = Row((progress.bound + behind).min(end).to_array());
            }
        }
    }

    /// Intersects one solid with all rays; `None` if no ray passes it.
    #[inline(always)]
    fn meet<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        item: u32,
        rays: &Departures<'_, S>,
        progress: &mut Progress<S>,
    ) -> Option<Met> {
        let simd = group.simd;
        let (passage, _, several) = self.pass_all(group, item, rays);
        progress.uncertain |= several | (passage.uncertain & rays.queried);
        let region = self.objects[item as usize].region;
        let solids = (splat(simd, f64::from(item)), splat(simd, region));
        progress.meet(simd, solids, &passage, rays.queried, passage.is_single.then_some(u64::MAX))
    }

    /// The ways of all rays through one solid, and the rays whose first change may be welded to another one within a distance
    /// behind it.
    pub(super) fn pass_one<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        item: u32,
        rays: &Departures<'_, S>,
        behind: Lanes<S>,
    ) -> (Passage<S>, Mask<S>) {
        // a separate function, since the kernels are large
        group.simd.vectorize(
            #[inline(always)]
            || {
                let (mut passage, ray, several) = self.pass_all(group, item, rays);
                passage.uncertain |= several;
                let limits = &self.parts[self.objects[item as usize].part as usize].limits;
                let near = ray.may_coincide(passage.first, passage.first + behind, limits);
                (passage, near)
            },
        )
    }

    /// The ways of all rays through one solid, the rays in its frame, and those that start on several of its surfaces.
    #[inline(always)]
    fn pass_all<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        item: u32,
        rays: &Departures<'_, S>,
    ) -> (Passage<S>, LaneRay<S>, Mask<S>) {
        let simd = group.simd;
        let object = &self.objects[item as usize];
        let part = &self.parts[object.part as usize];
        let placement = Row([f64::from(object.placement); LANES]);
        let (listed, several) = listed(simd, &placement, part, rays.starts);
        let steps = self.steps(object);
        let (mut always, mut ray) = (Mask::splat(simd, false), *rays.ray);
        if !steps.is_empty() {
            let carried = Carried::new(simd, rays.ray.origin, rays.ray.direction, steps);
            let (carried, uncertain) = carried.ready(simd, &part.limits);
            (always, ray) = (uncertain.always, carried);
        }
        let mut passage = pass(group, part, &ray, listed.as_ref(), (rays.from, rays.t_max));
        passage.uncertain |= always;
        (passage, ray, Mask::from_bitmask(simd, several))
    }

    /// Intersects the solids of a list with the rays in a bit mask, each solid with one ray; `None` if no ray passes its
    /// solid.
    #[inline(always)]
    fn meet_each<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        items: &[u32; LANES],
        some: u64,
        rays: &Departures<'_, S>,
        progress: &mut Progress<S>,
    ) -> Option<Met> {
        let simd = group.simd;
        let Passages { passage, region, single, .. } =
            self.pass_each(group, items, some, rays, splat(simd, 0.0));
        progress.uncertain |= passage.uncertain & rays.queried;
        let object = Lanes::load_array_ref(simd, &solids_in(items).0);
        progress.meet(simd, (object, region), &passage, rays.queried, Some(single))
    }

    /// The ways of the rays in a bit mask through the solids of a list, each ray through one of them.
    pub(super) fn pass_each<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        items: &[u32; LANES],
        some: u64,
        rays: &Departures<'_, S>,
        behind: Lanes<S>,
    ) -> Passages<S> {
        // a separate function, since the kernels are large
        group.simd.vectorize(
            #[inline(always)]
            || self.pass_each_here(group, items, some, rays, behind),
        )
    }

    #[inline(always)]
    fn pass_each_here<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        items: &[u32; LANES],
        some: u64,
        rays: &Departures<'_, S>,
        behind: Lanes<S>,
    ) -> Passages<S> {
        let simd = group.simd;
        let (infinity, never) = (splat(simd, f64::INFINITY), Mask::splat(simd, false));
        let mut all = Passage {
            first: infinity,
            second: infinity,
            face: infinity,
            inside: never,
            grazes: never,
            uncertain: never,
            is_single: true,
        };
        let (mut left, mut single, mut region, mut near) = (some, 0, Row([0.0; LANES]), never);
        while left != 0 {
            let lead = &self.objects[items[left.trailing_zeros() as usize % LANES] as usize];
            let part = &self.parts[lead.part as usize];
            let (mut here, mut steps, mut placement) =
                (0u64, [self.steps(lead); LANES], Row([NOWHERE; LANES]));
            for lane in lanes_of(left) {
                let object = &self.objects[items[lane] as usize];
                if object.part == lead.part && object.steps.len() == lead.steps.len() {
                    here |= 1 << lane;
                    steps[lane] = self.steps(object);
                    placement.0[lane] = f64::from(object.placement);
                    region.0[lane] = object.region;
                }
            }
            left &= !here;
            let lanes = Mask::from_bitmask(simd, here);
            let (listed, several) = listed(simd, &placement, part, rays.starts);
            let mut ray = *rays.ray;
            let mut uncertain = Mask::from_bitmask(simd, several);
            if !steps[0].is_empty() {
                let carried = Carried::each(simd, rays.ray.origin, rays.ray.direction, &steps);
                let (carried, unready) = carried.ready(simd, &part.limits);
                (ray, uncertain) = (carried, uncertain | unready.always);
            }
            let found = pass(group, part, &ray, listed.as_ref(), (rays.from, rays.t_max));
            all.uncertain |= (uncertain | found.uncertain) & lanes;
            all.first = lanes.select(found.first, all.first);
            all.second = lanes.select(found.second, all.second);
            all.face = lanes.select(found.face, all.face);
            all.inside |= found.inside & lanes;
            all.grazes |= found.grazes & lanes;
            near |= ray.may_coincide(found.first, found.first + behind, &part.limits) & lanes;
            single |= if found.is_single { here } else { 0 };
        }
        Passages { passage: all, region: Lanes::load_array_ref(simd, &region.0), single, near }
    }
}

impl<S: Simd> Progress<S> {
    /// Adds the ways of the rays through solids, given by their indices and regions; `None` if no ray passes its solid.
    #[inline(always)]
    fn meet(
        &mut self,
        simd: S,
        (object, region): (Lanes<S>, Lanes<S>),
        passage: &Passage<S>,
        queried: Mask<S>,
        single: Option<u64>,
    ) -> Option<Met> {
        let &Passage { first, second, face, inside, grazes, .. } = passage;
        if !(first.simd_lt(splat(simd, f64::INFINITY)) | inside).any_true() {
            return None;
        }
        let owns = inside & region.simd_gt(self.owner);
        let enters = !inside & region.simd_gt(self.owner);
        self.bound = (owns | enters).select(self.bound.min(first), self.bound);
        self.owner = owns.select(region, self.owner);
        Some(Met {
            object: Row(object.to_array()),
            region: Row(region.to_array()),
            first: Row(first.to_array()),
            second: Row(second.to_array()),
            face: Row(face.to_array()),
            inside: (inside & queried).to_bitmask(),
            grazes: grazes.to_bitmask(),
            single: single.unwrap_or(0),
        })
    }
}

/// No placement.
const NOWHERE: f64 = -2.0;

/// The ways of eight rays, in the frame of a part, through the part.
#[inline(always)]
fn pass<S: Simd>(
    group: &mut BundleEvaluation<'_, S>,
    part: &Part,
    ray: &LaneRay<S>,
    listed: Option<&LaneStarts<S>>,
    (from, t_max): (Lanes<S>, f64),
) -> Passage<S> {
    let simd = group.simd;
    let (infinity, never) = (splat(simd, f64::INFINITY), Mask::splat(simd, false));
    match &part.method {
        Method::Plan(plan) if plan.is_single_span() => {
            let (span, uncertain) = group.only_span(plan, ray, listed, (from, t_max));
            let (grazes, uncertain) = (uncertain.grazes, uncertain.always);
            let Some((span, ties)) = span else {
                let (first, second, face, inside) = (infinity, infinity, infinity, never);
                return Passage { first, second, face, inside, grazes, uncertain, is_single: true };
            };
            let is_some = span.is_some() & span.to.simd_gt(from);
            let inside = is_some & span.from.simd_le(from);
            let earliest = inside.select(span.to, span.from);
            let comes = is_some & earliest.simd_lt(t_max);
            let is_tied = (inside & ties[1]) | (!inside & ties[0]);
            Passage {
                first: comes.select(earliest, infinity),
                second: (comes & !inside & span.to.simd_lt(t_max)).select(span.to, infinity),
                face: inside.select(span.to_face, span.from_face),
                inside,
                grazes,
                uncertain: uncertain | (comes & is_tied),
                is_single: true,
            }
        }
        Method::Plan(plan) => {
            let (uncertain, inside) = group.enter_from(plan, ray, listed, (from, t_max));
            let (first, second, face) = first_two(group);
            let (grazes, uncertain) = (uncertain.grazes, uncertain.always);
            Passage { first, second, face, inside, grazes, uncertain, is_single: false }
        }
        // no kernel for rays that start on it
        Method::Carved(_) => Passage {
            first: infinity,
            second: infinity,
            face: infinity,
            inside: never,
            grazes: never,
            uncertain: !never,
            is_single: false,
        },
    }
}

/// The numbers below 32 with two zero bits before each bit.
const SPREAD: [u64; 32] = spread();

const fn spread() -> [u64; 32] {
    let mut table = [0; 32];
    let mut k = 0;
    while k < 32 {
        let mut bit = 0;
        while bit < 5 {
            table[k] |= ((k as u64 >> bit) & 1) << (3 * bit);
            bit += 1;
        }
        k += 1;
    }
    table
}

/// The surface of a solid on which each of eight rays starts, if there are any, and a bit mask of the rays that start on several
/// of its surfaces. The solids of the rays are copies of one part in several placements.
#[inline(always)]
fn listed<S: Simd>(simd: S, placement: &Row, part: &Part, starts: &Starts) -> (Option<LaneStarts<S>>, u64) {
    let Starts { first, others } = starts;
    let here = Lanes::load_array_ref(simd, &placement.0);
    let number = Lanes::load_array_ref(simd, &first.surface.0);
    let is_here = Lanes::load_array_ref(simd, &first.placement.0).simd_eq(here);
    let is_known = match part.consecutive {
        Some([low, high]) => is_here & number.simd_ge(low) & number.simd_le(high),
        None => {
            let is_own = |&lane: &usize| part.surfaces.contains(&(first.surface.0[lane] as u32));
            let own = lanes_of(is_here.to_bitmask()).filter(is_own).fold(0, |all, lane| all | 1 << lane);
            Mask::from_bitmask(simd, own)
        }
    };
    let (mut known, mut inside, mut several) = (is_known.to_bitmask(), first.inside, 0);
    let mut surface = Row(is_known.select(number, splat(simd, -1.0)).to_array());
    for &LaneStart { lane, start } in others {
        let is_here = f64::from(start.placement.0) == placement.0[lane % LANES];
        if is_here && part.surfaces.contains(&start.surface.0) {
            several |= known & 1 << lane;
            known |= 1 << lane;
            surface.0[lane % LANES] = f64::from(start.surface.0);
            inside = inside & !(1 << lane) | u64::from(start.inside) << lane;
        }
    }
    let listed = (known != 0).then(|| LaneStarts {
        surface: Lanes::load_array_ref(simd, &surface.0),
        inside: Mask::from_bitmask(simd, inside),
    });
    (listed, several)
}

/// The times of the first two changes, +inf for none, and the face of the first; the second time may be slightly too early.
#[inline(always)]
fn first_two<S: Simd>(group: &BundleEvaluation<'_, S>) -> (Lanes<S>, Lanes<S>, Lanes<S>) {
    let simd = group.simd;
    let (mut t, mut face) = (Row([f64::INFINITY; LANES]), Row([-1.0; LANES]));
    for lane in 0..LANES {
        if let Some(code) = group.code(0, lane) {
            t.0[lane] = group.memory.ends[code].0[lane];
            face.0[lane] = group.memory.faces[code].0[lane];
        }
    }
    // without the index of the end in its low bits
    let second = Lanes::from_bits(group.key(1).to_bits() & !CODE);
    (Lanes::load_array_ref(simd, &t.0), second, Lanes::load_array_ref(simd, &face.0))
}

/// The first change of region along each ray, and the regions before and after it. Regions up to `base` hold everywhere or
/// nowhere along the rays.
#[inline(always)]
fn first_change<S: Simd>(
    simd: S,
    met: &[Met],
    progress: &Progress<S>,
    (queried, base): (Mask<S>, Lanes<S>),
) -> (Search<S>, Lanes<S>, Lanes<S>) {
    let infinity = splat(simd, f64::INFINITY);
    let owner = progress.owner;
    let mut search = Search::new(simd, progress.uncertain & queried);
    search.queried = queried;
    let (mut owns, mut again) = (Mask::splat(simd, false), infinity);
    for solid in met {
        let [t, region] = [&solid.first, &solid.region].map(|row| Lanes::load_array_ref(simd, &row.0));
        let inside = Mask::from_bitmask(simd, solid.inside);
        let is_own = region.simd_eq(owner);
        // two copies of one region overlap
        search.always |= owns & inside & is_own;
        owns |= inside & is_own;
        again = again.min((!inside & is_own).select(t, infinity));
        let changes = (inside & is_own) | (!inside & region.simd_gt(owner));
        let closer = changes & t.simd_lt(search.first);
        search.first = closer.select(t, search.first);
        search.face = closer.select(Lanes::load_array_ref(simd, &solid.face.0), search.face);
        search.object = closer.select(Lanes::load_array_ref(simd, &solid.object.0), search.object);
        search.grazes = (closer & Mask::from_bitmask(simd, solid.grazes)) | (search.grazes & !closer);
    }
    let (first, object) = (search.first, search.object);
    let is_hit = first.simd_lt(infinity);
    // another copy of the same region begins before this one ends, or solids farther away may be missing
    search.always |= (is_hit & again.simd_le(first)) | progress.bound.simd_lt(first);
    let mut after = base;
    for solid in met {
        let [t, second, region, own] = [&solid.first, &solid.second, &solid.region, &solid.object]
            .map(|row| Lanes::load_array_ref(simd, &row.0));
        let inside = Mask::from_bitmask(simd, solid.inside);
        let begun = first.simd_ge(t);
        let holds = (inside & !begun) | (!inside & begun & first.simd_lt(second));
        after = (holds & region.simd_gt(after)).select(region, after);
        let is_other = !object.simd_eq(own);
        search.tied |= is_hit & is_other & (t.simd_eq(first) | second.simd_eq(first));
        let is_multiple = Mask::from_bitmask(simd, !solid.single);
        search.always |= is_hit & is_multiple & first.simd_ge(second);
    }
    for solid in met {
        let [t, second, region] =
            [&solid.first, &solid.second, &solid.region].map(|row| Lanes::load_array_ref(simd, &row.0));
        let next = t.simd_gt(first).select(t, second.simd_gt(first).select(second, infinity));
        let matters = region.simd_ge(after);
        search.second = search.second.min(matters.select(next, infinity));
    }
    (search, owner, is_hit.select(after, owner))
}
