//! Plane regions and their extrusions, against closed forms.

use crate::measure::{check_volume, losses, read, volume, whole};
use rayweave_formats::LossKind;
use std::f64::consts::PI;

const NEAR: f64 = 1e-3;

fn moved(x: f64, y: f64, z: f64) -> String {
    format!("multmatrix([[1, 0, 0, {x}], [0, 1, 0, {y}], [0, 0, 1, {z}], [0, 0, 0, 1]])")
}

#[test]
fn prisms() {
    let over = |flat: &str| format!("linear_extrude(height = 5) {{ {flat} }}");
    check_volume(&over("square(size = [2, 3], center = true);"), false, 30.0, NEAR);
    check_volume(&over("circle($fn = 9, r = 2);"), false, 20.0 * PI, NEAR);
    check_volume(&over("circle($fn = 8, r = 2);"), true, 5.0 * 8.0 * 2f64.sqrt(), NEAR);
    // a plate with a hole, with paths of both orientations, and a path inside the hole
    let points = "points = [[0, 0], [6, 0], [6, 6], [0, 6], [1, 1], [5, 1], [5, 5], [1, 5], [2, 2], [2, 3], [3, 3], [3, 2]]";
    let plate =
        format!("polygon({points}, paths = [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11]], convexity = 1);");
    check_volume(&over(&plate), false, 5.0 * (36.0 - 16.0 + 1.0), NEAR);
    // not convex, clockwise
    check_volume(
        &over("polygon(points = [[0, 0], [2, 2], [0, 6], [6, 0]], paths = undef);"),
        false,
        5.0 * 12.0,
        NEAR,
    );
    check_volume(
        &over(&format!("difference() {{ square(4); {} circle(r = 1); }}", moved(4.0, 4.0, 0.0))),
        false,
        80.0 - 1.25 * PI,
        NEAR,
    );
    check_volume(
        &over(&format!("intersection() {{ circle(r = 1); {} circle(r = 1); }}", moved(1.0, 0.0, 9.0))),
        false,
        5.0 * (2.0 * PI / 3.0 - 0.75f64.sqrt()),
        NEAR,
    );
    check_volume(
        "linear_extrude(height = 5, center = true) multmatrix([[2, 1, 0, 7], [0, 3, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) circle(r = 1);",
        false,
        30.0 * PI,
        NEAR,
    );
}

#[test]
fn pyramids() {
    check_volume("linear_extrude(height = 6, scale = 0) square(3, center = true);", false, 18.0, NEAR);
    check_volume(
        &format!(
            "linear_extrude(height = 6, scale = 0.5, center = true) {} circle(r = 2);",
            moved(9.0, 1.0, 0.0)
        ),
        false,
        2.0 * PI * 7.0,
        NEAR,
    );
    // a section at t has the area (1 + t) 4 by (1 - t / 2) 2
    let uneven: f64 = (0..1000)
        .map(|k| (f64::from(k) + 0.5) / 1000.0)
        .map(|t| (1.0 + t) * (1.0 - t / 2.0) * 8.0 / 1000.0)
        .sum();
    check_volume("linear_extrude(height = 3, scale = [2, 0.5]) square([4, 2]);", false, 3.0 * uneven, NEAR);
    check_volume(
        "linear_extrude(height = 6, scale = [0.5, 0.5]) polygon(points = [[0, 0], [2, 2], [0, 6], [6, 0]]);",
        false,
        2.0 * 12.0 * 1.75,
        NEAR,
    );
}

/// Two triangles of area 4 that share the point where the contour crosses itself; a section at t has their area times both
/// scale factors.
#[test]
fn pyramids_over_contours_that_cross_themselves() {
    let bow = "polygon(points = [[-2, -2], [2, 2], [2, -2], [-2, 2]], paths = undef);";
    let cases = [("[0, 1]", 36.0), ("[3, 1]", 144.0), ("[1, 1]", 72.0), ("[0.5, 0.5]", 72.0 * 1.75 / 3.0)];
    for facets in [false, true] {
        // facets are slices, which do not approximate the sides of the solid
        for (scale, expected) in cases.into_iter().skip(if facets { 2 } else { 0 }) {
            check_volume(
                &format!("linear_extrude(height = 9, scale = {scale}) {bow}"),
                facets,
                expected,
                NEAR,
            );
        }
    }
    // a pentagram, filled by the even-odd rule: points of winding number 2 are a hole
    let star = "polygon(points = [[0, 3], [2, -3], [-3, 1], [3, 1], [-2, -3]], paths = undef);";
    let [straight, uneven] = ["[1, 1]", "[3, 1]"].map(|scale| {
        volume(&whole(&format!("linear_extrude(height = 9, scale = {scale}) {star}"), false), 300)
    });
    assert!((uneven / straight - 2.0).abs() < NEAR, "{uneven} {straight}");
}

/// Pappus's theorem: the area times the path length of its centroid.
#[test]
fn solids_of_revolution() {
    // discs on both sides of the axis, with one half subtracted
    let discs = "difference() { group() { multmatrix([[1, 0, 0, -3.5], [0, 1, 0, 1.5], [0, 0, 1, 0], [0, 0, 0, 1]]) circle($fn = 16, r = 1.5); \
                 multmatrix([[1, 0, 0, 3.5], [0, 1, 0, 1.5], [0, 0, 1, 0], [0, 0, 0, 1]]) circle($fn = 16, r = 1.5); } \
                 multmatrix([[1, 0, 0, SIDE], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) square([100, 100], center = true); }";
    for side in ["50", "-50"] {
        let text = format!("rotate_extrude($fn = 16) {}", discs.replace("SIDE", side));
        check_volume(&text, false, 2.0 * PI * PI * 3.5 * 2.25, NEAR);
        // value of OpenSCAD 2021.01
        check_volume(&text, true, 147.6, NEAR);
    }
    let both = discs.replace("SIDE", "200");
    let (refused, messages) = losses(&format!("rotate_extrude() {both}"), LossKind::Refused);
    assert!(refused == 1 && messages.contains("both sides of the axis"), "{messages}");

    let ring = |angle: &str, flat: &str| {
        format!("rotate_extrude({angle}convexity = 2, $fn = 24) {} {flat}", moved(5.0, 1.0, 0.0))
    };
    check_volume(&ring("", "square([2, 3], center = true);"), false, 6.0 * 10.0 * PI, NEAR);
    check_volume(&ring("", "circle(r = 2);"), false, 4.0 * PI * 10.0 * PI, NEAR);
    check_volume(&ring("angle = 90, ", "square([2, 3], center = true);"), false, 15.0 * PI, NEAR);
    check_volume(
        &ring("angle = -270, start = 10, ", "square([2, 3], center = true);"),
        false,
        45.0 * PI,
        NEAR,
    );
    // on the other side of the axis
    let left = format!("rotate_extrude(angle = 90) {} square(1);", moved(-4.0, 0.0, 0.0));
    check_volume(&left, false, 3.5 * PI / 2.0, NEAR);
    // an hourglass of cones with a straight bore: frustums minus a cylinder
    let glass = "rotate_extrude() polygon(points = [[1, -3], [4, -3], [2, 0], [4, 3], [1, 3]]);";
    check_volume(glass, false, 2.0 * PI * (16.0 + 8.0 + 4.0) - 6.0 * PI, NEAR);
    // half a disc makes a ball
    let half = "rotate_extrude() intersection() { circle(r = 3); multmatrix([[1, 0, 0, 0], [0, 1, 0, -5], [0, 0, 1, 0], [0, 0, 0, 1]]) square([9, 10]); }";
    check_volume(half, false, 36.0 * PI, NEAR);
    // 24 sectors
    let polygon = |r: f64| 12.0 * (PI / 12.0).sin() * r * r;
    check_volume(
        &ring("", "square([2, 3], center = true);"),
        true,
        3.0 * (polygon(6.0) - polygon(4.0)),
        NEAR,
    );
    check_volume(
        &ring("angle = 90, ", "square([2, 3], center = true);"),
        true,
        0.75 * (polygon(6.0) - polygon(4.0)),
        NEAR,
    );
    let (refused, messages) = losses("rotate_extrude() square(2, center = true);", LossKind::Refused);
    assert!(refused == 1 && messages.contains("both sides of the axis"), "{messages}");
}

#[test]
fn hulls_of_the_plane_and_offsets() {
    let over = |flat: &str| format!("linear_extrude(height = 2) {{ {flat} }}");
    let pill = format!("hull() {{ circle(r = 1); {} circle(r = 1); }}", moved(4.0, 0.0, 0.0));
    check_volume(&over(&pill), false, 2.0 * (PI + 8.0), NEAR);
    check_volume(
        &over(&format!("hull() {{ square(1); {} square(1); }}", moved(3.0, 3.0, 0.0))),
        false,
        14.0,
        NEAR,
    );
    check_volume(
        &over("offset(r = 1, $fn = 8) square([4, 5], center = true);"),
        false,
        2.0 * (20.0 + 18.0 + PI),
        NEAR,
    );
    check_volume(&over("offset(r = -1) square([4, 5], center = true);"), false, 12.0, NEAR);
    check_volume(&over("offset(delta = 1) square([4, 5], center = true);"), false, 84.0, NEAR);
    check_volume(&over("offset(delta = -1) square([4, 5], center = true);"), false, 12.0, NEAR);
    // an L-shape: its reentrant corner stays sharp, the five convex ones become round
    let angle = "polygon(points = [[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]])";
    let grown = 7.0 + 16.0 * 0.5 + 5.0 * PI * 0.0625 - 0.25;
    check_volume(&over(&format!("offset(r = 0.5) {angle};")), false, 2.0 * grown, NEAR);
    check_volume(&over("minkowski() { square(3); circle(r = 1); }"), false, 2.0 * (9.0 + 12.0 + PI), NEAR);
    check_volume(&over("minkowski() { square(3); square([1, 2]); }"), false, 40.0, NEAR);
    // holes are offset too: a plate with a hole grows outward and inward
    let plate = "difference() { square(10, center = true); square(4, center = true); }";
    check_volume(&over(&format!("offset(delta = 1) {{ {plate} }}")), false, 2.0 * (144.0 - 4.0), NEAR);
    check_volume(&over(&format!("offset(r = 1) {{ {plate} }}")), false, 2.0 * (140.0 + PI - 4.0), NEAR);
    check_volume(&over(&format!("offset(r = -1) {{ {plate} }}")), false, 2.0 * (64.0 - 32.0 - PI), NEAR);
    check_volume(&over(&format!("offset(delta = -1) {{ {plate} }}")), false, 2.0 * (64.0 - 36.0), NEAR);
    check_volume(
        &over(&format!("offset(delta = 0.5) {angle};")),
        false,
        2.0 * (7.0 + 8.0 + 5.0 * 0.25 - 0.25),
        NEAR,
    );
    check_volume(&over("offset(delta = 3) circle(r = 2);"), false, 50.0 * PI, NEAR);
    // Minkowski sum of two frames: the hole of the larger one shrinks
    let frame = "difference() { square(2, center = true); square(1, center = true); }";
    check_volume(&over(&format!("minkowski() {{ {plate} {frame} }}")), false, 2.0 * (144.0 - 4.0), NEAR);
    check_volume(&over(&format!("minkowski() {{ {angle}; {angle}; }}")), false, 2.0 * 37.0, NEAR);
    check_volume(&over(&format!("hull() {{ {plate} }}")), false, 200.0, NEAR);
    // chamfers cut off a triangle of height sqrt(2) - 1 at each corner
    let cut = (2f64.sqrt() - 1.0).powi(2);
    check_volume(
        &over("offset(delta = 1, chamfer = true) square(2);"),
        false,
        2.0 * (16.0 - 4.0 * cut),
        NEAR,
    );
}

#[test]
fn flat_models_are_plates_and_dimensions_do_not_mix() {
    let (approximated, messages) = losses("square([3, 4]);", LossKind::Approximated);
    assert!(approximated == 1 && messages.contains("plate from z = -0.5 to 0.5"), "{messages}");
    assert!((volume(&read("square([3, 4]);", false).scene, 200) - 12.0).abs() < 0.05);
    let (dropped, messages) = losses("cube(1); square(9);", LossKind::Dropped);
    assert!(dropped == 1 && messages.contains("are mixed"), "{messages}");
    let (refused, messages) = losses("linear_extrude(height = 1) cube(1);", LossKind::Refused);
    assert!(refused == 1 && messages.contains("are solids"), "{messages}");
    let (refused, messages) = losses(
        "linear_extrude(height = 1) polygon(points = [[0, 0], [1, 0]], paths = [[0, 1, 7]]);",
        LossKind::Refused,
    );
    assert!(refused == 1 && messages.contains("a path refers to point 7, but there are 2"), "{messages}");
}
