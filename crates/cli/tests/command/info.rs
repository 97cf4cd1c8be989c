//! `info`: the contents of a model.

use crate::bench::Bench;
use serde_json::json;

#[test]
fn a_model_in_numbers() {
    let bench = Bench::new();
    let facts = bench.json(&["info", "cemented.toml", "--json"]);
    assert_eq!(facts["unit"], "cm");
    assert_eq!(facts["bounds"], json!([[-10.0, -10.0, -10.0], [10.0, 10.0, 10.0]]));
    let statistics = &facts["statistics"];
    // one sphere and two boxes, of which four sides lie in common planes and one is shared
    assert_eq!(statistics["leaves"], 3);
    assert_eq!(statistics["faces"], 13);
    assert_eq!(statistics["surfaces"], 8);
    assert_eq!(statistics["shared surfaces"], 5);
    assert_eq!(statistics["placements"], 0);
    let media: Vec<_> = facts["media"].as_array().unwrap().iter().map(|m| m["name"].clone()).collect();
    assert_eq!(media, ["world", "water", "crown", "flint"]);
    assert_eq!(
        facts["regions"][1],
        json!({
            "name": "left", "medium": "crown",
            "solid": "left = box_from_corners(lo=[-2.0, -1.0, -1.0], hi=[0.0, 1.0, 1.0])",
        })
    );
    assert_eq!(facts["leaves"].as_array().unwrap().len(), 3);
}

#[test]
fn parameters_change_the_bounds() {
    let bench = Bench::new();
    let facts = bench.json(&["info", "ball.toml", "--json", "-D", "R=2.5"]);
    assert_eq!(facts["bounds"], json!([[-2.5, -2.5, -2.5], [2.5, 2.5, 2.5]]));
    assert_eq!(facts["parameters"], json!({ "R": 2.5 }));
}

#[test]
fn the_tree_for_people() {
    let bench = Bench::new();
    bench.write(
        "tree.toml",
        r#"
rayweave = 1
[solid.slab]
box = { size = [4, 4, 1] }
[solid.hole]
cylinder = { radius = 0.5 }
[solid.post]
expr = "hole & slab"
transform = [{ translate = [0, 0, 5] }]
[solid.plate]
expr = "slab - hole | post"
"#,
    );
    let text = bench.says(&["info", "tree.toml"]);
    let tree = "\
plate = union of 2
\u{251c}\u{2500} difference
\u{2502}  \u{251c}\u{2500} slab = box(size=[4.0, 4.0, 1.0])
\u{2502}  \u{2514}\u{2500} hole = cylinder(radius=0.5, height=inf)
\u{2514}\u{2500} post = (intersection of 2).translate(0, 0, 5)
   \u{251c}\u{2500} hole = cylinder(radius=0.5, height=inf)
   \u{2514}\u{2500} slab = box(size=[4.0, 4.0, 1.0])
";
    assert!(text.contains(tree), "{text}");
    assert!(text.starts_with("tree.toml: 1 region, 4 solids, 1 medium, lengths in mm\n"), "{text}");
    assert!(text.contains("\nbounds           (-2, -2, -0.5) to (2, 2, 5.5)\n"), "{text}");
    let post = bench.says(&["info", "tree.toml", "--solid", "post"]);
    assert!(post.contains("post = (intersection of 2).translate(0, 0, 5)"), "{post}");
    assert!(post.contains("\nbounds           (-0.5, -0.5, 4.5) to (0.5, 0.5, 5.5)\n"), "{post}");
    let wrong = bench.fails(2, &["info", "tree.toml", "--solid", "pots"]);
    assert!(wrong.contains("Did you mean `post`?"), "{wrong}");
    let cut = bench.says(&["info", "tree.toml", "--depth", "1"]);
    assert!(cut.contains("difference (--depth N shows more)"), "{cut}");
    let short = bench.says(&["info", "tree.toml", "--lines", "2"]);
    assert!(short.contains("... (--lines N shows more)"), "{short}");
}

/// The box of two balls that overlap reaches to 2 along z, what they have in common to sqrt(7) / 2 only.
#[test]
fn larger_bounds_have_the_extent_beside_them() {
    let bench = Bench::new();
    bench.write(
        "lens.toml",
        "rayweave = 1\n[solid.a]\nsphere = { radius = 2 }\n[solid.b]\nsphere = { radius = 2 }\n\
         transform = { translate = [3, 0, 0] }\n[solid.lens]\nexpr = \"a & b\"\n[[region]]\nsolid = \"lens\"",
    );
    let text = bench.says(&["info", "lens.toml"]);
    assert!(
        text.contains(", found by rays\n") && text.contains(", a larger box that contains the model\n"),
        "{text}"
    );
    let facts = bench.json(&["info", "lens.toml", "--json"]);
    let top = facts["extent"][1][2].as_f64().unwrap();
    assert!((top - 1.75f64.sqrt()).abs() < 1e-8 && facts["bounds"][1][2] == 2.0, "{facts}");
}

#[test]
fn solids_without_bounds_and_without_anything() {
    let bench = Bench::new();
    bench.write("half.toml", "rayweave = 1\n[solid.half]\nhalf_space = { normal = [0, 0, 1], offset = 2 }\n");
    assert!(bench.says(&["info", "half.toml"]).contains("(-inf, -inf, -inf) to (inf, inf, 2)"));
    let facts = bench.json(&["info", "half.toml", "--json"]);
    assert_eq!(facts["bounds"], json!([[null, null, null], [null, null, 2.0]]));
    bench.write("none.toml", "rayweave = 1\n");
    let none = bench.run(&["info", "none.toml"]);
    assert!(
        none.code == 0 && none.err.starts_with("warning: the model is empty: it has no solid."),
        "{}",
        none.err
    );
    assert!(
        none.out.contains("0 regions, 0 solids, 0 media") && none.out.contains("nothing"),
        "{}",
        none.out
    );
}

/// A plate with a hole inside and one outside it, and two disjoint parts.
const PLATE: &str = r#"
rayweave = 1
[solid.plate]
box = { size = [40, 20, 2] }
[solid.hole]
cylinder = { radius = 2, height = 10 }
[solid.hole_a]
expr = "hole"
transform = [{ translate = [10, 0, 0] }]
[solid.hole_b]
expr = "hole"
transform = [{ translate = [60, 0, 0] }]
[solid.lid]
box = { size = [4, 4, 4] }
transform = [{ translate = [0, 0, 30] }]
[solid.bolt]
expr = "lid & hole"
[solid.whole]
expr = "plate - (hole_a | hole_b) | bolt"
"#;

#[test]
fn how_a_model_is_prepared() {
    let bench = Bench::new();
    bench.write("plate.toml", PLATE);
    let text = bench.says(&["info", "plate.toml", "--explain"]);
    for line in [
        "as written  (plate - (hole_a/hole | hole_b/hole)) | (lid & bolt/hole)",
        "as kept     plate & ~hole_a/hole",
        "flatten   4 -> 3          0            3 -> 2    nested equal operators are merged",
        "prune     3 -> 1          0            2 -> 1    no parts that bounding boxes prove irrelevant",
        "leaves  2 of 5 are used",
        "bounds  (-20, -10, -5) to (62, 10, 32) of all leaves",
        "        (-20, -10, -1) to (20, 10, 1) of the solid they form",
        "  hole_b/hole: it lies outside plate: A - B with disjoint bounds.",
        "  bolt: it is nowhere, as the bounds of lid and bolt/hole are disjoint",
    ] {
        assert!(text.lines().any(|found| found == line), "{line}\n{text}");
    }
    assert!(!bench.says(&["info", "plate.toml"]).contains("as written"));
    let short = bench.says(&["info", "plate.toml", "--explain", "--lines", "1"]);
    assert!(short.contains("  ... and 1 more"), "{short}");
}

#[test]
fn how_a_model_is_prepared_in_numbers() {
    let bench = Bench::new();
    bench.write("plate.toml", PLATE);
    let facts = bench.json(&["info", "plate.toml", "--explain", "--json"]);
    let model = &facts["preparation"][0];
    assert_eq!(model["unasked_leaves"], json!(["hole_b/hole", "lid", "bolt/hole"]));
    assert_eq!(model["removed"][0]["replaced_by"], "universe");
    let passes = model["passes"].as_array().unwrap();
    let names: Vec<_> = passes.iter().map(|pass| pass["pass"].as_str().unwrap()).collect();
    assert_eq!(names, ["positive", "flatten", "fold", "share", "prune"]);
    assert_eq!(passes[0]["before"], json!({ "leaves": 5, "operators": 4, "complements": 0, "height": 3 }));
    assert_eq!(passes[4]["after"], json!({ "leaves": 2, "operators": 1, "complements": 0, "height": 1 }));
    assert_eq!(facts["bounds"], model["bounds"]);
    assert_eq!(model["bounds_of_leaves"], json!([[-20.0, -10.0, -5.0], [62.0, 10.0, 32.0]]));
    assert_eq!(bench.json(&["info", "plate.toml", "--json"])["preparation"], json!(null));
}

/// A cube of side 2 with a cavity of side 1 as text, without the last `missing` of its triangles.
fn hollow_cube(missing: usize) -> String {
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let (mut vertices, mut triangles) = (String::new(), Vec::new());
    for (shell, side) in [2.0, 1.0].into_iter().enumerate() {
        for k in 0..8 {
            let at = |axis: usize| 10.0 + if k >> axis & 1 == 1 { 0.5 * side } else { -0.5 * side };
            vertices += &format!("v {} {} {}\n", at(0), at(1), at(2));
        }
        for [a, b, c, d] in faces.map(|face| face.map(|corner| corner + 8 * shell + 1)) {
            // the cavity is clockwise seen from outside
            let [b, d] = if shell == 0 { [b, d] } else { [d, b] };
            triangles.extend([format!("f {a} {b} {c}\n"), format!("f {a} {c} {d}\n")]);
        }
    }
    triangles.truncate(24 - missing);
    vertices + &triangles.concat()
}

#[test]
fn a_mesh_file_in_numbers() {
    let bench = Bench::new();
    bench.write("hollow.obj", hollow_cube(0));
    let facts = bench.json(&["info", "hollow.obj", "--json"]);
    let mesh = &facts["meshes"][0];
    assert_eq!(
        (&mesh["triangles"], &mesh["shells"], &mesh["is_closed"]),
        (&json!(24), &json!(2), &json!(true))
    );
    assert_eq!((&mesh["volume"], &mesh["area"]), (&json!(7.0), &json!(30.0)));
    assert_eq!(mesh["bounds"], json!([[9.0, 9.0, 9.0], [11.0, 11.0, 11.0]]));
    assert_eq!(facts["regions"].as_array().unwrap().len(), 1);
    let text = bench.says(&["info", "hollow.obj"]);
    assert!(
        text.contains("hollow         24        16  2: 1 piece, 1 cavity  yes       30       7  (9, 9, 9) to (11, 11, 11)"),
        "{text}"
    );
    // the volume is exact where a model places the mesh
    bench.write(
        "placed.toml",
        "rayweave = 1\n[solid.part]\nmesh = { file = \"hollow.obj\" }\ntransform = [{ scale = 2 }, { rotate_z = 30 }]\n",
    );
    let volume = bench.json(&["volume", "placed.toml", "--json", "--precision", "0.05"]);
    let exact = volume["regions"][0]["volume_by_formula"].as_f64().unwrap();
    assert!((exact - 56.0).abs() < 1e-12, "{exact}");
}

#[test]
fn an_open_mesh_file_in_numbers() {
    let bench = Bench::new();
    bench.write("open.obj", hollow_cube(1));
    let mesh = bench.json(&["info", "open.obj", "--json"])["meshes"][0].clone();
    assert_eq!((&mesh["is_closed"], &mesh["open_edges"]), (&json!(false), &json!(3)));
    assert_eq!((&mesh["volume"], &mesh["area"]), (&json!(null), &json!(29.5)));
    let text = bench.says(&["info", "open.obj"]);
    assert!(text.contains("no: 3 open edges") && text.contains("open is not a solid"), "{text}");
    // the model is repaired, and so is the mesh
    let repaired = bench.run(&["info", "open.obj", "--json", "--repair"]);
    assert!(repaired.code == 0 && repaired.err.contains("1 plane hole filled"), "{}", repaired.err);
    let facts: serde_json::Value = serde_json::from_str(&repaired.out).unwrap();
    assert_eq!(facts["meshes"][0]["volume"], json!(7.0));
    bench.write("empty.obj", "");
    let refused = bench.fails(3, &["info", "empty.obj"]);
    assert!(refused.contains("the mesh is empty: the file has no triangles."), "{refused}");
}
