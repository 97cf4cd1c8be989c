//! Solids with plane faces (polyhedra, traps, tessellated solids), and ruled ones (`G4GenericTrap`).

use super::round::{ZPlane, edges, in_order, outline};
use super::{Made, Phi, loose_box, of, union_of};
use crate::gdml::attributes::{Failure, refused};
use rayweave_math::{Affine, Bounds, Mat3, Vec3, sin_cos_degrees, unit_vector_degrees};
use rayweave_model::Solid;
use rayweave_shape::primitive::{CentredBox, Convex, Primitive, Quadric, Value, build};
use std::collections::HashMap;

/// tan of an angle in degrees.
fn tan(angle: f64) -> f64 {
    let (sin, cos) = sin_cos_degrees(angle);
    sin / cos
}

/// `G4Para`: a sheared box, with full lengths.
pub(in crate::gdml) fn parallelepiped(size: [f64; 3], alpha: f64, theta: f64, phi: f64) -> Made {
    let (sin, cos) = sin_cos_degrees(phi);
    let shear = Mat3::from_cols(
        Vec3::X,
        Vec3::new(tan(alpha), 1.0, 0.0),
        Vec3::new(tan(theta) * cos, tan(theta) * sin, 1.0),
    );
    Ok(of(CentredBox::new(Vec3::from_array(size))?).apply(Affine::from_linear(shear)))
}

/// Parameters of a `G4Trap`, full lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gdml) struct Trapezoid {
    pub z: f64,
    pub theta: f64,
    pub phi: f64,
    /// Lower face: extent along y, along x at low y and at high y, and the angle of the line between the midpoints of those
    /// sides.
    pub low: [f64; 4],
    /// The same for the upper face.
    pub high: [f64; 4],
}

impl Trapezoid {
    /// Vertices of the lower and upper face, counter-clockwise seen from +z.
    pub fn corners(&self) -> [[[f64; 2]; 4]; 2] {
        let (sin, cos) = sin_cos_degrees(self.phi);
        let lean = 0.5 * self.z * tan(self.theta);
        let quadrilateral = |[y, x1, x2, alpha]: [f64; 4], side: f64| {
            let (middle, skew) = ([side * lean * cos, side * lean * sin], 0.5 * y * tan(alpha));
            let corner = |x: f64, sign_x: f64, sign_y: f64| {
                [middle[0] + sign_y * skew + sign_x * 0.5 * x, middle[1] + sign_y * 0.5 * y]
            };
            [corner(x1, -1.0, -1.0), corner(x1, 1.0, -1.0), corner(x2, 1.0, 1.0), corner(x2, -1.0, 1.0)]
        };
        [quadrilateral(self.low, -1.0), quadrilateral(self.high, 1.0)]
    }
}

/// `G4Trap` and `G4Trd`.
pub(in crate::gdml) fn trapezoid(trapezoid: &Trapezoid) -> Made {
    let lengths = [&trapezoid.low[..3], &trapezoid.high[..3]].concat();
    if trapezoid.z <= 0.0 || lengths.iter().any(|length| *length < 0.0) {
        return refused("a length is negative, or its height is 0");
    }
    let [low, high] = trapezoid.corners();
    ruled(low, high, 0.5 * trapezoid.z)
}

/// Sine of the angle below which edges count as parallel and the face between them as planar.
const PLANE: f64 = 1e-10;

/// `G4GenericTrap`: ruled between a quadrilateral at -dz and one at dz, with corresponding vertices. A side face between
/// edges that are not parallel is part of a hyperbolic paraboloid. Vertices may coincide.
pub(in crate::gdml) fn ruled(low: [[f64; 2]; 4], high: [[f64; 2]; 4], dz: f64) -> Made {
    let middle = [0, 1, 2, 3].map(|k| [0, 1].map(|axis| 0.5 * (low[k][axis] + high[k][axis])));
    let area = edges(&middle).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>();
    if area == 0.0 || dz <= 0.0 {
        return refused("it has no interior");
    }
    let (low, high) = if area > 0.0 { (low, high) } else { (reversed(low), reversed(high)) };
    let sides: Vec<Side> = (0..4).filter_map(|k| Side::new(low, high, dz, k)).collect();
    if !is_convex(low, high) {
        return refused("a section across z is not convex");
    }
    let planes: Vec<[f64; 4]> = sides.iter().filter_map(Side::plane).collect();
    let twisted = sides.iter().filter(|side| side.plane().is_none());
    let reach =
        low.iter().chain(&high).fold([0.0f64; 2], |r, c| [r[0].max(c[0].abs()), r[1].max(c[1].abs())]);
    let mut parts = Vec::new();
    if planes.len() == sides.len() {
        parts.push(of(Convex::new([&planes[..], &[[0.0, 0.0, -1.0, dz], [0.0, 0.0, 1.0, dz]]].concat())?));
    } else {
        parts.push(loose_box(reach[0], reach[1], dz)?);
        if !planes.is_empty() {
            parts.push(of(Convex::new(planes)?));
        }
    }
    for side in twisted {
        parts.push(of(Quadric::new(side.quadric())?));
    }
    union_or_intersection(parts)
}

fn union_or_intersection(mut parts: Vec<Solid>) -> Made {
    Ok(if parts.len() == 1 { parts.remove(0) } else { Solid::intersection(parts) })
}

fn reversed(mut corners: [[f64; 2]; 4]) -> [[f64; 2]; 4] {
    corners.reverse();
    corners
}

/// A side face: the line through the vertex `a + z da` in the direction `e + z de`, with the inside on its left.
struct Side {
    a: [f64; 2],
    da: [f64; 2],
    e: [f64; 2],
    de: [f64; 2],
    /// The edge at both ends.
    ends: [[f64; 2]; 2],
}

impl Side {
    /// The side from vertex k to the next; `None` if both its edges are points.
    fn new(low: [[f64; 2]; 4], high: [[f64; 2]; 4], dz: f64, k: usize) -> Option<Side> {
        let next = (k + 1) % 4;
        let edge = |corners: [[f64; 2]; 4]| [0, 1].map(|axis| corners[next][axis] - corners[k][axis]);
        let ends = [edge(low), edge(high)];
        let mean = |l: [f64; 2], h: [f64; 2]| [0, 1].map(|axis| 0.5 * (l[axis] + h[axis]));
        let slope = |l: [f64; 2], h: [f64; 2]| [0, 1].map(|axis| 0.5 * (h[axis] - l[axis]) / dz);
        (ends != [[0.0; 2]; 2]).then(|| Side {
            a: mean(low[k], high[k]),
            da: slope(low[k], high[k]),
            e: mean(ends[0], ends[1]),
            de: slope(ends[0], ends[1]),
            ends,
        })
    }

    /// The plane of the face, if its edges are parallel.
    fn plane(&self) -> Option<[f64; 4]> {
        let [low, high] = self.ends;
        let length = |v: [f64; 2]| libm::hypot(v[0], v[1]);
        let cross = low[0] * high[1] - low[1] * high[0];
        if cross.abs() > PLANE * length(low) * length(high) {
            return None;
        }
        let [ex, ey] = if length(low) > length(high) { low } else { high };
        let out = [ey, -ex];
        let along = |v: [f64; 2]| out[0] * v[0] + out[1] * v[1];
        Some([out[0], out[1], -along(self.da), along(self.a)])
    }

    /// Quadric matrix of -(ex (y - ay) - ey (x - ax)), where all four are linear in z.
    fn quadric(&self) -> [[f64; 4]; 4] {
        let Side { a, da, e, de, .. } = self;
        let mut q = [[0.0; 4]; 4];
        let mut set = |i: usize, j: usize, value: f64| {
            q[i][j] = value;
            q[j][i] = value;
        };
        set(1, 2, -0.5 * de[0]);
        set(0, 2, 0.5 * de[1]);
        set(1, 3, -0.5 * e[0]);
        set(0, 3, 0.5 * e[1]);
        set(2, 2, de[0] * da[1] - de[1] * da[0]);
        set(2, 3, 0.5 * (e[0] * da[1] + de[0] * a[1] - e[1] * da[0] - de[1] * a[0]));
        set(3, 3, e[0] * a[1] - e[1] * a[0]);
        q
    }
}

/// True if no section between the ends has a reflex vertex. The turn at a vertex is quadratic in z; its minimum is at an
/// end or in between.
fn is_convex(low: [[f64; 2]; 4], high: [[f64; 2]; 4]) -> bool {
    let edge = |corners: [[f64; 2]; 4], k: usize| {
        [0, 1].map(|axis| corners[(k + 1) % 4][axis] - corners[k % 4][axis])
    };
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    (0..4).all(|k| {
        let [(l0, l1), (h0, h1)] = [low, high].map(|corners| (edge(corners, k), edge(corners, k + 1)));
        let (at_low, at_high) = (cross(l0, l1), cross(h0, h1));
        let mixed = cross(l0, h1) + cross(h0, l1);
        let noise = 1e-9 * [at_low.abs(), at_high.abs(), mixed.abs()].into_iter().fold(0.0, f64::max);
        // (1-t)^2 low + t (1-t) mixed + t^2 high, over t in [0, 1]
        let curvature = at_low - mixed + at_high;
        let best = (at_low - 0.5 * mixed) / curvature;
        let t = if curvature > 0.0 && (0.0..1.0).contains(&best) { best } else { 0.0 };
        let between = (1.0 - t) * (1.0 - t) * at_low + t * (1.0 - t) * mixed + t * t * at_high;
        at_low.min(at_high).min(between) >= -noise
    })
}

/// `G4Tet`.
pub(in crate::gdml) fn tetrahedron(corners: [Vec3; 4]) -> Made {
    let volume = (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[3] - corners[0]);
    if volume == 0.0 {
        return refused("its corners lie in a plane");
    }
    let face = |skipped: usize| {
        let rest: Vec<Vec3> = (0..4).filter(|k| *k != skipped).map(|k| corners[k]).collect();
        let normal = (rest[1] - rest[0]).cross(rest[2] - rest[0]);
        let out = if normal.dot(corners[skipped] - rest[0]) > 0.0 { -normal } else { normal };
        [out.x, out.y, out.z, out.dot(rest[0])]
    };
    Ok(of(Convex::new((0..4).map(face).collect())?))
}

/// `G4Polyhedra` from planes: the radii are distances of the side faces from the axis.
pub(in crate::gdml) fn polyhedra(planes: &[ZPlane], sides: u32, phi: Phi) -> Made {
    if !in_order(planes) {
        let (_, cos) = sin_cos_degrees(0.5 * phi.delta.min(360.0) / f64::from(sides.max(1)));
        let corners: Vec<[f64; 2]> = outline(planes).into_iter().map(|[r, z]| [r / cos, z]).collect();
        return generic_polyhedra(&corners, sides, phi);
    }
    let normals = side_normals(sides, phi, planes.len())?;
    let mut sections = Vec::new();
    for pair in planes.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if a.rmin > a.rmax || b.rmin > b.rmax {
            return refused("an inner radius is greater than the outer one");
        }
        let outer = frustum(&normals, (a.z, a.rmax), (b.z, b.rmax))?;
        let inner = frustum(&normals, (a.z, a.rmin), (b.z, b.rmin))?;
        let is_thin = a.rmin == a.rmax && b.rmin == b.rmax;
        sections.extend(match (outer, inner) {
            _ if is_thin => None,
            (Some(outer), Some(inner)) => Some(outer - inner),
            (outer, _) => outer,
        });
    }
    let whole = union_of(sections, "it has no interior: its length or its thickness is zero.")?;
    cut(whole, phi, sides, planes.iter().map(|plane| [plane.rmax, plane.z]))
}

/// The part within a sector. The sides of a partial turn alone are unbounded: a box with faces outside the solid gives
/// finite bounds.
fn cut(whole: Solid, phi: Phi, sides: u32, corners: impl Iterator<Item = [f64; 2]>) -> Made {
    if phi.is_whole() {
        return Ok(whole);
    }
    let (_, cos) = sin_cos_degrees(0.5 * phi.delta / f64::from(sides));
    let [r, z] = corners.fold([0.0f64; 2], |reach, [r, z]| [reach[0].max(r), reach[1].max(z.abs())]);
    phi.cut(whole & loose_box(r / cos, r / cos, 1.25 * z)?)
}

/// `G4Polyhedra` from the vertices (r, z) of a polygon: the radii are distances of the edges from the axis.
///
/// The solid is the symmetric difference of the frusta under the polygon's edges, as in [`super::round::generic_polycone`].
pub(in crate::gdml) fn generic_polyhedra(corners: &[[f64; 2]], sides: u32, phi: Phi) -> Made {
    let normals = side_normals(sides, phi, corners.len())?;
    let (_, cos) = sin_cos_degrees(0.5 * phi.delta.min(360.0) / f64::from(sides));
    let mut frusta = Vec::new();
    for ([r1, z1], [r2, z2]) in edges(corners) {
        frusta.extend(frustum(&normals, (z1, r1 * cos), (z2, r2 * cos))?);
    }
    match frusta.len() {
        0 => refused("its corners enclose nothing"),
        1 => cut(frusta.remove(0), phi, sides, corners.iter().copied()),
        _ => cut(Solid::symmetric_difference(frusta), phi, sides, corners.iter().copied()),
    }
}

/// Maximum number of faces of a polyhedra.
const MAX_FACES: usize = 1_000_000;

/// Outward directions of the side faces of a solid with the given number of planes.
fn side_normals(sides: u32, phi: Phi, planes: usize) -> Result<Vec<Vec3>, Failure> {
    if planes.saturating_mul(sides as usize) > MAX_FACES {
        return refused(format!("it has too many faces: more than {MAX_FACES}."));
    }
    let step = phi.delta.min(360.0) / f64::from(sides.max(1));
    if sides == 0 || step >= 180.0 {
        return refused("it has too few sides for its sector");
    }
    Ok((0..sides).map(|k| unit_vector_degrees(phi.start + (f64::from(k) + 0.5) * step)).collect())
}

/// The points behind the side faces, with distances that change linearly between two heights; `None` if empty.
///
/// If the sides cover only part of a turn, the sector cuts off the rest.
fn frustum(normals: &[Vec3], a: (f64, f64), b: (f64, f64)) -> Result<Option<Solid>, Failure> {
    let ((z1, r1), (z2, r2)) = if a.0 < b.0 { (a, b) } else { (b, a) };
    if r1 < 0.0 || r2 < 0.0 {
        return refused("a radius is negative");
    }
    if z1 == z2 || (r1 == 0.0 && r2 == 0.0) {
        return Ok(None);
    }
    let slope = (r2 - r1) / (z2 - z1);
    let side = |normal: &Vec3| [normal.x, normal.y, -slope, r1 - slope * z1];
    let ends = [[0.0, 0.0, -1.0, -z1], [0.0, 0.0, 1.0, z2]];
    Ok(Some(of(Convex::new(normals.iter().map(side).chain(ends).collect())?)))
}

/// `G4TessellatedSolid`: half-spaces if the facets enclose a convex solid, else a mesh.
pub(in crate::gdml) fn tessellated(facets: &[Vec<Vec3>]) -> Made {
    if let Some(planes) = planes_of(facets) {
        let convex = Convex::new(planes)?;
        let (found, corners) = (Primitive::from(convex.clone()).lower().bounds, bounds_of(facets));
        let near = |a: Vec3, b: Vec3| (a - b).abs().max_element() <= 1e-6 * corners.size().length();
        if near(found.lo, corners.lo) && near(found.hi, corners.hi) {
            return Ok(of(convex));
        }
        // a face is missing: the planes of the other faces intersect elsewhere, or nowhere
    }
    mesh(facets)
}

/// Defects of facets, as `G4TessellatedSolid::CheckStructure` finds them. Facets are counted from 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::gdml) struct Defects {
    /// Signed volume: negative if the facets are clockwise seen from outside.
    pub volume: f64,
    /// The facet with the most edges that another facet traverses in the same direction, and the number of all such edges.
    pub reversed: Option<(usize, usize)>,
    /// The first facet with an edge of an odd number of facets, and the number of all such edges.
    pub open: Option<(usize, usize)>,
}

impl Defects {
    pub fn of(facets: &[Vec<Vec3>]) -> Defects {
        let origin = facets.first().and_then(|facet| facet.first()).copied().unwrap_or_default();
        let volume = facets.iter().map(|facet| newell(facet).dot(facet[0] - origin) / 3.0).sum();
        let numbers = numbered(facets);
        // the two ends in order, the direction, and the facet
        let mut all: Vec<(usize, usize, bool, usize)> = Vec::new();
        for (facet, corners) in numbers.iter().enumerate() {
            let sides = edges(corners).filter(|(a, b)| a != b);
            all.extend(sides.map(|(a, b)| (a.min(b), a.max(b), a < b, facet)));
        }
        all.sort_unstable();
        let (mut wrong, mut reversed_edges) = (vec![0usize; facets.len()], 0);
        let mut open: Option<(usize, usize)> = None;
        for edge in all.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let forward = edge.iter().filter(|side| side.2).count();
            if edge.len() % 2 != 0 {
                let (first, count) = open.unwrap_or((usize::MAX, 0));
                let facet = edge.iter().map(|side| side.3).min().unwrap_or(first);
                open = Some((first.min(facet), count + 1));
            } else if 2 * forward != edge.len() {
                reversed_edges += 1;
                edge.iter().for_each(|side| wrong[side.3] += 1);
            }
        }
        let worst = wrong.iter().copied().max().unwrap_or(0);
        let reversed = wrong.iter().position(|&count| count == worst && count > 0);
        Defects { volume, reversed: reversed.map(|facet| (facet, reversed_edges)), open }
    }
}

fn bounds_of(facets: &[Vec<Vec3>]) -> Bounds {
    facets.iter().flatten().fold(Bounds::EMPTY, |all, p| all.union(&Bounds::new(*p, *p)))
}

/// Vertex numbers of the facets. Vertices within a billionth of the size are merged: those of `RELATIVE` facets are rounded.
fn numbered(facets: &[Vec<Vec3>]) -> Vec<Vec<usize>> {
    let size = bounds_of(facets).size().length();
    let near = 1e-9 * size;
    let cell = |p: Vec3| [p.x, p.y, p.z].map(|x| (x / (4.0 * near)).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<(Vec3, usize)>> = HashMap::new();
    let mut count = 0;
    let mut number = |p: Vec3| {
        let [low, high] = [cell(p - Vec3::splat(near)), cell(p + Vec3::splat(near))];
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let known = cells.get(&[x, y, z]).into_iter().flatten();
                    if let Some((_, k)) = known.into_iter().find(|(q, _)| (*q - p).length() <= near) {
                        return *k;
                    }
                }
            }
        }
        cells.entry(cell(p)).or_default().push((p, count));
        count += 1;
        count - 1
    };
    facets.iter().map(|facet| facet.iter().map(|p| number(*p)).collect()).collect()
}

/// The distinct planes of the facets if the solid is convex, i.e. if no vertex is in front of a plane.
fn planes_of(facets: &[Vec<Vec3>]) -> Option<Vec<[f64; 4]>> {
    let corners = || facets.iter().flatten();
    let centre = corners().sum::<Vec3>() / corners().count().max(1) as f64;
    let size = corners().fold(0.0f64, |size, p| size.max((*p - centre).length()));
    let mut planes: Vec<[f64; 4]> = Vec::new();
    for facet in facets {
        let normal = newell(facet).normalize_or_zero();
        if normal == Vec3::ZERO {
            continue;
        }
        let at = facet.iter().map(|p| normal.dot(*p)).sum::<f64>() / facet.len() as f64;
        let (normal, at) = if normal.dot(centre) > at { (-normal, -at) } else { (normal, at) };
        if corners().any(|p| normal.dot(*p) - at > 1e-9 * size) {
            return None;
        }
        let row = [normal.x, normal.y, normal.z, at];
        let is_near = |other: &[f64; 4], k: usize, tolerance: f64| (other[k] - row[k]).abs() <= tolerance;
        let is_known =
            |other: &[f64; 4]| (0..3).all(|k| is_near(other, k, 1e-9)) && is_near(other, 3, 1e-9 * size);
        if !planes.iter().any(is_known) {
            planes.push(row);
        }
    }
    Some(planes)
}

/// The solid inside facets, triangulated as fans.
fn mesh(facets: &[Vec<Vec3>]) -> Made {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for facet in facets {
        let first = vertices.len();
        vertices.extend(facet.iter().map(|corner| corner.to_array().to_vec()));
        faces.extend(
            (1..facet.len() - 1).map(|k| [first, first + k, first + k + 1].map(|n| n as f64).to_vec()),
        );
    }
    let arguments = [("vertices", Value::Rows(vertices)), ("faces", Value::Rows(faces))];
    build("mesh", &arguments)
        .map(of)
        .map_err(|error| Failure::Refused(format!("it is neither convex nor a valid mesh: {error}")))
}

/// Normal of a polygon in space; its length is the area (Newell's formula).
fn newell(polygon: &[Vec3]) -> Vec3 {
    edges(polygon).map(|(a, b)| 0.5 * (a - polygon[0]).cross(b - polygon[0])).sum()
}
