//! Streaming table writer for all formats.

use std::path::{Path, PathBuf};

use crate::format::{self, Sink};
use crate::{Chunk, DType, Part, Schema, TableError};
use rayweave_error::Message;

/// Writes a table chunk by chunk, in memory that does not depend on the number of rows, except that NPY files need the
/// distinct texts of columns of text.
///
/// The extension of the path determines the format:
///
/// - `.csv`: a header line, then one line per row (RFC 4180, but lines end with `\n`). Floats are the shortest decimals that
///   read back to the same bits, `inf`, `-inf` and `nan`; booleans are `true` and `false`; names are text. The path `-` is
///   standard output.
/// - `.npy`: a packed one-dimensional structured array, little endian, with indices of names and of texts as `<u4`
///   ([`NO_NAME`](crate::NO_NAME) is 4294967295). If there are columns of names or of texts, `HITS.names.json` in the
///   folder of `HITS.npy` maps each column to its list; texts are in the order in which they first occur, behind
///   those of [`list_texts`](Self::list_texts).
/// - `.parquet`: row groups of about 100,000 rows, with names as text and units in the file metadata (`unit.COLUMN`).
///   Requires the cargo feature `parquet`.
///
/// The path stays untouched until [`finish`](Self::finish). A writer dropped without it, or after an error, removes its temporary
/// file. Output to standard output, devices and pipes cannot be removed.
pub struct TableWriter {
    schema: Schema,
    path: PathBuf,
    rows: u64,
    sink: Box<dyn Sink>,
    failed: bool,
}

impl TableWriter {
    /// Creates a table file.
    ///
    /// # Errors
    ///
    /// [`TableError::Format`] for an unknown extension, or `.parquet` in a build without that feature; [`TableError::Io`] if the
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

    /// The schema.
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// The number of rows written so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Lists texts of a column before the rows: they come first in its list in the file of names of an NPY table,
    /// in this order, whether or not they occur, so that they have equal numbers in all tables. Other formats have no such list,
    /// and unknown columns are ignored.
    pub fn list_texts<'a>(&mut self, column: &str, texts: impl IntoIterator<Item = &'a str>) {
        let number =
            self.schema.columns().iter().position(|own| own.name == column && own.dtype == DType::Text);
        if let Some(number) = number {
            self.sink.list_texts(number, &texts.into_iter().collect::<Vec<_>>());
        }
    }

    /// Appends rows.
    ///
    /// # Errors
    ///
    /// [`TableError::Chunk`] if columns differ from the schema in number or type, or a name index is out of range; the chunk is
    /// then not written. [`TableError::Io`] if writing fails. After an error the table cannot be finished.
    pub fn write(&mut self, chunk: &Chunk) -> Result<(), TableError> {
        let written = chunk.check(&self.schema).and_then(|()| self.sink.write(&self.schema, chunk));
        self.failed |= written.is_err();
        self.rows += chunk.rows() as u64;
        written
    }

    /// Completes the file, renames it to its path, and returns the number of rows.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if an earlier write failed or completion fails. An existing file is then unchanged.
    pub fn finish(self) -> Result<u64, TableError> {
        if self.failed {
            let error = std::io::Error::other("an earlier chunk failed");
            return Err(TableError::io("write", &self.path, error));
        }
        self.sink.finish(&self.schema, self.rows)?;
        Ok(self.rows)
    }

    /// Completes the file like [`finish`](Self::finish), as a part of a table, then writes its description. A run that ends between
    /// the two leaves a file without description, which is not a part.
    ///
    /// # Errors
    ///
    /// Those of `finish`; [`TableError::Format`] for standard output, devices and pipes, which cannot be described.
    pub fn finish_part(self, part: &Part) -> Result<u64, TableError> {
        let (path, part) = (self.path.clone(), part.clone().with_schema(&self.schema));
        TableWriter::check_part(&path)?;
        Part::forget(&path)?;
        let rows = self.finish()?;
        part.describe(&path)?;
        Ok(rows)
    }

    /// Checks that a part can be written to this path.
    ///
    /// # Errors
    ///
    /// [`TableError::Format`] for standard output, devices and pipes.
    pub fn check_part(path: &Path) -> Result<(), TableError> {
        let is_special = path.metadata().is_ok_and(|kind| !kind.is_file());
        if path != Path::new("-") && !is_special {
            return Ok(());
        }
        let message = Message::new("a part cannot be written here", "its description is a file beside it");
        Err(TableError::format(path, message.suggest("Give the name of a file")))
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
