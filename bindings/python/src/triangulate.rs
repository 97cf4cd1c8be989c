//! Triangle meshes of solids and models.

use numpy::PyArray2;
use numpy::ndarray::Array2;
use pyo3::prelude::*;
use rayweave::formats::{WriteOptions, triangulate};

use crate::error::bad_value;
use crate::subject::scene;

/// Name, vertices (V, 3) and triangles (T, 3) of a region.
type Part<'py> = (String, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// The regions of a solid or a model as triangle meshes: see `rayweave.Mesh`.
#[pyfunction]
#[pyo3(signature = (subject: "Subject", tolerance))]
pub fn mesh_parts<'py>(subject: &Bound<'py, PyAny>, tolerance: Option<f64>) -> PyResult<Vec<Part<'py>>> {
    let (py, scene) = (subject.py(), scene(subject)?);
    let options = WriteOptions { tolerance, ..WriteOptions::default() };
    let parts = py.detach(|| triangulate(&scene, &options)).map_err(bad_value)?;
    let part = |(name, mesh): (String, rayweave::mesh::Mesh)| {
        let (vertices, triangles) = mesh.into_parts();
        let vertices: Vec<f64> = vertices.iter().flat_map(|vertex| vertex.to_array()).collect();
        let vertices = Array2::from_shape_vec((vertices.len() / 3, 3), vertices).map_err(bad_value)?;
        let triangles = triangles.into_flattened();
        let triangles = Array2::from_shape_vec((triangles.len() / 3, 3), triangles).map_err(bad_value)?;
        let (vertices, triangles) =
            (PyArray2::from_owned_array(py, vertices), PyArray2::from_owned_array(py, triangles));
        Ok((name, vertices, triangles))
    };
    parts.into_iter().map(part).collect()
}
