//! Cross-sections at findings.

use super::{CheckSettings, Finding, FindingKind};
use crate::AnalysisError;
use crate::error::{Make, maker};
use crate::section::{
    By, CrossSection, Cutter, Kinds, SectionPlane, SectionRun, SectionSettings, cross_sections,
};
use crate::subject::clipped;
use rayweave_error::Classified;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Program, Region, Solid};
use rayweave_scene::{Colour, Compiled, Scene};
use std::sync::Arc;

/// The cross-section of the model around a finding, in a plane that contains its ray, perpendicular to an axis if possible; the
/// intersection of an overlap is a separate part. `None` for a finding without a point.
///
/// # Errors
///
/// Those of [`cross_sections`].
pub fn finding_section<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    finding: &Finding,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &CheckSettings,
) -> Result<Option<CrossSection>, AnalysisError> {
    let Some(at) = finding.at else { return Ok(None) };
    let whole = Compiled::new(scene)?.program.bounds();
    let diagonal = if whole.is_finite() { whole.size().length() } else { 0.0 };
    let ray = finding.ray.map_or(Vec3::ZERO, |ray| ray.to - ray.from);
    let around = match finding.kind {
        FindingKind::Thin | FindingKind::Gap => 8.0 * finding.size.unwrap_or(0.0),
        FindingKind::Touch => 0.1 * diagonal,
        _ => 4.0 * ray.abs().max_element().max(finding.size.unwrap_or(0.0)),
    };
    let reach = around.max(1e-3 * diagonal).max(1e-9 * at.abs().max_element());
    let within = Some(Bounds::new(at, at).grown(if reach > 0.0 { reach } else { 1.0 }));
    let plane = plane_along(ray, at)?;
    let run = SectionRun { threads: settings.threads, cancel: settings.cancel.clone() };
    let section_settings = SectionSettings { by: By::Region, within, run, ..SectionSettings::default() };
    match overlapping(scene, finding) {
        Some([a, b]) => overlap(&plane, a, b, &maker(make), &section_settings).map(Some),
        None => {
            let sections = cross_sections(scene, None, make, &[plane], &section_settings, &mut |_| ())?;
            Ok(sections.into_iter().next())
        }
    }
}

/// The plane through a point that contains a direction: perpendicular to y, x or z if the direction is, otherwise tilted as little
/// as possible from the nearest of these.
fn plane_along(direction: Vec3, at: Vec3) -> Result<SectionPlane, AnalysisError> {
    let slopes = direction.abs() / direction.abs().max_element();
    // a few roundings of coordinates near the origin tilt a picture by less than a pixel
    if let Some(axis) = [1, 0, 2].into_iter().find(|&axis| slopes[axis] < 1e-6 || slopes.is_nan()) {
        return SectionPlane::across(axis, at[axis]);
    }
    // the first of several equal ones
    let axis =
        [1, 0, 2].into_iter().reduce(|best, axis| if slopes[axis] < slopes[best] { axis } else { best });
    // the viewer is at +x and +z for planes across x and z, and at -y for those across y
    let towards = [Vec3::X, Vec3::NEG_Y, Vec3::Z][axis.unwrap_or(1)];
    let unit = direction.normalize_or_zero();
    SectionPlane::new(at, towards - towards.dot(unit) * unit)
}

/// The two regions of an overlap.
fn overlapping(scene: &Scene, finding: &Finding) -> Option<[Region; 2]> {
    let [a, b] = &finding.regions[..] else { return None };
    let regions = scene.model_regions();
    let find = |name: &String| regions.iter().find(|region| region.name == *name).cloned();
    (finding.kind == FindingKind::Overlap).then(|| Some([find(a)?, find(b)?])).flatten()
}

fn overlap<E: Evaluator>(
    plane: &SectionPlane,
    a: Region,
    b: Region,
    make: &Make<'_, E>,
    settings: &SectionSettings,
) -> Result<CrossSection, AnalysisError> {
    let names = [a.name.clone(), b.name.clone(), "both".to_owned()];
    let solids: [Solid; 3] = [&a.solid - &b.solid, &b.solid - &a.solid, &a.solid & &b.solid];
    let region =
        |(k, (name, solid)): (u32, (&String, Solid))| Region { name: name.clone(), solid, medium: k };
    let regions = (1..).zip(names.iter().zip(solids)).map(region).collect();
    let program = Arc::new(Program::compile_regions(&clipped(regions, settings.within)?)?);
    // red for the intersection, as in the pictures of differences
    let colours = [Colour::PALETTE[0], Colour::PALETTE[2], Colour::new(213, 94, 0)];
    let kinds = Kinds { of: vec![1, 2, 3], names: names.into_iter().zip(colours).collect() };
    Cutter { evaluator: make(program)?, kinds, settings }.cut(plane)
}
