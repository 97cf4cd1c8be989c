//! The nearest points of a quadric, by the multiplier of its equation.

use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use rayweave_shape::surface::Quadric;

/// The greatest number of steps for the multiplier of a quadric; safeguarded Newton steps need about ten.
const MOST_STEPS: usize = 200;

/// The least multiplier, relative to its end, of a quadric: below it the foot is one of a symmetric pair.
const LEAST_MULTIPLIER: f64 = 1e-30;

/// The nearest points of a quadric, one or a symmetric pair, and a lower bound of their distance; `None` without convergence.
///
/// For a multiplier m with `1 + m w_k > 0`, `min |x - p|^2 + m f(x)` over all x is at most the squared distance from f = 0, and
/// the greatest of these minima is equal to it: strong duality holds for one quadratic constraint (S. Boyd, L. Vandenberghe,
/// *Convex Optimization* (2004), B.1). The minimum is at `x_k = (p_k - m l_k / 2) / (1 + m w_k)`, where f decreases with m: its
/// root is the foot. If f has no root before the end of the range, x at the end is completed to f = 0 along the principal axis
/// whose denominator vanishes there.
pub fn quadric_foot(s: &Quadric, point: Vec3) -> Option<(Vec<Vec3>, f64)> {
    let coordinates = |v: Vec3| Vec3::from_array(s.axes.map(|axis| axis.dot(v)));
    let world = |x: Vec3| s.centre + x.x * s.axes[0] + x.y * s.axes[1] + x.z * s.axes[2];
    let problem = Problem { at: coordinates(point - s.centre), linear: coordinates(s.linear), quadric: s };
    let value = problem.value(problem.at);
    if value == 0.0 {
        return Some((vec![point], 0.0));
    }
    let (least, greatest) = (s.weights.min_element(), s.weights.max_element());
    let end = match value > 0.0 {
        true => (least < 0.0).then_some(least),
        false => (greatest > 0.0).then_some(greatest),
    };
    let range = Range { end, is_positive: value > 0.0 };
    let parameter = problem.root(&range, value)?;
    let (multiplier, denominators) = range.at(s.weights, parameter);
    let x = problem.least(multiplier, denominators);
    let left = problem.value(x);
    let squared = (x - problem.at).length_squared() + multiplier * left;
    let bound = squared.max(0.0).sqrt();
    if parameter > LEAST_MULTIPLIER || end.is_none() {
        // a Newton step removes the rounding of a long way
        let gradient = 2.0 * s.weights * x + problem.linear;
        let step = problem.value(x) / gradient.length_squared() * gradient;
        return Some((vec![world(if step.is_finite() { x - step } else { x })], bound));
    }
    let weight = end?;
    let axis = (0..3).find(|&k| s.weights[k] == weight)?;
    // w x^2 + l x + (the rest of f) = 0 along that axis
    let mut without = x;
    without[axis] = 0.0;
    let (half, rest) = (0.5 * problem.linear[axis], problem.value(without));
    let root = (half * half - weight * rest).max(0.0).sqrt();
    let on = |sign: f64| {
        let mut foot = without;
        foot[axis] = (sign * root - half) / weight;
        world(foot)
    };
    Some((vec![on(1.0), on(-1.0)], bound))
}

/// A point and a quadric in its principal axes.
struct Problem<'q> {
    at: Vec3,
    linear: Vec3,
    quadric: &'q Quadric,
}

/// The multipliers with positive denominators `1 + m w_k` of one sign, by a positive parameter: without an end m is the
/// parameter or minus it, and with the weight at the end `m = (parameter - 1) / end`, so that the smallest denominator is the
/// parameter itself, without rounding.
struct Range {
    end: Option<f64>,
    is_positive: bool,
}

impl Range {
    /// The multiplier and the denominators.
    fn at(&self, weights: Vec3, parameter: f64) -> (f64, Vec3) {
        match self.end {
            Some(end) => {
                let denominators = (Vec3::splat(end) - weights) / end + parameter * weights / end;
                ((parameter - 1.0) / end, denominators)
            }
            None => {
                let multiplier = if self.is_positive { parameter } else { -parameter };
                (multiplier, Vec3::ONE + multiplier * weights)
            }
        }
    }

    /// The derivative of the multiplier by the parameter.
    fn rate(&self) -> f64 {
        match self.end {
            Some(end) => 1.0 / end,
            None if self.is_positive => 1.0,
            None => -1.0,
        }
    }
}

impl Problem<'_> {
    fn value(&self, x: Vec3) -> f64 {
        (self.quadric.weights * x + self.linear).dot(x) + self.quadric.constant
    }

    fn least(&self, multiplier: f64, denominators: Vec3) -> Vec3 {
        (self.at - 0.5 * multiplier * self.linear) / denominators
    }

    /// The parameter at which f is 0 at the minimum, by Newton's method within bounds; that of the end of the range if there is
    /// none.
    fn root(&self, range: &Range, start: f64) -> Option<f64> {
        let weights = self.quadric.weights;
        let value_and_rate = |parameter: f64| {
            let (multiplier, denominators) = range.at(weights, parameter);
            let x = self.least(multiplier, denominators);
            let gradient = 2.0 * weights * x + self.linear;
            let terms = (weights * x).abs() + self.linear.abs();
            let noise = 4.0 * UNIT_ROUNDOFF * (terms.dot(x.abs()) + self.quadric.constant.abs());
            let rate = -0.5 * (gradient * gradient / denominators).element_sum() * range.rate();
            (self.value(x), rate, noise)
        };
        let is_before = |value: f64| (value > 0.0) == (start > 0.0);
        // `before` has the sign of the point, `after` the other one
        let (mut before, mut after) = match range.end {
            Some(_) => (1.0, LEAST_MULTIPLIER),
            None => (0.0, 1.0),
        };
        if range.end.is_some() {
            if is_before(value_and_rate(after).0) {
                return Some(after);
            }
        } else {
            while is_before(value_and_rate(after).0) {
                before = after;
                after *= 4.0;
                if after > 1e60 {
                    return None;
                }
            }
        }
        let mut parameter = before;
        for _ in 0..MOST_STEPS {
            let (value, rate, noise) = value_and_rate(parameter);
            if !value.is_finite() {
                return None;
            }
            if value.abs() <= noise {
                return Some(parameter);
            }
            if is_before(value) {
                before = parameter
            } else {
                after = parameter
            }
            let newton = parameter - value / rate;
            let (lo, hi) = if before < after { (before, after) } else { (after, before) };
            // bounds that differ by orders of magnitude are halved by their logarithms
            let middle = if lo > 0.0 && hi > 4.0 * lo { (lo * hi).sqrt() } else { 0.5 * (lo + hi) };
            let next = if newton > lo && newton < hi { newton } else { middle };
            if (next - parameter).abs() <= 2.0 * f64::EPSILON * parameter.abs() || next == lo || next == hi {
                return Some(next);
            }
            parameter = next;
        }
        // any multiplier of the range has a valid bound
        Some(parameter)
    }
}
