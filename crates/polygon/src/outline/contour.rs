//! Pieces of contours: straight edges and arcs, and their division into short arcs.

use crate::Point;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A circular arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    pub centre: Point,
    pub radius: f64,
    pub is_ccw: bool,
}

/// A part of a contour, up to the start of the next part.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    pub from: Point,
    pub arc: Option<Arc>,
    /// The index of the vertex that it belongs to.
    pub origin: usize,
}

/// A straight edge, or an arc of at most a quarter turn.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    pub from: Point,
    pub to: Point,
    pub arc: Option<Arc>,
    pub origin: usize,
}

impl Arc {
    /// The angle of a point as seen from the centre, in radians.
    fn angle(&self, p: Point) -> f64 {
        libm::atan2(p[1] - self.centre[1], p[0] - self.centre[0])
    }

    /// The angle between two points of the arc, positive.
    fn sweep(&self, from: Point, to: Point) -> f64 {
        let turn = self.angle(to) - self.angle(from);
        let turn = if self.is_ccw { turn } else { -turn };
        if turn > 0.0 { turn } else { turn + TAU }
    }

    fn point(&self, angle: f64, distance: f64) -> Point {
        let (sin, cos) = sin_cos_radians(angle);
        [self.centre[0] + distance * cos, self.centre[1] + distance * sin]
    }
}

impl Edge {
    /// Divides pieces into straight edges and arcs of at most 90 degrees divided by 2 to the power of `division`.
    pub fn divide(pieces: &[Piece], division: u32) -> Vec<Edge> {
        let mut edges = Vec::new();
        for (k, &Piece { from, arc, origin }) in pieces.iter().enumerate() {
            let to = pieces[(k + 1) % pieces.len()].from;
            let Some(arc) = arc else {
                edges.push(Edge { from, to, arc: None, origin });
                continue;
            };
            let (start, sweep) = (arc.angle(from), arc.sweep(from, to));
            let longest = FRAC_PI_2 / f64::from(1 << division);
            // an arc of 90 degrees may be longer by rounding
            let count = (sweep / longest - 1e-9).ceil().max(1.0) as u32;
            let mut last = from;
            for part in 1..=count {
                let turn = sweep * f64::from(part) / f64::from(count);
                let angle = if arc.is_ccw { start + turn } else { start - turn };
                let next = if part == count { to } else { arc.point(angle, arc.radius) };
                edges.push(Edge { from: last, to: next, arc: Some(arc), origin });
                last = next;
            }
        }
        edges
    }

    /// Whether an arc bulges away from the inside of a counter-clockwise contour.
    pub fn is_convex(&self) -> Option<bool> {
        self.arc.map(|arc| arc.is_ccw)
    }

    /// The point where the tangents at the ends of an arc meet; the start of a straight edge.
    pub fn apex(&self) -> Point {
        let Some(arc) = self.arc else { return self.from };
        let half = 0.5 * arc.sweep(self.from, self.to);
        let start = arc.angle(self.from);
        arc.point(if arc.is_ccw { start + half } else { start - half }, arc.radius / sin_cos_radians(half).1)
    }

    /// The radius of an arc; 0 for a straight edge.
    pub fn radius(&self) -> f64 {
        self.arc.map_or(0.0, |arc| arc.radius)
    }

    /// The smallest x.
    pub fn smallest_x(&self) -> f64 {
        let ends = self.from[0].min(self.to[0]);
        match self.arc {
            None => ends,
            Some(arc) => {
                // the leftmost point of the circle belongs to the arc if it lies on its side of the chord
                let leftmost = [arc.centre[0] - arc.radius, arc.centre[1]];
                let side = cross(self.from, self.to, leftmost);
                let is_on_arc = if arc.is_ccw { side < 0.0 } else { side > 0.0 };
                if is_on_arc { ends.min(leftmost[0]) } else { ends }
            }
        }
    }

    /// Chords at most this far from the arc.
    pub fn chords(&self, tolerance: f64) -> Vec<Edge> {
        let Some(arc) = self.arc.filter(|arc| arc.radius > 0.0) else {
            return vec![Edge { arc: None, ..*self }];
        };
        let sweep = arc.sweep(self.from, self.to);
        // a chord over the angle a is r (1 - cos(a/2)) from its arc at most, which is less than r a^2 / 8
        let count = (sweep * (arc.radius / (8.0 * tolerance)).sqrt()).ceil().max(1.0) as u32;
        let point = |part: u32| match part {
            0 => self.from,
            _ if part == count => self.to,
            _ => {
                let turn = sweep * f64::from(part) / f64::from(count);
                let start = arc.angle(self.from);
                arc.point(if arc.is_ccw { start + turn } else { start - turn }, arc.radius)
            }
        };
        let chord = |k: u32| Edge { from: point(k), to: point(k + 1), arc: None, origin: self.origin };
        (0..count).map(chord).collect()
    }

    /// The points that divide an arc into equal parts of at most the angle `step`, without its ends, and the unit vectors from the
    /// centre.
    pub fn inner_points(&self, step: f64) -> Vec<(Point, Point)> {
        let Some(arc) = self.arc else { return Vec::new() };
        let (start, sweep) = (arc.angle(self.from), arc.sweep(self.from, self.to));
        // an arc of a whole number of steps may be longer by rounding
        let count = (sweep / step - 1e-9).ceil().max(1.0) as u32;
        let point = |part: u32| {
            let turn = sweep * f64::from(part) / f64::from(count);
            let (sin, cos) = sin_cos_radians(if arc.is_ccw { start + turn } else { start - turn });
            ([arc.centre[0] + arc.radius * cos, arc.centre[1] + arc.radius * sin], [cos, sin])
        };
        (1..count).map(point).collect()
    }

    /// The unit tangents at the start and at the end.
    pub fn tangents(&self) -> [Point; 2] {
        match self.arc {
            None => {
                let d = [self.to[0] - self.from[0], self.to[1] - self.from[1]];
                let length = libm::hypot(d[0], d[1]);
                [[d[0] / length, d[1] / length]; 2]
            }
            Some(arc) => [self.from, self.to].map(|p| {
                let r = [(p[0] - arc.centre[0]) / arc.radius, (p[1] - arc.centre[1]) / arc.radius];
                if arc.is_ccw { [-r[1], r[0]] } else { [r[1], -r[0]] }
            }),
        }
    }
}

/// Sine and cosine of an angle in radians.
fn sin_cos_radians(angle: f64) -> (f64, f64) {
    (libm::sin(angle), libm::cos(angle))
}

/// The pieces in the opposite direction.
pub fn reversed(pieces: Vec<Piece>) -> Vec<Piece> {
    let count = pieces.len();
    let reversed = (0..count).rev().map(|k| {
        let arc = pieces[k].arc.map(|arc| Arc { is_ccw: !arc.is_ccw, ..arc });
        Piece { from: pieces[(k + 1) % count].from, arc, origin: pieces[k].origin }
    });
    reversed.collect()
}

/// The signed area of a contour, positive if it is counter-clockwise. Arcs are taken as short chords.
pub fn turning(pieces: &[Piece]) -> f64 {
    chord_area(&Edge::divide(pieces, 3))
}

/// Twice the area of a triangle, positive if the corners are counter-clockwise.
fn cross(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn chord_area(edges: &[Edge]) -> f64 {
    let first = edges.first().map_or([0.0; 2], |edge| edge.from);
    0.5 * edges.iter().map(|edge| cross(first, edge.from, edge.to)).sum::<f64>()
}

/// The area within a counter-clockwise contour.
pub fn area(edges: &[Edge]) -> f64 {
    let segments = edges.iter().filter_map(|edge| {
        let arc = edge.arc?;
        let sweep = arc.sweep(edge.from, edge.to).min(PI);
        let segment = 0.5 * arc.radius * arc.radius * (sweep - sin_cos_radians(sweep).0);
        Some(if arc.is_ccw { segment } else { -segment })
    });
    chord_area(edges) + segments.sum::<f64>()
}

/// Whether a point that is not near a contour lies within it: the number of its edges to the right of the point is odd.
pub fn is_within(p: Point, contour: &[Point]) -> bool {
    let ends = contour.iter().zip(contour.iter().cycle().skip(1));
    let crossings = ends.filter(|(a, b)| {
        let is_up = a[1] <= p[1] && p[1] < b[1];
        let is_down = b[1] <= p[1] && p[1] < a[1];
        (is_up && cross(**a, **b, p) > 0.0) || (is_down && cross(**a, **b, p) < 0.0)
    });
    crossings.count() % 2 == 1
}
