//! Reader of the `[optics]` tables of model files.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::optics::Branches;
use rayweave::optics::file::{OpticalScene, optics_of};
use rayweave::scene::{Diagnostics, Document, Scene, load_allowing, parse_allowing};

use crate::error::{bad_value, require_file};
use crate::interrupt::abandonable;
use crate::model::overrides;
use crate::optics::element::PyElement;
use crate::optics::source::PySource;
use crate::optics::system::PySystem;

/// A system, its elements, its sources, its settings, the unit of its lengths, and the warnings.
type Loaded<'py> = (PySystem, Vec<PyElement>, Vec<PySource>, Bound<'py, PyDict>, &'static str, Vec<String>);

/// Reads the `[optics]` tables of a model file.
#[pyfunction]
#[pyo3(signature = (
    path, parameters: "dict[str, float | str] | None" = None, *, allow = Vec::new(), strict = false
) -> "tuple[CompiledSystem, list[ReadElement], list[LightSource], dict[str, Any], str, list[str]]")]
pub fn load_optics<'py>(
    py: Python<'py>,
    path: PathBuf,
    parameters: Option<&Bound<'py, PyDict>>,
    allow: Vec<PathBuf>,
    strict: bool,
) -> PyResult<Loaded<'py>> {
    require_file(&path)?;
    let overrides = overrides(parameters)?;
    read(py, strict, move || load_allowing(&path, &overrides, &allow))
}

/// Reads the `[optics]` tables of the text of a model file.
#[pyfunction]
#[pyo3(signature = (
    text, parameters: "dict[str, float | str] | None" = None, *, allow = Vec::new(), strict = false
) -> "tuple[CompiledSystem, list[ReadElement], list[LightSource], dict[str, Any], str, list[str]]")]
pub fn loads_optics<'py>(
    py: Python<'py>,
    text: &str,
    parameters: Option<&Bound<'py, PyDict>>,
    allow: Vec<PathBuf>,
    strict: bool,
) -> PyResult<Loaded<'py>> {
    let (text, overrides) = (text.to_owned(), overrides(parameters)?);
    read(py, strict, move || parse_allowing(&text, &overrides, &allow))
}

fn read<'py>(
    py: Python<'py>,
    strict: bool,
    model: impl FnOnce() -> Result<(Document, Scene), Diagnostics> + Send + 'static,
) -> PyResult<Loaded<'py>> {
    let (optics, system, unit, warnings) = abandonable(py, move || {
        let (document, scene) = model().map_err(bad_value)?;
        if strict && !scene.warnings.is_empty() {
            return Err(bad_value(scene.warnings.into_errors()));
        }
        let optics = optics_of(&document, &scene).map_err(bad_value)?;
        let system = optics.assembly.compile().map_err(bad_value)?;
        let rendered =
            |warning: &rayweave::scene::Diagnostic| Diagnostics::from(warning.clone()).render(false);
        let warnings: Vec<String> = scene.warnings.iter().map(rendered).collect();
        Ok::<_, PyErr>((optics, system, scene.unit.symbol(), warnings))
    })??;
    let elements = optics.assembly.elements().iter().map(|element| PyElement(element.clone())).collect();
    let sources = optics.sources.sources().iter().map(|source| PySource(source.clone())).collect();
    let settings = settings(py, &optics)?;
    Ok((PySystem { system: Arc::new(system) }, elements, sources, settings, unit, warnings))
}

/// The settings under the argument names of `System.trace`.
fn settings<'py>(py: Python<'py>, optics: &OpticalScene) -> PyResult<Bound<'py, PyDict>> {
    let branches = match optics.settings.branches {
        Branches::Ideal => "ideal",
        Branches::Both => "both",
        Branches::Random => "random",
    };
    let table = PyDict::new(py);
    table.set_item("branches", branches)?;
    table.set_item("polarised", optics.settings.polarised)?;
    table.set_item("generation_limit", optics.settings.generation_limit)?;
    table.set_item("threshold", optics.settings.threshold)?;
    table.set_item("seed", optics.settings.seed)?;
    Ok(table)
}
