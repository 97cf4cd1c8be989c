//! A borrowed hit array and the check of its contents.

use super::{Float, HitArrayError};

/// A borrowed hit array: `rows` hits of `columns` rays, row after row without gaps.
#[derive(Clone, Copy, Debug)]
pub struct HitArray<'a, T> {
    data: &'a [T],
    rows: usize,
    columns: usize,
}

impl<'a, T: Float> HitArray<'a, T> {
    /// The array with this shape; either number may be 0. The operations check the contents.
    ///
    /// # Errors
    /// `Shape` unless `data` holds `rows * columns` numbers.
    pub fn new(data: &'a [T], rows: usize, columns: usize) -> Result<Self, HitArrayError> {
        if rows.checked_mul(columns) != Some(data.len()) {
            return Err(HitArrayError::Shape { len: data.len(), rows, columns });
        }
        Ok(Self { data, rows, columns })
    }

    /// The hits of a single ray.
    pub const fn single(column: &'a [T]) -> Self {
        Self { data: column, rows: column.len(), columns: 1 }
    }

    /// The array with this shape, which holds all of the data.
    pub(super) const fn whole(data: &'a [T], rows: usize, columns: usize) -> Self {
        Self { data, rows, columns }
    }

    /// Number of hits per ray, H.
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// Number of rays, N.
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// All numbers, row by row.
    pub const fn data(&self) -> &'a [T] {
        self.data
    }

    /// Row `row`, one entry per ray.
    pub(crate) fn row(&self, row: usize) -> &'a [T] {
        &self.data[row * self.columns..][..self.columns]
    }

    /// The entries of column `column` in order, none if there is no such column.
    pub fn column(&self, column: usize) -> impl Iterator<Item = T> + use<'a, T> {
        let used = if column < self.columns { self.data } else { &[] };
        used.iter().skip(column).step_by(self.columns.max(1)).copied()
    }

    /// Rejects an odd number of rows; `name` is the array's name in messages.
    pub(crate) fn check_rows(&self, name: &'static str) -> Result<(), HitArrayError> {
        if self.rows % 2 == 1 {
            return Err(HitArrayError::OddRows { array: name, rows: self.rows });
        }
        Ok(())
    }

    /// Rejects NaN and unsorted columns. The number of rows must be even.
    pub(crate) fn check_entries(&self, name: &'static str) -> Result<(), HitArrayError> {
        if self.is_sorted() {
            return Ok(());
        }
        (0..self.columns).try_for_each(|column| check_column(name, column, self.column(column)))
    }

    /// Whether every entry is at least the one above it; false if there is a NaN, as every column has two
    /// entries or none.
    fn is_sorted(&self) -> bool {
        (1..self.rows).all(|row| {
            let pairs = self.row(row - 1).iter().zip(self.row(row));
            // no early exit within a row: the loop stays free of branches
            pairs.fold(true, |sorted, (above, below)| sorted & (above <= below))
        })
    }
}

/// Rejects a column that holds NaN or is not sorted.
pub(crate) fn check_column<T: Float>(
    array: &'static str,
    column: usize,
    entries: impl Iterator<Item = T>,
) -> Result<(), HitArrayError> {
    let mut previous = f64::NEG_INFINITY;
    for (row, t) in entries.map(Float::to_f64).enumerate() {
        if t.is_nan() {
            return Err(HitArrayError::Nan { array, row, column });
        }
        if t < previous {
            return Err(HitArrayError::NotSorted { array, row, column, previous, t });
        }
        previous = t;
    }
    Ok(())
}
