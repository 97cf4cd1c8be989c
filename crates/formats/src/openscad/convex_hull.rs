//! Convex hull of points in space.
//!
//! *Source*: the incremental ("beneath-beyond") construction, M. de Berg et al., *Computational Geometry*, chapter 11. The
//! orientation test is exact (Shewchuk 1997, crate `robust`), so that coplanar and collinear points are handled correctly.

use rayweave_math::Vec3;
use std::collections::{HashMap, HashSet};

/// Most points of a hull; more take too long.
pub(super) const MOST_POINTS: usize = 20_000;

/// Signed height of `p` above the plane of a triangle that is counter-clockwise seen from above; the sign is exact.
fn height(points: &[Vec3], [a, b, c]: [usize; 3], p: usize) -> f64 {
    let at = |k: usize| robust::Coord3D { x: points[k].x, y: points[k].y, z: points[k].z };
    -robust::orient3d(at(a), at(b), at(c), at(p))
}

/// Triangles of the convex hull, counter-clockwise seen from outside; `None` if all points lie in a plane.
pub(super) fn convex_hull(points: &[Vec3]) -> Option<Vec<[usize; 3]>> {
    let mut faces = first_faces(points)?;
    for p in 0..points.len() {
        let (seen, unseen): (Vec<_>, Vec<_>) = faces.iter().partition(|face| height(points, **face, p) > 0.0);
        if seen.is_empty() {
            continue;
        }
        let edges: HashSet<(usize, usize)> = seen.iter().flat_map(|face| edges(*face)).collect();
        faces = unseen;
        // horizon: the boundary edges of the visible faces
        let mut horizon: Vec<_> = edges.iter().filter(|(a, b)| !edges.contains(&(*b, *a))).copied().collect();
        horizon.sort_unstable();
        faces.extend(horizon.into_iter().map(|(a, b)| [a, b, p]));
    }
    Some(faces)
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
    // the rounded measure may be 0 for points outside the plane
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
    use super::*;

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
