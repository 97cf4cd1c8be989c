//! Non-sequential ray tracing: light through a system, event by event.
//!
//! Rays are traced in chunks. Each chunk is first traced in bundles of eight with hit prediction
//! ([`crate::bundle`]); the remaining rays are traced generation by generation: an evaluator
//! computes the next hits of all of them ([`finder`]), and the [`Propagator`] applies one event to
//! each ray.
//!
//! A ray that leaves an interface starts on its surface, without any offset (see
//! [`rayweave_model::Start`]); one that passes straight through a sheet remains the same ray.

mod finder;
mod generation;
mod hits;
mod index_cache;
mod propagate;
mod row_limit;
mod rows;
mod splitmix;

pub(crate) use generation::{Generation, Pending, RayState};
pub(crate) use hits::Hits;
pub(crate) use index_cache::OpticalConstants;
pub(crate) use propagate::{Propagator, oriented_against};
pub use row_limit::RowLimit;

use crate::beam::{Beam, Emitter};
use crate::bundle;
use crate::error::OpticsError;
use crate::segments::{Balance, Segments};
use crate::settings::TraceSettings;
use crate::system::System;
use finder::HitFinder;
use rayweave_model::drive::{Stopped, drive, thread_count};
use rayweave_model::memory::{self, Growth, Shortage};
use rayweave_model::{Evaluator, Program};
use rows::{Pool, Rows};
use std::ops::Range;
use std::sync::Arc;

/// Rays per chunk.
const CHUNK: usize = TraceSettings::CHUNK;

/// A system with evaluators for its programs, ready to trace light.
#[derive(Debug)]
pub struct Tracer<'a, E> {
    pub(crate) system: &'a System,
    pub(crate) solids: E,
    sheets: Vec<E>,
}

/// The result of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// The segments of all rays, chunk by chunk, and within each chunk generation by generation.
    pub segments: Segments,
    /// The power balance.
    pub balance: Balance,
}

impl<'a, E: Evaluator> Tracer<'a, E> {
    /// A tracer with evaluators made by a function.
    pub fn new(system: &'a System, make: impl Fn(Arc<Program>) -> E) -> Tracer<'a, E> {
        Tracer {
            system,
            solids: make(system.program.clone()),
            sheets: system.sheets.iter().map(|sheet| make(sheet.program.clone())).collect(),
        }
    }

    /// The system.
    pub fn system(&self) -> &'a System {
        self.system
    }

    /// Traces light and keeps all segments.
    ///
    /// # Errors
    /// [`OpticsError`] for light that cannot be traced, for segments that do not fit into memory, and if the
    /// run is cancelled.
    pub fn trace(&self, light: &impl Emitter, settings: &TraceSettings) -> Result<Trace, OpticsError> {
        let mut trace = Trace::default();
        self.trace_into(light, settings, &mut trace)?;
        Ok(trace)
    }

    /// Like [`Tracer::trace`], but reuses the buffers of an existing [`Trace`], so that repeated
    /// traces do not allocate memory for segments again. After an error the trace holds some of the
    /// segments.
    ///
    /// # Errors
    /// Those of [`Tracer::trace`].
    pub fn trace_into(
        &self,
        light: &impl Emitter,
        settings: &TraceSettings,
        trace: &mut Trace,
    ) -> Result<(), OpticsError> {
        let segments = &mut trace.segments;
        segments.clear();
        let mut limit = RowLimit::new(light, settings)?;
        trace.balance = self.run_with(light, settings, |rows| {
            if segments.is_empty() {
                // assumes about the same number of rows in every chunk
                let count = settings.rays.as_ref().map_or(light.count(), Range::len);
                let expected = rows.len().saturating_mul(count.div_ceil(CHUNK));
                if memory::check(expected as u64, Segments::ROW).is_ok() {
                    segments.reserve(expected);
                }
            }
            rows.append_to(segments, settings.keep);
            limit.check(segments.len())
        })?;
        Ok(())
    }

    /// Traces light and passes the segments to `sink` chunk by chunk, in the order of the source,
    /// so that a run of any length takes bounded memory. Parents are row numbers within the chunk.
    ///
    /// # Errors
    /// [`OpticsError`] for light that cannot be traced, if the run is cancelled, and any error of
    /// `sink`.
    pub fn run<X: From<OpticsError>>(
        &self,
        light: &impl Emitter,
        settings: &TraceSettings,
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
        settings: &TraceSettings,
        mut sink: impl FnMut(&Rows) -> Result<(), X>,
    ) -> Result<Balance, X> {
        let pool = Pool::default();
        let rays = settings.range(light.count())?;
        let end = rays.end;
        let chunks = rays.step_by(CHUNK).map(|at| at..(at + CHUNK).min(end));
        let mut balance = Balance::of_elements(self.system.element_names().len());
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

/// A thread with its buffers.
struct Worker<'t, E: Evaluator> {
    finder: HitFinder<'t, E>,
    light: Propagator<'t>,
    pool: &'t Pool,
    beam: Beam,
    now: Generation,
    pending: Pending,
    growth: Growth,
}

impl<'t, E: Evaluator> Worker<'t, E> {
    fn new(tracer: &'t Tracer<'t, E>, settings: &'t TraceSettings, pool: &'t Pool) -> Self {
        Worker {
            finder: HitFinder::new(tracer.system, &tracer.solids, &tracer.sheets),
            light: Propagator::new(tracer.system, settings),
            pool,
            beam: Beam::default(),
            now: Generation::default(),
            pending: Pending::default(),
            growth: Growth::default(),
        }
    }

    /// Traces the rays of a range to their ends.
    fn chunk(&mut self, light: &impl Emitter, range: Range<usize>) -> Result<(Rows, Balance), OpticsError> {
        let system = self.light.system;
        self.light.balance = Balance::of_elements(system.element_names().len());
        self.beam.clear();
        light.emit(range.clone(), &mut self.beam);
        self.beam.check(system).map_err(|error| moved(error, range.start))?;
        self.light.balance.emitted = self.beam.powers().iter().sum();
        let (finder, first) = (&mut self.finder, range.start as u64);
        bundle::trace(&mut self.light, (&self.beam, first), &mut self.pending, &mut |rays| {
            finder.common_hit(rays)
        });
        self.trace_generations().map_err(|shortage| OpticsError::Memory { rays: range.len(), shortage })?;
        let rows = self.pool.take().unwrap_or_default();
        let balance = std::mem::take(&mut self.light.balance);
        Ok((std::mem::replace(&mut self.light.rows, rows), balance))
    }

    /// Traces the pending rays generation by generation until none is left. Where light is divided again and again, their number
    /// grows exponentially with the number of generations.
    fn trace_generations(&mut self) -> Result<(), Shortage> {
        self.now.clear();
        let mut number = 0;
        while self.now.len() > 0 || number < self.pending.generations() {
            let pending = self.pending.at(number);
            match self.now.len() {
                0 => std::mem::swap(&mut self.now, pending),
                _ => self.now.append(pending),
            }
            pending.clear();
            let hits = self.finder.find(&self.now);
            self.light.propagate_generation(&self.now, hits);
            std::mem::swap(&mut self.now, &mut self.light.next);
            self.light.next.clear();
            number += 1;
            // with its hit and its start list, a ray takes about as much memory as two rows; so does each of the two
            // rays into which it may be divided
            let rows = 6 * self.now.len() + self.light.rows.len();
            self.growth.check(rows as u64 * Segments::ROW)?;
        }
        Ok(())
    }
}

/// Converts the ray number of an error from the chunk to the source.
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
