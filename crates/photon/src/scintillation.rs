//! Scintillation light: components with a spectrum, times and a share of the yield.

use crate::error::PhotonError;
use crate::material::{OpticalMaterial, ScintillationComponent};
use crate::philox::Stream;
use crate::property::Spectrum;

/// The scintillation light of a material: wavelengths and delays of its components, by their shares of the yield.
#[derive(Clone, Debug, PartialEq)]
pub struct ScintillationLight {
    components: Vec<ScintillationComponent>,
}

impl ScintillationLight {
    /// The light of a material.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for a material without `SCINTILLATIONCOMPONENT1`, a component with a share that has no
    /// `SCINTILLATIONTIMECONSTANT`, and shares that are all 0.
    pub fn new(material: &OpticalMaterial) -> Result<ScintillationLight, PhotonError> {
        let name = &material.name;
        let fault = |reason: String| {
            Err(PhotonError::setting(format!("the material `{name}` has no scintillation light"), reason))
        };
        let components: Vec<ScintillationComponent> =
            material.scintillation.iter().filter(|component| component.share > 0.0).cloned().collect();
        if material.scintillation.is_empty() {
            return fault("it has no SCINTILLATIONCOMPONENT1".to_owned());
        }
        if components.is_empty() {
            return fault("the yields of its components are all 0".to_owned());
        }
        if let Some(component) = components.iter().find(|component| component.time.is_none()) {
            return fault(format!("it has no SCINTILLATIONTIMECONSTANT{}", component.number));
        }
        Ok(ScintillationLight { components })
    }

    /// The energy of a photon in MeV, and its component.
    pub(crate) fn sample(&self, stream: &mut Stream) -> (f64, &ScintillationComponent) {
        let component = match &self.components[..] {
            [component] => component,
            components => &components[chosen(components, stream)],
        };
        (energy(&component.spectrum, stream), component)
    }
}

/// An energy in MeV.
pub(crate) fn energy(spectrum: &Spectrum, stream: &mut Stream) -> f64 {
    spectrum.quantile(stream.uniform(), f64::INFINITY).unwrap_or_default()
}

/// The index of a component, with the probability of its share of the yield.
pub(crate) fn chosen(components: &[ScintillationComponent], stream: &mut Stream) -> usize {
    let total: f64 = components.iter().map(|component| component.share).sum();
    let mut rest = total * stream.uniform();
    for (k, component) in components.iter().enumerate() {
        if rest < component.share {
            return k;
        }
        rest -= component.share;
    }
    components.len() - 1
}

/// A delay in ns with the density (1 - exp(-t / rise)) exp(-t / decay). It is the sum of two exponential numbers with the means
/// `decay` and rise decay / (rise + decay), since the convolution of exp(-a t) and exp(-b t) is in proportion to
/// exp(-a t) - exp(-b t).
pub(crate) fn delay(decay: f64, rise: f64, stream: &mut Stream) -> f64 {
    let delay = decay * stream.exponential();
    if rise > 0.0 { delay + rise * decay / (rise + decay) * stream.exponential() } else { delay }
}
