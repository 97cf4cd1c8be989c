//! Writing scenes in the formats of other programs.
//!
//! [`write`] writes a scene in any [`Format`]. Shapes that the format has are exact, others are triangulated within a
//! tolerance; remarks list what was approximated, dropped or expressed differently. Formats other than the native one have
//! no complements, no unbounded solids and no priority of regions. Therefore infinite shapes are cut to a box around the
//! whole model, a complement becomes that box minus the shape, and later regions that may overlap a region are subtracted
//! from it. None of this changes the solid.

mod error;
mod facets;
mod films;
mod fold;
mod gdml;
mod model;
mod openscad;
mod options;
mod remark;
mod triangles;

pub use error::WriteError;
pub use options::WriteOptions;
pub use remark::{Remark, RemarkKind};

use crate::Format;
use model::Model;
use rayweave_mesh::Mesh;
use rayweave_mesh_io::MeshFormat;
use rayweave_scene::{Body, Document, Layout, Scene};
use remark::Remarks;

/// A written file, with remarks on differences from the scene.
#[derive(Clone, Debug, Default)]
pub struct Written {
    /// Contents of the file.
    pub bytes: Vec<u8>,
    /// Everything that was approximated, dropped or expressed differently.
    pub remarks: Vec<Remark>,
}

/// Writes a scene in a format. `stated` is the document of the scene, if there is one: the native format keeps it, with
/// parameters and foreign tables.
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
        remarks.add(RemarkKind::Dropped, "the optics tables and those of other programs");
    }
    let bytes = match format {
        Format::OpenScad => openscad::write(&model, &mut remarks)?,
        Format::Gdml => gdml::write(&model, table, &mut remarks)?,
        Format::Mesh(kind) => triangles::write(&model, kind, options, &mut remarks)?,
        other => return Err(WriteError::NotWritten(other)),
    };
    Ok(Written { bytes, remarks: remarks.finish() })
}

/// The regions of a scene as closed triangle meshes, with their names, in the unit of the scene. Later regions are subtracted from
/// earlier ones; regions that they cover have no mesh.
///
/// # Errors
///
/// [`WriteError`].
pub fn triangulate(scene: &Scene, options: &WriteOptions) -> Result<Vec<(String, Mesh)>, WriteError> {
    let model = Model::new(scene, Format::Mesh(MeshFormat::Stl), options)?;
    let parts = triangles::meshes(&model)?.into_iter().filter(|made| !made.mesh.is_flat());
    Ok(parts.map(|made| (made.name, made.mesh)).collect())
}

/// The original document or, if it refers to other files, which may be missing in the folder of the new one, a document with
/// their contents.
fn native(scene: &Scene, stated: Option<&Document>) -> Written {
    let mut remarks = Remarks::default();
    let document = match stated {
        Some(stated) if !names_files(stated) => stated.clone(),
        Some(stated) => {
            remarks.add(RemarkKind::Changed, "references to files, replaced by their contents");
            if !stated.parameters.is_empty() {
                remarks.add(RemarkKind::Dropped, "parameters, replaced by their values");
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
