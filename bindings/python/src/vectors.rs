//! Conversion of vectors, points and matrices from and to Python.

use numpy::ndarray::{Array2, ArrayView1, Ix2};
use numpy::{PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayweave::math::{Affine, Vec3};

use crate::arrays::{double_array, list, room, shape_text};
use crate::error::{bad_type, bad_value, shown};

/// A vector of finite numbers.
pub fn vector(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec3> {
    let [x, y, z] = list(object, name)?
        .try_into()
        .map_err(|list: Vec<f64>| bad_value(format!("{name} has {} numbers: it must have 3.", list.len())))?;
    for (k, value) in [x, y, z].into_iter().enumerate() {
        if !value.is_finite() {
            return Err(bad_value(format!("{name}[{k}] is {value}: it must be finite.")));
        }
    }
    Ok(Vec3::new(x, y, z))
}

/// A vector of non-zero length.
pub fn direction(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec3> {
    let vector = vector(object, name)?;
    if vector == Vec3::ZERO {
        return Err(bad_value(format!("{name} has length 0: a direction must have a nonzero length.")));
    }
    Ok(vector)
}

/// A vector given by three arguments; `None` if there is only the first, which then is the vector.
pub fn components(
    x: &Bound<'_, PyAny>,
    y: Option<f64>,
    z: Option<f64>,
    function: &str,
) -> PyResult<Option<Vec3>> {
    let (y, z) = match (y, z) {
        (None, None) => return Ok(None),
        (Some(y), Some(z)) => (y, z),
        _ => {
            return Err(bad_type(format!(
                "{function} has two numbers: it needs a vector of three, or x, y and z."
            )));
        }
    };
    let x = x.extract::<f64>().map_err(|_| {
        bad_type(format!("x is {}: {function} needs a vector of three numbers, or x, y and z.", shown(x)))
    })?;
    Ok(Some(Vec3::new(finite(x, "x")?, finite(y, "y")?, finite(z, "z")?)))
}

/// A finite number.
pub fn finite(value: f64, name: &str) -> PyResult<f64> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(bad_value(format!("{name} is {value}: it must be finite.")))
}

/// The map itself, if it has an inverse.
pub fn invertible(map: Affine, name: &str) -> PyResult<Affine> {
    match map.inverse() {
        Ok(_) => Ok(map),
        Err(error) => Err(bad_value(format!("{name}: {error}"))),
    }
}

/// A map as a 4 x 4 matrix.
pub fn matrix_rows<'py>(py: Python<'py>, map: &Affine) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut flat = [0.0; 16];
    flat[15] = 1.0;
    for row in 0..3 {
        for column in 0..3 {
            flat[4 * row + column] = map.linear.col(column)[row];
        }
        flat[4 * row + 3] = map.translation[row];
    }
    let array = Array2::from_shape_vec((4, 4), flat.to_vec()).map_err(bad_value)?;
    Ok(PyArray2::from_owned_array(py, array))
}

/// A 4 x 4 matrix `world_from_local` that acts on columns.
pub fn matrix(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Affine> {
    let array = double_array(object, name)?;
    if array.shape() != [4, 4] {
        let shape = shape_text(array.shape());
        return Err(bad_value(format!("{name} has shape {shape}: it must be (4, 4).")));
    }
    let array = array.try_readonly().map_err(bad_value)?;
    let entries: Vec<f64> = array.as_array().iter().copied().collect();
    affine(&entries, name)
}

/// The rows of an array (N, 3).
pub fn vectors(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Vec3>> {
    let array = double_array(object, name)?;
    let [_, 3] = *array.shape() else {
        return Err(bad_value(format!("{name} has shape {}: it must be (N, 3).", shape_text(array.shape()))));
    };
    let array = array.try_readonly().map_err(bad_value)?;
    let row = |row: ArrayView1<'_, f64>| Vec3::new(row[0], row[1], row[2]);
    let view = array.as_array().into_dimensionality::<Ix2>().map_err(bad_value)?;
    let mut vectors = room(view.nrows())?;
    vectors.extend(view.rows().into_iter().map(row));
    Ok(vectors)
}

/// Many maps: translations (N, 3) or matrices (N, 4, 4).
pub fn maps(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Affine>> {
    let array = double_array(object, name)?;
    let mut entries: Vec<f64> = room(array.len())?;
    entries.extend(array.try_readonly().map_err(bad_value)?.as_array().iter());
    match array.shape() {
        [_, 3] => Ok(entries.chunks_exact(3).map(Vec3::from_slice).map(Affine::translate)).and_then(|maps| {
            maps.enumerate().map(|(k, map)| invertible(map, &format!("{name}[{k}]"))).collect()
        }),
        [_, 4, 4] => {
            (entries.chunks_exact(16).enumerate()).map(|(k, m)| affine(m, &format!("{name}[{k}]"))).collect()
        }
        [0] => Ok(Vec::new()),
        other => {
            Err(bad_value(format!("{name} has shape {}: it must be (N, 3) or (N, 4, 4).", shape_text(other))))
        }
    }
}

/// The map with these 16 entries, row by row.
fn affine(entries: &[f64], name: &str) -> PyResult<Affine> {
    let rows: [[f64; 4]; 4] = std::array::from_fn(|i| std::array::from_fn(|j| entries[4 * i + j]));
    let map = Affine::from_rows(&rows).ok_or_else(|| {
        let last = &rows[3];
        bad_value(format!(
            "{name}: the last row is {last:?}: it must be [0, 0, 0, 1]. Is the matrix transposed?"
        ))
    })?;
    invertible(map, name)
}

/// An array (N, 2) as a list of points.
pub fn points(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<[f64; 2]>> {
    let array = double_array(object, name)?;
    let [_, 2] = *array.shape() else {
        return Err(bad_value(format!("{name} has shape {}: it must be (N, 2).", shape_text(array.shape()))));
    };
    let array = array.try_readonly().map_err(bad_value)?;
    let view = array.as_array().into_dimensionality::<Ix2>().map_err(bad_value)?;
    let mut points = room(view.nrows())?;
    points.extend(view.rows().into_iter().map(|row: ArrayView1<'_, f64>| [row[0], row[1]]));
    Ok(points)
}

/// A list of points as an array (N, 2).
pub fn pairs<'py>(py: Python<'py>, points: &[[f64; 2]]) -> Bound<'py, PyArray2<f64>> {
    PyArray2::from_owned_array(py, Array2::from_shape_fn((points.len(), 2), |(row, k)| points[row][k]))
}
