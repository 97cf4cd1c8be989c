//! Random models made of a few parts.

use rayweave_conformance::Random;
use rayweave_math::Affine;
use rayweave_model::{Region, Solid};

/// One solid of the parts, a region for each part, or regions that share parts, in a frame.
pub fn regions(rng: &mut Random, parts: &[Solid], frame: &Affine) -> Vec<Region> {
    let solids: Vec<Solid> = match rng.below(4) {
        0..2 => vec![joined(rng, parts)],
        2 => parts.to_vec(),
        _ => {
            let count = 2 + rng.below(2);
            let one = |_| {
                let some = some(rng, parts);
                joined(rng, &some)
            };
            (0..count).map(one).collect()
        }
    };
    let plain = solids.len() == 1 && rng.chance(0.9);
    let region = |(k, solid): (usize, Solid)| {
        // three media, one of them that of the world, so that regions often have equal media
        let medium = if plain { 1 } else { rng.below(3) as u32 };
        Region { name: format!("r{k}"), solid: solid.apply(*frame), medium }
    };
    solids.into_iter().enumerate().map(region).collect()
}

/// A random non-empty subset of the parts, in random order.
fn some(rng: &mut Random, parts: &[Solid]) -> Vec<Solid> {
    let order = rng.order(parts.len());
    order[..1 + rng.below(parts.len())].iter().map(|&k| parts[k].clone()).collect()
}

/// A random expression with each part once, or one of them twice.
fn joined(rng: &mut Random, parts: &[Solid]) -> Solid {
    let mut open = parts.to_vec();
    if rng.chance(0.15) {
        open.push(parts[rng.below(parts.len())].clone());
    }
    while open.len() > 1 {
        let a = open.swap_remove(rng.below(open.len()));
        let b = open.swap_remove(rng.below(open.len()));
        let both = match rng.below(8) {
            0..3 => a | b,
            3..5 => a & b,
            5..7 => a - b,
            _ => a ^ b,
        };
        open.push(if rng.chance(0.1) { !both } else { both });
    }
    open.swap_remove(0)
}
