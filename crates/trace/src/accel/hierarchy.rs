//! A bounding volume hierarchy (BVH) of width eight: the eight boxes of a node are tested with one SIMD slab
//! test.
//!
//! Boxes are f32, rounded outwards in the frame of the hierarchy: 28 bytes per box. If all nodes are full,
//! inner nodes add one box in seven.

use super::build::{DEPTH, Item, Part, WIDTH, part_count, parts};
use super::frame::{Frame, Probe};
use fearless_simd::{Level, Simd, SimdBase, SimdFrom, SimdMask, dispatch, f32x8};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::Window;
use rayweave_shape::Ray;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A BVH of the leaves of a group.
#[derive(Clone, Debug)]
pub(super) struct Hierarchy {
    frame: Frame,
    nodes: Vec<Node>,
    level: Level,
}

/// Eight boxes and their children.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Node {
    /// The planes lo x, y, z and hi x, y, z of each box; an unused box is empty.
    planes: [[f32; WIDTH]; 6],
    /// Child of each box: a leaf number with [`LEAF`] set, or a node number.
    child: [u32; WIDTH],
}

/// Bit that marks the number of a leaf.
const LEAF: u32 = 1 << 31;

impl Hierarchy {
    /// Builds the tree over the finite boxes of some leaves. The tree does not depend on the number of
    /// threads.
    pub fn new(leaves: &[(Bounds, u32)], threads: usize) -> Hierarchy {
        let all = leaves.iter().fold(Bounds::EMPTY, |all, (bounds, _)| all.union(bounds));
        let frame =
            Frame::new(if leaves.is_empty() { &Bounds { lo: Vec3::ZERO, hi: Vec3::ZERO } } else { &all });
        let mut items: Vec<Item> = leaves.iter().map(|(bounds, leaf)| frame.item(bounds, *leaf)).collect();
        let parts = parts(&mut items, threads);
        Hierarchy { frame, nodes: widened(&items, &parts), level: Level::new() }
    }

    /// Memory of the nodes in bytes.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>()
    }

    /// Largest extent of all boxes together, up to a factor of two.
    pub fn size(&self) -> f64 {
        self.frame.size()
    }

    pub fn probe(&self, ray: &Ray, margin: f64, window: Window) -> Probe {
        self.frame.probe(ray, margin, window)
    }

    /// Appends the leaves whose boxes the ray passes within its window.
    pub fn touched(&self, probe: &Probe, out: &mut Vec<u32>) {
        dispatch!(self.level, simd => {
            let slabs = Slabs::new(simd, probe);
            self.walk(#[inline(always)] |node| slabs.passed(node).0, out);
        });
    }

    /// Appends the leaves whose boxes, grown by `margin`, contain a point.
    pub fn around(&self, point: Vec3, margin: f64, out: &mut Vec<u32>) {
        let point = self.frame.around(point, margin);
        self.walk(|node| node.overlaps(&point), out);
    }

    /// Depth-first traversal. `hits` returns the boxes of a node to be visited, as a bit mask.
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

/// State of a front-to-back traversal: leaves come in the order in which the ray enters their boxes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Front {
    probe: Probe,
    /// Queue of boxes not yet opened, nearest first: the entry time, as bits ordered like the times, above
    /// the child number.
    waiting: BinaryHeap<Reverse<u64>>,
    /// The leaves of the node that was opened last.
    fresh: [u32; WIDTH],
    fresh_count: usize,
}

impl Front {
    /// Starts the traversal at the beginning of the window.
    pub(super) fn begin(&mut self, hierarchy: &Hierarchy, probe: Probe) {
        self.probe = probe;
        self.waiting.clear();
        if !hierarchy.nodes.is_empty() {
            self.open(hierarchy, 0);
        }
    }

    /// Lower bound, in the ray's parameter, of the entry times of all boxes not yet opened; infinite if there
    /// is none.
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

    /// The leaves in the node that was opened last.
    pub fn fresh(&self) -> &[u32] {
        &self.fresh[..self.fresh_count]
    }

    /// Opens the nearest box; returns its leaf if it is the box of a leaf.
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
        self.fresh_count = 0;
        let (mut left, enter) =
            dispatch!(hierarchy.level, simd => Slabs::new(simd, &self.probe).entered(node));
        while left != 0 {
            let k = left.trailing_zeros() as usize % WIDTH;
            left &= left - 1;
            let child = node.child[k];
            self.waiting.push(Reverse(u64::from(bits_of(enter[k])) << 32 | u64::from(child)));
            if child & LEAF != 0 {
                self.fresh[self.fresh_count % WIDTH] = child ^ LEAF;
                self.fresh_count += 1;
            }
        }
    }
}

/// Maps a number to bits that sort in the same order.
fn bits_of(time: f32) -> u32 {
    let bits = time.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

fn time_of(bits: u32) -> f32 {
    f32::from_bits(if bits >> 31 == 1 { bits ^ 1 << 31 } else { !bits })
}

/// A ray prepared for the slab test (Kay & Kajiya, "Ray tracing complex scenes", 1986) against eight boxes at
/// once.
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

    /// Bit mask of the boxes that the ray passes within its window, and the entry times. For an unused box
    /// the ray enters at +inf and leaves at -inf.
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

    /// Bit mask of the boxes that overlap another box.
    fn overlaps(&self, other: &Item) -> u32 {
        let meets = |k: usize| {
            (0..3).all(|axis| {
                self.planes[axis][k] <= other.hi[axis] && other.lo[axis] <= self.planes[axis + 3][k]
            })
        };
        (0..WIDTH).filter(|&k| meets(k)).fold(0, |bits, k| bits | 1 << k)
    }
}

/// A part of the items that becomes a child of a wide node.
#[derive(Clone, Copy)]
struct Piece {
    /// Its index in the table of parts.
    part: usize,
    /// First of its items.
    begin: usize,
    count: usize,
}

impl Piece {
    /// The two children of its split.
    fn split(self, parts: &[Part]) -> [Piece; 2] {
        let Piece { part, begin, count } = self;
        let first = parts[part].first as usize;
        let second = Piece { part: part + 1 + part_count(first), begin: begin + first, count: count - first };
        [Piece { part: part + 1, begin, count: first }, second]
    }
}

/// The nodes of the wide tree in preorder. The box of largest area in a node is split until the node has
/// eight.
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

/// Splits a piece of more than eight items into up to eight pieces. Returns these and their number.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::build::part_count;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn boxes(seed: u64, count: usize, size: f64, at: Vec3) -> Vec<(Bounds, u32)> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut point = || Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let mut one = |k: usize| (Bounds::centred(at + point(), size * point().abs()), k as u32);
        (0..count).map(&mut one).collect()
    }

    /// Hard cases: boxes nested in a corner, ever smaller; identical boxes; boxes without extent.
    fn odd(count: usize) -> [Vec<(Bounds, u32)>; 3] {
        let point = |x: f64| Bounds { lo: Vec3::splat(x), hi: Vec3::splat(x) };
        let shrinking = |k: usize| Bounds { lo: Vec3::ZERO, hi: Vec3::splat(libm::exp2(-(k as f64) / 7.0)) };
        let numbered = |make: &dyn Fn(usize) -> Bounds| (0..count).map(|k| (make(k), k as u32)).collect();
        [
            numbered(&shrinking),
            numbered(&|_| Bounds::centred(Vec3::ONE, Vec3::ONE)),
            numbered(&|_| point(3.0)),
        ]
    }

    /// Collects the leaves below a node and returns the depth of the tree. Asserts that boxes contain their
    /// children.
    fn leaves_below(nodes: &[Node], at: usize, depth: usize, out: &mut Vec<u32>) -> usize {
        let (mut deepest, node) = (depth, &nodes[at]);
        for k in (0..WIDTH).filter(|&k| node.planes[0][k] <= node.planes[3][k]) {
            if node.child[k] & LEAF != 0 {
                out.push(node.child[k] ^ LEAF);
                continue;
            }
            let below = &nodes[node.child[k] as usize];
            for (axis, j) in (0..3).flat_map(|axis| (0..WIDTH).map(move |j| (axis, j))) {
                assert!(node.planes[axis][k] <= below.planes[axis][j]);
                assert!(below.planes[axis + 3][j] <= node.planes[axis + 3][k]);
            }
            deepest = deepest.max(leaves_below(nodes, node.child[k] as usize, depth + 1, out));
        }
        deepest
    }

    #[test]
    fn every_leaf_is_in_the_tree_once_and_no_tree_is_too_deep() {
        let mut all: Vec<_> =
            [1, 7, 8, 9, 63, 64, 65, 1000].map(|n| boxes(n as u64, n, 0.1, Vec3::ZERO)).into();
        all.extend(odd(3000));
        for leaves in all {
            let tree = Hierarchy::new(&leaves, 1);
            let mut found = Vec::new();
            let depth = leaves_below(&tree.nodes, 0, 1, &mut found);
            found.sort_unstable();
            assert!(found.into_iter().eq(0..leaves.len() as u32));
            assert!(depth <= DEPTH, "{depth}");
            assert!(leaves.len() < 1000 || tree.bytes() <= 44 * leaves.len(), "{}", tree.bytes());
        }
        assert!(Hierarchy::new(&[], 1).nodes.is_empty());
    }

    #[test]
    fn the_tree_does_not_depend_on_the_number_of_threads() {
        let leaves = boxes(1, 70_000, 0.05, Vec3::ZERO);
        let shape = |threads: usize| {
            let Hierarchy { nodes, .. } = Hierarchy::new(&leaves, threads);
            nodes
                .iter()
                .map(|node| (node.planes.map(|p| p.map(f32::to_bits)), node.child))
                .collect::<Vec<_>>()
        };
        let one = shape(1);
        assert!(one.len() > part_count(70_000) / 16);
        for threads in [2, 3, 8] {
            assert!(shape(threads) == one, "{threads} threads");
        }
    }

    /// Slab test in f64 on boxes that are not grown.
    fn passes(ray: &Ray, window: Window, bounds: &Bounds) -> bool {
        let (mut enter, mut leave) = (window.t_min(), window.t_max());
        for k in 0..3 {
            let (a, b) = (bounds.lo[k] - ray.origin[k], bounds.hi[k] - ray.origin[k]);
            if ray.direction[k] == 0.0 {
                if a > 0.0 || b < 0.0 {
                    return false;
                }
                continue;
            }
            let (a, b) = (a / ray.direction[k], b / ray.direction[k]);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
        enter <= leave
    }

    /// Rays near boxes of about unit size around a point: along axes, through corners, and from afar.
    fn rays(rng: &mut ChaCha8Rng, leaves: &[(Bounds, u32)], at: Vec3) -> Vec<Ray> {
        let mut vector = || Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let mut rays = Vec::new();
        for k in 0..120 {
            let (through, direction) = (at + vector(), vector());
            let bounds = leaves[k * 7 % leaves.len()].0;
            let far = [0.0, 2.0, 1e3][k % 3];
            let through = if k % 4 == 0 { bounds.corners()[k % 8] } else { through };
            let direction = match k % 5 {
                0 => Vec3::AXES[k % 3],
                1 => -Vec3::AXES[k % 3] + 1e-13 * direction,
                2 => direction * 1e-3,
                _ => direction,
            };
            rays.push(Ray::new(through - far * direction, direction));
        }
        rays
    }

    #[test]
    fn no_leaf_on_the_way_is_missed_and_few_others_are_found() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        for (at, size) in [(Vec3::ZERO, 0.2), (Vec3::new(50.0, -20.0, 3.0), 0.05), (Vec3::splat(1e6), 0.1)] {
            let leaves = boxes(3, 900, size, at);
            let tree = Hierarchy::new(&leaves, 1);
            let (mut met, mut found) = (0, 0);
            for ray in rays(&mut rng, &leaves, at) {
                let begin = ray.closest_time(at);
                let half = rng.random_range(0.0..0.7) / ray.direction.length();
                for window in [Window::ALL, Window::new(begin - half, begin + half).unwrap()] {
                    let margin = 1e-12 * (ray.origin.length() + at.length());
                    let probe = tree.probe(&ray, margin, window);
                    let mut touched = Vec::new();
                    tree.touched(&probe, &mut touched);
                    touched.sort_unstable();
                    // front-to-back traversal finds the same leaves
                    let (mut front, mut ordered, mut time) =
                        (Front::default(), Vec::new(), f64::NEG_INFINITY);
                    front.begin(&tree, probe);
                    while front.time() < f64::INFINITY {
                        assert!(front.time() >= time);
                        time = front.time();
                        let Some(leaf) = front.next(&tree) else { continue };
                        let entry = |bounds: &Bounds| {
                            passes(&ray, Window::new(-1e300, time).unwrap(), &bounds.grown(-1e-5))
                        };
                        assert!(window != Window::ALL || !entry(&leaves[leaf as usize].0));
                        ordered.push(leaf);
                    }
                    ordered.sort_unstable();
                    assert_eq!(ordered, touched);
                    let on_the_way = leaves.iter().filter(|(bounds, _)| passes(&ray, window, bounds));
                    for (_, leaf) in on_the_way {
                        assert!(touched.binary_search(leaf).is_ok(), "{ray:?} {window:?} misses {leaf}");
                        met += 1;
                    }
                    found += touched.len();
                }
            }
            // 60 allows for boxes that a ray barely passes or misses
            assert!(met > 100 && found <= met + met / 50 + 60, "{found} of {met}");
        }
    }

    #[test]
    fn boxes_that_hold_a_point_are_found() {
        let leaves = boxes(5, 500, 0.3, Vec3::ONE);
        let tree = Hierarchy::new(&leaves, 1);
        for (bounds, leaf) in &leaves {
            for point in [bounds.centre(), bounds.lo, bounds.hi] {
                let mut found = Vec::new();
                tree.around(point, 0.0, &mut found);
                assert!(found.contains(leaf));
                let near = |leaf: &u32| leaves[*leaf as usize].0.grown(1e-5).contains(point);
                assert!(found.iter().all(near));
            }
        }
    }
}
