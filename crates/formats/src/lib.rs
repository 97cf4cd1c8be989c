//! Models from other programs, read as documents and scenes: OpenSCAD, GDML and mesh files.
//!
//! [`load`] reads a model in any [`Format`], selected by the extension of the file or by the caller. A [`Report`] lists every
//! loss, i.e. each construct that a scene cannot represent, with its kind, its position and its count. Items that are not
//! supported are refused and the rest of the file is read. A file that is not in the format at all is an error.
//!
//! ```
//! use rayweave_formats::{Format, Options, parse};
//!
//! let text = "difference() { cube(size = [30, 30, 30], center = true); sphere($fn = 0, $fa = 12, $fs = 2, r = 20); }";
//! let imported = parse(text, Format::OpenScad, &[], &Options::default())?;
//! assert!(imported.report.is_empty());
//! assert_eq!(imported.scene.regions.len(), 1);
//!
//! // the same model in a native model file
//! let (_, scene) = rayweave_scene::parse(&imported.document().to_toml())?;
//! assert_eq!((scene.regions.len(), scene.regions[0].name.as_str()), (1, "model"));
//! # Ok::<(), rayweave_scene::Diagnostics>(())
//! ```

mod format;
pub mod gdml;
mod imported;
mod kernel;
mod mesh;
pub mod openscad;
mod options;
mod report;
mod save;
mod write;

pub use format::Format;
pub use imported::{Imported, Places};
pub use mesh::MeshFile;
pub use options::Options;
pub use report::{Loss, LossKind, Report};
pub use save::save;
pub use write::{Remark, RemarkKind, WriteError, WriteOptions, Written, triangulate, write};

use rayweave_error::with_limited_suggestions;
use rayweave_scene::{Diagnostics, Document, Scene, Source};
use std::path::Path;
use std::sync::Arc;

/// Reads a model file and overrides parameters (name, arithmetic expression). Without a format, the extension of the file
/// selects it; the native format is the fallback.
///
/// # Errors
///
/// All problems of the file at once, if it is not in the format or has too many errors; all warnings, if they count as errors
/// ([`Options::strict`]).
pub fn load(
    path: impl AsRef<Path>,
    format: Option<Format>,
    overrides: &[(String, String)],
    options: &Options,
) -> Result<Imported, Diagnostics> {
    let path = path.as_ref();
    let imported = match format.or_else(|| Format::from_path(path)).unwrap_or(Format::Native) {
        Format::Native => {
            let source = Arc::new(Source::new(Some(path.to_owned()), String::new()));
            report::refuse_unit(&source, Format::Native, options)?;
            report::refuse_program(&source, path, format)?;
            match options.scene_only {
                true => rayweave_scene::load_scene(path, overrides, &options.allow)
                    .map(|scene| native(None, scene)),
                false => rayweave_scene::load_allowing(path, overrides, &options.allow)
                    .map(|(document, scene)| native(Some(document), scene)),
            }
        }
        Format::Gdml => understand(gdml::source(path)?, Format::Gdml, overrides, options),
        Format::Mesh(kind) => {
            let source = Arc::new(Source::new(Some(path.to_owned()), String::new()));
            report::refuse_overrides(&source, Format::Mesh(kind), overrides)?;
            mesh::load(path, kind, options)
        }
        other => understand(Source::read(path)?, other, overrides, options),
    };
    strictly(imported?, options)
}

/// Reads a model from text. File names in it are relative to the current folder.
///
/// # Errors
///
/// The errors of [`load`].
pub fn parse(
    text: &str,
    format: Format,
    overrides: &[(String, String)],
    options: &Options,
) -> Result<Imported, Diagnostics> {
    let imported = match format {
        Format::Native => rayweave_scene::parse_allowing(text, overrides, &options.allow)
            .map(|(document, scene)| native(Some(document), scene)),
        other => understand(Source::new(None, text.to_owned()), other, overrides, options),
    };
    strictly(imported?, options)
}

/// Rejects a model with warnings, if they count as errors.
fn strictly(imported: Imported, options: &Options) -> Result<Imported, Diagnostics> {
    match options.strict && !imported.scene.warnings.is_empty() {
        true => Err(imported.scene.warnings.into_errors()),
        false => Ok(imported),
    }
}

/// A native model, with the warnings of its reader.
fn native(stated: Option<Document>, scene: Scene) -> Imported {
    Imported { stated, scene, report: Report::default(), places: Places::default() }
}

/// Reads the text of another program's file.
fn understand(
    source: Source,
    format: Format,
    overrides: &[(String, String)],
    options: &Options,
) -> Result<Imported, Diagnostics> {
    let source = Arc::new(source);
    with_limited_suggestions(|| match format {
        Format::Native => rayweave_scene::parse_allowing(source.text(), overrides, &options.allow)
            .map(|(document, scene)| native(Some(document), scene)),
        Format::OpenScad => {
            report::refuse_overrides(&source, format, overrides)?;
            let (mut scene, report) = openscad::read(&source, options)?;
            scene.unit = options.unit.unwrap_or(scene.unit);
            Ok(Imported::from_scene(scene, report))
        }
        Format::Gdml => {
            report::refuse_unit(&source, format, options)?;
            gdml::read(&source, overrides, options)
        }
        Format::Mesh(kind) => {
            report::refuse_overrides(&source, format, overrides)?;
            mesh::parse(&source, kind, options)
        }
    })
}
