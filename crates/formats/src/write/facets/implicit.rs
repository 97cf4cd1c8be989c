//! Tessellation of implicit surfaces on a cubic grid.

use crate::kernel::Body;
use rayweave_math::{Bounds, Vec3};
use rayweave_shape::primitive::Lowered;
use rayweave_shape::surface::Surface;

/// Finest grid: maximum number of cells along the diagonal of the box.
const MAX_CELLS: f64 = 300.0;

/// Tessellation of a shape with one smooth face of any kind.
pub(super) fn single_face(
    surface: &Surface,
    lowered: &Lowered,
    clip: &Bounds,
    tolerance: f64,
) -> Result<Option<Body>, String> {
    if lowered.facets.len() > 1 || lowered.complement {
        return Err("shapes with more than one curved face of this kind cannot be tessellated".to_owned());
    }
    body(surface, &lowered.bounds.intersection(clip), tolerance)
}

/// The interior of a surface, clipped to a box, from a level set on a grid that is refined until the centroids of the
/// triangles are within the tolerance.
pub(super) fn body(surface: &Surface, bounds: &Bounds, tolerance: f64) -> Result<Option<Body>, String> {
    if bounds.is_empty() {
        return Ok(None);
    }
    let diagonal = bounds.size().length();
    let mut cells = 32.0;
    while cells <= MAX_CELLS {
        let body =
            Body::level_set(|p| -surface.value_and_gradient(p).0, bounds, diagonal / cells, 1e-3 * tolerance);
        let Some(body) = body? else {
            return Ok(None);
        };
        if worst(&body, surface, bounds, diagonal / cells) <= tolerance {
            return Ok(Some(body));
        }
        cells *= 1.5;
    }
    Err(too_coarse(tolerance))
}

/// Largest distance of a triangle's centroid from the surface, except near the faces of the box.
fn worst(body: &Body, surface: &Surface, bounds: &Bounds, edge: f64) -> f64 {
    let inner = bounds.grown(-1.5 * edge);
    let centroids = body.centroids().into_iter().filter(|p| inner.contains(*p));
    let distance = |p: Vec3| {
        let (value, gradient) = surface.value_and_gradient(p);
        if value == 0.0 { 0.0 } else { value.abs() / gradient.length() }
    };
    centroids.map(distance).fold(0.0, f64::max)
}

/// The message about a grid that would need more cells than the limit.
pub(super) fn too_coarse(tolerance: f64) -> String {
    format!("the tessellation exceeds the tolerance {tolerance:?} on the finest grid. Increase the tolerance")
}
