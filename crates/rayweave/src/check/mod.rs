//! Does a model say what was meant? Overlaps, daughters outside their mothers, gaps, thin walls, parts without effect.
//!
//! Boxes prove what they can: regions whose boxes are apart have nothing in common. Everything else is looked at by rays, and what
//! no ray has met is not reported: a finding is sure, its absence is as sure as the rays are dense. [`CheckReport::scope`] says
//! what was proved and what was sampled. Equal seeds give equal reports, whatever the number of threads.
//!
//! ```
//! use rayweave::check::{CheckSettings, Kind, check};
//!
//! let (_, scene) = rayweave::scene::parse(
//!     "rayweave = 1\n[solid.a]\nbox = { size = 2 }\n[solid.b]\nbox = { size = 2 }\ntransform = [{ translate = [1.5, 0, 0] }]\n\
//!      [[region]]\nsolid = \"a\"\n[[region]]\nsolid = \"b\"",
//! )?;
//! let report = check(&scene, None, &CheckSettings::default(), &mut |_| ())?;
//! let overlap = report.of(Kind::Overlap).next().unwrap();
//! assert_eq!(overlap.regions, ["a", "b"]);
//! assert!((overlap.volume.unwrap().value - 2.0).abs() < 1e-9 && (overlap.size.unwrap() - 0.5).abs() < 1e-9);
//! # Ok::<(), rayweave::Error>(())
//! ```

mod hierarchy;
mod operands;
mod pairs;
mod parts;
mod picture;
mod pieces;
mod probe;
#[cfg(test)]
mod tests;

pub use hierarchy::Hierarchy;
pub use picture::finding_section;

use crate::section::clipped;
use crate::{Error, ErrorKind};
use probe::Probe;
use rayweave_analysis::measure::{Chord, Estimate, one_medium_each};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::drive::Cancel;
use rayweave_model::{Program, Region, Solid};
use rayweave_scene::{Scene, Unit};
use std::num::NonZeroUsize;

/// The sorts of findings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Two regions take the same space, and neither is within the other; the later one wins there. Copies of one volume that
    /// take the same space, where the model has a hierarchy.
    Overlap,
    /// A daughter reaches out of its mother.
    Outside,
    /// Nothing is left of a region: later ones take all of it.
    Hidden,
    /// There is nothing in a solid.
    Empty,
    /// An operand of a boolean operator changes nothing.
    Absorbed,
    /// A mesh that is closed, but may not be what was meant.
    Mesh,
    /// A wall that is thinner than a length.
    Thin,
    /// A gap that is narrower than a length.
    Gap,
    /// Two regions touch: a note, no fault.
    Touch,
}

impl Kind {
    /// All of them, with their names at every door.
    pub const ALL: [(Kind, &'static str); 9] = [
        (Kind::Overlap, "overlap"),
        (Kind::Outside, "outside"),
        (Kind::Hidden, "hidden"),
        (Kind::Empty, "empty"),
        (Kind::Absorbed, "absorbed"),
        (Kind::Mesh, "mesh"),
        (Kind::Thin, "thin"),
        (Kind::Gap, "gap"),
        (Kind::Touch, "touch"),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        Kind::ALL[self as usize].1
    }
}

impl std::str::FromStr for Kind {
    type Err = Error;

    fn from_str(name: &str) -> Result<Kind, Error> {
        let found = Kind::ALL.into_iter().find(|(_, own)| *own == name);
        let names = Kind::ALL.into_iter().map(|(_, own)| own);
        found.map(|(kind, _)| kind).ok_or_else(|| Error::unknown("kind of finding", name, names))
    }
}

/// How a model is checked.
#[derive(Clone, Debug)]
pub struct CheckSettings {
    /// Walls thinner than this are reported; 1e-5 of the diagonal of the model if it is not given.
    pub wall: Option<f64>,
    /// Gaps narrower than this are reported; 1e-5 of the diagonal if it is not given.
    pub gap: Option<f64>,
    /// Overlaps that are nowhere deeper than this are rounding; 1e-9 of the diagonal if it is not given.
    pub distance: Option<f64>,
    /// Cells along an edge of the cross-sections of the model: there are six times its square of rays through all of it, and
    /// about as many again for single regions and pairs.
    pub across: u32,
    /// The level of confidence of volumes.
    pub confidence: f64,
    /// The most pairs of parts that are looked at, and the most operands.
    pub most_pairs: usize,
    /// Only what lies in this box is looked at.
    pub within: Option<Bounds>,
    /// Chooses the random numbers: equal seeds give equal reports.
    pub seed: u64,
    /// The number of threads; results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Stops the run.
    pub cancel: Cancel,
}

/// 98,304 rays through the model, at most 20,000 pairs.
impl Default for CheckSettings {
    fn default() -> Self {
        CheckSettings {
            wall: None,
            gap: None,
            distance: None,
            across: 128,
            confidence: 0.99,
            most_pairs: 20_000,
            within: None,
            seed: 0,
            threads: None,
            cancel: Cancel::new(),
        }
    }
}

/// Something that may not be what was meant.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What sort of thing.
    pub kind: Kind,
    /// The regions that it is about.
    pub regions: Vec<String>,
    /// What there is to say, in words.
    pub text: String,
    /// How deep, thick or wide, in the unit of the model: the depth of an overlap where it was met, the least thickness of a wall or
    /// gap.
    pub size: Option<f64>,
    /// The volume of what overlaps or is outside.
    pub volume: Option<Estimate>,
    /// The area where regions touch.
    pub area: Option<f64>,
    /// A place.
    pub at: Option<Vec3>,
    /// A piece of a ray there: the ray runs from one end to the other.
    pub ray: Option<Chord>,
    /// True if it is known without rays.
    pub is_proved: bool,
}

impl Finding {
    fn new(kind: Kind, regions: &[&str], text: String) -> Finding {
        let regions = regions.iter().map(|name| (*name).to_owned()).collect();
        let (size, volume, area, at, ray) = (None, None, None, None, None);
        Finding { kind, regions, text, size, volume, area, at, ray, is_proved: false }
    }

    fn seen(self, size: f64, chord: Chord) -> Finding {
        let at = Some(0.5 * (chord.from + chord.to));
        Finding { size: Some(size), at, ray: Some(chord), ..self }
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckReport {
    /// The unit of all lengths.
    pub unit: Unit,
    /// All findings, sorted by their kind, then in the order of the regions.
    pub findings: Vec<Finding>,
    /// What was looked at, and how.
    pub scope: Scope,
}

/// What was looked at, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scope {
    /// The number of rays that were asked.
    pub rays: u64,
    /// Walls thinner than this are reported.
    pub wall: f64,
    /// Gaps narrower than this are reported.
    pub gap: f64,
    /// Overlaps that are nowhere deeper than this are rounding.
    pub distance: f64,
    /// The number of parts: regions, taken apart into the copies and operands that they are unions of.
    pub parts: u64,
    /// Pairs of parts of different regions whose boxes are apart: proved to have nothing in common.
    pub apart: u64,
    /// Pairs of parts that rays looked at.
    pub pairs: u64,
    /// Pairs of parts that were left out, since there were too many.
    pub left_out: u64,
    /// Operands that were looked at.
    pub operands: u64,
    /// Operands that were left out, since there were too many.
    pub operands_left_out: u64,
    /// True if mothers and daughters are known.
    pub has_hierarchy: bool,
}

impl CheckReport {
    /// The findings of a kind.
    pub fn of(&self, kind: Kind) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |finding| finding.kind == kind)
    }
}

/// Checks the regions of a scene. `hierarchy` tells mothers and daughters, where the model has any ([`Hierarchy::of`]). `progress`
/// is told the number of rays that were asked, again and again.
///
/// # Errors
///
/// [`ErrorKind::Compile`], [`ErrorKind::Solid`] for a model of which no region has an end, or without regions, [`ErrorKind::Value`] for
/// settings out of range, [`ErrorKind::Cancelled`].
pub fn check(
    scene: &Scene,
    hierarchy: Option<&Hierarchy>,
    settings: &CheckSettings,
    progress: &mut dyn FnMut(u64),
) -> Result<CheckReport, Error> {
    in_range(settings)?;
    let written = scene.model_regions();
    if written.is_empty() {
        return Err(Error::said(
            ErrorKind::Solid,
            "the model has no regions (there is nothing to check)".to_owned(),
        ));
    }
    let regions = clipped(written.clone(), settings.within)?;
    let boxes = compiled(&regions)?.region_bounds();
    let frame = frame(&boxes)?;
    if settings.within.is_some() && frame.is_empty() {
        let text = "nothing of the model is within the box (there is nothing to check) is it in the unit of the model?";
        return Err(Error::said(ErrorKind::Solid, text.to_owned()));
    }
    let regions = ended(regions, &boxes, &frame)?;
    let program = compiled(&regions)?;
    let mut probe = Probe::new(settings, frame, progress);
    probe.scope.has_hierarchy = hierarchy.is_some();
    let whole = settings.within.map(|_| written.as_slice());
    let subject = Subject { regions: &regions, whole, boxes: program.region_bounds(), hierarchy };
    let mut findings = pairs::overlaps(&subject, &mut probe)?;
    findings.extend(pairs::outside(&subject, &mut probe)?);
    findings.extend(pieces::findings(&subject, program, &findings, &mut probe)?);
    findings.extend(operands::findings(&written, &mut probe)?);
    findings.sort_by_key(|finding| finding.kind);
    Ok(CheckReport { unit: scene.unit, findings, scope: probe.scope })
}

/// What is checked.
struct Subject<'a> {
    regions: &'a [Region],
    /// The regions with what of them is not looked at, if only a box is.
    whole: Option<&'a [Region]>,
    /// The boxes of the regions, whatever later ones take.
    boxes: Vec<Bounds>,
    hierarchy: Option<&'a Hierarchy>,
}

impl Subject<'_> {
    fn name(&self, region: usize) -> &str {
        &self.regions[region].name
    }

    /// The solid of a region, if only a box of it is looked at.
    fn beyond(&self, region: usize) -> Option<&Solid> {
        self.whole.map(|whole| &whole[region].solid)
    }

    /// True if one of the regions is around the other, as mothers are around daughters.
    fn are_kin(&self, a: usize, b: usize) -> bool {
        self.hierarchy.is_some_and(|known| known.is_within(a, b) || known.is_within(b, a))
    }
}

fn compiled(regions: &[Region]) -> Result<Program, Error> {
    Ok(Program::compile_regions(&one_medium_each(regions))?)
}

/// The box that rays go through: that of the regions that have an end, with something around it where others have none.
fn frame(boxes: &[Bounds]) -> Result<Bounds, Error> {
    let finite = boxes.iter().filter(|own| own.is_finite() && !own.is_empty());
    let whole = finite.fold(Bounds::EMPTY, |all, own| all.union(own));
    match (whole.is_empty(), boxes.iter().any(is_endless)) {
        (true, true) => {
            let text =
                "no region of the model has an end (rays cannot look everywhere) check it within a box?";
            Err(Error::said(ErrorKind::Solid, text.to_owned()))
        }
        (false, true) => Ok(whole.grown(0.1 * whole.size().length())),
        (_, false) => Ok(whole),
    }
}

fn is_endless(own: &Bounds) -> bool {
    !own.is_empty() && !own.is_finite()
}

/// Regions without an end as far as rays look.
fn ended(regions: Vec<Region>, boxes: &[Bounds], frame: &Bounds) -> Result<Vec<Region>, Error> {
    let mut all = Vec::with_capacity(regions.len());
    for (region, own) in regions.into_iter().zip(boxes) {
        all.extend(clipped(vec![region], is_endless(own).then_some(*frame))?);
    }
    Ok(all)
}

fn in_range(settings: &CheckSettings) -> Result<(), Error> {
    let lengths = [("wall", settings.wall), ("gap", settings.gap), ("distance", settings.distance)];
    for (name, length) in lengths {
        if let Some(length) = length.filter(|length| !(*length >= 0.0 && length.is_finite())) {
            let text = format!("the {name} is {length} (it must be 0 or greater, and finite)");
            return Err(Error::said(ErrorKind::Value, text));
        }
    }
    match (2..=4096).contains(&settings.across) {
        true => Ok(()),
        false => {
            let text = format!("there are {} cells across (from 2 to 4096 are possible)", settings.across);
            Err(Error::said(ErrorKind::Value, text))
        }
    }
}
