//! Single vectors and matrices on their way in.

use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayweave::math::{Affine, Vec3};

use crate::arrays::{double_array, list, shape_text};
use crate::error::bad_value;

/// A vector of finite numbers.
pub fn vector(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec3> {
    let [x, y, z] = list(object, name)?
        .try_into()
        .map_err(|list: Vec<f64>| bad_value(format!("{name} has {} numbers (3 are needed)", list.len())))?;
    for (k, value) in [x, y, z].into_iter().enumerate() {
        if !value.is_finite() {
            return Err(bad_value(format!("{name}[{k}] is {value} (it must be finite)")));
        }
    }
    Ok(Vec3::new(x, y, z))
}

/// A vector that says a direction.
pub fn direction(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec3> {
    let vector = vector(object, name)?;
    if vector == Vec3::ZERO {
        return Err(bad_value(format!("{name}: zero length (it must say a direction)")));
    }
    Ok(vector)
}

/// A finite number.
pub fn finite(value: f64, name: &str) -> PyResult<f64> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(bad_value(format!("{name} is {value} (it must be finite)")))
}

/// The map itself, if it has an inverse.
pub fn invertible(map: Affine, name: &str) -> PyResult<Affine> {
    match map.inverse() {
        Ok(_) => Ok(map),
        Err(error) => Err(bad_value(format!("{name}: {error}"))),
    }
}

/// A 4 x 4 matrix `world_from_local` that acts on columns.
pub fn matrix(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Affine> {
    let array = double_array(object, name)?;
    if array.shape() != [4, 4] {
        let shape = shape_text(array.shape());
        return Err(bad_value(format!("{name} has shape {shape} ((4, 4) is needed)")));
    }
    let array = array.try_readonly().map_err(bad_value)?;
    let entries: Vec<f64> = array.as_array().iter().copied().collect();
    affine(&entries, name)
}

/// Many maps: translations (N, 3) or matrices (N, 4, 4).
pub fn maps(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Affine>> {
    let array = double_array(object, name)?;
    let entries: Vec<f64> = array.try_readonly().map_err(bad_value)?.as_array().iter().copied().collect();
    match array.shape() {
        [_, 3] => Ok(entries.chunks_exact(3).map(Vec3::from_slice).map(Affine::translate)).and_then(|maps| {
            maps.enumerate().map(|(k, map)| invertible(map, &format!("{name}[{k}]"))).collect()
        }),
        [_, 4, 4] => {
            (entries.chunks_exact(16).enumerate()).map(|(k, m)| affine(m, &format!("{name}[{k}]"))).collect()
        }
        [0] => Ok(Vec::new()),
        other => {
            Err(bad_value(format!("{name} has shape {} ((N, 3) or (N, 4, 4) is needed)", shape_text(other))))
        }
    }
}

/// The map with these 16 entries, row by row.
fn affine(entries: &[f64], name: &str) -> PyResult<Affine> {
    let rows: [[f64; 4]; 4] = std::array::from_fn(|i| std::array::from_fn(|j| entries[4 * i + j]));
    let map = Affine::from_rows(&rows).ok_or_else(|| {
        let last = &rows[3];
        bad_value(format!(
            "{name}: the last row is {last:?} (it must be [0, 0, 0, 1]) is the matrix transposed?"
        ))
    })?;
    invertible(map, name)
}
