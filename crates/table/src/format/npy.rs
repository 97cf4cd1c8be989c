//! NPY writer (NumPy): a structured array whose length is patched into the header at the end.

use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::chunk::Values;
use crate::format::Sink;
use crate::npy_header;
use crate::{AtomicFile, Chunk, DType, Schema, TableError, TextIds};

/// Number of rows that are interleaved at once, which bounds the scratch memory.
const ROWS_PER_BLOCK: usize = 1024;

/// Output to an NPY file and its file of name tables.
pub(super) struct NpySink {
    file: AtomicFile,
    /// Created at the start and renamed before the array, so that a complete array always has its names.
    names: Option<NameFile>,
    /// The texts of each column: those known before the rows, then the others in the order in which they first occur; empty for
    /// columns of other types.
    texts: Vec<TextIds>,
    block: Vec<u8>,
    row_size: usize,
}

impl NpySink {
    pub(super) fn create(path: &Path, schema: &Schema) -> Result<Self, TableError> {
        let mut file = AtomicFile::create(path)?;
        // same length as the final header, which replaces it
        let written = file.write_all(&npy_header::table(schema, 0));
        written.map_err(|error| TableError::io("write", path, error))?;
        let columns = schema.columns();
        Ok(Self {
            file,
            names: NameFile::create(path.with_extension("names.json"), schema)?,
            texts: columns.iter().map(|_| TextIds::default()).collect(),
            block: Vec::new(),
            row_size: columns.iter().map(|column| column.dtype.size()).sum(),
        })
    }

    /// The indices of the texts of a chunk, by column; empty for columns of other types.
    fn text_ids(&mut self, chunk: &Chunk) -> Vec<Vec<u32>> {
        let pairs = chunk.columns().iter().zip(&mut self.texts);
        pairs
            .map(|(values, known)| match values {
                Values::Text(texts) => texts.iter().map(|text| known.id(text)).collect(),
                _ => Vec::new(),
            })
            .collect()
    }

    fn interleave(&mut self, chunk: &Chunk, texts: &[Vec<u32>], first: usize, rows: usize) {
        self.block.clear();
        self.block.resize(rows * self.row_size, 0);
        let mut offset = 0;
        for (values, texts) in chunk.columns().iter().zip(texts) {
            let target = &mut self.block[offset..];
            offset += match values {
                Values::F64(v) => scatter(target, self.row_size, &v[first..first + rows], f64::to_le_bytes),
                Values::I64(v) => scatter(target, self.row_size, &v[first..first + rows], i64::to_le_bytes),
                Values::I32(v) => scatter(target, self.row_size, &v[first..first + rows], i32::to_le_bytes),
                Values::Name(v) => scatter(target, self.row_size, &v[first..first + rows], u32::to_le_bytes),
                Values::Text(_) => {
                    scatter(target, self.row_size, &texts[first..first + rows], u32::to_le_bytes)
                }
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
    fn list_texts(&mut self, column: usize, texts: &[&str]) {
        for &text in texts {
            self.texts[column].id(&Arc::from(text));
        }
    }

    fn write(&mut self, _schema: &Schema, chunk: &Chunk) -> Result<(), TableError> {
        let texts = self.text_ids(chunk);
        for first in (0..chunk.rows()).step_by(ROWS_PER_BLOCK) {
            self.interleave(chunk, &texts, first, ROWS_PER_BLOCK.min(chunk.rows() - first));
            let written = self.file.write_all(&self.block);
            written.map_err(|error| TableError::io("write", self.file.target(), error))?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, schema: &Schema, rows: u64) -> Result<(), TableError> {
        let header = npy_header::table(schema, rows);
        let patched = self.file.seek(SeekFrom::Start(0)).and_then(|_| self.file.write_all(&header));
        patched.map_err(|error| TableError::io("write", self.file.target(), error))?;
        self.names.map_or(Ok(()), |names| names.finish(schema, &self.texts))?;
        self.file.finish()
    }
}

/// The file `{"COLUMN": ["name 0", "name 1", ...], ...}` of the columns of names and of texts.
struct NameFile {
    out: AtomicFile,
    path: PathBuf,
    is_empty: bool,
}

impl NameFile {
    /// Creates the file and writes the tables of names; no file if there are no columns of names or texts.
    fn create(path: PathBuf, schema: &Schema) -> Result<Option<NameFile>, TableError> {
        let is_listed = |dtype: &DType| matches!(dtype, DType::Name(_) | DType::Text);
        if !schema.columns().iter().any(|column| is_listed(&column.dtype)) {
            return Ok(None);
        }
        let mut file = NameFile { out: AtomicFile::create(&path)?, path, is_empty: true };
        for column in schema.columns() {
            if let DType::Name(names) = &column.dtype {
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                file.add(&column.name, &names)?;
            }
        }
        Ok(Some(file))
    }

    fn add(&mut self, column: &str, names: &[&str]) -> Result<(), TableError> {
        let before = if std::mem::take(&mut self.is_empty) { "{" } else { "," };
        let written = write_name_table(&mut self.out, before, column, names);
        written.map_err(|error| TableError::io("write", &self.path, error))
    }

    /// Writes the tables of texts and completes the file.
    fn finish(mut self, schema: &Schema, texts: &[TextIds]) -> Result<(), TableError> {
        for (column, texts) in schema.columns().iter().zip(texts) {
            if column.dtype == DType::Text {
                let texts: Vec<&str> = texts.texts().iter().map(|text| &**text).collect();
                self.add(&column.name, &texts)?;
            }
        }
        self.out.write_all(b"\n}\n").map_err(|error| TableError::io("write", &self.path, error))?;
        self.out.finish()
    }
}

fn write_name_table(out: &mut AtomicFile, before: &str, column: &str, names: &[&str]) -> std::io::Result<()> {
    write!(out, "{before}\n  ")?;
    serde_json::to_writer(&mut *out, column)?;
    out.write_all(b": ")?;
    serde_json::to_writer(&mut *out, names)?;
    Ok(())
}
