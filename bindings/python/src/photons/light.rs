//! The light of torches: directions, wavelengths, polarisation and time.

use pyo3::prelude::*;
use rayweave::Vec3;
use rayweave::photon::property::{PropertyTable, Spectrum};
use rayweave::photon::{
    Directions, LinearDensity, OpticalMaterial, PropertyError, Pulse, ScintillationComponent,
    ScintillationLight, Torch, WavelengthDistribution,
};

use crate::error::bad_value;

/// The light of a torch, wherever it starts.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct TorchLight {
    /// The kind of a spectrum, `line`, `uniform`, `black body`, `table` or `scintillation`, its numbers, and the
    /// name of the material of scintillation.
    spectrum: (String, Vec<f64>, String),
    towards: Option<[f64; 3]>,
    cone_degrees: f64,
    polarisation: Option<[f64; 3]>,
    time: [f64; 2],
    time_deviation: f64,
    time_decay: f64,
}

impl TorchLight {
    /// The distribution of wavelengths.
    pub fn wavelengths(&self) -> PyResult<WavelengthDistribution> {
        let (kind, numbers, name) = &self.spectrum;
        match (kind.as_str(), &numbers[..]) {
            ("line", &[wavelength]) => Ok(WavelengthDistribution::Single(wavelength)),
            ("uniform", &[from, to]) => WavelengthDistribution::uniform(from, to).map_err(bad_value),
            ("black body", &[kelvin, from, to]) => {
                WavelengthDistribution::black_body(kelvin, from, to).map_err(bad_value)
            }
            ("table", numbers) => {
                let points = numbers.as_chunks::<2>().0.iter().map(|&[nm, density]| (nm, density));
                let density = LinearDensity::new(points.collect());
                let density =
                    density.map_err(|error| bad_value(format!("the spectrum is invalid: {error}")))?;
                Ok(WavelengthDistribution::Density(density))
            }
            ("scintillation", numbers) => {
                let scintillation = components(numbers).map_err(bad_value)?;
                let material =
                    OpticalMaterial { name: name.clone(), scintillation, ..OpticalMaterial::default() };
                let light = ScintillationLight::new(&material).map_err(bad_value)?;
                Ok(WavelengthDistribution::Scintillation(light))
            }
            _ => {
                let problem = "photons have no line spectra: give one wavelength, or the kind uniform, black body, table or scintillation.";
                Err(bad_value(format!("the spectrum is of the kind {kind:?}: {problem}")))
            }
        }
    }

    /// A torch with this light.
    pub fn light(&self, torch: Torch) -> PyResult<Torch> {
        let mut torch = torch;
        if let Some(axis) = self.towards {
            let half_angle = self.cone_degrees;
            torch = torch
                .towards(Directions::Cone { axis: Vec3::from_array(axis), half_angle })
                .map_err(bad_value)?;
        }
        if let Some(vector) = self.polarisation {
            torch = torch.polarised(Vec3::from_array(vector)).map_err(bad_value)?;
        }
        let pulse = Pulse { interval: self.time, deviation: self.time_deviation, decay: self.time_decay };
        torch.pulsed(pulse).map_err(bad_value)
    }
}

/// The components of scintillation, each as numbers: its number, time constant (NaN without one), rise time, share, the number of points of
/// its spectrum, and their energies in MeV and values.
fn components(mut numbers: &[f64]) -> Result<Vec<ScintillationComponent>, PropertyError> {
    let mut components = Vec::new();
    while let [number, time, rise_time, share, count, rest @ ..] = numbers {
        let (points, rest) = rest.split_at(rest.len().min(2 * *count as usize));
        let points = points.as_chunks::<2>().0.iter().map(|&[energy, value]| (energy, value)).collect();
        components.push(ScintillationComponent {
            number: *number as u32,
            spectrum: Spectrum::new(&PropertyTable::new(points)?)?,
            time: Some(*time).filter(|time| !time.is_nan()),
            rise_time: *rise_time,
            share: *share,
        });
        numbers = rest;
    }
    Ok(components)
}
