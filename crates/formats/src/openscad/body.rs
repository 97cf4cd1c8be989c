//! Subtrees as one closed mesh of their facets, with booleans by the mesh kernel. Bounding boxes, projections and Minkowski
//! sums of items with differences or intersections need it.

use super::arguments::{Arguments, Refusal};
use super::budget::KERNEL_TRIANGLE;
use super::fold::{Start, fold, repeated};
use super::operation::Operation;
use super::shell::Shell;
use super::state::Reader;
use crate::kernel::Body;
use rayweave_bvh::Bvh;
use rayweave_math::{Affine, Bounds};
use rayweave_mesh::{Mesh, RepairOptions};

/// The cost of a pair of triangles with overlapping boxes, in steps; measured: 160 ns for letters cut out of each other in three directions.
const OVERLAP: usize = 200;

/// The size of the leaves of the tree of boxes, and the cost of a query and of a box that it visits.
const CLUSTER: usize = 4;
const QUERY: usize = 100;
const VISIT: usize = 5;

/// The union of the facets below `from`. Equal differences and intersections are computed once, in their own frame.
pub(super) fn body(reader: &Reader, from: Start) -> Result<Option<Body>, Refusal> {
    for number in repeated(reader, from) {
        if !reader.is_known(number) {
            let found = joined(reader, Start::Item(number))?;
            let shell = found.map_or_else(Shell::default, |body| Shell::of_body(&body));
            reader.shared().keep(number, shell);
        }
    }
    joined(reader, from)
}

fn joined(reader: &Reader, from: Start) -> Result<Option<Body>, Refusal> {
    let of_shells = |arguments: &Arguments, shells: &[Shell], map: &Affine| {
        let all: Result<Vec<_>, _> = shells.iter().map(|shell| of_shell(arguments, shell, map)).collect();
        union(arguments, all?.into_iter().flatten().collect())
    };
    let arguments = reader.arguments(from.number());
    fold(reader, from, of_shells, |operation, parts| join(&arguments, operation, parts))
}

fn failed(arguments: &Arguments, why: &str) -> Refusal {
    arguments.refusal(&format!("its facets cannot be combined: {why}"))
}

fn of_shell(arguments: &Arguments, shell: &Shell, map: &Affine) -> Result<Option<Body>, Refusal> {
    arguments.spend(shell.triangles.len().saturating_mul(KERNEL_TRIANGLE))?;
    let points = shell.vertices.iter().map(|p| map.point(*p)).collect();
    let mesh = Mesh::new(points, shell.triangles.clone());
    let turned = mesh.and_then(|mesh| mesh.repaired(&RepairOptions::default().with_fill(false)));
    let (points, triangles) = turned.map_err(|error| failed(arguments, &error.to_string()))?.0.into_parts();
    match triangles.is_empty() {
        true => Ok(None),
        false => Body::from_triangles(points, triangles).map_err(|why| failed(arguments, &why)),
    }
}

/// An operation of the mesh kernel on two bodies, after its cost is counted.
fn combined(
    arguments: &Arguments,
    a: &Body,
    b: &Body,
    operation: impl Fn(&Body, &Body) -> Result<Option<Body>, String>,
) -> Result<Option<Body>, Refusal> {
    count_overlaps(arguments, a, b)?;
    operation(a, b).map_err(|why| failed(arguments, &why))
}

/// Counts the cost of an operation on two bodies: their triangles, and the pairs of triangles with overlapping boxes. A tree of boxes
/// finds the pairs, since the triangles of an extrusion are long: a sweep along an axis would pass far more pairs than there are.
fn count_overlaps(arguments: &Arguments, a: &Body, b: &Body) -> Result<(), Refusal> {
    arguments.spend((a.triangle_count() + b.triangle_count()).saturating_mul(KERNEL_TRIANGLE))?;
    let (few, many) = if a.triangle_count() <= b.triangle_count() { (a, b) } else { (b, a) };
    let boxes = triangle_boxes(many);
    let (tree, order) = Bvh::<CLUSTER>::of_clusters(&boxes);
    for own in triangle_boxes(few) {
        let (mut visited, mut near) = (0, 0);
        tree.overlapping(&own, 0.0, |places| {
            visited += places.len();
            near +=
                order[places].iter().filter(|&&k| !boxes[k as usize].intersection(&own).is_empty()).count();
        });
        arguments.spend(QUERY + VISIT * visited + OVERLAP * near)?;
    }
    Ok(())
}

fn triangle_boxes(body: &Body) -> Vec<Bounds> {
    let (points, triangles) = body.triangles();
    let bounds = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|k| points[k as usize]);
        Bounds::new(p.min(q).min(r), p.max(q).max(r))
    };
    triangles.iter().map(bounds).collect()
}

/// The union of all bodies, computed pairwise so that operands stay small until the last step.
fn union(arguments: &Arguments, mut all: Vec<Body>) -> Result<Option<Body>, Refusal> {
    while all.len() > 1 {
        let mut joined = Vec::with_capacity(all.len().div_ceil(2));
        for pair in all.chunks(2) {
            match pair {
                [a, b] => joined.extend(combined(arguments, a, b, Body::union)?),
                rest => joined.extend(rest.first().cloned()),
            }
        }
        all = joined;
    }
    Ok(all.pop())
}

fn join(
    arguments: &Arguments,
    operation: Operation,
    parts: Vec<Option<Body>>,
) -> Result<Option<Body>, Refusal> {
    if operation == Operation::Union {
        return union(arguments, parts.into_iter().flatten().collect());
    }
    let mut parts = parts.into_iter();
    let Some(mut first) = parts.next().flatten() else { return Ok(None) };
    if operation == Operation::Difference {
        return match union(arguments, parts.flatten().collect())? {
            Some(others) => combined(arguments, &first, &others, Body::difference),
            None => Ok(Some(first)),
        };
    }
    for part in parts {
        let common = match part {
            Some(part) => combined(arguments, &first, &part, Body::intersection)?,
            None => None,
        };
        let Some(common) = common else { return Ok(None) };
        first = common;
    }
    Ok(Some(first))
}

impl Shell {
    /// The triangles of a body.
    pub fn of_body(body: &Body) -> Shell {
        let (vertices, triangles) = body.triangles();
        Shell { vertices, triangles, is_convex: body.is_convex() }
    }
}

/// The faceted Minkowski sum of several nodes.
pub(super) fn sum(
    reader: &Reader,
    arguments: &Arguments,
    operands: &[usize],
) -> Result<Option<Body>, Refusal> {
    let mut all: Option<Body> = None;
    for &operand in operands {
        // OpenSCAD treats an empty operand as a point at the origin
        let Some(next) = body(reader, Start::Item(operand))? else { continue };
        all = match all {
            None => Some(next),
            Some(so_far) => {
                count_sum(arguments, &so_far, &next)?;
                let made = so_far.sum(&next);
                made.map_err(|why| {
                    arguments.refusal(&format!("the Minkowski sum of its facets cannot be computed: {why}"))
                })?
            }
        };
    }
    Ok(all)
}

/// Counts the cost of a sum: a hull for each pair of facets (a convex body counts as one facet), and their pairwise unions.
fn count_sum(arguments: &Arguments, a: &Body, b: &Body) -> Result<(), Refusal> {
    let facets = |body: &Body| if body.is_convex() { 1 } else { body.triangle_count() };
    let corners = |body: &Body| if body.is_convex() { body.triangle_count() } else { 3 };
    let pairs = facets(a).saturating_mul(facets(b));
    let triangles = pairs.saturating_mul(2 * corners(a).saturating_mul(corners(b)).min(2000));
    let rounds = usize::BITS - pairs.leading_zeros();
    arguments.spend(triangles.saturating_mul(rounds as usize).saturating_mul(KERNEL_TRIANGLE))
}

#[cfg(test)]
mod tests {
    use super::super::budget::Budget;
    use super::super::syntax::parse;
    use super::*;
    use crate::Options;
    use rayweave_scene::Source;
    use std::sync::Arc;

    /// The steps that a dump takes.
    fn steps(text: &str) -> u64 {
        let source = Arc::new(Source::new(None, text.to_owned()));
        let tree = parse(&source).unwrap();
        let budget = Budget::new(text.len());
        Reader::new(&source, &Options::default(), &tree, &budget).scene().unwrap();
        budget.used()
    }

    /// The boxes of long triangles along different axes overlap few others, although they all overlap along one of the axes.
    #[test]
    fn crossing_extrusions_take_linear_work() {
        let crossing = |n: usize| {
            let rod = format!("linear_extrude(height = 20, center = true) circle(r = 3, $fn = {n});");
            let turned =
                format!("multmatrix([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]) {rod}");
            format!("linear_extrude(height = 1) projection() intersection() {{ {rod} {turned} }}")
        };
        let (few, many) = (steps(&crossing(100)), steps(&crossing(800)));
        assert!(many < 16 * few, "{few} {many}");
    }

    #[test]
    fn equal_differences_are_combined_once() {
        let view = |degrees: f64| {
            let (sin, cos) = (libm::sin(degrees.to_radians()), libm::cos(degrees.to_radians()));
            let matrix = format!("[[1, 0, 0, 0], [0, {cos}, -{sin}, 0], [0, {sin}, {cos}, 0], [0, 0, 0, 1]]");
            let cut = "difference() { sphere(r = 5, $fn = 30); cube(6); }";
            format!("linear_extrude(height = 1) projection() multmatrix({matrix}) {cut}")
        };
        let all: String = (0..8).map(|k| view(10.0 * f64::from(k))).collect();
        let (one, eight) = (steps(&view(10.0)), steps(&all));
        assert!(eight < 4 * one, "{one} {eight}");
    }
}
