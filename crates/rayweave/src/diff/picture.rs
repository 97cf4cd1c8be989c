//! What differs, as a section.

use super::{DiffReport, DiffSettings, pairs};
use crate::section::{CrossSection, Cutter, Kinds, SectionPlane, SectionSettings, Sweep};
use crate::{AnyEvaluator, Error, ErrorKind};
use rayweave_math::Vec3;
use rayweave_scene::{Colour, Scene};
use std::sync::Arc;

/// Grey for what both have; a red and a blue that people with any kind of colour vision can tell apart (Okabe and Ito, 2008).
const COLOURS: [(&str, Colour); 3] = [
    ("both", Colour::new(200, 205, 211)),
    ("A only", Colour::new(213, 94, 0)),
    ("B only", Colour::new(0, 114, 178)),
];

/// The pair with the thickest difference, or the first one if all are the same, cut by a plane: what both have, and what only
/// one of them has, as parts of a section, to be drawn by [`crate::section::section_svg`]. Without a plane it is that of x, y and z
/// through the thickest difference in which the most of it lies.
///
/// # Errors
///
/// As [`super::diff`] and [`crate::section::cross_sections`].
pub fn diff_section(
    a: &Scene,
    b: &Scene,
    report: &DiffReport,
    settings: &DiffSettings,
    plane: Option<SectionPlane>,
) -> Result<CrossSection, Error> {
    let (_, pairs) = pairs(a, b, settings)?;
    let name = report.worst().or(report.pairs.first()).map_or("", |pair| &pair.name);
    let pair = pairs.iter().find(|pair| pair.name == name);
    let nothing = || Error::said(ErrorKind::Solid, "the report is not of these models".to_owned());
    let program = Arc::new(pair.ok_or_else(nothing)?.program()?);
    let at = match report.worst().and_then(|pair| pair.spot) {
        Some(spot) => spot.at,
        None => program.bounds().centre(),
    };
    let kinds = Kinds { of: vec![1, 2, 3], names: COLOURS.map(|(name, c)| (name.to_owned(), c)).into() };
    let sweep = Sweep { threads: settings.measure.threads, cancel: settings.measure.cancel.clone() };
    let cut_settings = SectionSettings { sweep, ..SectionSettings::default() };
    let cutter = Cutter { evaluator: AnyEvaluator::new(None, program)?, kinds, settings: &cut_settings };
    match plane {
        Some(plane) => cutter.cut(&plane),
        None => most_different(&cutter, at),
    }
}

fn most_different(cutter: &Cutter<'_, AnyEvaluator>, at: Vec3) -> Result<CrossSection, Error> {
    // the plane across y shows most models from the front, and wins where none shows more
    let sections = [1, 2, 0].map(|axis| cutter.cut(&SectionPlane::across(axis, at[axis])?));
    let mut best: Option<CrossSection> = None;
    for section in sections {
        let section = section?;
        if best.as_ref().is_none_or(|best| difference(&section) > difference(best)) {
            best = Some(section);
        }
    }
    best.ok_or_else(|| Error::said(ErrorKind::Solid, "nothing is to be cut".to_owned()))
}

fn difference(section: &CrossSection) -> f64 {
    COLOURS[1..].iter().filter_map(|(name, _)| section.part(name)).map(|part| part.area).sum()
}
