//! Tessellation of quadrics from their elliptic sections. Quadrics without elliptic sections are tessellated on a grid.

use super::implicit;
use super::revolved::{Profile, circle_count, revolved};
use crate::kernel::Body;
use rayweave_math::{Affine, Bounds, Mat3, Vec3};
use rayweave_shape::surface::{Quadric, Surface};

/// A sample of a profile: parameter and point.
type Sample = (f64, [f64; 2]);

/// Maximum number of bisections of a piece of a profile.
const MAX_HALVINGS: u32 = 20;

/// `a x^2 + b y^2 < g(z)` with a, b > 0 and g quadratic, in a frame with its own origin and axes.
struct Elliptic {
    origin: Vec3,
    axes: [Vec3; 3],
    a: f64,
    b: f64,
    /// g = g[0] + g[1] z + g[2] z^2.
    g: [f64; 3],
    /// True if the solid is the complement.
    is_outside: bool,
}

/// The interior of a quadric, clipped to a box.
pub(super) fn body(quadric: &Quadric, clip: &Bounds, tolerance: f64) -> Result<Option<Body>, String> {
    match elliptic(quadric) {
        Some(form) => form.body(clip, tolerance),
        None => {
            let surface = Surface::Quadric(Box::new(*quadric));
            let bounds = surface.inside_bounds();
            implicit::body(&surface, &bounds.intersection(clip), tolerance)
        }
    }
}

/// The elliptic form of a quadric, if two eigenvalues have the same sign.
fn elliptic(quadric: &Quadric) -> Option<Elliptic> {
    let weights = quadric.weights.to_array();
    let [i, j, m] =
        [[0, 1, 2], [1, 2, 0], [2, 0, 1]].into_iter().find(|[i, j, _]| weights[*i] * weights[*j] > 0.0)?;
    let (mut origin, mut constant) = (quadric.centre, quadric.constant);
    let linear = quadric.axes.map(|axis| axis.dot(quadric.linear));
    // along the third axis, on which the centre may be very far away, the linear term stays
    for k in [i, j] {
        origin -= quadric.axes[k] * (linear[k] / (2.0 * weights[k]));
        constant -= linear[k] * linear[k] / (4.0 * weights[k]);
    }
    let sign = weights[i].signum();
    Some(Elliptic {
        origin,
        axes: [quadric.axes[i], quadric.axes[j], quadric.axes[m]],
        a: sign * weights[i],
        b: sign * weights[j],
        g: [-sign * constant, -sign * linear[m], -sign * weights[m]],
        is_outside: sign < 0.0,
    })
}

impl Elliptic {
    fn value(&self, z: f64) -> f64 {
        self.g[0] + z * (self.g[1] + z * self.g[2])
    }

    fn body(&self, clip: &Bounds, tolerance: f64) -> Result<Option<Body>, String> {
        let mut sum: Option<Body> = None;
        for range in self.ranges(clip) {
            // flat where g is positive only within rounding errors, such as at an apex on a face of the box
            let Some(piece) = self.piece(range, tolerance)? else { continue };
            sum = match sum {
                Some(sum) => sum.union(&piece)?,
                None => Some(piece),
            };
        }
        match (self.is_outside, sum) {
            (false, sum) => Ok(sum),
            (true, Some(sum)) => Body::cuboid(clip).difference(&sum),
            (true, None) => Ok(Some(Body::cuboid(clip))),
        }
    }

    /// Intervals of z within the box in which g(z) > 0.
    fn ranges(&self, clip: &Bounds) -> Vec<[f64; 2]> {
        let heights = clip.corners().map(|corner| (corner - self.origin).dot(self.axes[2]));
        let lo = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let hi = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let roots = roots(self.g).into_iter().filter(|root| (lo..hi).contains(root));
        let ends: Vec<f64> = std::iter::once(lo).chain(roots).chain([hi]).collect();
        let has_sections = |pair: &&[f64]| pair[0] < pair[1] && self.value(0.5 * (pair[0] + pair[1])) > 0.0;
        ends.windows(2).filter(has_sections).map(|pair| [pair[0], pair[1]]).collect()
    }

    fn piece(&self, [lo, hi]: [f64; 2], tolerance: f64) -> Result<Option<Body>, String> {
        let [x, y] = [self.a, self.b].map(|weight| 1.0 / libm::sqrt(weight));
        let widest = x.max(y);
        let middle = self.value(0.5 * (lo + hi));
        let radius = |z: f64| {
            let value = self.value(z);
            // at a root of g the radius is zero; rounding leaves a small positive value
            if value > 1e-12 * middle { widest * libm::sqrt(value) } else { 0.0 }
        };
        // Chebyshev spacing: dense at both ends, where the profile may be perpendicular to the axis
        let at = |t: f64| {
            let z = match t {
                0.0 => lo,
                1.0 => hi,
                t => 0.5 * ((lo + hi) - (hi - lo) * libm::cos(std::f64::consts::PI * t)),
            };
            [radius(z), z]
        };
        let mut points = polyline(at, 0.5 * tolerance);
        if points[0][0] > 0.0 {
            points.insert(0, [0.0, lo]);
        }
        if points[points.len() - 1][0] > 0.0 {
            points.push([0.0, hi]);
        }
        let profile = Profile { points, is_bent: true };
        let n = circle_count(profile.reach(), 0.5 * tolerance)?;
        let body = revolved(&profile, n, Vec3::new(x / widest, y / widest, 1.0))?;
        let linear = Mat3::from_cols(self.axes[0], self.axes[1], self.axes[2]);
        body.map_or(Ok(None), |body| body.placed(&Affine { linear, translation: self.origin }))
    }
}

/// Real roots of c[0] + c[1] x + c[2] x^2, in increasing order.
fn roots([c, b, a]: [f64; 3]) -> Vec<f64> {
    if a == 0.0 {
        return if b == 0.0 { Vec::new() } else { vec![-c / b] };
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return Vec::new();
    }
    let q = -0.5 * (b + libm::copysign(libm::sqrt(discriminant), b));
    let mut both = if q == 0.0 { vec![0.0] } else { vec![q / a, c / q] };
    both.sort_by(f64::total_cmp);
    both
}

/// Polyline approximation of a curve over [0, 1] by adaptive bisection: chords deviate by at most `tolerance`, tested at the
/// parameter midpoint.
fn polyline(at: impl Fn(f64) -> [f64; 2], tolerance: f64) -> Vec<[f64; 2]> {
    const PIECES: u32 = 4;
    let sample = |t: f64| (t, at(t));
    let start = sample(0.0);
    let mut points = vec![start.1];
    let mut stack: Vec<(Sample, Sample, u32)> = Vec::new();
    for k in (0..PIECES).rev() {
        let [a, b] = [k, k + 1].map(|k| sample(f64::from(k) / f64::from(PIECES)));
        stack.push((a, b, 0));
    }
    while let Some((a, b, depth)) = stack.pop() {
        let middle = sample(0.5 * (a.0 + b.0));
        if depth < MAX_HALVINGS && distance(middle.1, a.1, b.1) > tolerance {
            stack.push((middle, b, depth + 1));
            stack.push((a, middle, depth + 1));
        } else {
            points.push(b.1);
        }
    }
    points
}

/// Distance of a point from the line through two others.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = libm::hypot(u[0], u[1]);
    if length == 0.0 { libm::hypot(v[0], v[1]) } else { (u[0] * v[1] - u[1] * v[0]).abs() / length }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A double cone whose tip lies on the top of the box up to rounding: the part above the tip has no interior.
    #[test]
    fn parts_within_rounding_errors_are_left_out() {
        let clip = Bounds::new(Vec3::splat(-1.0), Vec3::splat(1.0));
        for below in [1e-9, 1e-13, 2e-16, 0.0] {
            let tip = 1.0 - below;
            let (q, l) = (-0.25, 0.25 * tip);
            let rows =
                [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, q, l], [0.0, 0.0, l, -l * tip]];
            let Some(Surface::Quadric(cone)) = Surface::quadric(&rows) else { panic!("not a quadric") };
            let found = body(&cone, &clip, 1e-3).unwrap().unwrap().mesh().unwrap().volume();
            let expected = 2.0 / 3.0 * std::f64::consts::PI;
            assert!((found - expected).abs() < 0.01, "{below}: {found}");
        }
    }
    /// A frustum whose radii differ by next to nothing, with its apex up to 1e13 away.
    #[test]
    fn frusta_that_are_nearly_cylinders_have_their_volume() {
        let clip = Bounds::new(Vec3::splat(-2.0), Vec3::splat(2.0));
        for slope in [1e-13, -1e-13, 1e-11, 1e-9, 1e-7, 1e-5] {
            let rows = [
                [1.0, 0.0, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0],
                [0.0, 0.0, -slope * slope, -slope],
                [0.0, 0.0, -slope, -1.0],
            ];
            let Some(Surface::Quadric(cone)) = Surface::quadric(&rows) else { panic!("not a quadric") };
            let found = body(&cone, &clip, 1e-3).unwrap().unwrap().mesh().unwrap().volume();
            // chords within 1e-3 of the radius take less than 2e-3 of the area
            let expected = 4.0 * std::f64::consts::PI;
            assert!(found < expected && found > (1.0 - 2e-3) * expected, "{slope}: {found}");
        }
    }
}
