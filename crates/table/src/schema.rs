//! Schema of a table: names, types and units of columns.

use std::collections::HashSet;
use std::fmt;
use std::sync::Arc;

use crate::TableError;

/// The id that represents a missing value in a [`DType::Name`] column: an empty field in CSV, null in Parquet.
pub const NO_NAME: u32 = u32::MAX;

/// Data type of a column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DType {
    /// 64-bit floating point, including NaN and infinities.
    F64,
    /// 64-bit signed integer.
    I64,
    /// The number of a row of the same table, from 0, or a negative number: 64-bit signed integer.
    Row,
    /// 32-bit signed integer.
    I32,
    /// True or false.
    Bool,
    /// An index into this table of names (a categorical value), or [`NO_NAME`].
    Name(Arc<[String]>),
    /// Text that is not known in advance and may repeat.
    Text,
}

impl DType {
    /// The type string of NumPy, little endian.
    pub(crate) fn npy(&self) -> &'static str {
        match self {
            Self::F64 => "<f8",
            Self::I64 | Self::Row => "<i8",
            Self::I32 => "<i4",
            Self::Bool => "|b1",
            Self::Name(_) | Self::Text => "<u4",
        }
    }

    /// The size of a value in NPY, in bytes.
    pub(crate) fn size(&self) -> usize {
        match self {
            Self::F64 | Self::I64 | Self::Row => 8,
            Self::I32 | Self::Name(_) | Self::Text => 4,
            Self::Bool => 1,
        }
    }
}

impl fmt::Display for DType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::F64 => "f64",
            Self::I64 => "i64",
            Self::Row => "row",
            Self::I32 => "i32",
            Self::Bool => "bool",
            Self::Name(_) => "name",
            Self::Text => "text",
        })
    }
}

/// A column of a table: name, type and unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// The name, which must not be empty and must be unique in its schema.
    pub name: String,
    /// The type of the values.
    pub dtype: DType,
    /// The unit of the values, such as "mm". Stored in Parquet files (file metadata `unit.NAME`); CSV and NPY cannot store it.
    pub unit: Option<String>,
}

impl Column {
    /// A column without a unit.
    pub fn new(name: impl Into<String>, dtype: DType) -> Self {
        Self { name: name.into(), dtype, unit: None }
    }

    /// A column of indices into `names`. Columns may share one table.
    pub fn names(name: impl Into<String>, names: Arc<[String]>) -> Self {
        Self::new(name, DType::Name(names))
    }

    /// The column with a unit.
    #[must_use]
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = Some(unit.into());
        self
    }
}

/// The columns of a table, in order. Cheap to clone.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schema {
    columns: Arc<[Column]>,
}

impl Schema {
    /// A schema of these columns.
    ///
    /// # Errors
    ///
    /// [`TableError::Schema`] if there are no columns, or a name is empty or occurs twice.
    pub fn new(columns: Vec<Column>) -> Result<Self, TableError> {
        if columns.is_empty() {
            return Err(TableError::Schema("it has no columns".into()));
        }
        let mut seen = HashSet::new();
        for (i, column) in columns.iter().enumerate() {
            if column.name.is_empty() {
                return Err(TableError::Schema(format!("column {i} has no name")));
            }
            if !seen.insert(&column.name) {
                let problem = format!("two columns have the name {:?}", column.name);
                return Err(TableError::Schema(problem));
            }
        }
        Ok(Self { columns: columns.into() })
    }

    /// The columns, in order.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }
}
