//! Faceted boundaries of solids.

use super::arguments::{Arguments, Refusal};
use super::convex_hull::convex_hull;
use rayweave_math::Vec3;

/// A triangle mesh; inside and outside follow the even-odd rule along a ray.
#[derive(Clone, Debug, Default)]
pub(super) struct Shell {
    pub vertices: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// True if the shell is known to be the convex hull of its vertices.
    pub is_convex: bool,
}

impl Shell {
    /// Convex hull of points; empty if they are coplanar.
    pub fn hull(arguments: &Arguments, points: Vec<Vec3>) -> Result<Shell, Refusal> {
        let faces = convex_hull(arguments, &points)?.unwrap_or_default();
        let triangles = faces.into_iter().map(|corners| corners.map(|k| k as u32)).collect();
        Ok(Shell { vertices: points, triangles, is_convex: true })
    }
}
