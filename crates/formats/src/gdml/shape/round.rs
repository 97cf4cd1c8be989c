//! Round solids: tubes, cones, polycones, spheres, tori, quadrics.

use super::{Made, Phi, loose_box, of, union_of};
use crate::gdml::attributes::{Failure, refused};
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_model::Solid;
use rayweave_polygon::{Corner, Outline, Vertex};
use rayweave_shape::primitive::{
    Cone, Cylinder, Ellipsoid, HalfSpace, Paraboloid, Quadric, Slab, Sphere, Torus, Tube,
};

/// A z plane of a polycone or polyhedra, with its radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gdml) struct ZPlane {
    pub z: f64,
    pub rmin: f64,
    pub rmax: f64,
}

/// `G4Tubs`, with full length along z.
pub(in crate::gdml) fn tube(rmin: f64, rmax: f64, z: f64, phi: Phi) -> Made {
    phi.cut(whole_tube(rmin, rmax, z)?)
}

fn whole_tube(rmin: f64, rmax: f64, z: f64) -> Made {
    Ok(match rmin == 0.0 {
        true => of(Cylinder::new(rmax, z)?),
        false => of(Tube::new(rmax, rmin, z)?),
    })
}

/// `G4CutTubs`: a tube cut by planes with given normals through (0, 0, -z/2) and (0, 0, z/2).
pub(in crate::gdml) fn cut_tube(rmin: f64, rmax: f64, z: f64, phi: Phi, low: Vec3, high: Vec3) -> Made {
    if low.z >= 0.0 || high.z <= 0.0 {
        return refused("the normals of the ends do not point down and up");
    }
    // longer than the slanted ends, so that the flat ends of the tube lie outside
    let slope = |normal: Vec3| normal.truncate().length() / normal.z.abs();
    let reach = 1.5 * (z + 2.0 * rmax * slope(low).max(slope(high)));
    let ends = of(HalfSpace::new(low, -0.5 * z * low.z)?) & of(HalfSpace::new(high, 0.5 * z * high.z)?);
    phi.cut(Solid::intersection([whole_tube(rmin, rmax, reach)?, ends]))
}

/// `G4Cons`, with full length along z.
pub(in crate::gdml) fn cone(low: [f64; 2], high: [f64; 2], z: f64, phi: Phi) -> Made {
    let plane = |z: f64, [rmin, rmax]: [f64; 2]| ZPlane { z, rmin, rmax };
    let section = section(plane(-0.5 * z, low), plane(0.5 * z, high))?;
    phi.cut(section.map_or_else(|| refused("it has no interior: its length or its thickness is zero."), Ok)?)
}

/// Frustum between two heights; `None` if empty.
fn frustum(z1: f64, r1: f64, z2: f64, r2: f64) -> Result<Option<Solid>, Failure> {
    let ((z1, r1), (z2, r2)) = if z1 < z2 { ((z1, r1), (z2, r2)) } else { ((z2, r2), (z1, r1)) };
    if z1 == z2 || (r1 == 0.0 && r2 == 0.0) {
        return Ok(None);
    }
    let frustum = of(Cone::new(r1, r2, z2 - z1)?);
    let middle = 0.5 * (z1 + z2);
    Ok(Some(if middle == 0.0 { frustum } else { frustum.translate(Vec3::Z * middle) }))
}

/// The part between the radii of two z planes; `None` if empty.
fn section(a: ZPlane, b: ZPlane) -> Result<Option<Solid>, Failure> {
    if a.rmin > a.rmax || b.rmin > b.rmax {
        return refused("an inner radius is greater than the outer one");
    }
    if a.rmin == a.rmax && b.rmin == b.rmax {
        return Ok(None);
    }
    let outer = frustum(a.z, a.rmax, b.z, b.rmax)?;
    let inner = frustum(a.z, a.rmin, b.z, b.rmin)?;
    Ok(match (outer, inner) {
        (Some(outer), Some(inner)) => Some(outer - inner),
        (outer, _) => outer,
    })
}

/// The number of corners above which a polygon is revolved as an outline: rays are intersected with the few edges near them.
const MANY: usize = 256;

/// A simple polygon of vertices (r, z), revolved about the z axis; `None` for polygons that cross or touch themselves.
fn turned(corners: &[[f64; 2]]) -> Option<Solid> {
    let corner = |at: &[f64; 2]| Vertex { at: *at, bulge: 0.0, corner: Corner::Sharp };
    let outline = Outline::new(&[corners.iter().map(corner).collect()]).ok()?;
    outline.revolve(0.0, 360.0).ok()
}

/// `G4Polycone` from z planes; two planes at one height make a step. If z is not monotonic, the polygon of the radii is
/// revolved.
pub(in crate::gdml) fn polycone(planes: &[ZPlane], phi: Phi) -> Made {
    if !in_order(planes) {
        return generic_polycone(&outline(planes), phi);
    }
    if planes.len() > MANY
        && let Some(turned) = turned(&outline(planes))
    {
        return phi.cut(turned);
    }
    let mut sections = Vec::new();
    for pair in planes.windows(2) {
        sections.extend(section(pair[0], pair[1])?);
    }
    phi.cut(union_of(sections, "it has no interior: its length or its thickness is zero.")?)
}

/// True if the planes are monotonic in z.
pub(super) fn in_order(planes: &[ZPlane]) -> bool {
    let goes = |sign: f64| planes.windows(2).all(|pair| sign * (pair[1].z - pair[0].z) >= 0.0);
    goes(1.0) || goes(-1.0)
}

/// The polygon (r, z) of planes: along the outer radii, and back along the inner ones.
pub(super) fn outline(planes: &[ZPlane]) -> Vec<[f64; 2]> {
    let outer = planes.iter().map(|plane| [plane.rmax, plane.z]);
    let inner = planes.iter().rev().map(|plane| [plane.rmin, plane.z]);
    outer.chain(inner).collect()
}

/// `G4GenericPolycone`: a polygon of vertices (r, z), revolved about the z axis.
///
/// A point is inside the polygon if an odd number of edges at its height is farther from the axis: the solid is the
/// symmetric difference of the frusta under the edges.
pub(in crate::gdml) fn generic_polycone(corners: &[[f64; 2]], phi: Phi) -> Made {
    if corners.iter().any(|[r, _]| *r < 0.0) {
        return refused("a radius is negative");
    }
    if corners.len() > MANY
        && let Some(turned) = turned(corners)
    {
        return phi.cut(turned);
    }
    let mut frusta = Vec::new();
    for ([r1, z1], [r2, z2]) in edges(corners) {
        frusta.extend(frustum(z1, r1, z2, r2)?);
    }
    match frusta.len() {
        0 => refused("its corners enclose nothing"),
        1 => phi.cut(frusta.remove(0)),
        _ => phi.cut(Solid::symmetric_difference(frusta)),
    }
}

/// The edges of a closed polygon.
pub(super) fn edges<T: Copy>(corners: &[T]) -> impl Iterator<Item = (T, T)> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// `G4Sphere`: polar angles `theta` from +z, in degrees.
pub(in crate::gdml) fn sphere(rmin: f64, rmax: f64, phi: Phi, theta: Phi) -> Made {
    if rmin >= rmax {
        return refused("the inner radius is not less than the outer one");
    }
    let mut ball = of(Sphere::new(rmax)?);
    if rmin > 0.0 {
        ball = ball - of(Sphere::new(rmin)?);
    }
    // Geant4 clamps angles beyond the pole
    let end = theta.start + theta.delta;
    if !(0.0..180.0).contains(&theta.start) || theta.delta <= 0.0 {
        return refused("the polar angles are not between 0 and 180 degrees");
    }
    if end < 180.0 - 1e-7 {
        ball = ball & above(end, rmax)?;
    }
    if theta.start > 0.0 {
        ball = ball - above(theta.start, rmax)?;
    }
    phi.cut(ball)
}

/// The directions with a polar angle below `theta` (between 0 and 180 degrees), within a ball.
fn above(theta: f64, radius: f64) -> Made {
    if theta > 90.0 {
        return Ok(!above_equator(180.0 - theta, radius)?.mirror(Vec3::Z));
    }
    above_equator(theta, radius)
}

fn above_equator(theta: f64, radius: f64) -> Made {
    let (sin, cos) = sin_cos_degrees(theta);
    if cos <= 1e-12 {
        return Ok(of(HalfSpace::new(Vec3::NEG_Z, 0.0)?));
    }
    // the cone ends outside the ball, so that this end is never visible
    let height = 1.25 * radius;
    Ok(of(Cone::new(0.0, height * sin / cos, height)?).translate(Vec3::Z * (0.5 * height)))
}

/// `G4Orb`.
pub(in crate::gdml) fn orb(radius: f64) -> Made {
    Ok(of(Sphere::new(radius)?))
}

/// `G4Torus`.
pub(in crate::gdml) fn torus(rmin: f64, rmax: f64, major: f64, phi: Phi) -> Made {
    if rmin >= rmax || rmax > major {
        return refused("the radii are not in the order rmin < rmax <= rtor");
    }
    let outer = of(Torus::new(major, rmax)?);
    phi.cut(if rmin > 0.0 { outer - of(Torus::new(major, rmin)?) } else { outer })
}

/// `G4Ellipsoid`: half axes, cut off below and above; no cuts if both are 0.
pub(in crate::gdml) fn ellipsoid(radii: [f64; 3], low: f64, high: f64) -> Made {
    let whole = of(Ellipsoid::new(Vec3::from_array(radii))?);
    let (low, high) = if low == 0.0 && high == 0.0 { (-radii[2], radii[2]) } else { (low, high) };
    if low >= high || low >= radii[2] || high <= -radii[2] {
        return refused("the cuts remove all of it");
    }
    between(whole, low, high, radii[2])
}

/// The part of a solid in `|z| < reach` that is between two heights.
fn between(solid: Solid, low: f64, high: f64, reach: f64) -> Made {
    Ok(match (low > -reach, high < reach) {
        (false, false) => solid,
        (true, false) => solid & of(HalfSpace::new(Vec3::NEG_Z, -low)?),
        (false, true) => solid & of(HalfSpace::new(Vec3::Z, high)?),
        (true, true) => solid & of(Slab::new(Vec3::Z, low, high)?),
    })
}

/// A solid scaled along y.
fn stretched(solid: Solid, ratio: f64) -> Made {
    match ratio.is_finite() && ratio > 0.0 {
        true if ratio == 1.0 => Ok(solid),
        true => Ok(solid.scale(Vec3::new(1.0, ratio, 1.0))),
        false => refused("a half axis is not greater than 0"),
    }
}

/// `G4EllipticalTube`, with half lengths.
pub(in crate::gdml) fn elliptical_tube(dx: f64, dy: f64, dz: f64) -> Made {
    stretched(of(Cylinder::new(dx, 2.0 * dz)?), dy / dx)
}

/// `G4EllipticalCone`: (x/dx)^2 + (y/dy)^2 < (zmax - z)^2 and |z| < zcut.
pub(in crate::gdml) fn elliptical_cone(dx: f64, dy: f64, zmax: f64, zcut: f64) -> Made {
    let cut = zcut.min(zmax);
    stretched(of(Cone::new(dx * (zmax + cut), dx * (zmax - cut), 2.0 * cut)?), dy / dx)
}

/// `G4Paraboloid`, with the radii at -dz and dz.
pub(in crate::gdml) fn paraboloid(low: f64, high: f64, dz: f64) -> Made {
    if !(0.0 <= low && low < high && dz > 0.0) {
        return refused("the radii are not in the order 0 <= rlo < rhi, or the length is not greater than 0");
    }
    // r^2 = 4 f (z - vertex)
    let focal_length = (high - low) * (high + low) / (8.0 * dz);
    let height = high * high / (4.0 * focal_length);
    let whole = of(Paraboloid::new(focal_length, height)?).translate(Vec3::Z * (dz - height));
    Ok(if low > 0.0 { whole & of(HalfSpace::new(Vec3::NEG_Z, dz)?) } else { whole })
}

/// `G4Hype`: r^2 between rmin^2 + (z tan inst)^2 and rmax^2 + (z tan outst)^2; full length along z.
pub(in crate::gdml) fn hype(rmin: f64, rmax: f64, inst: f64, outst: f64, z: f64) -> Made {
    let half = 0.5 * z;
    let slope = |angle: f64| {
        let (sin, cos) = sin_cos_degrees(angle);
        sin / cos
    };
    let (inner, outer) = (slope(inst), slope(outst));
    let radius = |r: f64, slope: f64| libm::hypot(r, slope * half);
    if !(0.0 <= rmin && rmin < rmax) || radius(rmin, inner) >= radius(rmax, outer) {
        return refused("the inner surface is not within the outer one");
    }
    let end = radius(rmax, outer);
    let whole = hyperboloid(rmax, outer)? & loose_box(end, end, half)?;
    Ok(if radius(rmin, inner) > 0.0 { whole - hyperboloid(rmin, inner)? } else { whole })
}

/// x^2 + y^2 < r^2 + (slope z)^2
pub(super) fn hyperboloid(r: f64, slope: f64) -> Made {
    let mut matrix = [[0.0; 4]; 4];
    for (k, value) in [1.0, 1.0, -slope * slope, -r * r].into_iter().enumerate() {
        matrix[k][k] = value;
    }
    Ok(of(Quadric::new(matrix)?))
}
