//! Model checker: overlaps, daughters outside their mothers, gaps, thin walls, parts without effect.
//!
//! Disjoint bounding boxes prove that regions have nothing in common. Everything else is sampled with rays, and
//! a fault that no ray crosses is not reported: findings are certain, but their absence depends on the density
//! of the rays. [`CheckReport::scope`] lists what was proved and what was sampled. Equal seeds give equal
//! reports for any number of threads.
//!
//! ```
//! use rayweave_analysis::check::{CheckSettings, FindingKind, check};
//! use rayweave_trace::AnyEvaluator;
//!
//! let (_, scene) = rayweave_scene::parse(
//!     "rayweave = 1\n[solid.a]\nbox = { size = 2 }\n[solid.b]\nbox = { size = 2 }\ntransform = [{ translate = [1.5, 0, 0] }]\n\
//!      [[region]]\nsolid = \"a\"\n[[region]]\nsolid = \"b\"",
//! )?;
//! let report = check(&scene, None, AnyEvaluator::maker(None), &CheckSettings::default(), &mut |_| ())?;
//! let overlap = report.of(FindingKind::Overlap).next().unwrap();
//! assert_eq!(overlap.regions, ["a", "b"]);
//! assert!((overlap.volume.unwrap().value - 2.0).abs() < 1e-9 && (overlap.size.unwrap() - 0.5).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod connected;
#[cfg(test)]
mod connected_tests;
#[cfg(test)]
mod edge_tests;
mod edges;
mod facing;
mod finding;
#[cfg(test)]
mod format_tests;
mod hierarchy;
mod narrow;
mod nearest;
#[cfg(test)]
mod operand_tests;
mod operands;
mod pairs;
mod parts;
mod pieces;
mod places;
mod probe;
mod report;
mod section;
mod settings;
mod share;
mod stratum;
mod subject;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod wall_tests;
#[cfg(test)]
mod work_tests;

pub(crate) use connected::{ConnectedPart, connected_parts};
pub use finding::{Finding, FindingKind};
pub use hierarchy::Hierarchy;
pub use report::{CheckProgress, CheckReport, Scope};
pub use section::finding_section;
pub use settings::CheckSettings;
pub use share::CheckShare;

use crate::AnalysisError;
use crate::error::maker;
use crate::measure::one_medium_each;
use crate::subject::clipped;
use probe::Probe;
use rayweave_error::{Classified, Message};
use rayweave_math::Bounds;
use rayweave_model::{Evaluator, Program, Region};
use rayweave_scene::Scene;
use share::Work;
use std::ops::Range;
use std::sync::Arc;
use subject::Subject;

/// Checks the regions of a scene. `hierarchy` contains mothers and daughters, if the model has any
/// ([`Hierarchy::of`]). `make` creates the evaluator of a program; `progress` receives the number of
/// rays so far and the part of the work that is finished.
///
/// # Errors
///
/// [`AnalysisError`]: a model without regions or without a bounded region, settings out of range, a cancelled
/// run.
pub fn check<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    hierarchy: Option<&Hierarchy>,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &CheckSettings,
    progress: &mut dyn FnMut(CheckProgress),
) -> Result<CheckReport, AnalysisError> {
    let model = Model::new(scene, settings)?;
    let make = maker(make);
    let mut probe = Probe::new(&make, settings, model.frame, progress);
    report(scene, &model, hierarchy, &mut probe)
}

/// Runs the searches `range` of a check, for [`check_with`]: one for each pair of parts whose boxes overlap, and one for each operand.
/// Returns their results and the number of all searches.
///
/// # Errors
///
/// [`AnalysisError`] as [`check`], and for a range that ends beyond the last search.
pub fn check_share<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    hierarchy: Option<&Hierarchy>,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &CheckSettings,
    range: Range<u64>,
    progress: &mut dyn FnMut(CheckProgress),
) -> Result<(CheckShare, u64), AnalysisError> {
    let model = Model::new(scene, settings)?;
    let make = maker(make);
    let mut probe = Probe::new(&make, settings, model.frame, progress);
    probe.plan_range(&range);
    pairs::search(&model.subject(hierarchy), &mut probe)?;
    operands::findings(&model.written, &mut probe)?;
    probe.finish();
    let total = probe.next_search;
    if range.end > total {
        let message = Message::new(
            format!("the range ends at {}", range.end),
            format!("the check has {total} searches"),
        );
        return Err(AnalysisError::Value(message));
    }
    match probe.work {
        Work::Range(_, share) => Ok((share, total)),
        _ => Ok((CheckShare::default(), total)),
    }
}

/// Like [`check`], with results of searches that [`check_share`] returned; missing ones are run. The report is that of [`check`].
///
/// # Errors
///
/// [`AnalysisError`] as [`check`].
pub fn check_with<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    hierarchy: Option<&Hierarchy>,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &CheckSettings,
    share: &CheckShare,
    progress: &mut dyn FnMut(CheckProgress),
) -> Result<CheckReport, AnalysisError> {
    let model = Model::new(scene, settings)?;
    let make = maker(make);
    let mut probe = Probe::new(&make, settings, model.frame, progress);
    probe.work = Work::Known(share);
    report(scene, &model, hierarchy, &mut probe)
}

/// The daughters that extend beyond their mothers, as [`check`] reports them, without volumes: only those with a copy or operand whose
/// bounding box extends beyond the boxes of the mothers. Rays go through these parts alone, so that the search is quick enough for
/// programs that use the model; a daughter that extends beyond its mother within the box of the mother is missed.
///
/// # Errors
///
/// [`AnalysisError`] as [`check`].
pub fn protruding<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    hierarchy: &Hierarchy,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &CheckSettings,
) -> Result<Vec<Finding>, AnalysisError> {
    let model = Model::new(scene, settings)?;
    let make = maker(make);
    let progress = &mut |_| ();
    let mut probe = Probe::new(&make, settings, model.frame, progress);
    pairs::protruding(&model.subject(Some(hierarchy)), &mut probe)
}

/// The regions of a scene, prepared for rays.
struct Model {
    /// As they are written.
    written: Vec<Region>,
    /// Clipped to the sampled box.
    regions: Vec<Region>,
    program: Arc<Program>,
    boxes: Vec<Bounds>,
    frame: Bounds,
    is_clipped: bool,
}

impl Model {
    fn new(scene: &Scene, settings: &CheckSettings) -> Result<Model, AnalysisError> {
        in_range(settings)?;
        let written = scene.model_regions();
        if written.is_empty() {
            let message = Message::new("the model has no regions", "there is nothing to check");
            return Err(AnalysisError::Solid(message));
        }
        let regions = clipped(written.clone(), settings.within)?;
        let boxes = compiled(&regions)?.region_bounds();
        let frame = frame(&boxes)?;
        let is_clipped = settings.within.is_some();
        if is_clipped && frame.is_empty() {
            let message = Message::new("no part of the model is within the box", "there is nothing to check");
            return Err(AnalysisError::Solid(message.suggest("Is the box in the unit of the model?")));
        }
        let regions = ended(regions, &boxes, &frame)?;
        let program = compiled(&regions)?;
        let boxes = program.region_bounds();
        Ok(Model { written, regions, program: program.into(), boxes, frame, is_clipped })
    }

    fn subject<'s>(&'s self, hierarchy: Option<&'s Hierarchy>) -> Subject<'s> {
        let whole = self.is_clipped.then_some(self.written.as_slice());
        Subject { regions: &self.regions, whole, boxes: self.boxes.clone(), hierarchy }
    }
}

fn report<E: Evaluator>(
    scene: &Scene,
    model: &Model,
    hierarchy: Option<&Hierarchy>,
    probe: &mut Probe<'_, E>,
) -> Result<CheckReport, AnalysisError> {
    probe.scope.has_hierarchy = hierarchy.is_some();
    let subject = model.subject(hierarchy);
    probe.plan(pieces::planned_rays(&subject, &model.program, probe));
    probe.plan(operands::planned_rays(&model.written, probe.settings)?);
    let known = pairs::intersecting(&subject, probe)?;
    let outside = pairs::outside(&subject, probe)?;
    let pieces = pieces::findings(&subject, model.program.clone(), &known, probe)?;
    let mut findings = known.overlaps;
    findings.extend(outside);
    findings.extend(pieces);
    findings.extend(operands::findings(&model.written, probe)?);
    findings.sort_by_key(|finding| finding.kind);
    probe.finish();
    Ok(CheckReport { unit: scene.unit, findings, scope: probe.scope.clone() })
}

fn compiled(regions: &[Region]) -> Result<Program, AnalysisError> {
    Ok(Program::compile_regions(&one_medium_each(regions))?)
}

/// The sampled box: that of the bounded regions, with a margin if there are unbounded ones.
fn frame(boxes: &[Bounds]) -> Result<Bounds, AnalysisError> {
    let finite = boxes.iter().filter(|own| own.is_finite() && !own.is_empty());
    let whole = finite.fold(Bounds::EMPTY, |all, own| all.union(own));
    match (whole.is_empty(), boxes.iter().any(is_endless)) {
        (true, true) => {
            let message =
                Message::new("no region of the model is bounded", "rays cannot search all of space");
            Err(AnalysisError::Solid(
                message.suggest("Check the part within a box: --within LO HI, in Python within=(lo, hi)."),
            ))
        }
        (false, true) => Ok(whole.grown(0.1 * whole.size().length())),
        (_, false) => Ok(whole),
    }
}

fn is_endless(own: &Bounds) -> bool {
    !own.is_empty() && !own.is_finite()
}

/// The regions, with unbounded ones clipped to the sampled box.
fn ended(regions: Vec<Region>, boxes: &[Bounds], frame: &Bounds) -> Result<Vec<Region>, AnalysisError> {
    let mut all = Vec::with_capacity(regions.len());
    for (region, own) in regions.into_iter().zip(boxes) {
        all.extend(clipped(vec![region], is_endless(own).then_some(*frame))?);
    }
    Ok(all)
}

fn in_range(settings: &CheckSettings) -> Result<(), AnalysisError> {
    let lengths = [("wall", settings.wall), ("gap", settings.gap), ("distance", settings.distance)];
    for (name, length) in lengths {
        if let Some(length) = length.filter(|length| !(*length >= 0.0 && length.is_finite())) {
            let message = Message::new(format!("the {name} is {length}"), "it must be finite and at least 0");
            return Err(AnalysisError::Value(message));
        }
    }
    match (2..=4096).contains(&settings.across) {
        true => Ok(()),
        false => {
            let problem = format!("the number of cells across is {}", settings.across);
            Err(AnalysisError::Value(Message::new(problem, "it must be from 2 to 4096")))
        }
    }
}
