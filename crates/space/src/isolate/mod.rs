//! Rigorous root isolation: all sign changes of `g(t) = f(r(t))` on a time window, by interval bounds instead of sampling.
//!
//! *Method*: subdivision with interval arithmetic (R. E. Moore, *Interval Analysis* (1966), chapter 7; R. B. Kearfott,
//! *Rigorous Global Search* (1996)). Around the middle m of a piece of half length h the curve satisfies
//! `|r(t) - r(m) - v(m) (t - m)| <= A h^2 / 2` and `|r'(t) - v(m)| <= A h`, with its acceleration bound A on the piece. The
//! curve thus stays in a box, over which the field provides enclosures of f and grad f. Then:
//!
//! 1. If the curve *coincides* with the surface along the piece, that is, stays within `delta = 64 u (size of r + magnitude)` of
//!    it, signs are meaningless there, and the piece is merged with neighbours of the same kind.
//! 2. If the enclosure of f, or that of the mean value form `g(m) + g'(piece) [-h, h]`, does not contain 0, the piece has no
//!    crossing. The width of the mean value form decreases with the square of h.
//! 3. If the enclosure of g' does not contain 0, the piece has one crossing if the signs at its ends differ, otherwise none.
//!    Newton's method safeguarded by bisection finds it, to the last bit that the rounding of values allows.
//! 4. If the curve runs *beside* the surface, too close to separate the two by enclosures, the piece has no crossing.
//! 5. Otherwise the piece is halved.
//!
//! Coinciding and running beside are tested at nine points of a piece: its ends, its middle and six unevenly spaced points
//! between them. *Coinciding*: at each point `|f| <= delta |grad f|` and `|g'| h <= 4 delta |grad f|`, and the piece is so short
//! that between the points the curve deviates from its tangent by at most `A h^2 / 2 <= 2^-20 (size of r + magnitude)`. *Beside*:
//! all points on one side, `|g'| h <= |g| / 4`, and a deviation from the tangent of at most 2^-30 of those lengths.
//!
//! A run of coinciding pieces keeps the side before it. If the side after it differs, there is one crossing in the run, at the
//! sign change of the computed values. A double root is thus not a crossing, as along straight lines. If the curve coincides at
//! the beginning of the window, the start side is the side after that run. If it coincides over the whole window, the
//! side is that into which [`perturbation_direction`](rayweave_math::perturbation_direction) points from the middle of the window.
//!
//! *Guarantee*: let the curve satisfy its contract (see [`Curve`]) and the field's enclosures hold. Every crossing is reported, in
//! order and with its direction, except pairs of neighbours between which the curve stays within delta of the surface. The
//! guarantee is rigorous for pairs between which the curve departs from the surface by more than 2^-20 (size of r + magnitude).
//! For closer pairs it fails only for adversarial curves, which cross the surface between nine points of a piece that all
//! coincide with it or, within 2^-30, run beside it. *Not guaranteed*: crossings within delta, where two crossings and none are
//! indistinguishable.
//!
//! *Cost*: a transversal crossing takes about ten evaluations of the curve, for the pieces down to the size at which the curve is
//! straight relative to the surface and for the steps to the root. A tangency takes about twenty halvings of one or two pieces each.
//! A curve in the surface takes 2^9 pieces per unit of `t sqrt(A / size)`, with nine evaluations each; one that runs beside it at a
//! small distance d up to `sqrt(size / d)` times as many, at most 2^14. A curve of many turns has this cost per turn. At most
//! [`MAX_PIECES`] pieces are examined, and none is halved more than [`MAX_HALVINGS`] times.

mod collector;
mod motion;
mod path;

pub(crate) use motion::{Motion, checked_bound};
pub use path::coincides_along;

use crate::{Curve, CurveError, Field, Point};
use collector::Collector;
use path::{Composition, Piece, Verdict};
use rayweave_math::perturbs_inside;
use rayweave_rootray::RootRay;

/// The maximal number of pieces for one surface and window.
pub const MAX_PIECES: usize = 1 << 21;

/// The maximal number of halvings; a piece halved this often counts as coinciding.
pub const MAX_HALVINGS: u32 = 128;

/// The sign changes of a field along a curve strictly between `t0` and `t1`. The start side is that just after `t0`, inside if the field
/// is negative.
///
/// ```
/// use rayweave_shape::surface::Surface;
/// use rayweave_space::curve::Parabola;
/// use rayweave_space::isolate;
///
/// // thrown upwards at 4 from the ground, with a gravity of 2
/// let throw = Parabola::new([0.0, 0.0, 0.0], [1.0, 0.0, 4.0], [0.0, 0.0, -2.0]);
/// let ground = Surface::plane([0.0, 0.0, 1.0].into(), 0.0);
/// let roots = isolate(&ground, &throw, -1.0, 5.0)?;
/// assert_eq!(roots.to_string(), "inside [0, 4]");
/// # Ok::<(), rayweave_space::CurveError>(())
/// ```
///
/// # Errors
/// The window is not finite, not increasing or outside the curve's domain; a violation of the curve's contract was detected; or the work
/// exceeds the limit.
pub fn isolate<const D: usize, F, C>(field: &F, curve: &C, t0: f64, t1: f64) -> Result<RootRay, CurveError>
where
    F: Field<D> + ?Sized,
    C: Curve<D> + ?Sized,
{
    isolate_with(field, curve, t0, t1, perturbs_inside)
}

/// Like [`isolate`], with a function of the gradient that decides the side of a curve that coincides over the whole window.
pub fn isolate_with<const D: usize, F, C>(
    field: &F,
    curve: &C,
    t0: f64,
    t1: f64,
    side_in_surface: impl FnOnce(&Point<D>) -> bool,
) -> Result<RootRay, CurveError>
where
    F: Field<D> + ?Sized,
    C: Curve<D> + ?Sized,
{
    check_window(curve, t0, t1)?;
    let path = Composition::new(field, curve, t0, t1);
    let mut collector = Collector::new(&path, (t0, t1));
    let whole = Piece { a: path.sample(t0)?, b: path.sample(t1)?, halvings: 0 };
    let mut waiting = vec![whole];
    let mut pieces = 0;
    while let Some(piece) = waiting.pop() {
        pieces += 1;
        if pieces > MAX_PIECES {
            return Err(CurveError::TooMuchWork { t0, t1, pieces: MAX_PIECES });
        }
        match path.classify(&piece)? {
            Verdict::Clear { inside } => collector.add(&piece, inside, inside)?,
            Verdict::Monotonic => collector.add(&piece, piece.a.inside(), piece.b.inside())?,
            Verdict::Coinciding => collector.add_coinciding(&piece),
            Verdict::Undecided(middle) => waiting.extend(piece.halves(middle).into_iter().rev()),
        }
    }
    collector.finish(|| path.sample(0.5 * t0 + 0.5 * t1).map(|sample| side_in_surface(&sample.gradient)))
}

/// Rejects windows that are not finite, not increasing or outside the curve's domain.
pub fn check_window<const D: usize, C: Curve<D> + ?Sized>(
    curve: &C,
    t0: f64,
    t1: f64,
) -> Result<(), CurveError> {
    // covers infinite and NaN ends, overflow, and the order
    if !(t1 - t0).is_finite() || t0 >= t1 {
        return Err(CurveError::Window { t0, t1 });
    }
    let (first, last) = curve.domain();
    if t0 < first || t1 > last {
        return Err(CurveError::OutsideDomain { t0, t1, first, last });
    }
    Ok(())
}
