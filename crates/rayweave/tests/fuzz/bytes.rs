//! Choices from bytes: whatever a fuzzer invents means something.

/// Reads choices off a list of bytes; when it has ended, every choice is the first one.
pub struct Bytes<'a> {
    left: &'a [u8],
}

impl<'a> Bytes<'a> {
    pub fn new(data: &'a [u8]) -> Bytes<'a> {
        Bytes { left: data }
    }

    /// What has not been read.
    pub fn rest(&self) -> &'a [u8] {
        self.left
    }

    pub fn byte(&mut self) -> u8 {
        match self.left.split_first() {
            Some((&first, rest)) => {
                self.left = rest;
                first
            }
            None => 0,
        }
    }

    /// A whole number below `count`, which is from 1 to 256.
    pub fn below(&mut self, count: usize) -> usize {
        usize::from(self.byte()) % count
    }

    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }

    /// Most often one of a few numbers, so that coincidences are common; else any of the 2^64 patterns.
    pub fn number(&mut self, common: &[f64]) -> f64 {
        let choice = usize::from(self.byte());
        match common.get(choice % (common.len() + 1)) {
            Some(&number) => number,
            None => {
                let mut bits = [0; 8];
                bits.fill_with(|| self.byte());
                f64::from_le_bytes(bits)
            }
        }
    }
}
