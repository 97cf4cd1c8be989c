//! Numbers of prescriptions as tables and arrays.

use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::lens::paraxial::{FirstOrder, Pupil, Seidel};
use rayweave::optics::Beam;

use crate::optics::arrivals::Of;

/// The Seidel sums of every surface, as columns.
pub fn seidel_table<'py>(py: Python<'py>, sums: &[Seidel]) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    let columns: [(&str, Of<Seidel>); 7] = [
        ("spherical", |sum| sum.spherical),
        ("coma", |sum| sum.coma),
        ("astigmatism", |sum| sum.astigmatism),
        ("petzval", |sum| sum.petzval),
        ("distortion", |sum| sum.distortion),
        ("axial_colour", |sum| sum.axial_colour),
        ("lateral_colour", |sum| sum.lateral_colour),
    ];
    for (name, value) in columns {
        table.set_item(name, PyArray1::from_vec(py, sums.iter().map(value).collect()))?;
    }
    Ok(table)
}

/// First-order data by name.
pub fn first_order_table<'py>(py: Python<'py>, data: &FirstOrder) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    let numbers = [
        ("focal_length", data.focal_length),
        ("back_focal_distance", data.back_focal_distance),
        ("front_focal_distance", data.front_focal_distance),
        ("back_principal_plane", data.back_principal_plane),
        ("front_principal_plane", data.front_principal_plane),
        ("stop_semi_diameter", data.stop_semi_diameter),
        ("f_number", data.f_number),
        ("magnification", data.magnification),
        ("angular_magnification", data.angular_magnification),
        ("image_distance", data.image_distance),
        ("petzval_sum", data.petzval_sum),
    ];
    for (name, number) in numbers {
        table.set_item(name, number)?;
    }
    let pupil = |pupil: &Pupil| (pupil.position, pupil.diameter);
    table.set_item("entrance_pupil", pupil(&data.entrance_pupil))?;
    table.set_item("exit_pupil", pupil(&data.exit_pupil))?;
    let matrix = data.matrix;
    table.set_item("matrix", [matrix.a, matrix.b, matrix.c, matrix.d])?;
    Ok(table)
}

/// Origins and directions of rays, both (N, 3).
pub fn ray_arrays<'py>(
    py: Python<'py>,
    beam: &Beam,
) -> (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>) {
    let shape = (beam.len(), 3);
    let origins = Array2::from_shape_fn(shape, |(row, k)| beam.get(row).ray.origin[k]);
    let directions = Array2::from_shape_fn(shape, |(row, k)| beam.get(row).ray.direction[k]);
    (PyArray2::from_owned_array(py, origins), PyArray2::from_owned_array(py, directions))
}
