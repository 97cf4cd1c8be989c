//! Are two models the same solid? Where not: how much, how thick, seen by which ray.
//!
//! Regions are compared in pairs: those of one name, or all regions of a medium together, or everything that is in any region. A
//! region is what later ones leave of it. Lengths of the second model are brought to the unit of the first.
//!
//! Both models are compiled as one, in which faces that agree to rounding become one surface and pieces that only rounding makes
//! are welded away. Rays then look for what belongs to one side alone; where a piece of a ray seems thicker than the distance that
//! does not matter, rays in five directions through its middle look again, so that a ray which follows a thin film is not taken
//! for a difference. Models are called the same if none of the rays met a difference thicker than that.
//!
//! ```
//! use rayweave::diff::{DiffSettings, diff};
//!
//! let (_, a) = rayweave::scene::parse("rayweave = 1\nunit = \"cm\"\n[solid.ball]\nsphere = { radius = 1 }")?;
//! let (_, b) = rayweave::scene::parse("rayweave = 1\nunit = \"mm\"\n[solid.egg]\nellipsoid = { radii = [10, 10, 12] }")?;
//! assert!(diff(&a, &a, &DiffSettings::default(), &mut |_| ())?.is_same());
//! let report = diff(&a, &b, &DiffSettings::default(), &mut |_| ())?;
//! let egg = &report.pairs[0];
//! assert!(!report.is_same() && egg.a_only.value == 0.0);
//! assert!(egg.b_only.holds(0.8 * std::f64::consts::PI / 3.0));
//! assert!((egg.spot.unwrap().thickness - 0.2).abs() < 0.02);
//! # Ok::<(), rayweave::Error>(())
//! ```

pub(crate) mod judge;
mod pairs;
mod picture;
#[cfg(test)]
mod tests;

pub use picture::diff_section;

use crate::section::clipped;
use crate::{Error, ErrorKind};
use pairs::{Pair, pairs};
use rayweave_analysis::measure::{self, Chord, Estimate};
use rayweave_math::{Bounds, Vec3};
use rayweave_scene::{Scene, Unit};

/// What is compared with what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Match {
    /// Everything with everything if one of the models has a single region, else region by region.
    #[default]
    Auto,
    /// Regions of one name.
    Region,
    /// All regions of one medium, by the name of the medium.
    Medium,
    /// All that is in any region.
    Whole,
}

/// How models are compared.
#[derive(Clone, Debug)]
pub struct DiffSettings {
    /// What is compared with what.
    pub by: Match,
    /// Differences up to this thickness do not matter, in the unit of the first model; 1e-9 of the diagonal of what is compared if
    /// it is not given.
    pub distance: Option<f64>,
    /// Cells along an edge of the cross-sections: there are six times its square of rays for each pair.
    pub across: u32,
    /// How volumes are measured. The box (in the unit of the first model), the seed, the threads and who may stop the run are those of
    /// the whole comparison.
    pub measure: measure::Settings,
}

/// 98,304 rays for each pair, volumes to 1 % at 99 % with at most 2^20 rays.
impl Default for DiffSettings {
    fn default() -> Self {
        let measure =
            measure::Settings { precision: 1e-2, most_rays: 1 << 20, ..measure::Settings::default() };
        DiffSettings { by: Match::Auto, distance: None, across: 128, measure }
    }
}

/// What two models have in common, and what not.
#[derive(Clone, Debug, PartialEq)]
pub struct DiffReport {
    /// The unit of all lengths: that of the first model.
    pub unit: Unit,
    /// How regions were matched: never [`Match::Auto`].
    pub by: Match,
    /// Differences up to this thickness do not matter.
    pub distance: f64,
    /// The pairs, in the order of the first model; what only the second one has comes last.
    pub pairs: Vec<Difference>,
    /// The number of rays that were asked.
    pub rays: u64,
}

impl DiffReport {
    /// True if no difference thicker than [`DiffReport::distance`] was met.
    pub fn is_same(&self) -> bool {
        self.pairs.iter().all(|pair| pair.is_same)
    }

    /// The pair with the thickest difference, if there is one.
    pub fn worst(&self) -> Option<&Difference> {
        let thickness = |pair: &&Difference| pair.spot.map_or(0.0, |spot| spot.thickness);
        let different = self.pairs.iter().filter(|pair| !pair.is_same);
        different.max_by(|a, b| thickness(a).total_cmp(&thickness(b)))
    }
}

/// One part of the models.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The name of the region or the medium; `model` for everything.
    pub name: String,
    /// Whether each of the models has such a part.
    pub is_in: [bool; 2],
    /// True if no difference was met that matters.
    pub is_same: bool,
    /// True if it is known without rays: the same shapes in the same places, or nothing on both sides.
    pub is_proved: bool,
    /// The volume that both have in common.
    pub both: Estimate,
    /// The volume that only the first has.
    pub a_only: Estimate,
    /// The volume that only the second has.
    pub b_only: Estimate,
    /// The thickest difference that was met, also where it does not matter; `None` if there was none.
    pub spot: Option<Spot>,
    /// A box around all differences that were met and may matter.
    pub place: Option<Bounds>,
}

/// A place where models differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The middle of the piece of a ray there.
    pub at: Vec3,
    /// How thick the difference is there.
    pub thickness: f64,
    /// The piece of a ray through it that shows the thickness.
    pub chord: Chord,
    /// True if the first model has something there and the second one not.
    pub is_a: bool,
}

/// Compares two models. `progress` is told the number of rays that were asked, again and again.
///
/// # Errors
///
/// [`ErrorKind::Compile`], [`ErrorKind::Solid`] for models without end or without anything in them, [`ErrorKind::Value`] for settings
/// out of range, [`ErrorKind::Cancelled`].
pub fn diff(
    a: &Scene,
    b: &Scene,
    settings: &DiffSettings,
    progress: &mut dyn FnMut(u64),
) -> Result<DiffReport, Error> {
    check(settings)?;
    let (by, pairs) = pairs(a, b, settings)?;
    let bounds = judge::bounds_of(&pairs)?;
    let distance = settings.distance.unwrap_or(1e-9 * bounds.size().length());
    let mut judge = judge::Judge::new(settings, distance, progress);
    let differences = pairs.iter().map(|pair| judge.compare(pair)).collect::<Result<Vec<_>, Error>>()?;
    Ok(DiffReport { unit: a.unit, by, distance, pairs: differences, rays: judge.rays() })
}

fn check(settings: &DiffSettings) -> Result<(), Error> {
    let problem = match settings.distance {
        Some(d) if !(d >= 0.0 && d.is_finite()) => {
            Some(format!("the distance is {d} (it must be 0 or greater, and finite)"))
        }
        _ if !(2..=4096).contains(&settings.across) => {
            Some(format!("there are {} cells across (from 2 to 4096 are possible)", settings.across))
        }
        _ => None,
    };
    problem.map_or(Ok(()), |text| Err(Error::said(ErrorKind::Value, text)))
}
