//! `rayweave check`.

use crate::bench::{BALL, Bench, CEMENTED};

/// Two plates; the second overlaps the first by 0.5.
const PLATES: &str = "rayweave = 1\nunit = \"mm\"\n[solid.a]\nbox = { size = [8, 8, 2] }\n[solid.b]\nbox = { size = [4, 4, 2] }\n\
    transform = [{ translate = [0, 0, 1.5] }]\n[[region]]\nsolid = \"a\"\n[[region]]\nsolid = \"b\"";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("plates.toml", PLATES);
    bench
}

#[test]
fn findings_with_places() {
    let bench = bench();
    let said = bench.says(&["check", "plates.toml", "--cells", "32", "--pictures", "found"]);
    assert!(said.starts_with("plates.toml: overlap 1; lengths in mm\n"), "{said}");
    assert!(said.contains("overlap: a and b overlap; b, the later one, has priority"), "{said}");
    assert!(said.contains("0.5 mm deep, volume 8 ") && said.contains("ray from ("), "{said}");
    assert!(said.contains("\npicture: found") && said.ends_with("1-overlap.svg\n"), "{said}");
    let picture = bench.read("found/1-overlap.svg");
    assert!(picture.contains(">both<") && picture.contains("a and b overlap"), "{picture}");
    let said = bench.says(&["check", "ball.toml", "--cells", "16"]);
    assert!(said.starts_with("ball.toml: nothing found"), "{said}");
    assert!(
        said.contains("no wall under ")
            && said.contains(" points of edges and corners; a wall at a face or edge that no ray meets"),
        "{said}"
    );
}

/// The picture of a slanted wall shows its thickness between two arrows.
#[test]
fn pictures_of_walls_have_dimensions() {
    let bench = Bench::new();
    bench.write(
        "wall.toml",
        "rayweave = 1\n[solid.wall]\nbox = { size = [0.5, 9, 9] }\ntransform = [{ rotate_x = 35 }, { rotate_y = 20 }, { rotate_z = 10 }]\n",
    );
    let said = bench.says(&["check", "wall.toml", "--wall", "1", "--cells", "32", "--pictures", "found"]);
    assert!(said.contains("0.5 mm thick, between wall.x- and wall.x+, ray from"), "{said}");
    let picture = bench.read("found/1-thin.svg");
    assert!(picture.contains(">0.5 mm</text>") && picture.contains(r#"class="thickness""#), "{picture}");
}

#[test]
fn exit_codes_and_json() {
    let bench = bench();
    let run = bench.run(&["check", "plates.toml", "--cells", "32", "--fail-on", "thin,overlap", "--json"]);
    assert_eq!((run.code, run.err.as_str()), (1, ""));
    let json: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let finding = &json["findings"][0];
    assert_eq!((finding["kind"].as_str(), finding["size"].as_f64()), (Some("overlap"), Some(0.5)));
    assert!((finding["volume"]["value"].as_f64().unwrap() - 8.0).abs() < 0.2, "{finding}");
    assert!(json["scope"]["rays"].as_u64().unwrap() > 6000 && json["scope"]["pairs"] == 1, "{json}");
    bench.says(&["check", "plates.toml", "--cells", "16", "--fail-on", "thin,gap"]);
    assert_eq!(bench.run(&["check", "plates.toml", "--cells", "16", "--fail-on", "all"]).code, 1);
    // contact is not a fault: the two glasses of a doublet
    let said = bench.says(&["check", "cemented.toml", "--cells", "16", "--fail-on", "all"]);
    assert!(said.contains("touch: left and right touch"), "{said}");
    assert_eq!(bench.run(&["check", "cemented.toml", "--cells", "16", "--fail-on", "touch"]).code, 1);
    let run = bench.run(&["check", "cemented.toml", "--cells", "16", "--wall", "2.5", "--fail-on", "thin"]);
    assert!(
        run.code == 1 && run.out.contains("thin: left is thin") && CEMENTED.contains("left"),
        "{}",
        run.out
    );
}

#[test]
fn refusals() {
    let bench = bench();
    let failed = bench.fails(2, &["check", "plates.toml", "--fail-on", "overlaps"]);
    assert!(failed.contains("Did you mean `overlap`?"), "{failed}");
    assert!(bench.fails(2, &["check", "plates.toml", "--wall", "nan"]).contains("the wall is NaN"));
    assert!(bench.fails(2, &["check", "plates.toml", "--gap", "-1"]).contains("-1"));
    bench.fails(3, &["check", "none.toml"]);
    bench.write("floor.toml", "rayweave = 1\n[solid.f]\nhalf_space = { normal = [0, 0, 1], offset = 0 }");
    assert!(
        bench
            .fails(3, &["check", "floor.toml"])
            .contains("Check the part within a box: --within LO HI, in Python within=(lo, hi).")
    );
    bench.write("far.toml", BALL.replace("R = 1.0", "R = 1e200"));
    bench.fails(3, &["check", "far.toml", "--cells", "8", "--define", "R=1e400"]);
}

/// Findings about optical properties name the file, the line and the column.
#[test]
fn optical_properties_of_gdml_files() {
    let bench = Bench::new();
    let page = include_str!("../../../../docs/guides/photons.md");
    let (_, rest) = page.split_once("```xml\n").unwrap();
    let bar = rest.split_once("```\n").unwrap().0;
    // energies in MeV by mistake, and a property that nothing uses
    let bar = bar.replace("1.5*eV 400 4*eV 400", "1.5 400 4 400").replace(
        r#"<property name="ABSLENGTH""#,
        "<property name=\"ABSORPTION\" ref=\"LENGTH\"/>\n<property name=\"ABSLENGTH\"",
    );
    bench.write("bar.gdml", &bar);
    let line = bar.lines().position(|line| line.contains("\"ABSLENGTH\"")).unwrap() + 1;
    let said = bench.says(&["check", "bar.gdml", "--cells", "8"]);
    let expected = format!(
        "bar.gdml:{line}:1: the energies of `ABSLENGTH` of material `Crystal` are not those of light"
    );
    assert!(said.contains(&expected) && said.contains("The numbers look like eV"), "{said}");
    assert!(said.contains("unused: bar.gdml") && said.contains("`ABSORPTION` is ignored"), "{said}");
    assert_eq!(bench.run(&["check", "bar.gdml", "--cells", "8", "--fail-on", "optical"]).code, 1);
    bench.says(&["check", "bar.gdml", "--cells", "8", "--fail-on", "overlap"]);
}

/// Shapes that the reader of a dump adds, such as the pieces of an offset, are not operands of the model; those of the dump are.
#[test]
fn parts_of_one_item_of_a_dump_are_no_operands() {
    let bench = Bench::new();
    let ring = "rotate_extrude($fn = 30) polygon(points = [[10, 0], [20, 0], [20, 5], [15, 8], [10, 8]]);\n";
    let cases = [
        ("polygon", ring.to_owned()),
        ("torus", "rotate_extrude($fn = 30) multmatrix([[1, 0, 0, 25], [0, 1, 0, 5], [0, 0, 1, 0], [0, 0, 0, 1]]) circle(3);\n".to_owned()),
        ("offset", "linear_extrude(height = 5) offset(r = 2) square([10, 10], center = true);\n".to_owned()),
        ("hull", "hull() { sphere(5); cube(20); }\n".to_owned()),
        ("sum", "minkowski() { sphere(1); cube(5); }\n".to_owned()),
        ("scaled", "linear_extrude(height = 5, scale = 0.5) circle(9);\n".to_owned()),
    ];
    for (name, text) in &cases {
        let file = format!("{name}.csg");
        bench.write(&file, text);
        for facets in [&[][..], &["--facets"]] {
            let said = bench.says(&[&["check", &file, "--cells", "32"], facets].concat());
            assert!(said.contains(": nothing found; lengths in mm\n"), "{name} {facets:?}: {said}");
        }
    }
    bench.write("hole.csg", format!("difference() {{ {ring} cylinder(h = 9, r1 = 4, r2 = 4); }}"));
    let said = bench.says(&["check", "hole.csg", "--cells", "32"]);
    assert!(
        said.contains("absorbed 1") && said.contains("a cylinder takes nothing from the rest of model"),
        "{said}"
    );
}

/// A polyhedron whose faces are clockwise seen from outside, as OpenSCAD requires, is right; the reverse is not.
#[test]
fn polyhedra_of_dumps_are_the_right_way_out() {
    let bench = Bench::new();
    // a box with a pyramid subtracted from its floor
    let faces = [
        "[0, 1, 4]",
        "[1, 2, 4]",
        "[2, 3, 4]",
        "[3, 0, 4]",
        "[8, 7, 6, 5]",
        "[0, 5, 6, 1]",
        "[1, 6, 7, 2]",
        "[2, 7, 8, 3]",
        "[3, 8, 5, 0]",
    ];
    let reversed = |face: &str| {
        let mut corners: Vec<&str> = face.trim_matches(['[', ']']).split(", ").collect();
        corners.reverse();
        format!("[{}]", corners.join(", "))
    };
    let text = |faces: &[String]| {
        let points = "[[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0], [2, 2, 1], [0, 0, 4], [4, 0, 4], [4, 4, 4], [0, 4, 4]]";
        format!("polyhedron(points = {points}, faces = [{}], convexity = 2);", faces.join(", "))
    };
    bench.write("right.csg", text(&faces.map(str::to_owned)));
    bench.write("wrong.csg", text(&faces.map(reversed)));
    let said = bench.says(&["check", "right.csg", "--cells", "16"]);
    assert!(said.contains(": nothing found"), "{said}");
    let said = bench.says(&["check", "wrong.csg", "--cells", "16"]);
    assert!(said.contains("shells inside out: 1"), "{said}");
}

/// The two pieces of a disc that a ring cuts apart, and the shells of the mesh that they become; and a cavity.
#[test]
fn loose_pieces_and_cavities() {
    let bench = Bench::new();
    let disc = "rayweave = 1\n[solid.disc]\ncylinder = { radius = 20, height = 10 }\n[solid.ring]\n\
        tube = { outer_radius = 15, inner_radius = 14, height = 30 }\n[solid.part]\nexpr = \"disc - ring\"\n[[region]]\nsolid = \"part\"\n";
    bench.write("disc.toml", disc);
    let said = bench.says(&["check", "disc.toml", "--fail-on", "all"]);
    assert!(said.contains("loose: part consists of 2 separate pieces; the smallest"), "{said}");
    assert_eq!(bench.run(&["check", "disc.toml", "--fail-on", "loose"]).code, 1);
    assert_eq!(bench.run(&["convert", "disc.toml", "disc.stl", "--tolerance", "0.1"]).code, 0);
    assert!(
        bench.says(&["info", "disc.stl"]).contains("2: 2 pieces"),
        "{}",
        bench.says(&["info", "disc.stl"])
    );
    let hollow = "rayweave = 1\n[solid.block]\nbox = { size = 10 }\n[solid.bubble]\nsphere = { radius = 3 }\n\
        [solid.part]\nexpr = \"block - bubble\"\n[[region]]\nsolid = \"part\"\n";
    bench.write("hollow.toml", hollow);
    let said = bench.says(&["check", "hollow.toml"]);
    assert!(said.contains("cavity: part has a closed cavity with a volume of about 11"), "{said}");
    assert!(said.contains("  at (") && said.contains("), ray from ("), "{said}");
    assert_eq!(bench.run(&["convert", "hollow.toml", "hollow.stl", "--tolerance", "0.1"]).code, 0);
    assert!(
        bench.says(&["info", "hollow.stl"]).contains("2: 1 piece, 1 cavity"),
        "{}",
        bench.says(&["info", "hollow.stl"])
    );
    let json = bench.json(&["info", "hollow.stl", "--json"]);
    assert_eq!(
        (&json["meshes"][0]["pieces"], &json["meshes"][0]["cavities"]),
        (&1.into(), &1.into()),
        "{json}"
    );
}

/// Six equal holes leave six equal walls to the rim: one finding with their number, and a line for each place.
#[test]
fn equal_findings_are_one_with_all_places() {
    let bench = Bench::new();
    let plate = "rayweave = 1\n[solid.disc]\ncylinder = { radius = 20, height = 10 }\n[solid.hole]\ncylinder = { radius = 2 }\n\
        [solid.holes]\nplace = { solid = \"hole\", ring = 6, radius = 17 }\n[solid.part]\nexpr = \"disc - holes\"\n[[region]]\nsolid = \"part\"\n";
    bench.write("plate.toml", plate);
    let said = bench.says(&["check", "plate.toml", "--wall", "1.5"]);
    assert!(said.contains("thin 6;") && said.contains(" (6 times)\n"), "{said}");
    assert_eq!(said.matches("\nthin: ").count(), 1, "{said}");
    assert_eq!(said.matches("\n  1 mm thick, between ").count(), 6, "{said}");
    let said = bench.says(&["check", "plate.toml", "--wall", "1.5", "--lines", "4"]);
    assert!(said.contains(" (6 times, of which 4 are shown: see --lines)\n"), "{said}");
    assert_eq!(said.matches("\n  1 mm thick, between ").count(), 4, "{said}");
}
