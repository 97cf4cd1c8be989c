//! Interface of table outputs for single formats.

use crate::{Chunk, Schema, TableError};

/// Output of one format. Chunks match the schema.
pub(crate) trait Sink: Send {
    /// Appends rows.
    fn write(&mut self, schema: &Schema, chunk: &Chunk) -> Result<(), TableError>;

    /// Completes the file; `rows` is the total number of rows.
    fn finish(self: Box<Self>, schema: &Schema, rows: u64) -> Result<(), TableError>;
}
