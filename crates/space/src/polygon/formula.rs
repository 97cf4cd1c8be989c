//! A polygon as a boolean formula of half-planes, one for each edge.
//!
//! *Source*: D. Dobkin, L. Guibas, J. Hershberger and J. Snoeyink, "An efficient algorithm for finding the CSG
//! representation of a simple polygon", Algorithmica 10 (1993) (SIGGRAPH 1988), after D. P. Peterson, "Halfspace
//! representation of extrusions, solids of revolution, and pyramids", SANDIA report SAND84-0572 (1984).
//!
//! A simple chain of edges whose first and last edge go on for ever divides the plane; the formula of what is on
//! its left is made as follows. A vertex v on the convex hull of the chain cuts it in two, and each part goes on
//! straight where it was cut. It meets nothing there, since it leaves the hull, so that both parts are simple,
//! too. The left of the chain is what is left of both parts if the chain turns left at v, else what is left of
//! either. A polygon is what is left of two chains, from its lexicographically first vertex to its last one and
//! back.
//!
//! All choices are made on exact signs, so that the formula is right for the polygon's numbers as they are.
//! A tie on the hull may be resolved at will: the polygon is then as good as one with that vertex moved outward by
//! any small amount, whose formula is right, and whose half-planes tend to these.
//!
//! *Cost*: O(n h), h being the number of cuts one within the other: about log n for polygons of everyday, n at worst.

use super::Polygons;
use super::exact::{sign, turn};
use super::sweep::lexicographic;
use crate::Point;
use rayweave_math::roots::difference_of_products;
use rayweave_rootray::Side;

/// A half-plane `normal . p < offset`, bounded by the line through an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane {
    /// Out of the half-plane; its larger component is 1 in magnitude.
    pub normal: Point<2>,
    /// `normal . p` on the line.
    pub offset: f64,
    /// The number of the edge.
    pub edge: u32,
}

/// What joins the parts of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// Inside all parts.
    Intersection,
    /// Inside any part.
    Union,
    /// Inside an odd number of parts.
    SymmetricDifference,
    /// Outside the one part.
    Complement,
}

impl Polygons {
    /// The region as a formula: what `half_plane` makes of each edge, joined by `join`, innermost first.
    ///
    /// Each contour encloses a formula of unions and intersections in which each of its edges occurs once; the region
    /// is the symmetric difference of all contours or, if the outside is inside, the complement of that. `join`
    /// gets one part for a complement and any number for the other operators.
    pub fn fold<T>(
        &self,
        mut half_plane: impl FnMut(HalfPlane) -> T,
        mut join: impl FnMut(Operator, Vec<T>) -> T,
    ) -> T {
        let mut contours = Vec::with_capacity(self.places.len());
        for k in 0..self.places.len() {
            let corners = self.corners_of(k);
            let chain =
                Chain::new(&self.vertices[corners.clone()], corners.start as u32, self.places[k].is_island);
            contours.push(chain.fold(&mut half_plane, &mut join));
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

/// A contour as a closed chain, counter-clockwise from its lexicographically first vertex, which is at both ends.
struct Chain {
    points: Vec<Point<2>>,
    /// The number of the edge from each point to the next.
    edges: Vec<u32>,
}

/// A step of making a formula.
enum Task {
    /// The chain of the edges between two points.
    Chain(usize, usize),
    /// The two formulas made last, joined.
    Join(Operator),
}

/// A part of a formula on its way: its parts, and what joins them.
struct Group<T> {
    operator: Option<Operator>,
    parts: Vec<T>,
}

impl<T> Group<T> {
    /// One part for the operator: itself if it is of that operator, else closed.
    fn opened(self, operator: Operator, join: &mut impl FnMut(Operator, Vec<T>) -> T) -> Vec<T> {
        match self.operator {
            Some(own) if own != operator => vec![join(own, self.parts)],
            _ => self.parts,
        }
    }
}

impl Chain {
    fn new(corners: &[Point<2>], first_edge: u32, is_counter_clockwise: bool) -> Chain {
        let n = corners.len();
        let first = (0..n).min_by(|&a, &b| lexicographic(corners[a], corners[b])).unwrap_or(0);
        // backwards, the edge from corner k is that which leads to it
        let corner = |k: usize| if is_counter_clockwise { (first + k) % n } else { (first + n - k % n) % n };
        let edge = |k: usize| if is_counter_clockwise { corner(k) } else { corner(k + 1) };
        Chain {
            points: (0..=n).map(|k| corners[corner(k)]).collect(),
            edges: (0..n).map(|k| first_edge + edge(k) as u32).collect(),
        }
    }

    fn fold<T>(
        &self,
        half_plane: &mut impl FnMut(HalfPlane) -> T,
        join: &mut impl FnMut(Operator, Vec<T>) -> T,
    ) -> T {
        let n = self.edges.len();
        let last = (0..n).max_by(|&a, &b| lexicographic(self.points[a], self.points[b])).unwrap_or(0);
        let mut tasks = vec![Task::Join(Operator::Intersection), Task::Chain(last, n), Task::Chain(0, last)];
        let mut made: Vec<Group<T>> = Vec::new();
        let mut patience = 100 * n;
        while let Some(task) = tasks.pop() {
            match task {
                Task::Chain(from, to) if to - from == 1 => {
                    made.push(Group { operator: None, parts: vec![half_plane(self.half_plane(from))] });
                }
                Task::Chain(from, to) => {
                    let cut = self.cut(from, to, &mut patience);
                    let is_left = self.turn(cut) > 0;
                    let operator = if is_left { Operator::Intersection } else { Operator::Union };
                    tasks.extend([Task::Join(operator), Task::Chain(cut, to), Task::Chain(from, cut)]);
                }
                Task::Join(operator) => {
                    let (Some(second), Some(first)) = (made.pop(), made.pop()) else { continue };
                    let mut parts = first.opened(operator, join);
                    parts.extend(second.opened(operator, join));
                    made.push(Group { operator: Some(operator), parts });
                }
            }
        }
        // the first task was the intersection of both chains, so that this is its group
        let parts = made.into_iter().flat_map(|group| group.opened(Operator::Intersection, join)).collect();
        join(Operator::Intersection, parts)
    }

    fn turn(&self, k: usize) -> i8 {
        turn(self.points[k - 1], self.points[k], self.points[k + 1])
    }

    /// What is on the left of an edge.
    ///
    /// The normal is rounded by a few u and the offset by 2 ulp, so that the line passes both ends within a few u of
    /// their distance from the origin: well within `delta`.
    fn half_plane(&self, k: usize) -> HalfPlane {
        let (a, b) = (self.points[k], self.points[k + 1]);
        let normal = [b[1] - a[1], a[0] - b[0]];
        let longest = normal[0].abs().max(normal[1].abs());
        let offset = difference_of_products(a[0], b[1], a[1], b[0]) / longest;
        let tidy = |x: f64| if x.abs() < super::LEAST { 0.0 } else { x };
        HalfPlane { normal: normal.map(|x| tidy(x / longest)), offset: tidy(offset), edge: self.edges[k] }
    }

    /// A vertex strictly between two others that is on the convex hull of the chain between them, whose first and
    /// last edge go on for ever: the extreme in a direction from which both of these lead away. Of several such
    /// directions that is taken whose extreme halves the chain best, so that formulas are not high; `patience` is the
    /// number of vertices that may still be looked at for that.
    fn cut(&self, from: usize, to: usize, patience: &mut usize) -> usize {
        let p = &self.points;
        // from the chain outward along its ends
        let ends = [[p[from + 1], p[from]], [p[to - 1], p[to]]];
        let middle = (from + to) / 2;
        let mut best: Option<usize> = None;
        for direction in directions(ends) {
            if best.is_some() && *patience < to - from {
                break;
            }
            // exactly
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
            *patience = patience.saturating_sub(to - from);
        }
        best.unwrap_or_else(|| self.cut_across(from, to, ends))
    }

    /// The vertex strictly between two others that is farthest in a direction; of equals the one that halves the
    /// chain best.
    fn extreme(&self, from: usize, to: usize, direction: Point<2>) -> usize {
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

    /// The same for ends of which no middle direction can be had: the extreme across the first end, on the side
    /// where the other end does not lead, and of several the last one seen from there.
    fn cut_across(&self, from: usize, to: usize, [first, last]: [[Point<2>; 2]; 2]) -> usize {
        let p = &self.points;
        // positive to the left of the first end's direction
        let height = |a: Point<2>, b: Point<2>| cross(first, [b, a]);
        let forth = |a: Point<2>, b: Point<2>| inner(first, [b, a]);
        let extreme = |sign: i8| {
            let beyond = |a: &usize, b: &usize| {
                let order = sign * height(p[*a], p[*b]);
                order.cmp(&0).then(forth(p[*b], p[*a]).cmp(&0))
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

/// Directions that lead away from two others, but for rounding: the middle one, those towards either end of the
/// range, and the axes, along which the edges of man-made things lie side by side.
fn directions(ends: [[Point<2>; 2]; 2]) -> Vec<Point<2>> {
    let [Some(r), Some(s)] = ends.map(unit_from_to) else {
        return Vec::new();
    };
    let join = |a: f64, u: Point<2>, b: f64, v: Point<2>| [a * u[0] + b * v[0], a * u[1] + b * v[1]];
    let c = r[0] * s[0] + r[1] * s[1];
    // perpendicular to the one, away from the other
    let (across_r, across_s) = (join(-1.0, s, c, r), join(-1.0, r, c, s));
    let mut all = vec![join(-1.0, r, -1.0, s), [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    all.extend([0.02, 0.2, 0.8, 0.98].map(|part| join(part, across_r, 1.0 - part, across_s)));
    all
}

fn unit_from_to([a, b]: [Point<2>; 2]) -> Option<Point<2>> {
    let d = [b[0] - a[0], b[1] - a[1]];
    let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
    (length > 0.0).then(|| [d[0] / length, d[1] / length])
}

/// The sign of `direction . (a - b)`.
fn along(direction: Point<2>, a: Point<2>, b: Point<2>) -> i8 {
    sign([direction[0], 0.0], [a[0], b[0]], [-direction[1], 0.0], [a[1], b[1]])
}

/// The sign of the cross product of two vectors, each given by its ends.
fn cross([a, b]: [Point<2>; 2], [c, d]: [Point<2>; 2]) -> i8 {
    sign([b[0], a[0]], [d[1], c[1]], [b[1], a[1]], [d[0], c[0]])
}

/// The sign of their inner product.
fn inner([a, b]: [Point<2>; 2], [c, d]: [Point<2>; 2]) -> i8 {
    sign([b[0], a[0]], [d[0], c[0]], [a[1], b[1]], [d[1], c[1]])
}
