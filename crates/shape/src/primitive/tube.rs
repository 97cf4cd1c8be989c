//! A cylinder along z, centred at the origin, with a coaxial hole.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `outer_radius` | a number | length | finite and greater than 0 |  | distance of the outer side from the axis |
//! | `inner_radius` | a number | length | finite and at least 0 |  | distance of the wall of the hole from the axis |
//! | `height` | a number | length | greater than 0, or inf |  | whole extent along z |
//!
//! Inside: `inner_radius^2 < x^2 + y^2 < outer_radius^2, |z| < height/2`.
//!
//! Faces: `outer`, `inner`, `bottom` (z = -height/2) and `top` (z = height/2).
//!
//! The inner radius must be less than the outer one. If it is 0 there is no hole and no face `inner`; with an
//! infinite height there are no ends.
//!
//! Volume: pi (outer_radius^2 - inner_radius^2) height.

use super::lowered::{caps, pillar};
use super::parameter::check_increasing;
use super::shape::between;
use super::{Arguments, Facet, Lowered, Parameter, ParameterUnit, Range, Shape, ShapeError, Value};
use crate::surface::Surface;
use rayweave_math::Vec3;
use std::f64::consts::PI;

/// A cylinder along z with a coaxial hole: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tube {
    outer_radius: f64,
    inner_radius: f64,
    height: f64,
}

impl Tube {
    /// The tube between two radii; the height may be infinite.
    pub fn new(outer_radius: f64, inner_radius: f64, height: f64) -> Result<Tube, ShapeError> {
        Tube { outer_radius, inner_radius, height }.validated()
    }
}

impl Shape for Tube {
    const NAME: &'static str = "tube";
    const EQUATION: &'static str = "inner_radius^2 < x^2 + y^2 < outer_radius^2, |z| < height/2";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::number(
            "outer_radius",
            ParameterUnit::Length,
            Range::Positive,
            "distance of the outer side from the axis",
        ),
        Parameter::number(
            "inner_radius",
            ParameterUnit::Length,
            Range::NotNegative,
            "distance of the wall of the hole from the axis",
        ),
        Parameter::number("height", ParameterUnit::Length, Range::PositiveOrInfinite, "whole extent along z"),
    ];
    const FACES: &'static [&'static str] = &["outer", "inner", "bottom", "top"];

    fn from_arguments(arguments: &Arguments) -> Result<Tube, ShapeError> {
        Tube::new(
            arguments.number("outer_radius"),
            arguments.number("inner_radius"),
            arguments.number("height"),
        )
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![
            ("outer_radius", self.outer_radius.into()),
            ("inner_radius", self.inner_radius.into()),
            ("height", self.height.into()),
        ]
    }

    fn consistent(&self) -> Result<(), ShapeError> {
        let inner = ("inner_radius", self.inner_radius);
        let outer = ("outer_radius", self.outer_radius);
        check_increasing(Self::NAME, inner, outer, Vec::new())
    }

    fn lower(&self) -> Lowered {
        let wall = |radius| Surface::cylinder(Vec3::ZERO, Vec3::Z, radius);
        let mut facets = vec![Facet::inside("outer", wall(self.outer_radius))];
        if self.inner_radius > 0.0 {
            facets.push(Facet::outside("inner", wall(self.inner_radius)));
        }
        facets.extend(caps(self.height));
        Lowered::conjunction(facets, pillar(self.outer_radius, self.height))
    }

    fn volume(&self) -> Option<f64> {
        let (outer, inner) = (self.outer_radius, self.inner_radius);
        Some(PI * (outer - inner) * (outer + inner) * self.height)
    }

    fn example() -> Tube {
        Tube { outer_radius: 0.9, inner_radius: 0.6, height: 1.4 }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Tube {
        let outer_radius = between(rng, 0.4, 1.3);
        Tube {
            outer_radius,
            inner_radius: outer_radius * between(rng, 0.1, 0.9),
            height: between(rng, 0.3, 2.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, check_volume, message};
    use super::*;
    use crate::primitive::Cylinder;

    #[test]
    fn a_tube_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let (outer, inner, height) = (1.5 * scale, 0.9 * scale, 0.8 * scale);
            let solid = Tube::new(outer, inner, height).unwrap();
            check_inside(&solid, scale * Vec3::new(1.6, 1.6, 0.5), |p| {
                let distance = p.x.hypot(p.y);
                inner < distance && distance < outer && 2.0 * p.z.abs() < height
            });
            for axis in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y] {
                // the tube is not convex: each side is tested on its own
                let near = Tube::new(outer, inner, height).unwrap().lower();
                assert!(near.contains(axis * outer * (1.0 - 1e-12)));
                assert!(!near.contains(axis * inner * (1.0 - 1e-12)));
            }
            assert_eq!(solid.lower().bounds.hi, Vec3::new(outer, outer, 0.5 * height));
            check_volume(&solid);
        }
    }

    #[test]
    fn without_a_hole_it_is_a_cylinder() {
        let (full, rod) = (Tube::new(0.5, 0.0, 2.0).unwrap(), Cylinder::new(0.5, 2.0).unwrap());
        let surfaces = |lowered: Lowered| lowered.facets.into_iter().map(|facet| facet.surface);
        assert!(surfaces(full.lower()).eq(surfaces(rod.lower())));
        let ends = [(1.0, 0.0, 1.0), (-1.0, 0.0, -1.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)];
        let ends = ends.map(|(x, y, z)| Vec3::new(0.5 * x, 0.5 * y, z));
        check_touched(&full, Vec3::ZERO, &ends);
        assert_eq!(Tube::new(0.5, 0.2, f64::INFINITY).unwrap().lower().facets.len(), 2);
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Tube::new(1.0, 2.0, 1.0)),
            "tube: inner_radius is 2 and outer_radius is 1: inner_radius must be less than outer_radius. Are they the wrong way round?"
        );
        assert_eq!(
            message(Tube::new(1.0, -0.5, 1.0)),
            "tube: inner_radius is -0.5: inner_radius must be finite and at least 0. Did you mean 0.5?"
        );
    }
}
