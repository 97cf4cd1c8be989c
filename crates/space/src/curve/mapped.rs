//! Affine image of a curve: a curve in the frame of a placed solid.

use crate::{Curve, Point};
use rayweave_math::{Affine, Vec3};

/// The image of a curve in space, at the same times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapped<C> {
    curve: C,
    map: Affine,
    /// Upper bound of the factor by which the map lengthens a vector.
    norm: f64,
}

impl<C: Curve<3>> Mapped<C> {
    /// The curve `map(r(t))`; `curve` may be a reference.
    pub fn new(curve: C, map: Affine) -> Mapped<C> {
        let norm = map.similarity().unwrap_or_else(|| map.linear_norm());
        Mapped { curve, map, norm }
    }
}

impl<C: Curve<3>> Curve<3> for Mapped<C> {
    fn position(&self, t: f64) -> Point<3> {
        self.map.point(Vec3::from_array(self.curve.position(t))).to_array()
    }

    fn velocity(&self, t: f64) -> Point<3> {
        self.map.vector(Vec3::from_array(self.curve.velocity(t))).to_array()
    }

    fn acceleration_bound(&self, t0: f64, t1: f64) -> f64 {
        self.norm * self.curve.acceleration_bound(t0, t1)
    }

    fn domain(&self) -> (f64, f64) {
        self.curve.domain()
    }

    fn size(&self, t: f64) -> f64 {
        self.norm * self.curve.size(t) + self.map.translation.length()
    }
}
