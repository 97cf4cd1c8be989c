//! What eight rays meet first among many small solids that are united.
//!
//! As long as a ray is outside of all of them, the first change is the earliest entry into any: each solid is asked by a
//! plan of its own, front to back through a hierarchy of boxes, and boxes behind what was found so far are left out. A
//! ray that starts inside, two entries at the same time, or one so near the next change that the two may have to be
//! welded, is left to the weave.

use super::group::{Group, Row, load};
use super::plan::{Common, LARGE, MOST, Plan};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Edge, Expression, Gate, LeafId, MARGIN, Program, PrototypeId, Rays, Rule, Window};
use rayweave_shape::lanes::{LANES, LaneRay, Lanes, Mask, Vec3Lanes, splat};
use std::sync::Arc;

/// Solids that are united, in the order of a hierarchy.
#[derive(Clone, Debug)]
pub(super) struct Objects {
    pub model: Arc<Common>,
    objects: Vec<Object>,
    nodes: Vec<Node>,
    condition: f64,
}

/// One of the solids.
#[derive(Clone, Debug)]
struct Object {
    plan: Plan,
    region: f64,
}

/// A box around solids: inner nodes stand before their first child.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    /// The axis along which the children are parted, the first below.
    axis: usize,
    /// The second child; 0 for none.
    second: u32,
    /// The solid in it, where there are no children.
    object: u32,
}

impl Objects {
    /// For a model whose regions are unions of small solids, none of the medium of the world.
    pub fn new(program: &Program, model: &Arc<Common>) -> Option<Objects> {
        let group = program.prototype(PrototypeId(0));
        if program.regions().iter().any(|region| region.medium == 0) {
            return None;
        }
        let matters = program.matters(group);
        let mut items = Vec::new();
        for (region, &output) in group.expression.outputs().iter().enumerate() {
            for edge in united(&group.expression, output)? {
                let plan = Plan::of(program, model, &[edge], true)?;
                let leaves = leaves(&group.expression, edge)?;
                let around = leaves.iter().fold(Bounds::EMPTY, |all, leaf| all.union(&matters[leaf.index()]));
                if around.is_empty() {
                    continue;
                }
                if plan.start != Some(0) || !around.is_finite() {
                    return None;
                }
                items.push((around, Object { plan, region: region as f64 + 1.0 }));
            }
        }
        let (nodes, order) = hierarchy(&items);
        let objects = order.into_iter().map(|k| items[k].1.clone()).collect();
        Some(Objects { model: model.clone(), objects, nodes, condition: group.condition })
    }
}

/// The operands of nested unions below an edge.
fn united(expression: &Expression, output: Edge) -> Option<Vec<Edge>> {
    let (mut found, mut waiting) = (Vec::new(), vec![output]);
    while let Some(edge) = waiting.pop() {
        match expression.node(edge.node()) {
            Gate::Vacuum if !edge.is_complemented() => {}
            Gate::Join(Rule::AtLeast(1), operands) if !edge.is_complemented() => {
                waiting.extend(operands.iter());
            }
            _ => found.push(edge),
        }
        // parts that are used by several unions come by more than once
        if found.len() + waiting.len() > LARGE {
            return None;
        }
    }
    Some(found)
}

/// The leaves below an edge, if they are few.
fn leaves(expression: &Expression, edge: Edge) -> Option<Vec<LeafId>> {
    let (mut found, mut waiting) = (Vec::new(), vec![edge]);
    while let Some(edge) = waiting.pop() {
        match expression.node(edge.node()) {
            Gate::Leaf(leaf) => found.push(leaf),
            Gate::Join(_, operands) => waiting.extend(operands.iter()),
            Gate::Vacuum | Gate::Plenum => {}
        }
        if found.len() + waiting.len() > 64 * MOST {
            return None;
        }
    }
    Some(found)
}

/// Boxes parted by the surface area heuristic in bins (Wald, "On fast construction of SAH-based bounding volume
/// hierarchies", 2007), and the order of the solids in them.
fn hierarchy(items: &[(Bounds, Object)]) -> (Vec<Node>, Vec<usize>) {
    let mut order: Vec<usize> = (0..items.len()).collect();
    let (mut nodes, mut waiting): (Vec<Node>, _) = (Vec::new(), vec![(0..items.len(), None)]);
    while let Some((range, parent)) = waiting.pop() {
        let here = &mut order[range.clone()];
        let number = nodes.len() as u32;
        if let Some(parent) = parent {
            let parent: &mut Node = &mut nodes[parent as usize];
            parent.second = number;
        }
        let bounds = here.iter().fold(Bounds::EMPTY, |all, &k| all.union(&items[k].0));
        let (axis, at) = if here.len() > 1 { part(items, here) } else { (0, 0) };
        nodes.push(Node { bounds, axis, second: 0, object: range.start as u32 });
        if here.len() > 1 {
            waiting.push((range.start + at..range.end, Some(number)));
            waiting.push((range.start..range.start + at, None));
        }
    }
    (nodes, order)
}

const BINS: usize = 16;

/// Reorders the boxes, two or more, and says along which axis and where to part them.
fn part(items: &[(Bounds, Object)], here: &mut [usize]) -> (usize, usize) {
    let centre = |k: usize| items[k].0.centre();
    let centres =
        here.iter().fold(Bounds::EMPTY, |all, &k| all.union(&Bounds { lo: centre(k), hi: centre(k) }));
    let size = centres.size();
    let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    let bin = |k: usize| {
        let place = (centre(k)[axis] - centres.lo[axis]) / size[axis] * BINS as f64;
        (place as usize).min(BINS - 1)
    };
    let mut bins = [(Bounds::EMPTY, 0usize); BINS];
    for &k in here.iter() {
        let slot = &mut bins[bin(k)];
        *slot = (slot.0.union(&items[k].0), slot.1 + 1);
    }
    let cost = |bins: &[(Bounds, usize)]| {
        let (all, count) =
            bins.iter().fold((Bounds::EMPTY, 0), |(all, n), bin| (all.union(&bin.0), n + bin.1));
        (area(&all) * count as f64, count)
    };
    let border = |border: &usize| {
        let (left, right) = (cost(&bins[..*border]), cost(&bins[*border..]));
        (left.1 > 0 && right.1 > 0).then_some(left.0 + right.0)
    };
    let best = (1..BINS).filter_map(|k| border(&k).map(|cost| (cost, k))).min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((_, border)) => {
            here.sort_by_key(|&k| bin(k) >= border);
            (axis, here.partition_point(|&k| bin(k) < border))
        }
        None => (axis, here.len() / 2),
    }
}

fn area(bounds: &Bounds) -> f64 {
    let size = bounds.size();
    if bounds.is_empty() { 0.0 } else { size.x * size.y + size.y * size.z + size.z * size.x }
}

/// What is found first on eight rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct First {
    /// When; +inf for a miss.
    pub t: Row,
    /// The number of the face; -1 for a miss.
    pub face: Row,
    /// The region entered; 0 for a miss.
    pub region: Row,
    /// Lanes that have to be asked one by one, a bit each.
    pub doubt: u64,
}

/// So far behind a hit, in radii of the model, solids are still looked at: it is made sure that no weld reaches farther.
const BEHIND: f64 = 0.01;

/// What was found so far.
struct Search<S: Simd> {
    first: Lanes<S>,
    /// No change is earlier than this after the first.
    second: Lanes<S>,
    face: Lanes<S>,
    region: Lanes<S>,
    grazes: Mask<S>,
    always: Mask<S>,
}

/// Eight rays ready for tests against boxes.
struct Slabs<S: Simd> {
    origin: Vec3Lanes<S>,
    inverse: Vec3Lanes<S>,
    margin: Lanes<S>,
    behind: Lanes<S>,
}

impl Objects {
    /// What eight rays meet first; `None` if they go too far apart for it to pay.
    #[inline(always)]
    pub fn first<S: Simd>(
        &self,
        group: &mut Group<'_, S>,
        stack: &mut Vec<u32>,
        rays: Rays<'_>,
        at: usize,
        window: Window,
    ) -> Option<First> {
        let simd = group.simd;
        let (origin, direction) = (load(simd, rays.origins, at), load(simd, rays.directions, at));
        let (ray, doubt) = LaneRay::new(simd, origin, direction, &self.model.limits);
        if !self.go_together(simd, &ray) {
            return None;
        }
        let infinity = splat(simd, f64::INFINITY);
        let mut search = Search {
            first: infinity,
            second: infinity,
            face: splat(simd, -1.0),
            region: splat(simd, 0.0),
            grazes: doubt.grazes,
            always: doubt.always,
        };
        let slabs = self.slabs(simd, &ray);
        stack.clear();
        stack.extend((!self.nodes.is_empty()).then_some(0));
        while let Some(number) = stack.pop() {
            let node = &self.nodes[number as usize];
            if !slabs.touch(simd, &node.bounds, window, &search) {
                continue;
            }
            if node.second == 0 {
                self.ask(group, &self.objects[node.object as usize], &ray, window, &mut search);
                continue;
            }
            let rises = ray.direction.component(node.axis).as_slice()[0] > 0.0;
            let (near, far) = if rises { (number + 1, node.second) } else { (node.second, number + 1) };
            stack.extend([far, near]);
        }
        let hit = search.first.simd_lt(infinity);
        let next = search.second.min(search.first + slabs.behind);
        let near = search.grazes | ray.may_hug(search.first, next, &self.model.limits);
        Some(First {
            t: Row(search.first.to_array()),
            face: Row(search.face.to_array()),
            region: Row(search.region.to_array()),
            doubt: (search.always | near & hit).to_bitmask(),
        })
    }

    /// Looks for the first entry into one solid.
    #[inline(always)]
    fn ask<S: Simd>(
        &self,
        group: &mut Group<'_, S>,
        object: &Object,
        ray: &LaneRay<S>,
        window: Window,
        search: &mut Search<S>,
    ) {
        let simd = group.simd;
        let (doubt, inside) = group.enter(&object.plan, ray, window);
        search.always |= doubt.always | inside;
        let infinity = splat(simd, f64::INFINITY);
        let (mut t, mut face) = (Row([f64::INFINITY; LANES]), Row([-1.0; LANES]));
        if !group.key(0).simd_lt(infinity).any_true() {
            return;
        }
        for lane in 0..LANES {
            if let Some(code) = group.code(0, lane) {
                t.0[lane] = group.memory.ends[code].0[lane];
                face.0[lane] = group.memory.faces[code].0[lane];
            }
        }
        let (t, face) = (Lanes::load_array_ref(simd, &t.0), Lanes::load_array_ref(simd, &face.0));
        let closer = t.simd_lt(search.first);
        search.always |= t.simd_eq(search.first) & t.simd_lt(infinity);
        let leaves = group.key(1).min(search.first);
        search.second = closer.select(leaves, search.second.min(t));
        search.first = closer.select(t, search.first);
        search.face = closer.select(face, search.face);
        search.region = closer.select(splat(simd, object.region), search.region);
        search.grazes = (closer & doubt.grazes) | (search.grazes & !closer);
    }

    /// True if the rays are so near each other that they touch the same boxes, most of the time.
    #[inline(always)]
    fn go_together<S: Simd>(&self, simd: S, ray: &LaneRay<S>) -> bool {
        let lead = ray.lane(0);
        let along = ray.direction.dot(Vec3Lanes::splat(simd, lead.direction));
        let both = ray.square * lead.direction.length_squared();
        let apart = ray.origin.minus_all(lead.origin).taxicab();
        let is_near = apart.simd_lt(0.1 * self.model.limits.radius);
        (along.simd_gt(0.0) & (along * along).simd_gt(both * 0.99) & is_near).all_true()
    }

    #[inline(always)]
    fn slabs<S: Simd>(&self, simd: S, ray: &LaneRay<S>) -> Slabs<S> {
        let Vec3Lanes { x, y, z } = ray.direction;
        Slabs {
            origin: ray.origin,
            inverse: Vec3Lanes { x: inverse(simd, x), y: inverse(simd, y), z: inverse(simd, z) },
            margin: ray.origin.taxicab() * (self.condition * MARGIN),
            behind: splat(simd, BEHIND * self.model.limits.radius) / ray.direction.taxicab(),
        }
    }
}

/// The inverse of a component of a direction, kept finite: 1e-100 moves the ray by less than any margin.
#[inline(always)]
fn inverse<S: Simd>(simd: S, d: Lanes<S>) -> Lanes<S> {
    splat(simd, 1.0) / d.abs().max(splat(simd, 1e-100)).copysign(d)
}

impl<S: Simd> Slabs<S> {
    /// True if any ray passes the grown box before what it has met so far, or a little later.
    #[inline(always)]
    fn touch(&self, simd: S, bounds: &Bounds, window: Window, search: &Search<S>) -> bool {
        let (mut enter, mut leave) = (splat(simd, window.t_min()), splat(simd, window.t_max()));
        leave = leave.min(search.first + self.behind);
        let Vec3 { x, y, z } = bounds.lo;
        let low = [x, y, z];
        let Vec3 { x, y, z } = bounds.hi;
        let high = [x, y, z];
        for k in 0..3 {
            let (origin, inverse) = (self.origin.component(k), self.inverse.component(k));
            let a = (splat(simd, low[k]) - self.margin - origin) * inverse;
            let b = (splat(simd, high[k]) + self.margin - origin) * inverse;
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        enter.simd_le(leave).any_true()
    }
}
