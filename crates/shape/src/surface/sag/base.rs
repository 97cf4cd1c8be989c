//! Base of a sag surface: a conic of revolution, or a biconic with different curvatures along x and y.

use super::polynomial::Jet;
use rayweave_math::Interval;

/// The surface to which the terms of a sag are added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Base {
    /// `c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2))` with the curvature c (one over length, positive if the surface bends
    /// towards +z) and the conic constant k.
    Conic {
        /// Curvature at the vertex.
        curvature: f64,
        /// Conic constant: 0 for a sphere, -1 for a paraboloid.
        conic: f64,
    },
    /// `(cx x^2 + cy y^2) / (1 + sqrt(1 - (1 + kx) cx^2 x^2 - (1 + ky) cy^2 y^2))`.
    Biconic {
        /// The curvatures along x and y.
        curvatures: [f64; 2],
        /// The conic constants along x and y.
        conics: [f64; 2],
    },
}

/// The base as `q / (1 + sqrt(1 - g))` with `q = c_x x^2 + c_y y^2` and `g = g_x x^2 + g_y y^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Root {
    pub c: [f64; 2],
    pub g: [f64; 2],
    /// Largest g in the aperture, at most 1; rounding is clamped to it.
    most: f64,
}

const POSITIVE: Interval = Interval { lo: 0.0, hi: f64::INFINITY };

/// Smallest value of the root: keeps slopes finite at a vertical rim, at distances from the rim within rounding.
const LEAST: f64 = 1e-9;

impl Root {
    pub fn new(base: &Base, aperture: f64) -> Root {
        let (c, k) = match *base {
            Base::Conic { curvature, conic } => ([curvature; 2], [conic; 2]),
            Base::Biconic { curvatures, conics } => (curvatures, conics),
        };
        let g = [0, 1].map(|i| (1.0 + k[i]) * c[i] * c[i]);
        let most = g[0].max(g[1]).max(0.0) * aperture * aperture;
        Root { c, g, most: most.min(1.0) }
    }

    pub fn is_zero(&self) -> bool {
        self.c == [0.0; 2]
    }

    pub fn is_round(&self) -> bool {
        self.c[0] == self.c[1] && self.g[0] == self.g[1]
    }

    /// The square root for a value of g.
    #[inline]
    fn root(&self, g: f64) -> f64 {
        (1.0 - g.min(self.most)).sqrt()
    }

    /// Value and derivatives with respect to x and y.
    #[inline]
    pub fn value_and_gradient(&self, x: f64, y: f64) -> Jet {
        let ([cx, cy], [gx, gy]) = (self.c, self.g);
        if self.is_round() {
            let square = x * x + y * y;
            let s = self.root(gx * square);
            let slope = cx / s.max(LEAST);
            return [cx * square / (1.0 + s), slope * x, slope * y];
        }
        let s = self.root(gx * x * x + gy * y * y);
        let (below, inverse) = (1.0 / (1.0 + s), 1.0 / s.max(LEAST));
        let value = (cx * x * x + cy * y * y) * below;
        // d/dx of q / (1 + s) with ds/dx = -g_x x / s
        let slope = |c: f64, g: f64, v: f64| v * below * (2.0 * c + value * g * inverse);
        [value, slope(cx, gx, x), slope(cy, gy, y)]
    }

    /// Bounds of the second derivative along `x = x0 + x1 t`, `y = y0 + y1 t` for t in a range.
    pub fn bend(&self, x: [f64; 2], y: [f64; 2], t: Interval) -> Interval {
        match self.is_round() {
            true => self.round_bend(x, y, t),
            false => self.general_bend(x, y, t),
        }
    }

    /// With u = x^2 + y^2: `d/du = c / (2 s)` and `d^2/du^2 = c g / (4 s^3)`, both monotone in u. At a vertical rim the
    /// bounds are infinite, with the signs of c g and c.
    fn round_bend(&self, x: [f64; 2], y: [f64; 2], t: Interval) -> Interval {
        let (square, rate, twice) = square_along(x, y, t);
        let inverse = self.inverse_roots(square * self.g[0]);
        let first = inverse.positive_product(twice.narrowed(POSITIVE));
        let second = inverse.positive_product(inverse.square()).positive_product(rate.square());
        second * (0.25 * self.c[0] * self.g[0]) + first * (0.5 * self.c[0])
    }

    /// Bounds of the first derivative along a line for t in a range.
    pub fn slopes(&self, x: [f64; 2], y: [f64; 2], t: Interval) -> Interval {
        if self.is_round() {
            let (square, rate, _) = square_along(x, y, t);
            return rate * self.inverse_roots(square * self.g[0]) * (0.5 * self.c[0]);
        }
        let [q, q1, _] = weighted(self.c, x, y, t);
        let [g, g1, _] = weighted(self.g, x, y, t);
        let inverse = self.inverse_roots(g);
        let below = (Interval::point(1.0) + inverse.positive_recip()).positive_recip();
        // (q' - b s') / (1 + s) with b = q / (1 + s)
        (q1 + q * below * (g1 * inverse) * 0.5) * below
    }

    /// `1 / s` for a range of g.
    fn inverse_roots(&self, g: Interval) -> Interval {
        let rest = (Interval::point(1.0) - g).narrowed(Interval::new(1.0 - self.most, f64::INFINITY));
        rest.sqrt().positive_recip()
    }

    /// Interval evaluation of the product and quotient rules: with `b = q / (1 + s)`, `s' = -g' / (2 s)`,
    /// `s'' = -(g'' / 2 + s'^2) / s`, `b' = (q' - b s') / (1 + s)` and `b'' = (q'' - 2 b' s' - b s'') / (1 + s)`.
    fn general_bend(&self, x: [f64; 2], y: [f64; 2], t: Interval) -> Interval {
        let [q, q1, q2] = weighted(self.c, x, y, t);
        let [g, g1, g2] = weighted(self.g, x, y, t);
        let inverse = self.inverse_roots(g);
        let s = inverse.positive_recip();
        let below = (Interval::point(1.0) + s).positive_recip();
        let s1 = -(g1 * inverse) * 0.5;
        let s2 = -(g2 * 0.5 + s1.square()) * inverse;
        let b = q * below;
        let b1 = (q1 - b * s1) * below;
        let bend = (q2 - b1 * s1 * 2.0 - b * s2) * below;
        match (b.lo > 0.0, b.hi < 0.0) {
            _ if bend.magnitude() < f64::INFINITY || g2.lo < 0.0 => bend,
            (true, _) => least_bend(b, [q1, q2], inverse, g2),
            (_, true) => -least_bend(-b, [q1, -q2], inverse, g2),
            _ => bend,
        }
    }

    /// Bounds of the value and both derivatives over a box with x^2 + y^2 in `square`, within the aperture.
    pub fn ranges(&self, x: Interval, y: Interval, square: Interval) -> [Interval; 3] {
        let ([cx, cy], [gx, gy]) = (self.c, self.g);
        let (q, g) = match self.is_round() {
            true => (square * cx, square * gx),
            false => (x.square() * cx + y.square() * cy, x.square() * gx + y.square() * gy),
        };
        let inverse = self.inverse_roots(g);
        if self.is_round() {
            let below = (Interval::point(1.0) + inverse.positive_recip()).positive_recip();
            return [q * below, x * inverse * cx, y * inverse * cx];
        }
        let below = (Interval::point(1.0) + inverse.positive_recip()).positive_recip();
        let value = q * below;
        let slope =
            |c: f64, g: f64, v: Interval| v * below * (value * inverse * g + Interval::point(2.0 * c));
        [value, slope(cx, gx, x), slope(cy, gy, y)]
    }
}

/// Bounds of `b''` without an upper end, for b > 0 and g'' >= 0. The rule above is
/// `(1 + s) b'' = q'' + b g'' / (2 s) + b s'^2 (1 / s + 2 / (1 + s)) - 2 q' s' / (1 + s)`, and its last two terms, a
/// quadratic in s', are at least `-q'^2 s / (b (1 + s)^2)`.
fn least_bend(b: Interval, [q1, q2]: [Interval; 2], inverse: Interval, g2: Interval) -> Interval {
    let s = inverse.positive_recip();
    let below = (Interval::point(1.0) + s).positive_recip();
    let grows = b.positive_product(g2).positive_product(inverse).lo * 0.5;
    let dip = q1.square().positive_product(s).positive_product(b.positive_recip()) * below.square();
    let sum = (q2 + Interval::point(grows) - dip).lo;
    Interval::new((below * sum).lo, f64::INFINITY)
}

fn linear(a: [f64; 2], t: Interval) -> Interval {
    t * a[1] + Interval::point(a[0])
}

/// `w_x x^2 + w_y y^2` and its first and second derivatives along a line.
fn weighted(w: [f64; 2], x: [f64; 2], y: [f64; 2], t: Interval) -> [Interval; 3] {
    let (at_x, at_y) = (linear(x, t), linear(y, t));
    let first = at_x * (2.0 * w[0] * x[1]) + at_y * (2.0 * w[1] * y[1]);
    let second = Interval::point(2.0 * w[0] * x[1]) * x[1] + Interval::point(2.0 * w[1] * y[1]) * y[1];
    [at_x.square() * w[0] + at_y.square() * w[1], first, second]
}

/// `x^2 + y^2` and its first and second derivatives along a line.
pub(super) fn square_along(x: [f64; 2], y: [f64; 2], t: Interval) -> (Interval, Interval, Interval) {
    let [square, first, second] = weighted([1.0; 2], x, y, t);
    (square, first, second)
}
