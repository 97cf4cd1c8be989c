//! Decoder of fuzz input into choices: every input is valid.

/// Reads choices from bytes; at the end of the input every choice is the first one.
pub struct Bytes<'a> {
    left: &'a [u8],
}

impl<'a> Bytes<'a> {
    pub fn new(data: &'a [u8]) -> Bytes<'a> {
        Bytes { left: data }
    }

    /// The unread bytes.
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

    /// An integer below `count`, which is from 1 to 256.
    pub fn below(&mut self, count: usize) -> usize {
        usize::from(self.byte()) % count
    }

    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }

    /// Usually one of the common numbers, so that coincidences are frequent; otherwise any of the 2^64 bit
    /// patterns.
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
