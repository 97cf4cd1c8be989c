//! The functions of J. Stolfi's module *rootray* ("Tools for ray-tracing csg models in arbitrary spaces and rays", 2021),
//! under the names given there.
//!
//! The publication assumes that two crossing times that are very close result from rounding, and drops them. The functions of
//! this module therefore [`weld`](crate::RootRay::weld) their results with [`min_sep`], while the methods of [`RootRay`] are
//! exact. The module writes a root-ray as a pair `(s, T)`, where `s` is +1 in the
//! exterior and -1 in the interior: see [`from_pair`] and [`to_pair`].
//!
//! ```
//! use rayweave_rootray::seed;
//!
//! let f = seed::from_pair(1, &[1.0, 2.0])?;
//! let g = seed::from_pair(1, &[2.0 + 1e-15, 3.0])?;
//! assert_eq!(seed::to_pair(&seed::union(&f, &g)), (1, vec![1.0, 3.0]));
//! assert_eq!(f.union(&g).roots().len(), 4);
//! # Ok::<(), rayweave_rootray::RootRayError>(())
//! ```

pub use crate::min_sep;
use crate::{Problem, RootRay, RootRayError, Side};

/// The root-ray of the pair `(sign, times)`: sign +1 starts outside, -1 inside.
///
/// # Errors
/// `Sign` for any other sign; else as [`RootRay::new`].
pub fn from_pair(sign: i64, times: &[f64]) -> Result<RootRay, RootRayError> {
    let start = match sign {
        1 => Side::Outside,
        -1 => Side::Inside,
        _ => return Err(RootRayError::Sign { sign }),
    };
    RootRay::from_times(start, times.iter().copied())
}

/// The pair `(sign, times)` of a root-ray: sign +1 starts outside, -1 inside.
pub fn to_pair<S>(f: &RootRay<S>) -> (i64, Vec<f64>) {
    let sign = if f.start().is_inside() { -1 } else { 1 };
    (sign, f.times().collect())
}

/// The root-ray that is always outside: neutral for [`union`], absorbing for [`intersection`].
pub const fn vacuum() -> RootRay {
    RootRay::empty()
}

/// The root-ray that is always inside: neutral for [`intersection`], absorbing for [`union`].
pub const fn plenum() -> RootRay {
    RootRay::universe()
}

/// The root-ray of the complement: the same times, the other start side. Exact.
pub fn complement(f: &RootRay) -> RootRay {
    f.complement()
}

/// The root-ray of the union, welded: a very thin gap between the two disappears.
pub fn union(f1: &RootRay, f2: &RootRay) -> RootRay {
    f1.union(f2).weld(min_sep)
}

/// The root-ray of the intersection, welded: a very thin layer where the two barely overlap disappears.
pub fn intersection(f1: &RootRay, f2: &RootRay) -> RootRay {
    f1.intersection(f2).weld(min_sep)
}

/// The root-ray of `f1` without `f2`, welded: a very thin layer left over disappears.
pub fn difference(f1: &RootRay, f2: &RootRay) -> RootRay {
    f1.difference(f2).weld(min_sep)
}

/// The root-ray of what is in exactly one of the two, welded.
pub fn symmetric_difference(f1: &RootRay, f2: &RootRay) -> RootRay {
    f1.symmetric_difference(f2).weld(min_sep)
}

/// The part of `f` with `tmin < t < tmax`, welded: see [`RootRay::clip`].
///
/// The side just after `tmin` continues to minus infinity, and that just before `tmax` to infinity.
///
/// # Errors
/// As [`RootRay::clip`].
pub fn clip_time(f: &RootRay, tmin: f64, tmax: f64) -> Result<RootRay, RootRayError> {
    Ok(f.clip(tmin, tmax)?.weld(min_sep))
}

/// Questionable roots of `f`: neighbours closer than [`min_sep`]. [`validate_times`](crate::validate_times) checks plain lists
/// of times.
pub fn validate(f: &RootRay) -> Vec<Problem> {
    f.validate()
}
