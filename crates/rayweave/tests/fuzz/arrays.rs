//! Fuzz target: bytes as files of rays and as hit arrays.

use crate::bytes::Bytes;
use rayweave::rootray::hit_array::{CsgOptions, HitArray, HitArrayError, Operation, Regularize, array_csg};
use rayweave::rootray::{RootRay, Side};
use rayweave::table::{RayChunk, RayReader, TableError};
use rayweave::{Ray, Vec3};
use std::cell::RefCell;
use std::io::Cursor;
use std::path::PathBuf;

const TIMES: [f64; 9] = [0.0, 1.0, 2.0, 3.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -0.0];

/// The property: a file of rays is rejected with reasons or returns rays that can be traced; hit arrays are
/// rejected for their problem or combined according to the rule, entry by entry.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    match bytes.below(4) {
        0 => read(RayReader::from_csv(Cursor::new(bytes.rest().to_vec()), "fuzz.csv")),
        1 => npy(bytes.rest()),
        _ => csg(&mut bytes),
    }
}

fn npy(data: &[u8]) {
    thread_local! {
        static PATH: RefCell<Option<PathBuf>> = const { RefCell::new(None) };
    }
    let path = PATH.with_borrow_mut(|path| {
        let thread = format!("{:?}", std::thread::current().id()).replace(|c: char| !c.is_ascii_digit(), "");
        let name = format!("rayweave-fuzz-{}-{thread}.npy", std::process::id());
        path.get_or_insert_with(|| std::env::temp_dir().join(name)).clone()
    });
    std::fs::write(&path, data).unwrap();
    read(RayReader::open(&path));
    std::fs::remove_file(&path).unwrap();
}

fn read(reader: Result<RayReader, TableError>) {
    let refused = |error: TableError| assert!(!error.to_string().is_empty());
    let mut reader = match reader {
        Ok(reader) => reader,
        Err(error) => return refused(error),
    };
    let mut chunk = RayChunk::default();
    let mut expected = 0;
    // small chunks, to test the boundaries between them
    loop {
        match reader.read(&mut chunk, 3) {
            Ok(0) => return,
            Ok(count) => assert!(count == chunk.len() && count <= 3 && chunk.first == expected),
            Err(error) => return refused(error),
        }
        expected += chunk.len() as u64;
        for i in 0..chunk.len() {
            let at = |columns: &[Vec<f64>; 3]| Vec3::new(columns[0][i], columns[1][i], columns[2][i]);
            assert_eq!(Ray::new(at(&chunk.origin), at(&chunk.direction)).check(), Ok(()));
        }
    }
}

fn csg(bytes: &mut Bytes<'_>) {
    let operation = bytes.pick(&[Operation::Union, Operation::Intersect, Operation::Difference]);
    let sorted = bytes.below(4) > 0;
    let columns = bytes.below(4);
    let (a, b) = (array(bytes, columns, sorted), array(bytes, columns, sorted));
    let [first, second] = [&a, &b].map(|list| HitArray::new(list, list.len() / columns.max(1), columns));
    let (Ok(first), Ok(second)) = (first, second) else { return };
    let combined = array_csg(first, second, operation, CsgOptions::default());
    let Some(problem) = problem(&a, columns).or_else(|| problem(&b, columns)) else {
        let combined = combined.unwrap();
        assert_eq!(combined.len(), a.len() + b.len());
        let exact = CsgOptions { regularize: Regularize::Exact, ..CsgOptions::default() };
        let regular = array_csg(first, second, operation, exact).unwrap();
        for k in 0..columns {
            let column = |list: &[f64]| list.iter().skip(k).step_by(columns).copied().collect::<Vec<f64>>();
            assert_eq!(column(&combined), by_the_rule(&column(&a), &column(&b), operation));
            assert_eq!(root_ray(&column(&regular)), algebra(&column(&a), &column(&b), operation));
        }
        return;
    };
    assert_eq!(kind(&combined.unwrap_err()), problem);
}

/// An array with `columns` columns, sorted or not.
fn array(bytes: &mut Bytes<'_>, columns: usize, sorted: bool) -> Vec<f64> {
    let rows = bytes.below(8);
    let mut list = vec![0.0; rows * columns];
    for k in 0..columns {
        let mut column: Vec<f64> = (0..rows).map(|_| bytes.number(&TIMES)).collect();
        if sorted {
            column.iter_mut().filter(|t| t.is_nan()).for_each(|t| *t = f64::INFINITY);
            column.sort_by(f64::total_cmp);
        }
        column.into_iter().enumerate().for_each(|(row, t)| list[row * columns + k] = t);
    }
    list
}

/// The problem of an array according to the documentation: the lowest column first, then the lowest row.
fn problem(list: &[f64], columns: usize) -> Option<&'static str> {
    if list.len().checked_div(columns)? % 2 == 1 {
        return Some("odd");
    }
    let bad = |k: usize| {
        let column: Vec<f64> = list.iter().skip(k).step_by(columns).copied().collect();
        (0..column.len()).find_map(|row| match column[row] {
            t if t.is_nan() => Some("nan"),
            t if row > 0 && t < column[row - 1] => Some("not sorted"),
            _ => None,
        })
    };
    (0..columns).find_map(bad)
}

fn kind(error: &HitArrayError) -> &'static str {
    match error {
        HitArrayError::OddRows { .. } => "odd",
        HitArrayError::Nan { .. } => "nan",
        HitArrayError::NotSorted { .. } => "not sorted",
        _ => "another",
    }
}

/// The rule: every entry toggles its operand, those of the first operand first at equal times; entries that
/// change the result are kept.
fn by_the_rule(a: &[f64], b: &[f64], operation: Operation) -> Vec<f64> {
    let mut merged: Vec<(f64, usize)> = a.iter().map(|&t| (t, 0)).chain(b.iter().map(|&t| (t, 1))).collect();
    merged.sort_by(|x, y| x.0.partial_cmp(&y.0).unwrap());
    let mut inside = [false; 2];
    let mut kept = Vec::new();
    for (t, operand) in merged {
        let before = value(inside, operation);
        inside[operand] = !inside[operand];
        if value(inside, operation) != before {
            kept.push(t);
        }
    }
    kept.resize(a.len() + b.len(), f64::INFINITY);
    kept
}

fn value([a, b]: [bool; 2], operation: Operation) -> bool {
    match operation {
        Operation::Union => a || b,
        Operation::Intersect => a && b,
        Operation::Difference => a && !b,
    }
}

fn algebra(a: &[f64], b: &[f64], operation: Operation) -> RootRay {
    let (a, b) = (root_ray(a), root_ray(b));
    match operation {
        Operation::Union => a.union(&b),
        Operation::Intersect => a.intersection(&b),
        Operation::Difference => a.difference(&b),
    }
}

/// The root-ray of a column: entries at -inf give the start, equal ones cancel in pairs, +inf is padding.
fn root_ray(column: &[f64]) -> RootRay {
    let start = column.iter().filter(|&&t| t == f64::NEG_INFINITY).count() % 2 == 1;
    let mut times: Vec<f64> = Vec::new();
    for &t in column.iter().filter(|t| t.is_finite()) {
        match times.last() == Some(&t) {
            true => times.truncate(times.len() - 1),
            false => times.push(t),
        }
    }
    RootRay::from_times(Side::from_inside(start), times).unwrap()
}
