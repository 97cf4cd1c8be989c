//! Reading of the texts of GDML files.

use rayweave_scene::{Diagnostics, Source};
use rayweave_table::AllowedFiles;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Largest file in bytes.
const MAX_FILE_BYTES: u64 = 256 << 20;

/// Text of a GDML file, in UTF-8 or in Latin-1 if the XML declaration says so.
///
/// # Errors
///
/// One problem: the file cannot be read, is too large, or is not text.
pub(crate) fn source(path: &Path) -> Result<Source, Diagnostics> {
    // the common reader of all formats reports the problem
    let latin_1 = || File::open(path).ok().and_then(|file| source_of(file, path).ok());
    Source::read(path).or_else(|problems| latin_1().ok_or(problems))
}

/// Text of an included file, if it may be read and looks like XML. Messages never quote a file in a different format.
pub fn included(files: &AllowedFiles, path: &Path) -> Result<Source, String> {
    let file = files.open(path).map_err(|refused| refused.to_string())?;
    let source = source_of(file, path)?;
    let text = source.text().trim_start_matches('\u{feff}').trim_start();
    match text.is_empty() || text.starts_with('<') {
        true => Ok(source),
        false => Err("it is not XML".to_owned()),
    }
}

fn source_of(file: File, path: &Path) -> Result<Source, String> {
    let mut bytes = Vec::new();
    file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(format!("it is larger than {} MiB", MAX_FILE_BYTES >> 20));
    }
    let text =
        String::from_utf8(bytes).or_else(|error| latin_1(error.as_bytes()).ok_or("it is not UTF-8 text"))?;
    Ok(Source::new(Some(path.to_owned()), text))
}

/// Text in Latin-1, if the XML declaration names that encoding.
fn latin_1(bytes: &[u8]) -> Option<String> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(100)]).to_ascii_lowercase();
    let is_latin = head.starts_with("<?xml") && (head.contains("iso-8859-1") || head.contains("latin1"));
    is_latin.then(|| bytes.iter().map(|byte| char::from(*byte)).collect())
}
