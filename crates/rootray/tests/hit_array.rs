//! Hit arrays: the published test vectors, a slow transliteration of the algorithm, exact algebra, and all errors.

use std::fmt::Debug;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_rootray::hit_array::{
    CsgOptions, Float, HitArray, HitArrayError, Operation, Regularize, array_csg, array_csg_1d,
    array_csg_into, column_len, count_array, from_column, to_column, write_column,
};
use rayweave_rootray::{RootRay, Side};

const INF: f64 = f64::INFINITY;
const OPERATIONS: [Operation; 3] = [Operation::Union, Operation::Intersect, Operation::Difference];
const A: [f64; 4] = [1.0, 4.0, 5.0, 10.0];
const B: [f64; 10] = [0.0, 2.0, 3.0, 5.0, 6.0, 7.0, 8.0, 9.0, 11.0, 12.0];

fn options<T>(sort_output: bool, regularize: Regularize<T>) -> CsgOptions<T> {
    CsgOptions { sort_output, regularize, ..CsgOptions::default() }
}

fn padded<T: Float>(hits: &[T], rows: usize) -> Vec<T> {
    let mut hits = hits.to_vec();
    hits.resize(rows, T::INFINITY);
    hits
}

#[test]
fn published_vectors() {
    let csg = |operation| array_csg_1d(&A, &B, operation, CsgOptions::default()).unwrap();
    assert_eq!(csg(Operation::Union), padded(&[0.0, 10.0, 11.0, 12.0], 14));
    let double = [1.0, 2.0, 3.0, 4.0, 5.0, 5.0, 6.0, 7.0, 8.0, 9.0];
    assert_eq!(csg(Operation::Intersect), padded(&double, 14));
    assert_eq!(csg(Operation::Difference), padded(&[2.0, 3.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0], 14));
}

#[test]
fn published_vectors_in_f32_and_in_columns() {
    let narrow = |hits: &[f64]| hits.iter().map(|&t| t as f32).collect::<Vec<f32>>();
    let (a, b) = (narrow(&A), narrow(&B));
    let union = array_csg_1d(&a, &b, Operation::Union, CsgOptions::default()).unwrap();
    assert_eq!(union, padded(&[0.0_f32, 10.0, 11.0, 12.0], 14));
    // 40 rays, each a copy
    let repeat = |hits: &[f32]| hits.iter().flat_map(|&t| [t; 40]).collect::<Vec<f32>>();
    let (a, b) = (repeat(&a), repeat(&b));
    let (a, b) = (HitArray::new(&a, 4, 40).unwrap(), HitArray::new(&b, 10, 40).unwrap());
    assert_eq!(array_csg(a, b, Operation::Union, CsgOptions::default()).unwrap(), repeat(&union));
}

#[test]
fn regularizing_drops_the_double_hit_and_commutes() {
    let exact = options(true, Regularize::Exact);
    let csg = |a: &[f64], b: &[f64], operation| array_csg_1d(a, b, operation, exact).unwrap();
    let single = [1.0, 2.0, 3.0, 4.0, 6.0, 7.0, 8.0, 9.0];
    assert_eq!(csg(&A, &B, Operation::Intersect), padded(&single, 14));
    assert_eq!(csg(&B, &A, Operation::Intersect), padded(&single, 14));
    assert_eq!(csg(&A, &B, Operation::Union), padded(&[0.0, 10.0, 11.0, 12.0], 14));
    let difference = [2.0, 3.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0];
    assert_eq!(csg(&A, &B, Operation::Difference), padded(&difference, 14));
}

#[test]
fn operands_of_equal_times_do_not_commute_unless_regularized() {
    let (a, b) = ([0.0, 1.0], [1.0, 2.0]);
    let union = |a: &[f64], b: &[f64]| array_csg_1d(a, b, Operation::Union, CsgOptions::default()).unwrap();
    assert_eq!(union(&a, &b), [0.0, 1.0, 1.0, 2.0]);
    assert_eq!(union(&b, &a), [0.0, 2.0, INF, INF]);
    let intersect =
        |a: &[f64], b: &[f64]| array_csg_1d(a, b, Operation::Intersect, CsgOptions::default()).unwrap();
    assert_eq!(intersect(&a, &b), [INF; 4]);
    assert_eq!(intersect(&b, &a), [1.0, 1.0, INF, INF]);
}

#[test]
fn masked_entries_stay_in_merged_order() {
    let masked = options(false, Regularize::No);
    let hits = array_csg_1d(&[0.0, 3.0], &[1.0, 2.0], Operation::Union, masked).unwrap();
    assert_eq!(hits, [0.0, INF, INF, 3.0]);
    let hits = array_csg_1d(&[0.0, 3.0], &[1.0, 2.0], Operation::Intersect, masked).unwrap();
    assert_eq!(hits, [INF, 1.0, 2.0, INF]);
}

/// One ray by the published array program, step by step: concatenate, sort stably, count, compare with the row before, where
/// the row before the first is the last. Written without a merge on purpose.
fn transliterated<T: Float>(
    a: &[T],
    b: &[T],
    operation: Operation,
    sort_output: bool,
) -> (Vec<T>, Vec<T>, Vec<i64>) {
    let mut stacked: Vec<(usize, T)> = a.iter().chain(b).copied().enumerate().collect();
    stacked.sort_by(|x, y| x.1.partial_cmp(&y.1).unwrap());
    let difference = operation == Operation::Difference;
    let mut sum = i64::from(difference);
    let mut counts = Vec::new();
    for &(index, _) in &stacked {
        let leaves = (index % 2 == 1) != (difference && index >= a.len());
        sum += if leaves { -1 } else { 1 };
        counts.push(sum);
    }
    let n = counts.len();
    let changes = |row: usize| {
        let (here, above) = (counts[row], counts[(row + n - 1) % n]);
        match operation {
            Operation::Union => (here != 0) != (above != 0),
            Operation::Intersect | Operation::Difference => here == 2 || above == 2,
        }
    };
    let mut hits: Vec<T> =
        (0..n).map(|row| if changes(row) { stacked[row].1 } else { T::INFINITY }).collect();
    if sort_output {
        hits.sort_by(|x, y| x.partial_cmp(y).unwrap());
    }
    (hits, stacked.into_iter().map(|entry| entry.1).collect(), counts)
}

/// A sorted column of an even number of entries: small integers (so that there are ties), padding and unbounded starts.
fn random_column<T: Float>(rng: &mut ChaCha8Rng, rows: usize, number: fn(f64) -> T) -> Vec<T> {
    let entry = |rng: &mut ChaCha8Rng| match rng.random_range(0..10) {
        0 => -INF,
        1 | 2 => INF,
        3 => rng.random_range(-6.0..6.0),
        _ => f64::from(rng.random_range(-6..6)),
    };
    let mut column: Vec<f64> = (0..rows).map(|_| entry(rng)).collect();
    column.sort_by(f64::total_cmp);
    column.into_iter().map(number).collect()
}

fn random_columns<T: Float>(rng: &mut ChaCha8Rng, columns: usize, number: fn(f64) -> T) -> Vec<Vec<T>> {
    let rows = 2 * rng.random_range(0..7);
    (0..columns).map(|_| random_column(rng, rows, number)).collect()
}

/// The columns, row by row.
fn rows_of<T: Copy>(columns: &[Vec<T>]) -> Vec<T> {
    let rows = columns.first().map_or(0, Vec::len);
    (0..rows).flat_map(|row| columns.iter().map(move |column| column[row])).collect()
}

fn agrees_with_the_transliteration<T: Float + Debug>(seed: u64, number: fn(f64) -> T) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for round in 0..400 {
        // one block of columns, several, and a part of one
        let columns = [1, 2, 16, 17, 50][round % 5];
        let (a, b) = (random_columns(&mut rng, columns, number), random_columns(&mut rng, columns, number));
        let (rows1, rows2) = (a[0].len(), b[0].len());
        let (data1, data2) = (rows_of(&a), rows_of(&b));
        let array1 = HitArray::new(&data1, rows1, columns).unwrap();
        let array2 = HitArray::new(&data2, rows2, columns).unwrap();
        for operation in OPERATIONS {
            for sort_output in [true, false] {
                let slow: Vec<_> =
                    a.iter().zip(&b).map(|(a, b)| transliterated(a, b, operation, sort_output)).collect();
                let expected: Vec<Vec<T>> = slow.iter().map(|slow| slow.0.clone()).collect();
                let found =
                    array_csg(array1, array2, operation, options(sort_output, Regularize::No)).unwrap();
                assert_eq!(found, rows_of(&expected), "{operation:?} {a:?} {b:?}");
                let count = count_array(array1, array2, operation).unwrap();
                assert_eq!(count.times, rows_of(&slow.iter().map(|s| s.1.clone()).collect::<Vec<_>>()));
                let counts: Vec<i64> = count.counts.into_iter().map(i64::from).collect();
                assert_eq!(counts, rows_of(&slow.iter().map(|s| s.2.clone()).collect::<Vec<_>>()));
            }
        }
    }
}

#[test]
fn agrees_with_the_transliteration_in_f64() {
    agrees_with_the_transliteration::<f64>(20, |t| t);
}

#[test]
fn agrees_with_the_transliteration_in_f32() {
    agrees_with_the_transliteration::<f32>(21, |t| t as f32);
}

#[test]
fn signs_of_zero_follow_the_merged_order() {
    let bits = |hits: &[f64]| hits.iter().map(|t| t.to_bits()).collect::<Vec<_>>();
    let hits = array_csg_1d(&[-0.0, 1.0], &[-1.0, 0.0], Operation::Union, CsgOptions::default()).unwrap();
    assert_eq!(bits(&hits), bits(&[-1.0, 1.0, INF, INF]));
    let hits = array_csg_1d(&[0.0, 1.0], &[-0.0, 1.0], Operation::Intersect, CsgOptions::default()).unwrap();
    assert_eq!(bits(&hits), bits(&[-0.0, 1.0, INF, INF]));
    let exact = options(true, Regularize::Exact);
    for (a, b) in [([-0.0, 1.0], [0.0, 2.0]), ([0.0, 2.0], [-0.0, 1.0])] {
        let hits = array_csg_1d(&a, &b, Operation::Union, exact).unwrap();
        assert_eq!(bits(&hits), bits(&[0.0, 2.0, INF, INF]));
    }
}

fn combine(a: &RootRay, b: &RootRay, operation: Operation) -> RootRay {
    match operation {
        Operation::Union => a | b,
        Operation::Intersect => a & b,
        Operation::Difference => a - b,
    }
}

#[test]
fn regularized_hits_are_those_of_the_root_ray_algebra() {
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    for _ in 0..2000 {
        let (a, b) = (random_columns(&mut rng, 1, |t| t), random_columns(&mut rng, 1, |t| t));
        let (ray1, ray2) = (from_column(&a[0]).unwrap(), from_column(&b[0]).unwrap());
        let min_sep = rng.random_range(0.0..1.5);
        for operation in OPERATIONS {
            let csg = |regularize| array_csg_1d(&a[0], &b[0], operation, options(true, regularize)).unwrap();
            let expect = |ray: &RootRay| {
                let used = to_column(ray).into_iter().filter(|&t| t < INF).collect::<Vec<_>>();
                padded(&used, a[0].len() + b[0].len())
            };
            let exact = combine(&ray1, &ray2, operation);
            assert_eq!(csg(Regularize::Exact), expect(&exact), "{operation:?} {a:?} {b:?}");
            assert_eq!(csg(Regularize::Weld(0.0)), expect(&exact));
            assert_eq!(csg(Regularize::Weld(min_sep)), expect(&exact.weld(|_, _| min_sep)), "{min_sep}");
        }
    }
}

#[test]
fn welding_in_f32_uses_the_given_length() {
    let weld = |min_sep| {
        let weld = options(true, Regularize::Weld(min_sep));
        array_csg_1d(&[0.0_f32, 1.0], &[1.125, 2.0], Operation::Union, weld).unwrap()
    };
    assert_eq!(weld(0.125), [0.0, 1.0, 1.125, 2.0]);
    assert_eq!(weld(0.25), [0.0, 2.0, f32::INFINITY, f32::INFINITY]);
}

#[test]
fn empty_arrays_are_legal() {
    let empty: [f64; 0] = [];
    let none = |rows| HitArray::new(&empty, rows, 0).unwrap();
    for operation in OPERATIONS {
        for sort_output in [true, false] {
            let options = options(sort_output, Regularize::No);
            assert_eq!(array_csg(none(4), none(2), operation, options).unwrap(), []);
            assert_eq!(array_csg_1d(&[], &[], operation, options).unwrap(), [] as [f64; 0]);
            let kept = operation != Operation::Intersect;
            let hits = array_csg_1d(&[1.0, 2.0], &[], operation, options).unwrap();
            assert_eq!(hits, if kept { [1.0, 2.0] } else { [INF, INF] });
            let kept = operation == Operation::Union;
            let hits = array_csg_1d(&[], &[1.0, 2.0], operation, options).unwrap();
            assert_eq!(hits, if kept { [1.0, 2.0] } else { [INF, INF] });
        }
        let exact = options(true, Regularize::Exact);
        assert_eq!(array_csg(none(0), none(0), operation, exact).unwrap(), []);
    }
    let no_hits = HitArray::new(&empty, 0, 5).unwrap();
    assert_eq!(array_csg(no_hits, no_hits, Operation::Union, CsgOptions::default()).unwrap(), []);
    assert_eq!(no_hits.column(0).count() + no_hits.column(9).count(), 0);
}

fn error(a: (&[f64], usize, usize), b: (&[f64], usize, usize)) -> HitArrayError {
    let array1 = HitArray::new(a.0, a.1, a.2).unwrap();
    let array2 = HitArray::new(b.0, b.1, b.2).unwrap();
    let counted = count_array(array1, array2, Operation::Union).unwrap_err();
    let error = array_csg(array1, array2, Operation::Union, CsgOptions::default()).unwrap_err();
    // by their text: an error that holds NaN does not equal itself
    assert_eq!(counted.to_string(), error.to_string());
    error
}

#[test]
fn bad_arrays_are_rejected_with_the_first_bad_place() {
    let good = (&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0][..], 2, 3);
    let odd = (&[0.0; 9][..], 3, 3);
    assert_eq!(error(good, odd), HitArrayError::OddRows { array: "array2", rows: 3 });
    assert_eq!(error(good, (&[0.0; 4], 2, 2)), HitArrayError::Columns { columns1: 3, columns2: 2 });
    // columns 1 and 2 are bad; row 1 of column 1 comes first
    let unsorted = (&[0.0, 5.0, f64::NAN, 0.0, 4.0, 0.0][..], 2, 3);
    let expected = |array| HitArrayError::NotSorted { array, row: 1, column: 1, previous: 5.0, t: 4.0 };
    assert_eq!(error(unsorted, good), expected("array1"));
    assert_eq!(error(good, unsorted), expected("array2"));
    assert_eq!(error(unsorted, odd), expected("array1"));
    for row in 0..2 {
        let mut data = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0];
        data[row * 3 + 2] = f64::NAN;
        assert_eq!(error(good, (&data, 2, 3)), HitArrayError::Nan { array: "array2", row, column: 2 });
    }
    let text = expected("array1").to_string();
    assert_eq!(
        text,
        "array1 row 1, column 1 is 4, less than 5 in the row before: columns must be sorted. Sort along axis 0."
    );
}

#[test]
fn bad_shapes_and_options_are_rejected() {
    let data = [0.0; 6];
    let shape = |rows, columns| HitArray::new(&data, rows, columns).map(|array| array.rows()).unwrap_err();
    assert_eq!(shape(2, 2), HitArrayError::Shape { len: 6, rows: 2, columns: 2 });
    assert!(matches!(shape(usize::MAX, 2), HitArrayError::Shape { .. }));

    let csg = |options, len: usize| {
        let mut out = vec![7.0; len];
        let pair = (HitArray::single(&data[..2]), HitArray::single(&data[..4]));
        let result = array_csg_into(pair.0, pair.1, Operation::Union, options, &mut out);
        assert!(result.is_ok() || out.iter().all(|&t| t == 7.0), "out is left as it was");
        result
    };
    assert_eq!(csg(CsgOptions::default(), 6), Ok(()));
    let length = HitArrayError::OutputLength { expected: 6, found: 5 };
    assert_eq!(csg(CsgOptions::default(), 5), Err(length));
    let unsorted = Err(HitArrayError::RegularizeUnsorted);
    assert_eq!(csg(options(false, Regularize::Exact), 6), unsorted);
    assert_eq!(csg(options(false, Regularize::Weld(1.0)), 6), unsorted);
    for min_sep in [-1.0, INF, f64::NAN] {
        let result = csg(options(true, Regularize::Weld(min_sep)), 6);
        assert!(matches!(result, Err(HitArrayError::MinSep { .. })), "{min_sep}");
    }
}

#[test]
fn columns_become_root_rays() {
    let ray = |column: &[f64]| from_column(column).unwrap().to_string();
    assert_eq!(ray(&[]), "outside []");
    assert_eq!(ray(&[1.0, 2.0, INF, INF]), "outside [1, 2]");
    assert_eq!(ray(&[-INF, 2.0]), "inside [2]");
    assert_eq!(ray(&[-INF, -INF, 2.0, INF]), "outside [2]");
    assert_eq!(ray(&[-INF, INF]), "inside []");
    assert_eq!(ray(&[1.0, 1.0, 2.0, 2.0, 2.0, 3.0]), "outside [2, 3]");
    let zero = from_column(&[-1.0, -0.0]).unwrap();
    assert!(zero.roots()[1].t.is_sign_positive());
    assert_eq!(from_column(&[0.1_f32, INF as f32]).unwrap().roots()[0].t, f64::from(0.1_f32));

    assert_eq!(from_column(&[1.0]), Err(HitArrayError::OddRows { array: "column", rows: 1 }));
    let nan = from_column(&[1.0, f64::NAN]);
    assert_eq!(nan, Err(HitArrayError::Nan { array: "column", row: 1, column: 0 }));
    assert!(matches!(from_column(&[1.0, 0.0]), Err(HitArrayError::NotSorted { row: 1, .. })));
}

#[test]
fn root_rays_become_columns() {
    let ray = |start, times: &[f64]| RootRay::from_times(start, times.iter().copied()).unwrap();
    let cases = [
        (ray(Side::Outside, &[]), vec![INF, INF]),
        (ray(Side::Inside, &[]), vec![-INF, INF]),
        (ray(Side::Inside, &[1.0]), vec![-INF, 1.0]),
        (ray(Side::Inside, &[1.0, 2.0]), vec![-INF, 1.0, 2.0, INF]),
        (ray(Side::Outside, &[1.0, 2.0, 3.0]), vec![1.0, 2.0, 3.0, INF]),
    ];
    for (ray, column) in cases {
        assert_eq!(column_len(&ray), column.len());
        assert_eq!(to_column(&ray), column);
        assert_eq!(from_column(&column), Ok(ray.clone()));
        // the second column of a wider and longer array
        let mut data = vec![7.0; 3 * (column.len() + 2)];
        write_column(&ray, data.iter_mut().skip(1).step_by(3)).unwrap();
        let array = HitArray::new(&data, column.len() + 2, 3).unwrap();
        assert_eq!(array.column(1).collect::<Vec<_>>(), padded(&column, column.len() + 2));
        assert!(array.column(0).chain(array.column(2)).all(|t| t == 7.0));
    }
    let long = ray(Side::Inside, &[1.0, 2.0]);
    let mut rows = [7.0; 3];
    let short = write_column(&long, rows[..2].iter_mut());
    assert_eq!(short, Err(HitArrayError::ColumnLength { rows: 2, needed: 3 }));
    let odd = write_column(&long, rows.iter_mut());
    assert_eq!((odd, rows), (Err(HitArrayError::OddRows { array: "column", rows: 3 }), [7.0; 3]));
}
