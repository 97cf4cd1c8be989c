//! Materials: refractive index, absorption and range of validity.

use std::f64::consts::PI;
use std::sync::Arc;

use super::spectrum::{C_NM, D_NM, F_NM};
use super::{Dispersion, DispersionError, GlassError, Table};

/// A complex refractive index n + i k.
///
/// A plane wave goes as exp(i (2π/λ)(n + i k) z - iωt), so that a positive k absorbs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComplexIndex {
    /// The refractive index.
    pub n: f64,
    /// The extinction coefficient.
    pub k: f64,
}

/// An internal transmittance: the transmitted fraction without the losses at both faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmittance {
    /// In nanometres.
    pub wavelength_nm: f64,
    /// From 0 to 1.
    pub transmittance: f64,
    /// The thickness of the sample in millimetres.
    pub thickness_mm: f64,
}

/// Index and Abbe number at the d line as stated by a maker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published {
    /// The index at 587.5618 nm.
    pub n_d: f64,
    /// V_d = (n_d - 1)/(n_F - n_C).
    pub v_d: f64,
}

/// A material with its refractive index as a function of wavelength: a glass, a crystal, a liquid, a metal.
///
/// It is cheap to clone. Glass makers state indices relative to air of about 1013 hPa at 20 to 25
/// °C: use the index 1 around a lens made of such glasses, and `air` only where all indices are
/// absolute. Papers state either kind; the two differ by the factor 1.00027, the index of air, and
/// [`source`](Glass::source) gives the reference.
///
/// ```
/// use rayweave_optics::glass::glass;
/// # fn main() -> Result<(), rayweave_optics::glass::GlassError> {
/// let bk7 = glass("N-BK7")?;
/// assert!((bk7.index(587.5618)? - 1.51680).abs() < 1e-5);
/// assert!(bk7.internal_transmittance(365.0, 25.0)? > 0.96);
/// assert_eq!(
///     bk7.index(200.0).unwrap_err().to_string(),
///     "N-BK7 has no refractive index at 200 nm: its data range from 300 nm to 2500 nm. Use extrapolated().",
/// );
/// assert!(bk7.extrapolated().index(200.0).is_ok());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Glass {
    data: Arc<Data>,
    extrapolated: bool,
}

#[derive(Clone, Debug, PartialEq)]
struct Data {
    name: String,
    aliases: Vec<String>,
    maker: String,
    source: String,
    published: Option<Published>,
    dispersion: Dispersion,
    range_nm: [f64; 2],
    extinction: Option<Table>,
}

/// Constructors.
impl Glass {
    /// A transparent material. Its range is unlimited, or that of a table.
    pub fn new(name: impl Into<String>, dispersion: Dispersion) -> Glass {
        let range_nm = match &dispersion {
            Dispersion::Tabulated(table) => table.range_nm(),
            _ => [0.0, f64::INFINITY],
        };
        let data = Data {
            name: name.into(),
            aliases: Vec::new(),
            maker: String::new(),
            source: String::new(),
            published: None,
            dispersion,
            range_nm,
            extinction: None,
        };
        Glass { data: Arc::new(data), extrapolated: false }
    }

    fn changed(mut self, change: impl FnOnce(&mut Data)) -> Glass {
        change(Arc::make_mut(&mut self.data));
        self
    }

    /// Sets alternative names.
    pub fn with_aliases(self, aliases: Vec<String>) -> Glass {
        self.changed(|data| data.aliases = aliases)
    }

    /// Sets the maker.
    pub fn with_maker(self, maker: impl Into<String>) -> Glass {
        self.changed(|data| data.maker = maker.into())
    }

    /// Sets the reference of the data.
    pub fn with_source(self, source: impl Into<String>) -> Glass {
        self.changed(|data| data.source = source.into())
    }

    /// Sets index and Abbe number as stated by the maker.
    pub fn with_published(self, published: Published) -> Glass {
        self.changed(|data| data.published = Some(published))
    }

    /// Sets the range of wavelengths of the index in nanometres, ends included.
    ///
    /// # Errors
    /// [`GlassError::Range`] for a range that is negative, decreasing or NaN.
    pub fn with_range_nm(self, range_nm: [f64; 2]) -> Result<Glass, GlassError> {
        if !(range_nm[0] >= 0.0 && range_nm[1] >= range_nm[0]) {
            return Err(GlassError::Range { glass: self.data.name.clone(), range_nm });
        }
        Ok(self.changed(|data| data.range_nm = range_nm))
    }

    /// Sets extinction coefficients by wavelength.
    ///
    /// # Errors
    /// [`GlassError::Extinction`] for a negative coefficient.
    pub fn with_extinction(self, extinction: Table) -> Result<Glass, GlassError> {
        if let Some((wavelength_nm, value)) = extinction.pairs().find(|&(_, k)| k < 0.0) {
            return Err(GlassError::Extinction { glass: self.data.name.clone(), wavelength_nm, value });
        }
        Ok(self.changed(|data| data.extinction = Some(extinction)))
    }

    /// Sets extinction coefficients from internal transmittances τ: k = -λ ln τ/(4π d) for the
    /// thickness d (Beer-Lambert law).
    ///
    /// If there are several thicknesses at one wavelength, the transmittance nearest to 1/e is
    /// used, which is the most accurate. A transmittance of 0, which makers print for values below
    /// their resolution, counts as 1e-5.
    ///
    /// # Errors
    /// [`GlassError`] for a transmittance out of range, a thickness or wavelength that is not
    /// positive, or an empty list.
    pub fn with_transmittances(self, measured: &[Transmittance]) -> Result<Glass, GlassError> {
        measured.iter().try_for_each(Transmittance::check)?;
        let mut best: Vec<Transmittance> = measured.to_vec();
        let order = |a: &Transmittance, b: &Transmittance| {
            a.wavelength_nm.total_cmp(&b.wavelength_nm).then(a.inaccuracy().total_cmp(&b.inaccuracy()))
        };
        best.sort_by(order);
        best.dedup_by_key(|measured| measured.wavelength_nm);
        let pairs = best.iter().map(|measured| (measured.wavelength_nm, measured.extinction())).collect();
        self.with_extinction(Table::new(pairs)?)
    }

    /// The material with an index that is larger by the same amount at all wavelengths. The amount follows its name, such as
    /// `N-BK7 -0.01000`; without an amount it is the same material.
    pub fn shifted(&self, by: f64) -> Glass {
        if by == 0.0 {
            return self.clone();
        }
        let (law, before) = match &self.data.dispersion {
            Dispersion::Shifted { law, by } => (law.clone(), *by),
            other => (Box::new(other.clone()), 0.0),
        };
        let name = self.data.name.strip_suffix(&shift_text(before)).unwrap_or(&self.data.name);
        let (name, by) = (format!("{name}{}", shift_text(before + by)), before + by);
        self.clone().changed(|data| {
            data.name = name;
            data.dispersion = Dispersion::Shifted { law, by };
            data.aliases = Vec::new();
            data.published = None;
        })
    }

    /// The material extrapolated beyond its range: by its formula where that has a value, or by the
    /// value at the nearest end of its table. The accuracy is unknown.
    pub fn extrapolated(&self) -> Glass {
        Glass { extrapolated: true, ..self.clone() }
    }
}

/// The end of the name of a material whose index is shifted.
fn shift_text(by: f64) -> String {
    format!(" {by:+.5}")
}

/// The transmittance that replaces a 0 in a table.
const OPAQUE: f64 = 1e-5;

impl Transmittance {
    /// Checks that the numbers are in range.
    pub(super) fn check(&self) -> Result<(), GlassError> {
        let &Transmittance { wavelength_nm, transmittance, thickness_mm } = self;
        let positive = |value: f64| value > 0.0 && value.is_finite();
        if (0.0..=1.0).contains(&transmittance) && positive(thickness_mm) && positive(wavelength_nm) {
            return Ok(());
        }
        Err(GlassError::Transmittance { wavelength_nm, transmittance, thickness_mm })
    }

    /// The optical depth -ln τ, at least 0.
    fn depth(&self) -> f64 {
        -libm::log(self.transmittance.max(OPAQUE)) + 0.0
    }

    /// The distance of the optical depth from 1, where a measurement of the absorption is most accurate.
    fn inaccuracy(&self) -> f64 {
        (self.depth() - 1.0).abs()
    }

    fn extinction(&self) -> f64 {
        self.wavelength_nm * 1e-6 * self.depth() / (4.0 * PI * self.thickness_mm)
    }
}

/// Data.
impl Glass {
    /// The name, in the spelling of its maker.
    pub fn name(&self) -> &str {
        &self.data.name
    }

    /// Alternative names.
    pub fn aliases(&self) -> &[String] {
        &self.data.aliases
    }

    /// The maker; empty for natural materials.
    pub fn maker(&self) -> &str {
        &self.data.maker
    }

    /// The reference of the data.
    pub fn source(&self) -> &str {
        &self.data.source
    }

    /// Index and Abbe number as stated by the maker.
    pub fn published(&self) -> Option<Published> {
        self.data.published
    }

    /// The formula or the table of the index.
    pub fn dispersion(&self) -> &Dispersion {
        &self.data.dispersion
    }

    /// The range of wavelengths of the index in nanometres, ends included.
    pub fn range_nm(&self) -> [f64; 2] {
        self.data.range_nm
    }

    /// The range of wavelengths of the extinction coefficient in nanometres; `None` where it is
    /// unknown and counts as 0.
    pub fn extinction_range_nm(&self) -> Option<[f64; 2]> {
        self.data.extinction.as_ref().map(Table::range_nm)
    }
}

/// Optical properties.
impl Glass {
    /// The refractive index n at a wavelength in nanometres.
    ///
    /// # Errors
    /// [`GlassError`] for a wavelength that is not positive and finite, or outside the data.
    pub fn index(&self, wavelength_nm: f64) -> Result<f64, GlassError> {
        self.check("refractive index", wavelength_nm, self.data.range_nm)?;
        self.data.dispersion.index(wavelength_nm).ok_or_else(|| {
            let glass = self.data.name.clone();
            GlassError::NoIndex { glass, wavelength_nm }
        })
    }

    /// The extinction coefficient k at a wavelength in nanometres; 0 for a material of unknown absorption.
    ///
    /// # Errors
    /// [`GlassError`] for a wavelength that is not positive and finite, or outside the data.
    pub fn extinction(&self, wavelength_nm: f64) -> Result<f64, GlassError> {
        let range_nm = self.extinction_range_nm().unwrap_or([0.0, f64::INFINITY]);
        self.check("extinction coefficient", wavelength_nm, range_nm)?;
        Ok(self.data.extinction.as_ref().map_or(0.0, |table| table.at(wavelength_nm)))
    }

    /// The complex index n + i k at a wavelength in nanometres.
    ///
    /// # Errors
    /// As for [`index`](Glass::index) and [`extinction`](Glass::extinction).
    pub fn complex_index(&self, wavelength_nm: f64) -> Result<ComplexIndex, GlassError> {
        Ok(ComplexIndex { n: self.index(wavelength_nm)?, k: self.extinction(wavelength_nm)? })
    }

    /// The absorption coefficient α = 4πk/λ at a wavelength in nanometres, per millimetre: a length
    /// of d millimetres transmits the fraction exp(-α d) (Beer-Lambert law).
    ///
    /// # Errors
    /// As for [`extinction`](Glass::extinction).
    pub fn absorption_per_mm(&self, wavelength_nm: f64) -> Result<f64, GlassError> {
        Ok(4.0 * PI * self.extinction(wavelength_nm)? / (wavelength_nm * 1e-6))
    }

    /// The internal transmittance: the fraction that a thickness in millimetres transmits, without
    /// losses at faces.
    ///
    /// # Errors
    /// A thickness that is negative or NaN; otherwise as for [`extinction`](Glass::extinction).
    pub fn internal_transmittance(&self, wavelength_nm: f64, thickness_mm: f64) -> Result<f64, GlassError> {
        if thickness_mm.is_nan() || thickness_mm < 0.0 {
            return Err(GlassError::Thickness(thickness_mm));
        }
        let absorption = self.absorption_per_mm(wavelength_nm)?;
        // avoids 0 times infinity
        Ok(if absorption == 0.0 { 1.0 } else { libm::exp(-absorption * thickness_mm) })
    }

    /// The Abbe number V_d = (n_d - 1)/(n_F - n_C) of the formula.
    ///
    /// # Errors
    /// [`GlassError`] if one of the lines d, F, C is outside the data.
    pub fn abbe_number(&self) -> Result<f64, GlassError> {
        Ok((self.index(D_NM)? - 1.0) / (self.index(F_NM)? - self.index(C_NM)?))
    }

    fn check(
        &self,
        quantity: &'static str,
        wavelength_nm: f64,
        range_nm: [f64; 2],
    ) -> Result<(), GlassError> {
        if !(wavelength_nm > 0.0 && wavelength_nm.is_finite()) {
            return Err(GlassError::Wavelength(wavelength_nm));
        }
        let inside = range_nm[0] <= wavelength_nm && wavelength_nm <= range_nm[1];
        if inside || self.extrapolated {
            return Ok(());
        }
        Err(GlassError::OutOfRange { glass: self.data.name.clone(), quantity, wavelength_nm, range_nm })
    }
}

/// A material from its index at the d line and its Abbe number; see [`Dispersion::from_abbe`].
impl Glass {
    /// A material with the name `n_d/v_d`, such as `1.5168/64.17`.
    ///
    /// # Errors
    /// As for [`Dispersion::from_abbe`].
    pub fn from_abbe(n_d: f64, v_d: f64) -> Result<Glass, DispersionError> {
        let dispersion = Dispersion::from_abbe(n_d, v_d)?;
        Ok(Glass::new(format!("{n_d}/{v_d}"), dispersion).with_published(Published { n_d, v_d }))
    }
}
