//! Propagation: the loop of a batch of photons from event to event.
//!
//! All photons of a batch advance together, step by step: the next crossings of all of them, then the process with
//! the shortest free path or the boundary, then the photons that have ended are removed.

use crate::boundary::{
    AtBoundary, Boundary, BoundaryEvent, Departed, LaneBoundaries, LaneSurface, PlanePoint,
};
use crate::box_steps::{BatchPhotons, BoxSteps};
use crate::detector::{DetectionRule, Detector, Meeting};
use crate::draws::{Draws, LEAST_EXPONENTIAL, counter, exponential};
use crate::error::PhotonError;
use crate::flight::{End, Flight};
use crate::history::{Histories, HistoryOptions, HistoryRecorder, Process, Recorder};
use crate::hits::Hits;
use crate::material::{Bulk, MaterialValues, OpticalMaterial, ValueTable};
use crate::philox::{Purpose, Stream};
use crate::photon::{EventKey, Photon};
use crate::scatter::{self, LaneScattering};
use crate::settings::{RunSettings, TimeProfile};
use crate::source::{Source, turned};
use crate::volume::VolumePaths;
use rayweave_math::Vec3;
use rayweave_model::drive::{Stopped, drive, thread_count};
use rayweave_model::memory::{Growth, Shortage};
use rayweave_model::{
    Crossing, Evaluator, Face, FirstHitColumns, PlacementId, Query, RayBatch, RegionId, Start, StartLists,
};
use rayweave_optics::start_surfaces::ExitSide;
use std::collections::BTreeMap;
use std::ops::Range;

/// The number of photons that advance together.
pub(crate) const BATCH: u64 = 4096;

/// The number of photons of a batch for which the next crossings are found together: their columns stay in the cache.
const CHUNK: usize = 1024;

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

/// Simulates photons of a source with an evaluator of the program of the detector.
///
/// The result is a function of the detector, the source, the seed, the limits and the photon numbers: it does not
/// depend on the number of threads.
///
/// # Errors
///
/// [`PhotonError::Setting`] for invalid photons and limits, [`PhotonError::Memory`], [`PhotonError::Cancelled`].
pub fn simulate<E: Evaluator>(
    detector: &Detector,
    evaluator: &E,
    source: &Source,
    settings: &RunSettings,
) -> Result<PhotonRun, PhotonError> {
    let (mut total, mut growth) = (PhotonRun::default(), Growth::default());
    simulate_parts(detector, evaluator, source, settings, None, |part| -> Result<(), PhotonError> {
        total.append(part.run);
        Ok(growth.check(total.hits.len() as u64 * Hits::ROW)?)
    })?;
    Ok(total)
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

/// Like [`simulate`], but passes the result to `merge` in parts of a few thousand photons, in the order of their numbers:
/// memory does not grow with the number of photons. Records histories if there are options for them; recording does not
/// change the photons.
///
/// # Errors
///
/// Those of [`simulate`], and those of `merge`, which end the run.
pub fn simulate_parts<E: Evaluator, X: From<PhotonError>>(
    detector: &Detector,
    evaluator: &E,
    source: &Source,
    settings: &RunSettings,
    histories: Option<HistoryOptions>,
    merge: impl FnMut(PhotonPart) -> Result<(), X>,
) -> Result<(), X> {
    match histories {
        None => run_batches(detector, evaluator, source, settings, &(), merge),
        Some(options) => {
            run_batches(detector, evaluator, source, settings, &HistoryRecorder::new(options, source), merge)
        }
    }
}

fn run_batches<E: Evaluator, R: Recorder, X: From<PhotonError>>(
    detector: &Detector,
    evaluator: &E,
    source: &Source,
    settings: &RunSettings,
    recorder: &R,
    mut merge: impl FnMut(PhotonPart) -> Result<(), X>,
) -> Result<(), X> {
    check(source, settings)?;
    let Range { start, end } = settings.photons;
    // an empty range gives one empty part: its columns are those of other parts
    let chunks = (0..(end.saturating_sub(start)).div_ceil(BATCH).max(1))
        .map(|k| start + k * BATCH..(start + (k + 1) * BATCH).min(end.max(start)));
    let work = |batch: &mut Batch<'_, E, R>, numbers: Range<u64>| -> Result<PhotonPart, Shortage> {
        let run = batch.run(source, numbers.clone())?;
        Ok(PhotonPart { photons: numbers, run, histories: batch.recorder.take() })
    };
    drive(
        thread_count(settings.threads),
        &settings.cancel,
        chunks,
        || Batch::new(detector, evaluator, settings, recorder.clone()),
        work,
        |part| merge(part.map_err(PhotonError::from)?),
    )
    .map_err(|stopped| match stopped {
        Stopped::Cancelled => PhotonError::Cancelled.into(),
        Stopped::Failed(error) => error,
    })
}

/// Checks the source and the settings of a run.
pub(crate) fn check(source: &Source, settings: &RunSettings) -> Result<(), PhotonError> {
    source.check()?;
    source.check_range(&settings.photons)?;
    if settings.max_time.is_nan() || settings.max_time <= 0.0 {
        let problem = format!("the maximum time is {} ns", settings.max_time);
        return Err(PhotonError::setting(problem, "it must be positive"));
    }
    Ok(())
}

/// A batch of photons with its buffers.
pub(crate) struct Batch<'d, E: Evaluator, R: Recorder> {
    detector: &'d Detector,
    evaluator: &'d E,
    settings: &'d RunSettings,
    scratch: E::Scratch,
    emitted: Vec<Photon>,
    flights: Vec<Flight>,
    /// The number of photons that go on so far; they replace the first ones.
    kept: usize,
    /// Further photons of wavelength shifters, each with the number of those that go on before it.
    born: Vec<(usize, Flight)>,
    /// The photons with crossings and random numbers.
    chunk: Range<usize>,
    tables: Vec<ValueTable>,
    /// The last values of each material: many photons have the same energy.
    values: Vec<MaterialValues>,
    draws: Draws,
    rays: RayBatch,
    regions: Vec<u32>,
    /// The region in which the last photon of a source started.
    source_region: u32,
    first: Vec<u32>,
    starts: Vec<Start>,
    next_first: Vec<u32>,
    next_starts: Vec<Start>,
    /// The next crossings of the photons of the chunk.
    found: FirstHitColumns,
    /// Those between two regions that belong to different faces on their two sides.
    between: Vec<(usize, Crossing)>,
    /// The end of the step of each photon.
    stages: Vec<Stage>,
    bare: LaneBoundaries,
    painted: LaneBoundaries,
    scattering: LaneScattering,
    /// Steps within boxes, in runs without histories.
    boxes: Option<BoxSteps<'d>>,
    result: PhotonRun,
    /// The paths of all sensors so far.
    paths: VolumePaths,
    recorder: R,
    ends: Tally<End>,
    boundary_events: Tally<BoundaryEvent>,
    growth: Growth,
    /// Set when the photons of wavelength shifters do not fit into memory.
    shortage: Option<Shortage>,
}

/// Counts of a few kinds of events.
#[derive(Debug)]
struct Tally<K>(Vec<(K, u64)>);

impl<K: Copy + Ord> Tally<K> {
    fn add(&mut self, kind: K, number: u64) {
        match self.0.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, count)) => *count += number,
            None => self.0.push((kind, number)),
        }
    }

    /// The counts, which begin at 0 again.
    fn take(&mut self) -> BTreeMap<K, u64> {
        self.0.drain(..).collect()
    }
}

/// The end of the step of a photon.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// The photon ends.
    End(End),
    /// A process in the material.
    Bulk(Bulk),
    /// Rayleigh scattering, with the number of the photon among those that are scattered together.
    Scattering(u32),
    /// The boundary, with the refractive index in front of it.
    Boundary(f64, Group),
}

/// The group of photons at boundaries that a photon belongs to.
#[derive(Clone, Copy, Debug)]
enum Group {
    /// Those at bare interfaces, with the number of the photon among them.
    Bare(u32),
    /// Those at paint or metal that reflects by one rule, with the number of the photon among them.
    Painted(u32),
    /// Those that share nothing but the computation of random numbers, with the number of the request.
    Other(u32),
    /// None.
    Alone,
}

impl<'d, E: Evaluator, R: Recorder> Batch<'d, E, R> {
    pub fn new(detector: &'d Detector, evaluator: &'d E, settings: &'d RunSettings, recorder: R) -> Self {
        let tables: Vec<ValueTable> = detector.materials.iter().map(ValueTable::new).collect();
        Batch {
            detector,
            evaluator,
            settings,
            scratch: evaluator.scratch(),
            emitted: Vec::new(),
            flights: Vec::new(),
            kept: 0,
            born: Vec::new(),
            chunk: 0..0,
            values: tables.iter().map(MaterialValues::new).collect(),
            tables,
            draws: Draws::new(),
            rays: RayBatch::default(),
            regions: Vec::new(),
            source_region: u32::MAX,
            first: vec![0],
            starts: Vec::new(),
            next_first: vec![0],
            next_starts: Vec::new(),
            found: FirstHitColumns::default(),
            between: Vec::new(),
            stages: Vec::new(),
            bare: LaneBoundaries::bare(),
            painted: LaneBoundaries::painted(),
            scattering: LaneScattering::new(),
            boxes: if R::RECORDS { None } else { BoxSteps::new(detector, evaluator.box_cells(), settings) },
            result: PhotonRun::default(),
            paths: VolumePaths::default(),
            recorder,
            ends: Tally(Vec::new()),
            boundary_events: Tally(Vec::new()),
            growth: Growth::default(),
            shortage: None,
        }
    }

    pub fn run(&mut self, source: &Source, numbers: Range<u64>) -> Result<PhotonRun, Shortage> {
        self.result = PhotonRun::default();
        let key = EventKey { seed: self.settings.seed, event: self.settings.event };
        self.emit(source, key, numbers);
        self.finish(source)
    }

    /// Continues photons, each with the surface on which it starts, and adds photons that have been detected, each with the region
    /// and the face behind which it is. The result has no other counts than those of what happens here.
    #[cfg(feature = "gpu")]
    pub fn resume(
        &mut self,
        source: &Source,
        flights: impl IntoIterator<Item = (Flight, Option<Start>)>,
        detected: impl IntoIterator<Item = (Flight, (u32, Face))>,
    ) -> Result<PhotonRun, Shortage> {
        self.result = PhotonRun::default();
        self.clear();
        for (flight, start) in flights {
            self.flights.push(flight);
            self.starts.extend(start);
            self.first.push(self.starts.len() as u32);
        }
        for (flight, volume) in detected {
            let paths = (self.detector, &mut self.paths);
            let number = (self.settings.event, flight.origin);
            self.result.hits.push(number, flight.steps, &flight.photon, paths, volume);
        }
        self.finish(source)
    }

    /// Steps until all photons have ended; takes the result.
    fn finish(&mut self, source: &Source) -> Result<PhotonRun, Shortage> {
        // the result of a cancelled run is dropped
        while !self.flights.is_empty() && !self.settings.cancel.is_cancelled() {
            self.step_all();
            if let Some(shortage) = self.shortage.take() {
                return Err(shortage);
            }
        }
        // by photon number, whatever the number of steps
        self.result.hits.sort(&self.paths);
        self.result.hits.genstep = source.parents(&self.result.hits.photon);
        self.result.ends = self.ends.take();
        self.result.boundary_events = self.boundary_events.take();
        Ok(std::mem::take(&mut self.result))
    }

    /// Emits the photons of a batch.
    fn emit(&mut self, source: &Source, key: EventKey, numbers: Range<u64>) {
        let mut photons = std::mem::take(&mut self.emitted);
        self.clear();
        let region = self.source_region;
        let flight = |origin, photon| Flight { origin, number: key.number(origin), steps: 0, region, photon };
        if let Some(template) = source.at_point() {
            let mut origins = numbers.clone();
            turned(template, key, numbers, |photon| {
                self.flights.extend(origins.next().map(|origin| flight(origin, photon)));
            });
        } else {
            for first in numbers.clone().step_by(CHUNK) {
                photons.clear();
                let some = first..numbers.end.min(first + CHUNK as u64);
                source.emit((self.detector, self.evaluator), &mut self.scratch, key, some, &mut photons);
                let emitted = (first..).zip(&photons);
                self.flights.extend(emitted.map(|(origin, &photon)| flight(origin, photon)));
            }
        }
        self.result.photons += self.flights.len() as u64;
        self.emitted = photons;
        self.first.resize(self.flights.len() + 1, 0);
    }

    /// Removes all photons with their start lists.
    fn clear(&mut self) {
        self.flights.clear();
        self.starts.clear();
        self.first.clear();
        self.first.push(0);
        self.next_starts.clear();
        self.next_first.clear();
        self.next_first.push(0);
    }

    /// Further steps of photons within boxes, as far as they are certain.
    fn step_in_boxes(&mut self) {
        // without start surfaces no photon is on a face
        let Some(boxes) = self.boxes.as_mut().filter(|_| !self.starts.is_empty()) else { return };
        let counts = boxes.run(&mut BatchPhotons {
            flights: &mut self.flights,
            first: &self.first,
            starts: &mut self.starts,
            tables: &self.tables,
            values: &mut self.values,
        });
        self.result.steps += counts.steps;
        counts.events().for_each(|(event, number)| self.boundary_events.add(event, number));
        counts.ends().for_each(|(end, number)| self.ends.add(end, number));
        self.remove_ended();
    }

    /// Removes the photons that have ended within boxes.
    fn remove_ended(&mut self) {
        let Some([begin, ..]) = self.boxes.as_ref().map(BoxSteps::ended) else { return };
        let (begin, mut ended) = (*begin, self.boxes.iter().flat_map(BoxSteps::ended).peekable());
        let mut kept = begin;
        let mut end = self.first[kept] as usize;
        for at in begin..self.flights.len() {
            if ended.next_if_eq(&&at).is_some() {
                continue;
            }
            let list = self.first[at] as usize..self.first[at + 1] as usize;
            self.starts.copy_within(list.clone(), end);
            end += list.len();
            self.flights[kept] = self.flights[at];
            kept += 1;
            self.first[kept] = end as u32;
        }
        self.flights.truncate(kept);
        self.first.truncate(kept + 1);
        self.starts.truncate(end);
    }

    /// One step of all photons, chunk by chunk. Those that go on replace the others, in the same order.
    fn step_all(&mut self) {
        self.step_in_boxes();
        self.kept = 0;
        for first in (0..self.flights.len()).step_by(CHUNK) {
            self.chunk = first..self.flights.len().min(first + CHUNK);
            self.find();
            self.draws.compute(self.settings.seed, &self.flights[self.chunk.clone()]);
            self.step_chunk();
        }
        self.flights.truncate(self.kept);
        if !self.born.is_empty() {
            self.insert_born();
        }
        std::mem::swap(&mut self.first, &mut self.next_first);
        std::mem::swap(&mut self.starts, &mut self.next_starts);
        self.next_starts.clear();
        self.next_first.clear();
        self.next_first.push(0);
    }

    /// Inserts the further photons of wavelength shifters at their places.
    fn insert_born(&mut self) {
        let old = std::mem::take(&mut self.flights);
        let mut from = 0;
        for (at, flight) in self.born.drain(..) {
            self.flights.extend_from_slice(&old[from..at]);
            self.flights.push(flight);
            from = at;
        }
        self.flights.extend_from_slice(&old[from..]);
    }

    /// Keeps photon `i` of the chunk for the next step; its start list has been appended already.
    fn keep(&mut self, i: usize) {
        let at = self.chunk.start + i;
        if self.kept != at {
            self.flights[self.kept] = self.flights[at];
        }
        self.kept += 1;
        self.next_first.push(self.next_starts.len() as u32);
    }

    /// Keeps a photon of the chunk, after its step, for the next one. Changing it in place and then moving it would read what has
    /// just been written, in other pieces, which stops the processor.
    fn keep_as(&mut self, flight: Flight) {
        self.flights[self.kept] = flight;
        self.kept += 1;
        self.next_first.push(self.next_starts.len() as u32);
    }

    /// The next crossings of the photons of the chunk.
    fn find(&mut self) {
        let ray = |flight: &Flight| flight.photon.ray();
        let flights = &self.flights[self.chunk.clone()];
        self.rays.replace(flights.iter().map(ray));
        self.regions.clear();
        self.regions.extend(flights.iter().map(|flight| flight.region));
        let lists = StartLists { first: &self.first, entries: &self.starts }.slice(self.chunk.clone());
        // rays with a start list, even an empty one, may start inside
        let query = Query { starts: Some(lists), ..Query::nearest() };
        self.found.resize(flights.len());
        self.between.clear();
        let (query, mut hits) = ((&query, &self.regions[..]), self.found.hits());
        self.evaluator.nearest_in(self.rays.rays(), query, &mut self.scratch, &mut hits, &mut self.between);
        for ((ray, _), number) in self.between.iter().zip(0..) {
            self.found.face[*ray] = BETWEEN - number;
        }
    }

    /// Ends photon `i` of the chunk, at the surface of a crossing or in the volume.
    fn end(&mut self, i: usize, end: End, at: Option<&Crossing>) {
        self.record(i, Process::End(end), at);
        self.ends.add(end, 1);
    }

    /// Records a process of photon `i` of the chunk.
    fn record(&mut self, i: usize, process: Process, at: Option<&Crossing>) {
        self.recorder.record(self.detector, &self.flights[self.chunk.start + i], process, at);
    }

    /// The crossing of photon `i` of the chunk, if it has one.
    fn crossing(&self, i: usize) -> Option<Crossing> {
        let face = self.found.face[i];
        if face <= BETWEEN {
            return self.between.get((BETWEEN - face) as usize).map(|(_, crossing)| *crossing);
        }
        let face = self.detector.faces.get(usize::try_from(face).ok()?)?;
        let face = Face { placement: PlacementId(self.found.placement[i]), ..*face };
        let [before, after] = [self.found.before[i], self.found.after[i]].map(RegionId);
        Some(Crossing { t: self.found.t[i], face, left: face, entered: face, before, after })
    }

    /// One step of the photons of the chunk: to the nearest of the boundary and the processes in the material.
    fn step_chunk(&mut self) {
        self.stages.clear();
        self.bare.clear();
        self.painted.clear();
        self.scattering.clear();
        if R::RECORDS {
            // the rows of a photon follow each other
            for i in 0..self.chunk.len() {
                let stage = self.advance(i, false);
                self.conclude(i, stage);
            }
            return;
        }
        for i in 0..self.chunk.len() {
            let stage = self.advance(i, true);
            self.stages.push(stage);
        }
        for lanes in [&mut self.bare, &mut self.painted] {
            lanes.apply(self.settings.seed, &self.detector.starts);
        }
        self.scattering.apply(self.settings.seed);
        self.draws.answer(self.settings.seed);
        self.read_ahead();
        for i in 0..self.chunk.len() {
            self.conclude(i, self.stages[i]);
        }
    }

    /// Reads the data of the contacts of all photons at boundaries ahead.
    fn read_ahead(&self) {
        let FirstHitColumns { face, placement, .. } = &self.found;
        let at_boundary =
            self.stages.iter().zip(face).zip(placement).filter_map(|((stage, &face), &placement)| {
                let face = self.detector.faces.get(usize::try_from(face).ok()?)?;
                matches!(stage, Stage::Boundary(..)).then_some((face.surface, PlacementId(placement)))
            });
        self.detector.starts.read_ahead(at_boundary);
    }

    /// Moves a photon to the end of its step, unless that is a boundary. If `collects` is true, photons with the same process are
    /// collected for groups of eight.
    fn advance(&mut self, i: usize, collects: bool) -> Stage {
        let detector = self.detector;
        let region = self.found.before[i] as usize;
        let has_crossing = self.found.face[i] != -1;
        if R::RECORDS {
            let (flight, crossing) = (self.flights[self.chunk.start + i], self.crossing(i));
            self.recorder.begin(detector, &flight, region as u32, crossing.as_ref());
        }
        let flight = &mut self.flights[self.chunk.start + i];
        flight.region = region as u32;
        if flight.steps == 0 {
            self.source_region = flight.region;
        }
        if region == 0 && !has_crossing {
            return Stage::End(End::Escaped);
        }
        if flight.steps >= self.settings.max_steps {
            return Stage::End(End::StepLimit);
        }
        let medium = detector.material_of[region] as usize;
        let energy = flight.photon.energy;
        if !self.values[medium].is_at(energy) {
            self.values[medium].set(&self.tables[medium], energy);
        }
        let values = &self.values[medium];
        let Some(index) = values.index else {
            return Stage::End(End::NoIndex);
        };
        flight.steps += 1;
        self.result.steps += 1;
        let to_boundary = if has_crossing { self.found.t[i] } else { f64::INFINITY };
        let first_two = self.draws.uniforms(i);
        let (free, process) = free_path(values, first_two, (self.settings.seed, flight), to_boundary);
        let length = free.min(to_boundary);
        flight.photon.time += length / values.velocity;
        if flight.photon.time > self.settings.max_time {
            return Stage::End(End::TimeLimit);
        }
        let stage = match () {
            () if free < to_boundary => Stage::Bulk(process),
            // an unbounded material without any process, or the end of the world
            () if !has_crossing || self.found.after[i] == 0 => Stage::End(End::Escaped),
            // the contact with the surface has the place
            () if collects => return Stage::Boundary(index, self.collect(i, index)),
            () => return Stage::Boundary(index, Group::Alone),
        };
        flight.photon.position = flight.photon.ray().at(length);
        if collects
            && let Stage::Bulk(Bulk::Rayleigh) = stage
            && let Some(number) = self.scattering.push(flight)
        {
            return Stage::Scattering(number);
        }
        stage
    }

    /// Collects photon `i` for a group of those at boundaries.
    fn collect(&mut self, i: usize, index: f64) -> Group {
        let collected = self.meeting(i, index).and_then(|photon| match photon.surface {
            LaneSurface::Bare(_) => self.bare.push(&photon).map(Group::Bare),
            LaneSurface::Painted(..) => self.painted.push(&photon).map(Group::Painted),
        });
        collected.unwrap_or_else(|| Group::Other(self.draws.ask(&self.flights[self.chunk.start + i])))
    }

    /// Photon `i` in front of its boundary, if that is one for groups of eight photons.
    #[inline]
    fn meeting(&self, i: usize, index: f64) -> Option<AtBoundary> {
        let detector = self.detector;
        let regions = [self.found.before[i], self.found.after[i]];
        let meeting = detector.meetings.of(regions);
        // crossings of two faces are rare
        if self.found.face[i] < 0 || meeting == Meeting::Other {
            return None;
        }
        let flight = &self.flights[self.chunk.start + i];
        let Photon { position, direction, polarisation, energy, .. } = flight.photon;
        let surface = match meeting {
            Meeting::Bare => {
                let behind = self.index(detector.material_of[regions[1] as usize] as usize, energy)?;
                LaneSurface::Bare([index, behind])
            }
            Meeting::Painted(number, rule) => {
                LaneSurface::Painted(rule.values(&detector.surfaces[number as usize], energy))
            }
            Meeting::Other => return None,
        };
        let face = Face {
            placement: PlacementId(self.found.placement[i]),
            ..detector.faces[self.found.face[i] as usize]
        };
        Some(AtBoundary {
            direction,
            polarisation,
            normal: against(self.found.normal(i), direction),
            surface,
            counter: counter(flight),
            position,
            t: self.found.t[i],
            plane: detector.starts.plane(face),
        })
    }

    /// Applies what ends the step of photon `i`.
    fn conclude(&mut self, i: usize, stage: Stage) {
        match stage {
            Stage::End(end) => self.end(i, end, None),
            Stage::Bulk(process) => {
                let medium = self.detector.material_of[self.found.before[i] as usize] as usize;
                self.bulk(i, &self.detector.materials[medium], process);
            }
            Stage::Scattering(number) => {
                let flight = self.flights[self.chunk.start + i];
                let (direction, polarisation) = self.scattering.get(number);
                let photon = Photon { direction, polarisation, ..flight.photon };
                self.keep_as(Flight { photon, ..flight });
            }
            Stage::Boundary(index, group) => {
                let departed = match group {
                    Group::Bare(number) => self.bare.get(number),
                    Group::Painted(number) => self.painted.get(number),
                    Group::Other(_) | Group::Alone => None,
                };
                let point = departed.and_then(|departed| departed.contact);
                let event = departed.map(|departed| departed.event);
                if event == Some(BoundaryEvent::Absorption) {
                    self.boundary_events.add(BoundaryEvent::Absorption, 1);
                    return self.end(i, End::SurfaceAbsorbed, None);
                }
                if let (Some(departed), Some(point)) = (&departed, point)
                    && event != Some(BoundaryEvent::Detection)
                    && !(departed.is_behind && self.is_detecting(self.found.after[i]))
                {
                    return self.leave_plane(i, departed, &point);
                }
                if let Some(crossing) = self.crossing(i) {
                    let request = if let Group::Other(number) = group { Some(number) } else { None };
                    self.boundary(i, &crossing, (index, request, departed));
                }
            }
        }
    }

    /// A process in the material.
    fn bulk(&mut self, i: usize, material: &OpticalMaterial, process: Bulk) {
        let seed = self.settings.seed;
        let flight = &mut self.flights[self.chunk.start + i];
        let stream = || Stream::new(seed, flight.number, flight.steps, Purpose::Scattering);
        let Photon { direction, polarisation, .. } = flight.photon;
        let scattered = match process {
            Bulk::Absorption => return self.end(i, End::Absorbed, None),
            Bulk::Shift(shifter) => return self.shift(i, material, shifter),
            Bulk::Rayleigh => scatter::rayleigh(direction, polarisation, &mut stream()),
            Bulk::Mie => match &material.mie {
                Some(mie) => scatter::mie(mie, direction, polarisation, &mut stream()),
                None => (direction, polarisation),
            },
        };
        (flight.photon.direction, flight.photon.polarisation) = scattered;
        self.record(i, if matches!(process, Bulk::Mie) { Process::Mie } else { Process::Rayleigh }, None);
        self.keep(i);
    }

    /// Absorption and emission by a wavelength shifter.
    fn shift(&mut self, i: usize, material: &OpticalMaterial, shifter: u8) {
        let absorbed = self.flights[self.chunk.start + i];
        let shifter = &material.shifters[usize::from(shifter)];
        let mut stream =
            Stream::new(self.settings.seed, absorbed.number, absorbed.steps, Purpose::Reemission);
        let count = shifter.mean_photons.map_or(1, |mean| stream.poisson(mean));
        // each of them may be absorbed and emitted again: their number has no limit
        let bytes =
            ((self.flights.len() + self.born.len()) as u64 + u64::from(count)) * size_of::<Flight>() as u64;
        if let Err(shortage) = self.growth.check(bytes) {
            self.shortage = Some(shortage);
            return;
        }
        let mut emitted = 0;
        for _ in 0..count {
            let Some(energy) = shifter.spectrum.quantile(stream.uniform(), absorbed.photon.energy) else {
                continue;
            };
            let direction = stream.direction();
            let polarisation = stream.polarisation(direction);
            let delay = match self.settings.wls_time_profile {
                TimeProfile::Delta => shifter.time,
                TimeProfile::Exponential => shifter.time * stream.exponential(),
            };
            let time = absorbed.photon.time + delay;
            let photon = Photon { position: absorbed.photon.position, direction, polarisation, energy, time };
            // further photons have random numbers of their own
            let number = if emitted == 0 { absorbed.number } else { secondary(absorbed, emitted) };
            let flight = Flight { number, photon, ..absorbed };
            self.recorder.record(self.detector, &flight, Process::Reemission, None);
            if emitted == 0 {
                self.flights[self.chunk.start + i] = flight;
                self.keep(i);
            } else {
                self.born.push((self.kept, flight));
                self.next_first.push(self.next_starts.len() as u32);
            }
            emitted += 1;
        }
        match emitted {
            0 => self.end(i, End::ShifterAbsorbed, None),
            _ => self.result.photons += u64::from(emitted) - 1,
        }
    }

    /// The refractive index of a material.
    fn index(&self, medium: usize, energy: f64) -> Option<f64> {
        if self.values[medium].is_at(energy) {
            return self.values[medium].index;
        }
        self.detector.materials[medium].index.as_ref().map(|table| table.at(energy))
    }

    /// True if a region detects the photons that enter it.
    fn is_detecting(&self, region: u32) -> bool {
        self.settings.detection != DetectionRule::Efficiency
            && self.detector.sensors[region as usize].is_some()
    }

    /// Photon `i` leaves a plane in a run without histories, and goes on.
    fn leave_plane(&mut self, i: usize, departed: &Departed, point: &PlanePoint) {
        let (detector, at) = (self.detector, self.chunk.start + i);
        self.boundary_events.add(departed.event, 1);
        let (inside, side) = match departed.is_behind {
            true => (point.is_falling, ExitSide::Transmitted),
            false => (point.is_rising, ExitSide::Incident),
        };
        let surface = detector.faces[self.found.face[i] as usize].surface;
        let own = Start { surface, placement: PlacementId(self.found.placement[i]), inside };
        let flight = self.flights[at];
        if point.is_alone {
            self.next_starts.push(own);
        } else {
            let ray = flight.photon.ray();
            let known = StartLists { first: &self.first, entries: &self.starts }.of(at);
            let (ray, own) = ((&ray, self.found.t[i]), (own, side));
            detector.starts.append_on(&detector.program, ray, own, known, &mut self.next_starts);
        }
        let Departed { direction, polarisation, .. } = *departed;
        let photon = Photon { position: point.position, direction, polarisation, ..flight.photon };
        self.keep_as(Flight { photon, ..flight });
    }

    /// The optical boundary process for photon `i` of the chunk: the index in front of the crossing, the request of its random
    /// numbers, and the photon after the process in lanes, if there is one.
    fn boundary(
        &mut self,
        i: usize,
        crossing: &Crossing,
        (index, request, departed): (f64, Option<u32>, Option<Departed>),
    ) {
        let detector = self.detector;
        let ray = self.flights[self.chunk.start + i].photon.ray();
        let crossing = &match detector.boundaries.depends_on_copies(crossing) {
            true => detector.with_own_faces(&ray, crossing),
            false => *crossing,
        };
        let normal = against(self.found.normal(i), ray.direction);
        let (event, direction, polarisation, is_behind) = match departed {
            Some(departed) => (departed.event, departed.direction, departed.polarisation, departed.is_behind),
            None => self.scatter(i, crossing, (index, normal), request),
        };
        // that with a plane has been evaluated already
        let contact = match departed.and_then(|departed| departed.contact) {
            Some(point) => Ok(point),
            None => Err(detector.starts.contact(&detector.program, &ray, crossing)),
        };
        let photon = &mut self.flights[self.chunk.start + i].photon;
        photon.position = match &contact {
            Ok(point) => point.position,
            Err(contact) => contact.project(normal),
        };
        self.boundary_events.add(event, 1);
        let detects_efficiency = self.settings.detection != DetectionRule::Volume;
        match event {
            BoundaryEvent::Detection if detects_efficiency => {
                self.record(i, event.into(), Some(crossing));
                return self.detect(i, crossing);
            }
            BoundaryEvent::Detection | BoundaryEvent::Absorption => {
                return self.end(i, End::SurfaceAbsorbed, Some(crossing));
            }
            BoundaryEvent::NoIndex => return self.end(i, End::NoIndex, Some(crossing)),
            _ => {}
        }
        (photon.direction, photon.polarisation) = (direction, polarisation);
        self.record(i, event.into(), Some(crossing));
        if is_behind && self.is_detecting(crossing.after.0) {
            let flight = &self.flights[self.chunk.start + i];
            self.recorder.enter_sensor(detector, flight, crossing);
            return self.detect(i, crossing);
        }
        let side = if is_behind { ExitSide::Transmitted } else { ExitSide::Incident };
        let known = StartLists { first: &self.first, entries: &self.starts }.of(self.chunk.start + i);
        match contact {
            Ok(point) => {
                let inside = if is_behind { point.is_falling } else { point.is_rising };
                let Face { surface, placement, .. } = crossing.face;
                let own = (Start { surface, placement, inside }, side);
                let ray = (&ray, crossing.t);
                detector.starts.append_on(&detector.program, ray, own, known, &mut self.next_starts);
            }
            Err(contact) => detector.starts.append_at(&contact, side, known, &mut self.next_starts),
        }
        self.keep(i);
    }

    /// The boundary process of photon `i`, whose random numbers have a request: the event, the direction and the polarisation after
    /// it, and true if the photon continues behind the boundary.
    fn scatter(
        &self,
        i: usize,
        crossing: &Crossing,
        (index, normal): (f64, Vec3),
        request: Option<u32>,
    ) -> (BoundaryEvent, Vec3, Vec3, bool) {
        let detector = self.detector;
        let flight = &self.flights[self.chunk.start + i];
        let energy = flight.photon.energy;
        let [own, other] =
            [crossing.before, crossing.after].map(|region| detector.material_of[region.index()]);
        let mut boundary = Boundary {
            direction: flight.photon.direction,
            polarisation: flight.photon.polarisation,
            normal,
            energy,
            index,
            index_behind: self.index(other as usize, energy),
            is_same_material: own == other,
            surface: detector.surface(crossing),
        };
        let mut stream = self.draws.boundary(request, self.settings.seed, flight);
        let (event, is_behind) = boundary.apply(&mut stream);
        (event, boundary.direction, boundary.polarisation, is_behind)
    }

    fn detect(&mut self, i: usize, crossing: &Crossing) {
        let flight = &self.flights[self.chunk.start + i];
        let volume = (crossing.after.0, crossing.entered);
        self.result.hits.push(
            (self.settings.event, flight.origin),
            flight.steps,
            &flight.photon,
            (self.detector, &mut self.paths),
            volume,
        );
        self.ends.add(End::Detected, 1);
    }
}

/// The number in the column of faces for the first crossing of two different faces; those of the others follow downwards.
const BETWEEN: i32 = -2;

/// A normal, turned against a direction.
fn against(normal: Vec3, direction: Vec3) -> Vec3 {
    if normal.dot(direction) > 0.0 { -normal } else { normal }
}

/// The number of a further photon of a wavelength shifter: a hash of the absorbed photon's number, its step and the
/// position among the emitted ones, with bit 62 set.
fn secondary(flight: Flight, emitted: u32) -> u64 {
    let [a, b, ..] = crate::philox::philox4x32(
        [flight.number as u32, (flight.number >> 32) as u32, flight.steps, emitted],
        [0x5741_5645, 0x5241_5957],
    );
    1 << 62 | u64::from(a & 0x3fff_ffff) << 32 | u64::from(b)
}

/// The shortest free path in a material and its process, if it ends before the boundary; otherwise any path that does not.
/// `first_two` are the first two uniform numbers of the step.
#[inline]
fn free_path(
    values: &MaterialValues,
    first_two: [f64; 2],
    (seed, flight): (u64, &Flight),
    to_boundary: f64,
) -> (f64, Bulk) {
    let mut shortest = (f64::INFINITY, Bulk::Absorption);
    let paths = values.paths();
    for (&(mean, process), uniform) in paths.iter().zip(first_two) {
        // most paths are certainly longer, which needs no logarithm
        if mean * (1.0 - uniform) * LEAST_EXPONENTIAL > to_boundary {
            continue;
        }
        let length = mean * exponential(uniform);
        shortest = if length < shortest.0 { (length, process) } else { shortest };
    }
    if let Some(others @ [_, ..]) = paths.get(2..) {
        let mut stream = Draws::other_exponentials(seed, flight);
        for &(mean, process) in others {
            let length = mean * stream.exponential();
            shortest = if length < shortest.0 { (length, process) } else { shortest };
        }
    }
    shortest
}
