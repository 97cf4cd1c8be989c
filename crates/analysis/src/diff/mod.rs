//! Comparison of two models: whether they describe the same solids, and the volumes, thickness and position of the
//! differences.
//!
//! Regions are compared in pairs: regions with the same name, all regions of the same medium together, or all
//! regions together. A region consists of the points of its solid that belong to no later region. Lengths of the
//! second model are converted to the unit of the first.
//!
//! Both solids of a pair are compiled into one program, in which faces that agree to rounding error become one
//! surface and slivers due to rounding are removed. Random rays then search for points that belong to only one of
//! the solids. A ray along a thin film has a long piece in it, which is not a thick difference: pieces are
//! therefore measured again by rays in five directions through their middle, the thickest first. Of the pieces within
//! [`DiffSettings::distance`], which are reported but accepted, at most 4,096 are measured again. Models are the same if no difference found in this way is thicker than
//! [`DiffSettings::distance`].
//!
//! ```
//! use rayweave_analysis::diff::{DiffSettings, diff};
//! use rayweave_trace::AnyEvaluator;
//!
//! let make = AnyEvaluator::maker(None);
//! let (_, a) = rayweave_scene::parse("rayweave = 1\nunit = \"cm\"\n[solid.ball]\nsphere = { radius = 1 }")?;
//! let (_, b) = rayweave_scene::parse("rayweave = 1\nunit = \"mm\"\n[solid.egg]\nellipsoid = { radii = [10, 10, 12] }")?;
//! assert!(diff(&a, &a, &make, &DiffSettings::default(), &mut |_| ())?.is_same());
//! let report = diff(&a, &b, &make, &DiffSettings::default(), &mut |_| ())?;
//! let egg = &report.pairs[0];
//! assert!(!report.is_same() && egg.a_only.value == 0.0);
//! assert!(egg.b_only.contains(0.8 * std::f64::consts::PI / 3.0));
//! assert!((egg.spot.unwrap().thickness - 0.2).abs() < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod comparer;
mod pairs;
mod places;
mod report;
mod section;
mod settings;
#[cfg(test)]
mod tests;

pub use report::{DiffReport, Difference, DifferencePlace, ThickestSpot};
pub use section::diff_section;
pub use settings::{DiffSettings, Match};

use crate::AnalysisError;
use crate::error::maker;
use pairs::pairs;
use rayweave_error::{Classified, Message};
use rayweave_model::{Evaluator, Program};
use rayweave_scene::Scene;
use std::sync::Arc;

/// The progress of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DiffProgress {
    /// The number of rays so far.
    pub rays: u64,
    /// The number of pairs that are finished.
    pub done: usize,
    /// The number of all pairs.
    pub pairs: usize,
    /// The largest half-width of a volume of the current pair, relative to the volume; infinite while rays search for differences.
    pub precision: f64,
}

/// Compares two models. `make` creates the evaluator of a program; `progress` receives the number of rays traced so
/// far.
///
/// # Errors
///
/// [`AnalysisError`]: models that are unbounded or have no regions, solids that cannot be compiled, an error of
/// `make`, settings out of range, a cancelled run.
pub fn diff<E: Evaluator, X: Classified + Send + Sync + 'static>(
    a: &Scene,
    b: &Scene,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &DiffSettings,
    progress: &mut dyn FnMut(u64),
) -> Result<DiffReport, AnalysisError> {
    diff_with_progress(a, b, make, settings, &mut |now| progress(now.rays))
}

/// Like [`diff`]; `progress` receives the number of finished pairs and the precision reached as well.
///
/// # Errors
///
/// The errors of [`diff`].
pub fn diff_with_progress<E: Evaluator, X: Classified + Send + Sync + 'static>(
    a: &Scene,
    b: &Scene,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &DiffSettings,
    progress: &mut dyn FnMut(DiffProgress),
) -> Result<DiffReport, AnalysisError> {
    check(settings)?;
    let (by, pairs) = pairs(a, b, settings)?;
    let bounds = comparer::bounds_of(&pairs)?;
    let distance = settings.distance.unwrap_or(1e-9 * bounds.size().length());
    let make = maker(make);
    let count = pairs.len();
    let mut report = |rays, done, precision| progress(DiffProgress { rays, done, pairs: count, precision });
    let mut comparer = comparer::PairComparer::new(&make, settings, distance, &mut report);
    let differences =
        pairs.iter().map(|pair| comparer.compare(pair)).collect::<Result<Vec<_>, AnalysisError>>()?;
    Ok(DiffReport { unit: a.unit, by, distance, pairs: differences, rays: comparer.rays() })
}

fn check(settings: &DiffSettings) -> Result<(), AnalysisError> {
    let message = match settings.distance {
        Some(d) if !(d >= 0.0 && d.is_finite()) => {
            Message::new(format!("the distance is {d}"), "it must be finite and at least 0")
        }
        _ if !(2..=4096).contains(&settings.across) => {
            let problem = format!("the number of cells across is {}", settings.across);
            Message::new(problem, "it must be from 2 to 4096")
        }
        _ => return Ok(()),
    };
    Err(AnalysisError::Value(message))
}
