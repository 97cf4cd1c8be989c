//! Reading and writing of model files.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::document::Document;
use crate::formats::native::{self, Kept, Reading};
use crate::resolve::{reason, resolve, resolve_definitions};
use crate::scene::Scene;
use crate::source::{Source, Span};
use rayweave_error::with_limited_suggestions;
use rayweave_table::{AtomicFile, TableError, nearby_files};
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The maximum size of a model file in bytes.
const MAX_FILE_BYTES: u64 = 256 << 20;

/// Reads a model file, with overrides of some of its parameters (name, arithmetic expression).
///
/// Files that the model refers to must be in its folder or below.
///
/// # Errors
///
/// All problems of the file at once.
pub fn load(
    path: impl AsRef<Path>,
    overrides: &[(String, String)],
) -> Result<(Document, Scene), Diagnostics> {
    load_allowing(path, overrides, &[])
}

/// Reads a model file that may refer to files in its folder and in the given folders, and below, and to the given files.
///
/// # Errors
///
/// All problems of the file at once.
pub fn load_allowing(
    path: impl AsRef<Path>,
    overrides: &[(String, String)],
    allowed: &[PathBuf],
) -> Result<(Document, Scene), Diagnostics> {
    understand(Arc::new(Source::read(path.as_ref())?), overrides, allowed)
}

/// Reads a model from text. File names are relative to the current folder, and the files must be there or below.
///
/// # Errors
///
/// All problems of the text at once.
pub fn parse(text: &str) -> Result<(Document, Scene), Diagnostics> {
    parse_with(text, &[])
}

/// Reads a model from text, with overrides of some of its parameters (name, arithmetic expression).
///
/// # Errors
///
/// All problems of the text at once.
pub fn parse_with(text: &str, overrides: &[(String, String)]) -> Result<(Document, Scene), Diagnostics> {
    parse_allowing(text, overrides, &[])
}

/// Reads a model from text that may refer to files in the current folder and in the given folders, and below, and to the given files.
///
/// # Errors
///
/// All problems of the text at once.
pub fn parse_allowing(
    text: &str,
    overrides: &[(String, String)],
    allowed: &[PathBuf],
) -> Result<(Document, Scene), Diagnostics> {
    understand(Arc::new(Source::new(None, text.to_owned())), overrides, allowed)
}

/// Reads a model file like [`load_allowing`], but without its document, to save memory.
///
/// # Errors
///
/// All problems of the file at once.
pub fn load_scene(
    path: impl AsRef<Path>,
    overrides: &[(String, String)],
    allowed: &[PathBuf],
) -> Result<Scene, Diagnostics> {
    let source = Arc::new(Source::read(path.as_ref())?);
    with_limited_suggestions(|| {
        let Reading { document, problems, unreadable, definitions, .. } =
            read(source, allowed, Kept::Definitions)?;
        resolve_definitions(document, definitions, overrides, &unreadable, problems)
    })
}

fn understand(
    source: Arc<Source>,
    overrides: &[(String, String)],
    allowed: &[PathBuf],
) -> Result<(Document, Scene), Diagnostics> {
    with_limited_suggestions(|| read_and_resolve(source, overrides, allowed))
}

fn read_and_resolve(
    source: Arc<Source>,
    overrides: &[(String, String)],
    allowed: &[PathBuf],
) -> Result<(Document, Scene), Diagnostics> {
    let Reading { document, problems, unreadable, .. } = read(source, allowed, Kept::Document)?;
    let scene = resolve(&document, overrides, &unreadable, problems)?;
    Ok((document, scene))
}

fn read(source: Arc<Source>, allowed: &[PathBuf], kept: Kept) -> Result<Reading, Diagnostics> {
    let mut reading = native::read(source, kept);
    reading.document.allowed = allowed.to_vec();
    match reading.broken {
        true => Err(Diagnostics::new(reading.problems)),
        false => Ok(reading),
    }
}

impl Source {
    /// Reads the text of a model file, which must be UTF-8 of at most 256 MiB.
    ///
    /// # Errors
    ///
    /// One problem: the file cannot be read, is too large, or is not UTF-8 text.
    pub fn read(path: &Path) -> Result<Source, Diagnostics> {
        let source = |text: String| Source::new(Some(path.to_owned()), text);
        let problem = |reason: &str| {
            let problem =
                Diagnostic::error("the model file cannot be read").why(reason).suggest(nearby_files(path));
            Diagnostics::from(problem.in_file(&Arc::new(source(String::new()))))
        };
        let bytes = read_bytes(path).map_err(|reason| problem(&reason))?;
        match String::from_utf8(bytes) {
            Ok(text) => Ok(source(text)),
            Err(error) => {
                // the valid text before the error is kept unchanged, so that positions in the
                // displayed text are correct
                let at = error.utf8_error().valid_up_to();
                let source = Arc::new(source(String::from_utf8_lossy(error.as_bytes()).into_owned()));
                let problem = Diagnostic::error("the file is not UTF-8 text");
                let reason = format!("byte {at} is not part of a character");
                let suggestion = Some("was it saved in a different encoding?".to_owned());
                Err(problem
                    .why(reason)
                    .suggest(suggestion)
                    .at(&source, Span::new(at, at + char::REPLACEMENT_CHARACTER.len_utf8()))
                    .into())
            }
        }
    }
}

/// Reads the bytes of a text file of at most 256 MiB, for readers of other formats.
///
/// # Errors
///
/// The reason why it cannot be read, as a clause for use in a message.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    // Windows cannot open a folder, and reports that access is denied
    let is_folder = || "it is a folder".to_owned();
    let file = File::open(path).map_err(|error| if path.is_dir() { is_folder() } else { reason(&error) })?;
    let metadata = file.metadata().map_err(|error| reason(&error))?;
    if metadata.is_dir() {
        return Err(is_folder());
    }
    match metadata.len() > MAX_FILE_BYTES {
        true => Err(too_large()),
        false => read_stream(file),
    }
}

/// Reads the bytes of a stream of unknown length, at most 256 MiB, for readers of model files.
///
/// # Errors
///
/// The reason why it cannot be read, as a clause for use in a message.
pub fn read_stream(stream: impl Read) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let count = stream.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(|error| reason(&error))?;
    match count as u64 > MAX_FILE_BYTES {
        true => Err(too_large()),
        false => Ok(bytes),
    }
}

fn too_large() -> String {
    format!("it is larger than {} MiB", MAX_FILE_BYTES >> 20)
}

impl Document {
    /// Evaluates the document, with overrides of some of its parameters.
    ///
    /// # Errors
    ///
    /// All problems at once.
    pub fn scene(&self, overrides: &[(String, String)]) -> Result<Scene, Diagnostics> {
        resolve(self, overrides, &Default::default(), Vec::new())
    }

    /// Formats the document as a model file. Comments are kept at the head and in the tables of
    /// other programs.
    pub fn to_toml(&self) -> String {
        native::write(self)
    }

    /// Saves the document in a file, which appears when it is complete: see [`AtomicFile`].
    ///
    /// # Errors
    ///
    /// [`TableError::Io`]; an existing file is left unchanged.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), TableError> {
        let path = path.as_ref();
        let mut file = AtomicFile::create(path)?;
        let written = file.write_all(self.to_toml().as_bytes());
        written.map_err(|error| TableError::Io {
            action: "write",
            path: path.display().to_string(),
            error,
        })?;
        file.finish()
    }
}
