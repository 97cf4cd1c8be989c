//! Robust geometric predicates: exact signs of orientations and of differences of products.
//!
//! *Source*: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates",
//! Discrete & Computational Geometry 18 (1997): a floating-point filter, then the exact sum as an expansion.
//!
//! *Guarantee*: exact for numbers that are 0 or between 1e-100 and 1e100 in magnitude: products of their differences do not
//! overflow, and their parts are above 1e-232, where `two_product` is exact.

use crate::Point;
use rayweave_math::UNIT_ROUNDOFF;
use rayweave_math::roots::{two_product, two_sum};

/// The sign of `(a - b) (c - d) - (e - f) (g - h)`: -1, 0 or 1.
pub fn sign([a, b]: [f64; 2], [c, d]: [f64; 2], [e, f]: [f64; 2], [g, h]: [f64; 2]) -> i8 {
    let (p, q) = ((a - b) * (c - d), (e - f) * (g - h));
    let value = p - q;
    // each difference, each product and the last difference have a relative error of at most u: 3 u (|p| + |q|) + u |value|
    // plus terms in u^2, in total below 5 u (|p| + |q|)
    if value.abs() > 5.0 * UNIT_ROUNDOFF * (p.abs() + q.abs()) {
        return if value > 0.0 { 1 } else { -1 };
    }
    if (a == b || c == d) && (e == f || g == h) {
        return 0;
    }
    let mut sum = Expansion::default();
    for term in product([a, b], [c, d]) {
        sum.add(term);
    }
    for term in product([e, f], [g, h]) {
        sum.add(-term);
    }
    sum.sign()
}

/// `(a - b) (c - d)` as an exact sum of parts.
fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 8] {
    let ((p, p_error), (q, q_error)) = (two_sum(a, -b), two_sum(c, -d));
    let pairs = [(p, q), (p, q_error), (p_error, q), (p_error, q_error)];
    let mut parts = [0.0; 8];
    for (k, (x, y)) in pairs.into_iter().enumerate() {
        (parts[2 * k], parts[2 * k + 1]) = two_product(x, y);
    }
    parts
}

/// An exact sum of numbers as nonoverlapping parts in increasing magnitude (Shewchuk's expansion).
#[derive(Default)]
struct Expansion {
    parts: [f64; 16],
    count: usize,
}

impl Expansion {
    /// Shewchuk's grow-expansion with zero elimination.
    fn add(&mut self, term: f64) {
        let (mut carry, mut kept) = (term, 0);
        for k in 0..self.count {
            let (sum, error) = two_sum(carry, self.parts[k]);
            if error != 0.0 {
                self.parts[kept] = error;
                kept += 1;
            }
            carry = sum;
        }
        if carry != 0.0 {
            self.parts[kept] = carry;
            kept += 1;
        }
        self.count = kept;
    }

    /// The sign of the last part, which exceeds the sum of all others.
    fn sign(&self) -> i8 {
        match self.parts[..self.count].last() {
            Some(&part) if part > 0.0 => 1,
            Some(_) => -1,
            None => 0,
        }
    }
}

/// The orientation of three points: 1 counter-clockwise, -1 clockwise, 0 collinear.
pub fn orientation(a: Point, b: Point, c: Point) -> i8 {
    sign([b[0], a[0]], [c[1], a[1]], [b[1], a[1]], [c[0], a[0]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::rational::RBig;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn exact(numbers: [[f64; 2]; 4]) -> i8 {
        let [p, q, r, s] = numbers.map(|[x, y]| RBig::try_from(x).unwrap() - RBig::try_from(y).unwrap());
        (p * q).cmp(&(r * s)) as i8
    }

    #[test]
    fn signs_agree_with_rationals_near_zero() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let (mut zeros, mut filtered) = (0, 0);
        for _ in 0..20_000 {
            // three points on a line through a lattice point, perturbed by units in the last place
            let scale = libm::exp2(f64::from(rng.random_range(-200i32..200)));
            let direction = [0, 1].map(|_| f64::from(rng.random_range(-8i32..=8)));
            let mut at = || {
                let t = f64::from(rng.random_range(-9i32..=9));
                [0, 1].map(|k| {
                    let x = scale * (0.1 + t * direction[k]);
                    let ulps = if rng.random_bool(0.3) { rng.random_range(-1i64..=1) } else { 0 };
                    f64::from_bits((x.to_bits() as i64 + ulps) as u64)
                })
            };
            let (a, b, c) = (at(), at(), at());
            let truth = exact([[b[0], a[0]], [c[1], a[1]], [b[1], a[1]], [c[0], a[0]]]);
            assert_eq!(orientation(a, b, c), truth, "{a:?} {b:?} {c:?}");
            match truth {
                0 => zeros += 1,
                _ => filtered += 1,
            }
        }
        assert!(zeros > 1000 && filtered > 1000, "{zeros} {filtered}");
    }

    #[test]
    fn extremes_of_the_range() {
        let tiny = 1e-100;
        assert_eq!(orientation([0.0, 0.0], [tiny, tiny], [tiny, tiny.next_up()]), 1);
        assert_eq!(orientation([0.0, 0.0], [tiny, tiny], [1e100, 1e100]), 0);
        assert_eq!(orientation([-1e100, 0.0], [tiny, 0.0], [1e100, -tiny]), -1);
    }
}
