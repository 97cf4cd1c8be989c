//! `offset`: regions of the plane, grown or shrunk.

use super::arguments::{Arguments, Refusal};
use super::boolean::Operation;
use super::extrude::{half_planes, is_convex};
use super::facets::Fineness;
use super::flat::{Flat, Flats, Leaf, image, simple};
use super::gather::hull_of_discs;
use super::part::Part;
use super::revolve::plane_similarity;
use super::sum::{flat_sum, leaves};
use rayweave_math::{Affine, Vec3};
use rayweave_space::Point;
use rayweave_space::polygon::HalfPlane;

/// `offset(r)` and `offset(delta, chamfer)`.
pub(super) fn offset(arguments: &Arguments, flats: &mut Flats, flat: Flat) -> Result<Part, Refusal> {
    let radius = arguments.number("r", 0.0)?;
    let delta = arguments.number("delta", 0.0)?;
    match (radius, delta) {
        (0.0, 0.0) => Ok(flat.into()),
        (0.0, delta) => sharp(arguments, flats, flat, delta),
        (r, _) if r > 0.0 => {
            let fragments = Fineness::of(arguments)?.fragments(r);
            flat_sum(arguments, flats, flat, &[([0.0; 2], r, fragments)])
        }
        (r, _) => shrunk(arguments, flats, flat, -r),
    }
}

/// The one leaf of a region.
fn only(arguments: &Arguments, flats: &Flats, flat: Flat) -> Result<(Leaf, Affine), Refusal> {
    let mut all = leaves(arguments, flats, flat)?;
    match (all.pop(), all.is_empty()) {
        (Some(leaf), true) => Ok(leaf),
        _ => Err(arguments.refusal(
            "it shrinks, or keeps the corners of, more than one region: their common boundary is not known",
        )),
    }
}

/// What is farther than a distance from the boundary of a leaf.
fn shrunk(arguments: &Arguments, flats: &mut Flats, flat: Flat, by: f64) -> Result<Part, Refusal> {
    let (leaf, map) = only(arguments, flats, flat)?;
    if let (Leaf::Disc { radius, fragments }, Some(factor)) = (&leaf, plane_similarity(&map)) {
        let radius = factor * radius - by;
        if radius <= 0.0 {
            return Ok(Part::Empty);
        }
        let disc = flats.leaf(Leaf::Disc { radius, fragments: *fragments });
        return Ok(flats
            .moved(Affine::translate(Vec3::new(map.translation.x, map.translation.y, 0.0)), disc)
            .into());
    }
    let fragments = Fineness::of(arguments)?.fragments(by);
    let mut rims = Vec::new();
    for contour in leaf.contours() {
        let points: Vec<Point<2>> = contour.into_iter().map(|p| image(&map, p)).collect();
        for (k, p) in points.iter().enumerate() {
            let q = points[(k + 1) % points.len()];
            if let Part::Flat(pieces) = hull_of_discs(flats, &[(*p, by, fragments), (q, by, fragments)]) {
                rims.extend(pieces.into_iter().map(|piece| piece.body));
            }
        }
    }
    let own = flats.leaf(leaf);
    let mut operands = vec![flats.moved(map, own)];
    operands.extend(rims);
    Ok(flats.join(Operation::Difference, operands).into())
}

/// A convex polygon with its edges moved outward and its corners kept, or cut off.
fn sharp(arguments: &Arguments, flats: &mut Flats, flat: Flat, by: f64) -> Result<Part, Refusal> {
    let (leaf, map) = only(arguments, flats, flat)?;
    let contours = leaf.contours();
    let contour: Vec<Point<2>> = contours.iter().flatten().map(|p| image(&map, *p)).collect();
    let polygons = simple(arguments, contour)?.filter(|_| contours.len() == 1);
    let Some(polygons) = polygons.filter(is_convex) else {
        return Err(arguments.refusal("it keeps the corners of a region that is not convex"));
    };
    let moved = |h: &HalfPlane| {
        let length = libm::hypot(h.normal[0], h.normal[1]);
        (h.normal.map(|x| x / length), h.offset / length + by)
    };
    let mut walls: Vec<(Point<2>, f64)> = half_planes(&polygons).iter().map(moved).collect();
    if by > 0.0 && arguments.truth("chamfer", false)? {
        walls.extend(chamfers(&polygons.contours().flat_map(|c| c.corners.to_vec()).collect::<Vec<_>>(), by));
    }
    let [lo, hi] = polygons.corner_bounds();
    // mitres of sharp corners reach far
    let far = 100.0 * (hi[0] - lo[0] + hi[1] - lo[1] + by.abs());
    let mut corners = vec![
        [lo[0] - far, lo[1] - far],
        [hi[0] + far, lo[1] - far],
        [hi[0] + far, hi[1] + far],
        [lo[0] - far, hi[1] + far],
    ];
    for wall in walls {
        corners = clipped(&corners, wall);
    }
    match corners.len() >= 3 {
        true => Ok(flats.leaf(Leaf::Outline(vec![corners])).into()),
        false => Ok(Part::Empty),
    }
}

/// Half-planes that cut off each corner at a distance from it, across the bisector.
fn chamfers(corners: &[Point<2>], by: f64) -> Vec<(Point<2>, f64)> {
    let n = corners.len();
    let unit = |a: Point<2>, b: Point<2>| {
        let d = [b[0] - a[0], b[1] - a[1]];
        d.map(|x| x / libm::hypot(d[0], d[1]))
    };
    let cut = |k: usize| {
        let (before, here, after) = (corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]);
        let (u, v) = (unit(before, here), unit(after, here));
        let out = [u[0] + v[0], u[1] + v[1]];
        let out = out.map(|x| x / libm::hypot(out[0], out[1]));
        (out, out[0] * here[0] + out[1] * here[1] + by)
    };
    (0..n).map(cut).collect()
}

/// A convex polygon cut by a half-plane `normal . p < offset` (I. E. Sutherland, G. W. Hodgman 1974).
fn clipped(corners: &[Point<2>], (normal, offset): (Point<2>, f64)) -> Vec<Point<2>> {
    let height = |p: Point<2>| normal[0] * p[0] + normal[1] * p[1] - offset;
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (k, &p) in corners.iter().enumerate() {
        let q = corners[(k + 1) % corners.len()];
        let (a, b) = (height(p), height(q));
        if a <= 0.0 {
            kept.push(p);
        }
        if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
            let t = a / (a - b);
            kept.push([0, 1].map(|axis| p[axis] + t * (q[axis] - p[axis])));
        }
    }
    kept
}
