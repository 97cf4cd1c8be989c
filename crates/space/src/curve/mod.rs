//! Curves r(t) in R^d: lines, parabolas, arcs, helices, splines, and user-defined ones by the trait [`Curve`].

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

/// The tolerance for violations of the contract of [`Curve`], relative to [`Curve::size`]. The contract holds up to rounding, and
/// user functions may lose digits. A curve with a smaller violation is traced, with roots that are wrong by as much.
pub(crate) const CONTRACT_TOLERANCE: f64 = 1e-11;

/// A curve with a bound on its second derivative.
///
/// Isolation evaluates the curve at some times and derives enclosures between them from the bound. *Contract*: `r` is continuously
/// differentiable, and `|r(t) - r(s) - v(s) (t - s)| <= A (t - s)^2 / 2` for s and t in `[t0, t1]` with
/// `A = acceleration_bound(t0, t1)`. A detected violation is a [`CurveError`].
pub trait Curve<const D: usize> {
    /// The position r(t).
    fn position(&self, t: f64) -> Point<D>;

    /// The velocity r'(t).
    fn velocity(&self, t: f64) -> Point<D>;

    /// An upper bound of `|r''|` (Euclidean norm) between two times, `t0 < t1`: finite, 0 for a straight line. Tighter bounds mean
    /// less work.
    fn acceleration_bound(&self, t0: f64, t1: f64) -> f64;

    /// The first and the last time of the curve; infinite if it is unbounded.
    fn domain(&self) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    /// The sum of the lengths from which `position(t)` is computed: the rounding error of the position is at most a few unit
    /// roundoffs times this size. A larger size widens the zone around a surface in which the curve counts as *on* it.
    ///
    /// Less accurate functions, with an error e, should return a size of at least e / 1e-15. Otherwise a curve that touches a
    /// surface may be reported to cross it.
    ///
    /// The default, `|r(t)| + |t| |r'(t)|`, holds for positions computed from `t` and lengths of the magnitude of the result.
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
