//! Tables of measured surfaces.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayweave::photon::{DavisTable, DichroicTable, LutTable, MeasuredTable, SurfaceTables};

use crate::arrays::{RealArray, contiguous, double_array, list, real_array, shape_text};
use crate::error::bad_value;

/// Tables of measured surfaces: see `rayweave.photons.SurfaceTables`.
#[pyclass(frozen, module = "rayweave.photons", name = "PhotonTables")]
pub struct PyTables(pub SurfaceTables);

/// The numbers of an array of a shape, in row-major order.
fn numbers(array: &Bound<'_, PyAny>, name: &str, shape: &[usize]) -> PyResult<Vec<f64>> {
    let array = double_array(array, name)?;
    if array.shape() != shape {
        let (own, wanted) = (shape_text(array.shape()), shape_text(shape));
        return Err(bad_value(format!("{name} has shape {own}: it must be {wanted}.")));
    }
    let array = contiguous(array)?;
    let array = array.try_readonly().map_err(bad_value)?;
    Ok(array.as_slice().map_err(bad_value)?.to_vec())
}

#[pymethods]
impl PyTables {
    /// The tables of a folder and of a dichroic file.
    #[new]
    #[pyo3(signature = (folder = None, dichroic = None))]
    fn new(folder: Option<PathBuf>, dichroic: Option<PathBuf>) -> PyResult<PyTables> {
        let mut tables = SurfaceTables::default();
        if let Some(folder) = folder {
            tables = tables.folder(folder);
        }
        if let Some(path) = dichroic {
            tables = tables.dichroic(DichroicTable::read(&path).map_err(bad_value)?);
        }
        Ok(PyTables(tables))
    }

    /// The same with a table of probabilities for a surface or a finish.
    #[pyo3(signature = (name, probabilities: "ArrayLike"))]
    fn with_lut(&self, name: &str, probabilities: &Bound<'_, PyAny>) -> PyResult<PyTables> {
        let shape = [LutTable::PHIS, LutTable::THETAS, LutTable::INCIDENCES];
        let table = LutTable::new(&numbers(probabilities, "probabilities", &shape)?).map_err(bad_value)?;
        Ok(PyTables(self.0.clone().with(name, MeasuredTable::Lut(Arc::new(table)))))
    }

    /// The same with reflectances and directions for a surface or a finish.
    #[pyo3(signature = (name, reflectance: "ArrayLike", directions: "ArrayLike"))]
    fn with_davis(
        &self,
        name: &str,
        reflectance: &Bound<'_, PyAny>,
        directions: &Bound<'_, PyAny>,
    ) -> PyResult<PyTables> {
        let reflectance = list(reflectance, "reflectance")?;
        let directions: Vec<f32> = match real_array(directions, "directions")? {
            RealArray::Single(array) => {
                let array = contiguous(array)?;
                array.try_readonly().map_err(bad_value)?.as_slice().map_err(bad_value)?.to_vec()
            }
            RealArray::Double(array) => {
                let array = contiguous(array)?;
                let array = array.try_readonly().map_err(bad_value)?;
                array.as_slice().map_err(bad_value)?.iter().map(|&value| value as f32).collect()
            }
        };
        let table = DavisTable::new(reflectance, &directions).map_err(bad_value)?;
        Ok(PyTables(self.0.clone().with(name, MeasuredTable::Davis(Arc::new(table)))))
    }

    /// The same with a transmittance for a surface.
    #[pyo3(signature = (name, wavelengths_nm: "ArrayLike", angles_degrees: "ArrayLike", percent: "ArrayLike"))]
    fn with_dichroic(
        &self,
        name: &str,
        wavelengths_nm: &Bound<'_, PyAny>,
        angles_degrees: &Bound<'_, PyAny>,
        percent: &Bound<'_, PyAny>,
    ) -> PyResult<PyTables> {
        let (wavelengths, angles) =
            (list(wavelengths_nm, "wavelengths_nm")?, list(angles_degrees, "angles_degrees")?);
        let percent = numbers(percent, "percent", &[angles.len(), wavelengths.len()])?;
        let table = DichroicTable::new(wavelengths, angles, percent).map_err(bad_value)?;
        Ok(PyTables(self.0.clone().with(name, MeasuredTable::Dichroic(Arc::new(table)))))
    }
}
