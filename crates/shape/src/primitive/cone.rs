//! A cone or a frustum along z, centred at the origin.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `radius1` | a number | length | finite and at least 0 |  | radius at z = -height/2 |
//! | `radius2` | a number | length | finite and at least 0 |  | radius at z = height/2 |
//! | `height` | a number | length | finite and greater than 0 |  | whole extent along z |
//!
//! Inside: `x^2 + y^2 < (radius1 + (radius2 - radius1) (z/height + 1/2))^2, |z| < height/2`.
//!
//! Faces: `side`, `bottom` (z = -height/2) and `top` (z = height/2).
//!
//! One radius may be 0: that end is the apex, and the face there is only a point. With two equal radii the solid is a
//! cylinder, with bit-identical faces.
//!
//! Volume: pi height (radius1^2 + radius1 radius2 + radius2^2) / 3 (the frustum of Heron, *Metrica* II).

use super::lowered::{caps, pillar};
use super::shape::between;
use super::{Arguments, Facet, Lowered, Parameter, ParameterUnit, Range, Shape, ShapeError, Value};
use crate::surface::Surface;
use rayweave_math::{Mat3, Vec3};
use std::f64::consts::PI;

/// A cone or a frustum along z: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    radius1: f64,
    radius2: f64,
    height: f64,
}

impl Cone {
    /// The cone with `radius1` at z = -height/2 and `radius2` at z = height/2.
    pub fn new(radius1: f64, radius2: f64, height: f64) -> Result<Cone, ShapeError> {
        Cone { radius1, radius2, height }.validated()
    }

    /// The cylinder, or the double cone; the faces `bottom` and `top` cut a piece out of one nappe.
    fn side(&self) -> Surface {
        let slope = (self.radius2 - self.radius1) / self.height;
        if slope == 0.0 {
            return Surface::cylinder(Vec3::ZERO, Vec3::Z, self.radius1);
        }
        let (mean, size) =
            (0.5 * (self.radius1 + self.radius2), self.radius1.max(self.radius2).max(self.height));
        let apex = -mean / slope;
        if apex.abs() <= DISTANT * size {
            return Surface::cone(Vec3::new(0.0, 0.0, self.apex()), Vec3::Z, slope.abs());
        }
        // x^2 + y^2 < (mean + slope z)^2
        Surface::quadric_about(
            Vec3::ZERO,
            Mat3::from_diagonal(Vec3::new(1.0, 1.0, -slope * slope)),
            Vec3::new(0.0, 0.0, -2.0 * mean * slope),
            -mean * mean,
        )
    }

    /// The height at which the radius is 0, exact if that is an end.
    fn apex(&self) -> f64 {
        let sum = self.radius1 + self.radius2;
        0.5 * self.height * (sum / (self.radius1 - self.radius2))
    }
}

/// Distance of the apex, relative to the size, beyond which the side is written about the origin instead: the distance
/// would cost as many digits of the points near the frustum.
const DISTANT: f64 = 16.0;

impl Shape for Cone {
    const NAME: &'static str = "cone";
    const EQUATION: &'static str =
        "x^2 + y^2 < (radius1 + (radius2 - radius1) (z/height + 1/2))^2, |z| < height/2";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::number("radius1", ParameterUnit::Length, Range::NotNegative, "radius at z = -height/2"),
        Parameter::number("radius2", ParameterUnit::Length, Range::NotNegative, "radius at z = height/2"),
        Parameter::number("height", ParameterUnit::Length, Range::Positive, "whole extent along z"),
    ];
    const FACES: &'static [&'static str] = &["side", "bottom", "top"];

    fn from_arguments(arguments: &Arguments) -> Result<Cone, ShapeError> {
        Cone::new(arguments.number("radius1"), arguments.number("radius2"), arguments.number("height"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![
            ("radius1", self.radius1.into()),
            ("radius2", self.radius2.into()),
            ("height", self.height.into()),
        ]
    }

    fn consistent(&self) -> Result<(), ShapeError> {
        if self.radius1 > 0.0 || self.radius2 > 0.0 {
            return Ok(());
        }
        Err(ShapeError::BothZero { shape: Self::NAME, first: "radius1", second: "radius2" })
    }

    fn lower(&self) -> Lowered {
        let mut facets = vec![Facet::inside("side", self.side())];
        facets.extend(caps(self.height));
        Lowered::conjunction(facets, pillar(self.radius1.max(self.radius2), self.height))
    }

    fn volume(&self) -> Option<f64> {
        let (a, b) = (self.radius1, self.radius2);
        Some(PI * self.height * (a * a + a * b + b * b) / 3.0)
    }

    fn example() -> Cone {
        Cone { radius1: 0.9, radius2: 0.3, height: 1.6 }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Cone {
        let (a, b) = (between(rng, 0.2, 1.4), between(rng, 0.2, 1.4));
        let (radius1, radius2) = match (5.0 * rng()) as u32 {
            0 => (a, 0.0),
            1 => (0.0, b),
            _ => (a, b),
        };
        Cone { radius1, radius2, height: between(rng, 0.4, 2.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, check_volume, message};
    use super::*;
    use crate::primitive::Cylinder;

    fn check(radius1: f64, radius2: f64, height: f64) {
        let solid = Cone::new(radius1, radius2, height).unwrap();
        let radius = radius1.max(radius2);
        check_inside(&solid, 1.1 * Vec3::new(radius, radius, 0.5 * height), |p| {
            let limit = radius1 * (0.5 - p.z / height) + radius2 * (0.5 + p.z / height);
            p.x.hypot(p.y) < limit && 2.0 * p.z.abs() < height
        });
        let wide = if radius1 > radius2 { -0.5 } else { 0.5 } * height;
        let rim = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
        let rim = rim.map(|(x, y)| Vec3::new(radius * x, radius * y, wide));
        check_touched(&solid, Vec3::ZERO, &[&rim[..], &[Vec3::new(0.0, 0.0, -wide)]].concat());
        check_volume(&solid);
    }

    #[test]
    fn frustums_and_cones_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            check(scale, 0.4 * scale, 2.0 * scale);
            check(0.1 * scale, 2.0 * scale, 0.3 * scale);
            check(0.0, scale, scale);
            check(0.7 * scale, 0.0, 3.0 * scale);
        }
    }

    #[test]
    fn nearly_equal_radii_keep_their_digits() {
        for difference in [1e-3, 1e-6, 1e-10, 1e-15] {
            check(1.0, 1.0 + difference, 2.0);
        }
        let lowered = Cone::new(1.0, 1.0 + 1e-9, 2.0).unwrap().lower();
        let at = |x: f64, z: f64| lowered.contains(Vec3::new(x, 0.0, z));
        assert!(at(1.0 + 0.4e-9, 0.0) && !at(1.0 + 0.6e-9, 0.0));
        assert!(at(1.0 + 0.7e-9, 0.5) && !at(1.0 + 0.8e-9, 0.5));
    }

    /// The tolerance of a side depends on its size, wherever its apex is.
    #[test]
    fn the_reach_of_the_side_is_about_its_size() {
        for exponent in 0..16 {
            let solid = Cone::new(1.0, 1.0 + 10f64.powi(-exponent), 2.0).unwrap();
            assert!(solid.side().magnitude() < 40.0, "{:?}", solid.side());
        }
    }

    #[test]
    fn equal_radii_are_the_cylinder() {
        let (cone, rod) = (Cone::new(0.5, 0.5, 2.0).unwrap(), Cylinder::new(0.5, 2.0).unwrap());
        assert_eq!(cone.lower(), rod.lower());
    }

    #[test]
    fn the_apex_is_exact_and_the_other_nappe_is_cut_off() {
        let solid = Cone::new(0.1, 0.0, 0.3).unwrap();
        assert_eq!(solid.apex(), 0.15);
        assert_eq!(Cone::new(0.0, 0.7, 0.3).unwrap().apex(), -0.15);
        assert!(!solid.lower().contains(Vec3::new(0.0, 0.0, 0.2)));
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Cone::new(0.0, 0.0, 1.0)),
            "cone: radius1 and radius2 are both 0: the solid would be empty. Should one of them be positive?"
        );
        assert_eq!(
            message(Cone::new(1.0, 0.5, f64::INFINITY)),
            "cone: height is inf: height must be finite and greater than 0."
        );
        assert_eq!(
            message(Cone::new(-1.0, 0.5, 1.0)),
            "cone: radius1 is -1: radius1 must be finite and at least 0. Did you mean 1?"
        );
    }
}
