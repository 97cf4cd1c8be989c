//! Lights of a scene.

use crate::colour::Linear;
use crate::{RenderError, Rgba};
use rayweave_math::Vec3;

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Parallel light that travels along this vector; of any length but zero.
    Direction(Vec3),
    /// Light from this point, equally strong at every distance.
    Position(Vec3),
}

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where it comes from.
    pub kind: LightKind,
    /// How strong it is: 1 makes a surface that faces it as bright as its colour. At least 0.
    pub intensity: f64,
    /// Its colour; the opacity counts for nothing.
    pub colour: Rgba,
}

impl Light {
    /// White light of intensity 1 that travels along a vector.
    pub fn along(direction: impl Into<Vec3>) -> Light {
        Light { kind: LightKind::Direction(direction.into()), intensity: 1.0, colour: Rgba::WHITE }
    }

    /// White light of intensity 1 from a point.
    pub fn at(position: impl Into<Vec3>) -> Light {
        Light { kind: LightKind::Position(position.into()), ..Light::along(Vec3::Z) }
    }

    /// The vector from a point to the light: all the way to a position, of unit length towards a direction.
    pub(crate) fn towards(&self, point: Vec3) -> Vec3 {
        match self.kind {
            LightKind::Direction(direction) => -(direction / direction.abs().max_element()).normalize(),
            LightKind::Position(position) => position - point,
        }
    }

    /// The time at which a ray along [`Light::towards`] reaches the light.
    pub(crate) fn distance(&self) -> f64 {
        match self.kind {
            LightKind::Direction(_) => f64::INFINITY,
            LightKind::Position(_) => 1.0,
        }
    }

    /// What arrives, per channel.
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
            () if !zero_is_legal && vector == Vec3::ZERO => "the direction zero",
            () if !(0.0..f64::INFINITY).contains(&self.intensity) => {
                "an intensity that is negative or not finite"
            }
            () => return Ok(()),
        };
        Err(RenderError::Light { index, problem })
    }
}
