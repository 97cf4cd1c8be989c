//! Models from other programs.

use crate::bench::Bench;

const DUMP: &str = "difference() {\n\tcube(size = [4, 4, 4], center = true);\n\tsphere($fn = 12, $fa = 12, $fs = 2, r = 1);\n}\n";

#[test]
fn openscad_by_ending_and_by_option() {
    let bench = Bench::new();
    bench.write("part.csg", DUMP);
    bench.write("part.txt", DUMP);
    for arguments in [&["info", "part.csg"][..], &["info", "part.txt", "--format", "openscad"]] {
        let info = bench.says(arguments);
        assert!(info.contains("1 region") && info.contains("sphere"), "{info}");
    }
    // exactly round: 1 from the centre; with --facets, the apothem of a facet
    let probe = ["probe", "part.csg", "--from", "-4,0.1,0.1", "--to", "4,0.1,0.1"];
    let round = bench.says(&probe);
    let faceted = bench.says(&[&probe[..], &["--facets"]].concat());
    assert!(round != faceted, "{round}");
    assert!(bench.says(&["info", "part.csg", "--facets"]).contains("convex"));
    assert!(bench.fails(2, &["info", "part.csg", "--format", "opensacd"]).contains("openscad"));
    assert!(bench.fails(3, &["info", "part.txt"]).contains("part.txt"));
}

#[test]
fn losses_are_reported_with_their_places() {
    let bench = Bench::new();
    bench.write("part.csg", format!("{DUMP}import(file = \"gone.stl\");\n"));
    let output = bench.run(&["info", "part.csg"]);
    let messages = &output.err;
    assert!(messages.contains("part.csg:5:1") && messages.contains("no file `gone.stl`"), "{messages}");
    assert!(output.out.contains("1 region"));
    bench.write("cut.csg", &DUMP[..40]);
    assert!(bench.fails(3, &["info", "cut.csg"]).contains("cut.csg:2:"));
}

/// Results computed from a part of a model would be wrong.
#[test]
fn answers_need_all_of_the_geometry() {
    let bench = Bench::new();
    bench.write("part.csg", format!("{DUMP}import(file = \"gone.stl\");\n"));
    let missing = bench.fails(3, &["volume", "part.csg"]);
    assert!(missing.contains("no file `gone.stl`"), "{missing}");
    assert!(missing.contains("error: part.csg: a part of the geometry is missing"), "{missing}");
    let allowed = bench.run(&["volume", "part.csg", "--allow-missing", "--precision", "0.1"]);
    assert!(
        allowed.code == 0 && allowed.out.contains("model") && allowed.err.contains("no file"),
        "{}",
        allowed.err
    );
    for command in ["info", "volume"] {
        let strict = bench.fails(3, &[command, "part.csg", "--strict", "--allow-missing"]);
        assert!(strict.starts_with("error: import() is left out"), "{strict}");
    }
}

#[test]
fn warnings_are_errors_if_asked() {
    let bench = Bench::new();
    bench.write("empty.toml", "");
    for command in ["info", "volume", "check"] {
        let done = bench.run(&[command, "empty.toml"]);
        assert!(done.err.contains("warning: the model is empty"), "{command}: {}", done.err);
        assert!(bench.fails(3, &[command, "empty.toml", "--strict"]).contains("error: the model is empty"));
        assert!(bench.fails(3, &["-q", command, "empty.toml", "--strict"]).contains("the model is empty"));
        // errors stay
        let quiet = bench.run(&["-q", command, "empty.toml"]).err;
        assert!(!quiet.contains("warning") && quiet.contains("error") == (command == "check"), "{quiet}");
    }
    bench.write(
        "heavy.toml",
        "rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\n[medium.a]\ndensity = \"heavy\"\n",
    );
    assert!(bench.fails(3, &["volume", "heavy.toml"]).contains("unknown parameter `heavy`"));
}

#[test]
fn files_elsewhere_need_permission() {
    let bench = Bench::new();
    let folder = bench.path("model");
    std::fs::create_dir_all(&folder).unwrap();
    bench.write("ball.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
    bench.write("model/part.toml", "rayweave = 1\n[solid.a]\nmesh = { file = '../ball.off' }\n");
    let refused = bench.fails(3, &["info", "model/part.toml"]);
    assert!(
        refused.contains("outside the folder of the model") && refused.contains("--allow-path"),
        "{refused}"
    );
    let here = bench.path("");
    bench.says(&["info", "model/part.toml", "--allow-path", here.to_str().unwrap()]);
    bench.says(&["info", "model/part.toml", "--allow-path", "nowhere", "--allow-path", "ball.off"]);
    // the light of a source
    bench.write("rays.csv", "ox,oy,oz,dx,dy,dz\n0,0,0,0,0,1\n");
    bench.write(
        "model/light.toml",
        "rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\n[optics.medium]\na = 1.5\n[[optics.source]]\nrays = { file = '../rays.csv' }\n",
    );
    let refused = bench.fails(3, &["optics", "model/light.toml"]);
    assert!(
        refused.contains("outside the folder of the model") && refused.contains("--allow-path"),
        "{refused}"
    );
    bench.says(&["optics", "model/light.toml", "--allow-path", "rays.csv"]);
}
