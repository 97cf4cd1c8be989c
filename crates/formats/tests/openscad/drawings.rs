//! Imported drawings (SVG, DXF), against closed forms and against OpenSCAD.

use crate::folder::Folder;
use crate::measure::volume;
use rayweave_formats::LossKind;
use std::f64::consts::PI;

fn svg(head: &str, body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" {head}>{body}</svg>"
    )
}

const PAGE: &str = "width=\"100mm\" height=\"100mm\" viewBox=\"0 0 100 100\"";

/// Bounding boxes of OpenSCAD 2021.01 for pages with and without sizes, units and view boxes.
#[test]
fn svg_pages() {
    let two = "<rect width=\"10\" height=\"10\"/><rect x=\"190\" y=\"90\" width=\"10\" height=\"10\"/>";
    let pill = "<rect x=\"10\" y=\"30\" width=\"80\" height=\"10\"/>";
    let cases = [
        ("width=\"100mm\" height=\"50mm\" viewBox=\"0 0 200 100\"", two, "", [0.0, 0.0, 100.0, 50.0]),
        ("width=\"100mm\" height=\"100mm\" viewBox=\"0 0 200 100\"", two, "", [0.0, 25.0, 100.0, 75.0]),
        (
            "width=\"100mm\" height=\"100mm\" viewBox=\"0 0 200 100\"",
            two,
            ", center = true",
            [-50.0, -25.0, 50.0, 25.0],
        ),
        // without a view box the unit is a millimetre
        // pixels are those of CSS, 96 in an inch, whatever the resolution
        (
            "width=\"192px\" height=\"96px\" viewBox=\"0 0 200 100\"",
            two,
            ", dpi = 72",
            [0.0, 0.0, 50.8, 25.4],
        ),
        ("width=\"100\" height=\"50\"", pill, ", dpi = 72", [10.0, 17.6389 - 40.0, 90.0, 17.6389 - 30.0]),
        // without a size the unit is a pixel
        ("viewBox=\"10 0 200 100\"", pill, ", dpi = 25.4", [0.0, 60.0, 80.0, 70.0]),
    ];
    let folder = Folder::new("pages");
    for (head, body, arguments, expected) in cases {
        folder.write("a.svg", svg(head, body));
        let text = format!("linear_extrude(height = 1) import(file = \"a.svg\"{arguments});");
        let bounds = folder.bounds(&text);
        let found = [bounds.lo.x, bounds.lo.y, bounds.hi.x, bounds.hi.y];
        let is_near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3);
        assert!(is_near, "{head}: {found:?} instead of {expected:?}");
    }
}

/// A DXF entity as pairs of group codes and values.
fn entity(name: &str, pairs: &[(u16, &str)]) -> String {
    let pairs: String = pairs.iter().map(|(code, value)| format!("{code}\n{value}\n")).collect();
    format!("0\n{name}\n{pairs}")
}

fn line(a: [i32; 2], b: [i32; 2]) -> String {
    format!("0\nLINE\n8\n0\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", a[0], a[1], b[0], b[1])
}

fn square() -> String {
    [line([0, 0], [10, 0]), line([10, 0], [10, 10]), line([0, 10], [10, 10]), line([0, 10], [0, 0])].concat()
}

fn dxf(entities: &str, blocks: &str) -> String {
    format!(
        "0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"
    )
}

/// The syntax of older dumps.
#[test]
fn extrusions_that_name_a_drawing() {
    let folder = Folder::new("older");
    folder.write("a.dxf", dxf(&square(), ""));
    let text = "linear_extrude(file = \"a.dxf\", layer = \"\", origin = [0, 0], height = 3, scale = [1, 1]);";
    assert!((volume(&folder.read(text).scene, 200) / 300.0 - 1.0).abs() < 2e-3);
    let circle = entity("CIRCLE", &[(8, "bar"), (10, "5"), (20, "6"), (40, "4")]);
    folder.write("b.dxf", dxf(&[square(), circle].concat(), ""));
    let bounds = folder.bounds(
        "linear_extrude(height = 1) import(file = \"b.dxf\", layer = \"bar\", origin = [10, 20], scale = 2);",
    );
    // value of OpenSCAD 2021.01
    assert_eq!([bounds.lo.x, bounds.lo.y, bounds.hi.x, bounds.hi.y], [-18.0, -36.0, -2.0, -20.0]);
    let text = "rotate_extrude(file = \"a.dxf\", origin = [-5, 0], scale = 1);";
    // Pappus's theorem
    assert!((volume(&folder.read(text).scene, 200) / (2000.0 * PI) - 1.0).abs() < 2e-3);
}

/// A drawing that cannot be read is refused with its reason, and the rest of the dump is read.
#[test]
fn damaged_drawings() {
    let long = format!(
        "<!DOCTYPE svg [<!ENTITY a \"{}\">]>{}",
        "M0 0 ".repeat(20_000),
        svg(PAGE, &"<path d=\"&a;\"/>".repeat(1000))
    );
    let nested = format!("<svg>{}", "<g>".repeat(100_000));
    let laughs = "<!DOCTYPE svg [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;\"><!ENTITY c \"&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;\"><!ENTITY d \"&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;\"><!ENTITY e \"&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;\"><!ENTITY f \"&e;&e;&e;&e;&e;&e;&e;&e;&e;&e;\"><!ENTITY g \"&f;&f;&f;&f;&f;&f;&f;&f;&f;&f;\">]><svg id=\"&g;\"/>";
    let cycle =
        svg(PAGE, "<g id=\"a\"><use href=\"#b\"/></g><g id=\"b\"><use href=\"#a\"/><use href=\"#a\"/></g>");
    let block = format!(
        "{}{}{}",
        entity("BLOCK", &[(2, "B")]),
        entity("INSERT", &[(2, "B")]).repeat(2),
        entity("ENDBLK", &[])
    );
    let cases = [
        ("svg", "<svg><g>".to_owned(), "it is not SVG"),
        ("svg", "<html/>".to_owned(), "its outermost element is `html`"),
        ("svg", nested, "deep"),
        ("svg", long, "its entities may expand to more than 64 MiB"),
        ("svg", laughs.to_owned(), "it is not SVG"),
        ("svg", cycle, "deep"),
        ("svg", svg(PAGE, "<text>a</text>"), "leaves out `text` in line 1 of its file"),
        ("svg", svg(PAGE, "<path d=\"M0 0 h1e300 v1e300 z\"/>"), "too large"),
        (
            "svg",
            svg(PAGE, "<rect width=\"1\" height=\"1\" transform=\"turn(4)\"/>"),
            "its transform cannot be read",
        ),
        ("dxf", "0\nSECTION\n2".to_owned(), "it ends after the code in line 3"),
        ("dxf", "binary".to_owned(), "line 1 of it is not a DXF group code"),
        ("dxf", "0\nEOF\n".to_owned(), "no sections"),
        ("dxf", dxf(&entity("LINE", &[]), "").replace("0\nEOF\n", ""), "it has no EOF at its end"),
        ("dxf", dxf(&entity("INSERT", &[(2, "B")]), &block), "its blocks use each other"),
        ("dxf", dxf(&entity("HATCH", &[]), ""), "leaves out `HATCH` in line 11 of its file"),
        ("dxf", dxf(&entity("SPLINE", &[(71, "3"), (40, "0")]), ""), "points do not match"),
    ];
    let folder = Folder::new("damaged");
    for (ending, text, message) in cases {
        folder.write(&format!("a.{ending}"), &text);
        let dump = format!("cube(1); linear_extrude(height = 1) import(file = \"a.{ending}\");");
        let imported = folder.read(&dump);
        let messages = imported.report.warnings().to_string();
        assert!(
            imported.report.count(LossKind::Refused) >= 1 && messages.contains(message),
            "{message}: {messages}"
        );
        assert_eq!(imported.scene.regions.len(), 1);
    }
}
