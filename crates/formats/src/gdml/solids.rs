//! `<solids>`: GDML solids, including GDML booleans (union, subtraction, intersection).

use super::attributes::{Failure, Numbers, refused};
use super::define::{Role, rotation};
use super::origin;
use super::problem::Place;
use super::problem::Problem;
use super::schema;
use super::shape::extruded::{Section, extruded};
use super::shape::faceted::*;
use super::shape::round::*;
use super::shape::twisted::{twisted, twisted_tube};
use super::shape::{Made, Phi, cuboid};
use super::xml::{Element, Name};
use crate::LossKind;
use rayweave_math::{Affine, Vec3, sin_cos_degrees};
use rayweave_model::Solid;
use rayweave_scene::{Table, bare_name};
use std::collections::BTreeMap;

/// The solids of a file by name; `None` for refused ones.
#[derive(Debug, Default)]
pub(super) struct Library {
    solids: BTreeMap<String, Option<Shape>>,
    /// Rows of the table `[gdml]` for the solids without a native twin.
    pub origins: Vec<Table>,
}

/// A solid with the dimensions that divisions need.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub solid: Solid,
    /// Name of the element, e.g. `box`.
    pub tag: String,
    pub sizes: Sizes,
}

/// Dimensions of a solid that divisions need.
#[derive(Clone, Debug, Default)]
pub(super) struct Sizes {
    /// Lengths in millimetres and angles in degrees, by attribute.
    pub numbers: BTreeMap<&'static str, f64>,
    /// Heights of the planes of a polycone or polyhedra, in millimetres.
    pub heights: Vec<f64>,
}

impl Sizes {
    fn extend<const N: usize>(&mut self, numbers: [(&'static str, f64); N]) {
        self.numbers.extend(numbers);
    }

    /// Dimensions of a polycone or polyhedra.
    fn planes(&mut self, planes: &[ZPlane], phi: Phi) {
        self.heights = planes.iter().map(|plane| plane.z).collect();
        self.extend([("start", phi.start), ("delta", phi.delta)]);
    }

    /// A dimension by name, 0 if there is none.
    pub fn number(&self, name: &str) -> f64 {
        self.numbers.get(name).copied().unwrap_or(0.0)
    }
}

impl Library {
    /// A solid defined earlier; `Ok(None)` if it was refused.
    fn find(&self, numbers: &mut Numbers, name: &str, place: Place) -> Result<Option<Shape>, Failure> {
        match self.solids.get(name) {
            Some(found) => Ok(found.clone()),
            None => {
                let problem = Problem::new(
                    format!("unknown solid `{name}`: no solid defined before has this name."),
                    place,
                );
                Err(numbers.error(problem.did_you_mean(name, self.solids.keys().map(String::as_str))))
            }
        }
    }

    /// The solid in `<element ref="name"/>`; `None` if it was refused.
    pub fn of(&self, numbers: &mut Numbers, element: &Element) -> Result<Option<Shape>, Failure> {
        let (name, place) = numbers.reference(element, "ref")?;
        self.find(numbers, &name, place)
    }

    /// Adds the solid of an element. An unsupported solid is refused with a warning.
    pub fn add(&mut self, numbers: &mut Numbers, element: &Element) {
        if !schema::solids().any(|tag| element.name == tag) {
            let problem =
                Problem::new(format!("the solid `{}` is not supported", element.name), element.place);
            let problem = problem.did_you_mean(&element.name, schema::solids());
            numbers.context.lose(LossKind::Refused, &element.name, problem);
            if let Some(name) = element.attribute("name") {
                self.solids.insert(name.value.clone(), None);
            }
            return;
        }
        let Ok(name) = numbers.name(element) else {
            return;
        };
        if self.solids.contains_key(&name) {
            let message = format!("a second solid `{name}`: the first one is used.");
            numbers.context.lose(LossKind::Dropped, &element.name, Problem::new(message, element.place));
            return;
        }
        let mut sizes = Sizes::default();
        let composed = self.composed(numbers, element);
        let is_composed = composed.is_some();
        let made = composed.unwrap_or_else(|| primitive(numbers, element, &mut sizes));
        let shape = made.map(|solid| Shape { solid, tag: element.name.to_string(), sizes });
        let shape = refuse_or_keep(numbers, element, shape);
        if let Some(shape) = shape.as_ref().filter(|_| !is_composed) {
            self.origins.extend(origin::row(numbers, element, bare_name(&name), &shape.solid));
        }
        self.solids.insert(
            name.clone(),
            shape.map(|shape| Shape { solid: shape.solid.named(bare_name(&name)), ..shape }),
        );
    }

    /// A solid that refers to other solids; `None` for all others.
    fn composed(&self, numbers: &mut Numbers, element: &Element) -> Option<Made> {
        Some(match element.name.as_str() {
            "union" | "subtraction" | "intersection" => self.boolean(numbers, element),
            "multiUnion" => self.multi_union(numbers, element),
            "scaledSolid" => self.scaled(numbers, element),
            "reflectedSolid" => self.reflected(numbers, element),
            _ => return None,
        })
    }

    /// An operand of a boolean solid.
    fn operand(&self, numbers: &mut Numbers, element: &Element, child: &str, attribute: &str) -> Made {
        let Some(child) = element.child(child) else {
            let message = format!("`{}` has no `{child}`: it is required.", element.name);
            return Err(numbers.error(Problem::new(message, element.place)));
        };
        let (name, place) = numbers.reference(child, attribute)?;
        match self.find(numbers, &name, place)? {
            Some(shape) => Ok(shape.solid),
            None => refused(format!("its part `{name}` is refused")),
        }
    }

    fn boolean(&self, numbers: &mut Numbers, element: &Element) -> Made {
        let first = self.operand(numbers, element, "first", "ref");
        let second = self.operand(numbers, element, "second", "ref");
        let (position, angles) = numbers.placement(element, "")?;
        let (first_position, first_angles) = numbers.placement(element, "first")?;
        let first = placed(&first?, rotation(first_angles), first_position);
        let second = placed(&second?, rotation(angles), position);
        Ok(match element.name.as_str() {
            "union" => first | second,
            "subtraction" => first - second,
            _ => first & second,
        })
    }

    fn multi_union(&self, numbers: &mut Numbers, element: &Element) -> Made {
        let (mut parts, mut failure) = (Vec::new(), None);
        numbers.each(element, &mut |numbers, node| {
            if node.name == "multiUnionNode" {
                match self.node(numbers, node) {
                    Ok(part) => parts.push(part),
                    Err(other) => failure = Some(other),
                }
            }
        });
        failure.map_or_else(|| super::shape::union_of(parts, "it has no parts"), Err)
    }

    fn node(&self, numbers: &mut Numbers, node: &Element) -> Made {
        let solid = self.operand(numbers, node, "solid", "ref");
        let (position, angles) = numbers.placement(node, "")?;
        Ok(placed(&solid?, rotation(angles), position))
    }

    fn scaled(&self, numbers: &mut Numbers, element: &Element) -> Made {
        let solid = self.operand(numbers, element, "solidref", "ref");
        let scale = numbers.child_vector(element, "scale", Role::Scale)?.unwrap_or(Vec3::ONE);
        scaled(&solid?, scale)
    }

    /// `<reflectedSolid>` of older files: a solid scaled by `sx sy sz`, rotated by `rx ry rz` and translated by `dx dy dz`.
    fn reflected(&self, numbers: &mut Numbers, element: &Element) -> Made {
        let (name, place) = numbers.reference(element, "solid")?;
        let Some(shape) = self.find(numbers, &name, place)? else {
            return refused(format!("its part `{name}` is refused"));
        };
        let mut scale = Vec3::ONE;
        for (axis, attribute) in ["sx", "sy", "sz"].into_iter().enumerate() {
            scale[axis] = numbers.number_or(element, attribute, 1.0)?;
        }
        let angles = Vec3::from_array(numbers.angles(element, ["rx", "ry", "rz"])?);
        let position = Vec3::from_array(numbers.lengths_or_zero(element, ["dx", "dy", "dz"])?);
        Ok(placed(&scaled(&shape.solid, scale)?, rotation(angles), position))
    }
}

/// The solid scaled along the axes; a factor of 0 is refused, since the result would be flat.
fn scaled(solid: &Solid, scale: Vec3) -> Made {
    match scale.to_array().contains(&0.0) {
        true => refused("a scale factor is 0"),
        false => Ok(solid.scale(scale)),
    }
}

/// The solid, or a refusal in the report.
fn refuse_or_keep(numbers: &mut Numbers, element: &Element, made: Result<Shape, Failure>) -> Option<Shape> {
    match made {
        Ok(shape) => Some(shape),
        Err(Failure::Reported) => None,
        Err(Failure::Refused(reason)) => {
            let name = element.text("name");
            let problem = Problem::new(format!("the solid `{name}` is refused: {reason}."), element.place);
            numbers.context.lose(LossKind::Refused, &element.name, problem);
            None
        }
    }
}

fn placed(solid: &Solid, rotation: Affine, position: Vec3) -> Solid {
    let map = rotation.then(&Affine::translate(position));
    if map == Affine::IDENTITY { solid.clone() } else { solid.apply(map) }
}

/// A solid without references to other solids.
pub(super) fn primitive(numbers: &mut Numbers, e: &Element, sizes: &mut Sizes) -> Made {
    match e.name.as_str() {
        "box" => {
            let [x, y, z] = numbers.lengths(e, ["x", "y", "z"])?;
            sizes.extend([("x", x), ("y", y), ("z", z)]);
            cuboid([x, y, z])
        }
        "tube" => tube_of(numbers, e, sizes),
        "cutTube" => cut_tube_of(numbers, e),
        "cone" => cone_of(numbers, e, sizes),
        "polycone" => {
            let (planes, phi) = (z_planes(numbers, e)?, sector(numbers, e)?);
            sizes.planes(&planes, phi);
            polycone(&planes, phi)
        }
        "genericPolycone" => {
            generic_polycone(&corners(numbers, e, "rzpoint", ["r", "z"])?, sector(numbers, e)?)
        }
        "polyhedra" => {
            let (planes, sides, phi) = (z_planes(numbers, e)?, sides(numbers, e)?, sector(numbers, e)?);
            sizes.planes(&planes, phi);
            numbers.count_faces(planes.len().saturating_mul(sides as usize))?;
            polyhedra(&planes, sides, phi)
        }
        "genericPolyhedra" => {
            let (corners, sides) = (corners(numbers, e, "rzpoint", ["r", "z"])?, sides(numbers, e)?);
            numbers.count_faces(corners.len().saturating_mul(sides as usize))?;
            generic_polyhedra(&corners, sides, sector(numbers, e)?)
        }
        "trd" => trd(numbers, e, sizes),
        "trap" => trap(numbers, e),
        "para" => para(numbers, e, sizes),
        "tet" => tet(numbers, e),
        "arb8" => arb8(numbers, e),
        "xtru" => xtru(numbers, e),
        "tessellated" => facets(numbers, e),
        "sphere" => sphere_of(numbers, e),
        "orb" => orb(numbers.lengths(e, ["r"])?[0]),
        "torus" => {
            let [rmax, rtor] = numbers.lengths(e, ["rmax", "rtor"])?;
            let [rmin] = numbers.lengths_or_zero(e, ["rmin"])?;
            torus(rmin, rmax, rtor, sector(numbers, e)?)
        }
        "ellipsoid" => {
            let radii = numbers.lengths(e, ["ax", "by", "cz"])?;
            let [low, high] = numbers.lengths_or_zero(e, ["zcut1", "zcut2"])?;
            ellipsoid(radii, low, high)
        }
        "eltube" => {
            let [dx, dy, dz] = numbers.lengths(e, ["dx", "dy", "dz"])?;
            elliptical_tube(dx, dy, dz)
        }
        "elcone" => elcone_of(numbers, e),
        "paraboloid" => {
            let [high, dz] = numbers.lengths(e, ["rhi", "dz"])?;
            paraboloid(numbers.lengths_or_zero(e, ["rlo"])?[0], high, dz)
        }
        "hype" => hype_of(numbers, e),
        "twistedbox" => {
            let [x, y, z] = numbers.lengths(e, ["x", "y", "z"])?;
            twist(numbers, e, &straight([x, x], [y, y], z))
        }
        "twistedtrd" => {
            let [x1, x2, y1, y2, z] = numbers.lengths(e, ["x1", "x2", "y1", "y2", "z"])?;
            twist(numbers, e, &straight([x1, x2], [y1, y2], z))
        }
        "twistedtrap" => twistedtrap_of(numbers, e),
        "twistedtubs" => twisted_tubs(numbers, e),
        _ => refused("this kind of solid is unknown"),
    }
}

/// The sector of a solid; the full turn by default.
fn sector(numbers: &mut Numbers, e: &Element) -> Result<Phi, Failure> {
    let start = numbers.angle(e, "startphi", 0.0);
    let delta = numbers.angle(e, "deltaphi", 360.0);
    Ok(Phi { start: start?, delta: delta? })
}

fn sides(numbers: &mut Numbers, e: &Element) -> Result<u32, Failure> {
    numbers.whole(e, "numsides", 1, 4096).map(|sides| sides as u32)
}

fn tube_of(numbers: &mut Numbers, e: &Element, sizes: &mut Sizes) -> Made {
    let [rmax, z] = numbers.lengths(e, ["rmax", "z"])?;
    let [rmin] = numbers.lengths_or_zero(e, ["rmin"])?;
    let phi = sector(numbers, e)?;
    sizes.extend([("rmin", rmin), ("rmax", rmax), ("z", z), ("start", phi.start), ("delta", phi.delta)]);
    tube(rmin, rmax, z, phi)
}

fn cone_of(numbers: &mut Numbers, e: &Element, sizes: &mut Sizes) -> Made {
    let [rmax1, rmax2, z] = numbers.lengths(e, ["rmax1", "rmax2", "z"])?;
    let [rmin1, rmin2] = numbers.lengths_or_zero(e, ["rmin1", "rmin2"])?;
    let phi = sector(numbers, e)?;
    sizes.extend([("rmin1", rmin1), ("rmax1", rmax1), ("rmin2", rmin2), ("rmax2", rmax2), ("z", z)]);
    sizes.extend([("start", phi.start), ("delta", phi.delta)]);
    cone([rmin1, rmax1], [rmin2, rmax2], z, phi)
}

fn sphere_of(numbers: &mut Numbers, e: &Element) -> Made {
    let [rmax] = numbers.lengths(e, ["rmax"])?;
    let [rmin] = numbers.lengths_or_zero(e, ["rmin"])?;
    let start = numbers.angle(e, "starttheta", 0.0)?;
    let theta = Phi { start, delta: numbers.angle(e, "deltatheta", 180.0 - start)? };
    sphere(rmin, rmax, sector(numbers, e)?, theta)
}

fn elcone_of(numbers: &mut Numbers, e: &Element) -> Made {
    let [zmax, zcut] = numbers.lengths(e, ["zmax", "zcut"])?;
    let (dx, dy) = (numbers.number(e, "dx")?, numbers.number(e, "dy")?);
    elliptical_cone(dx, dy, zmax, zcut)
}

fn hype_of(numbers: &mut Numbers, e: &Element) -> Made {
    let [rmax, z] = numbers.lengths(e, ["rmax", "z"])?;
    let [rmin] = numbers.lengths_or_zero(e, ["rmin"])?;
    let [inst, outst] = numbers.angles(e, ["inst", "outst"])?;
    hype(rmin, rmax, inst, outst, z)
}

fn twistedtrap_of(numbers: &mut Numbers, e: &Element) -> Made {
    let [z, y1, x1, x2, y2, x3, x4] = numbers.lengths(e, ["z", "y1", "x1", "x2", "y2", "x3", "x4"])?;
    let [theta, phi, alpha] = numbers.angles(e, ["Theta", "Phi", "Alph"])?;
    let (low, high) = ([y1, x1, x2, alpha], [y2, x3, x4, alpha]);
    twist(numbers, e, &Trapezoid { z, theta, phi, low, high })
}

fn cut_tube_of(numbers: &mut Numbers, e: &Element) -> Made {
    let [rmax, z] = numbers.lengths(e, ["rmax", "z"])?;
    let [rmin] = numbers.lengths_or_zero(e, ["rmin"])?;
    let mut normal = |names: [&str; 3]| -> Result<Vec3, Failure> {
        let mut normal = Vec3::ZERO;
        for (axis, name) in names.into_iter().enumerate() {
            normal[axis] = numbers.number(e, name)?;
        }
        Ok(normal)
    };
    let low = normal(["lowX", "lowY", "lowZ"])?;
    let high = normal(["highX", "highY", "highZ"])?;
    cut_tube(rmin, rmax, z, sector(numbers, e)?, low, high)
}

/// The `<zplane>` elements of a solid.
fn z_planes(numbers: &mut Numbers, e: &Element) -> Result<Vec<ZPlane>, Failure> {
    let unit = numbers.length_unit(e)?;
    let (mut planes, mut failure) = (Vec::new(), None);
    numbers.each(e, &mut |numbers, child| {
        if child.name == "zplane" {
            match z_plane(numbers, child, unit) {
                Ok(plane) => planes.push(plane),
                Err(other) => failure = Some(other),
            }
        }
    });
    failure.map_or(Ok(planes), Err)
}

fn z_plane(numbers: &mut Numbers, child: &Element, unit: f64) -> Result<ZPlane, Failure> {
    let z = numbers.number(child, "z");
    let rmin = numbers.number_or(child, "rmin", 0.0);
    let rmax = numbers.number(child, "rmax");
    Ok(ZPlane { z: z? * unit, rmin: rmin? * unit, rmax: rmax? * unit })
}

/// Child elements with two lengths each.
fn corners(
    numbers: &mut Numbers,
    e: &Element,
    tag: &str,
    names: [&str; 2],
) -> Result<Vec<[f64; 2]>, Failure> {
    let unit = numbers.length_unit(e)?;
    let (mut all, mut failure) = (Vec::new(), None);
    numbers.each(e, &mut |numbers, child| {
        if child.name == tag {
            match names.map(|name| numbers.number(child, name)) {
                [Ok(a), Ok(b)] => all.push([a * unit, b * unit]),
                _ => failure = Some(Failure::Reported),
            }
        }
    });
    failure.map_or(Ok(all), Err)
}

fn trd(numbers: &mut Numbers, e: &Element, sizes: &mut Sizes) -> Made {
    let [x1, x2, y1, y2, z] = numbers.lengths(e, ["x1", "x2", "y1", "y2", "z"])?;
    sizes.extend([("x1", x1), ("x2", x2), ("y1", y1), ("y2", y2), ("z", z)]);
    trapezoid(&straight([x1, x2], [y1, y2], z))
}

fn trap(numbers: &mut Numbers, e: &Element) -> Made {
    let [z, y1, x1, x2, y2, x3, x4] = numbers.lengths(e, ["z", "y1", "x1", "x2", "y2", "x3", "x4"])?;
    let [theta, phi, alpha1, alpha2] = numbers.angles(e, ["theta", "phi", "alpha1", "alpha2"])?;
    trapezoid(&Trapezoid { z, theta, phi, low: [y1, x1, x2, alpha1], high: [y2, x3, x4, alpha2] })
}

fn para(numbers: &mut Numbers, e: &Element, sizes: &mut Sizes) -> Made {
    let [x, y, z] = numbers.lengths(e, ["x", "y", "z"])?;
    let [alpha, theta, phi] = numbers.angles(e, ["alpha", "theta", "phi"])?;
    sizes.extend([("x", x), ("y", y), ("z", z), ("alpha", alpha), ("theta", theta), ("phi", phi)]);
    parallelepiped([x, y, z], alpha, theta, phi)
}

fn tet(numbers: &mut Numbers, e: &Element) -> Made {
    let mut corners = [Vec3::ZERO; 4];
    for (corner, name) in corners.iter_mut().zip(["vertex1", "vertex2", "vertex3", "vertex4"]) {
        *corner = vertex(numbers, e, name)?;
    }
    tetrahedron(corners)
}

fn arb8(numbers: &mut Numbers, e: &Element) -> Made {
    let coordinates = ["x", "y"].map(|axis| [1, 2, 3, 4, 5, 6, 7, 8].map(|k| format!("v{k}{axis}")));
    let [x, y] = coordinates.map(|names| numbers.lengths(e, names.each_ref().map(String::as_str)));
    let ([x, y], [dz]) = ([x?, y?], numbers.lengths(e, ["dz"])?);
    let end = |first: usize| [0, 1, 2, 3].map(|k| [x[first + k], y[first + k]]);
    ruled(end(0), end(4), dz)
}

fn xtru(numbers: &mut Numbers, e: &Element) -> Made {
    let vertices = corners(numbers, e, "twoDimVertex", ["x", "y"])?;
    let sections = sections(numbers, e)?;
    numbers.count_faces(vertices.len().saturating_mul(sections.len()))?;
    extruded(&vertices, &sections)
}

fn straight(x: [f64; 2], y: [f64; 2], z: f64) -> Trapezoid {
    Trapezoid { z, theta: 0.0, phi: 0.0, low: [y[0], x[0], x[0], 0.0], high: [y[1], x[1], x[1], 0.0] }
}

/// A vertex: a defined position. `lunit` does not apply to it.
fn vertex(numbers: &mut Numbers, e: &Element, name: &str) -> Result<Vec3, Failure> {
    let (name, place) = numbers.reference(e, name)?;
    match numbers.positions.get(&name) {
        Some(position) => Ok(*position),
        None => {
            let problem = Problem::new(
                format!("unknown position `{name}`: no <position name=\"{name}\"> before it."),
                place,
            );
            let known: Vec<String> = numbers.positions.keys().cloned().collect();
            Err(numbers.error(problem.did_you_mean(&name, known.iter().map(String::as_str))))
        }
    }
}

fn sections(numbers: &mut Numbers, e: &Element) -> Result<Vec<Section>, Failure> {
    let unit = numbers.length_unit(e)?;
    let (mut all, mut failure) = (Vec::new(), None);
    numbers.each(e, &mut |numbers, child| {
        if child.name == "section" {
            match section_of(numbers, child, unit) {
                Ok(section) => all.push(section),
                Err(other) => failure = Some(other),
            }
        }
    });
    failure.map_or(Ok(all), Err)
}

fn section_of(numbers: &mut Numbers, child: &Element, unit: f64) -> Result<Section, Failure> {
    let z = numbers.number(child, "zPosition");
    let x = numbers.number_or(child, "xOffset", 0.0);
    let y = numbers.number_or(child, "yOffset", 0.0);
    let scale = numbers.number_or(child, "scalingFactor", 1.0);
    Ok(Section { z: z? * unit, offset: [x? * unit, y? * unit], scale: scale? })
}

fn facets(numbers: &mut Numbers, e: &Element) -> Made {
    let (mut facets, mut places, mut failure) = (Vec::new(), Vec::new(), None);
    numbers.each(e, &mut |numbers, child| {
        if !["triangular", "quadrangular"].contains(&child.name.as_str()) {
            return;
        }
        match facet(numbers, child) {
            Ok(facet) => {
                facets.push(facet);
                places.push(child.place);
            }
            Err(other) => failure = Some(other),
        }
    });
    match failure {
        Some(failure) => Err(failure),
        None if facets.len() < 4 => refused("it has fewer than 4 facets"),
        None => {
            let solid = tessellated(&facets)?;
            warn_of_defects(numbers, e, &facets, &places);
            Ok(solid)
        }
    }
}

/// Warns about the defects that Geant4 warns about. In Rayweave, the interior does not depend on the order of the vertices.
fn warn_of_defects(numbers: &mut Numbers, e: &Element, facets: &[Vec<Vec3>], places: &[Place]) {
    let (name, defects) = (e.text("name"), Defects::of(facets));
    if defects.volume <= 0.0 {
        let message = format!(
            "the tessellated solid `{name}` is inside out: its facets are clockwise seen from outside. In Geant4 the interior \
            depends on the order of the vertices, in Rayweave it does not."
        );
        numbers.context.warn(Problem::new(message, e.place));
    }
    if let Some((facet, count)) = defects.reversed {
        let message = format!(
            "facet {facet} (counted from 0) of the tessellated solid `{name}` has the wrong orientation: it and a neighbour \
             traverse a common edge in the same direction{}. In Geant4 the interior depends on the order of the vertices, in Rayweave it \
             does not.",
            if count == 1 { String::new() } else { format!(" ({count} such edges in the solid)") }
        );
        numbers.context.warn(Problem::new(message, places[facet]));
    }
    if let Some((facet, count)) = defects.open {
        let message = format!(
            "the tessellated solid `{name}` has holes: {count} of its edges do not belong to two facets. The first is an \
            edge of facet {facet} (counted from 0)."
        );
        numbers.context.warn(Problem::new(message, places[facet]));
    }
}

/// Vertices of a facet; with `type="RELATIVE"` all but the first are relative to the first.
fn facet(numbers: &mut Numbers, child: &Element) -> Result<Vec<Vec3>, Failure> {
    let count = if child.name == "triangular" { 3 } else { 4 };
    let mut corners = Vec::with_capacity(count);
    for name in &["vertex1", "vertex2", "vertex3", "vertex4"][..count] {
        corners.push(vertex(numbers, child, name)?);
    }
    if child.text("type") == "RELATIVE" {
        let first = corners[0];
        corners[1..].iter_mut().for_each(|corner| *corner += first);
    }
    Ok(corners)
}

fn twist(numbers: &mut Numbers, e: &Element, trapezoid: &Trapezoid) -> Made {
    let angle = numbers.angle(e, "PhiTwist", 0.0)?;
    numbers.count_faces(1)?;
    let made = twisted(trapezoid, angle)?;
    numbers.count_faces(5 * made.layers)?;
    let message = format!(
        "the twisted solid `{}` is a stack of {} layers whose side faces are quadrics that deviate by at most {:.1e} mm.",
        e.text("name"),
        made.layers,
        // two digits, not rounded down
        1.06 * made.deviation
    );
    numbers.context.lose(LossKind::Approximated, &e.name, Problem::new(message, e.place));
    Ok(made.solid)
}

fn twisted_tubs(numbers: &mut Numbers, e: &Element) -> Made {
    let [rmin, rmax, z] = numbers.lengths(e, ["endinnerrad", "endouterrad", "zlen"])?;
    let twist = numbers.angle(e, "twistedangle", 0.0)?;
    let [phi, total] = numbers.angles(e, ["phi", "totphi"])?;
    let segments = numbers.number_or(e, "nseg", 0.0)?;
    twisted_tube(twist, rmin, rmax, z, if segments > 0.0 { total / segments } else { phi })
}

/// A solid with the dimensions of a parameterised volume: the same kind as the solid of the volume, with partly different
/// attribute names.
pub(super) fn with_dimensions(numbers: &mut Numbers, dimensions: &Element) -> Option<Shape> {
    let tag = dimensions.name.strip_suffix("_dimensions")?;
    fn renamed(name: &str) -> &str {
        match name {
            "InR" => "rmin",
            "OutR" => "rmax",
            "hz" => "z",
            "StartPhi" | "startPhi" => "startphi",
            "DeltaPhi" | "openPhi" => "deltaphi",
            "numSide" => "numsides",
            "StartTheta" => "starttheta",
            "DeltaTheta" => "deltatheta",
            "TorR" | "SweptR" => "rtor",
            "Theta" => "theta",
            "Phi" => "phi",
            "Alpha" => "alpha",
            other => other,
        }
    }
    let attributes = dimensions
        .attributes
        .iter()
        .map(|a| super::xml::Attribute { name: Name::new(renamed(&a.name)), ..a.clone() });
    let element = Element {
        name: Name::new(tag),
        place: dimensions.place,
        attributes: attributes.collect(),
        children: dimensions.children.clone(),
        content: None,
    };
    let mut sizes = Sizes::default();
    let solid = match tag {
        "polyhedra" => polyhedra_to_corners(numbers, &element),
        _ => primitive(numbers, &element, &mut sizes),
    };
    let made = solid.map(|solid| Shape { solid, tag: tag.to_owned(), sizes });
    refuse_or_keep(numbers, &element, made)
}

/// A polyhedra whose radii are distances of edges from the axis, as Geant4 reads `polyhedra_dimensions`.
fn polyhedra_to_corners(numbers: &mut Numbers, e: &Element) -> Made {
    let (mut planes, sides, phi) = (z_planes(numbers, e)?, sides(numbers, e)?, sector(numbers, e)?);
    let (_, cos) = sin_cos_degrees(0.5 * phi.delta.min(360.0) / f64::from(sides));
    for plane in &mut planes {
        (plane.rmin, plane.rmax) = (cos * plane.rmin, cos * plane.rmax);
    }
    numbers.count_faces(planes.len().saturating_mul(sides as usize))?;
    polyhedra(&planes, sides, phi)
}

#[cfg(test)]
mod tests {
    use super::super::context::Context;
    use super::*;

    /// A solid without attributes is refused for what it lacks, not because its kind is unknown.
    #[test]
    fn every_solid_of_the_schema_has_a_reader() {
        for tag in schema::solids().filter(|tag| *tag != "opticalsurface") {
            let element = Element {
                name: Name::new(tag),
                place: Place::default(),
                attributes: Vec::new(),
                children: Vec::new(),
                content: None,
            };
            let mut context = Context::default();
            let mut numbers = Numbers::new(&mut context);
            let made = Library::default().composed(&mut numbers, &element);
            let made = made.unwrap_or_else(|| primitive(&mut numbers, &element, &mut Sizes::default()));
            assert!(!matches!(made, Err(Failure::Refused(reason)) if reason.contains("unknown")), "{tag}");
        }
    }
}
