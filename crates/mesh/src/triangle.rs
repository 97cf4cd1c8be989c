//! One triangle: its plane, its closest point, and whether it meets another.

use rayweave_math::{Bounds, Vec3};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// The corners of a triangle.
pub(crate) type Triangle = [Vec3; 3];

pub(crate) fn bounds([a, b, c]: Triangle) -> Bounds {
    Bounds { lo: a.min(b).min(c), hi: a.max(b).max(c) }
}

pub(crate) fn middle([a, b, c]: Triangle) -> Vec3 {
    (a + b + c) / 3.0
}

/// The vector across a triangle, which turns counter-clockwise seen from its tip; twice as long as the triangle is large.
pub(crate) fn cross([a, b, c]: Triangle) -> Vec3 {
    (b - a).cross(c - a)
}

/// The unit normal; NaN if the corners lie on a line.
pub(crate) fn normal(triangle: Triangle) -> Vec3 {
    let cross = cross(triangle);
    // squares of areas may be beyond the range
    let cross = cross / cross.abs().max_element();
    cross / cross.length()
}

/// The point of a triangle that is closest to `p`.
///
/// *Source*: C. Ericson, Real-Time Collision Detection (2005), 5.1.5.
pub(crate) fn closest_point([a, b, c]: Triangle, p: Vec3) -> Vec3 {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + (d1 / (d1 - d3)) * ab;
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + (d2 / (d2 - d6)) * ac;
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b);
    }
    let scale = 1.0 / (va + vb + vc);
    a + (vb * scale) * ab + (vc * scale) * ac
}

/// The side of the plane through a triangle on which a point is, exactly: -1, 0, 1.
pub(crate) fn side_of(triangle: Triangle, p: Vec3) -> i8 {
    let [a, b, c] = triangle.map(coord3);
    // turns of corners and sides of points are mirrored there
    sign(-orient3d(a, b, c, coord3(p)))
}

fn coord3(p: Vec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// True if the corners lie on one line, exactly.
pub(crate) fn is_flat(triangle: Triangle) -> bool {
    (0..3).all(|axis| turn_across(triangle, axis) == 0)
}

/// The turn of three points seen along an axis.
fn turn_across(triangle: Triangle, axis: usize) -> i8 {
    let [a, b, c] = triangle.map(|p| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] });
    sign(orient2d(a, b, c))
}

/// How two triangles meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meeting {
    /// Not at all, or at common corners only, or so that one touches the other.
    Touching,
    /// An edge of one goes through the inside of the other.
    Crossing,
    /// They lie in one plane and have an area in common.
    Overlapping,
}

/// How two triangles meet, exactly; the first `shared` corners of both are common points (0, 1 or 2).
pub(crate) fn meeting(a: Triangle, b: Triangle, shared: usize) -> Meeting {
    let sides = (b.map(|p| side_of(a, p)), a.map(|p| side_of(b, p)));
    let apart = |s: [i8; 3]| s == [1; 3] || s == [-1; 3];
    match () {
        () if apart(sides.0) || apart(sides.1) => Meeting::Touching,
        () if sides.0 == [0; 3] && overlap_in_plane(a, b) => Meeting::Overlapping,
        () if shared < 2 && (pierces(a, b, shared) || pierces(b, a, shared)) => Meeting::Crossing,
        () => Meeting::Touching,
    }
}

/// True if an edge of `a` that ends in no common corner goes through the inside of `b`.
fn pierces(a: Triangle, b: Triangle, shared: usize) -> bool {
    let edges = (0..3).map(|k| (k, (k + 1) % 3)).filter(|&(p, q)| p >= shared && q >= shared);
    edges.into_iter().any(|(p, q)| goes_through(a[p], a[q], b))
}

fn goes_through(p: Vec3, q: Vec3, triangle: Triangle) -> bool {
    let (from, to) = (side_of(triangle, p), side_of(triangle, q));
    if from * to >= 0 {
        return false;
    }
    let [a, b, c] = triangle;
    let turn = side_of([p, q, a], b);
    turn != 0 && turn == side_of([p, q, b], c) && turn == side_of([p, q, c], a)
}

/// True if two triangles of one plane have an area in common: no edge of one separates them.
fn overlap_in_plane(a: Triangle, b: Triangle) -> bool {
    let Some(axis) = (0..3).find(|&axis| turn_across(a, axis) != 0) else {
        return false;
    };
    turn_across(b, axis) != 0 && !separates(a, b, axis) && !separates(b, a, axis)
}

/// True if all of `b` is on the outer side of an edge of `a`, or on it.
fn separates(a: Triangle, b: Triangle, axis: usize) -> bool {
    let inner = turn_across(a, axis);
    (0..3).any(|k| b.iter().all(|&p| inner * turn_across([a[k], a[(k + 1) % 3], p], axis) <= 0))
}
