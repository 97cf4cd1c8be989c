//! Photons on a graphics card, with the histories of the CPU.
//!
//! The device moves photons step by step in double precision, by the operations of the CPU. A photon that needs a process, a
//! surface or a shape that the device does not know, or whose next crossing is in doubt, is *handed back*: the CPU continues it from
//! the state before that step. So every history is that of the CPU.
//!
//! Two batches of photons are in flight: while one is on the device, the CPU emits the photons of the other and completes its hits.
//! The results are merged in the order of the photon numbers, whichever batch is complete first.

mod codes;
mod tables;
#[cfg(test)]
mod tests;

use crate::batch::Batch;
use crate::detector::{DetectionRule, Detector};
use crate::error::PhotonError;
use crate::flight::{End, Flight};
use crate::hits::Hits;
use crate::photon::{EventKey, Photon};
use crate::propagate::{BATCH, check, simulate_parts};
use crate::run::{PhotonPart, PhotonRun};
use crate::settings::{RunSettings, TimeProfile};
use crate::source::Source;
use codes::{
    BY_EFFICIENCY, BY_VOLUME, COUNTS, DETECTED, EVENTS, EXPONENTIAL, FIRST_END, FIRST_EVENT, HANDED_BACK,
};
use rayweave_gpu::{Adapter, AdapterKind, Carried, Carrier, CarrierForm, CarrierSlot, GpuError};
use rayweave_math::Vec3;
use rayweave_model::Evaluator;
use rayweave_model::drive::{Stopped, drive, thread_count};
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use tables::Tables;

/// The number of photons of a batch on a card, and on a program that acts as one.
const ROOM: usize = 1 << 19;
const SOFTWARE_ROOM: usize = 1 << 14;

/// The number of batches in flight by default: one on the device, and one that the CPU prepares or completes.
const IN_FLIGHT: NonZeroUsize = NonZeroUsize::new(2).unwrap();

/// Steps of a photon in one pass: the drivers of cards stop kernels that run for seconds.
const PASS: u32 = 64;

/// The number of photons of a batch that the CPU simulates as well, for a comparison of the hits.
const COMPARED: u64 = 128;

/// Numbers and words of a photon on its way to the device, and of one that comes back.
const STATE: [usize; 2] = [11, 8];
const ROW: [usize; 2] = [11, 10];

/// A detector on a graphics card.
#[derive(Debug)]
pub struct PhotonDevice {
    tables: Tables,
    carrier: Carrier,
    /// The buffers of batches in flight, made when they are first used. The device is busy with one run at a time.
    slots: Mutex<Vec<CarrierSlot>>,
    in_flight: NonZeroUsize,
    adapter: String,
    /// Called with the number of the first photon of each batch that is complete, in tests of the order.
    #[cfg(test)]
    completed: fn(u64),
}

/// The share of a device in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PhotonDeviceReport {
    /// The photons of the source.
    pub photons: u64,
    /// Those that the CPU finished.
    pub handed_back: u64,
    /// The steps on the device.
    pub steps: u64,
    /// Bytes moved to the device and back.
    pub bytes: u64,
    /// The time to emit photons, summed over the batches.
    pub emit: Duration,
    /// The time on the device, transfers included, summed over the batches; with two batches in flight it includes waiting for the
    /// other one.
    pub device: Duration,
    /// The time to complete hits and photons on the CPU, summed over the batches.
    pub complete: Duration,
    /// The reason why the CPU simulated the rest of the run.
    pub problem: Option<GpuError>,
}

impl PhotonDeviceReport {
    /// Adds the report of a further run.
    pub fn add(&mut self, other: PhotonDeviceReport) {
        self.photons += other.photons;
        self.handed_back += other.handed_back;
        self.steps += other.steps;
        self.bytes += other.bytes;
        self.emit += other.emit;
        self.device += other.device;
        self.complete += other.complete;
        self.problem = self.problem.take().or(other.problem);
    }
}

impl PhotonDevice {
    /// The device of a detector.
    ///
    /// # Errors
    ///
    /// [`GpuError`] for a detector that is too large or unbounded, and for a card that does not compute as the CPU does.
    pub fn new(adapter: &Adapter, detector: &Detector) -> Result<PhotonDevice, GpuError> {
        let room = if adapter.kind() == AdapterKind::Software { SOFTWARE_ROOM } else { ROOM };
        PhotonDevice::with_tables(adapter, Tables::new(detector)?, room)
    }

    fn with_tables(adapter: &Adapter, tables: Tables, room: usize) -> Result<PhotonDevice, GpuError> {
        let form = CarrierForm { state: STATE, row: ROW, counts: COUNTS, params: 8 };
        let columns = (&tables.next.exact[..], &tables.next.words[..]);
        let carrier = Carrier::new(adapter, tables.source.clone(), columns, form, room)?;
        let slots = Mutex::new(vec![carrier.slot()?]);
        Ok(PhotonDevice {
            tables,
            carrier,
            slots,
            in_flight: IN_FLIGHT,
            adapter: adapter.name().to_owned(),
            #[cfg(test)]
            completed: |_| (),
        })
    }

    /// Sets the number of batches in flight, by default two. Each takes memory of the card for its photons; results do not depend on it.
    #[must_use]
    pub fn with_batches_in_flight(self, in_flight: NonZeroUsize) -> PhotonDevice {
        PhotonDevice { in_flight, ..self }
    }

    /// The name of the card.
    pub fn adapter(&self) -> &str {
        &self.adapter
    }

    /// Simulates photons as [`simulate_parts`] does, in larger parts and without histories. If the device fails, the CPU simulates the
    /// rest, and the report states the reason.
    ///
    /// # Errors
    ///
    /// Those of [`simulate_parts`].
    pub fn simulate_parts<E: Evaluator, X: From<PhotonError>>(
        &self,
        detector: &Detector,
        evaluator: &E,
        source: &Source,
        settings: &RunSettings,
        report: &mut PhotonDeviceReport,
        mut merge: impl FnMut(PhotonPart) -> Result<(), X>,
    ) -> Result<(), X> {
        check(source, settings)?;
        let Range { start, end } = settings.photons;
        let room = self.carrier.room() as u64;
        // an empty range gives one empty part: its columns are those of other parts
        let count = end.saturating_sub(start).div_ceil(room).max(1);
        let batches = (0..count).map(|k| start + k * room..(start + (k + 1) * room).min(end.max(start)));
        let mut slots = self.slots.lock().unwrap_or_else(PoisonError::into_inner);
        let in_flight = if count > 1 { self.in_flight } else { NonZeroUsize::MIN };
        let mut next = start;
        let done = self.fill(&mut slots, in_flight).map_err(|error| Stopped::Failed(Halt::Device(error)));
        let done = done.and_then(|()| {
            let job = Job { device: self, detector, evaluator, source, settings };
            let free = Mutex::new(slots.iter().collect::<Vec<_>>());
            let take = || free.lock().unwrap_or_else(PoisonError::into_inner).pop();
            let work = |slot: &mut Option<&CarrierSlot>, numbers: Range<u64>| {
                let Some(slot) = *slot else { unreachable!("there is a slot for each batch in flight") };
                (numbers.clone(), job.checked(slot, numbers))
            };
            drive(in_flight, &settings.cancel, batches, take, work, |(photons, result)| {
                let (run, own) = result.map_err(|failed| match failed {
                    Failed::Photon(error) => Halt::Run(error.into()),
                    Failed::Device(error) => Halt::Device(error),
                })?;
                report.add(own);
                next = photons.end;
                merge(PhotonPart { photons, run, histories: None }).map_err(Halt::Run)
            })
        });
        match done {
            Ok(()) => Ok(()),
            Err(Stopped::Cancelled) => Err(PhotonError::Cancelled.into()),
            Err(Stopped::Failed(Halt::Run(error))) => Err(error),
            Err(Stopped::Failed(Halt::Device(error))) => {
                report.problem = Some(error);
                drop(slots);
                let rest = RunSettings { photons: next..end, ..settings.clone() };
                simulate_parts(detector, evaluator, source, &rest, None, merge)
            }
        }
    }

    /// Makes buffers until there are enough for a number of batches.
    fn fill(&self, slots: &mut Vec<CarrierSlot>, count: NonZeroUsize) -> Result<(), GpuError> {
        while slots.len() < count.get() {
            slots.push(self.carrier.slot()?);
        }
        Ok(())
    }
}

/// The reason why a run ends early.
enum Halt<X> {
    /// An error of the run, which the caller gets.
    Run(X),
    /// A problem of the device: the CPU continues.
    Device(GpuError),
}

/// The reason why a batch has no result.
enum Failed {
    Photon(PhotonError),
    Device(GpuError),
}

impl From<Stopped<PhotonError>> for Failed {
    fn from(stopped: Stopped<PhotonError>) -> Failed {
        Failed::Photon(match stopped {
            Stopped::Cancelled => PhotonError::Cancelled,
            Stopped::Failed(error) => error,
        })
    }
}

/// A run on a device.
struct Job<'r, E> {
    device: &'r PhotonDevice,
    detector: &'r Detector,
    evaluator: &'r E,
    source: &'r Source,
    settings: &'r RunSettings,
}

impl<E: Evaluator> Job<'_, E> {
    /// Simulates a batch of photons and compares its first hits with those of the CPU.
    fn checked(
        &self,
        slot: &CarrierSlot,
        numbers: Range<u64>,
    ) -> Result<(PhotonRun, PhotonDeviceReport), Failed> {
        let found = self.run(slot, numbers.clone())?;
        if !self.agrees(&found.0, numbers.clone())? {
            return Err(Failed::Device(GpuError::Contradicted { adapter: self.device.adapter.clone() }));
        }
        #[cfg(test)]
        (self.device.completed)(numbers.start);
        Ok(found)
    }

    /// Simulates a batch of photons.
    fn run(
        &self,
        slot: &CarrierSlot,
        numbers: Range<u64>,
    ) -> Result<(PhotonRun, PhotonDeviceReport), Failed> {
        let cancel = &self.settings.cancel;
        let count = numbers.end - numbers.start;
        let clock = Instant::now();
        self.emit(slot, numbers.clone())?;
        let emitted = clock.elapsed();
        let carrier = &self.device.carrier;
        let carried = carrier.run(slot, count as usize, &self.params(), || cancel.is_cancelled());
        let carried = carried.map_err(Failed::Device)?;
        if cancel.is_cancelled() {
            return Err(Failed::Photon(PhotonError::Cancelled));
        }
        let back = clock.elapsed();
        let mut run = self.complete(&carried, numbers.start)?;
        let counted = |place: usize| carried.counts[place - 2];
        let report = PhotonDeviceReport {
            photons: count,
            handed_back: counted(FIRST_END + HANDED_BACK as usize - 1),
            steps: counted(2),
            bytes: carried.bytes,
            emit: emitted,
            device: back - emitted,
            complete: clock.elapsed() - back,
            problem: None,
        };
        run.photons += count;
        run.steps += report.steps;
        for (k, end) in End::ALL.into_iter().enumerate() {
            add(&mut run.ends, end, counted(FIRST_END + k));
        }
        for (k, (_, event)) in EVENTS.into_iter().enumerate() {
            add(&mut run.boundary_events, event, counted(FIRST_EVENT + k));
        }
        Ok((run, report))
    }

    /// True if the CPU has the same hits for the first photons of a batch.
    fn agrees(&self, run: &PhotonRun, numbers: Range<u64>) -> Result<bool, Failed> {
        let some = numbers.start..numbers.end.min(numbers.start + COMPARED);
        let mut batch = Batch::new(self.detector, self.evaluator, self.settings, ());
        let own = batch.run(self.source, some.clone()).map_err(|shortage| Failed::Photon(shortage.into()))?;
        Ok(run.hits.begins_with(&own.hits, some.end))
    }

    /// Uploads the photons of a batch, as the source emits them.
    fn emit(&self, slot: &CarrierSlot, numbers: Range<u64>) -> Result<(), Failed> {
        let key = EventKey { seed: self.settings.seed, event: self.settings.event };
        let start = numbers.start;
        drive(
            thread_count(self.settings.threads),
            &self.settings.cancel,
            chunks(numbers),
            || self.evaluator.scratch(),
            |scratch, numbers: Range<u64>| {
                let mut photons = Vec::new();
                let emitter = (self.detector, self.evaluator);
                self.source.emit(emitter, scratch, key, numbers.clone(), &mut photons);
                ((numbers.start - start) as usize, states(numbers, key, &photons))
            },
            |(first, (numbers, words))| {
                self.device.carrier.load(slot, first, &numbers, &words);
                Ok(())
            },
        )?;
        Ok(())
    }

    /// The parameters of the kernel behind the first two.
    fn params(&self) -> [u32; 8] {
        let RunSettings { seed, max_time, max_steps, detection, wls_time_profile, .. } = *self.settings;
        let halves = |bits: u64| [bits as u32, (bits >> 32) as u32];
        let ([a, b], [c, d]) = (halves(seed), halves(max_time.to_bits()));
        let rules = [
            (detection != DetectionRule::Volume, BY_EFFICIENCY),
            (detection != DetectionRule::Efficiency, BY_VOLUME),
            (wls_time_profile == TimeProfile::Exponential, EXPONENTIAL),
        ];
        let rules = rules.iter().filter(|(holds, _)| *holds).map(|(_, bit)| bit).sum();
        [PASS, max_steps, a, b, c, d, rules, 0]
    }

    /// The hits, and the results of the photons that the CPU continues; `first` is the number of the first photon.
    fn complete(&self, carried: &Carried, first: u64) -> Result<PhotonRun, Failed> {
        let key = EventKey { seed: self.settings.seed, event: self.settings.event };
        let mut rows: Vec<u32> = (0..(carried.words.len() / ROW[1]) as u32).collect();
        rows.sort_unstable_by_key(|&row| carried.words[ROW[1] * row as usize]);
        let returned = |&row: &u32| Returned::new(carried, row as usize, (first, key));
        let work = |batch: &mut Batch<'_, E, ()>, rows: &[u32]| {
            let all = || rows.iter().map(returned);
            let flights = all().filter(|own| own.state == HANDED_BACK);
            let starts = |own: Returned| {
                let starts = own.starts.map(|start| self.device.tables.next.start(start));
                (own.flight, starts.into_iter().flatten())
            };
            let flights = flights.map(starts);
            let detected = all().filter(|own| own.state == DETECTED);
            let volume =
                |own: &Returned| Some((own.after, self.device.tables.next.face(own.facet, own.item)?));
            let detected = detected.filter_map(|own| Some((own.flight, volume(&own)?)));
            batch.resume(self.source, flights, detected).map_err(PhotonError::from)
        };
        let mut total = PhotonRun::default();
        drive(
            thread_count(self.settings.threads),
            &self.settings.cancel,
            rows.chunks(BATCH as usize),
            || Batch::new(self.detector, self.evaluator, self.settings, ()),
            work,
            |run| {
                total.append(run?);
                Ok(())
            },
        )?;
        if total.hits.is_empty() {
            total.hits = Hits::default();
            total.hits.genstep = self.source.parents(&[]);
        }
        Ok(total)
    }
}

/// Adds a count of a kind of events, if it is not 0.
fn add<K: Ord>(counts: &mut std::collections::BTreeMap<K, u64>, kind: K, count: u64) {
    if count > 0 {
        *counts.entry(kind).or_default() += count;
    }
}

/// The bytes of the states of new photons: of their numbers and of their words.
fn states(numbers: Range<u64>, key: EventKey, photons: &[Photon]) -> (Vec<u8>, Vec<u8>) {
    let [mut own_numbers, mut own_words] =
        [8 * STATE[0], 4 * STATE[1]].map(|size| Vec::with_capacity(size * photons.len()));
    for (number, photon) in numbers.zip(photons) {
        let vectors = [photon.position, photon.direction, photon.polarisation];
        for value in vectors.iter().flat_map(|vector| vector.to_array()).chain([photon.energy, photon.time]) {
            own_numbers.extend_from_slice(&value.to_le_bytes());
        }
        let number = key.number(number);
        for word in [(number >> 32) as u32, number as u32, 0, 0, 0, 0, 0, 0] {
            own_words.extend_from_slice(&word.to_le_bytes());
        }
    }
    (own_numbers, own_words)
}

/// A range of photons in parts that the CPU simulates together.
fn chunks(numbers: Range<u64>) -> impl Iterator<Item = Range<u64>> + Send {
    let Range { start, end } = numbers;
    (0..(end - start).div_ceil(BATCH)).map(move |k| start + k * BATCH..(start + (k + 1) * BATCH).min(end))
}

/// A photon that came back.
struct Returned {
    flight: Flight,
    state: u32,
    after: u32,
    facet: u32,
    item: u32,
    starts: [u32; 4],
}

impl Returned {
    fn new(carried: &Carried, row: usize, (first, key): (u64, EventKey)) -> Returned {
        let numbers = &carried.numbers[ROW[0] * row..ROW[0] * (row + 1)];
        let words = &carried.words[ROW[1] * row..ROW[1] * (row + 1)];
        let vector = |k: usize| Vec3::new(numbers[k], numbers[k + 1], numbers[k + 2]);
        let photon = Photon {
            position: vector(0),
            direction: vector(3),
            polarisation: vector(6),
            energy: numbers[9],
            time: numbers[10],
        };
        let origin = first + u64::from(words[0]);
        let flight = Flight { origin, number: key.number(origin), steps: words[2], region: u32::MAX, photon };
        let starts = [words[6], words[7], words[8], words[9]];
        Returned { flight, state: words[1], after: words[3], facet: words[4], item: words[5], starts }
    }
}
