//! A body bounded by a freeform surface: above a conic with terms in x and y or Zernike polynomials, within its aperture.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `aperture` | a number | length | finite and greater than 0 |  | radius of the aperture |
//! | `curvature` | a number | 1/length | finite | 0 | one over the radius of curvature of the base; positive if it bends towards +z |
//! | `conic` | a number | none | finite | 0 | conic constant of the base |
//! | `xy` | a list of numbers | none | finite | [] | coefficients of x, y, x^2, x y, y^2, x^3, x^2 y, ..., lengths |
//! | `zernike` | a list of numbers | none | finite | [] | coefficients of Noll's Z1, Z2, ..., lengths |
//! | `norm_radius` | a number | length | finite and at least 0 | 0 | length by which x and y are divided; 0 for that of the aperture |
//! | `height` | a number | length | greater than 0, or inf | inf | height of the flat end above the origin |
//!
//! Inside: `x^2 + y^2 < aperture^2, conic + sum of terms of x / norm_radius and y / norm_radius < z < height`.
//!
//! Faces: `surface`, `side` and `top` (z = height).
//!
//! Terms in x and y are ordered by degree, and within a degree by falling power of x, as in the extended polynomial
//! of lens design programs. Zernike polynomials have the order and norm (root mean square 1 over the disc of
//! `norm_radius`) of R. J. Noll, J. Opt. Soc. Am. 66 (1976) 207. Both kinds may be combined, up to degree 30. The
//! base must not end within the aperture. No crossing within the aperture is missed.
//!
//! For a level base the bounding box exceeds the smallest one by at most 2 % of the surface's depth. Where a curved base and
//! the terms partly cancel each other, it may exceed it by the smaller of their depths as well.

use super::sag::{above, checked};
use super::shape::between;
use super::{Arguments, Lowered, Parameter, ParameterUnit, Range, Shape, ShapeError, Value};
use crate::surface::sag::{Base, Description, Sag, Zernike, zernike_terms};
use std::sync::Arc;

/// A body with a freeform face: [the manual page](self).
#[derive(Clone, Debug, PartialEq)]
pub struct Freeform {
    // boxed, since each node of a tree of solids has room for the largest primitive
    given: Box<Given>,
    sag: Arc<Sag>,
}

#[derive(Clone, Debug, PartialEq)]
struct Given {
    aperture: f64,
    curvature: f64,
    conic: f64,
    xy: Vec<f64>,
    zernike: Vec<f64>,
    norm_radius: f64,
    height: f64,
}

impl Given {
    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![
            ("aperture", self.aperture.into()),
            ("curvature", self.curvature.into()),
            ("conic", self.conic.into()),
            ("xy", self.xy.as_slice().into()),
            ("zernike", self.zernike.as_slice().into()),
            ("norm_radius", self.norm_radius.into()),
            ("height", self.height.into()),
        ]
    }

    fn solid(self) -> Result<Freeform, ShapeError> {
        Ok(Freeform {
            sag: checked::<Freeform>(&self.arguments(), || self.description())?,
            given: Box::new(self),
        })
    }

    /// The body, unchecked.
    fn certain(self) -> Freeform {
        Freeform { sag: Arc::new(Sag::unchecked(&self.description())), given: Box::new(self) }
    }

    fn description(&self) -> Description {
        let Given { aperture, curvature, conic, .. } = *self;
        let radius = if self.norm_radius > 0.0 { self.norm_radius } else { aperture };
        let mut mixed = xy_terms(&self.xy, radius);
        mixed.extend(zernike_terms(Zernike::Noll, &self.zernike, radius));
        Description { mixed, ..Description::new(aperture, Base::Conic { curvature, conic }) }
    }
}

/// Terms of x / radius and y / radius in the order of the manual page.
fn xy_terms(coefficients: &[f64], radius: f64) -> Vec<(u32, u32, f64)> {
    let powers = (1u32..).flat_map(|degree| (0..=degree).map(move |j| (degree - j, j)));
    let scaled = |((i, j), c): ((u32, u32), &f64)| (i, j, (0..i + j).fold(*c, |c, _| c / radius));
    powers.zip(coefficients).map(scaled).collect()
}

impl Freeform {
    /// The body above the freeform: a conic base plus terms in x and y and Zernike polynomials, both with coordinates
    /// divided by a radius (0 for that of the aperture), up to the given height, which may be infinite.
    pub fn new(
        aperture: f64,
        [curvature, conic]: [f64; 2],
        [xy, zernike]: [&[f64]; 2],
        norm_radius: f64,
        height: f64,
    ) -> Result<Freeform, ShapeError> {
        let (xy, zernike) = (xy.to_vec(), zernike.to_vec());
        Given { aperture, curvature, conic, xy, zernike, norm_radius, height }.solid()
    }
}

impl Shape for Freeform {
    const NAME: &'static str = "freeform";
    const EQUATION: &'static str =
        "x^2 + y^2 < aperture^2, conic + sum of terms of x / norm_radius and y / norm_radius < z < height";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::number("aperture", ParameterUnit::Length, Range::Positive, "radius of the aperture"),
        Parameter::number(
            "curvature",
            ParameterUnit::Curvature,
            Range::Finite,
            "one over the radius of curvature of the base; positive if it bends towards +z",
        )
        .or(0.0),
        Parameter::number("conic", ParameterUnit::None, Range::Finite, "conic constant of the base").or(0.0),
        Parameter::list("xy", "coefficients of x, y, x^2, x y, y^2, x^3, x^2 y, ..., lengths"),
        Parameter::list("zernike", "coefficients of Noll's Z1, Z2, ..., lengths"),
        Parameter::number(
            "norm_radius",
            ParameterUnit::Length,
            Range::NotNegative,
            "length by which x and y are divided; 0 for that of the aperture",
        )
        .or(0.0),
        Parameter::number(
            "height",
            ParameterUnit::Length,
            Range::PositiveOrInfinite,
            "height of the flat end above the origin",
        )
        .or(f64::INFINITY),
    ];
    const FACES: &'static [&'static str] = &["surface", "side", "top"];

    fn from_arguments(arguments: &Arguments) -> Result<Freeform, ShapeError> {
        let number = |name| arguments.number(name);
        let (xy, zernike) = (arguments.list("xy"), arguments.list("zernike"));
        let forms = [number("curvature"), number("conic")];
        let (radius, height) = (number("norm_radius"), number("height"));
        Freeform::new(number("aperture"), forms, [&xy, &zernike], radius, height)
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        self.given.arguments()
    }

    fn lower(&self) -> Lowered {
        above(&self.sag, self.given.height)
    }

    fn example() -> Freeform {
        let given = Given {
            aperture: 1.0,
            curvature: 0.4,
            conic: -1.0,
            xy: vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.15],
            zernike: vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.03, 0.0, 0.02],
            norm_radius: 1.0,
            height: 0.9,
        };
        given.certain()
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Freeform {
        let aperture = between(rng, 0.4, 1.2);
        let given = Given {
            aperture,
            curvature: between(rng, -0.6, 0.6) / aperture,
            conic: between(rng, -2.0, 0.4),
            xy: (0..14).map(|_| between(rng, -0.06, 0.06)).collect(),
            zernike: if rng() < 0.5 { (0..15).map(|_| between(rng, -0.02, 0.02)).collect() } else { vec![] },
            norm_radius: if rng() < 0.5 { 0.0 } else { 1.3 },
            height: if rng() < 0.2 { f64::INFINITY } else { between(rng, 0.2, 1.5) },
        };
        given.certain()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, message};
    use super::*;
    use rayweave_math::Vec3;

    #[test]
    fn freeforms_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let xy = [0.1, -0.2, 0.05, 0.3, 0.0, -0.2].map(|c| c * scale);
            let zernike = [0.0, 0.0, 0.0, 0.05, 0.0, 0.0, 0.02].map(|c| c * scale);
            let forms = [0.3 / scale, -0.5];
            let solid = Freeform::new(scale, forms, [&xy, &zernike], 2.0 * scale, 0.8 * scale).unwrap();
            check_inside(&solid, 1.2 * Vec3::splat(scale), |p| {
                let p = p / scale;
                let (x, y) = (p.x / 2.0, p.y / 2.0);
                let (r2, v) = (p.x * p.x + p.y * p.y, x * x + y * y);
                let conic = 0.3 * r2 / (1.0 + (1.0 - 0.5 * 0.09 * r2).sqrt());
                let terms = 0.1 * x - 0.2 * y + 0.05 * x * x + 0.3 * x * y - 0.2 * x * x * x;
                // Noll's focus and coma along y
                let waves = 0.05 * 3f64.sqrt() * (2.0 * v - 1.0) + 0.02 * 8f64.sqrt() * (3.0 * v - 2.0) * y;
                r2 < 1.0 && conic + terms + waves < p.z && p.z < 0.8
            });
        }
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        let many = vec![1e-3; 500];
        assert!(message(Freeform::new(1.0, [0.0, 0.0], [&many, &[]], 0.0, 1.0)).contains("degree 31"));
        assert!(message(Freeform::new(1.0, [0.0, 0.0], [&[], &many], 0.0, 1.0)).contains("degree 31"));
        assert!(message(Freeform::new(1.0, [0.0, 0.0], [&[], &[]], -1.0, 1.0)).contains("norm_radius is -1"));
    }
}
