//! Ray batches of the exemplars, the same on every platform.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave::model::RayBatch;
use rayweave::render::{Camera, Size};
use rayweave::{Error, Ray, Vec3};

/// A random number generator with this seed.
pub fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// A point in the cube between (-1, -1, -1) and (1, 1, 1).
fn in_cube(random: &mut ChaCha8Rng) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)))
}

/// A uniform random point on the unit sphere, by projection of a point in the ball (von Neumann's
/// rejection).
fn on_sphere(random: &mut ChaCha8Rng) -> Vec3 {
    loop {
        let point = in_cube(random);
        let length = point.length();
        if 0.01 < length && length < 1.0 {
            return point / length;
        }
    }
}

/// Incoherent rays: from random points on the sphere of radius 5 to random points in the cube
/// between (-1, -1, -1) and (1, 1, 1), at t = 1.
pub fn incoherent(count: usize, seed: u64) -> RayBatch {
    let mut random = random(seed);
    let one = |_| {
        let (from, to) = (5.0 * on_sphere(&mut random), in_cube(&mut random));
        Ray::new(from, to - from)
    };
    (0..count).map(one).collect()
}

/// Rays for a lens of aperture 20 about the origin: from random points on the sphere of radius 100
/// to random points in a box slightly wider than the lens, so that some miss.
pub fn lens_rays(count: usize, seed: u64) -> RayBatch {
    let mut random = random(seed);
    let one = |_| {
        let (from, to) = (100.0 * on_sphere(&mut random), Vec3::new(11.0, 11.0, 2.0) * in_cube(&mut random));
        Ray::new(from, to - from)
    };
    (0..count).map(one).collect()
}

/// The camera of the coherent rays: the cube fills most of a square picture.
pub fn camera() -> Result<Camera, Error> {
    Ok(Camera::perspective([4.0, -5.0, 3.2], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 24.0)?)
}

/// Coherent rays: those of the pixels of a square picture, row by row; as many whole rows as fit
/// into `count` rays.
pub fn coherent(count: usize) -> Result<RayBatch, Error> {
    let (camera, side) = (camera()?, count.isqrt().max(8) / 8 * 8);
    let size = Size::new(side as u32, side as u32)?;
    let pixels = (0..side * side).map(|i| [(i % side) as f64 + 0.5, (i / side) as f64 + 0.5]);
    Ok(pixels.map(|[x, y]| camera.ray(size, x, y)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_what_they_are_called() {
        let rays = incoherent(1000, 1);
        for i in 0..1000 {
            let ray = rays.rays().get(i);
            assert!((ray.origin.length() - 5.0).abs() < 1e-12);
            assert!((ray.origin + ray.direction).abs().max_element() <= 1.0 + 1e-12);
        }
        let rays = coherent(5000).unwrap();
        assert_eq!(rays.rays().len(), 64 * 64);
        assert_eq!(rays.rays().get(0).origin, rays.rays().get(4095).origin);
    }
}
