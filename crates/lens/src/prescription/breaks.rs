//! Poses of the surfaces behind coordinate breaks.

use super::error::bad;
use super::pose::Pose;
use super::{CoordinateBreak, Prescription, PrescriptionError};
use rayweave_math::{Affine, Vec3};

impl Prescription {
    /// Adds a coordinate break after the existing ones.
    pub fn broken(mut self, at: CoordinateBreak) -> Prescription {
        self.breaks.push(at);
        self
    }

    /// The poses of all surfaces and the image; empty if all are on the axis.
    pub(super) fn poses(&self, vertices: &[f64]) -> Vec<Pose> {
        let mut axis = Affine::IDENTITY;
        let places = if self.breaks.is_empty() { &[] } else { vertices };
        let pose = |(k, &vertex): (usize, &f64)| {
            let vertex = Vec3::Z * vertex;
            for at in self.breaks.iter().filter(|at| at.before == k + 1) {
                let map = Affine::translate(-vertex).then(&at.map).then(&Affine::translate(vertex));
                axis = map.then(&axis);
            }
            Pose::new(axis)
        };
        places.iter().enumerate().map(pose).collect()
    }

    pub(super) fn check_breaks(&self) -> Result<(), PrescriptionError> {
        let count = self.surfaces.len() + 1;
        for at in &self.breaks {
            if !(1..=count).contains(&at.before) {
                let (what, number) = ("surface behind a coordinate break", at.before);
                return Err(PrescriptionError::NoSuch { what, number, first: 1, last: count });
            }
            let scale = at.map.similarity().filter(|_| at.map.is_finite()).unwrap_or(f64::NAN);
            let is_mirrored =
                at.map.vector(Vec3::X).cross(at.map.vector(Vec3::Y)).dot(at.map.vector(Vec3::Z)) < 0.0;
            if is_mirrored || scale.is_nan() || (scale - 1.0).abs() > 1e-9 {
                let what = format!("the scale of the coordinate break in front of surface {}", at.before);
                return Err(bad(
                    what,
                    if is_mirrored { -scale } else { scale },
                    "1, because a break only shifts and rotates",
                ));
            }
        }
        Ok(())
    }
}
