//! Table of predicted hits, keyed by the start of the rays.

/// The next hit of a ray bundle, predicted from the hits of earlier rays that started on the same
/// side of the same surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PredictedHit {
    /// A face of a solid.
    Face {
        /// The number of its surface in the [`Predictor`](super::Predictor) of the solids.
        surface: usize,
    },
    /// A sheet.
    Sheet {
        /// Its number.
        sheet: usize,
        /// The number of its surface in the predictor of the sheet.
        surface: usize,
    },
}

/// The maximum number of calls of the evaluator per chunk for rays from the same start.
///
/// The table is kept for one chunk only: predictions that depended on other chunks would make the
/// order of sums depend on threads.
const MAX_EVALUATIONS: u32 = 4;

/// The predicted hit of rays from one start.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Prediction {
    pub hit: Option<PredictedHit>,
    evaluations: u32,
}

impl Prediction {
    /// True if the evaluator may be called once more; counts the call.
    pub fn may_evaluate(&mut self) -> bool {
        let may = self.evaluations < MAX_EVALUATIONS;
        self.evaluations += u32::from(may);
        may
    }
}

/// Predicted hits, keyed by the surface on which the rays start and the side to which they leave
/// it, or by no surface.
#[derive(Debug, Default)]
pub(crate) struct PredictionTable(Vec<Prediction>);

impl PredictionTable {
    pub fn entry(&mut self, start: Option<(usize, bool)>) -> &mut Prediction {
        let place = start.map_or(0, |(surface, inside)| 1 + 2 * surface + usize::from(inside));
        if self.0.len() <= place {
            self.0.resize(place + 1, Prediction::default());
        }
        &mut self.0[place]
    }
}
