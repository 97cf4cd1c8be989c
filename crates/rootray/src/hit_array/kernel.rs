//! Scalar kernel for one ray: merges its two sorted columns and keeps the entries that change the state.

use super::{Float, Operation};

/// The state of a ray between two entries: bit 0, inside the first solid; bit 1, inside the second.
type State = u8;

/// Whether a state is inside the result, for each of the four states.
#[derive(Clone, Copy)]
pub(super) struct TruthTable(u8);

impl TruthTable {
    pub(super) const fn new(operation: Operation) -> Self {
        Self(match operation {
            Operation::Union => 0b1110,
            Operation::Intersect => 0b1000,
            Operation::Difference => 0b0010,
        })
    }

    fn differs(self, before: State, after: State) -> bool {
        ((self.0 >> before) ^ (self.0 >> after)) & 1 == 1
    }
}

/// The entries of two sorted columns in stable order, each with the bit that it toggles: 1 for the first, 2 for the second.
pub(super) struct Merge<'a, T> {
    first: &'a [T],
    second: &'a [T],
}

impl<'a, T> Merge<'a, T> {
    pub(super) const fn new(first: &'a [T], second: &'a [T]) -> Self {
        Self { first, second }
    }
}

impl<T: Float> Iterator for Merge<'_, T> {
    type Item = (T, State);

    fn next(&mut self) -> Option<Self::Item> {
        match (self.first.split_first(), self.second.split_first()) {
            (Some((&t, rest)), other) if other.is_none_or(|(&u, _)| t <= u) => {
                self.first = rest;
                Some((t, 1))
            }
            (_, Some((&t, rest))) => {
                self.second = rest;
                Some((t, 2))
            }
            _ => None,
        }
    }
}

/// Writes the kept entries in order, then +inf. `out` is as long as both columns together.
pub(super) fn keep<T: Float>(table: TruthTable, first: &[T], second: &[T], out: &mut [T]) {
    let (mut kept, mut state) = (0, 0);
    for (t, bit) in Merge::new(first, second) {
        // written always and overwritten if not kept: random input gives a branch no pattern to predict
        out[kept] = t;
        kept += usize::from(table.differs(state, state ^ bit));
        state ^= bit;
    }
    out[kept..].fill(T::INFINITY);
}

/// Writes every entry of the merged columns in its place, and +inf for those that are not kept.
pub(super) fn mask<T: Float>(table: TruthTable, first: &[T], second: &[T], out: &mut [T]) {
    let mut state = 0;
    for ((t, bit), out) in Merge::new(first, second).zip(out) {
        *out = if table.differs(state, state ^ bit) { t } else { T::INFINITY };
        state ^= bit;
    }
}

/// Writes the crossings of the exact algebra, then +inf: entries with equal times toggle together. A result
/// that is inside at -inf begins with -inf.
pub(super) fn regularize<T: Float>(table: TruthTable, first: &[T], second: &[T], out: &mut [T]) {
    let (mut kept, mut before, mut state) = (0, 0, 0);
    let mut entries = Merge::new(first, second).take_while(|entry| entry.0 < T::INFINITY).peekable();
    while let Some((t, bit)) = entries.next() {
        state ^= bit;
        if entries.peek().is_some_and(|next| next.0 == t) {
            continue;
        }
        if table.differs(before, state) {
            // no negative zero: the bits must not depend on the operand that the time comes from
            out[kept] = t + T::ZERO;
            kept += 1;
        }
        before = state;
    }
    out[kept..].fill(T::INFINITY);
}

/// Drops the pieces shorter than `min_sep` from a regularized column, by the rule of [`crate::weld_runs`].
pub(super) fn weld<T: Float>(min_sep: T, column: &mut [T]) {
    let used = column.partition_point(|&t| t < T::INFINITY);
    let (mut kept, mut start) = (0, 0);
    while start < used {
        let end =
            start + crate::weld::run_length(&column[start..used], &mut |&a: &T, &b: &T| b - a < min_sep);
        if (end - start) % 2 == 1 {
            column[kept] = column[end - 1];
            kept += 1;
        }
        start = end;
    }
    column[kept..].fill(T::INFINITY);
}
