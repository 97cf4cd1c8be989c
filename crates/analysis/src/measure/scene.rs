//! Measurement of the regions of a scene, with masses and exact volumes.

use super::share::MeasureShare;
use super::{
    Estimate, MeasureError, MeasureProgress, MeasureSettings, Measured, Measurement, exact_volume,
    measure_with_progress, one_medium_each,
};
use crate::AnalysisError;
use crate::error::maker;
use crate::features::{MOST_REACHED, extent_of};
use crate::subject::subject;
use rayweave_error::Classified;
use rayweave_math::Bounds;
use rayweave_model::{Evaluator, Program, RegionId};
use rayweave_scene::Scene;
use std::ops::Range;
use std::sync::Arc;

/// The measurements of a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SceneReport {
    /// The regions, in their order.
    pub regions: Vec<RegionReport>,
    /// The number of rays.
    pub rays: u64,
    /// The maximum number of rays that applied: see [`Measurement::most_rays`].
    pub most_rays: u64,
}

/// The measurements of one region.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RegionReport {
    /// The integrals, in the length unit of the scene.
    pub measured: Measured,
    /// The name of the medium.
    pub medium: String,
    /// The exact volume, if the region is a single primitive with a closed form, its bounding box overlaps that of no
    /// other region, and the measurement is not restricted to a box.
    pub exact_volume: Option<f64>,
    /// The mass in grams, if the medium has a `density` (in g/cm^3).
    pub mass: Option<Estimate>,
    /// The box around the region, which it reaches on all sides: see [`extent`](fn@crate::features::extent). `None` for an empty region,
    /// in models of more than 32 regions, and if the measurement is restricted to a box.
    pub bounds: Option<Bounds>,
}

/// The number of regions up to which their boxes are computed.
pub const MAX_BOXES: usize = 32;

/// Measures the regions of a scene, or one of its solids alone. `make` creates the evaluator of a program;
/// `progress` receives the number of rays so far.
///
/// # Errors
///
/// [`AnalysisError`]: an unknown solid, an unbounded region, settings out of range, a cancelled run.
///
/// ```
/// use rayweave_analysis::measure::{MeasureSettings, measure_scene};
/// use rayweave_trace::AnyEvaluator;
///
/// let (_, scene) = rayweave_scene::parse(
///     "rayweave = 1\nunit = \"cm\"\n[solid.ball]\nsphere = { radius = 2 }\n[[region]]\nsolid = \"ball\"\nmedium = \"glass\"\n\
///      [medium.glass]\ndensity = 2.51",
/// )?;
/// let report = measure_scene(&scene, None, AnyEvaluator::maker(None), &MeasureSettings::default(), &mut |_| ())?;
/// let ball = &report.regions[0];
/// let volume = 32.0 / 3.0 * std::f64::consts::PI;
/// assert!(ball.measured.volume.contains(volume) && ball.measured.volume.half_width < 1e-3 * volume);
/// assert_eq!(ball.exact_volume, Some(volume));
/// // grams: the density of a medium is in g/cm^3
/// assert_eq!(ball.bounds.unwrap().hi.to_array(), [2.0; 3]);
/// assert!((ball.mass.unwrap().value / volume - 2.51).abs() < 0.003);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn measure_scene<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    solid: Option<&str>,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &MeasureSettings,
    progress: &mut dyn FnMut(u64),
) -> Result<SceneReport, AnalysisError> {
    measure_scene_with_progress(scene, solid, make, settings, &mut |now| progress(now.rays))
}

/// Like [`measure_scene`]; `progress` receives the precision reached as well.
///
/// # Errors
///
/// The errors of [`measure_scene`].
pub fn measure_scene_with_progress<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    solid: Option<&str>,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &MeasureSettings,
    progress: &mut dyn FnMut(MeasureProgress),
) -> Result<SceneReport, AnalysisError> {
    measured_scene(scene, solid, make, settings, |evaluator| {
        measure_with_progress(evaluator, settings, progress)
    })
}

/// Traces a range of the cells of a measurement with about `rays` rays ([`MeasureShare::trace`]) of the regions of a scene, or of one
/// of its solids.
///
/// # Errors
///
/// [`AnalysisError`], as for [`measure_scene`].
pub fn share_of_scene<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    solid: Option<&str>,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &MeasureSettings,
    (rays, cells): (u64, Range<u64>),
    progress: &mut dyn FnMut(u64),
) -> Result<MeasureShare, AnalysisError> {
    let (regions, _) = subject(scene, solid)?;
    let program = Arc::new(Program::compile_regions(&one_medium_each(&regions))?);
    let evaluator = maker(make)(program)?;
    Ok(MeasureShare::trace(&evaluator, settings, rays, cells, progress)?)
}

/// The measurements of a scene from the sums over all cells.
///
/// # Errors
///
/// [`AnalysisError`], as for [`measure_scene`].
pub fn report_shares<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    solid: Option<&str>,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &MeasureSettings,
    share: &MeasureShare,
) -> Result<SceneReport, AnalysisError> {
    measured_scene(scene, solid, make, settings, |evaluator| share.report(evaluator, settings))
}

/// The report of a scene whose regions are measured by a function.
fn measured_scene<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    solid: Option<&str>,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    settings: &MeasureSettings,
    measured: impl FnOnce(&E) -> Result<Measurement, MeasureError>,
) -> Result<SceneReport, AnalysisError> {
    let (regions, media) = subject(scene, solid)?;
    let program = Arc::new(Program::compile_regions(&one_medium_each(&regions))?);
    let evaluator = maker(make)(program.clone())?;
    let found = measured(&evaluator)?;
    let (boxes, load) = (program.region_bounds(), program.ray_load());
    // the extents of all regions together
    let most_reached = settings.most_reached.map_or(u64::MAX, |most| most.min(MOST_REACHED));
    let each = most_reached / regions.len().max(1) as u64;
    let reports = found.regions.into_iter().enumerate().map(|(k, measured)| {
        let is_alone = (0..regions.len()).all(|j| j == k || boxes[j].intersection(&boxes[k]).is_empty());
        let exact_volume = exact_volume(&regions[k].solid).filter(|_| is_alone && settings.within.is_none());
        let medium = media[k];
        let density = medium.and_then(|medium| medium.number("density"));
        let centimetres = scene.unit.metres() * 100.0;
        let mass = density.map(|density| grams(measured.volume, density, centimetres));
        let has_box = regions.len() <= MAX_BOXES && settings.within.is_none();
        let own = RegionId::from(k + 1);
        let extent = || extent_of(&evaluator, boxes[k], &|region| region == own, (&load, each));
        let bounds = has_box.then(extent).flatten();
        RegionReport {
            exact_volume,
            mass,
            bounds: bounds.map(|extent| extent.bounds),
            medium: medium.map_or_else(String::new, |m| m.name.clone()),
            measured,
        }
    });
    Ok(SceneReport { regions: reports.collect(), rays: found.rays, most_rays: found.most_rays })
}

fn grams(volume: Estimate, density: f64, centimetres: f64) -> Estimate {
    let factor = density * centimetres.powi(3);
    Estimate { value: factor * volume.value, half_width: factor.abs() * volume.half_width }
}
