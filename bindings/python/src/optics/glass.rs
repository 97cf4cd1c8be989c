//! Materials of the catalogue.

use numpy::ndarray::ArrayD;
use numpy::{PyArrayDyn, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use rayweave::optics::glass::{Dispersion, Glass, GlassError, glass, glasses};

use crate::arrays::double_array;
use crate::error::bad_value;

/// A material with its refractive index by wavelength: a glass, a crystal, a liquid, a metal.
///
/// `index(wavelength_nm)` and `extinction(wavelength_nm)` take a number or an array of vacuum wavelengths in nanometres. A
/// wavelength that the data do not reach is an error; `extrapolated()` is the same material without that check.
///
/// >>> import rayweave.optics as ro
/// >>> glass = ro.Glass("N-BK7")
/// >>> round(glass.index(587.5618), 5), round(glass.abbe_number(), 2)
/// (1.5168, 64.17)
/// >>> glass.index([486.1, 656.3]).round(5)
/// array([1.52238, 1.51432])
#[pyclass(frozen, module = "rayweave.optics", name = "Glass", eq)]
#[derive(Clone, PartialEq)]
pub struct PyGlass(pub Glass);

#[pymethods]
impl PyGlass {
    /// A material of the built-in catalogue, by name; upper and lower case, spaces and dashes do not matter.
    #[new]
    #[pyo3(signature = (name))]
    fn new(name: &str) -> PyResult<Self> {
        glass(name).map(PyGlass).map_err(bad_value)
    }

    /// A material by Sellmeier's formula n^2 - 1 = sum of b l^2 / (l^2 - c), l in micrometres, c in square micrometres.
    #[staticmethod]
    #[pyo3(signature = (name, b, c))]
    fn sellmeier(name: &str, b: Vec<f64>, c: Vec<f64>) -> PyResult<Self> {
        if b.len() != c.len() {
            let text = format!("b has {} numbers and c has {}: each term needs both.", b.len(), c.len());
            return Err(bad_value(text));
        }
        let terms: Vec<(f64, f64)> = b.into_iter().zip(c).collect();
        Ok(PyGlass(Glass::new(name, Dispersion::sellmeier(&terms))))
    }

    /// A material by its index at 587.5618 nm and its Abbe number.
    #[staticmethod]
    #[pyo3(signature = (n_d, v_d))]
    fn from_abbe(n_d: f64, v_d: f64) -> PyResult<Self> {
        Glass::from_abbe(n_d, v_d).map(PyGlass).map_err(bad_value)
    }

    /// The refractive index at a vacuum wavelength in nanometres, or at each of an array of them.
    #[pyo3(signature = (wavelength_nm))]
    #[cfg_attr(false, stub("(wavelength_nm: float) -> float"))]
    #[cfg_attr(false, stub("(wavelength_nm: ArrayLike) -> Any"))]
    fn index<'py>(&self, wavelength_nm: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        each(wavelength_nm, |wavelength| self.0.index(wavelength))
    }

    /// The extinction coefficient at a vacuum wavelength in nanometres, or at each of an array of them.
    #[pyo3(signature = (wavelength_nm))]
    #[cfg_attr(false, stub("(wavelength_nm: float) -> float"))]
    #[cfg_attr(false, stub("(wavelength_nm: ArrayLike) -> Any"))]
    fn extinction<'py>(&self, wavelength_nm: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        each(wavelength_nm, |wavelength| self.0.extinction(wavelength))
    }

    /// The Abbe number (n_d - 1) / (n_F - n_C).
    fn abbe_number(&self) -> PyResult<f64> {
        self.0.abbe_number().map_err(bad_value)
    }

    /// The same material without a check of the range of its data.
    fn extrapolated(&self) -> Self {
        PyGlass(self.0.extrapolated())
    }

    /// Name.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    /// Manufacturer; empty if there is none.
    #[getter]
    fn maker(&self) -> &str {
        self.0.maker()
    }

    /// Source of the data.
    #[getter]
    fn source(&self) -> &str {
        self.0.source()
    }

    /// Range of wavelengths with a known index, in nanometres.
    #[getter]
    fn range_nm(&self) -> (f64, f64) {
        let [lo, hi] = self.0.range_nm();
        (lo, hi)
    }

    fn __repr__(&self) -> String {
        format!("Glass({:?})", self.0.name())
    }

    /// A material of the catalogue pickles by its name.
    #[cfg_attr(false, stub("() -> tuple[type[Glass], tuple[str]]"))]
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let name = self.0.name();
        match glass(name) {
            Ok(known) if known == self.0 => Ok((py.get_type::<PyGlass>().into_any(), (name.to_owned(),))),
            _ => Err(bad_value(format!(
                "the glass {name:?} cannot be pickled: it is not that of the catalogue. Make it where it is used."
            ))),
        }
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.0.name().hash(&mut hasher);
        hasher.finish()
    }
}

/// The names of all materials of the catalogue.
///
/// >>> import rayweave.optics as ro
/// >>> "N-BK7" in ro.glass_names()
/// True
#[pyfunction]
pub fn glass_names() -> Vec<String> {
    glasses().iter().map(|glass| glass.name().to_owned()).collect()
}

/// A function of a number, or of each number of an array.
fn each<'py>(
    wavelengths: &Bound<'py, PyAny>,
    function: impl Fn(f64) -> Result<f64, GlassError>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = wavelengths.py();
    if let Ok(wavelength) = wavelengths.extract::<f64>() {
        return Ok(function(wavelength).map_err(bad_value)?.into_pyobject(py)?.into_any());
    }
    let array = double_array(wavelengths, "wavelength_nm")?;
    let array = array.try_readonly().map_err(bad_value)?;
    let values: Result<Vec<f64>, GlassError> = array.as_array().iter().map(|&w| function(w)).collect();
    let shaped = ArrayD::from_shape_vec(array.as_array().raw_dim(), values.map_err(bad_value)?);
    let found: Bound<'py, PyArrayDyn<f64>> = shaped.map_err(bad_value)?.to_pyarray(py);
    Ok(found.into_any())
}
