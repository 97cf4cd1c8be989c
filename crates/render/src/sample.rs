//! What rays see: surfaces, and what is kept of them for a place of the picture.

use rayweave_math::Vec3;
use rayweave_model::{Crossing, Face, RegionId};
use rayweave_shape::Ray;

/// A surface on the way of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer {
    /// The number of the ray in its batch.
    pub ray: usize,
    /// How many layers are before it on its ray.
    pub level: usize,
    pub t: f64,
    /// The unit normal on the side of the eye.
    pub normal: Vec3,
    pub face: Face,
    /// The region whose surface is seen.
    pub region: RegionId,
    /// The lights that shine on it, a bit each.
    pub lit: u32,
}

/// What is seen at a place of the picture: a layer, as far as neighbours are compared by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    pub t: f64,
    pub normal: [f32; 3],
    pub face: u32,
    pub placement: u32,
    pub region: u32,
    pub lit: u32,
}

impl Sample {
    /// Nothing is seen.
    pub const MISS: Sample =
        Sample { t: f64::INFINITY, normal: [0.0; 3], face: u32::MAX, placement: 0, region: 0, lit: 0 };
}

/// The region whose surface a crossing shows: the one behind it, or, where that is the world, the one that is left.
pub(crate) fn seen(crossing: &Crossing) -> RegionId {
    if crossing.enters() { crossing.after } else { crossing.before }
}

/// The side of a surface's normal that faces the eye.
pub(crate) fn towards_eye(normal: Vec3, ray: &Ray) -> Vec3 {
    if normal.dot(ray.direction) > 0.0 { -normal } else { normal }
}
