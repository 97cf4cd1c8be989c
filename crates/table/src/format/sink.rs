//! Interface of table outputs for single formats.

use crate::{Chunk, Schema, TableError};

/// Output of one format. Chunks match the schema.
pub(crate) trait Sink: Send {
    /// Lists texts of a column, given by its number, before the rows.
    fn list_texts(&mut self, _column: usize, _texts: &[&str]) {}

    /// Appends rows.
    fn write(&mut self, schema: &Schema, chunk: &Chunk) -> Result<(), TableError>;

    /// Completes the file; `rows` is the total number of rows.
    fn finish(self: Box<Self>, schema: &Schema, rows: u64) -> Result<(), TableError>;
}
