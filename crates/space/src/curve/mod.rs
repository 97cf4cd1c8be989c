//! Trajectories r(t) in R^d, each kind in its own file; and those of a user, who implements [`Curve`].

mod arc;
mod error;
mod helix;
mod line;
mod mapped;
mod parabola;
mod spline;
mod vector;

pub use arc::Arc;
pub use error::CurveError;
pub use helix::Helix;
pub use line::Line;
pub use mapped::Mapped;
pub use parabola::Parabola;
pub use spline::{Spline, SplineEnds};

use crate::Point;
use crate::point::length;

/// How far a curve may be from what it promises, relative to its [`Curve::size`], before it counts as broken. A promise is
/// meant up to rounding, and a user's functions may lose digits; a curve that is off by less than this is followed
/// all the same, with roots that are off by as much.
pub(crate) const TRUST: f64 = 1e-11;

/// A trajectory whose second derivative is bounded.
///
/// Whatever is found on a curve is found from these three functions: isolation evaluates the curve at some times
/// and concludes from the bound what it can do between them. So the bound is a promise: `r` is continuously
/// differentiable, and `|r(t) - r(s) - v(s) (t - s)| <= A (t - s)^2 / 2` for s and t in `[t0, t1]` with
/// `A = acceleration_bound(t0, t1)`. Promises that are seen to be broken are reported as a [`CurveError`].
pub trait Curve<const D: usize> {
    /// r(t).
    fn position(&self, t: f64) -> Point<D>;

    /// r'(t).
    fn velocity(&self, t: f64) -> Point<D>;

    /// A number that `|r''|` (Euclidean) nowhere exceeds between two times, `t0 < t1`: finite, 0 for a straight
    /// line. The closer the bound the less work.
    fn acceleration_bound(&self, t0: f64, t1: f64) -> f64;

    /// The first and the last time at which the curve is defined; infinite where it never begins or ends.
    fn domain(&self) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    /// The sum of the lengths from which `position(t)` is computed, so that the rounding of that point is at most
    /// a few unit roundoffs of it. The larger the size, the wider the zone around a surface in which the curve
    /// counts as being *on* it.
    ///
    /// Functions that are less exact than that, off by e say, should have a size of e / 1e-15 at least, or a curve that
    /// touches a surface may be told to cross it.
    ///
    /// As long as it is not overridden it is `|r(t)| + |t| |r'(t)|`, which holds for everything that is computed
    /// from `t` and lengths of the size of the result.
    fn size(&self, t: f64) -> f64 {
        length(&self.position(t)) + t.abs() * length(&self.velocity(t))
    }
}

impl<const D: usize, C: Curve<D> + ?Sized> Curve<D> for &C {
    fn position(&self, t: f64) -> Point<D> {
        (**self).position(t)
    }

    fn velocity(&self, t: f64) -> Point<D> {
        (**self).velocity(t)
    }

    fn acceleration_bound(&self, t0: f64, t1: f64) -> f64 {
        (**self).acceleration_bound(t0, t1)
    }

    fn domain(&self) -> (f64, f64) {
        (**self).domain()
    }

    fn size(&self, t: f64) -> f64 {
        (**self).size(t)
    }
}
