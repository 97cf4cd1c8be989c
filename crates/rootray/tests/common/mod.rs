//! Random root-rays with many ties, for all test files.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_rootray::{RootRay, Side};

pub fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// Every integer time from -4 to 4 is a root with probability 0.4.
pub fn tied_ray(rng: &mut ChaCha8Rng) -> RootRay {
    let start = Side::from_inside(rng.random());
    let times = (-4..=4).filter(|_| rng.random_bool(0.4)).map(f64::from);
    RootRay::from_times(start, times.collect::<Vec<_>>()).unwrap()
}
