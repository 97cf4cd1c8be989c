//! Generators of convex hulls: the points, balls and discs below a node.

use super::arguments::{Arguments, Refusal, vector};
use super::extent::Way;
use super::extrude::is_convex as is_one_cell;
use super::facets::{Fineness, ring_points, sphere_rings};
use super::flat::{Flat, Flats, Leaf, image, simple};
use super::hull::{Generator, check_count};
use super::hull2::touching_points;
use super::operation::Operation;
use super::part::Part;
use super::primitive::CylinderSizes;
use super::region::boundary;
use super::revolve::plane_similarity;
use super::state::Reader;
use super::{mesh, transform};
use rayweave_math::{Affine, Vec3};
use rayweave_polygon::Point;

/// All generators below a node. Operands of booleans all count, which is right for unions only.
pub(super) fn generators(reader: &Reader, root: usize, map: Affine) -> Result<Vec<Generator>, Refusal> {
    let mut found = Vec::new();
    let mut waiting = vec![(root, map)];
    while let Some((number, map)) = waiting.pop() {
        if !reader.live[number] {
            continue;
        }
        let node = &reader.tree.nodes[number];
        let arguments = reader.arguments(number);
        // a node costs a map, names and numbers
        arguments.spend(100)?;
        let mut inner = map;
        match node.name.as_str() {
            "group" | "union" | "render" | "color" | "hull" => {}
            "multmatrix" => inner = transform::matrix(&arguments)?.then(&map),
            "resize" => inner = reader.resized.get(&number).copied().unwrap_or(Affine::IDENTITY).then(&map),
            "linear_extrude" => {
                extruded(reader, number, &arguments, &map, &mut found)?;
                continue;
            }
            _ => {
                leaf(&arguments, &node.name, reader.options.facets, &map, &mut found)?;
                continue;
            }
        }
        waiting.extend(node.children.iter().rev().map(|child| (*child as usize, inner)));
    }
    Ok(found)
}

/// Decomposition of a node into a union of convex parts, each given by its generators.
pub(super) fn convex_parts(reader: &Reader, root: usize) -> Result<Vec<Vec<Generator>>, Refusal> {
    let mut parts = Vec::new();
    let mut waiting = vec![(root, Affine::IDENTITY)];
    while let Some((number, map)) = waiting.pop() {
        if !reader.live[number] {
            continue;
        }
        let node = &reader.tree.nodes[number];
        let arguments = reader.arguments(number);
        let inner = match node.name.as_str() {
            "group" | "union" | "render" | "color" => map,
            "multmatrix" => transform::matrix(&arguments)?.then(&map),
            name => {
                check_convex(reader, number, name, &arguments)?;
                parts.push(generators(reader, number, map)?);
                continue;
            }
        };
        waiting.extend(node.children.iter().rev().map(|child| (*child as usize, inner)));
    }
    Ok(parts)
}

/// Refuses parts of a Minkowski sum that are not known to be convex.
fn check_convex(reader: &Reader, number: usize, name: &str, arguments: &Arguments) -> Result<(), Refusal> {
    let is_convex = match name {
        "polyhedron" => mesh::is_convex(arguments)?,
        "linear_extrude" => match reader.extruded.get(&number) {
            None => true,
            Some(flat) => is_convex(arguments, &reader.flats, *flat)?,
        },
        _ => true,
    };
    match is_convex {
        true => Ok(()),
        false => Err(arguments.refusal("it is a part of a sum and not known to be convex")),
    }
}

/// Generators of a leaf node.
fn leaf(
    arguments: &Arguments,
    name: &str,
    facets: bool,
    map: &Affine,
    found: &mut Vec<Generator>,
) -> Result<(), Refusal> {
    let mut points = |all: Vec<Vec3>| found.extend(all.into_iter().map(|p| Generator::point(map.point(p))));
    match name {
        "cube" => points(cube(arguments)?),
        "polyhedron" => {
            let corners = polyhedron(arguments)?;
            arguments.spend(100 * corners.len())?;
            points(corners);
        }
        "sphere" => {
            let radius = arguments.number("r", 1.0)?;
            let fragments = Fineness::of(arguments)?.fragments(radius);
            match similarity(map).filter(|_| !facets) {
                Some(factor) if radius > 0.0 => {
                    found.push(Generator::Ball {
                        centre: map.translation,
                        radius: factor * radius,
                        fragments,
                    });
                }
                None if radius > 0.0 => {
                    check_count(arguments, fragments * fragments.div_ceil(2))?;
                    points(ring_points(&sphere_rings(radius, fragments), fragments));
                }
                _ => {}
            }
        }
        "cylinder" => {
            let Some(sizes) = CylinderSizes::of(arguments)? else { return Ok(()) };
            let fragments = Fineness::of(arguments)?.fragments(sizes.largest());
            match similarity(map).filter(|_| !facets) {
                Some(factor) => found.extend(sizes.rings().map(|ring| disc(ring, factor, map, fragments))),
                None => points(ring_points(&sizes.rings(), fragments)),
            }
        }
        _ => return Err(arguments.refusal("nothing that it is part of can be the hull of it")),
    }
    Ok(())
}

/// Scale factor of a similarity map, which keeps balls round. Tolerance: matrices are printed with six digits.
pub(super) fn similarity(map: &Affine) -> Option<f64> {
    let columns = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis];
    let lengths = columns.map(Vec3::length);
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let equal = lengths.iter().all(|length| longest - length <= 1e-5 * longest);
    let [x, y, z] = columns;
    let across = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|inner| inner.abs() <= 1e-5 * longest * longest);
    (equal && across && longest > 0.0).then(|| lengths.iter().sum::<f64>() / 3.0)
}

/// A ring (radius, z) under a similarity map.
fn disc([radius, z]: [f64; 2], factor: f64, map: &Affine, fragments: usize) -> Generator {
    let centre = map.point(Vec3::new(0.0, 0.0, z));
    let axis = map.vector(Vec3::Z).normalize();
    match radius > 0.0 {
        true => Generator::Disc { centre, axis, radius: factor * radius, fragments },
        false => Generator::point(centre),
    }
}

pub(super) fn cube(arguments: &Arguments) -> Result<Vec<Vec3>, Refusal> {
    let size = Vec3::from_array(arguments.point("size", 1.0)?);
    if size.min_element() <= 0.0 {
        return Ok(Vec::new());
    }
    let lo = if arguments.boolean("center", false)? { -0.5 * size } else { Vec3::ZERO };
    let corner = |k: u32| lo + size * Vec3::from_array([0, 1, 2].map(|bit| f64::from(k >> bit & 1)));
    Ok((0..8).map(corner).collect())
}

fn polyhedron(arguments: &Arguments) -> Result<Vec<Vec3>, Refusal> {
    let points = arguments.get("points", "a list of points (x, y, z), all finite", |value| {
        value.list()?.iter().map(vector).collect::<Option<Vec<Vec3>>>()
    })?;
    Ok(points.unwrap_or_default())
}

/// Generators of a linear extrusion: its bottom and top.
fn extruded(
    reader: &Reader,
    number: usize,
    arguments: &Arguments,
    map: &Affine,
    found: &mut Vec<Generator>,
) -> Result<(), Refusal> {
    let (Some(way), Some(flat)) = (Way::of(arguments)?, reader.extruded.get(&number)) else {
        return Ok(());
    };
    if arguments.number("twist", 0.0)? != 0.0 {
        return Err(arguments.refusal("the hull of what is twisted cannot be read"));
    }
    let ends = [(way.bottom, [1.0; 2]), (way.top, way.scale)];
    for (centre, radius, fragments) in round(arguments, &reader.flats, *flat)? {
        for (z, [fx, fy]) in ends {
            match similarity(map).filter(|_| radius > 0.0 && fx == fy && fx > 0.0) {
                Some(factor) => {
                    let here = Affine::translate(Vec3::new(fx * centre[0], fx * centre[1], 0.0)).then(map);
                    found.push(disc([fx * radius, z], factor, &here, fragments));
                }
                None => {
                    let corners = Leaf::Disc { radius, fragments }.contours().concat();
                    let corners = if radius > 0.0 { corners } else { vec![[0.0; 2]] };
                    let at = |p: Point| Vec3::new(fx * (centre[0] + p[0]), fy * (centre[1] + p[1]), z);
                    found.extend(corners.into_iter().map(|p| Generator::point(map.point(at(p)))));
                }
            }
        }
    }
    Ok(())
}

/// A disc of the plane with the number of its facets; radius 0 means a point.
pub(super) type Round = (Point, f64, usize);

/// Discs and points that generate the convex hull of a region: those of its leaves, or for differences and intersections
/// the vertices of its boundary.
pub(super) fn round(arguments: &Arguments, flats: &Flats, flat: Flat) -> Result<Vec<Round>, Refusal> {
    if !flats.is_union(arguments, flat)? {
        let contours = boundary(arguments, flats, flat)?;
        return Ok(contours.into_iter().flatten().map(|p| (p, 0.0, 1)).collect());
    }
    let of_leaf = |leaf: &Leaf, map: &Affine| {
        let point = |p: &Point| (image(map, *p), 0.0, 1);
        Ok(match (leaf, plane_similarity(map)) {
            (Leaf::Disc { radius, fragments }, Some(factor)) => {
                vec![(image(map, [0.0; 2]), factor * radius, *fragments)]
            }
            _ => leaf.contours().iter().flatten().map(point).collect(),
        })
    };
    flats.fold(arguments, flat, of_leaf, |_, parts| Ok(parts.concat()))
}

/// Convex hull of discs and points of the plane: the union of the discs and of the polygon of tangent points.
pub(super) fn hull_of_discs(
    arguments: &Arguments,
    flats: &mut Flats,
    discs: &[Round],
) -> Result<Part, Refusal> {
    let bare: Vec<(Point, f64)> = discs.iter().map(|(centre, radius, _)| (*centre, *radius)).collect();
    let mut parts = Vec::new();
    let corners = touching_points(&bare, |steps| arguments.spend(20 * steps))?;
    if corners.len() >= 3 {
        parts.push(flats.leaf(Leaf::Outline(vec![corners])));
    }
    for (centre, radius, fragments) in discs.iter().filter(|disc| disc.1 > 0.0) {
        let disc = flats.leaf(Leaf::Disc { radius: *radius, fragments: *fragments });
        parts.push(flats.moved(Affine::translate(Vec3::new(centre[0], centre[1], 0.0)), disc));
    }
    // later operations go over all parts
    arguments.spend(500 * parts.len())?;
    Ok(match parts.is_empty() {
        true => Part::Empty,
        false => flats.join(Operation::Union, parts).into(),
    })
}

/// The leaves of a union, with their maps.
pub(super) fn leaves(
    arguments: &Arguments,
    flats: &Flats,
    flat: Flat,
) -> Result<Vec<(Leaf, Affine)>, Refusal> {
    if !flats.is_union(arguments, flat)? {
        return Err(arguments.refusal("the boundary of what is cut out of something is not known"));
    }
    flats.fold(arguments, flat, |leaf, map| Ok(vec![(leaf.clone(), *map)]), |_, parts| Ok(parts.concat()))
}

/// True if the region is a single convex leaf.
pub(super) fn is_convex(arguments: &Arguments, flats: &Flats, flat: Flat) -> Result<bool, Refusal> {
    match flats.is_union(arguments, flat)? {
        true => match &leaves(arguments, flats, flat)?[..] {
            [(leaf, _)] => is_convex_leaf(arguments, leaf),
            _ => Ok(false),
        },
        false => Ok(false),
    }
}

pub(super) fn is_convex_leaf(arguments: &Arguments, leaf: &Leaf) -> Result<bool, Refusal> {
    match leaf {
        Leaf::Disc { .. } => Ok(true),
        Leaf::Outline(contours) => match &contours[..] {
            [contour] => {
                Ok(simple(arguments, contour.clone())?.is_some_and(|polygons| is_one_cell(&polygons)))
            }
            _ => Ok(false),
        },
    }
}
