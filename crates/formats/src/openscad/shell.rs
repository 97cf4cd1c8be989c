//! Faceted boundaries of solids.

use super::arguments::{Arguments, Refusal};
use super::convex_hull::convex_hull;
use rayweave_math::Vec3;
use rayweave_mesh::{Mesh, RepairOptions};
use rayweave_model::{Boundary, Facets, Solid};
use std::sync::Arc;

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

/// The solid of one item of the dump, whose operators the reader chose, with its facets, if there are any.
struct Item(Option<Facets>);

impl Boundary for Item {
    fn facets(&self, _tolerance: f64) -> Option<Facets> {
        self.0.clone()
    }
}

/// A solid that is one item of the dump.
pub(super) fn one_item(solid: &Solid) -> Solid {
    solid.with_boundary(Arc::new(Item(None)))
}

/// A solid that is one item of the dump, with exactly these facets.
pub(super) fn one_item_with(solid: &Solid, shell: Shell) -> Solid {
    // points on the axis of a revolution are repeated, and the facets may face inwards
    let mesh = Mesh::new(shell.vertices, shell.triangles);
    let facets =
        mesh.and_then(|mesh| mesh.repaired(&RepairOptions::default().with_fill(false))).map(|(mesh, _)| {
            let (points, triangles) = mesh.into_parts();
            Facets { points, triangles, ..Facets::default() }
        });
    solid.with_boundary(Arc::new(Item(facets.ok())))
}
