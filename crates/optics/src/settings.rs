//! Settings of a light trace: branches, polarisation, limits, rows, seed and threads.

use rayweave_model::drive::Cancel;
use std::num::NonZeroUsize;

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
            threads: None,
            cancel: Cancel::new(),
        }
    }
}

impl TraceSettings {
    /// True if the only event at polished faces is lossless refraction or total internal reflection.
    pub(crate) fn is_simple(&self) -> bool {
        self.branches == Branches::Ideal && !self.polarised
    }
}
