//! Visible surfaces, and the samples kept of them.

use rayweave_math::Vec3;
use rayweave_model::{Crossing, Face, PixelCamera, PixelRays, RegionId};
use rayweave_shape::Ray;

/// Points of a picture: some pixels with a regular grid of points in each.
#[derive(Default)]
pub(crate) struct PicturePoints {
    /// The points in pixel coordinates, pixel by pixel.
    pub places: Vec<[f64; 2]>,
    /// The numbers of the pixels.
    pub pixels: Vec<u32>,
    /// The number of points per side of a pixel.
    pub per_side: u32,
}

impl PicturePoints {
    /// The rays through the points, for devices that compute them.
    pub fn rays(&self, camera: PixelCamera) -> PixelRays<'_> {
        PixelRays { camera, per_side: self.per_side, pixels: &self.pixels }
    }
}

/// A surface along a camera ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer {
    /// The number of the ray in its batch.
    pub ray: usize,
    /// The number of layers in front of it on its ray.
    pub level: usize,
    pub t: f64,
    /// The unit normal on the side of the camera.
    pub normal: Vec3,
    pub face: Face,
    /// The visible region.
    pub region: RegionId,
    /// The lights that shine on it, one bit each.
    pub lit: u32,
}

/// The data of a layer by which neighbouring samples are compared.
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
    /// The sample of a ray without a hit.
    pub const MISS: Sample =
        Sample { t: f64::INFINITY, normal: [0.0; 3], face: u32::MAX, placement: 0, region: 0, lit: 0 };
}

/// The visible region at a crossing: the region behind it or, if that is the world, the region in front.
pub(crate) fn seen(crossing: &Crossing) -> RegionId {
    if crossing.enters() { crossing.after } else { crossing.before }
}

/// The normal on the side of the camera.
pub(crate) fn towards_eye(normal: Vec3, ray: &Ray) -> Vec3 {
    if normal.dot(ray.direction) > 0.0 { -normal } else { normal }
}
