//! Errors of dispersion formulas, tables and materials.

/// Error of numbers that are not a dispersion formula or a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DispersionError {
    /// There is no formula of this number.
    #[error("{catalogue} has no formula {number}: its formulas are numbered 1 to {last}.")]
    Formula {
        /// The catalogue.
        catalogue: &'static str,
        /// The value.
        number: u32,
        /// The last number.
        last: u32,
    },
    /// A wrong number of coefficients.
    #[error("{formula} has {given} coefficients: it takes {takes}.")]
    Coefficients {
        /// The formula.
        formula: String,
        /// The number of coefficients given.
        given: usize,
        /// The number of coefficients that it takes, in words.
        takes: &'static str,
    },
    /// A coefficient that is not finite.
    #[error("coefficient {position} is {value}: coefficients must be finite.")]
    Coefficient {
        /// Counted from 1.
        position: usize,
        /// The value.
        value: f64,
    },
    /// An invalid entry of a table.
    #[error(
        "table entry is {value} at {wavelength_nm} nm: wavelengths must be positive, and all numbers finite."
    )]
    Entry {
        /// The wavelength in nanometres.
        wavelength_nm: f64,
        /// The value.
        value: f64,
    },
    /// Two values of a table at one wavelength.
    #[error("table has both {} and {} at {wavelength_nm} nm: a wavelength has one value.", values[0], values[1])]
    Twice {
        /// The wavelength in nanometres.
        wavelength_nm: f64,
        /// Both values.
        values: [f64; 2],
    },
    /// A table without entries.
    #[error("table has no entries: it needs at least one wavelength.")]
    Empty,
    /// An impossible index or Abbe number.
    #[error(
        "material has index {n_d} and Abbe number {v_d}: the index must be greater than 1, the Abbe number positive, both finite."
    )]
    Abbe {
        /// The index at the d line.
        n_d: f64,
        /// The Abbe number.
        v_d: f64,
    },
}

/// Error of a material that cannot be made, or has no data at a wavelength.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GlassError {
    /// A wavelength outside the range of the data.
    #[error(
        "{glass} has no {quantity} at {wavelength_nm} nm: its data range from {} nm to {} nm. Use extrapolated().",
        range_nm[0],
        range_nm[1]
    )]
    OutOfRange {
        /// The name of the material.
        glass: String,
        /// `refractive index` or `extinction coefficient`.
        quantity: &'static str,
        /// The wavelength in nanometres.
        wavelength_nm: f64,
        /// The range of the data in nanometres.
        range_nm: [f64; 2],
    },
    /// An invalid wavelength.
    #[error("wavelength is {0} nm: wavelengths must be greater than 0 and finite. Is it in nanometres?")]
    Wavelength(f64),
    /// A formula without a real index.
    #[error(
        "{glass} has no refractive index at {wavelength_nm} nm: its formula has no positive value there."
    )]
    NoIndex {
        /// The name of the material.
        glass: String,
        /// The wavelength in nanometres.
        wavelength_nm: f64,
    },
    /// An unknown name.
    #[error("no glass is named {name:?}: the catalogue has {count} glasses.{}", did_you_mean(suggestions))]
    Unknown {
        /// The unknown name.
        name: String,
        /// The number of glasses of the catalogue.
        count: usize,
        /// The most similar names, at most three.
        suggestions: Vec<String>,
    },
    /// An invalid range of wavelengths.
    #[error(
        "range of {glass} is {} nm to {} nm: it must start at 0 or above and increase.",
        range_nm[0],
        range_nm[1]
    )]
    Range {
        /// The name of the material.
        glass: String,
        /// The range in nanometres.
        range_nm: [f64; 2],
    },
    /// A negative extinction coefficient.
    #[error("extinction coefficient of {glass} is {value} at {wavelength_nm} nm: it must be at least 0.")]
    Extinction {
        /// The name of the material.
        glass: String,
        /// The wavelength in nanometres.
        wavelength_nm: f64,
        /// The value.
        value: f64,
    },
    /// A transmittance or a thickness out of range.
    #[error(
        "internal transmittance is {transmittance} through {thickness_mm} mm at {wavelength_nm} nm: it must be from 0 to 1, \
         through a thickness greater than 0. Is it in per cent?"
    )]
    Transmittance {
        /// The wavelength in nanometres.
        wavelength_nm: f64,
        /// The transmittance.
        transmittance: f64,
        /// The thickness in millimetres.
        thickness_mm: f64,
    },
    /// A negative thickness.
    #[error("thickness is {0} mm: it must be at least 0.")]
    Thickness(f64),
    /// A parameter of air out of range.
    #[error("{quantity} of air is {value}: it must be from {} to {}.", range[0], range[1])]
    Air {
        /// The quantity, with its unit.
        quantity: &'static str,
        /// The value.
        value: f64,
        /// The range.
        range: [f64; 2],
    },
    /// Invalid numbers of a formula or a table.
    #[error(transparent)]
    Dispersion(#[from] DispersionError),
}

fn did_you_mean(suggestions: &[String]) -> String {
    match suggestions {
        [] => String::new(),
        [only] => format!(" Did you mean {only}?"),
        [others @ .., last] => format!(" Did you mean {} or {last}?", others.join(", ")),
    }
}
