//! Dispersion formulas: the refractive index as a function of wavelength.
//!
//! λ is in micrometres in every formula.

use super::refractivity;
use super::spectrum::{C_NM, D_NM, F_NM};
use super::{DispersionError, Table};

/// One term `strength λ² / (λ² - resonance_um2)` of a Sellmeier formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SellmeierTerm {
    /// B, without a unit.
    pub strength: f64,
    /// C, the square of the wavelength of resonance, in square micrometres.
    pub resonance_um2: f64,
}

/// One term `factor λ^power / (λ² - pole)` of a rational formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RationalTerm {
    /// In micrometres to the power `2 - power`.
    pub factor: f64,
    /// The power of λ in the numerator.
    pub power: f64,
    /// In square micrometres.
    pub pole: f64,
}

/// A dispersion formula with its coefficients.
///
/// The variants are general forms; functions with the names of the formulas in catalogues construct
/// them. With λ in micrometres:
///
/// | function | formula | AGF | refractiveindex.info |
/// | --- | --- | --- | --- |
/// | [`schott`](Dispersion::schott) | n² = a₀ + a₁λ² + a₂λ⁻² + a₃λ⁻⁴ + a₄λ⁻⁶ + a₅λ⁻⁸ | 1 | in 3 |
/// | [`sellmeier`](Dispersion::sellmeier) | n² - 1 = Σ Bλ²/(λ² - C) | 2, 6, 11 with 3, 4, 5 terms | in 2; in 1 with C squared |
/// | [`herzberger`](Dispersion::herzberger) | n = A + BL + CL² + Dλ² + Eλ⁴ + Fλ⁶, L = 1/(λ² - 0.028) | 3 | 7 |
/// | [`sellmeier_2`](Dispersion::sellmeier_2) | n² - 1 = A + B₁λ²/(λ² - λ₁²) + B₂/(λ² - λ₂²) | 4 | in 4 |
/// | [`conrady`](Dispersion::conrady) | n = n₀ + A/λ + B/λ³·⁵ | 5 | in 5 |
/// | [`handbook_1`](Dispersion::handbook_1) | n² = A + B/(λ² - C) - Dλ² | 7 | in 4 |
/// | [`handbook_2`](Dispersion::handbook_2) | n² = A + Bλ²/(λ² - C) - Dλ² | 8 | in 4 |
/// | [`sellmeier_4`](Dispersion::sellmeier_4) | n² = A + Bλ²/(λ² - C) + Dλ²/(λ² - E) | 9 | in 4 |
/// | [`extended_1`](Dispersion::extended_1) | n² of Schott + a₆λ⁻¹⁰ + a₇λ⁻¹² | 10 | in 3 |
/// | [`extended_2`](Dispersion::extended_2) | n² of Schott + a₆λ⁴ + a₇λ⁶ | 12 | in 3 |
/// | [`extended_3`](Dispersion::extended_3) | n² = a₀ + a₁λ² + a₂λ⁴ + a₃λ⁻² + a₄λ⁻⁴ + ... + a₈λ⁻¹² | 13 | in 3 |
/// | [`cauchy`](Dispersion::cauchy) | n = A + B/λ² + C/λ⁴ + ... | | in 5 |
///
/// The formulas and their numbers are those of the AGF glass catalogues (Zemax OpticStudio user
/// guide, "The glass dispersion formulas") and of refractiveindex.info ("Dispersion formulas", M.
/// N. Polyanskiy); [`agf`](Dispersion::agf) and [`refractiveindex`](Dispersion::refractiveindex)
/// build them by number.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Dispersion {
    /// The same index at every wavelength.
    Constant(f64),
    /// n² = 1 + offset + Σ Bλ²/(λ² - C).
    Sellmeier {
        /// The constant added to 1; usually 0.
        offset: f64,
        /// The terms under the sum.
        terms: Vec<SellmeierTerm>,
    },
    /// n² = Σ Fλ^p/(λ² - c) + Σ a λ^q.
    Square {
        /// The terms with a pole.
        poles: Vec<RationalTerm>,
        /// Pairs (a, q).
        powers: Vec<(f64, f64)>,
    },
    /// n = Σ a λ^q, of pairs (a, q).
    Powers(Vec<(f64, f64)>),
    /// n = A + BL + CL² + Dλ² + Eλ⁴ + Fλ⁶ with L = 1/(λ² - 0.028).
    Herzberger([f64; 6]),
    /// n = 1 + offset + Σ b/(c - λ⁻²), of pairs (b, c) in λ⁻²: the formula of gases.
    Gas {
        /// The constant added to 1; usually 0.
        offset: f64,
        /// Pairs (b, c), both in reciprocal square micrometres.
        terms: Vec<(f64, f64)>,
    },
    /// (n² - 1)/(n² + 2) = a + bλ²/(λ² - c) + dλ²: "retro", formula 8 of refractiveindex.info.
    Retro([f64; 4]),
    /// n² = a + b/(λ² - c) + d(λ - e)/((λ - e)² + f): "exotic", formula 9 of refractiveindex.info.
    Exotic([f64; 6]),
    /// Air by Ciddor's equations; see [`Air`](super::Air).
    Air {
        /// The density of the dry part relative to standard air, times the factor of CO₂ for the
        /// refractivity.
        dry: f64,
        /// The density of the water vapour relative to that at 20 °C and 1333 Pa.
        vapour: f64,
    },
    /// Measured indices, with linear interpolation.
    Tabulated(Table),
    /// Another law plus the same amount at all wavelengths.
    Shifted {
        /// The other law.
        law: Box<Dispersion>,
        /// The amount.
        by: f64,
    },
}

const AGF: &str = "an AGF catalogue";
const REFRACTIVEINDEX: &str = "refractiveindex.info";

/// The powers of λ in formulas for n²; each formula takes the first of its row, in this order.
const SCHOTT_POWERS: [f64; 6] = [0.0, 2.0, -2.0, -4.0, -6.0, -8.0];
const EXTENDED_1_POWERS: [f64; 8] = [0.0, 2.0, -2.0, -4.0, -6.0, -8.0, -10.0, -12.0];
const EXTENDED_2_POWERS: [f64; 8] = [0.0, 2.0, -2.0, -4.0, -6.0, -8.0, 4.0, 6.0];
const EXTENDED_3_POWERS: [f64; 9] = [0.0, 2.0, 4.0, -2.0, -4.0, -6.0, -8.0, -10.0, -12.0];

/// Formulas by their names in catalogues; λ in micrometres.
impl Dispersion {
    /// The Sellmeier formula n² - 1 = Σ Bλ²/(λ² - C), of pairs (B, C in µm²).
    ///
    /// ```
    /// use rayweave_optics::glass::Dispersion;
    /// // Schott N-BK7, n_d = 1.51680
    /// let bk7 = Dispersion::sellmeier(&[
    ///     (1.03961212, 0.00600069867),
    ///     (0.231792344, 0.0200179144),
    ///     (1.01046945, 103.560653),
    /// ]);
    /// assert!((bk7.index(587.5618).unwrap() - 1.51680).abs() < 5e-6);
    /// ```
    pub fn sellmeier(terms: &[(f64, f64)]) -> Dispersion {
        let term = |&(strength, resonance_um2): &(f64, f64)| SellmeierTerm { strength, resonance_um2 };
        Dispersion::Sellmeier { offset: 0.0, terms: terms.iter().map(term).collect() }
    }

    /// n² - 1 = A + B₁λ²/(λ² - λ₁²) + B₂/(λ² - λ₂²), of A, B₁, λ₁, B₂, λ₂: the second term has no
    /// λ² in the numerator.
    pub fn sellmeier_2([a, b1, l1, b2, l2]: [f64; 5]) -> Dispersion {
        let poles = vec![pole(b1, 2.0, l1 * l1), pole(b2, 0.0, l2 * l2)];
        Dispersion::Square { poles, powers: vec![(1.0 + a, 0.0)] }
    }

    /// n² = A + Bλ²/(λ² - C) + Dλ²/(λ² - E).
    pub fn sellmeier_4([a, b, c, d, e]: [f64; 5]) -> Dispersion {
        let poles = vec![pole(b, 2.0, c), pole(d, 2.0, e)];
        Dispersion::Square { poles, powers: vec![(a, 0.0)] }
    }

    /// Schott's formula of 1966: n² = a₀ + a₁λ² + a₂λ⁻² + a₃λ⁻⁴ + a₄λ⁻⁶ + a₅λ⁻⁸.
    pub fn schott(coefficients: [f64; 6]) -> Dispersion {
        square_of_powers(&coefficients, &SCHOTT_POWERS)
    }

    /// n² = Schott's + a₆λ⁻¹⁰ + a₇λ⁻¹².
    pub fn extended_1(coefficients: [f64; 8]) -> Dispersion {
        square_of_powers(&coefficients, &EXTENDED_1_POWERS)
    }

    /// n² = Schott's + a₆λ⁴ + a₇λ⁶.
    pub fn extended_2(coefficients: [f64; 8]) -> Dispersion {
        square_of_powers(&coefficients, &EXTENDED_2_POWERS)
    }

    /// n² = a₀ + a₁λ² + a₂λ⁴ + a₃λ⁻² + a₄λ⁻⁴ + a₅λ⁻⁶ + a₆λ⁻⁸ + a₇λ⁻¹⁰ + a₈λ⁻¹².
    pub fn extended_3(coefficients: [f64; 9]) -> Dispersion {
        square_of_powers(&coefficients, &EXTENDED_3_POWERS)
    }

    /// Herzberger's formula: n = A + BL + CL² + Dλ² + Eλ⁴ + Fλ⁶ with L = 1/(λ² - 0.028).
    pub fn herzberger(coefficients: [f64; 6]) -> Dispersion {
        Dispersion::Herzberger(coefficients)
    }

    /// Conrady's formula: n = n₀ + A/λ + B/λ³·⁵.
    pub fn conrady([n0, a, b]: [f64; 3]) -> Dispersion {
        Dispersion::Powers(vec![(n0, 0.0), (a, -1.0), (b, -3.5)])
    }

    /// Cauchy's formula: n = A + B/λ² + C/λ⁴ + ..., with any number of coefficients.
    pub fn cauchy(coefficients: &[f64]) -> Dispersion {
        let powers = (0..).map(|order| -2.0 * f64::from(order));
        Dispersion::Powers(coefficients.iter().copied().zip(powers).collect())
    }

    /// The first formula of the Handbook of Optics: n² = A + B/(λ² - C) - Dλ².
    pub fn handbook_1([a, b, c, d]: [f64; 4]) -> Dispersion {
        Dispersion::Square { poles: vec![pole(b, 0.0, c)], powers: vec![(a, 0.0), (-d, 2.0)] }
    }

    /// The second formula of the Handbook of Optics: n² = A + Bλ²/(λ² - C) - Dλ².
    pub fn handbook_2([a, b, c, d]: [f64; 4]) -> Dispersion {
        Dispersion::Square { poles: vec![pole(b, 2.0, c)], powers: vec![(a, 0.0), (-d, 2.0)] }
    }

    /// Cauchy's formula with two terms, n = A + B/λ², and the given index at the d line (587.5618
    /// nm) and Abbe number V_d = (n_d - 1)/(n_F - n_C).
    ///
    /// B = (n_d - 1)/(V_d (λ_F⁻² - λ_C⁻²)) and A = n_d - B λ_d⁻² (F. A. Jenkins and H. E. White,
    /// Fundamentals of Optics, ch. 23). Two numbers do not determine partial dispersions: for the
    /// glasses of Schott the median error is 2e-4 and the largest, of P-SF68, 4e-3 between 450 nm
    /// and 700 nm, and 1e-3 and 1.5e-2 between 400 nm and 800 nm.
    ///
    /// # Errors
    /// [`DispersionError::Abbe`] unless the index is above 1, the Abbe number above 0, and both are finite.
    pub fn from_abbe(n_d: f64, v_d: f64) -> Result<Dispersion, DispersionError> {
        if !(n_d > 1.0 && v_d > 0.0 && n_d.is_finite() && v_d.is_finite()) {
            return Err(DispersionError::Abbe { n_d, v_d });
        }
        let per_square = |wavelength_nm: f64| 1e6 / (wavelength_nm * wavelength_nm);
        let b = (n_d - 1.0) / (v_d * (per_square(F_NM) - per_square(C_NM)));
        Ok(Dispersion::cauchy(&[n_d - b * per_square(D_NM), b]))
    }
}

fn pole(factor: f64, power: f64, pole: f64) -> RationalTerm {
    RationalTerm { factor, power, pole }
}

fn square_of_powers(coefficients: &[f64], powers: &[f64]) -> Dispersion {
    Dispersion::Square { poles: Vec::new(), powers: pairs(coefficients, powers) }
}

fn pairs(coefficients: &[f64], powers: &[f64]) -> Vec<(f64, f64)> {
    coefficients.iter().copied().zip(powers.iter().copied()).collect()
}

/// Formulas by number.
impl Dispersion {
    /// The formula of this number in AGF glass catalogues, 1 to 13. Missing coefficients at the end
    /// count as 0, and surplus zeros are ignored, as in those files.
    ///
    /// # Errors
    /// [`DispersionError`] for an unknown number, a coefficient that is not finite, or a surplus
    /// one that is not 0.
    pub fn agf(number: u32, coefficients: &[f64]) -> Result<Dispersion, DispersionError> {
        check_finite(coefficients)?;
        let c = coefficients;
        Ok(match number {
            1 => Dispersion::schott(padded(number, c)?),
            2 => sellmeier_of_pairs(0.0, &padded::<6>(number, c)?),
            3 => Dispersion::herzberger(padded(number, c)?),
            4 => Dispersion::sellmeier_2(padded(number, c)?),
            5 => Dispersion::conrady(padded(number, c)?),
            6 => sellmeier_of_pairs(0.0, &padded::<8>(number, c)?),
            7 => Dispersion::handbook_1(padded(number, c)?),
            8 => Dispersion::handbook_2(padded(number, c)?),
            9 => Dispersion::sellmeier_4(padded(number, c)?),
            10 => Dispersion::extended_1(padded(number, c)?),
            11 => sellmeier_of_pairs(0.0, &padded::<10>(number, c)?),
            12 => Dispersion::extended_2(padded(number, c)?),
            13 => Dispersion::extended_3(padded(number, c)?),
            _ => return Err(DispersionError::Formula { catalogue: AGF, number, last: 13 }),
        })
    }

    /// The formula of this number at refractiveindex.info, 1 to 9.
    ///
    /// # Errors
    /// [`DispersionError`] for an unknown number, a coefficient that is not finite, or a wrong
    /// number of coefficients.
    pub fn refractiveindex(number: u32, coefficients: &[f64]) -> Result<Dispersion, DispersionError> {
        check_finite(coefficients)?;
        match number {
            1 | 2 => refractiveindex_sellmeier(number, coefficients),
            3 => {
                let powers = constant_and_pairs(number, coefficients)?;
                Ok(Dispersion::Square { poles: Vec::new(), powers })
            }
            4 => refractiveindex_rational(coefficients),
            5 => Ok(Dispersion::Powers(constant_and_pairs(number, coefficients)?)),
            6 => {
                let terms = constant_and_pairs(number, coefficients)?;
                Ok(Dispersion::Gas { offset: terms[0].0, terms: terms[1..].to_vec() })
            }
            7 => Ok(Dispersion::Herzberger(exactly(number, coefficients, "1 to 6")?)),
            8 => Ok(Dispersion::Retro(exactly(number, coefficients, "1 to 4")?)),
            9 => Ok(Dispersion::Exotic(exactly(number, coefficients, "1 to 6")?)),
            _ => Err(DispersionError::Formula { catalogue: REFRACTIVEINDEX, number, last: 9 }),
        }
    }
}

fn check_finite(coefficients: &[f64]) -> Result<(), DispersionError> {
    match coefficients.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(place) => Err(DispersionError::Coefficient { position: place + 1, value: coefficients[place] }),
    }
}

fn padded<const N: usize>(number: u32, coefficients: &[f64]) -> Result<[f64; N], DispersionError> {
    if coefficients.iter().skip(N).any(|&value| value != 0.0) {
        return Err(wrong_count(AGF, number, coefficients, "fewer; surplus ones must be 0"));
    }
    Ok(std::array::from_fn(|place| coefficients.get(place).copied().unwrap_or(0.0)))
}

fn exactly<const N: usize>(
    number: u32,
    coefficients: &[f64],
    takes: &'static str,
) -> Result<[f64; N], DispersionError> {
    if coefficients.is_empty() || coefficients.len() > N {
        return Err(wrong_count(REFRACTIVEINDEX, number, coefficients, takes));
    }
    Ok(std::array::from_fn(|place| coefficients.get(place).copied().unwrap_or(0.0)))
}

fn wrong_count(catalogue: &str, number: u32, coefficients: &[f64], takes: &'static str) -> DispersionError {
    let formula = format!("formula {number} of {catalogue}");
    DispersionError::Coefficients { formula, given: coefficients.len(), takes }
}

/// A Sellmeier formula from alternating strengths and resonances. Terms of strength 0 are omitted,
/// because their resonances are undefined in catalogues.
fn sellmeier_of_pairs(offset: f64, coefficients: &[f64]) -> Dispersion {
    let pairs = coefficients.chunks_exact(2).filter(|pair| pair[0] != 0.0);
    let terms = pairs.map(|pair| SellmeierTerm { strength: pair[0], resonance_um2: pair[1] }).collect();
    Dispersion::Sellmeier { offset, terms }
}

/// Formulas 1 and 2: n² - 1 = C₁ + Σ Bλ²/(λ² - C), with C² in place of C in formula 1.
fn refractiveindex_sellmeier(number: u32, coefficients: &[f64]) -> Result<Dispersion, DispersionError> {
    let pairs = constant_and_pairs(number, coefficients)?;
    let resonance = |c: f64| if number == 1 { c * c } else { c };
    let flat: Vec<f64> = pairs[1..].iter().flat_map(|&(b, c)| [b, resonance(c)]).collect();
    Ok(sellmeier_of_pairs(pairs[0].0, &flat))
}

/// The constant with the power 0, then pairs as they are written.
fn constant_and_pairs(number: u32, coefficients: &[f64]) -> Result<Vec<(f64, f64)>, DispersionError> {
    if coefficients.len().is_multiple_of(2) {
        return Err(wrong_count(REFRACTIVEINDEX, number, coefficients, "a constant, then pairs"));
    }
    let terms = coefficients[1..].chunks_exact(2).map(|pair| (pair[0], pair[1]));
    Ok(std::iter::once((coefficients[0], 0.0)).chain(terms).collect())
}

/// Formula 4: n² = C₁ + C₂λ^C₃/(λ² - C₄^C₅) + C₆λ^C₇/(λ² - C₈^C₉) + C₁₀λ^C₁₁ + C₁₂λ^C₁₃ + ...
fn refractiveindex_rational(coefficients: &[f64]) -> Result<Dispersion, DispersionError> {
    let poles_end = coefficients.len().min(9);
    let complete = matches!(coefficients.len(), 1 | 5) || coefficients.len() >= 9;
    if !complete || coefficients.len().is_multiple_of(2) {
        return Err(wrong_count(REFRACTIVEINDEX, 4, coefficients, "1, 5, 9, or 9 and pairs"));
    }
    let poles = coefficients[1..poles_end].chunks_exact(4).filter(|term| term[0] != 0.0);
    let poles = poles.map(|term| pole(term[0], term[1], libm::pow(term[2], term[3]))).collect();
    let powers = coefficients[poles_end..].chunks_exact(2).map(|pair| (pair[0], pair[1]));
    let powers = std::iter::once((coefficients[0], 0.0)).chain(powers).collect();
    Ok(Dispersion::Square { poles, powers })
}

/// Evaluation.
impl Dispersion {
    /// The refractive index at a wavelength in nanometres, without a check of the range of validity.
    ///
    /// `None` if the wavelength is not positive and finite, or the formula has no positive finite value.
    pub fn index(&self, wavelength_nm: f64) -> Option<f64> {
        if !(wavelength_nm > 0.0 && wavelength_nm.is_finite()) {
            return None;
        }
        let index = self.value(wavelength_nm);
        (index > 0.0 && index.is_finite()).then_some(index)
    }

    fn value(&self, wavelength_nm: f64) -> f64 {
        let um = wavelength_nm / 1e3;
        let square = um * um;
        match self {
            Dispersion::Constant(index) => *index,
            Dispersion::Sellmeier { offset, terms } => sellmeier_square(*offset, terms, square).sqrt(),
            Dispersion::Square { poles, powers } => {
                let poles: f64 =
                    poles.iter().map(|t| t.factor * power(um, t.power) / (square - t.pole)).sum();
                (poles + sum_of_powers(powers, um)).sqrt()
            }
            Dispersion::Powers(powers) => sum_of_powers(powers, um),
            Dispersion::Herzberger(coefficients) => herzberger(coefficients, square),
            Dispersion::Gas { offset, terms } => {
                1.0 + offset + terms.iter().map(|&(b, c)| b / (c - 1.0 / square)).sum::<f64>()
            }
            Dispersion::Retro(coefficients) => retro(coefficients, square),
            Dispersion::Exotic(coefficients) => exotic(coefficients, um),
            Dispersion::Air { dry, vapour } => refractivity::air_index(*dry, *vapour, square),
            Dispersion::Tabulated(table) => table.at(wavelength_nm),
            Dispersion::Shifted { law, by } => law.value(wavelength_nm) + by,
        }
    }
}

fn sellmeier_square(offset: f64, terms: &[SellmeierTerm], square: f64) -> f64 {
    let term = |term: &SellmeierTerm| term.strength * square / (square - term.resonance_um2);
    1.0 + offset + terms.iter().map(term).sum::<f64>()
}

fn sum_of_powers(powers: &[(f64, f64)], um: f64) -> f64 {
    powers.iter().map(|&(factor, exponent)| factor * power(um, exponent)).sum()
}

fn herzberger([a, b, c, d, e, f]: &[f64; 6], square: f64) -> f64 {
    let l = 1.0 / (square - 0.028);
    a + l * (b + l * c) + square * (d + square * (e + square * f))
}

/// Solved for n: with q = (n² - 1)/(n² + 2), n² = (1 + 2q)/(1 - q).
fn retro([a, b, c, d]: &[f64; 4], square: f64) -> f64 {
    let q = a + b * square / (square - c) + d * square;
    ((1.0 + 2.0 * q) / (1.0 - q)).sqrt()
}

fn exotic([a, b, c, d, e, f]: &[f64; 6], um: f64) -> f64 {
    let shifted = um - e;
    // formula 9 with three coefficients has no second part, which would be 0/0 at its centre
    let second = if *d == 0.0 { 0.0 } else { d * shifted / (shifted * shifted + f) };
    (a + b / (um * um - c) + second).sqrt()
}

/// λ^p: by squaring where p is a small whole number, as it is in almost all formulas, and by `pow` elsewhere.
fn power(um: f64, exponent: f64) -> f64 {
    let whole = exponent as i32;
    if f64::from(whole) != exponent || whole.unsigned_abs() > 64 {
        return libm::pow(um, exponent);
    }
    let positive = whole_power(um, whole.unsigned_abs());
    if whole < 0 { 1.0 / positive } else { positive }
}

fn whole_power(mut base: f64, mut exponent: u32) -> f64 {
    let mut product = 1.0;
    while exponent > 0 {
        if exponent & 1 == 1 {
            product *= base;
        }
        base *= base;
        exponent >>= 1;
    }
    product
}
