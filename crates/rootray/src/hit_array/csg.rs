//! Boolean operations on hit arrays: the shapes, the checks and the walk over the rays.

use super::kernel::{self, TruthTable};
use super::{HitArray, HitArrayError, Real};

/// A boolean operation on two solids.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// Inside either.
    Union,
    /// Inside both.
    Intersect,
    /// Inside the first and not the second.
    Difference,
}

/// What becomes of entries with equal times and of thin pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Regularize<T = f64> {
    /// Nothing: pieces of length zero stay, as in the code by Frazier.
    #[default]
    No,
    /// Entries with equal times flip together; pieces of length zero are gone.
    Exact,
    /// As `Exact`; then pieces shorter than this length are dropped (finite, not negative; differences are taken in `T`). A
    /// run of times of which each is closer than this to the next becomes nothing, or its last time if it is of odd length.
    Weld(T),
}

/// How [`array_csg`] writes its result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CsgOptions<T = f64> {
    /// Whether each column is sorted, the padding last. If not, entries that are not kept stay as +inf in their places
    /// among the merged ones, which is not a valid hit array. Default: true.
    pub sort_output: bool,
    /// Default: `Regularize::No`. Anything else needs `sort_output`.
    pub regularize: Regularize<T>,
}

impl<T> Default for CsgOptions<T> {
    fn default() -> Self {
        Self { sort_output: true, regularize: Regularize::No }
    }
}

/// The hits of `array1 operation array2`, row by row: as many rows as both arrays together (H1 + H2) and as many columns as
/// each (N), in which entries that are not kept are +inf. Rows and columns may be 0.
///
/// # Errors
/// `OddRows`, `Columns`, `Nan`, `NotSorted` for the arrays; `MinSep` and `RegularizeUnsorted` for the options.
pub fn array_csg<T: Real>(
    array1: HitArray<'_, T>,
    array2: HitArray<'_, T>,
    operation: Operation,
    options: CsgOptions<T>,
) -> Result<Vec<T>, HitArrayError> {
    let mut out = vec![T::INFINITY; output_len(&array1, &array2)];
    array_csg_into(array1, array2, operation, options, &mut out)?;
    Ok(out)
}

/// [`array_csg`] for one ray.
///
/// # Errors
/// As [`array_csg`].
pub fn array_csg_1d<T: Real>(
    array1: &[T],
    array2: &[T],
    operation: Operation,
    options: CsgOptions<T>,
) -> Result<Vec<T>, HitArrayError> {
    array_csg(HitArray::single(array1), HitArray::single(array2), operation, options)
}

/// [`array_csg`] into memory of the caller, which is left as it was if there is an error.
///
/// # Errors
/// As [`array_csg`]; `OutputLength` unless `out` holds (H1 + H2) * N numbers.
pub fn array_csg_into<T: Real>(
    array1: HitArray<'_, T>,
    array2: HitArray<'_, T>,
    operation: Operation,
    options: CsgOptions<T>,
    out: &mut [T],
) -> Result<(), HitArrayError> {
    check_options(options)?;
    check_pair(&array1, &array2)?;
    let expected = output_len(&array1, &array2);
    if out.len() != expected {
        return Err(HitArrayError::OutputLength { expected, found: out.len() });
    }
    let table = TruthTable::new(operation);
    match (options.regularize, options.sort_output) {
        (Regularize::No, true) => walk(&array1, &array2, out, |a, b, out| kernel::keep(table, a, b, out)),
        (Regularize::No, false) => walk(&array1, &array2, out, |a, b, out| kernel::mask(table, a, b, out)),
        (Regularize::Exact, _) => {
            walk(&array1, &array2, out, |a, b, out| kernel::regularize(table, a, b, out))
        }
        (Regularize::Weld(min_sep), _) => walk(&array1, &array2, out, |a, b, out| {
            kernel::regularize(table, a, b, out);
            kernel::weld(min_sep, out);
        }),
    }
    Ok(())
}

/// Numbers in the result. The sum cannot overflow where the arrays exist: each holds at most `isize::MAX` bytes.
pub(super) fn output_len<T: Real>(array1: &HitArray<'_, T>, array2: &HitArray<'_, T>) -> usize {
    array1.data().len() + array2.data().len()
}

fn check_options<T: Real>(options: CsgOptions<T>) -> Result<(), HitArrayError> {
    if let Regularize::Weld(min_sep) = options.regularize
        && !(min_sep >= T::ZERO && min_sep < T::INFINITY)
    {
        return Err(HitArrayError::MinSep { min_sep: min_sep.to_f64() });
    }
    if options.regularize != Regularize::No && !options.sort_output {
        return Err(HitArrayError::RegularizeUnsorted);
    }
    Ok(())
}

/// Refuses two arrays that cannot be combined.
pub(super) fn check_pair<T: Real>(
    array1: &HitArray<'_, T>,
    array2: &HitArray<'_, T>,
) -> Result<(), HitArrayError> {
    let (columns1, columns2) = (array1.columns(), array2.columns());
    if columns1 != columns2 {
        return Err(HitArrayError::Columns { columns1, columns2 });
    }
    array1.check("array1")?;
    array2.check("array2")
}

/// Rays handled together. Two cache lines of f64 per row: whole lines are moved, and the scratch stays in the cache.
const BLOCK: usize = 16;

/// Calls `kernel` with the two columns and the output column of every ray.
///
/// Blocks of columns are turned into contiguous scratch and back, so that a kernel sees slices, and rows that lie a power of
/// two apart do not fight for the same cache set. The scratch is allocated once.
pub(super) fn walk<T: Real, O: Copy + Default>(
    array1: &HitArray<'_, T>,
    array2: &HitArray<'_, T>,
    out: &mut [O],
    mut kernel: impl FnMut(&[T], &[T], &mut [O]),
) {
    let (rows1, rows2, columns) = (array1.rows(), array2.rows(), array1.columns());
    let rows = rows1 + rows2;
    let width = BLOCK.min(columns);
    let mut scratch1 = vec![T::ZERO; rows1 * width];
    let mut scratch2 = vec![T::ZERO; rows2 * width];
    let mut result = vec![O::default(); rows * width];
    for start in (0..columns).step_by(BLOCK) {
        let width = BLOCK.min(columns - start);
        load(array1, start, width, &mut scratch1);
        load(array2, start, width, &mut scratch2);
        for lane in 0..width {
            let first = &scratch1[lane * rows1..][..rows1];
            let second = &scratch2[lane * rows2..][..rows2];
            kernel(first, second, &mut result[lane * rows..][..rows]);
        }
        store(&result, start, width, columns, out);
    }
}

/// Copies `width` columns from `start` on, each to a contiguous stretch.
fn load<T: Real>(array: &HitArray<'_, T>, start: usize, width: usize, scratch: &mut [T]) {
    let rows = array.rows();
    for row in 0..rows {
        for (lane, &t) in array.row(row)[start..start + width].iter().enumerate() {
            scratch[lane * rows + row] = t;
        }
    }
}

/// Copies `width` contiguous columns to the columns from `start` on.
fn store<O: Copy>(result: &[O], start: usize, width: usize, columns: usize, out: &mut [O]) {
    let rows = out.len() / columns;
    for row in 0..rows {
        for (lane, entry) in out[row * columns + start..][..width].iter_mut().enumerate() {
            *entry = result[lane * rows + row];
        }
    }
}
