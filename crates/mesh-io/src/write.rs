//! Writing mesh files: dispatch by format, and atomic saving.

use crate::read::unknown_format;
use crate::{FileError, Location, MeshFormat, MeshWriteOptions, gltf, obj, off, ply, stl, threemf};
use rayweave_mesh::Mesh;
use rayweave_table::AtomicFile;
use std::borrow::Cow;
use std::io::Write;
use std::path::Path;

/// Writes a mesh.
///
/// # Errors
/// [`FileError::Io`] from the writer.
pub fn write(
    mesh: &Mesh,
    format: MeshFormat,
    options: MeshWriteOptions,
    to: impl Write,
) -> Result<(), FileError> {
    write_objects(&[("", mesh)], format, options, to)
}

/// Writes named meshes as the objects of one file. [`LoadedMesh::objects`](crate::LoadedMesh::objects) restores them, except from
/// PLY, OFF and binary STL, which do not distinguish objects.
///
/// # Errors
/// [`rayweave_mesh::MeshError::TooMany`] as a [`FileError`], or [`FileError::Io`] from the writer.
pub fn write_objects(
    objects: &[(&str, &Mesh)],
    format: MeshFormat,
    options: MeshWriteOptions,
    mut to: impl Write,
) -> Result<(), FileError> {
    match format {
        MeshFormat::Stl if options.text => stl::write_text(objects, &mut to)?,
        MeshFormat::Stl => stl::write_binary(joined(objects)?.as_ref(), &mut to)?,
        MeshFormat::Obj => obj::write(objects, &mut to)?,
        MeshFormat::Ply => ply::write(joined(objects)?.as_ref(), options, &mut to)?,
        MeshFormat::Off => off::write(joined(objects)?.as_ref(), &mut to)?,
        MeshFormat::ThreeMf => threemf::write(objects, options.unit, &mut to)?,
        MeshFormat::Gltf => gltf::write_text(objects, &mut to)?,
        MeshFormat::Glb => gltf::write_binary(objects, &mut to)?,
    }
    Ok(to.flush()?)
}

/// The concatenation of all meshes.
fn joined<'a>(objects: &[(&str, &'a Mesh)]) -> Result<Cow<'a, Mesh>, FileError> {
    if let [(_, mesh)] = objects {
        return Ok(Cow::Borrowed(mesh));
    }
    let error = |error| FileError::Mesh { location: Location::Byte(0), error };
    let count: usize = objects.iter().map(|(_, mesh)| mesh.vertices().len()).sum();
    Mesh::check_count("vertices", count as u64).map_err(error)?;
    let (mut vertices, mut triangles) = (Vec::with_capacity(count), Vec::new());
    for (_, mesh) in objects {
        let first = vertices.len() as u32;
        vertices.extend_from_slice(mesh.vertices());
        triangles.extend(mesh.triangles().iter().map(|corners| corners.map(|corner| corner + first)));
    }
    Ok(Cow::Owned(Mesh::new(vertices, triangles).map_err(error)?))
}

/// Writes a mesh to a file, which appears when it is complete: see [`AtomicFile`]. Without a format, the file name extension
/// determines it.
///
/// # Errors
/// [`FileError::UnknownFormat`], [`FileError::NotWritten`] if the file cannot be created or renamed, or as [`write()`].
pub fn save(
    mesh: &Mesh,
    path: &Path,
    format: Option<MeshFormat>,
    options: MeshWriteOptions,
) -> Result<(), FileError> {
    let format = format.or_else(|| MeshFormat::from_path(path)).ok_or_else(|| unknown_format(path))?;
    let mut file = AtomicFile::create(path)?;
    write(mesh, format, options, &mut file)?;
    Ok(file.finish()?)
}
