//! Hash maps of numbers and addresses, which no input chooses: their hash needs no protection against chosen collisions.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};

/// A map by numbers or addresses.
pub(crate) type NumberMap<K, V> = HashMap<K, V, BuildHasherDefault<NumberHasher>>;

/// A set of numbers or addresses.
pub(crate) type NumberSet<K> = HashSet<K, BuildHasherDefault<NumberHasher>>;

/// Multiplicative hash (Knuth, The Art of Computer Programming 3, section 6.4), with 2^64 divided by the golden ratio.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NumberHasher(u64);

impl Hasher for NumberHasher {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(u64::from(byte)));
    }

    fn write_u32(&mut self, number: u32) {
        self.write_u64(u64::from(number));
    }

    fn write_u64(&mut self, number: u64) {
        self.0 = (self.0.rotate_left(26) ^ number).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }

    fn write_usize(&mut self, number: usize) {
        self.write_u64(number as u64);
    }

    fn finish(&self) -> u64 {
        // tables use the low bits too, and those of aligned addresses are 0
        self.0 ^ (self.0 >> 32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::hash::BuildHasher;

    /// The low bits, which select the place in a table, spread as random ones do: of n keys in n places 1 / e stay empty.
    #[test]
    fn numbers_and_addresses_spread() {
        let hasher = BuildHasherDefault::<NumberHasher>::default();
        let places = 1usize << 16;
        let empty = |hash: &dyn Fn(usize) -> u64| {
            let mut taken = vec![false; places];
            (0..places).for_each(|k| taken[hash(k) as usize % places] = true);
            taken.iter().filter(|taken| !**taken).count() as f64 / places as f64
        };
        assert!(empty(&|k| hasher.hash_one(k)) < 0.5);
        assert!(empty(&|k| hasher.hash_one(0x7f00_0000_0000 + 64 * k)) < 0.5);
        assert!(empty(&|k| hasher.hash_one((k as u32, 0x5500_0000_1230 + 128 * k))) < 0.5);
    }
}
