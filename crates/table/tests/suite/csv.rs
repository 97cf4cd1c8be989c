//! CSV tables.

use std::fs;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_table::{Chunk, Column, DType, Schema, TableWriter};

use crate::folder::Folder;
use crate::table::{chunk, schema};

fn written(schema: &Schema, chunk: &Chunk) -> String {
    let folder = Folder::new();
    let mut table = TableWriter::create(folder.join("a.csv"), schema).unwrap();
    table.write(chunk).unwrap();
    table.finish().unwrap();
    fs::read_to_string(folder.join("a.csv")).unwrap()
}

fn floats(values: Vec<f64>) -> Vec<String> {
    let schema = Schema::new(vec![Column::new("x", DType::F64)]).unwrap();
    let text = written(&schema, &Chunk::new(vec![values.into()]).unwrap());
    text.lines().skip(1).map(String::from).collect()
}

#[test]
fn every_type_as_text() {
    assert_eq!(
        written(&schema(), &chunk(0, 4)),
        "ray,crossing,t,enters,medium\n\
         0,0,0.0,true,air\n\
         1,-1,0.3333333333333333,false,\"flint, \"\"dense\"\"\"\n\
         2,-2,0.6666666666666666,true,\n\
         3,-3,1.0,false,air\n"
    );
}

#[test]
fn no_rows_is_a_header() {
    assert_eq!(written(&schema(), &chunk(0, 0)), "ray,crossing,t,enters,medium\n");
}

#[test]
fn texts_are_quoted_where_needed() {
    let schema = Schema::new(vec![Column::new("path", DType::Text)]).unwrap();
    let texts: Vec<std::sync::Arc<str>> = vec!["a[1]/b".into(), "a, b".into(), "".into()];
    let text = written(&schema, &Chunk::new(vec![texts.into()]).unwrap());
    assert_eq!(text, "path\na[1]/b\n\"a, b\"\n\"\"\n");
}

#[test]
fn special_floats() {
    let values = vec![f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -f64::NAN, -0.0, 1e300, 5e-324];
    assert_eq!(floats(values), ["inf", "-inf", "nan", "nan", "-0.0", "1e300", "5e-324"]);
}

#[test]
fn extreme_integers() {
    let schema = Schema::new(vec![Column::new("a", DType::I64), Column::new("b", DType::I32)]).unwrap();
    let chunk = Chunk::new(vec![vec![i64::MIN, i64::MAX].into(), vec![i32::MIN, i32::MAX].into()]).unwrap();
    assert_eq!(
        written(&schema, &chunk),
        "a,b\n-9223372036854775808,-2147483648\n9223372036854775807,2147483647\n"
    );
}

#[test]
fn random_bits_read_back_to_the_same_bits() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let values: Vec<f64> = (0..20_000).map(|_| f64::from_bits(rng.random())).collect();
    for (value, text) in values.iter().zip(floats(values.clone())) {
        let back: f64 = text.parse().unwrap();
        assert!(back.to_bits() == value.to_bits() || back.is_nan() && value.is_nan(), "{text}");
        // shortest: as many digits as the independent algorithm of the standard library
        let digits = |s: &str| {
            let mantissa = s.split('e').next().unwrap().replace(['.', '-'], "");
            mantissa.trim_matches('0').len()
        };
        assert_eq!(digits(&text), digits(&format!("{value:e}")), "{text}");
    }
}

#[test]
fn an_empty_single_field_is_not_a_blank_line() {
    let schema = Schema::new(vec![Column::names("medium", ["air".to_string()].into())]).unwrap();
    let chunk = Chunk::new(vec![vec![rayweave_table::NO_NAME].into()]).unwrap();
    assert_eq!(written(&schema, &chunk), "medium\n\"\"\n");
}
