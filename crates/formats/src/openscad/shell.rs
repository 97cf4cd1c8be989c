//! What bounds the solids below an item, in facets: for sections, shadows, sizes, and hulls that have no closed form.
//!
//! A section of a boolean is the boolean of the sections, so that nothing has to be cut but single shells.

use super::arguments::{Arguments, Refusal};
use super::boolean::Operation;
use super::convex_hull::{MOST_POINTS, convex_hull};
use super::extrude::Way;
use super::facets::{Fineness, sphere_rings};
use super::hull2::corners;
use super::mesh::{self, Twist};
use super::primitive::CylinderSizes;
use super::reader::Reader;
use super::region::{Contours, area, boundary, filled, join_contours};
use super::transform;
use i_overlay::core::fill_rule::FillRule;
use rayweave_math::{Affine, Vec3, sin_cos_degrees};
use rayweave_space::Point;
use std::collections::HashMap;

/// Facets of round shapes that are truly round elsewhere: off by 3.5e-4 of their radius.
const FINE: usize = 120;

/// More triangles than these take longer than a reader should.
const MOST_TRIANGLES: usize = 500_000;

/// Heights at which a shadow, or a hull, of what is cut is looked at.
const SLICES: usize = 100;

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

/// What `make` makes of the shells of each item below a node, joined as they are.
pub(super) fn fold<T>(
    reader: &Reader,
    root: usize,
    mut make: impl FnMut(&Arguments, &[Shell], &Affine) -> Result<T, Refusal>,
    mut join: impl FnMut(Operation, Vec<T>) -> T,
) -> Result<T, Refusal> {
    let mut tasks = vec![Task::Visit(root, Affine::IDENTITY)];
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
        match structure(reader, number, root, &arguments)? {
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
    made.pop()
        .ok_or_else(|| Arguments::new(reader.source, &reader.tree.nodes[root]).refusal("nothing is in it"))
}

/// How the children of an item are joined, and under which map; `None` for items that are shells themselves.
fn structure(
    reader: &Reader,
    number: usize,
    root: usize,
    arguments: &Arguments,
) -> Result<Option<(Operation, Affine)>, Refusal> {
    let name = reader.tree.nodes[number].name.as_str();
    let map = match name {
        "multmatrix" => transform::matrix(arguments)?,
        "resize" if number != root => reader.resized.get(&number).copied().unwrap_or(Affine::IDENTITY),
        _ => Affine::IDENTITY,
    };
    let operation = match name {
        "group" | "union" | "render" | "color" | "multmatrix" | "resize" => Operation::Union,
        "difference" => Operation::Difference,
        "intersection" => Operation::Intersection,
        // what is asked for is about its children
        _ if number == root => Operation::Union,
        _ => return Ok(None),
    };
    Ok(Some((operation, map)))
}

/// True if nothing below a node is cut.
pub(super) fn is_union(reader: &Reader, root: usize) -> Result<bool, Refusal> {
    fold(
        reader,
        root,
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
                let (vertices, triangles) =
                    twist.towers(arguments, boundary(arguments, &reader.flats, *flat)?)?;
                vec![Shell { vertices, triangles, is_convex: false }]
            }
            _ => Vec::new(),
        },
        "rotate_extrude" => match reader.extruded.get(&number) {
            Some(flat) => {
                let contours = boundary(arguments, &reader.flats, *flat)?;
                let reach = contours.iter().flatten().fold(0f64, |reach, p| reach.max(p[0].abs()));
                let count = fragments(reach)?;
                contours.iter().map(|contour| turned(arguments, contour, count)).collect::<Result<_, _>>()?
            }
            None => Vec::new(),
        },
        _ => return Err(arguments.refusal("what bounds it is not known")),
    })
}

/// The facets of a circle of so many fragments in the dump.
fn round(reader: &Reader, fragments: usize) -> usize {
    if reader.options.facets {
        return fragments;
    }
    reader.flats.has_chords.set(true);
    fragments.max(FINE)
}

/// A contour turned about the z axis, in rings that begin where the dump says.
fn turned(arguments: &Arguments, contour: &[Point<2>], full: usize) -> Result<Shell, Refusal> {
    let angle = arguments.number("angle", 360.0)?.clamp(-360.0, 360.0);
    let is_whole = angle.abs() >= 360.0;
    let start = arguments.number("start", if is_whole { 180.0 } else { 0.0 })?;
    let steps = ((full as f64 * angle.abs() / 360.0).floor() as usize).max(1);
    let rings = if is_whole { steps } else { steps + 1 };
    let n = contour.len() as u32;
    if contour.len().saturating_mul(rings) > MOST_TRIANGLES {
        return Err(arguments.refusal(&format!("it has more than {MOST_TRIANGLES} facets")));
    }
    let ring = |k: usize| {
        let (sin, cos) = sin_cos_degrees(start + angle * k as f64 / steps as f64);
        contour.iter().map(move |p| Vec3::new(cos * p[0], sin * p[0], p[1]))
    };
    let mut triangles = Vec::new();
    for k in 0..steps as u32 {
        let [a, b] = [k * n, (k + 1) % rings as u32 * n];
        for i in 0..n {
            let j = (i + 1) % n;
            triangles.extend([[a + i, b + i, b + j], [a + i, b + j, a + j]]);
        }
    }
    if !is_whole {
        let last = steps as u32 * n;
        triangles.extend((1..n - 1).flat_map(|k| [[0, k, k + 1], [last, last + k + 1, last + k]]));
    }
    Ok(Shell { vertices: (0..rings).flat_map(ring).collect(), triangles, is_convex: false })
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
    let cut = |_: &Arguments, shells: &[Shell], map: &Affine| {
        let all = shells.iter().map(|shell| filled(&cut(shell, map, height, side), FillRule::EvenOdd));
        Ok(join_contours(Operation::Union, all.collect()))
    };
    fold(reader, root, cut, join_contours)
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

/// The heights of vertices, thinned out, and some between them.
fn heights(reader: &Reader, root: usize) -> Result<Vec<f64>, Refusal> {
    let of_shells = |_: &Arguments, shells: &[Shell], map: &Affine| {
        Ok(shells.iter().flat_map(|shell| &shell.vertices).map(|p| map.point(*p).z).collect::<Vec<f64>>())
    };
    let mut all = fold(reader, root, of_shells, |_, parts| parts.concat())?;
    all.sort_by(f64::total_cmp);
    all.dedup();
    let (Some(&lo), Some(&hi)) = (all.first(), all.last()) else { return Ok(Vec::new()) };
    let step = all.len().div_ceil(SLICES);
    let mut chosen: Vec<f64> = all.into_iter().step_by(step.max(1)).collect();
    chosen.extend((1..SLICES).map(|k| lo + (hi - lo) * k as f64 / SLICES as f64));
    Ok(chosen)
}

/// Sections at many heights.
fn slices(reader: &Reader, root: usize) -> Result<Vec<(f64, Contours)>, Refusal> {
    let mut all = Vec::new();
    let mut heights = heights(reader, root)?;
    heights.sort_by(f64::total_cmp);
    for &height in &heights {
        for side in [Side::Above, Side::Below] {
            let contours = section_at(reader, root, height, side)?;
            // a prism has one section at all heights
            if all.last().is_none_or(|(_, last)| *last != contours) || height == heights[heights.len() - 1] {
                all.push((height, contours));
            }
        }
    }
    Ok(all)
}

/// `projection(cut = false)`: the shadow along z, and whether it is that of all facets. What is cut is looked at in slices.
pub(super) fn shadow(reader: &Reader, root: usize) -> Result<(Contours, bool), Refusal> {
    if !is_union(reader, root)? {
        let all = slices(reader, root)?.into_iter().map(|(_, contours)| contours).collect();
        return Ok((join_contours(Operation::Union, all), false));
    }
    let of_shells = |_: &Arguments, shells: &[Shell], map: &Affine| {
        let all = shells.iter().map(|shell| shade(shell, map)).collect();
        Ok(join_contours(Operation::Union, all))
    };
    Ok((fold(reader, root, of_shells, join_contours)?, true))
}

/// The shadow of a shell: of one that is convex the hull of its points, of others the union of the shadows of its triangles.
fn shade(shell: &Shell, map: &Affine) -> Contours {
    let mut points: Vec<Point<2>> =
        shell.vertices.iter().map(|p| map.point(*p)).map(|p| [p.x, p.y]).collect();
    if shell.is_convex {
        return vec![corners(points)].into_iter().filter(|contour| contour.len() >= 3).collect();
    }
    let size = points.iter().flatten().fold(0f64, |size, x| size.max(x.abs()));
    points.iter_mut().flatten().for_each(|x| *x = snapped(*x, size));
    let mut triangles: Contours =
        shell.triangles.iter().map(|corners| corners.map(|k| points[k as usize]).to_vec()).collect();
    triangles.retain(|triangle| area(triangle) != 0.0);
    triangles.iter_mut().filter(|triangle| area(triangle) < 0.0).for_each(|triangle| triangle.reverse());
    filled(&triangles, FillRule::NonZero)
}

/// Points whose box is that of a solid, and whether that is certain.
#[derive(Clone, Debug)]
pub(super) struct Extent {
    pub points: Vec<Vec3>,
    pub is_exact: bool,
}

impl Extent {
    /// The lower and the upper corner of the box; `None` without points.
    pub fn bounds(&self) -> Option<[Vec3; 2]> {
        let first = *self.points.first()?;
        Some(self.points.iter().fold([first; 2], |[lo, hi], p| [lo.min(*p), hi.max(*p)]))
    }

    fn joined(operation: Operation, parts: Vec<Extent>) -> Extent {
        let is_exact = parts.iter().all(|part| part.is_exact);
        let mut parts = parts.into_iter();
        let Some(first) = parts.next() else { return Extent { points: Vec::new(), is_exact } };
        match operation {
            Operation::Union => {
                let points = first.points.into_iter().chain(parts.flat_map(|part| part.points)).collect();
                Extent { points, is_exact }
            }
            Operation::Difference => first.without(&parts.collect::<Vec<_>>()),
            Operation::Intersection => parts.fold(first, |all, part| all.within(&part)),
        }
    }

    /// The points that nothing can have been taken from: those outside of the boxes of what is taken away. If they reach as
    /// far as all of them, the box is certain.
    fn without(self, others: &[Extent]) -> Extent {
        let boxes: Vec<[Vec3; 2]> = others.iter().filter_map(Extent::bounds).collect();
        let is_free = |p: &Vec3| !boxes.iter().any(|[lo, hi]| p.cmpge(*lo).all() && p.cmple(*hi).all());
        let kept: Vec<Vec3> = self.points.iter().copied().filter(is_free).collect();
        let kept = Extent { points: kept, is_exact: self.is_exact };
        if kept.bounds() == self.bounds() { kept } else { Extent { is_exact: false, ..self } }
    }

    /// The corners of the common box.
    fn within(self, other: &Extent) -> Extent {
        let (Some([a, b]), Some([c, d])) = (self.bounds(), other.bounds()) else {
            return Extent { points: Vec::new(), is_exact: self.is_exact && other.is_exact };
        };
        let (lo, hi) = (a.max(c), b.min(d));
        let points = if lo.cmplt(hi).all() { vec![lo, hi] } else { Vec::new() };
        Extent { points, is_exact: false }
    }
}

/// The extent of what is below a node.
pub(super) fn extent(reader: &Reader, root: usize) -> Result<Extent, Refusal> {
    let of_shells = |_: &Arguments, shells: &[Shell], map: &Affine| {
        let points = shells.iter().flat_map(|shell| &shell.vertices).map(|p| map.point(*p)).collect();
        Ok(Extent { points, is_exact: true })
    };
    fold(reader, root, of_shells, Extent::joined)
}

/// Points whose hull is that of what is below a node, and whether that is certain.
pub(super) fn hull_points(reader: &Reader, root: usize) -> Result<(Vec<Vec3>, bool), Refusal> {
    if is_union(reader, root)? {
        return Ok((extent(reader, root)?.points, true));
    }
    let slices = slices(reader, root)?;
    let at = |(height, contours): (f64, Contours)| {
        corners(contours.concat()).into_iter().map(move |p| Vec3::new(p[0], p[1], height))
    };
    Ok((slices.into_iter().flat_map(at).collect(), false))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_is_cut_on_both_sides_of_its_floor() {
        let rings = [[2f64.sqrt(), 1.0], [2f64.sqrt(), 0.0]];
        let (vertices, triangles) = mesh::between_rings(&rings, 4);
        let shell = Shell { vertices, triangles, is_convex: true };
        let size = |height, side| {
            let contours = filled(&cut(&shell, &Affine::IDENTITY, height, side), FillRule::EvenOdd);
            contours.iter().map(|contour| area(contour)).sum::<f64>()
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(size(0.5, Side::Above), 4.0) && near(size(0.0, Side::Above), 4.0));
        assert_eq!(size(0.0, Side::Below), 0.0);
        assert!(near(size(1.0, Side::Below), 4.0));
        assert_eq!(size(1.0, Side::Above), 0.0);
    }
}
