//! A ball stretched along the axes, centred at the origin.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `radii` | a list of 3 numbers | length | finite and greater than 0 |  | half axes along x, y and z |
//!
//! Inside: `(x/radii[0])^2 + (y/radii[1])^2 + (z/radii[2])^2 < 1`.
//!
//! Face: `side`.
//!
//! With three equal radii the solid is a sphere, with a bit-identical face.
//!
//! Volume: 4/3 pi radii\[0\] radii\[1\] radii\[2\], the affine image of the unit ball.

use super::shape::between;
use super::{
    Arguments, Facet, Lowered, Parameter, ParameterKind, ParameterUnit, Range, Shape, ShapeError, Value,
};
use crate::surface::Surface;
use rayweave_math::{Bounds, Mat3, Vec3};
use std::f64::consts::PI;

/// A stretched ball centred at the origin: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    radii: Vec3,
}

impl Ellipsoid {
    /// The ellipsoid with these half axes.
    pub fn new(radii: Vec3) -> Result<Ellipsoid, ShapeError> {
        Ellipsoid { radii }.validated()
    }

    /// The equation times the square of the smallest radius, to avoid over- and underflow.
    fn surface(&self) -> Surface {
        let smallest = self.radii.min_element();
        if smallest == self.radii.max_element() {
            return Surface::sphere(Vec3::ZERO, smallest);
        }
        let ratios = Vec3::splat(smallest) / self.radii;
        Surface::quadric_about(
            Vec3::ZERO,
            Mat3::from_diagonal(ratios * ratios),
            Vec3::ZERO,
            -(smallest * smallest),
        )
    }
}

impl Shape for Ellipsoid {
    const NAME: &'static str = "ellipsoid";
    const EQUATION: &'static str = "(x/radii[0])^2 + (y/radii[1])^2 + (z/radii[2])^2 < 1";
    const PARAMETERS: &'static [Parameter] = &[Parameter::new(
        "radii",
        ParameterKind::Vector3,
        ParameterUnit::Length,
        Range::Positive,
        "half axes along x, y and z",
    )];
    const FACES: &'static [&'static str] = &["side"];

    fn from_arguments(arguments: &Arguments) -> Result<Ellipsoid, ShapeError> {
        Ellipsoid::new(arguments.vector("radii"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("radii", self.radii.into())]
    }

    fn lower(&self) -> Lowered {
        Lowered::conjunction(
            vec![Facet::inside("side", self.surface())],
            Bounds::centred(Vec3::ZERO, self.radii),
        )
    }

    fn volume(&self) -> Option<f64> {
        Some(4.0 / 3.0 * PI * self.radii.x * self.radii.y * self.radii.z)
    }

    fn example() -> Ellipsoid {
        Ellipsoid { radii: Vec3::new(1.2, 0.8, 0.5) }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Ellipsoid {
        Ellipsoid { radii: Vec3::ZERO.map(|_| between(rng, 0.3, 1.5)) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, check_volume, message};
    use super::*;
    use crate::primitive::Sphere;

    #[test]
    fn an_ellipsoid_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let radii = scale * Vec3::new(0.5, 2.0, 1.0);
            let solid = Ellipsoid::new(radii).unwrap();
            check_inside(&solid, 1.1 * radii, |p| (p / radii).length() < 1.0);
            let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| radii * axis);
            check_touched(&solid, Vec3::ZERO, &[axes, axes.map(|p| -p)].concat());
            check_volume(&solid);
        }
    }

    #[test]
    fn needles_and_pancakes() {
        for radii in [Vec3::new(1e-6, 1.0, 1e-6), Vec3::new(1e4, 1e4, 1e-4)] {
            let solid = Ellipsoid::new(radii).unwrap();
            check_inside(&solid, 1.1 * radii, |p| (p / radii).length() < 1.0);
        }
    }

    #[test]
    fn equal_radii_are_the_sphere() {
        let ball = Ellipsoid::new(Vec3::splat(0.3)).unwrap();
        assert_eq!(ball.lower(), Sphere::new(0.3).unwrap().lower());
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Ellipsoid::new(Vec3::new(1.0, 0.0, 1.0))),
            "ellipsoid: radii[1] is 0: radii must be finite and greater than 0."
        );
    }
}
