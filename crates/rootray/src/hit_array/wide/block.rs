//! Combination of any number of rows: sorting networks order the rows of a block of columns that fits in the
//! cache.

use std::ops::Range;

use fearless_simd::prelude::*;

use super::super::kernel::{self, TruthTable};
use super::super::part::Part;
use super::super::scalar::walk;
use super::super::{Float, Operation};
use super::flags::Flags;
use super::network::{Exchange, Network};
use super::rule::{self, Rule};
use super::{direct, load, store};

/// Registers per row of a block.
const WIDTH: usize = 4;

/// Rows that are sorted in registers.
const GROUP: usize = 8;

/// Bytes of a tile, which consists of adjacent blocks whose rows are read and written together. Fits in the
/// L2 cache.
const TILE: usize = 1 << 17;

/// Maximum number of columns of a tile: a page of f64.
const LONGEST: usize = 512;

/// State shared by all blocks of a call.
pub struct Plan {
    pub(super) operation: Operation,
    /// Rows of the operand with more rows.
    pub(super) rows: usize,
    merge: Network,
    sort: Network,
}

impl Plan {
    pub fn new(operation: Operation, rows1: usize, rows2: usize) -> Self {
        let (count, rows) = ((rows1 + rows2) / 2, rows1.max(rows2));
        if rows <= direct::EXACT {
            return Plan { operation, rows, merge: Network::default(), sort: Network::default() };
        }
        Plan {
            operation,
            rows,
            merge: Network::merge(rows1 / 2, rows2 / 2),
            sort: Network::sort(count.next_multiple_of(GROUP), GROUP),
        }
    }
}

type Row<S, T> = [<T as super::super::float::Wide>::Lanes<S>; WIDTH];
type Mask<S, T> = <<T as super::super::float::Wide>::Lanes<S> as SimdBase<S>>::Mask;

/// A block of columns.
struct Block<S: Simd, T: Float> {
    /// Starts of pieces: those of the first operand, then those of the second; after the merge all of them,
    /// in the order of the network. Padded with rows of +inf to a multiple of [`GROUP`].
    starts: Vec<Row<S, T>>,
    /// Ends of pieces, likewise.
    ends: Vec<Row<S, T>>,
    /// Flags of the pieces that exist.
    exist: Vec<[Mask<S, T>; WIDTH]>,
}

/// Combines the columns. Returns false, with an invalid result, if a column is not sorted or holds NaN.
pub(super) fn run<S: Simd, T: Float>(
    simd: S,
    plan: &Plan,
    part: &mut Part<'_, T, T>,
    columns: Range<usize>,
) -> bool {
    simd.vectorize(
        #[inline(always)]
        || blocks(simd, plan, part, columns),
    )
}

#[inline(always)]
fn blocks<S: Simd, T: Float>(simd: S, plan: &Plan, part: &mut Part<'_, T, T>, columns: Range<usize>) -> bool {
    let end = columns.end;
    let count = part.out.len() / 2;
    let rule = Rule::new(plan.operation);
    let padding = [T::Lanes::<S>::splat(simd, T::INFINITY); WIDTH];
    let mut block = Block::<S, T> {
        starts: vec![padding; count.next_multiple_of(GROUP)],
        ends: vec![padding; count.next_multiple_of(GROUP)],
        exist: vec![[SimdMask::splat(simd, true); WIDTH]; rule.pieces(count)],
    };
    let wide = WIDTH * T::Lanes::<S>::LEN;
    let long = (TILE / (size_of::<T>() * 2 * count)).clamp(wide, LONGEST) / wide * wide;
    let mut tile = vec![T::INFINITY; 2 * count * long];
    for start in columns.step_by(long) {
        let columns = start..end.min(start + long);
        let mut flags = Flags::<S, T>::new(simd);
        flags.rows(simd, part.rows1.iter().map(|row| &row[columns.clone()]));
        flags.rows(simd, part.rows2.iter().map(|row| &row[columns.clone()]));
        if !flags.is_sorted() {
            return false;
        }
        if flags.has_zero() && part.has_negative_zero(&columns) {
            let table = TruthTable::new(plan.operation);
            walk(part, columns, |a, b, out| kernel::keep(table, a, b, out));
            continue;
        }
        for first in columns.clone().step_by(wide) {
            let columns = first..columns.end.min(first + wide);
            block.load(simd, rule, part, &columns);
            exchange_all(&plan.merge.exchanges, &mut block.starts);
            exchange_all(&plan.merge.exchanges, &mut block.ends);
            if block.compare(simd, rule, &plan.merge.order) {
                block.compare_operands(simd, rule, part, &columns);
            }
            block.drop_rest(simd, rule, &plan.merge.order);
            sort_all::<S, T>(&plan.sort.exchanges, &mut block.starts);
            sort_all::<S, T>(&plan.sort.exchanges, &mut block.ends);
            block.store(rule, &plan.sort.order, &mut tile, long, first - start..columns.end - start);
        }
        for (row, out) in tile.chunks(long).zip(&mut part.out) {
            out[columns.clone()].copy_from_slice(&row[..columns.len()]);
        }
    }
    true
}

impl<S: Simd, T: Float> Block<S, T> {
    /// Reads starts and ends of both operands.
    #[inline(always)]
    fn load(&mut self, simd: S, rule: Rule, part: &Part<'_, T, T>, columns: &Range<usize>) {
        let pieces1 = part.rows1.len() / 2;
        for (rows, from, complement) in
            [(&part.rows1, 0, rule.complement1), (&part.rows2, pieces1, rule.complement2)]
        {
            for (row, numbers) in rows.iter().enumerate() {
                let list = if (row % 2 == 1) == complement { &mut self.starts } else { &mut self.ends };
                load_row::<S, T>(simd, &numbers[columns.clone()], &mut list[from + row / 2]);
            }
        }
    }

    /// Determines from sorted starts and ends which pieces exist. Returns true if equal times leave it undecided.
    #[inline(always)]
    fn compare(&mut self, simd: S, rule: Rule, order: &[usize]) -> bool {
        let mut flags = Flags::<S, T>::new(simd);
        for (piece, exist) in self.exist.iter_mut().enumerate() {
            let (Some(start), true) = (rule.start_of(piece), piece < order.len()) else { continue };
            if start >= order.len() {
                continue;
            }
            let (starts, ends) = (&self.starts[order[start]], &self.ends[order[piece]]);
            unrolled!(k < WIDTH => {
                exist[k] = flags.is_before(starts[k], ends[k]);
            });
        }
        flags.has_tie()
    }

    /// Determines from the operands which pieces exist, including equal times.
    #[inline(always)]
    fn compare_operands(&mut self, simd: S, rule: Rule, part: &Part<'_, T, T>, columns: &Range<usize>) {
        let padding = [T::Lanes::<S>::splat(simd, T::INFINITY); WIDTH];
        let (mut first, mut second) = (vec![padding; part.rows1.len()], vec![padding; part.rows2.len()]);
        for (list, rows) in [(&mut first, &part.rows1), (&mut second, &part.rows2)] {
            for (row, numbers) in list.iter_mut().zip(rows) {
                load_row::<S, T>(simd, &numbers[columns.clone()], row);
            }
        }
        let (complement1, complement2) = (rule.complement1, rule.complement2);
        self.exist.fill([SimdMask::splat(simd, false); WIDTH]);
        for i in 0..rule::pieces_of(complement1, first.len()) {
            let begin1 = rule::begin(complement1, i);
            let end1 = rule::end(complement1, i, first.len());
            for j in 0..rule::pieces_of(complement2, second.len()) {
                let begin2 = rule::begin(complement2, j);
                let end2 = rule::end(complement2, j, second.len());
                let mut both = [SimdMask::splat(simd, true); WIDTH];
                if let (Some(begin), Some(end)) = (begin1, end2) {
                    let (begins, ends) = (&first[begin], &second[end]);
                    unrolled!(k < WIDTH => { both[k] &= begins[k].simd_le(ends[k]); });
                }
                if let (Some(begin), Some(end)) = (begin2, end1) {
                    let (begins, ends) = (&second[begin], &first[end]);
                    unrolled!(k < WIDTH => { both[k] &= begins[k].simd_lt(ends[k]); });
                }
                let exist = &mut self.exist[i + j];
                unrolled!(k < WIDTH => { exist[k] |= both[k]; });
            }
        }
    }

    /// Sets the starts and ends of pieces that do not exist to +inf.
    #[inline(always)]
    fn drop_rest(&mut self, simd: S, rule: Rule, order: &[usize]) {
        let padding = T::Lanes::<S>::splat(simd, T::INFINITY);
        for (k, &row) in order.iter().enumerate() {
            let from = rule.piece_from(k).and_then(|piece| self.exist.get(piece));
            keep(padding, from, &mut self.starts[row]);
            keep(padding, self.exist.get(k), &mut self.ends[row]);
        }
    }

    /// Writes sorted starts and ends to columns of a tile.
    #[inline(always)]
    fn store(&self, rule: Rule, order: &[usize], tile: &mut [T], long: usize, columns: Range<usize>) {
        for (&row, out) in order.iter().zip(tile.chunks_exact_mut(2 * long)) {
            let (entry, next) = out.split_at_mut(long);
            let (starts, ends) = if rule.is_complement() { (next, entry) } else { (entry, next) };
            store_row::<S, T>(&self.starts[row], &mut starts[columns.clone()]);
            store_row::<S, T>(&self.ends[row], &mut ends[columns.clone()]);
        }
    }
}

/// Reads the existing columns and pads the others with +inf.
#[inline(always)]
fn load_row<S: Simd, T: Float>(simd: S, numbers: &[T], row: &mut Row<S, T>) {
    let len = T::Lanes::<S>::LEN;
    if numbers.len() == WIDTH * len {
        unrolled!(k < WIDTH => { row[k] = T::Lanes::<S>::from_slice(simd, &numbers[k * len..(k + 1) * len]); });
    } else {
        *row = [T::Lanes::<S>::splat(simd, T::INFINITY); WIDTH];
        for (t, numbers) in row.iter_mut().zip(numbers.chunks(len)) {
            *t = load(simd, numbers);
        }
    }
}

/// Writes the existing columns.
#[inline(always)]
fn store_row<S: Simd, T: Float>(row: &Row<S, T>, numbers: &mut [T]) {
    let len = T::Lanes::<S>::LEN;
    if numbers.len() == WIDTH * len {
        unrolled!(k < WIDTH => { row[k].store_slice(&mut numbers[k * len..(k + 1) * len]); });
    } else {
        for (t, numbers) in row.iter().zip(numbers.chunks_mut(len)) {
            store::<S, T>(*t, numbers);
        }
    }
}

/// Sets masked lanes to +inf.
#[inline(always)]
fn keep<S: Simd, V: SimdBase<S>>(padding: V, exist: Option<&[V::Mask; WIDTH]>, row: &mut [V; WIDTH]) {
    match exist {
        Some(exist) => {
            unrolled!(k < WIDTH => { row[k] = exist[k].select(row[k], padding); });
        }
        None => *row = [padding; WIDTH],
    }
}

#[inline(always)]
fn exchange_all<S: Simd, V: SimdFloat<S>>(network: &[Exchange], rows: &mut [[V; WIDTH]]) {
    for &(low, high) in network {
        if let Ok([low, high]) = rows.get_disjoint_mut([low, high]) {
            unrolled!(k < WIDTH => { (low[k], high[k]) = (low[k].min(high[k]), low[k].max(high[k])); });
        }
    }
}

/// Sorts groups of rows in registers, then merges them.
#[inline(always)]
fn sort_all<S: Simd, T: Float>(network: &[Exchange], rows: &mut [Row<S, T>]) {
    for group in rows.chunks_exact_mut(GROUP) {
        unrolled!(k < WIDTH => {
            let mut registers = [group[0][k]; GROUP];
            unrolled!(row < GROUP => { registers[row] = group[row][k]; });
            let sorted = direct::sort(registers);
            unrolled!(row < GROUP => { group[row][k] = sorted[row]; });
        });
    }
    exchange_all(network, rows);
}
