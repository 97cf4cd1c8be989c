//! Sources against closed forms: positions, directions, powers, wavelengths; and ranges of rays
//! against the whole source.

mod patterns;
mod pieces;
mod spectra;
mod spread;

use rayweave_math::Vec3;
use rayweave_optics::source::SourceRays;

/// Origin and direction of a ray.
fn ray(rays: &SourceRays, k: usize) -> (Vec3, Vec3) {
    let ray = rays.rays().get(k);
    (ray.origin, ray.direction)
}

/// The mean over all rays, weighted by power.
fn mean(rays: &SourceRays, value: impl Fn(Vec3, Vec3) -> f64) -> f64 {
    let parts = (0..rays.len()).map(|k| {
        let (origin, direction) = ray(rays, k);
        rays.power[k] * value(origin, direction)
    });
    parts.sum::<f64>() / rays.power.iter().sum::<f64>()
}

#[track_caller]
fn assert_close(found: f64, exact: f64, tolerance: f64) {
    assert!((found - exact).abs() <= tolerance, "found {found}, not {exact}: off by {:e}", found - exact);
}
