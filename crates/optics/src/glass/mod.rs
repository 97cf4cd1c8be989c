//! Refractive indices by wavelength.
//!
//! [`Dispersion`] holds the formulas that makers of glass and papers use. Wavelengths are in nanometres at every door and
//! in micrometres inside the formulas, as in print.

mod dispersion;
mod spectrum;
mod table;

pub use dispersion::{Dispersion, DispersionError, RationalTerm, SellmeierTerm};
pub use spectrum::{SPECTRAL_LINES, SpectralLine, line_nm};
pub use table::Table;
