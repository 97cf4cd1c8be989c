//! Changes of frame between surfaces: what folds and tilts a system.

use super::resolved::{Pose, bad};
use super::{Prescription, PrescriptionError};
use rayweave_math::{Affine, Vec3};

/// A coordinate break: the surface behind it, and all that follow, lie in another frame than on the axis.
///
/// The frame in front of a break has its origin where the vertex of the surface would be, and z along the axis so far.
/// Thicknesses go on along the new z. First-order data do not know of breaks: they are those of the surfaces on one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateBreak {
    /// The surface that it is in front of, counted from 1; the image is one more than the last surface.
    pub before: usize,
    /// Coordinates in front of the break from those behind it: a rigid map.
    pub map: Affine,
}

impl CoordinateBreak {
    /// A decentre along x and y, then tilts in degrees about x, about the new y and about the new z, each right-handed: what
    /// Zemax's coordinate break does by default (OpticStudio user guide, Ansys, 2024 R2, "Coordinate Break").
    pub fn new(before: usize, decentre: [f64; 2], tilt_degrees: [f64; 3]) -> CoordinateBreak {
        let [x, y, z] = turns(tilt_degrees);
        let map = z.then(&y).then(&x).then(&shift(decentre));
        CoordinateBreak { before, map }
    }

    /// The tilts first, about z, the new y and the new x, then the decentre: with all signs changed the way back from
    /// [`CoordinateBreak::new`].
    pub fn tilts_first(before: usize, decentre: [f64; 2], tilt_degrees: [f64; 3]) -> CoordinateBreak {
        let [x, y, z] = turns(tilt_degrees);
        let map = shift(decentre).then(&x).then(&y).then(&z);
        CoordinateBreak { before, map }
    }
}

fn turns([x, y, z]: [f64; 3]) -> [Affine; 3] {
    [Affine::rotation(Vec3::X, x), Affine::rotation(Vec3::Y, y), Affine::rotation(Vec3::Z, z)]
}

fn shift([x, y]: [f64; 2]) -> Affine {
    Affine::translate(Vec3::new(x, y, 0.0))
}

impl Prescription {
    /// The same with a coordinate break behind those that it has.
    pub fn broken(mut self, at: CoordinateBreak) -> Prescription {
        self.breaks.push(at);
        self
    }

    /// Where all surfaces and the image are moved to from the axis; nothing if they are on it.
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
                return Err(PrescriptionError::NoSuch { what, number, count });
            }
            let scale = at.map.similarity().filter(|_| at.map.is_finite()).unwrap_or(f64::NAN);
            let is_mirrored =
                at.map.vector(Vec3::X).cross(at.map.vector(Vec3::Y)).dot(at.map.vector(Vec3::Z)) < 0.0;
            if is_mirrored || scale.is_nan() || (scale - 1.0).abs() > 1e-9 {
                let what = format!("the scale of the coordinate break in front of surface {}", at.before);
                return Err(bad(
                    what,
                    if is_mirrored { -scale } else { scale },
                    "1: decentres and tilts only",
                ));
            }
        }
        Ok(())
    }
}
