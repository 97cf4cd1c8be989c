//! Walls and gaps at edges and corners, by closed forms.

use super::tests::{checked, quick};
use super::*;
use std::num::NonZeroUsize;

fn with(wall: f64, gap: f64) -> CheckSettings {
    CheckSettings { wall: Some(wall), gap: Some(gap), ..quick() }
}

fn sizes(report: &CheckReport, kind: FindingKind) -> Vec<f64> {
    report.of(kind).filter_map(|finding| finding.size).collect()
}

fn are(found: &[f64], expected: &[f64]) -> bool {
    found.len() == expected.len()
        && found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= 1e-9 * expected)
}

/// Asserts the walls below a limit, and that none is below the smallest one.
fn assert_walls(text: &str, limit: f64, expected: &[f64]) {
    let found = sizes(&checked(text, &with(limit, 0.0)), FindingKind::Thin);
    assert!(are(&found, expected), "{found:?}, not {expected:?}\n{text}");
    let below = sizes(&checked(text, &with(0.999 * expected[0], 0.0)), FindingKind::Thin);
    assert!(below.is_empty(), "{below:?}\n{text}");
}

fn assert_gaps(text: &str, limit: f64, expected: &[f64]) {
    let report = checked(text, &with(0.0, limit));
    let found = sizes(&report, FindingKind::Gap);
    assert!(are(&found, expected), "{found:?}, not {expected:?}\n{report:?}\n{text}");
    let below = checked(text, &with(0.0, 0.999 * expected[0]));
    assert!(sizes(&below, FindingKind::Gap).is_empty(), "{below:?}\n{text}");
}

/// A bar of thickness 4 with a groove in the form of a V, whose bottom is at a distance `rest` from the lower face.
fn grooved(half_angle: f64, rest: f64, turn: &str) -> String {
    let width = 6.0 * libm::tan(half_angle.to_radians());
    let z = rest - 2.0;
    format!(
        "[solid.bar]\nbox = {{ size = [40, 10, 4] }}\n\
         [solid.groove]\ntransform = [{{ rotate_x = 90 }}, {{ translate = [0, 10, {z:?}] }}]\n\
         [solid.groove.extrude]\noutline = [[0, 0], [{width:?}, 6], [{:?}, 6]]\nheight = 20\n\
         [solid.part]\nexpr = \"bar - groove\"\ntransform = [{turn}]\n[[region]]\nsolid = \"part\"",
        -width
    )
}

#[test]
fn grooves_in_the_form_of_a_v() {
    for half_angle in [15.0, 30.0, 45.0, 70.0] {
        for rest in [0.02, 0.1, 0.7] {
            assert_walls(&grooved(half_angle, rest, ""), 1.0, &[rest]);
        }
    }
    assert_walls(
        &grooved(45.0, 0.1, "{ rotate_x = 31 }, { rotate_y = 17 }, { translate = [90, -4, 3] }"),
        1.0,
        &[0.1],
    );
}

/// The bar of the report: all walls are found, the edge of the groove first.
#[test]
fn a_turned_square_prism_leaves_a_thin_wall() {
    let text = "[solid.b]\nbox = { size = [40, 10, 4] }\n[solid.p]\nprism = { sides = 4, radius = 3.9, height = 20 }\n\
        transform = [{ rotate_x = 90 }, { translate = [0, 0, 2] }]\n[solid.part]\nexpr = \"b - p\"\n[[region]]\nsolid = \"part\"";
    let found = sizes(&checked(text, &with(100.0, 0.0)), FindingKind::Thin);
    assert!((found[0] - 0.1).abs() < 1e-9, "{found:?}");
    assert_walls(text, 1.0, &[0.1]);
}

#[test]
fn a_hexagonal_pocket_leaves_a_thin_wall() {
    for (sides, offset) in [(6, 14.0), (6, 14.05), (5, 14.0), (3, 13.0)] {
        let text = format!(
            "[solid.disc]\ncylinder = {{ radius = 20, height = 10 }}\n[solid.pocket]\nprism = {{ sides = {sides}, radius = 5.9, height = 30 }}\n\
             transform = [{{ translate = [{offset}, 0, 0] }}]\n[solid.part]\nexpr = \"disc - pocket\"\ntransform = [{{ rotate_z = 33 }}]\n\
             [[region]]\nsolid = \"part\""
        );
        assert_walls(&text, 0.5 + 14.1 - offset, &[14.1 - offset]);
    }
}

/// The corners of two square pockets that face each other along a diagonal.
#[test]
fn edges_that_face_edges() {
    for apart in [0.05, 0.3] {
        let text = format!(
            "[solid.plate]\nbox = {{ size = [30, 30, 4] }}\n[solid.a]\nbox_from_corners = {{ lo = [-6, -6, -3], hi = [0, 0, 3] }}\n\
             [solid.b]\nbox_from_corners = {{ lo = [{apart}, {apart}, -3], hi = [7, 7, 3] }}\n\
             [solid.part]\nexpr = \"plate - a - b\"\n[[region]]\nsolid = \"part\""
        );
        assert_walls(&text, 1.0, &[apart * std::f64::consts::SQRT_2]);
    }
    // grooves on both sides of a plate, at right angles to each other
    let text = "[solid.plate]\nbox = { size = [30, 30, 4] }\n[solid.a]\nprism = { sides = 4, radius = 1.9, height = 50 }\n\
        transform = [{ rotate_x = 90 }, { translate = [1, 0, 2] }]\n[solid.b]\nprism = { sides = 4, radius = 1.95, height = 50 }\n\
        transform = [{ rotate_y = 90 }, { translate = [0, 3, -2] }]\n\
        [solid.part]\nexpr = \"plate - a - b\"\n[[region]]\nsolid = \"part\"";
    assert_walls(text, 1.0, &[0.15]);
}

#[test]
fn tips_of_cones_over_faces() {
    for (height, tilt) in [(3.9, 0.0), (3.7, 0.0), (3.95, 12.0)] {
        let text = format!(
            "[solid.plate]\nbox_from_corners = {{ lo = [-10, -10, 0], hi = [10, 10, 4] }}\n\
             [solid.pit]\ncone = {{ radius1 = 3, radius2 = 0, height = 5 }}\ntransform = [{{ rotate_x = 180 }}, {{ rotate_y = {tilt} }}, {{ translate = [0.3, 0.2, {z:?}] }}]\n\
             [solid.part]\nexpr = \"plate - pit\"\n[[region]]\nsolid = \"part\"",
            z = 4.0 - height + 2.5 * libm::cos(f64::to_radians(tilt))
        );
        assert_walls(&text, 0.5, &[4.0 - height]);
    }
}

#[test]
fn box_corners_near_spheres_and_rims_near_planes() {
    // a corner of a box at a distance 0.2 from a ball, along the diagonal
    let d = 10.2 / libm::sqrt(3.0);
    let gap = format!(
        "[solid.ball]\nsphere = {{ radius = 10 }}\n[solid.block]\nbox_from_corners = {{ lo = [{d:?}, {d:?}, {d:?}], hi = [12, 13, 14] }}\n\
         [[region]]\nsolid = \"ball\"\n[[region]]\nsolid = \"block\""
    );
    assert_gaps(&gap, 0.5, &[0.2]);
    // a pocket whose corner is at a distance 0.2 from the surface of the ball
    let d = 9.8 / libm::sqrt(3.0);
    let wall = format!(
        "[solid.ball]\nsphere = {{ radius = 10 }}\n[solid.pocket]\nbox_from_corners = {{ lo = [0, 0, 0], hi = [{d:?}, {d:?}, {d:?}] }}\n\
         [solid.part]\nexpr = \"ball - pocket\"\n[[region]]\nsolid = \"part\""
    );
    assert_walls(&wall, 0.5, &[0.2]);
    // the rim of a tilted cylinder over a plate
    for tilt in [10.0, 35.0, 60.0] {
        let (sine, cosine) = libm::sincos(f64::to_radians(tilt));
        let z = 0.15 + 4.0 * cosine + 3.0 * sine;
        let gap = format!(
            "[solid.plate]\nbox_from_corners = {{ lo = [-20, -20, -1], hi = [20, 20, 0] }}\n[solid.pin]\ncylinder = {{ radius = 3, height = 8 }}\n\
             transform = [{{ rotate_y = {tilt} }}, {{ translate = [1, 2, {z:?}] }}]\n[[region]]\nsolid = \"plate\"\n[[region]]\nsolid = \"pin\""
        );
        assert_gaps(&gap, 0.5, &[0.15]);
    }
}

/// Edges that point out of a body are no walls, whatever their angles.
#[test]
fn edges_of_ordinary_bodies_are_no_walls() {
    let bodies = [
        "box = { size = [7, 8, 9] }",
        "prism = { sides = 5, radius = 6, height = 9 }",
        "cone = { radius1 = 5, radius2 = 0, height = 8 }",
        "cylinder = { radius = 5, height = 8 }",
    ];
    for body in bodies {
        let text = format!(
            "[solid.s]\n{body}\ntransform = [{{ rotate_x = 20 }}, {{ rotate_y = 35 }}]\n[[region]]\nsolid = \"s\""
        );
        let report = checked(&text, &with(4.0, 4.0));
        assert!(report.findings.is_empty(), "{body}: {report:?}");
    }
    for angle in [12.0, 20.0, 30.0, 45.0, 80.0] {
        let height = 20.0 * libm::tan(f64::to_radians(angle));
        let text = format!(
            "[solid.s.extrude]\noutline = [[0, 0], [20, 0], [20, {height:?}]]\nheight = 30\n[[region]]\nsolid = \"s\""
        );
        let report = checked(&text, &with(0.5, 0.5));
        assert!(report.findings.is_empty(), "{angle}: {report:?}");
    }
    let steps = "[solid.a]\nbox = { size = [10, 10, 10] }\n[solid.b]\nbox_from_corners = { lo = [0, -9, 0], hi = [9, 9, 9] }\n\
        [solid.s]\nexpr = \"a - b\"\n[[region]]\nsolid = \"s\"";
    let report = checked(steps, &with(4.9, 4.9));
    assert!(report.findings.is_empty(), "{report:?}");
}

/// A plug in a cup is 0.2 from its side and 0.4 from its floor.
#[test]
fn all_gaps_of_two_parts_are_reported() {
    let text = "[solid.outer]\ncylinder = { radius = 20, height = 30 }\n[solid.bore]\ncylinder = { radius = 15, height = 30 }\n\
        transform = [{ translate = [0, 0, 5] }]\n[solid.cup]\nexpr = \"outer - bore\"\n\
        [solid.plug]\ncylinder = { radius = 14.8, height = 20 }\ntransform = [{ translate = [0, 0, 0.4] }]\n\
        [[region]]\nsolid = \"cup\"\n[[region]]\nsolid = \"plug\"";
    assert_gaps(text, 1.0, &[0.2, 0.4]);
}

/// A ring that rests on a plate touches it along a circle: there is no gap.
#[test]
fn tangent_faces_touch() {
    let cases = [
        "torus = { major = 20, minor = 1.31 }\ntransform = [{ translate = [0, 0, 3.31] }]",
        "sphere = { radius = 7.3 }\ntransform = [{ translate = [1, 2, 9.3] }]",
        "cylinder = { radius = 3.7, height = 20 }\ntransform = [{ rotate_y = 90 }, { translate = [1, 2, 5.7] }]",
    ];
    for body in cases {
        let text = format!(
            "[solid.plate]\nbox = {{ size = [60, 60, 4] }}\n[solid.body]\n{body}\n[[region]]\nsolid = \"plate\"\n[[region]]\nsolid = \"body\""
        );
        let report = checked(&text, &with(0.1, 0.1));
        let kinds: Vec<FindingKind> = report.findings.iter().map(|finding| finding.kind).collect();
        assert_eq!(kinds, [FindingKind::Touch], "{body}: {report:?}");
        let at = report.findings[0].at.unwrap();
        assert!((at.z - 2.0).abs() < 1e-6, "{at}");
        // raised by a thousandth there is a gap
        let raised = text.replace("3.31]", "3.311]").replace("9.3]", "9.301]").replace("5.7]", "5.701]");
        let report = checked(&raised, &with(0.0, 0.1));
        let gaps = sizes(&report, FindingKind::Gap);
        assert!(gaps.len() == 1 && (gaps[0] - 0.001).abs() < 1e-12, "{body}: {report:?}");
    }
}

/// The note of a contact has a point of it, not a ray through both parts.
#[test]
fn contacts_have_a_point() {
    let text = "[solid.a]\nbox_from_corners = { lo = [0, 0, 0], hi = [9, 9, 13] }\n[solid.b]\nbox_from_corners = { lo = [2, 2, 13], hi = [5, 5, 20] }\n\
        [[region]]\nsolid = \"a\"\n[[region]]\nsolid = \"b\"";
    let report = checked(text, &with(0.0, 0.0));
    let touch = report.of(FindingKind::Touch).next().unwrap();
    assert!(touch.ray.is_none() && (touch.at.unwrap().z - 13.0).abs() < 1e-12, "{touch:?}");
}

/// The faces of a V-shaped notch meet in an edge: they touch nothing. The edge of a tilted part that rests on a plate, of one region,
/// touches it.
#[test]
fn notches_do_not_touch_themselves() {
    for angle in [5.0, 10.0, 20.0, 24.0] {
        let notch = format!(
            "[solid.block]\nbox = {{ size = [40, 20, 20] }}\n[solid.v]\nwedge = {{ start_degrees = {}, sweep_degrees = {angle} }}\n\
             transform = {{ translate = [0, -5, 0] }}\n[solid.part]\nexpr = \"block - v\"\n[[region]]\nsolid = \"part\"",
            90.0 - angle / 2.0
        );
        for gap in [None, Some(1.0)] {
            let report = checked(&notch, &CheckSettings { gap, ..CheckSettings::default() });
            assert!(report.of(FindingKind::Touch).next().is_none(), "{angle}: {report:?}");
        }
        let resting = format!(
            "[solid.plate]\nbox_from_corners = {{ lo = [-20, -20, -5], hi = [20, 20, 0] }}\n\
             [solid.rod]\nbox_from_corners = {{ lo = [0, -8, 0], hi = [15, 8, 6] }}\ntransform = {{ rotate_y = -{angle} }}\n\
             [solid.part]\nexpr = \"plate | rod\"\n[[region]]\nsolid = \"part\""
        );
        let report = checked(&resting, &CheckSettings { gap: Some(1.0), ..CheckSettings::default() });
        assert!(report.of(FindingKind::Touch).next().is_some(), "{angle}: {report:?}");
    }
}

/// The sides of two teeth meet in an edge: the chords beside it, as short as rounding, are no gaps.
#[test]
fn edges_between_teeth_are_no_gaps() {
    let corner = |k: u32| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 400.0);
        let radius = if k.is_multiple_of(2) { 20.0 } else { 10.0 };
        format!("[{:.6}, {:.6}]", radius * cos, radius * sin)
    };
    let outline = (0..400).map(corner).collect::<Vec<_>>().join(", ");
    let star = format!(
        "[solid.star]\nextrude = {{ outline = [{outline}], height = 1 }}\n[[region]]\nsolid = \"star\""
    );
    let report = checked(&star, &CheckSettings { gap: Some(1e-3), ..CheckSettings::default() });
    let gaps = sizes(&report, FindingKind::Gap);
    assert!(gaps.iter().all(|size| *size > 1e-11), "{gaps:?}");
}

/// Walls and gaps of exactly the limit are not below it, wherever the part lies; a billionth above, they are.
#[test]
fn widths_equal_to_the_limit_are_not_below_it() {
    let places = [
        "",
        "\ntransform = [{ rotate_x = 31 }, { rotate_y = 17 }, { translate = [900, -40, 30] }]",
        "\ntransform = { translate = [0.1, 0.7, 1234.5] }",
    ];
    for place in places {
        let tube =
            format!("[solid.ring]\ntube = {{ outer_radius = 9, inner_radius = 6, height = 20 }}{place}");
        let groove = grooved(30.0, 0.7, "").replace("transform = []", place.trim());
        let gap = format!(
            "[solid.bush]\ntube = {{ outer_radius = 9, inner_radius = 6, height = 20 }}{place}\n\
             [solid.pin]\ncylinder = {{ radius = 5.7, height = 20 }}{place}\n\
             [[region]]\nsolid = \"bush\"\n[[region]]\nsolid = \"pin\""
        );
        for (text, kind, size) in [
            (&tube, FindingKind::Thin, 3.0),
            (&groove, FindingKind::Thin, 0.7),
            (&gap, FindingKind::Gap, 0.3),
        ] {
            let settings = |size: f64| match kind {
                FindingKind::Gap => with(0.0, size),
                _ => with(size, 0.0),
            };
            let found = sizes(&checked(text, &settings(size)), kind);
            assert!(found.is_empty(), "{found:?}\n{text}");
            let above = sizes(&checked(text, &settings(size * (1.0 + 1e-9))), kind);
            assert!(are(&above, &[size]), "{above:?}\n{text}");
        }
    }
}

/// A contact is reported although the box of one part is inside that of the other; a part inside another touches nothing.
#[test]
fn parts_in_the_box_of_another_touch_it() {
    let report = |text: &str| checked(text, &with(0.0, 0.0));
    let pin = "[solid.pin]\ncylinder = { radius = 6, height = 10 }\n\
        [solid.ring]\ntube = { inner_radius = 6, outer_radius = 12, height = 20 }\n\
        [[region]]\nsolid = \"pin\"\n[[region]]\nsolid = \"ring\"";
    let found = report(pin);
    let touch = found.of(FindingKind::Touch).next().unwrap();
    let area = 2.0 * std::f64::consts::PI * 6.0 * 10.0;
    assert!((touch.area.unwrap() - area).abs() < 0.05 * area, "{touch:?}");
    let core = pin.replace(
        "[solid.ring]\ntube = { inner_radius = 6, outer_radius",
        "[solid.ring]\ncylinder = { radius",
    );
    let swapped =
        core.replace("\"pin\"\n[[region]]\nsolid = \"ring\"", "\"ring\"\n[[region]]\nsolid = \"pin\"");
    assert_eq!(report(&swapped).findings, []);
}

#[test]
fn the_same_walls_at_edges_on_any_number_of_threads() {
    let on = |threads: usize| {
        let settings = CheckSettings { threads: NonZeroUsize::new(threads), ..with(1.0, 1.0) };
        checked(&grooved(30.0, 0.1, "{ rotate_x = 31 }"), &settings)
    };
    assert_eq!(on(1), on(4));
}
