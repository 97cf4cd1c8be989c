//! Sources of photons.

use std::fmt::Display;

use pyo3::prelude::*;
use rayweave::Vec3;
use rayweave::photon::property::HC_MEV_NM;
use rayweave::photon::{Directions, Photon, Source, Torch};

use crate::arrays::list;
use crate::error::bad_value;
use crate::vectors::{vector, vectors};

/// A source of photons: see `rayweave.photons.Source`.
#[pyclass(frozen, module = "rayweave.photons", name = "PhotonSource")]
pub struct PyPhotonSource {
    pub source: Source,
}

#[pymethods]
impl PyPhotonSource {
    /// A point that emits unpolarised photons, in all directions or in one.
    #[staticmethod]
    #[pyo3(signature = (position: "ArrayLike", wavelength_nm, towards: "ArrayLike | None" = None))]
    fn point(
        position: &Bound<'_, PyAny>,
        wavelength_nm: f64,
        towards: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let torch = Torch::point(vector(position, "position")?, wavelength_nm).map_err(bad_value)?;
        let torch = match towards {
            None => torch,
            Some(direction) => {
                let directions = Directions::Cone { axis: vector(direction, "towards")?, half_angle: 0.0 };
                torch.towards(directions).map_err(bad_value)?
            }
        };
        Ok(PyPhotonSource { source: Source::Torch(torch) })
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
        Ok(PyPhotonSource { source: Source::Photons(photons) })
    }

    /// The number of photons, if it is limited.
    #[getter]
    fn count(&self) -> Option<u64> {
        self.source.limit()
    }
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
