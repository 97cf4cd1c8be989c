//! Convex hull of points in space.
//!
//! *Source*: C. B. Barber, D. P. Dobkin, H. Huhdanpaa, "The Quickhull algorithm for convex hulls", ACM Trans. Math. Softw.
//! 22 (1996). The orientation test is exact (Shewchuk 1997, crate `robust`), so that coplanar and collinear points are
//! handled correctly.

use super::arguments::{Arguments, Refusal};
use rayweave_math::Vec3;
use std::collections::HashMap;

/// The cost of an orientation test, in steps.
const TEST: usize = 25;

/// Signed height of `p` above the plane of a triangle that is counter-clockwise seen from above; the sign is exact.
fn height(points: &[Vec3], [a, b, c]: [usize; 3], p: usize) -> f64 {
    let at = |k: usize| robust::Coord3D { x: points[k].x, y: points[k].y, z: points[k].z };
    -robust::orient3d(at(a), at(b), at(c), at(p))
}

/// A triangle of a hull under construction.
struct Face {
    corners: [usize; 3],
    /// Neighbours across the edges from each corner to the next.
    next: [usize; 3],
    /// Points above the face (each point is assigned to one face only), and the highest of them.
    above: Vec<usize>,
    highest: (f64, usize),
    is_kept: bool,
}

impl Face {
    fn new(corners: [usize; 3]) -> Face {
        Face { corners, next: [0; 3], above: Vec::new(), highest: (0.0, 0), is_kept: true }
    }

    fn take(&mut self, height: f64, p: usize) {
        if height > self.highest.0 {
            self.highest = (height, p);
        }
        self.above.push(p);
    }
}

/// Triangles of the convex hull, counter-clockwise seen from outside; `None` if all points lie in a plane.
///
/// # Errors
///
/// The number of orientation tests, on the order of n log n except for unusual points, exceeds the budget.
pub(super) fn convex_hull(
    arguments: &Arguments,
    points: &[Vec3],
) -> Result<Option<Vec<[usize; 3]>>, Refusal> {
    arguments.spend(10 * TEST * points.len())?;
    let Some(first) = first_faces(points) else { return Ok(None) };
    let mut faces: Vec<Face> = first.into_iter().map(Face::new).collect();
    for (k, next) in [[3, 2, 1], [0, 2, 3], [0, 3, 1], [0, 1, 2]].into_iter().enumerate() {
        // verified by the edges that the faces share
        let [a, b, c] = faces[k].corners;
        let across = |p: usize, q: usize| {
            next.into_iter().find(|n| edges(faces[*n].corners).contains(&(q, p))).unwrap_or(k)
        };
        faces[k].next = [across(a, b), across(b, c), across(c, a)];
    }
    give(arguments, points, &mut faces, &[0, 1, 2, 3], 0..points.len())?;
    let mut waiting: Vec<usize> = (0..4).collect();
    while let Some(from) = waiting.pop() {
        if !faces[from].is_kept || faces[from].above.is_empty() {
            continue;
        }
        let p = faces[from].highest.1;
        let (seen, horizon) = seen_from(arguments, points, &mut faces, from, p)?;
        // a fan of new faces from the horizon to the point
        let start = faces.len();
        let mut at: HashMap<usize, usize> = HashMap::new();
        for (k, &(a, b, beyond)) in horizon.iter().enumerate() {
            let mut face = Face::new([a, b, p]);
            face.next[0] = beyond;
            at.insert(a, start + k);
            let side = edges(faces[beyond].corners).iter().position(|edge| *edge == (b, a)).unwrap_or(0);
            faces[beyond].next[side] = start + k;
            faces.push(face);
        }
        for k in start..faces.len() {
            let [_, b, _] = faces[k].corners;
            let after = at.get(&b).copied().unwrap_or(k);
            faces[k].next[1] = after;
            faces[after].next[2] = k;
        }
        let new: Vec<usize> = (start..faces.len()).collect();
        let orphans: Vec<usize> =
            seen.iter().flat_map(|k| std::mem::take(&mut faces[*k].above)).filter(|q| *q != p).collect();
        give(arguments, points, &mut faces, &new, orphans.into_iter())?;
        waiting.extend(new);
    }
    Ok(Some(faces.into_iter().filter(|face| face.is_kept).map(|face| face.corners).collect()))
}

/// Gives each point to one of the faces that it is above; points within the hull are dropped.
fn give(
    arguments: &Arguments,
    points: &[Vec3],
    faces: &mut [Face],
    among: &[usize],
    given: impl Iterator<Item = usize>,
) -> Result<(), Refusal> {
    for p in given {
        let mut tests = 0;
        for &k in among {
            tests += 1;
            let height = height(points, faces[k].corners, p);
            if height > 0.0 {
                faces[k].take(height, p);
                break;
            }
        }
        arguments.spend(TEST * tests)?;
    }
    Ok(())
}

/// Removes the faces visible from a point, and returns them and their boundary: edges, each with the face beyond.
#[expect(clippy::type_complexity, reason = "two lists that belong together")]
fn seen_from(
    arguments: &Arguments,
    points: &[Vec3],
    faces: &mut [Face],
    from: usize,
    p: usize,
) -> Result<(Vec<usize>, Vec<(usize, usize, usize)>), Refusal> {
    faces[from].is_kept = false;
    let (mut seen, mut horizon, mut done) = (vec![from], Vec::new(), 0);
    while let Some(&k) = seen.get(done) {
        done += 1;
        let (next, sides) = (faces[k].next, edges(faces[k].corners));
        for (beyond, (a, b)) in next.into_iter().zip(sides) {
            if !faces[beyond].is_kept {
                continue;
            }
            if height(points, faces[beyond].corners, p) > 0.0 {
                faces[beyond].is_kept = false;
                seen.push(beyond);
            } else {
                horizon.push((a, b, beyond));
            }
        }
    }
    arguments.spend(10 * TEST * done)?;
    Ok((seen, horizon))
}

fn edges([a, b, c]: [usize; 3]) -> [(usize, usize); 3] {
    [(a, b), (b, c), (c, a)]
}

/// An initial tetrahedron of four of the points, chosen large.
fn first_faces(points: &[Vec3]) -> Option<Vec<[usize; 3]>> {
    let farthest = |measure: &dyn Fn(Vec3) -> f64| {
        (0..points.len()).max_by(|a, b| measure(points[*a]).total_cmp(&measure(points[*b])))
    };
    let a = farthest(&|p| -p.x)?;
    let b = farthest(&|p| (p - points[a]).length_squared())?;
    let along = points[b] - points[a];
    let c = farthest(&|p| along.cross(p - points[a]).length_squared())?;
    let normal = along.cross(points[c] - points[a]);
    let by_far = farthest(&|p| normal.dot(p - points[a]).abs())?;
    // the rounded measure may be 0 even for points outside the plane
    let mut candidates = std::iter::once(by_far).chain(0..points.len());
    let d = candidates.find(|d| height(points, [a, b, c], *d) != 0.0)?;
    let [b, c] = if height(points, [a, b, c], d) > 0.0 { [c, b] } else { [b, c] };
    Some(vec![[a, b, c], [a, d, b], [b, d, c], [c, d, a]])
}

/// Planes (a, b, c, d) of triangles, with unit normals; nearly equal planes are merged into one that cuts nothing off.
pub(super) fn planes(points: &[Vec3], faces: &[[usize; 3]]) -> Vec<[f64; 4]> {
    let size = points.iter().fold(0f64, |size, p| size.max(p.abs().max_element()));
    let mut planes: Vec<[f64; 4]> = Vec::new();
    let mut known: HashMap<[i64; 4], usize> = HashMap::new();
    for face in faces {
        let [a, b, c] = face.map(|k| points[k]);
        let Some(n) = (b - a).cross(c - a).try_normalize() else { continue };
        let d = n.dot(a).max(n.dot(b)).max(n.dot(c));
        let key = [n.x, n.y, n.z, d / size.max(f64::MIN_POSITIVE)].map(|x| (x * 1e8).round() as i64);
        let next = planes.len();
        let place = *known.entry(key).or_insert(next);
        match planes.get_mut(place) {
            Some(plane) => plane[3] = plane[3].max(d),
            None => planes.push([n.x, n.y, n.z, d]),
        }
    }
    planes
}

/// Volume enclosed by triangles.
pub(super) fn volume(points: &[Vec3], faces: &[[usize; 3]]) -> f64 {
    let Some(origin) = faces.first().map(|face| points[face[0]]) else {
        return 0.0;
    };
    let six = |face: &[usize; 3]| {
        let [a, b, c] = face.map(|k| points[k] - origin);
        a.cross(b).dot(c)
    };
    faces.iter().map(six).sum::<f64>() / 6.0
}

#[cfg(test)]
mod tests {
    use super::super::budget::Budget;
    use super::super::syntax::parse;
    use super::*;
    use rayweave_scene::Source;
    use std::sync::Arc;

    /// The hull, and whether it is within the budget of a small file.
    fn convex_hull(points: &[Vec3]) -> Option<Vec<[usize; 3]>> {
        let source = Arc::new(Source::new(None, "group();".to_owned()));
        let tree = parse(&source).expect("a dump");
        let budget = Budget::new(0);
        super::convex_hull(&Arguments::new(&source, &tree.nodes[0], &budget), points)
            .expect("within the budget")
    }

    /// The corners of a lattice on a sphere: 100 000 points take few steps, and each is a vertex.
    #[test]
    fn many_points_take_little_work() {
        let n = 100_000;
        let point = |k: usize| {
            let z = 1.0 - (2 * k + 1) as f64 / n as f64;
            let (sin, cos) = libm::sincos(2.399_963_229_728_653 * k as f64);
            Vec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
        };
        let points: Vec<Vec3> = (0..n).map(point).collect();
        assert_eq!(convex_hull(&points).map(|faces| faces.len()), Some(2 * n - 4));
    }

    /// A cube with extra points on its edges, on its faces and inside.
    #[test]
    fn a_grid_of_points_is_a_cube() {
        let points: Vec<Vec3> =
            (0..125).map(|k| Vec3::new(f64::from(k % 5), f64::from(k / 5 % 5), f64::from(k / 25))).collect();
        let faces = convex_hull(&points).expect("it is solid");
        assert_eq!(volume(&points, &faces), 64.0);
        let mut planes = planes(&points, &faces);
        planes.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        let expected = [
            [-1.0, 0.0, 0.0, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0, 4.0],
            [0.0, 1.0, 0.0, 4.0],
            [1.0, 0.0, 0.0, 4.0],
        ];
        assert_eq!(planes, expected);
    }

    #[test]
    fn points_of_a_plane_have_none() {
        let flat: Vec<Vec3> =
            (0..30).map(|k| Vec3::new(f64::from(k % 6), f64::from(k / 6), f64::from(k % 6))).collect();
        assert_eq!(convex_hull(&flat), None);
        assert_eq!(convex_hull(&flat[..1]), None);
        assert_eq!(convex_hull(&[]), None);
    }

    /// Every point is behind every plane, and the volume converges to that of the ball.
    #[test]
    fn points_of_a_sphere() {
        let golden = 2.399_963_229_728_653;
        let n = 600;
        let point = |k: usize| {
            let z = 1.0 - (2 * k + 1) as f64 / n as f64;
            let (r, angle) = ((1.0 - z * z).sqrt(), golden * k as f64);
            Vec3::new(r * libm::cos(angle), r * libm::sin(angle), z)
        };
        let points: Vec<Vec3> = (0..n).map(point).collect();
        let faces = convex_hull(&points).expect("it is solid");
        assert_eq!(faces.len(), 2 * n - 4);
        for [a, b, c, d] in planes(&points, &faces) {
            assert!(points.iter().all(|p| Vec3::new(a, b, c).dot(*p) <= d + 1e-12));
        }
        let ball = 4.0 / 3.0 * std::f64::consts::PI;
        let found = volume(&points, &faces);
        assert!(found < ball && found > 0.98 * ball, "{found}");
    }
}
