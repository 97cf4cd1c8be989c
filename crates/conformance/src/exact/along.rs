//! A surface along a ray: where it is crossed, or on which side of it the whole ray is.

use super::root::{Root, SignChanges, sign_changes};
use super::{Dyadic, Exact, Line, Surface};
use rayweave_math::UNIT_ROUNDOFF;
use rayweave_model::Ball;

/// The direction along which rays that lie in a surface are moved in thought.
const W: [f64; 3] = [1.0, 0.7548776662466927, 0.5698402909980532];

/// Pieces of a depth between one over this and this times the tolerance may be welded or not.
pub(super) const GREY: f64 = 4.0;

/// Why a ray has no certain answer and is to be drawn again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// It lies in a surface within about the tolerance.
    Lying,
    /// A piece is about as deep as the tolerance.
    Depth,
    /// It lies in a surface whose sides w cannot tell apart.
    Side,
}

/// What says how long a ray has to keep to a surface to lie in it.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// The ball of the compiled model.
    pub ball: Ball,
    /// True if parts of the model are placed, each with a ball of its own: then only rays that lie in a surface
    /// over any such length, or over none, have a certain answer.
    pub placed: bool,
}

/// The part of the ray that says whether it lies in a surface: its middle, the ends of the shortest part that
/// may be meant, and those of the longest.
pub(super) struct Chord {
    middle: Dyadic,
    short: [Dyadic; 2],
    long: [Dyadic; 2],
}

impl Chord {
    pub(super) fn new(exact: &Exact, line: &Line, span: &Span) -> Chord {
        let (ray, ball) = (&line.ray, &span.ball);
        let middle = (ball.centre - ray.origin).dot(ray.direction) / ray.direction.length_squared();
        let lengths = [ball.radius, (ray.origin - ball.centre).length(), ray.direction.length()];
        let length = lengths.into_iter().find(|&length| length > 0.0).unwrap_or(0.0);
        let size = exact.surfaces.iter().fold(length, |size, s| size.max(s.reach));
        let (short, long) =
            if span.placed { (length.min(1e-3 * size), 8.0 * size) } else { (length, length) };
        let ends = |length: f64| {
            let half = length / ray.direction.length();
            [middle - half, middle + half].map(Dyadic::from)
        };
        Chord { middle: Dyadic::from(middle), short: ends(short), long: ends(long) }
    }
}

/// A surface along the ray.
pub(super) struct Along {
    /// `[a, b, c]` of `a t^2 + b t + c`.
    pub(super) coefficients: [Dyadic; 3],
    pub(super) changes: SignChanges,
    pub(super) lies: bool,
}

fn polynomial([a, b, c]: &[Dyadic; 3], t: &Dyadic) -> Dyadic {
    &(&(&(a * t) + b) * t) + c
}

pub(super) fn delta(surface: &Surface, line: &Line, t: f64) -> f64 {
    let (o, d) = (line.ray.origin.length(), line.ray.direction.length());
    64.0 * UNIT_ROUNDOFF * (o + t.abs() * d + surface.reach)
}

/// The distance of the point at a time from a surface, to first order.
pub(super) fn distance(surface: &Surface, coefficients: &[Dyadic; 3], line: &Line, t: &Dyadic) -> f64 {
    let value = polynomial(coefficients, t).to_f64().abs();
    if value == 0.0 { 0.0 } else { value / surface.slope(&line.at(&t.rounded())) }
}

/// The same in units of the tolerance.
pub(super) fn depth(surface: &Surface, coefficients: &[Dyadic; 3], line: &Line, t: &Dyadic) -> f64 {
    distance(surface, coefficients, line, t) / delta(surface, line, t.to_f64())
}

impl Along {
    pub(super) fn new(surface: &Surface, line: &Line, chord: &Chord) -> Result<Along, Doubt> {
        let coefficients = surface.along(line);
        let lies = coefficients.iter().all(Dyadic::is_zero)
            || Self::nearly_lies(surface, &coefficients, line, chord)?;
        let changes = match lies {
            true => SignChanges { starts_negative: side_along_w(surface, line, chord)?, roots: Vec::new() },
            false => sign_changes(&coefficients),
        };
        Ok(Along { coefficients, changes, lies })
    }

    fn nearly_lies(surface: &Surface, c: &[Dyadic; 3], line: &Line, chord: &Chord) -> Result<bool, Doubt> {
        let deepest =
            |times: &[Dyadic; 2]| times.iter().map(|t| depth(surface, c, line, t)).fold(0.0, f64::max);
        let middle = depth(surface, c, line, &chord.middle);
        if middle > GREY || middle.max(deepest(&chord.short)) > GREY {
            return Ok(false);
        }
        if middle.max(deepest(&chord.long)) * GREY < 1.0 { Ok(true) } else { Err(Doubt::Lying) }
    }

    /// The greatest time by which a root may move if the surface moves by `by`.
    pub(super) fn play(&self, surface: &Surface, line: &Line, root: &Root, by: f64) -> f64 {
        let t = root.near();
        let [a, b, _] = &self.coefficients;
        let error = by * surface.slope(&line.at(&t.rounded()));
        let speed = (&(a * t).scaled(1) + b).to_f64().abs();
        let bend = a.to_f64().abs();
        // f moves by error: a second root joins in if the extremum between them is not farther away
        if speed * speed >= 4.0 * bend * error { 2.0 * error / speed } else { 2.5 * (error / bend).sqrt() }
    }

    /// The distance between the surface and the ray where they are almost tangent.
    pub(super) fn extremum(&self, surface: &Surface, line: &Line) -> f64 {
        let [a, b, _] = &self.coefficients;
        if a.is_zero() || self.lies {
            return f64::INFINITY;
        }
        distance(surface, &self.coefficients, line, &(-b).over(&a.scaled(1)))
    }
}

/// True (negative) if moving along w makes f negative. In placed parts the middle of the chord may be another:
/// then the side must be the same all along.
fn side_along_w(surface: &Surface, line: &Line, chord: &Chord) -> Result<bool, Doubt> {
    let side = side_at(surface, line, &chord.middle)?;
    let elsewhere = chord.long.iter().filter(|_| chord.short != chord.long);
    for t in elsewhere {
        if side_at(surface, line, t)? != side {
            return Err(Doubt::Side);
        }
    }
    Ok(side)
}

pub(super) fn side_at(surface: &Surface, line: &Line, t: &Dyadic) -> Result<bool, Doubt> {
    let gradient = surface.gradient(&line.at(t));
    let w = W.map(Dyadic::from);
    let slope = (0..3).fold(Dyadic::ZERO, |sum, k| &sum + &(&w[k] * &gradient[k]));
    let size = gradient.iter().fold(0.0, |size: f64, g| size.max(g.to_f64().abs()));
    if slope.is_zero() {
        let first = gradient.iter().find(|g| !g.is_zero());
        return first.map(|g| g.sign() < 0).ok_or(Doubt::Side);
    }
    if slope.to_f64().abs() > 1e-9 * size { Ok(slope.sign() < 0) } else { Err(Doubt::Side) }
}
