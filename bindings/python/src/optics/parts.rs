//! Conversion of the parts of systems to Python, in the form of the arguments of
//! `rayweave.optics.Element`.

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use rayweave::optics::{Assembly, Body, Element, Material, Medium};

use crate::error::bad_value;
use crate::optics::component::PySheet;
use crate::optics::glass::PyGlass;
use crate::optics::spec::{SpecOut, spec_of_action, spec_of_finish};
use crate::solid::PySolid;

/// A name, a solid or sheet, its material, its finish or action, and the finishes of single faces.
type Part<'py> = (String, Bound<'py, PyAny>, Bound<'py, PyAny>, SpecOut, Vec<(String, SpecOut)>);

/// All parts of an assembly.
pub fn parts<'py>(py: Python<'py>, assembly: &Assembly) -> PyResult<Vec<Part<'py>>> {
    assembly.elements().iter().map(|element| part(py, element)).collect()
}

fn part<'py>(py: Python<'py>, element: &Element) -> PyResult<Part<'py>> {
    let name = element.name().to_owned();
    match element.body() {
        Body::Sheet { sheet, action } => {
            let body = PySheet(sheet.clone()).into_bound_py_any(py)?;
            Ok((name, body, "absorber".into_bound_py_any(py)?, spec_of_action(action), Vec::new()))
        }
        Body::Solid { solid, material, finish, faces } => {
            let body = PySolid::from_solid(solid.clone()).into_bound_py_any(py)?;
            let own = faces.iter().map(|(face, finish)| (face.clone(), spec_of_finish(finish)));
            Ok((name, body, substance(py, material)?, spec_of_finish(finish), own.collect()))
        }
    }
}

fn substance<'py>(py: Python<'py>, material: &Material) -> PyResult<Bound<'py, PyAny>> {
    match material {
        Material::Opaque => "absorber".into_bound_py_any(py),
        Material::Transparent(medium) | Material::Metal(medium) => medium_object(py, medium),
    }
}

/// A glass, or a constant index: complex if it absorbs.
fn medium_object<'py>(py: Python<'py>, medium: &Medium) -> PyResult<Bound<'py, PyAny>> {
    if let Some(glass) = medium.as_glass() {
        return PyGlass(glass.clone()).into_bound_py_any(py);
    }
    match medium.as_constant() {
        Some(index) if index.im == 0.0 => index.re.into_bound_py_any(py),
        Some(index) => Ok(pyo3::types::PyComplex::from_doubles(py, index.re, index.im).into_any()),
        None => Err(bad_value(format!("{}: a law of dispersion has no name in Python", medium.name()))),
    }
}
