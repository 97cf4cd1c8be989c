//! Sources of photons.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::Arc;

use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayweave::Vec3;
use rayweave::photon::property::HC_MEV_NM;
use rayweave::photon::{
    Genstep, GenstepNumbers, Gensteps, Origin, Photon, Source, SourceVolume, Torch, gensteps_from_array,
    photons_from_opticks,
};

use crate::arrays::{RealArray, contiguous, double_array, list, real_array};
use crate::error::bad_value;
use crate::photons::light::TorchLight;
use crate::photons::parts::DetectorParts;
use crate::vectors::{vector, vectors};

/// A source of photons: see `rayweave.photons.Source`.
#[pyclass(frozen, module = "rayweave.photons", name = "PhotonSource")]
pub struct PyPhotonSource {
    pub source: Source,
    /// The detector that a source with volumes or materials belongs to.
    detector: Option<Arc<DetectorParts>>,
}

impl PyPhotonSource {
    fn free(source: Source) -> PyPhotonSource {
        PyPhotonSource { source, detector: None }
    }

    fn torch(origin: Origin, light: &TorchLight) -> PyResult<Torch> {
        light.light(Torch::new(origin, light.wavelengths()?).map_err(bad_value)?)
    }

    /// The inside of a volume, or its boundary.
    pub fn in_volume(
        py: Python<'_>,
        parts: Arc<DetectorParts>,
        (name, is_boundary): (&str, bool),
        light: &TorchLight,
    ) -> PyResult<PyPhotonSource> {
        let DetectorParts { detector, evaluator, .. } = &*parts;
        let volume = py.detach(|| match is_boundary {
            true => SourceVolume::boundary(detector, evaluator, name),
            false => SourceVolume::inside(detector, evaluator, name),
        });
        let torch = Self::torch(Origin::Volume(volume.map_err(bad_value)?), light)?;
        Ok(PyPhotonSource { source: Source::Torch(torch), detector: Some(parts) })
    }

    /// Gensteps, with the names of materials by their numbers.
    pub fn of_gensteps(
        py: Python<'_>,
        parts: Arc<DetectorParts>,
        gensteps: &Bound<'_, PyAny>,
        materials: &BTreeMap<u32, String>,
    ) -> PyResult<PyPhotonSource> {
        let steps = read_gensteps(gensteps)?;
        let DetectorParts { detector, evaluator, .. } = &*parts;
        let gensteps = py.detach(|| Gensteps::new(detector, evaluator, &steps, materials));
        let source = Source::Gensteps(gensteps.map_err(bad_value)?);
        Ok(PyPhotonSource { source, detector: Some(parts) })
    }

    /// An error if the source belongs to another detector: numbers of volumes and materials would differ.
    pub fn check_detector(&self, detector: &Arc<DetectorParts>) -> PyResult<()> {
        match &self.detector {
            Some(own) if !Arc::ptr_eq(own, detector) => {
                let problem = "the source belongs to another detector: its volumes and materials are those of the detector that it \
                               was made with. Make one with this detector.";
                Err(bad_value(problem))
            }
            _ => Ok(()),
        }
    }
}

#[pymethods]
impl PyPhotonSource {
    /// A point.
    #[staticmethod]
    #[pyo3(signature = (position: "ArrayLike", light))]
    fn point(position: &Bound<'_, PyAny>, light: TorchLight) -> PyResult<Self> {
        let origin = Origin::Point(vector(position, "position")?);
        Ok(Self::free(Source::Torch(Self::torch(origin, &light)?)))
    }

    /// A flat disc.
    #[staticmethod]
    #[pyo3(signature = (centre: "ArrayLike", normal: "ArrayLike", radius, light))]
    fn disc(
        centre: &Bound<'_, PyAny>,
        normal: &Bound<'_, PyAny>,
        radius: f64,
        light: TorchLight,
    ) -> PyResult<Self> {
        let (centre, axis) = (vector(centre, "centre")?, vector(normal, "normal")?);
        let torch = Self::torch(Origin::Disc { centre, axis, radius }, &light)?;
        Ok(Self::free(Source::Torch(torch)))
    }

    /// A straight line.
    #[staticmethod]
    #[pyo3(signature = (start: "ArrayLike", end: "ArrayLike", light))]
    fn line(start: &Bound<'_, PyAny>, end: &Bound<'_, PyAny>, light: TorchLight) -> PyResult<Self> {
        let torch = Self::torch(Origin::Line(vector(start, "start")?, vector(end, "end")?), &light)?;
        Ok(Self::free(Source::Torch(torch)))
    }

    /// Photons in the layout of Opticks, (N, 4, 4).
    #[staticmethod]
    #[pyo3(signature = (photons: "ArrayLike"))]
    fn from_opticks(photons: &Bound<'_, PyAny>) -> PyResult<Self> {
        let array = contiguous(double_array(photons, "photons")?)?;
        let array = array.try_readonly().map_err(bad_value)?;
        let numbers = array.as_slice().map_err(bad_value)?;
        let photons = photons_from_opticks(array.shape(), numbers).map_err(bad_value)?;
        Ok(Self::free(Source::Photons(photons)))
    }

    /// Given photons.
    #[staticmethod]
    #[pyo3(signature = (
        positions: "ArrayLike", directions: "ArrayLike", wavelengths_nm: "ArrayLike", times: "ArrayLike",
        polarisations: "ArrayLike | None" = None
    ))]
    fn photons(
        positions: &Bound<'_, PyAny>,
        directions: &Bound<'_, PyAny>,
        wavelengths_nm: &Bound<'_, PyAny>,
        times: &Bound<'_, PyAny>,
        polarisations: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (positions, directions) = (vectors(positions, "positions")?, vectors(directions, "directions")?);
        let (wavelengths, times) = (list(wavelengths_nm, "wavelengths_nm")?, list(times, "times")?);
        let given = polarisations.map(|object| vectors(object, "polarisations")).transpose()?;
        let count = positions.len();
        let mut lengths = vec![
            ("directions", directions.len()),
            ("wavelengths_nm", wavelengths.len()),
            ("times", times.len()),
        ];
        lengths.extend(given.as_ref().map(|list| ("polarisations", list.len())));
        if let Some((name, rows)) = lengths.into_iter().find(|(_, rows)| *rows != count) {
            return Err(bad_value(format!("{name} has {rows} rows: positions has {count}.")));
        }
        let photon = |k: usize| -> PyResult<Photon> {
            require(positions[k].is_finite(), "positions", k, &positions[k], "it must be finite")?;
            require(times[k].is_finite(), "times", k, &times[k], "it must be finite")?;
            let is_light = wavelengths[k] > 0.0 && wavelengths[k].is_finite();
            require(is_light, "wavelengths_nm", k, &wavelengths[k], "it must be positive and finite")?;
            let direction = directions[k].normalize_or_zero();
            let is_direction = direction != Vec3::ZERO;
            require(is_direction, "directions", k, &directions[k], "it must be finite and not 0")?;
            let polarisation = given.as_ref().map_or(Ok(Vec3::ZERO), |given| {
                let own = transverse(given[k], direction);
                let reason = "it must be finite and not along the direction";
                require(own.is_some(), "polarisations", k, &given[k], reason)?;
                Ok::<Vec3, PyErr>(own.unwrap_or(Vec3::ZERO))
            })?;
            let energy = HC_MEV_NM / wavelengths[k];
            Ok(Photon { position: positions[k], direction, polarisation, energy, time: times[k] })
        };
        let photons: Vec<Photon> = (0..count).map(photon).collect::<PyResult<_>>()?;
        Ok(Self::free(Source::Photons(photons)))
    }

    /// Sentences about gensteps that do not fit their materials.
    #[getter]
    fn notes(&self) -> Vec<String> {
        match &self.source {
            Source::Gensteps(gensteps) => gensteps.notes().to_vec(),
            Source::Torch(_) | Source::Photons(_) => Vec::new(),
        }
    }

    /// The number of photons, if it is limited.
    #[getter]
    fn count(&self) -> Option<u64> {
        self.source.limit()
    }
}

/// Gensteps in the layout of Opticks, (N, 6, 4), or of Geant4, (N, 16).
fn read_gensteps(array: &Bound<'_, PyAny>) -> PyResult<Vec<Genstep>> {
    let array = real_array(array, "gensteps")?;
    let steps = match array {
        RealArray::Single(array) => {
            let array = contiguous(array)?;
            let numbers = array.try_readonly().map_err(bad_value)?;
            let numbers = GenstepNumbers::Single(numbers.as_slice().map_err(bad_value)?);
            gensteps_from_array(array.shape(), numbers)
        }
        RealArray::Double(array) => {
            let array = contiguous(array)?;
            let numbers = array.try_readonly().map_err(bad_value)?;
            let numbers = GenstepNumbers::Double(numbers.as_slice().map_err(bad_value)?);
            gensteps_from_array(array.shape(), numbers)
        }
    };
    steps.map_err(bad_value)
}

/// An error about an entry of an array, unless a condition holds.
fn require(holds: bool, array: &str, index: usize, value: &impl Display, reason: &str) -> PyResult<()> {
    match holds {
        true => Ok(()),
        false => Err(bad_value(format!("{array}[{index}] is {value}: {reason}."))),
    }
}

/// The unit vector along the part of a polarisation across a direction. A vector that is across already, but for rounding, is
/// only normalised.
fn transverse(polarisation: Vec3, direction: Vec3) -> Option<Vec3> {
    let unit = polarisation.try_normalize()?;
    let along = unit.dot(direction);
    match along.abs() {
        small if small < 1e-12 => Some(unit),
        large if large > 1.0 - 1e-12 => None,
        _ => (unit - along * direction).try_normalize(),
    }
}
