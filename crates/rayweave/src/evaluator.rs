//! An evaluator that is chosen by its name while the program runs.

use crate::Error;
use rayweave_model::{Evaluator, Program, Query, Rays, RegionId, Sink};
use rayweave_trace::{Reference, Weave};
use std::sync::Arc;

/// Any of the evaluators. They give the same answers, bit for bit, and differ in speed only.
///
/// Code that knows which one it wants takes [`Weave`] or [`Reference`] itself; this one is for doors through which the
/// choice comes as text.
#[derive(Clone, Debug)]
pub enum AnyEvaluator {
    /// The one for daily use.
    Weave(Weave),
    /// The obvious one, for checks.
    Reference(Reference),
}

/// The memory of a thread for [`AnyEvaluator`].
#[derive(Debug)]
pub enum AnyScratch {
    /// For [`AnyEvaluator::Weave`].
    Weave(<Weave as Evaluator>::Scratch),
    /// For [`AnyEvaluator::Reference`].
    Reference(<Reference as Evaluator>::Scratch),
}

impl AnyEvaluator {
    /// The names to choose from; the first is the default.
    pub const NAMES: [&str; 2] = ["weave", "reference"];

    /// The evaluator of this name, or the default.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Name`] if there is none of this name.
    pub fn new(name: Option<&str>, program: Arc<Program>) -> Result<AnyEvaluator, Error> {
        match name.unwrap_or(AnyEvaluator::NAMES[0]) {
            "weave" => Ok(AnyEvaluator::Weave(Weave::new(program))),
            "reference" => Ok(AnyEvaluator::Reference(Reference::new(program))),
            other => Err(Error::unknown("evaluator", other, AnyEvaluator::NAMES.into_iter())),
        }
    }
}

impl Evaluator for AnyEvaluator {
    type Scratch = AnyScratch;

    fn name(&self) -> &'static str {
        match self {
            AnyEvaluator::Weave(weave) => weave.name(),
            AnyEvaluator::Reference(reference) => reference.name(),
        }
    }

    fn program(&self) -> &Program {
        match self {
            AnyEvaluator::Weave(weave) => weave.program(),
            AnyEvaluator::Reference(reference) => reference.program(),
        }
    }

    fn scratch(&self) -> AnyScratch {
        match self {
            AnyEvaluator::Weave(weave) => AnyScratch::Weave(weave.scratch()),
            AnyEvaluator::Reference(reference) => AnyScratch::Reference(reference.scratch()),
        }
    }

    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>, scratch: &mut AnyScratch, sink: &mut dyn Sink) {
        match (self, scratch) {
            (AnyEvaluator::Weave(weave), AnyScratch::Weave(own)) => weave.crossings(rays, query, own, sink),
            (AnyEvaluator::Reference(reference), AnyScratch::Reference(own)) => {
                reference.crossings(rays, query, own, sink)
            }
            // the scratch of another evaluator is of no use here
            (_, other) => {
                *other = self.scratch();
                self.crossings(rays, query, other, sink)
            }
        }
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut AnyScratch, out: &mut [RegionId]) {
        match (self, scratch) {
            (AnyEvaluator::Weave(weave), AnyScratch::Weave(own)) => weave.regions_at(points, own, out),
            (AnyEvaluator::Reference(reference), AnyScratch::Reference(own)) => {
                reference.regions_at(points, own, out)
            }
            (_, other) => {
                *other = self.scratch();
                self.regions_at(points, other, out)
            }
        }
    }
}
