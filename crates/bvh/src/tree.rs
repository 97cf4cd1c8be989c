//! BVH traversal with boxes in `f32`: queries by rays, boxes and points.

use crate::build::{DEPTH, Item, Split, build};
use crate::frame::{Frame, Probe};
use crate::node::{Child, Node32, WIDTH};
use crate::slabs::RaySlabs;
use fearless_simd::{Level, dispatch};
use rayweave_math::{Bounds, Vec3};
use std::ops::Range;

/// A bounding volume hierarchy whose leaves hold up to `LEAF` items each, a power of two.
///
/// The items are numbered by their places in the order of the tree. Every query is conservative: it visits all
/// items whose boxes satisfy its condition, and some others nearby.
#[derive(Clone, Debug)]
pub struct Bvh<const LEAF: usize = 1> {
    pub(crate) frame: Frame,
    pub(crate) nodes: Vec<Node32>,
    pub(crate) level: Level,
    unbounded: Vec<u32>,
}

impl<const LEAF: usize> PartialEq for Bvh<LEAF> {
    fn eq(&self, other: &Self) -> bool {
        (&self.frame, &self.nodes, &self.unbounded) == (&other.frame, &other.nodes, &other.unbounded)
    }
}

impl<const LEAF: usize> Default for Bvh<LEAF> {
    /// The tree without items.
    fn default() -> Self {
        Bvh {
            frame: Frame::new(&Bounds::EMPTY),
            nodes: Vec::new(),
            level: Level::new(),
            unbounded: Vec::new(),
        }
    }
}

impl Bvh<1> {
    /// The tree of single items, split such that almost all nodes are full, with items numbered as in the
    /// input. The tree does not depend on the number of threads.
    pub fn of_items(boxes: &[Bounds], threads: usize) -> Bvh<1> {
        let (mut tree, order) = Bvh::build(boxes, Split::Full, threads);
        let children = tree.nodes.iter_mut().flat_map(|node| &mut node.child);
        for child in children.filter(|child| child.as_node().is_none() && **child != Child::NONE) {
            let number = order[child.place() as usize] as usize;
            *child = Child::leaf::<1>(number..number + 1);
        }
        tree
    }
}

impl<const LEAF: usize> Bvh<LEAF> {
    /// The tree of clusters of up to `LEAF` items, and the order of the items in it: the number of the item at
    /// each place.
    pub fn of_clusters(boxes: &[Bounds]) -> (Bvh<LEAF>, Vec<u32>) {
        Bvh::build(boxes, Split::Free, 1)
    }

    fn build(boxes: &[Bounds], split: Split, threads: usize) -> (Bvh<LEAF>, Vec<u32>) {
        assert!(boxes.len() <= Child::most_items::<LEAF>(), "a tree has fewer than 2^31 items");
        let finite = || (0..boxes.len()).filter(|&k| boxes[k].is_finite());
        let frame = Frame::new(&finite().fold(Bounds::EMPTY, |all, k| all.union(&boxes[k])));
        let mut items: Vec<Item> = finite().map(|k| frame.item(&boxes[k], k as u32)).collect();
        let nodes = build::<LEAF>(&mut items, split, threads);
        let is_unbounded = |bounds: &Bounds| !bounds.is_finite() && !bounds.is_empty();
        let unbounded = (0..boxes.len()).filter(|&k| is_unbounded(&boxes[k])).map(|k| k as u32).collect();
        let tree = Bvh { frame, nodes, level: Level::new(), unbounded };
        (tree, items.iter().map(|item| item.number).collect())
    }

    /// The items with an unbounded box, as numbered in the input. They are not in the tree: the caller visits them in
    /// every query. Items with an empty box are neither here nor in the tree.
    pub fn unbounded(&self) -> &[u32] {
        &self.unbounded
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node32>() + self.unbounded.len() * size_of::<u32>()
    }

    /// Largest extent of all boxes together.
    pub fn size(&self) -> f64 {
        2.0 * self.frame.unit
    }

    /// Prepares a ray for tests against boxes that are grown by `margin`, between two times. A ray whose origin
    /// or direction is not finite, or whose direction is zero, passes no box.
    pub fn probe(&self, origin: Vec3, direction: Vec3, margin: f64, window: [f64; 2]) -> Probe {
        self.frame.probe(origin, direction, margin, window)
    }

    /// Calls `visit` with ranges of places: all items whose boxes the ray passes, in no order along it.
    pub fn traverse(&self, probe: &Probe, mut visit: impl FnMut(Range<usize>)) {
        dispatch!(self.level, simd => {
            let slabs = RaySlabs::new(simd, probe);
            self.walk(0, #[inline(always)] |node| slabs.passed(node).0, &mut visit);
        });
    }

    /// Calls `visit` with ranges of places: all items whose boxes, grown by `margin`, intersect a box.
    pub fn overlapping(&self, bounds: &Bounds, margin: f64, mut visit: impl FnMut(Range<usize>)) {
        let other = self.frame.around(bounds, margin);
        let meets = |planes: [f32; 6]| {
            (0..3).all(|axis| planes[axis] <= other.hi[axis] && other.lo[axis] <= planes[axis + 3])
        };
        self.walk(0, |node| node.mask(meets), &mut visit);
    }

    /// Depth-first traversal from a node on. `hits` returns the boxes of a node to be visited, as a bit mask.
    #[inline(always)]
    pub(crate) fn walk(
        &self,
        from: u32,
        hits: impl Fn(&Node32) -> u32,
        visit: &mut impl FnMut(Range<usize>),
    ) {
        let Some(mut node) = self.nodes.get(from as usize) else { return };
        let mut open = [(0u32, 0u32); DEPTH];
        let (mut depth, mut at, mut left) = (0, from, hits(node));
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
            let Some(inner) = child.as_node() else {
                visit(child.places::<LEAF>());
                continue;
            };
            if left != 0 {
                open[depth] = (at, left);
                depth += 1;
            }
            at = inner;
            node = &self.nodes[at as usize];
            left = hits(node);
        }
    }

    /// Branch and bound by squared distance from a point (Roussopoulos, Kelley and Vincent 1995). Calls `visit`
    /// with ranges of places and the squared distance within which items still count; `visit` returns a new one.
    /// Ends when no box that is left, grown by `margin`, is nearer to the point than that.
    pub fn nearest(
        &self,
        point: Vec3,
        margin: f64,
        mut within: f64,
        mut visit: impl FnMut(Range<usize>, f64) -> f64,
    ) {
        let (point, margin) = self.frame.point(point, margin);
        let scale = self.frame.unit * self.frame.unit;
        // each level leaves seven children behind
        let mut stack = [(0.0, Child::node(0)); (WIDTH - 1) * DEPTH + 1];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while waiting > 0 {
            waiting -= 1;
            let (distance, child) = stack[waiting];
            if distance > within {
                continue;
            }
            let Some(node) = child.as_node() else {
                within = visit(child.places::<LEAF>(), within);
                continue;
            };
            let node = &self.nodes[node as usize];
            let first = waiting;
            for k in (0..WIDTH).take_while(|&k| node.child[k] != Child::NONE) {
                stack[waiting] = (scale * distance_squared(node, k, &point, margin), node.child[k]);
                waiting += 1;
            }
            // the nearest last, to be visited first
            stack[first..waiting].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        }
    }
}

/// Lower bound of the squared distance of a point from a box.
fn distance_squared(node: &Node32, k: usize, point: &[f64; 3], margin: f64) -> f64 {
    let away = |axis: usize| {
        let (lo, hi) = (f64::from(node.planes[axis].0[k]), f64::from(node.planes[axis + 3].0[k]));
        ((lo - point[axis]).max(point[axis] - hi) - margin).max(0.0)
    };
    [0, 1, 2].map(|axis| away(axis) * away(axis)).iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn boxes(seed: u64, count: usize, size: f64) -> Vec<Bounds> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut point = || Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        (0..count).map(|_| Bounds::centred(point(), size * point().abs())).collect()
    }

    /// Hard cases: boxes nested in a corner, ever smaller; identical boxes; boxes without extent.
    fn odd(count: usize) -> [Vec<Bounds>; 3] {
        let shrinking = |k: usize| Bounds { lo: Vec3::ZERO, hi: Vec3::splat(libm::exp2(-(k as f64) / 7.0)) };
        let point = Bounds { lo: Vec3::splat(3.0), hi: Vec3::splat(3.0) };
        [
            (0..count).map(shrinking).collect(),
            vec![Bounds::centred(Vec3::ONE, Vec3::ONE); count],
            vec![point; count],
        ]
    }

    /// Collects the places below a node and returns the depth of the tree. Asserts that boxes contain their
    /// children.
    fn places_below<const LEAF: usize>(
        nodes: &[Node32],
        at: usize,
        depth: usize,
        out: &mut Vec<usize>,
    ) -> usize {
        let (mut deepest, node) = (depth, &nodes[at]);
        for k in (0..WIDTH).filter(|&k| node.child[k] != Child::NONE) {
            let Some(child) = node.child[k].as_node() else {
                out.extend(node.child[k].places::<LEAF>());
                continue;
            };
            let below = &nodes[child as usize];
            for (axis, j) in (0..3).flat_map(|axis| (0..WIDTH).map(move |j| (axis, j))) {
                assert!(node.planes[axis].0[k] <= below.planes[axis].0[j]);
                assert!(below.planes[axis + 3].0[j] <= node.planes[axis + 3].0[k]);
            }
            deepest = deepest.max(places_below::<LEAF>(nodes, child as usize, depth + 1, out));
        }
        deepest
    }

    fn check<const LEAF: usize>(tree: &Bvh<LEAF>, count: usize, most_bytes: usize) {
        let mut found = Vec::new();
        let depth = places_below::<LEAF>(&tree.nodes, 0, 1, &mut found);
        found.sort_unstable();
        assert!(found.into_iter().eq(0..count));
        assert!(depth <= DEPTH, "{depth}");
        assert!(count < 1000 || tree.bytes() <= most_bytes * count, "{} for {count}", tree.bytes());
    }

    #[test]
    fn every_item_is_in_the_tree_once_and_no_tree_is_too_deep() {
        let mut lists: Vec<_> = [1, 7, 8, 9, 63, 64, 65, 1000].map(|n| boxes(n as u64, n, 0.1)).into();
        lists.extend(odd(3000));
        for list in lists {
            check(&Bvh::of_items(&list, 1), list.len(), 44);
            let (clusters, mut order) = Bvh::<4>::of_clusters(&list);
            check(&clusters, list.len(), 20);
            check(&Bvh::<1>::build(&list, Split::Ordered, 1).0, list.len(), 44);
            order.sort_unstable();
            assert!(order.into_iter().eq(0..list.len() as u32));
        }
        assert_eq!(Bvh::of_items(&[], 1), Bvh::default());
    }

    #[test]
    fn the_tree_does_not_depend_on_the_number_of_threads() {
        let list = boxes(1, 70_000, 0.05);
        for split in [Split::Full, Split::Free] {
            let built = |threads: usize| Bvh::<2>::build(&list, split, threads);
            let one = built(1);
            for threads in [2, 3, 8] {
                assert!(built(threads) == one, "{threads} threads");
            }
        }
    }

    #[test]
    fn a_tree_in_list_order_keeps_the_order() {
        let list = boxes(2, 500, 0.1);
        let (tree, order) = Bvh::<1>::build(&list, Split::Ordered, 1);
        assert!(order.into_iter().eq(0..500));
        let mut found = Vec::new();
        tree.overlapping(&Bounds::centred(Vec3::ZERO, Vec3::splat(9.0)), 0.0, |item| found.push(item.start));
        assert!(found.into_iter().eq(0..500));
    }
}
