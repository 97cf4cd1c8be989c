//! Reader of whitespace-separated numbers.

use crate::error::PhotonError;
use rayweave_error::Message;
use std::path::Path;
use std::str::FromStr;

/// The largest file, in bytes: several times the largest table of Geant4's data sets.
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

/// The numbers of a file, at most `limit`; further ones are left out, as in Geant4.
///
/// # Errors
///
/// A file that cannot be read, is too large, is compressed, or holds other text than finite numbers.
fn read<T: Number>(path: &Path, limit: usize) -> Result<Vec<T>, Message> {
    let problem = || format!("cannot read the table {}", path.display());
    let cannot = |error: std::io::Error| {
        let compressed = path.with_extension("z");
        let message = Message::new(problem(), error.to_string());
        let advice = format!("Decompress {} first, as with `zlib-flate -uncompress`.", compressed.display());
        if compressed.is_file() { message.suggest(advice) } else { message }
    };
    let bytes = std::fs::metadata(path).map_err(cannot)?.len();
    if bytes > MAX_BYTES {
        return Err(Message::new(problem(), format!("it has {bytes} bytes, at most {MAX_BYTES} are read")));
    }
    let bytes = std::fs::read(path).map_err(cannot)?;
    let text = str::from_utf8(&bytes).map_err(|_| {
        let message = Message::new(problem(), "it is not text");
        message.suggest("Compressed tables must be decompressed first, as with `zlib-flate -uncompress`.")
    })?;
    parse(text, &path.display().to_string(), limit)
}

/// The numbers of a file, at most `limit`.
///
/// # Errors
///
/// [`PhotonError::Setting`] for files that cannot be read, are compressed, or hold other text.
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
                return Err(Message::new(problem, "finite numbers are expected"));
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
            "t.dat:2:4: the table has the entry `four`: finite numbers are expected."
        );
        assert!(refused("NaN").contains("t.dat:1:1"));
        assert!(read::<f32>(Path::new("no/such.dat"), 9).unwrap_err().to_string().contains("no/such.dat"));
    }
}
