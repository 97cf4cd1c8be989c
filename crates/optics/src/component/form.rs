//! Freeform optical surfaces: biconic, toroidal, polynomial and Zernike sag.

use super::Asphere;
use super::error::finite;
use super::{ComponentError, face::Profile};
use rayweave_error::Message;
use rayweave_math::sin_cos_degrees;
use rayweave_shape::primitive::{self, Primitive};
use rayweave_shape::surface::sag::{MAX_DEGREE, Zernike, zernike_terms};

/// The part of a surface beyond radius, conic constant and terms in powers of the distance from the axis.
///
/// Radii, curvatures and coefficients have the usual sign: a surface with positive ones curves towards +z.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Figure {
    /// None: a surface of revolution about the axis.
    #[default]
    Round,
    /// A separate radius and conic constant along x; those of the surface apply along y, and it has no
    /// terms: `z = (cx x^2 + cy y^2) / (1 + sqrt(1 - (1 + kx) cx^2 x^2 - (1 + ky) cy^2 y^2))`.
    Biconic {
        /// The radius of curvature along x; infinite for none.
        radius_x: f64,
        /// The conic constant along x.
        conic_x: f64,
    },
    /// A curve in the plane x = 0, given by the surface with its even terms as powers of y, rotated
    /// about a line parallel to y: with f the curve and R the radius of rotation,
    /// `z = R - S sqrt((R - f(y))^2 - x^2)` with S the sign of R.
    Toroidal {
        /// The radius of rotation, from the vertex along z to the axis of rotation; infinite for a cylinder.
        turn: f64,
    },
    /// Terms in x and y in addition to even terms in r: coefficients, as lengths, of `x/N`, `y/N`,
    /// `(x/N)^2`, `(x/N) (y/N)`, `(y/N)^2`, `(x/N)^3`, ...: degree by degree, each with falling
    /// powers of x, up to degree 30.
    Polynomial {
        /// The length N by which x and y are divided.
        norm_radius: f64,
        /// The coefficients.
        coefficients: Vec<f64>,
    },
    /// Zernike polynomials of `(x/N, y/N)` in addition to even terms in r, up to degree 30. They
    /// continue beyond the disc of radius N.
    Zernike {
        /// The numbering and normalisation.
        order: Zernike,
        /// The length N by which x and y are divided.
        norm_radius: f64,
        /// The coefficients, as lengths, in that order.
        coefficients: Vec<f64>,
    },
}

/// An optical surface with its vertex at the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceForm {
    /// Radius, conic constant and terms.
    pub asphere: Asphere,
    /// The deviation from that surface of revolution.
    pub figure: Figure,
    /// The terms `c x^i y^j` of the figure and of the even powers of r.
    terms: Vec<(u32, u32, f64)>,
}

impl From<Asphere> for SurfaceForm {
    fn from(asphere: Asphere) -> SurfaceForm {
        SurfaceForm { asphere, figure: Figure::Round, terms: Vec::new() }
    }
}

impl SurfaceForm {
    /// A surface with a figure.
    ///
    /// ```
    /// use rayweave_optics::component::{Asphere, Figure, SurfaceForm};
    ///
    /// // a cylinder of radius 5 that is curved along y
    /// let cylinder = SurfaceForm::new(Asphere::conic(5.0, 0.0), Figure::Toroidal { turn: f64::INFINITY });
    /// assert!((cylinder.sag([7.0, 3.0]).unwrap() - 1.0).abs() < 1e-15);
    /// ```
    pub fn new(asphere: Asphere, figure: Figure) -> SurfaceForm {
        let terms = match &figure {
            Figure::Polynomial { norm_radius, coefficients } => polynomial(*norm_radius, coefficients),
            Figure::Zernike { order, norm_radius, coefficients } => {
                zernike_terms(*order, coefficients, *norm_radius)
            }
            _ => Vec::new(),
        };
        let round = if terms.is_empty() { Vec::new() } else { round_terms(&asphere.even) };
        SurfaceForm { asphere, terms: terms.into_iter().chain(round).collect(), figure }
    }

    /// True for a surface of revolution about the axis.
    pub fn is_round(&self) -> bool {
        self.terms.is_empty() && !matches!(self.figure, Figure::Biconic { .. } | Figure::Toroidal { .. })
    }

    /// The sag, the height above the vertex plane; `None` beyond the end of the surface.
    pub fn sag(&self, point: [f64; 2]) -> Option<f64> {
        match self.is_round() {
            true => self.asphere.sag(libm::hypot(point[0], point[1])),
            false => self.sag_and_slopes(point).map(|[sag, ..]| sag),
        }
    }

    /// The sag and its derivatives along x and y; `None` beyond the end of the surface and where it
    /// is vertical.
    pub fn sag_and_slopes(&self, [x, y]: [f64; 2]) -> Option<[f64; 3]> {
        let Asphere { radius, conic, .. } = self.asphere;
        match self.figure {
            _ if self.is_round() => {
                let r = libm::hypot(x, y);
                let [sag, slope] = curve(&self.asphere, r)?;
                let slope = if r > 0.0 { slope / r } else { 0.0 };
                Some([sag, slope * x, slope * y])
            }
            Figure::Biconic { radius_x, conic_x } => {
                biconic([1.0 / radius_x, 1.0 / radius], [conic_x, conic], [x, y])
            }
            Figure::Toroidal { turn } => {
                let [f, slope] = curve(&self.asphere, y)?;
                if turn.is_infinite() {
                    return Some([f, 0.0, slope]);
                }
                let rest = (turn - f) * (turn - f) - x * x;
                let root = rest.sqrt().copysign(turn);
                // R - f - root without cancellation
                let bend = x * x / (turn - f + root);
                (rest > 0.0 && (turn - f) * turn > 0.0)
                    .then(|| [f + bend, x / root, slope * (turn - f) / root])
            }
            _ => {
                let base = biconic([1.0 / radius; 2], [conic; 2], [x, y])?;
                Some(self.terms.iter().fold(base, |sum, term| plus(sum, term, [x, y])))
            }
        }
    }

    /// Unit vectors perpendicular to the axis, along which the surface is sampled to find its
    /// extent: one for a surface of revolution, otherwise 32.
    pub fn directions(&self) -> impl Iterator<Item = [f64; 2]> + use<> {
        let count = if self.is_round() { 1 } else { 32 };
        (0..count).map(move |k| {
            let (sin, cos) = sin_cos_degrees(f64::from(k) * 360.0 / f64::from(count));
            [cos, sin]
        })
    }

    /// The distance from the axis at which the surface ends, if that is less than `reach`.
    pub fn end_within(&self, reach: f64) -> Option<f64> {
        let is_there = |r: f64| self.directions().all(|[x, y]| self.sag([r * x, r * y]).is_some());
        if is_there(reach) {
            return None;
        }
        let (mut good, mut bad) = (0.0, reach);
        for _ in 0..60 {
            let middle = 0.5 * (good + bad);
            if is_there(middle) { good = middle } else { bad = middle }
        }
        Some(good)
    }

    /// The curvatures at the vertex along x and y.
    pub fn curvatures(&self) -> [f64; 2] {
        let along_y = 1.0 / self.asphere.radius + 2.0 * self.asphere.even[0];
        match self.figure {
            Figure::Biconic { radius_x, .. } => [1.0 / radius_x, along_y],
            Figure::Toroidal { turn } => [1.0 / turn, along_y],
            _ if self.is_round() => [along_y; 2],
            _ => [[2, 0], [0, 2]].map(|power| {
                let here = self.terms.iter().filter(|&&(i, j, _)| [i, j] == power);
                1.0 / self.asphere.radius + here.map(|term| 2.0 * term.2).sum::<f64>()
            }),
        }
    }

    /// The surface seen from the other side.
    pub(super) fn reversed(&self) -> SurfaceForm {
        let Asphere { radius, conic, even, odd } = self.asphere;
        let [even, odd] = [even, odd].map(|terms| terms.map(|c| -c));
        let negative = |coefficients: &[f64]| coefficients.iter().map(|c| -c).collect();
        let figure = match &self.figure {
            Figure::Round => Figure::Round,
            &Figure::Biconic { radius_x, conic_x } => Figure::Biconic { radius_x: -radius_x, conic_x },
            Figure::Toroidal { turn } => Figure::Toroidal { turn: -turn },
            Figure::Polynomial { norm_radius, coefficients } => {
                Figure::Polynomial { norm_radius: *norm_radius, coefficients: negative(coefficients) }
            }
            Figure::Zernike { order, norm_radius, coefficients } => Figure::Zernike {
                order: *order,
                norm_radius: *norm_radius,
                coefficients: negative(coefficients),
            },
        };
        SurfaceForm::new(Asphere { radius: -radius, conic, even, odd }, figure)
    }

    /// The same form, if all its parameters are in range and consistent.
    ///
    /// # Errors
    /// [`ComponentError`], whose message contains `part` and the `name` of the surface.
    pub fn checked(self, part: &'static str, name: &str) -> Result<SurfaceForm, ComponentError> {
        Profile::asphere(&self.asphere).checked(part, name)?;
        let radius = |parameter: &str, value: f64| match value == 0.0 || value.is_nan() {
            true => Err(ComponentError::Radius { part, parameter: format!("{parameter} of {name}"), value }),
            false => Ok(()),
        };
        let Asphere { even, odd, .. } = self.asphere;
        match &self.figure {
            Figure::Round => return Ok(self),
            Figure::Biconic { radius_x, conic_x } => {
                radius("radius_x", *radius_x)?;
                finite(part, format!("conic_x of {name}"), *conic_x)?;
            }
            Figure::Toroidal { turn } => radius("turn", *turn)?,
            Figure::Polynomial { norm_radius, coefficients }
            | Figure::Zernike { norm_radius, coefficients, .. } => {
                super::error::positive(part, format!("norm_radius of {name}"), *norm_radius)?;
                for &c in coefficients {
                    finite(part, format!("a coefficient of {name}"), c)?;
                }
            }
        }
        let has_even = even != [0.0; 8] && matches!(self.figure, Figure::Biconic { .. });
        super::error::consistent(!has_even && odd == [0.0; 8], || {
            let which = if has_even { "even" } else { "odd" };
            let problem = format!("{name} of the {part} has {which} terms in r");
            Message::new(problem, format!("a {} has none", self.kind()))
        })?;
        let degree = self.terms.iter().map(|&(i, j, _)| (i + j) as usize).max().unwrap_or(0);
        super::error::consistent(degree <= MAX_DEGREE, || {
            let problem = format!("{name} of the {part} has terms of degree {degree}");
            Message::new(problem, format!("the highest degree is {MAX_DEGREE}")).suggest("Omit them")
        })?;
        Ok(self)
    }

    fn kind(&self) -> &'static str {
        match self.figure {
            Figure::Round => "surface of revolution",
            Figure::Biconic { .. } => "biconic",
            Figure::Toroidal { .. } => "toroid",
            Figure::Polynomial { .. } => "surface with terms in x and y",
            Figure::Zernike { .. } => "surface with Zernike polynomials",
        }
    }

    /// The body above the surface over a circular aperture.
    pub(super) fn above(&self, part: &'static str, aperture: f64) -> Result<Primitive, ComponentError> {
        let Asphere { radius, conic, even, .. } = self.asphere;
        let has_terms = even != [0.0; 8];
        let along_y = |k: [f64; 2], c: [f64; 2]| primitive::Biconic::new(aperture, c, k, f64::INFINITY);
        Ok(match self.figure {
            Figure::Biconic { radius_x, conic_x } => {
                along_y([conic_x, conic], [1.0 / radius_x, 1.0 / radius])?.into()
            }
            Figure::Toroidal { turn } if turn.is_infinite() && !has_terms => {
                along_y([0.0, conic], [0.0, 1.0 / radius])?.into()
            }
            Figure::Toroidal { turn } if turn.is_infinite() && radius.is_infinite() => {
                let in_y = (2..).step_by(2).zip(even).map(|(power, c)| (0, power, c));
                self.freeform(aperture, &in_y.collect::<Vec<_>>())?.into()
            }
            Figure::Toroidal { .. } => {
                let problem = format!(
                    "toroid of the {part} has a profile that is not a circle, or is a spindle toroid"
                );
                let reason = "solids of toroids need a circular profile and a radius of rotation of at least its \
                              radius, or a cylinder; only sequential ray tracing accepts any profile";
                return Err(ComponentError::Inconsistent(
                    Message::new(problem, reason).suggest("Use a biconic"),
                ));
            }
            _ => self.freeform(aperture, &self.terms)?.into(),
        })
    }

    fn freeform(
        &self,
        aperture: f64,
        terms: &[(u32, u32, f64)],
    ) -> Result<primitive::Freeform, ComponentError> {
        let (mut list, mut level) = (Vec::new(), 0.0);
        for &(i, j, c) in terms {
            let (degree, length) = ((i + j) as usize, (0..i + j).fold(c, |c, _| c * aperture));
            if degree == 0 {
                level += length;
                continue;
            }
            let place = degree * (degree + 1) / 2 - 1 + j as usize;
            list.resize(list.len().max(place + 1), 0.0);
            list[place] += length;
        }
        // Noll's first polynomial is 1
        let base = [1.0 / self.asphere.radius, self.asphere.conic];
        Ok(primitive::Freeform::new(aperture, base, [&list, &[level]], aperture, f64::INFINITY)?)
    }
}

/// The sag of a curve at a distance `r` from its vertex, and its slope; `None` beyond its end and
/// where it is vertical.
fn curve(of: &Asphere, r: f64) -> Option<[f64; 2]> {
    let (c, square) = (1.0 / of.radius, r * r);
    let root = (1.0 - (1.0 + of.conic) * c * c * square).sqrt();
    let even = (0..8).rev().fold(0.0, |sum, k| sum * square + (2 * k + 2) as f64 * of.even[k]);
    let odd = (0..8).rev().fold(0.0, |sum, k| sum * square + (2 * k + 1) as f64 * of.odd[k]);
    // the slope is undefined at the tip of a cone: 0
    let tip = if r == 0.0 { 0.0 } else { odd };
    let sag = of.sag(r.abs())?;
    (root > 0.0).then_some([sag, r * (c / root + even) + tip])
}

fn biconic(c: [f64; 2], k: [f64; 2], point: [f64; 2]) -> Option<[f64; 3]> {
    let [x, y] = point;
    let g = [0, 1].map(|i| (1.0 + k[i]) * c[i] * c[i]);
    let root = (1.0 - g[0] * x * x - g[1] * y * y).sqrt();
    let bend = c[0] * x * x + c[1] * y * y;
    let sum = 1.0 + root;
    // d(bend / sum), with d root = -g x / root
    let slope = |i: usize| point[i] * (2.0 * c[i] / sum + bend * g[i] / (sum * sum * root));
    (root > 0.0).then(|| [bend / sum, slope(0), slope(1)])
}

/// Adds a term to a sum and its derivatives.
fn plus(sum: [f64; 3], &(i, j, c): &(u32, u32, f64), [x, y]: [f64; 2]) -> [f64; 3] {
    let power = |base: f64, n: u32| (0..n).fold(1.0, |power, _| power * base);
    let below = |base: f64, n: u32| if n == 0 { 0.0 } else { f64::from(n) * power(base, n - 1) };
    let (along_x, along_y) = (power(x, i), power(y, j));
    [sum[0] + c * along_x * along_y, sum[1] + c * below(x, i) * along_y, sum[2] + c * along_x * below(y, j)]
}

/// Terms of x / norm and y / norm in the order of [`Figure::Polynomial`].
fn polynomial(norm: f64, coefficients: &[f64]) -> Vec<(u32, u32, f64)> {
    let powers = (1u32..).flat_map(|degree| (0..=degree).map(move |j| (degree - j, j)));
    let scaled = |((i, j), c): ((u32, u32), &f64)| (i, j, (0..i + j).fold(*c, |c, _| c / norm));
    powers.zip(coefficients).map(scaled).filter(|term| term.2 != 0.0).collect()
}

/// Terms in x and y of even powers of r.
fn round_terms(even: &[f64; 8]) -> Vec<(u32, u32, f64)> {
    let mut terms = Vec::new();
    for (n, &c) in (1u32..).zip(even).filter(|(_, c)| **c != 0.0) {
        let mut binomial = 1.0;
        for q in 0..=n {
            terms.push((2 * (n - q), 2 * q, c * binomial));
            binomial *= f64::from(n - q) / f64::from(q + 1);
        }
    }
    terms
}
