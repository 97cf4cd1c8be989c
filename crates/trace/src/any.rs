//! An evaluator chosen by name at run time.

use crate::single_hit::TooLarge;
use crate::{Packets, Reference, SingleHit, Spans, Weave};
use rayweave_error::{Classified, ErrorKind, Message};
use rayweave_model::{Crossing, Evaluator, FirstHits, HitRows, Program, Query, Rays, RegionId, Sink, Window};
use std::sync::Arc;

/// Error of [`AnyEvaluator::new`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluatorError {
    /// No evaluator has this name.
    #[error("{0}")]
    UnknownName(Message),
    /// The model is too large for the evaluator.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
}

impl Classified for EvaluatorError {
    fn kind(&self) -> ErrorKind {
        match self {
            EvaluatorError::UnknownName(_) => ErrorKind::Name,
            EvaluatorError::TooLarge(error) => error.kind(),
        }
    }
}

/// An evaluator chosen at run time. All evaluators return the same answers, bit for bit, and differ only in
/// speed.
///
/// Meant for interfaces that receive the choice as text; other code uses [`Packets`], [`Weave`],
/// [`Reference`], [`SingleHit`] or [`Spans`] directly.
#[derive(Clone, Debug)]
pub enum AnyEvaluator {
    /// The default: eight rays at a time in small models, the weave elsewhere.
    Packets(Packets),
    /// One sweep along the ray, for models of any size.
    Weave(Weave),
    /// Direct evaluation of the definition, for tests.
    Reference(Reference),
    /// Advances from crossing to crossing.
    SingleHit(SingleHit),
    /// Combines whole hit arrays, from the leaves up.
    Spans(Spans),
}

/// The scratch memory of a thread for [`AnyEvaluator`].
#[derive(Debug)]
pub enum AnyScratch {
    /// For [`AnyEvaluator::Packets`].
    Packets(<Packets as Evaluator>::Scratch),
    /// For [`AnyEvaluator::Weave`].
    Weave(<Weave as Evaluator>::Scratch),
    /// For [`AnyEvaluator::Reference`].
    Reference(<Reference as Evaluator>::Scratch),
    /// For [`AnyEvaluator::SingleHit`].
    SingleHit(<SingleHit as Evaluator>::Scratch),
    /// For [`AnyEvaluator::Spans`].
    Spans(<Spans as Evaluator>::Scratch),
}

impl AnyEvaluator {
    /// The names of the evaluators; the first is the default.
    pub const NAMES: [&str; 5] = ["packets", "weave", "reference", "single_hit", "spans"];

    /// The evaluator with this name; `None` gives the default.
    ///
    /// # Errors
    ///
    /// [`EvaluatorError`]: the name is unknown, or the model is too large for [`SingleHit`].
    pub fn new(name: Option<&str>, program: Arc<Program>) -> Result<AnyEvaluator, EvaluatorError> {
        match name.unwrap_or(AnyEvaluator::NAMES[0]) {
            "packets" => Ok(AnyEvaluator::Packets(Packets::new(program))),
            "weave" => Ok(AnyEvaluator::Weave(Weave::new(program))),
            "reference" => Ok(AnyEvaluator::Reference(Reference::new(program))),
            "single_hit" => Ok(AnyEvaluator::SingleHit(SingleHit::new(program)?)),
            "spans" => Ok(AnyEvaluator::Spans(Spans::new(program))),
            other => {
                Err(EvaluatorError::UnknownName(Message::unknown("evaluator", other, AnyEvaluator::NAMES)))
            }
        }
    }

    /// A constructor of the evaluator with this name, for code that compiles programs of its own.
    pub fn maker(name: Option<&str>) -> impl Fn(Arc<Program>) -> Result<AnyEvaluator, EvaluatorError> {
        move |program| AnyEvaluator::new(name, program)
    }
}

/// Forwards a call to the evaluator.
macro_rules! each {
    ($any:expr, $evaluator:ident => $call:expr) => {
        match $any {
            AnyEvaluator::Packets($evaluator) => $call,
            AnyEvaluator::Weave($evaluator) => $call,
            AnyEvaluator::Reference($evaluator) => $call,
            AnyEvaluator::SingleHit($evaluator) => $call,
            AnyEvaluator::Spans($evaluator) => $call,
        }
    };
}

/// Forwards a call to the evaluator with its scratch; the scratch of another evaluator is replaced first.
macro_rules! each_with {
    ($any:expr, $scratch:ident, $evaluator:ident => $call:expr) => {{
        if !$any.owns($scratch) {
            *$scratch = $any.scratch();
        }
        match ($any, $scratch) {
            (AnyEvaluator::Packets($evaluator), AnyScratch::Packets($scratch)) => $call,
            (AnyEvaluator::Weave($evaluator), AnyScratch::Weave($scratch)) => $call,
            (AnyEvaluator::Reference($evaluator), AnyScratch::Reference($scratch)) => $call,
            (AnyEvaluator::SingleHit($evaluator), AnyScratch::SingleHit($scratch)) => $call,
            (AnyEvaluator::Spans($evaluator), AnyScratch::Spans($scratch)) => $call,
            _ => unreachable!("the scratch was replaced"),
        }
    }};
}

impl AnyEvaluator {
    fn owns(&self, scratch: &AnyScratch) -> bool {
        matches!(
            (self, scratch),
            (AnyEvaluator::Packets(_), AnyScratch::Packets(_))
                | (AnyEvaluator::Weave(_), AnyScratch::Weave(_))
                | (AnyEvaluator::Reference(_), AnyScratch::Reference(_))
                | (AnyEvaluator::SingleHit(_), AnyScratch::SingleHit(_))
                | (AnyEvaluator::Spans(_), AnyScratch::Spans(_))
        )
    }
}

impl Evaluator for AnyEvaluator {
    type Scratch = AnyScratch;

    fn name(&self) -> &'static str {
        each!(self, evaluator => evaluator.name())
    }

    fn program(&self) -> &Program {
        each!(self, evaluator => evaluator.program())
    }

    fn scratch(&self) -> AnyScratch {
        match self {
            AnyEvaluator::Packets(packets) => AnyScratch::Packets(packets.scratch()),
            AnyEvaluator::Weave(weave) => AnyScratch::Weave(weave.scratch()),
            AnyEvaluator::Reference(reference) => AnyScratch::Reference(reference.scratch()),
            AnyEvaluator::SingleHit(single_hit) => AnyScratch::SingleHit(single_hit.scratch()),
            AnyEvaluator::Spans(spans) => AnyScratch::Spans(spans.scratch()),
        }
    }

    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>, scratch: &mut AnyScratch, sink: &mut dyn Sink) {
        each_with!(self, scratch, evaluator => evaluator.crossings(rays, query, scratch, sink))
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut AnyScratch, out: &mut [RegionId]) {
        each_with!(self, scratch, evaluator => evaluator.regions_at(points, scratch, out))
    }

    fn hits(
        &self,
        rays: Rays<'_>,
        window: Window,
        scratch: &mut AnyScratch,
        rows: &mut HitRows<'_, '_>,
    ) -> usize {
        each_with!(self, scratch, evaluator => evaluator.hits(rays, window, scratch, rows))
    }

    fn nearest(&self, rays: Rays<'_>, window: Window, scratch: &mut AnyScratch, hits: &mut FirstHits<'_>) {
        each_with!(self, scratch, evaluator => evaluator.nearest(rays, window, scratch, hits))
    }

    fn nearest_from(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut AnyScratch,
        hits: &mut FirstHits<'_>,
        between: &mut Vec<(usize, Crossing)>,
    ) {
        each_with!(self, scratch, evaluator => evaluator.nearest_from(rays, query, scratch, hits, between))
    }
}
