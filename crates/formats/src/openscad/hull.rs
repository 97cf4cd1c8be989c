//! OpenSCAD hull: the convex hull of points, balls and discs, as a union of convex solids.
//!
//! The hull of balls is bounded by pieces of the balls, of cones tangent to two balls, and of planes tangent to three or
//! more. It is the union of the balls, the frustums between pairs of balls that share such planes, and the polyhedron of
//! the points where the planes touch the balls: each piece of a cone or ball outside the polyhedron lies in a convex solid
//! that also contains the rim of the piece.

use super::arguments::{Arguments, Refusal};
use super::convex_hull::{convex_hull, planes};
use super::facets::{direction, ring_points, sphere_rings};
use super::mesh::convex;
use super::part::solid;
use super::part::union;
use rayweave_math::{Affine, Mat3, Vec3, any_perpendicular};
use rayweave_model::Solid;
use rayweave_shape::primitive::{Cone, Cylinder, Sphere};

/// Relative tolerance for equality: numbers are printed with six digits.
const NEAR: f64 = 1e-7;

/// Maximum number of balls of different sizes with exact hulls, since every triple is tested for tangent planes; with more, balls are
/// replaced by their facets.
const MAX_BALLS: usize = 100;

/// A generator of a convex hull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Generator {
    /// A ball; radius 0 means a point.
    Ball { centre: Vec3, radius: f64, fragments: usize },
    /// A disc with a unit normal.
    Disc { centre: Vec3, axis: Vec3, radius: f64, fragments: usize },
}

impl Generator {
    pub fn point(centre: Vec3) -> Generator {
        Generator::Ball { centre, radius: 0.0, fragments: 1 }
    }

    pub fn centre(&self) -> Vec3 {
        match self {
            Generator::Ball { centre, .. } | Generator::Disc { centre, .. } => *centre,
        }
    }

    pub fn radius(&self) -> f64 {
        match self {
            Generator::Ball { radius, .. } | Generator::Disc { radius, .. } => *radius,
        }
    }

    /// Lower and upper corner of the bounding box.
    pub fn bounds(&self) -> [Vec3; 2] {
        let reach = match self {
            Generator::Ball { radius, .. } => Vec3::splat(*radius),
            Generator::Disc { axis, radius, .. } => {
                *radius * Vec3::from_array(axis.to_array().map(|a| libm::sqrt((1.0 - a * a).max(0.0))))
            }
        };
        [self.centre() - reach, self.centre() + reach]
    }

    pub fn vertex_count(&self) -> usize {
        match *self {
            Generator::Ball { radius: 0.0, .. } => 1,
            Generator::Ball { fragments, .. } => fragments * fragments.div_ceil(2),
            Generator::Disc { fragments, .. } => fragments,
        }
    }

    /// The vertices of OpenSCAD's tessellation, up to the starting angle.
    pub fn vertices(&self) -> Vec<Vec3> {
        match *self {
            Generator::Ball { centre, radius: 0.0, .. } => vec![centre],
            Generator::Ball { centre, radius, fragments } => {
                let points = ring_points(&sphere_rings(radius, fragments), fragments);
                points.into_iter().map(|p| centre + p).collect()
            }
            Generator::Disc { centre, axis, radius, fragments } => {
                let u = any_perpendicular(axis);
                let v = axis.cross(u);
                let corner = |k: usize| {
                    let [cos, sin] = direction(k as f64, fragments);
                    centre + radius * (cos * u + sin * v)
                };
                (0..fragments).map(corner).collect()
            }
        }
    }
}

/// A convex hull, inexact if round generators were tessellated.
pub(super) struct Hull {
    pub solid: Option<Solid>,
    pub is_exact: bool,
}

/// Approximate number of steps to compute an exact hull, excluding the hull of points.
pub(super) fn cost(generators: &[Generator]) -> usize {
    let n = generators.len();
    let is_round = |g: &&Generator| matches!(g, Generator::Ball { radius, .. } if *radius > 0.0);
    let rounds = generators.iter().filter(is_round).count();
    let discs = generators.iter().filter(|g| matches!(g, Generator::Disc { .. })).count();
    // pairs of discs are compared to find twins, pairs of balls to find one inside the other; triples of balls are tested
    let pairs = if discs > 0 || rounds > 0 { n.saturating_mul(n).saturating_mul(10) } else { 0 };
    let balls = if discs > 0 { 0 } else { rounds.min(MAX_BALLS) };
    pairs.saturating_add(100 * balls * balls * n.min(MAX_BALLS))
}

/// Convex hull of generators; it has no solid if its volume is zero.
pub(super) fn hull(arguments: &Arguments, generators: &[Generator]) -> Result<Hull, Refusal> {
    let exact = match generators.iter().any(|g| matches!(g, Generator::Disc { .. })) {
        true => of_discs(arguments, generators)?,
        false => of_balls(arguments, generators)?,
    };
    if let Some(solid) = exact {
        return Ok(Hull { solid: Some(solid), is_exact: true });
    }
    let points = vertices(arguments, generators)?;
    let is_exact = generators.iter().all(|g| g.radius() == 0.0);
    Ok(Hull { solid: of_points(arguments, points)?, is_exact })
}

/// The vertices of the tessellations of all generators.
pub(super) fn vertices(arguments: &Arguments, generators: &[Generator]) -> Result<Vec<Vec3>, Refusal> {
    let count = generators.iter().map(Generator::vertex_count).fold(0, usize::saturating_add);
    check_count(arguments, count)?;
    Ok(generators.iter().flat_map(Generator::vertices).collect())
}

/// Maximum number of points that are collected for one hull.
const MAX_POINTS: usize = 2_000_000;

/// Refuses a number of points that would exhaust memory, before they are made, and counts their cost.
pub(super) fn check_count(arguments: &Arguments, count: usize) -> Result<(), Refusal> {
    match count > MAX_POINTS {
        true => Err(arguments.refusal(&format!("it has more than {MAX_POINTS} points"))),
        false => arguments.spend(100 * count),
    }
}

/// Convex hull of points as a polyhedron.
pub(super) fn of_points(arguments: &Arguments, points: Vec<Vec3>) -> Result<Option<Solid>, Refusal> {
    let points = distinct(points);
    match convex_hull(arguments, &points)? {
        None => Ok(None),
        Some(faces) => {
            arguments.hold(faces.len())?;
            let planes = planes(&points, &faces);
            let triangles = || faces.iter().map(|corners| corners.map(|k| k as u32)).collect();
            convex(arguments, planes, || (points.clone(), triangles())).map(Some)
        }
    }
}

fn distinct(mut points: Vec<Vec3>) -> Vec<Vec3> {
    points.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap_or(std::cmp::Ordering::Equal));
    points.dedup();
    points
}

#[derive(Clone, Copy, Debug)]
struct Ball {
    centre: Vec3,
    radius: f64,
}

/// Convex hull of balls; `None` if there are too many.
fn of_balls(arguments: &Arguments, generators: &[Generator]) -> Result<Option<Solid>, Refusal> {
    let all: Vec<Ball> = generators.iter().map(|g| Ball { centre: g.centre(), radius: g.radius() }).collect();
    if all.iter().all(|ball| ball.radius == 0.0) {
        return of_points(arguments, all.iter().map(|ball| ball.centre).collect());
    }
    let size = all.iter().fold(0f64, |size, ball| size.max(ball.centre.abs().max_element() + ball.radius));
    let balls = outer(all, NEAR * size);
    if balls.len() > MAX_BALLS {
        return Ok(None);
    }
    let touching = planes_that_touch(&balls, NEAR * size);
    let mut parts = Vec::new();
    let tangent: Vec<Vec3> = (touching.iter())
        .flat_map(|plane| plane.balls.iter().map(|k| balls[*k].centre + balls[*k].radius * plane.normal))
        .collect();
    parts.extend(of_points(arguments, tangent)?);
    for (i, a) in balls.iter().enumerate() {
        if a.radius > 0.0 {
            parts.push(solid(arguments, Sphere::new(a.radius))?.translate(a.centre));
        }
        for (j, b) in balls.iter().enumerate().skip(i + 1) {
            let shared = touching.iter().filter(|plane| plane.balls.contains(&i) && plane.balls.contains(&j));
            // without tangent planes all centres are collinear
            if touching.is_empty() || shared.count() >= 2 {
                parts.extend(frustum(arguments, a, b)?);
            }
        }
    }
    Ok(Some(union(parts)))
}

/// The balls that no other ball contains, without duplicates.
fn outer(all: Vec<Ball>, near: f64) -> Vec<Ball> {
    let mut kept: Vec<Ball> = Vec::new();
    let within = |a: &Ball, b: &Ball| (a.centre - b.centre).length() + a.radius <= b.radius + near;
    for ball in all {
        if !kept.iter().any(|other| within(&ball, other)) {
            kept.retain(|other| !within(other, &ball));
            kept.push(ball);
        }
    }
    kept
}

/// A supporting plane that touches three or more balls.
struct Touching {
    normal: Vec3,
    balls: Vec<usize>,
}

fn planes_that_touch(balls: &[Ball], near: f64) -> Vec<Touching> {
    let mut found: Vec<Touching> = Vec::new();
    for i in 0..balls.len() {
        for j in i + 1..balls.len() {
            for k in j + 1..balls.len() {
                for normal in normals([&balls[i], &balls[j], &balls[k]]) {
                    push(&mut found, balls, normal, i, near);
                }
            }
        }
    }
    found
}

/// Adds the plane with the given normal that touches ball `i`, if it supports all balls and is new.
fn push(found: &mut Vec<Touching>, balls: &[Ball], normal: Vec3, i: usize, near: f64) {
    let reach = |ball: &Ball| normal.dot(ball.centre) + ball.radius;
    let offset = reach(&balls[i]);
    if balls.iter().any(|ball| reach(ball) > offset + near) {
        return;
    }
    if found.iter().any(|plane| (plane.normal - normal).length() < NEAR) {
        return;
    }
    let touched = (0..balls.len()).filter(|k| reach(&balls[*k]) >= offset - near).collect();
    found.push(Touching { normal, balls: touched });
}

/// Normals of the two planes that touch three balls from the same side: n . (c2 - c1) = r1 - r2, and so on.
fn normals([a, b, c]: [&Ball; 3]) -> Vec<Vec3> {
    let (e, f) = (b.centre - a.centre, c.centre - a.centre);
    let across = e.cross(f);
    // collinear centres do not determine a plane
    if across.length() <= NEAR * e.length() * f.length() {
        return Vec::new();
    }
    let rows = Mat3::from_cols(e, f, across).transpose();
    let within = rows.inverse() * Vec3::new(a.radius - b.radius, a.radius - c.radius, 0.0);
    let rest = 1.0 - within.length_squared();
    if rest < 0.0 {
        return Vec::new();
    }
    let up = across.normalize() * rest.sqrt();
    vec![within + up, within - up]
}

/// Frustum between the tangent circles of the cone around two balls; `None` if it has no volume.
fn frustum(arguments: &Arguments, a: &Ball, b: &Ball) -> Result<Option<Solid>, Refusal> {
    let along = b.centre - a.centre;
    let distance = along.length();
    // sine of the half angle of the cone
    let sine = (a.radius - b.radius) / distance;
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let [r1, r2] = [a, b].map(|ball| ball.radius * cosine);
    let [z1, z2] = [a.radius * sine, distance + b.radius * sine];
    if z2 <= z1 || r1.max(r2) <= 0.0 {
        return Ok(None);
    }
    let centred = match r1 == r2 {
        true => solid(arguments, Cylinder::new(r1, z2 - z1))?,
        false => solid(arguments, Cone::new(r1, r2, z2 - z1))?,
    };
    let axis = along / distance;
    let middle = a.centre + 0.5 * (z1 + z2) * axis;
    Ok(Some(centred.apply(upright(axis).then(&Affine::translate(middle)))))
}

/// A rotation that takes z to the given unit vector.
fn upright(axis: Vec3) -> Affine {
    if axis == Vec3::Z {
        return Affine::IDENTITY;
    }
    let u = any_perpendicular(axis);
    Affine::from_linear(Mat3::from_cols(u, axis.cross(u), axis))
}

/// Convex hull of parallel discs and points if it is a stack of frustums or a prism over a plane hull, else `None`.
fn of_discs(arguments: &Arguments, generators: &[Generator]) -> Result<Option<Solid>, Refusal> {
    let axis = generators.iter().find_map(|g| match g {
        Generator::Disc { axis, .. } => Some(*axis),
        Generator::Ball { .. } => None,
    });
    let Some(axis) = axis else { return Ok(None) };
    let fits = |g: &Generator| match g {
        Generator::Disc { axis: other, .. } => axis.cross(*other).length() < NEAR,
        Generator::Ball { radius, .. } => *radius == 0.0,
    };
    if !generators.iter().all(fits) {
        return Ok(None);
    }
    match upright_discs(generators, axis) {
        Some([lo, hi]) => prism(arguments, generators, axis, lo, hi),
        None => stack(arguments, generators, axis),
    }
}

/// The heights of the two ends of a prism along an axis, if every generator has a copy at both ends; else `None`.
fn upright_discs(generators: &[Generator], axis: Vec3) -> Option<[f64; 2]> {
    let heights: Vec<f64> = generators.iter().map(|g| axis.dot(g.centre())).collect();
    let lo = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let hi = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let size =
        generators.iter().fold(hi - lo, |size, g| size.max(g.centre().abs().max_element() + g.radius()));
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-5 * size;
    let has_twin = |g: &Generator, height: f64, end: f64| {
        let foot = g.centre() + (end - height) * axis;
        let is_twin = |t: &Generator| near((t.centre() - foot).length(), 0.0) && near(t.radius(), g.radius());
        generators.iter().any(is_twin)
    };
    let mut all = generators.iter().zip(&heights);
    (hi > lo && all.all(|(g, height)| has_twin(g, *height, lo) && has_twin(g, *height, hi)))
        .then_some([lo, hi])
}

/// Prism over the plane hull of discs.
fn prism(
    arguments: &Arguments,
    generators: &[Generator],
    axis: Vec3,
    lo: f64,
    hi: f64,
) -> Result<Option<Solid>, Refusal> {
    let to_z = upright(axis).inverse().map_err(|error| arguments.refusal(&error.to_string()))?;
    let lower = generators.iter().filter(|g| axis.dot(g.centre()) - lo < 1e-4 * (hi - lo));
    let discs: Vec<([f64; 2], f64)> = lower
        .map(|g| {
            let p = to_z.point(g.centre());
            ([p.x, p.y], g.radius())
        })
        .collect();
    let corners = super::hull2::touching_points(&discs, |steps| arguments.spend(20 * steps))?;
    let mut parts = Vec::new();
    if corners.len() >= 3 {
        let points = corners.iter().flat_map(|c| [Vec3::new(c[0], c[1], lo), Vec3::new(c[0], c[1], hi)]);
        parts.extend(of_points(arguments, points.collect())?);
    }
    for ([x, y], radius) in discs.iter().filter(|disc| disc.1 > 0.0) {
        let rod = solid(arguments, Cylinder::new(*radius, hi - lo))?;
        parts.push(rod.translate([*x, *y, 0.5 * (lo + hi)]));
    }
    Ok(Some(union(parts).apply(upright(axis))))
}

/// Convex hull of coaxial discs and points: frustums between neighbours on the upper hull of the profile.
fn stack(arguments: &Arguments, generators: &[Generator], axis: Vec3) -> Result<Option<Solid>, Refusal> {
    let start = generators[0].centre();
    let size = generators.iter().fold(0f64, |size, g| size.max((g.centre() - start).length() + g.radius()));
    let off = |g: &Generator| (g.centre() - start).cross(axis).length();
    if generators.iter().any(|g| off(g) > 1e-5 * size) {
        return Ok(None);
    }
    let foot = start - axis.dot(start) * axis;
    let mut profile: Vec<[f64; 2]> = generators.iter().map(|g| [axis.dot(g.centre()), g.radius()]).collect();
    profile.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    let mut upper: Vec<[f64; 2]> = Vec::new();
    for p in profile {
        if let Some(last) = upper.last_mut().filter(|last| last[0] == p[0]) {
            *last = p;
        } else {
            upper.push(p);
        }
        while let [.., a, b, c] = upper[..]
            && (b[1] - a[1]) * (c[0] - a[0]) <= (c[1] - a[1]) * (b[0] - a[0])
        {
            upper.remove(upper.len() - 2);
        }
    }
    let mut parts = Vec::new();
    for pair in upper.windows(2) {
        let ([z1, r1], [z2, r2]) = (pair[0], pair[1]);
        if r1 > 0.0 || r2 > 0.0 {
            let frustum = solid(arguments, Cone::new(r1, r2, z2 - z1))?;
            let middle = foot + 0.5 * (z1 + z2) * axis;
            parts.push(frustum.apply(upright(axis).then(&Affine::translate(middle))));
        }
    }
    Ok((!parts.is_empty()).then(|| union(parts)))
}
