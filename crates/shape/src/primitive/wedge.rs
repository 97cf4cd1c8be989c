//! A sector of space around the z axis, unbounded along it.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `start_degrees` | a number | degrees | finite |  | angle of the first face, from +x towards +y |
//! | `sweep_degrees` | a number | degrees | greater than 0 and less than 360 |  | angle from the first face to the second |
//!
//! Inside: `start_degrees < atan2(y, x) < start_degrees + sweep_degrees (mod 360)`.
//!
//! Faces: `start` and `end`, half-planes that meet in the z axis.
//!
//! With a sweep of 180 both faces lie in one plane, and both are called `start`. With more than 180 the solid is the
//! complement of the missing wedge. Angles that are multiples of 90 degrees are exact. The bounds are finite on those
//! sides of the axes that the sector does not contain.

use super::shape::between;
use super::{Arguments, Facet, Lowered, Parameter, ParameterUnit, Range, Shape, ShapeError, Value};
use crate::surface::Surface;
use rayweave_math::{Bounds, Vec3, unit_vector_degrees};

/// A sector around the z axis: [the manual page](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wedge {
    start_degrees: f64,
    sweep_degrees: f64,
}

impl Wedge {
    /// The sector from an angle through a sweep, in degrees.
    pub fn new(start_degrees: f64, sweep_degrees: f64) -> Result<Wedge, ShapeError> {
        Wedge { start_degrees, sweep_degrees }.validated()
    }

    /// The directions of the two faces. The start angle is reduced first, so that full turns cost no digits.
    fn directions(&self) -> [Vec3; 2] {
        let start = self.start_degrees % 360.0;
        [start, start + self.sweep_degrees].map(unit_vector_degrees)
    }

    /// Bounding box by quadrants: an axis in the sector is unbounded, otherwise the bound is 0.
    fn bounds(&self) -> Bounds {
        let start = self.start_degrees.rem_euclid(360.0);
        let faces = self.directions();
        // an axis at the angle 90 k is inside if it comes after the start and before the end
        let inside = |k: u32| (f64::from(90 * k) - start).rem_euclid(360.0) < self.sweep_degrees;
        let reach = |k: u32, along: Vec3| {
            let reached = inside(k) || faces.iter().any(|face| face.dot(along) > 0.0);
            if reached { f64::INFINITY } else { 0.0 }
        };
        Bounds::new(
            Vec3::new(-reach(2, Vec3::NEG_X), -reach(3, Vec3::NEG_Y), f64::NEG_INFINITY),
            Vec3::new(reach(0, Vec3::X), reach(1, Vec3::Y), f64::INFINITY),
        )
    }
}

/// The normal of the face along a direction, towards larger angles; `+ 0` avoids -0.0.
fn ahead(direction: Vec3) -> Vec3 {
    Vec3::new(-direction.y, direction.x, 0.0) + Vec3::ZERO
}

impl Shape for Wedge {
    const NAME: &'static str = "wedge";
    const EQUATION: &'static str = "start_degrees < atan2(y, x) < start_degrees + sweep_degrees (mod 360)";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::number(
            "start_degrees",
            ParameterUnit::Angle,
            Range::Finite,
            "angle of the first face, from +x towards +y",
        ),
        Parameter::number(
            "sweep_degrees",
            ParameterUnit::Angle,
            Range::Between(0.0, 360.0),
            "angle from the first face to the second",
        ),
    ];
    const FACES: &'static [&'static str] = &["start", "end"];

    fn from_arguments(arguments: &Arguments) -> Result<Wedge, ShapeError> {
        Wedge::new(arguments.number("start_degrees"), arguments.number("sweep_degrees"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("start_degrees", self.start_degrees.into()), ("sweep_degrees", self.sweep_degrees.into())]
    }

    fn lower(&self) -> Lowered {
        let [start, end] = self.directions().map(|face| Surface::plane(ahead(face), 0.0));
        let bounds = self.bounds();
        if self.sweep_degrees == 180.0 {
            Lowered::conjunction(vec![Facet::outside("start", start)], bounds)
        } else if self.sweep_degrees < 180.0 {
            let facets = vec![Facet::outside("start", start), Facet::inside("end", end)];
            Lowered::conjunction(facets, bounds)
        } else {
            let missing = vec![Facet::inside("start", start), Facet::outside("end", end)];
            Lowered::complement(missing, bounds)
        }
    }

    fn volume(&self) -> Option<f64> {
        Some(f64::INFINITY)
    }

    fn example() -> Wedge {
        Wedge { start_degrees: 20.0, sweep_degrees: 110.0 }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Wedge {
        let sweep_degrees = match (5.0 * rng()) as u32 {
            0 => 180.0,
            1 => 90.0,
            _ => between(rng, 10.0, 350.0),
        };
        let start_degrees = match rng() < 0.3 {
            true => 90.0 * (8.0 * rng() - 4.0).round(),
            false => between(rng, -180.0, 180.0),
        };
        Wedge { start_degrees, sweep_degrees }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, message};
    use super::*;

    const ANGLES: [f64; 9] = [0.0, 30.0, 90.0, 144.5, 180.0, 270.0, -77.0, -360.0, 765.0];

    #[test]
    fn the_polar_angle_decides() {
        for start in ANGLES {
            for sweep in [20.0, 90.0, 179.0, 180.0, 181.0, 270.0, 345.0] {
                let solid = Wedge::new(start, sweep).unwrap();
                for scale in [1e-8, 1.0, 1e8] {
                    check_inside(&solid, Vec3::splat(scale), |p| {
                        let angle = p.y.atan2(p.x).to_degrees();
                        (angle - start).rem_euclid(360.0) < sweep
                    });
                }
            }
        }
    }

    #[test]
    fn bounds_reach_where_the_sector_does() {
        let inf = f64::INFINITY;
        let xy = |start, sweep| {
            let b = Wedge::new(start, sweep).unwrap().lower().bounds;
            (b.lo.x, b.hi.x, b.lo.y, b.hi.y)
        };
        assert_eq!(xy(0.0, 90.0), (0.0, inf, 0.0, inf));
        assert_eq!(xy(-360.0, 180.0), (-inf, inf, 0.0, inf));
        assert_eq!(xy(90.0, 180.0), (-inf, 0.0, -inf, inf));
        assert_eq!(xy(45.0, 90.0), (-inf, inf, 0.0, inf));
        assert_eq!(xy(350.0, 20.0), (0.0, inf, -inf, inf));
        assert_eq!(xy(200.0, 30.0), (-inf, 0.0, -inf, 0.0));
        assert_eq!(xy(0.0, 270.0), (-inf, inf, -inf, inf));
    }

    /// Neighbours in a fan share bit-identical planes, also opposite faces, so the fan has no gaps.
    #[test]
    fn a_fan_shares_its_planes() {
        let surface = |start: f64, sweep: f64, k: usize| {
            Wedge::new(start, sweep).unwrap().lower().facets[k].surface.clone()
        };
        for k in 0..10 {
            let start = 36.0 * f64::from(k);
            assert_eq!(surface(start, 36.0, 1), surface(start + 36.0, 36.0, 0));
        }
        assert_eq!(surface(0.0, 36.0, 0), surface(720.0, 36.0, 0));
    }

    #[test]
    fn half_of_space_has_one_face() {
        let half = Wedge::new(30.0, 180.0).unwrap().lower();
        assert_eq!((half.facets.len(), half.complement), (1, false));
        assert!(Wedge::new(30.0, 180.5).unwrap().lower().complement);
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Wedge::new(0.0, 360.0)),
            "wedge: sweep_degrees is 360: sweep_degrees must be greater than 0 and less than 360."
        );
        assert_eq!(
            message(Wedge::new(0.0, 400.0)),
            "wedge: sweep_degrees is 400: sweep_degrees must be greater than 0 and less than 360. Did you mean 40?"
        );
        assert_eq!(
            message(Wedge::new(f64::INFINITY, 10.0)),
            "wedge: start_degrees is inf: start_degrees must be finite."
        );
    }
}
