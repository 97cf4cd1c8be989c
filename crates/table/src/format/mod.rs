//! The formats of tables: one file each.

mod csv;
mod npy;
#[cfg(feature = "parquet")]
mod parquet;

use std::path::Path;

use crate::{Chunk, Schema, TableError};

/// Where chunks go. Chunks have been checked against the schema.
pub(crate) trait Sink: Send {
    /// Appends rows.
    fn write(&mut self, schema: &Schema, chunk: &Chunk) -> Result<(), TableError>;

    /// Completes the file; `rows` is the number of rows in all chunks.
    fn finish(self: Box<Self>, schema: &Schema, rows: u64) -> Result<(), TableError>;
}

/// Opens the format that the path's extension names.
pub(crate) fn open(path: &Path, schema: &Schema) -> Result<Box<dyn Sink>, TableError> {
    if path == Path::new("-") {
        return Ok(Box::new(csv::CsvSink::stdout(schema)?));
    }
    match extension(path).as_str() {
        "csv" => Ok(Box::new(csv::CsvSink::create(path, schema)?)),
        "npy" => Ok(Box::new(npy::NpySink::create(path, schema)?)),
        "parquet" => open_parquet(path, schema),
        _ => Err(TableError::format(
            path,
            "unknown table format (the extension says it: .csv, .npy or .parquet)",
        )),
    }
}

/// The extension in lower case; empty if there is none.
pub(crate) fn extension(path: &Path) -> String {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    extension.unwrap_or_default()
}

#[cfg(feature = "parquet")]
fn open_parquet(path: &Path, schema: &Schema) -> Result<Box<dyn Sink>, TableError> {
    Ok(Box::new(parquet::ParquetSink::create(path, schema)?))
}

#[cfg(not(feature = "parquet"))]
fn open_parquet(path: &Path, _schema: &Schema) -> Result<Box<dyn Sink>, TableError> {
    Err(TableError::format(
        path,
        "this build cannot write Parquet (it is heavy to compile, so it is a cargo feature); \
         build with `--features parquet`, or write .csv or .npy",
    ))
}
