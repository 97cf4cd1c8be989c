//! Models of other programs, read as documents and scenes.
//!
//! [`load`] reads a model in any [`Format`], by the ending of its name or by choice. What a format says and a scene cannot
//! say is told in a [`Report`]: each loss with its kind, its place and how many times it occurred. An item that cannot be
//! understood is refused and the rest is read; a file that is no such file at all is an error.
//!
//! ```
//! use rayweave_formats::{Format, Options, parse};
//!
//! let text = "difference() { cube(size = [30, 30, 30], center = true); sphere($fn = 0, $fa = 12, $fs = 2, r = 20); }";
//! let imported = parse(text, Format::OpenScad, &[], &Options::default())?;
//! assert!(imported.report.is_empty());
//! assert_eq!(imported.scene.regions.len(), 1);
//!
//! // the document says the same in a native model file
//! let (_, scene) = rayweave_scene::parse(&imported.document().to_toml())?;
//! assert_eq!((scene.regions.len(), scene.regions[0].name.as_str()), (1, "model"));
//! # Ok::<(), rayweave_scene::Diagnostics>(())
//! ```

mod format;
pub mod gdml;
mod kernel;
mod mesh;
pub mod openscad;
mod report;
mod write;

pub use format::Format;
pub use report::{Loss, LossKind, Report};
pub use write::{Remark, RemarkKind, WriteError, WriteOptions, Written, write};

use rayweave_scene::{Diagnostics, Document, Scene, Source, Unit};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How models of other programs are read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Round shapes as the facets that their own program makes of them, so that results compare; otherwise they are
    /// truly round.
    pub facets: bool,
    /// Files of fonts, and folders of such files, in which those that texts name are looked for first.
    pub fonts: Vec<PathBuf>,
    /// Meshes that are no solids, or perhaps not those that were meant, are mended as far as that is safe.
    pub repair: bool,
    /// The unit of lengths in formats that have none: STL, OBJ, PLY, OFF and OpenSCAD's dumps; millimetres if it is not given.
    pub unit: Option<Unit>,
}

/// What was read.
#[derive(Clone, Debug)]
pub struct Imported {
    /// What the file says, if that is more than the scene: a native file, or tables beside the scene.
    pub stated: Option<Document>,
    /// What it means, to be asked. Its warnings hold the report's.
    pub scene: Scene,
    /// What was approximated, dropped or refused; empty for native files.
    pub report: Report,
}

impl Imported {
    /// A scene that was made of another program's file, with what was lost on the way.
    pub fn from_scene(mut scene: Scene, report: Report) -> Imported {
        scene.warnings = report.warnings();
        Imported { stated: None, scene, report }
    }

    /// What the model is, to be saved as a native model file.
    pub fn document(&self) -> Document {
        self.stated.clone().unwrap_or_else(|| Document::from_scene(&self.scene))
    }
}

/// Reads a model file, with other values for some of its parameters (name, arithmetic text). Without a format it is
/// that of the file's name, or the native one where the name tells none.
///
/// # Errors
///
/// All problems of the file at once, if it is no file of its format or too much of it is wrong.
pub fn load(
    path: impl AsRef<Path>,
    format: Option<Format>,
    overrides: &[(String, String)],
    options: &Options,
) -> Result<Imported, Diagnostics> {
    let path = path.as_ref();
    match format.or_else(|| Format::from_path(path)).unwrap_or(Format::Native) {
        Format::Native => {
            let source = Arc::new(Source::new(Some(path.to_owned()), String::new()));
            report::refuse_unit(&source, Format::Native, options)?;
            report::refuse_program(&source, path, format)?;
            rayweave_scene::load(path, overrides).map(native)
        }
        Format::Gdml => understand(gdml::source(path)?, Format::Gdml, overrides, options),
        Format::Mesh(kind) => {
            let source = Arc::new(Source::new(Some(path.to_owned()), String::new()));
            report::refuse_overrides(&source, Format::Mesh(kind), overrides)?;
            mesh::load(path, kind, options)
        }
        other => understand(Source::read(path)?, other, overrides, options),
    }
}

/// Reads a model from text. Files that it names are looked for in the current folder.
///
/// # Errors
///
/// As [`load`].
pub fn parse(
    text: &str,
    format: Format,
    overrides: &[(String, String)],
    options: &Options,
) -> Result<Imported, Diagnostics> {
    match format {
        Format::Native => rayweave_scene::parse_with(text, overrides).map(native),
        other => understand(Source::new(None, text.to_owned()), other, overrides, options),
    }
}

fn native((document, scene): (Document, Scene)) -> Imported {
    Imported { stated: Some(document), scene, report: Report::default() }
}

/// Reads the text of another program's file.
fn understand(
    source: Source,
    format: Format,
    overrides: &[(String, String)],
    options: &Options,
) -> Result<Imported, Diagnostics> {
    let source = Arc::new(source);
    match format {
        Format::Native => rayweave_scene::parse_with(source.text(), overrides).map(native),
        Format::OpenScad => {
            report::refuse_overrides(&source, format, overrides)?;
            let (mut scene, report) = openscad::read(&source, options)?;
            scene.unit = options.unit.unwrap_or(scene.unit);
            Ok(Imported::from_scene(scene, report))
        }
        Format::Gdml => {
            report::refuse_overrides(&source, format, overrides)?;
            report::refuse_unit(&source, format, options)?;
            gdml::read(&source, options)
        }
        Format::Mesh(kind) => {
            report::refuse_overrides(&source, format, overrides)?;
            mesh::parse(&source, kind, options)
        }
    }
}
