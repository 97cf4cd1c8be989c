//! Hashes of contents, the same on every platform and in every version.

use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use twox_hash::XxHash3_128;

/// The size of the pieces of a file that are read at once.
const BLOCK: usize = 1 << 16;

/// A running hash: XXH3 with 128 bits (Y. Collet, *xxHash fast digest algorithm*, version 0.8), which tells contents apart but does
/// not protect against forgery.
///
/// Texts, [`Debug`](fmt::Debug) output for example, are written with [`fmt::Write`].
///
/// ```
/// use rayweave_table::ContentHash;
///
/// let mut hash = ContentHash::new();
/// hash.bytes(b"abc");
/// assert_eq!(hash.finish(), "06b05ab6733a618578af5f94892f3950");
/// ```
#[derive(Clone)]
pub struct ContentHash(XxHash3_128);

impl Default for ContentHash {
    fn default() -> ContentHash {
        ContentHash::new()
    }
}

impl fmt::Debug for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("ContentHash").field(&self.clone().finish()).finish()
    }
}

impl ContentHash {
    /// The hash of an empty input.
    pub fn new() -> ContentHash {
        ContentHash(XxHash3_128::new())
    }

    /// The hash of a text.
    pub fn of_text(text: &str) -> String {
        format!("{:032x}", XxHash3_128::oneshot(text.as_bytes()))
    }

    /// Appends bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.0.write(bytes);
    }

    /// Appends the contents of a file; returns its length.
    ///
    /// # Errors
    ///
    /// If the file cannot be read.
    pub fn file(&mut self, path: &Path) -> io::Result<u64> {
        let (mut file, mut block, mut length) = (File::open(path)?, vec![0; BLOCK], 0);
        loop {
            match file.read(&mut block) {
                Ok(0) => return Ok(length),
                Ok(count) => {
                    self.bytes(&block[..count]);
                    length += count as u64;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// The hash as 32 hexadecimal digits.
    pub fn finish(&self) -> String {
        format!("{:032x}", self.0.finish_128())
    }
}

impl fmt::Write for ContentHash {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn every_byte_of_a_file_counts() {
        let path = std::env::temp_dir().join(format!("rayweave-content-{}", std::process::id()));
        let hash = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            let mut hash = ContentHash::new();
            assert_eq!(hash.file(&path).unwrap(), bytes.len() as u64);
            hash.finish()
        };
        let mut bytes = vec![7; 3 * BLOCK + 5];
        let first = hash(&bytes);
        for at in [0, BLOCK - 1, BLOCK, 2 * BLOCK + 700, 3 * BLOCK + 4] {
            bytes[at] = 8;
            assert_ne!(first, hash(&bytes), "{at}");
            bytes[at] = 7;
        }
        assert_eq!(first, hash(&bytes));
        bytes.push(7);
        assert_ne!(first, hash(&bytes));
        fs::remove_file(&path).unwrap();
    }
}
