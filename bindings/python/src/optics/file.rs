//! The `[optics]` tables of model files.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::Affine;
use rayweave::optics::file::{OpticalScene, optics_of};
use rayweave::optics::{Branches, Element, Finish, Material};
use rayweave::scene::{Diagnostics, Document, Scene, load, parse_with};

use crate::error::bad_value;
use crate::model::overrides;
use crate::optics::component::PySheet;
use crate::optics::source::PySource;
use crate::optics::system::{PySystem, Spec};
use crate::solid::PySolid;
use crate::vectors::matrix;

/// A name, a solid or sheet, the name of a material, and the frame of a sheet.
type Parts<'py> = (String, Bound<'py, PyAny>, String, Bound<'py, PyArray2<f64>>);

/// An element as a model file says it: see `rayweave.optics.Element`.
#[pyclass(frozen, module = "rayweave.optics", name = "ReadElement")]
pub struct PyElement(pub Element);

#[pymethods]
impl PyElement {
    /// Its name, its solid or sheet, the name of its material, and the frame of a sheet.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        let name = self.0.name().to_owned();
        let frame = self.0.as_sheet().map_or(Affine::IDENTITY, |sheet| sheet.frame);
        let frame = rows_of(py, &frame)?;
        if let Some((solid, material)) = self.0.solid() {
            let solid = PySolid::from_solid(solid.clone()).into_pyobject(py)?.into_any();
            return Ok((name, solid, material_name(material), frame));
        }
        let sheet = self.0.as_sheet().ok_or_else(|| bad_value("an element is a solid or a sheet"))?;
        Ok((name, PySheet(sheet.clone()).into_pyobject(py)?.into_any(), String::new(), frame))
    }

    /// The element moved by an affine map, a 4 x 4 matrix.
    fn apply(&self, world_from_local: &Bound<'_, PyAny>) -> PyResult<Self> {
        let map = matrix(world_from_local, "matrix")?;
        self.0.clone().apply(&map).map(PyElement).map_err(bad_value)
    }

    /// The element with a finish, on all faces or on those of a name.
    #[pyo3(signature = (finish, face=None))]
    fn with_finish(&self, finish: Spec, face: Option<&str>) -> PyResult<Self> {
        let finish: Finish = finish.finish()?;
        let element = self.0.clone();
        Ok(PyElement(match face {
            Some(face) => element.face(face, finish),
            None => element.finish(finish),
        }))
    }
}

fn material_name(material: &Material) -> String {
    match material {
        Material::Transparent(medium) | Material::Metal(medium) => medium.name().to_owned(),
        Material::Opaque => "absorber".to_owned(),
    }
}

/// A map as a 4 x 4 matrix.
fn rows_of<'py>(py: Python<'py>, map: &Affine) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut flat = [0.0; 16];
    flat[15] = 1.0;
    for row in 0..3 {
        for column in 0..3 {
            flat[4 * row + column] = map.linear.col(column)[row];
        }
        flat[4 * row + 3] = map.translation[row];
    }
    let array = numpy::ndarray::Array2::from_shape_vec((4, 4), flat.to_vec()).map_err(bad_value)?;
    Ok(PyArray2::from_owned_array(py, array))
}

/// A system, its elements, its sources, its settings and the unit of its lengths.
type Loaded<'py> = (PySystem, Vec<PyElement>, Vec<PySource>, Bound<'py, PyDict>, &'static str, Vec<String>);

/// Reads the `[optics]` tables of a model file.
#[pyfunction]
#[pyo3(signature = (path, parameters=None))]
pub fn load_optics<'py>(
    py: Python<'py>,
    path: PathBuf,
    parameters: Option<&Bound<'py, PyDict>>,
) -> PyResult<Loaded<'py>> {
    let overrides = overrides(parameters)?;
    read(py, move || load(&path, &overrides))
}

/// Reads the `[optics]` tables of the text of a model file.
#[pyfunction]
#[pyo3(signature = (text, parameters=None))]
pub fn loads_optics<'py>(
    py: Python<'py>,
    text: &str,
    parameters: Option<&Bound<'py, PyDict>>,
) -> PyResult<Loaded<'py>> {
    let overrides = overrides(parameters)?;
    read(py, move || parse_with(text, &overrides))
}

fn read<'py>(
    py: Python<'py>,
    model: impl Send + FnOnce() -> Result<(Document, Scene), Diagnostics>,
) -> PyResult<Loaded<'py>> {
    let (optics, system, unit, warnings) = py.detach(|| {
        let (document, scene) = model().map_err(bad_value)?;
        let optics = optics_of(&document, &scene).map_err(bad_value)?;
        let system = optics.assembly.compile().map_err(bad_value)?;
        let told = |warning: &rayweave::scene::Diagnostic| Diagnostics::from(warning.clone()).render(false);
        let warnings: Vec<String> = scene.warnings.iter().map(told).collect();
        Ok::<_, PyErr>((optics, system, scene.unit.symbol(), warnings))
    })?;
    let elements = optics.assembly.elements().iter().map(|element| PyElement(element.clone())).collect();
    let sources = optics.sources.sources().iter().map(|source| PySource(source.clone())).collect();
    let settings = settings(py, &optics)?;
    Ok((PySystem { system: Arc::new(system) }, elements, sources, settings, unit, warnings))
}

/// The settings by the names that `System.trace` has for them.
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
