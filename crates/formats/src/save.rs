//! Writing scenes to model files.

use crate::{Format, Remark, WriteError, WriteOptions, write};
use rayweave_scene::{Document, Scene};
use rayweave_table::{AtomicFile, TableError};
use std::io::Write;
use std::path::Path;

/// Writes a scene to a file, which appears when it is complete, and returns the losses. Without a format, the extension of
/// the path selects one; an unknown extension means the native format. `stated` is the document of the scene, if there is one.
///
/// ```
/// use rayweave_formats::{Options, WriteOptions, load, save};
///
/// let (document, scene) = rayweave_scene::parse("rayweave = 1\n[solid.ball]\nsphere = { radius = 2 }")?;
/// let path = std::env::temp_dir().join(format!("rayweave-save-{}.csg", std::process::id()));
/// save(&scene, Some(&document), &path, None, &WriteOptions::default())?;
///
/// let ball = load(&path, None, &[], &Options::default())?;
/// assert!(ball.report.is_empty() && ball.scene.regions.len() == 1);
/// # std::fs::remove_file(&path).ok();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`WriteError`].
pub fn save(
    scene: &Scene,
    stated: Option<&Document>,
    path: &Path,
    format: Option<Format>,
    options: &WriteOptions,
) -> Result<Vec<Remark>, WriteError> {
    let format = format.or_else(|| Format::from_path(path)).unwrap_or(Format::Native);
    let written = write(scene, stated, format, options)?;
    let mut file = AtomicFile::create(path)?;
    let failed = |error| TableError::Io { action: "write", path: path.display().to_string(), error };
    file.write_all(&written.bytes).map_err(failed)?;
    file.finish()?;
    Ok(written.remarks)
}
