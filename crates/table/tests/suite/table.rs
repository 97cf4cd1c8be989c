//! Tables of all formats.

use std::fs;
use std::sync::Arc;

use rayweave_table::{Chunk, Column, DType, NO_NAME, Schema, TableWriter, Values};

use crate::folder::Folder;

/// One column of each type.
pub fn schema() -> Schema {
    let media: Arc<[String]> = ["air".to_string(), "flint, \"dense\"".to_string()].into();
    Schema::new(vec![
        Column::new("ray", DType::I64),
        Column::new("crossing", DType::I32),
        Column::new("t", DType::F64).unit("mm"),
        Column::new("enters", DType::Bool),
        Column::names("medium", media),
    ])
    .unwrap()
}

/// Rows `first..first + rows` of a table with values computed from the row.
pub fn chunk(first: i64, rows: i64) -> Chunk {
    let range = first..first + rows;
    let medium = |i: i64| [0, 1, NO_NAME][i as usize % 3];
    Chunk::new(vec![
        range.clone().collect::<Vec<i64>>().into(),
        range.clone().map(|i| -i as i32).collect::<Vec<_>>().into(),
        range.clone().map(|i| i as f64 / 3.0).collect::<Vec<_>>().into(),
        range.clone().map(|i| i % 2 == 0).collect::<Vec<_>>().into(),
        range.map(medium).collect::<Vec<_>>().into(),
    ])
    .unwrap()
}

fn formats() -> Vec<&'static str> {
    let parquet = cfg!(feature = "parquet").then_some("hits.parquet");
    ["hits.csv", "hits.npy", "HITS.CSV"].into_iter().chain(parquet).collect()
}

#[test]
fn nothing_appears_before_finish_and_no_temporary_file_stays() {
    for name in formats() {
        let folder = Folder::new();
        let mut table = TableWriter::create(folder.join(name), &schema()).unwrap();
        table.write(&chunk(0, 5000)).unwrap();
        assert!(!folder.join(name).exists());
        assert!(folder.names().iter().all(|file| file.starts_with('.') && file.ends_with(".tmp")));
        assert_eq!(table.finish().unwrap(), 5000);
        assert!(folder.names().iter().all(|file| !file.starts_with('.')), "{name}");
        assert!(folder.join(name).exists());
    }
}

#[test]
fn dropped_without_finish_leaves_nothing() {
    for name in formats() {
        let folder = Folder::new();
        let mut table = TableWriter::create(folder.join(name), &schema()).unwrap();
        table.write(&chunk(0, 5000)).unwrap();
        drop(table);
        assert_eq!(folder.names(), Vec::<String>::new(), "{name}");
    }
}

#[test]
fn dropped_without_finish_keeps_the_earlier_table() {
    for name in formats() {
        let folder = Folder::new();
        folder.write(name, "earlier");
        let mut table = TableWriter::create(folder.join(name), &schema()).unwrap();
        table.write(&chunk(0, 5000)).unwrap();
        drop(table);
        assert_eq!(folder.names(), [name]);
        assert_eq!(fs::read(folder.join(name)).unwrap(), b"earlier");
    }
}

#[test]
fn the_chunk_size_does_not_change_a_byte() {
    for name in ["hits.csv", "hits.npy"] {
        let folder = Folder::new();
        let mut contents = Vec::new();
        for size in [1, 7, 1023, 3000] {
            let mut table = TableWriter::create(folder.join(name), &schema()).unwrap();
            for first in (0..3000).step_by(size) {
                table.write(&chunk(first, (size as i64).min(3000 - first))).unwrap();
            }
            assert_eq!(table.rows(), 3000);
            table.finish().unwrap();
            contents.push(fs::read(folder.join(name)).unwrap());
        }
        assert!(contents.iter().all(|bytes| *bytes == contents[0]), "{name}");
    }
}

#[test]
fn an_invalid_chunk_is_reported_and_the_table_cannot_be_finished() {
    let folder = Folder::new();
    let mut table = TableWriter::create(folder.join("hits.csv"), &schema()).unwrap();
    let few = Chunk::new(vec![vec![1.0].into()]).unwrap();
    assert_eq!(
        table.write(&few).unwrap_err().to_string(),
        "the chunk is invalid: it has 1 columns, the schema has 5."
    );

    let mut columns = chunk(0, 2).columns().to_vec();
    columns[4] = vec![0, 2_u32].into();
    assert_eq!(
        table.write(&Chunk::new(columns).unwrap()).unwrap_err().to_string(),
        "the chunk is invalid: column \"medium\" has the name index 2 in row 1, but there are 2 names."
    );

    let mut columns = chunk(0, 2).columns().to_vec();
    columns[0] = Values::F64(vec![0.0, 1.0]);
    assert_eq!(
        table.write(&Chunk::new(columns).unwrap()).unwrap_err().to_string(),
        "the chunk is invalid: column \"ray\" has values of type f64, the schema has i64."
    );

    assert_eq!(
        folder.text_of(&table.finish().unwrap_err()),
        "cannot write hits.csv: an earlier chunk failed."
    );
    assert_eq!(folder.names(), Vec::<String>::new());
}

#[test]
fn columns_of_a_chunk_have_equal_length() {
    let error = Chunk::new(vec![vec![1.0, 2.0].into(), vec![true].into()]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the chunk is invalid: column 1 has 1 values and column 0 has 2, but columns must have equal lengths."
    );
}

#[test]
fn a_schema_names_each_column_once() {
    let text_of = |names: &[&str]| {
        let columns = names.iter().map(|&name| Column::new(name, DType::F64)).collect();
        Schema::new(columns).unwrap_err().to_string()
    };
    assert_eq!(text_of(&[]), "the schema is invalid: it has no columns.");
    assert_eq!(text_of(&["x", ""]), "the schema is invalid: column 1 has no name.");
    assert_eq!(text_of(&["x", "y", "x"]), "the schema is invalid: two columns have the name \"x\".");
}

#[test]
fn an_unknown_extension_is_rejected() {
    let folder = Folder::new();
    for name in ["hits.xlsx", "hits", ".csv", "hits.csv.gz"] {
        let error = TableWriter::create(folder.join(name), &schema()).unwrap_err();
        let expected =
            format!("{name}: the table format is unknown: the extension must be .csv, .npy or .parquet.");
        assert_eq!(folder.text_of(&error), expected);
    }
    assert_eq!(folder.names(), Vec::<String>::new());
}

#[cfg(not(feature = "parquet"))]
#[test]
fn the_error_about_parquet_suggests_the_feature() {
    let folder = Folder::new();
    let error = TableWriter::create(folder.join("hits.parquet"), &schema()).unwrap_err();
    assert_eq!(
        folder.text_of(&error),
        "hits.parquet: this build cannot write Parquet: it was compiled without the cargo feature `parquet`. \
         Build with `--features parquet`, or write .csv or .npy."
    );
}
