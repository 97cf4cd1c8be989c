//! Scalar loop over the rays, one at a time: the reference that all SIMD forms must match to the bit.

use std::ops::Range;

use super::Float;
use super::part::Part;

/// Columns handled together: two cache lines of f64 per row, so that whole lines are copied and the scratch
/// stays in the cache.
const BLOCK: usize = 16;

/// Calls `kernel` with the two columns and the output column of every ray of a range.
///
/// Blocks of columns are transposed into contiguous scratch and back, so that a kernel works on slices, and rows a power of
/// two apart do not compete for one cache set. The scratch is allocated once.
pub(super) fn walk<T: Float, O: Copy + Default>(
    part: &mut Part<'_, T, O>,
    columns: Range<usize>,
    mut kernel: impl FnMut(&[T], &[T], &mut [O]),
) {
    let (rows1, rows2) = (part.rows1.len(), part.rows2.len());
    let rows = rows1 + rows2;
    let width = BLOCK.min(columns.len());
    let mut scratch1 = vec![T::ZERO; rows1 * width];
    let mut scratch2 = vec![T::ZERO; rows2 * width];
    let mut result = vec![O::default(); rows * width];
    for start in columns.clone().step_by(BLOCK) {
        let block = start..columns.end.min(start + BLOCK);
        load(&part.rows1, block.clone(), &mut scratch1);
        load(&part.rows2, block.clone(), &mut scratch2);
        for lane in 0..block.len() {
            let first = &scratch1[lane * rows1..][..rows1];
            let second = &scratch2[lane * rows2..][..rows2];
            kernel(first, second, &mut result[lane * rows..][..rows]);
        }
        store(&result, block, &mut part.out);
    }
}

/// Copies columns, each to a contiguous slice.
fn load<T: Copy>(rows: &[&[T]], block: Range<usize>, scratch: &mut [T]) {
    for (row, numbers) in rows.iter().enumerate() {
        for (lane, &t) in numbers[block.clone()].iter().enumerate() {
            scratch[lane * rows.len() + row] = t;
        }
    }
}

/// Copies contiguous columns to their places.
fn store<O: Copy>(result: &[O], block: Range<usize>, out: &mut [&mut [O]]) {
    let rows = out.len();
    for (row, numbers) in out.iter_mut().enumerate() {
        for (lane, entry) in numbers[block.clone()].iter_mut().enumerate() {
            *entry = result[lane * rows + row];
        }
    }
}
