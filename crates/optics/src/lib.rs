//! Optics: what light does in the solids of a model.
//!
//! [`glass`] tells the refractive index of a material at a wavelength, [`component`] builds lenses, mirrors and prisms.

pub mod component;
pub mod glass;
