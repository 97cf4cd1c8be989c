//! The results of runs.

use crate::boundary::BoundaryEvent;
use crate::flight::End;
use crate::history::Histories;
use crate::hits::Hits;
use std::collections::BTreeMap;
use std::ops::Range;

/// The result of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PhotonRun {
    /// The number of photons, with those that wavelength shifters emitted in addition to one per absorption.
    pub photons: u64,
    /// The number of steps of all photons.
    pub steps: u64,
    /// The detected photons.
    pub hits: Hits,
    /// The number of photons by way of ending; the sum is `photons`.
    pub ends: BTreeMap<End, u64>,
    /// The number of boundary events by kind.
    pub boundary_events: BTreeMap<BoundaryEvent, u64>,
}

impl PhotonRun {
    /// Appends the result of a run of further photons.
    pub fn append(&mut self, other: PhotonRun) {
        self.photons += other.photons;
        self.steps += other.steps;
        self.hits.append(other.hits);
        for (end, count) in other.ends {
            *self.ends.entry(end).or_default() += count;
        }
        for (event, count) in other.boundary_events {
            *self.boundary_events.entry(event).or_default() += count;
        }
    }
}

/// The result of a run for consecutive photons.
#[derive(Clone, Debug)]
pub struct PhotonPart {
    /// The numbers of the photons.
    pub photons: Range<u64>,
    /// The result.
    pub run: PhotonRun,
    /// The histories, if they are recorded.
    pub histories: Option<Histories>,
}
