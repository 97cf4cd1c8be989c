//! Optical systems, compiled: solids with their media, and sheets.

use crate::abreast::{Abreast, Around};
use crate::component::{Sheet, with_prefix};
use crate::element::{Action, Body, Element, Finish, Material};
use crate::error::OpticsError;
use crate::foresee::Foresight;
use crate::medium::Medium;
use crate::near::Near;
use num_complex::Complex64;
use rayweave_math::{Affine, Bounds, Vec3};
use rayweave_model::{Crossing, Face, LeafFacet, PlacementId, Program, Region, RegionId};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// Nanometres in a millimetre, the unit of length unless another is chosen.
const NM_PER_MM: f64 = 1e6;

/// The parts of an optical system, in order: where solids overlap, the later one wins.
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
    /// Nothing in vacuum; lengths are millimetres.
    pub fn new() -> Assembly {
        Assembly::default()
    }

    /// The medium around everything.
    pub fn world(mut self, medium: Medium) -> Assembly {
        self.world = medium;
        self
    }

    /// The unit of all lengths, in nanometres: it matters for absorption, gratings and phases.
    pub fn unit_nm(mut self, unit_nm: f64) -> Assembly {
        self.unit_nm = unit_nm;
        self
    }

    /// Adds a part.
    #[expect(clippy::should_implement_trait, reason = "the parts of a list, not a sum")]
    pub fn add(mut self, element: Element) -> Assembly {
        self.elements.push(element);
        self
    }

    /// The parts in their order.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Compiles the system.
    ///
    /// # Errors
    /// [`OpticsError`] for two elements of one name, numbers out of range, finishes of faces that do not exist, and solids
    /// that do not compile.
    pub fn compile(&self) -> Result<System, OpticsError> {
        let mut names = HashSet::new();
        if let Some(twice) = self.elements.iter().find(|element| !names.insert(&element.name)) {
            return Err(OpticsError::SameName { name: twice.name.clone() });
        }
        if !(self.unit_nm > 0.0 && self.unit_nm.is_finite()) {
            let (element, what, range) =
                ("the system".to_owned(), "the unit in nm", "greater than 0, finite");
            return Err(OpticsError::BadNumber { element, what, value: self.unit_nm, range });
        }
        self.elements.iter().try_for_each(check)?;
        let mut solids = Solids::new(&self.world);
        let mut sheets = Vec::new();
        for (number, element) in self.elements.iter().enumerate() {
            match &element.body {
                Body::Solid { .. } => solids.add(number, element)?,
                Body::Sheet { sheet, action } => sheets.push(Plate::new(number, element, sheet, action)?),
            }
        }
        solids.compile(sheets, self)
    }
}

/// Refuses numbers that have no meaning.
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
        | Finish::Diffuse { reflectance } => fraction("the reflectance", *reflectance),
        Finish::Rough { slope } if !(*slope >= 0.0 && slope.is_finite()) => {
            Err(bad_number(element, "the slope", *slope, "at least 0, finite"))
        }
        Finish::Coated(films) => films.iter().try_for_each(|film| {
            let is_good = film.thickness_nm >= 0.0 && film.thickness_nm.is_finite();
            let bad =
                || bad_number(element, "the thickness of a film", film.thickness_nm, "at least 0, finite");
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
                fraction("the reflectance", *reflectance)
            }
            Action::ThinLens { focal_length } => finite("the focal length", *focal_length),
            Action::Grating { lines, .. } => finite("the number of lines", lines.length()),
            Action::Polariser { axis } | Action::Retarder { axis, .. } => finite("the axis", axis.length()),
            Action::Absorb | Action::Record => Ok(()),
        },
    }
}

fn bad_number(element: &Element, what: &'static str, value: f64, range: &'static str) -> OpticsError {
    OpticsError::BadNumber { element: element.name.clone(), what, value, range }
}

/// What fills a region.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Substance {
    Transparent(Medium),
    Opaque,
    Metal(Medium),
}

impl Substance {
    /// True if light goes straight on in it.
    pub fn is_uniform(&self) -> bool {
        matches!(self, Substance::Transparent(medium) if medium.gradient().is_none())
    }

    /// Its index at a point; of no meaning for what has none.
    pub fn index_at(&self, wavelength_nm: f64, point: Vec3) -> Complex64 {
        match self {
            Substance::Transparent(medium) | Substance::Metal(medium) => {
                medium.index_at(wavelength_nm, point)
            }
            Substance::Opaque => Complex64::ONE,
        }
    }
}

/// The finishes of a solid element.
#[derive(Clone, Debug)]
struct Dress {
    /// The number of the element among all.
    element: usize,
    finish: Finish,
    own: Vec<Finish>,
    /// For every face of the program the finish of its own, if any; empty if no face has one.
    by_face: Vec<u16>,
}

/// No finish of its own.
const NONE: u16 = u16::MAX;

impl Dress {
    /// The finish of a face of this element.
    fn of(&self, face: usize) -> &Finish {
        let own = self.by_face.get(face).copied().unwrap_or(NONE);
        self.own.get(usize::from(own)).unwrap_or(&self.finish)
    }
}

/// A face of an element that light meets.
pub(crate) struct FaceMet<'a> {
    pub element: usize,
    pub surface: usize,
    pub finish: &'a Finish,
    /// True if the light is inside of the element.
    pub from_inside: bool,
}

impl FaceMet<'_> {
    fn is_polished(&self) -> bool {
        *self.finish == Finish::Polished
    }
}

/// A sheet, compiled: a program of two regions, that before the surface and that behind it, within the trim.
#[derive(Clone, Debug)]
pub(crate) struct Plate {
    pub element: usize,
    pub program: Arc<Program>,
    pub near: Near,
    /// A box around all of it.
    pub bounds: Bounds,
    pub around: Around,
    pub foresight: Option<Foresight>,
    pub frame: Affine,
    pub action: Action,
}

impl Plate {
    fn new(number: usize, element: &Element, sheet: &Sheet, action: &Action) -> Result<Plate, OpticsError> {
        let region = |name: &str, solid, medium| Region { name: name.to_owned(), solid, medium };
        let regions = [
            region("inside", &sheet.surface & &sheet.trim, 1),
            region("outside", &sheet.trim - &sheet.surface, 2),
        ];
        let program = Program::compile_regions(&regions)
            .map_err(|problem| OpticsError::Geometry { element: element.name.clone(), problem })?;
        let near = Near::new(&program);
        // of several surfaces, one that is met before the one that is guessed could be overlooked
        let is_one = Program::compile(&sheet.surface).is_ok_and(|alone| alone.surfaces().len() == 1);
        let foresight = Foresight::new(&program).filter(|_| is_one);
        let bounds = program.bounds();
        let (program, frame, action) = (Arc::new(program), sheet.frame, action.clone());
        let around = Around::new(&bounds);
        Ok(Plate { element: number, program, near, bounds, around, foresight, frame, action })
    }
}

/// The solids while they are gathered.
struct Solids {
    regions: Vec<Region>,
    media: Vec<Substance>,
    dresses: Vec<Dress>,
    faces: Vec<Vec<(String, Finish)>>,
}

impl Solids {
    fn new(world: &Medium) -> Solids {
        let media = vec![Substance::Transparent(world.clone())];
        Solids { regions: Vec::new(), media, dresses: Vec::new(), faces: Vec::new() }
    }

    fn add(&mut self, number: usize, element: &Element) -> Result<(), OpticsError> {
        let Body::Solid { solid, material, finish, faces } = &element.body else { return Ok(()) };
        let named = with_prefix(solid, &element.name);
        // compiled alone first, so that problems and unknown faces are told with the name of the element
        let alone = Program::compile(&named)
            .map_err(|problem| OpticsError::Geometry { element: element.name.clone(), problem })?;
        let face_names: Vec<String> = alone.face_names().collect();
        for (face, _) in faces {
            if !face_names.iter().any(|name| is_called(name, face)) {
                let (element, face) = (element.name.clone(), face.clone());
                return Err(OpticsError::NoFace { element, face, faces: list(face_names) });
            }
        }
        let is_plain = faces.is_empty() && *finish == Finish::Polished;
        let medium = self.medium(material, is_plain);
        self.regions.push(Region { name: element.name.clone(), solid: named, medium });
        let own = faces.iter().map(|(_, finish)| finish.clone()).collect();
        self.dresses.push(Dress { element: number, finish: finish.clone(), own, by_face: Vec::new() });
        self.faces.push(faces.clone());
        Ok(())
    }

    /// The number of the medium: polished parts of the same glass that touch are one piece.
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

    fn compile(mut self, plates: Vec<Plate>, assembly: &Assembly) -> Result<System, OpticsError> {
        let program = Program::compile_regions(&self.regions)
            .map_err(|problem| OpticsError::Geometry { element: "the system".to_owned(), problem })?;
        let names: Vec<String> = program.face_names().collect();
        for ((dress, faces), region) in self.dresses.iter_mut().zip(&self.faces).zip(&self.regions) {
            if !faces.is_empty() {
                dress.by_face = by_face(&program, &names, &region.name, faces);
            }
        }
        let near = Near::new(&program);
        let boxes = plates.iter().map(|plate| plate.bounds);
        Ok(System {
            around: boxes.fold(program.bounds(), |all, one| all.union(&one)),
            abreast: Abreast::new(&program, &near),
            foresight: Foresight::new(&program),
            near,
            faces: faces(&program),
            program: Arc::new(program),
            media: self.media,
            dresses: self.dresses,
            plates,
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

/// The finishes of an element for all faces of a program: for its own by their names, and for those of other elements that lie in
/// the same surface, since a face that two elements share bears the name of one of them.
fn by_face(program: &Program, names: &[String], element: &str, faces: &[(String, Finish)]) -> Vec<u16> {
    let is_own = |name: &str| name.strip_prefix(element).is_some_and(|rest| rest.starts_with('.'));
    let called = |name: &str| faces.iter().rposition(|(face, _)| is_called(name, face));
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

/// True if a name, or some of its parts between dots, is what is asked for.
fn is_called(name: &str, asked: &str) -> bool {
    format!(".{name}.").contains(&format!(".{asked}."))
}

fn list(names: Vec<String>) -> String {
    let mut seen = HashSet::new();
    let names: Vec<String> = names.into_iter().filter(|name| seen.insert(name.clone())).collect();
    names.join(", ")
}

/// A face has a finish.
pub(crate) struct NotPolished;

/// An optical system, ready to be traced.
#[derive(Clone, Debug)]
pub struct System {
    pub(crate) program: Arc<Program>,
    pub(crate) near: Near,
    pub(crate) abreast: Option<Abreast>,
    pub(crate) foresight: Option<Foresight>,
    /// The faces by their numbers.
    pub(crate) faces: Vec<Face>,
    pub(crate) media: Vec<Substance>,
    dresses: Vec<Dress>,
    pub(crate) plates: Vec<Plate>,
    elements: Vec<String>,
    face_names: Vec<String>,
    pub(crate) unit_nm: f64,
    /// The box of all solids and sheets.
    pub(crate) around: Bounds,
}

impl System {
    /// The solids, compiled: region k + 1 is the k-th solid element.
    pub fn program(&self) -> &Arc<Program> {
        &self.program
    }

    /// The names of the elements; results name elements by their numbers in this list.
    pub fn element_names(&self) -> &[String] {
        &self.elements
    }

    /// The name of a surface by its number in results: faces of solids first, then the sheets in their order.
    pub fn surface_name(&self, surface: usize) -> &str {
        let sheet = || self.plates.get(surface - self.face_names.len()).map(|plate| plate.element);
        match self.face_names.get(surface) {
            Some(name) => name,
            None => sheet().map_or("", |element| &self.elements[element]),
        }
    }

    /// The numbers of all surfaces.
    pub fn surfaces(&self) -> Range<usize> {
        0..self.face_names.len() + self.plates.len()
    }

    /// The number of the sheet that an element is, as results name surfaces; `None` for solids and unknown names.
    pub fn sheet_surface(&self, element: &str) -> Option<usize> {
        let of = |plate: &Plate| self.elements[plate.element] == element;
        self.plates.iter().position(of).map(|k| k + self.face_names.len())
    }

    /// The map from the frame of a sheet to the world; `None` for solids and unknown names.
    pub fn sheet_frame(&self, element: &str) -> Option<&Affine> {
        let of = |plate: &&Plate| self.elements[plate.element] == element;
        self.plates.iter().find(of).map(|plate| &plate.frame)
    }

    /// The compiled sheet that an element is: region 1 lies before its surface, region 2 behind it, within its trim; `None`
    /// for solids and unknown names.
    pub fn sheet_program(&self, element: &str) -> Option<&Arc<Program>> {
        let of = |plate: &&Plate| self.elements[plate.element] == element;
        self.plates.iter().find(of).map(|plate| &plate.program)
    }

    /// The medium of a region of the solids, or of the world; `None` where no light goes.
    pub fn medium_of(&self, region: RegionId) -> Option<&Medium> {
        match self.substance(region) {
            Substance::Transparent(medium) | Substance::Metal(medium) => Some(medium),
            Substance::Opaque => None,
        }
    }

    /// The media in which light can be, each once.
    pub fn media(&self) -> impl Iterator<Item = &Medium> {
        self.media.iter().filter_map(|substance| match substance {
            Substance::Transparent(medium) | Substance::Metal(medium) => Some(medium),
            Substance::Opaque => None,
        })
    }

    pub(crate) fn substance(&self, region: RegionId) -> &Substance {
        &self.media[self.program.medium_of(region) as usize]
    }

    /// The element of a region, if its face of this number is polished; nothing for the world, which has no faces.
    pub(crate) fn polished(&self, region: RegionId, face: usize) -> Result<Option<usize>, NotPolished> {
        let Some(dress) = region.index().checked_sub(1).and_then(|k| self.dresses.get(k)) else {
            return Ok(None);
        };
        match dress.of(face) {
            Finish::Polished => Ok(Some(dress.element)),
            _ => Err(NotPolished),
        }
    }

    /// What is met at a crossing: the finish of what is entered or, if that is polished, of what is left.
    pub(crate) fn face_at(&self, crossing: &Crossing) -> FaceMet<'_> {
        let side = |region: RegionId, face: Face, from_inside: bool| {
            let dress = self.dresses.get(region.index().checked_sub(1)?)?;
            let surface = self.program.face_number(face.leaf, face.facet) as usize;
            let finish = dress.of(surface);
            Some(FaceMet { element: dress.element, surface, finish, from_inside })
        };
        let entered = side(crossing.after, crossing.entered, false);
        let left = side(crossing.before, crossing.left, true);
        match (entered, left) {
            (Some(entered), Some(left)) if entered.is_polished() && !left.is_polished() => left,
            (Some(met), _) | (None, Some(met)) => met,
            (None, None) => FaceMet { element: 0, surface: 0, finish: &Finish::Polished, from_inside: false },
        }
    }

    pub(crate) fn sheets_from(&self) -> usize {
        self.face_names.len()
    }
}
