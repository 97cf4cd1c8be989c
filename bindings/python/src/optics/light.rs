//! Conversion of light and of trace settings from Python.

use pyo3::prelude::*;
use rayweave::Ray;
use rayweave::math::Vec3;
use rayweave::optics::interface::Stokes;
use rayweave::optics::{Beam, Branches, Light, OpticsError, TraceSettings};

use crate::arrays::list;
use crate::engine::thread_argument;
use crate::error::bad_value;
use crate::vectors::vectors;

/// Settings as given by Python.
#[derive(FromPyObject)]
pub struct LightOptions<'py> {
    #[pyo3(item)]
    branches: String,
    #[pyo3(item)]
    polarised: bool,
    #[pyo3(item)]
    generation_limit: u32,
    #[pyo3(item)]
    threshold: f64,
    #[pyo3(item)]
    keep_escaped: bool,
    #[pyo3(item)]
    seed: u64,
    #[pyo3(item)]
    rays: Option<(usize, usize)>,
    #[pyo3(item)]
    threads: Option<Bound<'py, PyAny>>,
}

impl LightOptions<'_> {
    /// The settings.
    pub fn settings(&self) -> PyResult<TraceSettings> {
        Ok(TraceSettings {
            branches: branches_named(&self.branches)?,
            polarised: self.polarised,
            generation_limit: self.generation_limit,
            threshold: self.threshold,
            keep_escaped: self.keep_escaped,
            seed: self.seed,
            rays: self.rays.map(|(first, last)| first..last),
            threads: self.threads.as_ref().map(thread_argument).transpose()?,
            ..TraceSettings::default()
        })
    }
}

fn branches_named(name: &str) -> PyResult<Branches> {
    match name {
        "ideal" => Ok(Branches::Ideal),
        "both" => Ok(Branches::Both),
        "random" => Ok(Branches::Random),
        other => {
            Err(bad_value(format!("branches is {other:?}: it can be \"ideal\", \"both\" or \"random\".")))
        }
    }
}

/// The light in arrays of equal length: rays (N, 3), everything else (N,).
pub fn beam(
    rays: [&Bound<'_, PyAny>; 2],
    light: [&Bound<'_, PyAny>; 2],
    source: Vec<u32>,
    stokes: Option<Vec<[f64; 7]>>,
) -> PyResult<Beam> {
    let origins = vectors(rays[0], "origins")?;
    let directions = vectors(rays[1], "directions")?;
    let (wavelengths, powers) = (list(light[0], "wavelength_nm")?, list(light[1], "power")?);
    let count = origins.len();
    let lengths = [
        ("directions", directions.len()),
        ("wavelength_nm", wavelengths.len()),
        ("power", powers.len()),
        ("source", source.len()),
        ("stokes", stokes.as_ref().map_or(count, Vec::len)),
    ];
    if let Some((column, found)) = lengths.into_iter().find(|(_, length)| *length != count) {
        return Err(bad_value(OpticsError::Length { column, found, expected: count }));
    }
    let light = |i: usize| Light {
        ray: Ray::new(origins[i], directions[i]),
        wavelength_nm: wavelengths[i],
        power: powers[i],
        source: source[i],
        stokes: stokes.as_ref().map(|rows| polarisation(&rows[i])),
    };
    Ok((0..count).map(light).collect())
}

/// Polarisation from the four parameters and the axis.
fn polarisation(&[i, q, u, v, x, y, z]: &[f64; 7]) -> Stokes {
    Stokes { parameters: [i, q, u, v], axis: Vec3::new(x, y, z) }
}
