//! The equation of motion of light in a gradient, at one wavelength.

use crate::gradient::Gradient;
use crate::gradient::profile::Local;
use rayweave_math::Vec3;

/// The terms of the equation of motion for one medium and wavelength.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalField<'a> {
    pub gradient: &'a Gradient,
    /// The index of the medium, which the gradient multiplies.
    pub index: f64,
    pub wavelength_nm: f64,
}

impl LocalField<'_> {
    /// The square of the index at a point, and the acceleration of light there: `n grad n`.
    pub fn at(&self, point: Vec3) -> Local {
        let Local { squared, force } = self.gradient.at(point, self.wavelength_nm);
        let factor = self.index * self.index;
        Local { squared: factor * squared, force: factor * force }
    }

    /// The refractive index; NaN where the gradient has none.
    pub fn index_at(&self, point: Vec3) -> f64 {
        self.at(point).squared.sqrt()
    }
}
