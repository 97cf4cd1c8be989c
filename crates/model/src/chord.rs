//! The part of a ray that says whether it lies in a surface.

use rayweave_math::{Bounds, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::surface::{Chord, delta};

/// A ball around all that is finite in a group: finite leaves and the anchor points of surfaces, doubled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// The ball's centre.
    pub centre: Vec3,
    /// The ball's radius, >= 0.
    pub radius: f64,
}

impl Ball {
    /// The ball of a box that holds every finite thing of a group, doubled.
    ///
    /// Where all of it is one point (a lone plane, say) the distance of that point from the origin is the only
    /// length in sight; at the origin itself there is none, and the radius is 0.
    pub fn around(finite: &Bounds) -> Ball {
        if finite.is_empty() {
            return Ball { centre: Vec3::ZERO, radius: 0.0 };
        }
        let (centre, half) = (finite.centre(), 0.5 * finite.size().length());
        Ball { centre, radius: if half > 0.0 { 2.0 * half } else { centre.length() } }
    }
}

/// A chord is at least so many times as long as the tolerance is wide.
const LEAST: f64 = 1024.0;

impl Ball {
    /// Half of the chord of a ray that is closest to the centre at a time, in units of time.
    ///
    /// A model without any length takes that of the ray's origin from its centre or, where the ray starts
    /// there, the unit of time: so no length is singled out, and scales change nothing. A length that the ray's own
    /// rounding swallows is none: a lone plane that was turned about the origin has one of 1e-17, and over that every
    /// ray that meets it there would lie in it.
    pub fn half_chord(&self, ray: &Ray, closest: f64) -> f64 {
        let least = LEAST * delta(self.centre.length(), ray, closest);
        let radius = if self.radius > least { self.radius } else { 0.0 };
        let lengths = [radius, (ray.origin - self.centre).length(), ray.direction.length()];
        lengths.into_iter().find(|&length| length > 0.0).unwrap_or(0.0) / ray.direction.length()
    }
}

/// The chord of a ray: from one radius before its point closest to the centre to one radius after it.
///
/// That is the part of the ray in the ball, and somewhat more for rays that pass beside the centre: what
/// matters is that the chord is as long as the model, so that only a ray that keeps to a surface all along
/// counts as lying in it.
pub fn chord(ball: &Ball, ray: &Ray) -> Chord {
    let closest = ray.closest_time(ball.centre);
    let half = ball.half_chord(ray, closest);
    Chord::new(ray, (closest - half, closest + half))
}
