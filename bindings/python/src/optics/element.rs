//! Elements of optical systems: conversion from Python, and elements of model files.

use numpy::PyArray2;
use pyo3::prelude::*;
use rayweave::Affine;
use rayweave::optics::{Element, Finish, Material};

use crate::error::bad_value;
use crate::optics::component::PySheet;
use crate::optics::medium::Substance;
use crate::optics::spec::{Spec, unknown};
use crate::solid::PySolid;
use crate::vectors::{matrix, matrix_rows};

/// An element as given by Python: a solid with its material ("transparent", "opaque" or "metal"),
/// or a sheet.
#[derive(FromPyObject)]
pub enum Part<'py> {
    Solid(String, PyRef<'py, PySolid>, String, Option<Substance<'py>>, Spec, Vec<(String, Spec)>),
    Sheet(String, PyRef<'py, PySheet>, Spec),
    /// An element of a model file.
    Read(String, PyRef<'py, PyElement>),
}

impl Part<'_> {
    /// The element.
    pub fn element(&self) -> PyResult<Element> {
        match self {
            Part::Read(name, element) => Ok(element.0.clone().named(name)),
            Part::Sheet(name, sheet, action) => Ok(Element::sheet(name, sheet.0.clone(), action.action()?)),
            Part::Solid(name, solid, kind, substance, finish, faces) => {
                let medium = substance.as_ref().map(Substance::medium).transpose()?;
                let material = match (kind.as_str(), medium) {
                    ("opaque", None) => Material::Opaque,
                    ("transparent", Some(medium)) => Material::Transparent(medium),
                    ("metal", Some(medium)) => Material::Metal(medium),
                    (kind, _) => return Err(unknown("material", kind, &[])),
                };
                let element = Element::new(name, solid.solid().clone(), material).finish(finish.finish()?);
                faces
                    .iter()
                    .try_fold(element, |element, (face, finish)| Ok(element.face(face, finish.finish()?)))
            }
        }
    }
}

/// A name, a solid or sheet, the name of a material, and the frame of a sheet.
type Parts<'py> = (String, Bound<'py, PyAny>, String, Bound<'py, PyArray2<f64>>);

/// An element of a model file: see `rayweave.optics.Element`.
#[pyclass(frozen, module = "rayweave.optics", name = "ReadElement")]
pub struct PyElement(pub Element);

#[pymethods]
impl PyElement {
    /// Its name, its solid or sheet, the name of its material, and the frame of a sheet.
    #[pyo3(signature = () -> "tuple[str, Solid | Sheet, str, NDArray[np.float64]]")]
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        let name = self.0.name().to_owned();
        let frame = self.0.as_sheet().map_or(Affine::IDENTITY, |sheet| sheet.frame);
        let frame = matrix_rows(py, &frame)?;
        if let Some((solid, material)) = self.0.solid() {
            let solid = PySolid::from_solid(solid.clone()).into_pyobject(py)?.into_any();
            return Ok((name, solid, material_name(material), frame));
        }
        let sheet = self.0.as_sheet().ok_or_else(|| bad_value("an element is a solid or a sheet"))?;
        Ok((name, PySheet(sheet.clone()).into_pyobject(py)?.into_any(), String::new(), frame))
    }

    /// The element moved by an affine map, a 4 x 4 matrix.
    #[pyo3(signature = (world_from_local: "ArrayLike"))]
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
