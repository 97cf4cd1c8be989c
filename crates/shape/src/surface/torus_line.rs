//! Torus roots along a straight line: sign changes of `g(s) = (rho - major)^2 + z^2 - minor^2`, by Newton-like steps with
//! bisection.
//!
//! With a unit direction `g = s^2 + linear - 2 major rho(s)`. The distance rho from the axis is convex with `rho'' =
//! twist^2 / rho^3`, where twist is the moment of the line about the axis. So g is convex where `rho^3 > major twist^2`,
//! i.e. before and after one interval about the point closest to the axis, and concave within it. On each of these at most
//! three pieces the signs of g at the two ends, and at the extremum in between if both ends have the sign of the curvature,
//! determine the number of sign changes. Each sign change is then found by safeguarded steps in its bracket. No decision
//! depends on the size of a residual, so the list always has the right parity and order, and a crossing is lost or invented
//! only if the sign of g at an extremum is within its rounding, a few u (major + minor) in distance.
//!
//! Lengths are scaled by a power of two such that major + minor is about 1: scaling a scene by a power of two changes no
//! digit.

use super::Torus;
use rayweave_math::{UNIT_ROUNDOFF, Vec3};

/// Up to four times in increasing order.
#[derive(Clone, Copy, Debug, Default)]
pub struct Times {
    times: [f64; 4],
    count: usize,
}

impl Times {
    fn push(&mut self, t: f64) {
        if self.count < 4 {
            self.times[self.count] = t;
            self.count += 1;
        }
    }

    /// The times.
    pub fn found(&self) -> &[f64] {
        &self.times[..self.count]
    }

    /// The times, mutable for scaling.
    pub fn found_mut(&mut self) -> &mut [f64] {
        &mut self.times[..self.count]
    }
}

/// g and its derivatives at a point of the line.
#[derive(Clone, Copy, Debug)]
struct Jet {
    value: f64,
    /// Half of the slope; NaN on the axis.
    slope: f64,
    /// `major twist^2 / rho^3`: 1 minus half of the second derivative.
    turn: f64,
    /// 1 / rho.
    inverse: f64,
}

impl Jet {
    /// Half of the second derivative.
    fn curvature(&self) -> f64 {
        1.0 - self.turn
    }
}

/// A part of the line on which g is convex or concave.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from: f64,
    to: f64,
    convex: bool,
}

/// The line, by arc length, in units in which major + minor is about 1.
#[derive(Clone, Copy, Debug)]
pub struct TorusLine {
    across: Vec3,
    along: Vec3,
    z: f64,
    rise: f64,
    major: f64,
    minor: f64,
    /// `|along|^2`, `across . along` and the squared moment about the axis.
    alpha: f64,
    beta: f64,
    twist_squared: f64,
    /// If the line starts on the torus: `rho` at the start; g is then relative to its value there.
    start: Option<f64>,
}

/// Distance from the axis below which the rounding of a point matters.
pub(crate) const AXIS: f64 = 128.0 * UNIT_ROUNDOFF;

/// Largest final step: at a nearly double root, the noise of g divided by its slope.
pub(crate) const POLISH: f64 = 1.0 / (1u64 << 20) as f64;

/// Largest error of a step, relative to the noise of g, that is accepted without another evaluation.
pub(crate) const CERTAIN: f64 = 1.0 / 16.0;

/// Margin around a region outside of which g > 0, against rounding of its border.
pub(crate) const MARGIN: f64 = 1.0 / (1u64 << 40) as f64;

impl TorusLine {
    /// The line through the point q relative to the torus's centre along d, and the factor from times to arc lengths.
    pub fn new(torus: &Torus, q: Vec3, d: Vec3) -> (TorusLine, f64) {
        let scale = TorusLine::scale(torus);
        let length = d.length();
        let (q, d) = (scale * q, (1.0 / length) * d);
        let (z, rise) = (torus.axis.dot(q), torus.axis.dot(d));
        let (across, along) = (q - z * torus.axis, d - rise * torus.axis);
        let twist = torus.axis.dot(across.cross(along));
        let line = TorusLine {
            across,
            along,
            z,
            rise,
            major: scale * torus.major,
            minor: scale * torus.minor,
            alpha: along.length_squared(),
            beta: across.dot(along),
            twist_squared: twist * twist,
            start: None,
        };
        (line, scale * length)
    }

    /// Factor to units in which major + minor is about 1: a power of two.
    pub(crate) fn scale(torus: &Torus) -> f64 {
        libm::ldexp(1.0, -libm::ilogb(torus.major + torus.minor))
    }

    /// Sign changes of g; it is positive far away.
    pub fn sign_changes(&self) -> Times {
        let mut times = Times::default();
        let Some((from, to)) = self.window() else {
            return times;
        };
        for piece in self.pieces(from, to).into_iter().flatten() {
            let (from, to) = (self.jet(piece.from), self.jet(piece.to));
            self.search(&piece, from, to, &mut times);
        }
        times
    }

    /// Sign changes, for s > 0, of g minus its value at s = 0.
    ///
    /// g = s k(s), and k has no root at s = 0. On the first piece k is monotonic, because g is convex or concave there and
    /// 0 at its beginning: k has a root there if its signs at the ends differ.
    pub fn sign_changes_from_start(&self) -> Times {
        let line = TorusLine { start: Some(self.across.length()), ..*self };
        let mut times = Times::default();
        let k = line.chord_slope(0.0);
        // beyond this bound s^2 + 2 s (q . d) exceeds 2 major (rho(s) - rho(0)) <= 2 major s
        let radial = (self.beta + self.z * self.rise).abs();
        let to = 2.0 * (1.0 + MARGIN) * (self.major + radial);
        for piece in line.pieces(0.0, to).into_iter().flatten() {
            let end = line.jet(piece.to);
            if piece.from > 0.0 {
                line.search(&piece, line.jet(piece.from), end, &mut times);
                continue;
            }
            let negative = if k == 0.0 { !piece.convex } else { k < 0.0 };
            if negative != (end.value < 0.0) {
                times.push(line.root(&piece, negative, (piece.to, end)));
            }
        }
        times
    }

    /// `g(s) / s` with g relative to its value at 0: `s + 2 q.d - 2 major (rho(s) - rho(0)) / s`.
    fn chord_slope(&self, s: f64) -> f64 {
        let rho = (self.across + s * self.along).length();
        let sum = rho + self.start.unwrap_or(0.0);
        let drift = if sum > 0.0 { (self.alpha * s + 2.0 * self.beta) / sum } else { self.alpha.sqrt() };
        s + 2.0 * ((self.beta + self.z * self.rise) - self.major * drift)
    }

    fn jet(&self, s: f64) -> Jet {
        let p = self.across + s * self.along;
        let z = self.z + s * self.rise;
        let rho = p.length();
        let (ring, inverse) = (rho - self.major, 1.0 / rho);
        // k is better conditioned near the start, and g farther away, where its rounding is below that of s k
        let value = if self.start.is_some() && s <= self.minor {
            s * self.chord_slope(s)
        } else {
            ring * ring + (z * z - self.minor * self.minor)
        };
        // so close to the axis the direction of p is noise, and g has a kink
        let outwards = if rho > AXIS { p.dot(self.along) * inverse } else { f64::NAN };
        Jet {
            value,
            slope: ring * outwards + z * self.rise,
            turn: self.major * self.twist_squared * (inverse * inverse * inverse),
            inverse,
        }
    }

    /// The part of the line within the ball and the slab that contain the torus.
    fn window(&self) -> Option<(f64, f64)> {
        let outer = (self.major + self.minor) * (1.0 + MARGIN);
        let middle = -(self.beta + self.z * self.rise);
        let nearest = (self.across + middle * self.along).length_squared()
            + (self.z + middle * self.rise) * (self.z + middle * self.rise);
        let square = outer * outer - nearest;
        if square.is_nan() || square <= 0.0 {
            return None;
        }
        let half = square.sqrt();
        let thick = self.minor + MARGIN * outer;
        let (a, b) = ((-thick - self.z) / self.rise, (thick - self.z) / self.rise);
        if self.rise == 0.0 {
            return (self.z.abs() < thick).then_some((middle - half, middle + half));
        }
        let (from, to) = (a.min(b).max(middle - half), a.max(b).min(middle + half));
        (from < to).then_some((from, to))
    }

    /// The convex, concave and convex pieces between two points.
    fn pieces(&self, from: f64, to: f64) -> [Option<Piece>; 3] {
        let piece = |a: f64, b: f64, convex: bool| {
            let (from, to) = (a.max(from), b.min(to));
            (from < to).then_some(Piece { from, to, convex })
        };
        let (lo, hi) = (f64::NEG_INFINITY, f64::INFINITY);
        match self.inflections() {
            None => [piece(lo, hi, true), None, None],
            Some((a, b)) => [piece(lo, a, true), piece(a, b, false), piece(b, hi, true)],
        }
    }

    /// The points with `rho^3 = major twist^2`, if there are any.
    fn inflections(&self) -> Option<(f64, f64)> {
        if self.alpha == 0.0 {
            return None;
        }
        let (rho, inverse) = (cube_root(self.major * self.twist_squared), 1.0 / self.alpha);
        let square = (rho * rho - self.twist_squared * inverse) * inverse;
        let closest = -self.beta * inverse;
        let half = square.sqrt();
        (square >= 0.0 && half.is_finite()).then_some((closest - half, closest + half))
    }

    /// The sign changes in one piece: g has at most one between ends of different sign, and none or two between ends that
    /// both have the sign of the curvature.
    fn search(&self, piece: &Piece, from: Jet, to: Jet, times: &mut Times) {
        let (first, last) = (from.value < 0.0, to.value < 0.0);
        if first != last {
            let is_nearer = from.value.abs() < to.value.abs();
            let near = if is_nearer { (piece.from, from) } else { (piece.to, to) };
            times.push(self.root(piece, first, near));
        } else if first != piece.convex
            && let Some(between) = self.other_side(piece, from, to)
        {
            times.push(self.root(&Piece { to: between.0, ..*piece }, first, between));
            times.push(self.root(&Piece { from: between.0, ..*piece }, !first, between));
        }
    }

    /// A point of the piece where g has the opposite sign of both ends: a search for the extremum that stops as soon as
    /// such a point is found, or a tangent shows that there is none.
    fn other_side(&self, piece: &Piece, from: Jet, to: Jet) -> Option<(f64, Jet)> {
        let up = if piece.convex { 1.0 } else { -1.0 };
        // a NaN slope decides nothing
        if up * from.slope >= 0.0 || up * to.slope <= 0.0 {
            return None;
        }
        let (mut lo, mut hi) = (piece.from, piece.to);
        let mut s = within(lo, hi, lo - from.slope * (hi - lo) / (to.slope - from.slope));
        for _ in 0..80 {
            let jet = self.jet(s);
            if (jet.value < 0.0) == piece.convex {
                return Some((s, jet));
            }
            // only ends of a piece are on the axis
            let rising = up * jet.slope > 0.0 || (jet.slope.is_nan() && hi - s < s - lo);
            if rising {
                hi = s;
            } else {
                lo = s;
            }
            let room = if rising { s - lo } else { hi - s };
            let out_of_reach = up * jet.value > 2.0 * jet.slope.abs() * room;
            let next = within(lo, hi, s - jet.slope / jet.curvature());
            if out_of_reach || (next - s).abs() <= UNIT_ROUNDOFF * (1.0 + s.abs()) {
                return None;
            }
            s = next;
        }
        None
    }

    /// The sign change in a bracket: steps to the root of the local parabola (Euler's method, of third order, and as fast
    /// at a nearly double root), or bisection if a step leaves the bracket.
    fn root(&self, piece: &Piece, starts_negative: bool, near: (f64, Jet)) -> f64 {
        let (mut lo, mut hi, (mut s, mut jet)) = (piece.from, piece.to, near);
        for _ in 0..120 {
            if (jet.value < 0.0) == starts_negative {
                lo = s
            } else {
                hi = s
            }
            let step = parabola_step(&jet);
            let near = s + step;
            let least = if self.start.is_some() { self.minor.min(s) } else { self.minor };
            let between = lo < near && near < hi;
            if between && self.is_certain(&jet, step, least) {
                return near;
            }
            let is_small =
                jet.value.abs() <= UNIT_ROUNDOFF * least || (near - s).abs() <= UNIT_ROUNDOFF * s.abs();
            if is_small && !recedes(&jet, starts_negative, UNIT_ROUNDOFF * least) {
                // if slope and curvature vanish too, the parabola is noise and its root may be anywhere
                let polished = between && (near - s).abs() <= POLISH;
                return if polished { near } else { s };
            }
            let next = within(lo, hi, near);
            if next == s {
                // no further step changes s
                return s;
            }
            (s, jet) = (next, self.jet(next));
        }
        s
    }

    /// True if the root of the parabola equals the root of g up to noise.
    ///
    /// By Taylor's theorem `g = 0 +- max |g'''| |step|^3 / 6` there, and `|g'''| = 6 turn |rho'| / rho <= 6 turn / rho`
    /// grows by at most (8/7)^4 < 2 if rho shrinks by at most an eighth. This must be small against the noise of g near a
    /// root, `u minor`. The noise at the point itself, which grows with g, is small, too, if g is at most `minor^2`.
    fn is_certain(&self, jet: &Jet, step: f64, least: f64) -> bool {
        let step = step.abs();
        let error = 2.0 * (jet.turn * jet.inverse) * (step * step * step);
        jet.value.abs() <= self.minor * least
            && 8.0 * step * jet.inverse <= 1.0
            && error <= CERTAIN * UNIT_ROUNDOFF * least
    }
}

/// `s` if it is strictly between the bounds, else the midpoint.
fn within(lo: f64, hi: f64, s: f64) -> f64 {
    if lo < s && s < hi { s } else { 0.5 * lo + 0.5 * hi }
}

/// True if g grows from negative to positive values in a bracket but falls at a point of it, or the opposite.
///
/// On a piece, g is convex or concave, so it has its only extremum between such a point and the sign change: the point is not
/// the sign change, however small g is there. This occurs at an inflection near which the line is almost tangent, with contact
/// of third order: g is about `c s (s^2 - w^2)` about it, below its noise at s = 0, with sign changes at +-w as well.
///
/// The extremum of the local parabola differs from the value by `slope^2 / curvature`. If that is noise, too, the line touches
/// the torus there, and the point stands for both sign changes. The root of the parabola at a receding point is outside the
/// bracket, so the next step is a bisection. An unknown slope is none.
fn recedes(jet: &Jet, starts_negative: bool, noise: f64) -> bool {
    let is_opposite = if starts_negative { jet.slope < 0.0 } else { jet.slope > 0.0 };
    is_opposite && jet.slope * jet.slope > jet.curvature().abs() * noise
}

/// Root of `value + 2 slope x + curvature x^2` nearest to 0; NaN if there is none.
fn parabola_step(jet: &Jet) -> f64 {
    let discriminant = jet.slope * jet.slope - jet.curvature() * jet.value;
    -jet.value / (jet.slope + discriminant.sqrt().copysign(jet.slope))
}

/// Cube root of a number >= 0 within a few roundings; 0 for less than 2^-600.
///
/// The inverse cube root is a guess from the exponent with two steps of fourth order (Moroz, Samotyy, Walczyk, Cieslinski:
/// "Fast calculation of cube and inverse cube roots using a magic constant", 2021); all operations are available in SIMD
/// lanes.
pub(crate) fn cube_root(x: f64) -> f64 {
    if x < CUBE_LEAST {
        return 0.0;
    }
    let high = f64::from_bits((x.to_bits() >> 32) | CUBE_ONE.to_bits()) - CUBE_ONE;
    let guess = (CUBE_MAGIC - high * (1.0 / 3.0)) + CUBE_ONE;
    let mut y = f64::from_bits(guess.to_bits() << 32);
    for _ in 0..2 {
        let rest = 1.0 - x * (y * y * y);
        y += y * rest * (1.0 / 3.0 + rest * (2.0 / 9.0 + rest * (14.0 / 81.0)));
    }
    x * (y * y)
}

/// Smallest number with a nonzero cube root.
pub(crate) const CUBE_LEAST: f64 = f64::from_bits((1023 - 600) << 52);

/// 2^52: the last bits of its sum with a 32-bit number hold that number.
pub(crate) const CUBE_ONE: f64 = (1u64 << 52) as f64;

/// Upper 32 bits of the magic number for inverse cube roots.
pub(crate) const CUBE_MAGIC: f64 = 0x553e_f0ff as f64;

#[cfg(test)]
mod tests {
    use super::*;

    /// Against `libm`, which rounds correctly.
    #[test]
    fn cube_roots_are_right_within_a_few_roundings() {
        let mut x = 8.0;
        while x > CUBE_LEAST {
            let (got, expected) = (cube_root(x), libm::cbrt(x));
            assert!(
                (got - expected).abs() <= 6.0 * UNIT_ROUNDOFF * expected,
                "{x:e}: {got:e}, not {expected:e}"
            );
            x *= 0.9973;
        }
        assert_eq!(cube_root(0.0), 0.0);
    }
}
