//! True cross-sections of models, by a plane or a stack of them: areas, contours, pictures, DXF.
//!
//! [`rayweave_analysis::section`], whose names are all here, and [`cross_sections`], which knows regions and media.
//!
//! ```
//! use rayweave::section::{SectionPlane, SectionSettings, cross_sections};
//!
//! let (_, scene) = rayweave::scene::parse("rayweave = 1\n[solid.ring]\ntorus = { major = 3, minor = 1 }")?;
//! let plane: SectionPlane = "z=0.6".parse()?;
//! let found = cross_sections(&scene, None, None, &[plane], &SectionSettings::default(), &mut |_| ())?;
//! // an annulus between 3 - 0.8 and 3 + 0.8
//! let ring = &found[0].parts[0];
//! assert_eq!(ring.contours.len(), 2);
//! let area = std::f64::consts::PI * (3.8f64.powi(2) - 2.2f64.powi(2));
//! assert!((ring.area - area).abs() < found[0].tolerance * ring.perimeter);
//! # Ok::<(), rayweave::Error>(())
//! ```

mod draw;
mod dxf;
mod plane;
#[cfg(test)]
mod tests;

pub use plane::SectionPlane;
pub use rayweave_analysis::section::*;

use crate::measure::subject;
use crate::{AnyEvaluator, Error, ErrorKind};
use rayweave_analysis::measure::one_medium_each;
use rayweave_math::Bounds;
use rayweave_model::{Evaluator, Program, Region, RegionId, Solid};
use rayweave_scene::{Colour, Scene};
use rayweave_shape::primitive::{BoxFromCorners, Primitive};
use std::sync::Arc;

/// What is drawn as one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum By {
    /// All regions of a medium together.
    #[default]
    Medium,
    /// Each region alone.
    Region,
}

/// How a model is cut.
#[derive(Clone, Debug)]
pub struct SectionSettings {
    /// What is drawn as one.
    pub by: By,
    /// How far contours may be from the truth, in the unit of the model; 1/10,000 of the larger side of the model in the plane
    /// if it is not given.
    pub tolerance: Option<f64>,
    /// The least number of columns, from 2: what is thinner than their distance may be overlooked.
    pub columns: u32,
    /// Only what lies in this box is cut.
    pub within: Option<Bounds>,
    /// Threads and the token that stops the run.
    pub sweep: Sweep,
}

/// By medium, 512 columns.
impl Default for SectionSettings {
    fn default() -> Self {
        let sweep = Sweep::default();
        SectionSettings { by: By::Medium, tolerance: None, columns: 512, within: None, sweep }
    }
}

/// What a plane cuts.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossSection {
    /// The plane.
    pub plane: SectionPlane,
    /// What there is in it, in the order of the regions or media; only what it meets.
    pub parts: Vec<SectionPart>,
    /// The lower left corner of the model in the plane.
    pub lo: [f64; 2],
    /// The upper right corner.
    pub hi: [f64; 2],
    /// How far contours may be from the truth; the area errs by no more than this times the perimeter.
    pub tolerance: f64,
}

/// A medium, or a region, in a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionPart {
    /// Its name.
    pub name: String,
    /// Its colour in pictures.
    pub colour: Colour,
    /// Its area.
    pub area: f64,
    /// The length of all lines around it.
    pub perimeter: f64,
    /// Its outlines counter-clockwise, its holes clockwise; the last point is not the first one again. Coordinates are those of
    /// [`SectionPlane::cut`].
    pub contours: Vec<Vec<[f64; 2]>>,
}

impl CrossSection {
    /// A part by its name.
    pub fn part(&self, name: &str) -> Option<&SectionPart> {
        self.parts.iter().find(|part| part.name == name)
    }
}

/// Cuts the regions of a scene, or one of its solids alone, by planes. `progress` is told how many are done.
///
/// A plane that misses the model cuts nothing, which is no error.
///
/// # Errors
///
/// [`ErrorKind::Name`] for an unknown solid or evaluator, [`ErrorKind::Compile`], [`ErrorKind::Solid`] for a model that has no end
/// in a plane, [`ErrorKind::Value`] for settings out of range, [`ErrorKind::Cancelled`].
pub fn cross_sections(
    scene: &Scene,
    solid: Option<&str>,
    evaluator: Option<&str>,
    planes: &[SectionPlane],
    settings: &SectionSettings,
    progress: &mut dyn FnMut(usize),
) -> Result<Vec<CrossSection>, Error> {
    let (regions, _) = subject(scene, solid)?;
    let kinds = Kinds::new(scene, &regions, settings.by);
    let regions = clipped(regions, settings.within)?;
    let program = Arc::new(Program::compile_regions(&one_medium_each(&regions))?);
    let cutter = Cutter { evaluator: AnyEvaluator::new(evaluator, program)?, kinds, settings };
    let mut sections = Vec::with_capacity(planes.len());
    for plane in planes {
        sections.push(cutter.cut(plane)?);
        progress(sections.len());
    }
    Ok(sections)
}

/// A picture of one section, or of a stack, as SVG: filled by colour, with a legend and a scale. Lengths are in `unit`. Of more
/// than 100 planes as many are drawn, evenly chosen.
pub fn section_svg(sections: &[CrossSection], title: &str, unit: &str) -> String {
    draw::drawing(sections, title, unit)
}

/// Sections as DXF (release 12, ASCII): closed polylines on a layer for each part, at the height of the plane's offset.
pub fn section_dxf(sections: &[CrossSection], unit: &str) -> String {
    dxf::dxf(sections, unit)
}

/// The part of regions in a box.
///
/// # Errors
///
/// [`ErrorKind::Shape`] for a box without volume.
pub(crate) fn clipped(regions: Vec<Region>, within: Option<Bounds>) -> Result<Vec<Region>, Error> {
    let Some(within) = within else { return Ok(regions) };
    let frame: Solid = Primitive::from(BoxFromCorners::new(within.lo, within.hi)?).into();
    Ok(regions.into_iter().map(|region| Region { solid: &region.solid & &frame, ..region }).collect())
}

/// Which part each region belongs to.
#[derive(Clone, Debug)]
pub(crate) struct Kinds {
    /// The number of the part of each region, from 1.
    pub of: Vec<u32>,
    /// The parts.
    pub names: Vec<(String, Colour)>,
}

impl Kinds {
    fn new(scene: &Scene, regions: &[Region], by: By) -> Kinds {
        let mut kinds = Kinds { of: Vec::new(), names: Vec::new() };
        let mut known = std::collections::HashMap::new();
        for (k, region) in regions.iter().enumerate() {
            let key = if by == By::Medium { region.medium as usize } else { k };
            let next = kinds.names.len() as u32 + 1;
            let number = *known.entry(key).or_insert(next);
            if number == next {
                kinds.names.push(Kinds::name(scene, region, k, by));
            }
            kinds.of.push(number);
        }
        kinds
    }

    fn name(scene: &Scene, region: &Region, k: usize, by: By) -> (String, Colour) {
        let of_medium = scene.medium_names().get(region.medium as usize).map(|name| (*name).to_owned());
        let name = of_medium.filter(|_| by == By::Medium).unwrap_or_else(|| region.name.clone());
        let same = |own: &&rayweave_scene::SceneRegion| own.name == region.name;
        let own = scene.regions.get(k).filter(same).or_else(|| scene.regions.iter().rfind(same));
        (name, own.map_or(Colour::PALETTE[k % Colour::PALETTE.len()], |own| own.colour))
    }

    fn number(&self, region: RegionId) -> RegionId {
        region.index().checked_sub(1).and_then(|k| self.of.get(k)).map_or(RegionId(0), |&kind| RegionId(kind))
    }
}

/// What cuts a compiled model.
pub(crate) struct Cutter<'a, E> {
    /// Of a program whose regions all have media of their own.
    pub evaluator: E,
    pub kinds: Kinds,
    pub settings: &'a SectionSettings,
}

impl<E: Evaluator> Cutter<'_, E> {
    pub fn cut(&self, plane: &SectionPlane) -> Result<CrossSection, Error> {
        let cut = plane.cut()?;
        let is_positive = |tolerance: &f64| *tolerance > 0.0 && tolerance.is_finite();
        if let Some(tolerance) = self.settings.tolerance.filter(|tolerance| !is_positive(tolerance)) {
            let text = format!("the tolerance is {tolerance} (it has to be greater than 0 and finite)");
            return Err(Error::said(ErrorKind::Value, text));
        }
        let bounds = self.evaluator.program().bounds();
        let ranges = [0, 1].map(|k| cut.range(&bounds, k));
        let (lo, hi) = ([ranges[0][0], ranges[1][0]], [ranges[0][1], ranges[1][1]]);
        if bounds.is_empty() {
            let tolerance = self.settings.tolerance.unwrap_or(1e-4);
            return Ok(CrossSection {
                plane: *plane,
                parts: Vec::new(),
                lo: [0.0; 2],
                hi: [1.0; 2],
                tolerance,
            });
        }
        if !lo.iter().chain(&hi).all(|end| end.is_finite()) {
            let text = format!(
                "the model has no end in the plane {plane} (a section is finite) cut it within a box?"
            );
            return Err(Error::said(ErrorKind::Solid, text));
        }
        let side = (hi[0] - lo[0]).max(hi[1] - lo[1]).max(f64::MIN_POSITIVE);
        let tolerance = self.settings.tolerance.unwrap_or(1e-4 * side);
        // the faces at the ends of the model are within
        let room = (1e-3 * side).max(4.0 * tolerance);
        let columns = self.settings.columns.max(2);
        let look =
            Look { lo: lo.map(|x| x - room), hi: hi.map(|x| x + room), tolerance: 0.5 * tolerance, columns };
        let found = section_with(&self.evaluator, &cut, &look, &self.settings.sweep)?;
        let found = found.renumbered(|region| self.kinds.number(region)).simplified(0.5 * tolerance);
        Ok(CrossSection { plane: *plane, parts: self.parts(&found), lo, hi, tolerance })
    }

    fn parts(&self, found: &Section) -> Vec<SectionPart> {
        let part = |(number, (name, colour)): (u32, &(String, Colour))| {
            let number = RegionId(number);
            SectionPart {
                name: name.clone(),
                colour: *colour,
                area: found.area(number),
                perimeter: found.perimeter(number),
                contours: found.contours(number),
            }
        };
        let parts = (1..).zip(&self.kinds.names).map(part);
        parts.filter(|part| !part.contours.is_empty()).collect()
    }
}
