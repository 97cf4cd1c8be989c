//! Thin films (coatings) by the transfer matrix method.
//!
//! Each film has a transfer (characteristic) matrix (Born & Wolf, *Principles of Optics*, 7th
//! edition, section 1.6; Macleod, *Thin-Film Optical Filters*, chapter 2): for each polarisation, a
//! film of index n and thickness d, with light at the angle theta inside it, has
//!
//! ```text
//! M = |      cos D       -i sin D / y |     D = 2 pi n d cos(theta) / wavelength
//!     | -i y sin D            cos D   |     y = n cos(theta) for s,  n / cos(theta) for p
//! ```
//!
//! and with `(B, C) = M1 M2 ... (1, y of the last medium)` the tangential fields give
//! `r = (y0 B - C) / (y0 B + C)` and `t = 2 y0 / (y0 B + C)`. Without films these are the Fresnel
//! coefficients.

use super::fresnel::{Amplitudes, PlaneWave, amplitudes, tangential};
use num_complex::Complex64;

/// A film between two media.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// The complex index of refraction, n + i k.
    pub index: Complex64,
    /// The thickness, in nanometres.
    pub thickness_nm: f64,
}

impl Film {
    /// A film of index n + i k.
    pub fn new(n: f64, k: f64, thickness_nm: f64) -> Film {
        Film { index: Complex64::new(n, k), thickness_nm }
    }
}

/// The amplitudes of an interface with thin films between two media, light coming from the first.
///
/// `n1`, `n2` and `cosine` are those of [`fresnel`](super::fresnel()); `films` are listed in the
/// order in which light passes them.
///
/// ```
/// use num_complex::Complex64;
/// use rayweave_optics::interface::{Film, transfer_matrix};
///
/// // a quarter wave of magnesium fluoride on glass, normal incidence (Born & Wolf, section 1.6.4, equation 98)
/// let quarter = Film { index: Complex64::from(1.38), thickness_nm: 550.0 / 4.0 / 1.38 };
/// let found = transfer_matrix(1.0, &[quarter], Complex64::from(1.52), 1.0, 550.0);
/// let expected = ((1.52 - 1.38_f64.powi(2)) / (1.52 + 1.38_f64.powi(2))).powi(2);
/// assert!((found.reflectance() - expected).abs() < 1e-14);
/// ```
pub fn transfer_matrix(
    n1: f64,
    films: &[Film],
    n2: Complex64,
    cosine: f64,
    wavelength_nm: f64,
) -> Amplitudes {
    let tangential = tangential(n1, cosine);
    // the waves in the films are recomputed for each polarisation: a list of them would cost an allocation per photon
    amplitudes(n1, n2, cosine, |p, behind| {
        let carried = |fields, film: &Film| {
            carry(&PlaneWave::new(film.index, tangential), p, fields, film.thickness_nm, wavelength_nm)
        };
        films.iter().rev().fold(behind, carried)
    })
}

/// The tangential fields in front of a film, from those behind it.
fn carry(
    wave: &PlaneWave,
    p: usize,
    (b, c): (Complex64, Complex64),
    thickness_nm: f64,
    wavelength_nm: f64,
) -> (Complex64, Complex64) {
    let phase = std::f64::consts::TAU * wave.index * wave.cosine * thickness_nm / wavelength_nm;
    let (cosine, sine) = cosine_and_sine(phase);
    let sine = -Complex64::I * sine;
    let y = wave.admittance(p);
    (cosine * b + sine * c / y, sine * y * b + cosine * c)
}

/// Cosine and sine of a complex number, by `libm`, which has the same bits on every platform.
fn cosine_and_sine(z: Complex64) -> (Complex64, Complex64) {
    let (c, s, ch, sh) = (libm::cos(z.re), libm::sin(z.re), libm::cosh(z.im), libm::sinh(z.im));
    (Complex64::new(c * ch, -s * sh), Complex64::new(s * ch, c * sh))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }

    #[test]
    fn lossless_stacks_keep_the_power() {
        let film = |n: f64, d: f64| Film { index: Complex64::from(n), thickness_nm: d };
        let stack = [film(2.3, 60.0), film(1.38, 110.0), film(1.9, 35.0)];
        for degrees in [0.0_f64, 20.0, 45.0, 80.0] {
            let found =
                transfer_matrix(1.0, &stack, Complex64::from(1.52), degrees.to_radians().cos(), 480.0);
            for p in [0, 1] {
                close(found.reflected[p].norm_sqr() + found.transmitted[p].norm_sqr(), 1.0, 1e-13);
            }
        }
    }

    #[test]
    fn half_wave_films_have_no_effect() {
        let half = Film { index: Complex64::from(2.1), thickness_nm: 600.0 / 2.0 / 2.1 };
        let with = transfer_matrix(1.0, &[half], Complex64::from(1.5), 1.0, 600.0);
        close(with.reflectance(), 0.04, 1e-14);
    }

    #[test]
    fn quarter_wave_mirrors() {
        // (HL)^N H on glass: R = ((n0 - Y) / (n0 + Y))^2, Y = (nH / nL)^2N nH^2 / ns (Macleod, section 6.1)
        let (high, low, glass, pairs) = (2.35_f64, 1.38_f64, 1.52, 4);
        let film = |n: f64| Film { index: Complex64::from(n), thickness_nm: 633.0 / 4.0 / n };
        let mut stack = vec![film(high)];
        (0..pairs).for_each(|_| stack.extend([film(low), film(high)]));
        let y = (high / low).powi(2 * pairs) * high * high / glass;
        let found = transfer_matrix(1.0, &stack, Complex64::from(glass), 1.0, 633.0);
        close(found.reflectance(), ((1.0 - y) / (1.0 + y)).powi(2), 1e-13);
    }

    #[test]
    fn frustrated_total_reflection_decays_with_the_gap() {
        let gap = |d: f64| Film { index: Complex64::ONE, thickness_nm: d };
        let through =
            |d: f64| transfer_matrix(1.5, &[gap(d)], Complex64::from(1.5), 0.5, 500.0).transmittance();
        assert!(through(10.0) > 0.9 && through(500.0) < 0.1);
        // far away: exp(-2 kappa d), kappa = 2 pi / wavelength sqrt(n^2 sin^2 - 1)
        let kappa = std::f64::consts::TAU / 500.0 * (2.25_f64 * 0.75 - 1.0).sqrt();
        close((through(1500.0) / through(1400.0)).ln(), -200.0 * kappa, 1e-6);
    }

    #[test]
    fn cosines_and_sines() {
        for z in [(3.0, 4.0), (-3.0, 4.0), (-3.0, -4.0), (2.25, 0.0), (-2.25, 0.0), (0.0, 0.0)] {
            let z = Complex64::new(z.0, z.1);
            let (c, s) = cosine_and_sine(z);
            assert!((c * c + s * s - 1.0).norm() < 1e-12, "{z}");
            assert!((c + Complex64::I * s - (Complex64::I * z).exp()).norm() < 1e-13, "{z}");
        }
    }
}
