//! An evaluator chosen by name at run time.

use crate::accelerated::{Accelerated, RayDevice};
use crate::single_hit::TooLarge;
use rayweave_error::{Classified, ErrorKind, Message};
use rayweave_model::{
    BoxCells, Crossing, Evaluator, FirstHits, HitArrayRows, PixelRays, Program, Query, Rays, RegionId, Sink,
    Window,
};
use std::num::NonZeroUsize;
use std::sync::Arc;

/// An evaluator that cannot be made.
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

/// Defines [`AnyEvaluator`] and [`AnyScratch`] from one entry for each evaluator: its documentation, an optional `cfg`, its
/// module in this crate and its type, its name and its constructor. The first entry is the default. [`Accelerated`] has no name,
/// since its constructor needs a device.
macro_rules! evaluators {
    ($($(#[doc = $doc:literal])+ $(#[cfg($cfg:meta)])? $module:ident::$Kind:ident, $name:literal, $new:expr;)+) => {
        $($(#[cfg($cfg)])? use crate::$module::$Kind;)+

        /// An evaluator chosen at run time. All kinds give the same answers, bit for bit, and differ in speed only.
        ///
        /// For interfaces that receive the choice as text; other code uses [`Packets`], [`Weave`], [`Reference`] or
        /// [`SingleHit`] directly.
        #[derive(Clone, Debug)]
        #[non_exhaustive]
        pub enum AnyEvaluator {
            $($(#[doc = $doc])+ $(#[cfg($cfg)])? $Kind($Kind),)+
            /// A device, such as a graphics card, beside the CPU.
            Accelerated(Accelerated),
        }

        /// The scratch memory of a thread for [`AnyEvaluator`].
        #[derive(Debug)]
        #[allow(clippy::large_enum_variant, reason = "there is one value per thread")]
        #[non_exhaustive]
        pub enum AnyScratch {
            $(
                #[doc = concat!("For [`AnyEvaluator::", stringify!($Kind), "`].")]
                $(#[cfg($cfg)])?
                $Kind(<$Kind as Evaluator>::Scratch),
            )+
            /// For [`AnyEvaluator::Accelerated`].
            Accelerated(<Accelerated as Evaluator>::Scratch),
        }

        const ALL_NAMES: &[&str] = &[$($(#[cfg($cfg)])? $name,)+];

        impl AnyEvaluator {
            /// The evaluator called `name`, or the default.
            ///
            /// # Errors
            ///
            /// [`EvaluatorError`] for an unknown name, or for a model that is too large (possible for [`SingleHit`]
            /// only).
            pub fn new(name: Option<&str>, program: Arc<Program>) -> Result<AnyEvaluator, EvaluatorError> {
                match name.unwrap_or(AnyEvaluator::NAMES[0]) {
                    $($(#[cfg($cfg)])? $name => $new(program).map(AnyEvaluator::$Kind),)+
                    other => {
                        Err(EvaluatorError::UnknownName(Message::unknown("evaluator", other, AnyEvaluator::NAMES)))
                    }
                }
            }

            fn owns(&self, scratch: &AnyScratch) -> bool {
                match (self, scratch) {
                    $($(#[cfg($cfg)])? (AnyEvaluator::$Kind(_), AnyScratch::$Kind(_)) => true,)+
                    (AnyEvaluator::Accelerated(_), AnyScratch::Accelerated(_)) => true,
                    _ => false,
                }
            }

            fn new_scratch(&self) -> AnyScratch {
                match self {
                    $($(#[cfg($cfg)])? AnyEvaluator::$Kind(evaluator) => AnyScratch::$Kind(evaluator.scratch()),)+
                    AnyEvaluator::Accelerated(evaluator) => AnyScratch::Accelerated(evaluator.scratch()),
                }
            }
        }

        /// The same call to an evaluator of any kind.
        macro_rules! each {
            ($any:expr, $evaluator:ident => $call:expr) => {
                match $any {
                    $($(#[cfg($cfg)])? AnyEvaluator::$Kind($evaluator) => $call,)+
                    AnyEvaluator::Accelerated($evaluator) => $call,
                }
            };
        }

        /// The same call to an evaluator of any kind, with its scratch; the scratch of another kind is replaced first.
        macro_rules! each_with {
            ($any:expr, $scratch:ident, $evaluator:ident => $call:expr) => {{
                if !$any.owns($scratch) {
                    *$scratch = $any.new_scratch();
                }
                match ($any, $scratch) {
                    $($(#[cfg($cfg)])? (AnyEvaluator::$Kind($evaluator), AnyScratch::$Kind($scratch)) => $call,)+
                    (AnyEvaluator::Accelerated($evaluator), AnyScratch::Accelerated($scratch)) => $call,
                    _ => unreachable!("the scratch was replaced"),
                }
            }};
        }
    };
}

evaluators! {
    /// For daily use: rays in bundles of eight where the model is small, the sweep of [`Weave`] elsewhere.
    packets::Packets, "packets", |program| Ok(Packets::new(program));
    /// One sweep along a ray over the sorted crossings of all leaves, for models of any size.
    weave::Weave, "weave", |program| Ok(Weave::new(program));
    /// Root-ray algebra in the order of the expression, for checks.
    reference::Reference, "reference", |program| Ok(Reference::new(program));
    /// Advances from crossing to crossing and can explain each of them.
    single_hit::SingleHit, "single_hit", |program| Ok(SingleHit::new(program)?);
    /// Combines whole arrays of hits, from the leaves up.
    #[cfg(feature = "spans")]
    spans::Spans, "spans", |program| Ok(Spans::new(program));
}

impl AnyEvaluator {
    /// The names to choose from; the first is the default.
    pub const NAMES: [&str; ALL_NAMES.len()] = *ALL_NAMES.first_chunk().expect("as many names as there are");

    /// The evaluator that passes queries to a device, which holds the same program, and to the CPU.
    pub fn with_device(program: Arc<Program>, device: Arc<dyn RayDevice>) -> AnyEvaluator {
        AnyEvaluator::Accelerated(Accelerated::new(program, device))
    }

    /// A constructor of the evaluator with this name, for callers that compile programs of their own.
    pub fn maker(name: Option<&str>) -> impl Fn(Arc<Program>) -> Result<AnyEvaluator, EvaluatorError> {
        move |program| AnyEvaluator::new(name, program)
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
        self.new_scratch()
    }

    fn preferred_batch(&self) -> Option<NonZeroUsize> {
        each!(self, evaluator => evaluator.preferred_batch())
    }

    fn box_cells(&self) -> Option<&BoxCells> {
        each!(self, evaluator => evaluator.box_cells())
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
        rows: &mut HitArrayRows<'_, '_>,
    ) -> usize {
        each_with!(self, scratch, evaluator => evaluator.hits(rays, window, scratch, rows))
    }

    fn nearest(&self, rays: Rays<'_>, window: Window, scratch: &mut AnyScratch, hits: &mut FirstHits<'_>) {
        each_with!(self, scratch, evaluator => evaluator.nearest(rays, window, scratch, hits))
    }

    fn nearest_through(
        &self,
        (pixels, rays): (&PixelRays<'_>, Rays<'_>),
        window: Window,
        scratch: &mut AnyScratch,
        hits: &mut FirstHits<'_>,
    ) {
        each_with!(self, scratch, evaluator => evaluator.nearest_through((pixels, rays), window, scratch, hits))
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

    fn nearest_in(
        &self,
        rays: Rays<'_>,
        (query, regions): (&Query<'_>, &[u32]),
        scratch: &mut AnyScratch,
        hits: &mut FirstHits<'_>,
        between: &mut Vec<(usize, Crossing)>,
    ) {
        let query = (query, regions);
        each_with!(self, scratch, evaluator => evaluator.nearest_in(rays, query, scratch, hits, between))
    }
}
