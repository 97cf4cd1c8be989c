//! Groups and nested transforms: chapter 14.

use crate::ask::*;
use rayweave::shapes::{place, sphere};
use rayweave::{Affine, Solid, Vec3};

fn ball(name: &str) -> Solid {
    sphere(1.0).unwrap().named(name)
}

fn turn() -> Affine {
    Affine::rotation(Vec3::Y, 90.0)
}

#[test]
fn groups() {
    let along_z = |origin| ray(origin, [0.0, 0.0, 1.0]);
    assert_misses(&Solid::union([]), along_z([0.0; 3]));
    let group = Solid::union([
        ball("s1"),
        ball("s2").translate([0.0, 0.0, -3.0]),
        ball("s3").translate([5.0, 0.0, 0.0]),
    ]);
    let found = hits(&group, along_z([0.0, 0.0, -5.0]));
    let names: Vec<&str> = found.iter().map(|hit| hit.1.as_str()).collect();
    assert_eq!(names, ["s2.side", "s2.side", "s1.side", "s1.side"]);
    let scaled = ball("s").translate([5.0, 0.0, 0.0]).scale(Vec3::splat(2.0));
    assert_eq!(times(&scaled, along_z([10.0, 0.0, -10.0])).len(), 2);
}

/// The composed map of a sphere in nested groups, innermost first.
fn composed(inner_scale: [f64; 3]) -> Affine {
    let moved = Affine::translate(Vec3::new(5.0, 0.0, 0.0));
    moved.then(&Affine::scale(inner_scale.into())).then(&turn())
}

#[test]
fn a_point_of_the_world_as_a_nested_object_sees_it() {
    let map = composed([2.0; 3]);
    let local = map.inverse().unwrap().point(Vec3::new(-2.0, 0.0, -10.0));
    assert_near(local, [0.0, 0.0, -1.0], 1e-15);
    // the same point of the world is on the boundary: it is (0, 0, -1) of a unit sphere
    let nested = ball("s").translate([5.0, 0.0, 0.0]).scale(Vec3::splat(2.0)).apply(turn());
    let through = ray([-2.0, 0.0, -10.0], [1.0, 0.0, 0.0]);
    let found = times(&nested, through);
    assert!(found.iter().any(|t| t.abs() < 1e-14), "{found:?}");
}

/// The point of the sphere on the diagonal between its axes, and its normal in the world.
const POINT: [f64; 3] = [1.7321, 1.1547, -5.5774];
const NORMAL: [f64; 3] = [0.2857, 0.4286, -0.8571];

#[test]
fn the_normal_of_a_nested_object() {
    let group = ball("s").translate([5.0, 0.0, 0.0]).scale([1.0, 2.0, 3.0]).apply(turn());
    // the book gives four digits of the point and of the normal
    assert_near(normal(&group, POINT, NORMAL), NORMAL, 1e-4);
    // in local coordinates the normal is (1, 1, 1) / sqrt 3, and so is the point
    let local = composed([1.0, 2.0, 3.0]).inverse().unwrap().point(POINT.into());
    assert_near(local, [3f64.sqrt() / 3.0; 3], 1e-4);
    // exact: normals transform by the inverse transpose, here (1, 1/2, 1/3), then rotated
    let point = composed([1.0, 2.0, 3.0]).point(Vec3::splat(3f64.sqrt() / 3.0)).to_array();
    let exact = Vec3::new(1.0 / 3.0, 0.5, -1.0).normalize();
    assert_near(normal(&group, point, exact.to_array()), exact.to_array(), 1e-14);
    assert_near(exact, NORMAL, 1e-4);
}

#[test]
fn the_same_by_placing() {
    let inner = place(&ball("s"), [Affine::translate(Vec3::new(5.0, 0.0, 0.0))]);
    let group = place(&place(&inner, [Affine::scale(Vec3::new(1.0, 2.0, 3.0))]), [turn()]);
    assert_near(normal(&group, POINT, NORMAL), NORMAL, 1e-4);
}
