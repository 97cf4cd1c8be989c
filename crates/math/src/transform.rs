//! A placement with its inverse and the length of the way that leads there.

use crate::{Affine, SingularError};

/// An invertible affine map with its inverse, made once when a model is compiled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// From the inner frame to the outer one.
    pub world_from_local: Affine,
    /// From the outer frame to the inner one.
    pub local_from_world: Affine,
    /// The lengths of all translations composed on the way, in units of the outer frame: each of them was
    /// rounded, so tolerances must count them even where they cancel.
    pub path: f64,
}

impl Transform {
    /// The transform that changes nothing.
    pub const IDENTITY: Transform =
        Transform { world_from_local: Affine::IDENTITY, local_from_world: Affine::IDENTITY, path: 0.0 };

    /// From a composed map and the length of the translations in it.
    pub fn new(world_from_local: Affine, path: f64) -> Result<Transform, SingularError> {
        Ok(Transform { world_from_local, local_from_world: world_from_local.inverse()?, path })
    }

    /// From one map, whose own translation is the whole way.
    pub fn from_affine(world_from_local: Affine) -> Result<Transform, SingularError> {
        Transform::new(world_from_local, world_from_local.translation.length())
    }
}
