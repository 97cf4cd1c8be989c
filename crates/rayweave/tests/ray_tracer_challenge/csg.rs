//! Constructive solid geometry: chapter 16.

use crate::ask::*;
use rayweave::rootray::hit_array::{CsgOptions, Operation, array_csg_1d};
use rayweave::rootray::{RootRay, Side};
use rayweave::shapes::{box_, box_from_corners, slab, sphere};
use rayweave::{Solid, Vec3};

const OPERATIONS: [Operation; 3] = [Operation::Union, Operation::Intersect, Operation::Difference];

fn solid(operation: Operation, a: &Solid, b: &Solid) -> Solid {
    match operation {
        Operation::Union => a | b,
        Operation::Intersect => a & b,
        Operation::Difference => a - b,
    }
}

fn algebra(operation: Operation, a: &RootRay, b: &RootRay) -> RootRay {
    match operation {
        Operation::Union => a.union(b),
        Operation::Intersect => a.intersection(b),
        Operation::Difference => a.difference(b),
    }
}

/// Whether an intersection counts, by (left shape hit, inside left, inside right) just before: the book's
/// table in its order, for each operation.
const ALLOWED: [[bool; 8]; 3] = [
    [false, true, false, true, false, false, true, true],
    [true, false, true, false, true, true, false, false],
    [false, true, false, true, true, true, false, false],
];

/// The rows of the table: `(left is hit, inside left, inside right)`.
fn rows() -> impl Iterator<Item = [bool; 3]> {
    (0..8).map(|row: usize| [row < 4, row & 2 == 0, row & 1 == 0])
}

/// Root-rays of the two shapes of a row: the shape that is hit changes sides at 0, the other one never.
fn wave(is_hit: bool, inside: bool) -> RootRay {
    let times: &[f64] = if is_hit { &[0.0] } else { &[] };
    RootRay::from_times(Side::from_inside(inside), times.iter().copied()).unwrap()
}

#[test]
fn the_table_by_the_algebra_of_root_rays() {
    for (operation, allowed) in OPERATIONS.into_iter().zip(ALLOWED) {
        for ([left_hit, in_left, in_right], expected) in rows().zip(allowed) {
            let (a, b) = (wave(left_hit, in_left), wave(!left_hit, in_right));
            let found = algebra(operation, &a, &b).roots().len();
            assert_eq!(found == 1, expected, "{operation:?} {left_hit} {in_left} {in_right}");
        }
    }
}

#[test]
fn the_table_by_hit_arrays() {
    for (operation, allowed) in OPERATIONS.into_iter().zip(ALLOWED) {
        for ([left_hit, in_left, in_right], expected) in rows().zip(allowed) {
            let column = |is_hit: bool, inside: bool| {
                let mut hits = [f64::INFINITY; 2];
                let start = if inside {
                    hits[0] = f64::NEG_INFINITY;
                    1
                } else {
                    0
                };
                hits[start] = if is_hit { 0.0 } else { hits[start] };
                hits
            };
            let (a, b) = (column(left_hit, in_left), column(!left_hit, in_right));
            let found = array_csg_1d(&a, &b, operation, CsgOptions::default()).unwrap();
            assert_eq!(found.contains(&0.0), expected, "{operation:?} {left_hit} {in_left} {in_right}");
        }
    }
}

/// The table with geometry: slabs across x; one has a face at x = 0, and the other is wide or far away.
#[test]
fn the_table_by_solids() {
    for (operation, allowed) in OPERATIONS.into_iter().zip(ALLOWED) {
        for ([left_hit, in_left, in_right], expected) in rows().zip(allowed) {
            let shape = |is_hit: bool, inside: bool, name: &str| {
                let (lo, hi) = match (is_hit, inside) {
                    (true, true) => (-3.0, 0.0),
                    (true, false) => (0.0, 3.0),
                    (false, true) => (-5.0, 5.0),
                    (false, false) => (7.0, 9.0),
                };
                slab(Vec3::X, lo, hi).unwrap().named(name)
            };
            let (a, b) = (shape(left_hit, in_left, "left"), shape(!left_hit, in_right, "right"));
            let found = hits(&solid(operation, &a, &b), ray([0.0; 3], [1.0, 0.0, 0.0]));
            let there = found.iter().find(|hit| hit.0 == 0.0);
            assert_eq!(there.is_some(), expected, "{operation:?} {left_hit} {in_left} {in_right}");
            let side = if left_hit { "left." } else { "right." };
            assert!(there.is_none_or(|hit| hit.1.starts_with(side)), "{there:?}");
        }
    }
}

/// The kept ones of the intersections 1, 2, 3, 4, which alternate between two shapes.
const KEPT: [[usize; 2]; 3] = [[0, 3], [1, 2], [0, 1]];

#[test]
fn lists_are_filtered() {
    let (xs, shapes) = ([1.0, 2.0, 3.0, 4.0], ["s1", "s2", "s1", "s2"]);
    let span = |name: &str, lo: f64, hi: f64| {
        box_from_corners([lo, -1.0, -1.0], [hi, 1.0, 1.0]).unwrap().named(name)
    };
    let (s1, s2) = (span("s1", xs[0], xs[2]), span("s2", xs[1], xs[3]));
    for (operation, kept) in OPERATIONS.into_iter().zip(KEPT) {
        let expected = kept.map(|k| xs[k]);
        let found = array_csg_1d(&[xs[0], xs[2]], &[xs[1], xs[3]], operation, CsgOptions::default()).unwrap();
        assert_eq!(found[..2], expected);
        assert_eq!(found[2..], [f64::INFINITY; 2]);
        let found = hits(&solid(operation, &s1, &s2), ray([0.0; 3], [1.0, 0.0, 0.0]));
        let named: Vec<_> = found.iter().map(|hit| (hit.0, hit.1.split('.').next().unwrap())).collect();
        assert_eq!(named, kept.map(|k| (xs[k], shapes[k])));
    }
}

#[test]
fn a_ray_that_misses() {
    let joined = sphere(1.0).unwrap() | box_(Vec3::splat(2.0)).unwrap();
    assert_misses(&joined, ray([0.0, 2.0, -5.0], [0.0, 0.0, 1.0]));
}

#[test]
fn a_ray_that_hits() {
    let first = sphere(1.0).unwrap().named("s1");
    let second = sphere(1.0).unwrap().named("s2").translate([0.0, 0.0, 0.5]);
    let found = hits(&(first | second), ray([0.0, 0.0, -5.0], [0.0, 0.0, 1.0]));
    assert_eq!(found, [(4.0, "s1.side".to_owned()), (6.5, "s2.side".to_owned())]);
}
