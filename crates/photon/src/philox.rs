//! Random streams of photons: the counter-based random number generator Philox4x32-10.
//!
//! A random number is a function of the seed and of a counter that names the event, the photon, its
//! step and the purpose of the number. Histories therefore do not depend on the number of threads,
//! the batch size or the order of work, and any range of photons can be computed alone.
//!
//! *Source*: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as easy
//! as 1, 2, 3", SC11 (2011), section 3.3 and table 2.

use rayweave_math::Vec3;

pub(crate) const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
/// Increments of the key: the golden ratio and the square root of 3, minus 1, times 2^32.
pub(crate) const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
pub(crate) const ROUNDS: usize = 10;

/// The first three words of the counter of a photon's numbers in a step.
pub(crate) type Counter = [u32; 3];

/// Philox4x32-10: 128 random bits as a function of a counter and a key.
#[must_use]
pub fn philox4x32(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for round in 0..ROUNDS {
        if round > 0 {
            key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
        }
        let [a, b] = [0, 1].map(|k| u64::from(MULTIPLIERS[k]) * u64::from(counter[2 * k]));
        counter = [
            (b >> 32) as u32 ^ counter[1] ^ key[0],
            b as u32,
            (a >> 32) as u32 ^ counter[3] ^ key[1],
            a as u32,
        ];
    }
    counter
}

/// The use of random numbers within one step of a photon. Each purpose has numbers of its own, so
/// that a change of one process leaves those of the others as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Purpose {
    /// The creation of a photon by a source.
    Emission = 0,
    /// The distances to absorption and scattering.
    FreePath = 1,
    /// Scattering in a material.
    Scattering = 2,
    /// The optical boundary process.
    Boundary = 3,
    /// Emission after absorption: wavelength shifting.
    Reemission = 4,
    /// The place in a volume where a photon starts; the step counts the attempts.
    Position = 5,
}

/// The random numbers of one purpose in one step of one photon.
#[derive(Clone, Debug)]
pub struct Stream {
    key: [u32; 2],
    counter: [u32; 4],
    block: [u32; 4],
    used: usize,
}

/// 2^-53
pub(crate) const UNIT: f64 = f64::EPSILON / 2.0;

/// The lowest bit of the purpose in the fourth word of the counter; the bits below count blocks.
pub(crate) const PURPOSE_SHIFT: u32 = 24;

impl Stream {
    /// The stream of photon `photon` of the whole run in its step `step`. The counter is the event
    /// (the upper half of the photon number), the photon, the step and the purpose.
    #[must_use]
    pub fn new(seed: u64, photon: u64, step: u32, purpose: Purpose) -> Stream {
        Stream {
            key: [seed as u32, (seed >> 32) as u32],
            counter: [(photon >> 32) as u32, photon as u32, step, (purpose as u32) << PURPOSE_SHIFT],
            block: [0; 4],
            used: 4,
        }
    }

    /// The stream behind its first block.
    pub(crate) fn after_block(mut self) -> Stream {
        self.counter[3] = self.counter[3].wrapping_add(1);
        self
    }

    /// The stream with its first block, which is known.
    pub(crate) fn with_block(self, block: [u32; 4]) -> Stream {
        Stream { block, used: 0, ..self.after_block() }
    }

    /// A number between 0 and 1, both excluded: a multiple of 2^-53 plus 2^-54.
    pub fn uniform(&mut self) -> f64 {
        if self.used >= 4 {
            self.block = philox4x32(self.counter, self.key);
            // 2^24 blocks per step; no process needs more than a few
            self.counter[3] = self.counter[3].wrapping_add(1);
            self.used = 0;
        }
        let [high, low] = [self.block[self.used], self.block[self.used + 1]].map(u64::from);
        self.used += 2;
        ((high << 21 | low >> 11) as f64 + 0.5) * UNIT
    }

    /// True with a probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.uniform() < probability
    }

    /// An exponentially distributed number with mean 1.
    pub fn exponential(&mut self) -> f64 {
        -libm::log(self.uniform())
    }

    /// A normally distributed number with mean 0 and variance 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (2.0 * self.exponential()).sqrt();
        radius * self.azimuth().0
    }

    /// A number of the Poisson distribution: by products of uniform numbers (Knuth 1969) up to a mean
    /// of 30, above it the rounded normal approximation.
    pub fn poisson(&mut self, mean: f64) -> u32 {
        if mean > 30.0 {
            return (mean + mean.sqrt() * self.normal() + 0.5).max(0.0) as u32;
        }
        let (limit, mut product, mut count) = (libm::exp(-mean), self.uniform(), 0);
        while product > limit {
            product *= self.uniform();
            count += 1;
        }
        count
    }

    /// A unit vector, uniformly distributed.
    pub fn direction(&mut self) -> Vec3 {
        let z = 2.0 * self.uniform() - 1.0;
        self.around(Vec3::Z, z)
    }

    /// The unit vector at an angle with the given cosine to a unit vector, at a random azimuth.
    pub fn around(&mut self, axis: Vec3, cosine: f64) -> Vec3 {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (cos, sin) = self.azimuth();
        let (x, y) = perpendicular(axis);
        (sine * (cos * x + sin * y) + cosine * axis).normalize()
    }

    /// The cosine and the sine of an angle, uniformly distributed over the circle.
    fn azimuth(&mut self) -> (f64, f64) {
        cos_sin_turns(self.uniform())
    }

    /// A unit vector perpendicular to a unit vector, at a random azimuth.
    pub fn polarisation(&mut self, direction: Vec3) -> Vec3 {
        self.around(direction, 0.0)
    }

    /// A direction of the Lambertian (cosine) distribution about a unit normal.
    pub fn lambertian(&mut self, normal: Vec3) -> Vec3 {
        let cosine = self.uniform().sqrt();
        self.around(normal, cosine)
    }
}

/// The cosine and the sine of a number of turns between 0 and 1: Taylor polynomials within an eighth of a turn from a quarter,
/// which a multiplication by 4 separates exactly. The error is below 2^-52.
pub(crate) fn cos_sin_turns(turns: f64) -> (f64, f64) {
    let quarters = (4.0 * turns + 0.5) as u32;
    let angle = (4.0 * turns - f64::from(quarters)) * std::f64::consts::FRAC_PI_2;
    let square = angle * angle;
    let series = |coefficients: &[f64]| coefficients.iter().rev().fold(0.0, |sum, c| sum * square + c);
    let sin = angle + angle * square * series(&SINE);
    let cos = 1.0 - square * (0.5 - square * series(&COSINE));
    // selections instead of a branch that no processor can predict
    let (x, y) = if quarters & 1 == 0 { (cos, sin) } else { (sin, cos) };
    (if (quarters + 1) & 2 == 0 { x } else { -x }, if quarters & 2 == 0 { y } else { -y })
}

/// The coefficients of the Taylor series of the sine from x^3, and of the cosine from x^4. The first terms that are left out
/// are below (pi/4)^17 / 17! = 5e-17.
pub(crate) const SINE: [f64; 7] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];
pub(crate) const COSINE: [f64; 7] = [
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// Two unit vectors that form a right-handed orthonormal basis with a unit vector (Duff et al.,
/// "Building an orthonormal basis, revisited", JCGT 6 (2017) 1).
pub(crate) fn perpendicular(z: Vec3) -> (Vec3, Vec3) {
    let sign = 1f64.copysign(z.z);
    let a = -1.0 / (sign + z.z);
    let b = z.x * z.y * a;
    (Vec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x), Vec3::new(b, sign + z.y * z.y * a, -z.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The known answers published with the Random123 library, `kat_vectors`.
    #[test]
    fn published_vectors_are_reproduced() {
        assert_eq!(philox4x32([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(
            philox4x32([u32::MAX; 4], [u32::MAX; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        let pi = [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344];
        let expected = [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1];
        assert_eq!(philox4x32(pi, [0xa409_3822, 0x299f_31d0]), expected);
    }

    fn moments(count: u64, mut sample: impl FnMut(&mut Stream) -> f64) -> (f64, f64) {
        let (mut sum, mut squares) = (0.0, 0.0);
        for photon in 0..count {
            let value = sample(&mut Stream::new(7, photon, 3, Purpose::Boundary));
            sum += value;
            squares += value * value;
        }
        let mean = sum / count as f64;
        (mean, squares / count as f64 - mean * mean)
    }

    /// Chi-squared of Poisson numbers against their probabilities, as its distance from the number of degrees of freedom in standard
    /// deviations. Numbers with an expectation below 10 count together.
    fn poisson_deviation(mean: f64, count: u64) -> f64 {
        let mut found = vec![0_u64; 64];
        for photon in 0..count {
            let number = Stream::new(11, photon, 0, Purpose::Reemission).poisson(mean);
            found[(number as usize).min(63)] += 1;
        }
        let (mut probability, mut below) = (libm::exp(-mean), 0.0);
        let (mut chi2, mut bins, mut rest) = (0.0, 0_u32, count);
        for (number, found) in found.into_iter().enumerate() {
            let expected = count as f64 * probability;
            if expected < 10.0 && number as f64 > mean {
                break;
            }
            chi2 += (found as f64 - expected).powi(2) / expected;
            (bins, rest, below) = (bins + 1, rest - found, below + probability);
            probability *= mean / (number + 1) as f64;
        }
        let expected = count as f64 * (1.0 - below);
        chi2 += (rest as f64 - expected).powi(2) / expected;
        (chi2 - f64::from(bins)) / f64::from(2 * bins).sqrt()
    }

    #[test]
    fn poisson_numbers_have_their_probabilities() {
        for mean in [0.3, 1.5, 12.0] {
            let deviation = poisson_deviation(mean, 100_000);
            assert!(deviation.abs() < 4.0, "{mean}: {deviation}");
        }
    }

    #[test]
    #[ignore = "long"]
    fn long_poisson_numbers_have_their_probabilities() {
        for mean in [0.3, 1.5, 12.0] {
            let deviation = poisson_deviation(mean, 100_000_000);
            println!("mean {mean}: {deviation:+.2} standard deviations");
            assert!(deviation.abs() < 4.0, "{mean}: {deviation}");
        }
    }

    /// Means and variances lie within five standard errors of their closed forms.
    #[test]
    fn distributions_have_their_moments() {
        const COUNT: u64 = 40_000;
        let check = |(mean, variance): (f64, f64), expected: (f64, f64)| {
            let error = 5.0 * (expected.1 / COUNT as f64).sqrt();
            assert!((mean - expected.0).abs() < error, "mean {mean}, expected {}", expected.0);
            assert!(
                (variance / expected.1 - 1.0).abs() < 0.1,
                "variance {variance}, expected {}",
                expected.1
            );
        };
        check(moments(COUNT, Stream::uniform), (0.5, 1.0 / 12.0));
        check(moments(COUNT, Stream::exponential), (1.0, 1.0));
        check(moments(COUNT, Stream::normal), (0.0, 1.0));
        check(moments(COUNT, |stream| f64::from(stream.poisson(4.5))), (4.5, 4.5));
        check(moments(COUNT, |stream| f64::from(stream.poisson(200.0))), (200.0, 200.0));
        check(moments(COUNT, |stream| stream.direction().z), (0.0, 1.0 / 3.0));
        // the cosine of the Lambertian distribution has the density 2 c
        let axis = Vec3::new(1.0, -2.0, -2.0) / 3.0;
        check(moments(COUNT, |stream| stream.lambertian(axis).dot(axis)), (2.0 / 3.0, 1.0 / 18.0));
    }

    #[test]
    fn the_cosine_and_the_sine_are_those_of_libm() {
        for k in 0..=100_000 {
            let turns = f64::from(k) / 100_000.0;
            let (cos, sin) = cos_sin_turns(turns);
            let angle = std::f64::consts::TAU * turns;
            // the angle itself is rounded
            let error = (cos - libm::cos(angle)).abs().max((sin - libm::sin(angle)).abs());
            assert!(error <= 2f64.powi(-52) + angle * 2f64.powi(-53), "{turns}: {error:e}");
            assert!((cos * cos + sin * sin - 1.0).abs() <= 2f64.powi(-51), "{turns}");
        }
        assert_eq!(
            [0.0, 0.25, 0.5, 0.75].map(cos_sin_turns),
            [(1.0, 0.0), (-0.0, 1.0), (-1.0, -0.0), (0.0, -1.0)]
        );
    }

    #[test]
    fn the_basis_is_orthonormal_and_right_handed() {
        for axis in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(2.0, -1.0, -2.0) / 3.0] {
            let (x, y) = perpendicular(axis);
            assert!((x.cross(y) - axis).length() < 1e-15);
            assert!((x.length() - 1.0).abs() < 1e-15 && x.dot(y).abs() < 1e-15);
        }
    }
}
