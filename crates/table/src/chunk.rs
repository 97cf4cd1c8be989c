//! Chunks of rows, stored by column.

use crate::{DType, NO_NAME, Schema, TableError};
use std::sync::Arc;

/// The values of one column in one chunk.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// For [`DType::F64`].
    F64(Vec<f64>),
    /// For [`DType::I64`] and [`DType::Row`].
    I64(Vec<i64>),
    /// For [`DType::I32`].
    I32(Vec<i32>),
    /// For [`DType::Bool`].
    Bool(Vec<bool>),
    /// For [`DType::Name`], dictionary-encoded strings: indices into the column's names, or [`NO_NAME`].
    Name(Vec<u32>),
    /// For [`DType::Text`]. Equal texts should share memory.
    Text(Vec<Arc<str>>),
}

impl Values {
    /// An empty list of values of a type.
    pub fn empty(dtype: &DType) -> Self {
        match dtype {
            DType::F64 => Self::F64(Vec::new()),
            DType::I64 | DType::Row => Self::I64(Vec::new()),
            DType::I32 => Self::I32(Vec::new()),
            DType::Bool => Self::Bool(Vec::new()),
            DType::Name(_) => Self::Name(Vec::new()),
            DType::Text => Self::Text(Vec::new()),
        }
    }

    /// The number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::F64(v) => v.len(),
            Self::I64(v) => v.len(),
            Self::I32(v) => v.len(),
            Self::Bool(v) => v.len(),
            Self::Name(v) => v.len(),
            Self::Text(v) => v.len(),
        }
    }

    /// True if there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all values and keeps the memory.
    #[cfg(feature = "parquet")]
    pub(crate) fn clear(&mut self) {
        match self {
            Self::F64(v) => v.clear(),
            Self::I64(v) => v.clear(),
            Self::I32(v) => v.clear(),
            Self::Bool(v) => v.clear(),
            Self::Name(v) => v.clear(),
            Self::Text(v) => v.clear(),
        }
    }

    /// Appends a range of values of another list of the same type.
    #[cfg(feature = "parquet")]
    pub(crate) fn extend(&mut self, other: &Values, rows: std::ops::Range<usize>) {
        match (self, other) {
            (Self::F64(own), Self::F64(other)) => own.extend_from_slice(&other[rows]),
            (Self::I64(own), Self::I64(other)) => own.extend_from_slice(&other[rows]),
            (Self::I32(own), Self::I32(other)) => own.extend_from_slice(&other[rows]),
            (Self::Bool(own), Self::Bool(other)) => own.extend_from_slice(&other[rows]),
            (Self::Name(own), Self::Name(other)) => own.extend_from_slice(&other[rows]),
            (Self::Text(own), Self::Text(other)) => own.extend_from_slice(&other[rows]),
            // chunks are checked against the schema before they are written
            (own, other) => unreachable!("a column of {} among {}", other.dtype(), own.dtype()),
        }
    }

    fn dtype(&self) -> &'static str {
        match self {
            Self::F64(_) => "f64",
            Self::I64(_) => "i64",
            Self::I32(_) => "i32",
            Self::Bool(_) => "bool",
            Self::Name(_) => "name",
            Self::Text(_) => "text",
        }
    }
}

impl From<Vec<f64>> for Values {
    fn from(values: Vec<f64>) -> Self {
        Self::F64(values)
    }
}

impl From<Vec<i64>> for Values {
    fn from(values: Vec<i64>) -> Self {
        Self::I64(values)
    }
}

impl From<Vec<i32>> for Values {
    fn from(values: Vec<i32>) -> Self {
        Self::I32(values)
    }
}

impl From<Vec<bool>> for Values {
    fn from(values: Vec<bool>) -> Self {
        Self::Bool(values)
    }
}

/// Converts indices of names.
impl From<Vec<u32>> for Values {
    fn from(values: Vec<u32>) -> Self {
        Self::Name(values)
    }
}

impl From<Vec<Arc<str>>> for Values {
    fn from(values: Vec<Arc<str>>) -> Self {
        Self::Text(values)
    }
}

/// A chunk of rows of a table: columns of equal length.
#[derive(Debug, Clone, PartialEq)]
pub struct Chunk {
    columns: Vec<Values>,
    rows: usize,
}

impl Chunk {
    /// A chunk of these columns, in the order of the columns of the table's schema.
    ///
    /// # Errors
    ///
    /// [`TableError::Chunk`] if the columns differ in length.
    pub fn new(columns: Vec<Values>) -> Result<Self, TableError> {
        let rows = columns.first().map_or(0, Values::len);
        match columns.iter().position(|column| column.len() != rows) {
            None => Ok(Self { columns, rows }),
            Some(i) => Err(TableError::Chunk(format!(
                "column {i} has {} values and column 0 has {rows}, but columns must have equal lengths",
                columns[i].len()
            ))),
        }
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The columns.
    pub fn columns(&self) -> &[Values] {
        &self.columns
    }

    /// Checks number and types of the columns and the range of name indices.
    pub(crate) fn check(&self, schema: &Schema) -> Result<(), TableError> {
        let columns = schema.columns();
        if self.columns.len() != columns.len() {
            let problem = format!("it has {} columns, the schema has {}", self.columns.len(), columns.len());
            return Err(TableError::Chunk(problem));
        }
        for (values, column) in self.columns.iter().zip(columns) {
            check_column(values, &column.dtype)
                .map_err(|problem| TableError::Chunk(format!("column {:?} {problem}", column.name)))?;
        }
        Ok(())
    }
}

fn check_column(values: &Values, dtype: &DType) -> Result<(), String> {
    match (values, dtype) {
        (Values::F64(_), DType::F64)
        | (Values::I64(_), DType::I64 | DType::Row)
        | (Values::I32(_), DType::I32)
        | (Values::Bool(_), DType::Bool)
        | (Values::Text(_), DType::Text) => Ok(()),
        (Values::Name(ids), DType::Name(names)) => check_ids(ids, names.len()),
        _ => Err(format!("has values of type {}, the schema has {dtype}", values.dtype())),
    }
}

fn check_ids(ids: &[u32], names: usize) -> Result<(), String> {
    let is_bad = |&id: &u32| id != NO_NAME && id as usize >= names;
    match ids.iter().position(is_bad) {
        None => Ok(()),
        Some(i) => Err(format!("has the name index {} in row {i}, but there are {names} names", ids[i])),
    }
}
