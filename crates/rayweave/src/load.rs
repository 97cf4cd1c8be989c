//! Reading a model file with the default options.

use crate::Error;
use rayweave_formats::Options;
use rayweave_scene::Scene;
use std::path::Path;

/// Reads a model file in any of the [formats](crate::formats::Format), which the extension selects. The warnings of the scene list
/// what was lost. [`formats::load`](crate::formats::load) also takes the format, values of parameters and options.
///
/// # Errors
///
/// All problems of the file at once ([`Error::is_model_file`]).
///
/// ```
/// use rayweave::Compiled;
///
/// # std::env::set_current_dir("../..").unwrap();
/// let scene = rayweave::load("models/bracket.toml")?;
/// assert!(!scene.regions.is_empty());
/// let bounds = Compiled::new(&scene)?.program.bounds();
/// assert!(bounds.is_finite());
/// assert!(rayweave::load("picture.png").unwrap_err().to_string().contains("models are read from .toml"));
/// # Ok::<(), rayweave::Error>(())
/// ```
pub fn load(path: impl AsRef<Path>) -> Result<Scene, Error> {
    let options = Options { scene_only: true, ..Options::default() };
    Ok(rayweave_formats::load(path, None, &[], &options)?.scene)
}
