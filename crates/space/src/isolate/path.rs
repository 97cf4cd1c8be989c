//! Composition of a field with a curve: samples, enclosures over pieces, and coincidence with the surface.

use crate::isolate::motion::{Motion, checked_bound};
use crate::isolate::{MAX_HALVINGS, MAX_PIECES};
use crate::point::{dot, length};
use crate::{Curve, CurveError, Field, Point};
use rayweave_math::{Interval, UNIT_ROUNDOFF};
use rayweave_shape::surface::delta_of;

/// Bound of the rounding errors of points and values, relative to the lengths involved: an eighth of the tolerance delta.
const ROUNDING: f64 = 8.0 * UNIT_ROUNDOFF;

/// The maximal deviation from the tangent between the test points of a coinciding piece, relative to the lengths involved.
const MAX_DEVIATION: f64 = 1.0 / (1 << 20) as f64;

/// The maximal deviation from the tangent for a curve beside the surface, relative to the lengths involved.
const MAX_DEVIATION_BESIDE: f64 = 1.0 / (1 << 30) as f64;

/// The test points of a piece besides its ends and its middle, in half lengths: unevenly spaced, to avoid resonance with periodic curves.
const TEST_POINTS: [f64; 6] = [-0.81, -0.5, -0.23, 0.37, 0.5, 0.66];

/// The composition of a field with a curve.
pub struct Composition<'a, const D: usize, F: ?Sized, C: ?Sized> {
    field: &'a F,
    curve: &'a C,
    magnitude: f64,
    /// The length of the window.
    span: f64,
}

/// The values at one time.
#[derive(Clone, Copy, Debug)]
pub struct Sample<const D: usize> {
    pub t: f64,
    motion: Motion<D>,
    /// The value g.
    pub value: f64,
    /// The gradient of f.
    pub gradient: Point<D>,
    /// The derivative g'.
    pub slope: f64,
    /// The sum of the lengths from which position and value are computed.
    size: f64,
}

impl<const D: usize> Sample<D> {
    /// The computed side.
    pub fn inside(&self) -> bool {
        self.value < 0.0
    }
}

/// A piece: the interval of time between two samples.
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

    /// The time in the middle; `None` if there is no number between the ends or the limit of halvings is reached.
    fn middle(&self) -> Option<f64> {
        let middle = 0.5 * self.a.t + 0.5 * self.b.t;
        (self.a.t < middle && middle < self.b.t && self.halvings < MAX_HALVINGS).then_some(middle)
    }
}

/// The classification of a piece.
pub enum Verdict<const D: usize> {
    /// No zero: the whole piece is on this side.
    Clear { inside: bool },
    /// At most one zero.
    Monotonic,
    /// Within delta of the surface.
    Coinciding,
    /// To be halved at this sample.
    Undecided(Sample<D>),
}

impl<'a, const D: usize, F: Field<D> + ?Sized, C: Curve<D> + ?Sized> Composition<'a, D, F, C> {
    pub fn new(field: &'a F, curve: &'a C, t0: f64, t1: f64) -> Self {
        Composition { field, curve, magnitude: field.magnitude(), span: t1 - t0 }
    }

    /// The curve and the field at one time.
    pub fn sample(&self, t: f64) -> Result<Sample<D>, CurveError> {
        let motion = Motion::at(self.curve, t)?;
        let (value, gradient) = self.field.value_and_gradient(&motion.position);
        let slope = dot(&gradient, &motion.velocity);
        if value.is_nan() || slope.is_nan() {
            return Err(CurveError::NotFinite { t });
        }
        Ok(Sample { t, motion, value, gradient, slope, size: motion.size + self.magnitude })
    }

    /// The acceleration bound of a piece, checked.
    fn bound(&self, piece: &Piece<D>, m: &Sample<D>) -> Result<f64, CurveError> {
        checked_bound(self.curve, [&piece.a.motion, &m.motion, &piece.b.motion], self.span)
    }

    /// Classifies a piece.
    pub fn classify(&self, piece: &Piece<D>) -> Result<Verdict<D>, CurveError> {
        let Some(t) = piece.middle() else {
            return Ok(Verdict::Coinciding);
        };
        let m = self.sample(t)?;
        let bound = self.bound(piece, &m)?;
        let h = (piece.b.t - t).max(t - piece.a.t).next_up();
        let noise = ROUNDING * m.size.max(piece.a.size).max(piece.b.size);
        let deviation = 0.5 * bound * h * h;
        // tested first: enclosures may prove crossings within delta, which are meaningless
        if deviation <= MAX_DEVIATION * m.size && self.all(piece, &m, |s| self.near(s, h))? {
            return Ok(Verdict::Coinciding);
        }
        let cell: [Interval; D] = std::array::from_fn(|k| {
            Interval::around(m.motion.position[k], m.motion.velocity[k].abs() * h + deviation + noise)
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
        if deviation <= MAX_DEVIATION_BESIDE * m.size && self.all(piece, &m, beside)? {
            return Ok(Verdict::Clear { inside });
        }
        Ok(Verdict::Undecided(m))
    }

    /// An enclosure of g' from those of grad f and of the velocity, which changes by at most `turn`.
    fn slope(&self, gradient: &[Interval; D], m: &Sample<D>, turn: f64) -> Interval {
        let turn = turn + ROUNDING * length(&m.motion.velocity);
        (0..D).fold(Interval::point(0.0), |sum, k| {
            sum + gradient[k] * Interval::around(m.motion.velocity[k], turn)
        })
    }

    /// True if a condition holds at all test points of a piece.
    fn all(
        &self,
        piece: &Piece<D>,
        m: &Sample<D>,
        holds: impl Fn(&Sample<D>) -> bool,
    ) -> Result<bool, CurveError> {
        if !(holds(m) && holds(&piece.a) && holds(&piece.b)) {
            return Ok(false);
        }
        for part in TEST_POINTS {
            let end = if part < 0.0 { piece.a.t } else { piece.b.t };
            if !holds(&self.sample(m.t + part.abs() * (end - m.t))?) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// True if the curve is off the surface at a sample, and so nearly parallel to it that the distance changes by less than half over
    /// a piece of half length h.
    ///
    /// False at one end at least if g is a parabola with a root or its vertex in the piece: at distance x from the vertex
    /// `|g' / g| >= 2 / x`, and x is at most 2 h.
    fn beside(&self, s: &Sample<D>, h: f64) -> bool {
        // half of delta, so that rounding cannot exclude a curve at distance delta from both conditions
        s.value.abs() > 0.5 * self.tolerance(s) && s.slope.abs() * h <= 0.25 * s.value.abs()
    }

    /// True if the curve is on the surface at a sample, and departs from it within h by at most the tolerance. A parabola that touches the
    /// surface within the piece and is on it at the ends has slopes of at most `4 delta / h` there.
    fn near(&self, s: &Sample<D>, h: f64) -> bool {
        let tolerance = self.tolerance(s);
        s.value.abs() <= tolerance && s.slope.abs() * h <= 4.0 * tolerance
    }

    /// The maximal value of f at a point within delta of the surface. The gradient at the point alone is not sufficient if the surface is
    /// smaller than delta: at the centre of a sphere it is 0.
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

/// True if the span of the curve between two times stays within delta of the surface of the field. Subdivides until each piece is
/// classified as in isolation.
///
/// # Errors
/// As for [`isolate`](crate::isolate::isolate), for the curve.
pub fn coincides_along<const D: usize, F, C>(field: &F, curve: &C, a: f64, b: f64) -> Result<bool, CurveError>
where
    F: Field<D> + ?Sized,
    C: Curve<D> + ?Sized,
{
    let path = Composition::new(field, curve, a, b);
    let whole = Piece { a: path.sample(a)?, b: path.sample(b)?, halvings: 0 };
    let mut waiting = vec![whole];
    for _ in 0..MAX_PIECES {
        let Some(piece) = waiting.pop() else {
            return Ok(true);
        };
        match path.test_coincidence(&piece)? {
            Near::No => return Ok(false),
            Near::Yes => {}
            Near::Unsure(middle) => waiting.extend(piece.halves(middle)),
        }
    }
    Ok(false)
}

/// The result of a coincidence test of a piece.
enum Near<const D: usize> {
    Yes,
    No,
    Unsure(Sample<D>),
}

impl<const D: usize, F: Field<D> + ?Sized, C: Curve<D> + ?Sized> Composition<'_, D, F, C> {
    fn test_coincidence(&self, piece: &Piece<D>) -> Result<Near<D>, CurveError> {
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
        let sure =
            0.5 * bound * h * h <= MAX_DEVIATION * m.size && self.all(piece, &m, |s| self.near(s, h))?;
        Ok(if sure { Near::Yes } else { Near::Unsure(m) })
    }
}
