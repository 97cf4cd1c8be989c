//! A slab: all points between two parallel planes.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `normal` | a list of 3 numbers | none | finite and not all 0 |  | direction across the slab, of any length |
//! | `lo` | a number | length | finite |  | value of normal . p on the first plane |
//! | `hi` | a number | length | finite |  | value of normal . p on the second plane |
//!
//! Inside: `lo < normal . (x, y, z) < hi`.
//!
//! Faces: `lo` and `hi`.
//!
//! `lo` must be less than `hi`. The bounds are finite in one direction if the normal is parallel to an axis.

use super::half_space::{check_plane, layer_bounds, random_normal};
use super::parameter::check_increasing;
use super::shape::between;
use super::{
    Arguments, Facet, Lowered, Parameter, ParameterKind, ParameterUnit, Range, Shape, ShapeError, Value,
};
use crate::surface::Surface;
use rayweave_math::Vec3;

/// All points between two parallel planes: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    normal: Vec3,
    lo: f64,
    hi: f64,
}

impl Slab {
    /// The points with `lo < normal . p < hi`.
    pub fn new(normal: Vec3, lo: f64, hi: f64) -> Result<Slab, ShapeError> {
        Slab { normal, lo, hi }.validated()
    }
}

impl Shape for Slab {
    const NAME: &'static str = "slab";
    const EQUATION: &'static str = "lo < normal . (x, y, z) < hi";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new(
            "normal",
            ParameterKind::Vector3,
            ParameterUnit::None,
            Range::Direction,
            "direction across the slab, of any length",
        ),
        Parameter::number(
            "lo",
            ParameterUnit::Length,
            Range::Finite,
            "value of normal . p on the first plane",
        ),
        Parameter::number(
            "hi",
            ParameterUnit::Length,
            Range::Finite,
            "value of normal . p on the second plane",
        ),
    ];
    const FACES: &'static [&'static str] = &["lo", "hi"];

    fn from_arguments(arguments: &Arguments) -> Result<Slab, ShapeError> {
        Slab::new(arguments.vector("normal"), arguments.number("lo"), arguments.number("hi"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("normal", self.normal.into()), ("lo", self.lo.into()), ("hi", self.hi.into())]
    }

    fn consistent(&self) -> Result<(), ShapeError> {
        check_increasing(Self::NAME, ("lo", self.lo), ("hi", self.hi), Vec::new())?;
        check_plane(Self::NAME, "lo", Vec::new(), self.normal, self.lo)?;
        check_plane(Self::NAME, "hi", Vec::new(), self.normal, self.hi)
    }

    fn lower(&self) -> Lowered {
        let plane = |offset| Surface::plane(self.normal, offset);
        Lowered::conjunction(
            vec![Facet::outside("lo", plane(self.lo)), Facet::inside("hi", plane(self.hi))],
            layer_bounds(self.normal, self.lo, self.hi),
        )
    }

    fn volume(&self) -> Option<f64> {
        Some(f64::INFINITY)
    }

    fn example() -> Slab {
        Slab { normal: Vec3::new(0.2, 0.1, 1.0), lo: -0.3, hi: 0.3 }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Slab {
        let (normal, lo) = (random_normal(rng), between(rng, -1.0, 0.5));
        Slab { normal, lo, hi: lo + between(rng, 0.1, 1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, message};
    use super::*;

    #[test]
    fn slabs_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            for normal in [Vec3::new(1.0, -2.0, 0.5), Vec3::new(-2.0, 0.0, 0.0)] {
                let solid = Slab::new(normal, -0.2 * scale, 0.9 * scale).unwrap();
                check_inside(&solid, Vec3::splat(scale), |p| {
                    -0.2 * scale < normal.dot(p) && normal.dot(p) < 0.9 * scale
                });
            }
        }
    }

    #[test]
    fn bounds_along_an_axis() {
        let bounds = Slab::new(Vec3::new(-2.0, 0.0, 0.0), 1.0, 4.0).unwrap().lower().bounds;
        assert_eq!((bounds.lo.x, bounds.hi.x), (-2.0, -0.5));
        assert_eq!((bounds.lo.y, bounds.hi.z), (f64::NEG_INFINITY, f64::INFINITY));
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Slab::new(Vec3::X, 1.0, 1.0)),
            "slab: lo is 1 and hi is 1: lo must be less than hi. Are they the wrong way round?"
        );
        assert!(message(Slab::new(Vec3::ZERO, 0.0, 1.0)).contains("has length zero: a normal must"));
        assert!(message(Slab::new(Vec3::X * 1e-100, 0.0, 1.0)).contains("hi is 1e100"));
    }
}
