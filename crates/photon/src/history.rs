//! Histories: the steps of photons, Opticks' packed sequences of flags, and counts of processes by surface.
//!
//! The loop over photons is generic over a [`Recorder`]. That of a run without histories is `()`, whose calls do nothing.

use crate::boundary::BoundaryEvent;
use crate::detector::Detector;
use crate::flight::{End, Flight};
use crate::property::wavelength_nm;
use crate::source::Source;
use crate::volume::VolumePaths;
use rayweave_math::Vec3;
use rayweave_model::Crossing;
use rayweave_shape::Ray;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The process at the end of a step of a photon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Process {
    /// The photon is emitted by a torch, or given: the first row of its history.
    Emission,
    /// The photon is emitted by a Cerenkov genstep: the first row of its history.
    Cerenkov,
    /// The photon is emitted by a scintillation genstep: the first row of its history.
    Scintillation,
    /// Rayleigh scattering.
    Rayleigh,
    /// Mie scattering.
    Mie,
    /// Emission by a wavelength shifter.
    Reemission,
    /// Refraction at an interface.
    FresnelRefraction,
    /// Reflection at an interface or a metal.
    FresnelReflection,
    /// Reflection beyond the critical angle.
    TotalInternalReflection,
    /// Diffuse reflection.
    LambertianReflection,
    /// Reflection about the normal of a facet.
    LobeReflection,
    /// Mirror reflection about the mean normal.
    SpikeReflection,
    /// Reflection into the direction of incidence.
    BackScattering,
    /// Undeviated transmission.
    Transmission,
    /// Reflection by a measured table.
    LutReflection,
    /// Undeviated transmission by a dichroic filter.
    DichroicTransmission,
    /// Reflection at a thin film.
    CoatedReflection,
    /// Refraction through a thin film.
    CoatedRefraction,
    /// Transmission through a thin film beyond the critical angle of the film.
    CoatedFrustratedTransmission,
    /// A boundary between volumes of the same material.
    SameMaterial,
    /// The end of the photon: the last row of its history.
    End(End),
}

/// The nibbles of Opticks' sequences: 1 plus the number of the bit in `OpticksPhoton.h`. 0 is an empty slot.
mod nibble {
    pub const CERENKOV: u64 = 1;
    pub const SCINTILLATION: u64 = 2;
    pub const MISS: u64 = 3;
    pub const BULK_ABSORB: u64 = 4;
    pub const BULK_REEMIT: u64 = 5;
    pub const BULK_SCATTER: u64 = 6;
    pub const SURFACE_DETECT: u64 = 7;
    pub const SURFACE_ABSORB: u64 = 8;
    pub const SURFACE_DREFLECT: u64 = 9;
    pub const SURFACE_SREFLECT: u64 = 10;
    pub const BOUNDARY_REFLECT: u64 = 11;
    pub const BOUNDARY_TRANSMIT: u64 = 12;
    pub const TORCH: u64 = 13;
}

/// The abbreviations of Opticks' flags by nibble; the first one is that of an empty slot.
const ABBREVIATIONS: [&str; 16] =
    ["", "CK", "SI", "MI", "AB", "RE", "SC", "SD", "SA", "DR", "SR", "BR", "BT", "TO", "NA", "EX"];

/// The abbreviation of an Opticks flag by its slot in sequences; empty for 0 and for numbers above 15.
pub(crate) fn flag_name(nibble: u64) -> &'static str {
    ABBREVIATIONS.get(nibble as usize).copied().unwrap_or("")
}

impl Process {
    /// All processes, by their numbers in tables.
    pub const ALL: [Process; 28] = [
        Process::Emission,
        Process::Cerenkov,
        Process::Scintillation,
        Process::Rayleigh,
        Process::Mie,
        Process::Reemission,
        Process::FresnelRefraction,
        Process::FresnelReflection,
        Process::TotalInternalReflection,
        Process::LambertianReflection,
        Process::LobeReflection,
        Process::SpikeReflection,
        Process::BackScattering,
        Process::Transmission,
        Process::LutReflection,
        Process::DichroicTransmission,
        Process::CoatedReflection,
        Process::CoatedRefraction,
        Process::CoatedFrustratedTransmission,
        Process::SameMaterial,
        Process::End(End::Absorbed),
        Process::End(End::ShifterAbsorbed),
        Process::End(End::SurfaceAbsorbed),
        Process::End(End::NoIndex),
        Process::End(End::Detected),
        Process::End(End::Escaped),
        Process::End(End::StepLimit),
        Process::End(End::TimeLimit),
    ];

    /// The number in tables: the index in [`Process::ALL`].
    #[must_use]
    pub fn number(self) -> usize {
        Process::ALL.iter().position(|own| *own == self).unwrap_or(0)
    }

    /// The name in tables, such as `fresnel_refraction`; that of an end is [`End::name`].
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Process::Emission => "emission",
            Process::Cerenkov => "cerenkov",
            Process::Scintillation => "scintillation",
            Process::Rayleigh => "rayleigh",
            Process::Mie => "mie",
            Process::Reemission => "reemission",
            Process::FresnelRefraction => "fresnel_refraction",
            Process::FresnelReflection => "fresnel_reflection",
            Process::TotalInternalReflection => "total_internal_reflection",
            Process::LambertianReflection => "lambertian_reflection",
            Process::LobeReflection => "lobe_reflection",
            Process::SpikeReflection => "spike_reflection",
            Process::BackScattering => "back_scattering",
            Process::Transmission => "transmission",
            Process::LutReflection => "lut_reflection",
            Process::DichroicTransmission => "dichroic_transmission",
            Process::CoatedReflection => "coated_reflection",
            Process::CoatedRefraction => "coated_refraction",
            Process::CoatedFrustratedTransmission => "coated_frustrated_transmission",
            Process::SameMaterial => "same_material",
            Process::End(end) => end.name(),
        }
    }

    /// The slot of Opticks' sequences (4 bits); 0 for the limits of a run, which Opticks does not record. As in Opticks' recorder of
    /// Geant4, a material without index counts as absorption at a surface.
    #[must_use]
    pub fn nibble(self) -> u64 {
        match self {
            Process::Emission => nibble::TORCH,
            Process::Cerenkov => nibble::CERENKOV,
            Process::Scintillation => nibble::SCINTILLATION,
            Process::Rayleigh | Process::Mie => nibble::BULK_SCATTER,
            Process::Reemission => nibble::BULK_REEMIT,
            Process::FresnelRefraction
            | Process::Transmission
            | Process::DichroicTransmission
            | Process::CoatedRefraction
            | Process::CoatedFrustratedTransmission
            | Process::SameMaterial => nibble::BOUNDARY_TRANSMIT,
            Process::FresnelReflection | Process::TotalInternalReflection | Process::CoatedReflection => {
                nibble::BOUNDARY_REFLECT
            }
            Process::LambertianReflection
            | Process::LobeReflection
            | Process::BackScattering
            | Process::LutReflection => nibble::SURFACE_DREFLECT,
            Process::SpikeReflection => nibble::SURFACE_SREFLECT,
            Process::End(End::Absorbed | End::ShifterAbsorbed) => nibble::BULK_ABSORB,
            Process::End(End::SurfaceAbsorbed | End::NoIndex) => nibble::SURFACE_ABSORB,
            Process::End(End::Detected) => nibble::SURFACE_DETECT,
            Process::End(End::Escaped) => nibble::MISS,
            Process::End(End::StepLimit | End::TimeLimit) => 0,
        }
    }

    /// The bit of the process in Opticks' masks of flags (`OpticksPhoton.h`); 0 for the limits of a run.
    pub(crate) fn flag(self) -> u32 {
        match self.nibble() {
            0 => 0,
            nibble => 1 << (nibble - 1),
        }
    }
}

impl From<BoundaryEvent> for Process {
    fn from(event: BoundaryEvent) -> Process {
        match event {
            BoundaryEvent::FresnelRefraction => Process::FresnelRefraction,
            BoundaryEvent::FresnelReflection => Process::FresnelReflection,
            BoundaryEvent::TotalInternalReflection => Process::TotalInternalReflection,
            BoundaryEvent::LambertianReflection => Process::LambertianReflection,
            BoundaryEvent::LobeReflection => Process::LobeReflection,
            BoundaryEvent::SpikeReflection => Process::SpikeReflection,
            BoundaryEvent::BackScattering => Process::BackScattering,
            BoundaryEvent::Absorption => Process::End(End::SurfaceAbsorbed),
            BoundaryEvent::Detection => Process::End(End::Detected),
            BoundaryEvent::Transmission => Process::Transmission,
            BoundaryEvent::LutReflection => Process::LutReflection,
            BoundaryEvent::Dichroic => Process::DichroicTransmission,
            BoundaryEvent::CoatedReflection => Process::CoatedReflection,
            BoundaryEvent::CoatedRefraction => Process::CoatedRefraction,
            BoundaryEvent::CoatedFrustratedTransmission => Process::CoatedFrustratedTransmission,
            BoundaryEvent::SameMaterial => Process::SameMaterial,
            BoundaryEvent::NoIndex => Process::End(End::NoIndex),
        }
    }
}

/// The contents of histories. Counts are always part of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HistoryOptions {
    /// Whether all steps are recorded: about 150 bytes each.
    pub steps: bool,
    /// Whether the sequence of flags of each photon is recorded: 32 bytes each.
    pub sequences: bool,
}

/// A row of a history: the photon after a process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepRow {
    /// The number of the photon in the run; all photons of a wavelength shifter have that of the absorbed one.
    pub photon: i64,
    /// The number of the track: equal to `photon`, and a number of 2^62 or more for further photons of a wavelength shifter.
    pub track: i64,
    /// The number of steps so far; 0 at the emission.
    pub step: u32,
    /// The process.
    pub process: Process,
    /// The position in mm.
    pub position: Vec3,
    /// The time in ns.
    pub time: f64,
    /// The direction after the process.
    pub direction: Vec3,
    /// The polarisation after the process.
    pub polarisation: Vec3,
    /// The wavelength in nm after the process.
    pub wavelength_nm: f64,
    /// The volume that the step led through, as an index into [`Histories::volumes`]; for a photon detected on entering a
    /// sensitive volume, that volume.
    pub volume: u32,
    /// The number of the optical surface at the end of the step; `None` in a volume and at bare interfaces.
    pub surface: Option<u32>,
}

/// The sequence of flags of a photon in Opticks' layout: 4 bits for each of the first 32 rows of its history.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sequence {
    /// The number of the photon in the run.
    pub photon: i64,
    /// The number of the track, as in [`StepRow::track`].
    pub track: i64,
    /// The slots: row k is in bits 4 (k mod 16) to 4 (k mod 16) + 3 of word k div 16. A slot is 1 plus the number of the flag's bit
    /// in Opticks' `OpticksPhoton.h`, and 0 after the end.
    pub words: [u64; 2],
}

/// The number of slots of a sequence.
const SLOTS: usize = 32;

/// Histories of photons.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Histories {
    /// The steps, by photon, track and step.
    pub steps: Vec<StepRow>,
    /// The sequences, by photon and track.
    pub sequences: Vec<Sequence>,
    /// The number of rows by process.
    pub processes: BTreeMap<Process, u64>,
    /// The flags of all rows of each detected photon as a mask of the bits in `OpticksPhoton.h`, in the order of the hits.
    pub hit_flags: Vec<u32>,
    /// The number of boundary events by optical surface (`None`: bare interfaces) and process.
    pub surfaces: BTreeMap<(Option<u32>, Process), u64>,
    volumes: VolumePaths,
}

impl Histories {
    /// The paths of volumes: names and copy numbers of the placements that lead to them.
    #[must_use]
    pub fn volumes(&self) -> &[Arc<str>] {
        self.volumes.names()
    }

    /// Appends the histories of further photons.
    pub fn append(&mut self, other: Histories) {
        let numbers = self.volumes.absorb(&other.volumes);
        let renumbered = |row: StepRow| StepRow { volume: numbers[row.volume as usize], ..row };
        self.steps.extend(other.steps.into_iter().map(renumbered));
        self.sequences.extend(other.sequences);
        self.hit_flags.extend(other.hit_flags);
        for (process, count) in other.processes {
            *self.processes.entry(process).or_default() += count;
        }
        for (key, count) in other.surfaces {
            *self.surfaces.entry(key).or_default() += count;
        }
    }
}

/// The text of a sequence: abbreviations of Opticks' flags, such as `TO BT SD`.
///
/// ```
/// assert_eq!(rayweave_photon::sequence_text([0x7cd, 0]), "TO BT SD");
/// ```
#[must_use]
pub fn sequence_text(words: [u64; 2]) -> String {
    let slots = (0..SLOTS).map(|slot| (words[slot / 16] >> (4 * (slot % 16))) & 15);
    let names = slots.take_while(|&nibble| nibble != 0).map(|nibble| ABBREVIATIONS[nibble as usize]);
    let mut names: Vec<&str> = names.collect();
    // absorption, detection, absorption at a surface, a miss, a volume without an index and an error end a photon
    let is_cut = names.len() == SLOTS
        && names.last().is_some_and(|last| !["AB", "SD", "SA", "MI", "NA", "EX"].contains(last));
    names.extend(is_cut.then_some("..."));
    names.join(" ")
}

/// The hooks of the loop over photons.
pub(crate) trait Recorder: Clone + Send + Sync {
    /// True if anything is recorded.
    const RECORDS: bool;
    /// A step begins in the region of the photon, with the crossing at its end unless a process comes first.
    fn begin(&mut self, detector: &Detector, flight: &Flight, crossing: Option<&Crossing>);
    /// A process that changes or ends a photon, at the surface of a crossing or in the volume.
    fn record(&mut self, detector: &Detector, flight: &Flight, process: Process, at: Option<&Crossing>);
    /// A photon ends because it enters a sensitive volume.
    fn enter_sensor(&mut self, detector: &Detector, flight: &Flight, crossing: &Crossing);
    /// The histories of a batch.
    fn take(&mut self) -> Option<Histories>;
}

impl Recorder for () {
    const RECORDS: bool = false;

    fn begin(&mut self, _: &Detector, _: &Flight, _: Option<&Crossing>) {}
    fn record(&mut self, _: &Detector, _: &Flight, _: Process, _: Option<&Crossing>) {}
    fn enter_sensor(&mut self, _: &Detector, _: &Flight, _: &Crossing) {}
    fn take(&mut self) -> Option<Histories> {
        None
    }
}

/// The recorder of a run with histories.
#[derive(Clone, Debug)]
pub(crate) struct HistoryRecorder<'s> {
    options: HistoryOptions,
    /// The source, which tells how a photon is emitted.
    source: &'s Source,
    histories: Histories,
    /// The rows of each track so far, and its sequence.
    sequences: HashMap<(u64, u64), (usize, [u64; 2])>,
    /// The flags of each track in flight.
    flags: HashMap<(u64, u64), u32>,
    /// The number, the steps and the flags of each detected photon.
    detected: Vec<(u64, u32, u32)>,
    volume: u32,
}

impl<'s> HistoryRecorder<'s> {
    pub fn new(options: HistoryOptions, source: &'s Source) -> HistoryRecorder<'s> {
        let (histories, sequences, flags) = (Histories::default(), HashMap::new(), HashMap::new());
        HistoryRecorder { options, source, histories, sequences, flags, detected: Vec::new(), volume: 0 }
    }

    /// The process that emits a photon of the source.
    fn emission(&self, photon: u64) -> Process {
        match self.source {
            Source::Gensteps(gensteps) if gensteps.is_cerenkov(photon) => Process::Cerenkov,
            Source::Gensteps(_) => Process::Scintillation,
            Source::Torch(_) | Source::Photons(_) => Process::Emission,
        }
    }

    fn row(&mut self, flight: &Flight, process: Process, surface: Option<u32>) {
        *self.histories.processes.entry(process).or_default() += 1;
        let flags = self.flags.entry((flight.origin, flight.number)).or_default();
        *flags |= process.flag();
        if let Process::End(end) = process {
            let flags = self.flags.remove(&(flight.origin, flight.number)).unwrap_or_default();
            self.detected.extend((end == End::Detected).then_some((flight.origin, flight.steps, flags)));
        }
        if self.options.sequences {
            let (rows, words) = self.sequences.entry((flight.origin, flight.number)).or_default();
            if *rows < SLOTS {
                words[*rows / 16] |= process.nibble() << (4 * (*rows % 16));
            }
            *rows += 1;
        }
        if self.options.steps {
            let photon = &flight.photon;
            self.histories.steps.push(StepRow {
                photon: flight.origin as i64,
                track: flight.number as i64,
                step: flight.steps,
                process,
                position: photon.position,
                time: photon.time,
                direction: photon.direction,
                polarisation: photon.polarisation,
                wavelength_nm: wavelength_nm(photon.energy),
                volume: self.volume,
                surface,
            });
        }
    }
}

impl Recorder for HistoryRecorder<'_> {
    const RECORDS: bool = true;

    fn begin(&mut self, detector: &Detector, flight: &Flight, crossing: Option<&Crossing>) {
        if self.options.steps {
            let volumes = &mut self.histories.volumes;
            self.volume = match crossing {
                None => volumes.number(detector, flight.region, None),
                Some(crossing) => {
                    let ray = flight.photon.ray();
                    let back = Ray::new(ray.at(crossing.t), -ray.direction);
                    volumes.number_entered(detector, flight.region, crossing.left, &back)
                }
            };
        }
        if flight.steps == 0 {
            self.row(flight, self.emission(flight.origin), None);
        }
    }

    fn record(&mut self, detector: &Detector, flight: &Flight, process: Process, at: Option<&Crossing>) {
        let surface = at.and_then(|crossing| detector.surface_number(crossing));
        if at.is_some() {
            *self.histories.surfaces.entry((surface, process)).or_default() += 1;
        }
        self.row(flight, process, surface);
    }

    fn enter_sensor(&mut self, detector: &Detector, flight: &Flight, crossing: &Crossing) {
        if self.options.steps {
            let (volumes, ray) = (&mut self.histories.volumes, flight.photon.ray());
            self.volume = volumes.number_entered(detector, crossing.after.0, crossing.entered, &ray);
        }
        self.row(flight, Process::End(End::Detected), None);
    }

    fn take(&mut self) -> Option<Histories> {
        let mut histories = std::mem::take(&mut self.histories);
        // by photon, whatever the number of steps; rows of one step keep their order
        histories.steps.sort_by_key(|row| (row.photon, row.track, row.step));
        // as the hits
        self.detected.sort_by_key(|&(photon, steps, _)| (photon, steps));
        histories.hit_flags = self.detected.drain(..).map(|(.., flags)| flags).collect();
        let sequence = |((photon, track), (_, words)): ((u64, u64), (usize, [u64; 2]))| Sequence {
            photon: photon as i64,
            track: track as i64,
            words,
        };
        histories.sequences = self.sequences.drain().map(sequence).collect();
        histories.sequences.sort_by_key(|sequence| (sequence.photon, sequence.track));
        Some(histories)
    }
}
