//! A BVH of width eight for bundles of eight rays: all boxes of a node are tested at once against the whole
//! bundle.
//!
//! The bundle is bounded by interval arithmetic: by the least and greatest origins and the slowest and
//! fastest speeds of its rays. Conservative: a miss is definite for every ray of the bundle. On a possible
//! hit the caller tests each ray.

use super::group::Row;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::{Bounds, Vec3};
use rayweave_shape::lanes::{LANES, Lanes, Mask, Vec3Lanes, splat};

/// The nodes of the BVH; the first is the root.
#[derive(Clone, Debug, Default)]
pub(super) struct Boxes {
    nodes: Vec<Node>,
}

/// Eight boxes, one per lane; unused ones are empty.
#[derive(Clone, Debug)]
struct Node {
    /// The lower corners, then the upper ones, component by component.
    planes: [Row; 6],
    /// The child in each box.
    content: [Content; LANES],
    /// The number of boxes in use.
    count: usize,
}

/// The child in a box.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Content {
    /// A node, by index.
    Node(u32),
    /// An item, by index.
    Item(u32),
}

/// A node of the binary tree from which the wide nodes are made.
struct Pair {
    bounds: Bounds,
    /// The indices of both children; `None` for a single item.
    halves: Option<[u32; 2]>,
    item: u32,
}

impl Boxes {
    pub fn new(items: &[Bounds]) -> Boxes {
        let mut boxes = Boxes { nodes: Vec::new() };
        if !items.is_empty() {
            boxes.collapse(&pairs(items));
        }
        boxes
    }

    /// Returns the items in the order of the hierarchy, and renumbers them in it.
    pub fn reorder<T: Clone>(&mut self, items: &[T]) -> Vec<T> {
        let mut ordered = Vec::with_capacity(items.len());
        for content in self.nodes.iter_mut().flat_map(|node| &mut node.content[..node.count]) {
            if let Content::Item(item) = content {
                ordered.push(items[*item as usize].clone());
                *item = ordered.len() as u32 - 1;
            }
        }
        ordered
    }

    /// Builds the nodes of width eight from the binary tree: boxes of the largest area are opened first.
    fn collapse(&mut self, pairs: &[Pair]) {
        let mut waiting = vec![(0, None)];
        while let Some((pair, place)) = waiting.pop() {
            let number = self.nodes.len() as u32;
            if let Some((node, lane)) = place {
                let node: &mut Node = &mut self.nodes[node as usize];
                node.content[lane] = Content::Node(number);
            }
            let mut node = Node::EMPTY;
            for (lane, &held) in opened(pairs, pair).iter().enumerate() {
                let Pair { bounds, halves, item } = &pairs[held as usize];
                node.put(lane, bounds, Content::Item(*item));
                waiting.extend(halves.map(|_| (held, Some((number, lane)))));
            }
            self.nodes.push(node);
        }
    }
}

/// The contents of a box of the binary tree, as up to eight boxes.
fn opened(pairs: &[Pair], pair: u32) -> Vec<u32> {
    let mut held = vec![pair];
    while held.len() < LANES {
        let size = |&k: &usize| area(&pairs[held[k] as usize].bounds);
        let largest = (0..held.len())
            .filter(|&k| pairs[held[k] as usize].halves.is_some())
            .max_by(|a, b| size(a).total_cmp(&size(b)));
        let Some(largest) = largest else { break };
        let halves = pairs[held.swap_remove(largest) as usize].halves;
        held.extend(halves.into_iter().flatten());
    }
    held
}

impl Node {
    const EMPTY: Node = Node {
        planes: {
            let (low, high) = (Row([f64::INFINITY; LANES]), Row([f64::NEG_INFINITY; LANES]));
            [low, low, low, high, high, high]
        },
        content: [Content::Item(0); LANES],
        count: 0,
    };

    fn put(&mut self, lane: usize, bounds: &Bounds, content: Content) {
        for k in 0..3 {
            self.planes[k].0[lane] = bounds.lo[k];
            self.planes[k + 3].0[lane] = bounds.hi[k];
        }
        self.content[lane] = content;
        self.count = lane + 1;
    }

    #[inline(always)]
    fn bounds(&self, lane: usize) -> Bounds {
        let [a, b, c, d, e, f] = &self.planes;
        Bounds {
            lo: Vec3::new(a.0[lane], b.0[lane], c.0[lane]),
            hi: Vec3::new(d.0[lane], e.0[lane], f.0[lane]),
        }
    }
}

/// The binary tree, root first, split by the binned surface area heuristic (Wald, "On fast construction of
/// SAH-based bounding volume hierarchies", 2007).
fn pairs(items: &[Bounds]) -> Vec<Pair> {
    let mut order: Vec<usize> = (0..items.len()).collect();
    let (mut pairs, mut waiting): (Vec<Pair>, _) = (Vec::new(), vec![(0..items.len(), None)]);
    while let Some((range, place)) = waiting.pop() {
        let here = &mut order[range.clone()];
        let number = pairs.len() as u32;
        if let Some((parent, half)) = place {
            let parent: &mut Pair = &mut pairs[parent as usize];
            parent.halves.get_or_insert([0; 2])[half] = number;
        }
        let bounds = here.iter().fold(Bounds::EMPTY, |all, &k| all.union(&items[k]));
        let at = if here.len() > 1 { part(items, here) } else { 0 };
        pairs.push(Pair { bounds, halves: None, item: order[range.start] as u32 });
        if at > 0 {
            waiting.push((range.start + at..range.end, Some((number, 1))));
            waiting.push((range.start..range.start + at, Some((number, 0))));
        }
    }
    pairs
}

const BINS: usize = 16;

/// Partitions two or more boxes. Returns the number of boxes on the left side.
fn part(items: &[Bounds], here: &mut [usize]) -> usize {
    let centre = |k: usize| items[k].centre();
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
        *slot = (slot.0.union(&items[k]), slot.1 + 1);
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
            here.partition_point(|&k| bin(k) < border)
        }
        None => here.len() / 2,
    }
}

fn area(bounds: &Bounds) -> f64 {
    let size = bounds.size();
    if bounds.is_empty() { 0.0 } else { size.x * size.y + size.y * size.z + size.z * size.x }
}

/// Eight rays prepared for slab tests.
pub(super) struct Slabs<S: Simd> {
    origin: Vec3Lanes<S>,
    inverse: Vec3Lanes<S>,
    /// The growth of the boxes.
    margin: Lanes<S>,
}

/// The inverse of a component of a direction, kept finite: a component of 1e-100 moves the ray by less than
/// any margin.
#[inline(always)]
fn inverse<S: Simd>(simd: S, d: Lanes<S>) -> Lanes<S> {
    splat(simd, 1.0) / d.abs().max(splat(simd, 1e-100)).copysign(d)
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    pub fn new(simd: S, origin: Vec3Lanes<S>, direction: Vec3Lanes<S>, margin: Lanes<S>) -> Self {
        let Vec3Lanes { x, y, z } = direction;
        let inverse = Vec3Lanes { x: inverse(simd, x), y: inverse(simd, y), z: inverse(simd, z) };
        Slabs { origin, inverse, margin }
    }

    /// The rays that pass the grown box.
    #[inline(always)]
    fn touch(&self, simd: S, bounds: &Bounds, intervals: &LaneIntervals<S>) -> Mask<S> {
        let (mut enter, mut leave) = (intervals.from.0, intervals.until.0);
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
        enter.simd_le(leave) & intervals.rays
    }

    /// The bundle of the rays in a bit mask.
    #[inline(always)]
    pub fn bundle(&self, rays: u64) -> Bundle {
        let mut sides = [[Side::NONE; 2]; 3];
        for (k, sides) in sides.iter_mut().enumerate() {
            let (origin, inverse) = (self.origin.component(k), self.inverse.component(k));
            for lane in (0..LANES).filter(|lane| rays >> lane & 1 == 1) {
                let (o, i) = (origin.as_slice()[lane], inverse.as_slice()[lane]);
                let margin = self.margin.as_slice()[lane];
                match i > 0.0 {
                    true => sides[0].add(o, i, margin),
                    false => sides[1].add(-o, -i, margin),
                }
            }
        }
        Bundle { sides }
    }
}

/// Bounds of the origins and directions of up to eight rays.
pub(super) struct Bundle {
    /// For each axis, the rays that ascend along it, and the mirror images of those that descend.
    sides: [[Side; 2]; 3],
}

/// Bounds of the rays that ascend along an axis.
#[derive(Clone, Copy)]
struct Side {
    /// The greatest origin plus the margin, and the least origin minus the margin.
    near: f64,
    far: f64,
    /// The least and the greatest inverse speed.
    least: f64,
    greatest: f64,
}

impl Side {
    const NONE: Side =
        Side { near: f64::NEG_INFINITY, far: f64::INFINITY, least: f64::INFINITY, greatest: 0.0 };

    #[inline(always)]
    fn add(&mut self, origin: f64, inverse: f64, margin: f64) {
        self.near = larger(self.near, origin + margin);
        self.far = smaller(self.far, origin - margin);
        self.least = smaller(self.least, inverse);
        self.greatest = larger(self.greatest, inverse);
    }

    /// Bounds per box: the earliest entry time and the latest exit time of any of the rays.
    #[inline(always)]
    fn times<S: Simd>(&self, low: Lanes<S>, high: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
        let (near, far) = (low - self.near, high - self.far);
        ((near * self.least).min(near * self.greatest), (far * self.least).max(far * self.greatest))
    }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl Bundle {
    /// Lower bounds of the entry times into the boxes of a node, and a bit mask of the boxes that the bundle
    /// may touch.
    #[inline(always)]
    fn enter<S: Simd>(&self, simd: S, node: &Node, intervals: &LaneIntervals<S>) -> (Lanes<S>, u64) {
        let (mut enter, mut leave) = (splat(simd, intervals.from.1), splat(simd, intervals.until.1));
        for (k, [up, down]) in self.sides.iter().enumerate() {
            let low = Lanes::load_array_ref(simd, &node.planes[k].0);
            let high = Lanes::load_array_ref(simd, &node.planes[k + 3].0);
            let (a, b) = match () {
                () if down.greatest == 0.0 => up.times(low, high),
                () if up.greatest == 0.0 => down.times(-high, -low),
                () => {
                    let (a, b) = up.times(low, high);
                    let (c, d) = down.times(-high, -low);
                    (a.min(c), b.max(d))
                }
            };
            enter = enter.max(a);
            leave = leave.min(b);
        }
        (enter, enter.simd_le(leave).to_bitmask())
    }
}

/// Stack of boxes that a bundle has yet to enter, the nearest one of each node on top.
#[derive(Clone, Debug, Default)]
pub(super) struct Ahead(Vec<Place>);

/// One box of a node.
#[derive(Clone, Copy, Debug)]
struct Place {
    enter: f64,
    node: u32,
    lane: u32,
}

/// The rays to be tested, and their intervals of t: the bound per lane, and the bound for all lanes.
#[derive(Clone, Copy)]
pub(super) struct LaneIntervals<S: Simd> {
    pub rays: Mask<S>,
    pub from: (Lanes<S>, f64),
    pub until: (Lanes<S>, f64),
}

impl Ahead {
    /// Starts the traversal for a bundle.
    #[inline(always)]
    pub fn begin<S: Simd>(&mut self, simd: S, boxes: &Boxes, bundle: &Bundle, intervals: &LaneIntervals<S>) {
        self.0.clear();
        if !boxes.nodes.is_empty() {
            self.open(simd, boxes, 0, bundle, intervals);
        }
    }

    /// The next item whose box some ray passes. The order is approximately front to back.
    #[inline(always)]
    pub fn next<S: Simd>(
        &mut self,
        simd: S,
        boxes: &Boxes,
        (slabs, bundle): (&Slabs<S>, &Bundle),
        intervals: &LaneIntervals<S>,
    ) -> Option<u32> {
        while let Some(Place { enter, node, lane }) = self.0.pop() {
            let (node, lane) = (&boxes.nodes[node as usize], lane as usize % LANES);
            if enter > intervals.until.1 || !slabs.touch(simd, &node.bounds(lane), intervals).any_true() {
                continue;
            }
            match node.content[lane] {
                Content::Item(item) => return Some(item),
                Content::Node(node) => self.open(simd, boxes, node, bundle, intervals),
            }
        }
        None
    }

    #[inline(always)]
    fn open<S: Simd>(
        &mut self,
        simd: S,
        boxes: &Boxes,
        node: u32,
        bundle: &Bundle,
        intervals: &LaneIntervals<S>,
    ) {
        let (enter, mut touched) = bundle.enter(simd, &boxes.nodes[node as usize], intervals);
        let known = self.0.len();
        while touched != 0 {
            let lane = touched.trailing_zeros();
            touched &= touched - 1;
            let here = Place { enter: enter.as_slice()[lane as usize % LANES], node, lane };
            self.0.push(here);
            // insertion sort: there are rarely more than three
            let mut at = self.0.len() - 1;
            while at > known && self.0[at - 1].enter < here.enter {
                self.0[at] = self.0[at - 1];
                at -= 1;
            }
            self.0[at] = here;
        }
    }
}
