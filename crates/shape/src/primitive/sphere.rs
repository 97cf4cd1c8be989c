//! A ball centred at the origin.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `radius` | a number | length | finite and greater than 0 |  | distance of the surface from the centre |
//!
//! Inside: `x^2 + y^2 + z^2 < radius^2`.
//!
//! Face: `side`.
//!
//! Volume: 4/3 pi radius^3 (Archimedes, *On the Sphere and Cylinder*).

use super::shape::between;
use super::{Arguments, Facet, Lowered, Parameter, ParameterUnit, Range, Shape, ShapeError, Value};
use crate::surface::Surface;
use rayweave_math::{Bounds, Vec3};
use std::f64::consts::PI;

/// A ball centred at the origin: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    radius: f64,
}

impl Sphere {
    /// The ball with this radius.
    pub fn new(radius: f64) -> Result<Sphere, ShapeError> {
        Sphere { radius }.validated()
    }
}

impl Shape for Sphere {
    const NAME: &'static str = "sphere";
    const EQUATION: &'static str = "x^2 + y^2 + z^2 < radius^2";
    const PARAMETERS: &'static [Parameter] = &[Parameter::number(
        "radius",
        ParameterUnit::Length,
        Range::Positive,
        "distance of the surface from the centre",
    )];
    const FACES: &'static [&'static str] = &["side"];

    fn from_arguments(arguments: &Arguments) -> Result<Sphere, ShapeError> {
        Sphere::new(arguments.number("radius"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("radius", self.radius.into())]
    }

    fn lower(&self) -> Lowered {
        let surface = Surface::sphere(Vec3::ZERO, self.radius);
        Lowered::conjunction(
            vec![Facet::inside("side", surface)],
            Bounds::centred(Vec3::ZERO, Vec3::splat(self.radius)),
        )
    }

    fn volume(&self) -> Option<f64> {
        Some(4.0 / 3.0 * PI * self.radius * self.radius * self.radius)
    }

    fn example() -> Sphere {
        Sphere { radius: 1.0 }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Sphere {
        Sphere { radius: between(rng, 0.3, 1.5) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, check_volume, message};
    use super::*;

    #[test]
    fn a_ball_at_every_scale() {
        for radius in [1e-8, 0.7, 1e8] {
            let ball = Sphere::new(radius).unwrap();
            check_inside(&ball, Vec3::splat(1.2 * radius), |p| p.length() < radius);
            let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| radius * axis);
            check_touched(&ball, Vec3::ZERO, &[axes, axes.map(|p| -p)].concat());
            check_volume(&ball);
        }
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Sphere::new(-1.0)),
            "sphere: radius is -1: radius must be finite and greater than 0. Did you mean 1?"
        );
        assert_eq!(
            message(Sphere::new(0.0)),
            "sphere: radius is 0: radius must be finite and greater than 0."
        );
    }
}
