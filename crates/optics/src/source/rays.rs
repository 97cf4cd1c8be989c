//! Rays of sources as columns.

use crate::Light;
use rayweave_math::Vec3;
use rayweave_model::Rays;

/// Rays as columns of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SourceRays {
    /// The components of the origins, in the unit of the document.
    pub origins: [Vec<f64>; 3],
    /// The components of the directions, of unit length.
    pub directions: [Vec<f64>; 3],
    /// The wavelengths in nanometres.
    pub wavelength_nm: Vec<f64>,
    /// The powers, in the unit of the source. (PyRayT's intensity.)
    pub power: Vec<f64>,
    /// The numbers of the rays, counted through all sources.
    pub id: Vec<i64>,
    /// The numbers of their sources.
    pub source: Vec<i32>,
}

impl SourceRays {
    /// The number of rays.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// Origins and directions for an evaluator.
    pub fn rays(&self) -> Rays<'_> {
        let [ox, oy, oz] = &self.origins;
        let [dx, dy, dz] = &self.directions;
        Rays { origins: [ox, oy, oz], directions: [dx, dy, dz] }
    }

    /// Removes all rays and keeps the memory.
    pub fn clear(&mut self) {
        self.numbers().for_each(Vec::clear);
        self.id.clear();
        self.source.clear();
    }

    /// Appends a ray with its number.
    pub(super) fn push(&mut self, id: u64, light: &Light) {
        for axis in 0..3 {
            self.origins[axis].push(light.ray.origin[axis]);
            self.directions[axis].push(light.ray.direction[axis]);
        }
        self.wavelength_nm.push(light.wavelength_nm);
        self.power.push(light.power);
        self.id.push(id as i64);
        self.source.push(light.source as i32);
    }

    fn numbers(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let SourceRays { origins, directions, wavelength_nm, power, .. } = self;
        origins.iter_mut().chain(directions).chain([wavelength_nm, power])
    }
}

/// A ray in the frame of the source.
pub(super) struct LocalRay {
    pub origin: Vec3,
    /// Of unit length, up to rounding.
    pub direction: Vec3,
    /// The weight of its power.
    pub weight: f64,
}
