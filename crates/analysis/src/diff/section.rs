//! Cross-section at a difference.

use super::{DiffReport, DiffSettings, pairs};
use crate::AnalysisError;
use crate::error::maker;
use crate::section::{CrossSection, Cutter, Kinds, SectionPlane, SectionRun, SectionSettings};
use rayweave_error::{Classified, Message};
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program};
use rayweave_scene::{Colour, Scene};
use std::sync::Arc;

/// Grey for the intersection; a red and a blue distinguishable with any kind of colour vision (Okabe and Ito,
/// 2008).
const COLOURS: [(&str, Colour); 3] = [
    ("both", Colour::new(200, 205, 211)),
    ("A only", Colour::new(213, 94, 0)),
    ("B only", Colour::new(0, 114, 178)),
];

/// The cross-section of the pair with the thickest difference, or of the first pair if all are the same. The
/// parts are the intersection and the space that belongs to one model only. If no plane is given, the plane is
/// the one across x, y or z through the thickest difference that has the longest outlines of differences. A plane along a thin layer
/// has the largest area, but shows its thickness too large.
///
/// # Errors
///
/// Those of [`super::diff`] and [`crate::section::cross_sections`].
pub fn diff_section<E: Evaluator, X: Classified + Send + Sync + 'static>(
    a: &Scene,
    b: &Scene,
    report: &DiffReport,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &DiffSettings,
    plane: Option<SectionPlane>,
) -> Result<CrossSection, AnalysisError> {
    let (_, pairs) = pairs(a, b, settings)?;
    let name = report.worst().or(report.pairs.first()).map_or("", |pair| &pair.name);
    let pair = pairs.iter().find(|pair| pair.name == name);
    let nothing = || {
        let reason = "none of its parts is in them";
        AnalysisError::Solid(Message::new("the report is not about these models", reason))
    };
    let program = Arc::new(pair.ok_or_else(nothing)?.program()?);
    let at = match report.worst().and_then(|pair| pair.spot) {
        Some(spot) => spot.at,
        None => program.bounds().centre(),
    };
    let kinds = Kinds { of: vec![1, 2, 3], names: COLOURS.map(|(name, c)| (name.to_owned(), c)).into() };
    let run = SectionRun { threads: settings.measure.threads, cancel: settings.measure.cancel.clone() };
    let cut_settings = SectionSettings { run, ..SectionSettings::default() };
    let cutter = Cutter { evaluator: maker(make)(program)?, kinds, settings: &cut_settings };
    match plane {
        Some(plane) => cutter.cut(&plane),
        None => most_different(&cutter, at),
    }
}

fn most_different<E: Evaluator>(cutter: &Cutter<'_, E>, at: Vec3) -> Result<CrossSection, AnalysisError> {
    let cut = |axis: usize| cutter.cut(&SectionPlane::across(axis, at[axis])?);
    // the plane across y shows most models from the front; it is kept unless another shows more
    let mut best = cut(1)?;
    for axis in [2, 0] {
        let section = cut(axis)?;
        if difference(&section) > difference(&best) {
            best = section;
        }
    }
    Ok(best)
}

fn difference(section: &CrossSection) -> f64 {
    COLOURS[1..].iter().filter_map(|(name, _)| section.part(name)).map(|part| part.perimeter).sum()
}
