//! Sections, projections and corners of the solids below a node, for items without a closed form.
//!
//! A section of a boolean is the boolean of the sections, so that only single shells have to be cut.

use super::arguments::{Arguments, Refusal};
use super::body::body;
use super::fold::{Start, fold, is_union};
use super::hull2::corners;
use super::operation::Operation;
use super::region::{Contours, area, check_near, filled, join_contours};
use super::shell::Shell;
use super::state::Reader;
use i_overlay::core::fill_rule::FillRule;
use rayweave_math::{Affine, Vec3};
use rayweave_polygon::Point;
use std::collections::HashMap;

/// Side of a cutting plane: a face in the plane itself belongs to one side only.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Above,
    Below,
}

/// `projection(cut = true)`: the section at z = 0, including faces in that plane.
pub(super) fn section(reader: &Reader, root: usize) -> Result<Contours, Refusal> {
    let above = section_at(reader, root, 0.0, Side::Above)?;
    let below = section_at(reader, root, 0.0, Side::Below)?;
    Ok(if above == below {
        above
    } else {
        join_contours(&reader.arguments(root), Operation::Union, vec![above, below])?
    })
}

fn section_at(reader: &Reader, root: usize, height: f64, side: Side) -> Result<Contours, Refusal> {
    let cut = |arguments: &Arguments, shells: &[Shell], map: &Affine| {
        let section = |shell| filled(arguments, &cut(shell, map, height, side), FillRule::EvenOdd);
        let all = shells.iter().map(section).collect::<Result<Vec<_>, _>>()?;
        join_contours(arguments, Operation::Union, all)
    };
    let join = |operation, parts| join_contours(&reader.arguments(root), operation, parts);
    fold(reader, Start::Below(root), cut, join)
}

/// Closed chains where a plane intersects a shell.
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
        // the same key for an edge from both of its triangles
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

/// Rounds to a grid of 2^-36 of `size`, so that coordinates equal up to rounding become equal and leave no slivers.
fn snapped(x: f64, size: f64) -> f64 {
    let grid = size * 2f64.powi(-36);
    if grid > 0.0 { (x / grid).round() * grid } else { x }
}

/// `projection(cut = false)`: projection of all facets along z.
pub(super) fn shadow(reader: &Reader, root: usize) -> Result<Contours, Refusal> {
    if !is_union(reader, root)? {
        let body = body(reader, Start::Below(root))?;
        let arguments = reader.arguments(root);
        let shade = |body| shade(&arguments, &Shell::of_body(&body), &Affine::IDENTITY);
        return body.map_or_else(|| Ok(Contours::new()), shade);
    }
    let of_shells = |arguments: &Arguments, shells: &[Shell], map: &Affine| {
        let all = shells.iter().map(|shell| shade(arguments, shell, map)).collect::<Result<_, _>>()?;
        join_contours(arguments, Operation::Union, all)
    };
    let join = |operation, parts| join_contours(&reader.arguments(root), operation, parts);
    fold(reader, Start::Below(root), of_shells, join)
}

/// The cost of a triangle in a silhouette.
const SILHOUETTE_TRIANGLE: usize = 1000;

/// Projection of a shell: the convex hull of the points of a convex shell, otherwise the region inside its silhouette. Of a shell that
/// is not closed, it is the union of the projected triangles.
fn shade(arguments: &Arguments, shell: &Shell, map: &Affine) -> Result<Contours, Refusal> {
    let mut points: Vec<Point> = shell.vertices.iter().map(|p| map.point(*p)).map(|p| [p.x, p.y]).collect();
    if shell.is_convex {
        // checked here, since the union with other shells passes it to `i_overlay`
        let hull: Contours = vec![corners(points)].into_iter().filter(|contour| contour.len() >= 3).collect();
        return check_near(arguments, &hull).map(|()| hull);
    }
    let size = points.iter().flatten().fold(0f64, |size, x| size.max(x.abs()));
    // adding 0 makes -0 the same point as 0
    points.iter_mut().flatten().for_each(|x| *x = snapped(*x, size) + 0.0);
    arguments.spend(shell.triangles.len().saturating_mul(SILHOUETTE_TRIANGLE))?;
    if let Some(chains) = silhouette(&points, &shell.triangles) {
        return filled(arguments, &chains, FillRule::NonZero);
    }
    let mut triangles: Contours =
        shell.triangles.iter().map(|corners| corners.map(|k| points[k as usize]).to_vec()).collect();
    triangles.retain(|triangle| area(triangle) != 0.0);
    triangles.iter_mut().filter(|triangle| area(triangle) < 0.0).for_each(|triangle| triangle.reverse());
    filled(arguments, &triangles, FillRule::NonZero)
}

/// Closed chains around the projected triangles that are counter-clockwise. Edges between two of them cancel, so that few edges remain.
/// `None` if the triangles are not a closed surface in which neighbours traverse common edges in opposite directions.
///
/// A vertical line crosses a closed surface upwards as often as downwards. The chains therefore wind at least once around each point
/// of the projection, and around no other point.
fn silhouette(points: &[Point], triangles: &[[u32; 3]]) -> Option<Contours> {
    let edges = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let mut balance: HashMap<[u32; 2], i32> = HashMap::new();
    for [a, b] in triangles.iter().flat_map(edges) {
        *balance.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
    }
    if balance.values().any(|count| *count != 0) {
        return None;
    }
    // by position, so that edges one above the other cancel, too
    let bits = |k: u32| points[k as usize].map(f64::to_bits);
    let is_seen = |t: &&[u32; 3]| area(&t.map(|k| points[k as usize])) > 0.0;
    let mut balance: HashMap<[[u64; 2]; 2], i32> = HashMap::new();
    for [a, b] in triangles.iter().filter(is_seen).flat_map(edges) {
        let (a, b) = (bits(a), bits(b));
        *balance.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
    }
    let directed = |([a, b], count): ([[u64; 2]; 2], i32)| {
        let edge = if count > 0 { (a, b) } else { (b, a) };
        std::iter::repeat_n(edge, count.unsigned_abs() as usize)
    };
    let mut edges: Vec<([u64; 2], [u64; 2])> = balance.into_iter().flat_map(directed).collect();
    edges.sort_unstable();
    Some(closed_chains(&edges))
}

/// Joins directed edges, sorted by their starts, to closed chains. Every point has as many edges to it as from it.
fn closed_chains(edges: &[([u64; 2], [u64; 2])]) -> Contours {
    let first = |from: [u64; 2]| edges.partition_point(|(start, _)| *start < from);
    // the number of used edges from a point, at the first of them
    let mut used = vec![0usize; edges.len()];
    let mut chains = Contours::new();
    for (k, &(start, _)) in edges.iter().enumerate() {
        if first(start) != k {
            continue;
        }
        loop {
            let (mut at, mut chain) = (start, Vec::new());
            loop {
                let group = first(at);
                let Some(&(from, to)) = edges.get(group + used.get(group).copied().unwrap_or(0)) else {
                    break;
                };
                if from != at {
                    break;
                }
                used[group] += 1;
                chain.push(from.map(f64::from_bits));
                at = to;
            }
            if chain.is_empty() {
                break;
            }
            chains.push(chain);
        }
    }
    chains
}

/// Vertices of the facets below a node; they have its convex hull and bounding box.
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
    fold(reader, Start::Below(root), of_shells, |_, parts: Vec<Vec<Vec3>>| Ok(parts.concat()))
}

#[cfg(test)]
mod tests {
    use super::super::budget::Budget;
    use super::super::region::filled_near;
    use super::*;
    use std::f64::consts::TAU;

    /// A torus from many sides: the region inside the silhouette is the union of all projected triangles.
    #[test]
    fn a_silhouette_bounds_the_projection() {
        let (n, m) = (24u32, 12u32);
        let at = |i: u32, j: u32| (i % n) * m + j % m;
        let corner = |k: u32| {
            let (a, b) = (f64::from(k / m) * TAU / f64::from(n), f64::from(k % m) * TAU / f64::from(m));
            let r = 3.0 + libm::cos(b);
            Vec3::new(r * libm::cos(a), r * libm::sin(a), libm::sin(b))
        };
        let vertices: Vec<Vec3> = (0..n * m).map(corner).collect();
        let quads = (0..n * m).map(|k| (k / m, k % m));
        let triangles: Vec<[u32; 3]> = quads
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let total = |contours: &Contours| contours.iter().map(|contour| area(contour)).sum::<f64>();
        for turn in 0..20 {
            let axis = Vec3::new(1.0, 0.3 * f64::from(turn), 0.1).normalize();
            let map = Affine::rotation(axis, f64::from(17 * turn));
            let points: Vec<Point> = vertices.iter().map(|p| map.point(*p)).map(|p| [p.x, p.y]).collect();
            let chains = silhouette(&points, &triangles).expect("a closed surface");
            let mut all: Contours =
                triangles.iter().map(|t| t.map(|k| points[k as usize]).to_vec()).collect();
            all.iter_mut().filter(|t| area(t) < 0.0).for_each(|t| t.reverse());
            let budgets = [Budget::new(0), Budget::new(0)];
            let [found, expected] =
                [(&budgets[0], &chains), (&budgets[1], &all)].map(|(budget, contours)| {
                    total(&filled_near(budget, contours, FillRule::NonZero).expect("few edges"))
                });
            assert!((found - expected).abs() < 1e-9 * expected, "{turn}: {found} instead of {expected}");
            assert!(expected > 10.0 && 4 * chains.concat().len() < all.concat().len(), "{turn}");
        }
        assert_eq!(silhouette(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], &[[0, 1, 2]]), None);
        let flipped: Vec<[u32; 3]> = [[triangles[0][1], triangles[0][0], triangles[0][2]]]
            .into_iter()
            .chain(triangles[1..].iter().copied())
            .collect();
        assert_eq!(silhouette(&vec![[0.0, 0.0]; 288], &flipped), None);
    }

    #[test]
    fn a_cube_is_cut_on_both_sides_of_its_floor() {
        let rings = [[2f64.sqrt(), 1.0], [2f64.sqrt(), 0.0]];
        let (vertices, triangles) = super::super::mesh::between_rings(&rings, 4);
        let shell = Shell { vertices, triangles, is_convex: true };
        let size = |height, side| {
            let chains = cut(&shell, &Affine::IDENTITY, height, side);
            let contours = filled_near(&Budget::new(0), &chains, FillRule::EvenOdd).expect("few edges");
            contours.iter().map(|contour| area(contour)).sum::<f64>()
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(size(0.5, Side::Above), 4.0) && near(size(0.0, Side::Above), 4.0));
        assert_eq!(size(0.0, Side::Below), 0.0);
        assert!(near(size(1.0, Side::Below), 4.0));
        assert_eq!(size(1.0, Side::Above), 0.0);
    }
}
