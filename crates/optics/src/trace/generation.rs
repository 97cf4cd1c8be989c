//! The rays of one generation as columns: geometry, payload and start lists.

use super::splitmix::splitmix64;
use crate::beam::{Beam, Light};
use crate::bundle::TransmittedRays;
use crate::interface::Stokes;
use crate::segments::{Event, Segment};
use rayweave_model::{Face, RayBatch, Rays, Start, StartLists};
use rayweave_shape::Ray;
use rayweave_shape::lanes::LANES;
use std::ops::Range;

/// The payload of a ray: all of its state but geometry and polarisation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Payload {
    pub wavelength_nm: f64,
    pub power: f64,
    /// The optical path length from the source.
    pub path: f64,
    pub id: i64,
    /// The row of the segment before; -1 for none.
    pub parent: i64,
    /// The key of its random numbers.
    pub stream: u64,
    pub source: u32,
    /// The number of events so far.
    pub generation: u32,
}

/// A ray of light between two events: geometry, payload and polarisation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayState {
    pub ray: Ray,
    pub payload: Payload,
    pub stokes: Option<Stokes>,
}

impl RayState {
    /// A segment of the ray; element, surface and event at its end are filled in later.
    pub fn segment(&self, (from, to): (f64, f64), intensity: f64, index: f64) -> Segment {
        let RayState { ray, payload, .. } = self;
        Segment {
            id: payload.id,
            parent: payload.parent,
            generation: payload.generation,
            source: payload.source,
            wavelength_nm: payload.wavelength_nm,
            intensity,
            index,
            start: ray.at(from),
            end: ray.at(to),
            direction: ray.direction,
            path: payload.path,
            element: -1,
            surface: -1,
            event: Event::Escaped,
        }
    }
}

/// The sheet that a ray starts on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SheetStart {
    pub ray: usize,
    pub sheet: usize,
    pub start: Start,
}

/// The rays of one generation, whose next hits the evaluator computes together.
#[derive(Debug)]
pub(crate) struct Generation {
    pub rays: RayBatch,
    pub payloads: Payloads,
    /// One for each ray; empty if polarisation is not traced.
    stokes: Vec<Stokes>,
    first: Vec<u32>,
    /// The surfaces of solids on which the rays start; those of a ray are appended before the ray.
    pub starts: Vec<Start>,
    pub sheet_starts: Vec<SheetStart>,
}

/// [`Payload`]s as columns.
#[derive(Debug, Default)]
pub(crate) struct Payloads {
    pub wavelength_nm: Vec<f64>,
    pub power: Vec<f64>,
    pub path: Vec<f64>,
    pub id: Vec<i64>,
    pub parent: Vec<i64>,
    pub stream: Vec<u64>,
    pub source: Vec<u32>,
    pub generation: Vec<u32>,
}

impl Payloads {
    fn clear(&mut self) {
        self.wavelength_nm.clear();
        self.power.clear();
        self.path.clear();
        self.id.clear();
        self.parent.clear();
        self.stream.clear();
        self.source.clear();
        self.generation.clear();
    }

    fn push(&mut self, payload: Payload) {
        self.wavelength_nm.push(payload.wavelength_nm);
        self.power.push(payload.power);
        self.path.push(payload.path);
        self.id.push(payload.id);
        self.parent.push(payload.parent);
        self.stream.push(payload.stream);
        self.source.push(payload.source);
        self.generation.push(payload.generation);
    }
}

impl Default for Generation {
    fn default() -> Generation {
        Generation {
            rays: RayBatch::default(),
            payloads: Payloads::default(),
            stokes: Vec::new(),
            first: vec![0],
            starts: Vec::new(),
            sheet_starts: Vec::new(),
        }
    }
}

impl Generation {
    pub fn len(&self) -> usize {
        self.payloads.id.len()
    }

    pub fn clear(&mut self) {
        self.rays.clear();
        self.payloads.clear();
        self.stokes.clear();
        self.first.truncate(1);
        self.starts.clear();
        self.sheet_starts.clear();
    }

    /// Appends rays of a beam, the first of which has the number `first`, with directions of unit length.
    pub fn append_beam(&mut self, beam: &Beam, range: Range<usize>, first: u64, polarised: bool) {
        let (rays, payloads) = (beam.rays(), &mut self.payloads);
        payloads.wavelength_nm.extend_from_slice(&beam.wavelengths_nm()[range.clone()]);
        payloads.power.extend_from_slice(&beam.powers()[range.clone()]);
        payloads.source.extend_from_slice(&beam.sources()[range.clone()]);
        let numbers = range.clone().map(|i| first + i as u64);
        payloads.id.extend(numbers.clone().map(|number| number as i64));
        payloads.stream.extend(numbers.map(splitmix64));
        let count = payloads.id.len();
        payloads.path.resize(count, 0.0);
        payloads.parent.resize(count, -1);
        payloads.generation.resize(count, 0);
        self.first.resize(count + 1, self.starts.len() as u32);
        let part = |columns: [_; 3]| columns.map(|column: &[f64]| &column[range.clone()]);
        let (origins, directions) = (part(rays.origins), part(rays.directions));
        self.rays.extend_normalised(Rays { origins, directions });
        for i in range.filter(|_| polarised) {
            let Light { ray, power, stokes, .. } = beam.get(i);
            let known = stokes.map(|stokes| stokes.with_power(power));
            self.stokes.push(known.unwrap_or(Stokes::unpolarised(power, ray.direction.normalize())));
        }
    }

    /// Appends all rays of another generation that start on no sheets.
    pub fn append(&mut self, other: &Generation) {
        let lists = StartLists { first: &other.first, entries: &other.starts };
        for i in 0..other.len() {
            self.starts.extend_from_slice(lists.of(i));
            let RayState { ray, payload, stokes } = other.get(i);
            self.push(ray, payload, stokes);
        }
    }

    /// Appends a ray that starts on the surfaces appended to `starts` since the ray before.
    pub fn push(&mut self, ray: Ray, payload: Payload, stokes: Option<Stokes>) {
        self.rays.push(ray);
        self.payloads.push(payload);
        self.stokes.extend(stokes);
        self.first.push(self.starts.len() as u32);
    }

    /// Appends rays `at..at + 8` of another generation after their transmission by a face, with new
    /// powers and geometry. `parent` is the row of the first, or none.
    pub fn append_transmitted(
        &mut self,
        other: &Payloads,
        at: usize,
        powers: &[f64; LANES],
        transmitted: &TransmittedRays,
        face: Face,
        parent: Option<i64>,
    ) {
        let (here, payloads) = (at..at + LANES, &mut self.payloads);
        payloads.wavelength_nm.extend_from_slice(&other.wavelength_nm[here.clone()]);
        payloads.power.extend_from_slice(powers);
        payloads.id.extend_from_slice(&other.id[here.clone()]);
        payloads.stream.extend_from_slice(&other.stream[here.clone()]);
        payloads.source.extend_from_slice(&other.source[here.clone()]);
        payloads.generation.extend(other.generation[here].iter().map(|generation| generation + 1));
        self.append_rays(transmitted, Some(face), parent);
    }

    /// Appends rays `at..at + 8` of a beam, the first of which has the number `first`, with their
    /// powers and geometry after a number of events, the last one at a face.
    pub fn append_bundle(
        &mut self,
        (beam, first): (&Beam, u64),
        at: usize,
        (powers, transmitted): (&[f64; LANES], &TransmittedRays),
        (events, face): (u32, Option<Face>),
        parent: Option<i64>,
    ) {
        let (here, payloads) = (at..at + LANES, &mut self.payloads);
        payloads.wavelength_nm.extend_from_slice(&beam.wavelengths_nm()[here.clone()]);
        payloads.power.extend_from_slice(powers);
        payloads.source.extend_from_slice(&beam.sources()[here.clone()]);
        let numbers = here.map(|i| first + i as u64);
        payloads.id.extend(numbers.clone().map(|number| number as i64));
        payloads.stream.extend(numbers.map(splitmix64));
        payloads.generation.extend([events; LANES]);
        self.append_rays(transmitted, face, parent);
    }

    /// Appends the geometry, optical paths, parents and start lists of eight rays.
    fn append_rays(&mut self, transmitted: &TransmittedRays, face: Option<Face>, parent: Option<i64>) {
        self.rays.extend(transmitted.rays(), 0..LANES);
        self.payloads.path.extend_from_slice(&transmitted.path);
        for lane in 0..LANES {
            self.payloads.parent.push(parent.map_or(-1, |parent| parent + lane as i64));
            let inside = transmitted.inside >> lane & 1 == 1;
            self.starts.extend(face.map(|face| Start {
                surface: face.surface,
                placement: face.placement,
                inside,
            }));
            self.first.push(self.starts.len() as u32);
        }
    }

    pub fn payload(&self, i: usize) -> Payload {
        let Payloads { wavelength_nm, power, path, id, parent, stream, source, generation } = &self.payloads;
        Payload {
            wavelength_nm: wavelength_nm[i],
            power: power[i],
            path: path[i],
            id: id[i],
            parent: parent[i],
            stream: stream[i],
            source: source[i],
            generation: generation[i],
        }
    }

    pub fn get(&self, i: usize) -> RayState {
        RayState {
            ray: self.rays.rays().get(i),
            payload: self.payload(i),
            stokes: self.stokes.get(i).copied(),
        }
    }

    /// The start list of a ray.
    pub fn starts_of(&self, i: usize) -> &[Start] {
        StartLists { first: &self.first, entries: &self.starts }.of(i)
    }

    pub fn start_lists(&self) -> Option<StartLists<'_>> {
        let lists = StartLists { first: &self.first, entries: &self.starts };
        (!self.starts.is_empty()).then_some(lists)
    }
}

/// Rays of a beam that fall back to the evaluator, by the generation that they have reached.
#[derive(Debug, Default)]
pub(crate) struct Pending(Vec<Generation>);

impl Pending {
    /// The rays that join a generation.
    pub fn at(&mut self, generation: usize) -> &mut Generation {
        if self.0.len() <= generation {
            self.0.resize_with(generation + 1, Generation::default);
        }
        &mut self.0[generation]
    }

    /// The number of generations that rays may join.
    pub fn generations(&self) -> usize {
        self.0.len()
    }
}
