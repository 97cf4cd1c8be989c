//! Search tree of rings about one axis: rectangles of radius and height.

use rayweave_model::{Ring, Window};
use rayweave_shape::Ray;

/// Rings of a leaf node.
const LEAF: usize = 4;

/// A bounding volume hierarchy of the rings of a group that have a common axis.
#[derive(Clone, Debug)]
pub(crate) struct RingTree {
    centre: [f64; 2],
    /// In preorder.
    nodes: Vec<Node>,
    /// The leaves of the rings, ring by ring in the order of the tree, and the end of those of each ring.
    leaves: Vec<u32>,
    ends: Vec<u32>,
    rectangles: Vec<Rectangle>,
}

/// The smallest and the largest radius, and the same of z.
#[derive(Clone, Copy, Debug)]
struct Rectangle {
    radii: [f64; 2],
    heights: [f64; 2],
}

#[derive(Clone, Copy, Debug)]
struct Node {
    around: Rectangle,
    /// The node after all below this one.
    next: u32,
    /// The rings of a leaf node; none in others.
    begin: u32,
    end: u32,
}

impl Rectangle {
    const EMPTY: Rectangle =
        Rectangle { radii: [f64::INFINITY, f64::NEG_INFINITY], heights: [f64::INFINITY, f64::NEG_INFINITY] };

    fn union(self, other: &Rectangle) -> Rectangle {
        let union = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Rectangle { radii: union(self.radii, other.radii), heights: union(self.heights, other.heights) }
    }

    fn middles(&self) -> [f64; 2] {
        [self.radii, self.heights].map(|[lo, hi]| 0.5 * (lo + hi))
    }
}

impl RingTree {
    /// Groups with fewer rings are searched by boxes alone.
    pub const MANY: usize = 64;

    /// The tree of the rings with the most frequent axis; `None` if they are few.
    pub fn new(mut rings: Vec<Ring>) -> Option<RingTree> {
        if rings.len() < RingTree::MANY {
            return None;
        }
        let key = |ring: &Ring| ring.centre.map(f64::to_bits);
        rings.sort_by_key(key);
        let centre = rings.chunk_by(|a, b| key(a) == key(b)).max_by_key(|same| same.len())?[0].centre;
        rings.retain(|ring| ring.centre == centre);
        if rings.len() < RingTree::MANY {
            return None;
        }
        let rectangle = |ring: &Ring| Rectangle { radii: ring.radii, heights: ring.heights };
        let given: Vec<Rectangle> = rings.iter().map(rectangle).collect();
        let mut order: Vec<usize> = (0..given.len()).collect();
        let nodes = built(&given, &mut order);
        let rectangles = order.iter().map(|&ring| given[ring]).collect();
        let (mut leaves, mut ends) = (Vec::new(), Vec::new());
        for ring in order {
            leaves.extend_from_slice(&rings[ring].leaves);
            ends.push(leaves.len() as u32);
        }
        Some(RingTree { centre, nodes, leaves, ends, rectangles })
    }

    /// The leaves of all rings.
    pub fn leaves(&self) -> &[u32] {
        &self.leaves
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
            + size_of_val(&self.leaves[..])
            + size_of_val(&self.ends[..])
            + size_of_val(&self.rectangles[..])
    }

    /// Appends the leaves of the rings that a ray may touch within a window. `margin` is the error of positions on the ray.
    pub fn intersected(&self, ray: &Ray, window: Window, margin: f64, out: &mut Vec<u32>) {
        let probe = RingProbe::new(ray, self.centre, window, margin);
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            if !probe.may_touch(&node.around) {
                at = node.next as usize;
                continue;
            }
            for ring in node.begin as usize..node.end as usize {
                if probe.may_touch(&self.rectangles[ring]) {
                    let begin = ring.checked_sub(1).map_or(0, |before| self.ends[before]);
                    out.extend_from_slice(&self.leaves[begin as usize..self.ends[ring] as usize]);
                }
            }
            at += 1;
        }
    }
}

/// The nodes over rings, of which `order` becomes the order in the tree.
fn built(rings: &[Rectangle], order: &mut [usize]) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::new();
    // the nodes on the way down wait for their end
    enum Task {
        Range(usize, usize),
        End(usize),
    }
    let mut tasks = vec![Task::Range(0, order.len())];
    while let Some(task) = tasks.pop() {
        let (begin, end) = match task {
            Task::Range(begin, end) => (begin, end),
            Task::End(node) => {
                nodes[node].next = nodes.len() as u32;
                continue;
            }
        };
        let own = &mut order[begin..end];
        let around = own.iter().fold(Rectangle::EMPTY, |all, &ring| all.union(&rings[ring]));
        tasks.push(Task::End(nodes.len()));
        if own.len() <= LEAF {
            nodes.push(Node { around, next: 0, begin: begin as u32, end: end as u32 });
            continue;
        }
        nodes.push(Node { around, next: 0, begin: 0, end: 0 });
        let range = |axis: usize| {
            let all = own.iter().map(|&ring| rings[ring].middles()[axis]);
            let [lo, hi] = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)]);
            hi - lo
        };
        let axis = usize::from(range(1) > range(0));
        let half = own.len() / 2;
        let place = |ring: usize| rings[ring].middles()[axis];
        own.select_nth_unstable_by(half, |&a, &b| place(a).total_cmp(&place(b)).then(a.cmp(&b)));
        tasks.extend([Task::Range(begin + half, end), Task::Range(begin, begin + half)]);
    }
    nodes
}

/// A ray for tests against rings.
struct RingProbe {
    /// The coefficients of the squared distance from the axis, `square t^2 + 2 half t + constant`.
    square: f64,
    half: f64,
    constant: f64,
    /// The start along the axis, and the speed.
    height: f64,
    speed: f64,
    times: [f64; 2],
    margin: f64,
    /// The distance of the origin and the speed, for the rounding errors of positions.
    origin: f64,
    rate: f64,
}

/// The rounding of positions and of squared distances, relative to the lengths involved: some tens of roundings.
const ROUNDING: f64 = 1e-14;

impl RingProbe {
    fn new(ray: &Ray, centre: [f64; 2], window: Window, margin: f64) -> RingProbe {
        let (o, d) = (ray.origin, ray.direction);
        let [x, y] = [o.x - centre[0], o.y - centre[1]];
        RingProbe {
            square: d.x * d.x + d.y * d.y,
            half: x * d.x + y * d.y,
            constant: x * x + y * y,
            height: o.z,
            speed: d.z,
            times: [window.t_min(), window.t_max()],
            margin,
            origin: o.length() + libm::hypot(centre[0], centre[1]),
            rate: d.length(),
        }
    }

    /// False only if the ray misses the ring.
    fn may_touch(&self, ring: &Rectangle) -> bool {
        let [lo, hi] = [ring.heights[0] - self.margin, ring.heights[1] + self.margin];
        let [mut from, mut to] = self.times;
        if self.speed == 0.0 {
            if self.height < lo || self.height > hi {
                return false;
            }
        } else {
            let [a, b] = [(lo - self.height) / self.speed, (hi - self.height) / self.speed];
            let slack = ROUNDING * (a.abs().max(b.abs()) + self.origin / self.speed.abs());
            (from, to) = (from.max(a.min(b) - slack), to.min(a.max(b) + slack));
        }
        if from > to {
            return false;
        }
        // the squared distance from the axis, with its rounding error
        let squared = |t: f64| {
            let lengths = self.origin + self.rate * t.abs();
            ((self.square * t + 2.0 * self.half) * t + self.constant, ROUNDING * lengths * lengths)
        };
        let [inner, outer] = [ring.radii[0] - self.margin, ring.radii[1] + self.margin];
        let nearest = if self.square > 0.0 { (-self.half / self.square).clamp(from, to) } else { from };
        let (least, error) = squared(if nearest.is_finite() { nearest } else { 0.0 });
        if least - error > outer * outer && (nearest.is_finite() || self.square == 0.0) {
            return false;
        }
        // the distance is convex: within the inner cylinder at both ends, the ray is so between them
        let is_within = |t: f64| {
            let (square, error) = squared(t);
            t.is_finite() && square + error < inner * inner
        };
        !(inner > 0.0 && is_within(from) && is_within(to))
    }
}
