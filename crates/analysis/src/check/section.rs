//! Cross-sections at findings.

use super::{CheckSettings, Finding, FindingKind};
use crate::AnalysisError;
use crate::error::{Make, maker};
use crate::section::{
    By, CrossSection, Cutter, Kinds, SectionPlane, SectionRun, SectionSettings, cross_sections,
};
use crate::subject::clipped;
use rayweave_error::Classified;
use rayweave_math::Bounds;
use rayweave_model::{Evaluator, Program, Region, Solid};
use rayweave_scene::{Colour, Compiled, Scene};
use std::sync::Arc;

/// The cross-section of the model around a finding, in a plane that contains its ray; the intersection of an
/// overlap is a separate part. `None` for a finding without a point.
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
    let ray = finding.ray.map_or(rayweave_math::Vec3::ZERO, |ray| (ray.to - ray.from).abs());
    let around = match finding.kind {
        FindingKind::Thin | FindingKind::Gap => 8.0 * finding.size.unwrap_or(0.0),
        _ => 4.0 * ray.max_element().max(finding.size.unwrap_or(0.0)),
    };
    let reach = around.max(1e-3 * diagonal).max(1e-9 * at.abs().max_element());
    let within = Some(Bounds::new(at, at).grown(if reach > 0.0 { reach } else { 1.0 }));
    // a plane that contains the ray; if possible, the one seen from the front
    let axis = if ray.y > ray.x.max(ray.z) { 0 } else { 1 };
    let plane = SectionPlane::across(axis, at[axis])?;
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
