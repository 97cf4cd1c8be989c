//! Arithmetic of WGSL with an adversary, who chooses the neighbour to which each operation rounds, or with rounding to nearest.

/// Rounds the operations one after the other as `choices` say: true for the neighbour above the exact result. Missing choices
/// are false.
#[derive(Clone, Debug, Default)]
pub(crate) struct Adversary {
    pub choices: Vec<bool>,
    next: usize,
    /// True if all operations round to nearest, in the order in which they are written.
    is_nearest: bool,
}

/// A vector of three numbers.
pub(crate) type V3 = [f32; 3];

impl Adversary {
    pub fn new(choices: Vec<bool>) -> Adversary {
        Adversary { choices, ..Adversary::default() }
    }

    /// The arithmetic of processors, and of devices that neither contract nor reassociate.
    pub fn nearest() -> Adversary {
        Adversary { is_nearest: true, ..Adversary::default() }
    }

    /// The number of choices so far.
    pub fn count(&self) -> usize {
        self.next
    }

    /// The next choice.
    pub fn choice(&mut self) -> bool {
        let choice = self.choices.get(self.next).copied().unwrap_or(false);
        self.next += 1;
        choice
    }

    /// `exact`, the result of an operation, as one of the two neighbouring numbers.
    fn round(&mut self, exact: f64) -> f32 {
        let up = self.choice();
        let near = exact as f32;
        let (below, above) = match f64::from(near).total_cmp(&exact) {
            std::cmp::Ordering::Equal => (near, near),
            std::cmp::Ordering::Less => (near, near.next_up()),
            std::cmp::Ordering::Greater => (near.next_down(), near),
        };
        if up { above } else { below }
    }

    pub fn add(&mut self, a: f32, b: f32) -> f32 {
        if self.is_nearest { a + b } else { self.round(f64::from(a) + f64::from(b)) }
    }

    pub fn sub(&mut self, a: f32, b: f32) -> f32 {
        if self.is_nearest { a - b } else { self.round(f64::from(a) - f64::from(b)) }
    }

    pub fn mul(&mut self, a: f32, b: f32) -> f32 {
        if self.is_nearest { a * b } else { self.round(f64::from(a) * f64::from(b)) }
    }

    /// A quotient, within 2.5 units in the last place.
    pub fn div(&mut self, a: f32, b: f32) -> f32 {
        if self.is_nearest {
            return a / b;
        }
        let sign = if self.choice() { 1.0 } else { -1.0 };
        (f64::from(a) / f64::from(b) * (1.0 + sign * 2.4 * f64::from(f32::EPSILON) / 2.0)) as f32
    }

    /// A square root by `1 / inverseSqrt`, within 4.5 units in the last place.
    pub fn root(&mut self, a: f32) -> f32 {
        if self.is_nearest {
            return a.sqrt();
        }
        let sign = if self.choice() { 1.0 } else { -1.0 };
        (f64::from(a).sqrt() * (1.0 + sign * 4.4 * f64::from(f32::EPSILON))) as f32
    }

    pub fn map(&mut self, a: V3, b: V3, mut op: impl FnMut(&mut Adversary, f32, f32) -> f32) -> V3 {
        [op(self, a[0], b[0]), op(self, a[1], b[1]), op(self, a[2], b[2])]
    }

    pub fn product(&mut self, a: V3, b: V3) -> V3 {
        self.map(a, b, Adversary::mul)
    }

    /// A sum in an order of the adversary's: WGSL may reassociate.
    pub fn total(&mut self, terms: &[f32]) -> f32 {
        let chosen = (0..3).fold(0, |n, bit| n | usize::from(self.choice()) << bit);
        let at = |k: usize| terms[(chosen + k) % terms.len()];
        (1..terms.len()).fold(at(0), |sum, k| self.add(sum, at(k)))
    }

    /// A sum of sums, which the adversary adds in an order of its own.
    pub fn groups(&mut self, groups: &[&[f32]]) -> f32 {
        if !self.is_nearest {
            return self.total(&groups.concat());
        }
        let sums: Vec<f32> = groups.iter().map(|terms| self.total(terms)).collect();
        self.total(&sums)
    }

    pub fn sum(&mut self, v: V3) -> f32 {
        self.total(&v)
    }

    pub fn dot(&mut self, a: V3, b: V3) -> f32 {
        let product = self.product(a, b);
        self.sum(product)
    }
}
