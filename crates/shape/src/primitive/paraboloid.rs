//! A paraboloid of revolution around z that opens upwards from the origin.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `focal_length` | a number | length | finite and greater than 0 |  | height of the focus above the vertex |
//! | `height` | a number | length | greater than 0, or inf | inf | height of the end above the vertex |
//!
//! Inside: `x^2 + y^2 < 4 focal_length z, z < height`.
//!
//! Faces: `side` and `top` (z = height).
//!
//! The vertex is the origin, the focus (0, 0, focal_length). The default height is infinite: the solid then has no
//! face `top`.
//!
//! Volume: 2 pi focal_length height^2, half of the cylinder around it (Archimedes, *On Conoids and
//! Spheroids*).

use super::shape::between;
use super::{Arguments, Facet, Lowered, Parameter, ParameterUnit, Range, Shape, ShapeError, Value};
use crate::surface::Surface;
use rayweave_math::{Bounds, Mat3, Vec3};
use std::f64::consts::PI;

/// A paraboloid around z: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paraboloid {
    focal_length: f64,
    height: f64,
}

impl Paraboloid {
    /// The paraboloid with this focal length, up to the given height, which may be infinite.
    pub fn new(focal_length: f64, height: f64) -> Result<Paraboloid, ShapeError> {
        Paraboloid { focal_length, height }.validated()
    }
}

impl Shape for Paraboloid {
    const NAME: &'static str = "paraboloid";
    const EQUATION: &'static str = "x^2 + y^2 < 4 focal_length z, z < height";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::number(
            "focal_length",
            ParameterUnit::Length,
            Range::Positive,
            "height of the focus above the vertex",
        ),
        Parameter::number(
            "height",
            ParameterUnit::Length,
            Range::PositiveOrInfinite,
            "height of the end above the vertex",
        )
        .or(f64::INFINITY),
    ];
    const FACES: &'static [&'static str] = &["side", "top"];

    fn from_arguments(arguments: &Arguments) -> Result<Paraboloid, ShapeError> {
        Paraboloid::new(arguments.number("focal_length"), arguments.number("height"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("focal_length", self.focal_length.into()), ("height", self.height.into())]
    }

    fn lower(&self) -> Lowered {
        let surface = Surface::quadric_about(
            Vec3::ZERO,
            Mat3::from_diagonal(Vec3::new(1.0, 1.0, 0.0)),
            Vec3::new(0.0, 0.0, -4.0 * self.focal_length),
            0.0,
        );
        let mut facets = vec![Facet::inside("side", surface)];
        if self.height.is_finite() {
            facets.push(Facet::inside("top", Surface::plane(Vec3::Z, self.height)));
        }
        let radius = 2.0 * (self.focal_length * self.height).sqrt();
        let lo = Vec3::new(-radius, -radius, 0.0);
        Lowered::conjunction(facets, Bounds::new(lo, Vec3::new(radius, radius, self.height)))
    }

    fn volume(&self) -> Option<f64> {
        Some(2.0 * PI * self.focal_length * self.height * self.height)
    }

    fn example() -> Paraboloid {
        Paraboloid { focal_length: 0.25, height: 1.0 }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Paraboloid {
        let focal_length = between(rng, 0.05, 0.6);
        let height = match rng() < 0.2 {
            true => f64::INFINITY,
            false => between(rng, 0.3, 1.5),
        };
        Paraboloid { focal_length, height }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, check_volume, message};
    use super::*;
    use crate::primitive::build;

    #[test]
    fn paraboloids_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            for (focal_length, height) in
                [(0.25 * scale, scale), (1e-3 * scale, 2.0 * scale), (3.0 * scale, scale)]
            {
                let solid = Paraboloid::new(focal_length, height).unwrap();
                let radius = 2.0 * (focal_length * height).sqrt();
                // nearer to the focus than to the directrix
                check_inside(&solid, 1.1 * Vec3::new(radius, radius, height), |p| {
                    let focus = Vec3::new(0.0, 0.0, focal_length);
                    (p - focus).length() < p.z + focal_length && p.z < height
                });
                let rim = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y].map(|v| v * radius + Vec3::Z * height);
                check_touched(&solid, Vec3::Z * (0.5 * height), &[&rim[..], &[Vec3::ZERO]].concat());
                check_volume(&solid);
            }
        }
    }

    #[test]
    fn without_a_height_it_has_no_top() {
        let endless = Paraboloid::new(0.25, f64::INFINITY).unwrap();
        assert_eq!(build("paraboloid", &[("focal_length", 0.25.into())]), Ok(endless.into()));
        let lowered = endless.lower();
        assert_eq!((lowered.facets.len(), lowered.bounds.lo.z), (1, 0.0));
        assert_eq!(lowered.bounds.hi, Vec3::INFINITY);
        check_inside(&endless, Vec3::ONE, |p| p.x * p.x + p.y * p.y < p.z);
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Paraboloid::new(0.0, 1.0)),
            "paraboloid: focal_length is 0: focal_length must be finite and greater than 0."
        );
    }
}
