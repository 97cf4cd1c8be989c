//! The loop: light through a system, event by event.
//!
//! Rays are followed in chunks: eight at a time as far as it is foreseen what they meet, then all rays of a chunk that are
//! left a generation at a time. A ray that leaves an interface starts on its
//! surface, without any offset (see [`rayweave_model::Start`]); one that goes straight on through a sheet stays the same ray.

mod eight;
mod events;
mod flight;
mod rows;

use crate::beam::{Beam, Emitter};
use crate::error::OpticsError;
use crate::generation::{Generation, Met, Part, SheetMet};
use crate::indices::Indices;
use crate::segments::{Balance, Segments};
use crate::settings::Settings;
use crate::system::System;
pub(crate) use events::{against, mixed};
use flight::waiting_for;
use rayweave_math::Affine;
use rayweave_model::drive::{Stopped, drive, thread_count};
use rayweave_model::{Evaluator, Limit, Program, Query, RayAnswer};
use rayweave_shape::lanes::LANES;
use rows::{Pool, Rows};
use std::ops::Range;
use std::sync::Arc;

/// Rays per chunk: enough for batches to pay, few enough to stay in cache with all their segments.
const CHUNK: usize = 2048;

/// A system with evaluators for its programs, ready to be asked.
#[derive(Debug)]
pub struct Tracer<'a, E> {
    pub(crate) system: &'a System,
    pub(crate) solids: E,
    sheets: Vec<E>,
    frames: Vec<(Affine, Affine)>,
}

/// Everything that came of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// The segments of all rays: chunk by chunk of the source, in each chunk generation by generation.
    pub segments: Segments,
    /// Where the power went.
    pub balance: Balance,
}

impl<'a, E: Evaluator> Tracer<'a, E> {
    /// With evaluators made by a function.
    pub fn new(system: &'a System, make: impl Fn(Arc<Program>) -> E) -> Tracer<'a, E> {
        let frames = system.plates.iter().map(|plate| {
            // a singular frame does not compile
            (plate.frame, plate.frame.inverse().unwrap_or(Affine::IDENTITY))
        });
        Tracer {
            system,
            solids: make(system.program.clone()),
            sheets: system.plates.iter().map(|plate| make(plate.program.clone())).collect(),
            frames: frames.collect(),
        }
    }

    /// The system.
    pub fn system(&self) -> &'a System {
        self.system
    }

    /// Traces light and keeps all segments.
    ///
    /// # Errors
    /// [`OpticsError`] for light that cannot be traced, and if the run is cancelled.
    pub fn trace(&self, light: &impl Emitter, settings: &Settings) -> Result<Trace, OpticsError> {
        let mut trace = Trace::default();
        self.trace_into(light, settings, &mut trace)?;
        Ok(trace)
    }

    /// The same in place of what a trace held before, in its memory: where many are made one after the other, new memory may
    /// take longer to get than light takes on its way. After an error the trace holds some of the segments.
    ///
    /// # Errors
    /// Those of [`Tracer::trace`].
    pub fn trace_into(
        &self,
        light: &impl Emitter,
        settings: &Settings,
        trace: &mut Trace,
    ) -> Result<(), OpticsError> {
        let segments = &mut trace.segments;
        segments.clear();
        trace.balance = self.run_with(light, settings, |rows| {
            if segments.is_empty() {
                // all chunks come to about as many rows
                segments.reserve(rows.len() * light.count().div_ceil(CHUNK));
            }
            rows.append_to(segments, settings.keep);
            Ok::<(), OpticsError>(())
        })?;
        Ok(())
    }

    /// Traces light and gives the segments away chunk by chunk, in the order of the source, so that a run of any length
    /// takes bounded memory. Parents are row numbers within the chunk.
    ///
    /// # Errors
    /// [`OpticsError`] for light that cannot be traced, if the run is cancelled, and what `sink` returns.
    pub fn run<X: From<OpticsError>>(
        &self,
        light: &impl Emitter,
        settings: &Settings,
        mut sink: impl FnMut(Segments) -> Result<(), X>,
    ) -> Result<Balance, X> {
        self.run_with(light, settings, |rows| {
            let mut segments = Segments::default();
            segments.reserve(rows.len());
            rows.append_to(&mut segments, settings.keep);
            sink(segments)
        })
    }

    fn run_with<X: From<OpticsError>>(
        &self,
        light: &impl Emitter,
        settings: &Settings,
        mut sink: impl FnMut(&Rows) -> Result<(), X>,
    ) -> Result<Balance, X> {
        let pool = Pool::default();
        let count = light.count();
        let chunks = (0..count).step_by(CHUNK).map(|at| at..(at + CHUNK).min(count));
        let mut balance =
            Balance { absorbed: vec![0.0; self.system.element_names().len()], ..Balance::default() };
        let work = |worker: &mut Worker<'_, E>, range: Range<usize>| worker.chunk(light, range);
        let merge = |found: Result<(Rows, Balance), OpticsError>| -> Result<(), X> {
            let (rows, part) = found?;
            balance.add(&part);
            sink(&rows)?;
            pool.give(rows);
            Ok(())
        };
        let threads = thread_count(settings.threads);
        drive(threads, &settings.cancel, chunks, || Worker::new(self, settings, &pool), work, merge)
            .map_err(|stopped| match stopped {
                Stopped::Cancelled => OpticsError::Cancelled.into(),
                Stopped::Failed(error) => error,
            })?;
        Ok(balance)
    }
}

/// A thread with its memory.
pub(crate) struct Worker<'t, E: Evaluator> {
    pub(crate) tracer: &'t Tracer<'t, E>,
    settings: &'t Settings,
    pool: &'t Pool,
    scratch: E::Scratch,
    sheet_scratch: Vec<E::Scratch>,
    beam: Beam,
    now: Generation,
    next: Generation,
    met: Met,
    /// The rays that join those of a round.
    waiting: Vec<Generation>,
    /// The number of the first ray of the beam.
    first: u64,
    part: Part,
    indices: Indices,
    pub(crate) rows: Rows,
    pub(crate) balance: Balance,
}

impl<'t, E: Evaluator> Worker<'t, E> {
    fn new(tracer: &'t Tracer<'t, E>, settings: &'t Settings, pool: &'t Pool) -> Self {
        Worker {
            tracer,
            settings,
            pool,
            scratch: tracer.solids.scratch(),
            sheet_scratch: tracer.sheets.iter().map(Evaluator::scratch).collect(),
            beam: Beam::default(),
            now: Generation::default(),
            next: Generation::default(),
            met: Met::default(),
            waiting: Vec::new(),
            first: 0,
            part: Part::default(),
            indices: Indices::default(),
            rows: Rows::default(),
            balance: Balance::default(),
        }
    }

    /// Follows the rays of a range to their ends.
    fn chunk(&mut self, light: &impl Emitter, range: Range<usize>) -> Result<(Rows, Balance), OpticsError> {
        self.balance =
            Balance { absorbed: vec![0.0; self.tracer.system.element_names().len()], ..Balance::default() };
        self.beam.clear();
        light.emit(range.clone(), &mut self.beam);
        self.beam.check(self.tracer.system).map_err(|error| moved(error, range.start))?;
        self.balance.emitted = self.beam.powers().iter().sum();
        self.first = range.start as u64;
        self.now.clear();
        self.fly();
        self.follow();
        let next = self.pool.take().unwrap_or_default();
        Ok((std::mem::replace(&mut self.rows, next), std::mem::take(&mut self.balance)))
    }

    /// Follows rays round by round until none is left.
    fn follow(&mut self) {
        self.now.clear();
        let mut round = 0;
        while self.now.len() > 0 || round < self.waiting.len() {
            let waiting = waiting_for(&mut self.waiting, round);
            match self.now.len() {
                0 => std::mem::swap(&mut self.now, waiting),
                _ => self.now.append(waiting),
            }
            waiting.clear();
            self.rows.rounds.push(self.rows.single.len());
            self.generation();
            round += 1;
        }
    }

    /// One event for every ray, or several where it passes sheets.
    fn generation(&mut self) {
        self.ask();
        let (now, met) = (std::mem::take(&mut self.now), std::mem::take(&mut self.met));
        let is_simple = self.settings.is_simple();
        let mut sheets = &met.sheets[..];
        let mut i = 0;
        while i < now.len() {
            let is_clear = sheets.first().is_none_or(|met| met.ray >= i + LANES);
            if is_simple && is_clear && self.transmit_eight(&now, &met, i).is_some() {
                i += LANES;
                continue;
            }
            let count = sheets.iter().take_while(|met| met.ray == i).count();
            let (here, rest) = sheets.split_at(count);
            sheets = rest;
            if !(here.is_empty() && is_simple && self.transmit(&now, &met, i)) {
                match self.is_bent(&met, i) {
                    true => self.bend(&now, &met, i),
                    false => self.advance(now.get(i), &met, i, here),
                }
            }
            i += 1;
        }
        (self.now, self.met) = (std::mem::replace(&mut self.next, now), met);
        self.next.clear();
    }

    /// Finds what all rays meet.
    fn ask(&mut self) {
        self.met.reset(self.now.len());
        let query = Query { starts: self.now.lists(), ..Query::nearest() };
        let (mut hits, between) = self.met.columns();
        self.tracer.solids.nearest_from(self.now.rays.rays(), &query, &mut self.scratch, &mut hits, between);
        for sheet in 0..self.tracer.sheets.len() {
            self.ask_sheet(sheet);
        }
        self.met.sort();
    }

    fn ask_sheet(&mut self, sheet: usize) {
        let around = &self.tracer.system.plates[sheet].around;
        self.part.gather(&self.now, &self.met, sheet, around);
        let query = Query { limit: Limit::All, starts: self.part.lists(), ..Query::nearest() };
        let (numbers, found) = (&self.part.numbers, &mut self.met.sheets);
        let mut take = |answer: RayAnswer<'_>| {
            let through = answer.crossings.iter().filter(|c| c.before.0 != 0 && c.after.0 != 0);
            found.extend(through.map(|&crossing| SheetMet { ray: numbers[answer.ray], sheet, crossing }));
        };
        let scratch = &mut self.sheet_scratch[sheet];
        self.tracer.sheets[sheet].crossings(self.part.rays.rays(), &query, scratch, &mut take);
    }
}

/// Counts the rays of an error from the beginning of the source.
fn moved(error: OpticsError, by: usize) -> OpticsError {
    match error {
        OpticsError::Ray(mut bad) => {
            bad.ray += by;
            OpticsError::Ray(bad)
        }
        OpticsError::BadLight { column, ray, value, range } => {
            OpticsError::BadLight { column, ray: ray + by, value, range }
        }
        OpticsError::Wavelength { ray, wavelength_nm, medium, range_nm } => {
            OpticsError::Wavelength { ray: ray + by, wavelength_nm, medium, range_nm }
        }
        other => other,
    }
}
