//! Subtrees as one closed mesh of their facets, with booleans by the mesh kernel. Bounding boxes, projections and Minkowski
//! sums of items with differences or intersections need it.

use super::arguments::{Arguments, Refusal};
use super::fold::{Start, fold};
use super::operation::Operation;
use super::shell::Shell;
use super::state::Reader;
use crate::kernel::Body;
use rayweave_math::Affine;
use rayweave_mesh::{Mesh, RepairOptions};

/// Result of a kernel operation: nothing, or a body.
type Made = Result<Option<Body>, String>;

/// The union of the facets below `from`.
pub(super) fn body(reader: &Reader, from: Start) -> Result<Option<Body>, Refusal> {
    let of_shells = |arguments: &Arguments, shells: &[Shell], map: &Affine| {
        let all: Result<Vec<_>, _> = shells.iter().map(|shell| of_shell(shell, map)).collect();
        let made = all.and_then(|all| Body::union(all.into_iter().flatten().collect()));
        made.map(Ok).map_err(|why| arguments.refusal(&format!("its facets cannot be joined: {why}")))
    };
    let made = fold(reader, from, of_shells, |operation, parts| Ok(join(operation, parts)))?;
    let arguments = reader.arguments(from.number());
    made.map_err(|why| arguments.refusal(&format!("the facets of its parts cannot be joined: {why}")))
}

fn of_shell(shell: &Shell, map: &Affine) -> Made {
    let points = shell.vertices.iter().map(|p| map.point(*p)).collect();
    let mesh = Mesh::new(points, shell.triangles.clone()).map_err(|error| error.to_string())?;
    let turned = mesh.repaired(&RepairOptions::default().with_fill(false));
    let (points, triangles) = turned.map_err(|error| error.to_string())?.0.into_parts();
    match triangles.is_empty() {
        true => Ok(None),
        false => Body::from_triangles(points, triangles).map(Some),
    }
}

fn join(operation: Operation, parts: Vec<Made>) -> Made {
    let mut parts = parts.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter();
    if operation == Operation::Union {
        return Body::union(parts.flatten().collect());
    }
    let Some(mut first) = parts.next().flatten() else { return Ok(None) };
    if operation == Operation::Difference {
        return match Body::union(parts.flatten().collect())? {
            Some(others) => first.less(&others),
            None => Ok(Some(first)),
        };
    }
    for part in parts {
        let common = match part {
            Some(part) => first.common(&part)?,
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

/// Most pairs of facets in a Minkowski sum; more take minutes.
const MOST_PAIRS: usize = 20_000;

/// The Minkowski sum of some nodes, in facets.
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
                check(arguments, &so_far, &next)?;
                let made = so_far.sum(&next);
                made.map_err(|why| arguments.refusal(&format!("its facets cannot be summed up: {why}")))?
            }
        };
    }
    Ok(all)
}

/// Refuses sums that would take too long.
fn check(arguments: &Arguments, a: &Body, b: &Body) -> Result<(), Refusal> {
    let count = |body: &Body| if body.is_convex() { 1 } else { body.triangle_count() };
    match count(a).saturating_mul(count(b)) > MOST_PAIRS {
        true => Err(arguments.refusal(&format!("it is a sum of more than {MOST_PAIRS} pairs of facets"))),
        false => Ok(()),
    }
}
