//! Gauss collocation: integration steps of light in a gradient, with the polynomial of each step as a curve.

use crate::gradient::LocalField;
use rayweave_math::{Bounds, Vec3};
use rayweave_space::{Curve, Point};
use std::sync::LazyLock;

/// The collocation points of a step.
const POINTS: usize = 8;

/// The roots of the Legendre polynomial of degree 8 above 0, and their weights (NIST, *Digital
/// Library of Mathematical Functions*, section 3.5(v)).
const GAUSS: [(f64, f64); POINTS / 2] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_27),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// The tolerance of the direction within a step. At the end of the step the error is far smaller.
const TOLERANCE: f64 = 1e-13;

/// The number of fixed-point iterations after which a step counts as too long.
const MAX_ITERATIONS: usize = 32;

/// The coefficients of the method, computed once.
struct Tables {
    nodes: [f64; POINTS],
    weights: [f64; POINTS],
    /// Legendre polynomials at the nodes: `[node][degree]`.
    legendre: [[f64; POINTS]; POINTS],
    /// The square of the matrix of Gauss's method, from forces to positions: `[to][of]`.
    twice: [[f64; POINTS]; POINTS],
}

static TABLES: LazyLock<Tables> = LazyLock::new(Tables::new);

impl Tables {
    fn new() -> Tables {
        let nodes: [f64; POINTS] = std::array::from_fn(|i| {
            let k = POINTS / 2;
            if i < k { -GAUSS[k - 1 - i].0 } else { GAUSS[i - k].0 }
        });
        let weights =
            nodes.map(|x| GAUSS.iter().find(|(node, _)| *node == x.abs()).map_or(0.0, |(_, weight)| *weight));
        let legendre = nodes.map(legendre);
        let mut twice = [[0.0; POINTS]; POINTS];
        for of in 0..POINTS {
            let unit: Vec<Vec3> =
                (0..POINTS).map(|k| Vec3::X * ((k as f64 + 0.5) * weights[of] * legendre[of][k])).collect();
            let mut once = integral(&unit);
            // the polynomial whose roots are the nodes is dropped: the method is then the Gauss
            // method for positions and velocities together, which is symplectic
            once.truncate(POINTS);
            let series = integral(&once);
            for to in 0..POINTS {
                twice[to][of] = value(&series, nodes[to]).x;
            }
        }
        Tables { nodes, weights, legendre, twice }
    }
}

/// Legendre polynomials of degree 0 up, by their recurrence (DLMF 18.9.1).
fn legendre<const N: usize>(x: f64) -> [f64; N] {
    let mut p = [1.0; N];
    for k in 1..N {
        let n = k as f64;
        let before = if k > 1 { p[k - 2] } else { 0.0 };
        p[k] = ((2.0 * n - 1.0) * x * p[k - 1] - (n - 1.0) * before) / n;
    }
    p
}

/// The sum of a series of Legendre polynomials.
fn value(series: &[Vec3], x: f64) -> Vec3 {
    let (mut before, mut now, mut sum) = (0.0, 1.0, Vec3::ZERO);
    for (k, c) in series.iter().enumerate() {
        sum += now * *c;
        let n = k as f64 + 1.0;
        (before, now) = (now, ((2.0 * n - 1.0) * x * now - (n - 1.0) * before) / n);
    }
    sum
}

/// The series of the integral from -1 (DLMF 18.9.7 and 18.17.1: `(2k + 1) P_k` is the derivative of
/// `P_{k+1} - P_{k-1}`).
fn integral(series: &[Vec3]) -> Vec<Vec3> {
    let at = |k: usize| series.get(k).copied().unwrap_or(Vec3::ZERO);
    let term = |k: usize| at(k - 1) / (2.0 * k as f64 - 1.0) - at(k + 1) / (2.0 * k as f64 + 3.0);
    std::iter::once(at(0) - at(1) / 3.0).chain((1..=series.len()).map(term)).collect()
}

/// A step: light from a point with a velocity `dr/dtau`, whose length is the index, up to the time
/// `duration`.
///
/// Times run from 0; position, velocity and acceleration are series of Legendre polynomials in
/// `t / half - 1`.
#[derive(Clone, Debug)]
pub(super) struct Step {
    half: f64,
    position: Vec<Vec3>,
    velocity: Vec<Vec3>,
    acceleration: Vec<Vec3>,
    /// Bounds on the acceleration and on its rate of change, with half the duration as the unit of time.
    bounds: [f64; 2],
    size: f64,
}

/// A step and the suggested duration of the next one.
pub(super) struct Stepped {
    pub step: Step,
    pub next: f64,
}

impl Step {
    /// A step along the solution within the tolerance, of at most `duration`; `None` if there is no solution.
    pub fn take(field: &LocalField<'_>, start: Vec3, velocity: Vec3, duration: f64) -> Option<Stepped> {
        let mut duration = duration;
        for _ in 0..64 {
            let Some(step) = Step::of(field, start, velocity, duration) else {
                duration *= 0.25;
                continue;
            };
            let error = step.error(field) / velocity.length();
            // the error scales with the duration to the power of the number of points plus one
            let change = libm::pow(TOLERANCE / error.max(1e-30), 1.0 / (POINTS as f64 + 1.0));
            let next = duration * (0.9 * change).clamp(0.2, 4.0);
            if error <= TOLERANCE {
                return Some(Stepped { step, next });
            }
            duration = next.min(0.9 * duration);
        }
        None
    }

    /// The step of this duration; `None` if the iteration does not converge.
    fn of(field: &LocalField<'_>, start: Vec3, velocity: Vec3, duration: f64) -> Option<Step> {
        let tables = &*TABLES;
        let half = 0.5 * duration;
        let straight = |x: f64| start + (half * (x + 1.0)) * velocity;
        let mut points = tables.nodes.map(straight);
        let rest = 4.0 * f64::EPSILON * (start.length() + duration * velocity.length());
        let mut last = f64::INFINITY;
        for _ in 0..MAX_ITERATIONS {
            let forces = points.map(|point| field.at(point).force);
            let mut moved = 0.0f64;
            for (to, point) in points.iter_mut().enumerate() {
                let fallen: Vec3 = (0..POINTS).map(|of| tables.twice[to][of] * forces[of]).sum();
                let next = straight(tables.nodes[to]) + half * half * fallen;
                moved = moved.max((next - *point).length());
                *point = next;
            }
            if moved <= rest {
                return Some(Step::from_forces(half, start, velocity, &forces));
            }
            if moved.is_nan() || moved >= last {
                return None;
            }
            last = moved;
        }
        None
    }

    fn from_forces(half: f64, start: Vec3, velocity: Vec3, forces: &[Vec3; POINTS]) -> Step {
        let tables = &*TABLES;
        let coefficient = |k: usize| -> Vec3 {
            let terms = (0..POINTS).map(|i| tables.weights[i] * tables.legendre[i][k] * forces[i]);
            (k as f64 + 0.5) * terms.sum::<Vec3>()
        };
        let acceleration: Vec<Vec3> = (0..POINTS).map(coefficient).collect();
        let mut speeds: Vec<Vec3> = integral(&acceleration).into_iter().map(|c| half * c).collect();
        speeds[0] += velocity;
        let mut position: Vec<Vec3> = integral(&speeds).into_iter().map(|c| half * c).collect();
        position[0] += start;
        // |P_k| <= 1 and |P_k'| <= k (k + 1) / 2 (DLMF 18.14.1 and 18.9.15)
        let lengths = || acceleration.iter().map(|c| c.length()).enumerate();
        let most = lengths().map(|(_, length)| length).sum();
        let change = lengths().map(|(k, length)| 0.5 * (k * (k + 1)) as f64 * length).sum();
        let size = position.iter().map(|c| c.length()).sum();
        Step { half, position, velocity: speeds, acceleration, bounds: [most, change], size }
    }

    /// The error of the velocity within the step, estimated from the residual of the equation of
    /// motion at its ends: the residual is proportional to the Legendre polynomial whose roots are
    /// the points, and the error is its integral.
    fn error(&self, field: &LocalField<'_>) -> f64 {
        let off = |x: f64| (value(&self.acceleration, x) - field.at(value(&self.position, x)).force).length();
        off(-1.0).max(off(1.0)) * self.half * 2.0 / (2.0 * POINTS as f64 + 1.0)
    }

    /// The bounding box.
    pub fn bounds(&self) -> Bounds {
        let half: Vec3 = self.position[1..].iter().map(|c| c.abs()).sum();
        Bounds::centred(self.position[0], half)
    }

    /// A bound of the lengths from which positions are computed.
    pub fn size(&self) -> f64 {
        self.size
    }

    pub fn duration(&self) -> f64 {
        2.0 * self.half
    }

    pub fn at(&self, t: f64) -> Vec3 {
        value(&self.position, t / self.half - 1.0)
    }

    pub fn velocity_at(&self, t: f64) -> Vec3 {
        value(&self.velocity, t / self.half - 1.0)
    }

    /// The times of the Gauss points between two times, with their weights.
    pub fn quadrature(&self, from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let tables = &*TABLES;
        tables.nodes.iter().zip(&tables.weights).map(move |(x, w)| (middle + half * x, half * w))
    }
}

impl Curve<3> for Step {
    fn position(&self, t: f64) -> Point<3> {
        self.at(t).to_array()
    }

    fn velocity(&self, t: f64) -> Point<3> {
        self.velocity_at(t).to_array()
    }

    fn acceleration_bound(&self, t0: f64, t1: f64) -> f64 {
        let [most, change] = self.bounds;
        let middle = value(&self.acceleration, 0.5 * (t0 + t1) / self.half - 1.0).length();
        let near = middle + change * 0.5 * (t1 - t0) / self.half;
        // margin for rounding of the sums
        (1.0 + 1e-12) * most.min(near)
    }

    fn domain(&self) -> (f64, f64) {
        (0.0, self.duration())
    }

    fn size(&self, _: f64) -> f64 {
        self.size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradient::Gradient;

    #[test]
    fn the_points_are_those_of_gauss() {
        // exact for all powers up to 15: the integral of x^(2k) over [-1, 1] is 2 / (2k + 1)
        let tables = &*TABLES;
        for power in 0..=15 {
            let sum: f64 = tables.nodes.iter().zip(&tables.weights).map(|(x, w)| w * x.powi(power)).sum();
            let expected = if power % 2 == 0 { 2.0 / f64::from(power + 1) } else { 0.0 };
            assert!((sum - expected).abs() < 1e-15, "{power}: {sum}");
        }
    }

    #[test]
    fn double_integrals_of_powers() {
        // twice from -1: x^m gives (x^(m+2) - (-1)^m) / ((m+1)(m+2)) - (-1)^(m+1) (x + 1) / (m + 1)
        let tables = &*TABLES;
        for m in 0..POINTS as i32 - 1 {
            let sign = if m % 2 == 0 { 1.0 } else { -1.0 };
            for (to, x) in tables.nodes.iter().enumerate() {
                let sum: f64 = (0..POINTS).map(|of| tables.twice[to][of] * tables.nodes[of].powi(m)).sum();
                let (a, b) = (f64::from(m + 1), f64::from(m + 2));
                let expected = (x.powi(m + 2) - sign) / (a * b) + sign * (x + 1.0) / a;
                assert!((sum - expected).abs() < 4e-15, "{m} {x}: {sum} {expected}");
            }
        }
    }

    fn rod(gradient: &Gradient) -> LocalField<'_> {
        LocalField { gradient, index: 1.5, wavelength_nm: 500.0 }
    }

    /// A ray in n^2 = n0^2 (1 - g^2 r^2): x = x0 cos(w tau) + u0/w sin(w tau) with w = n0 g, and z = v tau.
    fn sine(start: Vec3, velocity: Vec3, t: f64) -> (Vec3, Vec3) {
        let w = 1.5 * 0.4;
        let (s, c) = (w * t).sin_cos();
        let across = |p: f64, v: f64| (p * c + v / w * s, v * c - w * p * s);
        let ((x, u), (y, v)) = (across(start.x, velocity.x), across(start.y, velocity.y));
        (Vec3::new(x, y, start.z + velocity.z * t), Vec3::new(u, v, velocity.z))
    }

    const START: (Vec3, Vec3) = (Vec3::new(0.5, -0.2, 1.0), Vec3::new(0.3, 0.1, 1.4));

    #[test]
    fn steps_follow_sines() {
        let gradient = Gradient::selfoc(0.4).unwrap();
        let field = rod(&gradient);
        let (mut p, mut v, mut t, mut wanted) = (START.0, START.1, 0.0, 1.0);
        let mut steps = 0;
        while t < 100.0 {
            let Stepped { step, next } = Step::take(&field, p, v, wanted).unwrap();
            for k in 0..=10 {
                let s = 0.1 * f64::from(k) * step.duration();
                let (at, speed) = sine(START.0, START.1, t + s);
                assert!((step.at(s) - at).length() < 1e-12, "{t} {s}");
                assert!((step.velocity_at(s) - speed).length() < 1e-12, "{t} {s}");
            }
            (p, v) = (step.at(step.duration()), step.velocity_at(step.duration()));
            (t, wanted, steps) = (t + step.duration(), next, steps + 1);
        }
        // about three steps per radian
        assert!(steps < 250, "{steps}");
    }

    /// At the ends of a step the order is twice the number of points, 16, as steps far longer than
    /// the tolerance allows show.
    #[test]
    fn order_of_convergence() {
        let gradient = Gradient::selfoc(0.4).unwrap();
        let field = rod(&gradient);
        let off = |count: u32| {
            let duration = 35.0 / f64::from(count);
            let (mut p, mut v) = START;
            for _ in 0..count {
                let step = Step::of(&field, p, v, duration).unwrap();
                (p, v) = (step.at(step.duration()), step.velocity_at(step.duration()));
            }
            (p - sine(START.0, START.1, 35.0).0).length()
        };
        let (coarse, fine) = (off(7), off(9));
        let order = (coarse / fine).ln() / (9.0_f64 / 7.0).ln();
        assert!((15.0..17.5).contains(&order), "{coarse} {fine}: {order}");
    }

    #[test]
    fn steps_are_time_reversible() {
        let gradient = Gradient::polynomial(&[1.2, -0.1, 0.02], &[0.05]).unwrap();
        let field = rod(&gradient);
        let (p, v) = (Vec3::new(0.3, 0.4, 0.1), 1.7 * Vec3::new(0.48, 0.6, 0.64));
        let step = Step::of(&field, p, v, 0.8).unwrap();
        let (q, w) = (step.at(0.8), step.velocity_at(0.8));
        let back = Step::of(&field, q, -w, 0.8).unwrap();
        assert!((back.at(0.8) - p).length() < 1e-15 && (back.velocity_at(0.8) + v).length() < 4e-15);
    }

    /// Even steps that are far too long preserve the symplectic form: `J^T W J = W` for the
    /// derivative J of the map of position and velocity (Hairer, Lubich & Wanner, theorem VI.4.2).
    #[test]
    fn steps_are_symplectic() {
        let gradient = Gradient::fish_eye(1.0).unwrap();
        let field = LocalField { gradient: &gradient, index: 1.0, wavelength_nm: 500.0 };
        let start = [0.6, 0.1, -0.2, 0.5, 0.9, 0.7];
        let map = |q: [f64; 6]| -> [f64; 6] {
            let [a, b, c, u, v, w] = q;
            let step = Step::of(&field, Vec3::new(a, b, c), Vec3::new(u, v, w), 1.5).unwrap();
            assert!(step.error(&field) > 1e8 * TOLERANCE);
            let (p, s) = (step.at(1.5), step.velocity_at(1.5));
            [p.x, p.y, p.z, s.x, s.y, s.z]
        };
        let slope = |k: usize| -> [f64; 6] {
            let moved = |by: f64| map(std::array::from_fn(|i| start[i] + if i == k { by } else { 0.0 }));
            let (a, b, c, d) = (moved(-2e-3), moved(-1e-3), moved(1e-3), moved(2e-3));
            std::array::from_fn(|i| (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / 12e-3)
        };
        let columns: [[f64; 6]; 6] = std::array::from_fn(slope);
        for (i, a) in columns.iter().enumerate() {
            for (j, b) in columns.iter().enumerate() {
                let form: f64 = (0..3).map(|k| a[k] * b[k + 3] - a[k + 3] * b[k]).sum();
                let expected = if j == i + 3 {
                    1.0
                } else if i == j + 3 {
                    -1.0
                } else {
                    0.0
                };
                assert!((form - expected).abs() < 1e-9, "{i} {j}: {form}");
            }
        }
    }

    #[test]
    fn bounds_contain_the_acceleration() {
        let gradient = Gradient::luneburg(1.0).unwrap();
        let field = rod(&gradient);
        let step = Step::of(&field, Vec3::new(0.3, 0.2, -0.9), Vec3::Z, 0.7).unwrap();
        for (a, b) in [(0.0, 0.7), (0.1, 0.15), (0.6, 0.7)] {
            let bound = step.acceleration_bound(a, b);
            let time = |k: i32| a + (b - a) * 0.05 * f64::from(k);
            let here = |k| value(&step.acceleration, time(k) / step.half - 1.0).length();
            let most = (0..=20).map(here).fold(0.0, f64::max);
            assert!(most <= bound && bound < 1.5 * most, "{a} {b}: {most} {bound}");
        }
    }
}
