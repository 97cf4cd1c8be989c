//! Boolean operations on hit arrays: options, checks of shapes, and the loop over the rays.

use std::num::NonZeroUsize;

use super::kernel::{self, TruthTable};
use super::part::{self, Part};
use super::scalar::walk;
use super::wide::Plan;
use super::{Float, HitArray, HitArrayError, Instructions};

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

/// Treatment of entries with equal times and of thin pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Regularize<T = f64> {
    /// Keeps pieces of length zero, as Frazier's code does.
    #[default]
    No,
    /// Entries with equal times toggle together, which removes pieces of length zero.
    Exact,
    /// As `Exact`, then drops pieces shorter than this length (finite, not negative; differences are computed in `T`). A run of
    /// times, each closer than this length to the next, is dropped, except for its last time if the run has odd length.
    Weld(T),
}

/// Options of [`array_csg`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CsgOptions<T = f64> {
    /// Whether to sort each column, padding last. Without sorting, dropped entries stay in place as +inf, and the result is
    /// not a valid hit array. Default: true.
    pub sort_output: bool,
    /// Default: `Regularize::No`. Anything else needs `sort_output`.
    pub regularize: Regularize<T>,
    /// Maximum number of threads; small arrays use one. Default: 1.
    pub threads: NonZeroUsize,
    /// Instruction set. Default: the widest available.
    pub instructions: Instructions,
}

impl<T> Default for CsgOptions<T> {
    fn default() -> Self {
        Self {
            sort_output: true,
            regularize: Regularize::No,
            threads: NonZeroUsize::MIN,
            instructions: Instructions::Widest,
        }
    }
}

/// The hits of `array1 operation array2`, row by row: as many rows as both arrays together (H1 + H2) and as many columns as
/// each (N), in which entries that are not kept are +inf. Rows and columns may be 0.
///
/// # Errors
/// `OddRows`, `Columns`, `Nan`, `NotSorted` for the arrays; `MinSep` and `RegularizeUnsorted` for the options.
pub fn array_csg<T: Float>(
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
pub fn array_csg_1d<T: Float>(
    array1: &[T],
    array2: &[T],
    operation: Operation,
    options: CsgOptions<T>,
) -> Result<Vec<T>, HitArrayError> {
    array_csg(HitArray::single(array1), HitArray::single(array2), operation, options)
}

/// [`array_csg`] into memory of the caller.
///
/// The bits of the result depend neither on the number of threads nor on the instruction set. With `sort_output` and without
/// `regularize`, SIMD registers combine several rays at once; otherwise rays are combined one by one.
///
/// # Errors
/// As [`array_csg`]; `OutputLength` unless `out` holds (H1 + H2) * N numbers. After `Nan` or `NotSorted` part of the result may
/// have been written, because entries are checked while they are read; after other errors `out` is unchanged.
pub fn array_csg_into<T: Float>(
    array1: HitArray<'_, T>,
    array2: HitArray<'_, T>,
    operation: Operation,
    options: CsgOptions<T>,
    out: &mut [T],
) -> Result<(), HitArrayError> {
    check_options(options)?;
    check_shapes(&array1, &array2)?;
    let expected = output_len(&array1, &array2);
    if out.len() != expected {
        return Err(HitArrayError::OutputLength { expected, found: out.len() });
    }
    let columns = array1.columns();
    let plain = options.regularize == Regularize::No && options.sort_output;
    if plain
        && columns > 1
        && let Some(level) = options.instructions.level()
        && T::pays(level, array1.rows() + array2.rows(), columns)
    {
        let plan = Plan::new(operation, array1.rows(), array2.rows());
        let parts = Part::whole(array1, array2, &mut *out).split(options.threads);
        if part::all_parts(parts, |part| T::combine(level, &plan, part)) {
            return Ok(());
        }
    }
    check_entries(&array1, &array2)?;
    one_by_one(array1, array2, operation, options, out);
    Ok(())
}

/// [`array_csg_into`] ray by ray, for entries that are sorted.
fn one_by_one<T: Float>(
    array1: HitArray<'_, T>,
    array2: HitArray<'_, T>,
    operation: Operation,
    options: CsgOptions<T>,
    out: &mut [T],
) {
    let table = TruthTable::new(operation);
    let kernel = |a: &[T], b: &[T], out: &mut [T]| match (options.regularize, options.sort_output) {
        (Regularize::No, true) => kernel::keep(table, a, b, out),
        (Regularize::No, false) => kernel::mask(table, a, b, out),
        (Regularize::Exact, _) => kernel::regularize(table, a, b, out),
        (Regularize::Weld(min_sep), _) => {
            kernel::regularize(table, a, b, out);
            kernel::weld(min_sep, out);
        }
    };
    if array1.columns() == 1 {
        return kernel(array1.data(), array2.data(), out);
    }
    let parts = Part::whole(array1, array2, out).split(options.threads);
    part::all_parts(parts, |mut part| {
        let columns = 0..part.width();
        walk(&mut part, columns, kernel);
        true
    });
}

/// Length of the result. The sum cannot overflow: each array holds at most `isize::MAX` bytes.
pub(super) fn output_len<T: Float>(array1: &HitArray<'_, T>, array2: &HitArray<'_, T>) -> usize {
    array1.data().len() + array2.data().len()
}

fn check_options<T: Float>(options: CsgOptions<T>) -> Result<(), HitArrayError> {
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

/// Rejects arrays of incompatible shapes.
fn check_shapes<T: Float>(array1: &HitArray<'_, T>, array2: &HitArray<'_, T>) -> Result<(), HitArrayError> {
    let (columns1, columns2) = (array1.columns(), array2.columns());
    if columns1 != columns2 {
        return Err(HitArrayError::Columns { columns1, columns2 });
    }
    array1.check_rows("array1")?;
    match array2.check_rows("array2") {
        // of several errors the first is reported
        Err(error) => array1.check_entries("array1").and(Err(error)),
        Ok(()) => Ok(()),
    }
}

/// Rejects NaN and unsorted columns.
fn check_entries<T: Float>(array1: &HitArray<'_, T>, array2: &HitArray<'_, T>) -> Result<(), HitArrayError> {
    array1.check_entries("array1")?;
    array2.check_entries("array2")
}

/// Rejects two arrays that cannot be combined.
pub(super) fn check_pair<T: Float>(
    array1: &HitArray<'_, T>,
    array2: &HitArray<'_, T>,
) -> Result<(), HitArrayError> {
    check_shapes(array1, array2)?;
    check_entries(array1, array2)
}
