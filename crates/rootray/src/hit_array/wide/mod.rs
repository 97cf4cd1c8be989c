//! SIMD combination of hit arrays: one ray per lane of a register.
//!
//! Lanes are independent, so the result does not depend on their number. The code branches on values only where a column
//! is unsorted or holds NaN, a signed zero or equal times.

/// Repeats its body for the numbers below `$n`, at most nine, each a constant: arrays of lanes then stay in
/// registers, and bounds checks are removed. Do not use closures in the body: they are not always compiled
/// with the required instruction set.
macro_rules! unrolled {
    ($k:ident < $n:expr => $body:block) => {
        unrolled!(@ $k, $n, $body, 0 1 2 3 4 5 6 7 8)
    };
    (@ $k:ident, $n:expr, $body:block, $($number:literal)*) => {
        $({
            let $k: usize = $number;
            if $k < $n $body
        })*
    };
}

mod block;
mod direct;
mod flags;
mod network;
mod rule;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};

use super::Float;
use super::part::Part;

pub use block::Plan;

/// Below this number of columns the scalar loop is faster.
const FEWEST_COLUMNS: usize = 8;

/// The number of lanes of the widest register.
const WIDEST: usize = 16;

/// Whether the SIMD form is faster than the scalar loop for this number of columns and rows (of both operands together). Networks
/// take O(rows log^2 rows) steps, each for all lanes at once; the limit was measured, and keeps the scratch in the L2 cache.
pub(super) fn pays<T: Float>(level: Level, rows: usize, columns: usize) -> bool {
    let lanes = dispatch!(level, simd => lanes::<_, T>(simd));
    columns >= FEWEST_COLUMNS && rows <= (64 * lanes * lanes).min(2048)
}

#[inline(always)]
fn lanes<S: Simd, T: Float>(_: S) -> usize {
    T::Lanes::<S>::LEN
}

/// Combines the columns of a part. Returns false, with an invalid result, if a column is not sorted or holds NaN.
pub(super) fn combine<T: Float>(level: Level, plan: &Plan, mut part: Part<'_, T, T>) -> bool {
    match plan.rows {
        0..=2 => dispatch!(level, simd => direct::run::<_, T, 2>(simd, plan, &mut part)),
        3..=4 => dispatch!(level, simd => direct::run::<_, T, 4>(simd, plan, &mut part)),
        5..=direct::ROWS => dispatch!(level, simd => direct::run::<_, T, 8>(simd, plan, &mut part)),
        _ => {
            let columns = 0..part.width();
            dispatch!(level, simd => block::run(simd, plan, &mut part, columns))
        }
    }
}

/// Loads up to one number per lane; the remaining lanes are +inf.
#[inline(always)]
fn load<S: Simd, T: Float>(simd: S, numbers: &[T]) -> T::Lanes<S> {
    if numbers.len() == T::Lanes::<S>::LEN {
        return T::Lanes::<S>::from_slice(simd, numbers);
    }
    let mut lanes = [T::INFINITY; WIDEST];
    lanes[..numbers.len()].copy_from_slice(numbers);
    T::Lanes::<S>::from_slice(simd, &lanes[..T::Lanes::<S>::LEN])
}

/// Writes all lanes, or the first ones.
#[inline(always)]
fn store<S: Simd, T: Float>(lanes: T::Lanes<S>, numbers: &mut [T]) {
    if numbers.len() == T::Lanes::<S>::LEN {
        return lanes.store_slice(numbers);
    }
    numbers.copy_from_slice(&lanes.as_slice()[..numbers.len()]);
}
