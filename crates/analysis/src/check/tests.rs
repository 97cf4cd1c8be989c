//! Models with planted faults of known size.

use super::*;
use crate::measure::Estimate;
use rayweave_formats::{Format, Options};
use rayweave_math::Vec3;
use rayweave_model::drive::Cancel;
use rayweave_trace::AnyEvaluator;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

pub(super) fn scene(text: &str) -> Scene {
    rayweave_scene::parse(&format!("rayweave = 1\n{text}")).unwrap().1
}

pub(super) fn quick() -> CheckSettings {
    CheckSettings { across: 48, ..CheckSettings::default() }
}

pub(super) fn checked(text: &str, settings: &CheckSettings) -> CheckReport {
    check(&scene(text), None, AnyEvaluator::maker(None), settings, &mut |_| ()).unwrap()
}

/// Boxes by name, lower and upper corner, each a region.
fn boxes(all: &[(&str, [f64; 3], [f64; 3])]) -> String {
    let solid = |(name, lo, hi): &(&str, [f64; 3], [f64; 3])| {
        format!("[solid.{name}]\nbox_from_corners = {{ lo = {lo:?}, hi = {hi:?} }}\n")
    };
    let regions = all.iter().map(|(name, ..)| format!("[[region]]\nsolid = \"{name}\"\n"));
    all.iter().map(solid).chain(regions).collect()
}

/// True if an interval contains a number, up to rounding.
fn is_about(volume: Option<Estimate>, expected: f64) -> bool {
    volume.is_some_and(|volume| (volume.value - expected).abs() <= volume.half_width + 1e-9 * expected)
}

fn kinds(report: &CheckReport) -> Vec<(FindingKind, Vec<&str>)> {
    report.findings.iter().map(|f| (f.kind, f.regions.iter().map(String::as_str).collect())).collect()
}

#[test]
fn overlaps_and_harmless_contacts() {
    let report = checked(
        &boxes(&[
            ("a", [0.0; 3], [2.0; 3]),
            // 0.25 deep into a
            ("b", [1.75, 0.5, 0.5], [3.0, 1.5, 1.5]),
            // inside a, the usual way to place a part inside another
            ("c", [0.5; 3], [1.0; 3]),
            // touching a
            ("d", [0.0, 0.0, 2.0], [2.0, 2.0, 3.0]),
            ("e", [9.0; 3], [10.0; 3]),
        ]),
        &quick(),
    );
    assert_eq!(
        kinds(&report),
        [(FindingKind::Overlap, vec!["a", "b"]), (FindingKind::Touch, vec!["a", "d"])]
    );
    let overlap = &report.findings[0];
    assert!(is_about(overlap.volume, 0.25) && (overlap.size.unwrap() - 0.25).abs() < 1e-12, "{overlap:?}");
    let at = overlap.at.unwrap();
    assert!(at.x > 1.75 && at.x < 2.0 && !overlap.is_proved, "{at}");
    let touch = report.findings[1].area.unwrap();
    assert!((touch - 4.0).abs() < 0.2, "{touch}");
    // e is far from all others, and d from b and c
    assert_eq!((report.scope.parts, report.scope.apart, report.scope.pairs), (5, 8, 2), "{:?}", report.scope);
}

#[test]
fn curved_overlaps_by_formula() {
    let two = "[solid.a]\nsphere = { radius = 1 }\n[solid.b]\nsphere = { radius = 1 }\ntransform = [{ translate = [1.9, 0, 0] }]\n\
        [[region]]\nsolid = \"a\"\n[[region]]\nsolid = \"b\"";
    let report = checked(two, &quick());
    // a lens of two caps of height 0.05
    let lens = 2.0 * PI * 0.05f64.powi(2) * (1.0 - 0.05 / 3.0);
    let overlap = report.of(FindingKind::Overlap).next().unwrap();
    assert!(is_about(overlap.volume, lens), "{overlap:?} {lens}");
    assert!(overlap.size.unwrap() > 0.08 && overlap.size.unwrap() <= 0.1 + 1e-12, "{overlap:?}");
    // touching at a single point
    assert!(checked(&two.replace("1.9", "2"), &quick()).findings.is_empty());
    // faces that agree up to rounding do not overlap
    let third = 1.0 / 3.0;
    let near = boxes(&[("a", [0.0; 3], [0.1 + 0.2, 1.0, 1.0]), ("b", [0.3, 0.0, 0.0], [1.0, 1.0, third])]);
    assert_eq!(kinds(&checked(&near, &quick())), [(FindingKind::Touch, vec!["a", "b"])]);
}

#[test]
fn hidden_and_empty() {
    let covered = boxes(&[("small", [0.5; 3], [1.0; 3]), ("large", [0.0; 3], [2.0; 3])]);
    let empty = "[solid.x]\nexpr = \"small & far\"\n[solid.far]\nsphere = { radius = 1 }\ntransform = [{ translate = [9, 9, 9] }]\n\
        [solid.y]\nexpr = \"p & q\"\n[solid.p]\nsphere = { radius = 1 }\n[solid.q]\nsphere = { radius = 1 }\n\
        transform = [{ translate = [1.3, 1.3, 1.3] }]\n[[region]]\nsolid = \"x\"\n[[region]]\nsolid = \"y\"";
    let report = checked(&format!("{covered}{empty}"), &quick());
    assert_eq!(report.of(FindingKind::Hidden).next().unwrap().regions, ["small", "large"]);
    let empty: Vec<_> = report.of(FindingKind::Empty).map(|f| (f.regions[0].as_str(), f.is_proved)).collect();
    // boxes prove the first; only rays can detect the second
    assert_eq!(empty, [("x", true), ("y", false)]);
    assert!(report.of(FindingKind::Overlap).next().is_none(), "{report:?}");
}

/// A region outside the checked box is not reported as empty; a region that is empty everywhere is.
#[test]
fn regions_outside_the_box_are_not_empty() {
    let three = boxes(&[
        ("a", [0.0; 3], [2.0; 3]),
        ("outside", [5.0; 3], [6.0; 3]),
        ("beside", [0.0, 1.5, 0.0], [2.0, 3.0, 2.0]),
    ]);
    let none = "[solid.x]\nexpr = \"a - a\"\n[[region]]\nsolid = \"x\"";
    let within = |lo: f64, hi: f64| Some(Bounds::new(Vec3::splat(lo), Vec3::splat(hi)));
    let settings = CheckSettings { within: within(-1.0, 1.0), ..quick() };
    let report = checked(&format!("{three}{none}"), &settings);
    let empty: Vec<_> = report.of(FindingKind::Empty).map(|found| found.regions[0].as_str()).collect();
    assert_eq!(empty, ["x"], "{report:?}");
    let far = CheckSettings { within: within(50.0, 51.0), ..quick() };
    let error =
        check(&scene(&three), None, AnyEvaluator::maker(None), &far, &mut |_| ()).unwrap_err().to_string();
    assert!(error.starts_with("no part of the model is within the box"), "{error}");
}

#[test]
fn walls_and_gaps() {
    let plates = boxes(&[
        ("base", [0.0; 3], [10.0, 10.0, 1.0]),
        ("film", [0.0, 0.0, 1.5], [10.0, 10.0, 1.52]),
        ("lid", [0.0, 0.0, 1.53], [10.0, 10.0, 3.0]),
    ]);
    let report = checked(&plates, &CheckSettings { wall: Some(0.05), gap: Some(0.05), ..quick() });
    assert_eq!(kinds(&report), [(FindingKind::Thin, vec!["film"]), (FindingKind::Gap, vec!["film", "lid"])]);
    let sizes: Vec<f64> = report.findings.iter().map(|finding| finding.size.unwrap()).collect();
    assert!((sizes[0] - 0.02).abs() < 1e-12 && (sizes[1] - 0.01).abs() < 1e-12, "{sizes:?}");
    assert!(checked(&plates, &quick()).findings.is_empty());
    // a slot in one region; pieces of slanted rays in it are longer than its width
    let slot = "[solid.block]\nbox = { size = 10 }\n[solid.slot]\nbox = { size = [0.01, 20, 20] }\n\
        [solid.body]\nexpr = \"block - slot\"\ntransform = [{ rotate_y = 40 }]\n[[region]]\nsolid = \"body\"";
    let report = checked(slot, &CheckSettings { wall: Some(0.05), gap: Some(0.05), ..quick() });
    // the gap goes right through
    assert_eq!(kinds(&report), [(FindingKind::Gap, vec!["body"]), (FindingKind::Loose, vec!["body"])]);
    assert!((report.findings[0].size.unwrap() - 0.01).abs() < 1e-9, "{report:?}");
}

#[test]
fn operands_without_effect() {
    let model = "[solid.plate]\nbox = { size = [10, 10, 1] }\n[solid.hole]\ncylinder = { radius = 1, height = 3 }\n\
        [solid.missed]\ncylinder = { radius = 1, height = 3 }\ntransform = [{ translate = [5.8, 5.8, 0] }]\n\
        [solid.far]\nsphere = { radius = 1 }\ntransform = [{ translate = [50, 0, 0] }]\n\
        [solid.inner]\nsphere = { radius = 0.4 }\ntransform = [{ translate = [3, 3, 0] }]\n\
        [solid.part]\nexpr = \"(plate | inner) - (hole | missed | far)\"\n[[region]]\nsolid = \"part\"";
    let report = checked(model, &quick());
    let found: Vec<_> = report.of(FindingKind::Absorbed).map(|f| (f.text.as_str(), f.is_proved)).collect();
    assert_eq!(found.len(), 3, "{found:?}");
    let has = |name: &str, is_proved: bool| {
        found.iter().any(|(text, proved)| text.starts_with(name) && *proved == is_proved)
    };
    assert!(has("missed takes nothing", false) && has("far takes nothing", true), "{found:?}");
    assert!(has("inner adds nothing", false), "{found:?}");
}

/// The faces of a box as half-spaces: each cuts off what lies outside of the model, except for one that is farther away.
#[test]
fn half_spaces_of_an_intersection() {
    let sides = [("a", "[1, 0, 0]"), ("b", "[-1, 0, 0]"), ("c", "[0, 1, 0]"), ("d", "[0, -1, 0]")];
    let side = |(name, normal): &(&str, &str), offset: u32| {
        format!("[solid.{name}]\nhalf_space = {{ normal = {normal}, offset = {offset} }}\n")
    };
    let sides: String = sides.iter().map(|own| side(own, 2)).collect();
    let far = side(&("far", "[1, 1, 0]"), 9);
    let text = format!(
        "{sides}{far}[solid.slab]\nbox_from_corners = {{ lo = [-9, -9, -1], hi = [9, 9, 1] }}\n\
         [solid.rod]\nexpr = \"a & b & c & d & far\"\n[solid.s]\nexpr = \"rod & slab\"\n[[region]]\nsolid = \"s\""
    );
    let report = checked(&text, &quick());
    let absorbed: Vec<&str> = report.of(FindingKind::Absorbed).map(|finding| finding.text.as_str()).collect();
    assert_eq!(absorbed, ["far takes nothing from the rest of s, as far as rays show"]);
}

/// Two rows of a hundred boxes each, and one small box inside another: all are checked, or the number of skipped ones is
/// reported.
#[test]
fn unions_of_many() {
    let names: Vec<String> = (0..100).map(|k| format!("s{k}")).collect();
    let solid = |(k, name): (usize, &String)| {
        format!("[solid.{name}]\nbox = {{ size = 2 }}\ntransform = [{{ translate = [{}, 0, 0] }}]\n", 3 * k)
    };
    let row: String = names.iter().enumerate().map(solid).collect();
    let inner = "[solid.inner]\nbox = { size = 1 }\ntransform = [{ translate = [210, 0, 0] }]\n";
    let half = row.replace("[solid.s", "[solid.h").replace(", 0, 0]", ", 0, 1]");
    let other: Vec<String> = (0..100).map(|k| format!("h{k}")).collect();
    let text = format!(
        "{row}{half}{inner}[solid.row]\nexpr = \"{} | inner\"\n[solid.high]\nexpr = \"{}\"\n\
         [[region]]\nsolid = \"row\"\n[[region]]\nsolid = \"high\"",
        names.join(" | "),
        other.join(" | ")
    );
    let report = checked(&text, &quick());
    let absorbed: Vec<&str> = report.of(FindingKind::Absorbed).map(|finding| finding.text.as_str()).collect();
    assert_eq!(absorbed, ["inner adds nothing to the rest of row, as far as rays show"]);
    assert_eq!((report.scope.operands, report.scope.operands_left_out), (201, 0));
    // each box of the second row is half inside one of the first row
    let overlap = report.of(FindingKind::Overlap).next().unwrap();
    assert!(is_about(overlap.volume, 400.0), "{overlap:?}");
    let few = checked(&text, &CheckSettings { most_pairs: 7, ..quick() }).scope;
    assert_eq!((few.operands, few.operands_left_out, few.left_out), (7, 194, report.scope.pairs - 7));
}

/// Operands that all overlap: without a limit of the work, the check would compile and trace each of them with all others.
#[test]
fn the_work_on_overlapping_operands_is_limited() {
    let names: Vec<String> = (0..1500).map(|k| format!("s{k}")).collect();
    let solid = |(k, name): (usize, &String)| {
        format!(
            "[solid.{name}]\nsphere = {{ radius = 2 }}\ntransform = [{{ translate = [{}, 0, 0] }}]\n",
            1e-3 * k as f64
        )
    };
    let text: String = names.iter().enumerate().map(solid).collect();
    let text = format!("{text}[solid.row]\nexpr = \"{}\"\n[[region]]\nsolid = \"row\"", names.join(" | "));
    let settings = CheckSettings { across: 4, most_pairs: 1500, ..CheckSettings::default() };
    let scope = checked(&text, &settings).scope;
    assert_eq!(scope.operands + scope.operands_left_out, 1500);
    assert!(scope.operands < 100, "{}", scope.operands);
}

/// Regions that all overlap: the pairs that were not examined are counted, and are not reported as contacts.
#[test]
fn pairs_that_were_not_examined_are_counted() {
    let mut text = String::new();
    for k in 0..60 {
        let [x, y, z] = [k % 3, k % 4, k % 5].map(|k| 0.3 * f64::from(k));
        text += &format!("[solid.s{k}]\nsphere = {{ radius = {} }}\n", 10.0 + 1e-3 * f64::from(k));
        text += &format!("transform = [{{ translate = [{x}, {y}, {z}] }}]\n[[region]]\nsolid = \"s{k}\"\n");
    }
    let report = checked(&text, &CheckSettings { across: 8, most_pairs: 10, ..CheckSettings::default() });
    assert_eq!(report.scope.pairs, 10);
    assert!(report.scope.left_out >= 60 * 59 / 2 - 10, "{}", report.scope.left_out);
    assert_eq!(report.of(FindingKind::Touch).count(), 0);
    assert!(report.of(FindingKind::Overlap).count() > 5);
}

const DETECTOR: &str = r#"<?xml version="1.0"?>
<gdml>
 <define><position name="p" x="40" unit="mm"/><position name="q" x="-20" unit="mm"/><position name="r" x="-25" unit="mm"/></define>
 <materials><material name="air"><D value="0.001"/><atom value="14"/></material></materials>
 <solids>
  <box name="hall" x="100" y="100" z="100" lunit="mm"/>
  <box name="crate" x="30" y="30" z="30" lunit="mm"/>
  <box name="cell" x="10" y="10" z="10" lunit="mm"/>
 </solids>
 <structure>
  <volume name="Cell"><materialref ref="air"/><solidref ref="cell"/></volume>
  <volume name="Crate"><materialref ref="air"/><solidref ref="crate"/>
   <physvol><volumeref ref="Cell"/></physvol></volume>
  <volume name="Hall"><materialref ref="air"/><solidref ref="hall"/>
   <physvol><volumeref ref="Crate"/><positionref ref="p"/></physvol>
   <physvol><volumeref ref="Cell"/><positionref ref="q"/></physvol>
   <physvol><volumeref ref="Cell"/><positionref ref="r"/></physvol>
  </volume>
 </structure>
 <setup name="s" version="1"><world ref="Hall"/></setup>
</gdml>"#;

/// A crate extends 5 mm beyond the hall, and two of the three cells overlap; the cell in the crate is correct.
#[test]
fn daughters_and_copies() {
    let imported = rayweave_formats::parse(DETECTOR, Format::Gdml, &[], &Options::default()).unwrap();
    let hierarchy = Hierarchy::of(&imported.document(), &imported.scene).unwrap();
    let report =
        check(&imported.scene, Some(&hierarchy), AnyEvaluator::maker(None), &quick(), &mut |_| ()).unwrap();
    let [overlap, outside] = &report.findings[..] else { panic!("{report:?}") };
    assert_eq!((overlap.kind, &overlap.regions[..]), (FindingKind::Overlap, &["Cell".to_owned()][..]));
    assert!(is_about(overlap.volume, 500.0) && (overlap.size.unwrap() - 5.0).abs() < 1e-9, "{overlap:?}");
    assert_eq!((outside.kind, outside.regions.join(" ")), (FindingKind::Outside, "Crate Hall".to_owned()));
    assert!(is_about(outside.volume, 4500.0) && (outside.size.unwrap() - 5.0).abs() < 1e-9, "{outside:?}");
    assert!(hierarchy.is_within(2, 0) && !hierarchy.is_within(0, 2));
    // 2.5 mm of the hall between the crate and a cell that was moved next to it are a gap, not a thin wall
    let apart = DETECTOR.replace(r#"x="-25""#, r#"x="17.5""#);
    let imported = rayweave_formats::parse(&apart, Format::Gdml, &[], &Options::default()).unwrap();
    let settings = CheckSettings { wall: Some(3.0), gap: Some(3.0), ..quick() };
    let report =
        check(&imported.scene, Some(&hierarchy), AnyEvaluator::maker(None), &settings, &mut |_| ()).unwrap();
    let gap = report.of(FindingKind::Gap).next().unwrap();
    assert!((gap.size.unwrap() - 2.5).abs() < 1e-9 && gap.regions.contains(&"Crate".to_owned()), "{gap:?}");
    assert!(report.of(FindingKind::Thin).next().is_none(), "{report:?}");
    let imported = rayweave_formats::parse(DETECTOR, Format::Gdml, &[], &Options::default()).unwrap();
    // without the hierarchy, a crate that extends out of a hall is two overlapping boxes
    let report = check(&imported.scene, None, AnyEvaluator::maker(None), &quick(), &mut |_| ()).unwrap();
    assert!(report.of(FindingKind::Overlap).any(|f| f.regions == ["Hall", "Crate"]), "{report:?}");
}

/// The quick search finds the crate that extends 5 mm beyond the hall; not a crate that touches the face of the hall from inside, nor a
/// turned ball, whose box alone extends beyond the hall.
#[test]
fn protruding_daughters() {
    let found = |text: &str| {
        let imported = rayweave_formats::parse(text, Format::Gdml, &[], &Options::default()).unwrap();
        let hierarchy = Hierarchy::of(&imported.document(), &imported.scene).unwrap();
        protruding(&imported.scene, &hierarchy, AnyEvaluator::maker(None), &quick()).unwrap()
    };
    let [crate_outside] = &found(DETECTOR)[..] else { panic!("{:?}", found(DETECTOR)) };
    assert_eq!(crate_outside.text, "Crate extends beyond its mother, Hall");
    assert!((crate_outside.size.unwrap() - 5.0).abs() < 1e-9, "{crate_outside:?}");
    assert_eq!(found(&DETECTOR.replace(r#"x="40""#, r#"x="35""#)), []);
    let ball = DETECTOR.replace(
        r#"<box name="crate" x="30" y="30" z="30" lunit="mm"/>"#,
        r#"<orb name="crate" r="15" lunit="mm"/>"#,
    );
    let turned = ball.replace(
        r#"<positionref ref="p"/>"#,
        r#"<positionref ref="p"/><rotation name="t" z="45" unit="deg"/>"#,
    );
    let at = |x: &str| turned.replace(r#"x="40""#, &format!(r#"x="{x}""#));
    assert_eq!(found(&at("32")), []);
    assert_eq!(found(&at("40")).len(), 1);
}

#[test]
fn pictures_of_findings() {
    let text = boxes(&[("a", [0.0; 3], [2.0; 3]), ("b", [1.75, 0.5, 0.5], [3.0, 1.5, 1.5])]);
    let report = checked(&text, &quick());
    let section = finding_section(&scene(&text), &report.findings[0], AnyEvaluator::maker(None), &quick())
        .unwrap()
        .unwrap();
    let both = section.part("both").unwrap();
    assert!((both.area - 0.25).abs() < section.tolerance * both.perimeter, "{both:?}");
    assert!(section.part("a").is_some() && section.part("b").is_some());
}

#[test]
fn the_same_on_any_number_of_threads_and_refusals() {
    let text = boxes(&[("a", [0.0; 3], [2.0; 3]), ("b", [1.75, 0.5, 0.5], [3.0, 1.5, 1.5])]);
    let on =
        |threads: usize| checked(&text, &CheckSettings { threads: NonZeroUsize::new(threads), ..quick() });
    assert_eq!(on(1), on(3));
    let fails = |text: &str, settings: CheckSettings| {
        check(&scene(text), None, AnyEvaluator::maker(None), &settings, &mut |_| ()).unwrap_err().to_string()
    };
    assert!(fails(&text, CheckSettings { wall: Some(-1.0), ..quick() }).starts_with("the wall is -1"));
    assert!(fails(&text, CheckSettings { gap: Some(f64::NAN), ..quick() }).starts_with("the gap is NaN"));
    assert!(
        fails(&text, CheckSettings { across: 1, ..quick() }).starts_with("the number of cells across is 1")
    );
    let floor = "[solid.f]\nhalf_space = { normal = [0, 0, 1], offset = 0 }\n[[region]]\nsolid = \"f\"";
    assert!(
        fails(floor, quick())
            .contains("Check the part within a box: --within LO HI, in Python within=(lo, hi).")
    );
    let cancel = Cancel::new();
    cancel.cancel();
    assert_eq!(fails(&text, CheckSettings { cancel, ..quick() }), "cancelled");
    // an unbounded floor next to a bounded region is checked around that region
    let report = checked(&format!("{floor}\n{}", boxes(&[("a", [0.0, 0.0, -0.5], [1.0; 3])])), &quick());
    assert!(report.of(FindingKind::Overlap).any(|finding| finding.regions == ["f", "a"]), "{report:?}");
    assert_eq!("thin".parse::<FindingKind>().unwrap(), FindingKind::Thin);
    assert!("thinn".parse::<FindingKind>().unwrap_err().to_string().contains("Did you mean `thin`?"));
}

/// The wall of a tube and the land between a hole and the rim, whatever their directions: no ray of the survey is perpendicular to
/// them.
#[test]
fn thicknesses_of_curved_walls_are_exact() {
    let tube = "[solid.tube]\ntube = { outer_radius = 16, inner_radius = 12.5, height = 30 }";
    let hole = |degrees: f64| {
        format!(
            "[solid.disc]\ncylinder = {{ radius = 50, height = 12 }}\n[solid.hole]\ncylinder = {{ radius = 4.5, height = 20 }}\n\
             transform = [{{ translate = [37.5, 0, 0] }}, {{ rotate_z = {degrees} }}]\n[solid.part]\nexpr = \"disc - hole\"\n\
             [[region]]\nsolid = \"part\""
        )
    };
    let ball = "[solid.ball]\nsphere = { radius = 3 }";
    let pin = "[solid.pin]\ncylinder = { radius = 3, height = 20 }\ntransform = [{ rotate_x = 30 }]";
    let plate =
        "[solid.plate]\nbox = { size = [20, 20, 2] }\ntransform = [{ rotate_x = 44 }, { rotate_z = 20 }]";
    let cases = [
        (ball.to_owned(), 6.0),
        (pin.to_owned(), 6.0),
        (plate.to_owned(), 2.0),
        (tube.to_owned(), 3.5),
        (hole(0.0), 8.0),
        (hole(120.0), 8.0),
        (hole(77.7), 8.0),
    ];
    for (text, thickness) in cases {
        let limited = |wall: f64| CheckSettings { wall: Some(wall), ..quick() };
        let report = checked(&text, &limited(1.3 * thickness));
        let finding = report.of(FindingKind::Thin).next().unwrap();
        let found = finding.size.unwrap();
        assert!(
            (found - thickness).abs() < 1e-6 * thickness && found >= thickness * (1.0 - 1e-12),
            "{finding:?}"
        );
        let [from, to] = finding.ray.map(|ray| [ray.from, ray.to]).unwrap();
        assert!(((to - from).length() - found).abs() < 1e-6 * found, "{finding:?}");
        assert!(checked(&text, &limited(0.999 * thickness)).of(FindingKind::Thin).next().is_none());
    }
}

/// The total is that of the rays through the model and through the box of each region, of each pair and of each operand; the numbers of
/// rays are those of the report.
#[test]
fn progress_has_a_total() {
    let text = boxes(&[("a", [0.0; 3], [2.0; 3]), ("b", [1.75, 0.5, 0.5], [3.0, 1.5, 1.5])])
        + "[solid.c]\nexpr = 'd - e'\n[solid.d]\nbox = { size = 1 }\ntransform = [{ translate = [9, 0, 0] }]\n\
           [solid.e]\nsphere = { radius = 0.2 }\ntransform = [{ translate = [9, 0, 0] }]\n[[region]]\nsolid = \"c\"\n";
    let (scene, mut seen) = (scene(&text), Vec::new());
    let mut progress = |now: CheckProgress| seen.push(now);
    let report = check(&scene, None, AnyEvaluator::maker(None), &quick(), &mut progress).unwrap();
    // one pair with 6 * 10^2 rays, one operand with 6 * 20^2, four boxes with those of the scope
    let cells = [report.scope.cells, report.scope.cells_in_regions].map(|n| 6 * u64::from(n).pow(2));
    let (total, rays) = (600 + 2400 + cells[0] + 3 * cells[1], report.scope.rays);
    assert!(seen.len() > 10 && seen.iter().all(|now| now.total == total && now.done <= total), "{seen:?}");
    assert!(seen.is_sorted_by_key(|now| now.done) && seen.is_sorted_by_key(|now| now.rays), "{seen:?}");
    assert_eq!(seen.last(), Some(&CheckProgress { rays, done: total, total }));

    let mut seen = Vec::new();
    let mut progress = |now: CheckProgress| seen.push((now.done, now.total));
    let (_, all) =
        check_share(&scene, None, AnyEvaluator::maker(None), &quick(), 1..2, &mut progress).unwrap();
    assert_eq!((all, seen.first(), seen.last()), (2, Some(&(0, 1)), Some(&(1, 1))));
}

/// Two balls that overlap are found by the 96 rays of the first look; those with overlapping boxes only take all 600 as well. The depth of a
/// finding is that of all rays.
#[test]
fn overlapping_pairs_take_few_rays() {
    let ball = |name: &str, at: [f64; 3]| {
        format!("[solid.{name}]\nsphere = {{ radius = 5 }}\ntransform = [{{ translate = {at:?} }}]\n")
    };
    let text = ball("a", [0.0; 3])
        + &ball("b", [6.0, 0.0, 0.0])
        + &ball("c", [-6.0, -6.0, -6.0])
        + "[[region]]\nsolid = \"a\"\n[[region]]\nsolid = \"b\"\n[[region]]\nsolid = \"c\"";
    let scene = scene(&text);
    let make = || AnyEvaluator::maker(None);
    let (share, total) = check_share(&scene, None, make(), &quick(), 0..2, &mut |_| ()).unwrap();
    let text = share.to_text();
    let rays: Vec<&str> = text.lines().skip(1).map(|line| line.split(' ').nth(1).unwrap()).collect();
    assert_eq!((rays, total), (vec!["96", "696"], 2), "{text}");
    let report = check(&scene, None, make(), &quick(), &mut |_| ()).unwrap();
    assert_eq!(check_with(&scene, None, make(), &quick(), &share, &mut |_| ()).unwrap(), report);
    let overlap = report.of(FindingKind::Overlap).next().unwrap();
    assert!((overlap.size.unwrap() - 4.0).abs() < 0.2, "{overlap:?}");
}
