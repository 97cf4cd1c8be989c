//! Sections, projections, bounding boxes, and hulls of differences: against closed forms and against OpenSCAD.

use crate::folder::Folder;
use crate::measure::{check_volume, losses, read, volume};
use rayweave_formats::LossKind;
use rayweave_model::Program;
use std::f64::consts::PI;

const NEAR: f64 = 2e-3;

fn moved(x: f64, y: f64, z: f64) -> String {
    format!("multmatrix([[1, 0, 0, {x}], [0, 1, 0, {y}], [0, 0, 1, {z}], [0, 0, 0, 1]])")
}

/// Volume of a projection extruded to height 1, and the approximations.
fn projected(cut: bool, text: &str, facets: bool) -> f64 {
    let text = format!("linear_extrude(height = 1) projection(cut = {cut}) {{ {text} }}");
    let imported = read(&text, facets);
    assert_eq!(imported.report.count(LossKind::Refused), 0, "{text}\n{}", imported.report.warnings());
    volume(&imported.scene, 150)
}

fn check(cut: bool, text: &str, facets: bool, expected: f64) {
    let found = projected(cut, text, facets);
    assert!((found - expected).abs() < 4.0 * NEAR * expected, "{text}: {found} instead of {expected}");
}

/// Equal differences are combined once: each has its own place, also mirrored, and differs from others by any number.
#[test]
fn projections_of_equal_differences() {
    let l_shape = |size: u32| {
        format!("difference() {{ cube([4, 3, 2]); {} cube([9, 9, 9]); }}", moved(f64::from(size), 1.0, -1.0))
    };
    let mirrored = "multmatrix([[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])";
    let upright = "multmatrix([[1, 0, 0, 20], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])";
    let all = [
        format!("{} {}", moved(10.0, 0.0, 0.0), l_shape(2)),
        format!("{mirrored} {}", l_shape(2)),
        format!("{upright} {}", l_shape(2)),
        format!("{} {}", moved(30.0, 0.0, 0.0), l_shape(3)),
    ];
    // 4 x 3 without 2 x 2, twice; from the side 4 x 2; 4 x 3 without 1 x 2
    check(false, &all.join(" "), false, 8.0 + 8.0 + 8.0 + 10.0);
    let apart: Vec<String> =
        all.iter().map(|text| format!("linear_extrude(height = 1) projection() {text}")).collect();
    let found = volume(&read(&apart.join(" "), false).scene, 150);
    assert!((found - 34.0).abs() < 4.0 * NEAR * 34.0, "{found}");
}

#[test]
fn sections() {
    let drilled =
        "difference() { cube(10, center = true); cylinder(h = 20, r1 = 3, r2 = 3, center = true); }";
    check(true, drilled, false, 100.0 - 9.0 * PI);
    check(true, &format!("{} sphere(r = 5);", moved(1.0, 2.0, 3.0)), false, 16.0 * PI);
    // a face in the plane counts, from either side
    check(true, "cube([2, 3, 4]);", false, 6.0);
    check(true, &format!("{} cube([2, 3, 4]);", moved(0.0, 0.0, -4.0)), false, 6.0);
    // an annulus from a torus, and a prism on its side
    check(true, &format!("rotate_extrude() {} circle(r = 1);", moved(4.0, 0.0, 0.0)), false, 16.0 * PI);
    let lying = "multmatrix([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]) linear_extrude(height = 6, center = true) square([4, 2], center = true);";
    check(true, lying, false, 24.0);
    check(
        true,
        "intersection() { cube(4, center = true); multmatrix([[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 0], [0, 0, 0, 1]]) cube(4, center = true); }",
        false,
        9.0,
    );
    check(
        true,
        &format!("hull() {{ cube(2, center = true); {} cube(2, center = true); }}", moved(3.0, 0.0, 0.0)),
        false,
        10.0,
    );
    check(true, "minkowski() { cube(2, center = true); cube(1, center = true); }", false, 9.0);
    check(true, "resize(newsize = [4, 0, 0]) cube(2, center = true);", false, 8.0);
    let (refused, messages) = losses("linear_extrude(height = 1) projection() square(1);", LossKind::Refused);
    assert!(refused == 1 && messages.contains("not solids"), "{messages}");
    assert_eq!(read("linear_extrude(height = 1) projection(cut = true) multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 9], [0, 0, 0, 1]]) cube(1);", false).scene.regions.len(), 0);
}

#[test]
fn shadows() {
    check(false, &format!("{} sphere(r = 5);", moved(1.0, 2.0, 3.0)), false, 25.0 * PI);
    // a cube on its edge
    let edge = "multmatrix([[0.70710678, 0, 0.70710678, 0], [0, 1, 0, 0], [-0.70710678, 0, 0.70710678, 0], [0, 0, 0, 1]]) cube(2, center = true);";
    check(false, edge, false, 4.0 * 2f64.sqrt());
    check(false, &format!("cube(2); {} cube([2, 2, 9]);", moved(1.0, 0.0, 5.0)), false, 6.0);
    // projections: a through hole stays open, a blind hole does not
    let plate = "cube([10, 10, 2]);";
    let hole = |z: f64| format!("{} cylinder(h = 4, r1 = 2, r2 = 2);", moved(5.0, 5.0, z));
    check(false, &format!("difference() {{ {plate} {} }}", hole(-1.0)), false, 100.0 - 4.0 * PI);
    check(false, &format!("difference() {{ {plate} {} }}", hole(1.0)), false, 100.0);
}

/// The shadow of a ball with three conical bores, as in example021 of OpenSCAD, which has thousands of facets, against a sum over
/// the points of the plane.
#[test]
fn shadows_of_many_facets() {
    let bore = "cylinder($fn = 0, $fa = 30, $fs = 2, h = 62.5, r1 = 12.5, r2 = 6.25, center = true);";
    let along = |rows: &str| format!("multmatrix([{rows}, [0, 0, 0, 1]]) {bore}");
    let thing = format!(
        "difference() {{ sphere($fn = 0, $fa = 30, $fs = 2, r = 25); {bore} {} {} }}",
        along("[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0]"),
        along("[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0]"),
    );
    // the upper end of the ball above a point is left if it is above all three bores
    let is_dark = |x: f64, y: f64| {
        let top = 625.0 - x * x - y * y;
        let along_y = (9.375 + 0.1 * y).powi(2) - x * x;
        let along_x = (9.375 - 0.1 * x).powi(2) - y * y;
        top > 0.0 && top > along_x.max(along_y) && 9.375 - 0.1 * top.sqrt() < x.hypot(y)
    };
    let at = |k: i32| -25.0 + 0.05 * (f64::from(k) + 0.5);
    let dark = (0..1_000_000).filter(|k| is_dark(at(k / 1000), at(k % 1000))).count();
    check(false, &thing, false, 0.05 * 0.05 * dark as f64);
}

#[test]
fn sizes() {
    check_volume("resize(newsize = [10, 0, 0], auto = [0, 0, 0]) cube([2, 3, 4]);", false, 120.0, NEAR);
    check_volume(
        "resize(newsize = [10, 0, 0], auto = [1, 1, 1]) cube([2, 3, 4]);",
        false,
        24.0 * 125.0,
        NEAR,
    );
    check_volume(
        "resize(newsize = [10, 6, 0], auto = [0, 0, 1]) cube([2, 3, 4]);",
        false,
        10.0 * 6.0 * 20.0,
        NEAR,
    );
    check_volume("resize(newsize = [4, 6, 8]) sphere(r = 7);", false, 4.0 / 3.0 * PI * 24.0, NEAR);
    check_volume(
        "linear_extrude(height = 2) resize(newsize = [10, 0, 0], auto = [0, 0, 0]) circle(r = 1);",
        false,
        10.0 * PI,
        NEAR,
    );
    // a subtraction in the middle leaves the bounding box unchanged
    check_volume(
        "resize(newsize = [5, 5, 5]) difference() { cube(10); multmatrix([[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, -1], [0, 0, 0, 1]]) cube([8, 8, 12]); }",
        false,
        125.0 * 0.36,
        NEAR,
    );
    // a subtraction at the end makes it smaller
    check_volume(
        "resize(newsize = [5, 5, 5]) difference() { cube(10); cube([11, 11, 5]); }",
        false,
        125.0,
        NEAR,
    );
    // the facets of a sphere do not reach its poles, as in OpenSCAD
    let box_of = |text: &str, facets| {
        let scene = read(text, facets).scene;
        Program::compile_regions(&scene.model_regions()).expect("the solids compile").bounds()
    };
    let bounds = box_of("resize(newsize = [0, 0, 9]) sphere(r = 5, $fn = 8);", true);
    assert!(
        (bounds.hi.z - 4.5).abs() < 1e-9 && (bounds.hi.x - 5.0 * (PI / 8.0).cos()).abs() < 1e-9,
        "{bounds:?}"
    );
}

#[test]
fn hulls_of_anything() {
    let folder = Folder::new("hulls");
    folder.write("part.off", "OFF\n4 4 0\n0 0 0\n3 0 0\n0 3 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
    let hull = folder.read("hull() { import(file = \"part.off\"); cube(1); }");
    assert!(hull.report.is_empty(), "{}", hull.report.warnings());
    // the cube lies inside: 4 x + 4 y + 3 z is 11 at its corner and 12 on the face
    assert!((volume(&hull.scene, 200) / 6.0 - 1.0).abs() < NEAR);
    // a cavity does not change the hull
    check_hull(
        "difference() { cube(10); multmatrix([[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, -1], [0, 0, 0, 1]]) cube([8, 8, 12]); }",
        1000.0,
    );
    // two of the four corners of a square are removed
    check_hull(
        "difference() { cube([10, 10, 1]); multmatrix([[1, 0, 0, 5], [0, 1, 0, 5], [0, 0, 1, -1], [0, 0, 0, 1]]) cube([9, 9, 3]); }",
        100.0 - 12.5,
    );
    check_volume(
        "hull() { rotate_extrude($fn = 8) multmatrix([[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) square(2); }",
        true,
        2.0 * 100.0 * (PI / 4.0).sin(),
        NEAR,
    );
}

fn check_hull(text: &str, expected: f64) {
    check_volume(&format!("hull() {{ {text} }}"), false, expected, 2.0 * NEAR);
}

/// An L-shape: a cube of 3 minus one of 2, with its corner at the origin and the given height.
fn angle(height: f64) -> String {
    format!(
        "difference() {{ cube([3, 3, {height}]); {} cube([2, 2, {}]); }}",
        moved(1.0, 1.0, -1.0),
        height + 2.0
    )
}

#[test]
fn sums_of_nonconvex_solids() {
    // both arms grow equally on all sides
    check_volume(
        &format!("minkowski() {{ {} cube(0.5); }}", angle(1.0)),
        false,
        1.5 * (3.5 * 3.5 - 2.0 * 2.0),
        NEAR,
    );
    // the second operand is far from the origin, and the first one is convex
    let far = format!("minkowski() {{ {} cube(0.5); {} }}", moved(20.0, -7.0, 3.0), angle(1.0));
    check_volume(&far, false, 1.5 * (3.5 * 3.5 - 2.0 * 2.0), NEAR);
    // an L-shape plus itself: two bars of 6 by 2 and a square of 4 by 4 in their corner
    let both = format!("minkowski() {{ {} {} }}", angle(1.0), angle(1.0));
    check_volume(&both, false, 2.0 * (24.0 - 4.0 + 4.0), NEAR);
    // a cavity that the other operand does not fill, and one that it fills
    let hollow = "difference() { cube(10, center = true); cube(6, center = true); }";
    let grown = |by: f64| format!("minkowski() {{ {hollow} cube({by}, center = true); }}");
    check_volume(&grown(2.0), false, 12f64.powi(3) - 4f64.powi(3), NEAR);
    check_volume(&grown(7.0), false, 17f64.powi(3), NEAR);
    // the first operand fits inside the second without contact of their facets
    let shell = "difference() { cube(9, center = true); cube(8, center = true); }";
    let small = "difference() { cube(1, center = true); cube([0.5, 0.5, 3], center = true); }";
    check_volume(&format!("minkowski() {{ {shell} {small} }}"), false, 1000.0 - 343.0, NEAR);
    let (approximated, messages) = losses(
        "minkowski() { difference() { cube(9); cylinder(h = 9, r1 = 3, r2 = 3); } cube(1); }",
        LossKind::Approximated,
    );
    assert!(approximated == 1 && messages.contains("chords"), "{messages}");
}
