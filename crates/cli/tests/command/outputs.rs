//! Outputs that are also inputs, or another output: refused before anything is written.

use crate::bench::Bench;
use crate::photons;

const RAYS: &str = "ox,oy,oz,dx,dy,dz\n-5,0,0,1,0,0\n";

const LINE: [&str; 4] = ["--from", "-5,0,0", "--to", "-4,0,0"];

#[test]
fn inputs_are_not_overwritten() {
    let bench = Bench::new();
    bench.write("r.csv", RAYS);
    let refused = |arguments: &[&str], input: &str| {
        let before = bench.read(input);
        let said = bench.fails(2, arguments);
        assert!(said.contains("which would be overwritten. Choose another name."), "{said}");
        assert_eq!(bench.read(input), before, "{arguments:?}");
        said
    };
    let trace = refused(&["trace", "ball.toml", "--rays", "r.csv", "-o", "./r.csv"], "r.csv");
    assert!(trace.contains("./r.csv: it is also the input --rays, which"), "{trace}");
    refused(&["trace", "ball.toml", "--rays", "r.csv", "-o", "ball.toml"], "ball.toml");
    let probe = [&["probe", "ball.toml", "--timeline", "ball.toml"], &LINE[..]].concat();
    assert!(refused(&probe, "ball.toml").contains("ball.toml: it is also the model, which"));
    refused(&["convert", "ball.toml", "ball.toml", "--to", "stl"], "ball.toml");
    bench.write("c.csv", "contour,x,y\n0,0,0\n0,1,0\n0,1,1\n");
    refused(&["infill", "c.csv", "--spacing", "0.1", "-o", "c.csv"], "c.csv");
    // the usual name of a picture
    bench.write("shot.png", bench.read("ball.toml"));
    refused(&["render", "shot.png", "--format", "native"], "shot.png");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("r.csv", bench.path("soft.csv")).unwrap();
        std::fs::hard_link(bench.path("r.csv"), bench.path("hard.csv")).unwrap();
        refused(&["trace", "ball.toml", "--rays", "r.csv", "-o", "soft.csv"], "r.csv");
        refused(&["trace", "ball.toml", "--rays", "r.csv", "-o", "hard.csv"], "hard.csv");
    }
    // an existing file that is no input is replaced
    bench.write("out.csv", "old");
    bench.run(&["trace", "ball.toml", "--rays", "r.csv", "-o", "out.csv"]);
    assert!(bench.read("out.csv").starts_with("ray,"));
}

#[test]
fn files_that_a_model_reads_are_not_overwritten() {
    let bench = Bench::new();
    let light = "ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,1\n";
    bench.write("light.csv", light);
    bench.write(
        "lit.toml",
        "rayweave = 1\n[solid.ball]\nsphere = { radius = 1 }\n[medium.ball]\nindex = 1.5\n\
         [[optics.source]]\nrays = { file = \"light.csv\" }\nwavelength_nm = 500\n",
    );
    let said = bench.fails(2, &["optics", "lit.toml", "--out", "light.csv"]);
    assert!(said.contains("light.csv: it is also a file that the model reads, which would be"), "{said}");
    assert_eq!(bench.read("light.csv"), light);
    bench.run(&["convert", "ball.toml", "ball.stl"]);
    bench.write("part.toml", "rayweave = 1\n[solid.part]\nmesh = { file = \"ball.stl\" }\n");
    let said = bench.fails(2, &["convert", "part.toml", "ball.stl"]);
    assert!(said.contains("a file that the model reads"), "{said}");
}

/// The pictures of `check --pictures` have names that the command line does not name.
#[test]
fn pictures_do_not_overwrite_what_the_model_reads() {
    let bench = Bench::new();
    let outline = "[solid.a]\nextrude = { file = \"pictures/1-overlap.svg\", height = 4 }\n";
    let model = format!(
        "rayweave = 1\n{outline}[solid.b]\nsphere = {{ radius = 2 }}\n[[region]]\nsolid = \"a\"\n[[region]]\nsolid = \"b\"\n"
    );
    std::fs::create_dir_all(bench.path("pictures")).unwrap();
    let drawing = "<svg xmlns=\"http://www.w3.org/2000/svg\"><rect width=\"3\" height=\"3\"/></svg>";
    bench.write("pictures/1-overlap.svg", drawing);
    bench.write("two.toml", &model);
    let said = bench.fails(2, &["check", "two.toml", "--pictures", "pictures"]);
    assert!(said.contains("1-overlap.svg: it is also a file that the model reads"), "{said}");
    assert_eq!(std::fs::read_to_string(bench.path("pictures/1-overlap.svg")).unwrap(), drawing);
    assert!(bench.run(&["check", "two.toml", "--pictures", "others"]).out.contains("picture: others"));
}

#[test]
fn outputs_have_names_of_their_own() {
    let bench = photons::bench();
    for (option, name) in [("--steps", "p.csv"), ("--histories", "./p.csv")] {
        let said = bench.fails(2, &photons::run(&["-o", "p.csv", option, name]));
        assert!(said.contains(&format!("{name}: --out and {option} name the same file.")), "{said}");
    }
    assert!(!bench.path("p.csv").exists());
    let fill = ["infill", "ball.toml", "--spacing", "0.1", "--z", "0"];
    let said = bench.fails(2, &[&fill[..], &["-o", "x.svg", "--svg", "x.svg"]].concat());
    assert!(said.contains("x.svg: --out and --svg name the same file."), "{said}");
    let said = bench.fails(2, &["optics", "ball.toml", "--layout", "q.svg", "--spot", "q.svg"]);
    assert!(said.contains("q.svg: --layout and --spot name the same file."), "{said}");
    let said = bench.fails(2, &["section", "ball.toml", "-o", "a.svg", "-o", "a.svg"]);
    assert!(said.contains("a.svg: --out names the same file twice."), "{said}");
    let said = bench.fails(2, &[&["probe", "ball.toml", "--timeline", "t.png"], &LINE[..]].concat());
    assert!(said.contains("t.png: this drawing is written as .svg only."), "{said}");
    let said = bench.fails(2, &[&fill[..], &["--svg", "t.txt"]].concat());
    assert!(said.contains("t.txt: this drawing is written as .svg only."), "{said}");
}

/// Names of a model reach a terminal as text, and numbers of options are refused in their own terms.
#[test]
fn control_characters_and_numbers() {
    let bench = Bench::new();
    bench.write("esc.toml", "rayweave = 1\n[solid.\"a\\u001b]0;OWNED\\u0007\"]\nsphere = { radius = 1 }\n");
    for command in [&["info", "esc.toml"][..], &["volume", "esc.toml", "--total", "6"]] {
        let done = bench.run(command);
        assert!(done.out.contains("a\\u001b]0;OWNED\\u0007"), "{}", done.out);
        let is_escape = |c: char| c.is_control() && c != '\n';
        assert!(!done.out.contains(is_escape) && !done.err.contains(is_escape), "{command:?}");
    }
    let said = |arguments: &[&str]| bench.fails(2, arguments);
    assert!(
        said(&["info", "ball.toml", "--threads", "0"]).contains("'--threads <N>': it must be at least 1")
    );
    let seed = said(&["volume", "ball.toml", "--seed", "-1"]);
    assert!(seed.contains("'-1' for '--seed <N>': it must be a whole number from 0"), "{seed}");
    let total = said(&["volume", "ball.toml", "--total", "18446744073709551615"]);
    assert!(total.contains("is not in 6..=68719476736"), "{total}");
    // every count can be written with an exponent
    let total = said(&["volume", "ball.toml", "--total", "1e12"]);
    assert!(total.contains("1000000000000 is not in 6..=68719476736"), "{total}");
    for huge in ["1e99", "18446744073709551616"] {
        let total = said(&["volume", "ball.toml", "--total", huge]);
        assert!(total.contains("it is too large: the limit is 18446744073709551615 in full"), "{total}");
    }
    let part = said(&["volume", "ball.toml", "--seed", "1.5"]);
    assert!(part.contains("it must be a whole number from 0, as 100000 or 1e5"), "{part}");
    let same = |arguments: [&[&str]; 2]| assert_eq!(bench.run(arguments[0]).out, bench.run(arguments[1]).out);
    let volume = ["volume", "ball.toml", "--json"];
    same(
        [&["--total", "1e3", "--seed", "1e1", "--threads", "1e0"][..], &["--total", "1000", "--seed", "10"]]
            .map(|options| [&volume[..], options].concat())
            .each_ref()
            .map(Vec::as_slice),
    );
    same([
        &["section", "ball.toml", "--columns", "1e2", "--json"],
        &["section", "ball.toml", "--columns", "100", "--json"],
    ]);
    let folder = bench.fails(1, &["new", "nodir/x.toml"]);
    assert!(folder.contains("the folder nodir does not exist. Create it first."), "{folder}");
}

/// Requests far beyond what a machine computes are refused at once.
#[test]
fn huge_requests() {
    let bench = Bench::new();
    let mut nest = "rayweave = 1\n[solid.s0]\nsphere = { radius = 1 }\n".to_owned();
    for k in 1..29 {
        nest +=
            &format!("[solid.s{k}]\nplace = {{ solid = \"s{}\", at = [[0, 0, 0], [{k}, 0, 0]] }}\n", k - 1);
    }
    bench.write("nest.toml", &nest);
    for out in ["o.stl", "o.csg", "o.gdml"] {
        let said = bench.fails(1, &["convert", "nest.toml", out]);
        assert!(said.contains("has more than 1000000 shapes and operators: every copy counts"), "{said}");
    }
    let fine = bench.fails(2, &["section", "ball.toml", "--tolerance", "1e-14"]);
    assert!(fine.contains("the tolerance is 1e-14: for a section of this size"), "{fine}");
    let coarse = bench.json(&["section", "ball.toml", "--tolerance", "1e300", "--json"]);
    assert!(coarse.to_string().contains("\"area\""), "{coarse}");
    let ring = "rayweave = 1\n[solid.ring]\ntorus = { major = 1e4, minor = 1e-9 }\n";
    bench.write("ring.toml", ring);
    let said = bench.fails(3, &["convert", "ring.toml", "ring.stl", "--tolerance", "2"]);
    assert!(said.contains("the solid vanishes at the tolerance 2: no triangles"), "{said}");
}
