//! Export of scenes to POV-Ray 3.7. The README in this folder lists the supported features and
//! the losses.
//!
//! Language: "POV-Ray 3.7.0 Reference Documentation", Persistence of Vision Raytracer Pty. Ltd., 2013.

mod shape;
mod write;

pub use write::{PovRay, PovRayError};

use crate::scene::Scene;

impl Scene {
    /// Converts the scene to the language of POV-Ray 3.7; the README of `formats/povray` documents
    /// the conversion.
    ///
    /// # Errors
    /// [`PovRayError`]: a singular transform, or a scene whose text would be too large.
    pub fn to_povray(&self) -> Result<PovRay, PovRayError> {
        write::write(self)
    }
}
