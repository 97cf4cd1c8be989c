//! Times at which a ray crosses a surface of degree 1 or 2: numbers (p +- sqrt(d)) / q, compared exactly.

use super::Dyadic;
use std::cmp::Ordering;

/// A root of a polynomial of degree 1 or 2: `(p + side sqrt(d)) / q`.
#[derive(Clone, Debug)]
pub struct Root {
    p: Dyadic,
    /// -1, 0 or 1.
    side: i32,
    d: Dyadic,
    /// Greater than zero.
    q: Dyadic,
    /// The value, to about 190 bits.
    approximation: Dyadic,
    t: f64,
}

/// The sign changes of a function: its sign at -inf and its roots.
#[derive(Clone, Debug)]
pub struct SignChanges {
    /// True if the function is negative at -inf.
    pub starts_negative: bool,
    /// The roots, strictly increasing.
    pub roots: Vec<Root>,
}

impl Root {
    fn new(p: Dyadic, side: i32, d: Dyadic, q: Dyadic) -> Root {
        let (p, q) = if q.sign() < 0 { (-&p, -&q) } else { (p, q) };
        let top = match side {
            0 => p.clone(),
            1 => &p + &d.root(),
            _ => &p - &d.root(),
        };
        let approximation = top.over(&q);
        let t = approximation.to_f64();
        Root { p, side, d, q, approximation, t }
    }

    /// The root p / q.
    pub fn quotient(p: Dyadic, q: Dyadic) -> Root {
        Root::new(p, 0, Dyadic::ZERO, q)
    }

    /// The value, to about 190 bits (relative to the greater of p and sqrt(d), over q).
    pub fn approximation(&self) -> &Dyadic {
        &self.approximation
    }

    /// The value rounded to `f64`.
    pub fn t(&self) -> f64 {
        self.t
    }

    /// Exact comparison.
    pub fn compare(&self, other: &Root) -> Ordering {
        let slack = 1e-14 * (self.t.abs() + other.t.abs()) + 1e-40;
        if (self.t - other.t).abs() > slack {
            return self.t.total_cmp(&other.t);
        }
        let a = &(&self.p * &other.q) - &(&other.p * &self.q);
        let (b, c) = (times(self.side, &other.q), times(-other.side, &self.q));
        sign_of_two(&a, (&b, &self.d), (&c, &other.d)).cmp(&0)
    }
}

fn times(sign: i32, x: &Dyadic) -> Dyadic {
    match sign {
        0 => Dyadic::ZERO,
        1 => x.clone(),
        _ => -x,
    }
}

/// The sign of `a + b sqrt(d)`.
fn sign_of_one(a: &Dyadic, b: &Dyadic, d: &Dyadic) -> i32 {
    let (sa, sb) = (a.sign(), b.sign() * d.sign());
    if sa == 0 || sb == 0 || sa == sb {
        return if sb == 0 { sa } else { sb };
    }
    match a.square().compare(&(&b.square() * d)) {
        Ordering::Greater => sa,
        Ordering::Less => sb,
        Ordering::Equal => 0,
    }
}

/// The sign of `a + b sqrt(d) + c sqrt(e)`.
fn sign_of_two(a: &Dyadic, (b, d): (&Dyadic, &Dyadic), (c, e): (&Dyadic, &Dyadic)) -> i32 {
    let (first, second) = (&b.square() * d, &c.square() * e);
    let (sb, sc) = (b.sign() * d.sign(), c.sign() * e.sign());
    // the sign of the sum of the two square roots
    let roots = match (sb, sc) {
        (0, _) => sc,
        (_, 0) => sb,
        _ if sb == sc => sb,
        _ => match first.compare(&second) {
            Ordering::Greater => sb,
            Ordering::Less => sc,
            Ordering::Equal => 0,
        },
    };
    let sa = a.sign();
    if roots == 0 || sa == 0 || sa == roots {
        return if roots == 0 { sa } else { roots };
    }
    // of opposite sign: compares a^2 with the square of that sum
    let rest = &(&a.square() - &first) - &second;
    let mixed = -&(b * c).scaled(1);
    match sign_of_one(&rest, &mixed, &(d * e)) {
        1 => sa,
        0 => 0,
        _ => roots,
    }
}

/// The sign changes of `a t^2 + b t + c`, which must not vanish identically.
pub fn sign_changes([a, b, c]: &[Dyadic; 3]) -> SignChanges {
    let constant = |negative| SignChanges { starts_negative: negative, roots: Vec::new() };
    if a.is_zero() && b.is_zero() {
        return constant(c.sign() < 0);
    }
    if a.is_zero() {
        return SignChanges { starts_negative: b.sign() > 0, roots: vec![Root::quotient(-c, b.clone())] };
    }
    let starts_negative = a.sign() < 0;
    let discriminant = &b.square() - &(a * c).scaled(2);
    if discriminant.sign() <= 0 {
        return constant(starts_negative);
    }
    let mut roots: Vec<Root> = if c.is_zero() {
        vec![Root::quotient(Dyadic::ZERO, Dyadic::ONE), Root::quotient(-b, a.clone())]
    } else {
        let root = |side| Root::new(-b, side, discriminant.clone(), a.scaled(1));
        vec![root(-1), root(1)]
    };
    roots.sort_by(Root::compare);
    SignChanges { starts_negative, roots }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;

    fn polynomial(coefficients: [f64; 3]) -> [Dyadic; 3] {
        coefficients.map(Dyadic::from)
    }

    fn value([a, b, c]: &[Dyadic; 3], t: &Dyadic) -> Dyadic {
        &(&(&(a * t) + b) * t) + c
    }

    #[test]
    fn the_sign_changes_at_the_roots() {
        let mut rng = Random::new(3);
        for _ in 0..300 {
            let p = polynomial([rng.between(-1.0, 1.0), rng.between(-1.0, 1.0), rng.between(-1.0, 1.0)]);
            let found = sign_changes(&p);
            let mut negative = found.starts_negative;
            for root in &found.roots {
                let step = root.approximation().abs().scaled(-150);
                let signs =
                    [&root.approximation - &step, root.approximation() + &step].map(|t| value(&p, &t).sign());
                assert_eq!(signs, if negative { [-1, 1] } else { [1, -1] });
                negative = !negative;
            }
        }
    }

    #[test]
    fn comparison_is_exact() {
        let roots = |c: [f64; 3]| sign_changes(&polynomial(c)).roots;
        // sqrt(2) in three ways, and its nearest neighbour
        let [a, b] = [roots([1.0, 0.0, -2.0]), roots([-3.0, 0.0, 6.0])];
        assert!(a[1].compare(&b[1]).is_eq() && a[0].compare(&b[0]).is_eq() && a[0].compare(&b[1]).is_lt());
        let near = roots([0.0, 1.0, -std::f64::consts::SQRT_2]);
        assert!(near[0].compare(&a[1]).is_gt(), "the double is above the root of 2");
        // 1 + sqrt(3) against 1 + sqrt(3 + 2^-80): nearly the same value
        let c = roots([1.0, -2.0, -2.0]);
        let [one, two, constant] = polynomial([1.0, -2.0, -2.0]);
        let d = sign_changes(&[one, two, &constant - &Dyadic::ONE.scaled(-80)]).roots;
        assert_eq!(c[1].t(), d[1].t());
        assert!(c[1].compare(&d[1]).is_lt() && c[0].compare(&d[0]).is_gt());
        // (t - 1)(t - 3) and t - 3
        let e = roots([1.0, -4.0, 3.0]);
        assert!(e[1].compare(&roots([0.0, -2.0, 6.0])[0]).is_eq());
        assert!(roots([1.0, -2.0, 1.0]).is_empty());
        assert!(roots([1.0, -2.0, 0.0])[0].approximation().is_zero());
    }

    /// Compares with a high-precision approximation, on polynomials with small integer coefficients, which
    /// often have equal roots.
    #[test]
    fn comparison_agrees_with_many_digits() {
        let mut rng = Random::new(4);
        let mut equal = 0;
        for _ in 0..3000 {
            let mut small = || rng.below(9) as f64 - 4.0;
            let (p, q) = ([small(), small(), small()], [small(), small(), small()]);
            if p[0] == 0.0 && p[1] == 0.0 || q[0] == 0.0 && q[1] == 0.0 {
                continue;
            }
            for a in &sign_changes(&polynomial(p)).roots {
                for b in &sign_changes(&polynomial(q)).roots {
                    let gap = a.approximation() - b.approximation();
                    let same = gap.abs().compare(&Dyadic::ONE.scaled(-150)).is_lt();
                    let expected = if same { Ordering::Equal } else { gap.sign().cmp(&0) };
                    assert_eq!(a.compare(b), expected, "{p:?} {q:?}");
                    equal += usize::from(same);
                }
            }
        }
        assert!(equal > 100);
    }
}
