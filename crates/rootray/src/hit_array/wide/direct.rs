//! Few rows: everything happens in registers, from the rows of the operands to those of the result.

use std::array::from_fn;
use std::ops::Range;

use fearless_simd::prelude::*;

use super::super::kernel::{self, TruthTable};
use super::super::part::Part;
use super::super::scalar::walk;
use super::super::{Operation, Real};
use super::rule::{self, Rule};
use super::watch::Watch;
use super::{load, store};

/// The greatest number of rows of an operand that is combined here.
pub(super) const ROWS: usize = 8;

/// Columns between two looks at what was seen.
const CHUNK: usize = 512;

/// The operands' rows, those that are not there as padding, and the rows of the result that are there: every other one, and
/// those between.
struct Rows<'a, T, const H: usize> {
    first: [&'a [T]; H],
    second: [&'a [T]; H],
    even: [Option<&'a mut [T]>; H],
    odd: [Option<&'a mut [T]>; H],
}

impl<'a, T: Real, const H: usize> Rows<'a, T, H> {
    fn new(part: &'a mut Part<'_, T, T>, columns: Range<usize>, padding: &'a [T; CHUNK]) -> Self {
        let padding = &padding[..columns.len()];
        let row = |rows: &[&'a [T]], k: usize| rows.get(k).map_or(padding, |row| &row[columns.clone()]);
        let (mut even, mut odd) = ([const { None }; H], [const { None }; H]);
        for (k, row) in part.out.iter_mut().enumerate() {
            let half = if k % 2 == 0 { &mut even } else { &mut odd };
            half[k / 2] = Some(&mut row[columns.clone()]);
        }
        Rows { first: from_fn(|k| row(&part.rows1, k)), second: from_fn(|k| row(&part.rows2, k)), even, odd }
    }

    /// Combines as many columns as there are lanes, or fewer.
    #[inline(always)]
    fn step<S: Simd>(&mut self, simd: S, rule: Rule, columns: Range<usize>, watch: &mut Watch<S, T>) {
        let padding = T::Lanes::<S>::splat(simd, T::INFINITY);
        let (mut first, mut second) = ([padding; H], [padding; H]);
        unrolled!(k < H => {
            first[k] = load(simd, &self.first[k][columns.clone()]);
            second[k] = load(simd, &self.second[k][columns.clone()]);
        });
        let [even, odd] = combine::<S, T, H>(simd, rule, first, second, watch);
        unrolled!(k < H => {
            if let Some(row) = &mut self.even[k] {
                store::<S, T>(even[k], &mut row[columns.clone()]);
            }
            if let Some(row) = &mut self.odd[k] {
                store::<S, T>(odd[k], &mut row[columns.clone()]);
            }
        });
    }
}

/// Combines operands of at most `H` rows, which is 2, 4 or [`ROWS`]. False if a column is not sorted or holds NaN; the result
/// is of no use then.
#[inline(always)]
pub(super) fn run<S: Simd, T: Real, const H: usize>(
    simd: S,
    operation: Operation,
    part: &mut Part<'_, T, T>,
) -> bool {
    let (width, padding) = (part.width(), [T::INFINITY; CHUNK]);
    for start in (0..width).step_by(CHUNK) {
        let columns = start..width.min(start + CHUNK);
        let rows = Rows::<T, H>::new(part, columns.clone(), &padding);
        let watch = match operation {
            Operation::Union => chunk(simd, Rule::new(Operation::Union), rows, columns.len()),
            Operation::Intersect => chunk(simd, Rule::new(Operation::Intersect), rows, columns.len()),
            Operation::Difference => chunk(simd, Rule::new(Operation::Difference), rows, columns.len()),
        };
        if !watch.is_sorted() {
            return false;
        }
        if watch.has_zero() && part.has_negative_zero(&columns) {
            let table = TruthTable::new(operation);
            walk(part, columns, |a, b, out| kernel::keep(table, a, b, out));
        }
    }
    true
}

/// Combines columns of one rule, which the compiler knows.
#[inline(always)]
fn chunk<S: Simd, T: Real, const H: usize>(
    simd: S,
    rule: Rule,
    mut rows: Rows<'_, T, H>,
    width: usize,
) -> Watch<S, T> {
    let len = T::Lanes::<S>::LEN;
    let whole = width - width % len;
    let mut watch = Watch::new(simd);
    for start in (0..whole).step_by(len) {
        rows.step(simd, rule, start..start + len, &mut watch);
    }
    if whole < width {
        rows.step(simd, rule, whole..width, &mut watch);
    }
    watch
}

/// The rows of the result, every other one and those between, for one column in each lane.
#[inline(always)]
fn combine<S: Simd, T: Real, const H: usize>(
    simd: S,
    rule: Rule,
    first: [T::Lanes<S>; H],
    second: [T::Lanes<S>; H],
    watch: &mut Watch<S, T>,
) -> [[T::Lanes<S>; H]; 2] {
    unrolled!(k < H => {
        watch.sign(first[k]);
        watch.sign(second[k]);
        if k > 0 {
            watch.order(first[k - 1], first[k]);
            watch.order(second[k - 1], second[k]);
        }
    });
    let (from1, from2) = (usize::from(rule.complement1), usize::from(rule.complement2));
    let mut starts = merge::<S, T, H>(&first, from1, &second, from2);
    let mut ends = merge::<S, T, H>(&first, 1 - from1, &second, 1 - from2);

    let padding = T::Lanes::<S>::splat(simd, T::INFINITY);
    if rule.start_of(0) == Some(1) {
        (starts[0], ends[H - 1]) = (padding, padding);
    }
    unrolled!(piece < rule.pieces(H) => {
        let exists = exists::<S, T, H>(simd, rule, &first, &second, piece);
        if let Some(start) = rule.start_of(piece) && start < H {
            starts[start] = exists.select(starts[start], padding);
        }
        if piece < H {
            ends[piece] = exists.select(ends[piece], padding);
        }
    });
    sort(&mut starts);
    sort(&mut ends);
    if rule.is_complement() { [ends, starts] } else { [starts, ends] }
}

/// Whether a piece exists: whether two pieces overlap of which it would come.
#[inline(always)]
fn exists<S: Simd, T: Real, const H: usize>(
    simd: S,
    rule: Rule,
    first: &[T::Lanes<S>; H],
    second: &[T::Lanes<S>; H],
    piece: usize,
) -> <T::Lanes<S> as SimdBase<S>>::Mask {
    let (complement1, complement2) = (rule.complement1, rule.complement2);
    let mut any = SimdMask::splat(simd, false);
    unrolled!(i < rule::pieces_of(complement1, H).min(piece + 1) => {
        let j = piece - i;
        if j < rule::pieces_of(complement2, H) {
            let mut both = SimdMask::splat(simd, true);
            if let (Some(begin), Some(end)) = (rule::begin(complement1, i), rule::end(complement2, j, H)) {
                both &= first[begin].simd_le(second[end]);
            }
            if let (Some(begin), Some(end)) = (rule::begin(complement2, j), rule::end(complement1, i, H)) {
                both &= second[begin].simd_lt(first[end]);
            }
            any |= both;
        }
    });
    any
}

/// Every other row of both operands, sorted.
#[inline(always)]
fn merge<S: Simd, T: Real, const H: usize>(
    first: &[T::Lanes<S>; H],
    from1: usize,
    second: &[T::Lanes<S>; H],
    from2: usize,
) -> [T::Lanes<S>; H] {
    let mut rows = *first;
    unrolled!(k < H / 2 => {
        rows[k] = first[2 * k + from1];
        rows[H / 2 + k] = second[2 * k + from2];
    });
    unrolled!(k < H / 2 => { exchange(&mut rows, k, k + H / 2); });
    if H == 4 {
        exchange(&mut rows, 1, 2);
    } else if H == 8 {
        unrolled!(k < 2 => { exchange(&mut rows, k + 2, k + 4); });
        unrolled!(k < 3 => { exchange(&mut rows, 2 * k + 1, 2 * k + 2); });
    }
    rows
}

/// Sorts the rows.
#[inline(always)]
fn sort<S: Simd, V: SimdFloat<S>, const H: usize>(rows: &mut [V; H]) {
    unrolled!(k < H / 2 => { exchange(rows, 2 * k, 2 * k + 1); });
    unrolled!(k < H / 4 => {
        exchange(rows, 4 * k, 4 * k + 2);
        exchange(rows, 4 * k + 1, 4 * k + 3);
        exchange(rows, 4 * k + 1, 4 * k + 2);
    });
    unrolled!(k < H / 8 * 4 => { exchange(rows, k, k + 4); });
    unrolled!(k < H / 8 * 2 => { exchange(rows, k + 2, k + 4); });
    unrolled!(k < H / 8 * 3 => { exchange(rows, 2 * k + 1, 2 * k + 2); });
}

#[inline(always)]
fn exchange<S: Simd, V: SimdFloat<S>, const H: usize>(rows: &mut [V; H], low: usize, high: usize) {
    (rows[low], rows[high]) = (rows[low].min(rows[high]), rows[low].max(rows[high]));
}
