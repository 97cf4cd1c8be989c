//! Interface of ray readers for single formats.

use super::RayChunk;
use super::problems::ProblemList;
use std::io;

/// Progress of a reader, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Number of bytes read so far.
    pub done: u64,
    /// Total number of bytes; `None` for standard input and pipes.
    pub total: Option<u64>,
}

/// Reader of one ray file format.
pub(super) trait RaySource: Send {
    /// Appends at most `max_rays` rows to the chunk, starting with row `first`. Returns the number of consumed rows, 0 at the end.
    /// Invalid rows are consumed and reported, but not appended.
    fn fill(
        &mut self,
        chunk: &mut RayChunk,
        first: u64,
        max_rays: usize,
        problems: &mut ProblemList,
    ) -> io::Result<u64>;

    /// Skips at most this many rows at the start without reading them, if the source can; returns the number of skipped rows.
    fn skip(&mut self, _rows: u64) -> io::Result<u64> {
        Ok(0)
    }

    fn progress(&self) -> Progress;

    fn rays(&self) -> Option<u64>;
}
