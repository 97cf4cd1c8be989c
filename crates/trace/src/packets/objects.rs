//! First hits of eight rays on a union of many small solids, some of them placed.
//!
//! For a ray that starts outside all solids, the first change is the earliest entry into any of them. A BVH
//! yields the solids from front to back; each is intersected with a plan of its own in its own frame, and
//! boxes behind the current hit are skipped. A ray falls back to the weave if it starts inside, if two
//! entries occur at the same time, or if the entry and the next change are so close that they may have to be
//! welded.

mod boxes;
mod cells;
mod copies;
mod crowd;
mod sliver;
mod within;

pub(super) use copies::CopiesScratch;
pub(super) use within::Walk;

use self::cells::Cells;
use self::copies::Copies;
use super::carved::{Bundled, Carved};
use super::group::{BundleEvaluation, Row, load};
use super::normal::Hits;
use super::places::{Carried, LinearParts, Step, slabs, unit_gradient, unit_of_plane};
use super::plan::{Common, LARGE, MAX_SPANS, Plan, SMALL, limits, most_solids};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_bvh::{BundleSlabs, BundleTraversal, BundleWindow, ExactBvh};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::weld::Trajectory;
use rayweave_model::{
    BoxCells, Edge, Expression, Face, Gate, LeafId, LeafKind, MARGIN, PlacementId, Program, Prototype,
    PrototypeId, Rays, Rule, Window,
};
use rayweave_shape::lanes::{LANES, LaneLimits, LaneRay, Lanes, Mask, Vec3Lanes, splat};
use rayweave_shape::surface::Surface;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// A union of solids.
#[derive(Clone, Debug)]
pub(super) struct Objects {
    pub model: Arc<Common>,
    objects: Vec<Object>,
    parts: Vec<Part>,
    /// The transforms into the frames of placed solids.
    steps: Vec<Step>,
    boxes: ExactBvh,
    condition: f64,
    /// True if there are so few leaves that all eight rays are traced together, however far apart they are.
    is_few: bool,
    /// True if there are several regions, each with a medium of its own: see [`within`].
    is_layered: bool,
    /// For layered models, the surroundings of each solid.
    cells: Cells,
    /// The unit gradients of the faces of placed solids whose faces are planes.
    units: Vec<Vec3>,
    box_cells: Option<BoxCells>,
    /// For lists of crossings, if most solids are copies.
    copies: Option<Copies>,
}

/// One of the solids.
#[derive(Clone, Debug)]
struct Object {
    region: f64,
    /// The index of its part; copies share it.
    part: u32,
    placement: u32,
    /// The leaf of the model's own group that places it.
    top: Option<LeafId>,
    /// The transforms into its frame, outermost first.
    steps: Range<u32>,
    /// The number of its first unit gradient.
    units: Option<u32>,
}

/// A solid in its own frame, prepared for intersection.
#[derive(Clone, Debug)]
struct Part {
    method: Method,
    limits: LaneLimits,
    /// See [`Prototype::condition`].
    condition: f64,
    /// The numbers of its surfaces.
    surfaces: Vec<u32>,
    /// The first and the last of them, if they are consecutive numbers.
    consecutive: Option<[f64; 2]>,
    /// The surfaces of its leaves; the flag is true if the part lies where f < 0.
    sides: Vec<(u32, bool)>,
    /// The numbers of its faces, if it is a leaf whose faces are planes.
    planes: Option<Range<u32>>,
}

/// The method of intersection of a solid.
#[derive(Clone, Debug)]
enum Method {
    Plan(Box<Plan>),
    Carved(Box<Carved>),
}

impl Method {
    fn leaf_count(&self) -> usize {
        match self {
            Method::Plan(plan) => plan.leaves.len(),
            Method::Carved(carved) => carved.leaf_count(),
        }
    }

    fn surfaces(&self) -> Vec<u32> {
        let facets = match self {
            Method::Plan(plan) => &plan.facets,
            Method::Carved(carved) => carved.facets(),
        };
        let mut surfaces: Vec<u32> =
            facets.iter().flat_map(|facet| facet.surfaces).map(|surface| surface as u32).collect();
        surfaces.sort_unstable();
        surfaces.dedup();
        surfaces
    }
}

impl Objects {
    /// Decomposes a model; `None` unless its regions are unions of small solids, none with the medium of the
    /// world.
    pub fn new(program: &Program, model: &Arc<Common>) -> Option<Objects> {
        if program.regions().iter().any(|region| region.medium == 0) {
            return None;
        }
        let mut found = Gathered::new(program, model);
        let group = program.prototype(PrototypeId(0));
        for (region, &output) in group.expression.outputs().iter().enumerate() {
            let region = region as f64 + 1.0;
            found.waiting.push(Within { edge: output, region, ..Within::default() });
            found.gather()?;
        }
        let Gathered { parts, objects, boxes, steps, .. } = found;
        let bounds: Vec<Bounds> = boxes.iter().map(|all| all.bounds).collect();
        let (tree, order) = ExactBvh::sorted(&bounds);
        let extents: Vec<Bounds> = order.iter().map(|&k| boxes[k as usize].extent).collect();
        let bounds: Vec<Bounds> = order.iter().map(|&k| bounds[k as usize]).collect();
        let boxes = tree;
        let mut objects: Vec<Object> = order.iter().map(|&k| objects[k as usize].clone()).collect();
        let parts = reordered(&parts, &mut objects);
        let steps = reordered_steps(&steps, &mut objects);
        let leaves = objects.iter().map(|object| parts[object.part as usize].method.leaf_count());
        let is_few = leaves.sum::<usize>() <= MAX_SPANS;
        let condition = group.condition;
        let (is_layered, model, cells) = (is_layered(program), model.clone(), Cells::default());
        let mut found = Objects {
            model,
            objects,
            parts,
            steps,
            boxes,
            condition,
            is_few,
            is_layered,
            cells,
            units: Vec::new(),
            box_cells: None,
            copies: None,
        };
        found.copies = Copies::new(&found, group.leaves.len(), program.regions().len());
        if is_layered {
            found.cells = Cells::new(program, &found, &bounds, &extents);
            found.find_units(program);
            found.box_cells = found.find_box_cells(program);
        }
        Some(found)
    }

    /// Computes the unit gradients of planes, if there are placed solids: those of other models are simpler to find.
    fn find_units(&mut self, program: &Program) {
        for k in 0..self.objects.len() {
            let object = &self.objects[k];
            let Some(faces) = self.parts[object.part as usize].planes.clone() else { continue };
            if self.steps.is_empty() || self.units.len() > LARGE {
                continue;
            }
            let first = self.units.len();
            for face in faces {
                let facet = &program.facets()[face as usize];
                let Surface::Plane(plane) = &program.surface(facet.surface()).surface else { continue };
                self.units.push(unit_of_plane(plane.normal, self.steps(&self.objects[k])));
            }
            self.objects[k].units = Some(first as u32);
        }
    }

    /// The unit gradient of a face of a solid, if it was computed in advance.
    fn unit(&self, object: f64, face: f64) -> Option<Vec3> {
        let object = &self.objects[object as usize];
        let faces = self.parts[object.part as usize].planes.as_ref()?;
        self.units.get((object.units? + (face as u32).wrapping_sub(faces.start)) as usize).copied()
    }

    /// True if [`Objects::first_within`] applies.
    pub fn is_layered(&self) -> bool {
        self.is_layered
    }

    /// The cells that are boxes.
    pub fn box_cells(&self) -> Option<&BoxCells> {
        self.box_cells.as_ref()
    }

    /// The number of solids.
    pub fn count(&self) -> usize {
        self.objects.len()
    }

    fn steps(&self, object: &Object) -> &[Step] {
        &self.steps[object.steps.start as usize..object.steps.end as usize]
    }
}

/// True if there are several regions, each with a medium of its own.
fn is_layered(program: &Program) -> bool {
    let mut media: Vec<u32> = program.regions().iter().map(|region| region.medium).collect();
    media.sort_unstable();
    media.len() > 1 && media.windows(2).all(|pair| pair[0] < pair[1])
}

/// A solid within a group that may be placed.
#[derive(Clone, Debug)]
struct Within {
    edge: Edge,
    region: f64,
    group: PrototypeId,
    placement: u32,
    /// The leaves that place the group, outermost first, each with its own group.
    path: Vec<(PrototypeId, LeafId)>,
    steps: Range<u32>,
}

impl Default for Within {
    fn default() -> Self {
        let group = PrototypeId(0);
        Within { edge: Edge::EMPTY, region: 0.0, group, placement: 0, path: Vec::new(), steps: 0..0 }
    }
}

/// State of the decomposition of a model.
struct Gathered<'p> {
    program: &'p Program,
    model: &'p Arc<Common>,
    /// Cache of the boxes in which the leaves of each group matter.
    matters: HashMap<PrototypeId, Vec<Bounds>>,
    known: HashMap<(PrototypeId, Edge), Option<u32>>,
    waiting: Vec<Within>,
    parts: Vec<Part>,
    objects: Vec<Object>,
    boxes: Vec<Boxes>,
    steps: Vec<Step>,
    linear_parts: LinearParts,
}

/// The boxes of a solid in the world.
#[derive(Clone, Copy)]
struct Boxes {
    /// The lanes for which it matters.
    bounds: Bounds,
    /// Around all of it.
    extent: Bounds,
}

impl<'p> Gathered<'p> {
    fn new(program: &'p Program, model: &'p Arc<Common>) -> Self {
        Gathered {
            program,
            model,
            matters: HashMap::new(),
            known: HashMap::new(),
            waiting: Vec::new(),
            parts: Vec::new(),
            objects: Vec::new(),
            boxes: Vec::new(),
            steps: Vec::new(),
            linear_parts: LinearParts::default(),
        }
    }

    /// Decomposes the waiting solids; `None` if one is not a union of small solids, or if there are too many.
    fn gather(&mut self) -> Option<()> {
        while let Some(within) = self.waiting.pop() {
            // parts of several unions are visited more than once
            if self.objects.len() + self.waiting.len() > most_solids(self.program) || self.parts.len() > LARGE
            {
                return None;
            }
            self.take_apart(within)?;
        }
        Some(())
    }

    fn take_apart(&mut self, within: Within) -> Option<()> {
        let expression = &self.program.prototype(within.group).expression;
        let upright = !within.edge.is_complemented();
        match expression.node(within.edge.node()) {
            Gate::Empty if upright => Some(()),
            Gate::Join(Rule::AtLeast(1), operands) if upright => {
                self.waiting.extend(operands.iter().map(|&edge| Within { edge, ..within.clone() }));
                Some(())
            }
            Gate::Leaf(leaf) if upright && self.is_placed(&within, leaf) => self.enter(within, leaf),
            _ => {
                let part = self.part(&within)?;
                self.add(&within, part)
            }
        }
    }

    fn leaf(&self, within: &Within, leaf: LeafId) -> LeafId {
        LeafId(self.program.prototype(within.group).leaves.start + leaf.0)
    }

    fn is_placed(&self, within: &Within, leaf: LeafId) -> bool {
        matches!(self.program.leaf(self.leaf(within, leaf)).kind(), LeafKind::Instance { .. })
    }

    /// Continues in the frame of a placed solid.
    fn enter(&mut self, mut within: Within, leaf: LeafId) -> Option<()> {
        let id = self.leaf(&within, leaf);
        let LeafKind::Instance { prototype, placement } = self.program.leaf(id).kind() else { return None };
        let group = self.program.prototype(prototype);
        if self.matters(within.group)[leaf.index()].is_empty() {
            return Some(());
        }
        let first = self.steps.len() as u32;
        self.steps.extend_from_within(within.steps.start as usize..within.steps.end as usize);
        self.steps.push(Step::new(self.program.leaf(id).place(), &mut self.linear_parts));
        within.steps = first..self.steps.len() as u32;
        within.path.push((within.group, leaf));
        within.placement += placement;
        within.group = prototype;
        within.edge = *group.expression.outputs().first()?;
        self.waiting.push(within);
        (group.ball.radius > 0.0).then_some(())
    }

    fn matters(&mut self, group: PrototypeId) -> &[Bounds] {
        let program = self.program;
        self.matters.entry(group).or_insert_with(|| program.matters(program.prototype(group)))
    }

    /// The index of a part; `None` if it cannot be intersected in lanes.
    fn part(&mut self, within: &Within) -> Option<u32> {
        let key = (within.group, within.edge);
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let part = self.new_part(within);
        self.known.insert(key, part);
        part
    }

    fn new_part(&mut self, within: &Within) -> Option<u32> {
        let (program, group) = (self.program, self.program.prototype(within.group));
        let leaves = leaves(&group.expression, within.edge)?;
        let all = leaves.iter().map(|&(leaf, _)| self.leaf(within, leaf));
        let planes = planes(program, all.clone());
        let signed = all.clone().zip(leaves.iter().map(|&(_, is_subtracted)| is_subtracted));
        let sides = signed.flat_map(|(leaf, is_subtracted)| {
            let facets = program.leaf(leaf).facets().iter();
            facets.map(move |facet| (facet.surface().0, facet.inside() != is_subtracted))
        });
        let sides = sides.collect();
        let (limits, condition) = (limits(program, group, all), group.condition);
        let method = self.method(within, group)?;
        let surfaces = method.surfaces();
        let consecutive = consecutive(&surfaces);
        self.parts.push(Part { method, limits, condition, surfaces, consecutive, sides, planes });
        Some(self.parts.len() as u32 - 1)
    }

    /// Chooses a plan if it is small, otherwise a carved solid, otherwise the larger plan; `None` if none is
    /// possible.
    fn method(&mut self, within: &Within, group: &Prototype) -> Option<Method> {
        // no ray may start inside far away
        let plan = Plan::of(self.program, self.model, group, &[within.edge], true);
        let mut plan = plan.filter(|plan| plan.start == Some(0)).map(Box::new);
        if let Some(plan) = plan.take_if(|plan| is_small(plan)) {
            return Some(Method::Plan(plan));
        }
        let program = self.program;
        let carved = Carved::new(program, group, within.edge, self.matters(within.group));
        carved.map(|carved| Method::Carved(Box::new(carved))).or(plan.map(Method::Plan))
    }

    /// Adds a solid unless it is empty; `None` if it is unbounded.
    fn add(&mut self, within: &Within, part: u32) -> Option<()> {
        let bounds = self.bounds(within)?;
        if bounds.is_empty() {
            return Some(());
        }
        if !bounds.is_finite() {
            return None;
        }
        let extent = self.extent(within)?;
        let Within { region, placement, ref steps, .. } = *within;
        let top = within.path.first().map(|&(_, leaf)| leaf);
        self.boxes.push(Boxes { bounds, extent });
        self.objects.push(Object { region, part, placement, top, steps: steps.clone(), units: None });
        Some(())
    }

    /// A box around a solid in the world, whether or not all of it matters; unbounded if some of its leaves are.
    fn extent(&self, within: &Within) -> Option<Bounds> {
        let program = self.program;
        let leaves = leaves(&program.prototype(within.group).expression, within.edge)?;
        let bounds = leaves.iter().map(|&(leaf, _)| program.leaf_bounds(self.leaf(within, leaf)));
        let all = bounds.fold(Bounds::EMPTY, |all, bounds| all.union(&bounds));
        let placed = |around: Bounds, &(group, leaf): &(PrototypeId, LeafId)| {
            let outer: &Prototype = program.prototype(group);
            program.placed_bounds(outer, LeafId(outer.leaves.start + leaf.0), &around)
        };
        Some(within.path.iter().rev().fold(all, placed))
    }

    /// The bounding box of a solid in the world.
    fn bounds(&mut self, within: &Within) -> Option<Bounds> {
        let program = self.program;
        let leaves = leaves(&program.prototype(within.group).expression, within.edge)?;
        let matters = self.matters(within.group);
        let matters = leaves.iter().map(|(leaf, _)| &matters[leaf.index()]);
        let mut around = matters.fold(Bounds::EMPTY, |all, bounds| all.union(bounds));
        for &(group, leaf) in within.path.iter().rev() {
            let outer: &Prototype = program.prototype(group);
            let id = LeafId(outer.leaves.start + leaf.0);
            let image = program.placed_bounds(outer, id, &around);
            around = image.intersection(&self.matters(group)[leaf.index()]);
        }
        Some(around)
    }
}

fn is_small(plan: &Plan) -> bool {
    plan.comparisons() <= SMALL
}

/// Sorts the parts in the order in which objects use them, so that spatial neighbours are close in memory.
fn reordered(parts: &[Part], objects: &mut [Object]) -> Vec<Part> {
    let (mut ordered, mut numbers) = (Vec::with_capacity(parts.len()), HashMap::new());
    for object in objects {
        object.part = *numbers.entry(object.part).or_insert_with(|| {
            ordered.push(parts[object.part as usize].clone());
            ordered.len() as u32 - 1
        });
    }
    ordered
}

/// Sorts the transforms likewise.
fn reordered_steps(steps: &[Step], objects: &mut [Object]) -> Vec<Step> {
    let mut ordered = Vec::with_capacity(steps.len());
    for object in objects {
        let first = ordered.len() as u32;
        ordered.extend_from_slice(&steps[object.steps.start as usize..object.steps.end as usize]);
        object.steps = first..ordered.len() as u32;
    }
    ordered
}

/// The first and the last of some sorted numbers if none is missing between them.
fn consecutive(numbers: &[u32]) -> Option<[f64; 2]> {
    let (first, last) = (*numbers.first()?, *numbers.last()?);
    ((last - first) as usize + 1 == numbers.len()).then_some([first, last].map(f64::from))
}

/// The numbers of the faces of a leaf if it is the only one and all of them are planes.
fn planes(program: &Program, mut leaves: impl Iterator<Item = LeafId>) -> Option<Range<u32>> {
    let (Some(leaf), None) = (leaves.next(), leaves.next()) else { return None };
    let LeafKind::Shape { facets } = program.leaf(leaf).kind() else { return None };
    let is_plane = |face: u32| {
        let facet = &program.facets()[face as usize];
        matches!(program.surface(facet.surface()).surface, Surface::Plane(_))
    };
    facets.clone().all(is_plane).then_some(facets)
}

/// The leaves below an edge, each with true if it is subtracted; `None` if there are too many.
fn leaves(expression: &Expression, edge: Edge) -> Option<Vec<(LeafId, bool)>> {
    let (mut found, mut waiting) = (Vec::new(), vec![(edge, false)]);
    while let Some((edge, is_outside)) = waiting.pop() {
        let is_outside = is_outside != edge.is_complemented();
        match expression.node(edge.node()) {
            Gate::Leaf(leaf) => found.push((leaf, is_outside)),
            Gate::Join(_, operands) => waiting.extend(operands.iter().map(|&operand| (operand, is_outside))),
            Gate::Empty | Gate::Universe => {}
        }
        if found.len() + waiting.len() > 64 * MAX_SPANS {
            return None;
        }
    }
    Some(found)
}

/// First hits of eight rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct First {
    /// The times; +inf for a miss.
    pub t: Row,
    /// The numbers of the faces; -1 for a miss.
    pub face: Row,
    /// The regions before and after; without a hit both are that of the start.
    pub before: Row,
    pub region: Row,
    /// The placements of the faces; 0 for a miss.
    pub placement: Row,
    /// The indices of the solids; undefined for a miss.
    object: Row,
    /// Bit mask of the uncertain lanes, which fall back to the weave.
    pub uncertain: u64,
}

/// Distance behind a hit, in radii of the model, up to which solids are still searched. A separate check proves that no
/// weld reaches farther.
pub(super) const BEHIND: f64 = 0.01;

/// State of a search.
struct Search<S: Simd> {
    first: Lanes<S>,
    /// Lower bound of the time of the next change after the first.
    second: Lanes<S>,
    face: Lanes<S>,
    object: Lanes<S>,
    grazes: Mask<S>,
    always: Mask<S>,
    /// The rays on which another solid begins or ends at the time of the first change.
    tied: Mask<S>,
    /// The rays being traced.
    queried: Mask<S>,
}

impl<S: Simd> Search<S> {
    #[inline(always)]
    fn new(simd: S, always: Mask<S>) -> Self {
        let (infinity, none) = (splat(simd, f64::INFINITY), splat(simd, -1.0));
        let never = Mask::splat(simd, false);
        Search {
            first: infinity,
            second: infinity,
            face: none,
            object: none,
            grazes: never,
            always,
            tied: never,
            queried: never,
        }
    }
}

impl Objects {
    /// The first hits of eight rays. Rays that are close to each other are traced together.
    #[inline(always)]
    pub fn first<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        [ahead, inner]: &mut [BundleTraversal; 2],
        program: &Program,
        rays: Rays<'_>,
        at: usize,
        window: Window,
    ) -> First {
        let simd = group.simd;
        let (origin, direction) = (load(simd, rays.origins, at), load(simd, rays.directions, at));
        let (ray, uncertain) = LaneRay::new(simd, origin, direction, &self.model.limits);
        let mut search = Search::new(simd, uncertain.always);
        let margin = ray.origin.taxicab() * (self.condition * MARGIN);
        let slabs = slabs(simd, ray.origin, ray.direction, margin);
        let behind = splat(simd, BEHIND * self.model.limits.radius) / ray.direction.taxicab();
        let mut left: u64 = (1 << LANES.min(rays.len() - at)) - 1;
        while left != 0 {
            let some = if self.is_few { left } else { self.together(simd, &ray, left) };
            search.queried = Mask::from_bitmask(simd, some);
            self.search(group, [ahead, inner], (&ray, &slabs, behind), some, window, &mut search);
            left &= !some;
        }
        self.found(simd, &ray, &search, behind, (program, window))
    }

    /// Searches for the first hits of the rays in the bit mask `some`.
    #[inline(always)]
    fn search<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        [ahead, inner]: [&mut BundleTraversal; 2],
        (ray, slabs, behind): (&LaneRay<S>, &BundleSlabs<S>, Lanes<S>),
        some: u64,
        window: Window,
        search: &mut Search<S>,
    ) {
        let simd = group.simd;
        let bundle = slabs.bundle(simd, some);
        let (from, end) = (splat(simd, window.t_min()), splat(simd, window.t_max()));
        let mut intervals =
            BundleWindow { rays: search.queried, from: (from, window.t_min()), until: (end, window.t_max()) };
        ahead.begin(simd, &self.boxes, &bundle, &intervals);
        while let Some(item) = ahead.next(simd, &self.boxes, (slabs, &bundle), &intervals) {
            let rays = Bundled { ray, slabs, bundle: &bundle, intervals: &intervals };
            if self.intersect(group, item, &rays, inner, window, search) {
                let until = (search.first + behind).min(end);
                intervals.until = (until, latest(search.queried.select(until, from)));
            }
        }
    }

    /// Intersects one solid. Returns true if the hit of any ray became earlier.
    #[inline(always)]
    fn intersect<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        item: u32,
        rays: &Bundled<'_, S>,
        ahead: &mut BundleTraversal,
        window: Window,
        search: &mut Search<S>,
    ) -> bool {
        let simd = group.simd;
        let object = &self.objects[item as usize];
        let part = &self.parts[object.part as usize];
        let (uncertain, inside) = match (self.steps(object), &part.method) {
            ([], Method::Plan(plan)) => group.enter(plan, rays.ray, window),
            ([], Method::Carved(carved)) => group.enter_carved(carved, rays, ahead, window),
            (steps, method) => {
                let carried = Carried::new(simd, rays.ray.origin, rays.ray.direction, steps);
                let (ray, uncertain) = carried.ready(simd, &part.limits);
                search.always |= uncertain.always & search.queried;
                match method {
                    Method::Plan(plan) => group.enter(plan, &ray, window),
                    Method::Carved(carved) => {
                        let slabs = carried.slabs(simd, part.condition);
                        let bundle = slabs.bundle(simd, search.queried.to_bitmask());
                        let rays =
                            Bundled { ray: &ray, slabs: &slabs, bundle: &bundle, intervals: rays.intervals };
                        group.enter_carved(carved, &rays, ahead, window)
                    }
                }
            }
        };
        search.always |= (uncertain.always | inside) & search.queried;
        let infinity = splat(simd, f64::INFINITY);
        if !group.key(0).simd_lt(infinity).any_true() {
            return false;
        }
        let (mut t, mut face) = (Row([f64::INFINITY; LANES]), Row([-1.0; LANES]));
        for lane in 0..LANES {
            if let Some(code) = group.code(0, lane) {
                t.0[lane] = group.memory.ends[code].0[lane];
                face.0[lane] = group.memory.faces[code].0[lane];
            }
        }
        let (t, face) = (Lanes::load_array_ref(simd, &t.0), Lanes::load_array_ref(simd, &face.0));
        let t = search.queried.select(t, infinity);
        let closer = t.simd_lt(search.first);
        search.always |= t.simd_eq(search.first) & t.simd_lt(infinity);
        let leaves = group.key(1).min(search.first);
        search.second = closer.select(leaves, search.second.min(t));
        search.first = closer.select(t, search.first);
        search.face = closer.select(face, search.face);
        search.object = closer.select(splat(simd, f64::from(item)), search.object);
        search.grazes = (closer & uncertain.grazes) | (search.grazes & !closer);
        closer.any_true()
    }

    /// Collects the results of a search, and marks uncertain lanes.
    #[inline(always)]
    fn found<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        search: &Search<S>,
        behind: Lanes<S>,
        (program, window): (&Program, Window),
    ) -> First {
        let zero = Row([0.0; LANES]);
        let (object, next) = (Row(search.object.to_array()), search.second.min(search.first + behind));
        let mut first = First {
            t: Row(search.first.to_array()),
            face: Row(search.face.to_array()),
            before: zero,
            region: zero,
            placement: zero,
            object,
            uncertain: search.always.to_bitmask(),
        };
        let mut left = search.first.simd_lt(f64::INFINITY).to_bitmask();
        while left != 0 {
            let (here, steps) = self.copies(&object, left);
            let lead = &self.objects[object.0[left.trailing_zeros() as usize % LANES] as usize];
            let limits = &self.parts[lead.part as usize].limits;
            let near = match steps[0] {
                [] => ray.may_coincide(search.first, next, limits),
                _ => {
                    let carried = Carried::each(simd, ray.origin, ray.direction, &steps);
                    carried.ready(simd, limits).0.may_coincide(search.first, next, limits)
                }
            };
            for lane in lanes_of(here) {
                let met = &self.objects[object.0[lane] as usize];
                (first.region.0[lane], first.placement.0[lane]) = (met.region, f64::from(met.placement));
            }
            let mut near = (near | search.grazes).to_bitmask() & here & left & !first.uncertain;
            left &= !here;
            while near != 0 {
                let lane = near.trailing_zeros() as usize % LANES;
                near &= near - 1;
                let next = next.as_slice()[lane];
                let hit = (self.face(&first, lane), first.t.0[lane]);
                if !self.is_resolved(hit, &ray.lane(lane), next, (program, window)) {
                    first.uncertain |= 1 << lane;
                }
            }
        }
        first
    }

    /// The lanes of a bit mask, not 0, whose solids are copies of that of the first of them, and the transforms into their
    /// frames; those of the other lanes are the transforms of the first one.
    #[inline(always)]
    fn copies(&self, objects: &Row, left: u64) -> (u64, [&[Step]; LANES]) {
        let lead = &self.objects[objects.0[left.trailing_zeros() as usize % LANES] as usize];
        let (mut here, mut steps) = (0, [self.steps(lead); LANES]);
        for lane in lanes_of(left) {
            let object = &self.objects[objects.0[lane] as usize];
            if object.part == lead.part && object.steps.len() == lead.steps.len() {
                here |= 1 << lane;
                steps[lane] = self.steps(object);
            }
        }
        (here, steps)
    }

    /// True if no change at time `next` or later, within the model, can be welded to the first crossing of a
    /// ray.
    fn is_resolved(
        &self,
        (face, t): (Face, f64),
        ray: &rayweave_shape::Ray,
        next: f64,
        (program, window): (&Program, Window),
    ) -> bool {
        let limits = &self.model.limits;
        let end = ray.closest_time(limits.centre) + limits.radius / ray.direction.length();
        ray.separated_along(program, face, t, (next, end.min(window.t_max()).max(next)))
    }

    /// The face of a hit.
    pub fn face(&self, first: &First, lane: usize) -> Face {
        let face = self.model.faces[first.face.0[lane] as usize];
        Face { placement: PlacementId(first.placement.0[lane] as u32), ..face }
    }

    /// A face of a solid, by their numbers.
    fn face_of(&self, object: f64, face: f64) -> Face {
        let placement = PlacementId(self.objects[object as usize].placement);
        Face { placement, ..self.model.faces[face as usize] }
    }

    /// The normals of hits, and a bit mask of the lanes that must be computed one by one.
    #[inline(always)]
    pub fn normals<S: Simd>(
        &self,
        simd: S,
        program: &Program,
        first: &First,
        hits: &Hits<S>,
    ) -> (Vec3Lanes<S>, u64) {
        if self.steps.is_empty() {
            return hits.normals(simd, &self.model.slopes);
        }
        let mut known = [Row([f64::NAN; LANES]); 3];
        let mut left = hits.hit;
        for lane in (0..LANES).filter(|lane| hits.hit >> lane & 1 == 1) {
            let Some(unit) = self.unit(first.object.0[lane], first.face.0[lane]) else { continue };
            left &= !(1 << lane);
            known.iter_mut().zip(unit.to_array()).for_each(|(row, value)| row.0[lane] = value);
        }
        let [x, y, z] = known.each_ref().map(|row| Lanes::load_array_ref(simd, &row.0));
        let mut units = Vec3Lanes { x, y, z };
        let mut others = 0;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            let face = first.face.0[lane];
            let (copies, steps) = self.copies(&first.object, left);
            let here = lanes_of(copies).filter(|&lane| first.face.0[lane] == face);
            let here = here.fold(0, |all: u64, lane| all | 1 << lane);
            let ray = Carried::each(simd, hits.origin, hits.direction, &steps);
            match unit_gradient(simd, (program, &self.model.slopes), face, &ray, hits.t, &steps) {
                Some(unit) => units = units.or_where(Mask::from_bitmask(simd, here), unit),
                None => others |= here,
            }
            left &= !here;
        }
        hits.oriented(simd, units, others)
    }

    /// True if the rays `at..at + 8` are so far apart that it takes less time to trace each of them alone, in a union of leaves.
    #[inline(always)]
    pub fn are_apart<S: Simd>(&self, simd: S, rays: Rays<'_>, at: usize) -> bool {
        let (origin, direction) = (load(simd, rays.origins, at), load(simd, rays.directions, at));
        let (ray, _) = LaneRay::new(simd, origin, direction, &self.model.limits);
        let mut left: u64 = (1 << LANES.min(rays.len() - at)) - 1;
        let mut bundles = 0;
        while left != 0 && !self.is_few {
            left &= !self.together(simd, &ray, left);
            bundles += 1;
        }
        bundles > BUNDLES
    }

    /// Bit mask of the first of the rays in `left` and those so close to it that they usually touch the same
    /// boxes.
    #[inline(always)]
    fn together<S: Simd>(&self, simd: S, ray: &LaneRay<S>, left: u64) -> u64 {
        let first = left & left.wrapping_neg();
        let lead = ray.lane(first.trailing_zeros() as usize % LANES);
        let along = ray.direction.dot(Vec3Lanes::splat(simd, lead.direction));
        let both = ray.square * lead.direction.length_squared();
        let apart = ray.origin.minus_all(lead.origin).taxicab();
        let is_near = apart.simd_lt(NEAR * self.model.limits.radius);
        let near = along.simd_gt(0.0) & (along * along).simd_gt(both * (1.0 - NEAR * NEAR)) & is_near;
        near.to_bitmask() & left | first
    }
}

/// Largest angle in radians, and largest distance in radii of the model, between rays that are traced
/// together.
const NEAR: f64 = 0.03;

/// Number of bundles of eight rays above which each ray is traced alone.
const BUNDLES: usize = 2;

/// The lanes in a bit mask.
fn lanes_of(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (mask != 0).then(|| mask.trailing_zeros() as usize % LANES);
        mask &= mask.wrapping_sub(1);
        lane
    })
}

/// The greatest of eight times.
#[inline(always)]
fn latest<S: Simd>(times: Lanes<S>) -> f64 {
    let mut latest = f64::NEG_INFINITY;
    for &t in times.as_slice() {
        latest = if t > latest { t } else { latest };
    }
    latest
}
