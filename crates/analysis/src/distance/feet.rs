//! Critical points of the distance from a point, in closed form: on surfaces of revolution, on quadrics, and on circles.

use super::quadric_foot::quadric_foot;
use super::surfaces::{across, circles};
use rayweave_math::Vec3;
use rayweave_shape::surface::{Cone, Surface, Torus};

/// The points of a surface from which its normal leads to `point`, the nearest one among them; empty where there is no closed
/// form. If they form a circle, those on the side of `near` are returned.
pub fn feet(surface: &Surface, point: Vec3, near: Vec3) -> Vec<Vec3> {
    match surface {
        // the second step removes the rounding of a long way
        Surface::Plane(s) => {
            let foot = point - (s.normal.dot(point) - s.offset) * s.normal;
            vec![foot - (s.normal.dot(foot) - s.offset) * s.normal]
        }
        Surface::Sphere(s) => {
            let out = s.radius * direction(point - s.centre, near - s.centre, Vec3::X);
            vec![s.centre + out, s.centre - out]
        }
        Surface::Cylinder(s) => {
            let (height, out) = about_axis(point - s.point, near - s.point, s.axis);
            let level = s.point + height * s.axis;
            vec![level + s.radius * out, level - s.radius * out]
        }
        Surface::Cone(s) => on_cone(s, point, near),
        Surface::Torus(s) => on_torus(s, point, near),
        Surface::Quadric(s) => quadric_foot(s, point).map_or(Vec::new(), |(feet, _)| feet),
        Surface::AffineTorus(_) | Surface::Object(_) => Vec::new(),
    }
}

/// The nearest and the farthest point of a circle in which two surfaces meet, if it has a closed form.
pub fn feet_on_curve(a: &Surface, b: &Surface, point: Vec3, near: Vec3) -> Vec<Vec3> {
    let Some((centre, axis, circles)) = circles(a, b) else { return Vec::new() };
    let (_, out) = about_axis(point - centre, near - centre, axis);
    let on = |(height, radius): (f64, f64)| {
        let level = centre + height * axis;
        [level + radius * out, level - radius * out]
    };
    circles.into_iter().filter(|(_, radius)| radius.is_finite()).flat_map(on).collect()
}

/// The unit vector along `v`, or along `near` if v is 0, or else `otherwise`.
fn direction(v: Vec3, near: Vec3, otherwise: Vec3) -> Vec3 {
    v.try_normalize().or(near.try_normalize()).unwrap_or(otherwise)
}

/// The height of a point along an axis, and the unit vector away from it.
fn about_axis(q: Vec3, near: Vec3, axis: Vec3) -> (f64, Vec3) {
    let out = direction(across(q, axis), across(near, axis), axis.any_orthonormal_vector());
    // the second step removes the rounding of a long vector
    (q.dot(axis), direction(across(out, axis), out, out))
}

/// The feet on the four lines in which the cone meets the plane of the point and the axis, and the apex.
fn on_cone(s: &Cone, point: Vec3, near: Vec3) -> Vec<Vec3> {
    let q = point - s.apex;
    let (height, out) = about_axis(q, near - s.apex, s.axis);
    let rho = q.dot(out);
    let mut feet = vec![s.apex];
    for slope in [s.slope, -s.slope] {
        let along = (height + slope * rho) / (1.0 + slope * slope);
        feet.push(s.apex + along * (s.axis + slope * out));
    }
    feet
}

/// The feet on the two circles in which the torus meets the plane of the point and the axis.
fn on_torus(s: &Torus, point: Vec3, near: Vec3) -> Vec<Vec3> {
    let q = point - s.centre;
    let (height, out) = about_axis(q, near - s.centre, s.axis);
    let mut feet = Vec::with_capacity(4);
    for side in [out, -out] {
        let middle = s.centre + s.major * side;
        let way = height * s.axis + (q.dot(side) - s.major) * side;
        let towards = s.minor * direction(way, near - middle, s.axis);
        feet.extend([middle + towards, middle - towards]);
    }
    feet
}
