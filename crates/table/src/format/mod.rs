//! Table formats, one file each.

mod csv;
mod npy;
#[cfg(feature = "parquet")]
mod parquet;
mod sink;

use std::path::Path;

use rayweave_error::Message;

use crate::{Schema, TableError};
pub(crate) use sink::Sink;

/// Opens an output of the format given by the path's extension.
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
            Message::new("the table format is unknown", "the extension must be .csv, .npy or .parquet"),
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
        Message::new(
            "this build cannot write Parquet",
            "it was compiled without the cargo feature `parquet`",
        )
        .suggest("Build with `--features parquet`, or write .csv or .npy"),
    ))
}
