//! Copies of a volume along an axis of its mother: replicas, divisions, and copies with dimensions of their own.

use super::{Copies, Daughter, Graph, Pending, Volume, measure};
use crate::LossKind;
use crate::gdml::attributes::{Failure, Numbers, degrees};
use crate::gdml::shape::{Made, Phi, cuboid, faceted, round};
use crate::gdml::solids::Shape;
use crate::gdml::xml::Element;
use crate::gdml::{Context, Trouble};
use rayweave_math::{Affine, Vec3};
use std::collections::BTreeMap;

/// Copies of one daughter.
pub(super) const MOST: i64 = 1_000_000;
/// Copies of all daughters that are replicas or divisions.
const MOST_ALTOGETHER: usize = 4_000_000;
/// Copies of one daughter that have dimensions of their own, and therefore are volumes of their own.
const MOST_VOLUMES: usize = 20_000;

/// The direction of a row of copies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    X,
    Y,
    Z,
    Rho,
    Phi,
}

/// The axes with their names in divisions and in the directions of replicas.
pub(super) const AXES: [(&str, &str, Axis); 5] = [
    ("kXAxis", "x", Axis::X),
    ("kYAxis", "y", Axis::Y),
    ("kZAxis", "z", Axis::Z),
    ("kRho", "rho", Axis::Rho),
    ("kPhi", "phi", Axis::Phi),
];

/// Copies in a row: width of each, and the distance of the first from the start. Millimetres, or degrees along phi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub axis: Axis,
    pub count: usize,
    pub width: f64,
    pub offset: f64,
}

/// The axis of a name as `kXAxis`.
pub(super) fn axis(name: &str) -> Option<Axis> {
    AXES.iter().find(|row| row.0 == name).map(|row| row.2)
}

/// The axis of `<direction x="1"/>`.
pub(super) fn direction(element: &Element) -> Option<Axis> {
    let is_set = |name: &str| element.text(name).trim().parse::<f64>().is_ok_and(|value| value == 1.0);
    AXES.iter().find(|row| is_set(row.1)).map(|row| row.2)
}

/// A length, or an angle in degrees if it is along phi; 0 if it is not given.
pub(super) fn quantity(
    numbers: &mut Numbers,
    element: &Element,
    axis: Axis,
    name: &str,
) -> Result<f64, Failure> {
    let is_angle = axis == Axis::Phi;
    let unit = numbers.unit(element, "unit", measure(is_angle), 1.0);
    let value = numbers.number_or(element, name, 0.0)?;
    Ok(if is_angle { degrees(value, unit?) } else { value * unit? })
}

/// Fills in the copies of a daughter whose volume is known.
pub(super) fn spread(context: &mut Context, graph: &mut Graph, pending: &Pending, volume: usize) {
    let mother = graph.volumes[pending.mother].shape.clone();
    let own = graph.volumes[volume].shape.clone();
    let copies = match &pending.copies {
        Copies::Placed => return,
        Copies::Replicas(row) => replicas(*row, own.as_ref()),
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
            let message = format!("the copies of `{}` are refused ({reason})", pending.name);
            context.lose(LossKind::Refused, "copies", Trouble::new(message, daughter.place));
        }
    }
}

/// Maps, each with a solid where it is not the volume's own.
type Spread = Vec<(Affine, Option<Shape>)>;

fn within_limits(graph: &mut Graph, copies: Spread) -> Result<Spread, Failure> {
    graph.copies += copies.len();
    let volumes = copies.iter().filter(|(_, shape)| shape.is_some()).count();
    match graph.copies > MOST_ALTOGETHER || volumes > MOST_VOLUMES {
        true => Err(Failure::Refused("they are too many".to_owned())),
        false => Ok(copies),
    }
}

/// Puts the copies into the graph: those of the volume's own solid at its daughter, each other in a volume of its own.
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

/// `G4PVReplica`: along x, y, z the row is centred; around phi copy k is turned by `offset + (k + 1/2) width`; along rho the
/// copies are rings.
fn replicas(row: Row, own: Option<&Shape>) -> Result<Spread, Failure> {
    let copies = (0..row.count).map(|k| k as f64);
    match row.axis {
        Axis::Phi => Ok(copies.map(|k| (turned(row.offset + (k + 0.5) * row.width), None)).collect()),
        Axis::Rho => {
            let tube = own.filter(|shape| shape.tag == "tube").ok_or_else(|| unfit(row.axis, own))?;
            let ring = |k: f64| {
                let inner = row.offset + k * row.width;
                let changed = [("rmin", inner), ("rmax", inner + row.width)];
                Ok((Affine::IDENTITY, Some(resized(tube, &changed)?)))
            };
            copies.map(ring).collect()
        }
        _ => {
            let first = -0.5 * row.width * (row.count as f64 - 1.0);
            Ok(copies.map(|k| (moved(row.axis, first + k * row.width), None)).collect())
        }
    }
}

/// `G4PVDivision`: pieces of the mother. The volume's own solid is used where it is such a piece already.
fn divisions(row: Row, mother: Option<&Shape>, own: Option<&Shape>) -> Result<Spread, Failure> {
    let mother = mother.ok_or_else(|| Failure::Refused("the mother has no solid".to_owned()))?;
    let (start, extent) = extent(row.axis, mother).ok_or_else(|| unfit(row.axis, Some(mother)))?;
    let room = extent - row.offset;
    let (count, width) = match (row.count, row.width) {
        (0, width) if width > 0.0 => (((room / width) + 1e-9).floor(), width),
        (count, 0.0) => (count as f64, room / count as f64),
        (count, width) => (count as f64, width),
    };
    if !(width > 0.0 && count >= 1.0 && count <= MOST as f64) {
        return Err(Failure::Refused("neither its number nor its width is greater than 0".to_owned()));
    }
    let pieces = (0..count as usize).map(|k| start + row.offset + k as f64 * width);
    pieces.map(|low| piece(row.axis, mother, own, low, width, start)).collect()
}

/// The range of a solid along an axis: where it starts, and how long it is.
fn extent(axis: Axis, shape: &Shape) -> Option<(f64, f64)> {
    let size = |name: &str| shape.sizes.get(name).copied();
    let centred = |length: f64| (-0.5 * length, length);
    match (axis, shape.tag.as_str()) {
        (Axis::X, "box") => size("x").map(centred),
        (Axis::Y, "box") => size("y").map(centred),
        (Axis::X, "trd") if size("x1") == size("x2") => size("x1").map(centred),
        (Axis::Y, "trd") if size("y1") == size("y2") => size("y1").map(centred),
        (Axis::Z, "box" | "tube" | "cone" | "trd") => size("z").map(centred),
        (Axis::Phi, "tube" | "cone") => Some((size("start")?, size("delta")?.min(360.0))),
        (Axis::Rho, "tube") => Some((size("rmin")?, size("rmax")? - size("rmin")?)),
        _ => None,
    }
}

/// The piece of the mother from `low` on, in a frame of its own.
fn piece(
    axis: Axis,
    mother: &Shape,
    own: Option<&Shape>,
    low: f64,
    width: f64,
    start: f64,
) -> Result<(Affine, Option<Shape>), Failure> {
    let middle = low + 0.5 * width;
    let (map, changed) = match axis {
        Axis::X | Axis::Y => {
            let names = if axis == Axis::X { ["x", "x1", "x2"] } else { ["y", "y1", "y2"] };
            (moved(axis, middle), names.map(|name| (name, width)).to_vec())
        }
        Axis::Z => (moved(axis, middle), slice(mother, low, width)),
        Axis::Rho => (Affine::IDENTITY, vec![("rmin", low), ("rmax", low + width)]),
        Axis::Phi => (turned(low - start), vec![("delta", width)]),
    };
    let shape = resized(mother, &changed)?;
    let is_own = own.is_some_and(|own| own.tag == shape.tag && alike(&own.sizes, &shape.sizes));
    Ok((map, (!is_own).then_some(shape)))
}

/// The sizes of a slice across z: those that taper are interpolated.
fn slice(mother: &Shape, low: f64, width: f64) -> Vec<(&'static str, f64)> {
    let size = |name: &str| mother.sizes.get(name).copied().unwrap_or(0.0);
    let part = |z: f64| z / size("z") + 0.5;
    let mut changed = vec![("z", width)];
    for (one, two) in [("x1", "x2"), ("y1", "y2"), ("rmin1", "rmin2"), ("rmax1", "rmax2")] {
        let at = |part: f64| size(one) + part * (size(two) - size(one));
        changed.extend([(one, at(part(low))), (two, at(part(low + width)))]);
    }
    changed
}

fn alike(a: &BTreeMap<&'static str, f64>, b: &BTreeMap<&'static str, f64>) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
    a.len() == b.len() && a.iter().all(|(name, value)| b.get(name).is_some_and(|other| near(*value, *other)))
}

/// The same kind of solid with other sizes.
fn resized(shape: &Shape, changed: &[(&'static str, f64)]) -> Result<Shape, Failure> {
    let mut sizes = shape.sizes.clone();
    changed.iter().filter(|(name, _)| shape.sizes.contains_key(name)).for_each(|(name, value)| {
        sizes.insert(name, *value);
    });
    Ok(Shape { solid: rebuilt(&shape.tag, &sizes)?, tag: shape.tag.clone(), sizes })
}

fn rebuilt(tag: &str, sizes: &BTreeMap<&'static str, f64>) -> Made {
    let size = |name: &str| sizes.get(name).copied().unwrap_or(0.0);
    let phi = Phi { start: size("start"), delta: size("delta") };
    match tag {
        "box" => cuboid(["x", "y", "z"].map(size)),
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
    let what = shape.map_or("a volume without solid", |shape| shape.tag.as_str());
    Failure::Refused(format!("copies along {axis:?} are not possible for a {what}"))
}
