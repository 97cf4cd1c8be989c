//! `rayweave diff`.

use crate::bench::{BALL, Bench, CEMENTED};

/// The ball of glass in inches, defined in a different way.
const IN_INCHES: &str = "rayweave = 1\nunit = \"in\"\n[solid.bead]\nellipsoid = { radii = [0.0787401574803149606, 0.03937007874015748, 0.03937007874015748] }\n\
    transform = [{ scale = [0.5, 1, 1] }]\n[[region]]\nsolid = \"bead\"";

#[test]
fn the_same_is_0() {
    let bench = Bench::new();
    let said = bench.says(&["diff", "ball.toml", "ball.toml"]);
    assert!(said.contains("the same solid: no difference thicker than 3.46e-9 mm"), "{said}");
    assert!(said.contains("same (as written)"), "{said}");
    bench.write("bead.toml", IN_INCHES);
    let said = bench.says(&["diff", "ball.toml", "bead.toml", "--cells", "32"]);
    assert!(
        said.contains("the same solid") && !said.contains("as written") && !said.contains("0 ±"),
        "{said}"
    );
    assert!(said.contains("volumes in mm^3, ± half the width of their confidence interval"), "{said}");
    // a different format
    bench.write("cube.csg", "cube(size = [2, 2, 2], center = true);");
    bench.write("cube.toml", "rayweave = 1\n[solid.cube]\nbox = { size = 2 }");
    bench.says(&["diff", "cube.toml", "cube.csg", "--cells", "16"]);
}

#[test]
fn one_solid_of_each_model_is_compared() {
    let bench = Bench::new();
    let text = |radius: f64| {
        format!(
            "rayweave = 1\n[solid.ball]\nsphere = {{ radius = 1 }}\n[solid.rod]\ncylinder = {{ radius = {radius}, height = 4 }}\n\
             [solid.part]\nexpr = \"ball | rod\"\n[[region]]\nsolid = \"part\""
        )
    };
    bench.write("a.toml", text(0.25));
    bench.write("b.toml", text(0.5));
    bench.says(&["diff", "a.toml", "b.toml", "--solid", "ball", "--cells", "16"]);
    for solid in ["rod", "part"] {
        assert_eq!(
            bench.run(&["diff", "a.toml", "b.toml", "--solid", solid, "--cells", "16"]).code,
            1,
            "{solid}"
        );
    }
    // a mesh file has one part, whose name is that of the file
    assert_eq!(bench.run(&["convert", "a.toml", "rod.stl", "--solid", "rod", "--tolerance", "1e-3"]).code, 0);
    for (solid, code) in [("rod", 0), ("ball", 1)] {
        let run = bench.run(&[
            "diff",
            "a.toml",
            "rod.stl",
            "--solid",
            solid,
            "--cells",
            "16",
            "--distance",
            "2e-3",
        ]);
        assert_eq!(run.code, code, "{} {}", run.out, run.err);
        assert_eq!(run.err.contains("Its only solid, `rod`, is compared"), solid == "ball", "{}", run.err);
    }
    bench.write("c.toml", text(0.5).replace("rod", "bar"));
    let run = bench.run(&["diff", "a.toml", "c.toml", "--solid", "rod"]);
    assert!(run.code == 2 && run.err.contains("the names are ball, bar, part"), "{}", run.err);
}

/// Two holes of b.toml are missing in a.toml.
#[test]
fn places_of_differences_are_listed() {
    let bench = Bench::new();
    let plate = "rayweave = 1\n[solid.plate]\nbox = { size = [60, 40, 8] }\n";
    bench.write("a.toml", plate);
    let holes = "[solid.left]\ncylinder = { radius = 3 }\ntransform = { translate = [-15, 0, 0] }\n\
        [solid.right]\nbox = { size = 4 }\ntransform = { translate = [15, 5, 0] }\n\
        [solid.part]\nexpr = \"plate - left - right\"\n[[region]]\nsolid = \"part\"\n";
    bench.write("b.toml", format!("{plate}{holes}"));
    let run = bench.run(&["diff", "a.toml", "b.toml", "--cells", "32"]);
    assert_eq!(run.code, 1, "{}", run.err);
    let (_, list) = run.out.split_once("model: 2 places, the largest first, in mm\n").expect(&run.out);
    let rows: Vec<Vec<&str>> = list.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!((rows.len(), rows[0][0], rows[1][0], rows[2][0]), (3, "only", "A", "A"), "{list}");
    let json = bench.run(&["diff", "a.toml", "b.toml", "--cells", "32", "--json"]).out;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let places = json["pairs"][0]["places"].as_array().unwrap();
    let expected = [(72.0 * std::f64::consts::PI, [-15.0, 0.0, 0.0]), (64.0, [15.0, 5.0, 0.0])];
    for (place, (volume, centre)) in places.iter().zip(expected) {
        assert!((place["volume"].as_f64().unwrap() / volume - 1.0).abs() < 0.1, "{place}");
        for (k, x) in centre.into_iter().enumerate() {
            assert!((place["centre"][k].as_f64().unwrap() - x).abs() < 0.3, "{place}");
        }
    }
}

#[test]
fn a_difference_has_exit_code_1_and_is_reported() {
    let bench = Bench::new();
    bench.write("large.toml", BALL.replace("R = 1.0", "R = 1.25"));
    let run = bench.run(&["diff", "ball.toml", "large.toml", "--cells", "32", "--json", "-o", "d.svg"]);
    assert_eq!((run.code, run.err.as_str()), (1, ""));
    let json: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let pair = &json["pairs"][0];
    let shell = 4.0 / 3.0 * std::f64::consts::PI * (1.25f64.powi(3) - 1.0);
    let (value, width) =
        (pair["b_only"]["value"].as_f64().unwrap(), pair["b_only"]["half_width"].as_f64().unwrap());
    assert!((value - shell).abs() <= width && width < 0.05 * shell, "{pair}");
    assert!(pair["a_only"]["value"] == 0.0 && pair["spot"]["only_in"] == "B", "{pair}");
    let svg = bench.read("d.svg");
    assert!(svg.contains(">B only<") && svg.contains(">both<") && !svg.contains(">A only<"), "{svg}");
    // equal within the given distance
    bench.says(&["diff", "ball.toml", "large.toml", "--cells", "32", "--distance", "1.1"]);
    let run = bench.run(&["diff", "cemented.toml", "ball.toml", "--by", "region", "--cells", "16"]);
    assert_eq!(run.code, 1);
    assert!(run.out.contains("only in A") && run.out.contains("only in B"), "{}", run.out);
    bench.write("moved.toml", CEMENTED.replace("[3, 1, 1]", "[3.5, 1, 1]"));
    let run = bench.run(&["diff", "cemented.toml", "moved.toml", "--cells", "24", "--rays", "100000"]);
    assert!(
        run.code == 1 && run.out.contains("right: only in B, 0.5 thick, along the ray from "),
        "{}",
        run.out
    );
    assert!(run.out.lines().any(|line| line.starts_with("left") && line.contains("same")), "{}", run.out);
}

#[test]
fn trouble_is_2() {
    let bench = Bench::new();
    assert!(bench.fails(2, &["diff", "ball.toml", "none.toml"]).contains("none.toml"));
    bench.write("broken.toml", "rayweave = 1\n[solid.a]\nspere = {}");
    assert!(bench.fails(2, &["diff", "broken.toml", "ball.toml"]).contains("Did you mean `sphere`?"));
    assert!(
        bench
            .fails(2, &["diff", "ball.toml", "ball.toml", "--distance", "nan"])
            .contains("the distance is NaN")
    );
    assert!(bench.fails(2, &["diff", "ball.toml", "ball.toml", "-o", "d.doc"]).contains("d.doc"));
    bench.write("floor.toml", "rayweave = 1\n[solid.f]\nhalf_space = { normal = [0, 0, 1], offset = 0 }");
    let failed = bench.fails(2, &["diff", "floor.toml", "ball.toml"]);
    assert!(
        failed.contains("Compare the parts within a box: --within LO HI, in Python within=(lo, hi)."),
        "{failed}"
    );
    bench.fails(2, &["diff", "ball.toml"]);
}

/// A radius of 20/3 with the six digits of a .csg file: a difference of 3e-6, which a note explains.
#[test]
fn rounded_numbers_of_csg_files_are_explained() {
    let bench = Bench::new();
    bench.write("ball.toml", "rayweave = 1\n[solid.ball]\nsphere = { radius = \"20 / 3\" }\n");
    bench.write("ball.csg", "sphere($fn = 0, $fa = 12, $fs = 2, r = 6.66667);");
    let run = bench.run(&["diff", "ball.toml", "ball.csg", "--cells", "24", "--rays", "20000"]);
    assert!(
        run.code == 1 && run.err.contains("six digits") && run.err.contains("--distance 1e-5"),
        "{}",
        run.err
    );
    bench.says(&["diff", "ball.toml", "ball.csg", "--cells", "24", "--distance", "1e-5"]);
    bench.write("large.toml", "rayweave = 1\n[solid.ball]\nsphere = { radius = 7 }\n");
    let run = bench.run(&["diff", "large.toml", "ball.csg", "--cells", "24", "--rays", "20000"]);
    assert!(run.code == 1 && !run.err.contains("six digits"), "{}", run.err);
}
