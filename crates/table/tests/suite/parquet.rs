//! Parquet tables, read back row by row.

use std::fs::File;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use rayweave_table::{Chunk, Column, DType, NO_NAME, Schema, TableWriter};
use std::sync::Arc;

use crate::folder::Folder;
use crate::table::{chunk, schema};

#[test]
fn values_nulls_and_units_read_back() {
    const ROWS: i64 = 150_000;
    let folder = Folder::new();
    let path = folder.join("hits.parquet");
    let mut table = TableWriter::create(&path, &schema()).unwrap();
    for first in (0..ROWS).step_by(30_000) {
        table.write(&chunk(first, 30_000)).unwrap();
    }
    assert_eq!(table.finish().unwrap(), ROWS as u64);
    assert_eq!(folder.names(), ["hits.parquet"]);

    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    assert_eq!(reader.num_row_groups(), 2);
    let units = reader.metadata().file_metadata().key_value_metadata().unwrap();
    assert!(units.iter().any(|u| u.key == "unit.t" && u.value.as_deref() == Some("mm")));
    let mut rows = 0;
    for (i, row) in (0_i64..).zip(reader.get_row_iter(None).unwrap()) {
        let medium = match [0, 1, NO_NAME][i as usize % 3] {
            0 => Field::Str("air".into()),
            1 => Field::Str("flint, \"dense\"".into()),
            _ => Field::Null,
        };
        let expected = [
            ("ray", Field::Long(i)),
            ("crossing", Field::Int(-i as i32)),
            ("t", Field::Double(i as f64 / 3.0)),
            ("enters", Field::Bool(i % 2 == 0)),
            ("medium", medium),
        ];
        let row = row.unwrap();
        let fields = row.get_column_iter().map(|(name, field)| (name.as_str(), field.clone()));
        assert!(fields.eq(expected), "row {i}");
        rows += 1;
    }
    assert_eq!(rows, ROWS);
}

#[test]
fn texts_read_back() {
    let folder = Folder::new();
    let path = folder.join("hits.parquet");
    let schema = Schema::new(vec![Column::new("path", DType::Text)]).unwrap();
    let mut table = TableWriter::create(&path, &schema).unwrap();
    let texts: Vec<Arc<str>> = vec!["a[1]/b".into(), "".into(), "a[1]/b".into()];
    table.write(&Chunk::new(vec![texts.clone().into()]).unwrap()).unwrap();
    table.finish().unwrap();
    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    let rows = reader.get_row_iter(None).unwrap().map(Result::unwrap);
    let read: Vec<Field> = rows.map(|row| row.get_column_iter().next().unwrap().1.clone()).collect();
    assert_eq!(read, texts.iter().map(|text| Field::Str(text.to_string())).collect::<Vec<_>>());
}

#[test]
fn no_rows() {
    let folder = Folder::new();
    let path = folder.join("hits.parquet");
    TableWriter::create(&path, &schema()).unwrap().finish().unwrap();
    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    assert_eq!(reader.metadata().file_metadata().num_rows(), 0);
    assert_eq!(reader.metadata().file_metadata().schema_descr().num_columns(), 5);
}
