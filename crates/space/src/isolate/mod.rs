//! When a curve crosses the surface of a field: all sign changes of `g(t) = f(r(t))` on a window, isolated by bounds
//! and not by sampling.
//!
//! *Method*: subdivision with interval arithmetic (R. E. Moore, *Interval Analysis* (1966), chapter 7; R. B. Kearfott,
//! *Rigorous Global Search* (1996)). About the middle m of a piece of half length h the curve keeps to
//! `|r(t) - r(m) - v(m) (t - m)| <= A h^2 / 2` and `|r'(t) - v(m)| <= A h`, with A its acceleration bound on the piece. So it
//! stays in a box, over which the field gives bounds of f and grad f, and
//!
//! 1. if the curve *hugs* the surface over the piece, that is, keeps within `delta = 64 u (size of r + reach)` of it, no sign
//!    there means anything, and the piece is joined with its neighbours of the same kind;
//! 2. if the bounds of f, or those of the mean value theorem `g(m) + g'(piece) [-h, h]`, leave out 0, the piece has no
//!    crossing: the width of the second kind of bounds falls with the square of h;
//! 3. if the bounds of g' leave out 0, the piece has one crossing if the signs at its ends differ, else none; it is found
//!    by Newton's steps safeguarded by bisection, to the last bit that the rounding of values allows;
//! 4. if the curve runs *beside* the surface, so near that bounds do not part the two, the piece has no crossing;
//! 5. else it is halved.
//!
//! Hugging and running beside are judged at nine points of a piece: its ends, its middle and six between them, not in
//! equal steps. *Hugging*: at each of them `|f| <= delta |grad f|` and `|g'| h <= 4 delta |grad f|`, and the piece is so short that
//! between them the curve cannot leave its tangent by more than `A h^2 / 2 <= 2^-20 (size of r + reach)`. *Beside*: all on
//! one side, `|g'| h <= |g| / 4`, and the curve cannot leave its tangent by more than 2^-30 of those lengths.
//!
//! A stretch of hugging pieces keeps the side that the curve has before it; if it has another one after it, there is one
//! crossing in the stretch, where the computed sign changes. So a double root is no crossing, as on straight lines. A window
//! at whose beginning the curve hugs starts on the side that it has after that stretch; one that hugs all over is on the
//! side into which [`lie_direction`](crate::lie_direction) leads from the middle of the window.
//!
//! *Guarantee*: let the curve keep its promises (see [`Curve`]) and the field's bounds hold. Every crossing is reported, in
//! order and with its direction, but for pairs of neighbours between which the curve stays within delta of the surface. The
//! guarantee is by bounds, and so unconditional, for pairs between which the curve goes farther from the surface than 2^-20
//! (size of r + reach); nearer than that it holds unless the curve is made to hide: to wiggle across the surface between
//! nine points of a piece, all of which say that it hugs, or, within 2^-30, runs beside it. *Not guaranteed*: what happens
//! within delta, where two crossings and none cannot be told apart.
//!
//! *Cost*: a transversal crossing costs about ten evaluations of the curve in all, the pieces down to the size at which the
//! curve is straight against the surface and the steps to the root; a tangency some twenty halvings, of one or two pieces
//! each; a curve that lies in the surface 2^9 pieces per unit of `t sqrt(A / size)`, with nine evaluations each; and one that
//! runs beside it at a small distance d up to `sqrt(size / d)` of them, 2^14 at most. A curve of many turns costs so much
//! per turn. No more than [`MOST_PIECES`] pieces are examined, and none is halved more than [`MOST_HALVINGS`] times.

mod motion;
mod path;
mod walk;

pub(crate) use motion::{Motion, checked_bound};
pub use path::hugs;

use crate::{Curve, CurveError, Field, Point, leads_inside};
use path::{Path, Piece, Verdict};
use rayweave_rootray::RootRay;
use walk::Walk;

/// Isolation of one surface on one window gives up after this many pieces.
pub const MOST_PIECES: usize = 1 << 21;

/// A piece this many times halved is taken for hugging, whatever its bounds say.
pub const MOST_HALVINGS: u32 = 128;

/// The sign changes of a field along a curve, strictly between `t0` and `t1`; the start side is that just after `t0`,
/// inside where the field is negative.
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
/// A window that is not finite, not in order or beyond the curve's domain; a curve that breaks its promises, where that
/// is noticed; too much work.
pub fn isolate<const D: usize, F, C>(field: &F, curve: &C, t0: f64, t1: f64) -> Result<RootRay, CurveError>
where
    F: Field<D> + ?Sized,
    C: Curve<D> + ?Sized,
{
    isolate_aside(field, curve, t0, t1, leads_inside)
}

/// [`isolate`] where something else decides the side of a curve that hugs all over, from the gradient.
pub fn isolate_aside<const D: usize, F, C>(
    field: &F,
    curve: &C,
    t0: f64,
    t1: f64,
    aside: impl FnOnce(&Point<D>) -> bool,
) -> Result<RootRay, CurveError>
where
    F: Field<D> + ?Sized,
    C: Curve<D> + ?Sized,
{
    check_window(curve, t0, t1)?;
    let path = Path::new(field, curve, t0, t1);
    let mut walk = Walk::new(&path, (t0, t1));
    let whole = Piece { a: path.sample(t0)?, b: path.sample(t1)?, halvings: 0 };
    let mut waiting = vec![whole];
    let mut pieces = 0;
    while let Some(piece) = waiting.pop() {
        pieces += 1;
        if pieces > MOST_PIECES {
            return Err(CurveError::TooMuchWork { t0, t1, pieces: MOST_PIECES });
        }
        match path.judge(&piece)? {
            Verdict::Clear { inside } => walk.go_on(&piece, inside, inside)?,
            Verdict::Monotonic => walk.go_on(&piece, piece.a.inside(), piece.b.inside())?,
            Verdict::Hugging => walk.hug(&piece),
            Verdict::Undecided(middle) => waiting.extend(piece.halves(middle).into_iter().rev()),
        }
    }
    walk.finish(|| path.sample(0.5 * t0 + 0.5 * t1).map(|sample| aside(&sample.gradient)))
}

/// Refuses windows that are no bounded stretch of the curve.
pub fn check_window<const D: usize, C: Curve<D> + ?Sized>(
    curve: &C,
    t0: f64,
    t1: f64,
) -> Result<(), CurveError> {
    // infinite ends and overflow, NaN and order in one
    if !(t1 - t0).is_finite() || t0 >= t1 {
        return Err(CurveError::Window { t0, t1 });
    }
    let (first, last) = curve.domain();
    if t0 < first || t1 > last {
        return Err(CurveError::OutsideDomain { t0, t1, first, last });
    }
    Ok(())
}
