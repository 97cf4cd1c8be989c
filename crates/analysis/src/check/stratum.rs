//! Smallest distances between faces, edges and corners.
//!
//! A face is a piece of one surface, an edge a piece of the curve in which two surfaces meet, a corner a point common to three. The
//! distance of two points on them is least where its derivatives along both vanish: Newton's method with the curvatures of the
//! surfaces finds that place, damped as by Levenberg and Marquardt, so that each step reduces the distance.

use crate::distance::combination;
use crate::measure::MeasuredChord;
use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use rayweave_shape::surface::Surface;

/// The determinants above which two and three normals are independent: faces that meet at an edge or corner differ by far more than
/// those that a point has in common by chance.
const INDEPENDENT: [f64; 2] = [1e-6, 1e-4];

/// A face, edge or corner without its ends.
#[derive(Clone, Debug)]
pub(super) enum Stratum<'s> {
    /// The points that one to three surfaces have in common.
    Common(Vec<&'s Surface>),
    /// The apex of a cone.
    Apex(Vec3),
}

/// Two points, one on each of two strata, of which no pair beside them has a smaller distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    pub ends: [Vec3; 2],
    /// The distance; for two faces negative where they intersect.
    pub distance: f64,
    /// Distances up to this are rounding errors.
    pub tolerance: f64,
    /// True for two faces with parallel normals, also where they touch.
    pub is_tangent: bool,
}

impl Closest {
    /// The way between the points.
    pub fn chord(&self) -> MeasuredChord {
        MeasuredChord { from: self.ends[0], to: self.ends[1] }
    }
}

/// The largest number of steps towards a curve or corner; each doubles the number of correct digits.
const PROJECTIONS: usize = 16;

/// The largest number of steps towards the closest place.
const STEPS: usize = 60;

/// Distances are at right angles to faces and edges up to this angle: their relative error is half its square.
const RIGHT_ANGLE: f64 = 1e-6;

impl Stratum<'_> {
    /// The nearest point of the stratum and the unit gradients there; `None` without convergence.
    pub fn project(&self, near: Vec3) -> Option<(Vec3, Vec<Vec3>)> {
        let surfaces = match self {
            Stratum::Apex(apex) => return Some((*apex, Vec::new())),
            Stratum::Common(surfaces) => surfaces,
        };
        let (mut point, mut units) = (near, Vec::with_capacity(surfaces.len()));
        for _ in 0..PROJECTIONS {
            units.clear();
            let mut offsets = [0.0; 3];
            let mut error = 0.0f64;
            for (k, surface) in surfaces.iter().enumerate() {
                let (value, gradient) = surface.value_and_gradient(point);
                let length = gradient.length();
                if !(length > 0.0 && value.is_finite()) {
                    return None;
                }
                units.push(gradient / length);
                error = error.max((value / length).abs());
                // the signed distance of `near` from the tangent plane
                offsets[k] = value / length + units[k].dot(near - point);
            }
            let next = near - combination(&units, offsets, INDEPENDENT)?;
            let step = (next - point).length();
            point = next;
            if step <= 4.0 * UNIT_ROUNDOFF * (point.length() + near.length()) {
                break;
            }
            if !(step.is_finite() && error.is_finite()) {
                return None;
            }
        }
        let is_on = surfaces.iter().all(|surface| {
            let (value, gradient) = surface.value_and_gradient(point);
            value.abs() <= rounding(surface, point) * gradient.length()
        });
        is_on.then_some((point, units))
    }

    /// The lengths that enter the coordinates of a point.
    fn rounding(&self, point: Vec3) -> f64 {
        match self {
            Stratum::Apex(apex) => 256.0 * UNIT_ROUNDOFF * apex.length(),
            Stratum::Common(surfaces) => {
                surfaces.iter().map(|surface| rounding(surface, point)).fold(0.0, f64::max)
            }
        }
    }

    /// An orthonormal basis of the directions along the stratum.
    fn tangents(&self, units: &[Vec3]) -> Vec<Vec3> {
        match (self, units) {
            (Stratum::Common(_), [unit]) => {
                let side = unit.any_orthonormal_vector();
                vec![side, unit.cross(side)]
            }
            (Stratum::Common(_), [a, b]) => vec![a.cross(*b).normalize_or_zero()],
            _ => Vec::new(),
        }
    }

    /// The second derivative of the distance along the tangents that the curvature of the stratum contributes, with `way` the way from
    /// the other point. The derivatives of gradients are differences over `step`.
    fn bending(&self, point: Vec3, units: &[Vec3], tangents: &[Vec3], way: Vec3, step: f64) -> [[f64; 2]; 2] {
        let mut bent = [[0.0; 2]; 2];
        let Stratum::Common(surfaces) = self else { return bent };
        let Some(multipliers) = multipliers(units, way) else { return bent };
        for (k, surface) in surfaces.iter().enumerate().filter(|(_, own)| !matches!(own, Surface::Plane(_))) {
            let slope = surface.value_and_gradient(point).1.length();
            for (j, tangent) in tangents.iter().enumerate() {
                let [after, before] =
                    [step, -step].map(|step| surface.value_and_gradient(point + step * *tangent).1);
                let turned = (after - before) / (2.0 * step * slope);
                for (i, other) in tangents.iter().enumerate() {
                    bent[i][j] -= multipliers[k] * turned.dot(*other);
                }
            }
        }
        bent
    }
}

/// The rounding error of distances at a point of a surface: 256 u times the lengths in its equation, as for signed distances
/// ([`crate::distance`]).
fn rounding(surface: &Surface, point: Vec3) -> f64 {
    256.0 * UNIT_ROUNDOFF * (surface.magnitude() + point.length())
}

/// The coefficients of the part of a vector in the span of unit vectors.
fn multipliers(units: &[Vec3], of: Vec3) -> Option<[f64; 3]> {
    match *units {
        [a] => Some([a.dot(of), 0.0, 0.0]),
        [a, b] => {
            let (cosine, x, y) = (a.dot(b), a.dot(of), b.dot(of));
            let determinant = 1.0 - cosine * cosine;
            (determinant > 0.0).then(|| [(x - cosine * y) / determinant, (y - cosine * x) / determinant, 0.0])
        }
        _ => None,
    }
}

/// Points of two strata and their differential geometry.
struct State {
    ends: [Vec3; 2],
    units: [Vec<Vec3>; 2],
    distance: f64,
}

fn state(strata: &[Stratum<'_>; 2], near: [Vec3; 2]) -> Option<State> {
    let (p, first) = strata[0].project(near[0])?;
    let (q, second) = strata[1].project(near[1])?;
    Some(State { ends: [p, q], units: [first, second], distance: (p - q).length() })
}

/// The closest place of two strata that descent from two points leads to; `None` without convergence. Differences of gradients
/// are taken over `step`.
pub(super) fn closest(strata: &[Stratum<'_>; 2], near: [Vec3; 2], step: f64) -> Option<Closest> {
    let mut now = state(strata, near)?;
    let mut damping = 1e-6;
    let mut rounding = 0.0f64;
    let mut error = f64::INFINITY;
    for _ in 0..STEPS {
        let [p, q] = now.ends;
        rounding = strata[0].rounding(p).max(strata[1].rounding(q));
        let way = p - q;
        let tangents = [strata[0].tangents(&now.units[0]), strata[1].tangents(&now.units[1])];
        let n = [tangents[0].len(), tangents[1].len()];
        let mut slope = [0.0; 4];
        tangents[0].iter().enumerate().for_each(|(k, tangent)| slope[k] = tangent.dot(way));
        tangents[1].iter().enumerate().for_each(|(k, tangent)| slope[n[0] + k] = -tangent.dot(way));
        error = slope.iter().map(|x| x * x).sum::<f64>().sqrt();
        if error <= 1e-12 * now.distance || now.distance <= rounding {
            break;
        }
        let mut matrix = [[0.0; 4]; 4];
        let bent = [
            strata[0].bending(p, &now.units[0], &tangents[0], way, step),
            strata[1].bending(q, &now.units[1], &tangents[1], -way, step),
        ];
        for (of, first) in [(0, 0), (1, n[0])] {
            for i in 0..n[of] {
                for j in 0..n[of] {
                    matrix[first + i][first + j] = bent[of][i][j] + f64::from(u8::from(i == j));
                }
            }
        }
        for (i, a) in tangents[0].iter().enumerate() {
            for (j, b) in tangents[1].iter().enumerate() {
                let coupled = -a.dot(*b);
                (matrix[i][n[0] + j], matrix[n[0] + j][i]) = (coupled, coupled);
            }
        }
        let mut is_better = false;
        while damping < 1e6 {
            let mut damped = matrix;
            (0..n[0] + n[1]).for_each(|k| damped[k][k] += damping);
            let along = |change: [f64; 4]| {
                let of = |tangents: &[Vec3], first: usize| -> Vec3 {
                    tangents.iter().enumerate().map(|(k, tangent)| change[first + k] * *tangent).sum()
                };
                [p + of(&tangents[0], 0), q + of(&tangents[1], n[0])]
            };
            let next = solved(damped, slope.map(|x| -x), n[0] + n[1])
                .and_then(|change| state(strata, along(change)))
                .filter(|next| next.distance < now.distance);
            if let Some(next) = next {
                now = next;
                damping = (0.1 * damping).max(1e-15);
                is_better = true;
                break;
            }
            damping *= 10.0;
        }
        if !is_better {
            break;
        }
    }
    let is_at_least = now.distance <= rounding || error <= RIGHT_ANGLE * now.distance + rounding;
    let found = Closest { ends: now.ends, distance: now.distance, tolerance: rounding, is_tangent: false };
    match (&now.units[0][..], &now.units[1][..]) {
        ([_], [_]) => Some(parallel(strata, now.ends, step).unwrap_or(found)).filter(|_| is_at_least),
        // near a contact the derivatives of the distance D vanish as D^(3/2), so that rounding u L of them leaves D = u^(2/3) L
        _ => {
            let lengths = rounding / (256.0 * UNIT_ROUNDOFF);
            let tolerance = 16.0 * libm::cbrt(UNIT_ROUNDOFF * UNIT_ROUNDOFF) * lengths;
            is_at_least.then_some(Closest { tolerance, ..found })
        }
    }
}

/// The place near two points where the normals of two surfaces are parallel, which is accurate also where they touch; `None` without
/// convergence.
fn parallel(strata: &[Stratum<'_>; 2], near: [Vec3; 2], step: f64) -> Option<Closest> {
    let first = state(strata, near)?;
    let (mut ends, mut middle) = (first.ends, 0.5 * (first.ends[0] + first.ends[1]));
    // so that both normals point from the first point to the second
    let signs = match first.units[0][0].dot(ends[1] - ends[0]) {
        along if along < 0.0 => [-1.0, -first.units[0][0].dot(first.units[1][0]).signum()],
        _ => [1.0, first.units[0][0].dot(first.units[1][0]).signum()],
    };
    let mut best: Option<(f64, Closest)> = None;
    for _ in 0..STEPS {
        let now = state(strata, [middle, middle])?;
        ends = now.ends;
        let normals = [signs[0] * now.units[0][0], signs[1] * now.units[1][0]];
        let axis = (normals[0] + normals[1]).try_normalize()?;
        let side = axis.any_orthonormal_vector();
        let tangents = [side, axis.cross(side)];
        let turn = normals[1] - normals[0];
        let error = turn.length();
        let tolerance = strata[0].rounding(ends[0]).max(strata[1].rounding(ends[1]));
        let distance = (ends[1] - ends[0]).dot(axis);
        let found = Closest { ends, distance, tolerance, is_tangent: error <= RIGHT_ANGLE };
        if best.is_none_or(|(least, _)| error < least) {
            best = Some((error, found));
        } else {
            break;
        }
        if error <= 4.0 * UNIT_ROUNDOFF {
            break;
        }
        // the curvature of a surface is minus the bending along a unit way
        let bent = [0, 1]
            .map(|k| strata[k].bending(ends[k], &now.units[k], &tangents, signs[k] * now.units[k][0], step));
        let mut matrix = [[0.0; 4]; 4];
        for i in 0..2 {
            for j in 0..2 {
                matrix[i][j] = bent[1][i][j] - bent[0][i][j];
            }
            // a direction in which neither surface bends does not matter
            matrix[i][i] += 1e-12 / step;
        }
        let slope = [turn.dot(tangents[0]), turn.dot(tangents[1]), 0.0, 0.0];
        let Some(change) = solved(matrix, slope, 2) else { break };
        middle = 0.5 * (ends[0] + ends[1]) + change[0] * tangents[0] + change[1] * tangents[1];
    }
    let (error, found) = best?;
    let is_beside = |k: usize| (found.ends[k] - near[k]).length() <= 1e3 * step;
    (error <= RIGHT_ANGLE && is_beside(0) && is_beside(1)).then_some(found)
}

/// Solves a symmetric system of up to four equations; `None` if the matrix is not positive definite.
fn solved(mut matrix: [[f64; 4]; 4], mut right: [f64; 4], n: usize) -> Option<[f64; 4]> {
    for k in 0..n {
        let pivot = matrix[k][k];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return None;
        }
        for i in k + 1..n {
            let factor = matrix[i][k] / pivot;
            for j in k..n {
                matrix[i][j] -= factor * matrix[k][j];
            }
            right[i] -= factor * right[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| matrix[k][j] * right[j]).sum();
        right[k] = (right[k] - known) / matrix[k][k];
    }
    Some(right)
}
