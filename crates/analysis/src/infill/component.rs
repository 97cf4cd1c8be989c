//! Connected components of the traces of a layer.

use super::region::Piece;

/// For each piece of a layer, sorted by line, then time, the first piece of its component.
///
/// Two pieces on adjacent lines are connected if their open ranges overlap. Union-find with the earliest
/// piece of a set as its root; O(n log n) in the worst case, O(n) in practice.
pub fn components(pieces: &[Piece]) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..pieces.len() as u32).collect();
    let mut lines = pieces.chunk_by(|a, b| a.0 == b.0);
    let mut below: (usize, &[Piece]) = (0, lines.next().unwrap_or_default());
    for own in lines {
        let here = below.0 + below.1.len();
        if below.1[0].0 + 1 == own[0].0 {
            for (a, b) in overlaps(below.1, own) {
                join(&mut parent, (below.0 + a) as u32, (here + b) as u32);
            }
        }
        below = (here, own);
    }
    (0..pieces.len() as u32).map(|k| root(&mut parent, k)).collect()
}

/// The pairs of overlapping pieces of two lines, by their numbers.
fn overlaps<'a>(below: &'a [Piece], own: &'a [Piece]) -> impl Iterator<Item = (usize, usize)> + 'a {
    let (mut a, mut b) = (0, 0);
    std::iter::from_fn(move || {
        while a < below.len() && b < own.len() {
            let ([a_from, a_to], [b_from, b_to]) = (below[a].1, own[b].1);
            let pair = (a, b);
            // the piece that ends first overlaps no further piece
            match a_to < b_to {
                true => a += 1,
                false => b += 1,
            }
            if a_from < b_to && b_from < a_to {
                return Some(pair);
            }
        }
        None
    })
}

fn root(parent: &mut [u32], mut k: u32) -> u32 {
    while parent[k as usize] != k {
        // path halving, which speeds up later searches
        parent[k as usize] = parent[parent[k as usize] as usize];
        k = parent[k as usize];
    }
    k
}

fn join(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    #[test]
    fn the_picture_of_the_manual() {
        let pieces = [
            (0, [2.0, 12.0]),
            (1, [0.0, 13.0]),
            (2, [1.0, 4.0]),
            (2, [9.0, 12.0]),
            (3, [2.0, 3.0]),
            (3, [10.0, 11.0]),
        ];
        assert_eq!(components(&pieces), [0; 6]);
        assert_eq!(components(&pieces[2..]), [0, 1, 0, 1]);
        assert_eq!(components(&[]), [0; 0]);
        // a missing line separates the lines below from those above; a common point does not connect
        assert_eq!(components(&[(0, [0.0, 1.0]), (2, [0.0, 1.0])]), [0, 1]);
        assert_eq!(components(&[(0, [0.0, 1.0]), (1, [1.0, 2.0])]), [0, 1]);
    }

    /// Compared with flood filling, pair by pair.
    #[test]
    fn random_pieces_agree_with_flooding() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..500 {
            let mut pieces: Vec<Piece> = Vec::new();
            for line in 0..rng.random_range(1..12) {
                let mut at = 0;
                while at < 20 && rng.random_bool(0.8) {
                    let from = at + rng.random_range(1..5);
                    at = from + rng.random_range(1..6);
                    pieces.push((line, [f64::from(from), f64::from(at)]));
                }
            }
            let n = pieces.len();
            let touch = |a: &Piece, b: &Piece| (a.0 - b.0).abs() == 1 && a.1[0] < b.1[1] && b.1[0] < a.1[1];
            let mut label: Vec<u32> = (0..n as u32).collect();
            for _ in 0..n {
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    if touch(&pieces[i], &pieces[j]) {
                        label[i] = label[i].min(label[j]);
                    }
                }
            }
            assert_eq!(components(&pieces), label, "{pieces:?}");
        }
    }
}
