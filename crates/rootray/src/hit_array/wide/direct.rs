//! Combination of few rows: all intermediate values stay in registers.

use std::array::from_fn;
use std::ops::Range;

use fearless_simd::prelude::*;

use super::super::kernel::{self, TruthTable};
use super::super::part::Part;
use super::super::scalar::walk;
use super::super::{Float, Operation};
use super::block::{self, Plan};
use super::flags::Flags;
use super::rule::{self, Rule};

/// Maximum number of rows of an operand for this method.
pub(super) const ROWS: usize = 8;

/// Up to this number of rows all pairs of entries are compared, which also resolves equal times; the number of comparisons grows
/// quadratically.
pub(super) const EXACT: usize = 4;

/// Number of columns between two checks of the collected flags.
const CHUNK: usize = 512;

/// Rows of some columns; missing rows are padding.
struct Rows<'a, T, const H: usize> {
    first: [&'a [T]; H],
    second: [&'a [T]; H],
    /// The starts of pieces among these rows, those of the first operand before those of the second.
    starts: [&'a [T]; H],
    /// The ends of pieces, likewise.
    ends: [&'a [T]; H],
    /// Destination rows of sorted starts.
    to_starts: [Option<&'a mut [T]>; H],
    /// Destination rows of sorted ends.
    to_ends: [Option<&'a mut [T]>; H],
}

impl<'a, T: Float, const H: usize> Rows<'a, T, H> {
    fn new(rule: Rule, part: &'a mut Part<'_, T, T>, columns: Range<usize>, padding: &'a [T]) -> Self {
        let padding = &padding[..columns.len()];
        let row = |rows: &[&'a [T]], k: usize| rows.get(k).map_or(padding, |row| &row[columns.clone()]);
        let first: [&[T]; H] = from_fn(|k| row(&part.rows1, k));
        let second: [&[T]; H] = from_fn(|k| row(&part.rows2, k));
        let every_other = |from1: usize, from2: usize| {
            from_fn(|k| if k < H / 2 { first[2 * k + from1] } else { second[2 * k - H + from2] })
        };
        let (from1, from2) = (usize::from(rule.complement1), usize::from(rule.complement2));
        let (starts, ends) = (every_other(from1, from2), every_other(1 - from1, 1 - from2));
        let (mut to_starts, mut to_ends) = ([const { None }; H], [const { None }; H]);
        for (k, row) in part.out.iter_mut().enumerate() {
            let list = if (k % 2 == 1) == rule.is_complement() { &mut to_starts } else { &mut to_ends };
            list[k / 2] = Some(&mut row[columns.clone()]);
        }
        Rows { first, second, starts, ends, to_starts, to_ends }
    }
}

/// Combines operands of at most `H` rows (2, 4 or [`ROWS`]). Returns false, with an invalid result, if a column is not sorted or
/// holds NaN.
#[inline(always)]
pub(super) fn run<S: Simd, T: Float, const H: usize>(
    simd: S,
    plan: &Plan,
    part: &mut Part<'_, T, T>,
) -> bool {
    let (width, len) = (part.width(), T::Lanes::<S>::LEN);
    let (whole, padding) = (width - width % len, [T::INFINITY; CHUNK]);
    let long = if H > EXACT { CHUNK / 4 } else { CHUNK };
    for start in (0..whole).step_by(long) {
        let columns = start..whole.min(start + long);
        let flags = chunk::<S, T, H>(simd, plan.operation, part, columns.clone(), &padding);
        if !resolve_ties(simd, plan, part, columns, flags) {
            return false;
        }
    }
    if whole == width {
        return true;
    }
    let flags = rest::<S, T, H>(simd, plan.operation, part, whole..width, &padding);
    resolve_ties(simd, plan, part, whole..width, flags)
}

/// Combines columns with equal times again, by the exact rule.
fn resolve_ties<S: Simd, T: Float>(
    simd: S,
    plan: &Plan,
    part: &mut Part<'_, T, T>,
    columns: Range<usize>,
    flags: Flags<S, T>,
) -> bool {
    let seen = simd.vectorize(
        #[inline(always)]
        || [flags.is_sorted(), flags.has_zero(), flags.has_tie()],
    );
    match seen {
        [false, ..] => return false,
        [_, true, _] if part.has_negative_zero(&columns) => {
            let table = TruthTable::new(plan.operation);
            walk(part, columns, |a, b, out| kernel::keep(table, a, b, out));
        }
        [.., true] => return block::run(simd, plan, part, columns),
        _ => (),
    }
    true
}

/// Combines fewer columns than there are lanes; the other lanes are padding.
fn rest<S: Simd, T: Float, const H: usize>(
    simd: S,
    operation: Operation,
    part: &mut Part<'_, T, T>,
    columns: Range<usize>,
    padding: &[T],
) -> Flags<S, T> {
    let (len, rows) = (T::Lanes::<S>::LEN, part.out.len());
    let mut operands = vec![T::INFINITY; rows * len];
    for (wide, row) in operands.chunks_mut(len).zip(part.rows1.iter().chain(&part.rows2)) {
        wide[..columns.len()].copy_from_slice(&row[columns.clone()]);
    }
    let mut result = vec![T::INFINITY; rows * len];
    let (first, second) = operands.split_at(part.rows1.len() * len);
    let mut wide = Part {
        rows1: first.chunks(len).collect(),
        rows2: second.chunks(len).collect(),
        out: result.chunks_mut(len).collect(),
    };
    let flags = chunk::<S, T, H>(simd, operation, &mut wide, 0..len, padding);
    for (wide, row) in result.chunks(len).zip(&mut part.out) {
        row[columns.clone()].copy_from_slice(&wide[..columns.len()]);
    }
    flags
}

/// Combines columns whose number is a multiple of the number of lanes.
fn chunk<S: Simd, T: Float, const H: usize>(
    simd: S,
    operation: Operation,
    part: &mut Part<'_, T, T>,
    columns: Range<usize>,
    padding: &[T],
) -> Flags<S, T> {
    let width = columns.len();
    let mut rows = Rows::<T, H>::new(Rule::new(operation), part, columns, padding);
    simd.vectorize(
        #[inline(always)]
        || match operation {
            // for few rows, code specialised by operation is faster
            Operation::Union if H <= EXACT => steps(simd, Operation::Union, &mut rows, width),
            Operation::Intersect if H <= EXACT => steps(simd, Operation::Intersect, &mut rows, width),
            Operation::Difference if H <= EXACT => steps(simd, Operation::Difference, &mut rows, width),
            _ => steps(simd, operation, &mut rows, width),
        },
    )
}

#[inline(always)]
fn steps<S: Simd, T: Float, const H: usize>(
    simd: S,
    operation: Operation,
    rows: &mut Rows<'_, T, H>,
    width: usize,
) -> Flags<S, T> {
    let mut flags = Flags::new(simd);
    if H > EXACT {
        flags.rows(simd, rows.first.iter().copied());
        flags.rows(simd, rows.second.iter().copied());
    }
    for start in (0..width).step_by(T::Lanes::<S>::LEN) {
        step(simd, operation, rows, start..start + T::Lanes::<S>::LEN, &mut flags);
    }
    flags
}

/// Combines one column in each lane.
#[inline(always)]
fn step<S: Simd, T: Float, const H: usize>(
    simd: S,
    operation: Operation,
    rows: &mut Rows<'_, T, H>,
    columns: Range<usize>,
    flags: &mut Flags<S, T>,
) {
    let first = load_all::<S, T, H>(simd, &rows.first, columns.clone());
    let second = load_all::<S, T, H>(simd, &rows.second, columns.clone());
    let (mut starts, mut ends) = (first, second);
    if H > EXACT {
        starts = load_all::<S, T, H>(simd, &rows.starts, columns.clone());
        ends = load_all::<S, T, H>(simd, &rows.ends, columns.clone());
    } else {
        let rule = Rule::new(operation);
        let (from1, from2) = (usize::from(rule.complement1), usize::from(rule.complement2));
        unrolled!(k < H / 2 => {
            (starts[k], starts[H / 2 + k]) = (first[2 * k + from1], second[2 * k + from2]);
            (ends[k], ends[H / 2 + k]) = (first[2 * k + 1 - from1], second[2 * k + 1 - from2]);
        });
    }
    if H <= EXACT {
        unrolled!(k < H => {
            flags.sign(first[k]);
            flags.sign(second[k]);
            if k > 0 {
                flags.order(first[k - 1], first[k]);
                flags.order(second[k - 1], second[k]);
            }
        });
    }
    merge(&mut starts);
    merge(&mut ends);
    let [starts, ends] = match operation {
        Operation::Union => keep(simd, Rule::new(Operation::Union), first, second, starts, ends, flags),
        Operation::Intersect => {
            keep(simd, Rule::new(Operation::Intersect), first, second, starts, ends, flags)
        }
        Operation::Difference => {
            keep(simd, Rule::new(Operation::Difference), first, second, starts, ends, flags)
        }
    };
    store_all::<S, T, H>(sort(starts), &mut rows.to_starts, columns.clone());
    store_all::<S, T, H>(sort(ends), &mut rows.to_ends, columns);
}

#[inline(always)]
fn load_all<S: Simd, T: Float, const H: usize>(
    simd: S,
    rows: &[&[T]; H],
    columns: Range<usize>,
) -> [T::Lanes<S>; H] {
    let mut lanes = [T::Lanes::<S>::splat(simd, T::INFINITY); H];
    unrolled!(k < H => { lanes[k] = T::Lanes::<S>::from_slice(simd, &rows[k][columns.clone()]); });
    lanes
}

#[inline(always)]
fn store_all<S: Simd, T: Float, const H: usize>(
    lanes: [T::Lanes<S>; H],
    rows: &mut [Option<&mut [T]>; H],
    columns: Range<usize>,
) {
    unrolled!(k < H => {
        if let Some(row) = &mut rows[k] {
            lanes[k].store_slice(&mut row[columns.clone()]);
        }
    });
}

/// Sorted starts and ends, with +inf for those of pieces that do not exist. The rule is a constant for the
/// compiler.
#[inline(always)]
fn keep<S: Simd, V: SimdFloat<S, Element: Float<Lanes<S> = V>>, const H: usize>(
    simd: S,
    rule: Rule,
    first: [V; H],
    second: [V; H],
    mut starts: [V; H],
    mut ends: [V; H],
    flags: &mut Flags<S, V::Element>,
) -> [[V; H]; 2] {
    let padding = V::splat(simd, V::Element::INFINITY);
    if rule.start_of(0) == Some(1) {
        (starts[0], ends[H - 1]) = (padding, padding);
    }
    unrolled!(piece < rule.pieces(H) => {
        let exists = match rule.start_of(piece) {
            Some(start) if H > EXACT && start < H && piece < H => flags.is_before(starts[start], ends[piece]),
            _ if H > EXACT => SimdMask::splat(simd, true),
            _ => exists::<S, V::Element, H>(simd, rule, &first, &second, piece),
        };
        if let Some(start) = rule.start_of(piece) && start < H {
            starts[start] = exists.select(starts[start], padding);
        }
        if piece < H {
            ends[piece] = exists.select(ends[piece], padding);
        }
    });
    [starts, ends]
}

/// Whether a piece exists: true if two pieces that would form it overlap.
#[inline(always)]
fn exists<S: Simd, T: Float, const H: usize>(
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

/// Sorts rows whose halves are sorted: the network of [`Network::merge`](super::network::Network::merge).
#[inline(always)]
fn merge<S: Simd, V: SimdFloat<S>, const H: usize>(rows: &mut [V; H]) {
    unrolled!(k < H / 2 => { exchange(rows, k, k + H / 2); });
    if H == 4 {
        exchange(rows, 1, 2);
    } else if H == 8 {
        unrolled!(k < 2 => { exchange(rows, k + 2, k + 4); });
        unrolled!(k < 3 => { exchange(rows, 2 * k + 1, 2 * k + 2); });
    }
}

/// Sorts the rows: the network of [`Network::sort`](super::network::Network::sort).
#[inline(always)]
pub(super) fn sort<S: Simd, V: SimdFloat<S>, const H: usize>(mut rows: [V; H]) -> [V; H] {
    unrolled!(k < H / 2 => { exchange(&mut rows, 2 * k, 2 * k + 1); });
    unrolled!(k < H / 4 => {
        exchange(&mut rows, 4 * k, 4 * k + 2);
        exchange(&mut rows, 4 * k + 1, 4 * k + 3);
        exchange(&mut rows, 4 * k + 1, 4 * k + 2);
    });
    unrolled!(k < H / 8 * 4 => { exchange(&mut rows, k, k + 4); });
    unrolled!(k < H / 8 * 2 => { exchange(&mut rows, k + 2, k + 4); });
    unrolled!(k < H / 8 * 3 => { exchange(&mut rows, 2 * k + 1, 2 * k + 2); });
    rows
}

#[inline(always)]
fn exchange<S: Simd, V: SimdFloat<S>, const H: usize>(rows: &mut [V; H], low: usize, high: usize) {
    (rows[low], rows[high]) = (rows[low].min(rows[high]), rows[low].max(rows[high]));
}
