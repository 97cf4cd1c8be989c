//! Surfaces of degree 2 along a ray.
//!
//! With q = r(t) - centre, `f = a t^2 + 2 b t + c`. The coefficients are computed where little precision is lost: first at
//! the closest approach to the surface's centre, and, if `b^2 - a c` still cancels there (a long thin ellipsoid, a ray far
//! out along a cone), again at the extremum -b/a of f. A shift costs a rounding of the point, u (|o| + |t| |d|), the same
//! as for the ray itself; the remaining error of f is relative to its terms *at the point of evaluation*.

//!
//! # Crossings that cannot be distinguished from none
//!
//! The leading coefficient `a` (for a plane, `n . d`) carries the rounding of the direction's components along the
//! surface's axes: those axes are rounded to 2 u per component, a dot product of three terms to 3 u, so that `e . d` is
//! uncertain by 5 u times the sum of the absolute values of its terms. Where `a` is smaller than that, even its sign is
//! unknown: the ray may just as well be parallel to the plane, or asymptotic to the quadric, and a crossing that exists
//! only because of `a` would be reported at times of 1e8 (quadrics) or 1e15 (planes). Such a crossing is dropped; others
//! keep their bits.
//!
//! This stays within the tolerance of surfaces, `delta(t) = 64 u (|o| + |t| |d| + ...)`: a plane is off the ray by less
//! than `8 sqrt(3) u |t| |d|` where the side is wrong, and f of a quadric changes by `noise t^2` where its gradient is of
//! the order of `|t| |d|`. If the normal or axis is a coordinate axis, each sum has a single term, which exceeds its own
//! error bound: a plane across a coordinate axis, or a cylinder along one, loses no crossing.

use super::SurfaceCrossings;
use crate::Ray;
use crate::real::Real;
use rayweave_math::roots::{Crossings, quadratic};
use rayweave_math::{UNIT_ROUNDOFF, Vec3};

/// Relative error of `e . d` for a rounded unit vector e, 5 u, with room.
pub const DOT_NOISE: f64 = 8.0 * UNIT_ROUNDOFF;

/// Relative error of a square term: twice that of each factor, and of the sums.
pub const SQUARE_NOISE: f64 = 16.0 * UNIT_ROUNDOFF;

/// The sum of the absolute values of the components.
pub fn taxicab(v: Vec3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// `n . d`, or 0 if its sign may be due to rounding.
pub fn certain_dot(n: Vec3, d: Vec3) -> f64 {
    let dot = n.dot(d);
    if dot.abs() <= DOT_NOISE * n.abs().dot(d.abs()) { 0.0 } else { dot }
}

/// A ray at its closest approach to the centre of a sphere, or to the axis of a cylinder in the plane perpendicular to it.
#[derive(Clone, Copy, Debug)]
pub struct Approach<R> {
    /// The time of the closest approach; 0 for a ray parallel to the axis.
    pub time: R,
    /// The squared speed; 0 for a ray parallel to the axis.
    pub square: R,
    /// The squared radius minus the squared distance at that time: -f.
    pub inside: R,
}

impl<R: Real> Approach<R> {
    /// The time of the closest approach from the squared speed and the product of position and velocity; 0 if the speed is 0.
    #[inline(always)]
    pub fn time(square: R, product: R) -> R {
        R::select(square.is_zero(), square.splat(0.0), -product / square)
    }

    /// Half of the time that the ray spends inside, if it enters.
    #[inline(always)]
    pub fn half(&self) -> R {
        (self.inside / self.square).sqrt()
    }
}

impl Approach<f64> {
    /// The crossings of a single ray.
    #[inline(always)]
    pub fn crossings(&self) -> Crossings<2> {
        let &Approach { time, square, inside } = self;
        if inside.is_nan() || inside <= 0.0 || square == 0.0 {
            return Crossings::constant(inside > 0.0);
        }
        let half = self.half();
        // a ray that diverges from an axis by 1e-150 per unit of time has a finite interval, although its square overflows
        let half = if half.is_finite() { half } else { inside.sqrt() / square.sqrt() };
        Crossings::new(false, &[time - half, time + half])
    }
}

/// Coefficients `[a, b, c]` of `a t^2 + 2 b t + c`.
pub type Coefficients = [f64; 3];

/// Time of closest approach to `centre`, and that point relative to it.
pub fn recentred(ray: &Ray, centre: Vec3) -> (f64, Vec3) {
    let shift = ray.closest_time(centre);
    (shift, (ray.origin - centre) + shift * ray.direction)
}

/// Crossings of a surface of degree 2 from its coefficients `at(s)` about the time `shift + s`.
///
/// `at` shifts each coordinate of the surface's own frame separately. For a cylinder and a ray that is parallel to its axis
/// up to rounding, the perpendicular coordinate moves by 1 in a time of 1e16, and a shift in world coordinates would lose
/// the extremum in the rounding of the axial one.
///
/// `noise` bounds the error of `a`; 0 if `a` is exact.
///
/// The lane form is in `lanes/quadratic.rs`; both give the same bits, tested by `tests/lanes.rs`.
pub fn quadratic_crossings(shift: f64, noise: f64, at: impl Fn(f64) -> Coefficients) -> Crossings<2> {
    let [a, b, c] = at(0.0);
    if noise > 0.0 && a.abs() <= noise {
        return without_far_roots(quadratic(a, b, c), noise, c).shifted(shift);
    }
    let again = -b / a;
    if cancels(a, b, c) && again.is_finite() {
        let [a, b, c] = at(again);
        return quadratic(a, b, c).shifted(shift + again);
    }
    quadratic(a, b, c).shifted(shift)
}

/// The crossings without those that may be due to an error of `noise` in the square term: those at which `noise t^2` is at
/// least |c|, with f(0) = c.
fn without_far_roots(crossings: Crossings<2>, noise: f64, c: f64) -> Crossings<2> {
    let times = crossings.times();
    let is_far = |t: f64| t != 0.0 && noise * t * t >= c.abs();
    let before = times.iter().filter(|&&t| is_far(t) && t < 0.0).count();
    let mut kept = [f64::INFINITY; 2];
    for (slot, &t) in kept.iter_mut().zip(times.iter().filter(|&&t| !is_far(t))) {
        *slot = t;
    }
    Crossings::new(crossings.starts_negative() != (before == 1), &kept)
}

/// True if `b^2` and `a c` are equal within a factor of 2, so that their difference has fewer correct digits.
fn cancels(a: f64, b: f64, c: f64) -> bool {
    let (square, product) = (b * b, a * c);
    2.0 * (square - product).abs() < square
}

/// A surface along a ray that starts on it, with the root at the start divided out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    /// The side just after the start; `None` if the ray lies in the surface.
    pub negative_after: Option<bool>,
    /// The remaining sign changes, all > 0.
    pub times: Crossings<4>,
}

impl Departure {
    /// Departure for `f(r(t)) = a t^2 + 2 b t`: dividing by t leaves the root `-2 b / a`.
    pub fn quadratic([a, half_b]: [f64; 2]) -> Departure {
        let leading = if half_b == 0.0 { a } else { half_b };
        let t = -2.0 * half_b / a;
        let remaining = [if t > 0.0 { t } else { f64::INFINITY }];
        Departure {
            negative_after: (leading != 0.0).then_some(leading < 0.0),
            times: Crossings::new(leading < 0.0, &remaining),
        }
    }

    /// Refines the remaining root of a quadric by one Newton step. The start lies on the surface only up to rounding, and
    /// its residual f(0) may exceed f itself far from the start, e.g. near the apex of a cone. A large step is rejected,
    /// since it could lead back to the root at the start.
    pub fn polished(self, step: impl FnOnce(f64) -> f64) -> Departure {
        let &[t] = self.times.times() else {
            return self;
        };
        let step = step(t);
        if step.abs() <= 1e-6 * t {
            return Departure { times: self.times.shifted(-step), ..self };
        }
        self
    }

    /// Crossings of a ray that is on the side `inside` just after its start according to the start list. `along_w` is the
    /// side of a ray that lies in the surface. If list and direction disagree, the first time is 0.
    pub fn crossings(&self, inside: bool, along_w: impl FnOnce() -> bool) -> SurfaceCrossings {
        let is_inside_after = self.negative_after.unwrap_or_else(along_w);
        let mut times = [0.0; 4];
        let rest = self.times.times();
        let count = rest.len().min(3);
        times[1..=count].copy_from_slice(&rest[..count]);
        let first = usize::from(is_inside_after == inside);
        Crossings::new(inside, &times[first..=count])
    }
}
