//! Vertices of outlines, and the rounding of their corners.

use super::contour::{Arc, Piece};
use super::error::OutlineError;
use crate::Point;

/// A vertex of a contour, and the edge to the next vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Its position.
    pub at: Point,
    /// The tangent of a quarter of the angle that the edge to the next vertex turns by, as in DXF: 0 for a straight edge, 1 for half
    /// a circle to the left, negative to the right.
    pub bulge: f64,
    /// The form of the corner between two straight edges; at arcs, it must be sharp.
    pub corner: Corner,
}

/// The form of a corner.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Corner {
    /// Sharp.
    #[default]
    Sharp,
    /// An arc of this radius, tangent to both edges.
    Fillet(f64),
    /// A straight edge between the points at this distance from the vertex on both edges.
    Chamfer(f64),
}

impl Vertex {
    /// A vertex with a sharp corner and a straight edge.
    pub fn sharp(at: Point) -> Vertex {
        Vertex { at, bulge: 0.0, corner: Corner::Sharp }
    }

    /// A circle: two half circles.
    pub fn circle(centre: Point, radius: f64) -> [Vertex; 2] {
        [radius, -radius].map(|x| Vertex {
            at: [centre[0] + x, centre[1]],
            bulge: 1.0,
            corner: Corner::Sharp,
        })
    }
}

/// Relative length of an edge that remains between two roundings only because of rounding errors.
const NOTHING: f64 = 1e-12;

/// A straight edge, with the lengths that the corners at its ends take.
#[derive(Clone, Copy)]
struct Straight {
    direction: Point,
    length: f64,
    taken: [f64; 2],
}

/// The pieces of a contour with its corners rounded.
pub fn pieces(contour: usize, vertices: &[Vertex]) -> Result<Vec<Piece>, OutlineError> {
    check(contour, vertices)?;
    let next = |k: usize| if k + 1 == vertices.len() { 0 } else { k + 1 };
    // repeated vertices have no edge
    let kept: Vec<usize> = (0..vertices.len()).filter(|k| vertices[*k].at != vertices[next(*k)].at).collect();
    if kept.len() < 2 || (kept.len() == 2 && kept.iter().all(|k| vertices[*k].bulge == 0.0)) {
        return Err(OutlineError::NoArea { contour });
    }
    let mut straight: Vec<Option<Straight>> =
        kept.iter().map(|&k| straight_edge(&vertices[k], vertices[next(k)].at)).collect();
    let count = kept.len();
    // the vertex at the start of a kept edge may have been given several times: the last one counts
    let mut rounded = vec![None; count];
    for own in 0..count {
        let before = (own + count - 1) % count;
        let vertex = kept[own];
        let (size, setback) = match vertices[vertex].corner {
            Corner::Sharp => continue,
            corner => {
                let (Some(a), Some(b)) = (straight[before], straight[own]) else {
                    return Err(OutlineError::CornerAtArc { contour, vertex });
                };
                match round(vertices[vertex].at, a.direction, b.direction, corner) {
                    Some((size, setback, arc)) => {
                        rounded[own] = Some((setback, arc));
                        (size, setback)
                    }
                    None => continue,
                }
            }
        };
        for (edge, end) in [(before, 1), (own, 0)] {
            if let Some(edge) = &mut straight[edge] {
                edge.taken[end] = setback;
                let room = edge.length - edge.taken[1 - end];
                if setback > room + NOTHING * edge.length {
                    return Err(OutlineError::NoRoom { contour, vertex, size, setback, room });
                }
            }
        }
    }
    Ok(joined(vertices, &kept, &straight, &rounded))
}

/// The pieces, corner by corner and edge by edge.
fn joined(
    vertices: &[Vertex],
    kept: &[usize],
    straight: &[Option<Straight>],
    rounded: &[Option<(f64, Option<Arc>)>],
) -> Vec<Piece> {
    let count = kept.len();
    let is_used_up = |edge: &Straight| edge.length - edge.taken[0] - edge.taken[1] <= NOTHING * edge.length;
    let along = |at: Point, direction: Point, by: f64| [at[0] + by * direction[0], at[1] + by * direction[1]];
    let mut pieces = Vec::new();
    for own in 0..count {
        let (vertex, before) = (kept[own], (own + count - 1) % count);
        let at = vertices[vertex].at;
        if let (Some((setback, arc)), Some(a), Some(b)) = (rounded[own], straight[before], straight[own]) {
            // the start of a corner is the end of the last one, if nothing is left between them
            let start = match is_used_up(&a) {
                true => along(vertices[kept[before]].at, a.direction, a.taken[0]),
                false => along(at, a.direction, -setback),
            };
            pieces.push(Piece { from: start, arc, origin: vertex });
            if !is_used_up(&b) {
                pieces.push(Piece { from: along(at, b.direction, setback), arc: None, origin: vertex });
            }
            continue;
        }
        match straight[own] {
            // the end of the edge is taken by the next corner
            Some(edge) if is_used_up(&edge) => {}
            _ => {
                let next = vertices[(vertex + 1) % vertices.len()].at;
                pieces.push(Piece {
                    from: at,
                    arc: bulged(at, next, vertices[vertex].bulge),
                    origin: vertex,
                });
            }
        }
    }
    pieces
}

fn check(contour: usize, vertices: &[Vertex]) -> Result<(), OutlineError> {
    for (vertex, Vertex { at, bulge, corner }) in vertices.iter().enumerate() {
        // the square of the largest number must not overflow
        if at.iter().chain([bulge]).any(|x| !x.is_finite() || x.abs() > 1e60) {
            return Err(OutlineError::NotFinite { contour, vertex });
        }
        if let Corner::Fillet(size) | Corner::Chamfer(size) = corner
            && !(size.is_finite() && *size > 0.0)
        {
            return Err(OutlineError::NotPositive { contour, vertex, size: *size });
        }
    }
    Ok(())
}

fn straight_edge(vertex: &Vertex, to: Point) -> Option<Straight> {
    if vertex.bulge != 0.0 {
        return None;
    }
    let d = [to[0] - vertex.at[0], to[1] - vertex.at[1]];
    let length = libm::hypot(d[0], d[1]);
    Some(Straight { direction: [d[0] / length, d[1] / length], length, taken: [0.0; 2] })
}

/// The size of a rounding, the length that it takes of both edges, and its arc; `None` between edges in one line.
fn round(at: Point, u: Point, v: Point, corner: Corner) -> Option<(f64, f64, Option<Arc>)> {
    let (cross, dot) = (u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
    if cross == 0.0 {
        return None;
    }
    match corner {
        Corner::Sharp => None,
        Corner::Chamfer(size) => Some((size, size, None)),
        Corner::Fillet(radius) => {
            // the edge turns by an angle a; tan(a/2) = sin a / (1 + cos a)
            let setback = radius * cross.abs() / (1.0 + dot);
            let side = if cross > 0.0 { radius } else { -radius };
            let start = [at[0] - setback * u[0], at[1] - setback * u[1]];
            let centre = [start[0] - side * u[1], start[1] + side * u[0]];
            Some((radius, setback, Some(Arc { centre, radius, is_ccw: cross > 0.0 })))
        }
    }
}

/// The arc between two points.
fn bulged(from: Point, to: Point, bulge: f64) -> Option<Arc> {
    if bulge == 0.0 {
        return None;
    }
    let d = [to[0] - from[0], to[1] - from[1]];
    // the centre is at this multiple of the chord to the left of its middle
    let left = (1.0 - bulge * bulge) / (4.0 * bulge);
    let centre = [0.5 * (from[0] + to[0]) - left * d[1], 0.5 * (from[1] + to[1]) + left * d[0]];
    let radius = libm::hypot(d[0], d[1]) * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
    Some(Arc { centre, radius, is_ccw: bulge > 0.0 })
}
