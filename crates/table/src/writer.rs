//! One table into a file of any format.

use std::path::{Path, PathBuf};

use crate::format::{self, Sink};
use crate::{Chunk, Schema, TableError};

/// Writes a table chunk by chunk; memory does not grow with the number of rows.
///
/// The extension of the path says the format:
///
/// - `.csv`: a header line, then one line a row (RFC 4180, but lines end with `\n`). Floats in the shortest form that
///   reads back to the same bits, `inf`, `-inf`, `nan`; booleans `true`, `false`; names as text. The path `-` is
///   standard output.
/// - `.npy`: a one-dimensional structured array, little endian, packed; name ids as `<u4`
///   ([`NO_NAME`](crate::NO_NAME) is 4294967295). Beside `HITS.npy` stands `HITS.names.json`, an object from column
///   name to the list of names, if there are columns of names.
/// - `.parquet`: row groups of about 100,000 rows, names as text, units in the file's metadata (`unit.COLUMN`). Needs
///   the cargo feature `parquet`.
///
/// Nothing appears under the path before [`finish`](Self::finish); dropped without it, or after an error, the writer
/// removes what it wrote. (Standard output, devices and pipes cannot be taken back.)
pub struct TableWriter {
    schema: Schema,
    path: PathBuf,
    rows: u64,
    sink: Box<dyn Sink>,
    failed: bool,
}

impl TableWriter {
    /// Opens a table.
    ///
    /// # Errors
    ///
    /// [`TableError::Format`] for an unknown extension, or `.parquet` in a build without it; [`TableError::Io`] if the
    /// file cannot be created.
    pub fn create(path: impl AsRef<Path>, schema: &Schema) -> Result<Self, TableError> {
        let path = path.as_ref();
        Ok(Self {
            schema: schema.clone(),
            path: path.to_path_buf(),
            rows: 0,
            sink: format::open(path, schema)?,
            failed: false,
        })
    }

    /// The columns.
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// The number of rows written so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Appends rows.
    ///
    /// # Errors
    ///
    /// [`TableError::Chunk`] if columns differ from the schema in number or type, or a name id is out of range (nothing
    /// of the chunk is written then); [`TableError::Io`] if writing fails. After an error the table cannot be finished.
    pub fn write(&mut self, chunk: &Chunk) -> Result<(), TableError> {
        let written = chunk.check(&self.schema).and_then(|()| self.sink.write(&self.schema, chunk));
        self.failed |= written.is_err();
        self.rows += chunk.rows() as u64;
        written
    }

    /// Completes the file, gives it its name, and returns the number of rows.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if an earlier write failed or completing fails; there is then no file, or the earlier one.
    pub fn finish(self) -> Result<u64, TableError> {
        if self.failed {
            let error = std::io::Error::other("an earlier chunk failed");
            return Err(TableError::io("write", &self.path, error));
        }
        self.sink.finish(&self.schema, self.rows)?;
        Ok(self.rows)
    }
}

impl std::fmt::Debug for TableWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TableWriter")
            .field("path", &self.path)
            .field("rows", &self.rows)
            .finish_non_exhaustive()
    }
}
