//! Reader of whitespace-separated numbers, from files that may be compressed.

use crate::error::PhotonError;
use flate2::read::ZlibDecoder;
use rayweave_error::Message;
use rayweave_table::nearby_sentence;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The largest file, in bytes after decompression: several times the largest table of Geant4's data sets.
const MAX_BYTES: u64 = 1 << 29;

/// A number of a table.
pub(super) trait Number: FromStr + Copy {
    fn is_finite(self) -> bool;
}

impl Number for f32 {
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }
}

impl Number for f64 {
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}

/// The extension of the files of Geant4's data set RealSurface, which zlib compresses (RFC 1950).
const COMPRESSED: &str = "z";

/// The file of a table: the path itself, or if there is no such file, the compressed one beside it.
fn existing(path: &Path) -> PathBuf {
    let compressed = path.with_extension(COMPRESSED);
    if !path.exists() && compressed.is_file() { compressed } else { path.to_owned() }
}

/// The contents of a file, decompressed.
fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let mut bytes = Vec::new();
    if path.extension().is_some_and(|extension| extension == COMPRESSED) {
        ZlibDecoder::new(file).take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    } else {
        file.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    }
    Ok(bytes)
}

/// The numbers of a file, at most `limit`; further ones are left out, as in Geant4. If the file is absent, that with the
/// extension `.z` is read.
///
/// # Errors
///
/// A file that cannot be read or decompressed, is too large, or holds other text than finite numbers.
fn read<T: Number>(path: &Path, limit: usize) -> Result<Vec<T>, Message> {
    let path = &existing(path);
    let problem = || format!("cannot read the table {}", path.display());
    let bytes = bytes(path).map_err(|error| {
        let message = Message::new(problem(), rayweave_scene::reason(&error));
        match nearby_sentence(path).trim_start() {
            "" => message,
            hint => message.suggest(hint),
        }
    })?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(Message::new(problem(), format!("it has more than {MAX_BYTES} bytes")));
    }
    let text = str::from_utf8(&bytes).map_err(|_| {
        let message = Message::new(problem(), "it is not text");
        message.suggest("If it is compressed by zlib, its name must end in `.z`.")
    })?;
    parse(text, &path.display().to_string(), limit)
}

/// The numbers of a file, at most `limit`.
///
/// # Errors
///
/// [`PhotonError::Setting`] for files that cannot be read or decompressed, or hold other text.
pub(super) fn read_numbers<T: Number>(path: &Path, limit: usize) -> Result<Vec<T>, PhotonError> {
    read(path, limit).map_err(PhotonError::Setting)
}

/// The numbers of a text with a name, at most `limit`.
///
/// # Errors
///
/// Anything but finite numbers, with its place.
fn parse<T: Number>(text: &str, name: &str, limit: usize) -> Result<Vec<T>, Message> {
    let mut numbers = Vec::new();
    for word in text.split_ascii_whitespace().take(limit) {
        match word.parse::<T>() {
            Ok(number) if number.is_finite() => numbers.push(number),
            _ => {
                let at = word.as_ptr() as usize - text.as_ptr() as usize;
                let line = text[..at].matches('\n').count() + 1;
                let column = text[..at].chars().rev().take_while(|c| *c != '\n').count() + 1;
                let word: String = word.chars().take(20).collect();
                let problem = format!("{name}:{line}:{column}: the table has the entry `{word}`");
                return Err(Message::new(problem, "its entries must be finite numbers"));
            }
        }
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_up_to_the_limit() {
        assert_eq!(parse::<f64>("1 2.5\n-3e2 x", "t", 3).unwrap(), [1.0, 2.5, -300.0]);
    }

    #[test]
    fn other_text_is_refused_with_its_place() {
        let refused = |text: &str| parse::<f32>(text, "t.dat", 9).unwrap_err().to_string();
        assert_eq!(
            refused("1 2\n 3 four"),
            "t.dat:2:4: the table has the entry `four`: its entries must be finite numbers."
        );
        assert!(refused("NaN").contains("t.dat:1:1"));
        assert!(read::<f32>(Path::new("no/such.dat"), 9).unwrap_err().to_string().contains("no/such.dat"));
    }
}
