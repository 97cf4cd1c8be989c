//! A box centred at the origin, its sides along the axes.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `size` | a number or a list of 3 numbers | length | finite and greater than 0 |  | whole extents along x, y and z |
//!
//! Inside: `|x| < size[0]/2, |y| < size[1]/2, |z| < size[2]/2`.
//!
//! Faces: `x-`, `x+`, `y-`, `y+`, `z-`, `z+`, named after the sides of the box.
//!
//! A single number is the side of a cube.
//!
//! Volume: the product of the extents.

use super::box_from_corners::{FACES, between_corners};
use super::shape::between;
use super::{Arguments, Lowered, Parameter, ParameterKind, ParameterUnit, Range, Shape, ShapeError, Value};
use rayweave_math::Vec3;

/// A box centred at the origin: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentredBox {
    size: Vec3,
}

impl CentredBox {
    /// The box with these extents.
    pub fn new(size: Vec3) -> Result<CentredBox, ShapeError> {
        CentredBox { size }.validated()
    }

    /// The cube with this side.
    pub fn cube(side: f64) -> Result<CentredBox, ShapeError> {
        CentredBox::new(Vec3::splat(side))
    }
}

impl Shape for CentredBox {
    const NAME: &'static str = "box";
    const EQUATION: &'static str = "|x| < size[0]/2, |y| < size[1]/2, |z| < size[2]/2";
    const PARAMETERS: &'static [Parameter] = &[Parameter::new(
        "size",
        ParameterKind::NumberOrVector3,
        ParameterUnit::Length,
        Range::Positive,
        "whole extents along x, y and z",
    )];
    const FACES: &'static [&'static str] = &FACES;

    fn from_arguments(arguments: &Arguments) -> Result<CentredBox, ShapeError> {
        CentredBox::new(arguments.vector("size"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("size", self.size.into())]
    }

    fn lower(&self) -> Lowered {
        between_corners(-0.5 * self.size, 0.5 * self.size)
    }

    fn volume(&self) -> Option<f64> {
        Some(self.size.x * self.size.y * self.size.z)
    }

    fn example() -> CentredBox {
        CentredBox { size: Vec3::new(1.6, 1.2, 1.0) }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> CentredBox {
        CentredBox { size: Vec3::ZERO.map(|_| between(rng, 0.5, 2.5)) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, check_volume, message};
    use super::*;
    use crate::primitive::build;

    #[test]
    fn a_box_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let size = scale * Vec3::new(0.5, 2.0, 1.0);
            let solid = CentredBox::new(size).unwrap();
            check_inside(&solid, 0.6 * size, |p| {
                2.0 * p.x.abs() < size.x && 2.0 * p.y.abs() < size.y && 2.0 * p.z.abs() < size.z
            });
            check_touched(&solid, Vec3::ZERO, &[-0.5 * size, 0.5 * size]);
            check_volume(&solid);
        }
    }

    #[test]
    fn one_number_is_a_cube() {
        let cube = CentredBox::cube(2.0).unwrap();
        assert_eq!(build("box", &[("size", 2.0.into())]), Ok(cube.into()));
        assert_eq!(cube.volume(), Some(8.0));
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(CentredBox::new(Vec3::new(1.0, 1.0, -2.0))),
            "box: size[2] is -2: size must be finite and greater than 0. Did you mean 2?"
        );
        assert_eq!(
            message(build("box", &[("size", Value::Vector(vec![1.0, 1.0]))])),
            "box: size is a list of 2 numbers: size must be a number or a list of 3 numbers. Are there too few or too many numbers?"
        );
    }
}
