//! CSV writer: comma-separated values by RFC 4180, with lines ending in `\n`.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::chunk::Values;
use crate::format::Sink;
use crate::{AtomicFile, Chunk, Column, DType, NO_NAME, Schema, TableError};

/// Output to a CSV file or to standard output.
pub(super) struct CsvSink {
    csv: ::csv::Writer<Output>,
    path: PathBuf,
}

enum Output {
    File(AtomicFile),
    Stdout(io::Stdout),
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.write(bytes),
            Self::Stdout(stdout) => stdout.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::File(file) => file.flush(),
            Self::Stdout(stdout) => stdout.flush(),
        }
    }
}

impl CsvSink {
    pub(super) fn create(path: &Path, schema: &Schema) -> Result<Self, TableError> {
        Self::start(Output::File(AtomicFile::create(path)?), path, schema)
    }

    pub(super) fn stdout(schema: &Schema) -> Result<Self, TableError> {
        Self::start(Output::Stdout(io::stdout()), Path::new("standard output"), schema)
    }

    fn start(output: Output, path: &Path, schema: &Schema) -> Result<Self, TableError> {
        let mut csv = ::csv::WriterBuilder::new().buffer_capacity(1 << 16).from_writer(output);
        let header = schema.columns().iter().map(|column| &column.name);
        csv.write_record(header).map_err(|error| write_error(path, error))?;
        Ok(Self { csv, path: path.to_path_buf() })
    }

    fn write_row(&mut self, columns: &[Column], chunk: &Chunk, row: usize) -> ::csv::Result<()> {
        let mut number = Number::default();
        for (values, column) in chunk.columns().iter().zip(columns) {
            let text = match values {
                Values::F64(v) => number.float(v[row]),
                Values::I64(v) => number.integer(v[row]),
                Values::I32(v) => number.integer(v[row].into()),
                Values::Bool(v) => {
                    if v[row] {
                        "true"
                    } else {
                        "false"
                    }
                }
                Values::Name(v) => name(&column.dtype, v[row]),
                Values::Text(v) => &v[row],
            };
            self.csv.write_field(text)?;
        }
        self.csv.write_record(None::<&[u8]>)
    }
}

impl Sink for CsvSink {
    fn write(&mut self, schema: &Schema, chunk: &Chunk) -> Result<(), TableError> {
        for row in 0..chunk.rows() {
            let written = self.write_row(schema.columns(), chunk, row);
            written.map_err(|error| write_error(&self.path, error))?;
        }
        Ok(())
    }

    fn finish(self: Box<Self>, _schema: &Schema, _rows: u64) -> Result<(), TableError> {
        let output = self.csv.into_inner();
        let output = output.map_err(|error| TableError::io("write", &self.path, error.into_error()))?;
        match output {
            Output::File(file) => file.finish(),
            Output::Stdout(mut stdout) => {
                let flushed = stdout.flush();
                flushed.map_err(|error| TableError::io("write", &self.path, error))
            }
        }
    }
}

/// Converts an error of `csv`, which fails here only if the file does.
fn write_error(path: &Path, error: ::csv::Error) -> TableError {
    let error = match error.into_kind() {
        ::csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    };
    TableError::io("write", path, error)
}

/// The name with a valid index; empty for [`NO_NAME`].
fn name(dtype: &DType, id: u32) -> &str {
    match dtype {
        DType::Name(names) if id != NO_NAME => &names[id as usize],
        _ => "",
    }
}

/// Scratch buffers for formatting numbers.
#[derive(Default)]
struct Number {
    float: Option<ryu::Buffer>,
    text: String,
}

impl Number {
    /// The shortest decimal text that reads back to the same bits. Sign and payload of NaN are lost.
    fn float(&mut self, value: f64) -> &str {
        if value.is_nan() {
            "nan"
        } else if value == f64::INFINITY {
            "inf"
        } else if value == f64::NEG_INFINITY {
            "-inf"
        } else {
            self.float.get_or_insert_with(ryu::Buffer::new).format_finite(value)
        }
    }

    fn integer(&mut self, value: i64) -> &str {
        self.text.clear();
        // writing into a String cannot fail
        let _ = write!(self.text, "{value}");
        &self.text
    }
}
