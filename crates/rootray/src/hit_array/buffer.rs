//! Hit array that owns its memory.

use super::HitArray;
use crate::Side;

/// Reusable hit array that owns its memory: H rows of N columns, stored row by row.
///
/// H is the least even number that holds the fullest column, 0 where all are empty. The entries of a column are those of a
/// root-ray: -inf if it starts inside, then strictly increasing finite times, then +inf.
#[derive(Clone, Debug, Default)]
pub struct HitArrayBuf {
    data: Vec<f64>,
    rows: usize,
    columns: usize,
}

impl HitArrayBuf {
    /// Resets the array to `columns` columns without hits. Keeps the memory.
    pub fn reset(&mut self, columns: usize) {
        self.data.clear();
        self.rows = 0;
        self.columns = columns;
    }

    /// Number of hits per ray, H.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of rays, N.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// A borrowed view of the array.
    pub fn as_array(&self) -> HitArray<'_, f64> {
        HitArray::whole(&self.data, self.rows, self.columns)
    }

    /// Fills an empty column with a root-ray: its start side and its finite, strictly increasing times. Adds rows if needed;
    /// does nothing if the column does not exist.
    pub fn fill_column(&mut self, column: usize, start: Side, times: impl IntoIterator<Item = f64>) {
        let unbounded = start.is_inside().then_some(f64::NEG_INFINITY);
        for (row, t) in unbounded.into_iter().chain(times).enumerate() {
            self.put(row, column, t);
        }
    }

    /// Writes one entry, with two more rows if there is no such row. Rows are filled one after the other.
    pub(super) fn put(&mut self, row: usize, column: usize, t: f64) {
        if column >= self.columns {
            return;
        }
        if row >= self.rows {
            self.rows += 2;
            self.data.resize(self.rows * self.columns, f64::INFINITY);
        }
        self.data[row * self.columns + column] = t;
    }
}
