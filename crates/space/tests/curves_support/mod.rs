//! Shared helpers of curve tests: a curve of closures, and polynomials in exact arithmetic.
#![allow(dead_code, reason = "each test program uses a part of it")]

use dashu::base::Sign;
use dashu::rational::RBig;
use rayweave_space::{Curve, Point};

/// A user-defined curve.
pub struct Own<P, V, A> {
    pub position: P,
    pub velocity: V,
    pub bound: A,
}

impl<const D: usize, P, V, A> Curve<D> for Own<P, V, A>
where
    P: Fn(f64) -> Point<D>,
    V: Fn(f64) -> Point<D>,
    A: Fn(f64, f64) -> f64,
{
    fn position(&self, t: f64) -> Point<D> {
        (self.position)(t)
    }

    fn velocity(&self, t: f64) -> Point<D> {
        (self.velocity)(t)
    }

    fn acceleration_bound(&self, t0: f64, t1: f64) -> f64 {
        (self.bound)(t0, t1)
    }
}

/// A polynomial with exact coefficients, the constant first.
#[derive(Clone, Debug)]
pub struct Polynomial(pub Vec<RBig>);

pub fn exact(x: f64) -> RBig {
    RBig::try_from(x).unwrap()
}

impl Polynomial {
    pub fn new(coefficients: &[f64]) -> Polynomial {
        Polynomial(coefficients.iter().map(|&c| exact(c)).collect()).trimmed()
    }

    pub fn plus(&self, other: &Polynomial) -> Polynomial {
        let at = |p: &Polynomial, k: usize| p.0.get(k).cloned().unwrap_or(RBig::ZERO);
        Polynomial((0..self.0.len().max(other.0.len())).map(|k| at(self, k) + at(other, k)).collect())
            .trimmed()
    }

    pub fn times(&self, other: &Polynomial) -> Polynomial {
        let mut product = vec![RBig::ZERO; self.0.len() + other.0.len()];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Polynomial(product).trimmed()
    }

    fn trimmed(mut self) -> Polynomial {
        while self.0.last() == Some(&RBig::ZERO) {
            self.0.pop();
        }
        self
    }

    pub fn sign_at(&self, t: f64) -> i32 {
        let t = exact(t);
        let value = self.0.iter().rev().fold(RBig::ZERO, |sum, c| sum * &t + c);
        match (value == RBig::ZERO, value.sign()) {
            (true, _) => 0,
            (_, Sign::Negative) => -1,
            _ => 1,
        }
    }

    fn derivative(&self) -> Polynomial {
        let terms = self.0.iter().enumerate().skip(1);
        Polynomial(terms.map(|(k, c)| c * RBig::from(k as u32)).collect())
    }

    /// The negated remainder of a division.
    fn minus_remainder(&self, by: &Polynomial) -> Polynomial {
        let mut rest = self.0.clone();
        let leading = by.0.last().unwrap();
        while rest.len() >= by.0.len() {
            let factor = rest.last().unwrap() / leading;
            let shift = rest.len() - by.0.len();
            for (k, c) in by.0.iter().enumerate() {
                rest[shift + k] -= &factor * c;
            }
            rest.pop();
        }
        Polynomial(rest.into_iter().map(|c| -c).collect()).trimmed()
    }

    /// The number of distinct roots in `(t0, t1]`, by Sturm's theorem.
    pub fn count_roots(&self, t0: f64, t1: f64) -> usize {
        let mut chain = vec![self.clone(), self.derivative()];
        while chain[chain.len() - 1].0.len() > 1 {
            let next = chain[chain.len() - 2].minus_remainder(&chain[chain.len() - 1]);
            if next.0.is_empty() {
                break;
            }
            chain.push(next);
        }
        let changes = |t: f64| {
            let signs: Vec<i32> = chain.iter().map(|p| p.sign_at(t)).filter(|&s| s != 0).collect();
            signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
        };
        changes(t0) - changes(t1)
    }
}
