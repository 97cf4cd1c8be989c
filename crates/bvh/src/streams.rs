//! Traversal by many rays node by node: each node is read once and tested against all rays that pass its box.
//!
//! A ray on its own way through a tree waits for each test before it can decide about the next node. Here the tests of many
//! rays against one node follow each other without decisions between them (ray streams: Gribble and Ramani 2008). There is no
//! order along the rays: all items before the ends of the rays are found. That pays where rays pass few boxes.

use crate::exact::ExactBvh;
use crate::node::{Node64, Row64};
use crate::rays::SlabRay;
use fearless_simd::prelude::*;

/// The items whose boxes many rays pass, with the memory for their search.
#[derive(Clone, Debug, Default)]
pub struct RayStreams {
    /// The time up to which each ray is traced; -inf for rays with too many items.
    until: Vec<f64>,
    /// The nodes to be tested, each with the part of `numbers` that are its rays.
    open: Vec<Open>,
    numbers: Vec<u32>,
    /// The boxes that each ray of a node passes, as bit masks, and the times at which it enters them.
    masks: Vec<u64>,
    enters: Vec<Row64>,
    passed: Vec<Passed>,
    first: Vec<u32>,
    counts: Vec<u32>,
}

/// A node with its rays.
#[derive(Clone, Copy, Debug)]
struct Open {
    node: u32,
    start: u32,
    end: u32,
}

/// A box that a ray passes.
#[derive(Clone, Copy, Debug)]
struct Passed {
    enter: f64,
    place: u32,
    /// The box behind it on the same ray.
    next: u32,
}

/// No box.
const NONE: u32 = u32::MAX;

/// Largest number of items of a ray.
const MOST_PASSED: u32 = 16;

/// The boxes that a ray passes, from front to back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamPlace(u32);

impl StreamPlace {
    /// Without any box.
    pub const END: StreamPlace = StreamPlace(NONE);
}

impl RayStreams {
    /// Finds the items whose boxes the rays pass, each up to a time.
    pub fn find<S: Simd>(&mut self, simd: S, tree: &ExactBvh, rays: &[(SlabRay, f64)]) {
        // a separate function, compiled for the instruction set
        simd.vectorize(
            #[inline(always)]
            || self.find_here(simd, tree, rays),
        );
    }

    #[inline(always)]
    fn find_here<S: Simd>(&mut self, simd: S, tree: &ExactBvh, rays: &[(SlabRay, f64)]) {
        self.until.clear();
        self.until.extend(rays.iter().map(|(_, until)| *until));
        for (column, value) in [(&mut self.first, NONE), (&mut self.counts, 0)] {
            column.clear();
            column.resize(rays.len(), value);
        }
        self.passed.clear();
        self.numbers.clear();
        self.numbers.extend(0..rays.len() as u32);
        self.open.clear();
        if !tree.nodes.is_empty() {
            self.open.push(Open { node: 0, start: 0, end: rays.len() as u32 });
        }
        while let Some(open) = self.open.pop() {
            // what follows are the lists of nodes within those that came before
            self.numbers.truncate(open.end as usize);
            self.test(simd, tree, rays, open);
        }
    }

    /// Tests the rays of a node, and lists those that pass each of its boxes.
    #[inline(always)]
    fn test<S: Simd>(&mut self, simd: S, tree: &ExactBvh, rays: &[(SlabRay, f64)], open: Open) {
        let (start, end) = (open.start as usize, open.end as usize);
        let (node, count) = (&tree.nodes[open.node as usize], end - start);
        if self.masks.len() < count {
            self.masks.resize(count, 0);
            self.enters.resize(count, Row64([0.0; 8]));
        }
        let mut touched = 0;
        let tested = self.masks[..count].iter_mut().zip(&mut self.enters[..count]);
        for (&number, (mask, enters)) in self.numbers[start..end].iter().zip(tested) {
            let until = self.until[number as usize];
            let (enter, passes) = rays[number as usize].0.enter(simd, node, until);
            enter.store_array(&mut enters.0);
            *mask = passes;
            touched |= passes;
        }
        let mut items = 0;
        while touched != 0 {
            let k = touched.trailing_zeros() as usize % crate::WIDTH;
            touched &= touched - 1;
            match node.child[k].as_node() {
                Some(inner) => self.descend(inner, k, start..end),
                None => items |= 1 << k,
            }
        }
        if items != 0 {
            for at in 0..count {
                self.pass(node, (at, self.numbers[start + at] as usize), items);
            }
        }
    }

    /// Opens the node in box `k` for those of some rays that pass it.
    #[inline(always)]
    fn descend(&mut self, inner: u32, k: usize, rays: std::ops::Range<usize>) {
        let first = self.numbers.len();
        self.numbers.resize(first + rays.len(), 0);
        let (known, list) = self.numbers.split_at_mut(first);
        let mut len = 0;
        for (&number, &mask) in known[rays].iter().zip(&self.masks) {
            // no branch: whether a ray passes cannot be predicted
            list[len] = number;
            len += (mask >> k & 1) as usize;
        }
        self.numbers.truncate(first + len);
        self.open.push(Open { node: inner, start: first as u32, end: (first + len) as u32 });
    }

    /// Adds the items of a node in the bit mask `items` to the list of a ray, as far as the ray passes their boxes; `at` is its place
    /// among the rays of the node. Ray by ray: most pass none or one of them.
    #[inline(always)]
    fn pass(&mut self, node: &Node64, (at, ray): (usize, usize), items: u64) {
        let mut passes = self.masks[at] & items;
        while passes != 0 {
            let k = passes.trailing_zeros() as usize % crate::WIDTH;
            passes &= passes - 1;
            self.counts[ray] += 1;
            if self.counts[ray] > MOST_PASSED {
                self.until[ray] = f64::NEG_INFINITY;
                return;
            }
            // sorted: there are rarely more than two
            let (enter, own, place) = (self.enters[at].0[k], self.passed.len() as u32, node.child[k].place());
            let (mut before, mut next) = (NONE, self.first[ray]);
            while let Some(here) = self.passed.get(next as usize).filter(|here| here.enter < enter) {
                (before, next) = (next, here.next);
            }
            self.passed.push(Passed { enter, place, next });
            match self.passed.get_mut(before as usize) {
                Some(before) => before.next = own,
                None => self.first[ray] = own,
            }
        }
    }

    /// The places of the items that have been found, in any order.
    pub fn places(&self) -> impl Iterator<Item = u32> + '_ {
        self.passed.iter().map(|passed| passed.place)
    }

    /// The first box that a ray passes; `None` if it passes so many that their search was given up.
    #[inline]
    #[must_use]
    pub fn of_ray(&self, ray: usize) -> Option<StreamPlace> {
        (self.counts[ray] <= MOST_PASSED).then_some(StreamPlace(self.first[ray]))
    }

    /// The place of the next item whose box a ray passes before a time, from front to back.
    #[inline]
    pub fn next(&self, at: &mut StreamPlace, until: f64) -> Option<u32> {
        let passed = self.passed.get(at.0 as usize).filter(|passed| passed.enter <= until);
        at.0 = passed.map_or(NONE, |passed| passed.next);
        passed.map(|passed| passed.place)
    }
}
