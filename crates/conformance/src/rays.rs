//! Random rays: through a model, grazing, in its faces and along its edges, from far away, with directions of any length.

use crate::{Random, Style};
use rayweave_math::{Affine, Vec3};
use rayweave_model::RayBatch;
use rayweave_shape::Ray;

/// Random rays for a model of the given style in the given frame.
pub fn rays(rng: &mut Random, style: Style, frame: &Affine, count: usize) -> Vec<Ray> {
    (0..count).map(|_| ray(rng, style, frame)).collect()
}

/// Rays as a batch.
pub fn batch(rays: &[Ray]) -> RayBatch {
    rays.iter().copied().collect()
}

fn ray(rng: &mut Random, style: Style, frame: &Affine) -> Ray {
    let local = match (style, rng.below(8)) {
        (_, 0) => through(rng),
        (_, 1) => from_afar(rng),
        (_, 2) => rescaled(rng),
        (Style::Generic, 3..6) => through(rng),
        (_, 3..5) => along_axis(rng, 0.0),
        (_, 5) => along_axis(rng, 1.0),
        (_, 6) => diagonal(rng),
        _ => tangent(rng),
    };
    local.transformed(frame)
}

fn through(rng: &mut Random) -> Ray {
    let (a, b) = (rng.point(2.5), rng.point(2.5));
    let direction = if rng.chance(0.5) { b - a } else { (b - a).normalize() };
    Ray::new(a - rng.between(0.0, 6.0) * direction, direction)
}

fn from_afar(rng: &mut Random) -> Ray {
    let (direction, distance) = (rng.direction(), rng.magnitude(3.0, 8.0).abs());
    Ray::new(rng.point(2.0) - distance * direction, direction)
}

/// A ray with a direction of arbitrary length.
fn rescaled(rng: &mut Random) -> Ray {
    let ray = through(rng);
    Ray::new(ray.origin, ray.direction * rng.magnitude(-30.0, 30.0).abs())
}

fn multiple_of_quarter(rng: &mut Random) -> f64 {
    0.25 * (rng.below(25) as f64 - 12.0)
}

/// A ray parallel to an axis through multiples of 0.25; 30 % of them are displaced by up to 1e-12. A `tilt` of 1 adds
/// slopes of 1e-16 to 0.8, 0 adds none.
fn along_axis(rng: &mut Random, tilt: f64) -> Ray {
    let axis = rng.below(3);
    let mut origin = Vec3::new(multiple_of_quarter(rng), multiple_of_quarter(rng), multiple_of_quarter(rng));
    let mut direction = Vec3::ZERO;
    direction[axis] = rng.pick(&[1.0, -1.0, 2.0, 0.125]);
    direction[(axis + 1) % 3] = tilt * rng.magnitude(-16.0, -1.0);
    if rng.chance(0.5) {
        direction[(axis + 2) % 3] = tilt * rng.magnitude(-16.0, -1.0);
    }
    if rng.chance(0.3) {
        origin[(axis + 1) % 3] += rng.magnitude(-17.0, -12.0);
    }
    Ray::new(origin, direction)
}

fn diagonal(rng: &mut Random) -> Ray {
    let origin = Vec3::new(multiple_of_quarter(rng), multiple_of_quarter(rng), multiple_of_quarter(rng));
    let mut direction = Vec3::ZERO;
    while direction == Vec3::ZERO {
        direction = Vec3::from_array(std::array::from_fn(|_| rng.pick(&[-1.0, 0.0, 1.0])));
    }
    Ray::new(origin, direction)
}

/// A ray nearly tangent to a sphere or cylinder with one of the sizes of the grid.
fn tangent(rng: &mut Random) -> Ray {
    let radius = rng.pick(&[0.5, 1.0]) * (1.0 + rng.magnitude(-17.0, -6.0));
    let outward = rng.direction();
    let along = rng.direction().cross(outward).normalize();
    let centre =
        2.0 * Vec3::new(multiple_of_quarter(rng), multiple_of_quarter(rng), multiple_of_quarter(rng));
    Ray::new(centre + radius * outward - rng.between(-4.0, 4.0) * along, along)
}
