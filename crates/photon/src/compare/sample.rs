//! Samples of photons: what a comparison uses of a table.

use crate::flight::End;
use crate::history::{Process, flag_name};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The meaning of the codes of histories.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alphabet {
    /// The numbers of processes, [`Process::ALL`].
    Processes,
    /// Slots of Opticks' sequences: the first 32 rows of a history.
    Flags,
}

/// The number of rows that Opticks' sequences have.
const FLAG_ROWS: usize = 32;

impl Alphabet {
    /// The name of a code; empty for a number that none has.
    #[must_use]
    pub fn name(self, code: u8) -> &'static str {
        match self {
            Alphabet::Processes => Process::ALL.get(usize::from(code)).map_or("", |process| process.name()),
            Alphabet::Flags => flag_name(u64::from(code)),
        }
    }

    /// True if a history that ends in this code is that of a detected photon.
    fn is_detection(self, code: u8) -> bool {
        let detected = Process::End(End::Detected);
        match self {
            Alphabet::Processes => usize::from(code) == detected.number(),
            Alphabet::Flags => u64::from(code) == detected.nibble(),
        }
    }

    /// The codes of a history of processes as flags.
    fn flags(codes: &[u8]) -> Vec<u8> {
        let nibble =
            |&code: &u8| Process::ALL.get(usize::from(code)).map_or(0, |process| process.nibble() as u8);
        codes.iter().map(nibble).take_while(|&nibble| nibble != 0).take(FLAG_ROWS).collect()
    }
}

/// A track of a photon. Further photons of a wavelength shifter are tracks of their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SampleTrack {
    /// The number of the photon.
    pub photon: i64,
    /// The codes of the history; empty if the sample has none. Tracks with equal histories should share them: samples have far
    /// fewer histories than tracks.
    pub history: Arc<[u8]>,
    /// The volume of the end: an index into [`PhotonSample::volumes`].
    pub volume: u32,
    /// The time of the end in ns.
    pub time: f64,
    /// The wavelength at the end in nm.
    pub wavelength_nm: f64,
}

/// Histories that tracks share.
#[derive(Debug, Default)]
pub(super) struct SharedHistories(HashSet<Arc<[u8]>>);

impl SharedHistories {
    /// The shared history with these codes.
    pub fn share(&mut self, codes: &[u8]) -> Arc<[u8]> {
        if let Some(known) = self.0.get(codes) {
            return known.clone();
        }
        let history: Arc<[u8]> = codes.into();
        self.0.insert(history.clone());
        history
    }
}

/// A sample of photons.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotonSample {
    /// The name in reports, such as that of the file.
    pub name: String,
    /// The meaning of the codes; `None` without histories.
    pub alphabet: Option<Alphabet>,
    /// The tracks by photon.
    pub tracks: Vec<SampleTrack>,
    /// The names of the volumes; `None` without volumes.
    pub volumes: Option<Vec<String>>,
    /// Whether the tracks have times and wavelengths.
    pub has_times: bool,
    /// Whether the photons have numbers.
    pub has_numbers: bool,
    /// Whether times and wavelengths are rounded to single precision.
    pub is_single: bool,
    /// Whether the sample has only detected photons.
    pub is_hits: bool,
}

impl PhotonSample {
    pub(super) fn new(name: &str) -> PhotonSample {
        PhotonSample {
            name: name.to_owned(),
            alphabet: None,
            tracks: Vec::new(),
            volumes: None,
            has_times: false,
            has_numbers: true,
            is_single: false,
            is_hits: false,
        }
    }

    /// The number of photons: further photons of a wavelength shifter do not count.
    #[must_use]
    pub fn photons(&self) -> u64 {
        match self.has_numbers {
            true => self.tracks.chunk_by(|a, b| a.photon == b.photon).count() as u64,
            false => self.tracks.len() as u64,
        }
    }

    /// The detected tracks.
    pub(super) fn detected(&self) -> PhotonSample {
        let is_detected = |track: &&SampleTrack| match (self.alphabet, track.history.last()) {
            (Some(alphabet), Some(&last)) => alphabet.is_detection(last),
            _ => self.is_hits,
        };
        let tracks = self.tracks.iter().filter(is_detected).cloned().collect();
        PhotonSample { tracks, alphabet: None, is_hits: true, ..self.head() }
    }

    /// The sample with the histories as flags.
    pub(super) fn as_flags(&self) -> PhotonSample {
        let mut known: HashMap<Arc<[u8]>, Arc<[u8]>> = HashMap::new();
        let mut flags = |track: &SampleTrack| match self.alphabet {
            Some(Alphabet::Processes) => {
                let own = known.entry(track.history.clone());
                let history = own.or_insert_with_key(|codes| Alphabet::flags(codes).into()).clone();
                SampleTrack { history, ..track.clone() }
            }
            _ => track.clone(),
        };
        PhotonSample {
            tracks: self.tracks.iter().map(&mut flags).collect(),
            alphabet: self.alphabet.map(|_| Alphabet::Flags),
            ..self.head()
        }
    }

    /// The sample without its tracks.
    fn head(&self) -> PhotonSample {
        PhotonSample { tracks: Vec::new(), name: self.name.clone(), volumes: self.volumes.clone(), ..*self }
    }
}
