//! Tests of the module `glass`.

mod agf;
mod air;
mod catalogue;
mod dispersion;
mod material;
mod yaml;

/// The rows of a file in `reference/`, without comments and the header, split at commas.
fn rows(text: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').collect())
}

/// Copies of a text with a few of its bytes replaced, moved or dropped, the same on every machine.
fn mutations(text: &str, count: usize) -> impl Iterator<Item = Vec<u8>> {
    use rand::{Rng, RngExt, SeedableRng};
    let mut rng = rand::rngs::ChaCha8Rng::seed_from_u64(5);
    (0..count).map(move |_| {
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..rng.random_range(1..8) {
            let (from, to) = (rng.random_range(0..bytes.len()), rng.random_range(0..bytes.len()));
            match rng.random_range(0..3) {
                0 => bytes[from] = (rng.next_u32() & 0xff) as u8,
                1 => bytes.swap(from, to),
                _ => drop(bytes.remove(from)),
            }
        }
        bytes
    })
}
