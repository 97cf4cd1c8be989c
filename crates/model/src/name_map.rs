//! Hash maps of names, which a file may choose: their hash is seeded at random, like that of the standard library, and faster.

use std::collections::HashMap;
use std::hash::{BuildHasher, Hasher, RandomState};

/// A map by names, or by keys that contain names.
pub type NameMap<K, V> = HashMap<K, V, NameState>;

/// The seed of [`NameHasher`]: two random numbers.
#[derive(Clone, Debug)]
pub struct NameState {
    start: u64,
    factor: u64,
}

impl Default for NameState {
    fn default() -> NameState {
        let random = RandomState::new();
        NameState { start: random.hash_one(0), factor: random.hash_one(1) | 1 }
    }
}

impl BuildHasher for NameState {
    type Hasher = NameHasher;

    fn build_hasher(&self) -> NameHasher {
        NameHasher { hash: self.start, factor: self.factor }
    }
}

/// A hash by products of 64-bit numbers whose halves are added without carry, the *folded multiply* of the hash functions aHash,
/// wyhash and foldhash. One product takes in 16 bytes.
#[derive(Clone, Debug)]
pub struct NameHasher {
    hash: u64,
    factor: u64,
}

/// The product of two numbers, folded to 64 bits.
fn folded(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    (product as u64) ^ ((product >> 64) as u64)
}

/// At most 8 bytes as a number.
fn number(bytes: &[u8]) -> u64 {
    let mut word = [0; 8];
    word[..bytes.len()].copy_from_slice(bytes);
    u64::from_le_bytes(word)
}

impl Hasher for NameHasher {
    fn write(&mut self, bytes: &[u8]) {
        // the length, so that zeros at the end count
        self.hash = self.hash.wrapping_add(bytes.len() as u64);
        for block in bytes.chunks(16) {
            let (low, high) = block.split_at(block.len().min(8));
            self.hash = folded(number(low) ^ self.hash, number(high) ^ self.factor);
        }
    }

    fn write_u8(&mut self, number: u8) {
        self.write_u64(u64::from(number));
    }

    fn write_u32(&mut self, number: u32) {
        self.write_u64(u64::from(number));
    }

    fn write_u64(&mut self, number: u64) {
        self.hash = folded(self.hash ^ number, self.factor);
    }

    fn write_usize(&mut self, number: usize) {
        self.write_u64(number as u64);
    }

    fn finish(&self) -> u64 {
        folded(self.hash, self.factor.rotate_left(32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// No two of 300,000 names and numbers have the same hash (by chance: 1 in 4e8), whatever differs.
    #[test]
    fn different_keys_have_different_hashes() {
        let state = NameState::default();
        let names = (0..100_000u32).map(|k| state.hash_one((k % 3, format!("solid{k}").as_str())));
        let zeros = (0..1000usize).map(|k| state.hash_one(vec![0u8; k].as_slice()));
        let numbers = (0..100_000u64).map(|k| state.hash_one([k, k << 32]));
        let long =
            (0..100_000u32).map(|k| state.hash_one(format!("a name of more than two words {k} and a tail")));
        let hashes: HashSet<u64> = names.chain(zeros).chain(numbers).chain(long).collect();
        assert_eq!(hashes.len(), 301_000);
    }

    /// The low bits, which select the place in a table, and the high ones, which are compared first, spread as random ones do: of
    /// n keys in n places 1 / e stay empty.
    #[test]
    fn hashes_of_names_spread() {
        let state = NameState::default();
        let places = 1usize << 14;
        for shift in [0, 50] {
            let mut taken = vec![false; places];
            (0..places)
                .for_each(|k| taken[(state.hash_one(format!("s{k}")) >> shift) as usize % places] = true);
            let empty = taken.iter().filter(|taken| !**taken).count() as f64 / places as f64;
            assert!((0.34..0.40).contains(&empty), "{shift}: {empty}");
        }
    }

    #[test]
    fn seeds_differ() {
        assert_ne!(NameState::default().hash_one("a"), NameState::default().hash_one("a"));
    }
}
