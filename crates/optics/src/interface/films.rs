//! Amplitudes of a plane interface, bare or with thin films.
//!
//! Waves go as `exp(i (k.r - w t))`, so that an absorbing medium has the index `n + i k` with `k >= 0`. The films are
//! treated by characteristic matrices (Born & Wolf, *Principles of Optics*, 7th edition, section 1.6; Macleod, *Thin-Film
//! Optical Filters*, chapter 2): for each polarisation a film of index n, thickness d at the angle theta inside it has
//!
//! ```text
//! M = |      cos D       -i sin D / y |     D = 2 pi n d cos(theta) / wavelength
//!     | -i y sin D            cos D   |     y = n cos(theta) for s,  n / cos(theta) for p
//! ```
//!
//! and with `(B, C) = M1 M2 ... (1, y of the last medium)` the tangential fields give `r = (y0 B - C) / (y0 B + C)` and
//! `t = 2 y0 / (y0 B + C)`. Without films these are Fresnel's coefficients (Born & Wolf, section 1.5.2).

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

/// What an interface makes of the two polarisations: s, perpendicular to the plane of incidence, and p, in it.
///
/// The squares of the absolute values are fractions of *power*: the amplitudes of transmission contain the factor for the
/// width and the speed of the transmitted beam. With s the same for all three beams and p = k x s for each of them, the
/// signs are those of Born & Wolf: at normal incidence from air on glass, `reflected[0] < 0 < reflected[1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Amplitudes of reflection for s and p.
    pub reflected: [Complex64; 2],
    /// Amplitudes of transmission for s and p, both 0 where nothing propagates behind the interface.
    pub transmitted: [Complex64; 2],
}

impl Response {
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

/// The response of an interface with films between two media, light coming from the first.
///
/// `n1` is real: where light travels it is hardly absorbed within a wavelength. `cosine` is that of the angle of incidence,
/// from 0 to 1; `films` are listed in the order in which the light meets them.
///
/// ```
/// use num_complex::Complex64;
/// use rayweave_optics::interface::{Film, response};
///
/// // a quarter wave of magnesium fluoride on glass, normal incidence (Born & Wolf, section 1.6.4, equation 98)
/// let quarter = Film { index: Complex64::from(1.38), thickness_nm: 550.0 / 4.0 / 1.38 };
/// let found = response(1.0, &[quarter], Complex64::from(1.52), 1.0, 550.0);
/// let expected = ((1.52 - 1.38_f64.powi(2)) / (1.52 + 1.38_f64.powi(2))).powi(2);
/// assert!((found.reflectance() - expected).abs() < 1e-14);
/// ```
pub fn response(n1: f64, films: &[Film], n2: Complex64, cosine: f64, wavelength_nm: f64) -> Response {
    let sine = n1 * (1.0 - cosine * cosine).max(0.0).sqrt();
    let behind = Layer::new(n2, sine);
    let layers: Vec<_> = films.iter().map(|film| (Layer::new(film.index, sine), film.thickness_nm)).collect();
    let (mut reflected, mut transmitted) = ([Complex64::ZERO; 2], [Complex64::ZERO; 2]);
    for p in [0, 1] {
        let front = if p == 0 { n1 * cosine } else { n1 / cosine };
        if !front.is_finite() || front == 0.0 {
            // grazing incidence: all is reflected
            (reflected[p], transmitted[p]) = (Complex64::from(-1.0), Complex64::ZERO);
            continue;
        }
        let (b, c) =
            layers.iter().rev().fold((Complex64::ONE, behind.admittance(p)), |fields, (layer, d)| {
                layer.carry(p, fields, *d, wavelength_nm)
            });
        let sum = front * b + c;
        // Born & Wolf measure p by the magnetic field: the electric one, tangential here, has the other sign
        let sign = if p == 0 { 1.0 } else { -1.0 };
        reflected[p] = sign * (front * b - c) / sum;
        let through = (behind.admittance(p).re / front).max(0.0).sqrt();
        transmitted[p] = 2.0 * front / sum * through;
    }
    Response { reflected, transmitted }
}

/// A medium and the angle of the wave in it.
struct Layer {
    index: Complex64,
    cosine: Complex64,
}

impl Layer {
    /// From the part of the wave vector along the interface, n sin(theta), the same in all media.
    fn new(index: Complex64, sine: f64) -> Layer {
        let cosine = square_root(Complex64::ONE - (sine / index) * (sine / index));
        // of the two roots the wave that decays, or that goes forward
        let normal = index * cosine;
        let forward = normal.im > 0.0 || (normal.im == 0.0 && normal.re >= 0.0);
        Layer { index, cosine: if forward { cosine } else { -cosine } }
    }

    fn admittance(&self, p: usize) -> Complex64 {
        if p == 0 { self.index * self.cosine } else { self.index / self.cosine }
    }

    fn carry(
        &self,
        p: usize,
        (b, c): (Complex64, Complex64),
        thickness_nm: f64,
        wavelength_nm: f64,
    ) -> (Complex64, Complex64) {
        let phase = std::f64::consts::TAU * self.index * self.cosine * thickness_nm / wavelength_nm;
        let (cosine, sine) = cosine_and_sine(phase);
        let sine = -Complex64::I * sine;
        let y = self.admittance(p);
        (cosine * b + sine * c / y, sine * y * b + cosine * c)
    }
}

/// Of a complex number, by the functions of the library that has the same bits everywhere.
fn cosine_and_sine(z: Complex64) -> (Complex64, Complex64) {
    let (c, s, ch, sh) = (libm::cos(z.re), libm::sin(z.re), libm::cosh(z.im), libm::sinh(z.im));
    (Complex64::new(c * ch, -s * sh), Complex64::new(s * ch, c * sh))
}

/// The root with a real part that is not negative (Kahan, "Branch cuts for complex elementary functions", 1987, without
/// the scaling that keeps squares from overflowing: indices are of moderate size).
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
    fn fresnel(n1: f64, n2: f64, theta: f64) -> [f64; 4] {
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
                let found = response(n1, &[], Complex64::from(n2), theta.cos(), 500.0);
                let [rs, rp, ts, tp] = fresnel(n1, n2, theta);
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
        let found = response(1.0, &[], Complex64::from(1.5), theta.cos(), 500.0);
        assert!(found.reflected[1].norm() < 1e-15 && found.reflected[0].norm() > 0.3);
    }

    #[test]
    fn total_reflection_shifts_the_phase() {
        // Born & Wolf, section 1.5.4, equation 60: tan(delta / 2) for s and p
        let (n, theta) = (1.0 / 1.5, 50.0_f64.to_radians());
        let found = response(1.5, &[], Complex64::from(1.0), theta.cos(), 500.0);
        let root = (theta.sin().powi(2) - n * n).sqrt();
        let [s, p] = found.reflected;
        close(s.norm(), 1.0, 1e-14);
        close(p.norm(), 1.0, 1e-14);
        close((s.arg() / 2.0).tan().abs(), root / theta.cos(), 1e-12);
        close((p.arg() / 2.0).tan().abs(), root / (n * n * theta.cos()), 1e-12);
        assert_eq!(found.transmittance(), 0.0);
    }

    #[test]
    fn functions_of_complex_numbers() {
        for z in [(3.0, 4.0), (-3.0, 4.0), (-3.0, -4.0), (2.25, 0.0), (-2.25, 0.0), (0.0, 0.0)] {
            let z = Complex64::new(z.0, z.1);
            let root = square_root(z);
            assert!((root * root - z).norm() < 1e-15 && root.re >= 0.0, "{z} {root}");
            let (c, s) = cosine_and_sine(z);
            assert!((c * c + s * s - 1.0).norm() < 1e-12, "{z}");
            assert!((c + Complex64::I * s - (Complex64::I * z).exp()).norm() < 1e-13, "{z}");
        }
    }

    #[test]
    fn metals_reflect_at_normal_incidence() {
        // (n - 1)^2 + k^2 over (n + 1)^2 + k^2 (Born & Wolf, section 14.2, equation 26)
        let (n, k) = (0.97, 6.03);
        let found = response(1.0, &[], Complex64::new(n, k), 1.0, 550.0);
        close(found.reflectance(), ((n - 1.0_f64).powi(2) + k * k) / ((n + 1.0_f64).powi(2) + k * k), 1e-14);
    }

    #[test]
    fn lossless_stacks_keep_the_power() {
        let film = |n: f64, d: f64| Film { index: Complex64::from(n), thickness_nm: d };
        let stack = [film(2.3, 60.0), film(1.38, 110.0), film(1.9, 35.0)];
        for degrees in [0.0_f64, 20.0, 45.0, 80.0] {
            let found = response(1.0, &stack, Complex64::from(1.52), degrees.to_radians().cos(), 480.0);
            for p in [0, 1] {
                close(found.reflected[p].norm_sqr() + found.transmitted[p].norm_sqr(), 1.0, 1e-13);
            }
        }
    }

    #[test]
    fn half_waves_are_absent() {
        let half = Film { index: Complex64::from(2.1), thickness_nm: 600.0 / 2.0 / 2.1 };
        let with = response(1.0, &[half], Complex64::from(1.5), 1.0, 600.0);
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
        let found = response(1.0, &stack, Complex64::from(glass), 1.0, 633.0);
        close(found.reflectance(), ((1.0 - y) / (1.0 + y)).powi(2), 1e-13);
    }

    #[test]
    fn frustrated_total_reflection_decays_with_the_gap() {
        let gap = |d: f64| Film { index: Complex64::ONE, thickness_nm: d };
        let through = |d: f64| response(1.5, &[gap(d)], Complex64::from(1.5), 0.5, 500.0).transmittance();
        assert!(through(10.0) > 0.9 && through(500.0) < 0.1);
        // far away: exp(-2 kappa d), kappa = 2 pi / wavelength sqrt(n^2 sin^2 - 1)
        let kappa = std::f64::consts::TAU / 500.0 * (2.25_f64 * 0.75 - 1.0).sqrt();
        close((through(1500.0) / through(1400.0)).ln(), -200.0 * kappa, 1e-6);
    }

    #[test]
    fn grazing_light_is_reflected() {
        let found = response(1.0, &[], Complex64::from(1.5), 0.0, 500.0);
        assert_eq!((found.reflectance(), found.transmittance()), (1.0, 0.0));
    }
}
