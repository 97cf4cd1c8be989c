//! Ranges of columns of two operands and of their result, and the division of a call into such parts for threads.

use std::num::NonZeroUsize;
use std::ops::Range;

use super::{Float, HitArray};

/// The same columns of both operands and of the result, row by row; all rows are equally long.
pub struct Part<'a, T, O> {
    /// Rows of `array1`.
    pub rows1: Vec<&'a [T]>,
    /// Rows of `array2`.
    pub rows2: Vec<&'a [T]>,
    /// Rows of the result, as many as both together.
    pub out: Vec<&'a mut [O]>,
}

/// Least length of the result per thread: about a tenth of a millisecond of work.
const NUMBERS_PER_THREAD: usize = 1 << 17;

/// Maximum number of threads for a result of this length; [`array_csg_into`](super::array_csg_into) uses no more.
pub fn most_threads(numbers: usize) -> NonZeroUsize {
    NonZeroUsize::new(numbers / NUMBERS_PER_THREAD).unwrap_or(NonZeroUsize::MIN)
}

/// Columns of a part are a multiple of this, except for the last part: no cache line of the result belongs to
/// two threads.
const COLUMNS_PER_CUT: usize = 64;

impl<'a, T: Float, O> Part<'a, T, O> {
    /// All columns. `out` holds as many numbers as both arrays.
    pub fn whole(array1: HitArray<'a, T>, array2: HitArray<'a, T>, out: &'a mut [O]) -> Self {
        let columns = array1.columns().max(1);
        Part { rows1: rows(array1), rows2: rows(array2), out: out.chunks_exact_mut(columns).collect() }
    }

    /// Number of columns, 0 if there is no row.
    pub fn width(&self) -> usize {
        self.out.first().map_or(0, |row| row.len())
    }

    /// Divides the columns into at most `threads` parts of nearly equal width; fewer if there is little work.
    pub fn split(mut self, threads: NonZeroUsize) -> Vec<Self> {
        let width = self.width();
        let count = threads.min(most_threads(width * self.out.len())).get();
        let step = width.div_ceil(count).next_multiple_of(COLUMNS_PER_CUT);
        let mut parts = Vec::with_capacity(count);
        while self.width() > step {
            let rest = self.split_off(step);
            parts.push(std::mem::replace(&mut self, rest));
        }
        parts.push(self);
        parts
    }

    /// Keeps the first `width` columns, which must exist, and returns the others.
    fn split_off(&mut self, width: usize) -> Self {
        let cut = |rows: &mut Vec<&'a [T]>| {
            let rest = rows.iter().map(|row| &row[width..]).collect();
            rows.iter_mut().for_each(|row| *row = &row[..width]);
            rest
        };
        let (rows1, rows2) = (cut(&mut self.rows1), cut(&mut self.rows2));
        let halves = self.out.drain(..).map(|row| row.split_at_mut(width));
        let (kept, out) = halves.unzip();
        self.out = kept;
        Part { rows1, rows2, out }
    }

    /// Whether a number in these columns is a zero with a negative sign.
    pub fn has_negative_zero(&self, columns: &Range<usize>) -> bool {
        let rows = self.rows1.iter().chain(&self.rows2);
        rows.flat_map(|row| &row[columns.clone()]).any(|t| t.to_f64().to_bits() == (-0.0_f64).to_bits())
    }
}

fn rows<T: Float>(array: HitArray<'_, T>) -> Vec<&[T]> {
    (0..array.rows()).map(|row| array.row(row)).collect()
}

/// Runs `work` on every part, each on its own thread, the first on the calling one. Returns whether all
/// results are true.
pub(super) fn all_parts<P: Send>(parts: Vec<P>, work: impl Fn(P) -> bool + Sync) -> bool {
    let mut parts = parts.into_iter();
    let Some(first) = parts.next() else { return true };
    std::thread::scope(|scope| {
        let others: Vec<_> = parts.map(|part| scope.spawn(|| work(part))).collect();
        let done = work(first);
        others.into_iter().fold(done, |done, other| match other.join() {
            Ok(more) => done & more,
            Err(panic) => std::panic::resume_unwind(panic),
        })
    })
}
