//! Conversion of prescriptions to solids: lenses with shared cemented faces, mirrors on substrates, stop and
//! image as sheets.

use super::error::{bad, positive};
use super::stop::{Extents, StopSheet, stop_sheets};
use super::{Behind, Prescription, PrescriptionError, Resolved, Surface};
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_optics::component::{
    Aperture, Asphere, Blank, ComponentError, Sheet, SurfaceForm, freeform_lens, freeform_mirror, rod,
    with_prefix,
};
use rayweave_optics::{Action, Assembly, Element, Finish, Medium};

/// The name of the image element.
pub const IMAGE: &str = "image";

/// The start of the names of faces beyond the clear semi-diameters of a lens.
const RIM: &str = "rim";

/// Ratio of computed semi-diameters to the extent of the rays.
const SPARE: f64 = 1.02;

/// The least thickness of a mirror substrate behind its rim, in units of its diameter.
const SUBSTRATE: f64 = 0.1;

/// The outline of a lens among the solids.
#[derive(Clone, Debug, PartialEq)]
pub struct LensOutline {
    /// The name of its element.
    pub name: String,
    /// Its surfaces in the order of z, counted from 0; the medium is that behind the first one in the order of light.
    pub surfaces: [usize; 2],
    /// The semi-diameters at which the surfaces end; beyond them the lens has a flat rim.
    pub ends: [f64; 2],
    /// The semi-diameter of the lens.
    pub semi_diameter: f64,
    /// The distance of the vertices.
    pub thickness: f64,
}

/// A prescription converted to parts of a system.
#[derive(Clone, Debug)]
pub struct PrescriptionLayout {
    /// The parts: lenses, named after their surfaces (`lens 1-2`), and mirrors (`mirror 3`); then the
    /// [sheets of the stop](Self::stop), and [`IMAGE`], which transmits the light. Rims absorb.
    pub assembly: Assembly,
    /// The sheets of the stop, [`STOP`](super::STOP) and [`MOUNT`](super::MOUNT): none if the stop is the rim of a
    /// mirror, or of a lens that is as wide as any other. A stop on a wider face of a lens is a ring on that face.
    pub stop: Vec<StopSheet>,
    /// The lenses, in the order of `assembly`.
    pub lenses: Vec<LensOutline>,
    /// The numbers of the elements in the order in which light reaches them in the prescription; light on any
    /// other path is stray light.
    pub sequence: Vec<usize>,
    /// The clear semi-diameters of the surfaces; the last is that of the image.
    pub semi_diameters: Vec<f64>,
}

impl Prescription {
    /// Converts the prescription to solids in air, with the unit of lengths; [`Prescription::beam`] returns
    /// its rays.
    ///
    /// A lens is as wide as the wider one of its two surfaces. If the other surface ends earlier, or if the
    /// two would intersect outside its semi-diameter, a flat rim joins it to the edge. Beyond, up to the greater of their
    /// [mechanical semi-diameters](Surface::mechanical_semi_diameter), the surfaces absorb the light; where they do not reach
    /// that far, they are flat. Coincident faces of
    /// neighbours, as in cemented lenses, become one surface of the compiled system, so light passes from
    /// glass to glass in one event. Mirrors get a substrate. A lens or mirror that light passes twice is one
    /// part.
    ///
    /// # Errors
    /// [`PrescriptionError`], with the surfaces at fault, for lenses that cannot be built.
    pub fn assembly(&self) -> Result<PrescriptionLayout, PrescriptionError> {
        let is_computed = |number: usize| {
            self.surfaces.get(number - 1).is_some_and(|surface| surface.semi_diameter.is_none())
        };
        self.solids().map_err(|error| match error {
            PrescriptionError::Cross { first, second, height, reach, .. } => {
                let is_computed = is_computed(first) || is_computed(second);
                PrescriptionError::Cross { first, second, height, reach, is_computed }
            }
            other => other,
        })
    }

    fn solids(&self) -> Result<PrescriptionLayout, PrescriptionError> {
        let resolved = self.resolved()?;
        let radii = self.semi_diameters(&resolved)?;
        let extents = Extents::new(&radii);
        let mut builder = Builder {
            lens: self,
            resolved: &resolved,
            radii,
            extents,
            parts: Vec::new(),
            lenses: Vec::new(),
        };
        (0..self.surfaces.len()).try_for_each(|k| builder.open_gap(k))?;
        builder.extents = Extents::new(&builder.radii);
        let mut sequence = Vec::new();
        for k in 0..self.surfaces.len() {
            sequence.extend(builder.surface(k)?);
        }
        let stop = stop_sheets(self, &resolved, &builder.extents);
        for sheet in &stop {
            let element = builder.stop_element(sheet)?;
            builder.parts.push(Part { k: self.stop - 1, low: 0.0, high: 0.0, element });
        }
        sequence.push(builder.parts.len());
        let assembly = Assembly::new().unit_nm(self.unit_nm);
        let assembly = builder.parts.iter().fold(assembly, |all, part| all.add(part.element.clone()));
        let image = builder.image()?;
        let Builder { radii, lenses, .. } = builder;
        Ok(PrescriptionLayout {
            assembly: assembly.add(image),
            stop,
            lenses,
            sequence,
            semi_diameters: radii,
        })
    }

    /// The clear semi-diameters: the stated ones, otherwise the extent of the real rays of all fields and
    /// wavelengths through centre and rim of the entrance pupil and of the stop. The last is that of the
    /// image.
    pub(crate) fn semi_diameters(&self, resolved: &Resolved) -> Result<Vec<f64>, PrescriptionError> {
        let mut needed = vec![0.0_f64; resolved.vertices.len()];
        let mut lost = None;
        for field in 0..self.fields.len() {
            for line in &self.lines {
                let rim: Vec<[f64; 2]> = rim().collect();
                let mut beams = vec![self.beam(field, line.wavelength_nm, &rim)?];
                // if aiming at the rim of the stop fails, only the rays through the entrance pupil are used
                beams.extend(self.beam_at_stop(field, line.wavelength_nm, &rim));
                for ray in beams.iter().flat_map(|beam| (0..beam.len()).map(|k| beam.get(k).ray)) {
                    // lost rays are ignored
                    let followed = self.follow_resolved(resolved, &ray, line.wavelength_nm);
                    let passes = followed.unwrap_or_else(|error| {
                        lost = Some(error);
                        Vec::new()
                    });
                    for (k, (radius, pass)) in needed.iter_mut().zip(&passes).enumerate() {
                        let at = resolved.local(k, pass.point);
                        *radius = radius.max(libm::hypot(at.x, at.y));
                    }
                }
            }
        }
        // no ray arrived anywhere: an error, not a semi-diameter of 0
        if let Some(error) = lost.filter(|_| needed.iter().all(|&radius| radius == 0.0)) {
            return Err(error);
        }
        let image = self.surfaces.len();
        let widest = needed[..image].iter().fold(0.0_f64, |widest, &radius| widest.max(radius));
        let stated = |k: usize| match self.surfaces.get(k) {
            Some(surface) => surface.semi_diameter.unwrap_or(SPARE * needed[k]),
            None => self.image.semi_diameter.unwrap_or((2.0 * needed[k]).max(0.1 * widest)),
        };
        (0..=image).map(|k| positive(format!("the semi-diameter of surface {}", k + 1), stated(k))).collect()
    }
}

/// Centre and rim of the pupil.
fn rim() -> impl Iterator<Item = [f64; 2]> {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let diagonal = [[half, half], [half, -half], [-half, half], [-half, -half]];
    [[0.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 0.0], [-1.0, 0.0]].into_iter().chain(diagonal)
}

/// An element and its extent along the axis of a surface.
struct Part {
    k: usize,
    low: f64,
    high: f64,
    element: Element,
}

struct Builder<'a> {
    lens: &'a Prescription,
    resolved: &'a Resolved,
    radii: Vec<f64>,
    extents: Extents,
    parts: Vec<Part>,
    lenses: Vec<LensOutline>,
}

/// A placed surface: number from 0, vertex, form, semi-diameter.
#[derive(Clone)]
struct Placed {
    k: usize,
    vertex: f64,
    form: SurfaceForm,
    reach: f64,
}

impl Placed {
    fn z(&self, place: [f64; 2]) -> Option<f64> {
        Some(self.vertex + self.form.sag(place)?)
    }

    /// The heights on a circle about the axis; `None` beyond the end of the surface.
    fn around(&self, radius: f64) -> Option<Vec<f64>> {
        self.form.directions().map(|[x, y]| self.z([radius * x, radius * y])).collect()
    }

    /// The plane at the mean height of its rim.
    fn rim(&self) -> Option<Placed> {
        let heights = self.around(self.reach)?;
        let vertex = heights.iter().sum::<f64>() / heights.len() as f64;
        Some(Placed { vertex, form: Asphere::conic(f64::INFINITY, 0.0).into(), ..self.clone() })
    }
}

impl Builder<'_> {
    fn placed(&self, k: usize) -> Placed {
        let form = self.resolved.forms[k].clone();
        Placed { k, vertex: self.resolved.vertices[k], form, reach: self.radii[k] }
    }

    /// Both surfaces of the space behind a surface, in the order of z.
    fn ends(&self, k: usize) -> [Placed; 2] {
        let (here, next) = (self.placed(k), self.placed(k + 1));
        if self.resolved.forward[k + 1] { [here, next] } else { [next, here] }
    }

    /// Checks the space behind a surface. If the surfaces intersect only in the spare width beyond all rays,
    /// their semi-diameters are reduced to the intersection.
    fn open_gap(&mut self, k: usize) -> Result<(), PrescriptionError> {
        let checked = self.check_gap(k);
        let Err(PrescriptionError::Cross { height, .. }) = checked else { return checked };
        let narrower = if self.radii[k] <= self.radii[k + 1] { k } else { k + 1 };
        let is_stated = |surface: &Surface| surface.semi_diameter.is_some();
        if self.lens.surfaces.get(narrower).is_none_or(is_stated) || SPARE * height < self.radii[narrower] {
            return checked;
        }
        self.radii[narrower] = height * (1.0 - 1e-9);
        self.check_gap(k)
    }

    /// Reports an error if the surfaces on both sides of a space intersect within both semi-diameters.
    fn check_gap(&self, k: usize) -> Result<(), PrescriptionError> {
        for placed in [self.placed(k), self.placed(k + 1)] {
            if let Some(limit) = placed.form.end_within(placed.reach) {
                return Err(PrescriptionError::TooLarge {
                    surface: placed.k + 1,
                    reach: placed.reach,
                    limit,
                });
            }
        }
        if k + 1 == self.lens.surfaces.len() && self.resolved.media[k + 1] == Medium::vacuum() {
            return Ok(());
        }
        if !self.resolved.are_aligned(k, k + 1) {
            return Ok(());
        }
        let [low, high] = self.ends(k);
        let reach = low.reach.min(high.reach);
        let directions: Vec<_> = low.form.directions().chain(high.form.directions()).collect();
        let gap = |height: f64| {
            let gaps = directions.iter().map(|[x, y]| [height * x, height * y]);
            gaps.filter_map(|place| Some(high.z(place)? - low.z(place)?)).reduce(f64::min)
        };
        let is_open =
            |height: &f64| gap(*height).is_some_and(|gap| gap < -1e-12 * (reach + low.vertex.abs()));
        // a scan, then bisection for the height at which the surfaces cross
        let wrong = (0..=64).map(|step| reach * f64::from(step) / 64.0).find(is_open);
        match wrong {
            None => Ok(()),
            Some(wrong) => {
                let (mut good, mut bad) = ((wrong - reach / 64.0).max(0.0), wrong);
                for _ in 0..60 {
                    let middle = 0.5 * (good + bad);
                    if gap(middle).is_some_and(|gap| gap < 0.0) { bad = middle } else { good = middle }
                }
                let (first, second, is_computed) = (k + 1, k + 2, false);
                Err(PrescriptionError::Cross { first, second, height: bad, reach, is_computed })
            }
        }
    }

    /// Adds the part that begins at a surface; returns the element that light reaches there.
    fn surface(&mut self, k: usize) -> Result<Option<usize>, PrescriptionError> {
        let surface = &self.lens.surfaces[k];
        if surface.behind == Behind::Mirror {
            return self.mirror(k, surface).map(Some);
        }
        if self.resolved.media[k + 1] != Medium::vacuum() {
            return self.lens(k).map(Some);
        }
        // into air: light leaves the lens in front
        let inside = k > 0 && self.resolved.media[k] != Medium::vacuum();
        if inside { self.lens(k - 1).map(Some) } else { Ok(None) }
    }

    /// Adds a part unless it exists already; returns its number.
    fn put(&mut self, part: Part) -> usize {
        let span = part.high - part.low;
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * span;
        let is_lens = |name: &str| name.starts_with("lens");
        let known = self.parts.iter().position(|other| {
            same(other.low, part.low)
                && same(other.high, part.high)
                && self.resolved.are_aligned(other.k, part.k)
                && is_lens(other.element.name()) == is_lens(part.element.name())
        });
        known.unwrap_or_else(|| {
            self.parts.push(part);
            self.parts.len() - 1
        })
    }

    /// The lens between a surface and the next one.
    fn lens(&mut self, k: usize) -> Result<usize, PrescriptionError> {
        if !self.resolved.are_aligned(k, k + 1) {
            return Err(PrescriptionError::Tilted { first: k + 1, second: k + 2 });
        }
        let [low, high] = self.ends(k);
        if low.vertex >= high.vertex {
            let name = format!("the thickness behind surface {}", k + 1);
            let range = "greater than 0 in a lens, or less than 0 where light travels back";
            return Err(bad(name, self.lens.surfaces[k].thickness, range));
        }
        let name = format!("lens {}-{}", k + 1, k + 2);
        let wrong = |problem| prescription_error(problem, k);
        let (solid, has_flat) = body(&low, &high).map_err(wrong)?;
        let (reach, edge) = (low.reach.max(high.reach), self.edge(k)?);
        let ends = [&low, &high].map(|side| if has_flat { side.reach } else { reach });
        self.extents.add_lens([(low.k, ends[0]), (high.k, ends[1])], reach.max(edge));
        let (solid, ends) = match edge > reach {
            true => with_rim(solid, [&low, &high], (ends, edge)).map_err(wrong)?,
            false => (solid, ends),
        };
        let mut element = Element::transparent(&name, self.at_pose(k, solid), &self.resolved.media[k + 1])
            .face("edge", Finish::Absorber);
        if has_flat {
            let flat = if low.reach > high.reach { "back" } else { "front" };
            element = element.face(&format!("{name}.flat.{flat}.plane"), Finish::Absorber);
        }
        if edge > reach {
            element = element.face(RIM, Finish::Absorber);
        }
        let count = self.parts.len();
        let number = self.put(Part { k, low: low.vertex, high: high.vertex, element });
        if self.parts.len() > count {
            let (surfaces, thickness) = ([low.k, high.k], high.vertex - low.vertex);
            self.lenses.push(LensOutline { name, surfaces, ends, semi_diameter: reach.max(edge), thickness });
        }
        Ok(number)
    }

    /// The greatest stated mechanical semi-diameter of the lens behind surface `k`; 0 without one.
    fn edge(&self, k: usize) -> Result<f64, PrescriptionError> {
        let mut edge = 0.0_f64;
        for number in [k, k + 1] {
            let stated = self.lens.surfaces.get(number).and_then(|surface| surface.mechanical_semi_diameter);
            if let Some(stated) = stated {
                edge = edge.max(positive(
                    format!("the mechanical semi-diameter of surface {}", number + 1),
                    stated,
                )?);
            }
        }
        Ok(edge)
    }

    fn mirror(&mut self, k: usize, surface: &Surface) -> Result<usize, PrescriptionError> {
        let (placed, faces_back) = (self.placed(k), !self.resolved.forward[k]);
        let heights = placed.around(placed.reach).unwrap_or_default();
        let rims: Vec<f64> = heights.iter().map(|z| z - placed.vertex).collect();
        let towards = rims.iter().map(|rim| if faces_back { -rim } else { *rim });
        let towards_substrate = towards.fold(0.0, f64::max);
        let thickness = towards_substrate + 2.0 * SUBSTRATE * placed.reach;
        let blank = Blank::new(Aperture::circle(2.0 * placed.reach), thickness);
        let blank = if faces_back { blank.turned() } else { blank };
        let wrong = |problem| prescription_error(problem, k);
        let mut solid = freeform_mirror(&placed.form, &blank).map_err(wrong)?;
        if surface.hole > 0.0 {
            let bore = rod(
                2.0 * surface.hole,
                4.0 * (thickness + rims.iter().fold(0.0, |most: f64, rim| most.max(rim.abs()))),
            )
            .map_err(wrong)?;
            solid = solid - with_prefix(&bore, "hole");
        }
        // the default finish is a mirror and exceptions are named: where the reflecting face coincides with a
        // face of a lens, as on the back of a meniscus, it may carry that face's name
        let name = format!("mirror {}", k + 1);
        let mut element = Element::mirror(&name, self.at_pose(k, solid.translate(Vec3::Z * placed.vertex)))
            .face(&format!("{name}.back.plane"), Finish::Absorber)
            .face(&format!("{name}.edge.side"), Finish::Absorber);
        if surface.hole > 0.0 {
            element = element.face(&format!("{name}.hole.edge.side"), Finish::Absorber);
        }
        let (low, high) = if faces_back { (-thickness, 0.0) } else { (0.0, thickness) };
        Ok(self.put(Part { k, low: placed.vertex + low, high: placed.vertex + high, element }))
    }

    /// Moves a solid on the axis by the pose of surface `k`.
    fn at_pose(&self, k: usize, solid: Solid) -> Solid {
        match self.resolved.poses.get(k) {
            Some(pose) => solid.apply(pose.to_world()),
            None => solid,
        }
    }

    /// The placement of a surface with its vertex at the origin.
    fn place(&self, placed: &Placed) -> Affine {
        let on_axis = Affine::translate(Vec3::Z * placed.vertex);
        self.resolved.poses.get(placed.k).map_or(on_axis, |pose| on_axis.then(&pose.to_world()))
    }

    /// A sheet of the stop, which absorbs the light.
    fn stop_element(&self, sheet: &StopSheet) -> Result<Element, PrescriptionError> {
        let k = self.lens.stop - 1;
        let made = sheet.sheet(&self.place(&self.placed(k)));
        let made = made.map_err(|problem| prescription_error(problem, k))?;
        Ok(Element::sheet(sheet.name, made, Action::Absorb))
    }

    fn image(&self) -> Result<Element, PrescriptionError> {
        let k = self.lens.surfaces.len();
        let placed = self.placed(k);
        let wrong = |problem| prescription_error(problem, k);
        let sheet =
            Sheet::conic(self.lens.image.radius, self.lens.image.conic, Aperture::circle(2.0 * placed.reach));
        let sheet = sheet.map_err(wrong)?.apply(&self.place(&placed)).map_err(wrong)?;
        Ok(Element::sheet(IMAGE, sheet, Action::Record))
    }
}

/// The solid between two surfaces, and whether it needs a flat rim.
fn body(low: &Placed, high: &Placed) -> Result<(Solid, bool), ComponentError> {
    let reach = low.reach.max(high.reach);
    let whole = between(low, high, reach);
    let narrow = low.reach.min(high.reach);
    let flat = if low.reach > high.reach {
        (Some(low.clone()), high.rim())
    } else {
        (low.rim(), Some(high.clone()))
    };
    match flat {
        (Some(front), Some(back)) if ends_early(&whole) && narrow < reach => {
            let core = between(low, high, narrow)?;
            let ring = between(&front, &back, reach)? - bore(&front, &back, narrow, reach)?;
            Ok((core | with_prefix(&ring, "flat"), true))
        }
        _ => Ok((whole?, false)),
    }
}

/// True if two surfaces do not reach as far as their solid.
fn ends_early(made: &Result<Solid, ComponentError>) -> bool {
    matches!(made, Err(ComponentError::ApertureTooLarge { .. } | ComponentError::SurfacesCross { .. }))
}

/// A lens with a ring around it up to the semi-diameter `edge`, and the semi-diameters at which its surfaces then end. `ends` are
/// those of the lens. On each side the ring continues the surface or, where that does not reach the edge, is flat.
fn with_rim(
    lens: Solid,
    [low, high]: [&Placed; 2],
    (ends, edge): ([f64; 2], f64),
) -> Result<(Solid, [f64; 2]), ComponentError> {
    let reach = ends[0].max(ends[1]);
    let planes =
        [(low, ends[0]), (high, ends[1])].map(|(side, reach)| Placed { reach, ..side.clone() }.rim());
    let depth =
        |k: usize, side: &Placed| planes[k].as_ref().map_or(0.0, |rim| (rim.vertex - side.vertex).abs());
    // the side that is flat already, or the deeper one, first
    let is_low_first = match ends[0] == ends[1] {
        true => depth(0, low) >= depth(1, high),
        false => ends[0] < ends[1],
    };
    let one = [is_low_first, !is_low_first];
    let ways = match ends[0] == ends[1] {
        true => vec![[false; 2], one, [true; 2]],
        false => vec![one, [true; 2]],
    };
    let mut problem = None;
    for is_flat in ways {
        let side = |k: usize, own: &Placed| if is_flat[k] { planes[k].clone() } else { Some(own.clone()) };
        let (Some(front), Some(back)) = (side(0, low), side(1, high)) else { continue };
        let made = between(&front, &back, edge);
        if ends_early(&made) {
            problem = Some(made);
            continue;
        }
        let ring = made? - bore(&front, &back, reach, edge)?;
        let ends = [0, 1].map(|k| if is_flat[k] { ends[k] } else { edge });
        return Ok((lens | with_prefix(&ring, RIM), ends));
    }
    // both planes are apart where the lens ends: only a surface without a plane comes here
    problem.unwrap_or(Ok(lens)).map(|lens| (lens, ends))
}

/// The core that a ring around a lens is without.
fn bore(front: &Placed, back: &Placed, radius: f64, edge: f64) -> Result<Solid, ComponentError> {
    let length = 4.0 * (edge + (back.vertex - front.vertex).abs());
    Ok(rod(2.0 * radius, length)?.translate(Vec3::Z * front.vertex).named("bore"))
}

fn between(low: &Placed, high: &Placed, reach: f64) -> Result<Solid, ComponentError> {
    let thickness = high.vertex - low.vertex;
    let aperture = Aperture::circle(2.0 * reach);
    let solid = freeform_lens(&low.form, &high.form, thickness, aperture)?;
    Ok(solid.translate(Vec3::Z * (low.vertex + 0.5 * thickness)))
}

/// Converts an error of a component; `k` is its first surface, counted from 0.
fn prescription_error(problem: ComponentError, k: usize) -> PrescriptionError {
    match problem {
        ComponentError::SurfacesCross { height, reach, .. } => {
            let (first, second, is_computed) = (k + 1, k + 2, false);
            PrescriptionError::Cross { first, second, height, reach, is_computed }
        }
        problem => PrescriptionError::Component { surface: k + 1, problem },
    }
}
