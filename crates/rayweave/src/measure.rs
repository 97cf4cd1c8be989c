//! Volume, mass, centre, inertia and surface area of regions, with confidence intervals.
//!
//! [`rayweave_analysis::measure`], whose names are all here, and [`measure_scene`], which knows media and formulas.
//!
//! ```
//! use rayweave::measure::{Settings, measure_scene};
//!
//! let (_, scene) = rayweave::scene::parse(
//!     "rayweave = 1\nunit = \"cm\"\n[solid.ball]\nsphere = { radius = 2 }\n[[region]]\nsolid = \"ball\"\nmedium = \"glass\"\n\
//!      [medium.glass]\ndensity = 2.51",
//! )?;
//! let report = measure_scene(&scene, None, None, &Settings::default(), &mut |_| ())?;
//! let ball = &report.regions[0];
//! let volume = 32.0 / 3.0 * std::f64::consts::PI;
//! assert!(ball.measured.volume.holds(volume) && ball.measured.volume.half_width < 1e-3 * volume);
//! assert_eq!(ball.formula, Some(volume));
//! // grams: the density of a medium is in g/cm^3
//! assert!((ball.mass.unwrap().value / volume - 2.51).abs() < 0.003);
//! # Ok::<(), rayweave::Error>(())
//! ```

use crate::{AnyEvaluator, Compiled, Error};
pub use rayweave_analysis::measure::*;
use rayweave_model::{Program, Region};
use rayweave_scene::{Medium, Scene};
use std::sync::Arc;

/// What has been measured of the regions of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneReport {
    /// The regions in their order.
    pub regions: Vec<RegionReport>,
    /// The number of rays asked in all.
    pub rays: u64,
}

/// What has been measured of one region.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionReport {
    /// The integrals, in lengths of the scene's unit.
    pub measured: Measured,
    /// The name of its medium.
    pub medium: String,
    /// The volume by formula, where the region is a single shape that no other region takes anything of.
    pub formula: Option<f64>,
    /// The mass in grams, if the medium has a `density` (in g/cm^3).
    pub mass: Option<Estimate>,
}

/// Measures the regions of a scene, or one of its solids as if it were alone. `progress` is told the number of rays that have been asked.
///
/// # Errors
///
/// [`crate::ErrorKind::Name`] for an unknown solid or evaluator, [`crate::ErrorKind::Compile`], [`crate::ErrorKind::Solid`] if
/// there is no end to it, [`crate::ErrorKind::Value`] for settings out of range, [`crate::ErrorKind::Cancelled`].
pub fn measure_scene(
    scene: &Scene,
    solid: Option<&str>,
    evaluator: Option<&str>,
    settings: &Settings,
    progress: &mut dyn FnMut(u64),
) -> Result<SceneReport, Error> {
    let (regions, media) = subject(scene, solid)?;
    let program = Arc::new(Program::compile_regions(&one_medium_each(&regions))?);
    let evaluator = AnyEvaluator::new(evaluator, program.clone())?;
    let found = measure(&evaluator, settings, progress)?;
    let boxes = program.region_bounds();
    let reports = found.regions.into_iter().enumerate().map(|(k, measured)| {
        let is_alone = (0..regions.len()).all(|j| j == k || boxes[j].intersection(&boxes[k]).is_empty());
        let formula = exact_volume(&regions[k].solid).filter(|_| is_alone && settings.within.is_none());
        let medium = media[k];
        let density = medium.and_then(|medium| number(medium, "density"));
        let centimetres = scene.unit.metres() * 100.0;
        let mass = density.map(|density| grams(measured.volume, density, centimetres));
        RegionReport { formula, mass, medium: medium.map_or_else(String::new, |m| m.name.clone()), measured }
    });
    Ok(SceneReport { regions: reports.collect(), rays: found.rays })
}

/// The regions that are asked about, with their media.
pub(crate) fn subject<'a>(
    scene: &'a Scene,
    solid: Option<&str>,
) -> Result<(Vec<Region>, Vec<Option<&'a Medium>>), Error> {
    let medium = |number: u32| scene.media.get(number as usize);
    let Some(name) = solid else {
        let regions = scene.model_regions();
        let media = regions.iter().map(|region| medium(region.medium)).collect();
        return Ok((regions, media));
    };
    let solid = Compiled::find(scene, name)?;
    let last = scene.regions.iter().rev().find(|region| region.solid.is_same(solid));
    let region = Region { name: name.to_owned(), solid: solid.clone(), medium: 1 };
    Ok((vec![region], vec![last.and_then(|region| medium(region.medium))]))
}

fn number(medium: &Medium, name: &str) -> Option<f64> {
    medium.numbers.iter().find(|(own, _)| own == name).map(|(_, value)| *value)
}

fn grams(volume: Estimate, density: f64, centimetres: f64) -> Estimate {
    let factor = density * centimetres.powi(3);
    Estimate { value: factor * volume.value, half_width: factor.abs() * volume.half_width }
}
