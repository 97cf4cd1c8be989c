//! Light sources of a scene.

use crate::colour::Linear;
use crate::{RenderError, Rgba};
use rayweave_math::Vec3;

/// The kind of a light source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// A directional light along this vector, of any length but zero.
    Direction(Vec3),
    /// A point light, equally strong at every distance.
    Position(Vec3),
}

/// A light source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// The kind, with its direction or position.
    pub kind: LightKind,
    /// The intensity, at least 0: 1 makes a surface that faces the light as bright as its colour.
    pub intensity: f64,
    /// The colour; its opacity is ignored.
    pub colour: Rgba,
}

impl Light {
    /// A white directional light of intensity 1.
    pub fn along(direction: impl Into<Vec3>) -> Light {
        Light { kind: LightKind::Direction(direction.into()), intensity: 1.0, colour: Rgba::WHITE }
    }

    /// A white point light of intensity 1.
    pub fn at(position: impl Into<Vec3>) -> Light {
        Light { kind: LightKind::Position(position.into()), ..Light::along(Vec3::Z) }
    }

    /// The vector from a point to the light: to the position of a point light, of unit length for a
    /// directional one.
    pub(crate) fn towards(&self, point: Vec3) -> Vec3 {
        match self.kind {
            LightKind::Direction(direction) => -(direction / direction.abs().max_element()).normalize(),
            LightKind::Position(position) => position - point,
        }
    }

    /// The `t` at which a ray along [`Light::towards`] reaches the light.
    pub(crate) fn distance(&self) -> f64 {
        match self.kind {
            LightKind::Direction(_) => f64::INFINITY,
            LightKind::Position(_) => 1.0,
        }
    }

    /// The arriving light, per channel.
    pub(crate) fn strength(&self) -> Linear {
        self.colour.linear().map(|channel| channel * self.intensity as f32)
    }

    pub(crate) fn check(&self, index: usize) -> Result<(), RenderError> {
        let (vector, zero_is_legal) = match self.kind {
            LightKind::Direction(direction) => (direction, false),
            LightKind::Position(position) => (position, true),
        };
        let problem = match () {
            () if !vector.is_finite() => "a position or direction that is not finite",
            () if !zero_is_legal && vector == Vec3::ZERO => "a zero direction",
            () if !(0.0..f64::INFINITY).contains(&self.intensity) => {
                "an intensity that is negative or not finite"
            }
            () => return Ok(()),
        };
        Err(RenderError::Light { index, problem })
    }
}
