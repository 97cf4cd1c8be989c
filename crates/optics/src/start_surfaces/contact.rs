//! Contacts of rays with surfaces: the surface at the point of a crossing.

use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_model::{Crossing, Face, Program};
use rayweave_shape::Ray;
use std::sync::Arc;

/// A map into the frame of a placement, in half a cache line: photons among many solids wait for it.
#[derive(Clone, Debug)]
pub(super) struct Map {
    pub translation: Vec3,
    /// Copies that are turned alike share it.
    pub linear: Arc<Mat3>,
}

impl Map {
    #[inline]
    pub fn affine(&self) -> Affine {
        Affine { linear: *self.linear, translation: self.translation }
    }
}

/// A crossing of a ray, with the surface at the point where it is crossed.
#[derive(Clone, Copy, Debug)]
pub struct Contact<'a> {
    pub(super) program: &'a Program,
    pub(super) ray: &'a Ray,
    pub(super) t: f64,
    pub(super) face: Face,
    /// The maps into the frame of the surface, outermost first.
    maps: &'a [Map],
    /// The surface's function at the point, and its gradient, in that frame.
    value: f64,
    gradient: Vec3,
}

impl<'a> Contact<'a> {
    /// Evaluates the surface of a crossing; `maps` lead into its frame.
    #[inline]
    pub(super) fn new(
        program: &'a Program,
        ray: &'a Ray,
        crossing: &Crossing,
        maps: &'a [Map],
    ) -> Contact<'a> {
        let &Crossing { t, face, .. } = crossing;
        let (value, gradient) = value_and_gradient(program, (ray, crossing), maps.iter().map(Map::affine));
        Contact { program, ray, t, face, maps, value, gradient }
    }

    /// The slope along the ray of the surface's function, up to a positive factor, like that of
    /// [`rayweave_model::attributes::world_gradient`].
    #[inline]
    pub(super) fn slope(&self) -> f64 {
        outer_gradient(self.gradient, self.maps.iter().map(Map::affine)).dot(self.ray.direction)
    }

    /// The point of the crossing, projected onto the surface by one Newton step along a normal.
    #[must_use]
    #[inline]
    pub fn project(&self, normal: Vec3) -> Vec3 {
        let maps = self.maps.iter().map(Map::affine);
        onto_surface((self.ray, self.t), normal, (self.value, self.gradient), maps)
    }
}

/// The function of the surface of a crossing and its gradient, in the frame that `maps` lead into.
#[inline]
fn value_and_gradient(
    program: &Program,
    (ray, crossing): (&Ray, &Crossing),
    maps: impl Iterator<Item = Affine>,
) -> (f64, Vec3) {
    let local = maps.fold(*ray, |local, map| local.transformed(&map));
    program.surface(crossing.face.surface).surface.value_and_gradient(local.at(crossing.t))
}

/// The point of a ray at a time, projected by one Newton step along a normal onto a surface with this value and gradient.
#[inline]
fn onto_surface(
    (ray, t): (&Ray, f64),
    normal: Vec3,
    (value, gradient): (f64, Vec3),
    maps: impl Iterator<Item = Affine>,
) -> Vec3 {
    let along = maps.fold(normal, |normal, map| map.vector(normal));
    newton_step(ray.at(t), normal, value / gradient.dot(along))
}

/// A gradient in the world, up to a positive factor; `maps` lead into its frame.
#[inline]
pub(super) fn outer_gradient(gradient: Vec3, maps: impl DoubleEndedIterator<Item = Affine>) -> Vec3 {
    let up = maps.rev().fold(gradient, |gradient, map| map.linear.transpose() * gradient);
    let largest = up.abs().max_element();
    match largest {
        // planes across an axis need no division
        1.0 => up,
        _ if largest > 0.0 => up / largest,
        _ => Vec3::ZERO,
    }
}

/// The point of a crossing, projected onto its surface by one Newton step along the normal.
#[must_use]
pub fn project(program: &Program, ray: &Ray, crossing: &Crossing, normal: Vec3) -> Vec3 {
    let maps: Vec<Affine> =
        program.descend(crossing.face.placement).map(|place| place.local_from_world).collect();
    let value = value_and_gradient(program, (ray, crossing), maps.iter().copied());
    onto_surface((ray, crossing.t), normal, value, maps.iter().copied())
}

/// A point after a step against a direction; a step that is not finite is ignored.
pub(crate) fn newton_step(point: Vec3, normal: Vec3, step: f64) -> Vec3 {
    if step.is_finite() { point - step * normal } else { point }
}
