//! Optical systems: an assembly of elements, compiled into solids with media and finishes, and sheets.

use crate::bundle::{LaneBounds, Predictor, Refractor};
use crate::component::{Sheet, with_prefix};
use crate::element::{Action, Body, Element, Finish, Material};
use crate::error::OpticsError;
use crate::medium::Medium;
use crate::start_surfaces::StartSurfaces;
use num_complex::Complex64;
use rayweave_math::{Affine, Bounds, Vec3};
use rayweave_model::{Crossing, Face, LeafFacet, PlacementId, Program, Region, RegionId};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// Nanometres in a millimetre, the unit of length unless another is chosen.
const NM_PER_MM: f64 = 1e6;

/// The elements of an optical system, in order: where solids overlap, the later one has priority.
#[derive(Clone, Debug)]
pub struct Assembly {
    elements: Vec<Element>,
    world: Medium,
    unit_nm: f64,
}

impl Default for Assembly {
    fn default() -> Assembly {
        Assembly { elements: Vec::new(), world: Medium::vacuum(), unit_nm: NM_PER_MM }
    }
}

impl Assembly {
    /// An empty assembly in vacuum; lengths are millimetres.
    pub fn new() -> Assembly {
        Assembly::default()
    }

    /// Sets the medium around all elements.
    pub fn world(mut self, medium: Medium) -> Assembly {
        self.world = medium;
        self
    }

    /// Sets the unit of all lengths, in nanometres, which absorption, gratings and phases depend on.
    pub fn unit_nm(mut self, unit_nm: f64) -> Assembly {
        self.unit_nm = unit_nm;
        self
    }

    /// Adds an element.
    #[expect(clippy::should_implement_trait, reason = "an element of a list, not a sum")]
    pub fn add(mut self, element: Element) -> Assembly {
        self.elements.push(element);
        self
    }

    /// The elements in their order.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Compiles the system.
    ///
    /// # Errors
    /// [`OpticsError`] for two elements with the same name, numbers out of range, finishes of faces
    /// that do not exist, and solids that do not compile.
    pub fn compile(&self) -> Result<System, OpticsError> {
        let mut names = HashSet::new();
        if let Some(twice) = self.elements.iter().find(|element| !names.insert(&element.name)) {
            return Err(OpticsError::SameName { name: twice.name.clone() });
        }
        if !(self.unit_nm > 0.0 && self.unit_nm.is_finite()) {
            let (element, what, range) = ("the system".to_owned(), "unit in nm", "greater than 0 and finite");
            return Err(OpticsError::BadNumber { element, what, value: self.unit_nm, range });
        }
        self.elements.iter().try_for_each(check)?;
        let mut solids = Solids::new(&self.world);
        let mut sheets = Vec::new();
        for (number, element) in self.elements.iter().enumerate() {
            match &element.body {
                Body::Solid { .. } => solids.add(number, element)?,
                Body::Sheet { sheet, action } => {
                    sheets.push(CompiledSheet::new(number, element, sheet, action)?)
                }
            }
        }
        solids.compile(sheets, self)
    }
}

/// Rejects numbers of finishes and actions that are out of range.
fn check(element: &Element) -> Result<(), OpticsError> {
    let fraction = |what: &'static str, value: f64| {
        let is_good = (0.0..=1.0).contains(&value);
        let bad = || bad_number(element, what, value, "from 0 to 1");
        if is_good { Ok(()) } else { Err(bad()) }
    };
    let finite = |what: &'static str, value: f64| {
        let is_good = value.is_finite() && value != 0.0;
        if is_good { Ok(()) } else { Err(bad_number(element, what, value, "finite and not 0")) }
    };
    let check_finish = |finish: &Finish| match finish {
        Finish::Mirror { reflectance }
        | Finish::Splitter { reflectance }
        | Finish::Diffuse { reflectance } => fraction("reflectance", *reflectance),
        Finish::Rough { slope } if !(*slope >= 0.0 && slope.is_finite()) => {
            Err(bad_number(element, "slope", *slope, "at least 0 and finite"))
        }
        Finish::Coated(films) => films.iter().try_for_each(|film| {
            let is_good = film.thickness_nm >= 0.0 && film.thickness_nm.is_finite();
            let bad = || bad_number(element, "film thickness", film.thickness_nm, "at least 0 and finite");
            if is_good { Ok(()) } else { Err(bad()) }
        }),
        Finish::Polished | Finish::Absorber | Finish::Rough { .. } => Ok(()),
    };
    match &element.body {
        Body::Solid { finish, faces, .. } => {
            faces.iter().map(|(_, finish)| finish).chain([finish]).try_for_each(check_finish)
        }
        Body::Sheet { action, .. } => match action {
            Action::Mirror { reflectance } | Action::Splitter { reflectance } => {
                fraction("reflectance", *reflectance)
            }
            Action::ThinLens { focal_length } => finite("focal length", *focal_length),
            Action::Grating { lines, .. } => finite("number of lines", lines.length()),
            Action::Polariser { axis } | Action::Retarder { axis, .. } => finite("axis", axis.length()),
            Action::Absorb | Action::Record => Ok(()),
        },
    }
}

fn bad_number(element: &Element, what: &'static str, value: f64, range: &'static str) -> OpticsError {
    OpticsError::BadNumber { element: element.name.clone(), what, value, range }
}

/// The content of a region.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Substance {
    Transparent(Medium),
    Opaque,
    Metal(Medium),
}

impl Substance {
    /// True if light propagates along straight rays in it.
    pub fn is_uniform(&self) -> bool {
        matches!(self, Substance::Transparent(medium) if medium.gradient().is_none())
    }

    /// The complex refractive index at a point; 1 for opaque solids, which have none.
    pub fn index_at(&self, wavelength_nm: f64, point: Vec3) -> Complex64 {
        match self {
            Substance::Transparent(medium) | Substance::Metal(medium) => {
                medium.index_at(wavelength_nm, point)
            }
            Substance::Opaque => Complex64::ONE,
        }
    }
}

/// The surface finishes of a solid element.
#[derive(Clone, Debug)]
struct ElementFinishes {
    /// The number of the element among all.
    element: usize,
    finish: Finish,
    own: Vec<Finish>,
    /// For every face of the program, the number of its own finish or [`NONE`]; empty if no face has its own finish.
    by_face: Vec<u16>,
}

/// Marks a face without a finish of its own.
const NONE: u16 = u16::MAX;

impl ElementFinishes {
    /// The finish of a face of this element.
    fn of_face(&self, face: usize) -> &Finish {
        let own = self.by_face.get(face).copied().unwrap_or(NONE);
        self.own.get(usize::from(own)).unwrap_or(&self.finish)
    }
}

/// The face of an element at a hit.
pub(crate) struct HitFace<'a> {
    pub element: usize,
    pub surface: usize,
    pub finish: &'a Finish,
    /// True if the light comes from inside the element.
    pub from_inside: bool,
}

impl HitFace<'_> {
    fn is_polished(&self) -> bool {
        *self.finish == Finish::Polished
    }
}

/// A compiled sheet: a program of two regions, one before the surface and one behind it, both
/// within the trim.
#[derive(Clone, Debug)]
pub(crate) struct CompiledSheet {
    pub element: usize,
    pub program: Arc<Program>,
    pub start_surfaces: StartSurfaces,
    /// The bounding box of the program.
    pub bounds: Bounds,
    pub lane_bounds: LaneBounds,
    pub predictor: Option<Predictor>,
    pub frame: Affine,
    pub local_from_world: Affine,
    pub action: Action,
}

impl CompiledSheet {
    fn new(
        number: usize,
        element: &Element,
        sheet: &Sheet,
        action: &Action,
    ) -> Result<CompiledSheet, OpticsError> {
        let region = |name: &str, solid, medium| Region { name: name.to_owned(), solid, medium };
        let regions = [
            region("inside", &sheet.surface & &sheet.trim, 1),
            region("outside", &sheet.trim - &sheet.surface, 2),
        ];
        let program = Program::compile_regions(&regions)
            .map_err(|problem| OpticsError::Geometry { element: element.name.clone(), problem })?;
        let start_surfaces = StartSurfaces::new(&program);
        // the prediction does not detect that another surface of the same sheet is hit first
        let is_one = Program::compile(&sheet.surface).is_ok_and(|alone| alone.surfaces().len() == 1);
        let predictor = Predictor::new(&program).filter(|_| is_one);
        let bounds = program.bounds();
        let (program, frame, action) = (Arc::new(program), sheet.frame, action.clone());
        let lane_bounds = LaneBounds::new(&bounds);
        // a singular frame does not compile
        let local_from_world = frame.inverse().unwrap_or(Affine::IDENTITY);
        Ok(CompiledSheet {
            element: number,
            program,
            start_surfaces,
            bounds,
            lane_bounds,
            predictor,
            frame,
            local_from_world,
            action,
        })
    }
}

/// The solid elements of an assembly, before compilation.
struct Solids {
    regions: Vec<Region>,
    media: Vec<Substance>,
    finishes: Vec<ElementFinishes>,
    faces: Vec<Vec<(String, Finish)>>,
}

impl Solids {
    fn new(world: &Medium) -> Solids {
        let media = vec![Substance::Transparent(world.clone())];
        Solids { regions: Vec::new(), media, finishes: Vec::new(), faces: Vec::new() }
    }

    fn add(&mut self, number: usize, element: &Element) -> Result<(), OpticsError> {
        let Body::Solid { solid, material, finish, faces } = &element.body else { return Ok(()) };
        let named = with_prefix(solid, &element.name);
        // each solid is compiled on its own first, so that errors and unknown faces carry the name
        // of the element
        let alone = Program::compile(&named)
            .map_err(|problem| OpticsError::Geometry { element: element.name.clone(), problem })?;
        let face_names: Vec<String> = alone.face_names().collect();
        for (face, _) in faces {
            if !face_names.iter().any(|name| matches_face(name, face)) {
                let (element, face) = (element.name.clone(), face.clone());
                return Err(OpticsError::NoFace { element, face, faces: list(face_names) });
            }
        }
        let is_plain = faces.is_empty() && *finish == Finish::Polished;
        let medium = self.medium(material, is_plain);
        self.regions.push(Region { name: element.name.clone(), solid: named, medium });
        let own = faces.iter().map(|(_, finish)| finish.clone()).collect();
        self.finishes.push(ElementFinishes {
            element: number,
            finish: finish.clone(),
            own,
            by_face: Vec::new(),
        });
        self.faces.push(faces.clone());
        Ok(())
    }

    /// The number of the medium. Polished solids of the same glass share one number, so that they
    /// have no interface where they touch.
    fn medium(&mut self, material: &Material, is_plain: bool) -> u32 {
        let substance = match material {
            Material::Transparent(medium) => Substance::Transparent(medium.clone()),
            Material::Opaque => Substance::Opaque,
            Material::Metal(medium) => Substance::Metal(medium.clone()),
        };
        let known = self.media.iter().position(|other| is_plain && *other == substance);
        let number = known.unwrap_or(self.media.len());
        if known.is_none() {
            self.media.push(substance);
        }
        number as u32
    }

    fn compile(mut self, sheets: Vec<CompiledSheet>, assembly: &Assembly) -> Result<System, OpticsError> {
        let program = Program::compile_regions(&self.regions)
            .map_err(|problem| OpticsError::Geometry { element: "the system".to_owned(), problem })?;
        let names: Vec<String> = program.face_names().collect();
        for ((finishes, faces), region) in self.finishes.iter_mut().zip(&self.faces).zip(&self.regions) {
            if !faces.is_empty() {
                finishes.by_face = by_face(&program, &names, &region.name, faces);
            }
        }
        let start_surfaces = StartSurfaces::new(&program);
        let boxes = sheets.iter().map(|sheet| sheet.bounds);
        Ok(System {
            bounds: boxes.fold(program.bounds(), |all, one| all.union(&one)),
            refractor: Refractor::new(&program, &start_surfaces),
            predictor: Predictor::new(&program),
            start_surfaces,
            faces: faces(&program),
            program: Arc::new(program),
            media: self.media,
            finishes: self.finishes,
            sheets,
            elements: assembly.elements.iter().map(|element| element.name.clone()).collect(),
            face_names: names,
            unit_nm: assembly.unit_nm,
        })
    }
}

fn faces(program: &Program) -> Vec<Face> {
    let mut faces = Vec::with_capacity(program.facets().len());
    for leaf in program.leaves() {
        let face = |(facet, side): (u32, &LeafFacet)| Face {
            leaf: leaf.id(),
            facet,
            surface: side.surface(),
            placement: PlacementId(0),
        };
        faces.extend((0..).zip(leaf.facets()).map(face));
    }
    faces
}

/// The finishes of an element by face of the program. It covers the element's own faces by their
/// names, and faces of other elements that lie in the same surface, because a face that two
/// elements share has the name of one of them.
fn by_face(program: &Program, names: &[String], element: &str, faces: &[(String, Finish)]) -> Vec<u16> {
    let is_own = |name: &str| name.strip_prefix(element).is_some_and(|rest| rest.starts_with('.'));
    let called = |name: &str| faces.iter().rposition(|(face, _)| matches_face(name, face));
    let own = names.iter().map(|name| if is_own(name) { called(name) } else { None });
    let mut found: Vec<u16> = own.map(|k| k.map_or(NONE, |k| k as u16)).collect();
    let surfaces = || program.facets().iter().map(|facet| facet.surface());
    let known: HashMap<_, u16> =
        surfaces().zip(&found).filter(|(_, k)| **k != NONE).map(|(s, &k)| (s, k)).collect();
    for ((surface, k), name) in surfaces().zip(&mut found).zip(names) {
        if !is_own(name) {
            *k = known.get(&surface).copied().unwrap_or(NONE);
        }
    }
    found
}

/// True if a face name, or a part of it between dots, is `wanted`.
fn matches_face(name: &str, wanted: &str) -> bool {
    format!(".{name}.").contains(&format!(".{wanted}."))
}

fn list(names: Vec<String>) -> String {
    let mut seen = HashSet::new();
    let names: Vec<String> = names.into_iter().filter(|name| seen.insert(name.clone())).collect();
    names.join(", ")
}

/// Error: a face has a finish other than polished.
pub(crate) struct NotPolished;

/// An optical system, ready to be traced.
#[derive(Clone, Debug)]
pub struct System {
    pub(crate) program: Arc<Program>,
    pub(crate) start_surfaces: StartSurfaces,
    pub(crate) refractor: Option<Refractor>,
    pub(crate) predictor: Option<Predictor>,
    /// The faces, indexed by their numbers.
    pub(crate) faces: Vec<Face>,
    pub(crate) media: Vec<Substance>,
    finishes: Vec<ElementFinishes>,
    pub(crate) sheets: Vec<CompiledSheet>,
    elements: Vec<String>,
    face_names: Vec<String>,
    pub(crate) unit_nm: f64,
    /// The bounding box of all solids and sheets.
    pub(crate) bounds: Bounds,
}

impl System {
    /// The solids, compiled: region k + 1 is the k-th solid element.
    pub fn program(&self) -> &Arc<Program> {
        &self.program
    }

    /// The names of the elements; results refer to elements by their numbers in this list.
    pub fn element_names(&self) -> &[String] {
        &self.elements
    }

    /// The name of the surface with this number in results: faces of solids first, then the sheets in their order.
    pub fn surface_name(&self, surface: usize) -> &str {
        let sheet = || self.sheets.get(surface - self.face_names.len()).map(|sheet| sheet.element);
        match self.face_names.get(surface) {
            Some(name) => name,
            None => sheet().map_or("", |element| &self.elements[element]),
        }
    }

    /// The numbers of all surfaces.
    pub fn surfaces(&self) -> Range<usize> {
        0..self.face_names.len() + self.sheets.len()
    }

    /// The surface number of a sheet in results; `None` for solids and unknown names.
    pub fn sheet_surface(&self, element: &str) -> Option<usize> {
        let of = |sheet: &CompiledSheet| self.elements[sheet.element] == element;
        self.sheets.iter().position(of).map(|k| k + self.face_names.len())
    }

    /// The map from the frame of a sheet to the world; `None` for solids and unknown names.
    pub fn sheet_frame(&self, element: &str) -> Option<&Affine> {
        let of = |sheet: &&CompiledSheet| self.elements[sheet.element] == element;
        self.sheets.iter().find(of).map(|sheet| &sheet.frame)
    }

    /// The program of a sheet: region 1 lies before its surface, region 2 behind it, within its
    /// trim; `None` for solids and unknown names.
    pub fn sheet_program(&self, element: &str) -> Option<&Arc<Program>> {
        let of = |sheet: &&CompiledSheet| self.elements[sheet.element] == element;
        self.sheets.iter().find(of).map(|sheet| &sheet.program)
    }

    /// The medium of a region of the solids, or of the world; `None` for opaque solids.
    pub fn medium_of(&self, region: RegionId) -> Option<&Medium> {
        match self.substance(region) {
            Substance::Transparent(medium) | Substance::Metal(medium) => Some(medium),
            Substance::Opaque => None,
        }
    }

    /// The media of the world and of all solids that are not opaque; equal media may occur several times.
    pub fn media(&self) -> impl Iterator<Item = &Medium> {
        self.media.iter().filter_map(|substance| match substance {
            Substance::Transparent(medium) | Substance::Metal(medium) => Some(medium),
            Substance::Opaque => None,
        })
    }

    pub(crate) fn substance(&self, region: RegionId) -> &Substance {
        &self.media[self.program.medium_of(region) as usize]
    }

    /// The element of a region, if its face of this number is polished; `None` for the world, which
    /// has no faces.
    pub(crate) fn polished(&self, region: RegionId, face: usize) -> Result<Option<usize>, NotPolished> {
        let Some(finishes) = region.index().checked_sub(1).and_then(|k| self.finishes.get(k)) else {
            return Ok(None);
        };
        match finishes.of_face(face) {
            Finish::Polished => Ok(Some(finishes.element)),
            _ => Err(NotPolished),
        }
    }

    /// The face at a crossing: that of the element that is entered or, if it is polished and the
    /// other is not, that of the element that is left.
    pub(crate) fn face_at(&self, crossing: &Crossing) -> HitFace<'_> {
        let side = |region: RegionId, face: Face, from_inside: bool| {
            let finishes = self.finishes.get(region.index().checked_sub(1)?)?;
            let surface = self.program.face_number(face.leaf, face.facet) as usize;
            let finish = finishes.of_face(surface);
            Some(HitFace { element: finishes.element, surface, finish, from_inside })
        };
        let entered = side(crossing.after, crossing.entered, false);
        let left = side(crossing.before, crossing.left, true);
        match (entered, left) {
            (Some(entered), Some(left)) if entered.is_polished() && !left.is_polished() => left,
            (Some(face), _) | (None, Some(face)) => face,
            (None, None) => HitFace { element: 0, surface: 0, finish: &Finish::Polished, from_inside: false },
        }
    }

    /// The surface number of the first sheet.
    pub(crate) fn first_sheet_surface(&self) -> usize {
        self.face_names.len()
    }
}
