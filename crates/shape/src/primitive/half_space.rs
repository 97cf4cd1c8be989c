//! A half-space: all points on one side of a plane.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `normal` | a list of 3 numbers | none | finite and not all 0 |  | direction out of the solid, of any length |
//! | `offset` | a number | length | finite |  | value of normal . p on the plane: for a unit normal, its signed distance from the origin |
//!
//! Inside: `normal . (x, y, z) < offset`.
//!
//! Face: `plane`.
//!
//! Only the ratio of `normal` to `offset` matters: a longer normal with the same offset moves the plane nearer to the
//! origin. The bounds are finite on one side if the normal is parallel to a coordinate axis, and infinite otherwise.

use super::parameter::check_length;
use super::shape::between;
use super::{
    Arguments, Facet, Lowered, Parameter, ParameterKind, ParameterUnit, Range, Shape, ShapeError, Value,
};
use crate::surface::{Plane, Surface};
use rayweave_math::{Bounds, Vec3};

/// All points on one side of a plane: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    normal: Vec3,
    offset: f64,
}

impl HalfSpace {
    /// The points with `normal . p < offset`.
    pub fn new(normal: Vec3, offset: f64) -> Result<HalfSpace, ShapeError> {
        HalfSpace { normal, offset }.validated()
    }
}

/// The bounds of `lo < normal . p < hi`: if the normal is parallel to a coordinate axis, the range along that axis, else all
/// of space.
pub(super) fn layer_bounds(normal: Vec3, lo: f64, hi: f64) -> Bounds {
    let mut bounds = Bounds::ALL;
    for k in 0..3 {
        if normal.abs() == Vec3::AXES[k] * normal[k].abs() {
            let (a, b) = (lo / normal[k], hi / normal[k]);
            bounds.lo[k] = a.min(b);
            bounds.hi[k] = a.max(b);
        }
    }
    bounds
}

/// Rejects a plane `normal . p = offset` that is farther from the origin than the largest supported length.
pub(super) fn check_plane(
    shape: &'static str,
    parameter: &'static str,
    index: Vec<usize>,
    normal: Vec3,
    offset: f64,
) -> Result<(), ShapeError> {
    let distance = Plane::new(normal, offset).offset;
    // a distance below the smallest supported length is accepted, like 0
    match distance.abs() < 1.0 {
        true => Ok(()),
        false => check_length(shape, parameter, index, distance),
    }
}

impl Shape for HalfSpace {
    const NAME: &'static str = "half_space";
    const EQUATION: &'static str = "normal . (x, y, z) < offset";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new(
            "normal",
            ParameterKind::Vector3,
            ParameterUnit::None,
            Range::Direction,
            "direction out of the solid, of any length",
        ),
        Parameter::number(
            "offset",
            ParameterUnit::Length,
            Range::Finite,
            "value of normal . p on the plane: for a unit normal, its signed distance from the origin",
        ),
    ];
    const FACES: &'static [&'static str] = &["plane"];

    fn from_arguments(arguments: &Arguments) -> Result<HalfSpace, ShapeError> {
        HalfSpace::new(arguments.vector("normal"), arguments.number("offset"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("normal", self.normal.into()), ("offset", self.offset.into())]
    }

    fn consistent(&self) -> Result<(), ShapeError> {
        check_plane(Self::NAME, "offset", Vec::new(), self.normal, self.offset)
    }

    fn lower(&self) -> Lowered {
        let surface = Surface::plane(self.normal, self.offset);
        Lowered::conjunction(
            vec![Facet::inside("plane", surface)],
            layer_bounds(self.normal, f64::NEG_INFINITY, self.offset),
        )
    }

    fn volume(&self) -> Option<f64> {
        Some(f64::INFINITY)
    }

    fn example() -> HalfSpace {
        HalfSpace { normal: Vec3::new(0.3, 0.2, 1.0), offset: 0.0 }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> HalfSpace {
        HalfSpace { normal: random_normal(rng), offset: between(rng, -1.0, 1.0) }
    }
}

/// A random normal: with probability 1/2 a unit vector along a coordinate axis, else an oblique vector with |z| from 0.1 to 1
/// and |x| and |y| at most 1.
pub(super) fn random_normal(rng: &mut dyn FnMut() -> f64) -> Vec3 {
    let sign = if rng() < 0.5 { -1.0 } else { 1.0 };
    match (6.0 * rng()) as usize {
        k @ 0..3 => sign * Vec3::AXES[k],
        _ => sign * Vec3::new(between(rng, -1.0, 1.0), between(rng, -1.0, 1.0), between(rng, 0.1, 1.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, message};
    use super::*;

    #[test]
    fn half_spaces_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            for normal in [Vec3::new(1.0, -2.0, 0.5), Vec3::new(0.0, 0.0, -3.0)] {
                let solid = HalfSpace::new(normal, 0.7 * scale).unwrap();
                check_inside(&solid, Vec3::splat(scale), |p| normal.dot(p) < 0.7 * scale);
            }
        }
    }

    #[test]
    fn bounds_are_finite_only_along_an_axis() {
        let bounds = |normal, offset| HalfSpace::new(normal, offset).unwrap().lower().bounds;
        let lower = bounds(Vec3::new(0.0, -2.0, 0.0), 3.0);
        assert_eq!(lower.lo, Vec3::new(f64::NEG_INFINITY, -1.5, f64::NEG_INFINITY));
        assert_eq!(lower.hi, Vec3::INFINITY);
        assert_eq!(bounds(Vec3::new(1e-9, 1.0, 0.0), 3.0), Bounds::ALL);
    }

    #[test]
    fn only_the_ratio_counts() {
        let lowered = |s: f64| HalfSpace::new(Vec3::new(s, 2.0 * s, 0.0), 3.0 * s).unwrap().lower();
        assert_eq!(lowered(1.0), lowered(1024.0));
        assert_eq!(lowered(1.0), lowered(2f64.powi(-40)));
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(HalfSpace::new(Vec3::ZERO, 1.0)),
            "half_space: normal has length zero: a normal must have a direction. Did you mean [0, 0, 1]?"
        );
        assert_eq!(
            message(HalfSpace::new(Vec3::new(0.0, f64::NAN, 1.0), 1.0)),
            "half_space: normal[1] is nan: normal must be finite and not all 0."
        );
        assert_eq!(
            message(HalfSpace::new(Vec3::new(0.0, 1e-200, 0.0), 1.0)),
            "half_space: offset is 1e200: only lengths from 1e-60 to 1e60 are supported. Is the unit right?"
        );
        assert!(message(HalfSpace::new(Vec3::Z * 1e-310, 1.0)).contains("offset is inf: only lengths"));
        assert_eq!(HalfSpace::new(Vec3::Z * 1e-310, 0.0).unwrap().lower().bounds.hi.z, 0.0);
        assert_eq!(
            message(HalfSpace::new(Vec3::Z, f64::INFINITY)),
            "half_space: offset is inf: offset must be finite."
        );
    }
}
