//! Quadric (any surface of degree 2) in its principal axes: `f = sum w_k (e_k . q)^2 + linear . q + constant` with q = p -
//! centre, orthonormal e_k and the largest |w_k| = 1.
//!
//! The matrix `sum w_k e_k e_k^T` is not stored: for a thin ellipsoid with half axes 1 and h, rounding its entries to u
//! would move the far ends by u / h^2. A rounding of e_k . q, at most 3 u |q|, moves the surface by at most
//! `sum |w_k (e_k . q)| 3 u |q| / |sum w_k (e_k . q) e_k|`, which is below `3 sqrt(3) u |q|` for perpendicular axes and
//! any weights.

use super::Surface;
use super::along::{SQUARE_NOISE, quadratic_crossings, recentred};
use crate::Ray;
use crate::real::{Real, Vector};
use rayweave_math::roots::Crossings;
use rayweave_math::{
    Bounds, Eigen, Mat3, Transform, UNIT_ROUNDOFF, Vec3, any_perpendicular, symmetric_eigen, unit,
};

/// A quadric in principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadric {
    /// The reference point of the equation: centre, vertex or apex.
    pub centre: Vec3,
    /// Orthonormal principal axes.
    pub axes: [Vec3; 3],
    /// Coefficient of the square along each axis; the largest magnitude is 1.
    pub weights: Vec3,
    /// Coefficient of q.
    pub linear: Vec3,
    /// Value at the centre.
    pub constant: f64,
}

/// Relative size below which an eigenvalue of a non-diagonal matrix counts as 0: the error of the eigenvalues.
const NOISE: f64 = 8.0 * UNIT_ROUNDOFF;

impl Quadric {
    /// `f = q . M q + linear . q + constant` with q = p - centre, about the given centre. The matrix is symmetric and not
    /// zero.
    pub fn about(centre: Vec3, matrix: &Mat3, linear: Vec3, constant: f64) -> Quadric {
        let eigen = symmetric_eigen(matrix);
        let weights = if eigen.exact { eigen.values } else { without_noise(&eigen) };
        Quadric { centre, axes: eigen.vectors, weights, linear, constant }.normalised()
    }

    /// `f = sum signs_k (rows_k . q)^2 + linear . q + constant`. The rows need not be perpendicular. Signs are 1, -1 or 0
    /// (the row then only completes the frame); at least one is not 0.
    pub fn from_squares(
        centre: Vec3,
        mut rows: [Vec3; 3],
        signs: [f64; 3],
        linear: Vec3,
        constant: f64,
    ) -> Quadric {
        make_perpendicular(&mut rows, &signs);
        let weights: [f64; 3] = std::array::from_fn(|k| signs[k] * rows[k].length_squared());
        complete_frame(&mut rows, &signs);
        Quadric { centre, axes: rows.map(unit), weights: Vec3::from_array(weights), linear, constant }
            .normalised()
    }

    fn normalised(self) -> Quadric {
        let largest = self.weights.abs().max_element();
        Quadric {
            weights: self.weights / largest,
            linear: self.linear / largest,
            constant: self.constant / largest,
            ..self
        }
    }

    /// All numbers: centre, axes, weights, linear part, constant.
    pub(super) fn numbers(&self) -> [f64; 19] {
        let [x, y, z] = self.axes;
        let vectors = [self.centre, x, y, z, self.weights, self.linear];
        std::array::from_fn(|k| if k < 18 { vectors[k / 3][k % 3] } else { self.constant })
    }

    pub(super) fn is_finite(&self) -> bool {
        self.centre.is_finite()
            && self.axes.iter().all(|e| e.is_finite())
            && self.weights.is_finite()
            && self.linear.is_finite()
            && self.constant.is_finite()
    }

    /// Coordinates along the principal axes.
    fn coordinates(&self, v: Vec3) -> Vec3 {
        Vec3::from_array(self.axes.map(|e| e.dot(v)))
    }

    /// A vector from coordinates along the principal axes.
    fn along_axes(&self, v: Vec3) -> Vec3 {
        v.x * self.axes[0] + v.y * self.axes[1] + v.z * self.axes[2]
    }

    /// At most two roots.
    pub fn crossings(&self, ray: &Ray) -> Crossings<2> {
        let (shift, q) = recentred(ray, self.centre);
        let (x, v) = (self.coordinates(q), self.coordinates(ray.direction));
        let (level, rise) = (self.linear.dot(q) + self.constant, self.linear.dot(ray.direction));
        // the error of v_k is that of a dot product: proportional to the sum of the absolute values of its terms
        let terms = Vec3::from_array(self.axes.map(|e| e.abs().dot(ray.direction.abs())));
        let noise = SQUARE_NOISE * (self.weights.abs() * v.abs()).dot(terms);
        let (x, v) = (Vector::from(x), Vector::from(v));
        let later = if self.is_ruled() { self.time_of_least_terms((x, v), rise, noise) } else { 0.0 };
        let (x, level) = (x.plus(v.times(later)), level + later * rise);
        quadratic_crossings(shift + later, noise, |s| {
            self.coefficients((x.plus(v.times(s)), v), (level + s * rise, rise))
        })
    }

    /// The time after which the terms of f are smallest: that of the least `sum |w_k| x_k^2`; 0 if `sum |w_k| v_k^2` is at most
    /// `noise`, the bound of its error, or if the linear part grows by more than the squares shrink.
    ///
    /// The rounding error of f is `u sum |w_k| x_k^2`. Terms of opposite sign cancel near the surface: two planes that cross in
    /// the z axis, `x y = 0`, meet a ray that is nearly in the plane y = 0 at a distance of 1e-3 from the axis, where the
    /// gradient is as small, while the closest approach to the centre may be at a distance of 1 from the axis. With the
    /// coefficients at the time s of the least terms, they add up at each root t to
    /// `sum |w_k| (x_k(s)^2 + v_k^2 (t - s)^2) = sum |w_k| x_k(t)^2 <= |x(t)| |grad f| / 2` (Cauchy and Schwarz, all |w_k| are at
    /// most 1), so that the root is off the surface by no more than a few u |x(t)|. A tangent of an elliptic cylinder has b = 0
    /// there, and b^2 - a c is not larger than the error of c alone.
    #[inline(always)]
    pub(crate) fn time_of_least_terms<R: Real>(&self, at: (Vector<R>, Vector<R>), rise: R, noise: R) -> R {
        time_of_least_terms(at.0.same(self.weights), at, rise, noise)
    }

    /// Coefficients from point and direction in principal axes, and the non-square part of f with its rate.
    #[inline(always)]
    pub(crate) fn coefficients<R: Real>(&self, at: (Vector<R>, Vector<R>), other: (R, R)) -> [R; 3] {
        coefficients(at.0.same(self.weights), at, other)
    }

    /// `[a, b]` of f along a ray that starts on the quadric, `a t^2 + 2 b t`.
    #[inline(always)]
    pub(crate) fn departure<R: Real>(&self, origin: Vector<R>, direction: Vector<R>) -> [R; 2] {
        let at = (origin.minus_all(self.centre).dots(self.axes), direction.dots(self.axes));
        let rise = direction.dot_all(self.linear);
        let [a, b, _] = self.coefficients(at, (rise, rise));
        [a, b]
    }

    /// f and its gradient.
    #[inline(always)]
    pub(crate) fn value_and_gradient<R: Real>(&self, point: Vector<R>) -> (R, Vector<R>) {
        let q = point.minus_all(self.centre);
        let x = q.dots(self.axes);
        let wx = x.times_all(self.weights);
        let value = wx.dot(x) + (q.dot_all(self.linear) + self.constant);
        let [i, j, k] = self.axes;
        let slope = Vector::along(i, wx.x).plus(Vector::along(j, wx.y)).plus(Vector::along(k, wx.z));
        (value, slope.times_number(2.0).plus_all(self.linear))
    }

    /// The change of the gradient per unit of time along a line with this direction.
    pub(super) fn gradient_rate(&self, direction: Vec3) -> Vec3 {
        2.0 * self.along_axes(self.weights * self.coordinates(direction))
    }

    /// True unless all weights have the same sign (an ellipsoid, a point or nothing).
    pub fn is_ruled(&self) -> bool {
        !(self.weights.cmpgt(Vec3::ZERO).all() || self.weights.cmplt(Vec3::ZERO).all())
    }

    /// Distance of the centre from the origin plus the size: the *shortest* half axis `sqrt(|constant|)` and the length
    /// `|linear|` over the largest weight.
    ///
    /// Longer half axes do not matter: an error of u in the constant moves the surface by `u |constant| / |grad f|`. If the
    /// linear part is 0, the surface has `q . grad f = -2 constant`, so that this is at most `u |q| / 2`, and |q| is
    /// already included in the point of the ray. (Counting them would be wrong: the apex of a frustum that is nearly a
    /// cylinder may be at any distance, and the frustum would be welded away.)
    pub fn magnitude(&self) -> f64 {
        self.centre.length() + self.constant.abs().sqrt() + self.linear.length()
    }

    /// The longest of the half axes `sqrt(|constant / w_k|)` and of the lengths `|linear / w_k|`, twice the radii of
    /// curvature at the vertex of a paraboloid, over all weights that are not 0. At most 1e70, the longest length of all
    /// surfaces.
    pub(super) fn size(&self) -> f64 {
        let weights = self.weights.abs().to_array().into_iter();
        let least = weights.filter(|&w| w > 0.0).fold(1.0, f64::min);
        (self.constant.abs() / least).sqrt().max(self.linear.length() / least).min(1e70)
    }

    /// The image under an affine map: `e . q = (L^-T e) . L q`.
    pub fn transformed(&self, to: &Transform) -> Quadric {
        let turned = to.local_from_world.linear.transpose();
        let centre = to.world_from_local.point(self.centre);
        if let Some(scale) = to.world_from_local.similarity() {
            let square = scale * scale;
            let keeps_directions = to.world_from_local.uniform_scale().is_some();
            return Quadric {
                centre,
                axes: if keeps_directions { self.axes } else { self.axes.map(|e| unit(turned * e)) },
                weights: self.weights,
                linear: square * (turned * self.linear),
                constant: square * self.constant,
            };
        }
        let (w, axes) = (self.weights.to_array(), self.axes);
        Quadric::from_squares(
            centre,
            std::array::from_fn(|k| turned * (nonzero(w[k]).abs().sqrt() * axes[k])),
            w.map(|w| if w == 0.0 { 0.0 } else { w.signum() }),
            turned * self.linear,
            self.constant,
        )
    }

    /// A box around f < 0: tight for ellipsoids, elliptic cylinders and paraboloids, infinite if the inside is unbounded in
    /// every direction, empty if f is nowhere negative.
    pub fn inside_bounds(&self) -> Bounds {
        if self.weights.min_element() < 0.0 {
            return Bounds::ALL;
        }
        let Some(form) = Bowl::new(self) else {
            return Bounds::EMPTY;
        };
        let side = |n: Vec3| form.farthest(self.coordinates(n));
        let axes = Vec3::AXES;
        let hi = Vec3::from_array(axes.map(side));
        let lo = Vec3::from_array(axes.map(|n| -side(-n)));
        Bounds::new(form.middle + lo, form.middle + hi)
    }
}

fn without_noise(eigen: &Eigen) -> Vec3 {
    let largest = eigen.values.abs().max_element();
    eigen.values.map(|v| if v.abs() <= NOISE * largest { 0.0 } else { v })
}

/// [`Quadric::time_of_least_terms`] with weights for each ray.
#[inline(always)]
pub(crate) fn time_of_least_terms<R: Real>(
    weights: Vector<R>,
    (x, v): (Vector<R>, Vector<R>),
    rise: R,
    noise: R,
) -> R {
    let weighted = v.times_each(weights.abs());
    let square = weighted.dot(v);
    let s = -weighted.dot(x) / square;
    let is_useful = noise.is_below(square) & rise.abs().is_at_most(s.abs() * square);
    R::select(is_useful, s, s.splat(0.0))
}

/// [`Quadric::coefficients`] with weights for each ray.
#[inline(always)]
pub(crate) fn coefficients<R: Real>(
    weights: Vector<R>,
    (x, v): (Vector<R>, Vector<R>),
    (level, rise): (R, R),
) -> [R; 3] {
    let (wx, wv) = (x.times_each(weights), v.times_each(weights));
    [wv.dot(v), wx.dot(v) + rise * 0.5, wx.dot(x) + level]
}

/// Replaces weight 0 by 1, so that the row keeps a direction.
fn nonzero(weight: f64) -> f64 {
    if weight == 0.0 { 1.0 } else { weight }
}

/// A quadric without negative weights as `sum w_k x_k^2 + slope . x + level`, in coordinates about the centre of the
/// squares; the slope has components only along axes of weight 0.
struct Bowl {
    middle: Vec3,
    weights: Vec3,
    slope: Vec3,
    level: f64,
}

impl Bowl {
    /// The normal form; `None` if f is nowhere negative.
    fn new(quadric: &Quadric) -> Option<Bowl> {
        let weights = quadric.weights;
        let linear = quadric.coordinates(quadric.linear);
        let small = NOISE * linear.length();
        let pick = |k: usize| match (weights[k] > 0.0, linear[k]) {
            (true, b) => (-0.5 * b / weights[k], 0.0),
            (false, b) => (0.0, if b.abs() <= small { 0.0 } else { b }),
        };
        let picked = [pick(0), pick(1), pick(2)];
        let shift = Vec3::from_array(picked.map(|p| p.0));
        let slope = Vec3::from_array(picked.map(|p| p.1));
        let level = quadric.constant - (weights * shift).dot(shift);
        (slope != Vec3::ZERO || level < 0.0).then(|| Bowl {
            middle: quadric.centre + quadric.along_axes(shift),
            weights,
            slope,
            level,
        })
    }

    /// Supremum of n . x over f < 0 (support function).
    fn farthest(&self, n: Vec3) -> f64 {
        let flat = Vec3::from_array(std::array::from_fn(|k| if self.weights[k] == 0.0 { n[k] } else { 0.0 }));
        // among the directions without a square only the one up the slope is bounded
        let multiplier =
            if self.slope == Vec3::ZERO { 0.0 } else { flat.dot(self.slope) / self.slope.length_squared() };
        let beside = flat - multiplier * self.slope;
        if beside.abs().max_element() > NOISE || multiplier * self.slope.length() < -NOISE {
            return f64::INFINITY;
        }
        let spread: f64 =
            (0..3).filter(|&k| self.weights[k] != 0.0).map(|k| n[k] * n[k] / self.weights[k]).sum();
        if multiplier * self.slope.length() > NOISE {
            // Lagrange multiplier: maximise n.x - multiplier * (w x^2 + level) over x
            return spread / (4.0 * multiplier) - multiplier * self.level;
        }
        if self.slope != Vec3::ZERO && spread > 0.0 {
            return f64::INFINITY;
        }
        (spread * -self.level).sqrt()
    }
}

/// One-sided Jacobi rotations, ordinary between rows of equal sign and hyperbolic between rows of opposite sign, until the
/// rows with nonzero signs are perpendicular. They leave f unchanged (J. Demmel, K. Veselic, "Jacobi's method is more
/// accurate than QR", SIAM J. Matrix Anal. Appl. 13 (1992), and the hyperbolic form of K. Veselic, "A Jacobi eigenreduction
/// algorithm for definite matrix pairs", Numer. Math. 64 (1993)).
fn make_perpendicular(rows: &mut [Vec3; 3], signs: &[f64; 3]) {
    for _ in 0..40 {
        let mut done = true;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let sign = signs[i] * signs[j];
            let dot = rows[i].dot(rows[j]);
            let lengths = rows[i].length() * rows[j].length();
            if sign == 0.0 || dot.abs() <= 4.0 * UNIT_ROUNDOFF * lengths {
                continue;
            }
            let (c, s) = jacobi_pair(rows[i].length_squared(), rows[j].length_squared(), dot, sign);
            (rows[i], rows[j]) = (c * rows[i] - sign * s * rows[j], s * rows[i] + c * rows[j]);
            done = false;
        }
        if done {
            return;
        }
    }
}

/// Cosine and sine (sign > 0), or hyperbolic cosine and sine (sign < 0), of the rotation
/// `(c a - sign s b, s a + c b)` that makes two rows perpendicular.
fn jacobi_pair(aa: f64, bb: f64, ab: f64, sign: f64) -> (f64, f64) {
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

/// Makes rows of sign 0 perpendicular to the others.
fn complete_frame(rows: &mut [Vec3; 3], signs: &[f64; 3]) {
    match std::array::from_fn(|k| signs[k] != 0.0) {
        [true, true, false] => rows[2] = unit(rows[0]).cross(unit(rows[1])),
        [true, false, true] => rows[1] = unit(rows[2]).cross(unit(rows[0])),
        [false, true, true] => rows[0] = unit(rows[1]).cross(unit(rows[2])),
        [true, false, false] => complete_pair(rows, [0, 1, 2]),
        [false, true, false] => complete_pair(rows, [1, 2, 0]),
        [false, false, true] => complete_pair(rows, [2, 0, 1]),
        [true, true, true] | [false, false, false] => {}
    }
}

fn complete_pair(rows: &mut [Vec3; 3], [only, next, last]: [usize; 3]) {
    let axis = unit(rows[only]);
    rows[next] = any_perpendicular(axis);
    rows[last] = axis.cross(rows[next]);
}

/// The surface `[x y z 1] Q [x y z 1]^T = 0` of a symmetric 4 x 4 matrix: a quadric about its centre or vertex, a plane if
/// Q has no quadratic terms, `None` if Q is constant or not finite.
pub(super) fn from_matrix(rows: &[[f64; 4]; 4]) -> Option<Surface> {
    let entry = |i: usize, j: usize| 0.5 * rows[i][j] + 0.5 * rows[j][i];
    let column = |j: usize| Vec3::new(entry(0, j), entry(1, j), entry(2, j));
    let matrix = Mat3::from_cols(column(0), column(1), column(2));
    let (linear, constant) = (2.0 * column(3), rows[3][3]);
    if !(matrix.is_finite() && linear.is_finite() && constant.is_finite()) {
        return None;
    }
    if matrix == Mat3::ZERO {
        return (linear != Vec3::ZERO).then(|| Surface::plane(linear, -constant));
    }
    let about_origin = Quadric::about(Vec3::ZERO, &matrix, linear, constant);
    Some(Surface::Quadric(Box::new(at_centre(about_origin))))
}

/// Distance of a centre, vertex or apex, relative to the size of a surface, beyond which it is not the reference point. The
/// tolerance of a surface grows with the distance of that point, to 64 u 2^20 = 7.5e-9 of the size here.
pub const DISTANT: f64 = (1u32 << 20) as f64;

/// The same quadric about the centre nearest to the old one or, without a centre, about its vertex. The reference point stays
/// where it is along axes on which the surface is nearly a cylinder: the centre may be at any distance there, as for a frustum
/// whose radii differ by roundings.
fn at_centre(quadric: Quadric) -> Quadric {
    let (w, b) = (quadric.weights, quadric.coordinates(quadric.linear));
    let small = NOISE * b.length();
    let far = DISTANT * (quadric.constant.abs().sqrt() + b.length());
    // the centre of an ellipsoid is needed for its box
    let is_distant = |shift: f64| shift.abs() > far && quadric.is_ruled();
    let shift_of = |k: usize| {
        let shift = if w[k] == 0.0 { 0.0 } else { -0.5 * b[k] / w[k] };
        if is_distant(shift) { None } else { Some(shift) }
    };
    let shifts = [0, 1, 2].map(shift_of);
    let shift = Vec3::from_array(shifts.map(Option::unwrap_or_default));
    let rest = Vec3::from_array(std::array::from_fn(|k| match shifts[k] {
        None => b[k],
        Some(_) if w[k] != 0.0 || b[k].abs() <= small => 0.0,
        Some(_) => b[k],
    }));
    let level = quadric.constant - (w * shift).dot(shift);
    if rest == Vec3::ZERO {
        return Quadric {
            centre: quadric.centre + quadric.along_axes(shift),
            linear: Vec3::ZERO,
            constant: level,
            ..quadric
        };
    }
    let is_near = level.abs() <= DISTANT * (level.abs().sqrt() + rest.length()) * rest.length();
    if shifts.contains(&None) || !is_near {
        return Quadric {
            centre: quadric.centre + quadric.along_axes(shift),
            linear: quadric.along_axes(rest),
            constant: level,
            ..quadric
        };
    }
    let shift = shift - level / rest.length_squared() * rest;
    Quadric {
        centre: quadric.centre + quadric.along_axes(shift),
        linear: quadric.along_axes(rest),
        constant: 0.0,
        ..quadric
    }
}
