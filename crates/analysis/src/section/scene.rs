//! Cross-sections of scenes, part by part.

use super::{Section, SectionError, SectionPlane, SectionRun, SectionWindow, section_with};
use crate::AnalysisError;
use crate::distance::world_surfaces;
use crate::error::maker;
use crate::measure::one_medium_each;
use crate::subject::{clipped, subject};
use rayweave_error::{Classified, Message};
use rayweave_math::Bounds;
use rayweave_model::memory::Growth;
use rayweave_model::{Evaluator, Program, Query, RayAnswer, RayBatch, Region, RegionId};
use rayweave_scene::{Colour, Scene, SceneRegion};
use rayweave_shape::Ray;
use rayweave_shape::surface::{Plane, Surface, delta_of};
use std::collections::HashMap;
use std::sync::Arc;

/// The division of a section into parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum By {
    /// All regions of a medium as one part.
    #[default]
    Medium,
    /// Each region as a part.
    Region,
}

/// The options of a section.
#[derive(Clone, Debug)]
pub struct SectionSettings {
    /// The parts.
    pub by: By,
    /// The largest distance of contours from the surfaces, in the unit of the model; by default 1/10,000 of
    /// the larger side of the model in the plane.
    pub tolerance: Option<f64>,
    /// The minimum number of columns, from 2 to 65,536: parts thinner than their spacing can be missed.
    pub columns: u32,
    /// Restricts the section to this box.
    pub within: Option<Bounds>,
    /// Threads and cancellation token.
    pub run: SectionRun,
}

/// By medium, 512 columns.
impl Default for SectionSettings {
    fn default() -> Self {
        let run = SectionRun::default();
        SectionSettings { by: By::Medium, tolerance: None, columns: 512, within: None, run }
    }
}

/// The section of a scene by a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossSection {
    /// The plane.
    pub plane: SectionPlane,
    /// The parts that the plane intersects, in the order of the regions or media.
    pub parts: Vec<SectionPart>,
    /// The lower left corner of the model in the plane.
    pub lo: [f64; 2],
    /// The upper right corner.
    pub hi: [f64; 2],
    /// The largest distance of contours from the surfaces; the error of an area is at most this times the
    /// perimeter.
    pub tolerance: f64,
    /// True if the plane lies in a plane face of the boundary of a part. The section then shows the material on one side of it:
    /// [`SectionPlane::side_in_face`]. Rays search for such a face; one smaller than 1/96 of the section may be missed.
    pub in_face: bool,
}

/// A medium or a region in a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionPart {
    /// The name.
    pub name: String,
    /// The colour in pictures.
    pub colour: Colour,
    /// The area.
    pub area: f64,
    /// The total length of the lines around it.
    pub perimeter: f64,
    /// Outlines counter-clockwise, holes clockwise; the first point is not repeated at the end. Coordinates
    /// are those of [`SectionPlane::cut`].
    pub contours: Vec<Vec<[f64; 2]>>,
}

impl CrossSection {
    /// A part by its name.
    pub fn part(&self, name: &str) -> Option<&SectionPart> {
        self.parts.iter().find(|part| part.name == name)
    }

    /// The approximate memory that it takes, in bytes.
    fn size(&self) -> u64 {
        let points: usize = self.parts.iter().flat_map(|part| &part.contours).map(Vec::len).sum();
        (points * size_of::<[f64; 2]>() + self.parts.len() * size_of::<SectionPart>()) as u64
    }
}

/// Cuts the regions of a scene, or one of its solids alone, by planes. `make` creates the evaluator of a
/// program; `progress` receives the number of finished planes.
///
/// A plane that misses the model gives a section without parts, not an error.
///
/// # Errors
///
/// [`AnalysisError`]: an unknown solid, a model that is unbounded in a plane, settings out of range,
/// sections that do not fit into memory, a cancelled run.
pub fn cross_sections<E: Evaluator, X: Classified + Send + Sync + 'static>(
    scene: &Scene,
    solid: Option<&str>,
    make: impl Fn(Arc<Program>) -> Result<E, X>,
    planes: &[SectionPlane],
    settings: &SectionSettings,
    progress: &mut dyn FnMut(usize),
) -> Result<Vec<CrossSection>, AnalysisError> {
    let (regions, _) = subject(scene, solid)?;
    let kinds = Kinds::new(scene, &regions, settings.by);
    let regions = clipped(regions, settings.within)?;
    let program = Arc::new(Program::compile_regions(&one_medium_each(&regions))?);
    let faces = plane_faces(&program);
    let cutter = Cutter { evaluator: maker(make)(program)?, kinds, settings };
    let mut sections = Vec::with_capacity(planes.len());
    let (mut bytes, mut growth) = (0, Growth::default());
    for plane in planes {
        let section = cutter.cut(plane)?;
        // most planes of shapes are no faces there: those between the arcs of an outline, say
        let in_face = faces.iter().any(|face| lies_in(plane, face)) && cutter.has_face_in(&section)?;
        let section = CrossSection { in_face, ..section };
        bytes += section.size();
        growth.check(bytes).map_err(SectionError::from)?;
        sections.push(section);
        progress(sections.len());
    }
    Ok(sections)
}

/// The planes of the faces of a program.
fn plane_faces(program: &Program) -> Vec<Plane> {
    let surfaces = world_surfaces(program).unwrap_or_default().into_iter();
    let plane = |surface| if let Surface::Plane(plane) = surface { Some(plane) } else { None };
    surfaces.filter_map(plane).collect()
}

/// True if the planes are equal up to rounding.
fn lies_in(plane: &SectionPlane, face: &Plane) -> bool {
    let (point, normal) = (plane.point(), plane.normal());
    let is_parallel = face.normal.cross(normal).length() <= delta_of(1.0);
    is_parallel
        && (face.normal.dot(point) - face.offset).abs() <= delta_of(point.length() + face.offset.abs())
}

/// The mapping of regions to parts.
#[derive(Clone, Debug)]
pub(crate) struct Kinds {
    /// The number of each region's part, from 1.
    pub of: Vec<u32>,
    /// The parts.
    pub names: Vec<(String, Colour)>,
}

impl Kinds {
    fn new(scene: &Scene, regions: &[Region], by: By) -> Kinds {
        let media = scene.medium_names();
        let mut last: HashMap<&str, &SceneRegion> = HashMap::new();
        last.extend(scene.regions.iter().map(|own| (own.name.as_str(), own)));
        let named = |region: &Region, k: usize| {
            let of_medium = media.get(region.medium as usize).map(|name| (*name).to_owned());
            let name = of_medium.filter(|_| by == By::Medium).unwrap_or_else(|| region.name.clone());
            let own = scene.regions.get(k).filter(|own| own.name == region.name);
            let own = own.or_else(|| last.get(region.name.as_str()).copied());
            (name, own.map_or(Colour::PALETTE[k % Colour::PALETTE.len()], |own| own.colour))
        };
        let mut kinds = Kinds { of: Vec::new(), names: Vec::new() };
        let mut known = HashMap::new();
        for (k, region) in regions.iter().enumerate() {
            let key = if by == By::Medium { region.medium as usize } else { k };
            let next = kinds.names.len() as u32 + 1;
            let number = *known.entry(key).or_insert(next);
            if number == next {
                kinds.names.push(named(region, k));
            }
            kinds.of.push(number);
        }
        kinds
    }

    fn number(&self, region: RegionId) -> RegionId {
        region.index().checked_sub(1).and_then(|k| self.of.get(k)).map_or(RegionId(0), |&kind| RegionId(kind))
    }
}

/// Cuts a compiled model.
pub(crate) struct Cutter<'a, E> {
    /// An evaluator of a program in which every region has its own medium.
    pub evaluator: E,
    pub kinds: Kinds,
    pub settings: &'a SectionSettings,
}

/// The smallest tolerance relative to the larger side of the section. Below it, rounding errors of the coordinates decide where points
/// of contours lie, and their number, inversely proportional to the square root of the tolerance, exceeds a million for a circle.
const FINEST: f64 = 1e-12;

/// The number of rays along each side of a section that search for a face in its plane, and the distance from the plane, relative to the
/// size of the model, that counts as rounding.
const ACROSS: usize = 96;
const FACE: f64 = 1e-9;

impl<E: Evaluator> Cutter<'_, E> {
    pub fn cut(&self, plane: &SectionPlane) -> Result<CrossSection, AnalysisError> {
        let cut = plane.cut()?;
        let is_positive = |tolerance: &f64| *tolerance > 0.0 && tolerance.is_finite();
        if let Some(tolerance) = self.settings.tolerance.filter(|tolerance| !is_positive(tolerance)) {
            return Err(SectionError::Tolerance { tolerance }.into());
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
                in_face: false,
            });
        }
        if !lo.iter().chain(&hi).all(|end| end.is_finite()) {
            let problem = format!("the model is unbounded in the plane {plane}");
            let message = Message::new(problem, "a section must be finite")
                .suggest("Cut the part within a box: --within LO HI, in Python within=(lo, hi).");
            return Err(AnalysisError::Solid(message));
        }
        let side = (hi[0] - lo[0]).max(hi[1] - lo[1]).max(f64::MIN_POSITIVE);
        let least = FINEST * side;
        // contours cannot be coarser than the section
        let tolerance = self.settings.tolerance.unwrap_or(1e-4 * side).min(side);
        if tolerance < least {
            return Err(SectionError::TooFine { tolerance, least }.into());
        }
        // a margin for the faces at the ends of the model
        let room = (1e-3 * side).max(4.0 * tolerance);
        let window = SectionWindow {
            lo: lo.map(|x| x - room),
            hi: hi.map(|x| x + room),
            tolerance: 0.5 * tolerance,
            columns: self.settings.columns,
        };
        let found = section_with(&self.evaluator, &cut, &window, &self.settings.run)?;
        let found = found.renumbered(|region| self.kinds.number(region)).simplified(0.5 * tolerance);
        Ok(CrossSection { plane: *plane, parts: self.parts(&found), lo, hi, tolerance, in_face: false })
    }

    /// True if a ray across the plane of a section changes from one part to another there.
    fn has_face_in(&self, section: &CrossSection) -> Result<bool, AnalysisError> {
        let CrossSection { lo, hi, .. } = *section;
        let cut = section.plane.cut()?;
        let normal = cut.normal();
        let near = FACE * self.evaluator.program().bounds().size().max_element();
        let step = [0, 1].map(|k| (hi[k] - lo[k]) / ACROSS as f64);
        // off the middle of the cells, where the faces across the plane of symmetric models are
        let place = |k: usize| [(k % ACROSS, 0.37), (k / ACROSS, 0.41)].map(|(n, part)| n as f64 + part);
        let mut batch = RayBatch::default();
        for k in 0..ACROSS * ACROSS {
            let at = place(k);
            batch.push(Ray::new(cut.point([0, 1].map(|k| lo[k] + at[k] * step[k])), normal));
        }
        let mut is_found = false;
        let mut sink = |answer: RayAnswer<'_>| {
            is_found |= answer.crossings.iter().any(|crossing| {
                crossing.t.abs() <= near
                    && self.kinds.number(crossing.before) != self.kinds.number(crossing.after)
            });
        };
        let mut scratch = self.evaluator.scratch();
        self.evaluator.crossings(batch.rays(), &Query::default(), &mut scratch, &mut sink);
        Ok(is_found)
    }

    fn parts(&self, found: &Section) -> Vec<SectionPart> {
        // the edges of each part, in their order: searching all edges for each part takes parts times edges
        let mut own: Vec<Vec<u32>> = vec![Vec::new(); self.kinds.names.len() + 1];
        for (k, edge) in (0..).zip(&found.edges) {
            own[edge.left.index()].push(k);
            own[edge.right.index()].push(k);
        }
        let part = |(number, (name, colour)): (u32, &(String, Colour))| {
            let number = RegionId(number);
            let edges = own[number.index()].iter().map(|&k| found.edges[k as usize].clone()).collect();
            let found = Section { edges };
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
