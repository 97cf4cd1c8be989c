//! Primitive solids and transforms, against closed forms.

use crate::measure::{check_volume, losses, read, volume, whole};
use rayweave_formats::LossKind;
use rayweave_scene::Colour;
use std::f64::consts::PI;

/// Relative tolerance of volumes measured with rays.
const NEAR: f64 = 1e-3;

/// Shapes with up to 8 sides by `$fn` are polygons, prisms and pyramids, as in OpenSCAD, without a warning.
#[test]
fn few_sides_are_kept() {
    let square = "square([2, 2], center = true);";
    let moved = |by: &str, item: &str| {
        format!("multmatrix([[1, 0, 0, {by}], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) {item}")
    };
    let nut = "cylinder($fn = 6, h = 10, r1 = 5, r2 = 5);";
    let (hexagon, octagon, triangle) = (1.5 * 3f64.sqrt() * 25.0, 8f64.sqrt(), 0.75 * 3f64.sqrt());
    let bore = "multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -1], [0, 0, 0, 1]]) cylinder($fn = 64, h = 12, r1 = 2, r2 = 2);";
    // hexagons with corners at 11 and 9 from the axis, 2 high
    let ring = 2.0 * 1.5 * 3f64.sqrt() * (121.0 - 81.0);
    for (text, expected) in [
        (nut.to_owned(), 10.0 * hexagon),
        ("cylinder($fn = 4, h = 9, r1 = 5, r2 = 0);".to_owned(), 150.0),
        ("cylinder($fn = 8, h = 2, r1 = 1, r2 = 1);".to_owned(), 2.0 * octagon),
        ("linear_extrude(height = 2) circle($fn = 2, r = 1);".to_owned(), 2.0 * triangle),
        (format!("difference() {{ {nut} {bore} }}"), 10.0 * hexagon - 40.0 * PI),
        (format!("rotate_extrude($fn = 6) {}", moved("10", square)), ring),
        // the hull of two nuts 10 apart along a diagonal: the rectangle between them is 10 long and as wide as a nut across its flats
        (format!("hull() {{ {nut} {} }}", moved("10", nut)), 10.0 * (hexagon + 10.0 * 5.0 * 3f64.sqrt())),
        (
            "linear_extrude(height = 2) projection() cylinder($fn = 6, h = 10, r1 = 5, r2 = 5);".to_owned(),
            2.0 * hexagon,
        ),
    ] {
        check_volume(&text, false, expected, NEAR);
        let (count, messages) = losses(&text, LossKind::Approximated);
        assert_eq!(count, 0, "{text}: {messages}");
    }
    // a round shape stays round
    for round in ["sphere($fn = 0, $fa = 12, $fs = 2, r = 1);", "sphere($fn = 9, r = 1);"] {
        check_volume(round, false, 4.0 * PI / 3.0, NEAR);
    }
}

#[test]
fn primitives_are_round_or_faceted() {
    check_volume("cube(size = [2, 3, 4], center = true);", false, 24.0, NEAR);
    check_volume("cube(size = 2);", false, 8.0, NEAR);
    check_volume("sphere($fn = 0, $fa = 12, $fs = 2, r = 10);", false, 4000.0 * PI / 3.0, NEAR);
    check_volume("cylinder($fn = 9, h = 10, r1 = 5, r2 = 5);", false, 250.0 * PI, NEAR);
    check_volume(
        "cylinder($fn = 0, $fa = 12, $fs = 2, h = 9, r1 = 5, r2 = 0, center = true);",
        false,
        75.0 * PI,
        NEAR,
    );
    // a regular prism and a pyramid over hexagons
    let hexagon = 1.5 * 3f64.sqrt() * 25.0;
    check_volume("cylinder($fn = 6, h = 10, r1 = 5, r2 = 5);", true, 10.0 * hexagon, NEAR);
    check_volume("cylinder($fn = 6, h = 9, r1 = 0, r2 = 5, center = true);", true, 3.0 * hexagon, NEAR);
    // two frustums and a prism of 4 sides: the rings of a ball with $fn = 5 are at 30, 90 and 150 degrees and have 5 sides
    let area = |radius: f64| 2.5 * (0.4 * PI).sin() * radius * radius;
    let (small, height) = (0.5, 3f64.sqrt() / 2.0);
    let frustum = height / 3.0 * (area(1.0) + area(small) + (area(1.0) * area(small)).sqrt());
    check_volume("sphere($fn = 5, r = 1);", true, 2.0 * frustum, NEAR);
}

#[test]
fn booleans_and_maps() {
    check_volume(
        "difference() { cube(4, center = true); cube([2, 2, 9], center = true); }",
        false,
        48.0,
        NEAR,
    );
    check_volume(
        "intersection() { cube(4); multmatrix([[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) cube(4); }",
        false,
        16.0,
        NEAR,
    );
    check_volume(
        "union() { cube(4); multmatrix([[1, 0, 0, 4], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) { cube(4); } }",
        false,
        128.0,
        NEAR,
    );
    // sheared and mirrored: the volume scales with the determinant
    check_volume(
        "multmatrix([[-2, 1, 0, 5], [0, 3, 1, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) sphere(r = 1);",
        false,
        8.0 * PI,
        NEAR,
    );
    check_volume(
        "multmatrix([[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 2]]) cube(3);",
        false,
        27.0,
        NEAR,
    );
}

#[test]
fn empty_where_openscad_is_empty() {
    for text in
        ["", "group();", "cube(0);", "sphere(r = -1);", "cylinder(h = 0, r1 = 1, r2 = 1);", "*cube(1);"]
    {
        assert_eq!(volume(&read(text, false).scene, 10), 0.0, "{text}");
    }
    check_volume("difference() { cube(2); group(); }", false, 8.0, NEAR);
    // a disabled child counts as absent: the next one becomes the first operand
    for off in ["*", "%"] {
        let rest = read(&format!("difference() {{ {off}cube(9); cube(2); cube(1); }}"), false).scene;
        assert!((volume(&rest, 100) / 7.0 - 1.0).abs() < 2e-2, "{off}");
        let common = read(&format!("intersection() {{ {off}cube(1); cube(2); cube(3); }}"), false).scene;
        assert!((volume(&common, 100) / 8.0 - 1.0).abs() < 2e-2, "{off}");
    }
    assert_eq!(volume(&read("intersection() { cube(2); group(); }", false).scene, 10), 0.0);
    assert_eq!(volume(&read("difference() { group(); cube(2); }", false).scene, 10), 0.0);
    let flat = "multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1]]) cube(1); cube(2);";
    let (dropped, messages) = losses(flat, LossKind::Dropped);
    assert!(dropped == 1 && messages.contains("Is a scale 0?"), "{messages}");
}

#[test]
fn modifiers() {
    check_volume(
        "cube(2); *cube(9); #multmatrix([[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) cube(1);",
        false,
        9.0,
        NEAR,
    );
    check_volume("cube(2); group() { difference() { cube(8); !cube(3); } }", false, 27.0, NEAR);
    let (dropped, messages) = losses("cube(2); %cube(9);", LossKind::Dropped);
    assert!(dropped == 1 && messages.contains("previews"), "{messages}");
}

#[test]
fn colours_become_regions_and_the_outer_colour_wins() {
    let text = "color([1, 0, 0, 1]) cube(1); color([0, 0, 1, 0.5]) { cube(2); color([1, 0, 0, 1]) sphere(r = 1); } cube(3); cube(4);";
    let scene = whole(text, false);
    let regions: Vec<(&str, Colour)> = scene.regions.iter().map(|r| (r.name.as_str(), r.colour)).collect();
    let blue = Colour { alpha: 128, ..Colour::new(0, 0, 255) };
    let expected =
        [("colour_ff0000", Colour::new(255, 0, 0)), ("colour_0000ff80", blue), ("model", Colour::PALETTE[2])];
    assert_eq!(regions, expected);
    // each piece is cut and keeps its colour
    let cut = whole(
        "difference() { group() { color([1, 0, 0, 1]) cube(2); color([0, 1, 0, 1]) multmatrix([[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) cube(2); } cube([9, 9, 1]); }",
        false,
    );
    assert_eq!(cut.regions.len(), 2);
    assert!((volume(&cut, 300) - 8.0).abs() < 0.01);
}

#[test]
fn unreadable_items_count_as_absent() {
    let text = "cube(2);\ndifference() {\n cube(3);\n  riddle(x = 1);\n}\nintersection() { riddle(); cube(1); }\nunion() { difference() { riddle(); cube(1); } }";
    let (refused, messages) = losses(text, LossKind::Refused);
    assert!(refused == 3 && messages.contains("<text>:4:3") && messages.contains("3 times"), "{messages}");
    assert!((volume(&read(text, false).scene, 300) - 27.0).abs() < 0.05);
    let (refused, messages) = losses("cube(2); cube(size = \"big\"); sphere(r = [1]);", LossKind::Refused);
    assert!(refused == 2 && messages.contains("size must be a finite number, or 3 of them"), "{messages}");
}

#[test]
fn rounding_in_matrices_is_none() {
    // the first value is that of OpenSCAD's test issue13, the second that of every quarter turn
    check_volume(
        "cube([10, 10, 5]); multmatrix([[1, 0, 0, 5], [0, 1, 0, 5], [0, 0, 1, -3.33067e-16], [0, 0, 0, 1]]) cube([5, 10, 10]);",
        false,
        500.0 + 500.0 - 125.0,
        2e-3,
    );
    check_volume(
        "cube(2); multmatrix([[6.12303e-17, -1, 0, 2], [1, 6.12303e-17, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) cube(2);",
        false,
        8.0,
        2e-3,
    );
}

#[test]
fn a_region_of_the_plane_empties_an_intersection_of_solids() {
    let imported = read("intersection() { cube(5, center = true); circle(r = 2); }", true);
    assert!(imported.scene.regions.is_empty());
    assert!(imported.report.warnings().to_string().contains("are mixed"));
}

/// Arguments that are not read cause warnings with their position, misspelt ones also with a suggestion.
#[test]
fn unknown_arguments_are_warnings() {
    let cases = [
        ("cylinder(hh = 3, r1 = 1, r2 = 1);", "`hh` of cylinder() is ignored", Some("Did you mean `h`?"), 10),
        (
            "cube(size = 2, centre = true);",
            "`centre` of cube() is ignored",
            Some("Did you mean `center`?"),
            16,
        ),
        ("cube(size = 2, rotate = \"3\");", "`rotate` of cube() is ignored", None, 16),
        ("linear_extrude(heigth = 3) square(1);", "`heigth`", Some("Did you mean `height`?"), 16),
        ("cylinder(h = 3, r = 1);", "`r` of cylinder()", Some("Did you mean `r1` and `r2`?"), 17),
        (
            "cylinder(h = 3, d = 1);",
            "`d` of cylinder()",
            Some("Did you mean `r1` and `r2`, half of the diameters?"),
            17,
        ),
        ("sphere(d = 3);", "`d` of sphere()", Some("Did you mean `r`, half of the diameter?"), 8),
        ("sphere(1, 2);", "at most 1 of its arguments may be unnamed", None, 11),
        ("sphere(r = 1, r = 2);", "the second `r` of sphere()", None, 15),
        ("group(size = 2) cube(1);", "`size` of group()", None, 7),
    ];
    for (text, message, suggestion, column) in cases {
        let report = read(text, false).report;
        let losses: Vec<_> = report.iter().collect();
        assert_eq!(losses.len(), 1, "{text}: {}", report.warnings());
        assert_eq!(losses[0].kind, LossKind::Dropped, "{text}");
        let found = losses[0].first.message().to_owned();
        assert!(found.contains(message), "{text}: {found}");
        assert!(suggestion.is_none_or(|meant| found.contains(meant)), "{text}: {found}");
        assert_eq!(suggestion.is_none(), !found.contains("Did you mean"), "{text}: {found}");
        assert_eq!(losses[0].first.line_column(), Some((1, column)), "{text}");
    }
    // a shadowed argument does not matter where the item itself is not part of the model
    assert!(read("cube(1); *sphere(rr = 1);", false).report.is_empty());
}
