//! Random streams: counter-based random numbers of rays, independent of which range of a source is generated.
//!
//! ChaCha is a counter-based generator: block number k of a stream, 64 bytes, is computed from key
//! and counter alone. Ray k gets block k, eight numbers with 53 bits each. This is faster than a
//! stream for each ray: consecutive rays are consecutive blocks, which the generator computes four
//! at a time, and a range starts with one jump. Each source has its own stream, so that sources
//! with equal seeds do not share their numbers. Eight rounds are far more than statistical tests
//! need (J.-P. Aumasson, *Too much crypto*, 2019).

use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};
use rayweave_math::unit_fraction;

/// Separates the streams of sources from other streams of the same seed.
const SOURCES: u64 = u64::from_be_bytes(*b"sources\0");

/// The number of random numbers of a ray.
pub(super) const NUMBERS: usize = 8;

/// The random numbers of one ray, uniform in [0, 1).
pub(super) type Numbers = [f64; NUMBERS];

/// The random numbers of consecutive rays.
pub(super) struct RayNumbers(ChaCha8Rng);

impl RayNumbers {
    /// The random numbers of a ray and of those after it.
    pub fn from(seed: u64, stream: u64, ray: u64) -> RayNumbers {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(SOURCES ^ stream);
        // two words of 32 bits for each number
        generator.set_word_pos(u128::from(ray) * 2 * NUMBERS as u128);
        RayNumbers(generator)
    }

    /// The numbers of the next ray.
    pub fn ray(&mut self) -> Numbers {
        std::array::from_fn(|_| unit_fraction(self.0.next_u64()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_ray_do_not_depend_on_the_range() {
        let mut all = RayNumbers::from(7, 3, 0);
        let all: Vec<Numbers> = (0..100).map(|_| all.ray()).collect();
        for first in [0, 1, 5, 63, 99] {
            let mut piece = RayNumbers::from(7, 3, first);
            assert!((first as usize..100).all(|ray| piece.ray() == all[ray]), "{first}");
        }
        assert_ne!(RayNumbers::from(7, 4, 0).ray(), all[0]);
        assert_ne!(RayNumbers::from(8, 3, 0).ray(), all[0]);
    }

    /// Mean 1/2 and variance 1/12 of each number, none correlated with another.
    #[test]
    fn moments() {
        let (mut generator, count) = (RayNumbers::from(1, 0, 0), 100_000);
        let mut products = [[0.0; NUMBERS]; NUMBERS];
        for _ in 0..count {
            let numbers = generator.ray().map(|u| u - 0.5);
            for i in 0..NUMBERS {
                (0..NUMBERS).for_each(|j| products[i][j] += numbers[i] * numbers[j]);
            }
        }
        // standard deviations: of the product of two 1/12, of a square sqrt(1/180)
        let error = 5.0 / f64::from(count).sqrt();
        for i in 0..NUMBERS {
            for j in 0..NUMBERS {
                let (expected, deviation) =
                    if i == j { (1.0 / 12.0, 180f64.sqrt().recip()) } else { (0.0, 1.0 / 12.0) };
                let found = products[i][j] / f64::from(count);
                assert!((found - expected).abs() < error * deviation, "{i} {j} {found}");
            }
        }
    }
}
