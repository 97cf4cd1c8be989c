//! Distances from surfaces and from curves in which two surfaces meet.

use super::quadric_foot::quadric_foot;
use rayweave_math::{Mat3, UNIT_ROUNDOFF, Vec3, symmetric_eigen};
use rayweave_shape::surface::{Cone, MeshForm, Object, Plane, Quadric, Surface, Torus};
use std::any::Any;

/// A number with the sign of f at a point, whose magnitude is at most the distance from the surface. It is the distance, up to
/// rounding, for planes, spheres, circular cylinders and cones, tori and meshes; 0 without a bound. That of quadrics, which
/// costs as little, is improved by [`refined_bound`].
pub fn signed_bound(surface: &Surface, point: Vec3) -> f64 {
    match surface {
        Surface::Plane(s) => s.normal.dot(point) - s.offset,
        Surface::Sphere(s) => (point - s.centre).length() - s.radius,
        Surface::Cylinder(s) => across(point - s.point, s.axis).length() - s.radius,
        Surface::Cone(s) => cone(s, point),
        Surface::Quadric(s) => quadric(s, surface, point),
        Surface::Torus(s) => torus(s, point - s.centre),
        Surface::AffineTorus(s) => {
            torus(&s.torus, s.local_from_world * (point - s.centre)) / stretch(&s.local_from_world)
        }
        Surface::Object(s) => object(s, surface, point),
    }
}

/// The part of a vector across a unit vector.
pub fn across(v: Vec3, axis: Vec3) -> Vec3 {
    v - v.dot(axis) * axis
}

/// In the half-plane of the point and the axis both nappes are straight lines from the apex.
fn cone(s: &Cone, point: Vec3) -> f64 {
    let q = point - s.apex;
    let (h, rho) = (q.dot(s.axis).abs(), across(q, s.axis).length());
    (rho - s.slope * h) / (1.0 + s.slope * s.slope).sqrt()
}

fn torus(s: &Torus, q: Vec3) -> f64 {
    let (z, rho) = (q.dot(s.axis), across(q, s.axis).length());
    ((rho - s.major) * (rho - s.major) + z * z).sqrt() - s.minor
}

/// By Taylor's formula |f(p + v)| >= |f| - |g| |v| - w |v|^2, with the gradient g and the largest weight w: there is no root
/// nearer than the positive root of the right side.
fn quadric(s: &Quadric, surface: &Surface, point: Vec3) -> f64 {
    let (value, gradient) = surface.value_and_gradient(point);
    let (slope, weight) = (gradient.length(), s.weights.abs().max_element());
    let root = slope + (slope * slope + 4.0 * weight * value.abs()).sqrt();
    if root > 0.0 { 2.0 * value / root } else { 0.0 }
}

/// The distance from a quadric, up to rounding, where [`signed_bound`] is smaller.
pub fn refined_bound(surface: &Surface, point: Vec3, bound: f64) -> f64 {
    let Surface::Quadric(s) = surface else { return bound };
    match quadric_foot(s, point) {
        Some((_, distance)) => distance.max(bound.abs()).copysign(bound),
        None => bound,
    }
}

/// f of a mesh is the distance in its own frame.
fn object(s: &Object, surface: &Surface, point: Vec3) -> f64 {
    let form: &dyn Any = &*s.form;
    let (value, _) = surface.value_and_gradient(point);
    match form.is::<MeshForm>() {
        true => value / stretch(&s.local_from_world),
        // no bound, but the sign
        false => 0.0f64.copysign(value),
    }
}

/// The largest factor by which a map lengthens a vector, slightly enlarged for rounding.
fn stretch(linear: &Mat3) -> f64 {
    let gram = linear.transpose() * *linear;
    let largest = symmetric_eigen(&gram).values.max_element();
    largest.max(0.0).sqrt() * (1.0 + 64.0 * UNIT_ROUNDOFF)
}

/// The distance of a point from the curve in which two surfaces meet, up to rounding, where it has a closed form: two planes, and
/// circles about a common axis. Infinite if the surfaces do not meet.
pub fn curve_distance(a: &Surface, b: &Surface, point: Vec3) -> Option<f64> {
    if let (Surface::Plane(a), Surface::Plane(b)) = (a, b) {
        return line_distance(a, b, point);
    }
    let (centre, axis, circles) = circles(a, b)?;
    circles_distance(centre, axis, point, circles)
}

/// Circles about a common axis: a centre and the unit axis, and for each circle its height above the centre and its radius, which
/// is NaN for none.
pub type Circles = (Vec3, Vec3, [(f64, f64); 2]);

/// The one or two circles in which two surfaces meet: a plane or a sphere and a surface of revolution about a common axis.
pub fn circles(a: &Surface, b: &Surface) -> Option<Circles> {
    match (a, b) {
        (Surface::Plane(_), Surface::Plane(_)) => None,
        (Surface::Plane(plane), round) | (round, Surface::Plane(plane)) => {
            let (centre, axis) = revolved(round, plane.normal)?;
            let height = plane.offset - plane.normal.dot(centre);
            Some((centre, axis, radii_at(round, height)?.map(|radius| (height, radius))))
        }
        (Surface::Sphere(ball), Surface::Cylinder(tube))
        | (Surface::Cylinder(tube), Surface::Sphere(ball)) => {
            let offset = across(ball.centre - tube.point, tube.axis).length();
            let tolerance = 16.0 * UNIT_ROUNDOFF * (ball.centre.length() + tube.point.length() + tube.radius);
            let height = root_of_difference(ball.radius, tube.radius);
            // NaN, for no circle, is its radius, too
            let radius = tube.radius + 0.0 * height;
            (offset <= tolerance).then_some((ball.centre, tube.axis, [(height, radius), (-height, radius)]))
        }
        (Surface::Sphere(a), Surface::Sphere(b)) => {
            let between = (b.centre - a.centre).length();
            let axis = (b.centre - a.centre) / between;
            let squares = (a.radius - b.radius) * (a.radius + b.radius);
            let height = 0.5 * (between + squares / between);
            let circle = (height, root_of_difference(a.radius, height.abs()));
            // nearly concentric spheres: the height is not accurate
            (between > 1e-3 * (a.radius + b.radius)).then_some((a.centre, axis, [circle, circle]))
        }
        _ => None,
    }
}

/// `sqrt(a^2 - b^2)`; NaN if b is larger.
fn root_of_difference(a: f64, b: f64) -> f64 {
    ((a - b) * (a + b)).sqrt()
}

/// A centre and the unit axis of a surface of revolution about an axis along a unit vector.
fn revolved(surface: &Surface, along: Vec3) -> Option<(Vec3, Vec3)> {
    let (centre, axis) = match surface {
        Surface::Sphere(s) => return Some((s.centre, along)),
        Surface::Cylinder(s) => (s.point, s.axis),
        Surface::Cone(s) => (s.apex, s.axis),
        Surface::Torus(s) => (s.centre, s.axis),
        _ => return None,
    };
    (across(axis, along).length() <= 8.0 * UNIT_ROUNDOFF).then_some((centre, along))
}

/// The radii of the two circles, which may be equal, of a surface of revolution at a height above its centre; NaN for none.
fn radii_at(surface: &Surface, height: f64) -> Option<[f64; 2]> {
    match surface {
        Surface::Sphere(s) => Some([root_of_difference(s.radius, height.abs()); 2]),
        Surface::Cylinder(s) => Some([s.radius; 2]),
        Surface::Cone(s) => Some([s.slope * height.abs(); 2]),
        Surface::Torus(s) => {
            let half = root_of_difference(s.minor, height.abs());
            Some([s.major - half, s.major + half].map(f64::abs))
        }
        _ => None,
    }
}

/// The distance from circles about an axis, each given by its height above `centre` and its radius; NaN radii are no circles.
fn circles_distance(centre: Vec3, axis: Vec3, point: Vec3, circles: [(f64, f64); 2]) -> Option<f64> {
    let q = point - centre;
    let (z, rho) = (q.dot(axis), across(q, axis).length());
    let distance = |(height, radius): (f64, f64)| {
        let (up, out) = (z - height, rho - radius);
        (up * up + out * out).sqrt()
    };
    // `f64::min` ignores NaN
    Some(circles.into_iter().map(distance).fold(f64::INFINITY, f64::min))
}

/// The distance from the line in which two planes meet, if their angle is not small.
fn line_distance(a: &Plane, b: &Plane, point: Vec3) -> Option<f64> {
    let cosine = a.normal.dot(b.normal);
    let sine_square = 1.0 - cosine * cosine;
    if sine_square < 1e-3 {
        return None;
    }
    let (da, db) = (a.normal.dot(point) - a.offset, b.normal.dot(point) - b.offset);
    // p - q = x na + y nb with the plane distances da and db
    let (x, y) = ((da - cosine * db) / sine_square, (db - cosine * da) / sine_square);
    Some((x * a.normal + y * b.normal).length())
}
