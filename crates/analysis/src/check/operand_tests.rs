//! Operands of unbounded effect.

use super::tests::{checked, quick};
use super::*;

fn absorbed(text: &str) -> Vec<String> {
    checked(text, &quick()).of(FindingKind::Absorbed).map(|finding| finding.text.clone()).collect()
}

const OUTER: &str =
    "[[region]]\nsolid = \"outer\"\n[[region]]\nsolid = \"cap\"\n[solid.outer]\nbox = { size = 500 }\n";

/// Caps of all shapes by planes at random heights: the shape limits the half-space, and the half-space the shape.
#[test]
fn caps_are_not_absorbed() {
    let shapes = [
        "ellipsoid = { radii = [97, 97, 72] }",
        "sphere = { radius = 90 }",
        "cylinder = { radius = 80, height = 150 }",
        "cone = { radius1 = 80, radius2 = 60, height = 150 }",
        "torus = { major = 60, minor = 30 }",
        "box = { size = [120, 140, 160] }",
    ];
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    for shape in shapes {
        for number in 0..4 {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            // within 28, the smallest half height
            let offset =
                if number == 0 { 0.0 } else { (state >> 11) as f64 / (1u64 << 53) as f64 * 56.0 - 28.0 };
            for normal in ["[0, 0, -1]", "[0, 0, 1]", "[0.1, -0.2, 1]"] {
                let half = format!(
                    "[solid.e]\n{shape}\n[solid.h]\nhalf_space = {{ normal = {normal}, offset = {offset} }}\n"
                );
                let cap = format!("{OUTER}{half}[solid.cap]\nexpr = \"e & h\"");
                assert_eq!(absorbed(&cap), [""; 0], "{shape} {normal} {offset}");
            }
        }
    }
}

/// Unions and differences with unbounded operands, and operands that are without effect nevertheless.
#[test]
fn unbounded_operands() {
    let solids = "[solid.b]\nbox_from_corners = { lo = [-50, -50, -50], hi = [50, 50, 50] }\n\
        [solid.up]\nhalf_space = { normal = [0, 0, -1], offset = 10 }\n[solid.ball]\nellipsoid = { radii = [20, 20, 30] }\n\
        [solid.low]\nhalf_space = { normal = [0, 0, 1], offset = 60 }\n";
    for (expr, without_effect) in [
        ("b & (up | ball)", &[][..]),
        ("b & (up - ball)", &[]),
        ("b - (up - ball)", &[]),
        ("b & low", &["low takes nothing from the rest of cap, as far as rays show"]),
        ("ball & b", &["b takes nothing from the rest of cap, as far as rays show"]),
    ] {
        let text = format!("{OUTER}{solids}[solid.cap]\nexpr = \"{expr}\"");
        assert_eq!(absorbed(&text), without_effect, "{expr}");
    }
}
