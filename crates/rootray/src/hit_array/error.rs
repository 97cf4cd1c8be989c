//! Errors of hit arrays.

/// The reason why hit arrays cannot be combined. Rows and columns count from 0; `array` is the name of the
/// argument. Of several bad entries the first is reported: `array1` before `array2`, then the lowest column,
/// then the lowest row.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HitArrayError {
    /// The data do not fill the shape.
    #[error(
        "{len} numbers do not fill {rows} rows of {columns} columns: rows times columns must equal the length."
    )]
    Shape {
        /// Numbers given.
        len: usize,
        /// Requested rows.
        rows: usize,
        /// Requested columns.
        columns: usize,
    },
    /// An odd number of rows.
    #[error("{array} has {rows} rows: the number of hits must be even. Pad each column with +inf.")]
    OddRows {
        /// Name of the array.
        array: &'static str,
        /// Its number of rows.
        rows: usize,
    },
    /// Different numbers of rays.
    #[error(
        "array1 has {columns1} columns and array2 has {columns2}: each column is a ray, so both need the same number."
    )]
    Columns {
        /// Columns of `array1`.
        columns1: usize,
        /// Columns of `array2`.
        columns2: usize,
    },
    /// A NaN.
    #[error("{array} row {row}, column {column} is NaN: hits must be numbers. Mark misses with +inf.")]
    Nan {
        /// Name of the array.
        array: &'static str,
        /// Row of the NaN.
        row: usize,
        /// Column of the NaN.
        column: usize,
    },
    /// A column that is not sorted.
    #[error(
        "{array} row {row}, column {column} is {t}, less than {previous} in the row before: columns must be sorted. Sort along axis 0."
    )]
    NotSorted {
        /// Name of the array.
        array: &'static str,
        /// Row of the smaller, later entry.
        row: usize,
        /// Column of both entries.
        column: usize,
        /// The entry before.
        previous: f64,
        /// The smaller, later entry.
        t: f64,
    },
    /// `out` is not as long as the result.
    #[error(
        "out holds {found} numbers, but the result has {expected}: the rows of both arrays together, times the columns."
    )]
    OutputLength {
        /// Length of the result.
        expected: usize,
        /// Length of `out`.
        found: usize,
    },
    /// `regularize` together with `sort_output = false`.
    #[error("regularize needs sort_output: a regularized result has no masked entries to leave in place.")]
    RegularizeUnsorted,
    /// A `min_sep` that is negative, infinite or NaN.
    #[error("min_sep is {min_sep}: it must be finite and not negative.")]
    MinSep {
        /// The value given.
        min_sep: f64,
    },
    /// A root-ray that does not fit into a column.
    #[error("a column of {rows} rows cannot hold a root-ray that needs {needed}")]
    ColumnLength {
        /// Rows of the column.
        rows: usize,
        /// Entries that the root-ray needs.
        needed: usize,
    },
}
