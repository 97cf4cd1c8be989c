//! The join of NPY tables: texts are numbered again, in the order of the lists of the parts, which is that of the whole.

use super::{Part, PartSet, dtype};
use crate::chunk::Values;
use crate::{Chunk, Column, DType, Schema, TableError, TableWriter, npy_header};
use rayweave_error::Message;
use serde_json::Value;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use std::sync::Arc;

/// Rows that are read at once.
const ROWS: usize = 8192;

pub(super) fn merge(set: &PartSet, out: &Path) -> Result<(), TableError> {
    let mut whole: Option<TableWriter> = None;
    for (path, part) in set.parts() {
        let table = NpyPart::open(path, part)?;
        let writer = match &mut whole {
            Some(writer) if *writer.schema() == table.schema => writer,
            Some(_) => return Err(damaged(path, "its names differ from those of the other parts")),
            None => whole.insert(TableWriter::create(out, &table.schema)?),
        };
        table.copy(path, writer)?;
    }
    whole.map_or(Ok(()), |writer| writer.finish().map(|_| ()))
}

fn damaged(path: &Path, reason: &str) -> TableError {
    TableError::table(path, Message::new("the table cannot be merged", reason))
}

/// An open NPY table.
struct NpyPart {
    file: BufReader<File>,
    schema: Schema,
    /// The texts of each column; empty for columns of other types.
    texts: Vec<Vec<Arc<str>>>,
    rows: u64,
}

impl NpyPart {
    fn open(path: &Path, part: &Part) -> Result<NpyPart, TableError> {
        let file = File::open(path).map_err(|error| TableError::io("read", path, error))?;
        let mut file = BufReader::with_capacity(1 << 16, file);
        let header = npy_header::read(&mut file).map_err(|error| TableError::io("read", path, error))?;
        let header = header.map_err(|reason| damaged(path, &reason))?;
        let [rows] = header.shape[..] else { return Err(damaged(path, "it is not a list of rows")) };
        let lists = names(path, part)?;
        let mut columns = Vec::with_capacity(part.columns.len());
        let mut texts = Vec::with_capacity(part.columns.len());
        for column in &part.columns {
            let list = lists.get(&column.name).and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
            let list: Option<Vec<&str>> = list.iter().map(Value::as_str).collect();
            let list = list.ok_or_else(|| damaged(path, "its list of names is damaged"))?;
            let dtype = match dtype(&column.dtype) {
                Some(DType::Name(_)) => DType::Name(list.iter().map(|&name| name.to_owned()).collect()),
                Some(dtype) => dtype,
                None => return Err(damaged(path, &format!("the type {} is unknown", column.dtype))),
            };
            let is_text = dtype == DType::Text;
            texts.push(if is_text { list.into_iter().map(Arc::from).collect() } else { Vec::new() });
            let unit = column.unit.clone();
            columns.push(Column { name: column.name.clone(), dtype, unit });
        }
        Ok(NpyPart { file, schema: Schema::new(columns)?, texts, rows })
    }

    /// Appends all rows to another table.
    fn copy(mut self, path: &Path, whole: &mut TableWriter) -> Result<(), TableError> {
        let columns = self.schema.columns().to_vec();
        for (column, texts) in columns.iter().zip(&self.texts) {
            whole.list_texts(&column.name, texts.iter().map(|text| &**text));
        }
        let row_size: usize = columns.iter().map(|column| column.dtype.size()).sum();
        let (mut block, before) = (Vec::new(), whole.rows());
        let mut left = self.rows;
        while left > 0 {
            let rows = left.min(ROWS as u64) as usize;
            block.resize(rows * row_size, 0);
            self.file.read_exact(&mut block).map_err(|error| TableError::io("read", path, error))?;
            let mut offset = 0;
            let values = columns.iter().zip(&self.texts).map(|(column, texts)| {
                let start = offset;
                offset += column.dtype.size();
                let values = values(&column.dtype, &block[start..], row_size, texts);
                let values =
                    values.ok_or_else(|| damaged(path, "a text has no entry in its list of names"))?;
                Ok::<Values, TableError>(shifted(values, &column.dtype, before))
            });
            whole.write(&Chunk::new(values.collect::<Result<_, _>>()?)?)?;
            left -= rows as u64;
        }
        Ok(())
    }
}

/// The lists of names beside the table.
fn names(path: &Path, part: &Part) -> Result<Value, TableError> {
    match super::files(path, &part.columns).get(1) {
        None => Ok(Value::Null),
        Some(names) => {
            let text =
                std::fs::read_to_string(names).map_err(|error| TableError::io("read", names, error))?;
            serde_json::from_str(&text).map_err(|_| damaged(names, "the list of names is damaged"))
        }
    }
}

/// The values of a column, `stride` bytes apart; `None` if a text has no entry in the list.
fn values(dtype: &DType, bytes: &[u8], stride: usize, texts: &[Arc<str>]) -> Option<Values> {
    Some(match dtype {
        DType::F64 => Values::F64(gather(bytes, stride, f64::from_le_bytes)),
        DType::I64 | DType::Row => Values::I64(gather(bytes, stride, i64::from_le_bytes)),
        DType::I32 => Values::I32(gather(bytes, stride, i32::from_le_bytes)),
        DType::Bool => Values::Bool(gather(bytes, stride, |[byte]: [u8; 1]| byte != 0)),
        DType::Name(_) => Values::Name(gather(bytes, stride, u32::from_le_bytes)),
        DType::Text => {
            let ids = gather(bytes, stride, u32::from_le_bytes);
            Values::Text(ids.iter().map(|&id| texts.get(id as usize).cloned()).collect::<Option<_>>()?)
        }
    })
}

/// The values of a column of a part, with the numbers of rows in the whole; `before` is the number of rows of earlier parts.
pub(super) fn shifted(values: Values, dtype: &DType, before: u64) -> Values {
    match values {
        Values::I64(rows) if *dtype == DType::Row => {
            Values::I64(rows.into_iter().map(|row| if row < 0 { row } else { row + before as i64 }).collect())
        }
        values => values,
    }
}

fn gather<T, const SIZE: usize>(bytes: &[u8], stride: usize, value: impl Fn([u8; SIZE]) -> T) -> Vec<T> {
    let rows = bytes.chunks(stride).filter_map(|row| row.first_chunk::<SIZE>());
    rows.map(|bytes| value(*bytes)).collect()
}
