//! Glyph positions of texts.

use super::folder::Folder;
use rayweave_conformance::skipped;
use std::path::Path;

const FONTS: [&str; 2] = ["DejaVuSans.ttf", "DejaVuSerif.ttf"];

/// Bounding boxes of texts of size 10 in the SVG export of OpenSCAD 2021.01: lower x and y, upper x and y. The cases cover
/// kerning, two blanks, ligatures and spacing, joining right-to-left letters, and vertical lines.
const TEXTS: [(&str, &str, [f64; 4]); 8] = [
    ("AVATAR", r#"script = "Latn""#, [0.10849, 0.0, 50.8071, 10.1248]),
    (
        "Hx  Hg",
        r#"script = "Latn", halign = "center", valign = "center""#,
        [-21.4656, -6.42076, 21.7733, 6.59042],
    ),
    (
        "office",
        r#"script = "Latn", halign = "right", valign = "top", spacing = 1.3"#,
        [-47.6108, -10.5046, -3.04282, 0.247345],
    ),
    ("gap", r#"script = "Latn", valign = "bottom", spacing = 0.9"#, [0.766296, -0.0676422, 23.2851, 10.5947]),
    (
        "Ab",
        r#"script = "Latn", direction = "ttb", halign = "center", valign = "center""#,
        [-9.06503, -12.0332, 0.211761, 11.9659],
    ),
    (
        "\u{633}\u{644}\u{627}\u{645}",
        r#"script = "Arab", direction = "rtl""#,
        [0.949387, -3.3364, 26.9744, 10.5516],
    ),
    (
        "\u{5e9}\u{5dc}\u{5d5}\u{5dd}",
        r#"script = "Hebr", direction = "rtl""#,
        [1.26129, 0.0, 29.6475, 10.1248],
    ),
    ("To.", r#"script = "Latn", font = "DejaVu Serif""#, [0.13559, -0.198395, 19.0337, 10.1248]),
];

/// OpenSCAD's hinting rounds outlines to a grid of 1/2170 of the size, on either side of a letter.
const GRID: f64 = 2.0 * 10.0 / 2170.0;

#[test]
fn letters_stand_where_openscad_puts_them() {
    let folder = Path::new("/usr/share/fonts/truetype/dejavu");
    if let Some(missing) = FONTS.iter().find(|font| !folder.join(font).is_file()) {
        skipped(format!(
            "{missing} is not among the fonts of the system. On Debian, install fonts-dejavu-core."
        ));
        return;
    }
    let dumps = Folder::new("texts");
    for (text, rest, expected) in TEXTS {
        let font = if rest.contains("font") { "" } else { r#", font = "DejaVu Sans""# };
        // the hull of the corners has the same bounding box
        let bounds =
            dumps.bounds(&format!(r#"hull() {{ text(text = "{text}", size = 10, {rest}{font}); }}"#));
        let found = [bounds.lo.x, bounds.lo.y, bounds.hi.x, bounds.hi.y];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < GRID, "{text}: {bounds:?} instead of {expected:?}");
        }
    }
}
