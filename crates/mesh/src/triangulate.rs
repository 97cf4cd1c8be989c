//! Triangulation of polygons in space by ear clipping.

use rayweave_math::{UNIT_ROUNDOFF, Vec3};

/// The number of corners up to which ears are clipped from the start of the polygon, which gives fans where it is convex. The ears
/// of larger polygons are clipped all around, so that triangles stay small.
const MAX_FAN: usize = 1000;

/// The work that the triangulation of the polygons of one file or mesh may take: ear clipping takes quadratic time, and cubic time for
/// polygons with few ears. Polygons that exceed it become fans.
#[derive(Clone, Copy, Debug)]
pub struct EarBudget {
    /// Number of corners that may still be compared with a triangle.
    left: u64,
}

impl EarBudget {
    /// Comparisons for every file: about half a second.
    const BASE: u64 = 50_000_000;
    /// Further comparisons for each corner: enough for any number of convex polygons with 128 corners.
    const PER_CORNER: u64 = 64;

    /// True if this many comparisons are left, which are then used up.
    fn take(&mut self, comparisons: usize) -> bool {
        let left = self.left.checked_sub(comparisons as u64);
        self.left = left.unwrap_or(0);
        left.is_some()
    }

    fn add_corners(&mut self, count: usize) {
        self.left = self.left.saturating_add(Self::PER_CORNER * count as u64);
    }
}

impl Default for EarBudget {
    /// The budget of a file that is yet to be read.
    fn default() -> EarBudget {
        EarBudget { left: Self::BASE }
    }
}

/// Triangulates a polygon; also returns whether it is plane, within rounding to single precision.
///
/// A polygon without ears, such as one that intersects itself, becomes a fan around its first corner: this has the same boundary
/// and, by the even-odd rule, the same interior. So does one for which the budget is too small.
pub fn triangulate_polygon(
    vertices: &[Vec3],
    corners: &[u32],
    budget: &mut EarBudget,
) -> (Vec<[u32; 3]>, bool) {
    let area = area_vector(vertices, corners);
    let normal = area.normalize_or_zero();
    let size = area.length().sqrt();
    let first = vertices[corners[0] as usize];
    let is_near = |&v: &u32| {
        let point = vertices[v as usize];
        normal.dot(point - first).abs() <= 1e-5 * size + 16.0 * UNIT_ROUNDOFF * point.length()
    };
    let clipped = clip_ears(vertices, corners, normal, budget);
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
/// remaining polygon has no ear, or the budget is used up.
pub fn clip_ears(
    vertices: &[Vec3],
    corners: &[u32],
    normal: Vec3,
    budget: &mut EarBudget,
) -> Option<Vec<[u32; 3]>> {
    budget.add_corners(corners.len());
    let mut left = corners.to_vec();
    let mut triangles = Vec::with_capacity(corners.len());
    let is_large = corners.len() > MAX_FAN;
    let mut start = 0;
    while left.len() > 3 {
        let mut ear = None;
        for k in (0..left.len()).map(|k| (start + k) % left.len()) {
            let [a, b, c] = neighbours(&left, k);
            // only convex corners need the comparison with all others
            let is_convex = orientation(vertices, [a, b, c], normal) > 0.0;
            if !budget.take(if is_convex { left.len() } else { 1 }) {
                return None;
            }
            if is_convex && is_ear(vertices, &left, [a, b, c], normal) {
                ear = Some(k);
                break;
            }
        }
        let ear = ear?;
        triangles.push(neighbours(&left, ear));
        left.remove(ear);
        start = if is_large { ear + 1 } else { 0 };
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

/// True if the triangle at a convex corner contains no other corner of the polygon.
fn is_ear(vertices: &[Vec3], corners: &[u32], [a, b, c]: [u32; 3], normal: Vec3) -> bool {
    let is_left = |triangle: [u32; 3]| orientation(vertices, triangle, normal) >= 0.0;
    let contains = |&p: &u32| [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(is_left);
    let mut others = corners.iter().filter(|vertex| ![a, b, c].contains(vertex));
    !others.any(contains)
}

fn orientation(vertices: &[Vec3], triangle: [u32; 3], normal: Vec3) -> f64 {
    crate::triangle::cross(triangle.map(|vertex| vertices[vertex as usize])).dot(normal)
}
