//! Polynomial terms of a sag: in one variable (the square of the distance from the axis) and in two (x and y). All
//! coordinates are divided by the aperture radius.

use rayweave_math::{Interval, UNIT_ROUNDOFF};

/// Highest total degree of a polynomial in two variables.
pub const MAX_DEGREE: usize = 30;

/// `c_0 + c_1 v + c_2 v^2 + ...`, for v in [-1, 1].
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Polynomial(Vec<f64>);

/// First-order jet of a function of x and y: the value and the derivatives with respect to x and y.
pub(super) type Jet = [f64; 3];

impl Polynomial {
    /// The polynomial without trailing zeros.
    pub fn new(mut coefficients: Vec<f64>) -> Polynomial {
        while coefficients.last() == Some(&0.0) {
            coefficients.pop();
        }
        Polynomial(coefficients)
    }

    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    pub fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    pub fn coefficients(&self) -> &[f64] {
        &self.0
    }

    /// Sum of the magnitudes of all terms at v = 1.
    pub fn size(&self) -> f64 {
        self.0.iter().map(|c| c.abs()).sum()
    }

    /// Value and derivative.
    #[inline]
    pub fn value_and_slope(&self, v: f64) -> (f64, f64) {
        let (mut value, mut slope) = (0.0, 0.0);
        for c in self.0.iter().rev() {
            slope = slope * v + value;
            value = value * v + c;
        }
        (value, slope)
    }

    /// Bounds of the first and second derivatives for v from `from` to `to`, both in [-1, 1]. Infinite if the degree is above
    /// `2 * MAX_DEGREE + 1`.
    pub fn derivatives(&self, from: f64, to: f64) -> (Interval, Interval) {
        if self.0.len() < 2 {
            return (Interval::point(0.0), Interval::point(0.0));
        }
        let mut shifted = [0.0; 2 * MAX_DEGREE + 2];
        let coefficients = shifted.get_mut(..self.0.len());
        let Some(coefficients) = coefficients else { return (Interval::ALL, Interval::ALL) };
        coefficients.copy_from_slice(&self.0);
        derivatives(coefficients, from, to)
    }
}

/// Bounds of the first and second derivatives of a polynomial from `from` to `to`, both in [-1, 1]; overwrites the
/// coefficients.
///
/// Repeated Horner schemes expand the polynomial about the middle m of the range, as `sum b_k (v - m)^k`. In a short range
/// all terms but the lowest are small. Within the range, the rounding errors of the b_k change the value by less than
/// 4 n u times the sum of the magnitudes of all coefficients, with n the number of coefficients and u the unit roundoff;
/// each derivative multiplies that by at most n.
pub(super) fn derivatives(c: &mut [f64], from: f64, to: f64) -> (Interval, Interval) {
    let (n, middle) = (c.len(), 0.5 * (from + to));
    // distance of the ends from the middle, plus the rounding errors of both
    let half = (0.5 * (to - from)).max(0.0) + 2.0 * UNIT_ROUNDOFF;
    let size: f64 = c.iter().map(|c| c.abs()).sum();
    for first in 0..n {
        for k in (first..n - 1).rev() {
            c[k] += middle * c[k + 1];
        }
    }
    let order = n as f64;
    let error = 8.0 * UNIT_ROUNDOFF * order * order * size;
    let (mut first, mut second, mut power) = (0.0, 0.0, 1.0);
    for k in 2..n {
        let (k, b) = (k as f64, c[k].abs());
        first += k * b * power * half;
        second += if k > 2.0 { k * (k - 1.0) * b * power } else { 0.0 };
        power *= half;
    }
    let slope = c.get(1).copied().unwrap_or(0.0);
    let bend = 2.0 * c.get(2).copied().unwrap_or(0.0);
    (around(slope, first, error), around(bend, second, order * error))
}

/// The interval `middle +- (radius + error)`, with a margin for the rounding of `radius`.
fn around(middle: f64, radius: f64, error: f64) -> Interval {
    Interval::around(middle, radius * (1.0 + 64.0 * UNIT_ROUNDOFF) + error)
}

/// `sum c_ij x^i y^j`, for |x|, |y| <= 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Bivariate {
    /// For each power of x, its coefficient: a polynomial in y.
    rows: Vec<Polynomial>,
    degree: usize,
}

impl Bivariate {
    /// The sum of the terms `c x^i y^j`, given as (i, j, c).
    pub fn new(terms: &[(usize, usize, f64)]) -> Bivariate {
        let (mut rows, mut degree) = (Vec::<Vec<f64>>::new(), 0);
        for &(i, j, c) in terms.iter().filter(|term| term.2 != 0.0) {
            rows.resize(rows.len().max(i + 1), Vec::new());
            let length = rows[i].len().max(j + 1);
            rows[i].resize(length, 0.0);
            rows[i][j] += c;
            degree = degree.max(i + j);
        }
        Bivariate { rows: rows.into_iter().map(Polynomial::new).collect(), degree }
    }

    pub fn is_zero(&self) -> bool {
        self.rows.is_empty()
    }

    pub fn degree(&self) -> usize {
        self.degree
    }

    pub fn rows(&self) -> &[Polynomial] {
        &self.rows
    }

    /// Sum of the magnitudes of all coefficients.
    pub fn size(&self) -> f64 {
        self.rows.iter().map(Polynomial::size).sum()
    }

    /// Value and derivatives with respect to x and y (Horner's scheme).
    pub fn value_and_gradient(&self, x: f64, y: f64) -> Jet {
        let [mut value, mut by_x, mut by_y] = [0.0; 3];
        for row in self.rows.iter().rev() {
            let (own, slope) = row.value_and_slope(y);
            by_x = by_x * x + value;
            value = value * x + own;
            by_y = by_y * x + slope;
        }
        [value, by_x, by_y]
    }

    /// Coefficients of the polynomial in s along `x = x0 + x1 s`, `y = y0 + y1 s`.
    pub fn along(&self, x: [f64; 2], y: [f64; 2]) -> [f64; MAX_DEGREE + 1] {
        let mut sum = [0.0; MAX_DEGREE + 1];
        for (k, row) in self.rows.iter().enumerate().rev() {
            times_linear(&mut sum, self.degree - k, x);
            let mut own = [0.0; MAX_DEGREE + 1];
            for (j, c) in row.coefficients().iter().enumerate().rev() {
                times_linear(&mut own, row.degree() - j, y);
                own[0] += c;
            }
            sum.iter_mut().zip(&own[..=row.degree()]).for_each(|(sum, own)| *sum += own);
        }
        sum
    }

    /// Bounds of the value over the unit disc; they exceed the smallest ones by at most 2 % of their difference at each end, plus
    /// rounding. Interval arithmetic with the powers would exceed them by orders of magnitude for Zernike terms of high degree,
    /// which cancel each other.
    ///
    /// On each diameter the polynomial has degree n in cos(psi), and on each circle it is a trigonometric polynomial of degree
    /// n: see [`GRID`]. One bound after the other gives the square of its factor.
    pub fn disc_range(&self) -> Interval {
        let count = GRID * self.degree;
        let mut values = Extremes::NONE;
        for k in 0..count.max(1) {
            let (sin, cos) = grid_direction(k, count);
            let along = self.along([0.0, cos], [0.0, sin]);
            for j in 0..=count {
                let (_, s) = grid_direction(j, count);
                values.add(along[..=self.degree].iter().rev().fold(0.0, |value, c| value * s + c));
            }
        }
        values.between(GRID_FACTOR * GRID_FACTOR, self.degree, self.size())
    }

    /// Bounds of the value and both first derivatives over a box in [-1, 1]^2: Horner's scheme in interval arithmetic.
    pub fn ranges(&self, x: Interval, y: Interval) -> [Interval; 3] {
        let mut ranges = [Interval::point(0.0); 3];
        for row in self.rows.iter().rev() {
            let (own, slope) = range(row.coefficients(), y);
            let [value, by_x, by_y] = ranges;
            ranges = [value * x + own, by_x * x + value, by_y * x + slope];
        }
        ranges
    }
}

/// Steps of a grid in angle per degree, from 0 to pi: a trigonometric polynomial t of degree n is at most [`GRID_FACTOR`] times
/// as large as on any grid of GRID n such steps.
///
/// At a distance of up to pi / n from a point where |t| has its maximum M, |t| is at least `M cos(n distance)` (M. Riesz,
/// Jahresber. DMV 23 (1914) 354), and the nearest grid point is at most half a step away, pi / (2 GRID n). For algebraic
/// polynomials, with the cosine of the angle as variable, this is the bound of H. Ehlich and K. Zeller, Math. Z. 86 (1964) 41.
pub(super) const GRID: usize = 8;

/// `1 / cos(pi / (2 GRID)) = 1.019591...`, rounded up.
pub(super) const GRID_FACTOR: f64 = 1.0196;

/// Sine and cosine of the k-th of `count` steps from 0 to pi.
pub(super) fn grid_direction(k: usize, count: usize) -> (f64, f64) {
    libm::sincos(std::f64::consts::PI * k as f64 / count.max(1) as f64)
}

/// Smallest and largest of the values on a grid.
pub(super) struct Extremes {
    low: f64,
    high: f64,
}

impl Extremes {
    pub const NONE: Extremes = Extremes { low: f64::INFINITY, high: f64::NEG_INFINITY };

    pub fn add(&mut self, value: f64) {
        (self.low, self.high) = (self.low.min(value), self.high.max(value));
    }

    /// Bounds between the grid points: the polynomial minus the mean of both extremes is at most `factor` times as large as on the
    /// grid. Each value of degree n has at most n + 1 factors of a few roundings, and as many additions: below `8 (n + 1) u`
    /// times the sum of the magnitudes of the coefficients, which enters the radius with the factor (at most 1.04) twice.
    pub fn between(&self, factor: f64, degree: usize, size: f64) -> Interval {
        let (middle, half) = (0.5 * self.low + 0.5 * self.high, 0.5 * self.high - 0.5 * self.low);
        let error = 24.0 * UNIT_ROUNDOFF * (degree + 1) as f64 * size;
        if degree == 0 { Interval::around(middle, error) } else { around(middle, factor * half, error) }
    }
}

/// Bounds of a polynomial and its derivative over an interval.
pub(super) fn range(coefficients: &[f64], v: Interval) -> (Interval, Interval) {
    let zero = Interval::point(0.0);
    coefficients
        .iter()
        .rev()
        .fold((zero, zero), |(value, slope), &c| (value * v + Interval::point(c), slope * v + value))
}

/// Multiplies a polynomial in s, of degree below `count` or zero, by `a[0] + a[1] s`.
fn times_linear(c: &mut [f64; MAX_DEGREE + 1], count: usize, a: [f64; 2]) {
    for k in (1..=count.min(MAX_DEGREE)).rev() {
        c[k] = c[k] * a[0] + c[k - 1] * a[1];
    }
    c[0] *= a[0];
}
