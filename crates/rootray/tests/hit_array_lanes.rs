//! SIMD forms against the scalar form, bit for bit: every instruction set, remainders of lanes, shapes, ties,
//! zeros of both signs, infinities, threads; and the positions of errors.

use std::num::NonZeroUsize;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_rootray::hit_array::{
    CsgOptions, Float, HitArray, HitArrayError, Instructions, Operation, array_csg, array_csg_1d,
    array_csg_into,
};

const INF: f64 = f64::INFINITY;
const OPERATIONS: [Operation; 3] = [Operation::Union, Operation::Intersect, Operation::Difference];

/// One ray by the definition, without a merge: an entry of one operand is kept if the other's side lets it change the result.
/// Equal times: those of the first operand come first.
fn by_sides(a: &[f64], b: &[f64], operation: Operation) -> Vec<f64> {
    let inside_b = |t: f64| b.iter().filter(|&&other| other < t).count() % 2 == 1;
    let inside_a = |t: f64| a.iter().filter(|&&other| other <= t).count() % 2 == 1;
    let (keep_a, keep_b) = match operation {
        Operation::Union => (false, false),
        Operation::Intersect => (true, true),
        Operation::Difference => (false, true),
    };
    let first = a.iter().filter(|&&t| inside_b(t) == keep_a).map(|&t| (t, 0));
    let second = b.iter().filter(|&&t| inside_a(t) == keep_b).map(|&t| (t, 1));
    let mut kept: Vec<(f64, usize)> = first.chain(second).collect();
    kept.sort_by(|x, y| x.partial_cmp(y).unwrap());
    let mut hits: Vec<f64> = kept.into_iter().map(|entry| entry.0).collect();
    hits.resize(a.len() + b.len(), INF);
    hits
}

/// The columns, row by row.
fn rows_of(columns: &[Vec<f64>]) -> Vec<f64> {
    let rows = columns.first().map_or(0, Vec::len);
    (0..rows).flat_map(|row| columns.iter().map(move |column| column[row])).collect()
}

fn bits<T: Float>(hits: &[T]) -> Vec<u64> {
    hits.iter().map(|t| t.to_f64().to_bits()).collect()
}

/// Combines the columns with all instructions and compares with the definition, bit for bit.
fn check<T: Float>(a: &[Vec<f64>], b: &[Vec<f64>], number: fn(f64) -> T) {
    let (rows1, rows2, columns) = (a[0].len(), b[0].len(), a.len());
    let narrow = |columns: &[Vec<f64>]| rows_of(columns).into_iter().map(number).collect::<Vec<T>>();
    let (data1, data2) = (narrow(a), narrow(b));
    let first = HitArray::new(&data1, rows1, columns).unwrap();
    let second = HitArray::new(&data2, rows2, columns).unwrap();
    for operation in OPERATIONS {
        let expected: Vec<Vec<f64>> = a.iter().zip(b).map(|(a, b)| by_sides(a, b, operation)).collect();
        let expected = bits(&narrow(&expected));
        for instructions in Instructions::available().into_iter().chain([Instructions::Widest]) {
            let options = CsgOptions { instructions, ..CsgOptions::default() };
            let found = bits(&array_csg(first, second, operation, options).unwrap());
            assert_eq!(found, expected, "{operation:?} {instructions:?} {a:?} {b:?}");
        }
    }
}

fn check_both(a: &[Vec<f64>], b: &[Vec<f64>]) {
    check::<f64>(a, b, |t| t);
    check::<f32>(a, b, |t| t as f32);
}

/// All non-decreasing columns of `rows` rows over the given numbers.
fn all_columns(rows: usize, numbers: &[f64]) -> Vec<Vec<f64>> {
    let mut columns = vec![vec![]];
    for _ in 0..rows {
        let longer = |column: Vec<f64>| {
            let last = column.last().copied().unwrap_or(-INF);
            let more = numbers.iter().filter(move |&&t| t >= last);
            more.map(move |&t| column.iter().copied().chain([t]).collect::<Vec<_>>()).collect::<Vec<_>>()
        };
        columns = columns.into_iter().flat_map(longer).collect();
    }
    columns
}

fn check_all_pairs(a: &[Vec<f64>], b: &[Vec<f64>]) {
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a.clone(), b.clone())));
    let (a, b): (Vec<_>, Vec<_>) = pairs.unzip();
    check_both(&a, &b);
}

/// All arrangements of up to two pieces that are disjoint, touch or have no length, next to operands with
/// none or many entries.
#[test]
fn all_small_columns() {
    let numbers = [-INF, 1.0, 2.0, 3.0, INF];
    let columns = [0, 2, 4].map(|rows| all_columns(rows, &numbers));
    assert_eq!(columns.each_ref().map(Vec::len), [1, 15, 70]);
    for a in &columns {
        columns.iter().for_each(|b| check_all_pairs(a, b));
    }
}

/// Six rows of three different numbers against few: all possible ties, for the networks that do not
/// distinguish operands.
#[test]
fn all_ties_of_six_rows() {
    let high = all_columns(6, &[1.0, 2.0, INF]);
    assert_eq!(high.len(), 28);
    check_all_pairs(&high, &high);
    check_all_pairs(&high, &all_columns(2, &[1.0, 2.0, INF]));
    check_all_pairs(&all_columns(10, &[1.0, 2.0]), &high);
}

/// Zeros of both signs are equal times; the result holds the bits of the merged order.
#[test]
fn all_signs_of_zero() {
    let numbers = [-1.0, -0.0, 0.0, 1.0];
    let columns = [2, 4].map(|rows| all_columns(rows, &numbers));
    for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        check_all_pairs(&columns[a], &columns[b]);
    }
    let high = all_columns(10, &[-0.0, 1.0]);
    check_all_pairs(&high, &columns[0]);
}

/// A sorted column: a random mixture of ties, other times, padding and unbounded starts.
fn random_column(rng: &mut ChaCha8Rng, rows: usize, ties: f64) -> Vec<f64> {
    let entry = |rng: &mut ChaCha8Rng| match rng.random_range(0..12) {
        0 => -INF,
        1 | 2 => INF,
        3 => -0.0,
        _ if rng.random_bool(ties) => f64::from(rng.random_range(-6..6)),
        // the same number in both precisions
        _ => f64::from(rng.random_range(-60.0_f32..60.0)),
    };
    let mut column: Vec<f64> = (0..rows).map(|_| entry(rng)).collect();
    column.sort_by(|a, b| a.partial_cmp(b).unwrap());
    column
}

fn random_columns(rng: &mut ChaCha8Rng, rows: usize, columns: usize, ties: f64) -> Vec<Vec<f64>> {
    (0..columns).map(|_| random_column(rng, rows, ties)).collect()
}

#[test]
fn all_shapes_up_to_ten_rows() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    for (rows1, rows2) in (0..=5).flat_map(|a| (0..=5).map(move |b| (2 * a, 2 * b))) {
        for ties in [0.0, 0.3, 1.0] {
            let a = random_columns(&mut rng, rows1, 67, ties);
            check_both(&a, &random_columns(&mut rng, rows2, 67, ties));
        }
    }
}

#[test]
fn all_remainders_of_lanes() {
    let mut rng = ChaCha8Rng::seed_from_u64(32);
    for columns in 1..=70 {
        for (rows1, rows2) in [(2, 2), (4, 2), (2, 6), (8, 8), (12, 10)] {
            let a = random_columns(&mut rng, rows1, columns, 0.2);
            check_both(&a, &random_columns(&mut rng, rows2, columns, 0.2));
        }
    }
}

#[test]
fn many_rows() {
    let mut rng = ChaCha8Rng::seed_from_u64(33);
    for (rows1, rows2, columns) in
        [(64, 64, 40), (200, 2, 40), (0, 130, 40), (1022, 1026, 16), (1200, 1200, 16)]
    {
        for ties in [0.0, 0.1] {
            let a = random_columns(&mut rng, rows1, columns, ties);
            check_both(&a, &random_columns(&mut rng, rows2, columns, ties));
        }
    }
}

fn threads(count: usize) -> NonZeroUsize {
    NonZeroUsize::new(count).unwrap()
}

/// A large array, with one or several threads, whole or in batches.
#[test]
fn threads_and_batches_do_not_show() {
    let mut rng = ChaCha8Rng::seed_from_u64(34);
    let (rows, columns) = (4, 150_001);
    let data: [Vec<f64>; 2] = [0; 2].map(|_| rows_of(&random_columns(&mut rng, rows, columns, 0.1)));
    let [first, second] = data.each_ref().map(|data| HitArray::new(data, rows, columns).unwrap());
    for sort_output in [true, false] {
        let csg = |count: usize| {
            let options = CsgOptions { threads: threads(count), sort_output, ..CsgOptions::default() };
            bits(&array_csg(first, second, Operation::Union, options).unwrap())
        };
        let alone = csg(1);
        assert!([2, 3, 7].into_iter().all(|count| csg(count) == alone));
        for (start, width) in [(0, 1), (17, 7), (149_000, 64), (64, 1000), (1, 150_000)] {
            let cut = |data: &Vec<f64>| -> Vec<f64> {
                data.chunks(columns).flat_map(|row| row[start..start + width].to_vec()).collect()
            };
            let parts = data.each_ref().map(cut);
            let [first, second] = parts.each_ref().map(|data| HitArray::new(data, rows, width).unwrap());
            let options = CsgOptions { sort_output, ..CsgOptions::default() };
            let batch = bits(&array_csg(first, second, Operation::Union, options).unwrap());
            let expected: Vec<u64> =
                alone.chunks(columns).flat_map(|row| row[start..start + width].to_vec()).collect();
            assert_eq!(batch, expected);
        }
    }
}

/// One error among many rays is found anywhere, with its row and column.
#[test]
fn faults_are_named_where_they_are() {
    for (rows, columns) in [(2, 700), (4, 700), (6, 100), (12, 100)] {
        let good: Vec<f64> = (0..rows).flat_map(|row| vec![row as f64; columns]).collect();
        for (row, column) in [(0, 0), (rows - 1, columns - 1), (1, 67), (rows / 2, columns - 3)] {
            let mut bad = good.clone();
            bad[row * columns + column] = f64::NAN;
            let expected = |array| format!("{array} row {row}, column {column} is NaN");
            check_fault(&bad, &good, rows, &expected("array1"));
            check_fault(&good, &bad, rows, &expected("array2"));
            if row > 0 {
                bad[row * columns + column] = -9.0;
                check_fault(
                    &bad,
                    &good,
                    rows,
                    &format!("array1 row {row}, column {column} is -9, less than"),
                );
            }
        }
    }
}

fn check_fault(a: &[f64], b: &[f64], rows: usize, expected: &str) {
    let columns = a.len() / rows;
    let [a32, b32] = [a, b].map(|data| data.iter().map(|&t| t as f32).collect::<Vec<_>>());
    for instructions in Instructions::available() {
        let error = fault(a, b, rows, columns, instructions);
        assert!(error.to_string().starts_with(expected), "{error} {expected}");
        let error = fault(&a32, &b32, rows, columns, instructions);
        assert!(error.to_string().starts_with(expected), "{error} {expected}");
    }
}

fn fault<T: Float>(
    a: &[T],
    b: &[T],
    rows: usize,
    columns: usize,
    instructions: Instructions,
) -> HitArrayError {
    let [first, second] = [a, b].map(|data| HitArray::new(data, rows, columns).unwrap());
    let options = CsgOptions { instructions, threads: threads(3), ..CsgOptions::default() };
    array_csg(first, second, Operation::Union, options).unwrap_err()
}

/// After an error of shape, or in a single ray, the output is unchanged.
#[test]
fn small_faults_write_nothing() {
    let mut out = [7.0; 4];
    let single = |column| HitArray::single(column);
    let csg = |a, b, out: &mut [f64]| array_csg_into(a, b, Operation::Union, CsgOptions::default(), out);
    assert!(csg(single(&[0.0, 1.0]), single(&[1.0, 0.0]), &mut out).is_err());
    assert!(csg(single(&[0.0, 1.0]), single(&[0.0]), &mut out).is_err());
    assert!(csg(single(&[0.0, 1.0]), single(&[0.0, 1.0, 2.0, 3.0]), &mut out).is_err());
    assert_eq!(out, [7.0; 4]);
}

#[test]
fn instructions_are_named_from_narrow_to_wide() {
    let available = Instructions::available();
    assert_eq!(available[0], Instructions::Scalar);
    assert!(!available.contains(&Instructions::Widest));
    #[cfg(target_arch = "x86_64")]
    assert!(available.contains(&Instructions::Sse2), "every such machine has it");
    // an instruction set that the machine lacks is not used, and the result is the same
    let requested = [Instructions::Sse42, Instructions::Avx2, Instructions::Avx512];
    for instructions in requested {
        let options = CsgOptions { instructions, ..CsgOptions::default() };
        let hits = array_csg_1d(&[0.0, 2.0], &[1.0, 3.0], Operation::Difference, options).unwrap();
        assert_eq!(hits, [0.0, 1.0, INF, INF]);
    }
}
