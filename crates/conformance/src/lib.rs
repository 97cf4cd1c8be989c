//! Conformance suite: tests that every evaluator has to pass.
//!
//! [`conformance_tests!`] generates a test for each part:
//!
//! - [`agree`]: answers equal to those of the reference, bit for bit;
//! - [`sampled`]: at points between the crossings, the side given by formulas independent of the engine;
//! - [`closed`]: closed forms;
//! - [`laws`]: boolean identities, motions, mirrors, scales, reversal, cuts, regions, placements;
//! - [`forms`]: trees of any shape and order, and their positive forms;
//! - [`chords`]: mean chord lengths, by integral geometry;
//! - [`touching`]: solids with common faces, made and placed in any way, hit at any angle;
//! - [`in_surface`]: rays in faces and along edges;
//! - [`rehit`]: a thousand bounces in mirrors (re-hit test);
//! - [`deep`]: trees of 100,000 levels on a small stack.
//!
//! ```ignore
//! mod weave {
//!     rayweave_conformance::conformance_tests!(Weave::new, Reference::new);
//! }
//! ```
//!
//! [`approximate`] tests the second contract: answers with error bounds, or marked as uncertain.
//!
//! Every test has a long form, `cargo test -- --ignored long_`. Not part of the suite: [`exact`], the oracle
//! without rounding, [`differential`], a differential test of several evaluators, and [`scale`], models of any
//! size. Any test can report by [`skipped`] that its requirements are missing.

use rayweave_model::{Crossing, Face};

mod evaluator_under_test;
mod random;
mod skipped;
mod tally;

pub mod agree;
pub mod approximate;
pub mod chords;
pub mod closed;
pub mod deep;
pub mod differential;
pub mod exact;
pub mod forms;
pub mod in_surface;
pub mod laws;
pub mod models;
pub mod oracle;
pub mod rays;
pub mod rehit;
pub mod sampled;
pub mod scale;
pub mod touching;

pub use evaluator_under_test::{EvaluatorUnderTest, Maker, maker};
pub use models::{Model, Style};
pub use random::Random;
pub use skipped::skipped;
pub use tally::Tally;

/// The size of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// A few seconds per test: run for every change.
    Short,
    /// Hundreds of times as large.
    Long,
}

impl Effort {
    /// `short` for a short test, `long` for a long one.
    fn of(self, short: u64, long: u64) -> u64 {
        match self {
            Effort::Short => short,
            Effort::Long => long,
        }
    }

    /// The number of rounds, in multiples of the short test.
    fn times(self) -> u64 {
        self.of(1, 300)
    }

    fn models_and_rays(self) -> (u64, usize) {
        match self {
            Effort::Short => (1200, 100),
            Effort::Long => (100_000, 1000),
        }
    }
}

/// Crossings as text, one per line, for messages.
fn list(crossings: &[Crossing]) -> String {
    let line = |c: &Crossing| {
        let face = |f: Face| format!("{}.{}@{}", f.leaf.0, f.facet, f.placement.0);
        let (at, left, entered) = (face(c.face), face(c.left), face(c.entered));
        format!("\n  t = {:?}: {} -> {} at {at}, from {left}, into {entered}", c.t, c.before.0, c.after.0)
    };
    crossings.iter().map(line).collect()
}

/// Generates the tests that an evaluator has to pass. `$make` makes the evaluator from an `Arc<Program>`,
/// `$reference` makes the reference; without it the comparison with the reference is left out.
#[macro_export]
macro_rules! conformance_tests {
    ($make:expr, $reference:expr $(,)?) => {
        #[test]
        fn agrees_with_the_reference() {
            $crate::agree::with_the_reference($make, $reference, $crate::Effort::Short);
        }

        #[test]
        #[ignore = "long"]
        fn long_agrees_with_the_reference() {
            $crate::agree::with_the_reference($make, $reference, $crate::Effort::Long);
        }

        $crate::conformance_tests!($make);
    };
    ($make:expr $(,)?) => {
        $crate::conformance_tests! { @ $make;
            sampled::with_formulas, formulas, long_formulas;
            laws::of_booleans, booleans, long_booleans;
            laws::of_cuts, cuts, long_cuts;
            forms::of_trees, forms, long_forms;
            chords::mean_length, mean_chords, long_mean_chords;
            laws::of_scale, scale, long_scale;
            laws::of_motion, motion, long_motion;
            laws::of_reversal, reversal, long_reversal;
            laws::of_regions, regions, long_regions;
            laws::of_placements, placements, long_placements;
            touching::at_any_angle, touching_faces, long_touching_faces;
            in_surface::as_if_moved, rays_in_faces, long_rays_in_faces;
            in_surface::in_shared_faces, rays_in_shared_faces, long_rays_in_shared_faces;
            in_surface::along_shared_edges, rays_along_edges, long_rays_along_edges;
            rehit::in_mirrors, mirrors, long_mirrors;
        }

        #[test]
        fn closed_forms() {
            $crate::closed::forms($make);
        }

        #[test]
        fn points() {
            $crate::closed::points($make);
        }

        #[test]
        fn deep_trees() {
            $crate::deep::chains($make);
        }
    };
    (@ $make:expr; $($module:ident :: $function:ident, $short:ident, $long:ident;)*) => {$(
        #[test]
        fn $short() {
            $crate::$module::$function($make, $crate::Effort::Short);
        }

        #[test]
        #[ignore = "long"]
        fn $long() {
            $crate::$module::$function($make, $crate::Effort::Long);
        }
    )*};
}
