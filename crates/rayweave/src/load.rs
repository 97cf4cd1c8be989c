//! Reading a model file with the default options.

use crate::Error;
use rayweave_formats::{LossKind, Options};
use rayweave_scene::{Diagnostic, Diagnostics, Scene, Source};
use std::path::Path;
use std::sync::Arc;

/// Reads a model file in any of the [formats](crate::formats::Format), which the extension selects. The warnings of the scene list
/// what was approximated. [`formats::load`](crate::formats::load) also takes the format, values of parameters and options, and reads
/// models of which a part is missing.
///
/// # Errors
///
/// All problems of the file at once ([`Error::is_model_file`]). A model of which a part is missing, such as an imported file, is an
/// error: its answers would be wrong.
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
    let path = path.as_ref();
    let options = Options { scene_only: true, ..Options::default() };
    let imported = rayweave_formats::load(path, None, &[], &options)?;
    let missing = imported.report.iter().filter(|loss| loss.kind == LossKind::Refused);
    let missing: Vec<Diagnostic> = missing.map(|loss| loss.first.clone()).collect();
    if missing.is_empty() {
        return Ok(imported.scene);
    }
    let source = Arc::new(Source::new(Some(path.to_owned()), String::new()));
    let problem =
        Diagnostic::error("a part of the geometry is missing").why("answers would be wrong").suggest(Some(
            "Correct the model, or read it with `formats::load`, whose report lists what is missing"
                .to_owned(),
        ));
    Err(Diagnostics::new(std::iter::once(problem.in_file(&source)).chain(missing).collect()).into())
}
