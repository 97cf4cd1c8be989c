//! The photons in flight of a batch: a [`Photon`] and a [`Mark`] for each of them.

use crate::flight::Flight;
use crate::philox::Counter;
use crate::photon::{EventKey, Photon};
use rayweave_model::Start;
use rayweave_optics::start_surfaces::StartSurfaces;

/// The numbers of a photon in a batch, beside its [`Photon`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    /// The number of the photon in [`Numbers`].
    pub number: u32,
    /// As in [`Flight`].
    pub steps: u32,
    pub place: Place,
}

/// The start of the next step of a photon: the kind in the two highest bits, and a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place(u32);

/// The lowest bit of the kind of a place, and the bits of its value.
const KIND: u32 = 30;
const VALUE: u32 = (1 << KIND) - 1;
/// No surface; the value is the region in which the photon probably is.
const IN_REGION: u32 = 0;
/// One surface; the value is its place in the list of [`StartSurfaces`] and, in the lowest bit, 1 if f < 0 just after the start.
const ON_SURFACE: u32 = 1;
/// The surfaces of a list; the value is its number in [`SurfaceLists`].
const ON_LIST: u32 = 2;

impl Place {
    /// In a region that is not known.
    pub const UNKNOWN: Place = Place(VALUE);

    /// On no surface, in a region; `u32::MAX` if that is not known.
    #[inline]
    pub fn in_region(region: u32) -> Place {
        Place(region.min(VALUE))
    }

    /// On one surface; `None` for surfaces that a place cannot express.
    #[inline]
    pub fn on(start: &Start, all: &StartSurfaces) -> Option<Place> {
        let place = all.place(start.surface, start.placement)?;
        (place <= VALUE >> 1).then_some(Place(ON_SURFACE << KIND | place << 1 | u32::from(start.inside)))
    }

    /// The region in which a photon on no surface probably is; `u32::MAX` if that is not known, and for other photons.
    #[inline]
    pub fn region(self) -> u32 {
        if self.0 < VALUE { self.0 } else { u32::MAX }
    }

    /// True on no surface.
    #[inline]
    pub fn is_free(self) -> bool {
        self.0 >> KIND == IN_REGION
    }

    /// The surface, if it is one.
    #[inline]
    pub fn start(self, all: &StartSurfaces) -> Option<Start> {
        if self.0 >> KIND != ON_SURFACE {
            return None;
        }
        let (surface, placement) = all.placed((self.0 & VALUE) >> 1);
        Some(Start { surface, placement, inside: self.0 & 1 == 1 })
    }
}

/// Lists of several start surfaces, one after the other: few photons start on an edge.
#[derive(Debug, Default)]
pub(crate) struct SurfaceLists {
    entries: Vec<Start>,
    /// The end of each list.
    ends: Vec<u32>,
}

impl SurfaceLists {
    pub fn clear(&mut self) {
        self.entries.clear();
        self.ends.clear();
    }

    /// The place of a photon on some surfaces, in a region if there are none.
    #[inline]
    pub fn place(&mut self, starts: &[Start], region: u32, all: &StartSurfaces) -> Place {
        match starts {
            [] => Place::in_region(region),
            [start] => Place::on(start, all).unwrap_or_else(|| self.add(starts)),
            _ => self.add(starts),
        }
    }

    #[cold]
    fn add(&mut self, starts: &[Start]) -> Place {
        self.entries.extend_from_slice(starts);
        self.ends.push(self.entries.len() as u32);
        Place(ON_LIST << KIND | (self.ends.len() - 1) as u32)
    }

    /// The list of a place; empty for places of other kinds.
    pub fn of(&self, place: Place) -> &[Start] {
        if place.0 >> KIND != ON_LIST {
            return &[];
        }
        let number = (place.0 & VALUE) as usize;
        let first = number.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.entries[first as usize..self.ends[number] as usize]
    }
}

/// The numbers of the photons of a batch: those of the source follow each other.
#[derive(Debug)]
pub(crate) struct Numbers {
    key: EventKey,
    /// The number of the first photon of the batch.
    first: u64,
    /// The `origin` and the `number` of other photons, as in [`Flight`].
    others: Vec<[u64; 2]>,
}

/// The bit of the numbers of photons in [`Numbers::others`].
const OTHER: u32 = 1 << 31;

impl Numbers {
    pub fn new(key: EventKey) -> Numbers {
        Numbers { key, first: 0, others: Vec::new() }
    }

    /// Begins a batch with the number of its first photon.
    pub fn begin(&mut self, first: u64) {
        self.first = first;
        self.others.clear();
    }

    /// The number for a mark of a photon that is not the one at its place in the batch.
    pub fn add(&mut self, origin: u64, number: u64) -> u32 {
        self.others.push([origin, number]);
        OTHER | (self.others.len() - 1) as u32
    }

    /// Removes the numbers of photons that have ended, if they are many.
    pub fn shrink(&mut self, marks: &mut [Mark]) {
        if self.others.len() <= 2 * marks.len() {
            return;
        }
        let old = std::mem::take(&mut self.others);
        for mark in marks.iter_mut().filter(|mark| mark.number & OTHER != 0) {
            let [origin, number] = old[(mark.number & !OTHER) as usize];
            mark.number = self.add(origin, number);
        }
    }

    /// As [`Flight::origin`].
    #[inline]
    pub fn origin(&self, mark: &Mark) -> u64 {
        match mark.number & OTHER {
            0 => self.first + u64::from(mark.number),
            _ => self.others[(mark.number & !OTHER) as usize][0],
        }
    }

    /// As [`Flight::number`].
    #[inline]
    pub fn number(&self, mark: &Mark) -> u64 {
        match mark.number & OTHER {
            0 => self.key.number(self.first + u64::from(mark.number)),
            _ => self.others[(mark.number & !OTHER) as usize][1],
        }
    }

    /// The counter of the random numbers of a photon in its present step.
    #[inline]
    pub fn counter(&self, mark: &Mark) -> Counter {
        let number = self.number(mark);
        [(number >> 32) as u32, number as u32, mark.steps]
    }

    /// A photon with its numbers.
    pub fn flight(&self, photon: &Photon, mark: &Mark) -> Flight {
        Flight {
            origin: self.origin(mark),
            number: self.number(mark),
            steps: mark.steps,
            region: mark.place.region(),
            photon: *photon,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number in `docs/reference/photon-validation.md`.
    #[test]
    fn a_photon_in_flight_takes_100_bytes() {
        assert_eq!(size_of::<Photon>() + size_of::<Mark>(), 100);
    }
}
