//! Linear extrusion (`linear_extrude`) without twist: prisms, and pyramids where the region is scaled along the height.

use super::arguments::{Arguments, Refusal};
use super::boolean::join_solids;
use super::budget::CORNER;
use super::extent::Way;
use super::flat::{Flat, Flats, Leaf, simple};
use super::mesh::{MAX_PLANES, Twist};
use super::part::solid;
use super::region::{filled, placed};
use i_overlay::core::fill_rule::FillRule;
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_polygon::Point;
use rayweave_polygon::{HalfPlane, Operator, Polygons};
use rayweave_shape::primitive::{BoxFromCorners, Convex, Cylinder, HalfSpace, Quadric};

/// Maximum number of points of an outline whose prism is a mesh.
const MAX_CORNERS: usize = 2000;

/// Margin of the box around a pyramid, relative to its larger side.
const LOOSE: f64 = 1.0 / 64.0;

/// Extrusion of a region.
pub(super) fn extruded(
    arguments: &Arguments,
    flats: &Flats,
    flat: Flat,
    way: &Way,
) -> Result<Solid, Refusal> {
    let leaf = |leaf: &Leaf, map: &Affine| {
        arguments.spend(CORNER * (3 + leaf.point_count()))?;
        match way.is_straight() {
            true => prism(arguments, leaf, map, way),
            false => pyramid(arguments, leaf, map, way),
        }
    };
    flats.fold(arguments, flat, leaf, |operation, parts| Ok(join_solids(operation, parts)))
}

/// Straight extrusion of a mapped leaf.
fn prism(arguments: &Arguments, leaf: &Leaf, map: &Affine, way: &Way) -> Result<Solid, Refusal> {
    let own = match leaf {
        Leaf::Disc { radius, .. } => {
            let rod = solid(arguments, Cylinder::new(*radius, way.top - way.bottom))?;
            let middle = 0.5 * (way.bottom + way.top);
            if middle == 0.0 { rod } else { rod.translate([0.0, 0.0, middle]) }
        }
        // a mesh has a BVH, and other programs can read it as one shape; triangulating the ends of very long outlines takes too
        // long
        Leaf::Outline(contours) if (MAX_PLANES..MAX_CORNERS).contains(&leaf.point_count()) => {
            Twist::plain(way).over(arguments, contours)?
        }
        Leaf::Outline(contours) => {
            let mut parts = Vec::with_capacity(contours.len());
            for contour in contours {
                parts.push(match simple(arguments, contour.clone()) {
                    Ok(None) => continue,
                    Ok(Some(polygons)) => prism_over(arguments, &polygons, way)?,
                    // a contour that crosses or touches itself: even-odd rule
                    Err(_) => tangled(arguments, contour, way)?,
                });
            }
            odd(parts)
        }
    };
    Ok(if *map == Affine::IDENTITY { own } else { own.apply(*map) })
}

/// Extrusion of a contour that crosses or touches itself, as a mesh.
fn tangled(arguments: &Arguments, contour: &[Point], way: &Way) -> Result<Solid, Refusal> {
    Twist::plain(way).over(arguments, &vec![contour.to_vec()])
}

/// Even-odd combination: inside an odd number of the solids.
pub(super) fn odd(mut parts: Vec<Solid>) -> Solid {
    match parts.len() {
        0 => Solid::empty(),
        1 => parts.remove(0),
        _ => Solid::symmetric_difference(parts),
    }
}

fn prism_over(arguments: &Arguments, polygons: &Polygons, way: &Way) -> Result<Solid, Refusal> {
    let (lo, hi) = (way.bottom, way.top);
    if let Some([a, b]) = rectangle(polygons) {
        let corners = BoxFromCorners::new(Vec3::new(a[0], a[1], lo), Vec3::new(b[0], b[1], hi));
        return solid(arguments, corners);
    }
    if is_convex(polygons) {
        let mut planes = vec![[0.0, 0.0, -1.0, -lo], [0.0, 0.0, 1.0, hi]];
        planes.extend(half_planes(polygons).iter().map(|h| [h.normal[0], h.normal[1], 0.0, h.offset]));
        return solid(arguments, Convex::new(planes));
    }
    polygons.extrude(lo, hi).map_err(|error| arguments.refusal(&error.to_string()))
}

/// The corners of an axis-parallel rectangle.
fn rectangle(polygons: &Polygons) -> Option<[Point; 2]> {
    let bounds = polygons.corner_bounds();
    let mut contours = polygons.contours();
    let (contour, none) = (contours.next()?, contours.next());
    let at_a_corner = |p: &Point| (0..2).all(|k| p[k] == bounds[0][k] || p[k] == bounds[1][k]);
    (none.is_none() && contour.corners.len() == 4 && contour.corners.iter().all(at_a_corner))
        .then_some(bounds)
}

/// True for a single convex contour: its formula is one intersection of half-planes.
pub(super) fn is_convex(polygons: &Polygons) -> bool {
    polygons.fold(
        |_| true,
        |operator, parts| operator == Operator::Intersection && parts.iter().all(|part| *part),
    )
}

/// The half-planes of all edges.
pub(super) fn half_planes(polygons: &Polygons) -> Vec<HalfPlane> {
    let mut all = Vec::with_capacity(polygons.edge_count());
    polygons.fold(|half_plane| all.push(half_plane), |_, _| ());
    all
}

/// A boolean formula of half-planes as a solid.
pub(super) fn formula(
    polygons: &Polygons,
    mut wall: impl FnMut(HalfPlane) -> Result<Solid, Refusal>,
) -> Result<Solid, Refusal> {
    let all = |parts: Vec<Result<Solid, Refusal>>| parts.into_iter().collect::<Result<Vec<Solid>, Refusal>>();
    polygons.fold(&mut wall, |operator, parts| {
        let parts = all(parts)?;
        Ok(match operator {
            Operator::Intersection => Solid::intersection(parts),
            Operator::Union => Solid::union(parts),
            Operator::SymmetricDifference => Solid::symmetric_difference(parts),
            Operator::Complement => !Solid::union(parts),
        })
    })
}

/// Scaled extrusion of a mapped leaf.
fn pyramid(arguments: &Arguments, leaf: &Leaf, map: &Affine, way: &Way) -> Result<Solid, Refusal> {
    if let Leaf::Disc { radius, .. } = leaf
        && way.scale[0] == way.scale[1]
    {
        return cone(arguments, *radius, map, way);
    }
    let [lo, hi] = leaf.bounds(map);
    let mut contours = placed(arguments, leaf.contours(), map, (hi[0] - lo[0]).max(hi[1] - lo[1]))?;
    if contours.iter().any(|contour| simple(arguments, contour.clone()).is_err()) {
        // crossings of edges must be vertices: walls other than those through the crossing are curved
        contours = filled(arguments, &contours, FillRule::EvenOdd)?;
    }
    let mut parts = Vec::new();
    for contour in contours {
        let polygons = match simple(arguments, contour.clone()) {
            Ok(None) => continue,
            Ok(Some(polygons)) => polygons,
            // plane walls, which triangles represent exactly
            Err(_) if way.is_even() => {
                parts.push(tangled(arguments, &contour, way)?);
                continue;
            }
            Err(why) => return Err(why),
        };
        let bounds = around(arguments, polygons.corner_bounds(), way)?;
        parts.push(formula(&polygons, |half_plane| wall(arguments, &half_plane, way))? & bounds);
    }
    Ok(odd(parts))
}

/// A box with the height range of the extrusion and a margin on all other sides.
fn around(arguments: &Arguments, [lo, hi]: [Point; 2], way: &Way) -> Result<Solid, Refusal> {
    let margin = LOOSE * (hi[0] - lo[0]).max(hi[1] - lo[1]);
    let end = |k: usize, p: Point, sign: f64| {
        let [a, b] = [p[k], p[k] * way.scale[k]];
        sign * (sign * a).max(sign * b) + sign * margin
    };
    let corner = |p, sign, z| Vec3::new(end(0, p, sign), end(1, p, sign), z);
    solid(arguments, BoxFromCorners::new(corner(lo, -1.0, way.bottom), corner(hi, 1.0, way.top)))
}

/// The wall over `a x + b y < c`, scaled along z: `a x / f + b y / g < c` with the scale factors f and g of x and y.
fn wall(arguments: &Arguments, half_plane: &HalfPlane, way: &Way) -> Result<Solid, Refusal> {
    let ([a, b], c) = (half_plane.normal, half_plane.offset);
    let [f, g] = way.factors();
    if f == g {
        // a x + b y - c slope z < c constant
        return solid(arguments, HalfSpace::new(Vec3::new(a, b, -c * f[0]), c * f[1]));
    }
    // a x g + b y f - c f g < 0, halved off the diagonal
    let xz = 0.5 * a * g[0];
    let yz = 0.5 * b * f[0];
    let x = 0.5 * a * g[1];
    let y = 0.5 * b * f[1];
    let z = -0.5 * c * (f[0] * g[1] + f[1] * g[0]);
    let matrix =
        [[0.0, 0.0, xz, x], [0.0, 0.0, yz, y], [xz, yz, -c * f[0] * g[0], z], [x, y, z, -c * f[1] * g[1]]];
    solid(arguments, Quadric::new(matrix))
}

/// Scaled extrusion of a mapped disc with equal scale in x and y: a right or oblique cone.
fn cone(arguments: &Arguments, radius: f64, map: &Affine, way: &Way) -> Result<Solid, Refusal> {
    let inverse = map.inverse().map_err(|error| arguments.refusal(&error.to_string()))?;
    let [factor, _] = way.factors();
    // coordinates in the frame of the disc, and the scale factor, as linear forms of (x, y, z, 1)
    let form = |row: usize| {
        let (x, y) = (inverse.linear.x_axis[row], inverse.linear.y_axis[row]);
        let shift = inverse.translation[row];
        [x, y, shift * factor[0], shift * factor[1]]
    };
    let grown = [0.0, 0.0, radius * factor[0], radius * factor[1]];
    let (u, v) = (form(0), form(1));
    let entry = |i: usize, j: usize| u[i] * u[j] + v[i] * v[j] - grown[i] * grown[j];
    let matrix = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| entry(i, j)));
    let bounds = Leaf::Disc { radius, fragments: 3 }.bounds(map);
    Ok(solid(arguments, Quadric::new(matrix))? & around(arguments, bounds, way)?)
}
