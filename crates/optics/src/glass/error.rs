//! Why a material gives no answer.

use super::DispersionError;

/// Why a material gives no answer or cannot be built, as "problem (why) suggestion?".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GlassError {
    /// The data do not reach the wavelength.
    #[error(
        "{glass} has no {quantity} at {wavelength_nm} nm (its data hold from {} nm to {} nm) extrapolate it?",
        range_nm[0],
        range_nm[1]
    )]
    OutOfRange {
        /// The name of the material.
        glass: String,
        /// `refractive index` or `extinction coefficient`.
        quantity: &'static str,
        /// What was asked for, in nanometres.
        wavelength_nm: f64,
        /// What the data reach, in nanometres.
        range_nm: [f64; 2],
    },
    /// There is no light of this wavelength.
    #[error("the wavelength is {0} nm (a wavelength is greater than 0 and finite) is it in nanometres?")]
    Wavelength(f64),
    /// The formula gives no real index.
    #[error(
        "{glass} has no refractive index at {wavelength_nm} nm (its formula gives no positive number there)"
    )]
    NoIndex {
        /// The name of the material.
        glass: String,
        /// In nanometres.
        wavelength_nm: f64,
    },
    /// Nothing has this name.
    #[error("no glass is named {name:?} (the catalogue has {count} of them){}", did_you_mean(suggestions))]
    Unknown {
        /// What was asked for.
        name: String,
        /// How many glasses the catalogue has.
        count: usize,
        /// The names most like it, at most three.
        suggestions: Vec<String>,
    },
    /// A range of wavelengths is none.
    #[error(
        "the range of {glass} is {} nm to {} nm (it begins above 0, ends later and is no NaN)",
        range_nm[0],
        range_nm[1]
    )]
    Range {
        /// The name of the material.
        glass: String,
        /// What was given, in nanometres.
        range_nm: [f64; 2],
    },
    /// An extinction coefficient would make light grow.
    #[error("the extinction coefficient of {glass} is {value} at {wavelength_nm} nm (it is at least 0)")]
    Extinction {
        /// The name of the material.
        glass: String,
        /// In nanometres.
        wavelength_nm: f64,
        /// What was given.
        value: f64,
    },
    /// A transmittance is none, or is measured through nothing.
    #[error(
        "the internal transmittance is {transmittance} through {thickness_mm} mm at {wavelength_nm} nm (it is from 0 to 1, \
         through a thickness greater than 0) is it in per cent?"
    )]
    Transmittance {
        /// In nanometres.
        wavelength_nm: f64,
        /// What was given.
        transmittance: f64,
        /// In millimetres.
        thickness_mm: f64,
    },
    /// A thickness is none.
    #[error("the thickness is {0} mm (a thickness is at least 0)")]
    Thickness(f64),
    /// Air is never like this.
    #[error("the {quantity} of air is {value} (it is from {} to {})", range[0], range[1])]
    Air {
        /// What of it, with its unit.
        quantity: &'static str,
        /// What was given.
        value: f64,
        /// What may be given.
        range: [f64; 2],
    },
    /// The numbers make no formula or table.
    #[error(transparent)]
    Dispersion(#[from] DispersionError),
}

fn did_you_mean(suggestions: &[String]) -> String {
    match suggestions {
        [] => String::new(),
        [only] => format!(" did you mean {only}?"),
        [others @ .., last] => format!(" did you mean {} or {last}?", others.join(", ")),
    }
}
