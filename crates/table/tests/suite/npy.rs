//! NPY tables, read back by an independent reader.

use std::fs;

use npyz::{DType as Npy, NpyFile};
use rayweave_table::{Chunk, Column, DType, NO_NAME, Schema, TableWriter};

use crate::folder::Folder;
use crate::table::{chunk, schema};

fn write(folder: &Folder, schema: &Schema, chunks: &[Chunk]) -> Vec<u8> {
    let mut table = TableWriter::create(folder.join("hits.npy"), schema).unwrap();
    chunks.iter().for_each(|chunk| table.write(chunk).unwrap());
    table.finish().unwrap();
    fs::read(folder.join("hits.npy")).unwrap()
}

/// The offset of the data, from the length field of the file.
fn data_offset(bytes: &[u8]) -> usize {
    assert_eq!(&bytes[..6], b"\x93NUMPY");
    match bytes[6] {
        1 => 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]])),
        _ => 12 + u32::from_le_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]) as usize,
    }
}

#[test]
fn header_holds_types_and_final_length() {
    let folder = Folder::new();
    let bytes = write(&folder, &schema(), &[chunk(0, 2000), chunk(2000, 500)]);
    let offset = data_offset(&bytes);
    assert_eq!((bytes[6], bytes[7], offset % 64, bytes[offset - 1]), (1, 0, 0, b'\n'));
    let text = str::from_utf8(&bytes[10..offset]).unwrap();
    assert_eq!(
        text.trim_end(),
        "{'descr': [('ray', '<i8'), ('crossing', '<i4'), ('t', '<f8'), ('enters', '|b1'), ('medium', '<u4')], \
         'fortran_order': False, 'shape': (2500,), }"
    );
    assert_eq!(bytes.len() - offset, 2500 * 25);

    let file = NpyFile::new(&bytes[..]).unwrap();
    assert_eq!(file.shape(), [2500]);
    let Npy::Record(fields) = file.dtype() else { panic!() };
    let fields: Vec<_> = fields.iter().map(|f| (f.name.as_str(), f.dtype.descr())).collect();
    let expected =
        [("ray", "'<i8'"), ("crossing", "'<i4'"), ("t", "'<f8'"), ("enters", "'|b1'"), ("medium", "'<u4'")];
    assert_eq!(fields, expected.map(|(name, descr)| (name, descr.to_string())));
}

#[test]
fn rows_are_packed_little_endian() {
    let folder = Folder::new();
    let bytes = write(&folder, &schema(), &[chunk(0, 2000), chunk(2000, 500)]);
    let rows = &bytes[data_offset(&bytes)..];
    for (i, row) in (0_i64..).zip(rows.chunks_exact(25)) {
        assert_eq!(row[..8], i.to_le_bytes());
        assert_eq!(row[8..12], (-i as i32).to_le_bytes());
        assert_eq!(row[12..20], (i as f64 / 3.0).to_le_bytes());
        assert_eq!(row[20], u8::from(i % 2 == 0));
        assert_eq!(row[21..], [0, 1, NO_NAME][i as usize % 3].to_le_bytes());
    }
}

#[test]
fn name_tables_are_written_beside() {
    let folder = Folder::new();
    write(&folder, &schema(), &[chunk(0, 1)]);
    assert_eq!(folder.names(), ["hits.names.json", "hits.npy"]);
    let text = fs::read_to_string(folder.join("hits.names.json")).unwrap();
    assert_eq!(text, "{\n  \"medium\": [\"air\",\"flint, \\\"dense\\\"\"]\n}\n");
}

#[test]
fn several_name_tables_are_one_object() {
    let folder = Folder::new();
    let names = |list: &[&str]| list.iter().map(|s| s.to_string()).collect::<Vec<_>>().into();
    let columns = vec![
        Column::names("surface", names(&["ä\n", ""])),
        Column::new("t", DType::F64),
        Column::names("solid", names(&[])),
    ];
    write(&folder, &Schema::new(columns).unwrap(), &[]);
    let text = fs::read_to_string(folder.join("hits.names.json")).unwrap();
    assert_eq!(text, "{\n  \"surface\": [\"ä\\n\",\"\"],\n  \"solid\": []\n}\n");
}

#[test]
fn texts_are_numbered_in_order_of_occurrence() {
    let folder = Folder::new();
    let text = |list: &[&str]| list.iter().map(|&text| text.into()).collect::<Vec<std::sync::Arc<str>>>();
    let columns = vec![Column::new("path", DType::Text), Column::names("solid", ["a".to_owned()].into())];
    let chunk = |list: &[&str]| Chunk::new(vec![text(list).into(), vec![0u32; list.len()].into()]).unwrap();
    let schema = Schema::new(columns).unwrap();
    let bytes = write(&folder, &schema, &[chunk(&["b[1]", "a", "b[1]"]), chunk(&["c", "a"])]);
    let names = fs::read_to_string(folder.join("hits.names.json")).unwrap();
    assert_eq!(names, "{\n  \"solid\": [\"a\"],\n  \"path\": [\"b[1]\",\"a\",\"c\"]\n}\n");
    let rows = bytes[data_offset(&bytes)..].chunks_exact(8);
    let ids: Vec<u32> = rows.map(|row| u32::from_le_bytes(row[..4].try_into().unwrap())).collect();
    assert_eq!(ids, [0, 1, 0, 2, 1]);
}

#[test]
fn without_names_there_is_no_second_file() {
    let folder = Folder::new();
    let schema = Schema::new(vec![Column::new("t", DType::F64)]).unwrap();
    let bytes = write(&folder, &schema, &[]);
    assert_eq!(folder.names(), ["hits.npy"]);
    assert_eq!(bytes.len(), data_offset(&bytes));
    assert_eq!(NpyFile::new(&bytes[..]).unwrap().shape(), [0]);
}

#[test]
fn long_headers_are_version_2_and_other_alphabets_version_3() {
    let folder = Folder::new();
    let many = (0..4000).map(|i| Column::new(format!("a_long_name_{i}"), DType::Bool)).collect();
    let bytes = write(&folder, &Schema::new(many).unwrap(), &[]);
    let Npy::Record(fields) = NpyFile::new(&bytes[..]).unwrap().dtype() else { panic!() };
    assert_eq!((bytes[6], data_offset(&bytes) % 64, fields.len()), (2, 0, 4000));

    let column = Column::new("λ 'µm' \\", DType::F64);
    let bytes = write(&folder, &Schema::new(vec![column]).unwrap(), &[]);
    let Npy::Record(fields) = NpyFile::new(&bytes[..]).unwrap().dtype() else { panic!() };
    assert_eq!((bytes[6], data_offset(&bytes) % 64), (3, 0));
    assert_eq!(fields[0].name, "λ 'µm' \\");
}
