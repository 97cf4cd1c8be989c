//! Export of scenes to POV-Ray 3.7. The README in this folder lists the supported features and
//! the losses.
//!
//! Language: "POV-Ray 3.7.0 Reference Documentation", Persistence of Vision Raytracer Pty. Ltd., 2013.

mod shape;
mod write;

pub use write::{PovRay, PovRayError};

use crate::scene::Scene;

impl Scene {
    /// Converts the scene to the scene description language of POV-Ray 3.7. The README of
    /// `formats/povray` documents the conversion.
    ///
    /// # Errors
    /// [`PovRayError`]: a singular transform, a face that no POV-Ray object can represent, or a region
    /// with too many parts.
    pub fn to_povray(&self) -> Result<PovRay, PovRayError> {
        write::write(self)
    }
}
