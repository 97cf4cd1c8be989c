//! Sources of light.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use rayweave::optics::source::{
    BeamProfile, Emission, ListedRays, Pattern, Power, Sampling, Source, Spectrum,
};

use crate::error::{bad_value, require_file};
use crate::optics::outline::Outline;
use crate::optics::spec::Spec;
use crate::vectors::{matrix, vectors};

/// Origins, directions, wavelengths and powers.
type Light<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// A source of light: see `rayweave.optics.Source`.
#[pyclass(frozen, module = "rayweave.optics", name = "LightSource")]
pub struct PySource(pub Source);

#[pymethods]
impl PySource {
    #[new]
    #[pyo3(signature = (kind, numbers, count, spectrum, power, is_total, seed, outline, sampling))]
    #[allow(clippy::too_many_arguments)] // those of the class in Python
    fn new(
        kind: &str,
        numbers: Vec<f64>,
        count: u64,
        spectrum: Spec,
        power: f64,
        is_total: bool,
        seed: u64,
        outline: Option<Outline>,
        sampling: &str,
    ) -> PyResult<Self> {
        let pattern = pattern(kind, &numbers, count, outline.as_ref(), sampling)?;
        let power = if is_total { Power::Total(power) } else { Power::PerRay(power) };
        let spectrum = spectrum_of(&spectrum)?;
        let source = Source::new(pattern).and_then(|source| source.spectrum(&spectrum)?.power(power));
        source.map(|source| PySource(source.seed(seed))).map_err(bad_value)
    }

    /// Rays given one by one, optionally with their own wavelengths and powers.
    #[staticmethod]
    #[pyo3(signature = (origins: "ArrayLike", directions: "ArrayLike", wavelength_nm = None, power = None))]
    fn listed(
        origins: &Bound<'_, PyAny>,
        directions: &Bound<'_, PyAny>,
        wavelength_nm: Option<Vec<f64>>,
        power: Option<Vec<f64>>,
    ) -> PyResult<Self> {
        let (origins, directions) = (vectors(origins, "origins")?, vectors(directions, "directions")?);
        let rays = ListedRays::new(origins, directions, wavelength_nm, power).map_err(bad_value)?;
        Source::new(Pattern::Rays(rays)).map(PySource).map_err(bad_value)
    }

    /// The rays of a file.
    #[staticmethod]
    #[pyo3(signature = (path))]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        require_file(&path)?;
        let read = || ListedRays::read(&path).and_then(|rays| Source::new(Pattern::Rays(rays)));
        py.detach(read).map(PySource).map_err(bad_value)
    }

    /// The source with a different spectrum.
    #[pyo3(signature = (spectrum))]
    fn with_spectrum(&self, spectrum: Spec) -> PyResult<Self> {
        self.0.clone().spectrum(&spectrum_of(&spectrum)?).map(PySource).map_err(bad_value)
    }

    /// The source with a different power, of each ray or of all together.
    #[pyo3(signature = (power, is_total))]
    fn with_power(&self, power: f64, is_total: bool) -> PyResult<Self> {
        let power = if is_total { Power::Total(power) } else { Power::PerRay(power) };
        self.0.clone().power(power).map(PySource).map_err(bad_value)
    }

    /// The source with polarised light, given by Stokes parameters.
    #[pyo3(signature = (parameters))]
    fn with_stokes(&self, parameters: [f64; 4]) -> PyResult<Self> {
        self.0.clone().stokes(parameters).map(PySource).map_err(bad_value)
    }

    /// The source moved by an affine map, a 4 x 4 matrix.
    #[pyo3(signature = (world_from_local: "ArrayLike"))]
    fn apply(&self, world_from_local: &Bound<'_, PyAny>) -> PyResult<Self> {
        let map = matrix(world_from_local, "matrix")?;
        self.0.clone().apply(&map).map(PySource).map_err(bad_value)
    }

    /// The number of rays.
    #[getter]
    fn count(&self) -> u64 {
        self.0.count()
    }

    /// Its rays: origins, directions, wavelengths and powers.
    fn rays<'py>(&self, py: Python<'py>) -> PyResult<Light<'py>> {
        let count = self.0.count();
        if count > MAX_RAYS {
            return Err(bad_value(format!(
                "the source has {count} rays: arrays hold at most {MAX_RAYS} of them. Trace the source by `System.stream`."
            )));
        }
        let rays = py.detach(|| self.0.rays(0..count));
        Ok((
            rows(py, &rays.origins)?,
            rows(py, &rays.directions)?,
            PyArray1::from_vec(py, rays.wavelength_nm),
            PyArray1::from_vec(py, rays.power),
        ))
    }
}

/// The maximum number of rays in arrays: 20 GB with their copies.
const MAX_RAYS: u64 = 1 << 27;

/// Vectors (N, 3) from their components.
fn rows<'py>(py: Python<'py>, [x, y, z]: &[Vec<f64>; 3]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = x.iter().zip(y).zip(z).flat_map(|((&x, &y), &z)| [x, y, z]).collect();
    let array = numpy::ndarray::Array2::from_shape_vec((x.len(), 3), flat).map_err(bad_value)?;
    Ok(PyArray2::from_owned_array(py, array))
}

fn pattern(
    kind: &str,
    numbers: &[f64],
    count: u64,
    outline: Option<&Outline>,
    sampling: &str,
) -> PyResult<Pattern> {
    let aperture =
        || outline.ok_or_else(|| bad_value("the aperture is missing: it bounds the beam."))?.aperture();
    Ok(match (kind, numbers) {
        ("line", &[length]) => Pattern::Line { length, count },
        ("circle", &[diameter]) => Pattern::Circle { diameter, count },
        ("cone", &[half_angle_degrees]) => Pattern::Cone { half_angle_degrees, count },
        ("wedge", &[angle_degrees]) => Pattern::Wedge { angle_degrees, count },
        ("lamp", &[width, height, half_angle_degrees]) => {
            Pattern::Lamp { width, height, half_angle_degrees, count }
        }
        ("beam", numbers) => {
            let profile = match *numbers {
                [radius] => BeamProfile::Gaussian { radius },
                _ => BeamProfile::TopHat,
            };
            Pattern::Beam { aperture: aperture()?, profile, sampling: sampling_named(sampling, count)? }
        }
        ("point", &[half_angle_degrees]) => {
            Pattern::Point { half_angle_degrees, sampling: sampling_named(sampling, count)? }
        }
        ("disk", &[half_angle_degrees]) => {
            let emission = Emission::Lambert;
            Pattern::Extended { aperture: aperture()?, emission, half_angle_degrees, count }
        }
        (kind, numbers) => {
            return Err(bad_value(format!("there is no source {kind:?} with {} numbers", numbers.len())));
        }
    })
}

/// Approximate number of rays: grids and rings round it.
fn sampling_named(name: &str, count: u64) -> PyResult<Sampling> {
    Sampling::named(name, count).ok_or_else(|| {
        let kinds = "\"fibonacci\", \"random\", \"grid\" or \"hexapolar\"";
        bad_value(format!("sampling is {name:?}: it can be {kinds}."))
    })
}

fn spectrum_of(spec: &Spec) -> PyResult<Spectrum> {
    Ok(match (spec.kind(), spec.numbers()) {
        ("line", &[wavelength_nm]) => Spectrum::Line(wavelength_nm),
        ("lines", numbers) => Spectrum::Lines(pairs(numbers)),
        ("table", numbers) => Spectrum::Table(pairs(numbers)),
        ("uniform", &[from_nm, to_nm]) => Spectrum::Band { from_nm, to_nm },
        ("black body", &[kelvin, from_nm, to_nm]) => Spectrum::BlackBody { kelvin, from_nm, to_nm },
        (kind, numbers) => {
            return Err(bad_value(format!("there is no spectrum {kind:?} with {} numbers", numbers.len())));
        }
    })
}

fn pairs(numbers: &[f64]) -> Vec<(f64, f64)> {
    numbers.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect()
}
