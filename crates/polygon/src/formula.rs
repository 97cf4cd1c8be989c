//! CSG representation of polygons: boolean formulas of half-planes, one for each edge.
//!
//! *Source*: D. Dobkin, L. Guibas, J. Hershberger and J. Snoeyink, "An efficient algorithm for finding the CSG
//! representation of a simple polygon", Algorithmica 10 (1993) (SIGGRAPH 1988), after D. P. Peterson, "Halfspace
//! representation of extrusions, solids of revolution, and pyramids", SANDIA report SAND84-0572 (1984).
//!
//! A simple chain of edges whose first and last edges are extended to infinity divides the plane. The formula of its left side is
//! built recursively. A vertex v on the convex hull of the chain splits it into two parts, whose edges at v are extended to
//! infinity. The extensions leave the hull and intersect nothing, so both parts are simple. The left side of the chain is the
//! intersection of the left sides of both parts if the chain turns left at v, otherwise their union. A polygon is the
//! intersection of the left sides of two chains: from its lexicographically first vertex to its last one, and back.
//!
//! All decisions use exact signs: the formula is exact for the given coordinates. Ties on the hull may be broken arbitrarily:
//! the formula is then the limit of the formulas of polygons with this vertex moved outward by smaller and smaller amounts.
//!
//! *Cost*: O(n h) with recursion depth h: about log n for common polygons, n at worst.

use crate::Point;
use crate::Polygons;
use crate::exact::{orientation, sign};
use crate::sweep::lexicographic;
use rayweave_math::roots::difference_of_products;
use rayweave_rootray::Side;

/// A half-plane `normal . p < offset`, bounded by the line through an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane {
    /// The outward normal, scaled so that the larger component is 1 in magnitude.
    pub normal: Point,
    /// The value of `normal . p` on the bounding line.
    pub offset: f64,
    /// The index of the edge.
    pub edge: u32,
}

/// A boolean operator of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// Inside all parts.
    Intersection,
    /// Inside any part.
    Union,
    /// Inside an odd number of parts.
    SymmetricDifference,
    /// Outside its only part.
    Complement,
}

impl Polygons {
    /// Folds the boolean formula of the region, operands first: `half_plane` converts each edge, `join` applies an operator.
    ///
    /// The formula of a contour consists of unions and intersections with one half-plane for each of its edges. The region is the
    /// symmetric difference of all contours or, if it is unbounded, the complement of that. `join` gets one operand for a
    /// complement and any number of operands for the other operators.
    pub fn fold<T>(
        &self,
        mut half_plane: impl FnMut(HalfPlane) -> T,
        mut join: impl FnMut(Operator, Vec<T>) -> T,
    ) -> T {
        let mut contours = Vec::with_capacity(self.nesting.len());
        for k in 0..self.nesting.len() {
            let corners = self.corners_of(k);
            let chain =
                Chain::new(&self.vertices[corners.clone()], corners.start as u32, self.nesting[k].is_island);
            contours.push(chain.fold_closed(&mut |edge| half_plane(chain.half_plane(edge)), &mut join));
        }
        let enclosed = match contours.len() {
            1 => contours.remove(0),
            _ => join(Operator::SymmetricDifference, contours),
        };
        match self.outside {
            Side::Outside => enclosed,
            Side::Inside => join(Operator::Complement, vec![enclosed]),
        }
    }
}

/// A chain of edges: a contour as a closed counter-clockwise chain that starts and ends at the lexicographically first vertex, or a
/// part of one, whose first and last edges stand for their extensions to infinity.
pub(crate) struct Chain {
    pub points: Vec<Point>,
    /// The index of the edge from each point to the next.
    pub edges: Vec<u32>,
}

/// A step of the construction, on an explicit stack.
enum Task {
    /// The chain of the edges between two points.
    Chain(usize, usize),
    /// Joins the last two formulas.
    Join(Operator),
}

/// A subformula: an operator with its operands. A single half-plane has no operator.
struct Subformula<T> {
    operator: Option<Operator>,
    parts: Vec<T>,
}

impl<T> Subformula<T> {
    /// The operands for an outer operator: those of the subformula if it has the same operator, else the joined subformula.
    fn operands_for(self, operator: Operator, join: &mut impl FnMut(Operator, Vec<T>) -> T) -> Vec<T> {
        match self.operator {
            Some(own) if own != operator => vec![join(own, self.parts)],
            _ => self.parts,
        }
    }
}

impl Chain {
    pub fn new(corners: &[Point], first_edge: u32, is_counter_clockwise: bool) -> Chain {
        let n = corners.len();
        let first = (0..n).min_by(|&a, &b| lexicographic(corners[a], corners[b])).unwrap_or(0);
        // in a reversed contour the edge from corner k is the given edge that ends there
        let corner = |k: usize| if is_counter_clockwise { (first + k) % n } else { (first + n - k % n) % n };
        let edge = |k: usize| if is_counter_clockwise { corner(k) } else { corner(k + 1) };
        Chain {
            points: (0..=n).map(|k| corners[corner(k)]).collect(),
            edges: (0..n).map(|k| first_edge + edge(k) as u32).collect(),
        }
    }

    /// The formula of the inside of a closed chain; `half_plane` converts an edge by its index in the chain.
    pub fn fold_closed<T>(
        &self,
        half_plane: &mut impl FnMut(usize) -> T,
        join: &mut impl FnMut(Operator, Vec<T>) -> T,
    ) -> T {
        let n = self.edges.len();
        let last = (0..n).max_by(|&a, &b| lexicographic(self.points[a], self.points[b])).unwrap_or(0);
        let tasks = vec![Task::Join(Operator::Intersection), Task::Chain(last, n), Task::Chain(0, last)];
        let made = self.subformulas(tasks, half_plane, join);
        // the bottom of the stack is the intersection of both chains
        let parts =
            made.into_iter().flat_map(|group| group.operands_for(Operator::Intersection, join)).collect();
        join(Operator::Intersection, parts)
    }

    /// The formula of the left side of an open chain, which is simple with its first and last edges extended to infinity.
    pub fn fold_open<T>(
        &self,
        half_plane: &mut impl FnMut(usize) -> T,
        join: &mut impl FnMut(Operator, Vec<T>) -> T,
    ) -> T {
        let mut made = self.subformulas(vec![Task::Chain(0, self.edges.len())], half_plane, join);
        match made.pop() {
            Some(Subformula { operator: Some(operator), parts }) => join(operator, parts),
            Some(Subformula { operator: None, mut parts }) if parts.len() == 1 => parts.remove(0),
            _ => join(Operator::Intersection, Vec::new()),
        }
    }

    fn subformulas<T>(
        &self,
        mut tasks: Vec<Task>,
        half_plane: &mut impl FnMut(usize) -> T,
        join: &mut impl FnMut(Operator, Vec<T>) -> T,
    ) -> Vec<Subformula<T>> {
        let mut made: Vec<Subformula<T>> = Vec::new();
        let mut budget = 100 * self.edges.len();
        while let Some(task) = tasks.pop() {
            match task {
                Task::Chain(from, to) if to - from == 1 => {
                    made.push(Subformula { operator: None, parts: vec![half_plane(from)] });
                }
                Task::Chain(from, to) => {
                    let cut = self.cut(from, to, &mut budget);
                    let is_left = self.orientation_at(cut) > 0;
                    let operator = if is_left { Operator::Intersection } else { Operator::Union };
                    tasks.extend([Task::Join(operator), Task::Chain(cut, to), Task::Chain(from, cut)]);
                }
                Task::Join(operator) => {
                    let (Some(second), Some(first)) = (made.pop(), made.pop()) else { continue };
                    let mut parts = first.operands_for(operator, join);
                    parts.extend(second.operands_for(operator, join));
                    made.push(Subformula { operator: Some(operator), parts });
                }
            }
        }
        made
    }

    fn orientation_at(&self, k: usize) -> i8 {
        orientation(self.points[k - 1], self.points[k], self.points[k + 1])
    }

    /// The half-plane on the left of an edge.
    ///
    /// The rounding error of the normal is a few u, that of the offset 2 ulp. The line therefore passes both end points within a few
    /// u times their distance from the origin, well within the tolerance `delta`.
    pub fn half_plane(&self, k: usize) -> HalfPlane {
        let (a, b) = (self.points[k], self.points[k + 1]);
        let normal = [b[1] - a[1], a[0] - b[0]];
        let longest = normal[0].abs().max(normal[1].abs());
        let offset = difference_of_products(a[0], b[1], a[1], b[0]) / longest;
        let tidy = |x: f64| if x.abs() < crate::MIN_COORDINATE { 0.0 } else { x };
        HalfPlane { normal: normal.map(|x| tidy(x / longest)), offset: tidy(offset), edge: self.edges[k] }
    }

    /// A vertex strictly between two others, on the convex hull of the extended chain between them: the extreme vertex in a direction
    /// from which both extensions lead away. Of several directions, the one whose extreme vertex is closest to the middle of the chain
    /// is used, which keeps formulas shallow. `budget` is the remaining number of vertices that this search may visit.
    fn cut(&self, from: usize, to: usize, budget: &mut usize) -> usize {
        let p = &self.points;
        // the end edges, directed outward
        let ends = [[p[from + 1], p[from]], [p[to - 1], p[to]]];
        let middle = (from + to) / 2;
        let mut best: Option<usize> = None;
        for direction in directions(ends) {
            if best.is_some() && *budget < to - from {
                break;
            }
            // tested with exact signs
            if ends.iter().any(|&[a, b]| along(direction, b, a) >= 0) {
                continue;
            }
            let found = self.extreme(from, to, direction);
            if best.is_none_or(|best| found.abs_diff(middle) < best.abs_diff(middle)) {
                best = Some(found);
            }
            if 4 * found.abs_diff(middle) <= to - from {
                break;
            }
            *budget = budget.saturating_sub(to - from);
        }
        best.unwrap_or_else(|| self.cut_across(from, to, ends))
    }

    /// The vertex strictly between two others that is extreme in a direction; among ties the one closest to the middle.
    fn extreme(&self, from: usize, to: usize, direction: Point) -> usize {
        let (p, middle) = (&self.points, (from + to) / 2);
        let mut best = from + 1;
        for k in from + 2..to {
            let order = along(direction, p[k], p[best]);
            if order > 0 || (order == 0 && k.abs_diff(middle) < best.abs_diff(middle)) {
                best = k;
            }
        }
        best
    }

    /// The hull vertex for ends without a usable direction between them: the extreme perpendicular to the first end, on the side
    /// away from the other end; among ties the last one along the first end.
    fn cut_across(&self, from: usize, to: usize, [first, last]: [[Point; 2]; 2]) -> usize {
        let p = &self.points;
        // positive to the left of the first end's direction
        let height = |a: Point, b: Point| cross(first, [b, a]);
        let along = |a: Point, b: Point| inner(first, [b, a]);
        let extreme = |sign: i8| {
            let beyond = |a: &usize, b: &usize| {
                let order = sign * height(p[*a], p[*b]);
                order.cmp(&0).then(along(p[*b], p[*a]).cmp(&0))
            };
            (from + 1..to).max_by(|a, b| beyond(a, b)).unwrap_or(from + 1)
        };
        match cross(first, last) {
            0 => {
                let left = extreme(1);
                let leads_back = inner(first, last) < 0;
                let is_level = height(p[left], last[0]) == 0;
                if leads_back && is_level { extreme(-1) } else { left }
            }
            leads_left if leads_left > 0 => extreme(-1),
            _ => extreme(1),
        }
    }
}

/// Candidate directions that lead away from two others, up to rounding: the bisector, directions towards both ends of the range,
/// and the coordinate axes, to which edges of man-made shapes are often parallel.
fn directions(ends: [[Point; 2]; 2]) -> Vec<Point> {
    let [Some(r), Some(s)] = ends.map(unit_from_to) else {
        return Vec::new();
    };
    let join = |a: f64, u: Point, b: f64, v: Point| [a * u[0] + b * v[0], a * u[1] + b * v[1]];
    let c = r[0] * s[0] + r[1] * s[1];
    // perpendicular to one, away from the other
    let (across_r, across_s) = (join(-1.0, s, c, r), join(-1.0, r, c, s));
    let mut all = vec![join(-1.0, r, -1.0, s), [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    all.extend([0.02, 0.2, 0.8, 0.98].map(|part| join(part, across_r, 1.0 - part, across_s)));
    all
}

fn unit_from_to([a, b]: [Point; 2]) -> Option<Point> {
    let d = [b[0] - a[0], b[1] - a[1]];
    let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
    (length > 0.0).then(|| [d[0] / length, d[1] / length])
}

/// The sign of `direction . (a - b)`.
fn along(direction: Point, a: Point, b: Point) -> i8 {
    sign([direction[0], 0.0], [a[0], b[0]], [-direction[1], 0.0], [a[1], b[1]])
}

/// The sign of the cross product of two vectors, each given by its ends.
pub(crate) fn cross([a, b]: [Point; 2], [c, d]: [Point; 2]) -> i8 {
    sign([b[0], a[0]], [d[1], c[1]], [b[1], a[1]], [d[0], c[0]])
}

/// The sign of the dot product of two vectors, each given by its ends.
fn inner([a, b]: [Point; 2], [c, d]: [Point; 2]) -> i8 {
    sign([b[0], a[0]], [d[0], c[0]], [a[1], b[1]], [d[1], c[1]])
}
