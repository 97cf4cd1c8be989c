//! Triangulation of polygons in space by ear clipping.

use rayweave_math::{UNIT_ROUNDOFF, Vec3};

/// The maximal number of corners for ear clipping, which takes at least quadratic time. Larger polygons become fans.
const MAX_CORNERS: usize = 1000;

/// Triangulates a polygon; also returns whether it is plane, within rounding to single precision.
///
/// A polygon without ears, such as one that intersects itself, becomes a fan around its first corner: this has the same boundary
/// and, by the even-odd rule, the same interior.
pub fn triangulate_polygon(vertices: &[Vec3], corners: &[u32]) -> (Vec<[u32; 3]>, bool) {
    let area = area_vector(vertices, corners);
    let normal = area.normalize_or_zero();
    let size = area.length().sqrt();
    let first = vertices[corners[0] as usize];
    let is_near = |&v: &u32| {
        let point = vertices[v as usize];
        normal.dot(point - first).abs() <= 1e-5 * size + 16.0 * UNIT_ROUNDOFF * point.length()
    };
    let clipped = if corners.len() > MAX_CORNERS { None } else { clip_ears(vertices, corners, normal) };
    (clipped.unwrap_or_else(|| fan(corners)), corners.iter().all(is_near))
}

/// The vector along the normal of a polygon with twice the polygon's area as length (M. E. Newell).
pub fn area_vector(vertices: &[Vec3], corners: &[u32]) -> Vec3 {
    let point = |k: usize| vertices[corners[k % corners.len()] as usize] - vertices[corners[0] as usize];
    (0..corners.len()).map(|k| point(k).cross(point(k + 1))).sum()
}

fn fan(corners: &[u32]) -> Vec<[u32; 3]> {
    corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]).collect()
}

/// Ear clipping of a polygon without holes, projected along `normal` (G. H. Meisters, "Polygons have ears", 1975). `None` if a
/// remaining polygon has no ear.
pub fn clip_ears(vertices: &[Vec3], corners: &[u32], normal: Vec3) -> Option<Vec<[u32; 3]>> {
    let mut left = corners.to_vec();
    let mut triangles = Vec::with_capacity(corners.len());
    while left.len() > 3 {
        let ear = (0..left.len()).find(|&k| is_ear(vertices, &left, k, normal))?;
        triangles.push(neighbours(&left, ear));
        left.remove(ear);
    }
    let last = neighbours(&left, 1);
    triangles.push(last);
    (orientation(vertices, last, normal) > 0.0).then_some(triangles)
}

/// A corner with its predecessor and successor.
fn neighbours(corners: &[u32], k: usize) -> [u32; 3] {
    let count = corners.len();
    [corners[(k + count - 1) % count], corners[k], corners[(k + 1) % count]]
}

/// True if the triangle at a corner is counter-clockwise and contains no other corner of the polygon.
fn is_ear(vertices: &[Vec3], corners: &[u32], k: usize, normal: Vec3) -> bool {
    let [a, b, c] = neighbours(corners, k);
    let is_left = |triangle: [u32; 3]| orientation(vertices, triangle, normal) >= 0.0;
    let contains = |&p: &u32| [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(is_left);
    let mut others = corners.iter().filter(|vertex| ![a, b, c].contains(vertex));
    orientation(vertices, [a, b, c], normal) > 0.0 && !others.any(contains)
}

fn orientation(vertices: &[Vec3], triangle: [u32; 3], normal: Vec3) -> f64 {
    crate::triangle::cross(triangle.map(|vertex| vertices[vertex as usize])).dot(normal)
}
