//! Candidates for the nearest boundary point: feet of perpendiculars, and points where surfaces meet.

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
        self.try_after(STEPS, from, is_inside, near, meeting, best);
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
        let mut point = near;
        let mut units = Vec::with_capacity(meeting.len());
        for _ in 0..steps {
            units.clear();
            let mut offsets = [0.0; 3];
            for (k, &number) in meeting.iter().enumerate() {
                let (value, gradient) = self.surface(number).value_and_gradient(point);
                let length = gradient.length();
                if !(length > 0.0 && value.is_finite()) {
                    return None;
                }
                units.push(gradient / length);
                // the signed distance of `from` from the tangent plane
                offsets[k] = value / length + units[k].dot(from - point);
            }
            point = from - combination(&units, offsets, INDEPENDENT)?;
        }
        point.is_finite().then_some((point, units))
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
