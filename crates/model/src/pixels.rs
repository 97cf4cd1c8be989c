//! Rays through the pixels of a picture, as a description from which a device can compute them.

use crate::{BadRay, Program, RayBatch, Rays};
use rayweave_math::Vec3;
use rayweave_shape::Ray;

/// The numbers of a camera that define the ray through each point of its picture.
///
/// For a picture of w x h pixels, let `u = (2 x - w) / h` and `v = (h - 2 y) / h`, where (x, y) is measured in pixels from the upper
/// left corner. The ray through (x, y) is
///
/// - perspective: from `position` along `forward + half_height (u right + v up)`, normalised;
/// - orthographic: from `position + half_height (u right + v up)` along `forward`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelCamera {
    /// The position.
    pub position: Vec3,
    /// The line of sight, a unit vector.
    pub forward: Vec3,
    /// The unit vector to the right in the picture.
    pub right: Vec3,
    /// The unit vector upwards in the picture.
    pub up: Vec3,
    /// Half the height of the picture: at distance 1, or in lengths of the model.
    pub half_height: f64,
    /// True if all rays leave the position, false if all are parallel.
    pub is_perspective: bool,
    /// Width and height of the picture in pixels, at least 1.
    pub size: [u32; 2],
}

impl PixelCamera {
    /// The ray through the point (x, y), in pixels from the upper left corner.
    ///
    /// Devices compute the same bits, so each operation and their order are part of the definition.
    #[inline(always)] // into loops that are compiled for wider instructions
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let [w, h] = self.size.map(f64::from);
        let u = (2.0 * x - w) / h * self.half_height;
        let v = (h - 2.0 * y) / h * self.half_height;
        let offset = u * self.right + v * self.up;
        match self.is_perspective {
            true => Ray::new(self.position, (self.forward + offset).normalize()),
            false => Ray::new(self.position + offset, self.forward),
        }
    }
}

/// Rays through points of some pixels of a picture, on a regular grid of n x n points per pixel: pixel by pixel, and row by row
/// within each.
#[derive(Clone, Copy, Debug)]
pub struct PixelRays<'a> {
    /// The camera.
    pub camera: PixelCamera,
    /// n, the number of points per side of a pixel, at least 1.
    pub per_side: u32,
    /// The numbers of the pixels, row by row from the upper left corner.
    pub pixels: &'a [u32],
}

impl PixelRays<'_> {
    /// The number of rays per pixel.
    pub fn per_pixel(&self) -> usize {
        self.per_side as usize * self.per_side as usize
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.pixels.len() * self.per_pixel()
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.pixels.is_empty()
    }

    /// Ray number `i`.
    #[inline]
    pub fn get(&self, i: usize) -> Ray {
        let [x, y] = self.place(i);
        self.camera.ray(x, y)
    }

    /// The point of ray number `i` in the picture.
    pub fn place(&self, i: usize) -> [f64; 2] {
        let (pixel, k) = (self.pixels[i / self.per_pixel()], (i % self.per_pixel()) as u32);
        let at =
            |whole: u32, part: u32| f64::from(whole) + (f64::from(part) + 0.5) / f64::from(self.per_side);
        let width = self.camera.size[0].max(1);
        [at(pixel % width, k % self.per_side), at(pixel / width, k / self.per_side)]
    }

    /// The rays of a range.
    pub fn batch(&self, range: std::ops::Range<usize>) -> RayBatch {
        range.map(|i| self.get(i)).collect()
    }
}

/// Rays of a query: arrays, or rays that a device can compute.
#[derive(Clone, Copy, Debug)]
pub enum RaySource<'a> {
    /// Rays as arrays.
    Arrays(Rays<'a>),
    /// Rays through pixels.
    Pixels(PixelRays<'a>),
}

impl<'a> From<Rays<'a>> for RaySource<'a> {
    fn from(rays: Rays<'a>) -> RaySource<'a> {
        RaySource::Arrays(rays)
    }
}

impl<'a> From<PixelRays<'a>> for RaySource<'a> {
    fn from(rays: PixelRays<'a>) -> RaySource<'a> {
        RaySource::Pixels(rays)
    }
}

impl RaySource<'_> {
    /// The number of rays.
    pub fn len(&self) -> usize {
        match self {
            RaySource::Arrays(rays) => rays.len(),
            RaySource::Pixels(rays) => rays.len(),
        }
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Ray number `i`.
    #[inline]
    pub fn get(&self, i: usize) -> Ray {
        match self {
            RaySource::Arrays(rays) => rays.get(i),
            RaySource::Pixels(rays) => rays.get(i),
        }
    }
}

impl Program {
    /// The check of [`Program::check_rays`] for rays through pixels.
    ///
    /// # Errors
    /// [`BadRay`] for the first ray that cannot be traced.
    pub fn check_pixels(&self, rays: &PixelRays<'_>) -> Result<(), BadRay> {
        let [w, h] = rays.camera.size;
        let count = u64::from(w) * u64::from(h);
        // components of origins are monotonic functions of x and of y, so those of all rays lie between those of the corners
        let [right, bottom] = [w, h].map(f64::from);
        let corners: RayBatch = [[0.0, 0.0], [right, 0.0], [0.0, bottom], [right, bottom]]
            .into_iter()
            .map(|[x, y]| rays.camera.ray(x, y))
            .collect();
        let is_inside = || rays.pixels.iter().all(|&pixel| u64::from(pixel) < count);
        if self.are_near(corners.rays()) && is_inside() {
            return Ok(());
        }
        self.check_rays(rays.batch(0..rays.len()).rays())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_shape::primitive::build;

    fn camera(is_perspective: bool) -> PixelCamera {
        PixelCamera {
            position: Vec3::new(1.0, 2.0, 3.0),
            forward: Vec3::Z,
            right: Vec3::X,
            up: Vec3::Y,
            half_height: 0.5,
            is_perspective,
            size: [4, 2],
        }
    }

    #[test]
    fn rays_pass_through_their_points() {
        let pixels = PixelRays { camera: camera(false), per_side: 2, pixels: &[5, 0] };
        assert_eq!((pixels.len(), pixels.is_empty()), (8, false));
        // pixel 5 is in column 1 of row 1
        let places: Vec<[f64; 2]> = (0..5).map(|i| pixels.place(i)).collect();
        assert_eq!(places, [[1.25, 1.25], [1.75, 1.25], [1.25, 1.75], [1.75, 1.75], [0.25, 0.25]]);
        // the height of the picture is 1, that of a pixel 1/2
        assert_eq!(pixels.get(0), Ray::new(Vec3::new(0.625, 1.875, 3.0), Vec3::Z));
        assert_eq!(pixels.batch(3..5).rays().get(1), pixels.get(4));
        let oblique = PixelRays { camera: camera(true), ..pixels }.get(0);
        assert_eq!(oblique.origin, Vec3::new(1.0, 2.0, 3.0));
        let expected = Vec3::new(-0.375, -0.125, 1.0);
        assert!((oblique.direction * expected.length() - expected).length() < 1e-15, "{oblique:?}");
    }

    #[test]
    fn pixels_are_checked_like_their_rays() {
        let ball = build("sphere", &[("radius", 1.0.into())]).unwrap();
        let program = Program::compile(&ball.into()).unwrap();
        for (distance, is_perspective) in
            [(3.0, true), (3.0, false), (1e14, true), (1e14, false), (1e300, false)]
        {
            let mut camera = camera(is_perspective);
            camera.position.z = -distance;
            // the last one is outside of the picture
            let pixels = PixelRays { camera, per_side: 3, pixels: &[0, 3, 7, 90] };
            let rays = pixels.batch(0..pixels.len());
            assert_eq!(program.check_pixels(&pixels), program.check_rays(rays.rays()), "{distance}");
            // distant rays of the perspective camera miss the ball by more than the tolerance
            assert_eq!(program.check_pixels(&pixels).is_ok(), distance < 10.0 || is_perspective);
        }
    }
}
