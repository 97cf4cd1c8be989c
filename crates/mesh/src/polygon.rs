//! Polygons in space, cut into triangles.

use rayweave_math::{UNIT_ROUNDOFF, Vec3};

/// Above so many corners a polygon is cut into a fan: cutting off ears takes the square of them at least.
const MOST_CORNERS: usize = 1000;

/// Triangles of a face, and whether it is plane, within rounding to single precision.
///
/// Where no ears are found, in a face that crosses itself say, they fan out from the first corner: the same boundary, and by
/// parity the same area.
pub fn triangles(vertices: &[Vec3], corners: &[u32]) -> (Vec<[u32; 3]>, bool) {
    let across = area_vector(vertices, corners);
    let normal = across.normalize_or_zero();
    let size = across.length().sqrt();
    let first = vertices[corners[0] as usize];
    let is_near = |&v: &u32| {
        let point = vertices[v as usize];
        normal.dot(point - first).abs() <= 1e-5 * size + 16.0 * UNIT_ROUNDOFF * point.length()
    };
    let cut = if corners.len() > MOST_CORNERS { None } else { ears(vertices, corners, normal) };
    (cut.unwrap_or_else(|| fan(corners)), corners.iter().all(is_near))
}

/// Twice the area of a polygon along its normal (M. E. Newell).
pub fn area_vector(vertices: &[Vec3], corners: &[u32]) -> Vec3 {
    let point = |k: usize| vertices[corners[k % corners.len()] as usize] - vertices[corners[0] as usize];
    (0..corners.len()).map(|k| point(k).cross(point(k + 1))).sum()
}

fn fan(corners: &[u32]) -> Vec<[u32; 3]> {
    corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]).collect()
}

/// The triangles of a polygon without holes, seen against `normal`: ear by ear (G. H. Meisters, "Polygons have ears", 1975).
/// `None` if at some time there is none.
pub fn ears(vertices: &[Vec3], corners: &[u32], normal: Vec3) -> Option<Vec<[u32; 3]>> {
    let mut left = corners.to_vec();
    let mut triangles = Vec::with_capacity(corners.len());
    while left.len() > 3 {
        let ear = (0..left.len()).find(|&k| is_ear(vertices, &left, k, normal))?;
        triangles.push(around(&left, ear));
        left.remove(ear);
    }
    let last = around(&left, 1);
    triangles.push(last);
    (turn(vertices, last, normal) > 0.0).then_some(triangles)
}

/// A corner with those before and after it.
fn around(corners: &[u32], k: usize) -> [u32; 3] {
    let count = corners.len();
    [corners[(k + count - 1) % count], corners[k], corners[(k + 1) % count]]
}

/// True if the triangle at a corner is within the polygon and holds none of its other corners.
fn is_ear(vertices: &[Vec3], corners: &[u32], k: usize, normal: Vec3) -> bool {
    let [a, b, c] = around(corners, k);
    let is_left = |triangle: [u32; 3]| turn(vertices, triangle, normal) >= 0.0;
    let holds = |&p: &u32| [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(is_left);
    let mut others = corners.iter().filter(|vertex| ![a, b, c].contains(vertex));
    turn(vertices, [a, b, c], normal) > 0.0 && !others.any(holds)
}

fn turn(vertices: &[Vec3], triangle: [u32; 3], normal: Vec3) -> f64 {
    crate::triangle::cross(triangle.map(|vertex| vertices[vertex as usize])).dot(normal)
}
