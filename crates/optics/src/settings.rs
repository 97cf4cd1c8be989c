//! How light is followed.

use rayweave_model::drive::Cancel;
use std::num::NonZeroUsize;

/// Which way light goes where part of it is reflected and part transmitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Branches {
    /// Through, without losses; back only where total reflection leaves no other way. Metals and coatings of mirrors keep
    /// their reflectance, and splitters split.
    #[default]
    Ideal,
    /// Both ways, each with its part of the power.
    Both,
    /// One of them at random, with all the power.
    Random,
}

/// Which segments are rows of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// All of them.
    #[default]
    All,
    /// Those after which nothing goes on: where light ends, whatever its way. They have no parents.
    Ends,
}

/// How light is followed.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Which way it goes where part of it is reflected.
    pub branches: Branches,
    /// Whether polarisation is followed; otherwise light is unpolarised at every interface.
    pub polarised: bool,
    /// After so many events a ray is not followed any more.
    pub generation_limit: u32,
    /// Below this power a ray is not followed any more.
    pub threshold: f64,
    /// Which segments are rows of the table.
    pub keep: Keep,
    /// Whether segments that meet nothing are rows of the table.
    pub keep_escaped: bool,
    /// The seed of all random choices.
    pub seed: u64,
    /// The number of threads; as many as there are cores if not given. Results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Stops the run when asked to.
    pub cancel: Cancel,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
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

impl Settings {
    /// True if polished faces do nothing but refract.
    pub(crate) fn is_simple(&self) -> bool {
        self.branches == Branches::Ideal && !self.polarised
    }
}
