//! Budgets of files that describe more than they contain: compressed parts, and meshes that are used many times.

use crate::{FileError, Location};
use std::cell::Cell;
use std::io::{self, BufRead, Read};

/// The number of bytes that the parts of an archive of this length may expand to: 32 times its length, at least 16 MiB and at
/// most 4 GiB. Deflate reaches a factor of 1000 on repeated text; models from slicers reach 5 to 20.
pub fn expanded_bytes(length: u64) -> u64 {
    length.saturating_mul(32).clamp(16 << 20, 1 << 32)
}

/// Rejects a number of vertices or triangles that a file of this length can describe only by repetition: more than 300,000
/// and more than 2 for each byte.
pub fn check_repetition(what: &str, count: u64, length: u64, location: Location) -> Result<(), FileError> {
    let limit = length.saturating_mul(2).max(300_000);
    if count <= limit {
        return Ok(());
    }
    let problem = format!("the file uses its meshes so often that they make {count} {what}");
    Err(FileError::syntax(location, problem, format!("a file of {length} bytes may make {limit}")))
}

/// The maximum number of bytes of one XML element or text, which the parser keeps in memory.
const MAX_PER_EVENT: u64 = 1 << 20;

/// A reader that fails when the budget of the whole archive is used up, or that of one XML event.
pub struct Metered<'b, R> {
    from: R,
    /// The bytes that the archive may still expand to, and their limit.
    left: &'b Cell<u64>,
    limit: u64,
    /// The bytes of the current event.
    event: &'b Cell<u64>,
}

impl<'b, R: BufRead> Metered<'b, R> {
    pub fn new(from: R, left: &'b Cell<u64>, limit: u64, event: &'b Cell<u64>) -> Metered<'b, R> {
        Metered { from, left, limit, event }
    }
}

impl<R: BufRead> Read for Metered<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl<R: BufRead> BufRead for Metered<'_, R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.left.get() == 0 {
            let limit = self.limit;
            return Err(io::Error::other(format!("the archive expands to more than {limit} bytes")));
        }
        if self.event.get() > MAX_PER_EVENT {
            return Err(io::Error::other(format!("an element has more than {MAX_PER_EVENT} bytes")));
        }
        self.from.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.left.set(self.left.get().saturating_sub(count as u64));
        self.event.set(self.event.get() + count as u64);
        self.from.consume(count);
    }
}
