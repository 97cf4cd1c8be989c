//! Sorting networks: a few keys of eight rays at a time, without branches.
//!
//! Batcher's odd-even merge sort ("Sorting networks and their applications", 1968), unrolled for up to 16
//! keys so that they stay in registers; more keys use insertion sort.

use super::group::{Row, Rows};
use super::plan::MAX_SPANS;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_shape::lanes::{LANES, Lanes};

/// Applies comparators in order.
macro_rules! comparators {
    ($keys:ident: $(($a:literal, $b:literal))+) => {{$({
        let (a, b) = ($keys[$a], $keys[$b]);
        ($keys[$a], $keys[$b]) = (a.min(b), a.max(b));
    })+}};
}

/// Loads the keys, sorts and stores them.
macro_rules! network {
    ($simd:ident, $rows:ident, $size:literal: $($comparators:tt)+) => {{
        let mut keys: [Lanes<S>; $size] = std::array::from_fn(|k| Lanes::load_array_ref($simd, &$rows[k].0));
        comparators!(keys: $($comparators)+);
        for k in 0..$size {
            keys[k].store_array(&mut $rows[k].0);
        }
    }};
}

/// Sorts an even number of keys, 2 to 10, of as many rays as a register holds.
#[inline(always)]
pub(super) fn sort_few<S: Simd, const N: usize>(keys: &mut [S::f64s; N]) {
    match N {
        2 => comparators!(keys: (0,1)),
        4 => comparators!(keys: (0,1) (2,3) (0,2) (1,3) (1,2)),
        6 => comparators!(keys:
            (0,1) (2,3) (4,5) (0,2) (1,3) (1,2) (0,4) (1,5) (2,4) (3,5) (1,2) (3,4)),
        8 => comparators!(keys:
            (0,1) (2,3) (4,5) (6,7) (0,2) (1,3) (4,6) (5,7) (1,2) (5,6) (0,4) (1,5) (2,6) (3,7) (2,4) (3,5)
            (1,2) (3,4) (5,6)),
        _ => comparators!(keys:
            (0,1) (2,3) (4,5) (6,7) (8,9) (0,2) (1,3) (4,6) (5,7) (1,2) (5,6) (0,4) (1,5) (2,6) (3,7) (2,4)
            (3,5) (1,2) (3,4) (5,6) (0,8) (1,9) (4,8) (5,9) (2,4) (3,5) (6,8) (7,9) (1,2) (3,4) (5,6) (7,8)),
    }
}

/// Sorts the first `count` keys of each lane. Rows after them, up to 16, may be overwritten by +inf.
#[inline(always)]
pub(super) fn sort<S: Simd>(simd: S, rows: &mut Rows, count: usize) {
    let size = match count {
        0..=1 => return,
        2 => 2,
        3..=4 => 4,
        5..=6 => 6,
        7..=8 => 8,
        9..=10 => 10,
        11..=12 => 12,
        13..=16 => 16,
        _ => return insertion(simd, rows, count),
    };
    rows[count..size].fill(Row([f64::INFINITY; LANES]));
    match size {
        2 => network!(simd, rows, 2:
            (0,1)),
        4 => network!(simd, rows, 4:
            (0,1) (2,3) (0,2) (1,3) (1,2)),
        6 => network!(simd, rows, 6:
            (0,1) (2,3) (4,5) (0,2) (1,3) (1,2) (0,4) (1,5) (2,4) (3,5) (1,2) (3,4)),
        8 => network!(simd, rows, 8:
            (0,1) (2,3) (4,5) (6,7) (0,2) (1,3) (4,6) (5,7) (1,2) (5,6) (0,4) (1,5) (2,6) (3,7) (2,4) (3,5)
            (1,2) (3,4) (5,6)),
        10 => network!(simd, rows, 10:
            (0,1) (2,3) (4,5) (6,7) (8,9) (0,2) (1,3) (4,6) (5,7) (1,2) (5,6) (0,4) (1,5) (2,6) (3,7) (2,4)
            (3,5) (1,2) (3,4) (5,6) (0,8) (1,9) (4,8) (5,9) (2,4) (3,5) (6,8) (7,9) (1,2) (3,4) (5,6) (7,8)),
        12 => network!(simd, rows, 12:
            (0,1) (2,3) (4,5) (6,7) (8,9) (10,11) (0,2) (1,3) (4,6) (5,7) (8,10) (9,11) (1,2) (5,6) (9,10)
            (0,4) (1,5) (2,6) (3,7) (2,4) (3,5) (1,2) (3,4) (5,6) (9,10) (0,8) (1,9) (2,10) (3,11) (4,8) (5,9)
            (6,10) (7,11) (2,4) (3,5) (6,8) (7,9) (1,2) (3,4) (5,6) (7,8) (9,10)),
        _ => network!(simd, rows, 16:
            (0,1) (2,3) (4,5) (6,7) (8,9) (10,11) (12,13) (14,15) (0,2) (1,3) (4,6) (5,7) (8,10) (9,11)
            (12,14) (13,15) (1,2) (5,6) (9,10) (13,14) (0,4) (1,5) (2,6) (3,7) (8,12) (9,13) (10,14) (11,15)
            (2,4) (3,5) (10,12) (11,13) (1,2) (3,4) (5,6) (9,10) (11,12) (13,14) (0,8) (1,9) (2,10) (3,11)
            (4,12) (5,13) (6,14) (7,15) (4,8) (5,9) (6,10) (7,11) (2,4) (3,5) (6,8) (7,9) (10,12) (11,13)
            (1,2) (3,4) (5,6) (7,8) (9,10) (11,12) (13,14)),
    }
}

#[inline(always)]
fn insertion<S: Simd>(simd: S, rows: &mut Rows, count: usize) {
    for k in 1..count {
        let mut key = Lanes::load_array_ref(simd, &rows[k % (2 * MAX_SPANS)].0);
        for other in &mut rows[..k] {
            let before = Lanes::load_array_ref(simd, &other.0);
            before.min(key).store_array(&mut other.0);
            key = before.max(key);
        }
        key.store_array(&mut rows[k % (2 * MAX_SPANS)].0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    /// By the zero-one principle (Knuth, The Art of Computer Programming 3, 5.3.4) a network that sorts all
    /// sequences of zeros and ones sorts all sequences.
    #[test]
    fn all_zeros_and_ones_are_sorted() {
        for count in 0..=18usize {
            for bits in (0..1usize << count).step_by(LANES) {
                let mut rows = [Row([f64::NAN; LANES]); 2 * MAX_SPANS];
                for (k, row) in rows[..count].iter_mut().enumerate() {
                    row.0 = std::array::from_fn(|lane| ((bits + lane) >> k & 1) as f64);
                }
                dispatch!(Level::new(), simd => sort(simd, &mut rows, count));
                for lane in 0..LANES {
                    let ones = (0..count).filter(|k| (bits + lane) >> k & 1 == 1).count();
                    for (k, row) in rows[..count].iter().enumerate() {
                        assert_eq!(row.0[lane], f64::from(u8::from(k >= count - ones)), "{count} keys");
                    }
                }
            }
        }
    }
}
