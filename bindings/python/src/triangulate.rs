//! Triangle meshes of solids and models.

use numpy::ndarray::Array2;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use rayweave::Vec3;
use rayweave::formats::{Format, MeshFile, Options, WriteOptions, triangulate};
use rayweave::mesh::Mesh;
use std::path::PathBuf;

use crate::error::{bad_value, require_file};
use crate::interrupt::abandonable;
use crate::model::unit_of;
use crate::save::format_of;
use crate::solid::PySolid;
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
    parts.into_iter().map(|part| as_part(py, part)).collect()
}

fn as_part<'py>(py: Python<'py>, (name, mesh): (String, Mesh)) -> PyResult<Part<'py>> {
    let (vertices, triangles) = mesh.into_parts();
    let vertices: Vec<f64> = vertices.iter().flat_map(|vertex| vertex.to_array()).collect();
    let vertices = Array2::from_shape_vec((vertices.len() / 3, 3), vertices).map_err(bad_value)?;
    let triangles = triangles.into_flattened();
    let triangles = Array2::from_shape_vec((triangles.len() / 3, 3), triangles).map_err(bad_value)?;
    Ok((name, PyArray2::from_owned_array(py, vertices), PyArray2::from_owned_array(py, triangles)))
}

/// The meshes of a file, closed or not: see `rayweave.load_mesh`.
#[pyfunction]
#[pyo3(signature = (path, format, unit, repair, allow))]
pub fn mesh_file_parts<'py>(
    py: Python<'py>,
    path: PathBuf,
    format: Option<&str>,
    unit: Option<&str>,
    repair: bool,
    allow: Vec<PathBuf>,
) -> PyResult<Vec<Part<'py>>> {
    require_file(&path)?;
    let format = format.map(format_of).transpose()?.or_else(|| Format::from_path(&path));
    let Some(Format::Mesh(kind)) = format else {
        let name = path.display();
        return Err(bad_value(format!(
            "{name} is no mesh: load_mesh reads .stl, .obj, .ply, .off, .3mf, .gltf and .glb. Use load for models."
        )));
    };
    let options = Options { unit: unit.map(unit_of).transpose()?, repair, allow, ..Options::default() };
    let file = abandonable(py, move || MeshFile::load(&path, kind, &options))?.map_err(bad_value)?;
    file.meshes.into_iter().map(|part| as_part(py, part)).collect()
}

/// The number of shells and of open edges, the exact volume (NaN if it is unknown), and a summary of all defects of a mesh.
#[pyfunction]
pub fn mesh_defects(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    triangles: PyReadonlyArray2<'_, u32>,
) -> PyResult<(usize, usize, f64, String, bool)> {
    let points =
        vertices.as_array().rows().into_iter().map(|row| Vec3::new(row[0], row[1], row[2])).collect();
    let corners = triangles.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
    let mesh = Mesh::new(points, corners).map_err(bad_value)?;
    let found = py.detach(|| mesh.diagnose());
    let volume = found.volume().unwrap_or(f64::NAN);
    Ok((found.components.len(), found.open_edges, volume, found.to_string(), found.is_sound()))
}

/// The exact volume of a single shape, possibly placed; None if the volume must be measured.
#[pyfunction]
pub fn exact_volume(py: Python<'_>, solid: &PySolid) -> Option<f64> {
    let solid = solid.solid().clone();
    py.detach(|| rayweave::measure::exact_volume(&solid))
}
