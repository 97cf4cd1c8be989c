//! Reading mesh files: dispatch by format.

use crate::{FileError, LoadedMesh, MeshFormat, ReadOptions, gltf, obj, off, ply, stl, threemf};
use rayweave_table::AllowedFiles;
use std::io::{BufRead, BufReader, Cursor, Seek};
use std::path::Path;

/// Reads a mesh file. Without a format, the file name extension determines it. Buffers of glTF may be in the folder of the file
/// and below.
///
/// # Errors
/// [`FileError`], with the line or byte at fault.
pub fn read(path: &Path, format: Option<MeshFormat>, options: &ReadOptions) -> Result<LoadedMesh, FileError> {
    read_allowed(path, format, options, &AllowedFiles::of_model(Some(path), &[]))
}

/// Reads a mesh file, and the files that it names, if they are among the given ones. Without a format, the file name extension
/// determines it.
///
/// # Errors
/// [`FileError`], with the line or byte at fault; [`FileError::Refused`] for a file that is not allowed.
pub fn read_allowed(
    path: &Path,
    format: Option<MeshFormat>,
    options: &ReadOptions,
    files: &AllowedFiles,
) -> Result<LoadedMesh, FileError> {
    let format = format.or_else(|| MeshFormat::from_path(path)).ok_or_else(|| unknown_format(path))?;
    let file = files.open(path)?;
    let length = file.metadata()?.len();
    let folder = path.parent().map(|folder| (folder, files));
    read_from(BufReader::with_capacity(1 << 16, file), length, folder, format, options)
}

/// The error for a file name without a known extension.
pub(crate) fn unknown_format(path: &Path) -> FileError {
    FileError::UnknownFormat { name: path.display().to_string() }
}

/// Reads a mesh file from memory.
///
/// # Errors
/// [`FileError`], with the line or byte at fault.
pub fn read_bytes(bytes: &[u8], format: MeshFormat, options: &ReadOptions) -> Result<LoadedMesh, FileError> {
    read_from(Cursor::new(bytes), bytes.len() as u64, None, format, options)
}

/// Reads a stream of known length. Formats that consist of several files need the folder of the others, and the files that may
/// be read.
fn read_from(
    from: impl BufRead + Seek,
    length: u64,
    folder: Option<(&Path, &AllowedFiles)>,
    format: MeshFormat,
    options: &ReadOptions,
) -> Result<LoadedMesh, FileError> {
    match format {
        MeshFormat::Stl => stl::read(from, length, options),
        MeshFormat::Obj => obj::read(from, options),
        MeshFormat::Ply => ply::read(from, length, options),
        MeshFormat::Off => off::read(from, length, options),
        MeshFormat::ThreeMf => threemf::read(from, length, options),
        MeshFormat::Gltf | MeshFormat::Glb => gltf::read(from, length, folder, options),
    }
}
