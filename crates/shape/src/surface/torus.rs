//! Torus: the points at distance `minor` from a circle of radius `major`, with the inside nearer to the circle.
//!
//! `g = (rho - major)^2 + z^2 - minor^2` with rho the distance from the axis and z the height. For `major < minor` (a
//! spindle torus) the balls about the circle overlap and fill the lemon in the middle, so it is solid. The quartic
//! `g (g + 4 major rho)` also vanishes on the lemon's skin, and in a thin torus it loses as many digits as
//! `(major / minor)^2` has. Neither is true of g, so roots are found from g.

use super::Surface;
use super::affine_torus::AffineTorus;
use super::along::{Departure, recentred};
use super::torus_line::TorusLine;
use crate::Ray;
use rayweave_math::roots::Crossings;
use rayweave_math::{Bounds, Transform, Vec3, unit};

/// A torus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// The centre.
    pub centre: Vec3,
    /// Unit vector along the axis of revolution; both senses describe the same torus.
    pub axis: Vec3,
    /// Radius of the centre circle of the tube, > 0.
    pub major: f64,
    /// Radius of the tube, > 0.
    pub minor: f64,
}

impl Torus {
    /// The torus about `centre` with its axis along `axis`, which need not have unit length.
    pub fn new(centre: Vec3, axis: Vec3, major: f64, minor: f64) -> Torus {
        Torus { centre, axis: unit(axis), major, minor }
    }

    /// At most four roots, computed about the closest approach to the centre. The lane form is in `lanes/torus.rs`; both give
    /// the same bits, tested by `tests/lanes.rs`.
    pub fn crossings(&self, ray: &Ray) -> Crossings<4> {
        let (shift, q) = recentred(ray, self.centre);
        self.crossings_about(shift, q, ray.direction)
    }

    /// The roots from a point of the ray relative to the centre, and its time.
    pub(super) fn crossings_about(&self, shift: f64, q: Vec3, d: Vec3) -> Crossings<4> {
        let (line, rate) = TorusLine::new(self, q, d);
        let mut times = line.sign_changes();
        for t in times.found_mut() {
            *t = shift + *t / rate;
        }
        Crossings::new(false, times.found())
    }

    /// Departure of a ray that starts on the torus.
    pub(super) fn departure(&self, ray: &Ray) -> Departure {
        self.departure_from(ray.origin - self.centre, ray.direction)
    }

    pub(super) fn departure_from(&self, q: Vec3, d: Vec3) -> Departure {
        let (line, rate) = TorusLine::new(self, q, d);
        let mut times = line.sign_changes_from_start();
        for t in times.found_mut() {
            *t /= rate;
        }
        // far away the ray is outside, so the parity of the remaining roots gives the side just after the start
        let inside = times.found().len() % 2 == 1;
        Departure { negative_after: Some(inside), times: Crossings::new(inside, times.found()) }
    }

    /// `(rho - major)^2 + z^2 - minor^2` and its gradient. On the axis g has a ridge, and the gradients of both sides
    /// cancel across it.
    pub fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        self.value_and_gradient_on_axis(point, Vec3::ZERO)
    }

    /// The value and the gradient of one side of the ridge, whose length is twice the distance from the centre circle
    /// everywhere. (At the pinch of a horn torus, `major = minor`, the gradients of both sides cancel to 0.)
    pub fn value_and_steepest(&self, point: Vec3) -> (f64, Vec3) {
        self.value_and_gradient_on_axis(point, self.axis.any_orthonormal_vector())
    }

    /// The value and gradient, with the direction away from the axis to be used on the axis.
    fn value_and_gradient_on_axis(&self, point: Vec3, away: Vec3) -> (f64, Vec3) {
        let q = point - self.centre;
        let z = self.axis.dot(q);
        let across = q - z * self.axis;
        let rho = across.length();
        let ring = rho - self.major;
        let outwards = if rho > 0.0 { across / rho } else { away };
        (ring * ring + z * z - self.minor * self.minor, 2.0 * (ring * outwards + z * self.axis))
    }

    pub(super) fn is_finite(&self) -> bool {
        self.centre.is_finite() && self.axis.is_finite() && self.major.is_finite() && self.minor.is_finite()
    }

    /// Distance of the centre from the origin plus the outer radius.
    pub fn magnitude(&self) -> f64 {
        self.centre.length() + self.size()
    }

    /// The outer radius.
    pub(super) fn size(&self) -> f64 {
        self.major + self.minor
    }

    /// Support function: the largest value of `n . (p - centre)` in the torus.
    pub(super) fn support(&self, n: Vec3) -> f64 {
        let across = n - self.axis.dot(n) * self.axis;
        self.major * across.length() + self.minor * n.length()
    }

    /// Smallest bounding box.
    pub fn inside_bounds(&self) -> Bounds {
        let half = Vec3::from_array(Vec3::AXES.map(|n| self.support(n)));
        Bounds::centred(self.centre, half)
    }

    /// The image: a torus under a similarity, else an affine torus.
    pub fn transformed(&self, to: &Transform) -> Surface {
        let map = &to.world_from_local;
        match map.similarity() {
            Some(scale) => Surface::Torus(Torus::new(
                map.point(self.centre),
                map.vector(self.axis),
                scale * self.major,
                scale * self.minor,
            )),
            None => AffineTorus::of(self).transformed(to),
        }
    }
}
