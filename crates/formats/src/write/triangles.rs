//! Mesh writer: each region as a closed triangle mesh within the tolerance.

use super::facets::{self, Frame, Request, Turned};
use super::films::films;
use super::fold::{Builder, Operation, check_count, fold};
use super::model::Model;
use super::remark::Remarks;
use super::{RemarkKind, WriteError, WriteOptions};
use crate::Format;
use crate::kernel::Body;
use rayweave_math::{Affine, Bounds, Vec3};
use rayweave_mesh::{Diagnosis, Mesh};
use rayweave_mesh_io::{MeshFormat, MeshWriteOptions, ThreeMfUnit, write_objects};
use rayweave_model::Boundary;
use rayweave_scene::{Colour, Unit};
use rayweave_shape::primitive::Primitive;
use std::cell::Cell;

/// Method of combining the shapes of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    /// Each shape as a body of facets.
    Bodies,
    /// Solids of revolution about a common axis by their profiles.
    Profiles,
}

/// A part of a region.
#[derive(Clone)]
enum Part {
    /// The clip box.
    Everything,
    Turned(Turned),
    Body(Box<Body>),
}

impl From<Body> for Part {
    fn from(body: Body) -> Part {
        Part::Body(Box::new(body))
    }
}

/// Builder of triangle bodies.
struct Triangulator<'m, 's> {
    model: &'m Model<'s>,
    region: usize,
    way: Way,
    /// Number of profiles that were combined.
    combined: usize,
    count: &'m TriangleCount,
}

/// Maximum number of triangles of the shapes of a model, apart from the largest shape, such as a large mesh that is converted to
/// another format. They take about 220 bytes each before the first boolean operation. 2,000 separate balls have about 2 million at the
/// default tolerance; copies that coincide have far more, because the tolerance follows the size of the model.
const MAX_TRIANGLES: usize = 3_000_000;

/// The triangles of the shapes of a model so far.
#[derive(Default)]
struct TriangleCount {
    all: Cell<usize>,
    largest: Cell<usize>,
}

impl TriangleCount {
    /// Adds a shape; true if the model has too many triangles.
    fn add(&self, triangles: usize) -> bool {
        self.all.set(self.all.get().saturating_add(triangles));
        self.largest.set(self.largest.get().max(triangles));
        self.all.get() - self.largest.get() > MAX_TRIANGLES
    }
}

impl<'m> Triangulator<'m, '_> {
    /// A body, if the model does not become too large with it.
    fn counted(&self, body: Option<Body>) -> Result<Option<Body>, WriteError> {
        match body.as_ref().is_some_and(|body| self.count.add(body.triangle_count())) {
            true => {
                let why = format!("the shapes of the model have more than {MAX_TRIANGLES} triangles");
                Err(WriteError::TooLarge { region: self.region(), why })
            }
            false => Ok(body),
        }
    }

    /// The error about triangles; a tolerance that needs too many of them is one of the options, not of the model.
    fn failed(&self, why: String) -> WriteError {
        match facets::is_too_fine(&why) {
            true => WriteError::TooLarge { region: self.region(), why },
            false => WriteError::Kernel { region: self.region(), why },
        }
    }

    fn frame(&self) -> Frame<'m> {
        Frame { clip: &self.model.clip, tolerance: self.model.tolerance }
    }

    fn body(&self, part: Part) -> Result<Option<Body>, String> {
        match part {
            Part::Everything => Ok(Some(Body::cuboid(&self.model.clip))),
            Part::Turned(turned) => turned.body(self.frame()),
            Part::Body(body) => Ok(Some(*body)),
        }
    }

    /// Combines the parts with the axis of the first solid of revolution, then the others as bodies.
    fn joined(&mut self, by: Operation, parts: Vec<Part>) -> Result<Option<Part>, String> {
        let frame = self.frame();
        // a difference is combined with its first part only
        let (axis, is_first) = match (&parts[..], by) {
            ([Part::Everything, Part::Turned(axis), ..], Operation::Difference) => (Some(axis.clone()), true),
            ([first, ..], Operation::Difference) => match first {
                Part::Turned(axis) => (Some(axis.clone()), true),
                _ => (None, false),
            },
            (all, _) => {
                let turned = all.iter().find_map(|part| match part {
                    Part::Turned(axis) => Some(axis.clone()),
                    _ => None,
                });
                (turned, false)
            }
        };
        let Some(axis) = axis else { return self.join_bodies(by, parts) };
        let (mut own, mut others) = (Vec::new(), Vec::new());
        for (number, part) in parts.into_iter().enumerate() {
            match part {
                Part::Everything if !is_first || number == 0 => own.push(Turned::everything(&axis, frame)),
                Part::Turned(turned) if turned.is_coaxial(&axis, frame) => own.push(turned),
                part => others.push(part),
            }
        }
        self.combined += own.len() - 1;
        let Some(own) = Turned::join(by, own, frame) else {
            return if by == Operation::Union { self.join_bodies(by, others) } else { Ok(None) };
        };
        if others.is_empty() {
            return Ok(Some(Part::Turned(own)));
        }
        others.insert(0, Part::Turned(own));
        self.join_bodies(by, others)
    }

    fn join_bodies(&self, by: Operation, parts: Vec<Part>) -> Result<Option<Part>, String> {
        let mut bodies = Vec::with_capacity(parts.len());
        for (number, part) in parts.into_iter().enumerate() {
            match (self.body(part)?, by) {
                (Some(body), _) => bodies.push(body),
                (None, Operation::Intersection) => return Ok(None),
                (None, Operation::Difference) if number == 0 => return Ok(None),
                (None, _) => {}
            }
        }
        Ok(match bodies.is_empty() {
            true => None,
            false => combine(by, bodies)?.map(Part::from),
        })
    }
}

impl Builder for Triangulator<'_, '_> {
    type Part = Part;

    fn clip(&self) -> Bounds {
        self.model.clip
    }

    fn everything(&mut self) -> Part {
        Part::Everything
    }

    fn leaf(
        &mut self,
        shape: &Primitive,
        place: &Affine,
        within: &Bounds,
    ) -> Result<Option<Part>, WriteError> {
        let failed = |why: String| match facets::is_too_fine(&why) {
            true => self.failed(why),
            false => self.failed(format!("`{}`: {why}", shape.name())),
        };
        if self.way == Way::Profiles
            && let Some(turned) = Turned::of(shape, place, self.frame()).map_err(failed)?
        {
            return Ok(Some(Part::Turned(turned)));
        }
        let clip = facets::clip_box(shape, &self.model.clip, within);
        let request = Request { shape, place, clip: &clip, tolerance: self.model.tolerance };
        let body = facets::body(&request).map_err(failed)?;
        Ok(self.counted(body)?.map(Part::from))
    }

    fn bounded(&mut self, boundary: &dyn Boundary, place: &Affine) -> Result<Option<Part>, WriteError> {
        let Some(facets) = boundary.facets(facets::tolerance_within(place, self.model.tolerance)) else {
            return Ok(None);
        };
        let body = Body::from_facets(facets).map_err(|why| self.failed(why))?;
        let body = body.map_or(Ok(None), |body| body.placed(place)).map_err(|why| self.failed(why))?;
        Ok(self.counted(body)?.map(Part::from))
    }

    fn join(&mut self, by: Operation, parts: Vec<Part>) -> Result<Option<Part>, WriteError> {
        self.joined(by, parts).map_err(|why| self.failed(why))
    }

    fn region(&self) -> String {
        self.model.scene.regions[self.region].name.clone()
    }
}

/// The boolean of one or more bodies.
fn combine(operation: Operation, mut parts: Vec<Body>) -> Result<Option<Body>, String> {
    match operation {
        Operation::Union => Body::union_all(parts),
        Operation::Difference => {
            let first = parts.remove(0);
            match Body::union_all(parts)? {
                Some(others) => first.difference(&others),
                None => Ok(Some(first)),
            }
        }
        Operation::Intersection => {
            let mut parts = parts.into_iter();
            let mut rest = parts.next();
            for part in parts {
                rest = match rest {
                    Some(rest) => rest.intersection(&part)?,
                    None => None,
                };
            }
            Ok(rest)
        }
    }
}

/// The solid of a region before subtractions, and whether profiles were combined.
fn solid(
    model: &Model,
    region: usize,
    way: Way,
    count: &TriangleCount,
) -> Result<(Option<Part>, bool), WriteError> {
    let own = &model.scene.regions[region];
    check_count(&own.solid, &own.name)?;
    let mut builder = Triangulator { model, region, way, combined: 0, count };
    let part = fold(&own.solid, &mut builder)?;
    Ok((part, builder.combined > 0))
}

/// The solids of all regions before subtractions.
struct Solids {
    parts: Vec<Option<Part>>,
    way: Way,
    /// True if profiles were combined, or can be.
    has_profiles: bool,
}

impl Solids {
    fn of(model: &Model, way: Way) -> Result<Solids, WriteError> {
        let (mut parts, mut has_profiles, count) = (Vec::new(), false, TriangleCount::default());
        for region in 0..model.scene.regions.len() {
            let (part, has_some) = solid(model, region, way, &count)?;
            parts.push(part);
            has_profiles |= has_some;
        }
        // those of different regions
        has_profiles |= parts.iter().flatten().filter(|part| matches!(part, Part::Turned(_))).count() > 1;
        Ok(Solids { parts, way, has_profiles })
    }

    /// The solids as bodies.
    fn bodies(&self, model: &Model) -> Result<Vec<Option<Body>>, WriteError> {
        let count = TriangleCount::default();
        let body = |(region, part): (usize, &Option<Part>)| {
            let builder = Triangulator { model, region, way: self.way, combined: 0, count: &count };
            let body = part.clone().map_or(Ok(None), |part| builder.body(part));
            body.map_err(|why| builder.failed(why))
        };
        self.parts.iter().enumerate().map(body).collect()
    }
}

/// The mesh of a body with its name and its defects.
pub(super) struct Made {
    pub name: String,
    pub mesh: Mesh,
    pub diagnosis: Diagnosis,
}

/// The defects of a mesh. Faces that overlap in one plane within rounding are among the overlaps.
fn diagnosed(mesh: &Mesh) -> Diagnosis {
    let mut diagnosis = mesh.diagnose();
    if diagnosis.overlaps.is_empty() {
        diagnosis.overlaps = films(mesh);
    }
    diagnosis
}

/// True if all meshes are sound, or so flat that they are left out.
fn is_sound(all: &[Made]) -> bool {
    all.iter().all(|one| one.diagnosis.is_sound() || one.mesh.is_flat())
}

/// Bodies as meshes. If one of them is not sound, solids of revolution are combined by their profiles instead; that takes longer, and
/// equal circles of neighbouring regions may have different facets.
fn sound(
    model: &Model,
    combined: impl Fn(&Model, &Solids) -> Result<Vec<(String, Body)>, WriteError>,
) -> Result<Vec<Made>, WriteError> {
    let made = |solids: &Solids| -> Result<Vec<Made>, WriteError> {
        let bodies = combined(model, solids)?.into_iter();
        let meshes = bodies.map(|(name, body)| match body.mesh() {
            Ok(mesh) => Ok(Made { diagnosis: diagnosed(&mesh), name, mesh }),
            Err(why) => Err(WriteError::Kernel { region: name, why }),
        });
        meshes.collect()
    };
    let first = made(&Solids::of(model, Way::Bodies)?)?;
    if is_sound(&first) {
        return Ok(first);
    }
    let again = Solids::of(model, Way::Profiles).and_then(|solids| match solids.has_profiles {
        true => made(&solids).map(Some),
        false => Ok(None),
    });
    // the defects of the usual way are reported if there is no better one
    Ok(again.ok().flatten().filter(|again| is_sound(again)).unwrap_or(first))
}

/// Meshes of all regions.
pub(super) fn meshes(model: &Model) -> Result<Vec<Made>, WriteError> {
    sound(model, apart)
}

/// The bodies of all regions, with their names, minus later ones.
fn apart(model: &Model, solids: &Solids) -> Result<Vec<(String, Body)>, WriteError> {
    let solids = solids.bodies(model)?;
    let mut bodies = Vec::new();
    for (number, region) in model.regions() {
        let Some(body) = &solids[number] else { continue };
        let cutters = model.later[number].iter().filter_map(|k| solids[*k].clone()).collect();
        let failed = |why| WriteError::Kernel { region: region.name.clone(), why };
        let rest = match Body::union_all(cutters).map_err(failed)? {
            Some(cutters) => body.difference(&cutters).map_err(failed)?,
            None => Some(body.clone()),
        };
        bodies.extend(rest.map(|body| (region.name.clone(), body)));
    }
    Ok(bodies)
}

/// All regions as one body: the solids are united before any subtraction, so that no coincident cut faces arise, and
/// regions of the world's medium are subtracted. Solids of revolution that touch are united by their profiles, if they have any: equal
/// circles of two regions may have different facets.
fn whole(model: &Model, solids: &Solids) -> Result<Vec<(String, Body)>, WriteError> {
    let (mut together, count) = (Vec::new(), TriangleCount::default());
    let mut builder = Triangulator { model, region: 0, way: solids.way, combined: 0, count: &count };
    for (number, (region, part)) in model.scene.regions.iter().zip(&solids.parts).enumerate() {
        builder.region = number;
        let Some(part) = part.clone() else { continue };
        if region.medium != 0 {
            together.push(part);
        } else if !together.is_empty()
            && let Some(all) = builder.join(Operation::Union, std::mem::take(&mut together))?
        {
            together.extend(builder.join(Operation::Difference, vec![all, part])?);
        }
    }
    if together.is_empty() {
        return Ok(Vec::new());
    }
    let failed = |why| WriteError::Kernel { region: WHOLE.to_owned(), why };
    let all = builder.joined(Operation::Union, together).map_err(failed)?;
    let body = all.map_or(Ok(None), |all| builder.body(all)).map_err(failed)?;
    Ok(body.into_iter().map(|body| (WHOLE.to_owned(), body)).collect())
}

/// The name of all regions as one body in messages.
const WHOLE: &str = "model";

/// The union of all regions for a format without regions. If no way gives a sound mesh, the regions are shells of their own, each with a
/// sound mesh: slicers and other programs accept shells that touch.
fn united(model: &Model, options: &WriteOptions, remarks: &mut Remarks) -> Result<Vec<Made>, WriteError> {
    let division = "the division into regions: the file contains one body, their union; 3MF, OBJ and glTF keep the regions apart";
    let one = sound(model, whole);
    if one.as_ref().is_ok_and(|one| is_sound(one)) {
        remarks.add(RemarkKind::Dropped, division);
        return one;
    }
    match meshes(model) {
        Ok(regions) if is_sound(&regions) => {
            remarks.add(
                RemarkKind::Dropped,
                "the names of regions: each region is a closed shell of its own, because facets of regions that touch do not match \
                 and their union has no sound mesh at this tolerance; 3MF, OBJ and glTF keep the regions apart",
            );
            model.remark_on_cuts(remarks);
            Ok(regions)
        }
        // the error about this mesh names the region
        Ok(regions) if !options.allow_unsound => Ok(regions),
        _ => {
            remarks.add(RemarkKind::Dropped, division);
            one
        }
    }
}

pub(super) fn write(
    model: &Model,
    format: MeshFormat,
    options: &WriteOptions,
    remarks: &mut Remarks,
) -> Result<Vec<u8>, WriteError> {
    let is_plain =
        matches!(format, MeshFormat::Ply | MeshFormat::Off) || format == MeshFormat::Stl && !options.text;
    let all = if is_plain && model.regions().count() > 1 {
        united(model, options, remarks)?
    } else {
        model.remark_on_cuts(remarks);
        meshes(model)?
    };
    remark_on_format(model, format, options, remarks);
    let mut parts = Vec::new();
    for Made { name, mesh, diagnosis } in &all {
        let failed = |why: String| WriteError::Kernel { region: name.clone(), why };
        let mapped = |mesh: &Mesh, map: &dyn Fn(Vec3) -> Vec3| {
            mesh.mapped(map).map_err(|error| failed(error.to_string()))
        };
        let written = mapped(mesh, &|p| in_format(p, format, model))?;
        let in_file = mapped(&written, &|p| in_precision(p, format, options))?;
        // such as a volume that its daughters fill: no reader accepts films of the thickness of rounding errors as a solid
        if in_file.is_flat() {
            let text = format!("`{name}` is left out: later regions cover all of its volume");
            remarks.add(RemarkKind::Changed, text);
            continue;
        }
        if !diagnosis.is_sound() {
            if !options.allow_unsound {
                return Err(WriteError::unsound(name, diagnosis));
            }
            remarks.add(RemarkKind::Approximated, format!("the mesh of `{name}` is not sound: {diagnosis}"));
        } else if is_single(format, options) {
            let rounded = in_file.diagnose();
            if !rounded.is_sound() {
                let text = format!("`{name}`, whose mesh is not sound in single precision: {rounded}");
                remarks.add(RemarkKind::Approximated, text);
            }
        }
        parts.push((name.as_str(), written));
    }
    if parts.is_empty() {
        let is_covered = model.later.iter().any(|later| !later.is_empty());
        return Err(match model.is_empty || is_covered {
            true => WriteError::Empty(Format::Mesh(format)),
            false => WriteError::Vanished(model.tolerance),
        });
    }
    let parts: Vec<(&str, &Mesh)> = parts.iter().map(|(name, mesh)| (*name, mesh)).collect();
    let mut bytes = Vec::new();
    let write_options =
        MeshWriteOptions::default().with_text(options.text).with_unit(unit_of(format, model).1);
    write_objects(&parts, format, write_options, &mut bytes)?;
    Ok(bytes)
}

fn remark_on_format(model: &Model, format: MeshFormat, options: &WriteOptions, remarks: &mut Remarks) {
    if model.has_curved_faces {
        let (tolerance, unit) = (model.tolerance, model.scene.unit);
        let text = format!("curved faces, with triangles within {tolerance:.3e} {unit}");
        remarks.add_expected(RemarkKind::Approximated, text);
    }
    if is_single(format, options) {
        remarks.add_expected(RemarkKind::Approximated, "coordinates, in single precision");
    }
    model.remark_on_conversion(unit_of(format, model).0, remarks);
    // names of faces follow from the model, as do colours that are not stated
    let regions = &model.scene.regions;
    let is_usual = regions.iter().enumerate().all(|(k, region)| region.colour == Colour::numbered(k));
    let text = "colours and names of faces";
    match is_usual {
        true => remarks.add_expected(RemarkKind::Dropped, text),
        false => remarks.add(RemarkKind::Dropped, text),
    }
    model.remark_on_media(remarks);
    model.remark_on_pictures(remarks);
}

/// True for formats with coordinates in single precision.
fn is_single(format: MeshFormat, options: &WriteOptions) -> bool {
    matches!(format, MeshFormat::Gltf | MeshFormat::Glb) || format == MeshFormat::Stl && !options.text
}

/// A point as a reader will see it.
fn in_precision(p: Vec3, format: MeshFormat, options: &WriteOptions) -> Vec3 {
    let rounded = |x: f64| if is_single(format, options) { f64::from(x as f32) } else { x };
    Vec3::new(rounded(p.x), rounded(p.y), rounded(p.z))
}

/// The unit of lengths in a file, with that of a 3MF file: metres for glTF, the unit of the model for 3MF where the format has it,
/// else millimetres.
fn unit_of(format: MeshFormat, model: &Model) -> (Unit, ThreeMfUnit) {
    let unit = model.scene.unit;
    let own = match unit {
        Unit::Micrometre => ThreeMfUnit::Micron,
        Unit::Centimetre => ThreeMfUnit::Centimeter,
        Unit::Metre => ThreeMfUnit::Meter,
        Unit::Inch => ThreeMfUnit::Inch,
        Unit::Foot => ThreeMfUnit::Foot,
        Unit::Millimetre | Unit::Nanometre | Unit::Kilometre => ThreeMfUnit::Millimeter,
    };
    match format {
        MeshFormat::Gltf | MeshFormat::Glb => (Unit::Metre, ThreeMfUnit::default()),
        MeshFormat::ThreeMf if own != ThreeMfUnit::Millimeter => (unit, own),
        _ => (Unit::Millimetre, ThreeMfUnit::default()),
    }
}

/// A point in the unit and axes of the format: y is up in glTF.
fn in_format(p: Vec3, format: MeshFormat, model: &Model) -> Vec3 {
    let unit = unit_of(format, model).0;
    let p = match format {
        MeshFormat::Gltf | MeshFormat::Glb => Vec3::new(p.x, p.z, -p.y),
        _ => p,
    };
    // not a factor of nearly 1
    if unit == model.scene.unit { p } else { p * (model.scene.unit.metres() / unit.metres()) }
}
