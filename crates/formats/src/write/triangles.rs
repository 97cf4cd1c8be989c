//! Mesh writer: each region as a closed triangle mesh within the tolerance.

use super::facets::{self, Request};
use super::fold::{Builder, Operation, check_count, fold};
use super::model::Model;
use super::remark::Remarks;
use super::{RemarkKind, WriteError, WriteOptions};
use crate::Format;
use crate::kernel::Body;
use rayweave_math::{Affine, Bounds, Vec3};
use rayweave_mesh::Mesh;
use rayweave_mesh_io::{MeshFormat, MeshWriteOptions, ThreeMfUnit, write_objects};
use rayweave_model::Boundary;
use rayweave_scene::{Colour, Unit};
use rayweave_shape::primitive::Primitive;
use std::cell::Cell;

/// Builder of triangle bodies.
struct Triangulator<'m, 's> {
    model: &'m Model<'s>,
    region: usize,
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

impl Triangulator<'_, '_> {
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

    fn failed(&self, why: String) -> WriteError {
        WriteError::Kernel { region: self.region(), why }
    }
}

impl Builder for Triangulator<'_, '_> {
    type Part = Body;

    fn clip(&self) -> Bounds {
        self.model.clip
    }

    fn everything(&mut self) -> Body {
        Body::cuboid(&self.model.clip)
    }

    fn leaf(
        &mut self,
        shape: &Primitive,
        place: &Affine,
        within: &Bounds,
    ) -> Result<Option<Body>, WriteError> {
        let clip = facets::clip_box(shape, &self.model.clip, within);
        let request = Request { shape, place, clip: &clip, tolerance: self.model.tolerance };
        let body = facets::body(&request).map_err(|why| self.failed(format!("`{}`: {why}", shape.name())))?;
        self.counted(body)
    }

    fn bounded(&mut self, boundary: &dyn Boundary, place: &Affine) -> Result<Option<Body>, WriteError> {
        let Some(facets) = boundary.facets(facets::tolerance_within(place, self.model.tolerance)) else {
            return Ok(None);
        };
        let body = Body::from_facets(facets).map_err(|why| self.failed(why))?;
        let body = body.map_or(Ok(None), |body| body.placed(place)).map_err(|why| self.failed(why))?;
        self.counted(body)
    }

    fn join(&mut self, by: Operation, parts: Vec<Body>) -> Result<Option<Body>, WriteError> {
        combine(by, parts).map_err(|why| self.failed(why))
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

/// The solid of a region before subtractions.
fn solid(model: &Model, region: usize, count: &TriangleCount) -> Result<Option<Body>, WriteError> {
    let own = &model.scene.regions[region];
    check_count(&own.solid, &own.name)?;
    fold(&own.solid, &mut Triangulator { model, region, count })
}

/// Meshes of all regions, with their names.
pub(super) fn meshes(model: &Model) -> Result<Vec<(String, Body)>, WriteError> {
    let (count, triangles) = (model.scene.regions.len(), TriangleCount::default());
    let solids: Vec<Option<Body>> =
        (0..count).map(|region| solid(model, region, &triangles)).collect::<Result<_, _>>()?;
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
/// regions of the world's medium are subtracted.
fn whole(model: &Model) -> Result<Option<Body>, WriteError> {
    let (mut together, triangles) = (Vec::new(), TriangleCount::default());
    for (number, region) in model.scene.regions.iter().enumerate() {
        let failed = |why| WriteError::Kernel { region: region.name.clone(), why };
        let Some(body) = solid(model, number, &triangles)? else { continue };
        if region.medium != 0 {
            together.push(body);
        } else if let Some(all) = Body::union_all(std::mem::take(&mut together)).map_err(failed)? {
            together.extend(all.difference(&body).map_err(failed)?);
        }
    }
    Body::union_all(together).map_err(|why| WriteError::Kernel { region: "model".to_owned(), why })
}

pub(super) fn write(
    model: &Model,
    format: MeshFormat,
    options: &WriteOptions,
    remarks: &mut Remarks,
) -> Result<Vec<u8>, WriteError> {
    let is_plain =
        matches!(format, MeshFormat::Ply | MeshFormat::Off) || format == MeshFormat::Stl && !options.text;
    let bodies = if is_plain && model.regions().count() > 1 {
        remarks.add(RemarkKind::Dropped, "the division into regions: the file contains one body");
        whole(model)?.into_iter().map(|body| (String::new(), body)).collect()
    } else {
        model.remark_on_cuts(remarks);
        meshes(model)?
    };
    remark_on_format(model, format, options, remarks);
    let mut parts = Vec::new();
    for (name, body) in &bodies {
        let failed = |why: String| WriteError::Kernel { region: name.clone(), why };
        let mesh = body.mesh().map_err(failed)?;
        let mapped = |mesh: &Mesh, map: &dyn Fn(Vec3) -> Vec3| {
            mesh.mapped(map).map_err(|error| failed(error.to_string()))
        };
        let written = mapped(&mesh, &|p| in_format(p, format, model))?;
        let in_file = mapped(&written, &|p| in_precision(p, format, options))?;
        // such as a volume that its daughters fill: no reader accepts films of the thickness of rounding errors as a solid
        if in_file.is_flat() {
            let text = format!("`{name}` is left out: later regions cover all of its volume");
            remarks.add(RemarkKind::Changed, text);
            continue;
        }
        let diagnosis = mesh.diagnose();
        if !diagnosis.is_sound() {
            if !options.allow_unsound {
                return Err(WriteError::unsound(name, &diagnosis));
            }
            remarks.add(RemarkKind::Approximated, format!("the mesh of `{name}` is not sound: {diagnosis}"));
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
