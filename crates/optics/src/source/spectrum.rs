//! Spectra: distributions of wavelengths, and their sampling by inverse transform.

use super::SourceError;
use super::error::positive;

/// The spectrum of a source. Every ray has one wavelength, drawn so that rays of equal power follow
/// the distribution of power (inverse transform sampling).
#[derive(Clone, Debug, PartialEq)]
pub enum Spectrum {
    /// One wavelength, in nanometres.
    Line(f64),
    /// Several wavelengths, in nanometres, each with its relative power.
    Lines(Vec<(f64, f64)>),
    /// Constant power per nanometre between two wavelengths.
    Band {
        /// The shortest wavelength.
        from_nm: f64,
        /// The longest wavelength.
        to_nm: f64,
    },
    /// The light of a black body between two wavelengths: see [`planck`].
    BlackBody {
        /// Its temperature in kelvin.
        kelvin: f64,
        /// The shortest wavelength.
        from_nm: f64,
        /// The longest wavelength.
        to_nm: f64,
    },
    /// Pairs of a wavelength in nanometres and the power per nanometre there, in any unit; linear in between.
    Table(Vec<(f64, f64)>),
}

/// The first radiation constant for spectral radiance, 2 h c^2, in W m^2 / sr (CODATA 2018, exact
/// to the digits given).
const FIRST_RADIATION_CONSTANT: f64 = 1.191_042_972e-16;

/// The second radiation constant, h c / k, in m K (CODATA 2018, exact to the digits given).
const SECOND_RADIATION_CONSTANT: f64 = 1.438_776_877e-2;

/// The spectral radiance of a black body in W / (m^2 sr nm):
/// `2 h c^2 / lambda^5 / (exp(h c / (lambda k T)) - 1)` (M. Planck 1901; constants of CODATA 2018).
///
/// ```
/// # use rayweave_optics::source::planck;
/// // a body of 5772 K, the sun, at 500 nm
/// assert!((planck(500.0, 5772.0) - 26_240.0).abs() < 10.0);
/// ```
pub fn planck(wavelength_nm: f64, kelvin: f64) -> f64 {
    let metres = 1e-9 * wavelength_nm;
    let exponent = SECOND_RADIATION_CONSTANT / (metres * kelvin);
    let per_metre = FIRST_RADIATION_CONSTANT / (metres.powi(5) * libm::expm1(exponent));
    // overflow: no light
    if per_metre.is_finite() { 1e-9 * per_metre } else { 0.0 }
}

/// The number of pieces of a black-body curve.
const PIECES: u32 = 2048;

impl Spectrum {
    /// The inverse cumulative distribution, from which wavelengths are drawn.
    ///
    /// # Errors
    /// Invalid wavelengths or weights, wavelengths that do not increase, zero total power.
    pub fn wavelengths(&self) -> Result<Wavelengths, SourceError> {
        match self {
            Spectrum::Line(wavelength_nm) => Ok(Wavelengths::Line(checked(*wavelength_nm)?)),
            Spectrum::Lines(lines) => discrete(lines),
            Spectrum::Band { from_nm, to_nm } => continuous(&[(*from_nm, 1.0), (*to_nm, 1.0)]),
            Spectrum::BlackBody { kelvin, from_nm, to_nm } => {
                continuous(&black_body(*kelvin, *from_nm, *to_nm)?)
            }
            Spectrum::Table(table) => continuous(table),
        }
    }
}

impl Default for Spectrum {
    /// 633 nm, a helium-neon laser.
    fn default() -> Self {
        Spectrum::Line(633.0)
    }
}

/// A spectrum ready to draw wavelengths from.
#[derive(Clone, Debug, PartialEq)]
pub enum Wavelengths {
    /// A single wavelength.
    Line(f64),
    /// Lines with the sums of the weights up to each.
    Lines(Cumulative),
    /// Points of a density, linear in between, with the integrals up to each.
    Density(Cumulative),
}

/// A cumulative distribution of wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Cumulative {
    wavelengths_nm: Vec<f64>,
    /// The density at each point; for lines the weight.
    density: Vec<f64>,
    /// The integral up to each point; for lines the sum including it.
    before: Vec<f64>,
    /// Guide table: for each of 2^k equal parts of the total, the first point whose integral
    /// exceeds the start of that part, from which the search begins (H. C. Chen and Y. Asau, *On
    /// generating random variates from an empirical distribution*, 1974).
    guide: Vec<u32>,
}

impl Cumulative {
    fn new(wavelengths_nm: Vec<f64>, density: Vec<f64>, before: Vec<f64>) -> Result<Cumulative, SourceError> {
        let total = before.last().copied().unwrap_or(0.0);
        if total == 0.0 || !total.is_finite() {
            return Err(SourceError::NoPower);
        }
        let parts = before.len().next_power_of_two();
        let first = |part: usize| {
            let sought = part as f64 / parts as f64 * total;
            before.partition_point(|&before| before <= sought) as u32
        };
        let guide = (0..parts).map(first).collect();
        Ok(Cumulative { wavelengths_nm, density, before, guide })
    }

    fn total(&self) -> f64 {
        self.before.last().copied().unwrap_or(0.0)
    }

    /// The first point whose integral exceeds a fraction of the total.
    fn after(&self, part: f64) -> usize {
        let sought = part * self.total();
        // exact for a power of two, so that the search never begins too late
        let begin = (part * self.guide.len() as f64) as usize;
        let mut point = self.guide[begin.min(self.guide.len() - 1)] as usize;
        while point < self.before.len() && self.before[point] <= sought {
            point += 1;
        }
        point
    }
}

impl Wavelengths {
    /// True if all rays have one wavelength.
    pub fn is_line(&self) -> bool {
        matches!(self, Wavelengths::Line(_))
    }

    /// The wavelength in nanometres below which a fraction of the power lies, 0 <= `part` < 1.
    pub fn at(&self, part: f64) -> f64 {
        match self {
            Wavelengths::Line(wavelength_nm) => *wavelength_nm,
            Wavelengths::Lines(lines) => {
                lines.wavelengths_nm[lines.after(part).min(lines.wavelengths_nm.len() - 1)]
            }
            Wavelengths::Density(points) => {
                let next = points.after(part).clamp(1, points.before.len() - 1);
                points.within(next - 1, part * points.total())
            }
        }
    }
}

impl Cumulative {
    /// The wavelength at which the integral attains a value between points k and k + 1: a root of
    /// `d0 x + (d1 - d0) x^2 / (2 step)`.
    fn within(&self, k: usize, sought: f64) -> f64 {
        let (from, step) = (self.wavelengths_nm[k], self.wavelengths_nm[k + 1] - self.wavelengths_nm[k]);
        let (d0, d1, rest) = (self.density[k], self.density[k + 1], sought - self.before[k]);
        let slope = (d1 - d0) / step;
        let denominator = d0 + (d0 * d0 + 2.0 * slope * rest).max(0.0).sqrt();
        if denominator > 0.0 { from + (2.0 * rest / denominator).clamp(0.0, step) } else { from }
    }
}

fn checked(wavelength_nm: f64) -> Result<f64, SourceError> {
    match wavelength_nm > 0.0 && wavelength_nm.is_finite() {
        true => Ok(wavelength_nm),
        false => Err(SourceError::Wavelength { value: wavelength_nm }),
    }
}

/// Wavelengths and weights as columns, if they are valid.
fn columns(pairs: &[(f64, f64)]) -> Result<(Vec<f64>, Vec<f64>), SourceError> {
    for &(wavelength_nm, value) in pairs {
        checked(wavelength_nm)?;
        let is_weight = value >= 0.0 && value.is_finite();
        if !is_weight {
            return Err(SourceError::Weight { value, wavelength_nm });
        }
    }
    Ok(pairs.iter().copied().unzip())
}

fn discrete(lines: &[(f64, f64)]) -> Result<Wavelengths, SourceError> {
    let (wavelengths_nm, density) = columns(lines)?;
    let sum = |sum: &mut f64, &weight: &f64| {
        *sum += weight;
        Some(*sum)
    };
    let before = density.iter().scan(0.0, sum).collect();
    Cumulative::new(wavelengths_nm, density, before).map(Wavelengths::Lines)
}

fn continuous(points: &[(f64, f64)]) -> Result<Wavelengths, SourceError> {
    let (wavelengths_nm, density) = columns(points)?;
    if let Some(pair) = wavelengths_nm.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(SourceError::NotIncreasing { before: pair[0], after: pair[1] });
    }
    let mut before = vec![0.0];
    for k in 1..wavelengths_nm.len() {
        let area = 0.5 * (density[k - 1] + density[k]) * (wavelengths_nm[k] - wavelengths_nm[k - 1]);
        before.push(before[k - 1] + area);
    }
    Cumulative::new(wavelengths_nm, density, before).map(Wavelengths::Density)
}

/// Points of Planck's curve, at equal ratios of wavelengths.
fn black_body(kelvin: f64, from_nm: f64, to_nm: f64) -> Result<Vec<(f64, f64)>, SourceError> {
    positive("black body", "kelvin", kelvin)?;
    if checked(from_nm)? >= checked(to_nm)? {
        return Err(SourceError::NotIncreasing { before: from_nm, after: to_nm });
    }
    let ratio = to_nm / from_nm;
    let at = |k: u32| match k {
        0 => from_nm,
        PIECES => to_nm,
        _ => from_nm * libm::pow(ratio, f64::from(k) / f64::from(PIECES)),
    };
    Ok((0..=PIECES).map(|k| (at(k), planck(at(k), kelvin))).collect())
}
