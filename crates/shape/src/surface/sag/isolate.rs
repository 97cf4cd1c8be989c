//! Root isolation by interval bounds: all sign changes of a smooth function between two times.
//!
//! A piece of the time axis is classified by guaranteed data: value and slope at its ends, bounds of the second derivative
//! over it, and, if these do not decide, bounds of the slope. From these a piece has no root, or is monotone, or has one
//! sign of curvature (at most two roots, separated by the extremum), or is bisected.
//!
//! *Bounds of the second derivative* of width w leave an uncertainty of w h^2 in the value of f, so pieces become short
//! only where f and its slope both vanish. The bounds may be infinite: at the tip of an odd term and at a vertical rim.
//! There the finite end and its sign suffice if the unbounded part dominates, since the piece then has one sign of
//! curvature. If another part curves against it, *bounds of the slope* decide. At a tip they are finite, so that a piece
//! with values beyond w h has no root, and one along which f stays below the noise is recognised as noise. At a vertical
//! rim they have a sign wherever the line leaves or approaches the rim.
//!
//! *Guarantee*: each piece of the list of signs is the sign of f, and no pair of roots is missed between which |f| exceeds
//! [`Smooth::noise`], up to what f64 can resolve: a piece along which the line is parallel to z to within the last bits of
//! x and y ([`Smooth::is_upright`]) has at most one crossing, and so has a piece as short as the rounding of its times. Two
//! crossings on such a piece are closer than the thinnest wall that such a line can resolve. If f does not exceed the noise
//! along a piece, the piece counts as one sign change if the signs at its ends differ, otherwise as none.
//!
//! [`PIECES`] is a safety limit; the guarantee does not hold for a line that exceeds it. No such line is known: lines
//! through tips, along axes and along vertical rims stay below [`PIECES`] / 16, which `line.rs` tests.

use rayweave_math::{Interval, UNIT_ROUNDOFF};

/// A function of time with a continuous slope.
pub(super) trait Smooth {
    /// Value and slope at a time.
    fn at(&self, t: f64) -> (f64, f64);
    /// Bounds of the second derivative between two times.
    fn bend(&self, from: f64, to: f64) -> Interval;
    /// Bounds of the slope between two times.
    fn slopes(&self, from: f64, to: f64) -> Interval;
    /// True if, up to the rounding of x and y, the line is parallel to z between two times, so that f is monotone.
    fn is_upright(&self, from: f64, to: f64) -> bool;
    /// Bound of the values whose sign is not significant.
    fn noise(&self) -> f64;
}

/// An end of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub t: f64,
    pub value: f64,
    pub slope: f64,
    /// The effective sign: that of the value, or of a neighbour if the value is noise.
    pub negative: bool,
}

impl End {
    pub fn of(f: &impl Smooth, t: f64) -> End {
        let (value, slope) = f.at(t);
        End { t, value, slope, negative: value < 0.0 }
    }

    /// The end with the sign of its neighbour if the value is noise. If f becomes 0 there without a change of sign, there is no
    /// crossing; else the root is found in the next piece.
    pub fn beside(self, negative: bool, f: &impl Smooth) -> End {
        if self.value.abs() <= quiet(f) { End { negative, ..self } } else { self }
    }

    /// The end of -f.
    fn negated(self) -> End {
        End { value: -self.value, slope: -self.slope, negative: !self.negative, ..self }
    }
}

/// The largest number of bisections of the first piece; the result is as short as the rounding of its ends.
const DEPTH: u32 = 64;

/// The largest number of pieces per line.
pub(super) const PIECES: u32 = 1 << 14;

/// Passes the sign changes between two ends to `emit`, in order.
pub(super) fn sign_changes(f: &impl Smooth, a: End, b: End, emit: &mut dyn FnMut(f64)) {
    visit(f, a, b, (DEPTH, &mut { PIECES }), emit);
}

fn visit(f: &impl Smooth, a: End, b: End, (depth, left): (u32, &mut u32), emit: &mut dyn FnMut(f64)) {
    let piece = Piece::new(f, a, b);
    *left = left.saturating_sub(1);
    match piece.kind(f) {
        _ if depth == 0 || *left == 0 => single(f, a, b, emit),
        Kind::Single => single(f, a, b, emit),
        Kind::Bent { up: true } => bent(f, a, b, emit),
        Kind::Bent { up: false } => bent(&Negated(f), a.negated(), b.negated(), emit),
        Kind::Any => {
            let middle = End::of(f, piece.middle());
            let middle = if a.negative == b.negative { middle.beside(a.negative, f) } else { middle };
            visit(f, a, middle, (depth - 1, left), emit);
            visit(f, middle, b, (depth - 1, left), emit);
        }
    }
}

/// Bound of the values that are treated as 0: a quarter of the noise, so that values beyond the noise are not.
fn quiet(f: &impl Smooth) -> f64 {
    0.25 * f.noise()
}

/// At most one sign change.
fn single(f: &impl Smooth, a: End, b: End, emit: &mut dyn FnMut(f64)) {
    if a.negative != b.negative {
        emit(root(f, a, b));
    }
}

/// Classification of a piece by its roots.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// One root if the signs at the ends differ, else none.
    Single,
    /// Monotone slope: at most two roots.
    Bent { up: bool },
    /// Any number of roots.
    Any,
}

struct Piece {
    a: End,
    b: End,
    half: f64,
    bend: Interval,
}

impl Piece {
    fn new(f: &impl Smooth, a: End, b: End) -> Piece {
        Piece { a, b, half: 0.5 * (b.t - a.t), bend: f.bend(a.t, b.t) }
    }

    fn middle(&self) -> f64 {
        0.5 * (self.a.t + self.b.t)
    }

    /// True if the piece is too short to resolve its times or positions.
    fn is_shortest(&self, f: &impl Smooth) -> bool {
        let rounding = 4.0 * UNIT_ROUNDOFF * self.a.t.abs().max(self.b.t.abs());
        self.half <= rounding || f.is_upright(self.a.t, self.b.t)
    }

    fn kind(&self, f: &impl Smooth) -> Kind {
        let noise = f.noise();
        match () {
            () if self.is_monotone() || self.is_clear() || self.is_noise(noise) => Kind::Single,
            () if self.is_shortest(f) => Kind::Single,
            () if self.bends_up() => Kind::Bent { up: true },
            () if self.bends_down() => Kind::Bent { up: false },
            () if self.is_single_by(f.slopes(self.a.t, self.b.t), noise) => Kind::Single,
            () => Kind::Any,
        }
    }

    /// True if the bounds of the second derivative are not negative. The margin of one rounding of 0 is needed because
    /// sums of bounds that end at 0 are rounded outward.
    fn bends_up(&self) -> bool {
        self.bend.lo >= -f64::MIN_POSITIVE
    }

    fn bends_down(&self) -> bool {
        self.bend.hi <= f64::MIN_POSITIVE
    }

    /// True if bounds of the slope show that the piece is monotone, or that its value stays away from 0, or is noise. Each
    /// half is bounded from its own end.
    fn is_single_by(&self, slopes: Interval, noise: f64) -> bool {
        let (a, b, half) = (self.a.value, self.b.value, self.half);
        let (fall, rise) = (slopes.lo.min(0.0) * half, slopes.hi.max(0.0) * half);
        let is_clear = (a + fall > 0.0 && b - rise > 0.0) || (a + rise < 0.0 && b - fall < 0.0);
        let is_noise = a.abs().max(b.abs()) + rise.max(-fall) <= noise;
        slopes.lo > 0.0 || slopes.hi < 0.0 || is_clear || is_noise
    }

    /// True if the slope keeps its sign. Each half is bounded from its own end.
    fn is_monotone(&self) -> bool {
        let Piece { a, b, half, bend } = self;
        let (rise, fall) = (bend.hi.max(0.0) * half, bend.lo.min(0.0) * half);
        let rises = a.slope + fall > 0.0 && b.slope - rise > 0.0;
        let falls = a.slope + rise < 0.0 && b.slope - fall < 0.0;
        rises || falls
    }

    /// True if the value stays away from 0.
    fn is_clear(&self) -> bool {
        let Piece { a, b, half, bend } = self;
        let square = 0.5 * half * half;
        let above = |end: &End, away: f64| {
            end.value + (away * end.slope * half).min(0.0) + bend.lo.min(0.0) * square > 0.0
        };
        let below = |end: &End, away: f64| {
            end.value + (away * end.slope * half).max(0.0) + bend.hi.max(0.0) * square < 0.0
        };
        (above(a, 1.0) && above(b, -1.0)) || (below(a, 1.0) && below(b, -1.0))
    }

    /// True if the value is noise throughout.
    fn is_noise(&self, noise: f64) -> bool {
        let square = 0.5 * self.half * self.half * self.bend.magnitude();
        let most = |end: &End| end.value.abs() + end.slope.abs() * self.half + square;
        most(&self.a) <= noise && most(&self.b) <= noise
    }
}

/// The negative of a function.
struct Negated<'a, F>(&'a F);

impl<F: Smooth> Smooth for Negated<'_, F> {
    fn at(&self, t: f64) -> (f64, f64) {
        let (value, slope) = self.0.at(t);
        (-value, -slope)
    }

    fn bend(&self, from: f64, to: f64) -> Interval {
        -self.0.bend(from, to)
    }

    fn slopes(&self, from: f64, to: f64) -> Interval {
        -self.0.slopes(from, to)
    }

    fn is_upright(&self, from: f64, to: f64) -> bool {
        self.0.is_upright(from, to)
    }

    fn noise(&self) -> f64 {
        self.0.noise()
    }
}

/// Sign changes of a function with increasing slope: two roots if it is positive at both ends and negative somewhere in
/// between.
fn bent(f: &impl Smooth, a: End, b: End, emit: &mut dyn FnMut(f64)) {
    if a.negative != b.negative {
        return emit(root(f, a, b));
    }
    if a.negative {
        return;
    }
    if let Some(low) = below_zero(f, a, b) {
        emit(root(f, a, low));
        emit(root(f, low, b));
    }
}

/// A point at which a function with increasing slope, positive at both ends, is negative by more than noise; `None` if there is
/// none.
fn below_zero(f: &impl Smooth, mut a: End, mut b: End) -> Option<End> {
    // a smaller value could be that of a point of contact
    let least = quiet(f);
    for _ in 0..DEPTH {
        // such a function is above its tangents
        if a.slope >= 0.0 || b.slope <= 0.0 || tangents_meet_above_zero(&a, &b) {
            return None;
        }
        let t = a.t + (b.t - a.t) * (a.slope / (a.slope - b.slope)).clamp(0.05, 0.95);
        if !(a.t < t && t < b.t) {
            return None;
        }
        let next = End::of(f, t);
        match next.slope {
            _ if next.value < -least => return Some(next),
            slope if slope < 0.0 => a = next,
            _ => b = next,
        }
    }
    None
}

fn tangents_meet_above_zero(a: &End, b: &End) -> bool {
    let along = (b.value - a.value - b.slope * (b.t - a.t)) / (a.slope - b.slope);
    a.value + a.slope * along > 0.0
}

/// The root between two ends of different sign: Newton's method, safeguarded by bisection.
///
/// If |f| is noise, f may have another root than the one between the ends, with the opposite slope: an end may be a root
/// itself, or f may touch 0 there. Such a point replaces the nearer end and keeps that end's sign.
pub(super) fn root(f: &impl Smooth, mut a: End, mut b: End) -> f64 {
    let (mut t, mut last) = (first_guess(&a, &b), b.t - a.t);
    // a step as small as the rounding of t or f is the last one
    let (finest, quiet) = (2.0 * UNIT_ROUNDOFF * a.t.abs().max(b.t.abs()), quiet(f));
    for _ in 0..200 {
        let here = End::of(f, t);
        let step = -here.value / here.slope;
        let is_quiet = here.value.abs() <= quiet;
        let is_other = is_quiet && if a.negative { here.slope < 0.0 } else { here.slope > 0.0 };
        if !is_other && (is_quiet || step.abs() <= finest) {
            return polished(f, &here, step, (&a, &b), finest);
        }
        let is_first = if is_other { t - a.t < b.t - t } else { here.negative == a.negative };
        if is_first {
            a = End { negative: a.negative, ..here }
        } else {
            b = End { negative: b.negative, ..here }
        }
        let (newton, halved) = (t + step, 0.5 * (a.t + b.t));
        let is_slow = is_other || 2.0 * step.abs() > last.abs();
        let next = if a.t < newton && newton < b.t && !is_slow { newton } else { halved };
        last = next - t;
        if next <= a.t || b.t <= next {
            return next;
        }
        t = next;
    }
    t
}

/// The result of a last Newton step. If |f| is noise, so may be the slope, and the step may lead anywhere: a step beyond the
/// rounding of t is taken only if |f| does not grow beyond the noise.
fn polished(f: &impl Smooth, here: &End, step: f64, (a, b): (&End, &End), finest: f64) -> f64 {
    let newton = here.t + step;
    let is_between = a.t <= newton && newton <= b.t;
    if is_between && (step.abs() <= FINE * finest || f.at(newton).0.abs() <= f.noise()) {
        newton
    } else {
        here.t
    }
}

/// The largest last step, relative to the rounding of the time, that needs no test.
const FINE: f64 = 64.0;

/// Zero of the straight line through two ends.
fn first_guess(a: &End, b: &End) -> f64 {
    let part = a.value / (a.value - b.value);
    a.t + (b.t - a.t) * if 0.0 < part && part < 1.0 { part } else { 0.5 }
}

/// The sign changes after a root at time `a`, which is divided out: `a` has the value 0 and the sign just after the root.
/// Returns the effective sign at `b`.
pub(super) fn sign_changes_after(f: &impl Smooth, a: End, b: End, emit: &mut dyn FnMut(f64)) -> bool {
    let mut rest = [b; DEPTH as usize];
    let mut count = 1;
    let mut end = b;
    // shrinks the first piece until it can be classified
    loop {
        let piece = Piece::new(f, a, end);
        let is_last = count == rest.len() || piece.is_shortest(f) || piece.is_noise(f.noise());
        let (up, down) = (piece.bends_up(), piece.bends_down());
        let (bends, bends_away) = if a.negative { (up, down) } else { (down, up) };
        match () {
            () if is_last || piece.is_monotone() || bends_away => end.negative = a.negative,
            () if bends => single_after(f, a, end, emit),
            () if piece.is_single_by(f.slopes(a.t, end.t), f.noise()) => end.negative = a.negative,
            () => {
                end = End::of(f, piece.middle());
                rest[count] = end;
                count += 1;
                continue;
            }
        }
        break;
    }
    for next in rest[..count - 1].iter().rev() {
        sign_changes(f, end, *next, emit);
        end = *next;
    }
    end.negative
}

/// Emits the only return of the function to 0, if there is one: the root of f / (t - a).
fn single_after(f: &impl Smooth, a: End, b: End, emit: &mut dyn FnMut(f64)) {
    if a.negative != b.negative {
        let divided = Divided { f, from: a };
        let start = End { value: a.slope, slope: 0.0, ..a };
        emit(root(&divided, start, End { negative: b.negative, ..End::of(&divided, b.t) }));
    }
}

/// `f / (t - from)`.
struct Divided<'a, F> {
    f: &'a F,
    from: End,
}

impl<F: Smooth> Smooth for Divided<'_, F> {
    fn at(&self, t: f64) -> (f64, f64) {
        let ((value, slope), by) = (self.f.at(t), t - self.from.t);
        (value / by, (slope - value / by) / by)
    }

    fn bend(&self, _: f64, _: f64) -> Interval {
        Interval::ALL
    }

    fn slopes(&self, _: f64, _: f64) -> Interval {
        Interval::ALL
    }

    fn is_upright(&self, _: f64, _: f64) -> bool {
        false
    }

    fn noise(&self) -> f64 {
        0.0
    }
}
