//! A torus around z, centred at the origin.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `major` | a number | length | finite and greater than 0 |  | radius of the circle in the middle of the tube |
//! | `minor` | a number | length | finite and greater than 0 |  | radius of the tube |
//!
//! Inside: `(sqrt(x^2 + y^2) - major)^2 + z^2 < minor^2`.
//!
//! Face: `side`.
//!
//! The solid is the set of points nearer than `minor` to the circle: with `major` > `minor` a ring torus, with
//! `major` = `minor` a horn torus, whose hole is a point, and with `major` < `minor` a spindle torus without a hole,
//! whose lemon is filled. The face of a spindle torus is only its outer skin.
//!
//! Volume: 2 pi^2 major minor^2 for a ring (Pappus). For a spindle torus it is that of the half disc of the section
//! beyond the axis, revolved: 4 pi (major (pi m^2/4 + major h/2 + m^2/2 asin(major/m)) + h^3/3) with m = minor and h
//! = sqrt(m^2 - major^2), the height at which the skin meets the axis.

use super::shape::between;
use super::{Arguments, Facet, Lowered, Parameter, ParameterUnit, Range, Shape, ShapeError, Value};
use crate::surface::Surface;
use rayweave_math::{Bounds, Vec3};
use std::f64::consts::PI;

/// A torus around z: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    major: f64,
    minor: f64,
}

impl Torus {
    /// The solid of points nearer than `minor` to the circle of radius `major` about z.
    pub fn new(major: f64, minor: f64) -> Result<Torus, ShapeError> {
        Torus { major, minor }.validated()
    }
}

impl Shape for Torus {
    const NAME: &'static str = "torus";
    const EQUATION: &'static str = "(sqrt(x^2 + y^2) - major)^2 + z^2 < minor^2";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::number(
            "major",
            ParameterUnit::Length,
            Range::Positive,
            "radius of the circle in the middle of the tube",
        ),
        Parameter::number("minor", ParameterUnit::Length, Range::Positive, "radius of the tube"),
    ];
    const FACES: &'static [&'static str] = &["side"];

    fn from_arguments(arguments: &Arguments) -> Result<Torus, ShapeError> {
        Torus::new(arguments.number("major"), arguments.number("minor"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("major", self.major.into()), ("minor", self.minor.into())]
    }

    fn lower(&self) -> Lowered {
        let surface = Surface::torus(Vec3::ZERO, Vec3::Z, self.major, self.minor);
        let around = self.major + self.minor;
        Lowered::conjunction(
            vec![Facet::inside("side", surface)],
            Bounds::centred(Vec3::ZERO, Vec3::new(around, around, self.minor)),
        )
    }

    fn volume(&self) -> Option<f64> {
        let square = self.minor * self.minor;
        if self.major >= self.minor {
            return Some(2.0 * PI * PI * self.major * square);
        }
        let h = ((self.minor - self.major) * (self.minor + self.major)).sqrt();
        let section =
            0.25 * PI * square + 0.5 * self.major * h + 0.5 * square * libm::asin(self.major / self.minor);
        Some(4.0 * PI * (self.major * section + h * h * h / 3.0))
    }

    fn example() -> Torus {
        Torus { major: 0.8, minor: 0.3 }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Torus {
        let minor = between(rng, 0.15, 0.6);
        let ratio = match (8.0 * rng()) as u32 {
            0 => 1.0,
            1 => between(rng, 0.3, 1.0),
            _ => between(rng, 1.0, 3.0),
        };
        Torus { major: ratio * minor, minor }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, check_volume, message};
    use super::*;

    /// Reference by the distance from the circle.
    fn inside(major: f64, minor: f64, p: Vec3) -> bool {
        (p.x.hypot(p.y) - major).hypot(p.z) < minor
    }

    #[test]
    fn rings_horns_and_spindles_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            for (major, minor) in [(1.0, 0.3), (1.0, 0.95), (0.7, 0.7), (0.4, 0.8), (0.01, 1.0)] {
                let (major, minor) = (scale * major, scale * minor);
                let solid = Torus::new(major, minor).unwrap();
                let size = major + minor;
                check_inside(&solid, 1.1 * Vec3::new(size, size, minor), |p| inside(major, minor, p));
                check_volume(&solid);
                // each half of the section is convex, and is tested from its own centre
                let middle = Vec3::X * major;
                let lowered = solid.lower();
                assert_eq!(lowered.bounds.hi, Vec3::new(size, size, minor));
                for edge in [middle + Vec3::X * minor, middle + Vec3::Z * minor] {
                    assert!(lowered.contains(edge + (middle - edge) * 1e-9));
                }
            }
        }
    }

    #[test]
    fn a_spindle_of_no_major_radius_is_nearly_a_ball() {
        let solid = Torus::new(1e-12, 1.0).unwrap();
        let ball = 4.0 / 3.0 * PI;
        assert!((solid.volume().unwrap() - ball).abs() < 1e-10);
        let axes = Vec3::AXES.map(|axis| axis * solid.lower().bounds.hi);
        check_touched(&solid, Vec3::ZERO, &[axes, axes.map(|p| -p)].concat());
    }

    #[test]
    fn the_lemon_is_filled() {
        let lowered = Torus::new(0.5, 1.0).unwrap().lower();
        let skin = 0.75f64.sqrt();
        assert!(lowered.contains(Vec3::ZERO));
        assert!(lowered.contains(Vec3::Z * (skin - 1e-9)) && !lowered.contains(Vec3::Z * (skin + 1e-9)));
        assert!(lowered.contains(Vec3::new(0.49, 0.0, 0.99)));
    }

    #[test]
    fn volumes_agree_where_the_formulas_meet() {
        let (ring, spindle) = (Torus::new(1.0, 1.0).unwrap(), Torus::new(1.0, 1.0 + 1e-9).unwrap());
        assert!((ring.volume().unwrap() / spindle.volume().unwrap() - 1.0).abs() < 3e-9);
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Torus::new(1.0, 0.0)),
            "torus: minor is 0: minor must be finite and greater than 0."
        );
        assert_eq!(
            message(Torus::new(-1.0, 0.5)),
            "torus: major is -1: major must be finite and greater than 0. Did you mean 1?"
        );
    }
}
