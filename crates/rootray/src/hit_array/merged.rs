//! The entries of many hit arrays, sorted ray by ray.

use super::HitArrayBuf;

/// An entry of one of several arrays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MergedHit {
    /// The time, -inf for a ray that starts inside.
    pub t: f64,
    /// The tag of the array that it comes from.
    pub tag: u32,
    /// True if the ray enters the solid of that array, false if it leaves it.
    pub enters: bool,
}

/// Reusable buffer of the entries of many hit arrays, sorted ray by ray, without padding.
#[derive(Clone, Debug, Default)]
pub struct MergedHits {
    entries: Vec<MergedHit>,
    /// One past the last entry of each column.
    ends: Vec<usize>,
}

impl MergedHits {
    /// Merges arrays of `columns` columns; a tag identifies the entries of each array. Entries of equal times are in no
    /// particular order. Skips arrays with a different number of columns.
    ///
    /// O(H N) for H rows in all, and O(n log n) for the n entries of each column.
    pub fn merge<'a>(
        &mut self,
        columns: usize,
        arrays: impl Iterator<Item = (&'a HitArrayBuf, u32)> + Clone,
    ) {
        let fitting = arrays.filter(|(array, _)| array.columns() == columns && array.rows() > 0);
        self.count(columns, fitting.clone());
        self.fill(fitting);
        for column in 0..columns {
            let range = self.range(column);
            self.entries[range].sort_unstable_by(|a, b| a.t.total_cmp(&b.t));
        }
    }

    /// The entries of one column by time.
    pub fn column(&self, column: usize) -> &[MergedHit] {
        &self.entries[self.range(column)]
    }

    fn range(&self, column: usize) -> std::ops::Range<usize> {
        let first = column.checked_sub(1).map_or(0, |before| self.ends[before]);
        first..self.ends[column]
    }

    /// Counts the entries and allocates; on return `ends` holds the start of each column.
    fn count<'a>(&mut self, columns: usize, arrays: impl Iterator<Item = (&'a HitArrayBuf, u32)>) {
        self.ends.clear();
        self.ends.resize(columns, 0);
        for (array, _) in arrays {
            let array = array.as_array();
            for row in 0..array.rows() {
                let entries = self.ends.iter_mut().zip(array.row(row));
                entries.for_each(|(count, &t)| *count += usize::from(t < f64::INFINITY));
            }
        }
        let mut total = 0;
        for end in &mut self.ends {
            (*end, total) = (total, total + *end);
        }
        self.entries.clear();
        self.entries.resize(total, MergedHit::default());
    }

    /// Writes every entry into its column; on return `ends` holds the end of each column.
    fn fill<'a>(&mut self, arrays: impl Iterator<Item = (&'a HitArrayBuf, u32)>) {
        for (array, tag) in arrays {
            let array = array.as_array();
            for row in 0..array.rows() {
                let enters = row % 2 == 0;
                for (end, &t) in self.ends.iter_mut().zip(array.row(row)) {
                    if t < f64::INFINITY {
                        self.entries[*end] = MergedHit { t, tag, enters };
                        *end += 1;
                    }
                }
            }
        }
    }
}
