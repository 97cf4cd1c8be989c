//! Predicted hits by the start of the rays.

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

/// How often the evaluator is called in a chunk for the hit of rays from the same start.
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
    /// Whether the evaluator may be called once more; counts the call.
    pub fn may_evaluate(&mut self) -> bool {
        let may = self.evaluations < MAX_EVALUATIONS;
        self.evaluations += u32::from(may);
        may
    }
}

/// Predicted hits by the start of the rays: a surface and the side to which they leave it, or neither.
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
