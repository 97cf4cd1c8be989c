//! Spectral lines (Fraunhofer lines) of glass data sheets.

/// A spectral line and the letter that glass makers give it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralLine {
    /// The letter, such as `d`.
    pub name: &'static str,
    /// The wavelength in air, in nanometres.
    pub wavelength_nm: f64,
}

const fn line(name: &'static str, wavelength_nm: f64) -> SpectralLine {
    SpectralLine { name, wavelength_nm }
}

/// The lines of ISO 7944 and of the makers' data sheets, from the ultraviolet to the infrared;
/// wavelengths in air, as in Schott's technical information TIE-29.
pub const SPECTRAL_LINES: &[SpectralLine] = &[
    line("i", 365.0146),
    line("h", 404.6561),
    line("g", 435.8343),
    line("F'", 479.9914),
    line("F", 486.1327),
    line("e", 546.0740),
    line("d", 587.5618),
    line("D", 589.2938),
    line("C'", 643.8469),
    line("C", 656.2725),
    line("r", 706.5188),
    line("s", 852.11),
    line("t", 1013.98),
];

pub(super) const F_NM: f64 = 486.1327;
pub(super) const D_NM: f64 = 587.5618;
pub(super) const C_NM: f64 = 656.2725;

/// The wavelength of a line in nanometres; `None` for an unknown letter. Letters are case-sensitive.
///
/// ```
/// use rayweave_optics::glass::line_nm;
/// assert_eq!(line_nm("d"), Some(587.5618));
/// assert_eq!(line_nm("D"), Some(589.2938));
/// ```
pub fn line_nm(name: &str) -> Option<f64> {
    SPECTRAL_LINES.iter().find(|line| line.name == name).map(|line| line.wavelength_nm)
}
