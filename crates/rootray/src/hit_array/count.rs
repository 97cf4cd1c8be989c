//! Surface count of two hit arrays: the intermediate step between merged entries and result.

use super::csg::{check_pair, output_len};
use super::kernel::Merge;
use super::part::Part;
use super::scalar::walk;
use super::{Float, HitArray, HitArrayError, Operation};

/// Merged entries and counts, both row by row: H1 + H2 rows, N columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CountArray<T> {
    /// The entries of both arrays in stable order, `array1` first at equal times.
    pub times: Vec<T>,
    /// The count just after each entry, 0 to 2.
    pub counts: Vec<u8>,
}

/// Surface count of Frazier's code: the number of solids that contain the ray just after each merged entry.
/// [`Operation::Difference`] replaces the second solid by its complement, in which the ray starts. Padding entries count, too.
///
/// # Errors
/// `OddRows`, `Columns`, `Nan`, `NotSorted`, as for [`array_csg`](super::array_csg).
pub fn count_array<T: Float>(
    array1: HitArray<'_, T>,
    array2: HitArray<'_, T>,
    operation: Operation,
) -> Result<CountArray<T>, HitArrayError> {
    check_pair(&array1, &array2)?;
    let len = output_len(&array1, &array2);
    let mut counted = vec![(T::ZERO, 0); len];
    let inverted = if operation == Operation::Difference { 2 } else { 0 };
    let mut part = Part::whole(array1, array2, &mut counted);
    let columns = 0..part.width();
    walk(&mut part, columns, |a, b, out| count(inverted, a, b, out));
    let (times, counts) = counted.into_iter().unzip();
    Ok(CountArray { times, counts })
}

/// The merged entries of one ray with the count after each; bit 0 of `state` is set inside the first solid,
/// bit 1 inside the second.
fn count<T: Float>(mut state: u8, first: &[T], second: &[T], out: &mut [(T, u8)]) {
    for ((t, bit), out) in Merge::new(first, second).zip(out) {
        state ^= bit;
        *out = (t, state.count_ones() as u8);
    }
}
