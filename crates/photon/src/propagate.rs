//! Propagation: the loop of a batch of photons from event to event.
//!
//! All photons of a batch advance together, step by step: the next crossings of all of them, then the process with
//! the shortest free path or the boundary, then the photons that have ended are removed.

use crate::boundary::{Boundary, BoundaryEvent};
use crate::detector::{DetectionRule, Detector};
use crate::error::PhotonError;
use crate::hits::{Hits, sensor_path};
use crate::material::OpticalMaterial;
use crate::philox::{Purpose, Stream};
use crate::property::LIGHT_SPEED;
use crate::scatter;
use crate::source::{EventKey, Photon, Source};
use rayweave_math::Vec3;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::{
    Crossing, Evaluator, Face, FirstHits, PlacementId, Query, RayBatch, RegionId, Start, StartLists,
};
use rayweave_optics::start_surfaces::{ExitSide, project};
use rayweave_shape::Ray;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::ops::Range;

/// The number of photons that advance together.
const BATCH: u64 = 4096;

/// The way in which a photon ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum End {
    /// Absorbed in a material, `ABSLENGTH`.
    Absorbed,
    /// Absorbed by a wavelength shifter that emitted no photon.
    ShifterAbsorbed,
    /// Absorbed at a surface.
    SurfaceAbsorbed,
    /// Absorbed on entering a material without a refractive index.
    NoIndex,
    /// Detected.
    Detected,
    /// Left the world.
    Escaped,
    /// Stopped at the maximum number of steps.
    StepLimit,
    /// Stopped at the maximum time.
    TimeLimit,
}

impl End {
    /// All ways, in the order of reports.
    pub const ALL: [End; 8] = [
        End::Absorbed,
        End::ShifterAbsorbed,
        End::SurfaceAbsorbed,
        End::NoIndex,
        End::Detected,
        End::Escaped,
        End::StepLimit,
        End::TimeLimit,
    ];

    /// The name in reports, such as `absorbed`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            End::Absorbed => "absorbed",
            End::ShifterAbsorbed => "shifter_absorbed",
            End::SurfaceAbsorbed => "surface_absorbed",
            End::NoIndex => "no_index",
            End::Detected => "detected",
            End::Escaped => "escaped",
            End::StepLimit => "step_limit",
            End::TimeLimit => "time_limit",
        }
    }
}

/// Settings of a run.
#[derive(Clone, Debug)]
pub struct RunSettings {
    /// The seed of all random numbers.
    pub seed: u64,
    /// The number of the event: photons of different events have different random numbers.
    pub event: u32,
    /// The numbers of the photons to simulate. A run of a part of a range gives that part of its results.
    pub photons: Range<u64>,
    /// The rule of detection.
    pub detection: DetectionRule,
    /// The maximum number of steps of a photon.
    pub max_steps: u32,
    /// The maximum time in ns.
    pub max_time: f64,
    /// The number of threads; by default that of [`thread_count`].
    pub threads: Option<NonZeroUsize>,
    /// Stops the run.
    pub cancel: Cancel,
}

impl RunSettings {
    /// The settings of a run of some photons: seed 0, both rules of detection, 10,000 steps, no limit of time.
    #[must_use]
    pub fn new(photons: Range<u64>) -> RunSettings {
        RunSettings {
            seed: 0,
            event: 0,
            photons,
            detection: DetectionRule::default(),
            max_steps: 10_000,
            max_time: f64::INFINITY,
            threads: None,
            cancel: Cancel::new(),
        }
    }
}

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
    fn append(&mut self, other: PhotonRun) {
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
/// [`PhotonError::Setting`] for invalid photons and limits, [`PhotonError::Cancelled`].
pub fn simulate<E: Evaluator>(
    detector: &Detector,
    evaluator: &E,
    source: &Source,
    settings: &RunSettings,
) -> Result<PhotonRun, PhotonError> {
    source.check()?;
    let Range { start, end } = settings.photons;
    source.check_range(&settings.photons)?;
    if settings.max_time.is_nan() || settings.max_time <= 0.0 {
        let problem = format!("the maximum time is {} ns", settings.max_time);
        return Err(PhotonError::setting(problem, "it must be positive"));
    }
    let chunks = (0..(end.saturating_sub(start)).div_ceil(BATCH))
        .map(|k| start + k * BATCH..(start + (k + 1) * BATCH).min(end));
    let mut total = PhotonRun::default();
    let work = |batch: &mut Batch<'_, E>, numbers: Range<u64>| batch.run(source, numbers);
    let merge = |part: PhotonRun| -> Result<(), PhotonError> {
        total.append(part);
        Ok(())
    };
    drive(
        thread_count(settings.threads),
        &settings.cancel,
        chunks,
        || Batch::new(detector, evaluator, settings),
        work,
        merge,
    )
    .map_err(|stopped| match stopped {
        Stopped::Cancelled => PhotonError::Cancelled,
        Stopped::Failed(error) => error,
    })?;
    Ok(total)
}

/// A photon in flight.
#[derive(Clone, Copy, Debug)]
struct Flight {
    /// The number of the source's photon that this one is, or comes from.
    origin: u64,
    /// The number that selects the random numbers.
    number: u64,
    /// Number of steps of its whole history, with those of the photons it was emitted from.
    steps: u32,
    photon: Photon,
}

/// A batch of photons with its buffers.
struct Batch<'d, E: Evaluator> {
    detector: &'d Detector,
    evaluator: &'d E,
    settings: &'d RunSettings,
    scratch: E::Scratch,
    flights: Vec<Flight>,
    next: Vec<Flight>,
    rays: RayBatch,
    first: Vec<u32>,
    starts: Vec<Start>,
    next_first: Vec<u32>,
    next_starts: Vec<Start>,
    found: Columns,
    result: PhotonRun,
}

/// The next crossings of the photons of a batch.
#[derive(Debug, Default)]
struct Columns {
    t: Vec<f64>,
    face: Vec<i32>,
    placement: Vec<u32>,
    before: Vec<u32>,
    after: Vec<u32>,
    normal: [Vec<f64>; 3],
    between: Vec<(usize, Crossing)>,
}

impl Columns {
    fn reset(&mut self, count: usize) {
        self.t.resize(count, 0.0);
        self.face.resize(count, 0);
        [&mut self.placement, &mut self.before, &mut self.after]
            .into_iter()
            .for_each(|ids| ids.resize(count, 0));
        self.normal.iter_mut().for_each(|column| column.resize(count, 0.0));
        self.between.clear();
    }

    fn normal(&self, i: usize) -> Vec3 {
        Vec3::new(self.normal[0][i], self.normal[1][i], self.normal[2][i])
    }
}

/// The event that ends a step before the boundary.
#[derive(Clone, Copy, Debug)]
enum Bulk {
    Absorption,
    Rayleigh,
    Mie,
    Shift(usize),
}

impl<'d, E: Evaluator> Batch<'d, E> {
    fn new(detector: &'d Detector, evaluator: &'d E, settings: &'d RunSettings) -> Self {
        Batch {
            detector,
            evaluator,
            settings,
            scratch: evaluator.scratch(),
            flights: Vec::new(),
            next: Vec::new(),
            rays: RayBatch::default(),
            first: vec![0],
            starts: Vec::new(),
            next_first: vec![0],
            next_starts: Vec::new(),
            found: Columns::default(),
            result: PhotonRun::default(),
        }
    }

    fn run(&mut self, source: &Source, numbers: Range<u64>) -> PhotonRun {
        self.result = PhotonRun::default();
        let key = EventKey { seed: self.settings.seed, event: self.settings.event };
        let mut photons = Vec::new();
        let start = numbers.start;
        source.emit((self.detector, self.evaluator), &mut self.scratch, key, numbers, &mut photons);
        self.result.photons = photons.len() as u64;
        for (origin, photon) in (start..).zip(photons) {
            self.continue_with(Flight { origin, number: key.number(origin), steps: 0, photon });
        }
        self.swap();
        while !self.flights.is_empty() {
            self.find();
            for i in 0..self.flights.len() {
                self.step(i);
            }
            self.swap();
        }
        // by photon number, whatever the number of steps
        self.result.hits.sort();
        std::mem::take(&mut self.result)
    }

    /// Keeps a photon for the next step; its start list has been appended already.
    fn continue_with(&mut self, flight: Flight) {
        self.next.push(flight);
        self.next_first.push(self.next_starts.len() as u32);
    }

    fn swap(&mut self) {
        std::mem::swap(&mut self.flights, &mut self.next);
        std::mem::swap(&mut self.first, &mut self.next_first);
        std::mem::swap(&mut self.starts, &mut self.next_starts);
        self.next.clear();
        self.next_starts.clear();
        self.next_first.clear();
        self.next_first.push(0);
    }

    /// The next crossings of all photons.
    fn find(&mut self) {
        self.rays.clear();
        for flight in &self.flights {
            self.rays.push(Ray { origin: flight.photon.position, direction: flight.photon.direction });
        }
        let lists = StartLists { first: &self.first, entries: &self.starts };
        let query = Query { starts: (!self.starts.is_empty()).then_some(lists), ..Query::nearest() };
        self.found.reset(self.flights.len());
        let Columns { t, face, placement, before, after, normal: [x, y, z], between } = &mut self.found;
        let mut columns = FirstHits { t, face, placement, before, after, normal: Some([x, y, z]) };
        self.evaluator.nearest_from(self.rays.rays(), &query, &mut self.scratch, &mut columns, between);
        between.sort_by_key(|(ray, _)| *ray);
    }

    fn end(&mut self, end: End) {
        *self.result.ends.entry(end).or_default() += 1;
    }

    /// The crossing of a photon, if it has one.
    fn crossing(&self, i: usize) -> Option<Crossing> {
        let face = usize::try_from(self.found.face[i]).ok()?;
        let between = &self.found.between;
        let at = between.partition_point(|(ray, _)| *ray < i);
        if let Some((_, crossing)) = between.get(at).filter(|(ray, _)| *ray == i) {
            return Some(*crossing);
        }
        let face =
            Face { placement: PlacementId(self.found.placement[i]), ..*self.detector.faces.get(face)? };
        let [before, after] = [self.found.before[i], self.found.after[i]].map(RegionId);
        Some(Crossing { t: self.found.t[i], face, left: face, entered: face, before, after })
    }

    /// One step of a photon: to the nearest of the boundary and the processes in the material.
    fn step(&mut self, i: usize) {
        let mut flight = self.flights[i];
        let detector = self.detector;
        let region = self.found.before[i];
        let crossing = self.crossing(i);
        if region == 0 && crossing.is_none() {
            return self.end(End::Escaped);
        }
        if flight.steps >= self.settings.max_steps {
            return self.end(End::StepLimit);
        }
        let material = detector.material(RegionId(region));
        let energy = flight.photon.energy;
        if material.index.is_none() {
            return self.end(End::NoIndex);
        }
        flight.steps += 1;
        self.result.steps += 1;
        let mut stream = Stream::new(self.settings.seed, flight.number, flight.steps, Purpose::FreePath);
        let bulk = free_path(material, energy, &mut stream);
        let to_boundary = crossing.map_or(f64::INFINITY, |crossing| crossing.t);
        let length = bulk.map_or(f64::INFINITY, |(length, _)| length).min(to_boundary);
        let velocity = material.group_velocity.as_ref().map_or(LIGHT_SPEED, |table| table.at(energy));
        let ray = Ray { origin: flight.photon.position, direction: flight.photon.direction };
        flight.photon.time += length / velocity;
        if flight.photon.time > self.settings.max_time {
            return self.end(End::TimeLimit);
        }
        flight.photon.position = ray.at(length);
        match (bulk, crossing) {
            (Some((free, process)), _) if free < to_boundary => self.bulk(flight, material, process),
            (_, Some(crossing)) => self.boundary(i, flight, &ray, &crossing),
            // an unbounded material without any process
            _ => self.end(End::Escaped),
        }
    }

    /// A process in the material.
    fn bulk(&mut self, mut flight: Flight, material: &OpticalMaterial, process: Bulk) {
        let stream = |purpose| Stream::new(self.settings.seed, flight.number, flight.steps, purpose);
        let Photon { direction, polarisation, .. } = flight.photon;
        let scattered = match process {
            Bulk::Absorption => return self.end(End::Absorbed),
            Bulk::Shift(shifter) => return self.shift(flight, material, shifter),
            Bulk::Rayleigh => scatter::rayleigh(direction, polarisation, &mut stream(Purpose::Scattering)),
            Bulk::Mie => match &material.mie {
                Some(mie) => scatter::mie(mie, direction, polarisation, &mut stream(Purpose::Scattering)),
                None => (direction, polarisation),
            },
        };
        (flight.photon.direction, flight.photon.polarisation) = scattered;
        self.continue_with(flight);
    }

    /// Absorption and emission by a wavelength shifter.
    fn shift(&mut self, flight: Flight, material: &OpticalMaterial, shifter: usize) {
        let shifter = &material.shifters[shifter];
        let mut stream = Stream::new(self.settings.seed, flight.number, flight.steps, Purpose::Reemission);
        let count = shifter.mean_photons.map_or(1, |mean| stream.poisson(mean));
        let mut emitted = 0;
        for _ in 0..count {
            let Some(energy) = shifter.spectrum.quantile(stream.uniform(), flight.photon.energy) else {
                continue;
            };
            let direction = stream.direction();
            let polarisation = stream.polarisation(direction);
            let time = flight.photon.time + shifter.time;
            let photon = Photon { position: flight.photon.position, direction, polarisation, energy, time };
            // further photons have random numbers of their own
            let number = if emitted == 0 { flight.number } else { secondary(flight, emitted) };
            self.continue_with(Flight { number, photon, ..flight });
            emitted += 1;
        }
        match emitted {
            0 => self.end(End::ShifterAbsorbed),
            _ => self.result.photons += u64::from(emitted) - 1,
        }
    }

    /// The optical boundary process for photon `i` of the batch.
    fn boundary(&mut self, i: usize, mut flight: Flight, ray: &Ray, crossing: &Crossing) {
        let detector = self.detector;
        let normal = self.found.normal(i);
        let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        flight.photon.position = project(&detector.program, ray, crossing, normal);
        if crossing.after.0 == 0 {
            return self.end(End::Escaped);
        }
        let [front, behind] = [crossing.before, crossing.after].map(|region| detector.material(region));
        let energy = flight.photon.energy;
        let at = |material: &OpticalMaterial| material.index.as_ref().map(|index| index.at(energy));
        let [own, other] =
            [crossing.before, crossing.after].map(|region| detector.material_of[region.index()]);
        let mut boundary = Boundary {
            direction: flight.photon.direction,
            polarisation: flight.photon.polarisation,
            normal,
            energy,
            index: at(front).unwrap_or(1.0),
            index_behind: at(behind),
            is_same_material: own == other,
            surface: detector.surface(crossing),
        };
        let mut stream = Stream::new(self.settings.seed, flight.number, flight.steps, Purpose::Boundary);
        let (event, is_behind) = boundary.apply(&mut stream);
        *self.result.boundary_events.entry(event).or_default() += 1;
        let detects_efficiency = self.settings.detection != DetectionRule::Volume;
        let detects_volume = self.settings.detection != DetectionRule::Efficiency;
        match event {
            BoundaryEvent::Detection if detects_efficiency => return self.detect(flight, crossing),
            BoundaryEvent::Detection | BoundaryEvent::Absorption => return self.end(End::SurfaceAbsorbed),
            BoundaryEvent::NoIndex => return self.end(End::NoIndex),
            _ => {}
        }
        (flight.photon.direction, flight.photon.polarisation) = (boundary.direction, boundary.polarisation);
        if is_behind && detects_volume && detector.sensors[crossing.after.index()].is_some() {
            return self.detect(flight, crossing);
        }
        let side = if is_behind { ExitSide::Transmitted } else { ExitSide::Incident };
        let first = self.next_starts.len();
        detector.starts.append(
            &detector.program,
            (ray, crossing.t),
            Some(crossing),
            side,
            &mut self.next_starts,
        );
        if side == ExitSide::Incident && crossing.t == 0.0 {
            // At an edge a photon is reflected by one face and then, without any way between, by the next: the way does not
            // show on which side of the first face the photon is, but its start list does.
            let lists = StartLists { first: &self.first, entries: &self.starts };
            for start in &mut self.next_starts[first + 1..] {
                let own = |s: &&Start| (s.surface, s.placement) == (start.surface, start.placement);
                if let Some(known) = lists.of(i).iter().find(own) {
                    start.inside = known.inside;
                }
            }
        }
        self.continue_with(flight);
    }

    fn detect(&mut self, flight: Flight, crossing: &Crossing) {
        let path = sensor_path(self.detector, crossing.entered, crossing.after.0);
        self.result.hits.push((self.settings.event, flight.origin), flight.steps, &flight.photon, path);
        self.end(End::Detected);
    }
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

/// The shortest free path in a material and its process; `None` if there is no process.
fn free_path(material: &OpticalMaterial, energy: f64, stream: &mut Stream) -> Option<(f64, Bulk)> {
    let mut shortest: Option<(f64, Bulk)> = None;
    let mut propose = |mean: f64, process: Bulk| {
        let length = mean * stream.exponential();
        if shortest.is_none_or(|(other, _)| length < other) {
            shortest = Some((length, process));
        }
    };
    if let Some(table) = &material.absorption_length {
        propose(table.at(energy), Bulk::Absorption);
    }
    if let Some(table) = &material.rayleigh_length {
        propose(table.at(energy), Bulk::Rayleigh);
    }
    if let Some(mie) = &material.mie {
        propose(mie.length.at(energy), Bulk::Mie);
    }
    for (number, shifter) in material.shifters.iter().enumerate() {
        propose(shifter.length.at(energy), Bulk::Shift(number));
    }
    shortest
}
