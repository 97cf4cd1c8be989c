//! A body bounded by an aspheric surface of revolution around z: above a conic with polynomial terms, within its aperture.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `aperture` | a number | length | finite and greater than 0 |  | radius of the aperture |
//! | `curvature` | a number | 1/length | finite |  | one over the radius of curvature at the vertex; positive if the surface bends towards +z |
//! | `conic` | a number | none | finite | 0 | conic constant: 0 for a sphere, -1 for a paraboloid |
//! | `even` | a list of numbers | none | finite | [] | coefficients of r^2, r^4, r^6, ... |
//! | `odd` | a list of numbers | none | finite | [] | coefficients of r, r^3, r^5, ... |
//! | `height` | a number | length | greater than 0, or inf | inf | height of the flat end above the vertex |
//!
//! Inside: `r < aperture, curvature r^2 / (1 + sqrt(1 - (1 + conic) curvature^2 r^2)) + sum of terms < z < height`.
//!
//! Faces: `surface`, `side` and `top` (z = height).
//!
//! The vertex is the origin. This is the even asphere of lens design (ISO 10110-12), beginning with a term in r^2 that
//! adds to the curvature, plus the odd asphere. The conic must not end within the aperture:
//! `(1 + conic) curvature^2 aperture^2` is at most 1. There are at most 30 coefficients of each kind. A term of first
//! order makes a cone around the vertex (an axicon). No crossing within the aperture is missed, whatever the
//! coefficients.
//!
//! The bounding box exceeds the smallest one by up to a few per cent of the surface's depth.
//!
//! Volume, if the top is above the surface: pi aperture^2 height minus the integral of 2 pi r times the sag. For the
//! conic the integral is pi curvature aperture^4 (1 + 2 w) / (3 (1 + w)^2), with w the square root at the rim.

use super::sag::{above, checked};
use super::shape::between;
use super::{Arguments, Lowered, Parameter, ParameterUnit, Range, Shape, ShapeError, Value};
use crate::surface::sag::{Base, Description, Sag};
use std::f64::consts::PI;
use std::sync::Arc;

/// A body with an aspheric face: [the manual page](self).
#[derive(Clone, Debug, PartialEq)]
pub struct Asphere {
    // boxed, since each node of a tree of solids has room for the largest primitive
    given: Box<Given>,
    sag: Arc<Sag>,
}

#[derive(Clone, Debug, PartialEq)]
struct Given {
    aperture: f64,
    curvature: f64,
    conic: f64,
    even: Vec<f64>,
    odd: Vec<f64>,
    height: f64,
}

impl Given {
    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![
            ("aperture", self.aperture.into()),
            ("curvature", self.curvature.into()),
            ("conic", self.conic.into()),
            ("even", self.even.as_slice().into()),
            ("odd", self.odd.as_slice().into()),
            ("height", self.height.into()),
        ]
    }

    fn solid(self) -> Result<Asphere, ShapeError> {
        let sag = checked::<Asphere>(&self.arguments(), || self.description())?;
        Ok(Asphere { given: Box::new(self), sag })
    }

    /// The body, unchecked.
    fn certain(self) -> Asphere {
        Asphere { sag: Arc::new(Sag::unchecked(&self.description())), given: Box::new(self) }
    }

    fn description(&self) -> Description {
        let Given { aperture, curvature, conic, .. } = *self;
        Description {
            even: self.even.clone(),
            odd: self.odd.clone(),
            ..Description::new(aperture, Base::Conic { curvature, conic })
        }
    }

    /// Integral of r times the sag over the radius of the aperture.
    fn moment(&self) -> f64 {
        let Given { aperture: r, curvature: c, conic: k, .. } = *self;
        let w = (1.0 - (1.0 + k) * c * c * r * r).max(0.0).sqrt();
        let base = c * (r * r) * (r * r) * (1.0 + 2.0 * w) / (6.0 * (1.0 + w) * (1.0 + w));
        let power = |n: usize| (0..n).fold(1.0, |power, _| power * r);
        let term = |c: f64, n: usize| c * power(n + 2) / (n + 2) as f64;
        let even: f64 = self.even.iter().enumerate().map(|(k, &c)| term(c, 2 * k + 2)).sum();
        let odd: f64 = self.odd.iter().enumerate().map(|(k, &c)| term(c, 2 * k + 1)).sum();
        base + even + odd
    }
}

impl Asphere {
    /// The body above the asphere with these coefficients, up to the given height, which may be infinite.
    pub fn new(
        aperture: f64,
        [curvature, conic]: [f64; 2],
        [even, odd]: [&[f64]; 2],
        height: f64,
    ) -> Result<Asphere, ShapeError> {
        let (even, odd) = (even.to_vec(), odd.to_vec());
        Given { aperture, curvature, conic, even, odd, height }.solid()
    }
}

impl Shape for Asphere {
    const NAME: &'static str = "asphere";
    const EQUATION: &'static str = "r < aperture, curvature r^2 / (1 + sqrt(1 - (1 + conic) curvature^2 r^2)) + sum of terms < z < height";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::number("aperture", ParameterUnit::Length, Range::Positive, "radius of the aperture"),
        Parameter::number(
            "curvature",
            ParameterUnit::Curvature,
            Range::Finite,
            "one over the radius of curvature at the vertex; positive if the surface bends towards +z",
        ),
        Parameter::number(
            "conic",
            ParameterUnit::None,
            Range::Finite,
            "conic constant: 0 for a sphere, -1 for a paraboloid",
        )
        .or(0.0),
        Parameter::list("even", "coefficients of r^2, r^4, r^6, ..."),
        Parameter::list("odd", "coefficients of r, r^3, r^5, ..."),
        Parameter::number(
            "height",
            ParameterUnit::Length,
            Range::PositiveOrInfinite,
            "height of the flat end above the vertex",
        )
        .or(f64::INFINITY),
    ];
    const FACES: &'static [&'static str] = &["surface", "side", "top"];

    fn from_arguments(arguments: &Arguments) -> Result<Asphere, ShapeError> {
        let number = |name| arguments.number(name);
        let (even, odd) = (arguments.list("even"), arguments.list("odd"));
        let forms = [number("curvature"), number("conic")];
        Asphere::new(number("aperture"), forms, [&even, &odd], number("height"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        self.given.arguments()
    }

    fn lower(&self) -> Lowered {
        above(&self.sag, self.given.height)
    }

    fn volume(&self) -> Option<f64> {
        let Given { aperture, height, .. } = *self.given;
        let whole = PI * aperture * aperture * height - 2.0 * PI * self.given.moment();
        // the heights are bounds, which may exceed the surface by roundings
        (self.sag.heights()[1] - height <= 1e-9 * aperture).then_some(whole)
    }

    fn example() -> Asphere {
        let given = Given {
            aperture: 1.0,
            curvature: 0.8,
            conic: -1.0,
            even: vec![0.0, -0.25],
            odd: vec![0.0, 0.1],
            height: 0.9,
        };
        given.certain()
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Asphere {
        let aperture = between(rng, 0.4, 1.2);
        let given = Given {
            aperture,
            curvature: between(rng, -0.8, 0.8) / aperture,
            conic: between(rng, -2.0, 0.4),
            even: (0..4).map(|_| between(rng, -0.15, 0.15)).collect(),
            odd: if rng() < 0.3 { vec![between(rng, -0.2, 0.2), between(rng, -0.2, 0.2)] } else { vec![] },
            height: if rng() < 0.2 { f64::INFINITY } else { between(rng, 0.2, 1.5) },
        };
        given.certain()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_volume, message};
    use super::*;
    use crate::primitive::{Paraboloid, build};
    use rayweave_math::Vec3;

    #[test]
    fn aspheres_at_every_scale() {
        for scale in [1e-8f64, 1.0, 1e8] {
            let even = [0.0, -0.25 / scale.powi(3), 0.1 / scale.powi(5)];
            let odd = [0.1, 0.2 / scale.powi(2)];
            let forms = [0.5 / scale, -0.4];
            let solid = Asphere::new(scale, forms, [&even, &odd], 1.2 * scale).unwrap();
            check_inside(&solid, 1.2 * Vec3::splat(scale), |p| {
                let p = p / scale;
                let r2 = p.x * p.x + p.y * p.y;
                let conic = 0.5 * r2 / (1.0 + (1.0 - 0.6 * 0.25 * r2).sqrt());
                let terms = -0.25 * r2 * r2 + 0.1 * r2 * r2 * r2 + 0.1 * r2.sqrt() + 0.2 * r2.sqrt() * r2;
                r2 < 1.0 && conic + terms < p.z && p.z < 1.2
            });
            check_volume(&solid);
        }
    }

    /// A paraboloid by its curvature and by its coefficient, against the quadric: volume and bounds.
    #[test]
    fn a_paraboloid_in_three_ways() {
        let quadric = Paraboloid::new(0.25, 1.0).unwrap();
        for (forms, even) in [([2.0, -1.0], vec![]), ([0.0, 0.0], vec![1.0]), ([1.0, -1.0], vec![0.5])] {
            let solid = Asphere::new(1.0, forms, [&even, &[]], 1.0).unwrap();
            assert!((solid.volume().unwrap() - quadric.volume().unwrap()).abs() < 1e-15);
            let (found, expected) = (solid.lower().bounds, quadric.lower().bounds);
            assert!((found.lo - expected.lo).length() < 1e-2 && found.hi == expected.hi, "{found:?}");
        }
        let sphere = Asphere::new(1.0, [1.0, 0.0], [&[], &[]], 1.0).unwrap();
        assert!((sphere.volume().unwrap() - 2.0 / 3.0 * PI).abs() < 1e-15);
    }

    #[test]
    fn lists_need_not_be_given() {
        let plain = Asphere::new(1.0, [0.5, 0.0], [&[], &[]], f64::INFINITY).unwrap();
        let built = build("asphere", &[("aperture", 1.0.into()), ("curvature", 0.5.into())]);
        assert_eq!(built, Ok(plain.clone().into()));
        assert_eq!((plain.lower().facets.len(), plain.volume()), (2, Some(f64::INFINITY)));
        let shallow = Asphere::new(1.0, [0.5, 0.0], [&[0.0, -9.0], &[]], 1e-3).unwrap();
        assert_eq!(Asphere::new(1.0, [0.5, 0.0], [&[], &[]], 0.1).unwrap().volume(), None);
        assert!(!shallow.lower().bounds.is_empty());
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Asphere::new(2.0, [0.8, 0.0], [&[], &[]], 1.0)),
            "asphere: the aperture's radius is 2: the conic ends at 1.25, where its square root becomes imaginary. Is the curvature too large?"
        );
        assert_eq!(
            message(Asphere::new(1.0, [0.8, 0.0], [&[0.0, f64::INFINITY], &[]], 1.0)),
            "asphere: even[1] is inf: even must be finite."
        );
        assert!(message(Asphere::new(1.0, [0.0, 0.0], [&[0.0; 31], &[]], 1.0)).contains("degree 31"));
    }
}
