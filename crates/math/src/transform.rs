//! Invertible affine maps (placements) with their inverse and the rounding that their translations add.

use crate::{Affine, SingularError};

/// An invertible affine map with its inverse, computed once when a model is compiled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Maps from the inner frame to the outer one.
    pub world_from_local: Affine,
    /// Maps from the outer frame to the inner one.
    pub local_from_world: Affine,
    /// The sum of the lengths of all composed translations, in units of the outer frame. Each of them was rounded, so
    /// tolerances count them even where they cancel.
    pub path: f64,
}

impl Transform {
    /// The identity.
    pub const IDENTITY: Transform =
        Transform { world_from_local: Affine::IDENTITY, local_from_world: Affine::IDENTITY, path: 0.0 };

    /// Inverts a composed map; `path` is the sum of the lengths of its translations.
    ///
    /// # Errors
    /// [`SingularError`] if the map has no usable inverse.
    pub fn new(world_from_local: Affine, path: f64) -> Result<Transform, SingularError> {
        Ok(Transform { world_from_local, local_from_world: world_from_local.inverse()?, path })
    }

    /// Inverts a single map; `path` is the length of its translation.
    ///
    /// # Errors
    /// [`SingularError`] if the map has no usable inverse.
    pub fn from_affine(world_from_local: Affine) -> Result<Transform, SingularError> {
        Transform::new(world_from_local, world_from_local.translation.length())
    }
}
