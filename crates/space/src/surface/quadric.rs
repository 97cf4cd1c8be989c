//! Central quadric in principal axes: `f(p) = sum weight_k (e_k . q)^2 + constant`, with q = p - centre and orthonormal axes e_k.
//! The weights are the eigenvalues of the quadratic form, scaled so that the largest magnitude is 1.
//!
//! The matrix is not stored: rounding of its entries would move the far ends of a thin ellipsoid.

use crate::Point;
use crate::affine::Affine;
use crate::curve::Line;
use crate::point::{add_scaled, dot, dot_noise, dot_of_sizes, is_finite, length, minus};
use crate::vector::{axis_vector, times, unit};
use rayweave_math::roots::Crossings;
use rayweave_math::{Interval, UNIT_ROUNDOFF};
use rayweave_shape::surface::{delta_of, quadratic_crossings};
use std::array::from_fn;

/// A quadric in principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadric<const D: usize> {
    /// The centre; if there are several, the one closest to the origin.
    pub centre: Point<D>,
    /// The principal axes; zero for zero weights.
    pub axes: [Point<D>; D],
    /// The eigenvalue of each axis, scaled so that the largest magnitude is 1.
    pub weights: Point<D>,
    /// The value at the centre.
    pub constant: f64,
}

impl<const D: usize> Quadric<D> {
    /// The quadric `sum weight_k x_k^2 + constant`, in the axes of the coordinates. At least one weight must be nonzero.
    pub fn along_axes(weights: Point<D>, constant: f64) -> Self {
        let axes = from_fn(|k| if weights[k] == 0.0 { [0.0; D] } else { axis_vector(k) });
        Quadric { centre: [0.0; D], axes, weights, constant }.normalised()
    }

    fn normalised(self) -> Self {
        let largest = crate::vector::largest(&self.weights);
        Quadric { weights: self.weights.map(|w| w / largest), constant: self.constant / largest, ..self }
    }

    /// The coordinates of a vector along the principal axes.
    fn coordinates(&self, v: &Point<D>) -> Point<D> {
        self.axes.each_ref().map(|e| dot(e, v))
    }

    /// The bilinear form of the quadric, for vectors in principal axes: `sum weight_k a_k b_k`.
    fn product(&self, a: &Point<D>, b: &Point<D>) -> f64 {
        (0..D).fold(0.0, |sum, k| sum + self.weights[k] * a[k] * b[k])
    }

    /// The crossings of a line, at most two. The coefficients are computed at the point of the line closest to the centre, which avoids
    /// cancellation for distant origins; if the surface may contain lines, where the terms of f are smallest. Distant crossings that
    /// exist only because rounding has changed the square term are dropped.
    pub(super) fn crossings(&self, line: &Line<D>) -> Crossings<2> {
        let (x, v, shift) = self.closest(line);
        // the error of v_k is that of a dot product: proportional to the sum of the absolute values of its terms
        let term = |k: usize| (self.weights[k] * v[k]).abs() * dot_of_sizes(&self.axes[k], &line.direction);
        let noise = 2.0 * dot_noise::<D>() * (0..D).map(term).sum::<f64>();
        let later = if self.may_contain_lines() { self.time_of_least_terms(&x, &v, noise) } else { 0.0 };
        let (x, shift) = (add_scaled(&x, later, &v), shift + later);
        quadratic_crossings(shift, noise, |s| {
            let x = add_scaled(&x, s, &v);
            [self.product(&v, &v), self.product(&x, &v), self.product(&x, &x) + self.constant]
        })
    }

    /// The time after which the terms of f are smallest: that of the least `sum |w_k| x_k^2`; 0 if `sum |w_k| v_k^2` is at most `noise`,
    /// the bound of its error.
    ///
    /// Terms of opposite sign cancel near the surface. With the coefficients at the time s of the least terms, the terms add up at each
    /// root t to `sum |w_k| x_k(t)^2 <= |x(t)| |grad f| / 2` (Cauchy and Schwarz, all |w_k| are at most 1), so that the root is off the
    /// surface by no more than a few u |x(t)|: see `Quadric` of `rayweave-shape`.
    fn time_of_least_terms(&self, x: &Point<D>, v: &Point<D>, noise: f64) -> f64 {
        let weighted: Point<D> = from_fn(|k| self.weights[k].abs() * v[k]);
        let square = dot(&weighted, v);
        if square > noise { -dot(&weighted, x) / square } else { 0.0 }
    }

    /// The sign changes of `w . grad f` along a line, for the direction w of symbolic perturbation; `None` if it is constant
    /// up to rounding.
    pub(super) fn perturbed_slope(&self, line: &Line<D>, w: &Point<D>) -> Option<Crossings<2>> {
        let (x, v, shift) = self.closest(line);
        let w = self.coordinates(w);
        let rise = self.product(&v, &w);
        // the error of the direction's coordinates is a few u times its length
        let is_noise = rise.abs() <= delta_of(length(&line.direction) * length(&w));
        let level = self.product(&x, &w);
        (!is_noise).then(|| Crossings::new(rise > 0.0, &[shift - level / rise]))
    }

    /// The point of the line closest to the centre, measured along the axes with nonzero weight: its coordinates, those of the
    /// direction, and the time.
    fn closest(&self, line: &Line<D>) -> (Point<D>, Point<D>, f64) {
        let x = self.coordinates(&minus(&line.origin, &self.centre));
        let v = self.coordinates(&line.direction);
        let closest = -dot(&x, &v) / dot(&v, &v);
        let shift = if closest.is_finite() { closest } else { 0.0 };
        (add_scaled(&x, shift, &v), v, shift)
    }

    pub(super) fn value_and_gradient(&self, point: &Point<D>) -> (f64, Point<D>) {
        let x = self.coordinates(&minus(point, &self.centre));
        let slope = |k: usize| 2.0 * self.weights[k] * x[k];
        let gradient = (0..D).fold([0.0; D], |sum, k| add_scaled(&sum, slope(k), &self.axes[k]));
        (self.product(&x, &x) + self.constant, gradient)
    }

    pub(super) fn ranges(&self, cell: &[Interval; D]) -> (Interval, [Interval; D]) {
        let q: [Interval; D] = from_fn(|j| cell[j] - Interval::point(self.centre[j]));
        let zero = Interval::point(0.0);
        let coordinate = |e: &Point<D>| weighted_sum(zero, e.iter().zip(&q).map(|(&a, &x)| (a, x)));
        let x = self.axes.each_ref().map(coordinate);
        let squares = (0..D).map(|k| (self.weights[k], x[k].square()));
        let value = weighted_sum(Interval::point(self.constant), squares);
        let slope = |j: usize| (0..D).map(move |k| (k, self.axes[k][j]));
        let gradient = from_fn(|j| {
            // the factor 2 is exact, the product with a component of an axis is not
            weighted_sum(zero, slope(j).map(|(k, a)| (2.0 * self.weights[k], x[k] * a)))
        });
        (value, gradient)
    }

    /// True if a line may lie in the surface. That is impossible if all weights have the same sign, since f then has one sign far
    /// away along every line. The test is conservative: hyperboloids of two sheets pass, although they contain no line.
    pub(super) fn may_contain_lines(&self) -> bool {
        !(self.weights.iter().all(|&w| w > 0.0) || self.weights.iter().all(|&w| w < 0.0))
    }

    /// The distance of the centre from the origin plus the shortest semi-axis. Longer semi-axes need no term: a relative error u of the
    /// constant moves a point q of the surface by at most u |q| / 2.
    pub(super) fn magnitude(&self) -> f64 {
        length(&self.centre) + self.constant.abs().sqrt()
    }

    /// The longest semi-axis `sqrt(|constant / w_k|)` over all weights that are not 0.
    pub(super) fn size(&self) -> f64 {
        let least = self.weights.iter().map(|w| w.abs()).filter(|&w| w > 0.0).fold(1.0, f64::min);
        (self.constant.abs() / least).sqrt()
    }

    /// The image under an affine map: `e . q = (L^-T e) . L q`.
    pub(super) fn transformed(&self, map: &Affine<D>, inverse: &Affine<D>) -> Self {
        let centre = map.point(&self.centre);
        if let Some(scale) = map.uniform_scale() {
            return Quadric { centre, constant: scale * scale * self.constant, ..*self }.at_nearest_centre();
        }
        let signs = self.weights.map(|w| if w == 0.0 { 0.0 } else { w.signum() });
        let row = |k: usize| inverse.covector(&times(self.weights[k].abs().sqrt(), &self.axes[k]));
        let mut rows = from_fn(row);
        orthogonalise(&mut rows, &signs);
        let weights = from_fn(|k| signs[k] * dot(&rows[k], &rows[k]));
        let axes = from_fn(|k| if signs[k] == 0.0 { [0.0; D] } else { unit(&rows[k]).0 });
        Quadric { centre, axes, weights, constant: self.constant }.normalised().at_nearest_centre()
    }

    /// Chooses the centre closest to the origin. If weights are zero, the centres form a line, plane or larger subspace, and distant
    /// ones lose precision.
    fn at_nearest_centre(self) -> Self {
        if self.weights.iter().all(|&w| w != 0.0) {
            return self;
        }
        let part = |e: &Point<D>| dot(e, &self.centre);
        let centre = self.axes.iter().fold([0.0; D], |sum, e| add_scaled(&sum, part(e), e));
        Quadric { centre, ..self }
    }

    pub(super) fn is_finite(&self) -> bool {
        is_finite(&self.centre)
            && self.axes.iter().all(is_finite)
            && is_finite(&self.weights)
            && self.constant.is_finite()
    }
}

fn weighted_sum(start: Interval, terms: impl Iterator<Item = (f64, Interval)>) -> Interval {
    // skips terms with factor 0: their interval may be infinite
    terms.filter(|&(factor, _)| factor != 0.0).fold(start, |sum, (factor, x)| sum + x * factor)
}

/// Orthogonalises the rows with nonzero sign by one-sided Jacobi rotations. Rows of equal sign take circular rotations, rows of opposite
/// sign hyperbolic rotations; both leave f unchanged (J. Demmel, K. Veselic, "Jacobi's
/// method is more accurate than QR", SIAM J. Matrix Anal. Appl. 13 (1992), and the hyperbolic form of K.
/// Veselic, "A Jacobi eigenreduction algorithm for definite matrix pairs", Numer. Math. 64 (1993)).
fn orthogonalise<const D: usize>(rows: &mut [Point<D>; D], signs: &Point<D>) {
    const SWEEPS: usize = 60;
    for _ in 0..SWEEPS {
        let mut done = true;
        for i in 0..D {
            for j in i + 1..D {
                done &= !rotate_pair(rows, (i, j), signs[i] * signs[j]);
            }
        }
        if done {
            return;
        }
    }
}

/// Makes two rows orthogonal; false if they already are.
fn rotate_pair<const D: usize>(rows: &mut [Point<D>; D], (i, j): (usize, usize), sign: f64) -> bool {
    let product = dot(&rows[i], &rows[j]);
    let squares = (dot(&rows[i], &rows[i]), dot(&rows[j], &rows[j]));
    if sign == 0.0 || product.abs() <= 4.0 * UNIT_ROUNDOFF * (squares.0 * squares.1).sqrt() {
        return false;
    }
    let (c, s) = rotation(squares, product, sign);
    let (a, b) = (rows[i], rows[j]);
    rows[i] = add_scaled(&times(c, &a), -sign * s, &b);
    rows[j] = add_scaled(&times(s, &a), c, &b);
    true
}

/// Cosine and sine (sign > 0), or hyperbolic cosine and sine (sign < 0), of the rotation
/// `(c a - sign s b, s a + c b)` that makes two rows perpendicular.
fn rotation((aa, bb): (f64, f64), ab: f64, sign: f64) -> (f64, f64) {
    if sign > 0.0 {
        let cot = (bb - aa) / (2.0 * ab);
        let tan = 1f64.copysign(cot) / (cot.abs() + (1.0 + cot * cot).sqrt());
        let c = 1.0 / (1.0 + tan * tan).sqrt();
        return (c, tan * c);
    }
    let ratio = 2.0 * ab / (aa + bb);
    let tanh = -ratio / (1.0 + (1.0 - ratio * ratio).max(0.0).sqrt());
    let c = 1.0 / (1.0 - tanh * tanh).sqrt();
    (c, tanh * c)
}
