//! `array_csg` against a table written by numpy, with reference/array_csg.py.

use rayweave_rootray::hit_array::{CsgOptions, Float, HitArray, Operation, array_csg};

const TABLE: &str = include_str!("reference/array_csg.txt");

/// A line `name rows columns numbers...`.
fn parse<T>(line: &str, name: &str, number: fn(f64) -> T) -> (usize, usize, Vec<T>) {
    let mut words = line.split(' ');
    assert_eq!(words.next(), Some(name));
    let rows = words.next().unwrap().parse().unwrap();
    let columns = words.next().unwrap().parse().unwrap();
    (rows, columns, words.map(|word| number(word.parse().unwrap())).collect())
}

fn operation(name: &str) -> Operation {
    match name {
        "union" => Operation::Union,
        "intersect" => Operation::Intersect,
        _ => Operation::Difference,
    }
}

fn check<T: Float>(operation: Operation, sort_output: bool, lines: &[&str], number: fn(f64) -> T) {
    let (rows1, columns, data1) = parse(lines[1], "array1", number);
    let (rows2, _, data2) = parse(lines[2], "array2", number);
    let (rows, _, expected) = parse(lines[3], "hits", number);
    assert_eq!(rows, rows1 + rows2);
    let array1 = HitArray::new(&data1, rows1, columns).unwrap();
    let array2 = HitArray::new(&data2, rows2, columns).unwrap();
    let options = CsgOptions { sort_output, ..CsgOptions::default() };
    assert_eq!(array_csg(array1, array2, operation, options).unwrap(), expected, "{lines:?}");
}

#[test]
fn agrees_with_numpy() {
    let lines: Vec<&str> = TABLE.lines().filter(|line| !line.starts_with('#')).collect();
    for lines in lines.chunks(4) {
        let case: Vec<&str> = lines[0].split(' ').collect();
        let (operation, sort_output) = (operation(case[2]), case[3] == "sorted");
        match case[1] {
            "f32" => check(operation, sort_output, lines, |t| t as f32),
            _ => check(operation, sort_output, lines, |t| t),
        }
    }
    assert!(lines.len() / 4 > 250, "the table is whole");
}
