//! OpenSCAD writer: the flattened language, which OpenSCAD reads as a program and [`crate::openscad`] as a dump.
//!
//! Boxes, balls, cylinders, cones and tori are OpenSCAD items under `multmatrix`; shapes with planar faces are
//! `polyhedron`s. Outlines are `rotate_extrude` and `linear_extrude` of polygons, with chords for the arcs of revolutions. Round shapes stay exactly round for readers that support it; `$fn` is the number of facets required by the
//! tolerance. Other shapes are `polyhedron`s of triangles. The regions are the top-level items of the file, each with its
//! colour. If the scene is not in millimetres, the usual unit of OpenSCAD, each region is scaled to millimetres.

use super::facets::{self, Request, number};
use super::fold::{Builder, Operation, fold};
use super::model::Model;
use super::remark::Remarks;
use super::{RemarkKind, WriteError};
use rayweave_math::{Affine, Bounds, MAX_AROUND, Vec3};
use rayweave_mesh::Mesh;
use rayweave_model::{Boundary, Motion, Swept};
use rayweave_scene::Colour;
use rayweave_shape::primitive::{Primitive, Value};
use std::collections::{BTreeSet, HashMap};

/// Maximum number of bytes of a file; shared parts are repeated.
const MAX_BYTES: usize = 256 << 20;

/// A part of the file.
enum Piece {
    Text(String),
    Group(&'static str, Vec<usize>),
}

struct Writer<'m, 's> {
    model: &'m Model<'s>,
    remarks: &'m mut Remarks,
    region: usize,
    pieces: Vec<Piece>,
    /// Number of shapes so far that were cut to a box.
    cut: u32,
    /// The part of each region written so far.
    known: HashMap<usize, Option<usize>>,
}

pub(super) fn write(model: &Model, remarks: &mut Remarks) -> Result<Vec<u8>, WriteError> {
    model.remark_on_cuts(remarks);
    let mut writer = Writer { model, remarks, region: 0, pieces: Vec::new(), cut: 0, known: HashMap::new() };
    let mut text = String::new();
    let scale = model.millimetres();
    for (number, region) in model.regions() {
        let Some(part) = writer.carved(number)? else { continue };
        let Colour { red, green, blue, alpha } = region.colour;
        let level = |level: u8| f64::from(level) / 255.0;
        let colour = [red, green, blue, alpha].map(|own| format!("{:?}", level(own))).join(", ");
        text += &format!("color([{colour}]) {{\n");
        match scale == 1.0 {
            true => writer.print(part, 1, &mut text)?,
            false => {
                text += &format!("\tmultmatrix({}) {{\n", rows(&Affine::scale(Vec3::splat(scale))));
                writer.print(part, 2, &mut text)?;
                text += "\t}\n";
            }
        }
        text += "}\n";
    }
    model.remark_on_unit(writer.remarks);
    let names: BTreeSet<_> = model.regions().map(|(_, region)| region.colour.to_string()).collect();
    writer.remarks.add(RemarkKind::Dropped, "names of regions, media and faces");
    if names.len() < model.regions().count() {
        writer.remarks.add(RemarkKind::Changed, "regions with the same colour, which are united");
    }
    model.remark_on_media(writer.remarks);
    model.remark_on_pictures(writer.remarks);
    Ok(text.into_bytes())
}

/// Readers take circles with fewer facets, up to 8, for polygons.
const LEAST_AROUND: usize = 12;

impl Writer<'_, '_> {
    fn add(&mut self, piece: Piece) -> usize {
        self.pieces.push(piece);
        self.pieces.len() - 1
    }

    /// A region minus the later ones that may overlap it.
    fn carved(&mut self, number: usize) -> Result<Option<usize>, WriteError> {
        let Some(first) = self.solid(number)? else {
            return Ok(None);
        };
        let mut parts = vec![first];
        for &later in &self.model.later[number] {
            parts.extend(self.solid(later)?);
        }
        if parts.len() > 1 { self.join(Operation::Difference, parts) } else { Ok(parts.pop()) }
    }

    /// A region before subtractions.
    fn solid(&mut self, number: usize) -> Result<Option<usize>, WriteError> {
        if let Some(known) = self.known.get(&number) {
            return Ok(*known);
        }
        let made = self.made(number)?;
        self.known.insert(number, made);
        Ok(made)
    }

    fn made(&mut self, number: usize) -> Result<Option<usize>, WriteError> {
        self.region = number;
        fold(&self.model.scene.regions[number].solid, self)
    }

    /// Writes a part and its descendants, indented by a tab per level.
    fn print(&self, part: usize, level: usize, text: &mut String) -> Result<(), WriteError> {
        let mut waiting = vec![(Some(part), level)];
        while let Some((part, depth)) = waiting.pop() {
            let tabs = "\t".repeat(depth.min(32));
            match part.map(|part| &self.pieces[part]) {
                None => *text += &format!("{tabs}}}\n"),
                Some(Piece::Text(own)) => *text += &format!("{tabs}{own}\n"),
                Some(Piece::Group(name, parts)) => {
                    *text += &format!("{tabs}{name}() {{\n");
                    waiting.push((None, depth));
                    waiting.extend(parts.iter().rev().map(|part| (Some(*part), depth + 1)));
                }
            }
            if text.len() > MAX_BYTES {
                let why = format!("more than {} MiB of text", MAX_BYTES >> 20);
                return Err(WriteError::TooLarge { region: self.region(), why });
            }
        }
        Ok(())
    }

    /// Number of facets of a circle with the given radius in the frame of the shape.
    fn fragments(&self, place: &Affine, radius: f64) -> usize {
        let request = 0.5 * self.model.tolerance / place.similarity().unwrap_or(place.linear_norm());
        facets::circle_count(radius, request).unwrap_or(MAX_AROUND).max(LEAST_AROUND)
    }

    /// The box to which a shape is cut. Each unbounded shape with planar faces has a different box around the clip box: faces of
    /// boxes that coincide up to rounding would be ambiguous for readers.
    fn room(&mut self, shape: &Primitive) -> Bounds {
        let lowered = shape.lower();
        if lowered.bounds.is_finite() || facets::planes_of(&lowered).is_none() {
            return self.model.clip;
        }
        self.cut += 1;
        // multiples of the golden ratio modulo 1 stay apart from each other
        let share = (f64::from(self.cut) * 0.618_033_988_749_894_9).fract();
        self.model.clip.grown((0.05 + 0.5 * share) * self.model.clip.size().length())
    }

    fn plain(&self, shape: &Primitive, place: &Affine) -> Option<String> {
        let number = |name: &str| number(shape, name).filter(|number| number.is_finite());
        let round = |radius: f64| format!("$fn = {}, $fa = 12, $fs = 2", self.fragments(place, radius));
        let cylinder = |low: f64, high: f64, height: f64| {
            let round = round(low.max(high));
            format!("cylinder({round}, h = {height:?}, r1 = {low:?}, r2 = {high:?}, center = true);")
        };
        Some(match shape {
            Primitive::Sphere(_) => {
                let radius = number("radius")?;
                format!("sphere({}, r = {radius:?});", round(radius))
            }
            Primitive::Ellipsoid(_) => return self.ellipsoid(shape, place),
            Primitive::CentredBox(_) | Primitive::BoxFromCorners(_) => cuboid(&shape.lower().bounds),
            Primitive::Cylinder(_) => cylinder(number("radius")?, number("radius")?, number("height")?),
            Primitive::Cone(_) => cylinder(number("radius1")?, number("radius2")?, number("height")?),
            Primitive::Tube(_) => {
                let (inner, outer, height) =
                    (number("inner_radius")?, number("outer_radius")?, number("height")?);
                let body = cylinder(outer, outer, height);
                // the bore is longer than the body, so that its ends lie outside
                match inner > 0.0 {
                    true => format!("difference() {{ {body} {} }}", cylinder(inner, inner, 1.5 * height)),
                    false => body,
                }
            }
            Primitive::Torus(_) if number("major")? > number("minor")? => {
                let (major, minor) = (number("major")?, number("minor")?);
                let (around, across) = (round(major + minor), round(minor));
                let moved = rows(&Affine::translate(Vec3::X * major));
                format!(
                    "rotate_extrude(angle = 360, convexity = 2, {around}) {{ multmatrix({moved}) {{ circle({across}, r = {minor:?}); }} }}"
                )
            }
            Primitive::HalfSpace(_)
            | Primitive::Slab(_)
            | Primitive::Torus(_)
            | Primitive::Paraboloid(_)
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

    /// An ellipsoid: a ball scaled along the axes.
    fn ellipsoid(&self, shape: &Primitive, place: &Affine) -> Option<String> {
        let radii = shape.arguments().into_iter().find_map(|(_, value)| match value {
            Value::Vector(radii) => <[f64; 3]>::try_from(radii).ok(),
            _ => None,
        })?;
        let scaled = Affine::scale(Vec3::from_array(radii));
        let fragments = self.fragments(&scaled.then(place), 1.0);
        let ball = format!("sphere($fn = {fragments}, $fa = 12, $fs = 2, r = 1);");
        Some(under(&scaled, &ball))
    }
}

impl Builder for Writer<'_, '_> {
    type Part = usize;

    fn clip(&self) -> Bounds {
        self.model.clip
    }

    fn everything(&mut self) -> usize {
        let text = cuboid(&self.model.clip);
        self.add(Piece::Text(text))
    }

    fn leaf(
        &mut self,
        shape: &Primitive,
        place: &Affine,
        within: &Bounds,
    ) -> Result<Option<usize>, WriteError> {
        if let Some(text) = self.plain(shape, place) {
            return Ok(Some(self.add(Piece::Text(under(place, &text)))));
        }
        if let Primitive::Mesh(mesh) = shape {
            let text = polyhedron(&mesh.solid().to_mesh());
            return Ok(Some(self.add(Piece::Text(under(place, &text)))));
        }
        if let Some(text) =
            facets::finite(shape, place, &self.model.clip).and_then(|cut| self.plain(&cut, place))
        {
            return Ok(Some(self.add(Piece::Text(under(place, &text)))));
        }
        if facets::planes_of(&shape.lower()).is_none() {
            let what = self.model.triangles_remark(shape, self.region);
            self.remarks.add(RemarkKind::Approximated, what);
        }
        let clip = facets::clip_box(shape, &self.room(shape), within);
        let request = Request { shape, place, clip: &clip, tolerance: self.model.tolerance };
        let failed = |why: String| WriteError::Kernel {
            region: self.model.scene.regions[self.region].name.clone(),
            why: format!("`{}`: {why}", shape.name()),
        };
        let body = facets::body(&request).map_err(failed)?;
        let mesh = body.map(|body| body.mesh()).transpose().map_err(failed)?;
        Ok(mesh.map(|mesh| self.add(Piece::Text(polyhedron(&mesh)))))
    }

    /// An extruded or revolved outline. Prisms over arcs are written from their trees, which are exact.
    fn bounded(&mut self, boundary: &dyn Boundary, place: &Affine) -> Result<Option<usize>, WriteError> {
        let tolerance = facets::tolerance_within(place, self.model.tolerance);
        let Some(Swept { polygons, has_chords, motion }) = boundary.swept(tolerance) else { return Ok(None) };
        let region = polygon(&polygons);
        let text = match motion {
            Motion::Along { .. } if has_chords => return Ok(None),
            Motion::Along { lo, hi } => {
                let height = hi - lo;
                let item = format!(
                    "linear_extrude(height = {height:?}, center = false, convexity = 4) {{ {region} }}"
                );
                under(&Affine::translate(Vec3::Z * lo), &item)
            }
            Motion::About { start, sweep } => {
                let reach = polygons.iter().flatten().map(|point| point[0]).fold(0.0, f64::max);
                let fragments = self.fragments(place, reach);
                let item = format!(
                    "rotate_extrude(angle = {sweep:?}, convexity = 4, $fn = {fragments}, $fa = 12, $fs = 2) {{ {region} }}"
                );
                let turn = if sweep == 360.0 { Affine::IDENTITY } else { Affine::rotation(Vec3::Z, start) };
                under(&turn, &item)
            }
        };
        if has_chords {
            let what = self.model.arcs_remark(self.region);
            self.remarks.add(RemarkKind::Approximated, what);
        }
        Ok(Some(self.add(Piece::Text(under(place, &text)))))
    }

    fn join(&mut self, by: Operation, parts: Vec<usize>) -> Result<Option<usize>, WriteError> {
        let name = match by {
            Operation::Union => "union",
            Operation::Intersection => "intersection",
            Operation::Difference => "difference",
        };
        Ok(Some(self.add(Piece::Group(name, parts))))
    }

    fn region(&self) -> String {
        self.model.scene.regions[self.region].name.clone()
    }
}

fn vector(v: Vec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

fn rows(map: &Affine) -> String {
    let row = |row: [f64; 4]| format!("[{}]", row.map(|number| format!("{number:?}")).join(", "));
    format!("[{}]", map.to_rows().map(row).join(", "))
}

/// An item under a map.
fn under(map: &Affine, item: &str) -> String {
    if *map == Affine::IDENTITY { item.to_owned() } else { format!("multmatrix({}) {{ {item} }}", rows(map)) }
}

fn cuboid(bounds: &Bounds) -> String {
    let cube = format!("cube(size = {}, center = false);", vector(bounds.size()));
    under(&Affine::translate(bounds.lo), &cube)
}

/// The region within polygons by the even-odd rule.
fn polygon(polygons: &[Vec<[f64; 2]>]) -> String {
    let points: Vec<String> = polygons.iter().flatten().map(|[x, y]| format!("[{x:?}, {y:?}]")).collect();
    let mut next = 0;
    let path = |polygon: &Vec<[f64; 2]>| {
        let numbers: Vec<String> = (next..next + polygon.len()).map(|number| number.to_string()).collect();
        next += polygon.len();
        format!("[{}]", numbers.join(", "))
    };
    let paths: Vec<String> = polygons.iter().map(path).collect();
    format!("polygon(points = [{}], paths = [{}], convexity = 4);", points.join(", "), paths.join(", "))
}

/// OpenSCAD faces are clockwise seen from outside.
fn polyhedron(mesh: &Mesh) -> String {
    let points: Vec<String> = mesh.vertices().iter().map(|p| vector(*p)).collect();
    let faces: Vec<String> = mesh.triangles().iter().map(|[a, b, c]| format!("[{a}, {c}, {b}]")).collect();
    format!("polyhedron(points = [{}], faces = [{}], convexity = 4);", points.join(", "), faces.join(", "))
}
