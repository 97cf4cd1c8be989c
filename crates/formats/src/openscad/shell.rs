//! What bounds the solids below an item, in facets: for sections, shadows, sizes, and hulls that have no closed form.
//!
//! A section of a boolean is the boolean of the sections, so that nothing has to be cut but single shells.

use super::arguments::{Arguments, Refusal};
use super::body::body;
use super::boolean::Operation;
use super::convex_hull::{MOST_POINTS, convex_hull};
use super::drawing::chords;
use super::extrude::Way;
use super::facets::{Fineness, sphere_rings};
use super::hull2::corners;
use super::mesh::{self, Twist};
use super::primitive::CylinderSizes;
use super::reader::Reader;
use super::region::{Contours, area, boundary, check_near, filled, join_contours};
use super::transform;
use crate::kernel::triangulated;
use i_overlay::core::fill_rule::FillRule;
use rayweave_math::{Affine, Vec3, sin_cos_degrees};
use rayweave_space::Point;
use std::collections::HashMap;

/// More triangles than these take longer than a reader should.
const MOST_TRIANGLES: usize = 500_000;

/// Triangles; inside is what a line reaches after an odd number of crossings.
#[derive(Clone, Debug, Default)]
pub(super) struct Shell {
    pub vertices: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Known to be the hull of the vertices.
    pub is_convex: bool,
}

impl Shell {
    /// The hull of points; nothing, if they lie in a plane.
    pub fn hull(arguments: &Arguments, points: Vec<Vec3>) -> Result<Shell, Refusal> {
        if points.len() > MOST_POINTS {
            return Err(arguments.refusal(&format!("it has more than {MOST_POINTS} points")));
        }
        let faces = convex_hull(&points).unwrap_or_default();
        let triangles = faces.into_iter().map(|corners| corners.map(|k| k as u32)).collect();
        Ok(Shell { vertices: points, triangles, is_convex: true })
    }
}

/// What is still to be done on a walk.
enum Task {
    Visit(usize, Affine),
    Join(Operation, usize),
}

/// Where a walk begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Start {
    /// At an item.
    Item(usize),
    /// At the children of an item that asks about them, taken as their union.
    Below(usize),
}

impl Start {
    pub fn number(self) -> usize {
        match self {
            Start::Item(number) | Start::Below(number) => number,
        }
    }
}

/// What `make` makes of the shells of each item there, joined as they are.
pub(super) fn fold<T>(
    reader: &Reader,
    from: Start,
    mut make: impl FnMut(&Arguments, &[Shell], &Affine) -> Result<T, Refusal>,
    mut join: impl FnMut(Operation, Vec<T>) -> T,
) -> Result<T, Refusal> {
    let mut tasks = vec![Task::Visit(from.number(), Affine::IDENTITY)];
    let mut made = Vec::new();
    while let Some(task) = tasks.pop() {
        let (number, map) = match task {
            Task::Join(operation, count) => {
                let operands = made.split_off(made.len() - count.min(made.len()));
                made.push(join(operation, operands));
                continue;
            }
            Task::Visit(number, map) => (number, map),
        };
        let node = &reader.tree.nodes[number];
        let arguments = Arguments::new(reader.source, node);
        reader.spend(&arguments, 20)?;
        match structure(reader, number, from, &arguments)? {
            Some((operation, inner)) => {
                let children: Vec<usize> =
                    node.children.iter().map(|k| *k as usize).filter(|k| reader.live[*k]).collect();
                tasks.push(Task::Join(operation, children.len()));
                let map = inner.then(&map);
                tasks.extend(children.into_iter().rev().map(|child| Task::Visit(child, map)));
            }
            None => {
                let shells = shells(reader, number, &arguments)?;
                let triangles = shells.iter().map(|shell| shell.triangles.len()).sum::<usize>();
                reader.spend(&arguments, 20 * triangles)?;
                if triangles > MOST_TRIANGLES {
                    return Err(arguments.refusal(&format!("it has more than {MOST_TRIANGLES} facets")));
                }
                made.push(make(&arguments, &shells, &map)?);
            }
        }
    }
    // the first task made the last one
    made.pop().ok_or_else(|| {
        Arguments::new(reader.source, &reader.tree.nodes[from.number()]).refusal("nothing is in it")
    })
}

/// How the children of an item are joined, and under which map; `None` for items that are shells themselves.
fn structure(
    reader: &Reader,
    number: usize,
    from: Start,
    arguments: &Arguments,
) -> Result<Option<(Operation, Affine)>, Refusal> {
    let name = reader.tree.nodes[number].name.as_str();
    let map = match name {
        "multmatrix" => transform::matrix(arguments)?,
        "resize" if from != Start::Below(number) => {
            reader.resized.get(&number).copied().unwrap_or(Affine::IDENTITY)
        }
        _ => Affine::IDENTITY,
    };
    let operation = match name {
        "group" | "union" | "render" | "color" | "multmatrix" | "resize" => Operation::Union,
        "difference" => Operation::Difference,
        "intersection" => Operation::Intersection,
        // what is asked for is about its children
        _ if from == Start::Below(number) => Operation::Union,
        _ => return Ok(None),
    };
    Ok(Some((operation, map)))
}

/// True if nothing below a node is cut.
pub(super) fn is_union(reader: &Reader, root: usize) -> Result<bool, Refusal> {
    fold(
        reader,
        Start::Below(root),
        |_, _, _| Ok(true),
        |operation, parts| {
            (operation == Operation::Union || parts.len() < 2) && parts.iter().all(|part| *part)
        },
    )
}

/// The shells of an item: it is their union.
fn shells(reader: &Reader, number: usize, arguments: &Arguments) -> Result<Vec<Shell>, Refusal> {
    if let Some(known) = reader.shells.get(&number) {
        return Ok(known.clone());
    }
    let fragments = |radius: f64| Ok::<_, Refusal>(round(reader, Fineness::of(arguments)?.fragments(radius)));
    let rings = |rings: &[[f64; 2]], fragments| {
        let (vertices, triangles) = mesh::between_rings(rings, fragments);
        vec![Shell { vertices, triangles, is_convex: true }]
    };
    Ok(match reader.tree.nodes[number].name.as_str() {
        "cube" => vec![Shell::hull(arguments, super::gather::cube(arguments)?)?],
        "sphere" => {
            let radius = arguments.number("r", 1.0)?;
            let fragments = fragments(radius)?;
            if radius > 0.0 { rings(&sphere_rings(radius, fragments), fragments) } else { Vec::new() }
        }
        "cylinder" => match CylinderSizes::of(arguments)? {
            Some(sizes) => rings(&sizes.rings(), fragments(sizes.largest())?),
            None => Vec::new(),
        },
        "polyhedron" => {
            let (vertices, triangles) = mesh::parts(arguments)?;
            let triangles = triangles.into_iter().map(|corners| corners.map(|k| k as u32)).collect();
            vec![Shell { vertices, triangles, is_convex: false }]
        }
        "linear_extrude" => match (Way::of(arguments)?, reader.extruded.get(&number)) {
            (Some(way), Some(flat)) => {
                let twist = Twist::new(arguments, &reader.flats, *flat, &way)?;
                vec![twist.shell(arguments, boundary(arguments, &reader.flats, *flat)?)?]
            }
            _ => Vec::new(),
        },
        "rotate_extrude" => match reader.extruded.get(&number) {
            Some(flat) => {
                let contours = boundary(arguments, &reader.flats, *flat)?;
                let reach = contours.iter().flatten().fold(0f64, |reach, p| reach.max(p[0].abs()));
                let count = fragments(reach)?;
                vec![turned(arguments, &contours, count)?]
            }
            None => Vec::new(),
        },
        _ => return Err(arguments.refusal("what bounds it is not known")),
    })
}

/// The facets of a circle of so many fragments in the dump; where round shapes are truly round, fine ones.
fn round(reader: &Reader, fragments: usize) -> usize {
    if reader.options.facets {
        return fragments;
    }
    reader.flats.has_chords.set(true);
    fragments.max(chords(360.0))
}

/// Contours turned about the z axis, in rings that begin where the dump says.
fn turned(arguments: &Arguments, contours: &Contours, full: usize) -> Result<Shell, Refusal> {
    let angle = arguments.number("angle", 360.0)?.clamp(-360.0, 360.0);
    let is_whole = angle.abs() >= 360.0;
    let start = arguments.number("start", if is_whole { 180.0 } else { 0.0 })?;
    let steps = ((full as f64 * angle.abs() / 360.0).floor() as usize).max(1);
    let rings = if is_whole { steps } else { steps + 1 };
    let n = contours.iter().map(Vec::len).sum::<usize>();
    if n.saturating_mul(2 * rings) > MOST_TRIANGLES {
        return Err(arguments.refusal(&format!("it has more than {MOST_TRIANGLES} facets")));
    }
    let ring = |k: usize| {
        let (sin, cos) = sin_cos_degrees(start + angle * k as f64 / steps as f64);
        contours.iter().flatten().map(move |p| Vec3::new(cos * p[0], sin * p[0], p[1]))
    };
    let n = n as u32;
    let mut triangles = Vec::new();
    for k in 0..steps as u32 {
        let [a, b] = [k * n, (k + 1) % rings as u32 * n];
        for [i, j] in edges(contours) {
            triangles.extend([[a + i, b + i, b + j], [a + i, b + j, a + j]]);
        }
    }
    if !is_whole {
        let last = steps as u32 * n;
        let ends = triangulated(contours);
        triangles.extend(ends.iter().flat_map(|t| [*t, [last + t[0], last + t[2], last + t[1]]]));
    }
    Ok(Shell { vertices: (0..rings).flat_map(ring).collect(), triangles, is_convex: false })
}

/// The edges of contours, whose points are numbered one contour after the other.
pub(super) fn edges(contours: &Contours) -> impl Iterator<Item = [u32; 2]> {
    let mut start = 0;
    contours.iter().flat_map(move |contour| {
        let (first, n) = (start, contour.len() as u32);
        start += n;
        (0..n).map(move |k| [first + k, first + (k + 1) % n])
    })
}

/// Just above or just below a height: a face at the height itself belongs to one side only.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Above,
    Below,
}

/// `projection(cut = true)`: what lies in the plane z = 0, faces that end there counted.
pub(super) fn section(reader: &Reader, root: usize) -> Result<Contours, Refusal> {
    let above = section_at(reader, root, 0.0, Side::Above)?;
    let below = section_at(reader, root, 0.0, Side::Below)?;
    Ok(if above == below { above } else { join_contours(Operation::Union, vec![above, below]) })
}

fn section_at(reader: &Reader, root: usize, height: f64, side: Side) -> Result<Contours, Refusal> {
    let cut = |arguments: &Arguments, shells: &[Shell], map: &Affine| {
        let section = |shell| filled(arguments, &cut(shell, map, height, side), FillRule::EvenOdd);
        let all = shells.iter().map(section).collect::<Result<Vec<_>, _>>()?;
        Ok(join_contours(Operation::Union, all))
    };
    fold(reader, Start::Below(root), cut, join_contours)
}

/// The closed chains in which a plane cuts a shell.
fn cut(shell: &Shell, map: &Affine, height: f64, side: Side) -> Contours {
    let vertices: Vec<Vec3> = shell.vertices.iter().map(|p| map.point(*p)).collect();
    let is_above = |k: u32| match side {
        Side::Above => vertices[k as usize].z > height,
        Side::Below => vertices[k as usize].z >= height,
    };
    let mut segments: Vec<[(u32, u32); 2]> = Vec::new();
    for t in &shell.triangles {
        let crossed = [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]
            .into_iter()
            .filter(|(a, b)| is_above(*a) != is_above(*b));
        // one name for an edge, from whichever triangle it is met
        let mut ends = crossed.map(|(a, b)| (a.min(b), a.max(b)));
        if let (Some(a), Some(b)) = (ends.next(), ends.next()) {
            segments.push([a, b]);
        }
    }
    let mut at: HashMap<(u32, u32), Vec<usize>> = HashMap::new();
    for (k, ends) in segments.iter().enumerate() {
        ends.iter().for_each(|end| at.entry(*end).or_default().push(k));
    }
    let size = vertices.iter().fold(0f64, |size, p| size.max(p.x.abs()).max(p.y.abs()));
    let point = |(a, b): (u32, u32)| {
        let (p, q) = (vertices[a as usize], vertices[b as usize]);
        let t = ((height - p.z) / (q.z - p.z)).clamp(0.0, 1.0);
        [p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)].map(|x| snapped(x, size))
    };
    let mut used = vec![false; segments.len()];
    let mut contours = Contours::new();
    for start in 0..segments.len() {
        let (mut next, mut end) = (Some(start).filter(|k| !used[*k]), segments[start][0]);
        let mut contour = Vec::new();
        while let Some(k) = next {
            used[k] = true;
            contour.push(point(end));
            end = if segments[k][0] == end { segments[k][1] } else { segments[k][0] };
            next = at[&end].iter().copied().find(|k| !used[*k]);
        }
        if contour.len() >= 3 {
            contours.push(contour);
        }
    }
    contours
}

/// A number on a grid of 2^-36 of a size: what is equal but for rounding becomes equal, and leaves no slivers.
fn snapped(x: f64, size: f64) -> f64 {
    let grid = size * 2f64.powi(-36);
    if grid > 0.0 { (x / grid).round() * grid } else { x }
}

/// `projection(cut = false)`: the shadow along z of all facets.
pub(super) fn shadow(reader: &Reader, root: usize) -> Result<Contours, Refusal> {
    if !is_union(reader, root)? {
        let body = body(reader, Start::Below(root))?;
        let arguments = Arguments::new(reader.source, &reader.tree.nodes[root]);
        let shade = |body| shade(&arguments, &Shell::of_body(&body), &Affine::IDENTITY);
        return body.map_or_else(|| Ok(Contours::new()), shade);
    }
    let of_shells = |arguments: &Arguments, shells: &[Shell], map: &Affine| {
        let all = shells.iter().map(|shell| shade(arguments, shell, map)).collect::<Result<_, _>>()?;
        Ok(join_contours(Operation::Union, all))
    };
    fold(reader, Start::Below(root), of_shells, join_contours)
}

/// The shadow of a shell: of one that is convex the hull of its points, of others the union of the shadows of its triangles.
fn shade(arguments: &Arguments, shell: &Shell, map: &Affine) -> Result<Contours, Refusal> {
    let mut points: Vec<Point<2>> =
        shell.vertices.iter().map(|p| map.point(*p)).map(|p| [p.x, p.y]).collect();
    if shell.is_convex {
        // the kernel meets it when it is joined with others
        let hull: Contours = vec![corners(points)].into_iter().filter(|contour| contour.len() >= 3).collect();
        return check_near(arguments, &hull).map(|()| hull);
    }
    let size = points.iter().flatten().fold(0f64, |size, x| size.max(x.abs()));
    points.iter_mut().flatten().for_each(|x| *x = snapped(*x, size));
    let mut triangles: Contours =
        shell.triangles.iter().map(|corners| corners.map(|k| points[k as usize]).to_vec()).collect();
    triangles.retain(|triangle| area(triangle) != 0.0);
    triangles.iter_mut().filter(|triangle| area(triangle) < 0.0).for_each(|triangle| triangle.reverse());
    filled(arguments, &triangles, FillRule::NonZero)
}

/// The corners of the facets below a node: what it is has their hull, and their box.
pub(super) fn corner_points(reader: &Reader, root: usize) -> Result<Vec<Vec3>, Refusal> {
    if !is_union(reader, root)? {
        return Ok(body(reader, Start::Below(root))?.map_or_else(Vec::new, |body| body.triangles().0));
    }
    let of_shells = |_: &Arguments, shells: &[Shell], map: &Affine| {
        let corners = |shell: &Shell| shell.triangles.iter().flatten().map(|k| *k as usize).collect();
        let of_shell = |shell: &Shell| {
            let mut used: Vec<usize> = corners(shell);
            used.sort_unstable();
            used.dedup();
            used.into_iter().map(|k| map.point(shell.vertices[k])).collect::<Vec<_>>()
        };
        Ok(shells.iter().flat_map(of_shell).collect())
    };
    fold(reader, Start::Below(root), of_shells, |_, parts: Vec<Vec<Vec3>>| parts.concat())
}

#[cfg(test)]
mod tests {
    use super::super::region::filled_near;
    use super::*;

    #[test]
    fn a_cube_is_cut_on_both_sides_of_its_floor() {
        let rings = [[2f64.sqrt(), 1.0], [2f64.sqrt(), 0.0]];
        let (vertices, triangles) = mesh::between_rings(&rings, 4);
        let shell = Shell { vertices, triangles, is_convex: true };
        let size = |height, side| {
            let contours = filled_near(&cut(&shell, &Affine::IDENTITY, height, side), FillRule::EvenOdd);
            contours.iter().map(|contour| area(contour)).sum::<f64>()
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(size(0.5, Side::Above), 4.0) && near(size(0.0, Side::Above), 4.0));
        assert_eq!(size(0.0, Side::Below), 0.0);
        assert!(near(size(1.0, Side::Below), 4.0));
        assert_eq!(size(1.0, Side::Above), 0.0);
    }
}
