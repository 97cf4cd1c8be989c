//! Scenes as files of other programs.
//!
//! [`write`] says a scene in any [`Format`], exactly where the format has the shape, else by triangles within a tolerance, and
//! tells what was approximated, dropped or said in another way. Formats other than the native one know no complement, nothing
//! without an end and no order of regions. So, within a box that holds the whole model, every infinite shape is cut to that box, a
//! complement is the box less the shape, and from every region the later ones are cut out that come near to it. None of this
//! changes what is inside.

mod facets;
mod fold;
mod gdml;

mod model;
mod openscad;
mod remark;
mod triangles;

pub use remark::{Remark, RemarkKind};

use crate::Format;
use model::Model;
use rayweave_mesh::files::FileError;
use rayweave_model::CompileError;
use rayweave_scene::{Body, Document, Layout, Scene};
use remark::Remarks;

/// How a scene is written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// The greatest distance, in the unit of the scene, between a curved face and the triangles that stand for it; greater
    /// than 0. If it is not given, a five-thousandth of the diagonal of the box around the model.
    pub tolerance: Option<f64>,
    /// Text, where meshes may be text or binary (STL, PLY).
    pub text: bool,
}

/// A file, and what it does not say as the scene did.
#[derive(Clone, Debug, Default)]
pub struct Written {
    /// The file.
    pub bytes: Vec<u8>,
    /// What was approximated, dropped or said in another way.
    pub remarks: Vec<Remark>,
}

/// Why a scene cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The tolerance is not a length.
    #[error("the tolerance is {0} (it must be finite and greater than 0)")]
    Tolerance(f64),
    /// A solid cannot be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A region has no end.
    #[error(
        "region `{region}` has no end (files of the format {format} cannot say that) can it be cut with a box?"
    )]
    Unbounded {
        /// The region.
        region: String,
        /// The format.
        format: Format,
    },
    /// A region becomes too long a text, or too many triangles.
    #[error("region `{region}` becomes too large ({why}) does a greater tolerance help?")]
    TooLarge {
        /// The region.
        region: String,
        /// What there would be too many of.
        why: String,
    },
    /// The booleans of triangles failed.
    #[error("the triangles of region `{region}` cannot be combined ({why})")]
    Kernel {
        /// The region.
        region: String,
        /// What the kernel says.
        why: String,
    },
    /// The writer of meshes failed.
    #[error(transparent)]
    File(#[from] FileError),
}

/// Writes a scene in a format. `stated` is what a native file said, if the scene comes from one: in the native format that is
/// kept, parameters and tables of others included.
///
/// # Errors
///
/// [`WriteError`].
pub fn write(
    scene: &Scene,
    stated: Option<&Document>,
    format: Format,
    options: &WriteOptions,
) -> Result<Written, WriteError> {
    if format == Format::Native {
        return Ok(native(scene, stated));
    }
    let mut remarks = Remarks::default();
    let model = Model::new(scene, format, options)?;
    let foreign = || stated.into_iter().flat_map(|document| &document.foreign);
    let table = foreign().find(|foreign| format == Format::Gdml && foreign.name.value == "gdml");
    if foreign().count() > usize::from(table.is_some()) {
        remarks.add(RemarkKind::Dropped, "tables of other programs and of optics");
    }
    let bytes = match format {
        Format::OpenScad => openscad::write(&model, &mut remarks)?,
        Format::Gdml => gdml::write(&model, table, &mut remarks)?,
        Format::Mesh(kind) => triangles::write(&model, kind, options, &mut remarks)?,
        Format::Native => Vec::new(),
    };
    Ok(Written { bytes, remarks: remarks.finish() })
}

/// The document as it was stated or, where that names files that may not be beside the new one, with what they hold.
fn native(scene: &Scene, stated: Option<&Document>) -> Written {
    let mut remarks = Remarks::default();
    let document = match stated {
        Some(stated) if !names_files(stated) => stated.clone(),
        Some(stated) => {
            remarks.add(RemarkKind::Changed, "files that the model names are now in its text");
            if !stated.parameters.is_empty() {
                remarks.add(RemarkKind::Dropped, "parameters (their values are in their places)");
            }
            let heading = stated.heading.clone();
            Document { foreign: stated.foreign.clone(), heading, ..Document::from_scene(scene) }
        }
        None => Document::from_scene(scene),
    };
    Written { bytes: document.to_toml().into_bytes(), remarks: remarks.finish() }
}

/// True if a document refers to other files.
fn names_files(document: &Document) -> bool {
    document.solids.iter().any(|solid| match &solid.body {
        Body::Shape(_, arguments) => arguments.iter().any(|(name, _)| name.value == "file"),
        Body::Place(place) => matches!(place.layout, Layout::File(_)),
        Body::Expression(_) => false,
    })
}
