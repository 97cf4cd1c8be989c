//! A box between two corners, its sides along the axes.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `lo` | a list of 3 numbers | length | finite |  | the corner with the smallest coordinates |
//! | `hi` | a list of 3 numbers | length | finite |  | the corner with the greatest coordinates |
//!
//! Inside: `lo[k] < (x, y, z)[k] < hi[k] for k = 0, 1, 2`.
//!
//! Faces: `x-`, `x+`, `y-`, `y+`, `z-`, `z+`, named after the sides of the box.
//!
//! Each component of `lo` must be less than that of `hi`.
//!
//! Volume: the product of the extents.

use super::parameter::check_increasing;
use super::shape::between;
use super::{
    Arguments, Facet, Lowered, Parameter, ParameterKind, ParameterUnit, Range, Shape, ShapeError, Value,
};
use crate::surface::Surface;
use rayweave_math::{Bounds, Vec3};

/// Names of the faces of a box.
pub(super) const FACES: [&str; 6] = ["x-", "x+", "y-", "y+", "z-", "z+"];

/// A box between two corners: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxFromCorners {
    lo: Vec3,
    hi: Vec3,
}

impl BoxFromCorners {
    /// The box from the corner `lo` to the corner `hi`.
    pub fn new(lo: Vec3, hi: Vec3) -> Result<BoxFromCorners, ShapeError> {
        BoxFromCorners { lo, hi }.validated()
    }
}

/// The box between two corners as six half-spaces.
pub(super) fn between_corners(lo: Vec3, hi: Vec3) -> Lowered {
    let facets = (0..3).flat_map(|k| {
        let plane = |corner: Vec3| Surface::plane(Vec3::AXES[k], corner[k]);
        [Facet::outside(FACES[2 * k], plane(lo)), Facet::inside(FACES[2 * k + 1], plane(hi))]
    });
    Lowered::conjunction(facets.collect(), Bounds::new(lo, hi))
}

impl Shape for BoxFromCorners {
    const NAME: &'static str = "box_from_corners";
    const EQUATION: &'static str = "lo[k] < (x, y, z)[k] < hi[k] for k = 0, 1, 2";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new(
            "lo",
            ParameterKind::Vector3,
            ParameterUnit::Length,
            Range::Finite,
            "the corner with the smallest coordinates",
        ),
        Parameter::new(
            "hi",
            ParameterKind::Vector3,
            ParameterUnit::Length,
            Range::Finite,
            "the corner with the greatest coordinates",
        ),
    ];
    const FACES: &'static [&'static str] = &FACES;

    fn from_arguments(arguments: &Arguments) -> Result<BoxFromCorners, ShapeError> {
        BoxFromCorners::new(arguments.vector("lo"), arguments.vector("hi"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("lo", self.lo.into()), ("hi", self.hi.into())]
    }

    fn consistent(&self) -> Result<(), ShapeError> {
        (0..3).try_for_each(|k| {
            let (lo, hi) = (("lo", self.lo[k]), ("hi", self.hi[k]));
            check_increasing(Self::NAME, lo, hi, vec![k])
        })
    }

    fn lower(&self) -> Lowered {
        between_corners(self.lo, self.hi)
    }

    fn volume(&self) -> Option<f64> {
        let size = self.hi - self.lo;
        Some(size.x * size.y * size.z)
    }

    fn example() -> BoxFromCorners {
        BoxFromCorners { lo: Vec3::ZERO, hi: Vec3::new(1.0, 0.8, 0.6) }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> BoxFromCorners {
        let lo = Vec3::ZERO.map(|_| between(rng, -1.2, 0.2));
        BoxFromCorners { lo, hi: lo + Vec3::ZERO.map(|_| between(rng, 0.3, 1.5)) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, check_volume, message};
    use super::*;

    #[test]
    fn a_box_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let (lo, hi) = (scale * Vec3::new(-1.0, 0.2, -3.0), scale * Vec3::new(2.0, 1.0, -1.0));
            let solid = BoxFromCorners::new(lo, hi).unwrap();
            check_inside(&solid, scale * Vec3::splat(3.0), |p| (0..3).all(|k| lo[k] < p[k] && p[k] < hi[k]));
            check_touched(&solid, 0.5 * (lo + hi), &[lo, hi]);
            check_volume(&solid);
        }
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(BoxFromCorners::new(Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0))),
            "box_from_corners: lo[1] is 0 and hi[1] is 0: lo must be less than hi. Are they the wrong way round?"
        );
        assert_eq!(
            message(BoxFromCorners::new(Vec3::NEG_INFINITY, Vec3::ONE)),
            "box_from_corners: lo[0] is -inf: lo must be finite."
        );
    }
}
