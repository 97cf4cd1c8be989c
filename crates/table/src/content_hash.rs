//! Hashes of contents, the same on every platform and in every version.

use std::fmt;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use twox_hash::XxHash3_128;

/// The size of the pieces of a file that are read at once.
const BLOCK: usize = 1 << 16;

/// The number of pieces of a large file that [`ContentHash::sample`] reads.
const SAMPLES: u64 = 64;

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

    /// Appends the length of a regular file and 64 pieces of 64 KiB at equal distances, the first and the last piece among
    /// them; all of a file of up to 4 MiB. Tells input files apart without reading gigabytes; a change between the pieces goes
    /// unnoticed.
    ///
    /// # Errors
    ///
    /// If the file cannot be read.
    pub fn sample(&mut self, path: &Path) -> io::Result<()> {
        let mut file = File::open(path)?;
        let length = file.metadata()?.len();
        self.bytes(&length.to_le_bytes());
        let block = BLOCK as u64;
        if length <= SAMPLES * block {
            return self.file(path).map(|_| ());
        }
        let mut piece = vec![0; BLOCK];
        for k in 0..SAMPLES {
            // u128: the product of a length and a number may exceed u64
            let start = u128::from(length - block) * u128::from(k) / u128::from(SAMPLES - 1);
            file.seek(SeekFrom::Start(start as u64))?;
            file.read_exact(&mut piece)?;
            self.bytes(&piece);
        }
        Ok(())
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
    fn samples_notice_the_length_and_both_ends() {
        let path = std::env::temp_dir().join(format!("rayweave-sample-{}", std::process::id()));
        let sampled = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            let mut hash = ContentHash::new();
            hash.sample(&path).unwrap();
            hash.finish()
        };
        let mut bytes = vec![7; 5 << 20];
        let first = sampled(&bytes);
        assert_eq!(first, sampled(&bytes));
        for at in [0, bytes.len() / 63, bytes.len() - 1] {
            bytes[at] = 8;
            assert_ne!(first, sampled(&bytes), "{at}");
            bytes[at] = 7;
        }
        bytes.push(7);
        assert_ne!(first, sampled(&bytes));
        // every byte of a short file counts
        let short = sampled(&[1; 1000]);
        let mut other = [1; 1000];
        other[700] = 2;
        assert_ne!(short, sampled(&other));
        fs::remove_file(&path).unwrap();
    }
}
