//! `rayweave section`.

use crate::bench::{BALL, Bench, CEMENTED};
use std::f64::consts::PI;

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("ball.toml", BALL);
    bench.write("cemented.toml", CEMENTED);
    bench
}

#[test]
fn areas_of_media() {
    let said = bench().says(&["section", "cemented.toml", "--plane", "z=0.5"]);
    let row = |name: &str| -> Vec<String> {
        let line = said.lines().find(|line| line.contains(name)).unwrap();
        line.split_whitespace().map(str::to_owned).collect()
    };
    assert!(said.starts_with("cemented.toml: contours within 0.00"), "{said}");
    assert_eq!(row("crown")[..5], ["z", "=", "0.5", "crown", "4"]);
    assert_eq!(row("flint")[..5], ["z", "=", "0.5", "flint", "6"]);
    let water: f64 = row("water")[4].parse().unwrap();
    assert!((water - (PI * 99.75 - 10.0)).abs() < 0.05, "{said}");
}

#[test]
fn json_has_the_contours() {
    let json = bench().json(&["section", "ball.toml", "--point", "0,0,0.6", "--normal", "0,0,-2", "--json"]);
    let part = &json["sections"][0]["parts"][0];
    let (area, error) = (part["area"].as_f64().unwrap(), part["area_error"].as_f64().unwrap());
    assert!((area - 0.64 * PI).abs() <= error && error < 1e-2, "{part}");
    let contour = part["contours"][0].as_array().unwrap();
    let off = contour.iter().map(|p| (p[0].as_f64().unwrap().hypot(p[1].as_f64().unwrap()) - 0.8).abs());
    assert!(off.fold(0.0, f64::max) < 3e-4);
}

#[test]
fn drawings_of_a_stack() {
    let bench = bench();
    let stack = ["--from", "-0.9", "--to", "0.9", "--count", "7"];
    let outs = ["-o", "b.svg", "-o", "b.png", "-o", "b.dxf", "-o", "b.pdf", "-o", "b.jpg"];
    let said = bench.says(&[&["section", "ball.toml"], &stack[..], &outs[..]].concat());
    assert_eq!(said.lines().filter(|line| line.starts_with("z = ")).count(), 7, "{said}");
    assert_eq!(bench.read("b.svg").matches("class=\"cut\"").count(), 7);
    assert!(bench.bytes("b.png").starts_with(b"\x89PNG"));
    // the page has 3/4 points for each pixel of the drawing
    let svg = bench.read("b.svg");
    let side = |name: &str| svg.split(&format!("{name}=\"")).nth(1).unwrap().split('"').next().unwrap();
    let [width, height] =
        ["width", "height"].map(|name| (75.0 * side(name).parse::<f64>().unwrap()).round() / 100.0);
    let pdf = String::from_utf8_lossy(&bench.bytes("b.pdf")).into_owned();
    assert!(pdf.starts_with("%PDF-") && pdf.contains("(ball.toml)") && pdf.trim_end().ends_with("%%EOF"));
    assert!(pdf.contains(&format!("/MediaBox [0 0 {width} {height}]")), "{width} {height}");
    assert!(bench.bytes("b.jpg").starts_with(&[0xff, 0xd8, 0xff]));
    let dxf = bench.read("b.dxf");
    assert_eq!(dxf.matches("\nCIRCLE\n").count(), 7);
    assert!(dxf.contains("\nLAYER\n2\nGLASS\n") && dxf.ends_with("0\nEOF\n"), "{dxf}");
    // standard output contains only the drawing
    assert!(bench.says(&["section", "ball.toml", "-o", "-"]).starts_with("<svg "));
}

/// The ball has radius 1: three quarters of the way from -1 to 1.
#[test]
fn percentages_of_the_model() {
    let bench = bench();
    let of = |plane: &str| bench.says(&["section", "ball.toml", "--plane", plane]);
    assert_eq!(of("z=75%"), of("z=0.5"));
    for plane in ["z=101%", "w=50%", "z=%", "50%"] {
        let failed = bench.fails(2, &["section", "ball.toml", "--plane", plane]);
        assert!(failed.contains("such as y=50%"), "{failed}");
    }
}

#[test]
fn refusals() {
    let bench = bench();
    let failed = bench.fails(3, &["section", "ball.toml", "--plane", "z=1.5"]);
    assert!(
        failed.contains("z = 1.5 does not intersect the model: it reaches from (-1, -1, -1)"),
        "{failed}"
    );
    bench.write("empty.toml", "rayweave = 1\n[solid.a]\nexpr = \"b & c\"\n[solid.b]\nsphere = { radius = 1 }\n[solid.c]\nsphere = { radius = 1 }\ntransform = [{ translate = [9, 0, 0] }]\n[[region]]\nsolid = \"a\"");
    assert!(bench.fails(3, &["section", "empty.toml"]).contains("the model: it is empty."));
    let failed = bench.fails(2, &["section", "ball.toml", "--plane", "z=nan"]);
    assert!(failed.contains("the plane `z=nan` is invalid"), "{failed}");
    bench.fails(2, &["section", "ball.toml", "--normal", "0,0,0"]);
    bench.fails(2, &["section", "ball.toml", "--tolerance", "nan"]);
    let failed = bench.fails(2, &["section", "ball.toml", "--tolerance", "-1"]);
    assert!(failed.contains("the tolerance is -1: it must"), "{failed}");
    let placed = ["section", "ball.toml", "--plane", "x=0.5", "--from", "0", "--to", "0.5"];
    assert!(bench.fails(2, &placed).contains("--from and --to set the positions of a stack"));
    bench.fails(2, &["section", "ball.toml", "--from", "0", "--to", "1", "--step", "-1"]);
    let failed = bench.fails(2, &["section", "ball.toml", "-o", "b.gif"]);
    assert!(failed.contains(".svg, .pdf, .png, .jpg or .dxf"), "{failed}");
    bench.fails(3, &["section", "none.toml"]);
}

#[test]
fn cut_faces_are_hatched_and_dimensioned() {
    let bench = bench();
    bench.says(&["section", "cemented.toml", "--hatch", "--dimensions", "-o", "h.svg", "-o", "h.pdf"]);
    let svg = bench.read("h.svg");
    // three regions, each with its own lines
    let hatches: Vec<&str> = svg.lines().filter(|line| line.contains("class=\"hatch\"")).collect();
    assert_eq!(hatches.len(), 3);
    assert!(hatches.iter().all(|line| line.matches('L').count() > 5), "{svg}");
    // two halves of one medium, with the edge between them; without --hatch they are one square of 2 by 2
    let halves = "rayweave = 1\n[solid.a]\nbox_from_corners = { lo = [0, 0, -1], hi = [1, 2, 1] }\n[solid.b]\n\
                  box_from_corners = { lo = [1, 0, -1], hi = [2, 2, 1] }\n[[region]]\nsolid = 'a'\nmedium = 'steel'\n\
                  [[region]]\nsolid = 'b'\nmedium = 'steel'\n[medium.steel]\n";
    bench.write("halves.toml", halves);
    let parts = |more: &[&str]| {
        let found = bench.json(&[&["section", "halves.toml", "--plane", "z", "--json"], more].concat());
        found["sections"][0]["parts"]
            .as_array()
            .unwrap()
            .iter()
            .map(|p| p["area"].as_f64().unwrap())
            .collect::<Vec<_>>()
    };
    let near = |found: &[f64], expected: &[f64]| {
        found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-2)
    };
    assert!(
        near(&parts(&[]), &[4.0]) && near(&parts(&["--hatch"]), &[2.0, 2.0]),
        "{:?}",
        parts(&["--hatch"])
    );
    let said = bench.says(&["section", "halves.toml", "-o", "halves.svg"]);
    let merged =
        "\nregions with the same medium are merged; --by-region keeps them apart\nwrote halves.svg\n";
    assert!(said.ends_with(merged), "{said}");
    let said = bench.says(&["section", "halves.toml", "--by-region", "-q", "-o", "halves.svg"]);
    assert!(!said.contains("merged") && !said.contains("wrote"), "{said}");
    // the bath is a ball with the diameter 20
    let values: Vec<&str> = svg.lines().filter(|line| line.contains("class=\"value\"")).collect();
    assert!(values.len() == 2 && values.iter().all(|line| line.contains(">20")), "{values:?}");
    assert!(values[1].contains("rotate(\u{2212}90") || values[1].contains("rotate(-90"), "{values:?}");
    let stack = ["section", "ball.toml", "--from", "0", "--to", "0.5", "--dimensions"];
    assert!(bench.fails(2, &stack).contains("cannot be used with"));
}

/// A half ball on a plate, cut beside the ball: behind the plane is its outline.
#[test]
fn edges_behind_the_plane_are_drawn() {
    let bench = bench();
    let model = "rayweave = 1\n[solid.plate]\nbox_from_corners = { lo = [-9, -9, 0], hi = [9, 9, 2] }\n[solid.ball]\n\
        sphere = { radius = 4 }\n[solid.part]\nexpr = \"plate | ball\"\n[[region]]\nsolid = \"part\"\n";
    bench.write("dome.toml", model);
    let beyond = |more: &[&str]| {
        bench.says(&[&["section", "dome.toml", "--plane", "y=-6", "-o", "dome.svg"], more].concat());
        bench.read("dome.svg").matches("class=\"beyond\"").count()
    };
    assert_eq!(beyond(&[]), 0);
    assert!(beyond(&["--beyond"]) > 0 && beyond(&["--hatch"]) > 0);
    assert_eq!(beyond(&["--hatch", "--no-beyond"]), 0);
    // the drawing reaches to the ends of the ball, 4 below and above the middle
    bench.says(&["section", "dome.toml", "--plane", "y=-6", "--hatch", "--dimensions", "-o", "dome.svg"]);
    let svg = bench.read("dome.svg");
    assert!(svg.contains(">18</text>") && svg.contains(">8</text>"), "{svg}");
}

/// A shaft in a hub: the shaft is not hatched in a section along it.
#[test]
fn named_regions_stay_without_hatching() {
    let bench = Bench::new();
    bench.write(
        "hub.toml",
        "rayweave = 1\n[solid.hub]\ncylinder = { radius = 10, height = 8 }\n[solid.shaft]\ncylinder = { radius = 3, height = 30 }\n\
         [[region]]\nsolid = \"hub\"\n[[region]]\nsolid = \"shaft\"",
    );
    let hatched = |more: &[&str]| {
        let all = ["section", "hub.toml", "--plane", "xz", "--hatch", "-o", "hub.svg"];
        bench.says(&[&all[..], more].concat());
        bench.read("hub.svg").matches("class=\"hatch\"").count()
    };
    assert_eq!(hatched(&[]), 2);
    assert_eq!(hatched(&["--no-hatch", "shaft"]), 1);
    let wrong = ["section", "hub.toml", "--plane", "xz", "--hatch", "--no-hatch", "axle", "-o", "hub.svg"];
    assert!(
        bench
            .fails(2, &wrong)
            .contains("--no-hatch axle is no region of hub.toml: its regions are hub, shaft.")
    );
}

#[test]
fn planes_in_faces_are_noted() {
    let bench = Bench::new();
    bench.write("cube.toml", "rayweave = 1\n[solid.cube]\nbox = { size = 2 }");
    let run = bench.run(&["section", "cube.toml", "--plane", "z=-1"]);
    let note =
        "note: the plane z = -1 lies in a face of the model: the section shows the material on its +z side.";
    assert!(
        run.code == 0 && run.err.starts_with(note) && run.out.contains("  4  "),
        "{} {}",
        run.out,
        run.err
    );
    let above = bench.fails(3, &["section", "cube.toml", "--plane", "z=1"]);
    assert!(
        above.contains("the plane z = 1 lies in a face") && above.contains("does not intersect"),
        "{above}"
    );
    assert_eq!(bench.run(&["section", "cube.toml", "--plane", "z=0"]).err, "");
    // the chord of an arc is a plane of the shape, but no face
    bench.write(
        "slot.toml",
        "rayweave = 1\n[solid.slot.extrude]\n\
         outline = [[-1, -2], { at = [1, -2], bulge = 1 }, [1, 2], { at = [-1, 2], bulge = 1 }]\nheight = 5",
    );
    for plane in ["y=0", "x=1", "x=-1", "x=2.5"] {
        assert_eq!(bench.run(&["section", "slot.toml", "--plane", plane]).err, "", "{plane}");
    }
    for plane in ["y=-2", "y=2", "z=0"] {
        assert!(bench.run(&["section", "slot.toml", "--plane", plane]).err.starts_with("note: "), "{plane}");
    }
}
