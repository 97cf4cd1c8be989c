//! Replica volumes, divisions and parameterised copies of a volume.

use super::pending::{Copies, Pending};
use super::row::{Axis, Row, measure};
use crate::LossKind;
use crate::gdml::attributes::{Failure, Numbers, degrees};
use crate::gdml::context::Context;
use crate::gdml::graph::{Daughter, Graph, Volume};
use crate::gdml::problem::Problem;
use crate::gdml::shape::{Made, Phi, cuboid, faceted, of, round};
use crate::gdml::solids::{Shape, Sizes};
use crate::gdml::units;
use crate::gdml::xml::Element;
use rayweave_math::{Affine, Vec3, sin_cos_degrees};
use rayweave_model::Solid;
use rayweave_shape::primitive::{Slab, Wedge};

/// Maximum number of copies of one daughter.
pub(super) const MAX_COPIES: i64 = 1_000_000;
/// Maximum number of copies of all replica volumes and divisions.
const MAX_TOTAL_COPIES: usize = 2_000_000;
/// Maximum number of copies of one daughter with their own dimensions, each of which is a volume.
const MAX_VOLUMES: usize = 20_000;

/// An optional length, or an angle in degrees along phi; 0 by default.
pub(super) fn quantity(
    numbers: &mut Numbers,
    element: &Element,
    axis: Axis,
    name: &str,
) -> Result<f64, Failure> {
    let is_angle = axis == Axis::Phi;
    let unit = factor(numbers, element, is_angle);
    let value = numbers.number_or(element, name, 0.0)?;
    Ok(if is_angle { degrees(value, unit?) } else { value * unit? })
}

/// Factor of a length or angle unit. Some programs write lengths as angles or vice versa, which Geant4 accepts: 1 mm is 1
/// rad.
fn factor(numbers: &mut Numbers, element: &Element, is_angle: bool) -> Result<f64, Failure> {
    if let Some(attribute) = element.attribute("unit") {
        let symbol = attribute.value.trim();
        if let (None, Some(factor)) =
            (units::of(measure(is_angle), symbol), units::of(measure(!is_angle), symbol))
        {
            let what = if is_angle { "an angle" } else { "a length" };
            let message =
                format!("`{symbol}` is not a unit of {what}: 1 mm is read as 1 rad here, as in Geant4.");
            numbers.context.warn(Problem::new(message, attribute.place));
            return Ok(factor);
        }
    }
    numbers.unit(element, "unit", measure(is_angle), 1.0)
}

/// Expands the copies of a daughter whose volume is resolved.
pub(super) fn spread(context: &mut Context, graph: &mut Graph, pending: &Pending, volume: usize) {
    let mother = graph.volumes[pending.mother].shape.clone();
    let own = graph.volumes[volume].shape.clone();
    let copies = match &pending.copies {
        Copies::Placed => return,
        Copies::Replicas(row) => replicas(*row, mother.as_ref(), own.as_ref()),
        Copies::Divisions(row) => divisions(*row, mother.as_ref(), own.as_ref()),
        Copies::Shapes(shapes) => {
            let maps = graph.volumes[pending.mother].daughters[pending.daughter].maps.clone();
            Ok(maps.into_iter().zip(shapes.iter().cloned()).collect())
        }
    };
    match copies.and_then(|copies| within_limits(graph, copies)) {
        Ok(copies) => place(graph, pending, volume, copies),
        Err(failure) => {
            let daughter = &graph.volumes[pending.mother].daughters[pending.daughter];
            let reason = if let Failure::Refused(reason) = failure { reason } else { String::new() };
            let message = format!("the copies of `{}` are refused: {reason}.", pending.name);
            context.lose(LossKind::Refused, "copies", Problem::new(message, daughter.place));
        }
    }
}

/// Maps of the copies, each with a solid if that differs from the solid of the volume.
type Spread = Vec<(Affine, Option<Shape>)>;

fn within_limits(graph: &mut Graph, copies: Spread) -> Result<Spread, Failure> {
    graph.copies += copies.len();
    let volumes = copies.iter().filter(|(_, shape)| shape.is_some()).count();
    match graph.copies > MAX_TOTAL_COPIES || volumes > MAX_VOLUMES {
        true => Err(Failure::Refused("there are too many".to_owned())),
        false => Ok(copies),
    }
}

/// Adds the copies to the graph: those with the solid of the volume as placements, each of the others as a new volume.
fn place(graph: &mut Graph, pending: &Pending, volume: usize, copies: Spread) {
    let template = graph.volumes[pending.mother].daughters[pending.daughter].clone();
    let (mut own, mut others) = (Vec::new(), Vec::new());
    for (map, shape) in copies {
        match shape {
            None => own.push(map),
            Some(shape) => others.push((map, shape)),
        }
    }
    graph.volumes[pending.mother].daughters[pending.daughter].maps = own;
    for (k, (map, shape)) in others.into_iter().enumerate() {
        let original: Volume = graph.volumes[volume].clone();
        let index = graph.volumes.len();
        let name = format!("{}[{k}]", original.bare_name());
        let solid = shape.solid.named(&name);
        graph.volumes.push(Volume {
            name,
            shape: Some(Shape { solid, ..shape }),
            daughters: Vec::new(),
            ..original
        });
        let daughter = Daughter { volume: index, maps: vec![map], ..template.clone() };
        graph.volumes[pending.mother].daughters.push(daughter);
    }
}

/// Replica volumes (`G4PVReplica`): along x, y, z the row is centred; around phi copy k is rotated by
/// `offset + (k + 1/2) width`; along rho the copies are rings.
fn replicas(row: Row, mother: Option<&Shape>, own: Option<&Shape>) -> Result<Spread, Failure> {
    let copies = (0..row.count).map(|k| k as f64);
    match row.axis {
        Axis::Phi => Ok(copies.map(|k| (turned(row.offset + (k + 0.5) * row.width), None)).collect()),
        Axis::Rho => copies
            .map(|k| {
                let inner = row.offset + k * row.width;
                Ok((Affine::IDENTITY, Some(ring(mother, own, inner, inner + row.width)?)))
            })
            .collect(),
        _ => {
            let first = -0.5 * row.width * (row.count as f64 - 1.0);
            Ok(copies.map(|k| (moved(row.axis, first + k * row.width), None)).collect())
        }
    }
}

/// A tube with the given radii or, for other solids, the part of the mother between the radii.
fn ring(mother: Option<&Shape>, own: Option<&Shape>, inner: f64, outer: f64) -> Result<Shape, Failure> {
    if let Some(tube) = own.filter(|shape| shape.tag == "tube") {
        return resized(tube, &[("rmin", inner), ("rmax", outer)]);
    }
    let mother = mother.ok_or_else(|| unfit(Axis::Rho, own))?;
    let whole = Phi { start: 0.0, delta: 360.0 };
    Ok(cut(mother, round::tube(inner, outer, f64::INFINITY, whole)?, Affine::IDENTITY))
}

/// The part of a solid within another one, in a local frame.
fn cut(shape: &Shape, within: Solid, into_frame: Affine) -> Shape {
    let part = shape.solid.clone() & within;
    Shape {
        solid: if into_frame == Affine::IDENTITY { part } else { part.apply(into_frame) },
        tag: String::new(),
        sizes: Sizes::default(),
    }
}

/// `G4PVDivision`: slices of the mother. The solid of the volume is used if it equals the slice.
fn divisions(row: Row, mother: Option<&Shape>, own: Option<&Shape>) -> Result<Spread, Failure> {
    let mother = mother.ok_or_else(|| Failure::Refused("the mother has no solid".to_owned()))?;
    if row.axis == Axis::Z && !mother.sizes.heights.is_empty() {
        return sections(row, mother);
    }
    let (start, extent) = extent(row.axis, mother).ok_or_else(|| unfit(row.axis, Some(mother)))?;
    let room = extent - row.offset;
    let (count, width) = match (row.count, row.width) {
        (0, width) if width > 0.0 => (((room / width) + 1e-9).floor(), width),
        (count, 0.0) => (count as f64, room / count as f64),
        (count, width) => (count as f64, width),
    };
    if !(width > 0.0 && count >= 1.0 && count <= MAX_COPIES as f64) {
        return Err(Failure::Refused("neither its number nor its width is greater than 0".to_owned()));
    }
    let row = Row { count: count as usize, width, ..row };
    (0..row.count).map(|k| piece(row, mother, own, start, k)).collect()
}

/// `G4ParameterisationPolyconeZ`, `G4ParameterisationPolyhedraZ`: the parts between the planes, or slices within one such
/// section.
fn sections(row: Row, mother: &Shape) -> Result<Spread, Failure> {
    let mut heights = mother.sizes.heights.clone();
    heights.sort_by(f64::total_cmp);
    let bounds: Vec<[f64; 2]> = match row.width > 0.0 && row.count > 0 {
        true => {
            let low = |k: usize| heights[0] + row.offset + k as f64 * row.width;
            (0..row.count).map(|k| [low(k), low(k + 1)]).collect()
        }
        false => heights.windows(2).map(|pair| [pair[0], pair[1]]).filter(|[a, b]| a < b).collect(),
    };
    if row.width == 0.0 && row.count != bounds.len() {
        let message = format!("its number is {}, and the planes bound {}", row.count, bounds.len());
        return Err(Failure::Refused(message));
    }
    let slice = |[low, high]: [f64; 2]| {
        let middle = 0.5 * (low + high);
        let part = cut(mother, of(Slab::new(Vec3::Z, low, high)?), moved(Axis::Z, -middle));
        Ok((moved(Axis::Z, middle), Some(part)))
    };
    bounds.into_iter().map(slice).collect()
}

/// Range of a solid along an axis: start and length.
fn extent(axis: Axis, shape: &Shape) -> Option<(f64, f64)> {
    let size = |name: &str| shape.sizes.number(name);
    let centred = |length: f64| (-0.5 * length, length);
    match (axis, shape.tag.as_str()) {
        (Axis::X, "box" | "para") => Some(centred(size("x"))),
        (Axis::Y, "box" | "para") => Some(centred(size("y"))),
        // for tapering sizes, the mean
        (Axis::X, "trd") => Some(centred(0.5 * (size("x1") + size("x2")))),
        (Axis::Y, "trd") => Some(centred(0.5 * (size("y1") + size("y2")))),
        (Axis::Z, "box" | "para" | "tube" | "cone" | "trd") => Some(centred(size("z"))),
        (Axis::Phi, "tube" | "cone" | "polycone" | "polyhedra") => {
            Some((size("start"), size("delta").min(360.0)))
        }
        (Axis::Rho, "tube") => Some((size("rmin"), size("rmax") - size("rmin"))),
        (Axis::Rho, "cone") => Some((size("rmin1"), size("rmax1") - size("rmin1"))),
        _ => None,
    }
}

/// One slice of the mother, in a local frame.
fn piece(
    row: Row,
    mother: &Shape,
    own: Option<&Shape>,
    start: f64,
    k: usize,
) -> Result<(Affine, Option<Shape>), Failure> {
    let low = start + row.offset + k as f64 * row.width;
    let middle = low + 0.5 * row.width;
    let (map, shape) = match (row.axis, mother.tag.as_str()) {
        (Axis::X | Axis::Y, "trd") if tapers(row.axis, mother) => {
            (moved(row.axis, middle), wedge(row, mother, low)?)
        }
        (Axis::X | Axis::Y, _) => {
            let names = if row.axis == Axis::X { ["x", "x1", "x2"] } else { ["y", "y1", "y2"] };
            (leaning(row.axis, mother, middle), resized(mother, &names.map(|name| (name, row.width)))?)
        }
        (Axis::Z, _) => (leaning(Axis::Z, mother, middle), resized(mother, &slice(mother, low, row.width))?),
        (Axis::Rho, "cone") => (Affine::IDENTITY, resized(mother, &cone_ring(row, mother, k))?),
        (Axis::Rho, _) => (Affine::IDENTITY, resized(mother, &[("rmin", low), ("rmax", low + row.width)])?),
        (Axis::Phi, "polycone" | "polyhedra") => {
            let within = of(Wedge::new(low, row.width)?);
            (turned(low - start), cut(mother, within, turned(start - low)))
        }
        (Axis::Phi, _) => (turned(low - start), resized(mother, &[("delta", row.width)])?),
    };
    let is_own = own.is_some_and(|own| own.tag == shape.tag && alike(&own.sizes, &shape.sizes));
    Ok((map, (!is_own).then_some(shape)))
}

/// A translation along an axis; in a parallelepiped along its edges.
fn leaning(axis: Axis, shape: &Shape, by: f64) -> Affine {
    let angle = |name: &str| sin_cos_degrees(shape.sizes.number(name));
    let tan = |name: &str| angle(name).0 / angle(name).1;
    let direction = match (axis, shape.tag.as_str()) {
        (Axis::Y, "para") => Vec3::new(tan("alpha"), 1.0, 0.0),
        (Axis::Z, "para") => Vec3::new(tan("theta") * angle("phi").1, tan("theta") * angle("phi").0, 1.0),
        _ => return moved(axis, by),
    };
    Affine::translate(direction * by)
}

fn tapers(axis: Axis, trd: &Shape) -> bool {
    let [one, two] = if axis == Axis::X { ["x1", "x2"] } else { ["y1", "y2"] };
    trd.sizes.number(one) != trd.sizes.number(two)
}

/// A slice of a `trd` that tapers along the axis of the division: the same fraction of the extent at every height.
fn wedge(row: Row, trd: &Shape, low: f64) -> Result<Shape, Failure> {
    let size = |name: &str| trd.sizes.number(name);
    let (along, across) = match row.axis {
        Axis::X => (["x1", "x2"], ["y1", "y2"]),
        _ => (["y1", "y2"], ["x1", "x2"]),
    };
    let mean = 0.5 * (size(along[0]) + size(along[1]));
    let middle = low + 0.5 * row.width;
    let quadrilateral = |end: usize| {
        let place = |at: f64| at / mean * size(along[end]) - middle;
        let (a, b, half) = (place(low), place(low + row.width), 0.5 * size(across[end]));
        match row.axis {
            Axis::X => [[a, -half], [b, -half], [b, half], [a, half]],
            _ => [[-half, a], [half, a], [half, b], [-half, b]],
        }
    };
    let solid = faceted::ruled(quadrilateral(0), quadrilateral(1), 0.5 * size("z"))?;
    Ok(Shape { solid, tag: String::new(), sizes: Sizes::default() })
}

/// The radii of a ring of a cone: at each end the same fraction of the thickness.
fn cone_ring(row: Row, cone: &Shape, k: usize) -> Vec<(&'static str, f64)> {
    let size = |name: &str| cone.sizes.number(name);
    let far = (size("rmax2") - size("rmin2") - row.offset) / row.count as f64;
    let at = |inner: &str, width: f64, k: usize| size(inner) + row.offset + k as f64 * width;
    vec![
        ("rmin1", at("rmin1", row.width, k)),
        ("rmax1", at("rmin1", row.width, k + 1)),
        ("rmin2", at("rmin2", far, k)),
        ("rmax2", at("rmin2", far, k + 1)),
    ]
}

/// Dimensions of a slice across z; tapering ones are interpolated.
fn slice(mother: &Shape, low: f64, width: f64) -> Vec<(&'static str, f64)> {
    let size = |name: &str| mother.sizes.number(name);
    let part = |z: f64| z / size("z") + 0.5;
    let mut changed = vec![("z", width)];
    for (one, two) in [("x1", "x2"), ("y1", "y2"), ("rmin1", "rmin2"), ("rmax1", "rmax2")] {
        let at = |part: f64| size(one) + part * (size(two) - size(one));
        changed.extend([(one, at(part(low))), (two, at(part(low + width)))]);
    }
    changed
}

fn alike(a: &Sizes, b: &Sizes) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
    let (a, b) = (&a.numbers, &b.numbers);
    let is_in_b = |(name, value): (&&str, &f64)| b.get(name).is_some_and(|other| near(*value, *other));
    !a.is_empty() && a.len() == b.len() && a.iter().all(is_in_b)
}

/// A solid of the same kind with some dimensions replaced.
fn resized(shape: &Shape, changed: &[(&'static str, f64)]) -> Result<Shape, Failure> {
    let mut sizes = shape.sizes.clone();
    for (name, value) in changed {
        sizes.numbers.entry(name).and_modify(|size| *size = *value);
    }
    Ok(Shape { solid: rebuilt(&shape.tag, &sizes)?, tag: shape.tag.clone(), sizes })
}

fn rebuilt(tag: &str, sizes: &Sizes) -> Made {
    let size = |name: &str| sizes.number(name);
    let phi = Phi { start: size("start"), delta: size("delta") };
    match tag {
        "box" => cuboid(["x", "y", "z"].map(size)),
        "para" => {
            faceted::parallelepiped(["x", "y", "z"].map(size), size("alpha"), size("theta"), size("phi"))
        }
        "tube" => round::tube(size("rmin"), size("rmax"), size("z"), phi),
        "cone" => round::cone(["rmin1", "rmax1"].map(size), ["rmin2", "rmax2"].map(size), size("z"), phi),
        _ => {
            let end = |x: &str, y: &str| [size(y), size(x), size(x), 0.0];
            let (low, high) = (end("x1", "y1"), end("x2", "y2"));
            faceted::trapezoid(&faceted::Trapezoid { z: size("z"), theta: 0.0, phi: 0.0, low, high })
        }
    }
}

fn moved(axis: Axis, by: f64) -> Affine {
    let direction = match axis {
        Axis::X => Vec3::X,
        Axis::Y => Vec3::Y,
        _ => Vec3::Z,
    };
    Affine::translate(direction * by)
}

fn turned(by: f64) -> Affine {
    Affine::rotation(Vec3::Z, by)
}

fn unfit(axis: Axis, shape: Option<&Shape>) -> Failure {
    let what = shape.map_or("volume without a solid", |shape| shape.tag.as_str());
    Failure::Refused(format!("a {what} cannot have copies along {axis:?}"))
}
