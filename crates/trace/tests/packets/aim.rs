//! Rays aimed at degenerate places of a model.

use rayweave_conformance::Random;
use rayweave_math::Vec3;
use rayweave_shape::Ray;

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// The point.
    pub point: Vec3,
    /// The unit normal there.
    pub normal: Vec3,
    /// A direction in the surface: an edge, an axis.
    pub along: Vec3,
}

impl Target {
    pub fn new(point: Vec3, normal: Vec3, along: Vec3) -> Target {
        Target { point, normal, along }
    }
}

/// A ray through a target or close by, at any angle to the normal and to the tangent direction, from
/// anywhere, with a direction of any length.
pub fn aimed(rng: &mut Random, targets: &[Target]) -> Ray {
    let Target { point, normal, along } = targets[rng.below(targets.len())];
    let across = normal.cross(along);
    let point = point + small(rng, -17.0, -7.0) * normal + small(rng, -17.0, -1.0) * across;
    let direction = match rng.below(8) {
        0 => rng.direction(),
        1..3 => normal + small(rng, -16.0, 0.0) * along + small(rng, -16.0, 0.0) * across,
        3..5 => along + small(rng, -17.0, -3.0) * normal + small(rng, -17.0, -1.0) * across,
        5 => across + small(rng, -17.0, -3.0) * normal + small(rng, -17.0, -1.0) * along,
        _ => {
            let turn = rng.between(-3.2, 3.2);
            let level = libm::cos(turn) * along + libm::sin(turn) * across;
            level + small(rng, -16.0, 0.0) * normal
        }
    };
    let direction = if rng.chance(0.5) { direction } else { -direction };
    let back = match rng.below(8) {
        0 => 0.0,
        1 => rng.magnitude(2.0, 12.0).abs(),
        _ => rng.between(-1.0, 8.0),
    };
    Ray::new(point - back * direction, direction * unit_of_time(rng))
}

/// Zero, or a number of random magnitude between two powers of ten, of either sign: half of them in the upper
/// six decades. One in a hundred is so small that its square underflows, or nearly so.
fn small(rng: &mut Random, lo: f64, hi: f64) -> f64 {
    match rng.below(100) {
        0 => rng.magnitude(-170.0, -140.0),
        1..20 => 0.0,
        20..60 => rng.magnitude(lo.max(hi - 6.0), hi),
        _ => rng.magnitude(lo, hi),
    }
}

/// A factor for a direction of unit length.
fn unit_of_time(rng: &mut Random) -> f64 {
    match rng.below(16) {
        0 => rng.magnitude(-90.0, 90.0).abs(),
        1 => rng.magnitude(-3.0, 3.0).abs(),
        2 => rng.pick(&[0.125, 2.0, 3.0]),
        _ => 1.0,
    }
}
