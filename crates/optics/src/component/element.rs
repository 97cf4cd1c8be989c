//! Solids between two surfaces of revolution inside an aperture: lenses, windows and substrates of mirrors.

use super::face::{Face, steps};
use super::{Aperture, ComponentError};
use rayweave_model::Solid;

/// Two surfaces with material between them.
pub(super) struct Element {
    /// The component, for messages.
    pub part: &'static str,
    pub front: Face,
    pub back: Face,
    pub aperture: Aperture,
    /// The centre of the aperture.
    pub centre: [f64; 2],
}

impl Element {
    /// The solid, with leaves named as the faces and `edge`.
    pub fn build(&self) -> Result<Solid, ComponentError> {
        let reach = self.checked_reach()?;
        let (front, back) = (self.front.over(reach), self.back.over(reach));
        let (low, high) = (front.range(reach)[0], back.range(reach)[1]);
        let margin = 0.25 * (high - low).max(reach);
        // the column ends outside the material, where it bounds nothing
        let ends = [front.floor(low, margin), back.ceiling(high, margin)];
        let edge = self.aperture.column(self.centre, ends)?.named("edge");
        Ok(Solid::intersection([front.beyond(ends[1])?, back.before(ends[0])?, edge]))
    }

    /// The extent of the aperture, if both surfaces extend that far and do not cross inside it.
    fn checked_reach(&self) -> Result<f64, ComponentError> {
        let reach = self.reach()?;
        for face in [&self.front, &self.back] {
            let limit = face.profile.limit();
            if reach > limit {
                let (part, surface) = (self.part, face.name);
                return Err(ComponentError::ApertureTooLarge { part, surface, reach, limit });
            }
        }
        match self.crossing(reach) {
            None => Ok(reach),
            Some(height) => Err(ComponentError::SurfacesCross {
                part: self.part,
                first: self.front.name.to_owned(),
                second: self.back.name.to_owned(),
                height,
                reach,
            }),
        }
    }

    /// The greatest distance from the axis, or from the plane x = 0 if the surfaces are curved along x only.
    fn reach(&self) -> Result<f64, ComponentError> {
        let aperture = self.aperture.checked()?;
        Ok(match self.front.profile.cylindrical || self.back.profile.cylindrical {
            true => self.centre[0].abs() + 0.5 * aperture.size()[0],
            false => aperture.reach(self.centre),
        })
    }

    /// The thickness `height` away from the axis.
    fn gap(&self, height: f64) -> f64 {
        self.back.z(height).unwrap_or(0.0) - self.front.z(height).unwrap_or(0.0)
    }

    /// The distance from the axis at which the surfaces cross, if that is less than `reach`.
    fn crossing(&self, reach: f64) -> Option<f64> {
        // a sharp edge is allowed; a negative thickness within rounding is not a crossing
        let rounding = 1e-13 * (reach + self.gap(0.0).abs());
        let heights: Vec<f64> = match self.front.profile.has_terms() || self.back.profile.has_terms() {
            true => steps(reach).collect(),
            false => vec![0.0, self.turning(reach).unwrap_or(reach), reach],
        };
        let wrong = heights.iter().position(|&height| self.gap(height) < -rounding)?;
        let (mut good, mut bad) = (heights[wrong.saturating_sub(1)], heights[wrong]);
        for _ in 0..80 {
            let middle = 0.5 * (good + bad);
            if self.gap(middle) < 0.0 { bad = middle } else { good = middle }
        }
        Some(bad)
    }

    /// The distance from the axis of an extremum of the thickness, if inside `reach`: the slopes of
    /// both surfaces, `h / sqrt(R^2 - (1 + k) h^2)` with the sign of R, are equal at h^2 = (R1^2 -
    /// R2^2) / (k1 - k2).
    fn turning(&self, reach: f64) -> Option<f64> {
        let (a, b) = (self.front.profile, self.back.profile);
        let square = (a.radius * a.radius - b.radius * b.radius) / (a.conic - b.conic);
        let height = square.sqrt();
        (height > 0.0 && height < reach).then_some(height)
    }
}
