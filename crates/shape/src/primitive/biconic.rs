//! A body bounded by a biconic surface: above conics of different curvature along x and y, within its aperture.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `aperture` | a number | length | finite and greater than 0 |  | radius of the aperture |
//! | `curvature_x` | a number | 1/length | finite |  | curvature at the vertex along x; positive if the surface bends towards +z |
//! | `curvature_y` | a number | 1/length | finite |  | curvature at the vertex along y |
//! | `conic_x` | a number | none | finite | 0 | conic constant along x |
//! | `conic_y` | a number | none | finite | 0 | conic constant along y |
//! | `height` | a number | length | greater than 0, or inf | inf | height of the flat end above the vertex |
//!
//! Inside: `x^2 + y^2 < aperture^2, (cx x^2 + cy y^2) / (1 + sqrt(1 - (1 + kx) cx^2 x^2 - (1 + ky) cy^2 y^2)) < z < height`.
//!
//! Faces: `surface`, `side` and `top` (z = height).
//!
//! The vertex is the origin; cx, cy, kx and ky are the curvatures and conic constants. The root must be real in the
//! whole aperture: `(1 + k) c^2 aperture^2` is at most 1 for both. No crossing within the aperture is missed.
//!
//! The bounding box exceeds the smallest one by a fraction of the surface's depth.

use super::sag::{above, checked};
use super::shape::between;
use super::{Arguments, Lowered, Parameter, ParameterUnit, Range, Shape, ShapeError, Value};
use crate::surface::sag::{Base, Description, Sag};
use std::sync::Arc;

/// A body with a biconic face: [the manual page](self).
#[derive(Clone, Debug, PartialEq)]
pub struct Biconic {
    // boxed, since each node of a tree of solids has room for the largest primitive
    given: Box<Given>,
    sag: Arc<Sag>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Given {
    aperture: f64,
    curvatures: [f64; 2],
    conics: [f64; 2],
    height: f64,
}

impl Given {
    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![
            ("aperture", self.aperture.into()),
            ("curvature_x", self.curvatures[0].into()),
            ("curvature_y", self.curvatures[1].into()),
            ("conic_x", self.conics[0].into()),
            ("conic_y", self.conics[1].into()),
            ("height", self.height.into()),
        ]
    }

    fn solid(self) -> Result<Biconic, ShapeError> {
        Ok(Biconic {
            sag: checked::<Biconic>(&self.arguments(), || self.description())?,
            given: Box::new(self),
        })
    }

    /// The body, unchecked.
    fn certain(self) -> Biconic {
        Biconic { sag: Arc::new(Sag::unchecked(&self.description())), given: Box::new(self) }
    }

    fn description(&self) -> Description {
        let Given { aperture, curvatures, conics, .. } = *self;
        Description::new(aperture, Base::Biconic { curvatures, conics })
    }
}

impl Biconic {
    /// The body above the biconic with these curvatures and conic constants along x and y, up to the given height, which
    /// may be infinite.
    pub fn new(
        aperture: f64,
        curvatures: [f64; 2],
        conics: [f64; 2],
        height: f64,
    ) -> Result<Biconic, ShapeError> {
        Given { aperture, curvatures, conics, height }.solid()
    }
}

const fn curvature(name: &'static str, summary: &'static str) -> Parameter {
    Parameter::number(name, ParameterUnit::Curvature, Range::Finite, summary)
}

const fn conic(name: &'static str, summary: &'static str) -> Parameter {
    Parameter::number(name, ParameterUnit::None, Range::Finite, summary).or(0.0)
}

impl Shape for Biconic {
    const NAME: &'static str = "biconic";
    const EQUATION: &'static str = "x^2 + y^2 < aperture^2, (cx x^2 + cy y^2) / (1 + sqrt(1 - (1 + kx) cx^2 x^2 - (1 + ky) cy^2 y^2)) < z < height";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::number("aperture", ParameterUnit::Length, Range::Positive, "radius of the aperture"),
        curvature("curvature_x", "curvature at the vertex along x; positive if the surface bends towards +z"),
        curvature("curvature_y", "curvature at the vertex along y"),
        conic("conic_x", "conic constant along x"),
        conic("conic_y", "conic constant along y"),
        Parameter::number(
            "height",
            ParameterUnit::Length,
            Range::PositiveOrInfinite,
            "height of the flat end above the vertex",
        )
        .or(f64::INFINITY),
    ];
    const FACES: &'static [&'static str] = &["surface", "side", "top"];

    fn from_arguments(arguments: &Arguments) -> Result<Biconic, ShapeError> {
        let number = |name| arguments.number(name);
        let curvatures = [number("curvature_x"), number("curvature_y")];
        Biconic::new(number("aperture"), curvatures, [number("conic_x"), number("conic_y")], number("height"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        self.given.arguments()
    }

    fn lower(&self) -> Lowered {
        above(&self.sag, self.given.height)
    }

    fn example() -> Biconic {
        Given { aperture: 1.0, curvatures: [0.9, -0.5], conics: [0.0, -1.0], height: 0.8 }.certain()
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Biconic {
        let aperture = between(rng, 0.4, 1.2);
        let mut pair = |lo: f64, hi: f64| [between(rng, lo, hi), between(rng, lo, hi)];
        let curvatures = pair(-0.8, 0.8).map(|c| c / aperture);
        let conics = pair(-2.0, 0.4);
        let height = if rng() < 0.2 { f64::INFINITY } else { between(rng, 0.2, 1.5) };
        Given { aperture, curvatures, conics, height }.certain()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, message};
    use super::*;
    use rayweave_math::Vec3;

    #[test]
    fn biconics_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let solid = Biconic::new(scale, [0.9 / scale, -0.5 / scale], [0.1, -2.0], 0.7 * scale).unwrap();
            check_inside(&solid, 1.2 * Vec3::splat(scale), |p| {
                let p = p / scale;
                let root = 1.0 - 1.1 * 0.81 * p.x * p.x + 0.25 * p.y * p.y;
                let sag = (0.9 * p.x * p.x - 0.5 * p.y * p.y) / (1.0 + root.max(0.0).sqrt());
                p.x * p.x + p.y * p.y < 1.0 && sag < p.z && p.z < 0.7
            });
        }
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert!(message(Biconic::new(1.0, [0.1, 2.0], [0.0, 0.0], 1.0)).contains("the conic ends at 0.5"));
        assert!(message(Biconic::new(1.0, [0.1, f64::NAN], [0.0, 0.0], 1.0)).contains("curvature_y is nan"));
    }
}
