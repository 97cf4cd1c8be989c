//! Models into files of any format.

use crate::Error;
use rayweave_formats::{Format, Remark, WriteOptions, write};
use rayweave_scene::{Document, Scene};
use rayweave_table::{AtomicFile, TableError};
use std::io::Write;
use std::path::Path;

/// Writes a scene to a file, which appears when it is complete, and tells what is not in it as the scene has it. Without a format
/// it is that of the file's name, or the native one where the name tells none. `stated` is the document that the scene comes
/// from, if there is one.
///
/// ```
/// use rayweave::{convert, formats, scene};
///
/// let (document, scene) = scene::parse("rayweave = 1\n[solid.ball]\nsphere = { radius = 2 }")?;
/// let path = std::env::temp_dir().join(format!("rayweave-convert-{}.csg", std::process::id()));
/// convert::save(&scene, Some(&document), &path, None, &formats::WriteOptions::default())?;
///
/// let ball = formats::load(&path, None, &[], &formats::Options::default())?;
/// assert!(ball.report.is_empty() && ball.scene.regions.len() == 1);
/// # std::fs::remove_file(&path).ok();
/// # Ok::<(), rayweave::Error>(())
/// ```
///
/// # Errors
///
/// [`crate::ErrorKind::Output`]; others as [`rayweave_formats::WriteError`] says them.
pub fn save(
    scene: &Scene,
    stated: Option<&Document>,
    path: &Path,
    format: Option<Format>,
    options: &WriteOptions,
) -> Result<Vec<Remark>, Error> {
    let format = format.or_else(|| Format::from_path(path)).unwrap_or(Format::Native);
    let written = write(scene, stated, format, options)?;
    let mut file = AtomicFile::create(path)?;
    let failed = |error| TableError::Io { action: "write", path: path.display().to_string(), error };
    file.write_all(&written.bytes).map_err(failed)?;
    file.finish()?;
    Ok(written.remarks)
}
