//! Candidates for the nearest boundary point: feet of perpendiculars, and points where surfaces meet.

use super::feet::{feet, feet_on_curve};
use super::field::Field;
use rayweave_math::{Mat3, Vec3};
use rayweave_shape::surface::Surface;

/// The number of Newton steps towards a candidate; each doubles the number of correct digits.
const STEPS: usize = 8;

/// The determinants above which two and three normals are independent.
const INDEPENDENT: [f64; 2] = [1e-12, 1e-9];

/// A point on the other side of the boundary than the point from which distances are measured.
#[derive(Clone, Copy, Debug)]
pub struct Witness {
    /// Its distance: an upper bound of the distance from the boundary.
    pub distance: f64,
    pub beyond: Vec3,
    /// A known boundary point next to it.
    pub on: Option<Vec3>,
}

impl Witness {
    pub const NONE: Witness = Witness { distance: f64::INFINITY, beyond: Vec3::INFINITY, on: None };
}

impl Field {
    /// Tries the critical point of the distance where the given one to three surfaces meet, starting from `near`.
    pub(super) fn try_meeting(
        &self,
        from: Vec3,
        is_inside: bool,
        near: Vec3,
        meeting: &[u32],
        best: &mut Witness,
    ) {
        // the gradient of a mesh leads from its nearest point, also where that is on an edge: the first step is exact
        if let [single] = *meeting
            && matches!(self.surface(single), Surface::Object(_))
        {
            self.try_after(1, from, is_inside, from, meeting, best);
        }
        let closed_form = match *meeting {
            [single] => feet(self.surface(single), from, near),
            [a, b] => feet_on_curve(self.surface(a), self.surface(b), from, near),
            _ => Vec::new(),
        };
        for &foot in &closed_form {
            // the position of such a foot does not depend on the length of the way
            let step = 4.0 * self.rounding(foot);
            let units = self.unit_gradients(foot, meeting).map_or(Vec::new(), |(_, units)| units);
            self.try_foot(foot, &units, step, (from, is_inside), best);
        }
        if closed_form.is_empty() || near != from {
            self.try_after(STEPS, from, is_inside, near, meeting, best);
        }
    }

    /// Tries the point after a number of Newton steps.
    fn try_after(
        &self,
        steps: usize,
        from: Vec3,
        is_inside: bool,
        near: Vec3,
        meeting: &[u32],
        best: &mut Witness,
    ) {
        let Some((foot, gradients)) = self.meeting_point(steps, from, near, meeting) else { return };
        let step = 4.0 * self.rounding(from.abs().max(foot.abs()));
        self.try_foot(foot, &gradients, step, (from, is_inside), best);
    }

    /// Tries points at the distance `step` from a boundary point.
    fn try_foot(
        &self,
        foot: Vec3,
        gradients: &[Vec3],
        step: f64,
        (from, is_inside): (Vec3, bool),
        best: &mut Witness,
    ) {
        let length = (foot - from).length();
        if length - 2.0 * step >= best.distance {
            return;
        }
        let onwards = if length > 16.0 * step { (foot - from) / length } else { Vec3::ZERO };
        let mut try_towards = |direction: Vec3| {
            let beyond = foot + step * direction;
            let distance = (beyond - from).length();
            if distance < best.distance && self.is_inside(beyond) != is_inside {
                *best = Witness { distance, beyond, on: Some(foot) };
            }
        };
        try_towards(onwards);
        // into each sector between the surfaces
        for pattern in 0..1usize << gradients.len() {
            let sign = |k: usize| if pattern >> k & 1 == 0 { 1.0 } else { -1.0 };
            let into: Vec3 = gradients.iter().enumerate().map(|(k, &unit)| sign(k) * unit).sum();
            try_towards(into);
        }
    }

    /// Newton's method for the point nearest to `from` at which all surfaces are 0: each step solves the linearised problem.
    /// Returns the point and the unit gradients.
    fn meeting_point(
        &self,
        steps: usize,
        from: Vec3,
        near: Vec3,
        meeting: &[u32],
    ) -> Option<(Vec3, Vec<Vec3>)> {
        let (mut point, mut last) = (near, Vec::new());
        for _ in 0..steps {
            let (values, units) = self.unit_gradients(point, meeting)?;
            let mut offsets = [0.0; 3];
            for (k, unit) in units.iter().enumerate() {
                // the signed distance of `from` from the tangent plane
                offsets[k] = values[k] + unit.dot(from - point);
            }
            point = from - combination(&units, offsets, INDEPENDENT)?;
            last = units;
        }
        point.is_finite().then_some((point, last))
    }

    /// The quotients of value and length of the gradient, and the unit gradients, of up to three surfaces; `None` where a
    /// gradient is 0.
    fn unit_gradients(&self, point: Vec3, surfaces: &[u32]) -> Option<([f64; 3], Vec<Vec3>)> {
        let (mut values, mut units) = ([0.0; 3], Vec::with_capacity(surfaces.len()));
        for (k, &number) in surfaces.iter().enumerate() {
            let (value, gradient) = self.surface(number).value_and_gradient(point);
            let length = gradient.length();
            if !(length > 0.0 && value.is_finite()) {
                return None;
            }
            values[k] = value / length;
            units.push(gradient / length);
        }
        Some((values, units))
    }

    /// Narrows a witness down to the boundary: the point where the way to it leaves the side of `from`.
    pub(super) fn settled(&self, from: Vec3, is_inside: bool, best: Witness) -> Witness {
        if !best.distance.is_finite() {
            return best;
        }
        let step = 4.0 * self.rounding(from.abs().max(best.beyond.abs()));
        if let Some(foot) = best.on {
            let length = (foot - from).length();
            let before =
                if length > 2.0 * step { foot - (2.0 * step / length) * (foot - from) } else { from };
            if self.is_inside(before) == is_inside {
                return best;
            }
        }
        let (mut near, mut far) = (from, best.beyond);
        while (far - near).length() > 0.25 * step {
            let middle = 0.5 * near + 0.5 * far;
            if middle == near || middle == far {
                break;
            }
            match self.is_inside(middle) == is_inside {
                true => near = middle,
                false => far = middle,
            }
        }
        Witness { distance: (far - from).length(), beyond: far, on: Some(far) }
    }
}

/// The combination `sum x_k u_k` of unit vectors with given dot products `offsets_k` with them; `None` if they are nearly
/// dependent: the determinant of two, or of three, is at most that in `least`.
pub(crate) fn combination(units: &[Vec3], offsets: [f64; 3], least: [f64; 2]) -> Option<Vec3> {
    match *units {
        [a] => Some(offsets[0] * a),
        [a, b] => {
            let cosine = a.dot(b);
            let determinant = 1.0 - cosine * cosine;
            let (x, y) = (offsets[0] - cosine * offsets[1], offsets[1] - cosine * offsets[0]);
            (determinant > least[0]).then(|| (x * a + y * b) / determinant)
        }
        [a, b, c] => {
            let rows = Mat3::from_cols(a, b, c).transpose();
            (rows.determinant().abs() > least[1]).then(|| rows.inverse() * Vec3::from_array(offsets))
        }
        _ => None,
    }
}
