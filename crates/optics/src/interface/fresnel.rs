//! Fresnel equations: amplitudes of reflection and transmission of s- and p-polarised light at dielectrics
//! and metals.
//!
//! Waves go as `exp(i (k.r - w t))`, so that an absorbing medium has the index `n + i k` with
//! `k >= 0`. The amplitudes follow from admittances y, `n cos(theta)` for s and `n / cos(theta)`
//! for p: `r = (y1 - y2) / (y1 + y2)` and `t = 2 y1 / (y1 + y2)` (Born & Wolf, *Principles of
//! Optics*, 7th edition, section 1.5.2; Macleod, *Thin-Film Optical Filters*, chapter 2).

use num_complex::Complex64;

/// Amplitude coefficients of an interface for the two polarisations: s, perpendicular to the plane
/// of incidence, and p, in it. They are the entries of diagonal Jones matrices.
///
/// The squares of the absolute values are fractions of *power*: the amplitudes of transmission
/// contain the factor for the width and the speed of the transmitted beam. With s the same for all
/// three beams and p = k x s for each of them, the signs are those of Born & Wolf: at normal
/// incidence from air onto glass, `reflected[0] < 0 < reflected[1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amplitudes {
    /// Amplitudes of reflection for s and p.
    pub reflected: [Complex64; 2],
    /// Amplitudes of transmission for s and p, both 0 where nothing propagates behind the interface.
    pub transmitted: [Complex64; 2],
}

impl Amplitudes {
    /// The fraction of the power of unpolarised light that is reflected.
    pub fn reflectance(&self) -> f64 {
        mean_power(&self.reflected)
    }

    /// The fraction of the power of unpolarised light that is transmitted.
    pub fn transmittance(&self) -> f64 {
        mean_power(&self.transmitted)
    }
}

fn mean_power(amplitudes: &[Complex64; 2]) -> f64 {
    0.5 * (amplitudes[0].norm_sqr() + amplitudes[1].norm_sqr())
}

/// Fresnel coefficients of a bare interface between two media, light coming from the first.
///
/// `n1` is real: where light propagates it is hardly absorbed within a wavelength. `n2` may be the
/// complex index of a metal. `cosine` is that of the angle of incidence, from 0 to 1. Beyond the
/// critical angle the amplitudes of reflection have the phases of total internal reflection.
///
/// ```
/// use num_complex::Complex64;
/// use rayweave_optics::interface::fresnel;
///
/// // 4 % at normal incidence on glass
/// assert!((fresnel(1.0, Complex64::from(1.5), 1.0).reflectance() - 0.04).abs() < 1e-15);
/// ```
pub fn fresnel(n1: f64, n2: Complex64, cosine: f64) -> Amplitudes {
    amplitudes(n1, n2, cosine, |_, behind| behind)
}

/// The amplitudes from the tangential fields (B, C) in front of the interface, which `carry`
/// computes from those behind it for s (0) and p (1).
pub(super) fn amplitudes(
    n1: f64,
    n2: Complex64,
    cosine: f64,
    carry: impl Fn(usize, (Complex64, Complex64)) -> (Complex64, Complex64),
) -> Amplitudes {
    let behind = PlaneWave::new(n2, tangential(n1, cosine));
    let (mut reflected, mut transmitted) = ([Complex64::ZERO; 2], [Complex64::ZERO; 2]);
    for p in [0, 1] {
        let front = if p == 0 { n1 * cosine } else { n1 / cosine };
        if !front.is_finite() || front == 0.0 {
            // grazing incidence: all light is reflected
            (reflected[p], transmitted[p]) = (Complex64::from(-1.0), Complex64::ZERO);
            continue;
        }
        let (b, c) = carry(p, (Complex64::ONE, behind.admittance(p)));
        let sum = front * b + c;
        // Born & Wolf define the sign of p by the magnetic field: the tangential electric field here has the
        // opposite sign
        let sign = if p == 0 { 1.0 } else { -1.0 };
        reflected[p] = sign * (front * b - c) / sum;
        let through = (behind.admittance(p).re / front).max(0.0).sqrt();
        transmitted[p] = 2.0 * front / sum * through;
    }
    Amplitudes { reflected, transmitted }
}

/// The component of the wave vector along the interface, n sin(theta): the same in all media.
pub(super) fn tangential(n1: f64, cosine: f64) -> f64 {
    n1 * (1.0 - cosine * cosine).max(0.0).sqrt()
}

/// A plane wave in a medium.
pub(super) struct PlaneWave {
    pub index: Complex64,
    /// The cosine of the angle to the normal of the interface, complex for evanescent and absorbed waves.
    pub cosine: Complex64,
}

impl PlaneWave {
    /// The wave with a tangential component n sin(theta).
    pub fn new(index: Complex64, tangential: f64) -> PlaneWave {
        let cosine = square_root(Complex64::ONE - (tangential / index) * (tangential / index));
        // of the two roots, take the wave that decays or propagates forward
        let normal = index * cosine;
        let forward = normal.im > 0.0 || (normal.im == 0.0 && normal.re >= 0.0);
        PlaneWave { index, cosine: if forward { cosine } else { -cosine } }
    }

    /// The optical admittance for s (0) or p (1).
    pub fn admittance(&self, p: usize) -> Complex64 {
        if p == 0 { self.index * self.cosine } else { self.index / self.cosine }
    }
}

/// The square root with a real part that is not negative (Kahan, "Branch cuts for complex
/// elementary functions", 1987, without the scaling that keeps squares from overflowing: indices
/// are of moderate size).
fn square_root(z: Complex64) -> Complex64 {
    let length = (z.re * z.re + z.im * z.im).sqrt();
    let large = (0.5 * (length + z.re.abs())).sqrt();
    match () {
        () if large == 0.0 => Complex64::ZERO,
        () if z.re >= 0.0 => Complex64::new(large, 0.5 * z.im / large),
        () => Complex64::new(0.5 * z.im.abs() / large, large.copysign(z.im)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }

    /// Fresnel's formulas for real indices (Born & Wolf, section 1.5.2, equations 20a and 21a).
    fn real_coefficients(n1: f64, n2: f64, theta: f64) -> [f64; 4] {
        let (ci, si) = (theta.cos(), theta.sin());
        let ct = (1.0 - (n1 / n2 * si).powi(2)).sqrt();
        let rs = (n1 * ci - n2 * ct) / (n1 * ci + n2 * ct);
        let rp = (n2 * ci - n1 * ct) / (n2 * ci + n1 * ct);
        let ts = 2.0 * n1 * ci / (n1 * ci + n2 * ct);
        let tp = 2.0 * n1 * ci / (n2 * ci + n1 * ct);
        let power = n2 * ct / (n1 * ci);
        [rs, rp, ts * power.sqrt(), tp * power.sqrt()]
    }

    #[test]
    fn bare_interfaces_obey_fresnel() {
        for (n1, n2) in [(1.0, 1.5), (1.33, 1.7), (1.7, 1.5)] {
            for degrees in [0.0_f64, 10.0, 35.0, 56.0, 60.0] {
                let theta = degrees.to_radians();
                let found = fresnel(n1, Complex64::from(n2), theta.cos());
                let [rs, rp, ts, tp] = real_coefficients(n1, n2, theta);
                for (z, expected) in
                    found.reflected.into_iter().chain(found.transmitted).zip([rs, rp, ts, tp])
                {
                    close(z.re, expected, 1e-14);
                    assert_eq!(z.im, 0.0);
                }
                close(found.reflectance() + found.transmittance(), 1.0, 1e-14);
            }
        }
    }

    #[test]
    fn p_light_is_not_reflected_at_brewsters_angle() {
        let theta = 1.5_f64.atan();
        let found = fresnel(1.0, Complex64::from(1.5), theta.cos());
        assert!(found.reflected[1].norm() < 1e-15 && found.reflected[0].norm() > 0.3);
    }

    #[test]
    fn total_reflection_shifts_the_phase() {
        // Born & Wolf, section 1.5.4, equation 60: tan(delta / 2) for s and p
        let (n, theta) = (1.0 / 1.5, 50.0_f64.to_radians());
        let found = fresnel(1.5, Complex64::from(1.0), theta.cos());
        let root = (theta.sin().powi(2) - n * n).sqrt();
        let [s, p] = found.reflected;
        close(s.norm(), 1.0, 1e-14);
        close(p.norm(), 1.0, 1e-14);
        close((s.arg() / 2.0).tan().abs(), root / theta.cos(), 1e-12);
        close((p.arg() / 2.0).tan().abs(), root / (n * n * theta.cos()), 1e-12);
        assert_eq!(found.transmittance(), 0.0);
    }

    #[test]
    fn metals_reflect_at_normal_incidence() {
        // (n - 1)^2 + k^2 over (n + 1)^2 + k^2 (Born & Wolf, section 14.2, equation 26)
        let (n, k) = (0.97, 6.03);
        let found = fresnel(1.0, Complex64::new(n, k), 1.0);
        close(found.reflectance(), ((n - 1.0_f64).powi(2) + k * k) / ((n + 1.0_f64).powi(2) + k * k), 1e-14);
    }

    #[test]
    fn grazing_light_is_reflected() {
        let found = fresnel(1.0, Complex64::from(1.5), 0.0);
        assert_eq!((found.reflectance(), found.transmittance()), (1.0, 0.0));
    }

    #[test]
    fn square_roots() {
        for z in [(3.0, 4.0), (-3.0, 4.0), (-3.0, -4.0), (2.25, 0.0), (-2.25, 0.0), (0.0, 0.0)] {
            let z = Complex64::new(z.0, z.1);
            let root = square_root(z);
            assert!((root * root - z).norm() < 1e-15 && root.re >= 0.0, "{z} {root}");
        }
    }
}
