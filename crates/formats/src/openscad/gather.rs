//! Generators of convex hulls: the points, balls and discs below a node.

use super::arguments::{Arguments, Refusal, vector};
use super::extent::Way;
use super::extrude::is_convex as is_one_cell;
use super::facets::{Fineness, ring_points, sphere_rings};
use super::flat::{Flat, Flats, Leaf, image, simple};
use super::hull::{Generator, check_count};
use super::hull2::{corners, touching_points};
use super::operation::Operation;
use super::part::Part;
use super::primitive::CylinderSizes;
use super::region::{Contours, boundary};
use super::revolve::plane_similarity;
use super::sector::{Sectors, profile};
use super::state::Reader;
use super::{mesh, transform};
use crate::kernel::triangulated;
use rayweave_math::{Affine, Vec3};
use rayweave_polygon::Point;
use std::collections::HashMap;

/// Maximum number of pairs of convex parts, which only unions of many parts exceed.
pub(super) const MAX_SUMS: usize = 2000;

/// All generators below a node. All operands of booleans count, which is correct only for unions.
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
            "rotate_extrude" => {
                turned(reader, number, &arguments, &map, &mut found)?;
                continue;
            }
            _ => {
                leaf(&arguments, &node.name, reader.is_faceted(&arguments), &map, &mut found)?;
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
            "linear_extrude" | "rotate_extrude" if !is_convex_item(reader, number, &arguments)? => {
                parts.extend(pieces_of(reader, number, &arguments, &map)?);
                continue;
            }
            _ => {
                check_convex(reader, number, &arguments)?;
                parts.push(generators(reader, number, map)?);
                continue;
            }
        };
        waiting.extend(node.children.iter().rev().map(|child| (*child as usize, inner)));
    }
    Ok(parts)
}

/// Refuses parts of a Minkowski sum that are not known to be convex.
fn check_convex(reader: &Reader, number: usize, arguments: &Arguments) -> Result<(), Refusal> {
    match is_convex_item(reader, number, arguments)? {
        true => Ok(()),
        false => Err(arguments.refusal("it is part of a Minkowski sum but not known to be convex")),
    }
}

/// True if an item without children, or an extrusion, is convex.
fn is_convex_item(reader: &Reader, number: usize, arguments: &Arguments) -> Result<bool, Refusal> {
    match (reader.tree.nodes[number].name.as_str(), reader.extruded.get(&number)) {
        ("polyhedron", _) => mesh::is_convex(arguments),
        ("linear_extrude", Some(flat)) => is_convex(arguments, &reader.flats, *flat),
        ("rotate_extrude", Some(_)) => Ok(false),
        _ => Ok(true),
    }
}

/// Decomposition of an extrusion into convex parts: pieces of its region, over which there are prisms or sectors.
fn pieces_of(
    reader: &Reader,
    number: usize,
    arguments: &Arguments,
    map: &Affine,
) -> Result<Vec<Vec<Generator>>, Refusal> {
    let Some(flat) = reader.extruded.get(&number) else { return Ok(Vec::new()) };
    let is_straight = reader.tree.nodes[number].name == "linear_extrude";
    let contours = match is_straight {
        true => boundary(arguments, &reader.flats, *flat)?,
        false => profile(reader, arguments, *flat)?,
    };
    let pieces = convex_pieces(arguments, &contours)?;
    let mut parts = Vec::new();
    if is_straight {
        let Some(way) = Way::of(arguments)? else { return Ok(Vec::new()) };
        if arguments.number("twist", 0.0)? != 0.0 || !way.is_even() {
            return Err(arguments.refusal("it is part of a Minkowski sum but not known to be convex"));
        }
        let [factor, _] = way.scale;
        for piece in pieces {
            let ends = [(way.bottom, 1.0), (way.top, factor)];
            let corners = ends
                .into_iter()
                .flat_map(|(z, by)| piece.iter().map(move |p| Vec3::new(by * p[0], by * p[1], z)));
            parts.push(corners.map(|p| Generator::point(map.point(p))).collect());
        }
        return Ok(parts);
    }
    let steps = Sectors::of(reader, arguments, &contours)?;
    if pieces.len().saturating_mul(steps.count) > MAX_SUMS {
        return Err(arguments.refusal(&format!("it has more than {MAX_SUMS} convex parts")));
    }
    for piece in &pieces {
        for k in 0..steps.count {
            let corners = [k, k + 1].into_iter().flat_map(|k| piece.iter().map(move |p| (k, p)));
            let point = |(k, p): (usize, &Point)| Generator::point(map.point(steps.point(k, *p)));
            parts.push(corners.map(point).collect());
        }
    }
    Ok(parts)
}

/// Decomposition of a region into convex polygons: triangles, joined across common edges while the result is convex.
///
/// *Source*: S. Hertel, K. Mehlhorn, "Fast triangulation of the plane with respect to simple polygons", 1983.
fn convex_pieces(arguments: &Arguments, contours: &Contours) -> Result<Vec<Vec<Point>>, Refusal> {
    let points: Vec<Point> = contours.concat();
    arguments.spend(5000 * points.len())?;
    let triangles = triangulated(contours);
    let mut pieces: Vec<Option<Vec<u32>>> = triangles.iter().map(|t| Some(t.to_vec())).collect();
    // the piece on the left of each directed edge
    let mut left: HashMap<[u32; 2], usize> = HashMap::new();
    for (k, [a, b, c]) in triangles.iter().copied().enumerate() {
        left.extend([[a, b], [b, c], [c, a]].map(|edge| (edge, k)));
    }
    for [a, b] in triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]) {
        let (Some(&one), Some(&other)) = (left.get(&[a, b]), left.get(&[b, a])) else { continue };
        let (Some(p), Some(q)) = (&pieces[one], &pieces[other]) else { continue };
        if one == other {
            continue;
        }
        // from b around to a, then on to b through the other piece
        let from = |piece: &[u32], start: u32| {
            let at = piece.iter().position(|k| *k == start).unwrap_or(0);
            piece[at..].iter().chain(&piece[..at]).copied().collect::<Vec<u32>>()
        };
        let (mut joined, rest) = (from(p, b), from(q, a));
        arguments.spend(20 * (joined.len() + rest.len()))?;
        joined.extend(&rest[1..rest.len() - 1]);
        if !is_convex_chain(&points, &joined) {
            continue;
        }
        for k in 0..joined.len() {
            left.insert([joined[k], joined[(k + 1) % joined.len()]], one);
        }
        left.remove(&[a, b]);
        left.remove(&[b, a]);
        pieces[one] = Some(joined);
        pieces[other] = None;
    }
    let corners = |piece: Vec<u32>| piece.into_iter().map(|k| points[k as usize]).collect();
    Ok(pieces.into_iter().flatten().map(corners).collect())
}

/// True if a closed chain of points has no right turn.
fn is_convex_chain(points: &[Point], chain: &[u32]) -> bool {
    let n = chain.len();
    (0..n).all(|k| {
        let [a, b, c] = [k, k + 1, k + 2].map(|k| points[chain[k % n] as usize]);
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) >= 0.0
    })
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
        _ => return Err(arguments.refusal("its hull cannot be computed")),
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
        return Err(arguments.refusal("the hull of a twisted extrusion cannot be computed"));
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

/// Generators of a rotate extrusion: the discs of the corners of its profile or, for a partial turn or with facets, the
/// vertices of its facets.
fn turned(
    reader: &Reader,
    number: usize,
    arguments: &Arguments,
    map: &Affine,
    found: &mut Vec<Generator>,
) -> Result<(), Refusal> {
    let Some(flat) = reader.extruded.get(&number) else { return Ok(()) };
    let contours = profile(reader, arguments, *flat)?;
    let sectors = Sectors::of(reader, arguments, &contours)?;
    // the corners of the hull of the profile and its mirror image
    let mirrored = contours.iter().flatten().flat_map(|p| [*p, [-p[0], p[1]]]).collect();
    let profile: Vec<Point> = corners(mirrored).into_iter().filter(|p| p[0] >= 0.0).collect();
    match similarity(map).filter(|_| sectors.is_whole && !reader.is_faceted(arguments)) {
        Some(factor) => {
            let fragments = sectors.count;
            found.extend(profile.iter().map(|[radius, z]| disc([*radius, *z], factor, map, fragments)));
        }
        None => {
            let profile = if sectors.is_whole { profile } else { contours.concat() };
            let rings = sectors.count + usize::from(!sectors.is_whole);
            check_count(arguments, profile.len().saturating_mul(rings))?;
            for k in 0..rings {
                found.extend(profile.iter().map(|p| Generator::point(map.point(sectors.point(k, *p)))));
            }
        }
    }
    Ok(())
}

/// A disc of the plane with the number of its facets; radius 0 means a point.
pub(super) type Round = (Point, f64, usize);

/// Discs and points that generate the convex hull of a region: those of its leaves or, for differences and intersections,
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
        parts.push(flats.transformed(Affine::translate(Vec3::new(centre[0], centre[1], 0.0)), disc));
    }
    // later operations visit all parts
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
        return Err(arguments.refusal("the boundary of a difference or intersection is unknown"));
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
