//! Chamfered and filleted rims of prisms: cutters that are subtracted, one for each edge, with mitre planes between them.

use super::contour::{Arc, Edge};
use super::solid::{half_plane_of, solid, within};
use super::{Contour, Outline, OutlineError, simple};
use crate::Point;
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_shape::primitive::{Cylinder, HalfSpace, Sphere, Torus};

/// The treatment of all edges of one end of an extrusion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Rim {
    /// Sharp edges.
    #[default]
    Sharp,
    /// A face at 45 degrees that takes this length of the walls and of the end.
    Chamfer(f64),
    /// A round face of this radius.
    Fillet(f64),
}

impl Rim {
    /// The height that it takes.
    pub fn size(self) -> f64 {
        match self {
            Rim::Sharp => 0.0,
            Rim::Chamfer(size) | Rim::Fillet(size) => size,
        }
    }
}

/// The smallest 1 + cos a for the angle a by which an outline turns at a corner with a mitre: the mitre of a sharper corner is more
/// than a thousand times longer than the treatment is wide.
const SHARPEST: f64 = 1e-6;

/// The largest sine of the angle between tangents that counts as a rounding error.
const TANGENT: f64 = 1e-9;

/// The distance of arcs from their chords where contact of rims is tested, relative to their radius.
const CHORDS: f64 = 1e-3;

/// One end of a prism.
struct End {
    rim: Rim,
    z: f64,
    /// 1 at the upper end, -1 at the lower end.
    up: f64,
    name: &'static str,
}

/// An edge, with its neighbours.
struct Place<'a> {
    edge: &'a Edge,
    is_island: bool,
    /// The directions of the mitre planes at both ends.
    mitres: [Point; 2],
    name: String,
}

/// The solids to subtract from a prism for the rim at height `z`, the upper end if `up`.
pub(super) fn cutters(outline: &Outline, rim: Rim, z: f64, up: bool) -> Result<Vec<Solid>, OutlineError> {
    if rim == Rim::Sharp {
        return Ok(Vec::new());
    }
    if !(rim.size().is_finite() && rim.size() > 0.0) {
        let reason = "its size must be greater than 0";
        return Err(OutlineError::Rim { contour: 0, vertex: 0, reason });
    }
    let (sign, name) = if up { (1.0, "top") } else { (-1.0, "bottom") };
    let end = End { rim, z, up: sign, name };
    check(outline, rim.size())?;
    let mut solids = Vec::new();
    for (number, contour) in outline.contours.iter().enumerate() {
        if let Some((centre, radius)) = contour.circle {
            let arc = Arc { centre, radius, is_ccw: true };
            let cutter = end.round(&arc, contour.is_island)?;
            solids.push(Solid::intersection(cutter).named(&format!("{}.contour{number}", end.name)));
            continue;
        }
        let count = contour.edges.len();
        for (k, edge) in contour.edges.iter().enumerate() {
            let [before, after] = [&contour.edges[(k + count - 1) % count], &contour.edges[(k + 1) % count]];
            let mitres = [mitre(before, edge), mitre(edge, after)];
            let kind = if edge.arc.is_some() { "arc" } else { "edge" };
            let name = format!("{}.contour{number}.{kind}{}", end.name, edge.origin);
            solids.push(end.cutter(&Place { edge, is_island: contour.is_island, mitres, name })?);
        }
    }
    Ok(solids)
}

/// The normal of the mitre plane between two edges: the sum of their directions.
fn mitre(edge: &Edge, next: &Edge) -> Point {
    let (u, v) = (edge.tangents()[1], next.tangents()[0]);
    [u[0] + v[0], u[1] + v[1]]
}

/// The movement of the corner between two edges when both move to the left by 1. For an outline without rims, in which edges may
/// turn back, it may be infinite.
pub(super) fn mitre_shift(edge: &Edge, next: &Edge) -> Point {
    let (u, v) = (edge.tangents()[1], next.tangents()[0]);
    let by = 1.0 / (1.0 + u[0] * v[0] + u[1] * v[1]);
    [-by * (u[1] + v[1]), by * (u[0] + v[0])]
}

impl End {
    fn cutter(&self, place: &Place<'_>) -> Result<Solid, OutlineError> {
        let Place { edge, is_island, mitres, name } = place;
        let mut parts = match edge.arc {
            Some(arc) => self.round(&arc, *is_island)?,
            None => self.straight(edge, *is_island)?,
        };
        for ([x, y], at, sign) in [(mitres[0], edge.from, -1.0), (mitres[1], edge.to, 1.0)] {
            let normal = Vec3::new(sign * x, sign * y, 0.0);
            parts.push(solid(HalfSpace::new(normal, normal.x * at[0] + normal.y * at[1]))?);
        }
        Ok(Solid::intersection(parts).named(name))
    }

    /// The points within `size` of the end.
    fn layer(&self, size: f64) -> Result<Solid, OutlineError> {
        solid(HalfSpace::new(Vec3::new(0.0, 0.0, -self.up), size - self.up * self.z))
    }

    fn straight(&self, edge: &Edge, is_island: bool) -> Result<Vec<Solid>, OutlineError> {
        let half_plane = half_plane_of(edge);
        let [x, y] = half_plane.normal;
        let wall = solid(HalfSpace::new(Vec3::new(x, y, 0.0), half_plane.offset))?;
        let length = libm::hypot(x, y);
        let side = if is_island { 1.0 } else { -1.0 };
        // the unit normal out of the material, and the distance of the wall along it
        let (out, wall_at) = ([side * x / length, side * y / length], side * half_plane.offset / length);
        let wall = if is_island { wall } else { !wall };
        match self.rim {
            Rim::Sharp => Ok(vec![Solid::empty()]),
            Rim::Chamfer(size) => {
                // out . p + up z > wall + up z_end - size
                let normal = -Vec3::new(out[0], out[1], self.up);
                Ok(vec![solid(HalfSpace::new(normal, size - wall_at - self.up * self.z))?, wall])
            }
            Rim::Fillet(radius) => {
                let direction = [-out[1], out[0]];
                let centre = Vec3::new(
                    edge.from[0] - radius * out[0],
                    edge.from[1] - radius * out[1],
                    self.z - self.up * radius,
                );
                let rows = [
                    [0.0, direction[1], direction[0], centre.x],
                    [0.0, -direction[0], direction[1], centre.y],
                    [1.0, 0.0, 0.0, centre.z],
                    [0.0, 0.0, 0.0, 1.0],
                ];
                let map = Affine::from_rows(&rows).unwrap_or(Affine::IDENTITY);
                let rod = solid(Cylinder::new(radius, f64::INFINITY))?.apply(map);
                let beyond = solid(HalfSpace::new(Vec3::new(-out[0], -out[1], 0.0), radius - wall_at))?;
                Ok(vec![wall, beyond, self.layer(radius)?, !rod])
            }
        }
    }

    fn round(&self, arc: &Arc, is_island: bool) -> Result<Vec<Solid>, OutlineError> {
        let Arc { centre, radius, is_ccw } = *arc;
        let disc = within(centre, 0.0, radius)?;
        let is_convex = is_ccw == is_island;
        let wall = if is_convex { disc } else { !disc };
        match (self.rim, is_convex) {
            (Rim::Sharp, _) => Ok(vec![Solid::empty()]),
            // r + up z > radius + up z_end - size
            (Rim::Chamfer(size), true) => {
                let kept = within(centre, -self.up, radius + self.up * self.z - size)?;
                Ok(vec![wall, !kept])
            }
            // r < radius + up (z - z_end) + size
            (Rim::Chamfer(size), false) => {
                Ok(vec![wall, within(centre, self.up, radius - self.up * self.z + size)?])
            }
            (Rim::Fillet(size), _) => {
                let path = if is_convex { radius - size } else { radius + size };
                let inner = within(centre, 0.0, path)?;
                let tube =
                    if path > 0.0 { solid(Torus::new(path, size))? } else { solid(Sphere::new(size))? };
                let tube = tube.translate([centre[0], centre[1], self.z - self.up * size]);
                let beyond = if is_convex { !inner } else { inner };
                Ok(vec![wall, beyond, self.layer(size)?, !tube])
            }
        }
    }
}

/// Rejects a treatment of this width that has no room: the outline moved inwards by it must be an outline with the same edges.
fn check(outline: &Outline, size: f64) -> Result<(), OutlineError> {
    let mut moved = Vec::new();
    for (number, contour) in outline.contours.iter().enumerate() {
        let edges = inner(number, contour, size)?;
        moved.push(edges.iter().flat_map(|edge| edge.chords(CHORDS * edge.radius())).collect());
    }
    let is_island: Vec<bool> = outline.contours.iter().map(|contour| contour.is_island).collect();
    simple(&moved, &is_island).map(|_| ()).map_err(|error| {
        let (contour, vertex) = error.place().unwrap_or_default();
        let reason = "it is too wide, and meets the rim of another edge";
        OutlineError::Rim { contour, vertex: vertex.unwrap_or(0), reason }
    })
}

/// The edges moved by `size` into the material.
fn inner(number: usize, contour: &Contour, size: f64) -> Result<Vec<Edge>, OutlineError> {
    let side = if contour.is_island { size } else { -size };
    let count = contour.edges.len();
    let mut corners = Vec::new();
    for (k, edge) in contour.edges.iter().enumerate() {
        let before = &contour.edges[(k + count - 1) % count];
        let (u, v) = (before.tangents()[1], edge.tangents()[0]);
        let (cross, dot) = (u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
        let fails = |reason| Err(OutlineError::Rim { contour: number, vertex: edge.origin, reason });
        let is_tangent = cross.abs() <= TANGENT && dot > 0.0;
        if !is_tangent && (edge.arc.is_some() || before.arc.is_some()) {
            return fails("an arc must be tangent to its neighbours");
        }
        if 1.0 + dot < SHARPEST {
            return fails("the corner is too sharp");
        }
        let by = side / (1.0 + dot);
        corners.push([edge.from[0] - by * (u[1] + v[1]), edge.from[1] + by * (u[0] + v[0])]);
    }
    let moved = contour.edges.iter().enumerate().map(|(k, edge)| {
        let (from, to) = (corners[k], corners[(k + 1) % count]);
        let arc = edge.arc.map(|arc| {
            let radius = if arc.is_ccw { arc.radius - side } else { arc.radius + side };
            Arc { radius, ..arc }
        });
        let direction = [edge.to[0] - edge.from[0], edge.to[1] - edge.from[1]];
        let remains = (to[0] - from[0]) * direction[0] + (to[1] - from[1]) * direction[1] > 0.0;
        let fails = |reason| Err(OutlineError::Rim { contour: number, vertex: edge.origin, reason });
        match arc {
            Some(arc) if arc.radius < 0.0 => fails("it is wider than the radius of the arc"),
            None if !remains => fails("it is too wide for the length of the edge"),
            _ => Ok(Edge { from, to, arc, origin: edge.origin }),
        }
    });
    moved.collect()
}
