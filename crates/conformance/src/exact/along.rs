//! A surface along a ray: its crossings, or the sides of a ray that lies in it.

use super::root::{Root, SignChanges, sign_changes};
use super::{Dyadic, Line, Surface};
use rayweave_math::{Affine, UNIT_ROUNDOFF, Vec3};
use rayweave_model::Ball;
use rayweave_shape::Ray;

/// The direction in which rays that lie in a surface are perturbed.
const W: [f64; 3] = [1.0, 0.7548776662466927, 0.5698402909980532];

/// Factor of the range of uncertain depths: a piece between 1 / GREY and GREY tolerances deep may be welded
/// or not.
pub(super) const GREY: f64 = 4.0;

/// Upper bound of 1 + sqrt(2), for roots near the extremum of `f = a t^2 + ...`: if f changes by `error` where its
/// slope v has v^2 < 4 |a| error, a root moves by at most `(v + sqrt(v^2 + 4 |a| error)) / (2 |a|)`, which is less
/// than `(1 + sqrt(2)) sqrt(error / |a|)`.
pub(super) const TANGENT_SHIFT: f64 = 2.5;

/// The reason why the exact answer for a ray is uncertain; a new ray is drawn instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncertain {
    /// Its distance from a surface is close to the tolerance.
    InSurface,
    /// The depth of a piece is close to the tolerance.
    Depth,
    /// It lies in a surface, and w does not determine the side.
    Side,
}

/// The chords over which a ray has to stay in a surface to lie in it: for each ball of the compiled model,
/// the middle of the chord and half its length, in times.
///
/// The model itself has a ball, and each solid placed in it has one. The chords are not assigned to surfaces:
/// the answer is certain only if a ray lies in a surface over all of these chords, or over none.
#[derive(Clone, Debug)]
pub struct Span(Vec<(f64, f64)>);

impl Span {
    /// The chords of a ray, for balls given with the maps into their frames.
    pub fn new(ray: &Ray, balls: &[(Affine, Ball)]) -> Span {
        let chord = |(map, ball): &(Affine, Ball)| {
            let (origin, direction) = (map.point(ray.origin), map.vector(ray.direction));
            let middle = (ball.centre - origin).dot(direction) / direction.length_squared();
            // a length below rounding counts as 0
            let point = origin.length() + middle.abs() * direction.length();
            let least = 65536.0 * UNIT_ROUNDOFF * (point + ball.centre.length() + ball.magnitude);
            let lengths = [ball.radius, (origin - ball.centre).length(), direction.length()];
            let length = lengths.into_iter().find(|&length| length > least).unwrap_or(least);
            (middle, length / direction.length())
        };
        let mut chords: Vec<(f64, f64)> = balls.iter().map(chord).collect();
        chords.dedup();
        Span(chords)
    }

    fn middles(&self) -> impl Iterator<Item = Dyadic> {
        self.0.iter().map(|chord| Dyadic::from(chord.0))
    }
}

/// The polynomial of a surface along a ray, with its sign changes.
pub(super) struct SurfacePolynomial {
    /// `[a, b, c]` of `a t^2 + b t + c`.
    pub(super) coefficients: [Dyadic; 3],
    pub(super) changes: SignChanges,
    pub(super) lies: bool,
    /// `[rise, level]` of `w . grad f = rise t + level`, if the ray lies in the surface and its side changes.
    turn: Option<[Dyadic; 2]>,
}

fn polynomial([a, b, c]: &[Dyadic; 3], t: &Dyadic) -> Dyadic {
    &(&(&(a * t) + b) * t) + c
}

pub(super) fn delta(surface: &Surface, line: &Line, t: f64) -> f64 {
    let (o, d) = (line.ray.origin.length(), line.ray.direction.length());
    64.0 * UNIT_ROUNDOFF * (o + t.abs() * d + surface.magnitude)
}

/// The distance of the ray from a surface at a time, to first order.
pub(super) fn distance(surface: &Surface, coefficients: &[Dyadic; 3], line: &Line, t: &Dyadic) -> f64 {
    let value = polynomial(coefficients, t).to_f64().abs();
    if value == 0.0 { 0.0 } else { value / surface.slope(&line.at(&t.rounded())) }
}

/// The distance in units of the tolerance.
pub(super) fn depth(surface: &Surface, coefficients: &[Dyadic; 3], line: &Line, t: &Dyadic) -> f64 {
    distance(surface, coefficients, line, t) / delta(surface, line, t.to_f64())
}

impl SurfacePolynomial {
    pub(super) fn new(surface: &Surface, line: &Line, span: &Span) -> Result<SurfacePolynomial, Uncertain> {
        let coefficients = surface.along(line);
        let lies = coefficients.iter().all(Dyadic::is_zero)
            || Self::nearly_lies(surface, &coefficients, line, span)?;
        let turn = if lies { turn(surface, line, span)? } else { None };
        let changes = match (lies, &turn) {
            (true, Some([rise, level])) => sign_changes(&[Dyadic::ZERO, rise.clone(), level.clone()]),
            (true, None) => {
                SignChanges { starts_negative: side_along_w(surface, line, span)?, roots: Vec::new() }
            }
            (false, _) => sign_changes(&coefficients),
        };
        Ok(SurfacePolynomial { coefficients, changes, lies, turn })
    }

    /// The distance of the ray from the surface at a time, in units of the tolerance. For a ray in the surface whose side
    /// changes it is `w . grad f` in units of its rounding, which bounds the time of the change.
    pub(super) fn depth(&self, surface: &Surface, line: &Line, t: &Dyadic) -> f64 {
        match &self.turn {
            // the engine takes 2 (2 bend delta |w|) for rounding, where the bend here already has the factor 2 |w|
            Some([rise, level]) => {
                let slope = (&(rise * t) + level).to_f64().abs();
                slope / (2.0 * surface.bend() * delta(surface, line, t.to_f64()))
            }
            None => depth(surface, &self.coefficients, line, t),
        }
    }

    fn nearly_lies(surface: &Surface, c: &[Dyadic; 3], line: &Line, span: &Span) -> Result<bool, Uncertain> {
        let mut verdicts = span.0.iter().map(|&chord| Self::keeps_to(surface, c, line, chord));
        let first = verdicts.next().unwrap_or(Ok(false))?;
        verdicts
            .try_fold(first, |all, verdict| if verdict? == all { Ok(all) } else { Err(Uncertain::InSurface) })
    }

    /// True if the chord lies in the surface: tested in its middle, at its ends, near the start of the ray, where the tolerance
    /// is smallest, and where the gradient is shortest.
    fn keeps_to(
        surface: &Surface,
        c: &[Dyadic; 3],
        line: &Line,
        (middle, half): (f64, f64),
    ) -> Result<bool, Uncertain> {
        let depth = |t: f64| depth(surface, c, line, &Dyadic::from(t));
        let inner = depth(middle);
        if inner > GREY {
            return Ok(false);
        }
        let (a, b) = (middle - half, middle + half);
        let length = (line.ray.origin.length() + surface.magnitude) / line.ray.direction.length();
        let start = 0.0f64.clamp(a, b);
        let times = [a, b, start, (start - length).max(a), (start + length).min(b)];
        let deepest = times.into_iter().map(depth).fold(inner, f64::max);
        match deepest.max(Self::depth_at_shortest_gradient(surface, c, line, (middle, half))) {
            deepest if deepest > GREY => Ok(false),
            deepest if deepest * GREY < 1.0 => Ok(true),
            _ => Err(Uncertain::InSurface),
        }
    }

    /// The depth at the time of the shortest gradient, if that is on the chord; else 0. The gradient is linear along the ray. It
    /// may be 0 there, so the change of the gradient within the tolerance is added to it.
    fn depth_at_shortest_gradient(
        surface: &Surface,
        c: &[Dyadic; 3],
        line: &Line,
        (middle, half): (f64, f64),
    ) -> f64 {
        let gradient = |t: &Dyadic| surface.gradient(&line.at(t));
        let middle = Dyadic::from(middle);
        let (here, next) = (gradient(&middle), gradient(&(&middle + &Dyadic::ONE)));
        let rate = Vec3::from_array(std::array::from_fn(|k| (&next[k] - &here[k]).to_f64()));
        let here = Vec3::from_array(here.map(|g| g.to_f64()));
        let later = -here.dot(rate) / rate.length_squared();
        if later.is_nan() || later.abs() >= half {
            return 0.0;
        }
        let t = &middle + &Dyadic::from(later);
        let delta = delta(surface, line, t.to_f64());
        // a quarter of the bound along w is the change of the gradient itself
        let slope = surface.slope(&line.at(&t)) + 0.25 * surface.bend() * delta;
        polynomial(c, &t).to_f64().abs() / slope / delta
    }

    /// Upper bound of the change of a root if the surface moves by `by`.
    pub(super) fn time_error(&self, surface: &Surface, line: &Line, root: &Root, by: f64) -> f64 {
        let t = root.approximation();
        if let Some([rise, _]) = &self.turn {
            return 2.0 * by * surface.bend() / rise.to_f64().abs();
        }
        let [a, b, _] = &self.coefficients;
        let error = by * surface.slope(&line.at(&t.rounded()));
        let speed = (&(a * t).scaled(1) + b).to_f64().abs();
        let bend = a.to_f64().abs();
        // f changes by error: a second root takes part if the extremum between them is at most that far away;
        // without one the shift s = 2 error / (speed + sqrt(speed^2 - 4 bend error)) is at most 2 error / speed
        if speed * speed >= 4.0 * bend * error {
            2.0 * error / speed
        } else {
            TANGENT_SHIFT * (error / bend).sqrt()
        }
    }

    /// For a surface that is touched within the tolerance but not crossed: the time, and the change of it if
    /// the surface moves by the tolerance.
    pub(super) fn touch(&self, surface: &Surface, line: &Line) -> Option<(f64, f64)> {
        let [a, b, _] = &self.coefficients;
        if !self.changes.roots.is_empty() || a.is_zero() || self.lies {
            return None;
        }
        let middle = (-b).over(&a.scaled(1));
        let (t, error) = (middle.to_f64(), delta(surface, line, middle.to_f64()));
        let slope = surface.slope(&line.at(&middle.rounded()));
        let near = polynomial(&self.coefficients, &middle).to_f64().abs()
            <= error * (slope + error * surface.bend());
        near.then(|| {
            (t, TANGENT_SHIFT * (error * (slope + error * surface.bend()) / a.to_f64().abs()).sqrt())
        })
    }

    /// The distance between the surface and the ray at the extremum of the polynomial, where they may be tangent. If the
    /// polynomial is constant, the least of the distances at the times 0 and 1: beside a ruling it falls with the distance from the
    /// apex, and rounding may move the ray across the surface.
    pub(super) fn extremum(&self, surface: &Surface, line: &Line) -> f64 {
        let [a, b, _] = &self.coefficients;
        let distance = |t: &Dyadic| distance(surface, &self.coefficients, line, t);
        if self.lies {
            return f64::INFINITY;
        }
        match (a.is_zero(), b.is_zero()) {
            (false, _) => distance(&(-b).over(&a.scaled(1))),
            (true, false) => f64::INFINITY,
            (true, true) => distance(&Dyadic::ZERO).min(distance(&Dyadic::ONE)),
        }
    }
}

/// `[rise, level]` of `w . grad f` along a ray in the surface; `None` if it is constant up to rounding.
fn turn(surface: &Surface, line: &Line, span: &Span) -> Result<Option<[Dyadic; 2]>, Uncertain> {
    // along the rulings of a cylinder the gradient is constant; a ray that drifts away from them, within the tolerance
    // on the chord, would get a change of side far outside the model
    if surface.is_circular_cylinder() {
        return Ok(None);
    }
    let slope = |t: Dyadic| {
        let gradient = surface.gradient(&line.at(&t));
        let w = W.map(Dyadic::from);
        (0..3).fold(Dyadic::ZERO, |sum, k| &sum + &(&w[k] * &gradient[k]))
    };
    let level = slope(Dyadic::ZERO);
    let rise = &slope(Dyadic::ONE) - &level;
    if rise.is_zero() {
        return Ok(None);
    }
    let mut verdicts = span.0.iter().map(|&(middle, half)| {
        let change = rise.to_f64().abs() * 2.0 * half;
        let noise = surface.bend() * delta(surface, line, middle.abs() + half);
        match change / noise {
            ratio if ratio > 8.0 * GREY => Ok(true),
            ratio if ratio * GREY < 1.0 => Ok(false),
            _ => Err(Uncertain::Side),
        }
    });
    let first = verdicts.next().unwrap_or(Ok(false))?;
    let turns =
        verdicts.try_fold(first, |all, one| if one? == all { Ok(all) } else { Err(Uncertain::Side) })?;
    Ok(turns.then_some([rise, level]))
}

/// True (negative) if moving along w makes f negative, in the middle of each chord.
fn side_along_w(surface: &Surface, line: &Line, span: &Span) -> Result<bool, Uncertain> {
    let mut sides = span.middles().map(|t| {
        // the middle is rounded: at a self-intersection of the surface the gradient is 0, and its direction nearby is
        // arbitrary
        let slack = surface.bend() * delta(surface, line, t.to_f64());
        side_at(surface, line, &t, slack)
    });
    let first = sides.next().unwrap_or(Err(Uncertain::Side))?;
    sides.try_fold(first, |all, side| if side? == all { Ok(all) } else { Err(Uncertain::Side) })
}

/// Like [`side_along_w`] at one time; the error of the gradient is at most `slack`.
pub(super) fn side_at(surface: &Surface, line: &Line, t: &Dyadic, slack: f64) -> Result<bool, Uncertain> {
    let gradient = surface.gradient(&line.at(t));
    let w = W.map(Dyadic::from);
    let slope = (0..3).fold(Dyadic::ZERO, |sum, k| &sum + &(&w[k] * &gradient[k]));
    let size = gradient.iter().fold(0.0, |size: f64, g| size.max(g.to_f64().abs()));
    if slope.is_zero() && slack < 1e-9 * size {
        let first = gradient.iter().find(|g| !g.is_zero());
        return first.map(|g| g.sign() < 0).ok_or(Uncertain::Side);
    }
    let certain = slope.to_f64().abs() > 1e-9 * size + slack;
    if certain { Ok(slope.sign() < 0) } else { Err(Uncertain::Side) }
}
