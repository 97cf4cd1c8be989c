//! Helix, the path of a charged particle in a uniform magnetic field.
//!
//! The equation of motion is `r'' = w r' x b` with b the unit vector of the field and w = q B / m the signed gyrofrequency
//! (J. D. Jackson, *Classical Electrodynamics*, 3rd ed. (1999), section 12.2; in the relativistic case m is the
//! relativistic mass, which a magnetic field does not change). With v0 split into `v_b` along and `v_p` perpendicular to
//! the field and `n = v_p x b`, the solution is
//!
//! `r(t) = r0 + t v_b + (sin(w t) / w) v_p + ((1 - cos(w t)) / w) n`.
//!
//! Both factors are computed as `t sinc(w t)` and `t sin(w t / 2) sinc(w t / 2)` with `sinc x = sin(x) / x`, which are accurate
//! for any w: w = 0 gives a straight line, a velocity perpendicular to the field a circle.

use crate::curve::vector::{self, Direction};
use crate::point::{add_scaled, length};
use crate::{Curve, CurveError, Point};

/// The helical motion of a charged particle. A particle of positive frequency turns clockwise as
/// seen against the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Helix {
    position: Point<3>,
    parallel: Point<3>,
    across: Point<3>,
    /// `v_p x b`, the direction of the acceleration at the start times `|v_p|`.
    normal: Point<3>,
    frequency: f64,
}

impl Helix {
    /// The particle at `position` with `velocity` at t = 0, in a field along `axis` (of any nonzero length), with the
    /// signed gyrofrequency `q B / m` in radians per unit of t.
    ///
    /// # Errors
    /// A number is NaN or infinite, or the axis is zero.
    pub fn new(
        position: Point<3>,
        velocity: Point<3>,
        axis: Point<3>,
        frequency: f64,
    ) -> Result<Helix, CurveError> {
        vector::finite("position", &position)?;
        vector::finite("velocity", &velocity)?;
        vector::finite("frequency", &[frequency])?;
        let axis = Direction::new("axis", &axis)?;
        let across = axis.across(&velocity);
        let normal = axis.cross(&across).map(|x| -x);
        Ok(Helix { position, parallel: axis.times(axis.dot(&velocity)), across, normal, frequency })
    }

    /// Like [`Helix::new`], with the signed gyroradius `|v_p| / w` instead of the frequency. Infinity is a straight line.
    ///
    /// # Errors
    /// As for [`Helix::new`]; the radius is NaN or 0.
    pub fn with_radius(
        position: Point<3>,
        velocity: Point<3>,
        axis: Point<3>,
        radius: f64,
    ) -> Result<Helix, CurveError> {
        if radius.is_nan() || radius == 0.0 {
            let why = "it must not be 0; use infinity for a straight line";
            return Err(CurveError::InvalidArgument { what: "radius", why });
        }
        let straight = Helix::new(position, velocity, axis, 0.0)?;
        let frequency = length(&straight.across) / radius;
        vector::finite("radius", &[frequency])?;
        Ok(Helix { frequency, ..straight })
    }

    /// The right-handed helix from `start` around the line through `centre` along `axis`, with a rise of `pitch` per turn, which takes
    /// 2 pi in t. A pitch of 0 gives a circle, a negative one a left-handed helix.
    ///
    /// # Errors
    /// A number is NaN or infinite, or the axis is zero.
    pub fn about(centre: Point<3>, axis: Point<3>, start: Point<3>, pitch: f64) -> Result<Helix, CurveError> {
        vector::finite("centre", &centre)?;
        vector::finite("start", &start)?;
        vector::finite("pitch", &[pitch])?;
        let direction = Direction::new("axis", &axis)?;
        let from: Point<3> = std::array::from_fn(|k| start[k] - centre[k]);
        let rise = direction.times(pitch / std::f64::consts::TAU);
        Helix::new(start, add_scaled(&direction.cross(&from), 1.0, &rise), axis, -1.0)
    }

    /// The signed gyrofrequency, in radians per unit of t.
    pub fn frequency(&self) -> f64 {
        self.frequency
    }

    /// The gyroradius without sign; infinite for a straight line.
    pub fn radius(&self) -> f64 {
        length(&self.across) / self.frequency.abs()
    }
}

/// `sin(x) / x`; 1 at 0.
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { libm::sin(x) / x }
}

impl Curve<3> for Helix {
    fn position(&self, t: f64) -> Point<3> {
        let angle = self.frequency * t;
        let (forward, sideways) = (sinc(angle), libm::sin(0.5 * angle) * sinc(0.5 * angle));
        std::array::from_fn(|k| {
            let mean = self.parallel[k] + forward * self.across[k] + sideways * self.normal[k];
            self.position[k] + t * mean
        })
    }

    fn velocity(&self, t: f64) -> Point<3> {
        let (sin, cos) = libm::sincos(self.frequency * t);
        std::array::from_fn(|k| self.parallel[k] + cos * self.across[k] + sin * self.normal[k])
    }

    fn acceleration_bound(&self, _: f64, _: f64) -> f64 {
        self.frequency.abs() * length(&self.across)
    }

    fn size(&self, t: f64) -> f64 {
        // the rounding error u |w t| of the angle moves the point by u |t v_p|
        length(&self.position) + t.abs() * (length(&self.parallel) + length(&self.across))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constructors_agree() {
        let by_radius = Helix::with_radius([1.0, 0.0, 0.0], [0.0, 2.0, 1.0], [0.0, 0.0, 3.0], -1.0).unwrap();
        let wound = Helix::about([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], std::f64::consts::PI).unwrap();
        assert_eq!((by_radius.frequency(), wound.frequency()), (-2.0, -1.0));
        for k in 0..50 {
            let t = 0.3 * f64::from(k);
            let want = [libm::cos(t), libm::sin(t), 0.5 * t];
            for (got, at) in [(by_radius.position(0.5 * t), want), (wound.position(t), want)] {
                assert!((0..3).all(|k| (got[k] - at[k]).abs() < 1e-14), "{got:?} {at:?}");
            }
        }
    }

    #[test]
    fn frequency_zero_is_a_line_and_invalid_arguments_are_named() {
        let slow = |w: f64| Helix::new([1.0, 2.0, 3.0], [0.5, -1.0, 0.25], [1.0, 1.0, 0.0], w).unwrap();
        assert_eq!(slow(0.0).position(8.0), [5.0, -6.0, 5.0]);
        // 1 - cos(w t) would cancel completely; the sideways displacement is w t^2 / 2 |v_p|
        let sideways = slow(1e-9).position(1.0)[2] - slow(0.0).position(1.0)[2];
        assert!(sideways != 0.0 && sideways.abs() < 1e-8);
        let bad = Helix::new([0.0; 3], [1.0; 3], [0.0; 3], 1.0);
        assert!(matches!(bad, Err(CurveError::InvalidArgument { what: "axis", .. })), "{bad:?}");
        let bad = Helix::with_radius([0.0; 3], [1.0; 3], [1.0; 3], 0.0);
        assert!(matches!(bad, Err(CurveError::InvalidArgument { what: "radius", .. })), "{bad:?}");
        assert!(Helix::with_radius([0.0; 3], [1.0; 3], [1.0; 3], f64::INFINITY).is_ok());
    }
}
