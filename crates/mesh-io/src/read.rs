//! Reading mesh files: dispatch by format.

use crate::{FileError, LoadedMesh, Location, MeshFormat, ReadOptions, gltf, obj, off, ply, stl, threemf};
use rayweave_error::Message;
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
    mut from: impl BufRead + Seek,
    mut length: u64,
    folder: Option<(&Path, &AllowedFiles)>,
    format: MeshFormat,
    options: &ReadOptions,
) -> Result<LoadedMesh, FileError> {
    if !matches!(format, MeshFormat::ThreeMf | MeshFormat::Glb) {
        length -= skip_mark(&mut from, format)?;
    }
    match format {
        MeshFormat::Stl => stl::read(from, length, options),
        MeshFormat::Obj => obj::read(from, options),
        MeshFormat::Ply => ply::read(from, length, options),
        MeshFormat::Off => off::read(from, length, options),
        MeshFormat::ThreeMf => threemf::read(from, length, options),
        MeshFormat::Gltf | MeshFormat::Glb => gltf::read(from, length, folder, options),
    }
}

/// Skips the byte order mark of a UTF-8 text and returns its length; rejects UTF-16, with or without a mark. The first bytes of a
/// binary STL file are arbitrary, so that a mark counts only in front of the first word of a text.
fn skip_mark(from: &mut impl BufRead, format: MeshFormat) -> Result<u64, FileError> {
    const MARK: &[u8] = b"\xef\xbb\xbf";
    let start = from.fill_buf()?;
    let is_letter = |byte: &u8| byte.is_ascii_graphic();
    let is_utf16 = match start {
        [0xff, 0xfe, letter, 0, ..] | [0xfe, 0xff, 0, letter, ..] => is_letter(letter),
        // a space may follow the first letter
        [a, 0, b, 0, ..] | [0, a, 0, b, ..] => is_letter(a) && (is_letter(b) || b.is_ascii_whitespace()),
        _ => false,
    };
    if is_utf16 {
        let message = Message::new("the text is UTF-16", "text files of meshes are read as UTF-8");
        let (location, message) = (Location::Byte(0), message.suggest("Save it as UTF-8."));
        return Err(FileError::Syntax { location, message });
    }
    let text = start.strip_prefix(MARK).map(<[u8]>::trim_ascii_start);
    let is_binary = |text: &[u8]| {
        format == MeshFormat::Stl && !text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
    };
    let length = if text.is_some_and(|text| !is_binary(text)) { MARK.len() } else { 0 };
    from.consume(length);
    Ok(length as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshWriteOptions;

    /// Files of a tetrahedron in each text format.
    fn texts() -> Vec<(MeshFormat, String)> {
        let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let mesh = rayweave_mesh::Mesh::new(points.map(Into::into).to_vec(), triangles).unwrap();
        let text = |format| {
            let options = MeshWriteOptions { text: true, ..MeshWriteOptions::default() };
            let mut bytes = Vec::new();
            crate::write_objects(&[("a", &mesh)], format, options, &mut bytes).unwrap();
            (format, String::from_utf8(bytes).unwrap())
        };
        let formats = [MeshFormat::Stl, MeshFormat::Obj, MeshFormat::Ply, MeshFormat::Off, MeshFormat::Gltf];
        formats.map(text).to_vec()
    }

    fn read(format: MeshFormat, bytes: &[u8]) -> Result<String, String> {
        let loaded = read_bytes(bytes, format, &ReadOptions::default());
        loaded.map(|loaded| format!("{loaded:?}")).map_err(|error| error.to_string())
    }

    #[test]
    fn encodings_of_text_files() {
        for (format, text) in texts() {
            let expected = read(format, text.as_bytes()).unwrap();
            let same =
                |text: &str| assert_eq!(read(format, text.as_bytes()), Ok(expected.clone()), "{format:?}");
            same(&text.replace('\n', "\r\n"));
            same(&format!("\u{feff}{text}"));
            let units = |first: &[u16], swapped: fn(u16) -> [u8; 2]| -> Vec<u8> {
                first.iter().copied().chain(text.encode_utf16()).flat_map(swapped).collect()
            };
            for mark in [vec![], vec![0xfeff]] {
                for bytes in [units(&mark, u16::to_le_bytes), units(&mark, u16::to_be_bytes)] {
                    let error = read(format, &bytes).unwrap_err();
                    assert!(error.starts_with("byte 0: the text is UTF-16"), "{format:?}: {error}");
                }
            }
        }
    }

    /// Any bytes may precede the number of triangles of a binary file.
    #[test]
    fn binary_files_may_begin_with_a_mark() {
        let mut bytes = b"\xef\xbb\xbf".to_vec();
        bytes.resize(80, b' ');
        bytes.extend(1u32.to_le_bytes());
        let corners: [f32; 12] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        bytes.extend(corners.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0, 0]);
        assert!(read(MeshFormat::Stl, &bytes).is_ok());
    }
}
