//! The part of a ray that says whether it lies in a surface.

use rayweave_math::{Bounds, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::surface::Chord;

/// A ball around all that is finite in a group: finite leaves and the anchor points of surfaces, doubled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// The ball's centre.
    pub centre: Vec3,
    /// The ball's radius, > 0.
    pub radius: f64,
}

impl Ball {
    /// The ball of a box that holds every finite thing of a group, doubled.
    ///
    /// Where all of it is one point (a lone plane, say) any ball will do: the distance of that point from
    /// the origin, or 1 at the origin itself, is the only length in sight.
    pub fn around(finite: &Bounds) -> Ball {
        if finite.is_empty() {
            return Ball { centre: Vec3::ZERO, radius: 1.0 };
        }
        let (centre, half) = (finite.centre(), 0.5 * finite.size().length());
        let radius = [2.0 * half, centre.length(), 1.0].into_iter().find(|&r| r > 0.0).unwrap_or(1.0);
        Ball { centre, radius }
    }
}

/// The chord of a ray: from one radius before its point closest to the centre to one radius after it.
///
/// That is the part of the ray in the ball, and somewhat more for rays that pass beside the centre: what
/// matters is that the chord is as long as the model, so that only a ray that keeps to a surface all along
/// counts as lying in it.
pub fn chord(ball: &Ball, ray: &Ray) -> Chord {
    let closest = ray.closest_time(ball.centre);
    let half = ball.radius / ray.direction.length();
    Chord::new(ray, (closest - half, closest + half))
}
