//! The statistics of comparisons: chi squared of two histograms, its tail probability, standard deviations.

use libm::{erfc, exp, fabs, lgamma, log, pow, sqrt};

/// A bin of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedBin {
    /// The contents of the bin: a history, an end, a path, or an interval.
    pub label: String,
    /// The numbers of photons of the two samples.
    pub counts: [u64; 2],
    /// The difference of the fractions, first minus second sample, in standard deviations.
    pub z: f64,
}

/// The comparison of the distributions of a quantity in two samples.
///
/// chi squared is that of two histograms of unequal totals, (A sqrt(N_b / N_a) - B sqrt(N_a / N_b))^2 / (A + B) summed over the
/// bins; the number of degrees of freedom is that of the bins minus 1, because the totals are given.
///
/// *Source*: Press et al., Numerical Recipes, 3rd edition, section 14.3.2.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedQuantity {
    /// `history`, `end`, `volume`, `time` or `wavelength`.
    pub name: &'static str,
    /// The numbers of photons that have the quantity.
    pub totals: [u64; 2],
    /// chi squared.
    pub chi2: f64,
    /// The number of degrees of freedom; 0 with a single bin, which tells nothing.
    pub ndf: u64,
    /// The probability of this chi squared or more in samples of one distribution.
    pub p: f64,
    /// The standard deviations of the normal distribution beyond which its upper tail has the probability `p`.
    pub z: f64,
    /// The bins, in the order of their numbers of photons or of their intervals.
    pub bins: Vec<ComparedBin>,
}

impl ComparedQuantity {
    pub(super) fn new(
        name: &'static str,
        totals: [u64; 2],
        bins: Vec<(String, [u64; 2])>,
    ) -> ComparedQuantity {
        let chi2 = bins.iter().map(|(_, counts)| term(*counts, totals)).sum();
        let ndf = (bins.len() as u64).saturating_sub(1);
        let p = chi_squared_tail(chi2, ndf);
        let bin = |(label, counts)| ComparedBin { label, counts, z: fraction_z(counts, totals) };
        let bins = bins.into_iter().map(bin).collect();
        ComparedQuantity { name, totals, chi2, ndf, p, z: normal_deviation(chi2, ndf, p), bins }
    }
}

/// The contribution of a bin to chi squared.
fn term([a, b]: [u64; 2], [total_a, total_b]: [u64; 2]) -> f64 {
    if a + b == 0 || total_a == 0 || total_b == 0 {
        return 0.0;
    }
    let ratio = sqrt(total_b as f64 / total_a as f64);
    let difference = a as f64 * ratio - b as f64 / ratio;
    difference * difference / (a + b) as f64
}

/// The difference of two fractions in standard deviations of the pooled fraction; 0 if that is 0 or 1.
pub(super) fn fraction_z([a, b]: [u64; 2], [total_a, total_b]: [u64; 2]) -> f64 {
    if total_a == 0 || total_b == 0 {
        return 0.0;
    }
    let (n, m) = (total_a as f64, total_b as f64);
    let pooled = (a + b) as f64 / (n + m);
    let variance = pooled * (1.0 - pooled) * (1.0 / n + 1.0 / m);
    if variance > 0.0 { (a as f64 / n - b as f64 / m) / sqrt(variance) } else { 0.0 }
}

/// The probability of a chi squared of at least `chi2` with `ndf` degrees of freedom: the incomplete gamma function
/// Q(ndf / 2, chi2 / 2). 1 without degrees of freedom.
///
/// *Source*: Press et al., Numerical Recipes, 3rd edition, section 6.2: the series below a + 1, the continued fraction above.
#[must_use]
pub fn chi_squared_tail(chi2: f64, ndf: u64) -> f64 {
    let (a, x) = (ndf as f64 / 2.0, chi2 / 2.0);
    if ndf == 0 || x.is_nan() || x <= 0.0 {
        return 1.0;
    }
    let front = exp(a * log(x) - x - lgamma(a));
    let tail = if x < a + 1.0 { 1.0 - front * series(a, x) } else { front * continued_fraction(a, x) };
    tail.clamp(0.0, 1.0)
}

/// The largest number of terms: they converge in about the square root of a, and a is at most half the number of bins.
const MAX_TERMS: u32 = 1_000_000;

/// The lower incomplete gamma function without its front factor.
fn series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
    for _ in 0..MAX_TERMS {
        n += 1.0;
        term *= x / n;
        sum += term;
        if fabs(term) < fabs(sum) * f64::EPSILON {
            break;
        }
    }
    sum
}

/// The upper incomplete gamma function without its front factor, by Lentz's method.
fn continued_fraction(a: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let not_zero = |value: f64| if fabs(value) < TINY { TINY } else { value };
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / not_zero(b);
    let mut h = d;
    for i in 1..MAX_TERMS {
        let factor = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        d = 1.0 / not_zero(factor * d + b);
        c = not_zero(b + factor / c);
        h *= d * c;
        if fabs(d * c - 1.0) < f64::EPSILON {
            break;
        }
    }
    h
}

/// The upper tail of the normal distribution beyond z.
#[must_use]
pub fn normal_tail(z: f64) -> f64 {
    0.5 * erfc(z / core::f64::consts::SQRT_2)
}

/// The deviation whose upper tail is `p`: by bisection, and for a `p` too small for it by the approximation of Wilson and Hilferty
/// (1931), in which the cube root of chi squared is normal.
fn normal_deviation(chi2: f64, ndf: u64, p: f64) -> f64 {
    if ndf == 0 {
        return 0.0;
    }
    if !(1e-300..=1.0 - 1e-9).contains(&p) {
        let spread = 2.0 / (9.0 * ndf as f64);
        return (pow(chi2 / ndf as f64, 1.0 / 3.0) - (1.0 - spread)) / sqrt(spread);
    }
    let (mut low, mut high) = (-40.0, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if normal_tail(middle) > p { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
