//! The errors of photon simulation.

use rayweave_error::{Classified, ErrorKind, Message};
use rayweave_model::CompileError;
use rayweave_model::memory::Shortage;
use rayweave_scene::Diagnostics;
use rayweave_table::TableError;

/// The reason why a table of a property is invalid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PropertyError {
    /// The table is empty.
    #[error("the property has no points: at least one pair of energy and value is needed.")]
    Empty,
    /// An energy that no photon has.
    #[error("the energy of point {index} is {energy} MeV: it must be positive and finite.")]
    Energy {
        /// The point, from 0.
        index: usize,
        /// The energy in MeV.
        energy: f64,
    },
    /// A wavelength that no photon has.
    #[error("the wavelength of point {index} is {wavelength} nm: it must be positive and finite.")]
    Wavelength {
        /// The point, from 0.
        index: usize,
        /// The wavelength in nm.
        wavelength: f64,
    },
    /// A value that is not finite.
    #[error("the value of point {index} is {value}: it must be finite.")]
    Value {
        /// The point, from 0.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A negative intensity of a spectrum.
    #[error("the intensity of point {index} is {value}: it must not be negative.")]
    Negative {
        /// The point, from 0.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A spectrum that is zero everywhere.
    #[error("the spectrum has no intensity: at least one value must be positive.")]
    Dark,
}

/// An error of a detector or of a run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PhotonError {
    /// Optical properties that are invalid, missing, or contradict each other: all of them.
    #[error("{}", lines(.0))]
    Detector(Vec<Message>),
    /// A spectrum of a source is invalid.
    #[error("the spectrum of the source is invalid: {0}")]
    Spectrum(#[from] PropertyError),
    /// The `[photons]` tables of a model file are invalid: all problems with their positions.
    #[error("{0}")]
    File(#[source] Diagnostics),
    /// The geometry cannot be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A setting of a source or of a run is invalid.
    #[error("{0}")]
    Setting(Message),
    /// A sample of photons cannot be compared.
    #[error("{0}")]
    Sample(Message),
    /// A table of photons cannot be written or read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The photons and their hits do not fit into memory.
    #[error(
        "the photons and their hits cannot be kept: {0}. Simulate parts of the range one after the other."
    )]
    Memory(#[from] Shortage),
    /// The run was cancelled.
    #[error("the run was cancelled.")]
    Cancelled,
}

/// One message per line.
fn lines(messages: &[Message]) -> String {
    messages.iter().map(Message::to_string).collect::<Vec<_>>().join("\n")
}

impl PhotonError {
    /// A setting that is invalid: the problem and its reason.
    pub(crate) fn setting(problem: impl Into<String>, reason: impl Into<String>) -> PhotonError {
        PhotonError::Setting(Message::new(problem, reason))
    }
}

impl Classified for PhotonError {
    fn kind(&self) -> ErrorKind {
        match self {
            PhotonError::Detector(_) => ErrorKind::Optics,
            PhotonError::File(_) => ErrorKind::ModelFile,
            PhotonError::Compile(_) => ErrorKind::Compile,
            PhotonError::Setting(_) | PhotonError::Memory(_) | PhotonError::Spectrum(_) => ErrorKind::Value,
            PhotonError::Sample(_) => ErrorKind::Input,
            PhotonError::Table(error) => error.kind(),
            PhotonError::Cancelled => ErrorKind::Cancelled,
        }
    }
}
