//! Bounding volume hierarchy (BVH) over the triangles of a mesh.
//!
//! *Source*: binned surface area heuristic, I. Wald, "On fast Construction of SAH-based Bounding Volume
//! Hierarchies" (2007); eight children per node, as in H. Dammertz, J. Hanika, A. Keller, "Shallow Bounding
//! Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays" (2008).
//!
//! *Guarantee*: queries are conservative, no triangle is missed. Boxes are stored in `f32` relative to the
//! centre of the mesh, in units of half its size, and tested with a margin that covers their rounding errors
//! (a few units of 6e-8, see [`MARGIN`]) and those of the line. Equal input gives equal nodes.

use crate::{Line, Mesh};
use rayweave_math::{Bounds, UNIT_ROUNDOFF, Vec3};
use std::ops::Range;

/// Maximum number of triangles in a leaf.
const LEAF: usize = 4;
const WIDTH: usize = 8;
const BINS: usize = 16;
/// Below this depth ranges are halved, which bounds the depth.
const DEEP: usize = 24;
/// Capacity of the traversal stack: 7 children per level, for 24 levels of any shape and 10 of halving.
const STACK: usize = 256;
/// Margin of box tests in units of half the mesh size: twice the error bound (1e-6) of origin, times and
/// planes in f32 within the box of the mesh.
const MARGIN: f64 = 2e-6;

/// A node: eight boxes and their children.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    lo: [[f32; WIDTH]; 3],
    hi: [[f32; WIDTH]; 3],
    child: [Child; WIDTH],
}

/// An inner node, or a leaf: bit 31 is set, bits 28 to 30 are the number of triangles, the others the first
/// one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Child(u32);

impl Child {
    const NONE: Child = Child(1 << 31);

    fn leaf(range: &Range<usize>) -> Child {
        Child(1 << 31 | (range.len() as u32) << 28 | range.start as u32)
    }

    fn as_leaf(self) -> Option<Range<usize>> {
        let start = (self.0 & ((1 << 28) - 1)) as usize;
        (self.0 >> 31 == 1).then(|| start..start + (self.0 >> 28 & 7) as usize)
    }
}

/// A BVH over the triangles of a mesh, which are reordered.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hierarchy {
    nodes: Vec<Node>,
    middle: Vec3,
    half: f64,
    magnitude: f64,
}

/// The box of a triangle in f32, during construction.
#[derive(Clone, Copy, Debug)]
struct Item {
    lo: [f32; 3],
    hi: [f32; 3],
    triangle: u32,
}

/// A box in f32.
#[derive(Clone, Copy, Debug)]
struct Small {
    lo: [f32; 3],
    hi: [f32; 3],
}

impl Small {
    const EMPTY: Small = Small { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };

    fn grow(&mut self, lo: &[f32; 3], hi: &[f32; 3]) {
        for k in 0..3 {
            self.lo[k] = self.lo[k].min(lo[k]);
            self.hi[k] = self.hi[k].max(hi[k]);
        }
    }

    fn of(items: &[Item]) -> Small {
        let mut all = Small::EMPTY;
        items.iter().for_each(|item| all.grow(&item.lo, &item.hi));
        all
    }

    fn area(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|k| (self.hi[k] - self.lo[k]).max(0.0));
        x * y + y * z + z * x
    }
}

impl Item {
    fn new(triangle: usize, bounds: &Bounds, middle: Vec3, half: f64) -> Item {
        let [lo, hi] = [bounds.lo, bounds.hi].map(|p| ((p - middle) / half).to_array());
        Item { lo: lo.map(below), hi: hi.map(above), triangle: triangle as u32 }
    }

    /// Twice the centre.
    fn centre(&self, axis: usize) -> f32 {
        self.lo[axis] + self.hi[axis]
    }
}

fn below(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

fn above(x: f64) -> f32 {
    -below(-x)
}

impl Hierarchy {
    /// Builds the hierarchy; also returns the order of the triangles in it.
    pub fn new(mesh: &Mesh) -> (Hierarchy, Vec<u32>) {
        let bounds = mesh.bounds();
        let middle = if bounds.is_empty() { Vec3::ZERO } else { bounds.centre() };
        let size = if bounds.is_empty() { 0.0 } else { 0.5 * bounds.size().max_element() };
        let half = if size > 0.0 { size } else { 1.0 };
        let item = |k| Item::new(k, &crate::triangle::bounds(mesh.corners(k)), middle, half);
        let mut items: Vec<Item> = (0..mesh.triangles().len()).map(item).collect();
        let nodes = build(&mut items);
        let magnitude = middle.length() + 2.0 * half;
        (Hierarchy { nodes, middle, half, magnitude }, items.iter().map(|item| item.triangle).collect())
    }

    /// Upper bound of the distance of a point of the mesh from the origin.
    pub fn magnitude(&self) -> f64 {
        self.magnitude
    }

    /// Size in bytes.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>()
    }

    /// The times between which the line is in a ball around the mesh, slightly enlarged; `None` if it misses
    /// the ball.
    pub fn chord(&self, line: &Line) -> Option<(f64, f64)> {
        let time = line.closest_time(self.middle);
        let distance = (line.at(time) - self.middle).length();
        let radius = 1.75 * self.half + self.slack(line);
        // NaN proves nothing: the line is traced
        if distance > radius {
            return None;
        }
        let half = radius / line.direction.length();
        Some((time - half, time + half))
    }

    /// Upper bound of the distance between the exact and the rounded line near the mesh.
    fn slack(&self, line: &Line) -> f64 {
        64.0 * UNIT_ROUNDOFF * (line.origin.length() + self.magnitude)
    }

    /// Calls `visit` with ranges of triangles, in the hierarchy's order, that include every triangle close to
    /// the line.
    pub fn along(&self, line: &Line, mut visit: impl FnMut(Range<usize>)) {
        if self.chord(line).is_none() {
            return;
        }
        let ray = SmallRay::new(self, line);
        self.walk(|node| ray.hits(node), &mut visit);
    }

    /// Calls `visit` with ranges of triangles that include every triangle whose box intersects this one.
    pub fn within(&self, bounds: &Bounds, mut visit: impl FnMut(Range<usize>)) {
        let margin = Vec3::splat(MARGIN);
        let lo = ((bounds.lo - self.middle) / self.half - margin).to_array().map(below);
        let hi = ((bounds.hi - self.middle) / self.half + margin).to_array().map(above);
        let meets = |node: &Node| {
            mask(|k| (0..3).all(|axis| node.lo[axis][k] <= hi[axis] && node.hi[axis][k] >= lo[axis]))
        };
        self.walk(meets, &mut visit);
    }

    /// Traverses the tree. `hits` returns a bit mask of the children to visit.
    fn walk(&self, hits: impl Fn(&Node) -> u8, visit: &mut impl FnMut(Range<usize>)) {
        let mut stack = [0u32; STACK];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while waiting > 0 {
            waiting -= 1;
            let node = &self.nodes[stack[waiting] as usize];
            let mut bits = hits(node);
            while bits != 0 {
                let child = node.child[bits.trailing_zeros() as usize];
                bits &= bits - 1;
                match child.as_leaf() {
                    Some(range) => visit(range),
                    None => {
                        stack[waiting] = child.0;
                        waiting += 1;
                    }
                }
            }
        }
    }

    /// Calls `visit` with ranges of triangles and the squared distance within which triangles still count;
    /// `visit` returns a new one. Ends when no unvisited box is nearer to the point than that.
    pub fn around(&self, point: Vec3, mut within: f64, mut visit: impl FnMut(Range<usize>, f64) -> f64) {
        let p = ((point - self.middle) / self.half).to_array();
        let margin = MARGIN + 64.0 * UNIT_ROUNDOFF * (point.length() + self.magnitude) / self.half;
        let scale = self.half * self.half;
        let mut stack = [(0.0, Child(0)); STACK];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while waiting > 0 {
            waiting -= 1;
            let (distance, child) = stack[waiting];
            if distance > within {
                continue;
            }
            if let Some(range) = child.as_leaf() {
                within = visit(range, within);
                continue;
            }
            let node = &self.nodes[child.0 as usize];
            let first = waiting;
            for k in (0..WIDTH).filter(|&k| node.child[k] != Child::NONE) {
                stack[waiting] = (scale * node.distance_squared(k, &p, margin), node.child[k]);
                waiting += 1;
            }
            // the nearest last, to be visited first
            stack[first..waiting].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        }
    }
}

impl Node {
    const EMPTY: Node = Node {
        lo: [[f32::INFINITY; WIDTH]; 3],
        hi: [[f32::NEG_INFINITY; WIDTH]; 3],
        child: [Child::NONE; WIDTH],
    };

    /// Lower bound of the squared distance of a point from a box.
    fn distance_squared(&self, k: usize, p: &[f64; 3], margin: f64) -> f64 {
        let away = |axis: usize| {
            let (lo, hi) = (f64::from(self.lo[axis][k]), f64::from(self.hi[axis][k]));
            ((lo - p[axis]).max(p[axis] - hi) - margin).max(0.0)
        };
        [0, 1, 2].map(|axis| away(axis) * away(axis)).iter().sum()
    }
}

/// Eight booleans as a bit mask.
fn mask(is_set: impl Fn(usize) -> bool) -> u8 {
    (0..WIDTH).fold(0, |bits, k| bits | u8::from(is_set(k)) << k)
}

/// A line in the frame of the boxes, in f32.
struct SmallRay {
    /// Origin per axis for the slab planes that are crossed first and last, with the margin included.
    near: [f32; 3],
    far: [f32; 3],
    inverse: [f32; 3],
}

impl SmallRay {
    fn new(hierarchy: &Hierarchy, line: &Line) -> SmallRay {
        let foot = line.at(line.closest_time(hierarchy.middle));
        let origin = ((foot - hierarchy.middle) / hierarchy.half).to_array();
        let scaled = line.direction / line.direction.abs().max_element();
        let direction = scaled.normalize().to_array();
        let margin = (MARGIN + hierarchy.slack(line) / hierarchy.half).min(1e30);
        // a line perpendicular to an axis crosses its planes at very large times, never at 0 times infinity
        let inverse = direction.map(|d| if d.abs() < 1e-25 { 1e25 } else { 1.0 / d });
        let toward =
            |sign: f64| std::array::from_fn(|k| (origin[k] + sign * margin.copysign(inverse[k])) as f32);
        SmallRay { near: toward(1.0), far: toward(-1.0), inverse: inverse.map(|x| x as f32) }
    }

    /// Bit mask of the boxes that the line intersects (slab test).
    fn hits(&self, node: &Node) -> u8 {
        let (mut first, mut last) = ([f32::NEG_INFINITY; WIDTH], [f32::INFINITY; WIDTH]);
        for axis in 0..3 {
            let (lo, hi) = (&node.lo[axis], &node.hi[axis]);
            let (near, far) = if self.inverse[axis] >= 0.0 { (lo, hi) } else { (hi, lo) };
            for k in 0..WIDTH {
                let enter = (near[k] - self.near[axis]) * self.inverse[axis];
                let leave = (far[k] - self.far[axis]) * self.inverse[axis];
                first[k] = if enter > first[k] { enter } else { first[k] };
                last[k] = if leave < last[k] { leave } else { last[k] };
            }
        }
        mask(|k| first[k] <= last[k])
    }
}

/// A range of items that becomes a child.
struct Part {
    range: Range<usize>,
    bounds: Small,
}

impl Part {
    fn new(items: &[Item], range: Range<usize>) -> Part {
        Part { bounds: Small::of(&items[range.clone()]), range }
    }
}

/// Builds the nodes, root first, and reorders the items.
fn build(items: &mut [Item]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(items.len() / 16 + 1);
    if items.is_empty() {
        return nodes;
    }
    nodes.push(Node::EMPTY);
    let mut waiting = vec![(0, 0, 0..items.len())];
    while let Some((index, depth, range)) = waiting.pop() {
        // the last levels are divided evenly, which needs fewer nodes
        let halve = depth >= DEEP || range.len() <= WIDTH * LEAF;
        for (k, part) in parts(items, range, halve).into_iter().enumerate() {
            let child = match part.range.len() <= LEAF {
                true => Child::leaf(&part.range),
                false => {
                    nodes.push(Node::EMPTY);
                    waiting.push((nodes.len() - 1, depth + 1, part.range));
                    Child((nodes.len() - 1) as u32)
                }
            };
            let node: &mut Node = &mut nodes[index];
            node.child[k] = child;
            for axis in 0..3 {
                node.lo[axis][k] = part.bounds.lo[axis];
                node.hi[axis][k] = part.bounds.hi[axis];
            }
        }
    }
    nodes.shrink_to_fit();
    nodes
}

/// Up to eight parts of a range: repeatedly splits the part with the largest box.
fn parts(items: &mut [Item], range: Range<usize>, halve: bool) -> Vec<Part> {
    let mut parts = Vec::with_capacity(WIDTH);
    parts.push(Part::new(items, range));
    while parts.len() < WIDTH {
        let large = (0..parts.len()).filter(|&k| parts[k].range.len() > LEAF);
        let weight = |part: &Part| if halve { part.range.len() as f32 } else { part.bounds.area() };
        let Some(k) = large.max_by(|&a, &b| weight(&parts[a]).total_cmp(&weight(&parts[b]))) else {
            break;
        };
        let Part { range, .. } = parts.swap_remove(k);
        let at = range.start + split(&mut items[range.clone()], halve);
        parts.push(Part::new(items, range.start..at));
        parts.push(Part::new(items, at..range.end));
    }
    parts
}

/// Partitions items into two non-empty groups and returns the start of the second.
fn split(items: &mut [Item], halve: bool) -> usize {
    let mut centres = Small::EMPTY;
    for item in items.iter() {
        let centre = [0, 1, 2].map(|axis| item.centre(axis));
        centres.grow(&centre, &centre);
    }
    let extent = [0, 1, 2].map(|axis| centres.hi[axis] - centres.lo[axis]);
    let axis = (1..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
    if halve || extent[axis] <= 0.0 {
        return halves(items, axis);
    }
    let (lo, scale) = (centres.lo[axis], BINS as f32 / extent[axis]);
    let bin = |item: &Item| (((item.centre(axis) - lo) * scale) as usize).min(BINS - 1);
    let Some(border) = cheapest_border(items, &bin) else {
        return halves(items, axis);
    };
    partition(items, |item| bin(item) < border)
}

fn halves(items: &mut [Item], axis: usize) -> usize {
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |a, b| {
        a.centre(axis).total_cmp(&b.centre(axis)).then(a.triangle.cmp(&b.triangle))
    });
    half
}

/// The border between bins with the least cost, area times count summed over both sides; `None` if all items
/// are in one bin.
fn cheapest_border(items: &[Item], bin: &impl Fn(&Item) -> usize) -> Option<usize> {
    let mut bins = [(Small::EMPTY, 0usize); BINS];
    for item in items {
        let (bounds, count) = &mut bins[bin(item)];
        bounds.grow(&item.lo, &item.hi);
        *count += 1;
    }
    let cost_from_left = running_costs(bins.iter());
    let cost_from_right = running_costs(bins.iter().rev());
    let cost = |border: usize| cost_from_left[border - 1] + cost_from_right[BINS - 1 - border];
    let filled = |border: &usize| {
        let left: usize = bins[..*border].iter().map(|(_, count)| count).sum();
        left > 0 && left < items.len()
    };
    (1..BINS).filter(filled).min_by(|&a, &b| cost(a).total_cmp(&cost(b)))
}

/// Area times count of the first bin, of the first two, and so on.
fn running_costs<'a>(bins: impl Iterator<Item = &'a (Small, usize)>) -> Vec<f32> {
    let (mut all, mut count) = (Small::EMPTY, 0);
    bins.map(|(bounds, more)| {
        all.grow(&bounds.lo, &bounds.hi);
        count += more;
        all.area() * count as f32
    })
    .collect()
}

/// Moves the items that satisfy the predicate to the front and returns their number.
fn partition(items: &mut [Item], wanted: impl Fn(&Item) -> bool) -> usize {
    let mut first = 0;
    for k in 0..items.len() {
        if wanted(&items[k]) {
            items.swap(first, k);
            first += 1;
        }
    }
    first
}
