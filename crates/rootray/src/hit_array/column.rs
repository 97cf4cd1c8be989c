//! A column of a hit array as a root-ray, and back.

use super::array::check_column;
use super::{Float, HitArrayError};
use crate::{Root, RootRay, Side};

/// The root-ray of one column: entries of -inf give the start side (an odd number is inside), equal finite entries cancel in
/// pairs, +inf is dropped. An `f32` entry becomes the same number as `f64`.
///
/// # Errors
/// `OddRows`, `Nan` or `NotSorted`, with "column" as the array's name and column 0.
pub fn from_column<T: Float>(column: &[T]) -> Result<RootRay, HitArrayError> {
    if column.len() % 2 == 1 {
        return Err(HitArrayError::OddRows { array: "column", rows: column.len() });
    }
    check_column("column", 0, column.iter().copied())?;
    let unbounded = column.partition_point(|t| t.to_f64() == f64::NEG_INFINITY);
    let padding = column.partition_point(|&t| t < T::INFINITY);
    let finite = &column[unbounded..padding];
    let odd_groups = finite.chunk_by(|a, b| a == b).filter(|group| group.len() % 2 == 1);
    // adding zero turns -0 into 0, which a root-ray stores
    let roots = odd_groups.map(|group| Root::new(group[0].to_f64() + 0.0, ())).collect();
    Ok(RootRay::from_ordered(Side::Outside.after(unbounded), roots))
}

/// The rows that a root-ray needs in a hit array: the least even number, at least 2, that holds its roots, and -inf if it
/// starts inside.
pub fn column_len<S>(ray: &RootRay<S>) -> usize {
    entries(ray).next_multiple_of(2).max(2)
}

/// The root-ray as a column of [`column_len`] rows: -inf if it starts inside, the roots, then +inf.
pub fn to_column<S>(ray: &RootRay<S>) -> Vec<f64> {
    let start = ray.start().is_inside().then_some(f64::NEG_INFINITY);
    let mut column: Vec<f64> = start.into_iter().chain(ray.times()).collect();
    column.resize(column_len(ray), f64::INFINITY);
    column
}

/// Writes the root-ray into `rows`, one entry each: -inf if it starts inside, the roots, then +inf. A column of a row-major
/// array is `data.iter_mut().skip(column).step_by(columns)`.
///
/// # Errors
/// `ColumnLength` if there are fewer rows than entries; `OddRows` if their number is odd. Nothing is written then.
pub fn write_column<'a, S>(
    ray: &RootRay<S>,
    rows: impl ExactSizeIterator<Item = &'a mut f64>,
) -> Result<(), HitArrayError> {
    let (len, needed) = (rows.len(), entries(ray));
    if len < needed {
        return Err(HitArrayError::ColumnLength { rows: len, needed });
    }
    if len % 2 == 1 {
        return Err(HitArrayError::OddRows { array: "column", rows: len });
    }
    let start = ray.start().is_inside().then_some(f64::NEG_INFINITY);
    let padded = start.into_iter().chain(ray.times()).chain(std::iter::repeat(f64::INFINITY));
    rows.zip(padded).for_each(|(row, t)| *row = t);
    Ok(())
}

/// The number of entries below +inf in the column of a root-ray.
fn entries<S>(ray: &RootRay<S>) -> usize {
    ray.roots().len() + usize::from(ray.start().is_inside())
}
