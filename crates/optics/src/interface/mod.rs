//! Physics of one interface: Snell's law, Fresnel equations, thin films, gratings and Stokes parameters.
//!
//! - [`reflect`] and [`refract`]: directions according to the law of reflection and Snell's law,
//!   with total internal reflection.
//! - [`diffract`]: the direction of an order of a diffraction grating.
//! - [`fresnel`]: amplitudes of reflection and transmission at a bare interface, including metals.
//! - [`transfer_matrix`]: the same with thin films (coatings) between the media.
//! - [`Stokes`]: the polarisation of a ray, and its change by diagonal Jones matrices.

mod fresnel;
mod grating;
mod polarisation;
mod snell;
mod thin_film;

pub use fresnel::{Amplitudes, fresnel};
pub use grating::diffract;
pub use polarisation::Stokes;
pub use snell::{reflect, refract};
pub use thin_film::{Film, transfer_matrix};
