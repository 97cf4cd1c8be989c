//! Scenes for POV-Ray 3.7, written only: its dialect, and what gets lost, are in the README beside this file.
//!
//! Language: "POV-Ray 3.7.0 Reference Documentation", Persistence of Vision Raytracer Pty. Ltd., 2013.

mod shape;
mod write;

pub use write::{PovRay, PovRayError};

use crate::scene::Scene;

impl Scene {
    /// The scene in the language of POV-Ray 3.7; the README of `formats/povray` says what becomes of what.
    ///
    /// # Errors
    /// [`PovRayError`]: a singular transform, or a scene so full of copies that the text would not end.
    pub fn to_povray(&self) -> Result<PovRay, PovRayError> {
        write::write(self)
    }
}
