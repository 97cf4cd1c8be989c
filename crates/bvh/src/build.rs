//! Construction of the tree by several threads. The tree does not depend on their number.
//!
//! Top down: each node repeatedly splits its part with the largest box until it has eight parts. Splits follow
//! the binned surface area heuristic (Wald 2007); small parts try every split (full sweep).

use crate::node::{Child, Node32, Row32, WIDTH};
use rayweave_math::Vec3;
use std::ops::Range;

/// The box of an item in the frame of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Item {
    pub lo: [f32; 3],
    pub hi: [f32; 3],
    /// The index of the item in the input.
    pub number: u32,
}

impl Item {
    const EMPTY: Item = Item { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3], number: 0 };

    fn with(mut self, other: &Item) -> Item {
        for k in 0..3 {
            self.lo[k] = if other.lo[k] < self.lo[k] { other.lo[k] } else { self.lo[k] };
            self.hi[k] = if other.hi[k] > self.hi[k] { other.hi[k] } else { self.hi[k] };
        }
        self
    }

    /// The bounding box of items.
    fn around(items: &[Item]) -> Item {
        items.iter().fold(Item::EMPTY, |all, item| all.with(item))
    }

    /// Twice the centre, along an axis.
    fn middle(&self, axis: usize) -> f32 {
        self.lo[axis] + self.hi[axis]
    }

    /// Half of the surface area; zero for an empty box.
    fn area(&self) -> f32 {
        let [x, y, z]: [f32; 3] = std::array::from_fn(|k| self.hi[k] - self.lo[k]);
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }
}

/// The order of the items in the tree, and the way to divide them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Split {
    /// By the surface area heuristic. Parts begin at multiples of eight leaves, so that almost all nodes are
    /// full and memory is least.
    Full,
    /// By the surface area heuristic, at any place.
    Free,
    /// In halves, in the order of the input, at multiples of eight leaves.
    Ordered,
}

const BINS: usize = 16;

/// Depth from which nodes are divided evenly, which bounds the depth of the tree for all inputs.
const DEEP: usize = 24;

/// Bound of the depth of a tree: 2^31 items make 2^28 parts of eight, and each even node separates eight parts.
pub(crate) const DEPTH: usize = DEEP + 12;

/// Number of items below which a part is not given to another thread.
const SHARED: usize = 1 << 14;

/// Sorts the items into tree order and builds the nodes, in preorder. Leaves hold up to `LEAF` items.
pub(crate) fn build<const LEAF: usize>(items: &mut [Item], split: Split, threads: usize) -> Vec<Node32> {
    if items.is_empty() {
        return Vec::new();
    }
    let mut nodes = Builder::<LEAF> { split, width: WIDTH }.fork(Job { items, first: 0, depth: 0 }, threads);
    nodes.shrink_to_fit();
    nodes
}

/// A subtree to be built.
struct Job<'a> {
    items: &'a mut [Item],
    /// The place of its first item in the whole list.
    first: usize,
    depth: usize,
}

/// A part of the items of a node.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub range: Range<usize>,
    pub bounds: Item,
}

impl Part {
    fn new(items: &[Item], range: Range<usize>) -> Part {
        Part { bounds: Item::around(&items[range.clone()]), range }
    }
}

pub(crate) struct Builder<const LEAF: usize> {
    pub split: Split,
    /// The number of children of a node.
    pub width: usize,
}

impl<const LEAF: usize> Builder<LEAF> {
    /// Builds a subtree; while threads are left, its children are built in parallel.
    fn fork(&self, job: Job<'_>, threads: usize) -> Vec<Node32> {
        if threads <= 1 || job.items.len() < SHARED {
            return self.subtree(job);
        }
        let Job { items, first, depth } = job;
        let parts = self.parts(items, depth);
        let mut node = self.node(&parts, first);
        let (mut jobs, mut rest, mut at) = (Vec::new(), items, 0);
        for Part { range, .. } in &parts {
            let (own, others) = rest.split_at_mut(range.end - at);
            if range.len() > LEAF {
                jobs.push(Job { items: own, first: first + at, depth: depth + 1 });
            }
            (rest, at) = (others, range.end);
        }
        let subtrees = self.fork_all(jobs, threads);
        let mut nodes = Vec::with_capacity(1 + subtrees.iter().map(Vec::len).sum::<usize>());
        nodes.push(node);
        let inner = (0..WIDTH).filter(|&k| parts.get(k).is_some_and(|part| part.range.len() > LEAF));
        for (k, mut subtree) in inner.zip(subtrees) {
            let offset = nodes.len();
            subtree.iter_mut().flat_map(|node| &mut node.child).for_each(|child| child.shift(offset));
            node.child[k] = Child::node(offset);
            nodes.append(&mut subtree);
        }
        nodes[0] = node;
        nodes
    }

    /// Builds several subtrees; half of the items are given to another thread.
    fn fork_all(&self, mut jobs: Vec<Job<'_>>, threads: usize) -> Vec<Vec<Node32>> {
        if threads <= 1 || jobs.len() <= 1 {
            return jobs.into_iter().map(|job| self.fork(job, threads)).collect();
        }
        let all: usize = jobs.iter().map(|job| job.items.len()).sum();
        let (mut count, mut at) = (jobs[0].items.len(), 1);
        while at + 1 < jobs.len() && 2 * count < all {
            (count, at) = (count + jobs[at].items.len(), at + 1);
        }
        let later = jobs.split_off(at);
        let mut subtrees = Vec::new();
        let mut others = Vec::new();
        std::thread::scope(|scope| {
            scope.spawn(|| others = self.fork_all(later, threads / 2));
            subtrees = self.fork_all(jobs, threads - threads / 2);
        });
        subtrees.append(&mut others);
        subtrees
    }

    /// Builds a subtree on this thread, with a stack of its own instead of the call stack.
    fn subtree(&self, Job { items, first, depth }: Job<'_>) -> Vec<Node32> {
        let mut nodes: Vec<Node32> = Vec::with_capacity(items.len() / (LEAF * (WIDTH - 2)));
        let mut waiting = vec![(None, depth, 0..items.len())];
        while let Some((above, depth, range)) = waiting.pop() {
            let here = nodes.len();
            if let Some((node, k)) = above {
                let node: &mut Node32 = &mut nodes[node];
                node.child[k] = Child::node(here);
            }
            let parts = self.parts(&mut items[range.clone()], depth);
            nodes.push(self.node(&parts, first + range.start));
            for (k, part) in parts.iter().enumerate().rev().filter(|(_, part)| part.range.len() > LEAF) {
                let inner = range.start + part.range.start..range.start + part.range.end;
                waiting.push((Some((here, k)), depth + 1, inner));
            }
        }
        nodes
    }

    /// A node with the boxes of its parts. The numbers of inner nodes among its children are not known yet.
    fn node(&self, parts: &[Part], first: usize) -> Node32 {
        let mut node = Node32::EMPTY;
        for (k, Part { range, bounds }) in parts.iter().enumerate() {
            let child = match range.len() <= LEAF {
                true => Child::leaf::<LEAF>(first + range.start..first + range.end),
                false => Child::node(0),
            };
            node.child[k] = child;
            for axis in 0..3 {
                let Row32(lo) = &mut node.planes[axis];
                lo[k] = bounds.lo[axis];
                let Row32(hi) = &mut node.planes[axis + 3];
                hi[k] = bounds.hi[axis];
            }
        }
        node
    }

    /// Divides the items of a node into as many parts as it has children, or fewer, in order: repeatedly splits the part with the
    /// largest box. The last levels are divided evenly, which needs fewer nodes.
    pub fn parts(&self, items: &mut [Item], depth: usize) -> Vec<Part> {
        let width = self.width;
        if LEAF == 1 && items.len() <= width {
            return (0..items.len()).map(|k| Part { range: k..k + 1, bounds: items[k] }).collect();
        }
        let is_last = items.len() <= width * LEAF;
        let is_even = depth >= DEEP || is_last || self.split == Split::Ordered;
        let multiple = if self.split == Split::Free || is_last { 1 } else { width * LEAF };
        let mut parts = Vec::with_capacity(width);
        parts.push(Part::new(items, 0..items.len()));
        while parts.len() < width {
            let large = (0..parts.len()).filter(|&k| parts[k].range.len() > multiple.max(LEAF));
            let weight = |part: &Part| if is_even { part.range.len() as f32 } else { part.bounds.area() };
            let largest = large.max_by(|&a, &b| weight(&parts[a]).total_cmp(&weight(&parts[b])));
            let Some(k) = largest else { break };
            let Part { range, .. } = parts.swap_remove(k);
            let at = range.start + self.split(&mut items[range.clone()], is_even, multiple);
            parts.push(Part::new(items, range.start..at));
            parts.push(Part::new(items, at..range.end));
        }
        parts.sort_unstable_by_key(|part| part.range.start);
        parts
    }

    /// Divides items into two groups that are not empty. Returns the number of items in the first one, a
    /// multiple of the given number.
    fn split(&self, items: &mut [Item], is_even: bool, multiple: usize) -> usize {
        let half = items.len() / 2;
        if self.split == Split::Ordered {
            return rounded(half, items.len(), multiple);
        }
        let centres = items.iter().fold(Item::EMPTY, |all, item| {
            let middle = std::array::from_fn(|axis| item.middle(axis));
            all.with(&Item { lo: middle, hi: middle, number: 0 })
        });
        let size = Vec3::from_array(std::array::from_fn(|k| f64::from(centres.hi[k] - centres.lo[k])));
        let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
        let count = match () {
            () if is_even || size[axis] <= 0.0 => half,
            () if multiple > 1 && items.len() <= WIDTH * multiple => return sweep(items, multiple),
            () => best_border(items, axis, centres.lo[axis]..centres.hi[axis]).unwrap_or(half),
        };
        let at = rounded(count, items.len(), multiple);
        items.select_nth_unstable_by(at, by_centre(axis));
        at
    }
}

/// The nearest multiple that leaves items on both sides.
fn rounded(count: usize, all: usize, multiple: usize) -> usize {
    let most = (all - 1) / multiple * multiple;
    ((count + multiple / 2) / multiple * multiple).clamp(multiple, most)
}

/// The order of centres along an axis. Equal centres are ordered by number, so that the tree does not depend on
/// the order of the steps.
fn by_centre(axis: usize) -> impl Fn(&Item, &Item) -> std::cmp::Ordering {
    move |a, b| a.middle(axis).total_cmp(&b.middle(axis)).then(a.number.cmp(&b.number))
}

/// The number of items before the bin border of least expected cost; `None` if no border has items on both
/// sides.
fn best_border(items: &[Item], axis: usize, range: Range<f32>) -> Option<usize> {
    let scale = BINS as f32 / (range.end - range.start);
    let mut bins = [(Item::EMPTY, 0usize); BINS];
    for item in items {
        let bin = ((item.middle(axis) - range.start) * scale) as usize;
        let slot = &mut bins[bin.min(BINS - 1)];
        *slot = (slot.0.with(item), slot.1 + 1);
    }
    let joined = |a: (Item, usize), b: &(Item, usize)| (a.0.with(&b.0), a.1 + b.1);
    let mut right = [(Item::EMPTY, 0usize); BINS + 1];
    for border in (0..BINS).rev() {
        right[border] = joined(right[border + 1], &bins[border]);
    }
    let (mut left, mut best) = ((Item::EMPTY, 0), (f32::INFINITY, None));
    for border in 1..BINS {
        left = joined(left, &bins[border - 1]);
        let cost = cost(left.0, left.1, right[border].0, right[border].1);
        if left.1 > 0 && right[border].1 > 0 && cost < best.0 {
            best = (cost, Some(left.1));
        }
    }
    best.1
}

/// The surface area heuristic: expected number of box tests for a ray that enters both parts, times the surface
/// area of the whole.
fn cost(left: Item, lefts: usize, right: Item, rights: usize) -> f32 {
    left.area() * lefts as f32 + right.area() * rights as f32
}

/// Divides few items at the best of all multiples along all axes.
fn sweep(items: &mut [Item], multiple: usize) -> usize {
    let mut best = (f32::INFINITY, 0, 0);
    for axis in 0..3 {
        items.sort_unstable_by(by_centre(axis));
        for at in (multiple..items.len()).step_by(multiple) {
            let (left, right) = items.split_at(at);
            let cost = cost(Item::around(left), left.len(), Item::around(right), right.len());
            best = if cost < best.0 { (cost, axis, at) } else { best };
        }
    }
    let (_, axis, at) = best;
    let at = if at == 0 { rounded(items.len() / 2, items.len(), multiple) } else { at };
    items.sort_unstable_by(by_centre(axis));
    at
}
