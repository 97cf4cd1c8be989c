//! Options of checks.

use rayweave_math::Bounds;
use rayweave_model::drive::Cancel;
use std::num::NonZeroUsize;

/// The options of a check.
#[derive(Clone, Debug)]
pub struct CheckSettings {
    /// Walls thinner than this are reported; by default 1e-5 of the diagonal of the model.
    pub wall: Option<f64>,
    /// Gaps narrower than this are reported; by default 1e-5 of the diagonal.
    pub gap: Option<f64>,
    /// Overlaps no deeper than this count as rounding error; by default 1e-9 of the diagonal.
    pub distance: Option<f64>,
    /// Number of cells n along an edge of the cross-sections of the model. 6 n^2 rays go through the whole model, and
    /// about as many again through single regions and pairs. Where a ray reaches more than 32 shapes on average, there are fewer
    /// ([`Scope::cells`](super::Scope::cells)).
    pub across: u32,
    /// The level of confidence of volumes.
    pub confidence: f64,
    /// The maximum number of pairs of parts, and of operands. The work on both grows with it: 4 million, and 2,500 per pair and 5,000 per
    /// operand, in rays times leaves that each may cross. Pairs and operands beyond that are left out. So are overlaps, and volumes of
    /// findings, beyond 4 million and 500 per pair.
    pub most_pairs: usize,
    /// Restricts the check to this box.
    pub within: Option<Bounds>,
    /// The seed of the random numbers: equal seeds give equal reports.
    pub seed: u64,
    /// The number of threads; results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Cancels the run.
    pub cancel: Cancel,
}

/// 98,304 rays through the model, at most 10,000 pairs.
impl Default for CheckSettings {
    fn default() -> Self {
        CheckSettings {
            wall: None,
            gap: None,
            distance: None,
            across: 128,
            confidence: 0.99,
            most_pairs: 10_000,
            within: None,
            seed: 0,
            threads: None,
            cancel: Cancel::new(),
        }
    }
}
