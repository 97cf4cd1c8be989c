//! Options of comparisons.

use crate::measure;

/// The matching of regions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Match {
    /// [`Match::Whole`] if one of the models has a single region, else [`Match::Region`].
    #[default]
    Auto,
    /// Regions with the same name.
    Region,
    /// All regions with the same medium, by the name of the medium.
    Medium,
    /// All regions together.
    Whole,
}

/// The options of a comparison.
#[derive(Clone, Debug)]
pub struct DiffSettings {
    /// The matching of regions.
    pub by: Match,
    /// The accepted thickness of differences, in the unit of the first model; by default 1e-9 of the diagonal
    /// of the models.
    pub distance: Option<f64>,
    /// Number of cells n along an edge of the cross-sections; each pair takes 6 n^2 rays.
    pub across: u32,
    /// The options of volumes. Box (in the unit of the first model), seed, threads and cancellation token
    /// apply to the whole comparison.
    pub measure: measure::MeasureSettings,
}

/// 98,304 rays for each pair; volumes to 1 %, with a confidence of 99 % and at most 2^20 rays.
impl Default for DiffSettings {
    fn default() -> Self {
        let measure = measure::MeasureSettings {
            precision: 1e-2,
            most_rays: 1 << 20,
            ..measure::MeasureSettings::default()
        };
        DiffSettings { by: Match::Auto, distance: None, across: 128, measure }
    }
}
