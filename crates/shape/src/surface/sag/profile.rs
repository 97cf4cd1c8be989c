//! Sag as a function of x and y: base plus terms.

use super::base::{Base, Root, square_along};
use super::polynomial::{
    Bivariate, Extremes, GRID, GRID_FACTOR, Jet, MAX_DEGREE, Polynomial, derivatives, grid_direction, range,
};
use rayweave_math::{Interval, UNIT_ROUNDOFF};

/// Description of a sag surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Radius of the aperture, > 0.
    pub aperture: f64,
    /// The base.
    pub base: Base,
    /// Coefficients of r^2, r^4, r^6, ...: the n-th in length^(1 - 2 n), at most 30.
    pub even: Vec<f64>,
    /// Coefficients of r, r^3, r^5, ..., at most 30.
    pub odd: Vec<f64>,
    /// Terms `c x^i y^j` with i + j <= 30.
    pub mixed: Vec<(u32, u32, f64)>,
}

impl Description {
    /// A base alone.
    pub fn new(aperture: f64, base: Base) -> Description {
        Description { aperture, base, even: Vec::new(), odd: Vec::new(), mixed: Vec::new() }
    }
}

/// `base + E(v) + rho O(v) + M(x / R, y / R)` with rho = r / R, v = rho^2 and R the aperture's radius, so that coefficients
/// are lengths, and arguments at most 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Profile {
    pub aperture: f64,
    pub root: Root,
    pub even: Polynomial,
    pub odd: Polynomial,
    pub mixed: Bivariate,
}

impl Profile {
    pub fn new(of: &Description) -> Profile {
        let radius = of.aperture;
        // one multiplication per factor, each a power of the same number
        let scaled = |list: &[f64], first: f64| {
            let mut factor = first;
            list.iter()
                .map(|c| {
                    let length = c * factor;
                    factor *= radius * radius;
                    length
                })
                .collect::<Vec<f64>>()
        };
        let mut even = vec![0.0];
        even.extend(scaled(&of.even, radius * radius));
        let mixed = of.mixed.iter().map(|&(i, j, c)| {
            let factor = (0..i + j).fold(1.0, |factor, _| factor * radius);
            (i as usize, j as usize, c * factor)
        });
        Profile {
            aperture: radius,
            root: Root::new(&of.base, radius),
            even: Polynomial::new(even),
            odd: Polynomial::new(scaled(&of.odd, radius)),
            mixed: Bivariate::new(&mixed.collect::<Vec<_>>()),
        }
    }

    /// True for a surface of revolution.
    pub fn is_round(&self) -> bool {
        self.root.is_round() && self.mixed.is_zero()
    }

    /// Sum of the magnitudes of all terms at the rim.
    pub fn size(&self) -> f64 {
        let base = self.root.c[0].abs().max(self.root.c[1].abs()) * self.aperture * self.aperture;
        base + self.even.size() + self.odd.size() + self.mixed.size()
    }

    /// Degree along a line, with a nominal degree for the base.
    pub fn degree(&self) -> usize {
        let odd = if self.odd.is_zero() { 0 } else { 2 * self.odd.degree() + 1 };
        odd.max(2 * self.even.degree()).max(self.mixed.degree())
    }

    /// Sag and its derivatives with respect to x and y at a point of the aperture.
    #[inline]
    pub fn value_and_gradient(&self, x: f64, y: f64) -> Jet {
        let mut jet = if self.root.is_zero() { [0.0; 3] } else { self.root.value_and_gradient(x, y) };
        let inverse = 1.0 / self.aperture;
        if !(self.even.is_zero() && self.odd.is_zero()) {
            let (value, slope) = self.terms((x * x + y * y) * inverse * inverse);
            let slope = 2.0 * inverse * inverse * slope;
            jet = [jet[0] + value, jet[1] + slope * x, jet[2] + slope * y];
        }
        if !self.mixed.is_zero() {
            let [value, by_x, by_y] = self.mixed.value_and_gradient(x * inverse, y * inverse);
            jet = [jet[0] + value, jet[1] + inverse * by_x, jet[2] + inverse * by_y];
        }
        jet
    }

    /// The terms in r and their derivative with respect to v. At the tip of an odd term of first order the slope is
    /// undefined: 0.
    #[inline]
    fn terms(&self, v: f64) -> (f64, f64) {
        let (mut value, mut slope) = self.even.value_and_slope(v);
        if !self.odd.is_zero() && v > 0.0 {
            let rho = v.sqrt();
            let (own, rate) = self.odd.value_and_slope(v);
            value += rho * own;
            slope += rho * rate + 0.5 * own / rho;
        }
        (value, slope)
    }

    /// Bounds of the value and derivatives over the part of a box in the aperture.
    pub fn ranges(&self, x: Interval, y: Interval) -> [Interval; 3] {
        let (radius, inverse) = (self.aperture, 1.0 / self.aperture);
        let whole = Interval::around(0.0, radius);
        let (x, y) = (x.narrowed(whole), y.narrowed(whole));
        let square = (x.square() + y.square()).narrowed(Interval::around(0.0, radius * radius));
        let mut sum = self.root.ranges(x, y, square);
        let mut add = |[a, b, c]: [Interval; 3]| sum = [sum[0] + a, sum[1] + b, sum[2] + c];
        let (value, slope) = self.term_ranges(square * (inverse * inverse));
        let slope = slope * (2.0 * inverse * inverse);
        add([value, slope * x, slope * y]);
        if !self.odd.is_zero() {
            let (value, slope) = self.odd_ranges(square * (inverse * inverse));
            // |x / r| is at most 1
            let part =
                |v: Interval| (v * (square.sqrt().positive_recip())).narrowed(Interval::new(-1.0, 1.0));
            let slope = slope * inverse;
            add([value, slope * part(x), slope * part(y)]);
        }
        let [value, by_x, by_y] = self.mixed.ranges(x * inverse, y * inverse);
        add([value, by_x * inverse, by_y * inverse]);
        sum
    }

    /// Bounds of the sum of all terms over the aperture, without the base: those of the terms in r, a polynomial in
    /// `rho = (1 + cos psi) / 2`, and of the terms in x and y. Each exceeds the smallest bounds by at most 2 % of their difference
    /// at each end, plus rounding.
    pub fn sum_of_terms(&self) -> Interval {
        let odd = if self.odd.is_zero() { 0 } else { 2 * self.odd.degree() + 1 };
        let degree = odd.max(2 * self.even.degree());
        let (count, mut values) = (GRID * degree, Extremes::NONE);
        for k in 0..=count {
            let rho = 0.5 + 0.5 * grid_direction(k, count).1;
            values.add(self.terms(rho * rho).0);
        }
        values.between(GRID_FACTOR, degree, self.even.size() + self.odd.size()) + self.mixed.disc_range()
    }

    /// Bounds of the base over the part of a box in the aperture: for a conic, whose sag is monotonic in r, the smallest ones up
    /// to a few roundings.
    pub fn base_range(&self, x: Interval, y: Interval) -> Interval {
        let whole = Interval::around(0.0, self.aperture);
        let (x, y) = (x.narrowed(whole), y.narrowed(whole));
        let square = (x.square() + y.square()).narrowed(Interval::around(0.0, self.aperture * self.aperture));
        if !self.root.is_round() {
            return self.root.ranges(x, y, square)[0];
        }
        let [a, b] =
            [square.lo, square.hi].map(|r2| self.root.value_and_gradient(r2.max(0.0).sqrt(), 0.0)[0]);
        let rounding = 16.0 * UNIT_ROUNDOFF * a.abs().max(b.abs());
        Interval::new(a.min(b) - rounding, a.max(b) + rounding)
    }

    fn term_ranges(&self, v: Interval) -> (Interval, Interval) {
        range(self.even.coefficients(), v)
    }

    /// The odd terms and their derivative with respect to rho.
    fn odd_ranges(&self, v: Interval) -> (Interval, Interval) {
        let rho = v.sqrt();
        let (value, slope) = range(self.odd.coefficients(), v);
        (rho * value, value + v * slope * 2.0)
    }
}

/// The sag along a straight line.
#[derive(Clone, Debug)]
pub(super) struct Along<'a> {
    profile: &'a Profile,
    pub x: [f64; 2],
    pub y: [f64; 2],
    mixed: Option<Mixed>,
}

/// The terms in x and y as a polynomial in `s = (t - middle) / half`.
#[derive(Clone, Debug)]
struct Mixed {
    coefficients: [f64; MAX_DEGREE + 1],
    middle: f64,
    half: f64,
}

impl<'a> Along<'a> {
    /// The sag along `x = x[0] + x[1] t`, `y = y[0] + y[1] t`.
    pub fn new(profile: &'a Profile, x: [f64; 2], y: [f64; 2]) -> Along<'a> {
        Along { profile, x, y, mixed: None }
    }

    /// Prepares bounds between two times, between which the line is in the aperture.
    pub fn bounded(self, (from, to): (f64, f64)) -> Along<'a> {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let inverse = 1.0 / self.profile.aperture;
        let scaled = |a: [f64; 2]| [(a[0] + middle * a[1]) * inverse, half * a[1] * inverse];
        let mixed = (!self.profile.mixed.is_zero()).then(|| Mixed {
            coefficients: self.profile.mixed.along(scaled(self.x), scaled(self.y)),
            middle,
            half,
        });
        Along { mixed, ..self }
    }

    /// Sag and its derivative.
    #[inline]
    pub fn at(&self, t: f64) -> (f64, f64) {
        let (x, y) = (self.x[0] + t * self.x[1], self.y[0] + t * self.y[1]);
        let [value, by_x, by_y] = self.profile.value_and_gradient(x, y);
        (value, by_x * self.x[1] + by_y * self.y[1])
    }

    /// Bounds of the second derivative between two times.
    pub fn bend(&self, from: f64, to: f64) -> Interval {
        let (profile, t) = (self.profile, Interval::new(from, to));
        let mut bend = Interval::point(0.0);
        if !profile.root.is_zero() {
            bend = bend + profile.root.bend(self.x, self.y, t);
        }
        if !(profile.even.is_zero() && profile.odd.is_zero()) {
            bend = bend + self.round_bend(t);
        }
        match &self.mixed {
            _ if profile.mixed.is_zero() => bend,
            Some(mixed) if mixed.half > 0.0 => bend + mixed.bend(profile.mixed.degree(), from, to),
            _ => Interval::ALL,
        }
    }

    /// Bounds of the first derivative between two times: finite unless the surface is vertical.
    pub fn slopes(&self, from: f64, to: f64) -> Interval {
        let (profile, t) = (self.profile, Interval::new(from, to));
        let mut slopes = Interval::point(0.0);
        if !profile.root.is_zero() {
            slopes = slopes + profile.root.slopes(self.x, self.y, t);
        }
        if !(profile.even.is_zero() && profile.odd.is_zero()) {
            slopes = slopes + self.round_slopes(t);
        }
        match &self.mixed {
            _ if profile.mixed.is_zero() => slopes,
            Some(mixed) if mixed.half > 0.0 => slopes + mixed.slopes(profile.mixed.degree(), from, to),
            _ => Interval::ALL,
        }
    }

    /// v = r^2 / R^2 and its first and second derivatives.
    fn square(&self, t: Interval) -> (Interval, Interval, Interval) {
        let radius = self.profile.aperture;
        let (r2, rate, twice) = square_along(self.x, self.y, t);
        let inverse = Interval::point(radius * radius).positive_recip();
        ((r2 * inverse).narrowed(UNIT), rate * inverse, twice * inverse)
    }

    fn round_slopes(&self, t: Interval) -> Interval {
        let (profile, (v, rate, twice)) = (self.profile, self.square(t));
        let even = profile.even.derivatives(v.lo, v.hi).0 * rate;
        if profile.odd.is_zero() { even } else { even + self.odd_slopes(v, rate, twice) }
    }

    /// First derivative of `sum c_k rho^(2 k + 1)`: `rho' = v' / (2 rho)`, which is at most w.
    fn odd_slopes(&self, v: Interval, rate: Interval, twice: Interval) -> Interval {
        let most = (twice * 0.5).sqrt().hi;
        let rho = (rate * 0.5 * v.sqrt().positive_recip()).narrowed(Interval::new(-most, most));
        let coefficients = self.profile.odd.coefficients().iter().enumerate().rev();
        let by_rho = coefficients.fold(Interval::point(0.0), |sum, (k, c)| {
            let n = (2 * k + 1) as f64;
            sum * v + Interval::point(n * c)
        });
        by_rho * rho
    }

    fn round_bend(&self, t: Interval) -> Interval {
        let (profile, (v, rate, twice)) = (self.profile, self.square(t));
        let (first, second) = profile.even.derivatives(v.lo, v.hi);
        let even = second * rate.square() + first * twice;
        if profile.odd.is_zero() { even } else { even + self.odd_bend(v, rate, twice) }
    }

    /// Second derivative of `rho O(v)` with `O = o + p(v) v`, where o is the term of first order: with w^2 = v'' / 2,
    /// half of the second derivative of v, and `rho'^2 = v'^2 / (4 v)`, which is at most w^2,
    /// `(rho^n)'' = n rho^(n - 2) (w^2 + (n - 2) rho'^2)`.
    fn odd_bend(&self, v: Interval, rate: Interval, twice: Interval) -> Interval {
        let rho = v.sqrt();
        let across = twice * 0.5;
        let along = (rate.square() * 0.25 * v.positive_recip()).narrowed(Interval::new(0.0, across.hi));
        let coefficients = self.profile.odd.coefficients();
        let mut bend = Interval::point(0.0);
        for (k, &c) in coefficients.iter().enumerate().skip(1).rev() {
            let n = (2 * k + 1) as f64;
            let term = (across + along * (n - 2.0)) * (n * c);
            bend = bend * v + term;
        }
        // r is convex along every line: at the tip its second derivative is unbounded, but positive
        let tip =
            (across - along).narrowed(Interval::new(0.0, across.hi)).positive_product(rho.positive_recip());
        bend * rho + tip * coefficients.first().copied().unwrap_or(0.0)
    }
}

impl Mixed {
    fn slopes(&self, degree: usize, from: f64, to: f64) -> Interval {
        self.derivatives(degree, from, to).0 * Interval::point(self.half).positive_recip()
    }

    fn bend(&self, degree: usize, from: f64, to: f64) -> Interval {
        self.derivatives(degree, from, to).1 * Interval::point(self.half).square().positive_recip()
    }

    /// Bounds of the derivatives with respect to s.
    fn derivatives(&self, degree: usize, from: f64, to: f64) -> (Interval, Interval) {
        let mut coefficients = self.coefficients;
        let place = |t: f64| ((t - self.middle) / self.half).clamp(-1.0, 1.0);
        let slack = 4.0 * UNIT_ROUNDOFF;
        derivatives(&mut coefficients[..=degree], place(from) - slack, place(to) + slack)
    }
}

const UNIT: Interval = Interval { lo: 0.0, hi: 1.0 };
