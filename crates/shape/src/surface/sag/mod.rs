//! Sag surfaces (aspheres, freeforms): `z = sag(x, y)` over a round aperture, with the inside below,
//! `f = z - sag(x, y) < 0`.
//!
//! The sag is a [base](Base), a conic of revolution or a biconic, plus terms in r^2, in odd powers of r, and in x and y
//! ([`Description`]). It is defined within the aperture, a circle about the z axis. *Beyond the aperture the surface
//! continues level*: each point has the sag of the rim in its direction, so f is defined and continuous everywhere.
//! Primitives clip the surface at the rim.
//!
//! # Guarantees
//!
//! No crossing within the aperture is missed or invented, wherever the ray starts and whatever the terms: roots of f
//! along the ray are isolated by bounds of the second derivative, computed for each piece of the ray with outward
//! rounding (see `isolate.rs`). The bounds are those of polynomials shifted to the middle of the piece, and closed forms
//! of the base. Two crossings count as none if between them the ray leaves the surface by less than the rounding of f,
//! `u (16 size + 4 R)` with the sum of the magnitudes of its terms and the aperture's radius R, which is within the
//! `64 u (|o| + |t| |d| + magnitude)` of all kernels; or if they lie on a piece of the ray that is parallel to z to within
//! `2 u R` (at a vertical rim the surface may be as steep as that). At the tip of an odd term and at a vertical rim,
//! where the second derivative is unbounded, its sign and bounds of the slope decide. Beyond the aperture a surface of
//! revolution is a plane; for other surfaces only the parity of the crossings there is guaranteed.
//!
//! A steep conic may be vertical at the rim, `(1 + k) c^2 R^2 = 1`, but must not end inside it.

mod base;
mod isolate;
mod line;
mod polynomial;
mod profile;
mod zernike;

pub use base::Base;
pub use polynomial::MAX_DEGREE;
pub use profile::Description;
pub use zernike::{Zernike, zernike_terms};

use super::object::{Departing, Form};
use crate::Ray;
use line::Line;
use profile::{Along, Profile};
use rayweave_math::{Bounds, Interval, UNIT_ROUNDOFF, Vec3};
use std::any::Any;

/// A sag surface about its vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Sag {
    profile: Profile,
    /// Bounds of the sag over the whole surface.
    low: f64,
    high: f64,
    /// Upper bound of the slope in the aperture; infinite for a conic that is vertical at the rim.
    steepest: f64,
    /// Sag at the rim, for a surface of revolution.
    rim: Option<f64>,
    noise: f64,
}

/// The reason why a sag surface does not exist.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SagError {
    /// The root of the base is imaginary in a part of the aperture.
    #[error(
        "the aperture's radius is {aperture}: the conic ends at {end}, where its square root becomes imaginary. Is the curvature too large?"
    )]
    Imaginary {
        /// Radius of the aperture.
        aperture: f64,
        /// Distance from the axis at which the base ends.
        end: f64,
    },
    /// A number is NaN or infinite, or a term exceeds 1e60 at the rim, or the aperture's radius is not positive.
    #[error(
        "the sag is not finite: the aperture has radius {aperture}, and the terms add up to {size} at the rim. Is the unit right?"
    )]
    NotFinite {
        /// Radius of the aperture.
        aperture: f64,
        /// Sum of the magnitudes of the terms at the rim.
        size: f64,
    },
    /// A power or a number of coefficients beyond [`MAX_DEGREE`].
    #[error(
        "a term has degree {degree}: the limits are degree {MAX_DEGREE} in x and y, and {MAX_DEGREE} coefficients in r. Remove the term."
    )]
    TooManyTerms {
        /// The degree, or the number of coefficients.
        degree: usize,
    },
}

impl Sag {
    /// The surface of a description.
    ///
    /// # Errors
    /// [`SagError`].
    pub fn new(of: &Description) -> Result<Sag, SagError> {
        check(of)?;
        let profile = Profile::new(of);
        let size = profile.size();
        match size <= 1e60 {
            true => Ok(Sag::with(profile)),
            false => Err(SagError::NotFinite { aperture: of.aperture, size }),
        }
    }

    /// The surface of a valid description.
    pub(crate) fn unchecked(of: &Description) -> Sag {
        Sag::with(Profile::new(of))
    }

    fn with(profile: Profile) -> Sag {
        let ([low, high], steepest) =
            if profile.is_round() { round_extent(&profile) } else { extent(&profile) };
        let rim = profile.is_round().then(|| profile.value_and_gradient(profile.aperture, 0.0)[0]);
        let noise = UNIT_ROUNDOFF * (16.0 * profile.size() + 4.0 * profile.aperture);
        Sag { low: low - noise, high: high + noise, steepest, rim, noise, profile }
    }

    /// Radius of the aperture.
    pub fn aperture(&self) -> f64 {
        self.profile.aperture
    }

    /// Bounds of z over the whole surface.
    ///
    /// For a level base they exceed the lowest and highest points by at most 2 % of the depth of the terms in r, plus 2 % of the
    /// depth of the terms in x and y. Where these two kinds or the base cancel each other, they may exceed them by the smaller
    /// of the depths as well.
    pub fn heights(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Sag and its derivatives with respect to x and y; beyond the aperture those of the rim.
    #[inline]
    pub fn sag(&self, x: f64, y: f64) -> [f64; 3] {
        let radius = self.profile.aperture;
        let square = x * x + y * y;
        if square <= radius * radius {
            return self.profile.value_and_gradient(x, y);
        }
        let r = square.sqrt();
        let (cos, sin) = (x / r, y / r);
        if let Some(rim) = self.rim {
            return [rim, 0.0, 0.0];
        }
        let [value, by_x, by_y] = self.profile.value_and_gradient(radius * cos, radius * sin);
        let around = (by_y * cos - by_x * sin) * (radius / r);
        [value, -around * sin, around * cos]
    }

    /// Bounds of the sag over a box that extends beyond the aperture.
    fn ranges_beyond(&self, x: Interval, y: Interval, r: Interval) -> [Interval; 3] {
        let (radius, inverse) = (self.profile.aperture, r.positive_recip());
        let whole = Interval::around(0.0, radius);
        let onto = |v: Interval| (v * inverse * radius).narrowed(whole);
        let [value, by_x, by_y] = self.profile.ranges(onto(x), onto(y));
        let most = length(by_x, by_y);
        let around = match self.rim {
            Some(_) => Interval::point(0.0),
            None => Interval::around(0.0, most),
        };
        [value, around, around]
    }
}

fn check(of: &Description) -> Result<(), SagError> {
    let (aperture, [c, k]) = match of.base {
        Base::Conic { curvature, conic } => (of.aperture, [[curvature; 2], [conic; 2]]),
        Base::Biconic { curvatures, conics } => (of.aperture, [curvatures, conics]),
    };
    let degree = of.mixed.iter().map(|&(i, j, _)| i as usize + j as usize);
    let degree = degree.chain([of.even.len(), of.odd.len()]).max().unwrap_or(0);
    if degree > MAX_DEGREE {
        return Err(SagError::TooManyTerms { degree });
    }
    let numbers =
        c.iter().chain(&k).chain(&of.even).chain(&of.odd).chain(of.mixed.iter().map(|term| &term.2));
    let is_aperture = aperture > 0.0 && aperture.is_finite();
    if !is_aperture || !numbers.into_iter().all(|x| x.is_finite()) {
        return Err(SagError::NotFinite { aperture, size: f64::NAN });
    }
    let steep = (0..2).map(|i| (1.0 + k[i]) * c[i] * c[i]).fold(0.0, f64::max);
    // a radius computed as the end of the conic may exceed it by roundings
    match steep * aperture * aperture <= 1.0 + 8.0 * UNIT_ROUNDOFF {
        true => Ok(()),
        false => Err(SagError::Imaginary { aperture, end: 1.0 / steep.sqrt() }),
    }
}

/// Number of pieces along a radius, or along a side of the aperture, for the extremes of height and slope.
const PIECES: u32 = 32;
const TILES: u32 = 12;

/// Lowest and highest sag, and the largest slope, of a surface of revolution.
fn round_extent(profile: &Profile) -> ([f64; 2], f64) {
    let radius = profile.aperture;
    let along = Along::new(profile, [0.0, 1.0], [0.0, 0.0]);
    let terms = profile.sum_of_terms();
    let (mut heights, mut steepest) = ([f64::INFINITY, f64::NEG_INFINITY], 0.0f64);
    for k in 0..PIECES {
        let place = |k: u32| radius * f64::from(k) / f64::from(PIECES);
        let (from, to) = (place(k), place(k + 1));
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from) * (1.0 + 4.0 * UNIT_ROUNDOFF));
        let (value, slope) = along.at(middle);
        let change = half * along.bend(from, to).magnitude();
        // near the tip of an odd term only the bounds of the slope are finite
        let steep = (slope.abs() + change).min(along.slopes(from, to).magnitude());
        let steep = if steep.is_nan() { f64::INFINITY } else { steep };
        let (x, y) = (Interval::new(from, to), Interval::point(0.0));
        let natural = profile.ranges(x, y)[0].narrowed(profile.base_range(x, y) + terms);
        let value = match slope.abs() > change {
            // monotone: the extremes are at the ends
            true => hull(Interval::point(along.at(from).0), Interval::point(along.at(to).0)),
            false => Interval::around(value, half * steep).narrowed(natural),
        };
        heights = [heights[0].min(value.lo), heights[1].max(value.hi)];
        steepest = steepest.max(steep);
    }
    (heights, steepest)
}

/// The same extremes for any surface, by tiles.
fn extent(profile: &Profile) -> ([f64; 2], f64) {
    let radius = profile.aperture;
    let place = |k: u32| radius * (2.0 * f64::from(k) / f64::from(TILES) - 1.0);
    let terms = profile.sum_of_terms();
    let (mut heights, mut steepest) = ([f64::INFINITY, f64::NEG_INFINITY], 0.0f64);
    for (i, j) in (0..TILES).flat_map(|i| (0..TILES).map(move |j| (i, j))) {
        let [x, y] = [i, j].map(|k| Interval::new(place(k), place(k + 1)));
        if (x.square() + y.square()).lo > radius * radius {
            continue;
        }
        let [natural, by_x, by_y] = profile.ranges(x, y);
        let steep = length(by_x, by_y);
        let steep = if steep.is_nan() { f64::INFINITY } else { steep };
        let value = natural.narrowed(profile.base_range(x, y) + terms);
        heights = [heights[0].min(value.lo), heights[1].max(value.hi)];
        steepest = steepest.max(steep);
    }
    (heights, steepest)
}

impl Form for Sag {
    fn crossings(&self, ray: &Ray, emit: &mut dyn FnMut(f64)) -> bool {
        let (shift, q) = super::along::recentred(ray, Vec3::ZERO);
        Line::new(self, q, ray.direction, 0.0).crossings(&mut |t| emit(shift + t))
    }

    fn crossings_from(&self, start: &Departing<'_>, emit: &mut dyn FnMut(f64)) {
        let Ray { origin, direction } = start.ray;
        let (value, _) = self.value_and_gradient(origin);
        Line::new(self, origin, direction, value).crossings_from(start, emit);
    }

    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let [sag, by_x, by_y] = self.sag(point.x, point.y);
        (point.z - sag, Vec3::new(-by_x, -by_y, 1.0))
    }

    fn degree(&self) -> u8 {
        // number of test points for coincidence with the base: that of a polynomial of moderate degree
        self.profile.degree().clamp(8, 64) as u8
    }

    fn is_ruled(&self) -> bool {
        // an analytic surface of revolution about z over a disc contains a line only if it is level
        let is_level = self.high - self.low <= 1e-9 * self.profile.aperture;
        !self.profile.is_round() || !self.profile.odd.is_zero() || is_level
    }

    fn magnitude(&self) -> f64 {
        // terms that cancel each other leave their rounding errors
        self.profile.aperture + self.profile.size()
    }

    fn inside_bounds(&self) -> Bounds {
        Bounds::new(Vec3::NEG_INFINITY, Vec3::new(f64::INFINITY, f64::INFINITY, self.high))
    }

    fn ranges(&self, cell: &[Interval; 3]) -> (Interval, [Interval; 3]) {
        let [x, y, z] = *cell;
        let (radius, square) = (self.profile.aperture, x.square() + y.square());
        let within = (square.lo <= radius * radius).then(|| self.profile.ranges(x, y));
        let beyond = (square.hi > radius * radius).then(|| self.ranges_beyond(x, y, square.sqrt()));
        let sag = match (within, beyond) {
            (Some(a), Some(b)) => std::array::from_fn(|k| hull(a[k], b[k])),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => [Interval::ALL; 3],
        };
        (z - sag[0], [-sag[1], -sag[2], Interval::point(1.0)])
    }

    fn fingerprint(&self) -> u64 {
        let Profile { aperture, root, even, odd, mixed } = &self.profile;
        let rows = mixed.rows().iter().flat_map(|row| row.coefficients());
        let all = [aperture].into_iter().chain(&root.c).chain(&root.g).chain(even.coefficients());
        let all = all.chain(odd.coefficients()).chain(rows);
        // FNV-1a hash (Fowler, Noll and Vo), word by word
        all.fold(0xcbf2_9ce4_8422_2325, |hash, x| (hash ^ (x + 0.0).to_bits()).wrapping_mul(0x0100_0000_01b3))
    }

    fn is_same(&self, other: &dyn Form) -> bool {
        let other: &dyn Any = other;
        other.downcast_ref::<Sag>().is_some_and(|other| self.profile == other.profile)
    }
}

/// Largest length of a vector in a box.
fn length(x: Interval, y: Interval) -> f64 {
    (x.square() + y.square()).sqrt().hi
}

fn hull(a: Interval, b: Interval) -> Interval {
    Interval::new(a.lo.min(b.lo), a.hi.max(b.hi))
}
