//! Wavelengths: lines, bands, tables, Planck's law.

use crate::assert_close;
use rayweave_optics::source::*;

fn line() -> Source {
    Source::new(Pattern::Line { length: 1.0, count: 40_000 }).unwrap()
}

fn drawn(spectrum: &Spectrum) -> Vec<f64> {
    line().spectrum(spectrum).unwrap().seed(5).rays(0..40_000).wavelength_nm
}

#[test]
fn lines_by_weight() {
    let lines = [(486.13, 1.0), (587.56, 5.0), (656.27, 2.0), (700.0, 0.0)];
    let wavelengths = drawn(&Spectrum::Lines(lines.to_vec()));
    for (line, weight) in lines {
        let part = wavelengths.iter().filter(|&&nm| nm == line).count() as f64 / 4e4;
        assert_close(part, weight / 8.0, 5.0 * 0.5 / 200.0);
    }
    let exact = Spectrum::Lines(lines.to_vec()).wavelengths().unwrap();
    assert_eq!(
        [0.0, 0.1249, 0.125, 0.7499, 0.75, 0.9999].map(|part| exact.at(part)),
        [486.13, 486.13, 587.56, 587.56, 656.27, 656.27]
    );
    assert!(drawn(&Spectrum::Line(532.0)).iter().all(|&nm| nm == 532.0));
}

/// A band is uniform; a triangle over [a, b] that rises from 0 has its part u at a + (b - a) sqrt(u).
#[test]
fn bands_and_tables() {
    let band = Spectrum::Band { from_nm: 400.0, to_nm: 700.0 };
    let wavelengths = drawn(&band);
    let mean = wavelengths.iter().sum::<f64>() / 4e4;
    assert_close(mean, 550.0, 5.0 * 300.0 / 12f64.sqrt() / 200.0);
    assert!(wavelengths.iter().all(|nm| (400.0..700.0).contains(nm)));
    let at = band.wavelengths().unwrap();
    let rising = Spectrum::Table(vec![(400.0, 0.0), (600.0, 3.0)]).wavelengths().unwrap();
    let falling = Spectrum::Table(vec![(400.0, 3.0), (600.0, 0.0)]).wavelengths().unwrap();
    for part in [0.0, 0.1, 0.25, 0.5, 0.99] {
        assert_close(at.at(part), 400.0 + 300.0 * part, 1e-12);
        assert_close(rising.at(part), 400.0 + 200.0 * part.sqrt(), 1e-12);
        assert_close(falling.at(part), 600.0 - 200.0 * (1.0 - part).sqrt(), 1e-12);
    }
    // a gap has no light: half of it lies on either side
    let gap = vec![(400.0, 1.0), (410.0, 1.0), (410.1, 0.0), (600.0, 0.0), (600.1, 1.0), (610.0, 1.0)];
    let gap = drawn(&Spectrum::Table(gap));
    assert!(gap.iter().all(|nm| (400.0..410.2).contains(nm) || (599.9..610.1).contains(nm)));
}

/// Wien's displacement law: the greatest radiance at 2.897771955e6 nm K / T (CODATA 2018).
#[test]
fn wien() {
    for kelvin in [300.0, 2856.0, 5772.0, 1e5] {
        let (mut low, mut high) = (1e6 / kelvin, 6e6 / kelvin);
        for _ in 0..200 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if planck(a, kelvin) < planck(b, kelvin) { low = a } else { high = b }
        }
        // a maximum is found to the square root of the precision
        assert_close(0.5 * (low + high) * kelvin, 2.897_771_955e6, 0.2);
    }
}

/// The law of Stefan and Boltzmann: pi times the integral over all wavelengths is sigma T^4 (CODATA 2018).
#[test]
fn stefan_boltzmann() {
    for kelvin in [300.0, 5772.0] {
        // over the logarithm of the wavelength, by the trapezoidal rule: the integrand and all its slopes vanish at both ends
        let (steps, from, to) = (4000, (1e4f64 / kelvin).ln(), (1e11f64 / kelvin).ln());
        let step = (to - from) / f64::from(steps);
        let at = |k| (from + step * f64::from(k)).exp();
        let sum: f64 = (0..=steps).map(|k| at(k) * planck(at(k), kelvin)).sum();
        let exact = 5.670_374_419e-8 * kelvin.powi(4);
        assert_close(std::f64::consts::PI * step * sum, exact, 1e-8 * exact);
    }
}

/// The part of the radiance below a wavelength: with x = h c / (lambda k T),
/// `15 / pi^4 sum exp(-n x) (x^3/n + 3 x^2/n^2 + 6 x/n^3 + 6/n^4)` (S. L. Chang and K. T. Rhee, 1984).
fn part_below(wavelength_nm: f64, kelvin: f64) -> f64 {
    let x = 1.438_776_877e7 / (wavelength_nm * kelvin);
    let term = |n: f64| {
        (-n * x).exp() * (x.powi(3) / n + 3.0 * x * x / (n * n) + 6.0 * x / n.powi(3) + 6.0 / n.powi(4))
    };
    15.0 / std::f64::consts::PI.powi(4) * (1..4000).map(|n| term(f64::from(n))).sum::<f64>()
}

#[test]
fn black_bodies() {
    // half of all radiance lies below 4107 um K (tables of black-body fractions)
    assert_close(part_below(4107.0e3 / 5000.0, 5000.0), 0.5, 1e-4);
    for (kelvin, from_nm, to_nm) in [(5772.0, 100.0, 1e5), (2856.0, 380.0, 780.0), (300.0, 2000.0, 5e4)] {
        let spectrum = Spectrum::BlackBody { kelvin, from_nm, to_nm };
        let wavelengths = spectrum.wavelengths().unwrap();
        let (low, high) = (part_below(from_nm, kelvin), part_below(to_nm, kelvin));
        let part = |nm: f64| (part_below(nm, kelvin) - low) / (high - low);
        for k in 0..100 {
            let sought = (f64::from(k) + 0.5) / 100.0;
            assert_close(part(wavelengths.at(sought)), sought, 1e-5);
        }
        let drawn = drawn(&spectrum);
        let middle = wavelengths.at(0.5);
        let below = drawn.iter().filter(|&&nm| nm < middle).count() as f64 / 4e4;
        assert_close(below, 0.5, 5.0 * 0.5 / 200.0);
    }
}

#[test]
fn refusals() {
    let message = |spectrum: Spectrum| spectrum.wavelengths().unwrap_err().to_string();
    assert!(message(Spectrum::Line(-500.0)).starts_with("wavelength of the spectrum is -500 nm:"));
    assert!(message(Spectrum::Lines(vec![(500.0, f64::NAN)])).contains("is NaN at 500 nm:"));
    assert!(message(Spectrum::Lines(vec![])).starts_with("spectrum has no power:"));
    assert!(message(Spectrum::Lines(vec![(500.0, 0.0)])).starts_with("spectrum has no power:"));
    assert_eq!(
        message(Spectrum::Band { from_nm: 700.0, to_nm: 400.0 }),
        "wavelength 400 nm of the spectrum follows 700 nm: wavelengths must increase. Are they swapped?"
    );
    assert!(message(Spectrum::Table(vec![(500.0, 1.0)])).starts_with("spectrum has no power:"));
    let body = |kelvin, from_nm, to_nm| Spectrum::BlackBody { kelvin, from_nm, to_nm };
    assert!(message(body(-3.0, 1.0, 2.0)).starts_with("kelvin of the black body is -3:"));
    assert!(message(body(3.0, 100.0, 200.0)).starts_with("spectrum has no power:"));
    assert!(message(body(3000.0, 200.0, 100.0)).contains("must increase"));
    assert!(message(body(3000.0, 200.0, f64::INFINITY)).contains("inf nm"));
}
