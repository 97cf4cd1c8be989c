//! Selection rule of the sorting-network method: which pieces a boolean operation keeps.
//!
//! Every operation is an intersection of the operands or of their complements: A - B = A & !B, and A | B is
//! the complement of !A & !B. A ray is inside an operand on its *pieces*: each goes from one entry to the
//! next; the first and the last piece of a complement are unbounded. Sort the starts of all pieces of both
//! operands, and the ends. If piece i of the first operand and piece j of the second overlap, they make piece
//! i + j of the intersection, counting pieces of no length and those that do not exist: it goes from
//! start i + j + 1 to end i + j, because i + j + 2 pieces have started there and i + j have ended. One comparison
//! therefore decides which of the sorted starts and ends are kept: piece k exists if start k + 1 comes before
//! end k.
//!
//! Equal times come in the order of the merged entries, those of the first operand first; within an operand
//! in the order of the rows. The sorted starts and ends do not decide these cases; then piece k exists if any
//! two pieces i and k - i overlap.

use super::super::Operation;

/// Whether the operands of the intersection are complemented.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rule {
    pub complement1: bool,
    pub complement2: bool,
}

impl Rule {
    #[inline(always)]
    pub const fn new(operation: Operation) -> Self {
        match operation {
            Operation::Union => Rule { complement1: true, complement2: true },
            Operation::Intersect => Rule { complement1: false, complement2: false },
            Operation::Difference => Rule { complement1: false, complement2: true },
        }
    }

    /// Whether the result is the complement of the intersection: it has the same entries, with starts and
    /// ends exchanged.
    #[inline(always)]
    pub const fn is_complement(self) -> bool {
        self.complement1 && self.complement2
    }

    /// The number of starts at -inf, and of ends at +inf, that are not entries.
    #[inline(always)]
    const fn without_end(self) -> usize {
        self.complement1 as usize + self.complement2 as usize
    }

    /// The number of possible pieces for `starts` starts among the entries.
    #[inline(always)]
    pub const fn pieces(self, starts: usize) -> usize {
        (starts + self.without_end()).saturating_sub(1)
    }

    /// The piece that would begin at start number `start` of the sorted entries.
    #[inline(always)]
    pub const fn piece_from(self, start: usize) -> Option<usize> {
        (start + self.without_end()).checked_sub(1)
    }

    /// The number among the sorted entries of the start of a piece; `None` if it is at -inf.
    #[inline(always)]
    pub const fn start_of(self, piece: usize) -> Option<usize> {
        (piece + 1).checked_sub(self.without_end())
    }
}

/// The row at which a piece of an operand begins; `None` if it is unbounded.
#[inline(always)]
pub(super) const fn begin(complement: bool, piece: usize) -> Option<usize> {
    (2 * piece).checked_sub(complement as usize)
}

/// The row at which a piece of an operand with `rows` rows ends; `None` if it is unbounded.
#[inline(always)]
pub(super) const fn end(complement: bool, piece: usize, rows: usize) -> Option<usize> {
    let row = 2 * piece + 1 - complement as usize;
    if row < rows { Some(row) } else { None }
}

/// The number of pieces of an operand with `rows` rows.
#[inline(always)]
pub(super) const fn pieces_of(complement: bool, rows: usize) -> usize {
    rows / 2 + complement as usize
}
