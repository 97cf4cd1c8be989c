//! Films: two faces of a mesh in one plane within rounding errors, one on the other. They are walls and slits without thickness.

use rayweave_bvh::Bvh;
use rayweave_math::{Bounds, Vec3};
use rayweave_mesh::{Findings, Intersection, Mesh};

/// Faces closer than this part of the largest coordinate are at one place: no format with coordinates in single precision, and no
/// program that prints the part, tells them apart.
const DISTANCE: f64 = 1e-10;

/// The part of a triangle that is left out along its edges, where neighbours may overlap within rounding.
const EDGE: f64 = 1e-3;

/// Triangles with a height below this multiple of the distance are not compared: rounding errors reach beyond [`EDGE`].
const LEAST_HEIGHT: f64 = 1e4;

/// The largest sine of the angle between the planes of two triangles that are compared.
const MOST_TILTED: f64 = 1e-5;

/// The number of pairs of triangles with overlapping boxes that are examined for each triangle, and for the whole mesh. A diagnosis
/// compares as many.
const PAIRS: [usize; 2] = [64, 2_000_000];

type Triangle = [Vec3; 3];

/// A triangle that is compared.
struct Face {
    number: u32,
    corners: Triangle,
    /// The unit normal.
    normal: Vec3,
    area: f64,
}

/// The pairs of triangles whose interiors overlap in one plane, within rounding errors.
pub(super) fn films(mesh: &Mesh) -> Findings<Intersection> {
    let bounds = mesh.bounds();
    let distance = DISTANCE * bounds.lo.abs().max(bounds.hi.abs()).max_element();
    let faces: Vec<Face> = (0..mesh.triangles().len()).filter_map(|k| face(mesh, k, distance)).collect();
    let boxes: Vec<Bounds> = faces.iter().map(|face| bounds_of(&face.corners)).collect();
    let (tree, order) = Bvh::<4>::of_clusters(&boxes);
    let mut left = PAIRS[0] * faces.len() + PAIRS[1];
    let mut found = Vec::new();
    for (number, face) in faces.iter().enumerate() {
        let (mut seen, mut others) = (0, Vec::new());
        tree.overlapping(&boxes[number], distance, |range| {
            seen += range.len();
            others.extend(order[range].iter().map(|&k| k as usize).filter(|&k| k > number));
        });
        if seen > left {
            break;
        }
        left -= seen;
        others.sort_unstable();
        let others = others.into_iter().filter(|&other| is_film(face, &faces[other], distance));
        found.extend(others.map(|other| Intersection {
            triangles: [face.number, faces[other].number],
            at: boxes[number].grown(distance).intersection(&boxes[other].grown(distance)).centre(),
        }));
    }
    found.into_iter().collect()
}

fn bounds_of([a, b, c]: &Triangle) -> Bounds {
    Bounds { lo: a.min(*b).min(*c), hi: a.max(*b).max(*c) }
}

fn face(mesh: &Mesh, number: usize, distance: f64) -> Option<Face> {
    let corners = mesh.triangles()[number].map(|corner| mesh.vertices()[corner as usize]);
    let [a, b, c] = corners;
    let cross = (b - a).cross(c - a);
    let (area, longest) = (cross.length(), (b - a).length().max((c - b).length()).max((a - c).length()));
    let is_wide = area > LEAST_HEIGHT * distance * longest;
    is_wide.then(|| Face { number: number as u32, corners, normal: cross / area, area })
}

fn is_film(a: &Face, b: &Face, distance: f64) -> bool {
    let (large, small) = if a.area < b.area { (b, a) } else { (a, b) };
    let height = |corner: &Vec3| (*corner - large.corners[0]).dot(large.normal).abs();
    a.normal.cross(b.normal).length() < MOST_TILTED
        && small.corners.iter().all(|corner| height(corner) <= distance)
        && !is_separated(&large.corners, &small.corners, large.normal)
        && !is_separated(&small.corners, &large.corners, large.normal)
}

/// True if an edge of the first triangle, moved inwards, has all of the second one on its outer side. Both are in a plane with this normal.
fn is_separated(first: &Triangle, second: &Triangle, normal: Vec3) -> bool {
    (0..3).any(|k| {
        let [from, to, opposite] = [0, 1, 2].map(|j| first[(k + j) % 3]);
        let inwards = (to - from).cross(normal);
        let inwards = if inwards.dot(opposite - from) < 0.0 { -inwards } else { inwards };
        let depth = |p: &Vec3| (*p - from).dot(inwards);
        second.iter().all(|p| depth(p) <= EDGE * depth(&opposite))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_math::Affine;

    /// Two cubes of side 10, one on the other with a slit between them.
    fn cubes(slit: f64, beside: Vec3, place: &Affine) -> Mesh {
        let cube = |lo: Vec3| {
            (0..8).map(move |k| lo + 10.0 * Vec3::new((k & 1).into(), (k >> 1 & 1).into(), (k >> 2).into()))
        };
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5_u32]];
        let triangles = |first: u32| {
            sides
                .iter()
                .flat_map(move |[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
                .map(move |t| t.map(|k| k + first))
        };
        let points = cube(Vec3::ZERO).chain(cube(Vec3::new(0.0, 0.0, 10.0 + slit) + beside));
        Mesh::new(points.map(|p| place.point(p)).collect(), triangles(0).chain(triangles(8)).collect())
            .unwrap()
    }

    #[test]
    fn slits_of_rounding_errors_are_found() {
        let tilted = Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 40.0)
            .then(&Affine::translate(Vec3::new(5.0, -7.0, 1.0)));
        for place in [Affine::IDENTITY, tilted] {
            let count = |slit: f64, beside: Vec3| films(&cubes(slit, beside, &place)).count;
            for slit in [0.0, 4e-14, -4e-14] {
                assert!(count(slit, Vec3::ZERO) >= 2, "{slit}");
                assert!(count(slit, Vec3::new(3.0, 8.0, 0.0)) >= 1, "{slit}");
                // edge by edge
                assert_eq!(count(slit, Vec3::new(10.0, 0.0, 0.0)), 0, "{slit}");
            }
            assert_eq!(count(1e-6, Vec3::ZERO), 0);
            assert_eq!(count(5.0, Vec3::ZERO), 0);
        }
    }
}
