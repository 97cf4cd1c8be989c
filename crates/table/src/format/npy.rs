//! NPY writer (NumPy): a structured array whose length is patched into the header at the end.

use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::chunk::Values;
use crate::format::Sink;
use crate::npy_header;
use crate::{AtomicFile, Chunk, DType, Schema, TableError};

/// Number of rows that are interleaved at once, which bounds the scratch memory.
const ROWS_PER_BLOCK: usize = 1024;

/// Output to an NPY file and the file of name tables beside it.
pub(super) struct NpySink {
    file: AtomicFile,
    /// Written at the start and renamed before the array, so that a complete array always has its names.
    names: Option<AtomicFile>,
    block: Vec<u8>,
    row_size: usize,
}

impl NpySink {
    pub(super) fn create(path: &Path, schema: &Schema) -> Result<Self, TableError> {
        let mut file = AtomicFile::create(path)?;
        // same length as the final header, which replaces it
        let written = file.write_all(&npy_header::table(schema, 0));
        written.map_err(|error| TableError::io("write", path, error))?;
        Ok(Self {
            file,
            names: write_names(&path.with_extension("names.json"), schema)?,
            block: Vec::new(),
            row_size: schema.columns().iter().map(|column| column.dtype.size()).sum(),
        })
    }

    fn interleave(&mut self, chunk: &Chunk, first: usize, rows: usize) {
        self.block.clear();
        self.block.resize(rows * self.row_size, 0);
        let mut offset = 0;
        for values in chunk.columns() {
            let target = &mut self.block[offset..];
            offset += match values {
                Values::F64(v) => scatter(target, self.row_size, &v[first..first + rows], f64::to_le_bytes),
                Values::I64(v) => scatter(target, self.row_size, &v[first..first + rows], i64::to_le_bytes),
                Values::I32(v) => scatter(target, self.row_size, &v[first..first + rows], i32::to_le_bytes),
                Values::Name(v) => scatter(target, self.row_size, &v[first..first + rows], u32::to_le_bytes),
                Values::Bool(v) => scatter(target, self.row_size, &v[first..first + rows], |b| [b.into()]),
            };
        }
    }
}

/// Stores the values of a column `stride` bytes apart; returns the size of a value.
fn scatter<T: Copy, const SIZE: usize>(
    target: &mut [u8],
    stride: usize,
    values: &[T],
    bytes: impl Fn(T) -> [u8; SIZE],
) -> usize {
    for (row, &value) in target.chunks_mut(stride).zip(values) {
        row[..SIZE].copy_from_slice(&bytes(value));
    }
    SIZE
}

impl Sink for NpySink {
    fn write(&mut self, _schema: &Schema, chunk: &Chunk) -> Result<(), TableError> {
        for first in (0..chunk.rows()).step_by(ROWS_PER_BLOCK) {
            self.interleave(chunk, first, ROWS_PER_BLOCK.min(chunk.rows() - first));
            let written = self.file.write_all(&self.block);
            written.map_err(|error| TableError::io("write", self.file.target(), error))?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, schema: &Schema, rows: u64) -> Result<(), TableError> {
        let header = npy_header::table(schema, rows);
        let patched = self.file.seek(SeekFrom::Start(0)).and_then(|_| self.file.write_all(&header));
        patched.map_err(|error| TableError::io("write", self.file.target(), error))?;
        self.names.map_or(Ok(()), AtomicFile::finish)?;
        self.file.finish()
    }
}

/// Writes `{"COLUMN": ["name 0", "name 1", ...], ...}` for the columns of names; no file if there are none.
fn write_names(path: &PathBuf, schema: &Schema) -> Result<Option<AtomicFile>, TableError> {
    let tables = schema.columns().iter().filter_map(|column| match &column.dtype {
        DType::Name(names) => Some((&column.name, names)),
        _ => None,
    });
    let mut file = None;
    for (column, names) in tables {
        let before = if file.is_none() { "{" } else { "," };
        let out = match &mut file {
            Some(out) => out,
            empty => empty.insert(AtomicFile::create(path)?),
        };
        let written = write_name_table(out, before, column, names);
        written.map_err(|error| TableError::io("write", path, error))?;
    }
    if let Some(out) = &mut file {
        out.write_all(b"\n}\n").map_err(|error| TableError::io("write", path, error))?;
    }
    Ok(file)
}

fn write_name_table(
    out: &mut AtomicFile,
    before: &str,
    column: &str,
    names: &[String],
) -> std::io::Result<()> {
    write!(out, "{before}\n  ")?;
    serde_json::to_writer(&mut *out, column)?;
    out.write_all(b": ")?;
    serde_json::to_writer(&mut *out, names)?;
    Ok(())
}
