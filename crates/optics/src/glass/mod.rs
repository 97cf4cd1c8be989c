//! Glasses, crystals, liquids and metals: refractive index and absorption by wavelength.
//!
//! - [`glass`](fn@glass) finds a material of the built-in [`Catalogue`] by name; [`glasses`] lists all of them.
//! - [`Glass`] tells index, extinction coefficient, absorption and transmittance, and refuses wavelengths that its data do not reach.
//! - [`Air`] is air of any temperature, pressure and humidity.
//! - [`Dispersion`] holds the formulas that makers of glass and papers use.
//! - [`read_agf`] and [`read_refractiveindex`] read the files in which such data are published.
//!
//! Wavelengths are in nanometres at every door and in micrometres inside the formulas, as in print. Lengths along which light is
//! absorbed are in millimetres.

mod agf;
mod air;
mod catalogue;
mod dispersion;
mod error;
mod material;
mod read;
mod spectrum;
mod table;
mod yaml;

pub(crate) use agf::decode;
pub use agf::read_agf;
pub use air::Air;
pub use catalogue::{Catalogue, glass, glasses};
pub use dispersion::{Dispersion, DispersionError, RationalTerm, SellmeierTerm};
pub use error::GlassError;
pub use material::{ComplexIndex, Glass, Published, Transmittance};
pub use read::{Problem, ReadError};
pub use spectrum::{SPECTRAL_LINES, SpectralLine, line_nm};
pub use table::Table;
pub use yaml::read_refractiveindex;
