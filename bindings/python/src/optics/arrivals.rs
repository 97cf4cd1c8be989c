//! Rays that arrive at the image.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::lens::analysis::{
    Arrival, Spot, best_focus, defocused, encircled_energy, encircled_energy_radius, geometric_mtf,
};

use crate::error::bad_value;

/// A function that returns a number of a `T`.
pub(super) type Of<T> = fn(&T) -> f64;

/// Number of rays, centroid, RMS radii, geometric radius.
type Sizes = (usize, (f64, f64), (f64, f64, f64), f64);

/// Rays on the image: see `rayweave.optics.Rays`.
#[pyclass(frozen, module = "rayweave.optics", name = "Arrivals")]
pub struct PyArrivals(pub Vec<Arrival>);

#[pymethods]
impl PyArrivals {
    /// Their columns by name.
    #[pyo3(signature = () -> "dict[str, NDArray[Any]]")]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = PyDict::new(py);
        let whole = self.0.iter().map(|ray| ray.id as i64);
        table.set_item("id", PyArray1::from_vec(py, whole.collect()))?;
        let columns: [(&str, Of<Arrival>); 10] = [
            ("x", |ray| ray.position.x),
            ("y", |ray| ray.position.y),
            ("z", |ray| ray.position.z),
            ("x_tilt", |ray| ray.direction.x),
            ("y_tilt", |ray| ray.direction.y),
            ("z_tilt", |ray| ray.direction.z),
            ("path", |ray| ray.path),
            ("index", |ray| ray.index),
            ("wavelength_nm", |ray| ray.wavelength_nm),
            ("power", |ray| ray.power),
        ];
        for (name, value) in columns {
            table.set_item(name, PyArray1::from_vec(py, self.0.iter().map(value).collect()))?;
        }
        Ok(table)
    }

    /// The same rays on a plane shifted along the axis.
    #[pyo3(signature = (shift))]
    fn moved(&self, shift: f64) -> Self {
        PyArrivals(defocused(&self.0, shift))
    }

    /// The number of rays, the centroid (x, y), the RMS radii (both, x, y) and the geometric radius.
    fn spot(&self) -> PyResult<Sizes> {
        let dark = || bad_value("no light arrives at the image: a spot needs at least one ray.");
        let spot = Spot::of(&self.0).ok_or_else(dark)?;
        let ([x, y], [rms_x, rms_y]) = (spot.centroid, spot.rms_xy);
        Ok((spot.rays, (x, y), (spot.rms, rms_x, rms_y), spot.geometric))
    }

    /// The fraction of the power within circles about the centroid.
    #[pyo3(signature = (radii))]
    fn encircled_energy<'py>(&self, py: Python<'py>, radii: Vec<f64>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, encircled_energy(&self.0, &radii))
    }

    /// The radius of the smallest circle about the centroid with a fraction of the power; NaN if there is no light.
    #[pyo3(signature = (fraction))]
    fn radius_of_energy(&self, fraction: f64) -> f64 {
        encircled_energy_radius(&self.0, fraction).unwrap_or(f64::NAN)
    }

    /// The geometric modulation of lines across a direction.
    #[pyo3(signature = (direction, frequencies))]
    fn mtf<'py>(
        &self,
        py: Python<'py>,
        direction: [f64; 2],
        frequencies: Vec<f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, py.detach(|| geometric_mtf(&self.0, direction, &frequencies)))
    }

    /// The shift of the plane with the smallest RMS radius; NaN for parallel rays.
    fn best_focus(&self) -> f64 {
        best_focus(&self.0).unwrap_or(f64::NAN)
    }
}
