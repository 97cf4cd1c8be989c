//! Writing solids and models to files in the format of their endings.

use std::path::Path;

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use rayweave::formats::{self, Format, WriteError, WriteOptions};
use rayweave::scene::{Document, Scene};
use rayweave::{Classified, ErrorKind};

use crate::error::bad_value;

/// The format of this name.
pub fn format_of(name: &str) -> PyResult<Format> {
    let reason = || bad_value(format!("unknown format '{name}': it can be {}.", Format::NAMES.join(", ")));
    Format::from_name(name).ok_or_else(reason)
}

/// The format of the ending of a file; native without an ending.
fn format_of_path(path: &Path) -> PyResult<Format> {
    if path.extension().is_none() {
        return Ok(Format::Native);
    }
    Format::from_path(path).ok_or_else(|| {
        let formats = Format::NAMES.into_iter().filter_map(Format::from_name);
        let endings: Vec<String> =
            formats.flat_map(Format::extensions).map(|ending| format!(".{ending}")).collect();
        let (path, endings) = (path.display(), endings.join(", "));
        bad_value(format!(
            "cannot write {path}: the ending names no format of models. The endings are {endings}; format=... names a format."
        ))
    })
}

/// Writes a scene to a file; returns the losses.
pub fn save_scene(
    py: Python<'_>,
    scene: &Scene,
    stated: Option<&Document>,
    path: &Path,
    format: Option<&str>,
    options: WriteOptions,
) -> PyResult<Vec<String>> {
    let format = format.map_or_else(|| format_of_path(path), format_of)?;
    let saved = py.detach(|| formats::save(scene, stated, path, Some(format), &options));
    let remarks = saved.map_err(|error| match error.kind() {
        _ if matches!(error, WriteError::Unsound { .. }) => bad_value(error),
        ErrorKind::Output => PyOSError::new_err(error.to_string()),
        _ => bad_value(error),
    })?;
    Ok(remarks.iter().map(ToString::to_string).collect())
}
