//! Hit attributes (point and normal), computed only for crossings that are reported.

use crate::{Crossing, Face, Program};
use rayweave_math::{Mat3, Vec3};
use rayweave_shape::Ray;

/// The point of a crossing.
pub fn point(ray: &Ray, crossing: &Crossing) -> Vec3 {
    ray.at(crossing.t)
}

/// The unit normal of a crossing: against the ray where it enters a region, along the ray where it leaves into the
/// world.
///
/// It is the gradient of the surface, transformed to the world by the inverse transpose. Where the surface
/// has no tangent plane (the apex of a cone) it is parallel to the ray, so that it is never NaN.
pub fn normal(program: &Program, ray: &Ray, crossing: &Crossing) -> Vec3 {
    let gradient = world_gradient(program, ray, crossing.face, crossing.t);
    let sign = if crossing.enters() { -1.0 } else { 1.0 };
    let unit = gradient.try_normalize().unwrap_or_else(|| sign * ray.direction.normalize());
    let slope = unit.dot(ray.direction);
    if slope == 0.0 { unit * outward(program, crossing.face) } else { unit * (slope.signum() * sign) }
}

/// Nesting depth of placements handled without a heap allocation.
const NESTED: usize = 4;

/// The gradient of a face's surface at time t, in world coordinates. Only its direction is meaningful.
///
/// It is transformed through every enclosing frame by the transpose of each `local_from_world`.
pub fn world_gradient(program: &Program, ray: &Ray, face: Face, t: f64) -> Vec3 {
    let (mut local, mut first, mut count, mut deeper) = (*ray, [Mat3::IDENTITY; NESTED], 0, Vec::new());
    // the ray as in `local_ray`, whose magnitude does not matter here
    for place in program.descend(face.placement) {
        local = local.transformed(&place.local_from_world);
        let map = place.local_from_world.linear.transpose();
        match first.get_mut(count) {
            Some(slot) => (*slot, count) = (map, count + 1),
            None => deeper.push(map),
        }
    }
    let (_, gradient) = program.surface(face.surface).surface.value_and_gradient(local.at(t));
    let maps = first[..count].iter().chain(&deeper).rev();
    let up = maps.fold(gradient, |gradient, map| *map * gradient);
    let largest = up.abs().max_element();
    if largest > 0.0 { up / largest } else { Vec3::ZERO }
}

/// +1 if the gradient of a face's surface points out of its leaf, else -1. Used where the ray is tangent.
fn outward(program: &Program, face: Face) -> f64 {
    let leaf = program.leaf(face.leaf);
    if leaf.facets()[face.facet as usize].inside() ^ leaf.is_complement() { 1.0 } else { -1.0 }
}
