//! Check for rays that are too far from a model: if the tolerance is as large as the model, all crossings would be
//! welded, and the ray would silently miss it.
//!
//! A ball vanishes along a ray if it is thinner than twice the tolerance `delta = 64 u (|o| + |t| |d| + m)` there, and a
//! slab if it is thinner than `delta`. A ray
//! is rejected where `delta`, at its point closest to the centre of the model, exceeds a quarter of the model's size,
//! which leaves a factor of 2. The size is the shortest side of the box around all regions. It is infinite for a
//! half-space, which cannot vanish, and finite for an unbounded slab or rod.
//!
//! A ray that misses the ball around the box by several `delta` is accepted: rounding cannot make it hit.

use crate::{BadRay, Program, PrototypeId, Rays};
use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use rayweave_shape::surface::delta;
use rayweave_shape::{Ray, RayError};

/// The least size of a model relative to the extent of its parts. Parts in contact may overlap in a thinner sliver due to
/// rounding, which no ray can resolve.
const SLIVER: f64 = 1e-12;

/// The distance at which a model vanishes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    /// The centre of the model.
    centre: Vec3,
    /// The radius of a ball around the model; infinite if the model is unbounded.
    radius: f64,
    /// The shortest side of the box around the model; infinite for models that cannot vanish.
    size: f64,
}

impl Range {
    fn of(program: &Program) -> Range {
        let group = program.prototype(PrototypeId(0));
        let (bounds, ball) = (&group.bounds, &group.ball);
        let (centre, radius, extent) = match bounds.is_finite() {
            true => (bounds.centre(), 0.5 * bounds.size().length(), ball.radius),
            // the ball around planes through one point has radius 0, so their position counts, too
            false => (ball.centre, f64::INFINITY, ball.centre.length() + ball.radius),
        };
        let size = bounds.size().min_element();
        // false for the box of an empty model
        let is_resolved = size > SLIVER * extent;
        Range { centre, radius, size: if is_resolved { size } else { f64::INFINITY } }
    }

    /// The largest tolerance with which rays are traced.
    fn tolerance(&self) -> f64 {
        0.25 * self.size
    }

    /// A bound of the components of an origin: rays that start within it are near enough.
    ///
    /// The closest point is at most `|o - centre|` away, so that `delta` is at most `128 u (|o| + |centre|)`.
    fn near(&self) -> f64 {
        // less than 1 / sqrt(3), by more than the rounding of this line
        0.577 * (self.tolerance() / (128.0 * UNIT_ROUNDOFF) - self.centre.length())
    }

    fn check(&self, ray: &Ray) -> Result<(), RayError> {
        let closest = ray.closest_time(self.centre);
        let accuracy = delta(self.centre.length(), ray, closest);
        if accuracy <= self.tolerance() {
            return Ok(());
        }
        // the rounding of the closest point is below delta
        let apart = (ray.at(closest) - self.centre).length();
        if apart > self.radius + 4.0 * accuracy {
            return Ok(());
        }
        let distance = closest.abs() * ray.direction.length();
        Err(RayError::TooFar { distance, accuracy, size: self.size })
    }
}

impl Program {
    /// Checks that every ray can be traced through this model: see [`Rays::check`] and [`RayError::TooFar`].
    ///
    /// Reads each component once, without a branch per ray, unless a ray starts at a great distance.
    ///
    /// # Errors
    /// [`BadRay`] for the first ray that cannot be traced.
    pub fn check_rays(&self, rays: Rays<'_>) -> Result<(), BadRay> {
        if self.are_near(rays) {
            return Ok(());
        }
        let range = Range::of(self);
        let check = |ray: &Ray| ray.check().and_then(|()| range.check(ray));
        (0..rays.len()).try_for_each(|ray| check(&rays.get(ray)).map_err(|problem| BadRay { ray, problem }))
    }

    /// True only if all rays pass the check since they start near the model; without a branch per ray.
    pub(crate) fn are_near(&self, rays: Rays<'_>) -> bool {
        rays.are_within(Range::of(self).near())
    }

    /// The check of [`Program::check_rays`] for one ray.
    ///
    /// # Errors
    /// [`RayError`] if the ray cannot be traced.
    pub fn check_ray(&self, ray: &Ray) -> Result<(), RayError> {
        ray.check().and_then(|()| Range::of(self).check(ray))
    }
}
