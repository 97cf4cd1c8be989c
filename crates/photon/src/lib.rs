//! Optical photons in detectors: simulation of single photons by Geant4's physics in exact geometry.
//!
//! A [`Detector`] is a compiled scene with optical materials and surfaces, read from the `[gdml]` or the `[photons]` table of a
//! document. [`simulate`] propagates photons of a [`Source`] (a [`Torch`], [`Gensteps`] or a list of photons) until each of
//! them ends: absorbed, detected, escaped or at a limit. The result holds the [`Hits`] and the number of photons by way of
//! ending. [`simulate_parts`] returns it in parts, in bounded memory, and records [`Histories`]: steps, sequences of flags and
//! counts.
//!
//! - Volumes are exact solids: no triangles, no offsets. A photon that leaves a boundary starts on it.
//! - The history of a photon is a function of the detector, the seed, the event and the number of the photon
//!   ([`philox`]): it does not depend on threads, batches or on the other photons of a run.
//! - Units are those of Geant4: mm, ns, MeV; wavelengths are in nm.
//!
//! *Sources*: Geant4 Physics Reference Manual 11.4, chapter "Optical photons"; Geant4 Book For
//! Application Developers 11.4, section 5.2.5. The order of decisions is that of Geant4's
//! `G4OpBoundaryProcess`, `G4OpAbsorption`, `G4OpRayleigh`, `G4OpMieHG` and `G4OpWLS`.

mod batch;
mod boundary;
mod box_steps;
mod compare;
mod detector;
#[cfg(feature = "gpu")]
mod device;
mod draws;
mod energies;
mod error;
mod flight;
mod free_path;
mod genstep;
mod history;
mod hit_file;
mod hits;
mod in_flight;
mod lines;
mod lint;
mod material;
mod opticks;
pub mod philox;
mod photon;
mod propagate;
pub mod property;
mod remarks;
mod rows;
mod run;
mod sample;
mod scatter;
mod scintillation;
mod settings;
mod source;
mod start;
mod step_table;
mod surface;
mod tables;
mod tracks;
mod volume;

pub use boundary::BoundaryEvent;
pub use compare::{
    Alphabet, CompareOptions, ComparedBin, ComparedQuantity, Comparison, FirstDifference, Pairs,
    PhotonSample, SampleTrack, chi_squared_tail, compare, normal_tail, read_sample,
};
pub use detector::{DetectionRule, Detector};
#[cfg(feature = "gpu")]
pub use device::{PhotonDevice, PhotonDeviceReport};
pub use error::{PhotonError, PropertyError};
pub use flight::End;
pub use genstep::{
    EmissionProcess, Genstep, GenstepNumbers, Gensteps, cerenkov_yield, gensteps_from_array,
    photons_from_opticks,
};
pub use history::{Histories, HistoryOptions, Process, Sequence, StepRow, sequence_text};
pub use hit_file::read_hits;
pub use hits::{Hits, hit_schema, hit_table};
pub use lint::{LintFinding, lint};
pub use material::{
    Compressibility, Mie, OpticalMaterial, ScintillationComponent, WavelengthShifter, rayleigh_length,
};
pub use opticks::{OpticksHits, opticks_photons};
pub use photon::Photon;
pub use propagate::{simulate, simulate_parts};
pub use remarks::{RemarkTerms, is_dark};
pub use run::{PhotonPart, PhotonRun};
pub use sample::LinearDensity;
pub use scintillation::ScintillationLight;
pub use settings::{RunSettings, TimeProfile};
pub use source::{Directions, Origin, Pulse, Source, SourceVolume, Torch, WavelengthDistribution};
pub use start::{check_start, emit};
pub use step_table::{history_schema, step_schema};
pub use surface::{
    Coating, DAVIS_FINISHES, LUT_FINISHES, MeasuredTable, OpticalSurface, SurfaceFinish, SurfaceModel,
    SurfaceType,
};
pub use tables::{DavisTable, DichroicTable, LutTable, SurfaceTables};
