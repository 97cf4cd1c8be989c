//! The join of Parquet tables: the rows are read and written again, because their groups have a fixed size.

use super::npy::shifted;
use super::{PartSet, dtype};
use crate::chunk::Values;
use crate::{Chunk, Column, DType, NO_NAME, Schema, TableError, TableWriter};
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_typed_column_reader};
use ::parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int32Type, Int64Type};
use ::parquet::errors::{ParquetError, Result};
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use rayweave_error::Message;
use std::collections::HashMap;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

type Reader = SerializedFileReader<File>;

pub(super) fn merge(set: &PartSet, out: &Path) -> std::result::Result<(), TableError> {
    // one part is open at a time: their number is not limited by that of open files
    let open = |path: &Path| {
        let file = File::open(path).map_err(|error| TableError::io("read", path, error))?;
        Reader::new(file).map_err(|error| damaged(path, &error))
    };
    let Some(first) = set.first() else { return Ok(()) };
    let types = first.columns.iter().map(|column| {
        let unknown = || ParquetError::General(format!("the type {} is unknown", column.dtype));
        dtype(&column.dtype).ok_or_else(|| damaged(out, &unknown()))
    });
    let types = types.collect::<std::result::Result<Vec<_>, TableError>>()?;
    // a schema lists the names before the rows
    let mut names: Vec<Names> = types.iter().map(|_| Names::default()).collect();
    let is_named = |dtype: &DType| matches!(dtype, DType::Name(_));
    if types.iter().any(is_named) {
        for (path, _) in set.parts() {
            let reader = open(path)?;
            let named = names.iter_mut().zip(&types).enumerate().filter(|(_, (_, dtype))| is_named(dtype));
            for (number, (own, _)) in named {
                own.read(&reader, number).map_err(|error| damaged(path, &error))?;
            }
        }
    }
    let columns = first.columns.iter().zip(types).zip(&names).map(|((column, dtype), own)| {
        let dtype = match dtype {
            DType::Name(_) => DType::Name(own.list.iter().cloned().collect()),
            dtype => dtype,
        };
        Column { name: column.name.clone(), dtype, unit: column.unit.clone() }
    });
    let columns = columns.collect();
    let schema = Schema::new(columns)?;
    let mut whole = TableWriter::create(out, &schema)?;
    for (path, _) in set.parts() {
        let reader = open(path)?;
        let before = whole.rows();
        for group in 0..reader.num_row_groups() {
            let values = schema.columns().iter().zip(&names).enumerate();
            let values = values.map(|(number, (column, names))| {
                let values = read(&reader, group, number, &column.dtype, names)?;
                Ok(shifted(values, &column.dtype, before))
            });
            let values = values.collect::<Result<_>>().map_err(|error| damaged(path, &error))?;
            whole.write(&Chunk::new(values)?)?;
        }
    }
    whole.finish().map(|_| ())
}

fn damaged(path: &Path, error: &ParquetError) -> TableError {
    TableError::table(path, Message::new("the table cannot be merged", error.to_string()))
}

/// The names that occur in a column, in the order in which they first occur.
#[derive(Default)]
struct Names {
    list: Vec<String>,
    ids: HashMap<Vec<u8>, u32>,
}

impl Names {
    fn read(&mut self, reader: &Reader, column: usize) -> Result<()> {
        for group in 0..reader.num_row_groups() {
            let (values, _) = read_all::<ByteArrayType>(reader, group, column)?;
            for name in values {
                if !self.ids.contains_key(name.data()) {
                    self.ids.insert(name.data().to_vec(), self.list.len() as u32);
                    self.list.push(name.as_utf8()?.to_owned());
                }
            }
        }
        Ok(())
    }
}

/// A column of a row group.
fn read(reader: &Reader, group: usize, column: usize, dtype: &DType, names: &Names) -> Result<Values> {
    Ok(match dtype {
        DType::F64 => Values::F64(read_all::<DoubleType>(reader, group, column)?.0),
        DType::I64 | DType::Row => Values::I64(read_all::<Int64Type>(reader, group, column)?.0),
        DType::I32 => Values::I32(read_all::<Int32Type>(reader, group, column)?.0),
        DType::Bool => Values::Bool(read_all::<BoolType>(reader, group, column)?.0),
        DType::Text => {
            let (values, _) = read_all::<ByteArrayType>(reader, group, column)?;
            // equal texts share memory
            let mut known: HashMap<Vec<u8>, Arc<str>> = HashMap::new();
            let text = |bytes: ByteArray| -> Result<Arc<str>> {
                if let Some(text) = known.get(bytes.data()) {
                    return Ok(text.clone());
                }
                let text: Arc<str> = bytes.as_utf8()?.into();
                known.insert(bytes.data().to_vec(), text.clone());
                Ok(text)
            };
            Values::Text(values.into_iter().map(text).collect::<Result<_>>()?)
        }
        DType::Name(_) => {
            let (values, levels) = read_all::<ByteArrayType>(reader, group, column)?;
            let mut present = values.iter();
            let id = |level: i16| match level {
                0 => NO_NAME,
                _ => present.next().and_then(|name| names.ids.get(name.data()).copied()).unwrap_or(NO_NAME),
            };
            Values::Name(levels.into_iter().map(id).collect())
        }
    })
}

/// The values of a column of a row group that are present, and the definition level of each row.
fn read_all<T: DataType>(reader: &Reader, group: usize, column: usize) -> Result<(Vec<T::T>, Vec<i16>)> {
    let group = reader.get_row_group(group)?;
    let rows = group.metadata().num_rows() as usize;
    let column: ColumnReader = group.get_column_reader(column)?;
    let mut column: ColumnReaderImpl<T> = get_typed_column_reader(column);
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    let mut read = 0;
    while read < rows {
        let (records, _, _) = column.read_records(rows - read, Some(&mut levels), None, &mut values)?;
        if records == 0 {
            return Err(ParquetError::General(format!("a column ends after {read} of {rows} rows")));
        }
        read += records;
    }
    Ok((values, levels))
}
