//! The same solids in several formats have the same findings.

use super::tests::scene;
use super::{CheckReport, CheckSettings, FindingKind, Hierarchy, check};
use rayweave_formats::{Format, Options};
use rayweave_trace::AnyEvaluator;

/// Limits that do not depend on the box around the model, which a world volume enlarges.
fn settings() -> CheckSettings {
    CheckSettings {
        wall: Some(1e-2),
        gap: Some(1e-2),
        distance: Some(1e-6),
        across: 48,
        ..CheckSettings::default()
    }
}

/// The faults, with the regions and sizes to six digits. A world volume makes notes about contacts of its own.
fn faults(report: &CheckReport) -> Vec<(FindingKind, Vec<String>, Option<String>)> {
    let faults = report.findings.iter().filter(|finding| !finding.kind.is_note());
    let short = |size: f64| format!("{size:.5e}");
    let mut all: Vec<_> = faults.map(|own| (own.kind, own.regions.clone(), own.size.map(short))).collect();
    all.sort_by(|a, b| a.0.cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
    all
}

fn of_native(text: &str) -> CheckReport {
    check(&scene(text), None, AnyEvaluator::maker(None), &settings(), &mut |_| ()).unwrap()
}

fn of(text: &str, format: Format) -> CheckReport {
    let imported = rayweave_formats::parse(text, format, &[], &Options::default()).unwrap();
    let hierarchy = Hierarchy::of(&imported.document(), &imported.scene);
    check(&imported.scene, hierarchy.as_ref(), AnyEvaluator::maker(None), &settings(), &mut |_| ()).unwrap()
}

/// Two plates overlap by 0.5, a third is 0.002 away, and a tube has a wall of 0.004.
#[test]
fn native_and_gdml_models_have_equal_findings() {
    let native = "[solid.a]\nbox = { size = [10, 20, 20] }\ntransform = [{ translate = [-5, 0, 0] }]\n\
        [solid.b]\nbox = { size = [10, 20, 20] }\ntransform = [{ translate = [4.5, 0, 0] }]\n\
        [solid.c]\nbox = { size = [10, 20, 20] }\ntransform = [{ translate = [14.502, 0, 0] }]\n\
        [solid.o]\ncylinder = { radius = 5, height = 20 }\n[solid.i]\ncylinder = { radius = 4.996, height = 30 }\n\
        [solid.d]\nexpr = \"o - i\"\ntransform = [{ translate = [0, 25, 0] }]\n\
        [[region]]\nsolid = \"a\"\n[[region]]\nsolid = \"b\"\n[[region]]\nsolid = \"c\"\n[[region]]\nsolid = \"d\"\n";
    let volume = |name: &str, solid: &str| {
        format!(r#"<volume name="{name}"><materialref ref="M"/><solidref ref="{solid}"/></volume>"#)
    };
    let placed = |name: &str, x: f64, y: f64| {
        format!(
            r#"<physvol name="p{name}"><volumeref ref="{name}"/><position name="at{name}" x="{x}" y="{y}" z="0" unit="mm"/></physvol>"#
        )
    };
    let gdml = format!(
        r#"<gdml><define/><materials><material name="M" Z="1"><D value="1"/><atom value="1"/></material></materials><solids>
        <box name="w" x="100" y="100" z="100" lunit="mm"/><box name="s" x="10" y="20" z="20" lunit="mm"/>
        <tube name="o" rmax="5" z="20" deltaphi="360" aunit="deg" lunit="mm"/>
        <tube name="i" rmax="4.996" z="30" deltaphi="360" aunit="deg" lunit="mm"/>
        <subtraction name="t"><first ref="o"/><second ref="i"/></subtraction></solids>
        <structure>{}{}{}{}<volume name="W"><materialref ref="M"/><solidref ref="w"/>{}{}{}{}</volume></structure>
        <setup name="Default" version="1.0"><world ref="W"/></setup></gdml>"#,
        volume("a", "s"),
        volume("b", "s"),
        volume("c", "s"),
        volume("d", "t"),
        placed("a", -5.0, 0.0),
        placed("b", 4.5, 0.0),
        placed("c", 14.502, 0.0),
        placed("d", 0.0, 25.0),
    );
    let found = faults(&of_native(native));
    let expected = [
        (FindingKind::Overlap, &["a", "b"][..], 0.5),
        (FindingKind::Thin, &["d"], 0.004),
        (FindingKind::Gap, &["b", "c"], 0.002),
    ];
    for (kind, regions, size) in expected {
        let size = Some(format!("{size:.5e}"));
        assert!(found.iter().any(|own| own.0 == kind && own.1 == regions && own.2 == size), "{found:?}");
    }
    assert_eq!(found.len(), 3, "{found:?}");
    assert_eq!(faults(&of(&gdml, Format::Gdml)), found);
}

/// A plate with holes, one of them beside it, and a ball beside the plate.
#[test]
fn native_and_openscad_models_have_equal_findings() {
    let native = "[solid._plate]\nbox = { size = [20, 20, 4] }\n[solid._hole]\ncylinder = { radius = 3, height = 10 }\n\
        [solid._slot]\nbox = { size = [1, 1, 10] }\ntransform = [{ translate = [5.5, 0, 0] }]\n\
        [solid._far]\nbox = { size = [1, 1, 10] }\ntransform = [{ translate = [50, 0, 0] }]\n\
        [solid._near]\nbox = { size = [1, 1, 10] }\ntransform = [{ translate = [9.495, 0, 0] }]\n\
        [solid._ball]\nsphere = { radius = 5 }\ntransform = [{ translate = [30, 0, 0] }]\n\
        [solid.model]\nexpr = \"(_plate - (_hole | _slot | _far | _near)) | _ball\"\n[[region]]\nsolid = \"model\"\n";
    let at = |x: f64, body: &str| {
        format!("multmatrix([[1, 0, 0, {x}], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) {body};\n")
    };
    let bar = "cube(size = [1, 1, 10], center = true)";
    let openscad = format!(
        "union() {{ difference() {{ cube(size = [20, 20, 4], center = true); cylinder(h = 10, r1 = 3, r2 = 3, center = true);\n{}{}{}}}\n{}}}",
        at(5.5, bar),
        at(50.0, bar),
        at(9.495, bar),
        at(30.0, "sphere(r = 5)"),
    );
    let (native, openscad) = (of_native(native), of(&openscad, Format::OpenScad));
    let found = faults(&native);
    let kinds: Vec<FindingKind> = found.iter().map(|own| own.0).collect();
    assert_eq!(kinds, [FindingKind::Absorbed, FindingKind::Thin], "{found:?}");
    assert_eq!(found[1].2, Some(format!("{:.5e}", 0.005)));
    assert_eq!(faults(&openscad), found);
    let loose =
        |report: &CheckReport| report.of(FindingKind::Loose).map(|own| own.text.clone()).collect::<Vec<_>>();
    assert!(loose(&native).len() == 1 && loose(&native) == loose(&openscad), "{:?}", loose(&openscad));
}
