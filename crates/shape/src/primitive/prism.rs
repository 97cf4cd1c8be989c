//! A prism over a regular polygon, along z, centred at the origin.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `sides` | a whole number | count | a whole number from 3 to 4096 |  | number of sides of the polygon |
//! | `radius` | a number | length | finite and greater than 0 |  | distance of its vertices from the axis |
//! | `height` | a number | length | greater than 0, or inf |  | whole extent along z |
//!
//! Inside: `x cos a_k + y sin a_k < radius cos(180/sides) for all a_k = (2 k + 1) 180/sides, |z| < height/2`.
//!
//! Faces: `side0..sideN-1`, `bottom` (z = -height/2) and `top` (z = height/2). Vertex k is at the angle
//! k 360/sides from +x towards +y, so the first is on +x; `side0` goes from vertex 0 to vertex 1.
//!
//! With an infinite height the prism has no ends.
//!
//! Volume: sides/2 radius^2 sin(360/sides) height, the sum over the triangles between the axis and the sides.

use super::lowered::caps;
use super::shape::between;
use super::{
    Arguments, Facet, Lowered, Parameter, ParameterKind, ParameterUnit, Range, Shape, ShapeError, Value,
};
use crate::surface::Surface;
use rayweave_math::{Bounds, Vec3, sin_cos_degrees, unit_vector_degrees};

/// A prism over a regular polygon: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prism {
    sides: u32,
    radius: f64,
    height: f64,
}

impl Prism {
    /// The prism with this number of sides, circumradius, and height, which may be infinite.
    pub fn new(sides: u32, radius: f64, height: f64) -> Result<Prism, ShapeError> {
        Prism { sides, radius, height }.validated()
    }

    /// The direction at the angle k 180/sides: a vertex for even k, the middle of a side for odd k.
    fn direction(&self, k: u32) -> Vec3 {
        unit_vector_degrees(180.0 * f64::from(k) / f64::from(self.sides))
    }

    fn side(&self, k: u32) -> Facet {
        let (_, cos) = sin_cos_degrees(180.0 / f64::from(self.sides));
        let surface = Surface::plane(self.direction(2 * k + 1), self.radius * cos);
        Facet::inside(format!("side{k}"), surface)
    }

    fn bounds(&self) -> Bounds {
        let half = 0.5 * self.height;
        let vertices = (0..self.sides).map(|k| self.radius * self.direction(2 * k));
        vertices.fold(Bounds::EMPTY, |bounds, vertex| {
            bounds.union(&Bounds::new(vertex.with_z(-half), vertex.with_z(half)))
        })
    }
}

impl Shape for Prism {
    const NAME: &'static str = "prism";
    const EQUATION: &'static str =
        "x cos a_k + y sin a_k < radius cos(180/sides) for all a_k = (2 k + 1) 180/sides, |z| < height/2";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new(
            "sides",
            ParameterKind::Count,
            ParameterUnit::Count,
            Range::Whole(3, 4096),
            "number of sides of the polygon",
        ),
        Parameter::number(
            "radius",
            ParameterUnit::Length,
            Range::Positive,
            "distance of its vertices from the axis",
        ),
        Parameter::number("height", ParameterUnit::Length, Range::PositiveOrInfinite, "whole extent along z"),
    ];
    const FACES: &'static [&'static str] = &["side0..sideN-1", "bottom", "top"];

    fn from_arguments(arguments: &Arguments) -> Result<Prism, ShapeError> {
        Prism::new(arguments.count("sides"), arguments.number("radius"), arguments.number("height"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("sides", self.sides.into()), ("radius", self.radius.into()), ("height", self.height.into())]
    }

    fn lower(&self) -> Lowered {
        let mut facets: Vec<Facet> = (0..self.sides).map(|k| self.side(k)).collect();
        facets.extend(caps(self.height));
        Lowered::conjunction(facets, self.bounds())
    }

    fn volume(&self) -> Option<f64> {
        let sides = f64::from(self.sides);
        let (sin, _) = sin_cos_degrees(360.0 / sides);
        Some(0.5 * sides * self.radius * self.radius * sin * self.height)
    }

    fn example() -> Prism {
        Prism { sides: 6, radius: 0.9, height: 1.4 }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Prism {
        Prism {
            sides: 3 + (6.0 * rng()) as u32,
            radius: between(rng, 0.4, 1.3),
            height: between(rng, 0.4, 2.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, check_volume, message};
    use super::*;
    use crate::primitive::build;
    use std::f64::consts::PI;

    /// Reference by polar angles: inside the triangle of the nearest side.
    fn inside(sides: u32, radius: f64, p: Vec3) -> bool {
        let step = 2.0 * PI / f64::from(sides);
        let off = p.y.atan2(p.x).rem_euclid(step) - 0.5 * step;
        p.x.hypot(p.y) * off.cos() < radius * (0.5 * step).cos()
    }

    #[test]
    fn prisms_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            for sides in [3, 4, 5, 6, 7, 48] {
                let (radius, height) = (0.8 * scale, 1.1 * scale);
                let solid = Prism::new(sides, radius, height).unwrap();
                check_inside(&solid, scale * Vec3::new(0.9, 0.9, 0.6), |p| {
                    inside(sides, radius, p) && 2.0 * p.z.abs() < height
                });
                let angle = |k: u32| 2.0 * PI * f64::from(k) / f64::from(sides);
                let vertex = |k| Vec3::new(radius * libm::cos(angle(k)), radius * libm::sin(angle(k)), 0.0);
                let vertices: Vec<Vec3> = (0..2 * sides)
                    .map(|k| vertex(k / 2).with_z(if k % 2 == 0 { -0.5 } else { 0.5 } * height))
                    .collect();
                check_touched(&solid, Vec3::ZERO, &vertices);
                check_volume(&solid);
            }
        }
    }

    #[test]
    fn four_sides_are_a_turned_square_with_equal_distances() {
        let square = Prism::new(4, 1.0, 2.0).unwrap();
        assert_eq!(square.lower().bounds, Bounds::centred(Vec3::ZERO, Vec3::ONE));
        assert!((square.volume().unwrap() - 4.0).abs() < 1e-15);
        assert_eq!(square.lower().facets[0].name, "side0");
        assert!(!square.lower().contains(Vec3::new(0.51, 0.51, 0.0)));
        assert_eq!(Prism::new(3, 1.0, f64::INFINITY).unwrap().lower().facets.len(), 3);
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        let with = |sides: f64| {
            let arguments = [("sides", sides.into()), ("radius", 1.0.into()), ("height", 1.0.into())];
            message(build("prism", &arguments))
        };
        assert_eq!(
            with(2.0),
            "prism: sides is 2: sides must be a whole number from 3 to 4096. Did you mean 3?"
        );
        assert_eq!(
            with(6.5),
            "prism: sides is 6.5: sides must be a whole number from 3 to 4096. Did you mean 7?"
        );
        assert_eq!(with(f64::NAN), "prism: sides is nan: sides must be a whole number from 3 to 4096.");
        assert!(message(Prism::new(0, 1.0, 1.0)).starts_with("prism: sides is 0"));
    }
}
