//! The loop of a batch of photons from event to event.
//!
//! All photons of a batch advance together, step by step: the next crossings of all of them, then the process with
//! the shortest free path or the boundary, then the photons that have ended are removed.

use crate::boundary::{
    AtBoundary, Boundary, BoundaryEvent, Departed, LaneBoundaries, LaneSurface, SurfacePoint,
};
use crate::box_steps::{BatchPhotons, BoxSteps};
use crate::detector::{Detector, Meeting};
use crate::draws::{Draws, stream};
use crate::flight::{End, Flight};
use crate::free_path::shortest;
use crate::history::{Process, Recorder};
use crate::in_flight::{Mark, Numbers, Place, SurfaceLists};
use crate::material::{Bulk, MaterialValues, OpticalMaterial, ValueTable};
use crate::philox::{Counter, Purpose, Stream};
use crate::photon::{EventKey, Photon};
use crate::run::PhotonRun;
use crate::scatter::{self, LaneScattering};
use crate::settings::{RunSettings, TimeProfile};
use crate::source::{Source, turned};
use crate::volume::VolumePaths;
use rayweave_math::Vec3;
use rayweave_model::memory::{Growth, Shortage};
use rayweave_model::{
    Crossing, Evaluator, Face, FirstHitColumns, PlacementId, Query, RayBatch, RegionId, Start, StartLists,
};
use rayweave_optics::start_surfaces::ExitSide;
use std::collections::BTreeMap;
use std::ops::Range;

/// The number of photons of a batch for which the next crossings are found together: their columns stay in the cache.
const CHUNK: usize = 1024;

/// A batch of photons with its buffers.
pub(crate) struct Batch<'d, E: Evaluator, R: Recorder> {
    detector: &'d Detector,
    evaluator: &'d E,
    settings: &'d RunSettings,
    scratch: E::Scratch,
    /// The photons in flight.
    photons: Vec<Photon>,
    marks: Vec<Mark>,
    numbers: Numbers,
    /// The lists of those that start on several surfaces, and of those among the photons that go on.
    lists: SurfaceLists,
    next_lists: SurfaceLists,
    /// The number of photons that go on so far; they replace the first ones.
    kept: usize,
    /// Further photons of wavelength shifters, each with the number of those that go on before it.
    born: Vec<(usize, Photon, Mark)>,
    /// True if a photon starts on a surface.
    is_on_surfaces: bool,
    /// The photons with crossings and random numbers.
    chunk: Range<usize>,
    tables: Vec<ValueTable>,
    /// The last values of each material: many photons have the same energy.
    values: Vec<MaterialValues>,
    draws: Draws,
    rays: RayBatch,
    /// The regions in which the photons of the chunk that start on no surface probably are; `u32::MAX` if that is not known.
    regions: Vec<u32>,
    /// The region in which the last photon of a source started.
    source_region: u32,
    /// The start lists of the photons of the chunk, as in [`StartLists`].
    first: Vec<u32>,
    starts: Vec<Start>,
    /// The start list of a photon that goes on.
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
    pub recorder: R,
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
            photons: Vec::new(),
            marks: Vec::new(),
            numbers: Numbers::new(EventKey { seed: settings.seed, event: settings.event }),
            lists: SurfaceLists::default(),
            next_lists: SurfaceLists::default(),
            kept: 0,
            born: Vec::new(),
            is_on_surfaces: false,
            chunk: 0..0,
            values: tables.iter().map(MaterialValues::new).collect(),
            tables,
            draws: Draws::new(),
            rays: RayBatch::default(),
            regions: Vec::new(),
            source_region: u32::MAX,
            first: Vec::new(),
            starts: Vec::new(),
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

    /// Continues photons, each with the surfaces on which it starts, and adds photons that have been detected, each with the region
    /// and the face behind which it is. The result has no other counts than those of what happens here.
    #[cfg(feature = "gpu")]
    pub fn resume(
        &mut self,
        source: &Source,
        flights: impl IntoIterator<Item = (Flight, impl IntoIterator<Item = Start>)>,
        detected: impl IntoIterator<Item = (Flight, (u32, Face))>,
    ) -> Result<PhotonRun, Shortage> {
        self.result = PhotonRun::default();
        self.clear(0);
        let mut list = Vec::new();
        for (Flight { origin, number, steps, region, photon }, starts) in flights {
            list.clear();
            list.extend(starts);
            let place = self.lists.place(&list, region, &self.detector.starts);
            self.is_on_surfaces |= !place.is_free();
            self.photons.push(photon);
            self.marks.push(Mark { number: self.numbers.add(origin, number), steps, place });
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
        while !self.photons.is_empty() && !self.settings.cancel.is_cancelled() {
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
        self.clear(numbers.start);
        let count = (numbers.end - numbers.start) as usize;
        self.photons.reserve(count);
        if let Some(template) = source.at_point() {
            turned(template, key, numbers, |photon| self.photons.push(photon));
        } else {
            for first in numbers.clone().step_by(CHUNK) {
                let some = first..numbers.end.min(first + CHUNK as u64);
                let emitter = (self.detector, self.evaluator);
                source.emit(emitter, &mut self.scratch, key, some, &mut self.photons);
            }
        }
        self.result.photons += count as u64;
        let place = Place::in_region(self.source_region);
        self.marks.extend((0..count as u32).map(|number| Mark { number, steps: 0, place }));
    }

    /// Removes all photons; `first` is the number of the first photon of the next batch.
    fn clear(&mut self, first: u64) {
        self.photons.clear();
        self.marks.clear();
        self.lists.clear();
        self.next_lists.clear();
        self.numbers.begin(first);
        self.is_on_surfaces = false;
    }

    /// Further steps of photons within boxes, as far as they are certain.
    fn step_in_boxes(&mut self) {
        let Some(boxes) = self.boxes.as_mut().filter(|_| self.is_on_surfaces) else { return };
        let counts = boxes.run(&mut BatchPhotons {
            photons: &mut self.photons,
            marks: &mut self.marks,
            numbers: &self.numbers,
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
        for at in begin..self.photons.len() {
            if ended.next_if_eq(&&at).is_some() {
                continue;
            }
            (self.photons[kept], self.marks[kept]) = (self.photons[at], self.marks[at]);
            kept += 1;
        }
        self.photons.truncate(kept);
        self.marks.truncate(kept);
    }

    /// One step of all photons, chunk by chunk. Those that go on replace the others, in the same order.
    fn step_all(&mut self) {
        self.step_in_boxes();
        self.kept = 0;
        self.is_on_surfaces = false;
        for first in (0..self.photons.len()).step_by(CHUNK) {
            self.chunk = first..self.photons.len().min(first + CHUNK);
            self.find();
            self.draws.compute(self.settings.seed, &self.numbers, &self.marks[self.chunk.clone()]);
            self.step_chunk();
        }
        self.photons.truncate(self.kept);
        self.marks.truncate(self.kept);
        if !self.born.is_empty() {
            self.insert_born();
        }
        self.numbers.shrink(&mut self.marks);
        std::mem::swap(&mut self.lists, &mut self.next_lists);
        self.next_lists.clear();
    }

    /// Inserts the further photons of wavelength shifters at their places.
    fn insert_born(&mut self) {
        let (photons, marks) = (std::mem::take(&mut self.photons), std::mem::take(&mut self.marks));
        let mut from = 0;
        let ends = self.born.drain(..).map(|(at, photon, mark)| (at, Some((photon, mark))));
        for (at, born) in ends.chain([(photons.len(), None)]) {
            self.photons.extend_from_slice(&photons[from..at]);
            self.marks.extend_from_slice(&marks[from..at]);
            if let Some((photon, mark)) = born {
                self.photons.push(photon);
                self.marks.push(mark);
            }
            from = at;
        }
    }

    /// Keeps a photon of the chunk, after its step, for the next one. Changing it in place and then moving it would read what has
    /// just been written, in other pieces, which stops the processor.
    fn keep(&mut self, photon: Photon, mark: Mark) {
        self.photons[self.kept] = photon;
        self.marks[self.kept] = mark;
        self.kept += 1;
    }

    /// The photon with number `i` of the chunk, with its numbers.
    fn flight(&self, i: usize) -> Flight {
        let at = self.chunk.start + i;
        self.numbers.flight(&self.photons[at], &self.marks[at])
    }

    /// The counter of the random numbers of photon `i` of the chunk.
    fn counter(&self, i: usize) -> Counter {
        self.numbers.counter(&self.marks[self.chunk.start + i])
    }

    /// The next crossings of the photons of the chunk.
    fn find(&mut self) {
        let photons = &self.photons[self.chunk.clone()];
        self.rays.replace(photons.iter().map(Photon::ray));
        self.list_starts();
        let lists = StartLists { first: &self.first, entries: &self.starts };
        // rays with a start list, even an empty one, may start inside
        let query = Query { starts: Some(lists), ..Query::nearest() };
        self.found.resize(self.chunk.len());
        self.between.clear();
        let (query, mut hits) = ((&query, &self.regions[..]), self.found.hits());
        self.evaluator.nearest_in(self.rays.rays(), query, &mut self.scratch, &mut hits, &mut self.between);
        for ((ray, _), number) in self.between.iter().zip(0..) {
            self.found.face[*ray] = BETWEEN - number;
        }
    }

    /// Lists the surfaces on which the photons of the chunk start, and the regions of the others.
    fn list_starts(&mut self) {
        let all = &self.detector.starts;
        self.starts.clear();
        self.first.clear();
        self.first.push(0);
        self.regions.clear();
        for mark in &self.marks[self.chunk.clone()] {
            match mark.place.start(all) {
                Some(start) => self.starts.push(start),
                None => self.starts.extend_from_slice(self.lists.of(mark.place)),
            }
            self.first.push(self.starts.len() as u32);
            self.regions.push(mark.place.region());
        }
    }

    /// Ends photon `i` of the chunk, at the surface of a crossing or in the volume.
    fn end(&mut self, i: usize, end: End, at: Option<&Crossing>) {
        self.record(i, Process::End(end), at);
        self.ends.add(end, 1);
    }

    /// Records a process of photon `i` of the chunk.
    fn record(&mut self, i: usize, process: Process, at: Option<&Crossing>) {
        if R::RECORDS {
            self.recorder.record(self.detector, &self.flight(i), process, at);
        }
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
        self.read_ahead();
        for lanes in [&mut self.bare, &mut self.painted] {
            lanes.apply(self.settings.seed, &self.detector.starts);
        }
        self.scattering.apply(self.settings.seed);
        self.draws.answer(self.settings.seed);
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
            let (flight, crossing) = (Flight { region: region as u32, ..self.flight(i) }, self.crossing(i));
            self.recorder.begin(detector, &flight, crossing.as_ref());
        }
        let at = self.chunk.start + i;
        let (photon, mark) = (&mut self.photons[at], &mut self.marks[at]);
        if mark.steps == 0 {
            self.source_region = region as u32;
        }
        if region == 0 && !has_crossing {
            return Stage::End(End::Escaped);
        }
        if mark.steps >= self.settings.max_steps {
            return Stage::End(End::StepLimit);
        }
        let medium = detector.material_of[region] as usize;
        if !self.values[medium].is_at(photon.energy) {
            self.values[medium].set(&self.tables[medium], photon.energy);
        }
        let values = &self.values[medium];
        let Some(index) = values.index else {
            return Stage::End(End::NoIndex);
        };
        mark.steps += 1;
        self.result.steps += 1;
        let to_boundary = if has_crossing { self.found.t[i] } else { f64::INFINITY };
        let others = || Draws::other_exponentials(self.settings.seed, self.numbers.counter(mark));
        let (free, process) = free_path(values, self.draws.exponentials(i), others);
        let length = free.min(to_boundary);
        photon.time += length / values.velocity;
        if photon.time > self.settings.max_time {
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
        photon.position = photon.ray().at(length);
        if collects
            && let Stage::Bulk(Bulk::Rayleigh) = stage
            && let Some(number) = self.scattering.push(photon, self.numbers.counter(mark))
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
        collected.unwrap_or_else(|| Group::Other(self.draws.ask(self.counter(i))))
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
        let Photon { position, direction, polarisation, energy, .. } = self.photons[self.chunk.start + i];
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
            counter: self.counter(i),
            position,
            t: self.found.t[i],
            contact: detector.starts.lane_contact(face.surface, face.placement),
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
                let at = self.chunk.start + i;
                let (direction, polarisation) = self.scattering.get(number);
                let photon = Photon { direction, polarisation, ..self.photons[at] };
                self.keep(photon, Mark { place: self.found_place(i), ..self.marks[at] });
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
                    && !(departed.is_behind && self.is_detecting(RegionId(self.found.after[i])))
                {
                    return self.leave_contact(i, departed, &point);
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
        let at = self.chunk.start + i;
        let (seed, counter) = (self.settings.seed, self.counter(i));
        let stream = || stream(seed, counter, Purpose::Scattering);
        let Photon { direction, polarisation, .. } = self.photons[at];
        let (direction, polarisation) = match process {
            Bulk::Absorption => return self.end(i, End::Absorbed, None),
            Bulk::Shift(shifter) => return self.shift(i, material, shifter),
            Bulk::Rayleigh => scatter::rayleigh(direction, polarisation, &mut stream()),
            Bulk::Mie => match &material.mie {
                Some(mie) => scatter::mie(mie, direction, polarisation, &mut stream()),
                None => (direction, polarisation),
            },
        };
        let photon = Photon { direction, polarisation, ..self.photons[at] };
        self.photons[at] = photon;
        self.record(i, if matches!(process, Bulk::Mie) { Process::Mie } else { Process::Rayleigh }, None);
        self.keep(photon, Mark { place: self.found_place(i), ..self.marks[at] });
    }

    /// The place of photon `i` of the chunk within the region of its step.
    fn found_place(&self, i: usize) -> Place {
        Place::in_region(self.found.before[i])
    }

    /// Absorption and emission by a wavelength shifter.
    fn shift(&mut self, i: usize, material: &OpticalMaterial, shifter: u8) {
        let absorbed = self.flight(i);
        let mark = Mark { place: self.found_place(i), ..self.marks[self.chunk.start + i] };
        let shifter = &material.shifters[usize::from(shifter)];
        let mut stream = stream(self.settings.seed, self.counter(i), Purpose::Reemission);
        let count = shifter.mean_photons.map_or(1, |mean| stream.poisson(mean));
        // each of them may be absorbed and emitted again: their number has no limit
        let bytes =
            ((self.photons.len() + self.born.len()) as u64 + u64::from(count)) * size_of::<Flight>() as u64;
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
            if R::RECORDS {
                let flight = Flight { number, photon, ..absorbed };
                self.recorder.record(self.detector, &flight, Process::Reemission, None);
            }
            if emitted == 0 {
                self.keep(photon, mark);
            } else {
                let number = self.numbers.add(absorbed.origin, number);
                self.born.push((self.kept, photon, Mark { number, ..mark }));
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
    fn is_detecting(&self, region: RegionId) -> bool {
        self.detector.is_detecting(self.settings.detection, region)
    }

    /// Photon `i` leaves a plane or a sphere in a run without histories, and goes on.
    fn leave_contact(&mut self, i: usize, departed: &Departed, point: &SurfacePoint) {
        let (detector, at) = (self.detector, self.chunk.start + i);
        self.boundary_events.add(departed.event, 1);
        let (inside, side) = match departed.is_behind {
            true => (point.is_falling, ExitSide::Transmitted),
            false => (point.is_rising, ExitSide::Incident),
        };
        let surface = detector.faces[self.found.face[i] as usize].surface;
        let own = Start { surface, placement: PlacementId(self.found.placement[i]), inside };
        let photon = self.photons[at];
        self.next_starts.clear();
        if point.is_alone {
            self.next_starts.push(own);
        } else {
            let ray = photon.ray();
            let known = StartLists { first: &self.first, entries: &self.starts }.of(i);
            let (ray, own) = ((&ray, self.found.t[i]), (own, side));
            detector.starts.append_on(&detector.program, ray, own, known, &mut self.next_starts);
        }
        let Departed { direction, polarisation, .. } = *departed;
        let photon = Photon { position: point.position, direction, polarisation, ..photon };
        self.keep_on_surfaces(i, photon);
    }

    /// Keeps photon `i` of the chunk on its next start surfaces.
    fn keep_on_surfaces(&mut self, i: usize, photon: Photon) {
        let (region, all) = (self.found.before[i], &self.detector.starts);
        let place = self.next_lists.place(&self.next_starts, region, all);
        self.is_on_surfaces |= !place.is_free();
        self.keep(photon, Mark { place, ..self.marks[self.chunk.start + i] });
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
        let at = self.chunk.start + i;
        let ray = self.photons[at].ray();
        let crossing = &match detector.boundaries.depends_on_copies(crossing) {
            true => detector.with_own_faces(&ray, crossing),
            false => *crossing,
        };
        let normal = against(self.found.normal(i), ray.direction);
        let (event, direction, polarisation, is_behind) = match departed {
            Some(departed) => (departed.event, departed.direction, departed.polarisation, departed.is_behind),
            None => self.scatter(i, crossing, (index, normal), request),
        };
        // those with planes and spheres have been evaluated already
        let contact = match departed.and_then(|departed| departed.contact) {
            Some(point) => Ok(point),
            None => Err(detector.starts.contact(&detector.program, &ray, crossing)),
        };
        let photon = &mut self.photons[at];
        photon.position = match &contact {
            Ok(point) => point.position,
            Err(contact) => contact.project(normal),
        };
        self.boundary_events.add(event, 1);
        let detects_efficiency = self.settings.detection.counts_efficiency();
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
        let photon = *photon;
        self.record(i, event.into(), Some(crossing));
        if is_behind && self.is_detecting(crossing.after) {
            if R::RECORDS {
                let flight = self.flight(i);
                self.recorder.enter_sensor(detector, &flight, crossing);
            }
            return self.detect(i, crossing);
        }
        let side = if is_behind { ExitSide::Transmitted } else { ExitSide::Incident };
        self.next_starts.clear();
        let known = StartLists { first: &self.first, entries: &self.starts }.of(i);
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
        self.keep_on_surfaces(i, photon);
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
        let Photon { direction, polarisation, energy, .. } = self.photons[self.chunk.start + i];
        let [own, other] =
            [crossing.before, crossing.after].map(|region| detector.material_of[region.index()]);
        let mut boundary = Boundary {
            direction,
            polarisation,
            normal,
            energy,
            index,
            index_behind: self.index(other as usize, energy),
            is_same_material: own == other,
            surface: detector.surface(crossing),
        };
        let mut stream = self.draws.boundary(request, self.settings.seed, self.counter(i));
        let (event, is_behind) = boundary.apply(&mut stream);
        (event, boundary.direction, boundary.polarisation, is_behind)
    }

    fn detect(&mut self, i: usize, crossing: &Crossing) {
        let (photon, mark) = (&self.photons[self.chunk.start + i], &self.marks[self.chunk.start + i]);
        let volume = (crossing.after.0, crossing.entered);
        let number = (self.settings.event, self.numbers.origin(mark));
        let paths = (self.detector, &mut self.paths);
        self.result.hits.push(number, mark.steps, photon, paths, volume);
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

/// The shortest free path in a material and its process. `first_two` are the first two exponentially distributed numbers of the step,
/// and `others` the numbers behind them.
#[inline]
fn free_path(values: &MaterialValues, first_two: [f64; 2], others: impl FnOnce() -> Stream) -> (f64, Bulk) {
    let paths = values.paths();
    let (length, process) = shortest(paths.iter().copied(), first_two);
    let mut shortest = (length, process.unwrap_or(Bulk::Absorption));
    if let Some(further @ [_, ..]) = paths.get(2..) {
        let mut stream = others();
        for &(mean, process) in further {
            let length = mean * stream.exponential();
            shortest = if length < shortest.0 { (length, process) } else { shortest };
        }
    }
    shortest
}
