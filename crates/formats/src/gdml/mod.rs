//! GDML, the exchange format of Geant4.
//!
//! *Sources*: R. Chytracek, J. McCormick, W. Pokorski, G. Santin, "Geometry Description Markup Language for physics simulation
//! and analysis applications", IEEE Trans. Nucl. Sci. 53 (2006) 2892; the GDML User's Guide 2.7; Geant4's Book For Application
//! Developers, section 4.1, for what each solid is.
//!
//! **Reading** goes through a file once, from the start to its end, as Geant4 does: `<define>` gives names to numbers, every
//! solid becomes a [`rayweave_model::Solid`] in its own frame, exact where its surfaces are of degree two or tori, and every
//! volume a node of a graph. References to volumes are looked up at the end.
//!
//! **The hierarchy** becomes regions, one for each logical volume, however many times it is placed: mothers before their
//! daughters, so that a daughter carves its mother (the later region wins). A volume placed many times is one prototype under
//! many maps, within those of its mother: memory grows with the file, not with the number of copies that it amounts to. The
//! volume of the world is the first region. A daughter that sticks out of its mother is kept whole; Geant4 leaves open what it
//! then is.
//!
//! **Media** are the materials, with density (`density`, g/cm3), temperature, pressure and, where a refractive index is given,
//! its value nearest to the yellow line of sodium. Everything else that a file says stands in the table `[gdml]` of the
//! document: the tree of volumes with the names of all placements, optical surfaces, matrices of properties, auxiliary tags.

mod attributes;
mod define;
mod expression;
mod hierarchy;
mod materials;
mod optical;
mod shape;
mod solids;
pub(crate) mod stated;
mod structure;
mod table;
mod units;
mod xml;

use crate::{Imported, LossKind, Options, Report};
use rayweave_scene::memory;
use rayweave_scene::{Diagnostic, Diagnostics, Foreign, Scene, Source, Spanned};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;
use xml::{Files, Place};

/// Kind and value of the auxiliary tag of a world that is only the room around a model which was no GDML file: it is no region.
pub(crate) const NO_REGION: [&str; 2] = ["rayweave", "room"];

pub(crate) use hierarchy::UNSPECIFIED;

/// The largest file in bytes.
const LARGEST_FILE: u64 = 256 << 20;
/// The memory that is taken for a byte of a file: of one of placements 15 were measured to read and to compile it, and 19 to write it
/// as a native file.
const MEMORY_A_BYTE: u64 = 20;
/// Problems beyond this number are not told: they come from a loop, or from a file that is none of this format.
const MOST_PROBLEMS: usize = 200;

/// Reads the text of a GDML file. Files that it names are looked for beside it.
///
/// # Errors
///
/// All problems at once, if it is not well-formed, refers to what is not there, or has numbers that cannot be computed.
pub fn read(source: &Arc<Source>, _options: &Options) -> Result<Imported, Diagnostics> {
    check_memory(source, memory::available())?;
    let mut context = Context::default();
    match context.model(source) {
        Some((scene, table)) if context.problems.is_empty() => {
            let mut imported = Imported::from_scene(scene, context.report);
            let warnings = imported.scene.warnings.iter().chain(&context.warnings).cloned();
            imported.scene.warnings = Diagnostics::new(warnings.collect());
            let mut document = imported.document();
            document.foreign.push(Foreign::new("gdml", table));
            imported.stated = Some(document);
            Ok(imported)
        }
        _ => Err(Diagnostics::new(context.problems)),
    }
}

/// Refuses a file whose model does not fit into memory, before it is taken apart.
fn check_memory(source: &Arc<Source>, available: Option<u64>) -> Result<(), Diagnostics> {
    let needed = MEMORY_A_BYTE * source.text().len() as u64;
    match available {
        Some(available) if needed > available => {
            let mebibytes = |bytes: u64| bytes.div_ceil(1 << 20);
            let why = format!(
                "it may take {} MiB of memory to read, and there are {}",
                mebibytes(needed),
                mebibytes(available)
            );
            Err(Diagnostic::error("the file is too large").why(why).in_file(source).into())
        }
        _ => Ok(()),
    }
}

/// What is collected while files are read.
#[derive(Debug, Default)]
struct Context {
    files: Files,
    problems: Vec<Diagnostic>,
    warnings: Vec<Diagnostic>,
    report: Report,
    /// The files that are being read, one within the other.
    open: Vec<std::path::PathBuf>,
}

impl Context {
    fn model(&mut self, source: &Arc<Source>) -> Option<(Scene, rayweave_scene::Table)> {
        let mut volumes = structure::Graph::default();
        self.open.extend(source.path().cloned());
        let world = structure::read_file(self, source.clone(), None, &mut volumes)?;
        // with problems, some daughters are of no volume
        if self.problems.is_empty() { hierarchy::scene(self, &volumes, world) } else { None }
    }

    /// Adds an error.
    fn error(&mut self, trouble: Trouble) {
        if self.problems.len() < MOST_PROBLEMS {
            self.problems.push(self.files.locate(Diagnostic::error(trouble.message), trouble.place));
        }
    }

    /// Adds a warning that tells of no loss.
    fn warn(&mut self, trouble: Trouble) {
        if self.warnings.len() < MOST_PROBLEMS {
            self.warnings.push(self.files.locate(Diagnostic::warning(trouble.message), trouble.place));
        }
    }

    /// Adds a loss.
    fn lose(&mut self, kind: LossKind, what: &str, trouble: Trouble) {
        self.report.add(kind, what, self.files.locate(Diagnostic::warning(trouble.message), trouble.place));
    }
}

/// Something wrong at a place.
#[derive(Clone, Debug)]
struct Trouble {
    message: String,
    place: Place,
}

impl Trouble {
    fn new(message: impl Into<String>, place: Place) -> Trouble {
        Trouble { message: message.into(), place }
    }

    /// Adds the name that was probably meant.
    fn did_you_mean<'a>(mut self, name: &str, known: impl IntoIterator<Item = &'a str>) -> Trouble {
        if let Some(nearest) = rayweave_scene::nearest(name, known) {
            self.message += &format!(" did you mean `{nearest}`?");
        }
        self
    }
}

/// The text of a GDML file. Files in Latin-1 that say so are understood, too.
///
/// # Errors
///
/// One problem: the file cannot be read, is too large, or is no text.
pub(crate) fn source(path: &Path) -> Result<Source, Diagnostics> {
    // what is wrong is said by the reader of all formats
    Source::read(path).or_else(|problems| source_of(path).map_err(|_| problems))
}

/// The text of a file that another one names.
fn source_of(path: &Path) -> Result<Source, String> {
    let file = File::open(path).map_err(|error| error.to_string())?;
    let mut bytes = Vec::new();
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(format!("it is larger than {} MiB", LARGEST_FILE >> 20));
    }
    let text = String::from_utf8(bytes)
        .or_else(|error| latin_1(error.as_bytes()).ok_or("it is not a text in UTF-8"))?;
    Ok(Source::new(Some(path.to_owned()), text))
}

/// A text in Latin-1, if its first line says that it is one.
fn latin_1(bytes: &[u8]) -> Option<String> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(100)]).to_ascii_lowercase();
    let is_latin = head.starts_with("<?xml") && (head.contains("iso-8859-1") || head.contains("latin1"));
    is_latin.then(|| bytes.iter().map(|byte| char::from(*byte)).collect())
}

/// A value that stands at no place of the document's text.
fn unplaced<T>(value: T) -> Spanned<T> {
    value.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_into_memory_is_refused() {
        let source = Arc::new(Source::new(None, " ".repeat(1 << 20)));
        assert!(check_memory(&source, Some(20 << 20)).is_ok() && check_memory(&source, None).is_ok());
        let text = check_memory(&source, Some((20 << 20) - 1)).unwrap_err().to_string();
        assert!(text.contains("20 MiB"), "{text}");
    }
}
