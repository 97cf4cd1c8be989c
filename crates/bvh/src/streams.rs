//! Traversal by many rays node by node: each node is read once and tested against all rays that pass its box.
//!
//! A ray on its own way through a tree waits for each test before it can decide about the next node. Here the tests of many
//! rays against one node follow each other without decisions between them (ray streams: Gribble and Ramani 2008). There is no
//! order along the rays: all items before the ends of the rays are found. That pays where rays pass few boxes.

use crate::node::Child;
use crate::wide::{StreamRay, WIDE, WideBvh, WideNode};
use fearless_simd::prelude::*;

/// The items whose boxes many rays pass, with the memory for their search.
#[derive(Clone, Debug, Default)]
pub struct RayStreams {
    /// The nodes to be tested, each with the part of `numbers` that are its rays.
    open: Vec<Open>,
    numbers: Vec<u32>,
    /// The boxes that each ray of a node passes, as bit masks, and the times at which it enters them.
    masks: Vec<u32>,
    enters: Vec<[f32; WIDE]>,
    /// The rays that pass each box of a node, in lists of equal length, and a list for none.
    passing: Vec<u32>,
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
    /// The time in the frame of the tree.
    enter: f32,
    item: u32,
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
    /// Finds the items whose boxes the rays pass. The rays that pass too many are no longer usable.
    pub fn find<S: Simd>(&mut self, simd: S, tree: &WideBvh, rays: &mut [StreamRay]) {
        // a separate function, compiled for the instruction set
        simd.vectorize(
            #[inline(always)]
            || self.find_here(simd, tree, rays),
        );
    }

    #[inline(always)]
    fn find_here<S: Simd>(&mut self, simd: S, tree: &WideBvh, rays: &mut [StreamRay]) {
        for (column, value) in [(&mut self.first, NONE), (&mut self.counts, 0)] {
            column.clear();
            column.resize(rays.len(), value);
        }
        self.passed.clear();
        self.numbers.clear();
        self.numbers.extend(0..rays.len() as u32);
        if self.masks.len() < rays.len() {
            self.masks.resize(rays.len(), 0);
            self.enters.resize(rays.len(), [0.0; WIDE]);
            self.passing.resize((WIDE + 1) * rays.len(), 0);
        }
        self.open.clear();
        if !tree.nodes.is_empty() {
            self.open.push(Open { node: 0, start: 0, end: rays.len() as u32 });
        }
        while let Some(open) = self.open.pop() {
            // what follows are the lists of nodes within those that came before
            self.numbers.truncate(open.end as usize);
            self.test(simd, &tree.nodes[open.node as usize], rays, open);
        }
    }

    /// Tests the rays of a node, and lists those that pass each of its boxes.
    #[inline(always)]
    fn test<S: Simd>(&mut self, simd: S, node: &WideNode, rays: &mut [StreamRay], open: Open) {
        let (start, end) = (open.start as usize, open.end as usize);
        let mut touched = 0;
        let tested = self.masks.iter_mut().zip(&mut self.enters);
        for (&number, (mask, enters)) in self.numbers[start..end].iter().zip(tested) {
            let (enter, passes) = rays[number as usize].enter(simd, node);
            enter.store_array(enters);
            *mask = passes;
            touched |= passes;
        }
        if touched & node.inner != 0 {
            self.descend(node, start..end);
        }
        let items = touched & !node.inner;
        if items != 0 {
            for at in 0..end - start {
                self.pass(&node.child, (at, self.numbers[start + at] as usize), (items, rays));
            }
        }
    }

    /// Opens the nodes within a node for those of its rays that pass their boxes.
    #[inline(always)]
    fn descend(&mut self, node: &WideNode, rays: std::ops::Range<usize>) {
        let (count, mut lengths) = (rays.len(), [0; WIDE + 1]);
        for (&number, &mask) in self.numbers[rays].iter().zip(&self.masks) {
            let mut passes = mask & node.inner;
            // most rays pass none, one or two of them: no branch for each, which cannot be predicted
            for _ in 0..FEW {
                let k = (passes | 1 << WIDE).trailing_zeros() as usize % (WIDE + 1);
                self.passing[k * count + lengths[k]] = number;
                lengths[k] += usize::from(k < WIDE);
                passes &= passes.wrapping_sub(1);
            }
            while passes != 0 {
                let k = passes.trailing_zeros() as usize % (WIDE + 1);
                self.passing[k * count + lengths[k]] = number;
                lengths[k] += 1;
                passes &= passes - 1;
            }
        }
        for (k, &length) in lengths.iter().enumerate().take(WIDE) {
            if let (Some(node), true) = (node.child[k].as_node(), length > 0) {
                let first = self.numbers.len();
                self.numbers.extend_from_slice(&self.passing[k * count..k * count + length]);
                self.open.push(Open { node, start: first as u32, end: (first + length) as u32 });
            }
        }
    }

    /// Adds the items of a node in the bit mask `items` to the list of a ray, as far as the ray passes their boxes; `at` is its place
    /// among the rays of the node. Ray by ray: most pass none or one of them.
    #[inline(always)]
    fn pass(
        &mut self,
        child: &[Child; WIDE],
        (at, ray): (usize, usize),
        (items, rays): (u32, &mut [StreamRay]),
    ) {
        let mut passes = self.masks[at] & items;
        while passes != 0 {
            let k = passes.trailing_zeros() as usize % WIDE;
            passes &= passes - 1;
            self.counts[ray] += 1;
            if self.counts[ray] > MOST_PASSED {
                rays[ray].until = f32::NEG_INFINITY;
                return;
            }
            // sorted: there are rarely more than two
            let (enter, own, item) = (self.enters[at][k], self.passed.len() as u32, child[k].place());
            let (mut before, mut next) = (NONE, self.first[ray]);
            while let Some(here) = self.passed.get(next as usize).filter(|here| here.enter < enter) {
                (before, next) = (next, here.next);
            }
            self.passed.push(Passed { enter, item, next });
            match self.passed.get_mut(before as usize) {
                Some(before) => before.next = own,
                None => self.first[ray] = own,
            }
        }
    }

    /// The items that have been found, in any order.
    pub fn items(&self) -> impl Iterator<Item = u32> + '_ {
        self.passed.iter().map(|passed| passed.item)
    }

    /// The first box that a ray passes; `None` if it passes so many that their search was given up.
    #[inline]
    #[must_use]
    pub fn of_ray(&self, ray: usize) -> Option<StreamPlace> {
        (self.counts[ray] <= MOST_PASSED).then_some(StreamPlace(self.first[ray]))
    }

    /// The next item whose box a ray passes before a time, from front to back; `pace` is that of the ray: see [`StreamRays::ray`].
    ///
    /// [`StreamRays::ray`]: crate::StreamRays::ray
    #[inline]
    pub fn next(&self, at: &mut StreamPlace, until: f64, pace: f64) -> Option<u32> {
        let passed = self.passed.get(at.0 as usize).filter(|passed| f64::from(passed.enter) <= until * pace);
        at.0 = passed.map_or(NONE, |passed| passed.next);
        passed.map(|passed| passed.item)
    }
}

/// Number of boxes of a node that most rays do not exceed.
const FEW: usize = 2;
