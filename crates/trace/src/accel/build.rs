//! Construction of a bounding volume hierarchy (BVH) by several threads. The tree does not depend on their
//! number.
//!
//! Binary splits by the binned surface area heuristic (Wald, "On fast construction of SAH-based bounding
//! volume hierarchies", 2007). Every part begins at a multiple of eight boxes, so that almost all nodes of
//! width eight are full. The index of a part in the tables depends only on item counts, so that threads write
//! to disjoint slices.

use rayweave_math::Vec3;
use std::ops::Range;

/// The bounding box of a leaf, in the frame of a hierarchy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Item {
    pub lo: [f32; 3],
    pub hi: [f32; 3],
    pub leaf: u32,
}

impl Item {
    const EMPTY: Item = Item { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3], leaf: 0 };

    fn with(mut self, other: &Item) -> Item {
        for k in 0..3 {
            self.lo[k] = if other.lo[k] < self.lo[k] { other.lo[k] } else { self.lo[k] };
            self.hi[k] = if other.hi[k] > self.hi[k] { other.hi[k] } else { self.hi[k] };
        }
        self
    }

    /// Twice the centre.
    fn middle(&self) -> [f32; 3] {
        std::array::from_fn(|k| self.lo[k] + self.hi[k])
    }

    /// Half of the surface area; zero for an empty box.
    pub fn area(&self) -> f32 {
        let [x, y, z]: [f32; 3] = std::array::from_fn(|k| self.hi[k] - self.lo[k]);
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }
}

/// A node of the binary tree: a range of the items, either all of them or one side of a split.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// The bounding box of its items.
    pub bounds: Item,
    /// The number of its items in the left child, which follows it in the table; 0 if the part is not split.
    /// The right child follows the whole subtree of the left one.
    pub first: u32,
}

/// Largest number of items in an end part, and number of children of a node of the wide tree.
pub(super) const WIDTH: usize = 8;

const BINS: usize = 16;

/// Depth from which parts are split in half by count, which bounds the depth of the tree for all inputs.
const DEEP: u32 = 48;

/// Bound of the depth of a tree: 2^32 items make 2^29 end parts, and halving separates these in fewer than 32
/// levels.
pub(super) const DEPTH: usize = DEEP as usize + 32;

/// Number of items below which a part is not given to another thread.
const SHARED: usize = 1 << 14;

/// Sorts the items into tree order. Returns the parts of the tree in preorder.
pub(super) fn parts(items: &mut [Item], threads: usize) -> Vec<Part> {
    let nothing = Part { bounds: Item::EMPTY, first: 0 };
    let mut parts = vec![nothing; part_count(items.len())];
    if !items.is_empty() {
        fork(items, &mut parts, 0, threads);
    }
    parts
}

/// Number of parts (nodes of the binary tree) for this number of items.
pub(super) fn part_count(items: usize) -> usize {
    (2 * items.div_ceil(WIDTH)).saturating_sub(1)
}

/// Splits a part; while threads are left, another thread builds the left half.
fn fork(items: &mut [Item], parts: &mut [Part], depth: u32, threads: usize) {
    if threads <= 1 || items.len() < SHARED {
        return sort(items, parts, depth);
    }
    let at = split(items, depth);
    parts[0] = Part { bounds: around(items), first: at as u32 };
    let (left, right) = items.split_at_mut(at);
    let (left_parts, right_parts) = parts[1..].split_at_mut(part_count(at));
    let share = threads / 2;
    std::thread::scope(|scope| {
        scope.spawn(|| fork(left, left_parts, depth + 1, share));
        fork(right, right_parts, depth + 1, threads - share);
    });
}

/// Builds the subtree of a part on this thread.
fn sort(items: &mut [Item], parts: &mut [Part], depth: u32) {
    let mut waiting = vec![(0..items.len(), 0usize, depth)];
    while let Some((range, part, depth)) = waiting.pop() {
        let here = &mut items[range.clone()];
        let bounds = around(here);
        if here.len() <= WIDTH {
            parts[part] = Part { bounds, first: 0 };
            continue;
        }
        let at = split(here, depth);
        parts[part] = Part { bounds, first: at as u32 };
        let middle = range.start + at;
        waiting.push((middle..range.end, part + 1 + part_count(at), depth + 1));
        waiting.push((range.start..middle, part + 1, depth + 1));
    }
}

fn around(items: &[Item]) -> Item {
    items.iter().fold(Item::EMPTY, |all, item| all.with(item))
}

/// Partitions more than eight items at a split. Returns the number of items before it, a multiple of eight.
fn split(items: &mut [Item], depth: u32) -> usize {
    let centres = items.iter().fold(Item::EMPTY, |all, item| {
        let middle = item.middle();
        all.with(&Item { lo: middle, hi: middle, leaf: 0 })
    });
    let size = Vec3::from_array(std::array::from_fn(|k| f64::from(centres.hi[k] - centres.lo[k])));
    let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    let half = items.len() / 2;
    let count = match () {
        () if depth >= DEEP || size[axis] <= 0.0 => half,
        () if items.len() <= WIDTH * WIDTH => return split_few(items),
        () => best_border(items, axis, centres.lo[axis]..centres.hi[axis]).unwrap_or(half),
    };
    let at = rounded(count, items.len());
    select(items, at, axis);
    at
}

/// The nearest multiple of eight that leaves items on both sides.
fn rounded(count: usize, all: usize) -> usize {
    let most = (all - 1) / WIDTH * WIDTH;
    ((count + WIDTH / 2) / WIDTH * WIDTH).clamp(WIDTH, most)
}

/// Moves the `at` items with the lowest centres before the others. Equal centres are ordered by leaf, so that
/// the tree does not depend on the order of the input.
fn select(items: &mut [Item], at: usize, axis: usize) {
    let key = |item: &Item| item.lo[axis] + item.hi[axis];
    items.select_nth_unstable_by(at, |a, b| key(a).total_cmp(&key(b)).then(a.leaf.cmp(&b.leaf)));
}

/// The number of items before the bin border of least expected cost; `None` if no border has items on both
/// sides.
fn best_border(items: &[Item], axis: usize, range: Range<f32>) -> Option<usize> {
    let scale = BINS as f32 / (range.end - range.start);
    let mut bins = [(Item::EMPTY, 0usize); BINS];
    for item in items {
        let bin = ((item.lo[axis] + item.hi[axis] - range.start) * scale) as usize;
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

/// Expected number of box tests for a ray that enters both parts, times the surface area of the whole.
fn cost(left: Item, lefts: usize, right: Item, rights: usize) -> f32 {
    left.area() * lefts as f32 + right.area() * rights as f32
}

/// [`split`] for few items: tries every multiple of eight along each axis.
fn split_few(items: &mut [Item]) -> usize {
    let mut best = (f32::INFINITY, 0, 0);
    for axis in 0..3 {
        select_all(items, axis);
        for at in (WIDTH..items.len()).step_by(WIDTH) {
            let cost = cost(around(&items[..at]), at, around(&items[at..]), items.len() - at);
            best = if cost < best.0 { (cost, axis, at) } else { best };
        }
    }
    let (_, axis, at) = best;
    let at = if at == 0 { rounded(items.len() / 2, items.len()) } else { at };
    select_all(items, axis);
    at
}

fn select_all(items: &mut [Item], axis: usize) {
    let key = |item: &Item| item.lo[axis] + item.hi[axis];
    items.sort_unstable_by(|a, b| key(a).total_cmp(&key(b)).then(a.leaf.cmp(&b.leaf)));
}
