//! A tree of boxes, eight to a node, that are tested at once.
//!
//! Boxes are f32, rounded outwards in the frame of the hierarchy: 28 bytes a box, and one box in seven for inner nodes
//! where all are full.

use super::build::{DEPTH, Item, Part, WIDTH, part_count, parts};
use super::frame::{Frame, Probe};
use fearless_simd::{Level, Simd, SimdBase, SimdFrom, SimdMask, dispatch, f32x8};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::Window;
use rayweave_shape::Ray;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Boxes of leaves, by where they are.
#[derive(Clone, Debug)]
pub(super) struct Hierarchy {
    frame: Frame,
    nodes: Vec<Node>,
    level: Level,
}

/// Eight boxes with what they hold.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Node {
    /// The planes lo x, y, z and hi x, y, z of each box; a box that is not there is empty.
    planes: [[f32; WIDTH]; 6],
    /// What is in each box: the number of a leaf with [`LEAF`] added, or of a node.
    child: [u32; WIDTH],
}

/// Marks the number of a leaf.
const LEAF: u32 = 1 << 31;

impl Hierarchy {
    /// The tree over the finite boxes of some leaves, made by so many threads; it does not depend on their number.
    pub fn new(leaves: &[(Bounds, u32)], threads: usize) -> Hierarchy {
        let all = leaves.iter().fold(Bounds::EMPTY, |all, (bounds, _)| all.union(bounds));
        let frame =
            Frame::new(if leaves.is_empty() { &Bounds { lo: Vec3::ZERO, hi: Vec3::ZERO } } else { &all });
        let mut items: Vec<Item> = leaves.iter().map(|(bounds, leaf)| frame.item(bounds, *leaf)).collect();
        let parts = parts(&mut items, threads);
        Hierarchy { frame, nodes: widened(&items, &parts), level: Level::new() }
    }

    /// What it takes in memory.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>()
    }

    /// A length of the size of all boxes together.
    pub fn size(&self) -> f64 {
        self.frame.size()
    }

    pub fn probe(&self, ray: &Ray, margin: f64, window: Window) -> Probe {
        self.frame.probe(ray, margin, window)
    }

    /// The leaves whose boxes the ray passes in its window.
    pub fn touched(&self, probe: &Probe, out: &mut Vec<u32>) {
        dispatch!(self.level, simd => {
            let slabs = Slabs::new(simd, probe);
            self.walk(#[inline(always)] |node| slabs.passed(node).0, out);
        });
    }

    /// The leaves whose boxes, grown, hold a point.
    pub fn around(&self, point: Vec3, margin: f64, out: &mut Vec<u32>) {
        let point = self.frame.around(point, margin);
        self.walk(|node| node.overlaps(&point), out);
    }

    /// Goes through all nodes that `hits` shows the way to: it tells which of the boxes of a node count, as bits.
    #[inline(always)]
    fn walk(&self, hits: impl Fn(&Node) -> u32, out: &mut Vec<u32>) {
        let Some(mut node) = self.nodes.first() else { return };
        let mut open = [(0u32, 0u32); DEPTH];
        let (mut depth, mut at, mut left) = (0, 0, hits(node));
        loop {
            while left == 0 {
                if depth == 0 {
                    return;
                }
                depth -= 1;
                (at, left) = open[depth];
                node = &self.nodes[at as usize];
            }
            let child = node.child[left.trailing_zeros() as usize % WIDTH];
            left &= left - 1;
            if child & LEAF != 0 {
                out.push(child ^ LEAF);
                continue;
            }
            if left != 0 {
                open[depth] = (at, left);
                depth += 1;
            }
            at = child;
            node = &self.nodes[at as usize];
            left = hits(node);
        }
    }
}

/// A way through a hierarchy along a ray, leaves in the order in which the ray enters their boxes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Front {
    probe: Probe,
    /// Boxes not opened yet, the first one on top: the time of the entry as bits in the order of the times, then what is
    /// in the box.
    waiting: BinaryHeap<Reverse<u64>>,
}

impl Front {
    /// At the beginning of the window.
    pub(super) fn begin(&mut self, hierarchy: &Hierarchy, probe: Probe) {
        self.probe = probe;
        self.waiting.clear();
        if !hierarchy.nodes.is_empty() {
            self.open(hierarchy, 0);
        }
    }

    /// No box that has not been opened begins before this time of the ray; infinite where there is none.
    pub fn time(&self) -> f64 {
        match self.waiting.peek() {
            Some(&Reverse(first)) => self.probe.time(time_of((first >> 32) as u32)),
            None => f64::INFINITY,
        }
    }

    /// A time by which the ray has left every box.
    pub fn end(&self) -> f64 {
        self.probe.end()
    }

    /// Opens the first box; the leaf if there is one in it.
    pub(super) fn next(&mut self, hierarchy: &Hierarchy) -> Option<u32> {
        let Reverse(first) = self.waiting.pop()?;
        let child = first as u32;
        if child & LEAF != 0 {
            return Some(child ^ LEAF);
        }
        self.open(hierarchy, child);
        None
    }

    fn open(&mut self, hierarchy: &Hierarchy, node: u32) {
        let node = &hierarchy.nodes[node as usize];
        let (mut left, enter) =
            dispatch!(hierarchy.level, simd => Slabs::new(simd, &self.probe).entered(node));
        while left != 0 {
            let k = left.trailing_zeros() as usize % WIDTH;
            left &= left - 1;
            self.waiting.push(Reverse(u64::from(bits_of(enter[k])) << 32 | u64::from(node.child[k])));
        }
    }
}

/// Bits in the order of the numbers.
fn bits_of(time: f32) -> u32 {
    let bits = time.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

fn time_of(bits: u32) -> f32 {
    f32::from_bits(if bits >> 31 == 1 { bits ^ 1 << 31 } else { !bits })
}

/// A ray ready for the slab test of Kay & Kajiya ("Ray tracing complex scenes", 1986) with eight boxes at once.
struct Slabs<S: Simd> {
    simd: S,
    near: [usize; 3],
    far: [usize; 3],
    near_origin: [f32x8<S>; 3],
    far_origin: [f32x8<S>; 3],
    inverse: [f32x8<S>; 3],
    window: [f32x8<S>; 2],
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    fn new(simd: S, probe: &Probe) -> Self {
        let [begin, end] = probe.window;
        Slabs {
            simd,
            near: probe.near,
            far: probe.far,
            near_origin: splat(simd, probe.near_origin),
            far_origin: splat(simd, probe.far_origin),
            inverse: splat(simd, probe.inverse),
            window: [f32x8::splat(simd, begin), f32x8::splat(simd, end)],
        }
    }

    /// Which boxes the ray passes in its window, as bits, and when it enters each. A box that is not there is entered at
    /// +inf and left at -inf.
    #[inline(always)]
    fn passed(&self, node: &Node) -> (u32, f32x8<S>) {
        let [mut enter, mut leave] = self.window;
        for k in 0..3 {
            let near = f32x8::simd_from(self.simd, node.planes[self.near[k]]);
            let far = f32x8::simd_from(self.simd, node.planes[self.far[k]]);
            enter = enter.max((near - self.near_origin[k]) * self.inverse[k]);
            leave = leave.min((far - self.far_origin[k]) * self.inverse[k]);
        }
        (enter.simd_le(leave).to_bitmask() as u32, enter)
    }

    #[inline(always)]
    fn entered(&self, node: &Node) -> (u32, [f32; WIDTH]) {
        let (passed, enter) = self.passed(node);
        let mut times = [0.0; WIDTH];
        enter.store_slice(&mut times);
        (passed, times)
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, [x, y, z]: [f32; 3]) -> [f32x8<S>; 3] {
    [f32x8::splat(simd, x), f32x8::splat(simd, y), f32x8::splat(simd, z)]
}

impl Node {
    const EMPTY: Node = Node {
        planes: [
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        child: [0; WIDTH],
    };

    fn put(&mut self, k: usize, bounds: &Item, child: u32) {
        for axis in 0..3 {
            self.planes[axis][k] = bounds.lo[axis];
            self.planes[axis + 3][k] = bounds.hi[axis];
        }
        self.child[k] = child;
    }

    /// Which boxes have a point in common with another box, as bits.
    fn overlaps(&self, other: &Item) -> u32 {
        let meets = |k: usize| {
            (0..3).all(|axis| {
                self.planes[axis][k] <= other.hi[axis] && other.lo[axis] <= self.planes[axis + 3][k]
            })
        };
        (0..WIDTH).filter(|&k| meets(k)).fold(0, |bits, k| bits | 1 << k)
    }
}

/// A part of the items on its way into a node.
#[derive(Clone, Copy)]
struct Piece {
    /// Its number among the parts.
    part: usize,
    /// Its items.
    begin: usize,
    count: usize,
}

impl Piece {
    /// The two into which it is split.
    fn split(self, parts: &[Part]) -> [Piece; 2] {
        let Piece { part, begin, count } = self;
        let first = parts[part].first as usize;
        let second = Piece { part: part + 1 + part_count(first), begin: begin + first, count: count - first };
        [Piece { part: part + 1, begin, count: first }, second]
    }
}

/// The nodes of the wide tree, each before those below it: the largest box in a node is opened until there are eight.
fn widened(items: &[Item], parts: &[Part]) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::with_capacity(items.len() / (WIDTH - 2));
    let mut waiting = Vec::new();
    if !items.is_empty() {
        waiting.push((None, Piece { part: 0, begin: 0, count: items.len() }));
    }
    while let Some((above, piece)) = waiting.pop() {
        let here = nodes.len();
        if let Some((node, k)) = above {
            let node: &mut Node = &mut nodes[node];
            node.child[k] = here as u32;
        }
        let mut node = Node::EMPTY;
        if piece.count <= WIDTH {
            let items = &items[piece.begin..piece.begin + piece.count];
            items.iter().enumerate().for_each(|(k, item)| node.put(k, item, item.leaf | LEAF));
        } else {
            let (pieces, count) = eight(piece, parts);
            for (k, &piece) in pieces[..count].iter().enumerate().rev() {
                let single = piece.count == 1;
                node.put(
                    k,
                    &parts[piece.part].bounds,
                    if single { items[piece.begin].leaf | LEAF } else { 0 },
                );
                if !single {
                    waiting.push((Some((here, k)), piece));
                }
            }
        }
        nodes.push(node);
    }
    nodes.shrink_to_fit();
    nodes
}

/// Up to eight pieces of a piece of more than eight items, and how many.
fn eight(piece: Piece, parts: &[Part]) -> ([Piece; WIDTH], usize) {
    let (mut pieces, mut count) = ([piece; WIDTH], 1);
    while count < WIDTH {
        let open = (0..count).filter(|&k| pieces[k].count > WIDTH);
        let area = |k: &usize| parts[pieces[*k].part].bounds.area();
        let Some(k) = open.max_by(|a, b| area(a).total_cmp(&area(b))) else { break };
        let [first, second] = pieces[k].split(parts);
        pieces.copy_within(k + 1..count, k + 2);
        (pieces[k], pieces[k + 1]) = (first, second);
        count += 1;
    }
    (pieces, count)
}
