//! A sorting network for ten elements.

use super::lanes::Lanes;

/// A time and the number of the face hit at that time.
pub type End<L> = (L, <L as Lanes>::Numbers);

/// Sorts two ends.
#[inline(always)]
pub fn order<L: Lanes>(ends: &mut [End<L>; 10], i: usize, k: usize) {
    let ((t, face), (t2, face2)) = (ends[i], ends[k]);
    let swap = t2.below(t);
    ends[i] = (L::choose(swap, t2, t), L::choose_number(swap, face2, face));
    ends[k] = (L::choose(swap, t, t2), L::choose_number(swap, face, face2));
}

/// Sorts ten ends by time: the network of 29 comparators by Waksman (Knuth, The Art of Computer
/// Programming 3, 5.3.4, figure 49), unrolled so that everything stays in registers.
#[inline(always)]
pub fn sort<L: Lanes>(e: &mut [End<L>; 10]) {
    macro_rules! comparators {
        ($($i:literal $k:literal),*) => { $( order(e, $i, $k); )* };
    }
    comparators!(0 8, 1 9, 2 7, 3 5, 4 6);
    comparators!(0 2, 1 4, 5 8, 7 9);
    comparators!(0 3, 2 4, 5 7, 6 9);
    comparators!(0 1, 3 6, 8 9);
    comparators!(1 5, 2 3, 4 8, 6 7);
    comparators!(1 2, 3 5, 4 6, 7 8);
    comparators!(2 3, 4 5, 6 7);
    comparators!(3 4, 5 6);
}

#[cfg(test)]
mod tests {
    use super::super::lanes::{Counted, Tally};
    use super::*;

    /// Zero-one principle: a network sorts everything if it sorts all sequences of zeros and ones
    /// (Knuth, 5.3.4, theorem Z).
    #[test]
    fn sorts_all_zeros_and_ones() {
        let tally = Tally::default();
        let zero = Counted::zero(&tally);
        for bits in 0..1_u32 << 10 {
            let mut ends = std::array::from_fn(|i| {
                let bit = bits >> i & 1;
                (zero.like(f64::from(bit)), zero.number(i64::from(bit)))
            });
            sort(&mut ends);
            let (mut times, mut faces) = ([0.0; 10], [0; 10]);
            for (i, (t, face)) in ends.into_iter().enumerate() {
                t.store(&mut times[i..=i]);
                Counted::store_numbers([face, face], [&mut [0], &mut faces[i..=i]]);
            }
            let ones = bits.count_ones() as usize;
            assert!(times[..10 - ones].iter().all(|&t| t == 0.0), "{bits:010b}");
            assert!(times[10 - ones..].iter().all(|&t| t == 1.0), "{bits:010b}");
            assert_eq!(times, faces.map(f64::from), "faces go with their times");
        }
    }
}
