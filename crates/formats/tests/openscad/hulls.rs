//! Convex hulls and Minkowski sums of solids, against Steiner's formula and other closed forms.

use crate::measure::{check_volume, losses};
use rayweave_formats::LossKind;
use std::f64::consts::PI;

const NEAR: f64 = 1e-3;

fn moved(x: f64, y: f64, z: f64) -> String {
    format!("multmatrix([[1, 0, 0, {x}], [0, 1, 0, {y}], [0, 0, 1, {z}], [0, 0, 0, 1]])")
}

/// Volume of the points within distance r of a box.
fn rounded(a: f64, b: f64, c: f64, r: f64) -> f64 {
    a * b * c + 2.0 * r * (a * b + b * c + c * a) + PI * r * r * (a + b + c) + 4.0 / 3.0 * PI * r.powi(3)
}

#[test]
fn rounded_boxes() {
    let corners = (0..8).map(|k: u32| [0, 1, 2].map(|bit| f64::from(k >> bit & 1)));
    let balls: String =
        corners.map(|[x, y, z]| moved(2.0 * x, 3.0 * y, 4.0 * z) + " sphere(r = 0.5);").collect();
    check_volume(&format!("hull() {{ {balls} }}"), false, rounded(2.0, 3.0, 4.0, 0.5), NEAR);
    check_volume(
        "minkowski() { cube([2, 3, 4]); sphere(r = 0.5); }",
        false,
        rounded(2.0, 3.0, 4.0, 0.5),
        NEAR,
    );
    check_volume("minkowski() { cube([2, 3, 4]); cube(1); }", false, 60.0, NEAR);
    check_volume(
        "minkowski() { cube([2, 3, 4]); cylinder(h = 1, r1 = 1, r2 = 1); }",
        false,
        5.0 * (6.0 + 10.0 + PI),
        NEAR,
    );
    // the Minkowski sum distributes over unions
    let two =
        format!("minkowski() {{ union() {{ cube(1); {} cube(1); }} sphere(r = 1); }}", moved(9.0, 0.0, 0.0));
    check_volume(&two, false, 2.0 * rounded(1.0, 1.0, 1.0, 1.0), NEAR);
}

#[test]
fn hulls_of_few_balls() {
    let two = |r: f64| format!("hull() {{ sphere(r = 1); {} sphere(r = {r}); }}", moved(0.0, 0.0, 4.0));
    check_volume(&two(1.0), false, 4.0 / 3.0 * PI + 4.0 * PI, NEAR);
    // a ball and a point: the tangent cone and the rest of the ball
    let (sine, cosine) = (0.25, (1.0f64 - 0.0625).sqrt());
    let cone = PI / 3.0 * cosine * cosine * (4.0 - sine);
    let height = 1.0 + sine;
    let cap = PI * height * height * (3.0 - height) / 3.0;
    check_volume(
        "hull() { sphere(r = 1); polyhedron(points = [[0, 0, 4]], faces = []); }",
        false,
        cone + cap,
        NEAR,
    );
    // three balls: a flat prism with rounded rims, by Steiner's formula for a triangle
    let three = format!(
        "hull() {{ sphere(r = 1); {} sphere(r = 1); {} sphere(r = 1); }}",
        moved(3.0, 0.0, 0.0),
        moved(0.0, 4.0, 0.0)
    );
    check_volume(&three, false, 2.0 * 6.0 + PI / 2.0 * 12.0 + 4.0 / 3.0 * PI, NEAR);
    // one operand inside the other
    check_volume("hull() { sphere(r = 2); cube(1); }", false, 32.0 / 3.0 * PI, NEAR);
}

#[test]
fn hulls_of_points_and_discs() {
    check_volume(
        &format!("hull() {{ cube(1); {} cube(1); }}", moved(2.0, 2.0, 2.0)),
        false,
        1.0 + 3.0 * 2.0,
        NEAR,
    );
    let rods = |x: f64| moved(x, 0.0, 0.0) + " cylinder(h = 3, r1 = 1, r2 = 1);";
    check_volume(&format!("hull() {{ {} {} }}", rods(0.0), rods(4.0)), false, 3.0 * (PI + 8.0), NEAR);
    // coaxial discs: a cylinder and a frustum; discs in between lie inside
    let disc = |z: f64, r: f64| moved(0.0, 0.0, z) + &format!(" cylinder(h = 1, r1 = {r}, r2 = {r});");
    let stack = format!("hull() {{ {} {} {} }}", disc(0.0, 2.0), disc(3.0, 0.5), disc(6.0, 1.0));
    check_volume(&stack, false, PI * (4.0 + 6.0 / 3.0 * (4.0 + 2.0 + 1.0)), NEAR);
    // axis along x, and extruded
    let lying = "multmatrix([[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])";
    check_volume(
        &format!("hull() {{ {lying} {{ {} {} }} }}", rods(0.0), rods(4.0)),
        false,
        3.0 * (PI + 8.0),
        NEAR,
    );
    check_volume(
        &format!(
            "hull() linear_extrude(height = 3) {{ circle(r = 1); {} circle(r = 1); }}",
            moved(4.0, 0.0, 0.0)
        ),
        false,
        3.0 * (PI + 8.0),
        NEAR,
    );
    // discs that are not parallel: the hull of their facets
    let leaning = format!("hull() {{ {} {lying} {} }}", rods(0.0), rods(5.0));
    let (approximated, messages) = losses(&leaning, LossKind::Approximated);
    assert!(approximated == 1 && messages.contains("hull of the facets"), "{messages}");
    let (refused, messages) = losses("hull() { cube(3); spiral(); }", LossKind::Refused);
    assert!(refused == 1 && messages.contains("cannot be read"), "{messages}");
}

#[test]
fn polyhedra() {
    let faces =
        "faces = [[0, 1, 2, 3], [4, 5, 1, 0], [7, 6, 5, 4], [5, 6, 2, 1], [6, 7, 3, 2], [7, 4, 0, 3]]";
    let points =
        "points = [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0], [0, 0, 4], [2, 0, 4], [2, 3, 4], [0, 3, 4]]";
    check_volume(&format!("polyhedron({points}, {faces}, convexity = 1);"), false, 24.0, NEAR);
    let (refused, messages) =
        losses(&format!("polyhedron({points}, faces = [[0, 1, 9]]);"), LossKind::Refused);
    assert!(refused == 1 && messages.contains("point 9 of 8"), "{messages}");
}
