//! FNV-1a hash of numbers (Fowler, Noll, Vo, 64 bits), the same on every platform and for every Rust release.

/// A running hash.
#[derive(Clone, Copy, Debug)]
pub struct Hash(u64);

impl Hash {
    /// The hash of an empty input.
    pub fn new() -> Hash {
        Hash(0xcbf2_9ce4_8422_2325)
    }

    /// Adds bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Adds a whole number.
    pub fn count(&mut self, value: u64) {
        self.bytes(&value.to_le_bytes());
    }

    /// Adds the bits of a number; all NaNs are equal.
    pub fn number(&mut self, value: f64) {
        let value = if value.is_nan() { f64::NAN } else { value };
        self.bytes(&value.to_bits().to_le_bytes());
    }

    /// Adds the bits of numbers, and their count.
    pub fn numbers<'a>(&mut self, values: impl IntoIterator<Item = &'a f64>) {
        let mut count = 0;
        for value in values {
            self.number(*value);
            count += 1;
        }
        self.count(count);
    }

    /// The hash as 16 hexadecimal digits.
    pub fn text(self) -> String {
        format!("{:016x}", self.0)
    }
}
