//! Refractive index of air as a function of temperature, pressure, humidity and carbon dioxide
//! content (Ciddor equation).
//!
//! P. E. Ciddor, "Refractive index of air: new equations for the visible and near infrared", Appl.
//! Opt. 35, 1566 (1996): the refractivities of dry air and of water vapour, each in proportion to
//! its density, and the densities by the BIPM equation of 1991 (R. S. Davis, Metrologia 29, 67
//! (1992)). Numbers of equations are Ciddor's.

use super::{Dispersion, Glass, GlassError};

/// The state of air. [`default`](Air::default) is Ciddor's standard air: dry, at 15 °C and 101 325
/// Pa, with 450 ppm of CO₂.
///
/// ```
/// use rayweave_optics::glass::Air;
/// # fn main() -> Result<(), rayweave_optics::glass::GlassError> {
/// let laboratory = Air { temperature_celsius: 20.0, relative_humidity: 0.5, ..Air::default() }.glass()?;
/// assert!((laboratory.index(633.0)? - 1.00027_137).abs() < 1e-7);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// From -40 to 100 °C.
    pub temperature_celsius: f64,
    /// From 0 to 140 000 Pa; Ciddor examined 80 000 to 120 000.
    pub pressure_pa: f64,
    /// From 0 to 1, relative to the saturation vapour pressure over liquid water.
    pub relative_humidity: f64,
    /// Parts of CO₂ in a million, from 0 to 2000.
    pub co2_ppm: f64,
}

impl Default for Air {
    fn default() -> Air {
        Air { temperature_celsius: 15.0, pressure_pa: 101_325.0, relative_humidity: 0.0, co2_ppm: 450.0 }
    }
}

/// The molar mass of water vapour in kg/mol.
const WATER_KG: f64 = 0.018015;
/// The molar gas constant in J/(mol K), as of the year of the paper.
const GAS_CONSTANT: f64 = 8.314510;
/// Ciddor's equations hold in this range of wavelengths.
const RANGE_NM: [f64; 2] = [300.0, 1690.0];

/// A mixture for the equation of density.
#[derive(Clone, Copy)]
struct Mixture {
    celsius: f64,
    pascal: f64,
    /// The mole fraction of water vapour.
    vapour: f64,
    /// The molar mass of dry air in kg/mol.
    dry_kg: f64,
}

impl Air {
    /// The air as a material with an absolute index and no absorption.
    ///
    /// # Errors
    /// [`GlassError::Air`] for a number outside the range of its field, or a vapour pressure above the
    /// total pressure.
    pub fn glass(&self) -> Result<Glass, GlassError> {
        let source = "P. E. Ciddor, Appl. Opt. 35, 1566-1573 (1996)";
        Glass::new("air", self.dispersion()?).with_source(source).with_range_nm(RANGE_NM)
    }

    /// The formula of the index.
    ///
    /// # Errors
    /// As for [`glass`](Air::glass).
    pub fn dispersion(&self) -> Result<Dispersion, GlassError> {
        self.check()?;
        let dry_kg = 1e-3 * (28.9635 + 12.011e-6 * (self.co2_ppm - 400.0));
        let here = Mixture {
            celsius: self.temperature_celsius,
            pascal: self.pressure_pa,
            vapour: self.vapour()?,
            dry_kg,
        };
        let standard_air = Mixture { celsius: 15.0, pascal: 101_325.0, vapour: 0.0, dry_kg };
        let standard_vapour = Mixture { celsius: 20.0, pascal: 1333.0, vapour: 1.0, dry_kg };
        // eq. 2: the refractivity of carbon dioxide
        let carbon = 1.0 + 0.534e-6 * (self.co2_ppm - 450.0);
        Ok(Dispersion::Air {
            dry: carbon * here.dry_density() / standard_air.dry_density(),
            vapour: here.vapour_density() / standard_vapour.vapour_density(),
        })
    }

    fn check(&self) -> Result<(), GlassError> {
        let ranges = [
            ("temperature in °C", self.temperature_celsius, [-40.0, 100.0]),
            ("pressure in Pa", self.pressure_pa, [0.0, 140_000.0]),
            ("relative humidity", self.relative_humidity, [0.0, 1.0]),
            ("content of CO2 in ppm", self.co2_ppm, [0.0, 2000.0]),
        ];
        match ranges.into_iter().find(|(_, value, [least, most])| !(least <= value && value <= most)) {
            None => Ok(()),
            Some((quantity, value, range)) => Err(GlassError::Air { quantity, value, range }),
        }
    }

    /// The mole fraction of water vapour (appendix A, step 4); the vapour pressure over water is
    /// that of Davis.
    fn vapour(&self) -> Result<f64, GlassError> {
        if self.relative_humidity == 0.0 {
            return Ok(0.0);
        }
        let celsius = self.temperature_celsius;
        let kelvin = celsius + 273.15;
        let saturated = libm::exp(
            1.2378847e-5 * kelvin * kelvin - 1.9121316e-2 * kelvin + 33.93711047 - 6.3431645e3 / kelvin,
        );
        let enhancement = 1.00062 + 3.14e-8 * self.pressure_pa + 5.6e-7 * celsius * celsius;
        let fraction = enhancement * self.relative_humidity * saturated / self.pressure_pa;
        if fraction <= 1.0 {
            return Ok(fraction);
        }
        let range = [0.0, self.relative_humidity / fraction];
        Err(GlassError::Air { quantity: "relative humidity", value: self.relative_humidity, range })
    }
}

impl Mixture {
    /// The density of its dry air in kg/m³ (eq. 4).
    fn dry_density(&self) -> f64 {
        self.moles() * self.dry_kg * (1.0 - self.vapour)
    }

    /// The density of its vapour in kg/m³.
    fn vapour_density(&self) -> f64 {
        self.moles() * WATER_KG * self.vapour
    }

    /// Moles per cubic metre.
    fn moles(&self) -> f64 {
        self.pascal / (self.compressibility() * GAS_CONSTANT * (self.celsius + 273.15))
    }

    /// Z (eq. 12).
    fn compressibility(&self) -> f64 {
        let (t, x) = (self.celsius, self.vapour);
        let ratio = self.pascal / (t + 273.15);
        let first = 1.58123e-6 - 2.9331e-8 * t + 1.1043e-10 * t * t;
        let second = (5.707e-6 - 2.051e-8 * t) * x + (1.9898e-4 - 2.376e-6 * t) * x * x;
        1.0 - ratio * (first + second) + ratio * ratio * (1.83e-11 - 0.765e-8 * x * x)
    }
}
