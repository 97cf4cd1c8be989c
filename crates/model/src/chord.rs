//! In-surface rays: the part of a ray along which the engine decides whether the ray lies in a surface.

use rayweave_math::{Bounds, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::surface::{Chord, delta, delta_of};

/// A ball around everything finite in a group (finite leaves and, for the surfaces of the others, the anchor
/// points and sizes), with twice the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// The ball's centre.
    pub centre: Vec3,
    /// The ball's radius, >= 0.
    pub radius: f64,
    /// The largest magnitude of a surface of the group: the length in its tolerance, which includes composed translations.
    pub magnitude: f64,
}

impl Ball {
    /// The ball with twice the radius of the one around a box that holds everything finite in a group, whose surfaces have
    /// magnitudes up to `magnitude`.
    ///
    /// If the box is a single point (of a lone plane or cone, which have no size), the only length available is
    /// the distance of that point from the origin. A radius below the rounding errors of the surfaces is 0.
    pub fn around(finite: &Bounds, magnitude: f64) -> Ball {
        if finite.is_empty() {
            return Ball { centre: Vec3::ZERO, radius: 0.0, magnitude };
        }
        let (centre, half) = (finite.centre(), 0.5 * finite.size().length());
        let radius = if half > 0.0 { 2.0 * half } else { centre.length() };
        let radius = if radius > LEAST * delta_of(magnitude) { radius } else { 0.0 };
        Ball { centre, radius, magnitude }
    }
}

/// Least length of a chord, in multiples of the tolerance `delta`.
const LEAST: f64 = 1024.0;

impl Ball {
    /// Half of the chord of a ray that is closest to the centre at a time, in units of time.
    ///
    /// If the radius is 0, half the chord is the distance of the ray's origin from the centre or, if that is
    /// 0 too, the length of its direction: no absolute length enters, so that results are invariant under
    /// scaling. A length below the rounding error of ray and surfaces counts as 0: a lone plane that was rotated about
    /// the origin has a radius of about 1e-17, and every ray that crosses it would lie in it over such a
    /// chord.
    pub fn half_chord(&self, ray: &Ray, closest: f64) -> f64 {
        let least = LEAST * delta(self.centre.length() + self.magnitude, ray, closest);
        let lengths = [self.radius, (ray.origin - self.centre).length(), ray.direction.length()];
        lengths.into_iter().find(|&length| length > least).unwrap_or(least) / ray.direction.length()
    }
}

/// The chord of a ray: from one radius before its point closest to the centre to one radius after it.
///
/// It covers the part of the ray in the ball, and more for rays that pass beside the centre. The chord is as
/// long as the model, so that only a ray that stays in a surface over the whole length counts as lying in it.
pub fn chord(ball: &Ball, ray: &Ray) -> Chord {
    let closest = ray.closest_time(ball.centre);
    let half = ball.half_chord(ray, closest);
    Chord::new(ray, (closest - half, closest + half))
}
