//! Loose pieces and cavities, counted by hand.

use super::tests::{checked, quick};
use super::{CheckSettings, FindingKind};

fn texts(model: &str, kind: FindingKind) -> Vec<String> {
    let settings = CheckSettings { across: 64, ..quick() };
    checked(model, &settings).of(kind).map(|finding| finding.text.clone()).collect()
}

fn region(solids: &str, expr: &str) -> String {
    format!("{solids}\n[solid.part]\nexpr = \"{expr}\"\n[[region]]\nsolid = \"part\"")
}

/// A plate cut in two by a slot of 0.02 is two pieces, unless a bridge of 1 joins them.
#[test]
fn a_plate_that_is_cut_through_has_two_pieces() {
    let solids = "[solid.plate]\nbox = { size = [20, 30, 4] }\n[solid.slot]\nbox = { size = [0.02, 40, 9] }\n\
        [solid.bridge]\nbox = { size = [2, 1, 4] }\ntransform = { translate = [0, 7.3, 0] }";
    let found = texts(&region(solids, "plate - slot"), FindingKind::Loose);
    let [text] = &found[..] else { panic!("{found:?}") };
    assert!(
        text.starts_with("part consists of 2 separate pieces; the smallest has a volume of about 12"),
        "{text}"
    );
    assert_eq!(texts(&region(solids, "(plate - slot) | bridge"), FindingKind::Loose), [""; 0]);
}

/// A chip beside the rest, three balls, and regions of one piece each.
#[test]
fn pieces_are_counted_by_region() {
    let balls = "[solid.a]\nsphere = { radius = 2 }\n[solid.b]\nsphere = { radius = 2 }\ntransform = { translate = [5, 0, 0] }\n\
        [solid.c]\nsphere = { radius = 1 }\ntransform = { translate = [0, 5, 0] }";
    let found = texts(&region(balls, "a | b | c"), FindingKind::Loose);
    // 4 pi / 3 = 4.19
    assert!(
        found.len() == 1 && found[0].contains("3 separate pieces; the smallest has a volume of about 4."),
        "{found:?}"
    );
    assert_eq!(texts(balls, FindingKind::Loose), [""; 0]);
}

/// Thin shells, pipes and slanted plates are one piece, although neighbouring chords do not overlap.
#[test]
fn thin_parts_are_one_piece() {
    let shell = "[solid.o]\nsphere = { radius = 10 }\n[solid.i]\nsphere = { radius = 9.98 }";
    assert_eq!(texts(&region(shell, "o - i"), FindingKind::Loose), [""; 0]);
    let plate = "[solid.p]\nbox = { size = [20, 30, 0.05] }\ntransform = [{ rotate_x = 33 }, { rotate_y = 27 }, { rotate_z = 11 }]";
    assert_eq!(texts(&region(plate, "p"), FindingKind::Loose), [""; 0]);
    let pipe = "[solid.p]\ntube = { outer_radius = 5, inner_radius = 4.97, height = 20 }\ntransform = [{ rotate_x = 33 }, { rotate_y = 27 }, { rotate_z = 11 }]";
    assert_eq!(texts(&region(pipe, "p"), FindingKind::Loose), [""; 0]);
    // as thin as 2e-4 of the distance of the rays
    let pipe = "[solid.o]\ncylinder = { radius = 5, height = 20 }\n[solid.i]\ncylinder = { radius = 4.9998, height = 30 }\n\
        [solid.room]\nbox = { size = 100 }";
    let model = format!(
        "{}\ntransform = [{{ translate = [0, 25, 0] }}]\n[[region]]\nsolid = \"room\"\n[[region]]\nsolid = \"part\"",
        region(pipe, "o - i").replace("\n[[region]]\nsolid = \"part\"", "")
    );
    assert_eq!(texts(&model, FindingKind::Loose), [""; 0]);
    let ring = "[solid.p]\ntorus = { major = 5, minor = 0.1 }\ntransform = [{ rotate_x = 33 }, { rotate_y = 27 }, { rotate_z = 11 }]";
    assert_eq!(texts(&region(ring, "p"), FindingKind::Loose), [""; 0]);
}

/// The hole of a nut between a lid and a floor is closed by all three; without the lid it is open.
#[test]
fn cavities_between_regions_name_all_of_them() {
    let solids = "[solid._d]\ncylinder = { radius = 6, height = 5 }\n[solid._h]\ncylinder = { radius = 3 }\n\
        [solid.nut]\nexpr = \"_d - _h\"\n[solid.lid]\ncylinder = { radius = 6, height = 1 }\ntransform = { translate = [0, 0, 3] }\n\
        [solid.floor]\ncylinder = { radius = 6, height = 1 }\ntransform = { translate = [0, 0, -3] }\n";
    let closed = format!(
        "{solids}[[region]]\nsolid = \"lid\"\n[[region]]\nsolid = \"nut\"\n[[region]]\nsolid = \"floor\""
    );
    let report = checked(&closed, &CheckSettings { across: 64, ..quick() });
    let cavity = report.of(FindingKind::Cavity).next().unwrap();
    // 45 pi = 141.4
    assert_eq!(cavity.text, "lid, nut and floor enclose a closed cavity with a volume of about 140");
    assert_eq!(cavity.regions, ["lid", "nut", "floor"]);
    let at = cavity.at.unwrap();
    assert!(libm::hypot(at.x, at.y) < 3.0 && at.z.abs() < 2.5, "{at}");
    let open = closed.replace("[[region]]\nsolid = \"lid\"\n", "");
    assert_eq!(texts(&open, FindingKind::Cavity), [""; 0]);
}

/// A hollow ball has a cavity, a ball with a hole into it has none; neither has a cup.
#[test]
fn closed_cavities_are_found() {
    let solids = "[solid.o]\nsphere = { radius = 10 }\n[solid.i]\nsphere = { radius = 6 }\n[solid.hole]\ncylinder = { radius = 0.5, height = 30 }";
    let found = texts(&region(solids, "o - i"), FindingKind::Cavity);
    // 4 pi 6^3 / 3 = 904.8
    assert_eq!(found, ["part has a closed cavity with a volume of about 900"]);
    assert_eq!(texts(&region(solids, "o - i - hole"), FindingKind::Cavity), [""; 0]);
    let thin = "[solid.o]\nsphere = { radius = 10 }\n[solid.i]\nsphere = { radius = 9.98 }";
    assert_eq!(texts(&region(thin, "o - i"), FindingKind::Cavity).len(), 1);
    let cup = "[solid.o]\nbox = { size = 10 }\n[solid.i]\nbox = { size = [9, 9, 10] }\ntransform = { translate = [0, 0, 1] }";
    assert_eq!(texts(&region(cup, "o - i"), FindingKind::Cavity), [""; 0]);
}
