//! The suite that every evaluator passes.
//!
//! [`conformance_tests!`] writes a test for each of its parts:
//!
//! - [`agree`]: equal answers, bit for bit, to those of the reference;
//! - [`sampled`]: the side that formulas give at points between the crossings;

use rayweave_model::{Crossing, Face};

mod random;
mod tally;

pub mod agree;
pub mod laws;
pub mod lying;
pub mod models;
pub mod oracle;
pub mod rays;
pub mod sampled;

pub use models::{Model, Style};
pub use random::Random;
pub use tally::Tally;

/// How much to ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// A few seconds a test: what every change is tested with.
    Short,
    /// A thousand times as much.
    Long,
}

impl Effort {
    /// How many times the short test.
    fn times(self) -> u64 {
        match self {
            Effort::Short => 1,
            Effort::Long => 1000,
        }
    }

    fn models_and_rays(self) -> (u64, usize) {
        match self {
            Effort::Short => (1200, 100),
            Effort::Long => (100_000, 1000),
        }
    }
}

/// Crossings in a line each, for messages.
fn list(crossings: &[Crossing]) -> String {
    let line = |c: &Crossing| {
        let face = |f: Face| format!("{}.{}@{}", f.leaf.0, f.facet, f.placement.0);
        let (at, left, entered) = (face(c.face), face(c.left), face(c.entered));
        format!("\n  t = {:?}: {} -> {} at {at}, from {left}, into {entered}", c.t, c.before.0, c.after.0)
    };
    crossings.iter().map(line).collect()
}
