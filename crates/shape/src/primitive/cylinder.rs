//! A round cylinder along z, centred at the origin.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `radius` | a number | length | finite and greater than 0 |  | distance of the side from the axis |
//! | `height` | a number | length | greater than 0, or inf | inf | whole extent along z |
//!
//! Inside: `x^2 + y^2 < radius^2, |z| < height/2`.
//!
//! Faces: `side`, `bottom` (z = -height/2) and `top` (z = height/2).
//!
//! The default height is infinite: the cylinder then has no ends, and its only face is `side`.
//!
//! Volume: pi radius^2 height.

use super::lowered::{caps, pillar};
use super::shape::between;
use super::{Arguments, Facet, Lowered, Parameter, ParameterUnit, Range, Shape, ShapeError, Value};
use crate::surface::Surface;
use rayweave_math::Vec3;
use std::f64::consts::PI;

/// A cylinder along z: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    radius: f64,
    height: f64,
}

impl Cylinder {
    /// The cylinder with this radius and height; the height may be infinite.
    pub fn new(radius: f64, height: f64) -> Result<Cylinder, ShapeError> {
        Cylinder { radius, height }.validated()
    }
}

impl Shape for Cylinder {
    const NAME: &'static str = "cylinder";
    const EQUATION: &'static str = "x^2 + y^2 < radius^2, |z| < height/2";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::number(
            "radius",
            ParameterUnit::Length,
            Range::Positive,
            "distance of the side from the axis",
        ),
        Parameter::number("height", ParameterUnit::Length, Range::PositiveOrInfinite, "whole extent along z")
            .or(f64::INFINITY),
    ];
    const FACES: &'static [&'static str] = &["side", "bottom", "top"];

    fn from_arguments(arguments: &Arguments) -> Result<Cylinder, ShapeError> {
        Cylinder::new(arguments.number("radius"), arguments.number("height"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("radius", self.radius.into()), ("height", self.height.into())]
    }

    fn lower(&self) -> Lowered {
        let surface = Surface::cylinder(Vec3::ZERO, Vec3::Z, self.radius);
        let mut facets = vec![Facet::inside("side", surface)];
        facets.extend(caps(self.height));
        Lowered::conjunction(facets, pillar(self.radius, self.height))
    }

    fn volume(&self) -> Option<f64> {
        Some(PI * self.radius * self.radius * self.height)
    }

    fn example() -> Cylinder {
        Cylinder { radius: 0.7, height: 1.8 }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Cylinder {
        let radius = between(rng, 0.3, 1.2);
        let height = match rng() < 0.2 {
            true => f64::INFINITY,
            false => between(rng, 0.4, 2.5),
        };
        Cylinder { radius, height }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, check_volume, message};
    use super::*;
    use crate::primitive::build;

    #[test]
    fn a_cylinder_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let (radius, height) = (0.4 * scale, 3.0 * scale);
            let solid = Cylinder::new(radius, height).unwrap();
            check_inside(&solid, scale * Vec3::new(0.5, 0.5, 2.0), |p| {
                p.x.hypot(p.y) < radius && 2.0 * p.z.abs() < height
            });
            let rim = [(1.0, 0.0, -0.5), (-1.0, 0.0, 0.5), (0.0, 1.0, 0.5), (0.0, -1.0, -0.5)];
            let rim = rim.map(|(x, y, z)| Vec3::new(radius * x, radius * y, height * z));
            check_touched(&solid, Vec3::ZERO, &rim);
            check_volume(&solid);
        }
    }

    #[test]
    fn without_a_height_it_has_no_ends() {
        let endless = Cylinder::new(0.5, f64::INFINITY).unwrap();
        assert_eq!(build("cylinder", &[("radius", 0.5.into())]), Ok(endless.into()));
        assert_eq!(endless.lower().facets.len(), 1);
        assert!(endless.lower().contains(Vec3::new(0.3, 0.3, 1e30)));
        assert_eq!(endless.lower().bounds.hi, Vec3::new(0.5, 0.5, f64::INFINITY));
        assert_eq!(endless.volume(), Some(f64::INFINITY));
        check_inside(&endless, Vec3::ONE, |p| p.x.hypot(p.y) < 0.5);
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Cylinder::new(1.0, -2.0)),
            "cylinder: height is -2: height must be greater than 0, or inf. Did you mean 2?"
        );
        assert_eq!(
            message(Cylinder::new(f64::INFINITY, 1.0)),
            "cylinder: radius is inf: radius must be finite and greater than 0."
        );
    }
}
