//! GDML writer: solids, materials, and logical and physical volumes.
//!
//! *Source*: the schema of GDML 3.1.6 and the GDML User's Guide 2.7, as for the reader [`crate::gdml`], which reads this
//! output.
//!
//! All lengths are in millimetres. If the scene came from a GDML file and its table `[gdml]` still describes the same
//! regions, the file has the same volume hierarchy. Otherwise each region is a volume placed in a world, with the later
//! regions subtracted from it, because volumes must not overlap. Materials, properties and optical surfaces also come from
//! the table. Boxes, balls, ellipsoids, tubes, cones, tori and paraboloids are Geant4 solids if their map allows it, with a
//! `scaledSolid` for a scale along the axes of the shape; half-spaces are boxes as large as the world; other shapes with
//! planar faces are exact `tessellated` solids, and all others are tessellated within the tolerance.

use super::facets::{self, Request, number};
use super::fold::{Builder, Operation, fold};
use super::model::Model;
use super::remark::Remarks;
use super::{RemarkKind, WriteError};
use crate::gdml::{NO_REGION, kept, stated};
use rayweave_math::{Affine, Bounds, Mat3, Vec3, any_perpendicular};
use rayweave_mesh::Mesh;
use rayweave_model::{Boundary, Motion, Solid, Swept};
use rayweave_scene::{Datum, Foreign};
use rayweave_shape::primitive::{Primitive, Value};
use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;

mod materials;
mod names;
mod tree;
mod writer;

use names::Names;
use writer::{Origin, Part, Structure, Writer, place_text};

/// Relative tolerance for perpendicular columns of a map.
const PERPENDICULAR: f64 = 1e-12;

pub(super) fn write(
    model: &Model,
    table: Option<&Foreign>,
    remarks: &mut Remarks,
) -> Result<Vec<u8>, WriteError> {
    let scale = model.millimetres();
    model.remark_on_unit(remarks);
    let table = table.and_then(|foreign| match &foreign.value.value {
        Datum::Table(table) => Some(table),
        _ => None,
    });
    let records = table.filter(|_| scale == 1.0).and_then(|table| stated::tree(table, model.scene));
    let records = records.filter(|records| tree::is_rigid(records));
    if records.is_none() {
        model.remark_on_cuts(remarks);
        if table.is_some() {
            remarks
                .add(RemarkKind::Dropped, "the volume tree, names of placements, skin and border surfaces");
        }
    }
    let clip = Bounds::new(scale * model.clip.lo, scale * model.clip.hi);
    let (defines, solids) = (String::new(), String::new());
    let (known, taken) = (HashMap::new(), HashSet::new());
    let mut origins: HashMap<String, Vec<Origin>> = HashMap::new();
    for row in table.map(|table| stated::rows(table, "solid")).unwrap_or_default() {
        let origin = Origin { row: row.clone(), solid: None, written: None };
        origins.entry(stated::text(row, "name").to_owned()).or_default().push(origin);
    }
    let mut writer =
        Writer { model, remarks, region: 0, scale, clip, defines, solids, count: 0, taken, origins, known };
    let names = Names::new(model);
    let room = records.as_ref().is_none_or(|records| records[0].solid.is_none());
    let needs = materials::Needs { room, all: records.is_none() };
    let materials = materials::materials(model, &names, table, needs, writer.remarks);
    let structure = match &records {
        Some(records) => writer.tree(records, table, &materials.names)?,
        None => writer.flat(&names, &materials.names)?,
    };
    writer.remarks.add(RemarkKind::Dropped, "names of faces");
    model.remark_on_pictures(writer.remarks);
    let Structure { volumes, world } = structure;
    let (defines, solids, more) =
        (writer.defines, writer.solids, table.map(materials::after).unwrap_or_default());
    Ok(format!(
        "{HEAD}  <define>\n{}{}{defines}  </define>\n  <materials>\n{}  </materials>\n  <solids>\n{solids}{}  </solids>\n  \
         <structure>\n{volumes}  </structure>\n{}  <setup name=\"Default\" version=\"1.0\">\n    \
         <world ref=\"{world}\"/>\n  </setup>\n</gdml>\n",
        materials.defines, more.defines, materials.text, more.surfaces, more.user
    )
    .into_bytes())
}

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gdml xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
xsi:noNamespaceSchemaLocation=\"http://service-spi.web.cern.ch/service-spi/app/releases/GDML/schema/gdml.xsd\">\n";

/// Attributes with lengths in millimetres.
fn lengths<const N: usize>(all: [(&str, f64); N]) -> String {
    let attribute = |(name, length): (&str, f64)| format!(" {name}=\"{length:?}\"");
    all.map(attribute).concat() + " lunit=\"mm\""
}

const WHOLE_TURN: &str = " startphi=\"0\" deltaphi=\"360\" aunit=\"deg\"";

impl Writer<'_, '_> {
    fn failed(&self, why: String) -> WriteError {
        WriteError::Kernel { region: self.region(), why }
    }

    /// Writes a solid of one element and returns its name.
    fn solid(&mut self, tag: &str, attributes: &str) -> String {
        let name = self.name();
        let _ = writeln!(self.solids, "    <{tag} name=\"{name}\"{attributes}/>");
        name
    }

    fn name(&mut self) -> String {
        loop {
            self.count += 1;
            let name = format!("s{}", self.count);
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }

    /// One volume per region, with the later ones subtracted, in a world around them.
    fn flat(&mut self, names: &Names, media: &[String]) -> Result<Structure, WriteError> {
        let (mut volumes, mut placements, model) = (String::new(), String::new(), self.model);
        for (number, region) in model.regions() {
            let Some(part) = self.carved(number)? else { continue };
            let (name, material) = (&names.regions[number], &media[region.medium as usize]);
            let _ = writeln!(
                volumes,
                "    <volume name=\"{name}\">\n      <materialref ref=\"{material}\"/>\n      <solidref ref=\"{}\"/>\n      \
                 <auxiliary auxtype=\"Color\" auxvalue=\"{}\"/>\n    </volume>",
                part.solid, region.colour
            );
            let (position, rotation) = place_text(&part.place, true);
            let _ = writeln!(
                placements,
                "      <physvol name=\"{name}_placed\">\n        <volumeref ref=\"{name}\"/>{position}{rotation}\n      </physvol>"
            );
        }
        let (world, name) = (self.room(), &names.world);
        let _ = writeln!(
            volumes,
            "    <volume name=\"{name}\">\n      <materialref ref=\"{}\"/>\n      <solidref ref=\"{world}\"/>\n{placements}      \
             <auxiliary auxtype=\"{}\" auxvalue=\"{}\"/>\n    </volume>",
            media[0], NO_REGION[0], NO_REGION[1]
        );
        Ok(Structure { volumes, world: name.clone() })
    }

    /// A box about the origin that contains the whole model.
    fn room(&mut self) -> String {
        let half = self.clip.lo.abs().max(self.clip.hi.abs());
        self.solid("box", &lengths([("x", 2.0 * half.x), ("y", 2.0 * half.y), ("z", 2.0 * half.z)]))
    }

    fn carved(&mut self, number: usize) -> Result<Option<Part>, WriteError> {
        let Some(mut part) = self.whole(number)? else {
            return Ok(None);
        };
        for &later in &self.model.later[number] {
            if let Some(cutter) = self.whole(later)? {
                part = self.pair("subtraction", &part, &cutter);
            }
        }
        Ok(Some(part))
    }

    /// A region before subtractions, written once.
    fn whole(&mut self, number: usize) -> Result<Option<Part>, WriteError> {
        if let Some(known) = self.known.get(&number) {
            return Ok(known.clone());
        }
        let made = self.made(number)?;
        self.known.insert(number, made.clone());
        Ok(made)
    }

    fn made(&mut self, number: usize) -> Result<Option<Part>, WriteError> {
        self.region = number;
        let solid = &self.model.scene.regions[number].solid;
        match self.scale == 1.0 {
            true => fold(solid, self),
            false => fold(&solid.scale(Vec3::splat(self.scale)), self),
        }
    }

    /// A boolean of two solids, in the frame of the first.
    fn pair(&mut self, tag: &str, first: &Part, second: &Part) -> Part {
        let name = self.name();
        // rotations are invertible
        let inverse = first.place.inverse().unwrap_or(Affine::IDENTITY);
        let (position, rotation) = place_text(&second.place.then(&inverse), false);
        let _ = writeln!(
            self.solids,
            "    <{tag} name=\"{name}\">\n      <first ref=\"{}\"/>\n      <second ref=\"{}\"/>{position}{rotation}\n    </{tag}>",
            first.solid, second.solid
        );
        Part { solid: name, place: first.place }
    }

    fn cuboid(&mut self, bounds: &Bounds) -> Part {
        let size = bounds.size();
        let solid = self.solid("box", &lengths([("x", size.x), ("y", size.y), ("z", size.z)]));
        Part { solid, place: Affine::translate(bounds.centre()) }
    }

    /// The Geant4 solid that corresponds to a shape, if any: element, position in the frame of the shape, and scale.
    fn own(&mut self, shape: &Primitive, place: &Affine) -> Option<Part> {
        let (turn, s) = decomposed(&place.linear)?;
        let is_round = (s.x - s.y).abs() <= PERPENDICULAR * s.x;
        let is_even = is_round && (s.x - s.z).abs() <= PERPENDICULAR * s.x;
        let number = |name: &str| number(shape, name).filter(|number| number.is_finite());
        let mut centre = Vec3::ZERO;
        let mut scaled = None;
        let (tag, attributes) = match shape {
            Primitive::Sphere(_) if is_even => ("orb", lengths([("r", s.x * number("radius")?)])),
            Primitive::Sphere(_) => ellipsoid(s * number("radius")?),
            Primitive::Ellipsoid(_) => ellipsoid(s * radii(shape)?),
            Primitive::CentredBox(_) | Primitive::BoxFromCorners(_) => {
                let bounds = shape.lower().bounds;
                centre = bounds.centre();
                let size = s * bounds.size();
                ("box", lengths([("x", size.x), ("y", size.y), ("z", size.z)]))
            }
            Primitive::Cylinder(_) if !is_round => {
                let (r, h) = (number("radius")?, number("height")?);
                ("eltube", lengths([("dx", s.x * r), ("dy", s.y * r), ("dz", 0.5 * s.z * h)]))
            }
            Primitive::Cylinder(_)
            | Primitive::Cone(_)
            | Primitive::HalfSpace(_)
            | Primitive::Slab(_)
            | Primitive::Torus(_)
            | Primitive::Paraboloid(_)
            | Primitive::Quadric(_)
            | Primitive::Tube(_)
            | Primitive::Wedge(_)
            | Primitive::Prism(_)
            | Primitive::Convex(_)
            | Primitive::Mesh(_)
            | Primitive::Asphere(_)
            | Primitive::Biconic(_)
            | Primitive::Freeform(_) => {
                // a solid of revolution about z, scaled afterwards
                let own = if is_round { s } else { Vec3::ONE };
                scaled = (!is_round).then_some(s);
                let (tag, text, up) = self.revolved(shape, own)?;
                centre = Vec3::Z * up;
                (tag, text)
            }
        };
        let mut solid = self.solid(tag, &attributes);
        if let Some(s) = scaled {
            let name = self.name();
            let _ = writeln!(
                self.solids,
                "    <scaledSolid name=\"{name}\">\n      <solidref ref=\"{solid}\"/>\n      <scale name=\"{name}_scale\" x=\"{:?}\" \
                 y=\"{:?}\" z=\"{:?}\"/>\n    </scaledSolid>",
                s.x, s.y, s.z
            );
            solid = name;
        }
        let place = Affine { linear: turn, translation: place.point(centre) };
        Some(Part { solid, place })
    }

    /// A solid of revolution, scaled along and across z: the element, and the height of its centre.
    fn revolved(&self, shape: &Primitive, s: Vec3) -> Option<(&'static str, String, f64)> {
        let number = |name: &str| number(shape, name).filter(|number| number.is_finite());
        let tube = |inner: f64, outer: f64, height: f64| {
            let text =
                lengths([("rmin", s.x * inner), ("rmax", s.x * outer), ("z", s.z * height)]) + WHOLE_TURN;
            ("tube", text, 0.0)
        };
        Some(match shape {
            Primitive::Cylinder(_) => tube(0.0, number("radius")?, number("height")?),
            Primitive::Tube(_) => tube(number("inner_radius")?, number("outer_radius")?, number("height")?),
            Primitive::Cone(_) => {
                let [low, high] = [s.x * number("radius1")?, s.x * number("radius2")?];
                let z = s.z * number("height")?;
                let sizes = [("rmin1", 0.0), ("rmax1", low), ("rmin2", 0.0), ("rmax2", high), ("z", z)];
                ("cone", lengths(sizes) + WHOLE_TURN, 0.0)
            }
            Primitive::Torus(_)
                if number("major")? > number("minor")? && (s.x - s.z).abs() <= PERPENDICULAR * s.x =>
            {
                let (major, minor) = (s.x * number("major")?, s.x * number("minor")?);
                ("torus", lengths([("rmin", 0.0), ("rmax", minor), ("rtor", major)]) + WHOLE_TURN, 0.0)
            }
            Primitive::Paraboloid(_) => {
                let (focal, height) = (number("focal_length")?, number("height")?);
                let rim = s.x * 2.0 * libm::sqrt(focal * height);
                let sizes = [("rlo", 0.0), ("rhi", rim), ("dz", 0.5 * s.z * height)];
                ("paraboloid", lengths(sizes), 0.5 * height)
            }
            Primitive::Sphere(_)
            | Primitive::Ellipsoid(_)
            | Primitive::CentredBox(_)
            | Primitive::BoxFromCorners(_)
            | Primitive::HalfSpace(_)
            | Primitive::Slab(_)
            | Primitive::Torus(_)
            | Primitive::Quadric(_)
            | Primitive::Wedge(_)
            | Primitive::Prism(_)
            | Primitive::Convex(_)
            | Primitive::Mesh(_)
            | Primitive::Asphere(_)
            | Primitive::Biconic(_)
            | Primitive::Freeform(_) => return None,
        })
    }

    /// The part of the clip box below a plane, as a rotated larger box.
    fn half_space(&mut self, normal: Vec3, offset: f64) -> Option<Part> {
        let length = normal.length();
        let (normal, offset) = (normal / length, offset / length);
        let heights = self.clip.corners().map(|corner| normal.dot(corner));
        let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
        if lowest >= offset {
            return None;
        }
        let (depth, wide) = (1.25 * (offset - lowest), 2.0 * self.clip.size().length());
        let solid = self.solid("box", &lengths([("x", wide), ("y", wide), ("z", depth)]));
        let x = any_perpendicular(normal);
        let linear = Mat3::from_cols(x, normal.cross(x), normal);
        let middle = self.clip.centre();
        let translation = middle + normal * (offset - 0.5 * depth - normal.dot(middle));
        Some(Part { solid, place: Affine { linear, translation } })
    }

    fn tessellated(&mut self, mesh: &Mesh) -> Part {
        let name = self.name();
        for (k, p) in mesh.vertices().iter().enumerate() {
            let _ = writeln!(
                self.defines,
                "    <position name=\"{name}_{k}\" x=\"{:?}\" y=\"{:?}\" z=\"{:?}\" unit=\"mm\"/>",
                p.x, p.y, p.z
            );
        }
        let _ = writeln!(self.solids, "    <tessellated name=\"{name}\" aunit=\"deg\" lunit=\"mm\">");
        for [a, b, c] in mesh.triangles() {
            let _ = writeln!(
                self.solids,
                "      <triangular vertex1=\"{name}_{a}\" vertex2=\"{name}_{b}\" vertex3=\"{name}_{c}\" type=\"ABSOLUTE\"/>"
            );
        }
        let _ = writeln!(self.solids, "    </tessellated>");
        Part { solid: name, place: Affine::IDENTITY }
    }
}

fn ellipsoid(radii: Vec3) -> (&'static str, String) {
    ("ellipsoid", lengths([("ax", radii.x), ("by", radii.y), ("cz", radii.z)]))
}

fn radii(shape: &Primitive) -> Option<Vec3> {
    shape.arguments().into_iter().find_map(|(_, value)| match value {
        Value::Vector(radii) => <[f64; 3]>::try_from(radii).ok().map(Vec3::from_array),
        _ => None,
    })
}

/// Decomposition of a map into a scale along the axes and a rotation, for shapes that are symmetric in y; `None` if it
/// shears.
fn decomposed(linear: &Mat3) -> Option<(Mat3, Vec3)> {
    let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    let columns = [linear.x_axis, sign * linear.y_axis, linear.z_axis];
    let [x, y, z] = columns.map(Vec3::length);
    let lengths = Vec3::new(x, y, z);
    let is_right =
        |i: usize, j: usize| columns[i].dot(columns[j]).abs() <= PERPENDICULAR * lengths[i] * lengths[j];
    let turn = Mat3::from_cols(columns[0] / x, columns[1] / y, columns[2] / z);
    (is_right(0, 1) && is_right(1, 2) && is_right(2, 0)).then_some((turn, lengths))
}

impl Builder for Writer<'_, '_> {
    type Part = Part;

    fn clip(&self) -> Bounds {
        self.clip
    }

    fn everything(&mut self) -> Part {
        let clip = self.clip;
        self.cuboid(&clip)
    }

    /// The element of the original file, if it still gives the same solid.
    fn named(&mut self, name: &str, solid: &Solid, place: &Affine) -> Option<Part> {
        if !tree::is_orthogonal(&place.linear) || place.linear.determinant() < 0.0 {
            return None;
        }
        let candidates = self.origins.get_mut(name)?;
        let is_it = |origin: &mut Origin| {
            let made = origin.solid.get_or_insert_with(|| kept::solid(&origin.row));
            made.as_ref() == Some(solid)
        };
        let number = candidates.iter_mut().position(is_it)?;
        if let Some(written) = &candidates[number].written {
            return Some(Part { solid: written.clone(), place: *place });
        }
        let own = materials::escaped(name);
        let own = if self.taken.insert(own.clone()) { own } else { self.name() };
        let origin = self.origins.get_mut(name)?.get_mut(number)?;
        self.solids += &kept::written(&origin.row, &own, materials::escaped);
        origin.written = Some(own.clone());
        Some(Part { solid: own, place: *place })
    }

    /// A revolved outline of one contour as a `genericPolycone`.
    fn bounded(&mut self, boundary: &dyn Boundary, place: &Affine) -> Result<Option<Part>, WriteError> {
        let Some((turn, s)) = decomposed(&place.linear) else { return Ok(None) };
        let is_even = [s.x, s.y].iter().all(|own| (own - s.z).abs() <= PERPENDICULAR * s.z);
        let is_mirrored = place.linear.determinant() < 0.0;
        let tolerance = facets::tolerance_within(place, self.scale * self.model.tolerance);
        let Some(Swept { polygons, has_chords, motion: Motion::About { start, sweep } }) =
            boundary.swept(tolerance)
        else {
            return Ok(None);
        };
        // a mirror image, which `decomposed` omits, starts at another angle
        let is_similar = is_even && (sweep == 360.0 || !is_mirrored);
        let ([polygon], true) = (&polygons[..], is_similar) else { return Ok(None) };
        let name = self.name();
        let _ = writeln!(
            self.solids,
            "    <genericPolycone name=\"{name}\" startphi=\"{start:?}\" deltaphi=\"{sweep:?}\" aunit=\"deg\" lunit=\"mm\">"
        );
        for [r, z] in polygon {
            let _ = writeln!(self.solids, "      <rzpoint r=\"{:?}\" z=\"{:?}\"/>", s.z * r, s.z * z);
        }
        let _ = writeln!(self.solids, "    </genericPolycone>");
        if has_chords {
            let what = self.model.arcs_remark(self.region);
            self.remarks.add(RemarkKind::Approximated, what);
        }
        let place = Affine { linear: turn, translation: place.translation };
        Ok(Some(Part { solid: name, place }))
    }

    fn leaf(
        &mut self,
        shape: &Primitive,
        place: &Affine,
        within: &Bounds,
    ) -> Result<Option<Part>, WriteError> {
        let cut = facets::finite(shape, place, &self.clip);
        if let Some(part) = self.own(cut.as_ref().unwrap_or(shape), place) {
            return Ok(Some(part));
        }
        let lowered = shape.lower();
        let planes = facets::planes_of(&lowered);
        if let (Some([(normal, offset)]), false) = (planes.as_deref(), lowered.complement) {
            // the plane in the frame of the model
            let Ok(inverse) = place.inverse() else { return Ok(None) };
            let normal_there = inverse.linear.transpose() * *normal;
            return Ok(self.half_space(normal_there, offset + normal_there.dot(place.translation)));
        }
        if planes.is_none() && !matches!(shape, Primitive::Mesh(_)) {
            let what = self.model.triangles_remark(shape, self.region);
            self.remarks.add(RemarkKind::Approximated, what);
        }
        let tolerance = self.scale * self.model.tolerance;
        let clip = facets::clip_box(shape, &self.clip, within);
        let request = Request { shape, place, clip: &clip, tolerance };
        let named = |why: String| format!("`{}`: {why}", shape.name());
        let body = facets::body(&request).map_err(|why| self.failed(named(why)))?;
        let mesh = body.map(|body| body.mesh()).transpose().map_err(|why| self.failed(named(why)))?;
        Ok(mesh.map(|mesh| self.tessellated(&mesh)))
    }

    fn join(&mut self, by: Operation, mut parts: Vec<Part>) -> Result<Option<Part>, WriteError> {
        if by == Operation::Difference {
            let first = parts.remove(0);
            return Ok(Some(parts.iter().fold(first, |rest, part| self.pair("subtraction", &rest, part))));
        }
        let tag = if by == Operation::Union { "union" } else { "intersection" };
        // pairwise, to limit the nesting depth
        while parts.len() > 1 {
            parts = parts
                .chunks(2)
                .map(|pair| match pair {
                    [a, b] => self.pair(tag, a, b),
                    rest => rest[0].clone(),
                })
                .collect();
        }
        Ok(parts.pop())
    }

    fn region(&self) -> String {
        self.model.scene.regions[self.region].name.clone()
    }
}
