//! Triangle geometry: normal, closest point, exact orientation predicates and triangle-triangle intersection.

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

/// The normal by the right-hand rule, with twice the area as length.
pub(crate) fn cross([a, b, c]: Triangle) -> Vec3 {
    (b - a).cross(c - a)
}

/// The unit normal; NaN if the triangle is degenerate.
pub(crate) fn normal(triangle: Triangle) -> Vec3 {
    let cross = cross(triangle);
    // squares of areas may overflow
    let cross = cross / cross.abs().max_element();
    cross / cross.length()
}

/// The point of a triangle closest to `p`, within a few roundings of the lengths involved for triangles of any aspect ratio:
/// the coordinate along the longest edge and the one across it are computed separately, so that their errors do not mix.
pub(crate) fn closest_point(triangle: Triangle, p: Vec3) -> Vec3 {
    let [a, b, c] = from_longest_edge(triangle);
    let (edge, to_c) = (b - a, c - a);
    let per_length = 1.0 / edge.length_squared();
    let along = |v: Vec3| v.dot(edge) * per_length;
    let foot = along(to_c);
    let across = to_c - foot * edge;
    // a second projection removes the rounding along the edge, which would tilt a short height
    let across = across - along(across) * edge;
    let s = along(p - a);
    let height = (p - a - s * edge).dot(across) / across.length_squared();
    let (at_a, at_b) = (1.0 - s - height * (1.0 - foot), s - height * foot);
    // all false (NaN) for a degenerate triangle
    if height >= 0.0 && at_a >= 0.0 && at_b >= 0.0 {
        return a + s * edge + height * across;
    }
    let on_edges = [[a, b], [b, c], [c, a]].map(|edge| closest_on_edge(edge, p));
    let nearer = |one: Vec3, other: Vec3| {
        if (other - p).length_squared() < (one - p).length_squared() { other } else { one }
    };
    on_edges.into_iter().fold(on_edges[0], nearer)
}

/// The corners in the same cyclic order, with the longest edge first.
fn from_longest_edge([a, b, c]: Triangle) -> Triangle {
    let [ab, bc, ca] = [b - a, c - b, a - c].map(|edge| edge.length_squared());
    match () {
        () if ab >= bc && ab >= ca => [a, b, c],
        () if bc >= ca => [b, c, a],
        () => [c, a, b],
    }
}

fn closest_on_edge([a, b]: [Vec3; 2], p: Vec3) -> Vec3 {
    let edge = b - a;
    let part = (p - a).dot(edge) / edge.length_squared();
    match () {
        () if part >= 1.0 => b,
        () if part > 0.0 => a + part * edge,
        () => a,
    }
}

/// The side of a triangle's plane on which a point lies, exactly: 1 on the side of the normal, -1 behind, 0 in the plane.
pub(crate) fn side_of(triangle: Triangle, p: Vec3) -> i8 {
    // the exact arithmetic takes long for points in one plane, most of which are perpendicular to an axis
    if (0..3).any(|axis| triangle.iter().all(|corner| corner[axis] == p[axis])) {
        return 0;
    }
    let [a, b, c] = triangle.map(coord3);
    // `robust` has the opposite sign convention
    sign(-orient3d(a, b, c, coord3(p)))
}

fn coord3(p: Vec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// True if the corners are collinear, exactly.
pub(crate) fn is_flat(triangle: Triangle) -> bool {
    (0..3).all(|axis| orientation_along(triangle, axis) == 0)
}

/// The orientation of three points projected along a coordinate axis, exactly.
fn orientation_along(triangle: Triangle, axis: usize) -> i8 {
    let [a, b, c] = triangle.map(|p| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] });
    sign(orient2d(a, b, c))
}

/// The intersection of two triangles, classified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meeting {
    /// None, or common corners only, or a contact without crossing.
    Touching,
    /// Their interiors cross, or an edge of one crosses the interior of the other.
    Crossing,
    /// They are coplanar and their interiors overlap.
    Overlapping,
}

/// Classifies the intersection of two triangles, exactly. The first `shared` corners of both are common
/// points (0, 1 or 2).
pub(crate) fn meeting(a: Triangle, b: Triangle, shared: usize) -> Meeting {
    let sides = (b.map(|p| side_of(a, p)), a.map(|p| side_of(b, p)));
    let apart = |s: [i8; 3]| s == [1; 3] || s == [-1; 3];
    match () {
        () if apart(sides.0) || apart(sides.1) => Meeting::Touching,
        () if sides.0 == [0; 3] && overlap_in_plane(a, b) => Meeting::Overlapping,
        () if shared < 2 && (pierces(a, b, shared) || pierces(b, a, shared)) => Meeting::Crossing,
        () if shared < 2 && interiors_cross((a, sides.1), (b, sides.0)) => Meeting::Crossing,
        () => Meeting::Touching,
    }
}

/// True if two triangles have a common point besides their first `shared` corners, which are equal, and the edge between them,
/// exactly. Coplanar triangles count only where their interiors overlap, and a triangle without area counts always.
///
/// Two surfaces of triangles whose edges all have two triangles cross each other only where this is true: a curve on both of
/// them lies in two triangles, of which one has an edge there if they are not coplanar.
pub(crate) fn is_in_contact(a: Triangle, b: Triangle, shared: usize) -> bool {
    let sides = (b.map(|p| side_of(a, p)), a.map(|p| side_of(b, p)));
    let apart = |s: [i8; 3]| s == [1; 3] || s == [-1; 3];
    match () {
        () if is_flat(a) || is_flat(b) => true,
        () if apart(sides.0) || apart(sides.1) => false,
        () if sides.0 == [0; 3] => overlap_in_plane(a, b),
        () if shared >= 2 => false,
        () => is_touched(a, b, sides.1, shared) || is_touched(b, a, sides.0, shared),
    }
}

/// True if an edge of `a` has a point in `b` other than the common corner. `sides` are the sides of the corners of `a`.
fn is_touched(a: Triangle, b: Triangle, sides: [i8; 3], shared: usize) -> bool {
    let edges = [(0, 1), (0, 2), (1, 2)];
    edges.into_iter().any(|(p, q)| match (sides[p], sides[q]) {
        (0, 0) => match (shared, p) {
            (1, 0) => is_into_corner(a[q], b),
            _ => meets_in_plane(a[p], a[q], b),
        },
        // off the plane except for the common corner
        _ if shared == 1 && p == 0 => false,
        (from, to) => {
            let line = [(0, 1), (1, 2), (2, 0)].map(|(k, l)| side_of([a[p], a[q], b[k]], b[l]));
            from * to <= 0 && !(line.contains(&1) && line.contains(&-1))
        }
    })
}

/// True if the segment from the first corner of a triangle to a point of its plane leads into the triangle or along its edges.
fn is_into_corner(q: Vec3, b: Triangle) -> bool {
    let axis = (0..3).find(|&axis| orientation_along(b, axis) != 0).unwrap_or(0);
    let inner = orientation_along(b, axis);
    inner * orientation_along([b[0], b[1], q], axis) >= 0
        && inner * orientation_along([b[0], q, b[2]], axis) >= 0
}

/// True if a segment in the plane of a triangle has a point in it.
fn meets_in_plane(p: Vec3, q: Vec3, b: Triangle) -> bool {
    let axis = (0..3).find(|&axis| orientation_along(b, axis) != 0).unwrap_or(0);
    let inner = orientation_along(b, axis);
    let is_beyond =
        |k: usize| [p, q].iter().all(|&end| inner * orientation_along([b[k], b[(k + 1) % 3], end], axis) < 0);
    let beside = b.map(|corner| orientation_along([p, q, corner], axis));
    !(0..3).any(is_beyond) && beside != [1; 3] && beside != [-1; 3]
}

/// True if an edge of `a` without common corners crosses the interior of `b`.
fn pierces(a: Triangle, b: Triangle, shared: usize) -> bool {
    let edges = (0..3).map(|k| (k, (k + 1) % 3)).filter(|&(p, q)| p >= shared && q >= shared);
    edges.into_iter().any(|(p, q)| crosses_interior(a[p], a[q], b))
}

/// True if the interiors of two triangles have a common segment, also if only edges end it: then no edge crosses an interior. The
/// sides of the corners of each with respect to the plane of the other are given.
///
/// Each triangle with corners on both sides of the other's plane has a segment in common with the line of the two planes: between
/// the points P1, P2 where the edges from the corner that is alone on its side cross the plane. The interiors cross where this segment
/// overlaps that of the other triangle, Q1, Q2: where some Q lies before some P, and some Q behind some P. The order of P and Q on the line
/// is the orientation of the two edges (Guigue and Devillers, Fast and Robust Triangle-Triangle Overlap Test Using Orientation Predicates,
/// 2003).
fn interiors_cross((a, sides_a): (Triangle, [i8; 3]), (b, sides_b): (Triangle, [i8; 3])) -> bool {
    let alone = |sides: [i8; 3]| {
        let is_alone = |&k: &usize| sides[k] != 0 && (1..3).all(|step| sides[(k + step) % 3] != sides[k]);
        (0..3).find(is_alone).filter(|&k| sides.contains(&-sides[k]))
    };
    let (Some(k), Some(l)) = (alone(sides_a), alone(sides_b)) else { return false };
    let orders =
        [(1, 1), (1, 2), (2, 1), (2, 2)].map(|(i, j)| side_of([a[k], a[(k + i) % 3], b[l]], b[(l + j) % 3]));
    orders.contains(&1) && orders.contains(&-1)
}

/// True if the segment from `p` to `q` crosses the interior of a triangle.
fn crosses_interior(p: Vec3, q: Vec3, triangle: Triangle) -> bool {
    let (from, to) = (side_of(triangle, p), side_of(triangle, q));
    if from * to >= 0 {
        return false;
    }
    let [a, b, c] = triangle;
    let side = side_of([p, q, a], b);
    side != 0 && side == side_of([p, q, b], c) && side == side_of([p, q, c], a)
}

/// True if two coplanar triangles have overlapping interiors: no edge separates them.
fn overlap_in_plane(a: Triangle, b: Triangle) -> bool {
    let Some(axis) = (0..3).find(|&axis| orientation_along(a, axis) != 0) else {
        return false;
    };
    orientation_along(b, axis) != 0 && !separates(a, b, axis) && !separates(b, a, axis)
}

/// True if an edge of `a` separates `b` from `a`: all of `b` is on its outer side or on it.
fn separates(a: Triangle, b: Triangle, axis: usize) -> bool {
    let inner = orientation_along(a, axis);
    (0..3).any(|k| b.iter().all(|&p| inner * orientation_along([a[k], a[(k + 1) % 3], p], axis) <= 0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
    use rayweave_math::{Affine, UNIT_ROUNDOFF};

    /// A triangle with a longest edge of length 1 and this height, rotated and translated.
    fn placed(height: f64, map: &Affine) -> Triangle {
        [Vec3::ZERO, Vec3::X, Vec3::new(0.3, height, 0.0)].map(|corner| map.point(corner))
    }

    fn random_map(rng: &mut ChaCha8Rng) -> Affine {
        let mut vector = || Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let (axis, by) = (vector(), vector());
        Affine::rotation(axis, rng.random_range(0.0..360.0)).then(&Affine::translate(by))
    }

    /// Constructed points on, above and beside a triangle have the expected distances, however thin it is.
    #[test]
    fn distances_from_needles_are_exact_to_rounding() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for height in (0..14).map(|k| 10_f64.powi(-k)) {
            for _ in 0..200 {
                let map = random_map(&mut rng);
                let triangle = placed(height, &map);
                let mut weights = [0.0; 3].map(|_: f64| rng.random_range(0.0..1.0));
                let sum: f64 = weights.iter().sum();
                weights = weights.map(|weight| weight / sum);
                let flat = weights[1] * Vec3::X + weights[2] * Vec3::new(0.3, height, 0.0);
                let above = rng.random_range(0.0..0.5);
                // rounding of the rotated corners may tilt the plane of a needle: test points above thick triangles only
                let above = if height > 0.1 { above } else { 0.0 };
                let beside = rng.random_range(0.0..0.5);
                let cases = [
                    (flat + above * Vec3::Z, above),
                    (Vec3::new(flat.x, -beside, 0.0), beside),
                    (Vec3::new(-beside, -0.1, 0.0), libm::hypot(beside, 0.1)),
                ];
                for (point, expected) in cases {
                    let point = map.point(point);
                    let found = (closest_point(triangle, point) - point).length();
                    assert!((found - expected).abs() < 16.0 * UNIT_ROUNDOFF, "{height} {found} {expected}");
                }
            }
        }
    }

    /// Triangles with corners on a small grid, so that corners and edges meet others exactly, against rational arithmetic: the interiors
    /// cross if a point of one segment of intersection lies inside both.
    #[test]
    fn crossings_on_a_grid_are_exact() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut found = [0; 2];
        for _ in 0..200_000 {
            let mut triangle = || {
                [0; 3].map(|_: i32| Vec3::from_array([0; 3].map(|_: i32| f64::from(rng.random_range(-2..3)))))
            };
            let (a, b) = (triangle(), triangle());
            let is_common = a.iter().any(|corner| b.contains(corner));
            if is_flat(a) || is_flat(b) || is_common {
                continue;
            }
            let crossing = meeting(a, b, 0) == Meeting::Crossing;
            assert_eq!(crossing, meeting(b, a, 0) == Meeting::Crossing, "{a:?} {b:?}");
            assert_eq!(crossing, cross_by_parameters(a, b), "{a:?} {b:?}");
            found[usize::from(crossing)] += 1;
        }
        assert!(found[1] > 1000, "{found:?}");
    }

    /// Whether the segments of two triangles on the line of their planes overlap: their ends along the line as fractions of integers.
    fn cross_by_parameters(a: Triangle, b: Triangle) -> bool {
        let whole = |v: Vec3| v.to_array().map(|x| x as i128);
        let minus = |p: [i128; 3], q: [i128; 3]| std::array::from_fn::<i128, 3, _>(|k| p[k] - q[k]);
        let dot = |p: [i128; 3], q: [i128; 3]| (0..3).map(|k| p[k] * q[k]).sum::<i128>();
        let cross = |p: [i128; 3], q: [i128; 3]| {
            std::array::from_fn::<i128, 3, _>(|k| {
                p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3]
            })
        };
        let (a, b) = (a.map(whole), b.map(whole));
        let normal = |t: [[i128; 3]; 3]| cross(minus(t[1], t[0]), minus(t[2], t[0]));
        let line = cross(normal(a), normal(b));
        // the ends of a triangle's segment in the plane of another, as numerators and positive denominators along the line
        let ends = |t: [[i128; 3]; 3], other: [[i128; 3]; 3]| {
            let n = normal(other);
            let height = t.map(|corner| dot(n, minus(corner, other[0])));
            let mut ends: Vec<(i128, i128)> = Vec::new();
            for (p, q) in [(0, 1), (1, 2), (2, 0)] {
                if height[p] * height[q] < 0 {
                    let (u, v) = (dot(line, t[p]), dot(line, t[q]));
                    let (below, above) = (height[q] - height[p], u * height[q] - v * height[p]);
                    ends.push(if below > 0 { (above, below) } else { (-above, -below) });
                }
            }
            // a corner in the plane ends the segment if the other two are on both sides
            for k in (0..3).filter(|&k| height[k] == 0 && height[(k + 1) % 3] * height[(k + 2) % 3] < 0) {
                ends.push((dot(line, t[k]), 1));
            }
            ends
        };
        let ends = [ends(a, b), ends(b, a)];
        let [[p, q], [r, s]] = match [&ends[0][..], &ends[1][..]] {
            [&[p, q], &[r, s]] => [[p, q], [r, s]],
            _ => return false,
        };
        let less = |x: (i128, i128), y: (i128, i128)| x.0 * y.1 < y.0 * x.1;
        let sorted = |x, y| if less(x, y) { [x, y] } else { [y, x] };
        let ([p, q], [r, s]) = (sorted(p, q), sorted(r, s));
        less(p, s) && less(r, q)
    }

    #[test]
    fn degenerate_triangles_have_closest_points() {
        let on_a_line = [Vec3::ZERO, Vec3::X, 0.5 * Vec3::X];
        assert_eq!(closest_point(on_a_line, Vec3::new(0.25, 1.0, 0.0)), 0.25 * Vec3::X);
        assert_eq!(closest_point(on_a_line, Vec3::new(3.0, 1.0, 0.0)), Vec3::X);
        assert_eq!(closest_point([Vec3::Y; 3], Vec3::X), Vec3::Y);
    }
}
