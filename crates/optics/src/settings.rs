//! Settings of a light trace: branches, polarisation, limits, rows, seed and threads.

use crate::OpticsError;
use rayweave_model::drive::Cancel;
use std::num::NonZeroUsize;
use std::ops::Range;

/// The branches that are traced where light is partly reflected and partly transmitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Branches {
    /// Lossless transmission, or total internal reflection. Metals and mirrors keep their
    /// reflectance, and beam splitters split.
    #[default]
    Ideal,
    /// Both branches, each with its part of the power.
    Both,
    /// One of them at random, with all the power.
    Random,
}

/// The segments that are rows of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// All of them.
    #[default]
    All,
    /// The last segment of each ray. These rows have no parents.
    Ends,
}

/// Settings of a light trace.
#[derive(Clone, Debug)]
pub struct TraceSettings {
    /// The branches at partial reflection.
    pub branches: Branches,
    /// Whether polarisation is traced; otherwise light is unpolarised at every interface.
    pub polarised: bool,
    /// The number of events after which a ray is dropped.
    pub generation_limit: u32,
    /// The power below which a ray is dropped.
    pub threshold: f64,
    /// The segments that are rows of the table.
    pub keep: Keep,
    /// Whether segments of escaped light are rows of the table.
    pub keep_escaped: bool,
    /// The seed of all random choices.
    pub seed: u64,
    /// Traces only the rays with these numbers, all by default. The segments are those of these rays in a trace of all. The range starts
    /// at a multiple of [`TraceSettings::CHUNK`] and ends at one or with the last ray: the rows of so many rays are written together,
    /// generation by generation.
    pub rays: Option<Range<usize>>,
    /// The number of threads, by default the number of cores. Results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Cancels the run from another thread.
    pub cancel: Cancel,
}

impl Default for TraceSettings {
    fn default() -> TraceSettings {
        TraceSettings {
            branches: Branches::Ideal,
            polarised: false,
            generation_limit: 1000,
            threshold: 0.0,
            keep: Keep::All,
            keep_escaped: true,
            seed: 0,
            rays: None,
            threads: None,
            cancel: Cancel::new(),
        }
    }
}

impl TraceSettings {
    /// Rays per chunk: large enough to amortise a batch, small enough for all its segments to stay in cache.
    pub const CHUNK: usize = 2048;

    /// The numbers of the rays to trace, of `count`.
    pub(crate) fn range(&self, count: usize) -> Result<Range<usize>, OpticsError> {
        let Some(range) = self.rays.clone() else { return Ok(0..count) };
        let is_cut = |at: usize| at == count || at.is_multiple_of(TraceSettings::CHUNK);
        match range.start <= range.end && range.end <= count && is_cut(range.start) && is_cut(range.end) {
            true => Ok(range),
            false => Err(OpticsError::Range { range, count, step: TraceSettings::CHUNK }),
        }
    }

    /// True if the only event at polished faces is lossless refraction or total internal reflection.
    pub(crate) fn is_simple(&self) -> bool {
        self.branches == Branches::Ideal && !self.polarised
    }
}
