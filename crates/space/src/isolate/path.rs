//! A field along a curve: values, bounds over pieces, and what hugging means.

use crate::isolate::motion::{Motion, checked_bound};
use crate::isolate::{MOST_HALVINGS, MOST_PIECES};
use crate::point::{dot, length};
use crate::{Curve, CurveError, Field, Point};
use rayweave_math::{Interval, UNIT_ROUNDOFF};
use rayweave_shape::surface::delta_of;

/// Points of the curve and values of the field are computed to within this times the lengths involved: an eighth of
/// the distance within which nothing is promised.
const ROUNDING: f64 = 8.0 * UNIT_ROUNDOFF;

/// Between the points at which hugging is judged, a curve may leave its tangent by this times the lengths involved.
const STRAY: f64 = 1.0 / (1 << 20) as f64;

/// The same for a curve that runs beside the surface, too near for bounds.
const STRAY_BESIDE: f64 = 1.0 / (1 << 30) as f64;

/// Where a piece is looked at beside its ends and its middle, in half lengths: not in step with anything that repeats.
const BETWEEN: [f64; 6] = [-0.81, -0.5, -0.23, 0.37, 0.5, 0.66];

/// Two functions of which one is asked along the other.
pub struct Path<'a, const D: usize, F: ?Sized, C: ?Sized> {
    field: &'a F,
    curve: &'a C,
    reach: f64,
    /// The length of the window.
    span: f64,
}

/// All that is asked at one time.
#[derive(Clone, Copy, Debug)]
pub struct Sample<const D: usize> {
    pub t: f64,
    motion: Motion<D>,
    /// g.
    pub value: f64,
    /// grad f.
    pub gradient: Point<D>,
    /// g'.
    pub slope: f64,
    /// The lengths from which position and value are computed.
    size: f64,
}

impl<const D: usize> Sample<D> {
    /// The computed side.
    pub fn inside(&self) -> bool {
        self.value < 0.0
    }
}

/// A stretch of time between two samples.
#[derive(Clone, Copy, Debug)]
pub struct Piece<const D: usize> {
    pub a: Sample<D>,
    pub b: Sample<D>,
    pub halvings: u32,
}

impl<const D: usize> Piece<D> {
    pub fn halves(&self, middle: Sample<D>) -> [Piece<D>; 2] {
        let halvings = self.halvings + 1;
        [Piece { a: self.a, b: middle, halvings }, Piece { a: middle, b: self.b, halvings }]
    }

    /// The time in the middle; `None` if there is no number between the ends.
    fn middle(&self) -> Option<f64> {
        let middle = 0.5 * self.a.t + 0.5 * self.b.t;
        (self.a.t < middle && middle < self.b.t && self.halvings < MOST_HALVINGS).then_some(middle)
    }
}

/// What the bounds say of a piece.
pub enum Verdict<const D: usize> {
    /// No zero: on this side all along.
    Clear { inside: bool },
    /// At most one zero.
    Monotonic,
    /// Nowhere farther than delta from the surface.
    Hugging,
    /// To be halved here.
    Undecided(Sample<D>),
}

impl<'a, const D: usize, F: Field<D> + ?Sized, C: Curve<D> + ?Sized> Path<'a, D, F, C> {
    pub fn new(field: &'a F, curve: &'a C, t0: f64, t1: f64) -> Self {
        Path { field, curve, reach: field.reach(), span: t1 - t0 }
    }

    /// The curve and the field at one time.
    pub fn sample(&self, t: f64) -> Result<Sample<D>, CurveError> {
        let motion = Motion::at(self.curve, t)?;
        let (value, gradient) = self.field.value_and_gradient(&motion.position);
        let slope = dot(&gradient, &motion.velocity);
        if value.is_nan() || slope.is_nan() {
            return Err(CurveError::NotFinite { t });
        }
        Ok(Sample { t, motion, value, gradient, slope, size: motion.size + self.reach })
    }

    /// The acceleration bound of a piece, checked.
    fn bound(&self, piece: &Piece<D>, m: &Sample<D>) -> Result<f64, CurveError> {
        checked_bound(self.curve, [&piece.a.motion, &m.motion, &piece.b.motion], self.span)
    }

    /// What is sure about a piece.
    pub fn judge(&self, piece: &Piece<D>) -> Result<Verdict<D>, CurveError> {
        let Some(t) = piece.middle() else {
            return Ok(Verdict::Hugging);
        };
        let m = self.sample(t)?;
        let bound = self.bound(piece, &m)?;
        let h = (piece.b.t - t).max(t - piece.a.t).next_up();
        let noise = ROUNDING * m.size.max(piece.a.size).max(piece.b.size);
        let stray = 0.5 * bound * h * h;
        // before any bounds: that a curve in a surface crosses it, for sure but within rounding, means nothing
        if stray <= STRAY * m.size && self.all(piece, &m, |s| self.near(s, h))? {
            return Ok(Verdict::Hugging);
        }
        let cell: [Interval; D] = std::array::from_fn(|k| {
            Interval::around(m.motion.position[k], m.motion.velocity[k].abs() * h + stray + noise)
        });
        let (value, gradient) = self.field.ranges(&cell);
        if !value.contains_zero() {
            return Ok(Verdict::Clear { inside: value.hi < 0.0 });
        }
        let slope = self.slope(&gradient, &m, bound * h);
        if !slope.contains_zero() {
            return Ok(Verdict::Monotonic);
        }
        let value = Interval::point(m.value) + slope * Interval { lo: -h, hi: h };
        if !value.contains_zero() {
            return Ok(Verdict::Clear { inside: value.hi < 0.0 });
        }
        let inside = m.inside();
        let beside = |s: &Sample<D>| s.inside() == inside && self.beside(s, h);
        if stray <= STRAY_BESIDE * m.size && self.all(piece, &m, beside)? {
            return Ok(Verdict::Clear { inside });
        }
        Ok(Verdict::Undecided(m))
    }

    /// Bounds of g' from those of grad f and of the velocity, which turns by no more than `turn`.
    fn slope(&self, gradient: &[Interval; D], m: &Sample<D>, turn: f64) -> Interval {
        let turn = turn + ROUNDING * length(&m.motion.velocity);
        (0..D).fold(Interval::point(0.0), |sum, k| {
            sum + gradient[k] * Interval::around(m.motion.velocity[k], turn)
        })
    }

    /// True if something holds at all points at which a piece is looked at.
    fn all(
        &self,
        piece: &Piece<D>,
        m: &Sample<D>,
        holds: impl Fn(&Sample<D>) -> bool,
    ) -> Result<bool, CurveError> {
        if !(holds(m) && holds(&piece.a) && holds(&piece.b)) {
            return Ok(false);
        }
        for part in BETWEEN {
            let end = if part < 0.0 { piece.a.t } else { piece.b.t };
            if !holds(&self.sample(m.t + part.abs() * (end - m.t))?) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// True if the curve is off the surface at a time, as parallel to it as its distance is from changing by half
    /// over a piece of half length h.
    ///
    /// Where g is a parabola with a root or its vertex in the piece this is false at one end at least: at x from
    /// the vertex `|g' / g| >= 2 / x`, and x is no more than 2 h.
    fn beside(&self, s: &Sample<D>, h: f64) -> bool {
        // half of delta, so that a curve about delta from the surface is one or the other, whatever is rounded
        s.value.abs() > 0.5 * self.tolerance(s) && s.slope.abs() * h <= 0.25 * s.value.abs()
    }

    /// True if the curve is on the surface at a time, and leaves it within h by no more than it may. A parabola
    /// that touches the surface within the piece and is on it at the ends has slopes of `4 delta / h` there, at most.
    fn near(&self, s: &Sample<D>, h: f64) -> bool {
        let tolerance = self.tolerance(s);
        s.value.abs() <= tolerance && s.slope.abs() * h <= 4.0 * tolerance
    }

    /// The largest value that f can have at a point within delta of the surface. Where all of the surface is smaller
    /// than delta, the gradient at the point alone would not do: in the centre of a sphere it is 0.
    fn tolerance(&self, s: &Sample<D>) -> f64 {
        let delta = delta_of(s.size);
        let plain = delta * length(&s.gradient);
        if s.value.abs() <= plain {
            return plain;
        }
        let cell = s.motion.position.map(|x| Interval::around(x, delta));
        let steepest = self.field.ranges(&cell).1.map(Interval::magnitude);
        delta * length(&steepest)
    }
}

/// True if the piece of the curve between two times lies within delta of the surface of the field: halved until each
/// part is judged as in isolation.
///
/// # Errors
/// As [`isolate`](crate::isolate::isolate), for the curve.
pub fn hugs<const D: usize, F, C>(field: &F, curve: &C, a: f64, b: f64) -> Result<bool, CurveError>
where
    F: Field<D> + ?Sized,
    C: Curve<D> + ?Sized,
{
    let path = Path::new(field, curve, a, b);
    let whole = Piece { a: path.sample(a)?, b: path.sample(b)?, halvings: 0 };
    let mut waiting = vec![whole];
    for _ in 0..MOST_PIECES {
        let Some(piece) = waiting.pop() else {
            return Ok(true);
        };
        match path.keeps_near(&piece)? {
            Near::No => return Ok(false),
            Near::Yes => {}
            Near::Unsure(middle) => waiting.extend(piece.halves(middle)),
        }
    }
    Ok(false)
}

/// Whether a piece keeps near the surface.
enum Near<const D: usize> {
    Yes,
    No,
    Unsure(Sample<D>),
}

impl<const D: usize, F: Field<D> + ?Sized, C: Curve<D> + ?Sized> Path<'_, D, F, C> {
    fn keeps_near(&self, piece: &Piece<D>) -> Result<Near<D>, CurveError> {
        let near = |s: &Sample<D>| s.value.abs() <= self.tolerance(s);
        if !(near(&piece.a) && near(&piece.b)) {
            return Ok(Near::No);
        }
        let Some(t) = piece.middle() else {
            return Ok(Near::Yes);
        };
        let m = self.sample(t)?;
        if !near(&m) {
            return Ok(Near::No);
        }
        let bound = self.bound(piece, &m)?;
        let h = (piece.b.t - t).max(t - piece.a.t);
        let sure = 0.5 * bound * h * h <= STRAY * m.size && self.all(piece, &m, |s| self.near(s, h))?;
        Ok(if sure { Near::Yes } else { Near::Unsure(m) })
    }
}
