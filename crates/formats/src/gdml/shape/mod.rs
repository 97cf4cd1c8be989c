//! GDML solids from their dimensions in millimetres and degrees, independent of files.
//!
//! Each function names the corresponding class of Geant4; Geant4's Book For Application Developers, section 4.1.2, defines
//! the parameters. Adjacent parts of a solid share bit-identical planes, so there are no seams.

pub(super) mod extruded;
pub(super) mod faceted;
pub(super) mod round;
pub(super) mod twisted;

use super::attributes::{Failure, refused};
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_shape::primitive::{BoxFromCorners, CentredBox, Primitive, Wedge};

/// A solid, or the reason for a failure.
pub(super) type Made = Result<Solid, Failure>;

/// A sector around the z axis, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Phi {
    pub start: f64,
    pub delta: f64,
}

/// The angle from which Geant4 treats a sector as the full turn: less than 0.5e-9 rad is missing.
const WHOLE_TURN: f64 = 360.0 - 0.5e-9 * 180.0 / std::f64::consts::PI;

impl Phi {
    pub fn is_whole(self) -> bool {
        self.delta >= WHOLE_TURN
    }

    /// The part of a solid within the sector.
    pub fn cut(self, solid: Solid) -> Made {
        if self.is_whole() {
            return Ok(solid);
        }
        if self.delta <= 0.0 {
            return refused(format!("the sector of {} degrees is empty", self.delta));
        }
        Ok(solid & of(Wedge::new(self.start, self.delta)?))
    }
}

/// A primitive as a solid.
pub(super) fn of(primitive: impl Into<Primitive>) -> Solid {
    Solid::from(primitive.into())
}

/// Union of at least one solid.
pub(super) fn union_of(mut parts: Vec<Solid>, nothing: &str) -> Made {
    match parts.len() {
        0 => refused(nothing),
        1 => Ok(parts.remove(0)),
        _ => Ok(Solid::union(parts)),
    }
}

/// `G4Box`, with full lengths.
pub(super) fn cuboid(size: [f64; 3]) -> Made {
    Ok(of(CentredBox::new(Vec3::from_array(size))?))
}

/// A bounding box for a solid with its own side faces: exact in z, larger in x and y, so that its sides lie outside.
pub(super) fn loose_box(half_x: f64, half_y: f64, half_z: f64) -> Made {
    let corner = Vec3::new(1.25 * half_x, 1.25 * half_y, half_z);
    Ok(of(BoxFromCorners::new(-corner, corner)?))
}
