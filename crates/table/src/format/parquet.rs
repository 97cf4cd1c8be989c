//! Apache Parquet writer: columns in row groups, compressed with Snappy.

use std::path::Path;
use std::sync::Arc;

use ::parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use ::parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int32Type, Int64Type};
use ::parquet::errors::{ParquetError, Result};
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use ::parquet::schema::types::{ColumnPath, Type, TypePtr};

use crate::chunk::Values;
use crate::format::Sink;
use crate::{AtomicFile, Chunk, Column, DType, NO_NAME, Schema, TableError};

/// Number of rows per row group: some tens of MB for the widest tables. All groups but the last have exactly this size, and each
/// column of a group is written at once: the bytes of a file depend on its rows alone, not on the chunks in which they came.
const ROWS_PER_GROUP: usize = 100_000;

/// Output to a Parquet file.
pub(super) struct ParquetSink {
    writer: SerializedFileWriter<AtomicFile>,
    /// The rows of the next group, by column.
    pending: Vec<Values>,
    /// The names of each column of names; empty for other columns.
    names: Vec<Vec<ByteArray>>,
    path: String,
}

impl ParquetSink {
    pub(super) fn create(path: &Path, schema: &Schema) -> std::result::Result<Self, TableError> {
        let file = AtomicFile::create(path)?;
        let path = path.display().to_string();
        let writer = start(file, schema).map_err(|error| write_error(&path, error))?;
        Ok(Self {
            writer,
            pending: schema.columns().iter().map(|column| Values::empty(&column.dtype)).collect(),
            names: schema.columns().iter().map(|column| name_table(&column.dtype)).collect(),
            path,
        })
    }

    fn write_group(&mut self) -> Result<()> {
        let mut group = self.writer.next_row_group()?;
        for (names, values) in self.names.iter().zip(&mut self.pending) {
            if let Some(mut column) = group.next_column()? {
                write_column(&mut column, values, names)?;
                column.close()?;
            }
            values.clear();
        }
        group.close()?;
        Ok(())
    }

    /// The number of rows of the next group so far.
    fn pending_rows(&self) -> usize {
        self.pending.first().map_or(0, Values::len)
    }
}

impl Sink for ParquetSink {
    fn write(&mut self, _schema: &Schema, chunk: &Chunk) -> std::result::Result<(), TableError> {
        let mut next = 0;
        while next < chunk.rows() {
            let end = chunk.rows().min(next + ROWS_PER_GROUP - self.pending_rows());
            let columns = self.pending.iter_mut().zip(chunk.columns());
            columns.for_each(|(own, values)| own.extend(values, next..end));
            next = end;
            if self.pending_rows() == ROWS_PER_GROUP {
                self.write_group().map_err(|error| write_error(&self.path, error))?;
            }
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, _schema: &Schema, _rows: u64) -> std::result::Result<(), TableError> {
        if self.pending_rows() > 0 {
            self.write_group().map_err(|error| write_error(&self.path, error))?;
        }
        let file = self.writer.into_inner();
        file.map_err(|error| write_error(&self.path, error))?.finish()
    }
}

fn start(file: AtomicFile, schema: &Schema) -> Result<SerializedFileWriter<AtomicFile>> {
    let unit = |column: &Column| {
        let unit = column.unit.clone()?;
        Some(KeyValue::new(format!("unit.{}", column.name), unit))
    };
    let units: Vec<_> = schema.columns().iter().filter_map(unit).collect();
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata((!units.is_empty()).then_some(units));
    // coordinates rarely repeat: a dictionary would be built and discarded
    for column in schema.columns().iter().filter(|column| column.dtype == DType::F64) {
        let path = ColumnPath::new(vec![column.name.clone()]);
        properties = properties.set_column_dictionary_enabled(path, false);
    }
    SerializedFileWriter::new(file, message(schema)?, Arc::new(properties.build()))
}

fn message(schema: &Schema) -> Result<TypePtr> {
    let fields: Result<Vec<_>> = schema.columns().iter().map(field).collect();
    let message = Type::group_type_builder("table").with_fields(fields?).build()?;
    Ok(Arc::new(message))
}

/// The Parquet type of a column. Only names are optional.
fn field(column: &Column) -> Result<TypePtr> {
    let (physical, logical, repetition) = match column.dtype {
        DType::F64 => (Physical::DOUBLE, None, Repetition::REQUIRED),
        DType::I64 | DType::Row => (Physical::INT64, None, Repetition::REQUIRED),
        DType::I32 => (Physical::INT32, None, Repetition::REQUIRED),
        DType::Bool => (Physical::BOOLEAN, None, Repetition::REQUIRED),
        DType::Name(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String), Repetition::OPTIONAL),
        DType::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String), Repetition::REQUIRED),
    };
    let field = Type::primitive_type_builder(&column.name, physical)
        .with_logical_type(logical)
        .with_repetition(repetition)
        .build()?;
    Ok(Arc::new(field))
}

fn write_column(column: &mut SerializedColumnWriter, values: &Values, names: &[ByteArray]) -> Result<usize> {
    match values {
        Values::F64(v) => column.typed::<DoubleType>().write_batch(v, None, None),
        Values::I64(v) => column.typed::<Int64Type>().write_batch(v, None, None),
        Values::I32(v) => column.typed::<Int32Type>().write_batch(v, None, None),
        Values::Bool(v) => column.typed::<BoolType>().write_batch(v, None, None),
        Values::Name(ids) => {
            // the definition level of an optional value: 1 present, 0 null
            let levels: Vec<i16> = ids.iter().map(|&id| i16::from(id != NO_NAME)).collect();
            let present = ids.iter().filter(|&&id| id != NO_NAME);
            let texts: Vec<_> = present.map(|&id| names[id as usize].clone()).collect();
            column.typed::<ByteArrayType>().write_batch(&texts, Some(&levels), None)
        }
        Values::Text(texts) => {
            let texts: Vec<_> = texts.iter().map(|text| ByteArray::from(&**text)).collect();
            column.typed::<ByteArrayType>().write_batch(&texts, None, None)
        }
    }
}

/// The names as byte arrays with shared memory.
fn name_table(dtype: &DType) -> Vec<ByteArray> {
    match dtype {
        DType::Name(names) => names.iter().map(|name| ByteArray::from(name.as_str())).collect(),
        _ => Vec::new(),
    }
}

fn write_error(path: &str, error: ParquetError) -> TableError {
    TableError::io("write", Path::new(path), std::io::Error::other(error))
}
