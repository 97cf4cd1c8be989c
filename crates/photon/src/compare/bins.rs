//! Bins of comparisons, chosen from the two samples together: a choice that favours neither of them.

use super::sample::Alphabet;
use std::collections::BTreeMap;

/// The numbers of rows of a history that a comparison looks at.
const MAX_ROWS: usize = 64;

/// The mark between the tracks of a photon in a history.
pub(super) const NEXT_TRACK: u8 = u8::MAX;

/// The most bins of times and of wavelengths.
const MAX_INTERVALS: u64 = 50;

/// Bins must be expected to have at least `least` photons of each sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pooling {
    /// The number of photons of both samples that a bin needs.
    needed: f64,
}

impl Pooling {
    pub fn new(least: f64, [a, b]: [u64; 2]) -> Pooling {
        Pooling { needed: least * (a + b) as f64 / a.min(b).max(1) as f64 }
    }

    fn is_enough(self, [a, b]: [u64; 2]) -> bool {
        (a + b) as f64 >= self.needed
    }
}

fn sum([a, b]: [u64; 2], [c, d]: [u64; 2]) -> [u64; 2] {
    [a + c, b + d]
}

/// The bins of categories: those with enough photons, and one of all others. The most frequent first.
pub(super) fn categories(counts: BTreeMap<String, [u64; 2]>, pooling: Pooling) -> Vec<(String, [u64; 2])> {
    let (bins, rest): (Vec<_>, Vec<_>) =
        counts.into_iter().partition(|(_, counts)| pooling.is_enough(*counts));
    let others = rest.iter().fold([0, 0], |total, (_, counts)| sum(total, *counts));
    let label = if let [(own, _)] = &rest[..] { own.clone() } else { "others".to_owned() };
    finish(bins, (label, others), pooling)
}

/// Adds the bin of what is left over, or its photons to the smallest bin if they are too few.
fn finish(
    mut bins: Vec<(String, [u64; 2])>,
    (name, others): (String, [u64; 2]),
    pooling: Pooling,
) -> Vec<(String, [u64; 2])> {
    bins.sort_by_key(|(_, [a, b])| std::cmp::Reverse(a + b));
    match bins.last_mut() {
        _ if others == [0, 0] => {}
        Some((label, counts)) if !pooling.is_enough(others) => {
            *label += &format!(", {name}");
            *counts = sum(*counts, others);
        }
        _ => bins.push((name, others)),
    }
    bins
}

/// The bins of histories. A history with too few photons is pooled with those of the longest common beginning that have enough
/// together: `TO BT ...` has all histories of this beginning without a bin of their own.
pub(super) fn histories(
    counts: &BTreeMap<Vec<u8>, [u64; 2]>,
    alphabet: Alphabet,
    pooling: Pooling,
) -> Vec<(String, [u64; 2])> {
    // sorted, even with equal beginnings of long histories
    let list: Vec<(&[u8], [u64; 2])> =
        counts.iter().map(|(codes, counts)| (&codes[..codes.len().min(MAX_ROWS)], *counts)).collect();
    let mut bins = Vec::new();
    let others = pool(&list, 0, (alphabet, pooling), &mut bins);
    finish(bins, ("others".to_owned(), others), pooling)
}

/// Makes the bins of histories with a common beginning of `depth` rows, at most [`MAX_ROWS`], and returns what is left over.
/// The list is sorted.
fn pool(
    list: &[(&[u8], [u64; 2])],
    depth: usize,
    (alphabet, pooling): (Alphabet, Pooling),
    bins: &mut Vec<(String, [u64; 2])>,
) -> [u64; 2] {
    let label = |codes: &[u8], is_open: bool| text(codes, is_open, alphabet);
    let total =
        |list: &[(&[u8], [u64; 2])]| list.iter().fold([0, 0], |total, (_, counts)| sum(total, *counts));
    let mut rest = [0, 0];
    for group in list.chunk_by(|(a, _), (b, _)| a.get(depth) == b.get(depth)) {
        let all = total(group);
        let (codes, _) = group[0];
        let is_complete = codes.len() == depth;
        match pooling.is_enough(all) {
            false => rest = sum(rest, all),
            true if is_complete => bins.push((label(codes, depth == MAX_ROWS), all)),
            true => rest = sum(rest, pool(group, depth + 1, (alphabet, pooling), bins)),
        }
    }
    if depth > 0 && pooling.is_enough(rest) {
        bins.push((label(&list[0].0[..depth], true), rest));
        return [0, 0];
    }
    rest
}

/// The text of a history, or of the beginning of several.
pub(super) fn text(codes: &[u8], is_open: bool, alphabet: Alphabet) -> String {
    let name = |&code: &u8| if code == NEXT_TRACK { "|" } else { alphabet.name(code) };
    let names: Vec<&str> = codes.iter().map(name).chain(is_open.then_some("...")).collect();
    names.join(" ")
}

/// The bins of values: intervals with about equal numbers of photons of both samples together. Values that differ by at most
/// `tolerance` (relative) are in one bin: they differ by rounding.
pub(super) fn intervals(
    [a, b]: [&[f64]; 2],
    pooling: Pooling,
    tolerance: f64,
    unit: &str,
) -> Vec<(String, [u64; 2])> {
    let mut values: Vec<(f64, usize)> = [a, b]
        .into_iter()
        .zip(0..)
        .flat_map(|(values, side)| values.iter().map(move |&value| (value, side)))
        .collect();
    values.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let count = values.len() as f64;
    let size = (count / MAX_INTERVALS as f64).max(pooling.needed);
    let mut bins: Vec<(String, [u64; 2])> = Vec::new();
    let mut first = 0;
    let is_apart = |k: usize| values[k].0 - values[k - 1].0 > tolerance * values[k].0.abs();
    for end in 1..=values.len() {
        let is_full = (end - first) as f64 >= size && (values.len() - end) as f64 >= size;
        if end == values.len() || (is_full && is_apart(end)) {
            let side = |side| values[first..end].iter().filter(|(_, own)| *own == side).count() as u64;
            bins.push((label(values[first].0, values[end - 1].0, unit), [side(0), side(1)]));
            first = end;
        }
    }
    bins
}

fn label(low: f64, high: f64, unit: &str) -> String {
    match format!("{low:.6}") == format!("{high:.6}") {
        true => format!("{low:.6} {unit}"),
        false => format!("{low:.6} to {high:.6} {unit}"),
    }
}
