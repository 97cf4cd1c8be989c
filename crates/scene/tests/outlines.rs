//! Extruded and revolved outlines in model files.

use rayweave_model::{Evaluator, Program, Solid};
use rayweave_scene::parse;
use rayweave_trace::Weave;
use std::sync::Arc;

fn solid(body: &str) -> Solid {
    let (_, scene) = parse(&format!("rayweave = 1\n[solid.s]\n{body}")).unwrap();
    scene.regions[0].solid.clone()
}

fn holds(body: &str, points: &[([f64; 3], bool)]) {
    let weave = Weave::new(Arc::new(Program::compile(&solid(body)).unwrap()));
    for (p, expected) in points {
        assert_eq!(weave.contains((*p).into()).unwrap(), *expected, "{body}: {p:?}");
    }
}

/// The problems of a solid, one per line.
fn problems(body: &str) -> String {
    parse(&format!("rayweave = 1\n[solid.s]\n{body}")).unwrap_err().to_string()
}

#[test]
fn extrusions() {
    let plate = "extrude = { outline = [[[0, 0], [8, 0], [8, 4], [0, 4]], { circle = 1, at = [2, 2] }], height = 3, fillet = 1 }";
    holds(
        plate,
        &[
            ([4.0, 2.0, 1.5], true),
            ([4.0, 2.0, -0.1], false),
            ([4.0, 2.0, 3.1], false),
            // within and beyond the fillet, whose centre is (1, 1)
            ([0.3, 0.3, 1.0], true),
            ([0.29, 0.29, 1.0], false),
            ([2.0, 2.99, 1.0], false),
            ([2.0, 3.01, 1.0], true),
        ],
    );
    // the arc through (2, 6) and the corners of the upper edge has the radius 2 about (2, 4)
    let arch =
        "extrude = { outline = [[0, 0], [4, 0], { at = [4, 4], through = [2, 6] }, [0, 4]], z = [-1, 1] }";
    holds(
        arch,
        &[
            ([2.0, 5.99, 0.9], true),
            ([2.0, 6.01, 0.0], false),
            ([3.4, 5.4, 0.0], true),
            ([3.5, 5.5, 0.0], false),
        ],
    );
    let rims = "extrude.outline = [[0, 0], [4, 0], [4, 4], [0, 4]]\nextrude.height = 2\n\
                extrude.top = { chamfer = 0.5 }\nextrude.bottom = { fillet = 0.5 }";
    holds(
        rims,
        &[
            ([0.24, 2.0, 1.74], true),
            ([0.26, 2.0, 1.77], false),
            ([0.2, 2.0, 0.2], true),
            ([0.1, 2.0, 0.1], false),
            ([0.1, 2.0, 1.0], true),
        ],
    );
    // parameters and single corners
    let (_, scene) = parse(
        "rayweave = 1\n[parameters]\na = 3\n[solid.s]\nextrude = { outline = [[0, 0], { at = [\"2*a\", 0], chamfer = \"a\" }, [\"2*a\", \"2*a\"]], height = \"a\" }",
    )
    .unwrap();
    let weave = Weave::new(Arc::new(Program::compile(&scene.regions[0].solid).unwrap()));
    assert!(
        weave.contains([4.4, 1.5, 1.0].into()).unwrap() && !weave.contains([4.6, 1.5, 1.0].into()).unwrap()
    );
}

#[test]
fn revolutions() {
    let ring = "revolve = { outline = { circle = 1, at = [3, 0] } }";
    holds(
        ring,
        &[
            ([3.0, 0.0, 0.99], true),
            ([0.0, -3.99, 0.0], true),
            ([0.0, 0.0, 0.0], false),
            ([0.0, 4.01, 0.0], false),
        ],
    );
    let quarter = "revolve = { outline = [[0, 0], [2, 0], [0, 3]], start = 90, angle = 90 }";
    holds(
        quarter,
        &[
            ([-0.5, 0.5, 1.0], true),
            ([0.5, 0.5, 1.0], false),
            ([-0.5, -0.5, 1.0], false),
            ([-1.0, 1.0, 1.5], false),
        ],
    );
}

/// Documents keep outlines as they are written.
#[test]
fn documents_are_written_again() {
    let text = "rayweave = 1\n[solid.s]\nextrude = { outline = [[0, 0], { at = [1, 0], fillet = 0.25 }, { at = [1, 1], bulge = 0.5 }], height = 2 }\n";
    let (document, scene) = parse(text).unwrap();
    let (again, same) = parse(&document.to_toml()).unwrap();
    assert_eq!(document, again);
    assert_eq!(scene.regions[0].solid.to_string(), same.regions[0].solid.to_string());
}

#[test]
fn problems_have_places() {
    for (body, expected) in [
        ("extrude = { height = 1 }", "there is no `outline`"),
        ("extrude = { outline = [[0, 0], [1, 0], [0, 1]] }", "there is no `height`"),
        ("extrude = { outline = [[0, 0], [1, 0], [0, 1]], height = 0 }", "height must be greater than 0"),
        (
            "extrude = { outline = [[0, 0], [1, 0], [0, 1]], height = 1, z = [0, 1] }",
            "`height` and `z` are both given",
        ),
        ("extrude = { outline = [[0, 0], [1, 0], [0, 1]], heigth = 1 }", "Did you mean `height`?"),
        ("extrude = { outline = [[0, 0], [1, 0]], height = 1 }", "contour 0 has no area"),
        ("extrude = { outline = [[0, 0], [1, 1], [1, 0], [0, 1]], height = 1 }", "crosses or touches itself"),
        ("extrude = { outline = [[0, 0], [1, 0, 2], [0, 1]], height = 1 }", "it must be two numbers"),
        ("extrude = { outline = [[0, 0], \"x\", [0, 1]], height = 1 }", "it must be two numbers"),
        ("extrude = { outline = [[0, 0], [\"inf\", 0], [0, 1]], height = 1 }", "it must be finite"),
        ("extrude = { outline = { circle = 0 }, height = 1 }", "greater than 0"),
        (
            "extrude = { outline = [{ at = [0, 0], fillet = 1, chamfer = 1 }, [1, 0], [0, 1]], height = 1 }",
            "a corner has one form",
        ),
        (
            "extrude = { outline = [{ at = [0, 0], through = [0.5, 0] }, [1, 0], [0, 1]], height = 1 }",
            "no arc leads through",
        ),
        ("extrude = { outline = [[0, 0], [1, 0], [0, 1]], height = 1, top = 3 }", "a table such as"),
        ("extrude = { outline = [[0, 0], [1, 0], [0, 1]], height = 1, top = {} }", "`top` is empty"),
        ("extrude = 7", "a table of its parameters, such as { outline = .. }"),
        ("revolve = { outline = [[-1, 0], [1, 0], [0, 1]] }", "an outline that is revolved lies at x >= 0"),
        ("revolve = { outline = [[0, 0], [1, 0], [0, 1]], angle = 400 }", "at most 360 degrees"),
    ] {
        let found = problems(body);
        assert!(found.contains(expected) && found.contains("3:"), "{body}: {found}");
    }
    // the message is about the point
    let found = problems("extrude = { outline = [[0, 0], { at = [2, 0], fillet = 5 }, [0, 2]], height = 1 }");
    assert!(found.contains("3:32") && found.contains("a fillet or chamfer of 5 takes"), "{found}");
}

/// Drawings in the folder of the model.
/// A fillet or chamfer of 0 is none.
#[test]
fn corners_and_rims_of_size_0_are_sharp() {
    let scene = |body: &str| {
        rayweave_scene::parse(&format!("rayweave = 1\n[solid.s]\n{body}")).map(|(_, scene)| scene)
    };
    let corners = "outline = [[0, 0], [4, 0], [0, 3]], height = 1";
    let sharp = scene(&format!("extrude = {{ {corners} }}")).unwrap();
    for zero in ["fillet = 0", "chamfer = 0", "top = { fillet = 0 }", "bottom = { chamfer = 0 }"] {
        let same = scene(&format!("extrude = {{ {corners}, {zero} }}")).unwrap();
        assert_eq!(format!("{:?}", same.solids), format!("{:?}", sharp.solids), "{zero}");
    }
    assert!(scene(&format!("extrude = {{ {corners}, fillet = -1 }}")).is_err());
    assert!(scene(&format!("extrude = {{ {corners}, top = {{ fillet = -1 }} }}")).is_err());
}

#[test]
fn outlines_in_files() {
    let folder = std::env::temp_dir().join(format!("rayweave-outlines-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    write(
        "a.dxf",
        "0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n8\ncut\n10\n1\n20\n0\n40\n0.5\n0\nSPLINE\n8\nnotes\n0\nENDSEC\n0\nEOF\n",
    );
    write("a.svg", r#"<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0h2v1h-2z"/></svg>"#);
    let load = |body: &str| {
        write("m.toml", &format!("rayweave = 1\n[solid.s]\n{body}"));
        rayweave_scene::load(folder.join("m.toml"), &[])
            .map(|(_, scene)| Weave::new(Arc::new(Program::compile(&scene.regions[0].solid).unwrap())))
    };
    let rod = load("extrude = { file = 'a.dxf', layer = 'cut', scale = 2, height = 1 }").unwrap();
    assert!(rod.contains([2.9, 0.0, 0.5].into()).unwrap() && !rod.contains([3.1, 0.0, 0.5].into()).unwrap());
    let ring = load("revolve = { file = 'a.dxf', layer = 'cut' }").unwrap();
    assert!(
        ring.contains([0.0, 1.4, 0.1].into()).unwrap() && !ring.contains([0.0, 0.4, 0.0].into()).unwrap()
    );
    let block = load("extrude = { file = 'a.svg', z = [0, 3], fillet = 0.25 }").unwrap();
    assert!(
        block.contains([1.0, -0.5, 2.0].into()).unwrap()
            && !block.contains([0.01, -0.01, 2.0].into()).unwrap()
    );
    for (body, expected) in [
        (
            "extrude = { file = 'a.dxf', height = 1 }",
            "the outline in `a.dxf` cannot be used: it has an entity SPLINE",
        ),
        ("extrude = { file = 'b.dxf', height = 1 }", "there is no such file"),
        ("extrude = { file = 'a.svg', layer = 'x', height = 1 }", "layers are selected in DXF files only"),
        ("extrude = { file = '../a.svg', height = 1 }", "outside the folder of the model"),
        ("extrude = { file = 'm.toml', height = 1 }", "outlines are read from .dxf and .svg files"),
        ("extrude = { file = 'a.dxf', layer = 'none', height = 1 }", "it has no closed curves"),
        ("extrude = { file = 'a.svg', outline = [], height = 1 }", "both given"),
    ] {
        let found = load(body).err().unwrap().to_string();
        assert!(found.contains(expected), "{body}: {found}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}
