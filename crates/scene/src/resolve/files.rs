//! Files that a model refers to: placements in NPY files, and meshes.

use super::context::Context;
use crate::diagnostic::Diagnostic;
use crate::source::Spanned;
use rayweave_math::{Affine, Vec3};
use rayweave_mesh::{MeshError, Polyhedron};
use rayweave_mesh_io::{FileError, ReadOptions, read_allowed};
use rayweave_model::memory;
use rayweave_shape::primitive::Mesh;
use rayweave_table::{AllowedFiles, NpyArray, NpyArrayError, RefusedFile};
use std::io::{BufReader, Read};
use std::path::Path;

/// The maximum number of values in a file of placements.
const MAX_NUMBERS: u64 = 1 << 26;

/// Reads the maps of a file in the folder of the model file: float64, (N, 3) translations or (N, 4, 4) matrices.
pub(super) fn transforms(context: &mut Context, file: &Spanned<String>) -> Option<Vec<Affine>> {
    let files = context.document.files();
    let path = files.folder().join(&file.value);
    let is_new = context.is_new_file(&path);
    if !is_new && !context.has_copies_left() {
        return None;
    }
    match read(&files, &path).and_then(|(numbers, shape)| to_maps(&numbers, &shape)) {
        Ok(maps) => (is_new || context.count_copies(maps.len() as u64, file.span)).then_some(maps),
        Err(reason) => {
            let problem = Diagnostic::error(format!("the placements in `{}` cannot be used", file.value));
            context.push(problem.why(reason), file.span);
            None
        }
    }
}

/// The longest text of a drawing, in bytes.
const MAX_TEXT: u64 = 64 << 20;

/// Reads a text file in the folder of the model file. The error is a clause.
pub(super) fn text(context: &Context, name: &str) -> Result<String, String> {
    let files = context.document.files();
    let opened = files.open(&files.folder().join(name)).map_err(|refused| match refused {
        RefusedFile::Io(error) => reason(&error),
        other => other.to_string(),
    })?;
    let mut text = String::new();
    match opened.take(MAX_TEXT + 1).read_to_string(&mut text) {
        Ok(length) if length as u64 > MAX_TEXT => Err(format!("it is larger than {} MiB", MAX_TEXT >> 20)),
        Ok(_) => Ok(text),
        Err(error) if error.kind() == std::io::ErrorKind::InvalidData => Err("it is not text".to_owned()),
        Err(error) => Err(reason(&error)),
    }
}

fn read(files: &AllowedFiles, path: &Path) -> Result<(Vec<f64>, Vec<u64>), String> {
    let opened = files.open(path).map_err(|refused| match refused {
        RefusedFile::Io(error) => reason(&error),
        other => other.to_string(),
    })?;
    let array = NpyArray::read(&mut BufReader::new(opened), MAX_NUMBERS).map_err(|error| match error {
        NpyArrayError::Io(error) => reason(&error),
        other => other.to_string(),
    })?;
    Ok((array.numbers, array.shape))
}

/// The solid of a mesh in a file in the folder of the model file. Defects of the mesh are reported
/// as warnings.
pub(super) fn mesh(context: &mut Context, file: &Spanned<String>, repair: bool) -> Option<Mesh> {
    let files = context.document.files();
    let limits = memory::available().map_or_else(ReadOptions::default, ReadOptions::for_memory);
    let found = match read_allowed(&files.folder().join(&file.value), None, &limits, &files) {
        Ok(found) => found,
        Err(error) => {
            let why = match &error {
                FileError::Io(error) => reason(error),
                error => error.to_string(),
            };
            let problem = Diagnostic::error(format!("the mesh in `{}` cannot be used", file.value));
            context.push(problem.why(why), file.span);
            return None;
        }
    };
    for warning in found.warnings {
        context.push(Diagnostic::warning(format!("`{}`: {warning}", file.value)), file.span);
    }
    if repair && let Some((mended, done)) = found.mesh.auto_repaired() {
        for (repair, _) in done.summary() {
            let repair = format!("the mesh in `{}` was repaired: {repair}", file.value);
            context.push(Diagnostic::warning(repair), file.span);
        }
        return diagnosed(context, file, &mended, true);
    }
    diagnosed(context, file, &found.mesh, repair)
}

fn diagnosed(
    context: &mut Context,
    file: &Spanned<String>,
    mesh: &rayweave_mesh::Mesh,
    repair: bool,
) -> Option<Mesh> {
    let diagnosis = mesh.diagnose();
    match Polyhedron::closed(mesh, &diagnosis) {
        Ok(solid) => {
            if !diagnosis.is_sound() {
                let problem = format!("the mesh in `{}` may not be as intended: {diagnosis}", file.value);
                let why =
                    "a point is inside if a line to it from infinity crosses the mesh an odd number of times";
                context.push(Diagnostic::warning(problem).why(why), file.span);
            }
            Some(solid.into())
        }
        Err(error) => {
            let problem = Diagnostic::error(format!("the mesh in `{}` is not a solid", file.value));
            let (reason, advice) = error.parts();
            let advice = match !repair && error != MeshError::Flat {
                true => "try `repair = true` in addition to `file`".to_owned(),
                false => advice,
            };
            let problem = problem.why(format!("{reason} ({diagnosis})")).suggest(Some(advice));
            context.push(problem, file.span);
            None
        }
    }
}

/// Describes an error of the operating system in words that are the same on all systems.
pub fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
        std::io::ErrorKind::PermissionDenied => "reading it is not permitted".to_owned(),
        std::io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        std::io::ErrorKind::UnexpectedEof => "it ends too early".to_owned(),
        _ => error.to_string(),
    }
}

fn to_maps(numbers: &[f64], shape: &[u64]) -> Result<Vec<Affine>, String> {
    let maps: Vec<Affine> = match shape {
        [_, 3] => numbers.chunks_exact(3).map(|p| Affine::translate(Vec3::new(p[0], p[1], p[2]))).collect(),
        [_, 4, 4] => {
            let maps = numbers.chunks_exact(16).enumerate().map(|(index, entries)| matrix(index, entries));
            maps.collect::<Result<_, _>>()?
        }
        _ => return Err(format!("its shape is {shape:?}, but it must be (N, 3) or (N, 4, 4)")),
    };
    for (index, map) in maps.iter().enumerate() {
        map.inverse().map_err(|error| format!("transform {index} of the file: {error}"))?;
    }
    Ok(maps)
}

fn matrix(index: usize, entries: &[f64]) -> Result<Affine, String> {
    let row = |k: usize| [entries[4 * k], entries[4 * k + 1], entries[4 * k + 2], entries[4 * k + 3]];
    let map = Affine::from_rows(&[row(0), row(1), row(2), row(3)]);
    map.ok_or_else(|| format!("the last row of matrix {index} is not 0, 0, 0, 1"))
}
