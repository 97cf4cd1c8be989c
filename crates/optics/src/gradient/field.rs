//! A gradient as light of one wavelength sees it.

use crate::gradient::Gradient;
use crate::gradient::profile::Local;
use rayweave_math::Vec3;

/// What the equation of motion is made of, for light of one wavelength in one medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalField<'a> {
    pub gradient: &'a Gradient,
    /// The index of the medium, which the gradient multiplies.
    pub index: f64,
    pub wavelength_nm: f64,
}

impl LocalField<'_> {
    /// The square of the index, and the acceleration of light in it: `n grad n`.
    pub fn at(&self, point: Vec3) -> Local {
        let Local { squared, force } = self.gradient.at(point, self.wavelength_nm);
        let factor = self.index * self.index;
        Local { squared: factor * squared, force: factor * force }
    }

    /// The index; NaN where there is none.
    pub fn index_at(&self, point: Vec3) -> f64 {
        self.at(point).squared.sqrt()
    }
}
