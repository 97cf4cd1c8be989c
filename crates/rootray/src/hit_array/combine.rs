//! Boolean functions of any number of hit arrays (surface count).

use super::merged::MergedHit;
use super::{HitArrayBuf, MergedHits};
use crate::CountRule;

/// The hits of a boolean function of many solids, exact: entries with equal times toggle together.
///
/// An operand is an array (empty if its number of columns differs) and a flag, `true` for its complement. The method is the
/// surface count of Frazier's code for any number of operands: +1 where a ray enters an operand, -1 where it leaves; a
/// complement starts at 1 and counts in reverse. A time is kept if the function of the count changes over all entries at that
/// time.
///
/// O(H N) for H rows of N columns in all operands, and O(n log n) for the n entries of each column. Allocates only while
/// `merged` and `out` grow.
pub fn combine<'a>(
    rule: CountRule,
    columns: usize,
    operands: impl Iterator<Item = (&'a HitArrayBuf, bool)> + Clone,
    merged: &mut MergedHits,
    out: &mut HitArrayBuf,
) {
    let complements = operands.clone().filter(|operand| operand.1).count();
    merged.merge(columns, operands.map(|(array, complemented)| (array, u32::from(complemented))));
    out.reset(columns);
    for column in 0..columns {
        keep(rule, complements, merged.column(column), |row, t| out.put(row, column, t));
    }
}

/// Writes the entries of one column that are kept, each with its row.
fn keep(rule: CountRule, complements: usize, entries: &[MergedHit], mut put: impl FnMut(usize, f64)) {
    let unbounded = entries.partition_point(|entry| entry.t == f64::NEG_INFINITY);
    let (starts, crossings) = entries.split_at(unbounded);
    let mut count = starts.iter().fold(complements, counted);
    let mut inside = rule.is_inside(count);
    let mut rows = 0..;
    let mut write = |t: f64| rows.next().into_iter().for_each(|row| put(row, t));
    if inside {
        write(f64::NEG_INFINITY);
    }
    for tied in crossings.chunk_by(|a, b| a.t == b.t) {
        count = tied.iter().fold(count, counted);
        if rule.is_inside(count) != inside {
            inside = !inside;
            // no negative zero: the bits must not depend on the operand that the time comes from
            write(tied[0].t + 0.0);
        }
    }
}

/// The count after an entry. It wraps, because between entries with equal times it may be any number.
fn counted(count: usize, entry: &MergedHit) -> usize {
    let complemented = entry.tag == 1;
    if entry.enters != complemented { count.wrapping_add(1) } else { count.wrapping_sub(1) }
}
