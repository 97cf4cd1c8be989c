//! Glasses, crystals, liquids and metals: refractive index and absorption as functions of wavelength.
//!
//! - [`glass`](fn@glass) returns a material of the built-in [`Catalogue`] by name; [`glasses`]
//!   returns all of them.
//! - [`Glass`] provides index, extinction coefficient, absorption and transmittance, and rejects
//!   wavelengths outside its data.
//! - [`Air`] is air of any temperature, pressure and humidity.
//! - [`Dispersion`] provides the formulas of glass makers and papers: Sellmeier, Schott, Cauchy,
//!   Conrady and others.
//! - [`read_agf`] and [`read_refractiveindex`] read AGF catalogues and files of refractiveindex.info.
//!
//! Wavelengths are in nanometres in the interface and in micrometres inside the formulas, as in the
//! literature. Absorption lengths are in millimetres.

mod agf;
mod air;
mod catalogue;
mod dispersion;
mod error;
mod material;
mod read;
mod refractivity;
mod spectrum;
mod table;
mod yaml;

pub use agf::{decode_text, read_agf};
pub use air::Air;
pub use catalogue::{Catalogue, glass, glasses};
pub use dispersion::{Dispersion, RationalTerm, SellmeierTerm};
pub use error::{DispersionError, GlassError};
pub use material::{ComplexIndex, Glass, Published, Transmittance};
pub use read::{FileProblem, GlassFileError};
pub use spectrum::{SPECTRAL_LINES, SpectralLine, line_nm};
pub use table::Table;
pub use yaml::read_refractiveindex;
