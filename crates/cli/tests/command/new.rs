//! `rayweave new`, and models from standard input.

use crate::bench::{BALL, Bench};

const KINDS: [&str; 4] = ["part", "bracket", "lens", "detector"];

#[test]
fn every_starter_is_a_sound_model() {
    let bench = Bench::new();
    for kind in KINDS {
        let file = format!("{kind}-new.toml");
        assert_eq!(bench.says(&["new", &file, kind]), format!("{file}\n"));
        let text = bench.read(&file);
        assert!(text.starts_with("# ") && text.contains(&file) && !text.contains("FILE"), "{text}");
        // every line of a table has a comment near: at least a fifth of the lines are comments
        let comments = text.lines().filter(|line| line.contains('#')).count();
        assert!(5 * comments > text.lines().count(), "{kind}: {comments}");
        assert!(bench.says(&["info", &file]).contains("mm"));
        bench.says(&["check", &file, "--fail-on", "empty,thin,absorbed"]);
    }
    let optics = bench.says(&["optics", "lens-new.toml"]);
    assert!(optics.contains("screen"), "{optics}");
    // two spheres of radius 51.5 with n_d = 1.5168 focus near 48 mm: the spot is much smaller than the beam
    assert_eq!(bench.says(&["new", "-"]).lines().nth(1), Some("rayweave = 1"));
}

#[test]
fn existing_files_are_kept() {
    let bench = Bench::new();
    let message = bench.fails(1, &["new", "ball.toml"]);
    assert!(message.contains("cannot write ball.toml: the file exists"), "{message}");
    assert_eq!(bench.read("ball.toml"), BALL);
    assert!(bench.fails(2, &["new", "a.toml", "teapot"]).contains("bracket"));
    for name in ["a.gdml", "a"] {
        let message = bench.fails(2, &["new", name, "detector"]);
        assert!(
            message.contains(&format!("cannot write {name}: the model is written as TOML.")),
            "{message}"
        );
        assert!(!bench.path(name).exists());
    }
    assert!(bench.fails(1, &["new", "none/a.toml"]).contains("cannot write none/a.toml"));
}

#[test]
fn models_come_from_standard_input() {
    let bench = Bench::new();
    let from_file = bench.says(&["volume", "ball.toml"]);
    let done = bench.run_with_input(&["volume", "-"], BALL);
    assert_eq!((done.code, done.err.as_str()), (0, ""));
    assert_eq!(done.out, from_file.replace("ball.toml", "standard input"));
    let done = bench.run_with_input(&["convert", "-", "out.csg", "-D", "R=2"], BALL);
    assert_eq!(done.code, 0, "{}", done.err);
    let done = bench.run_with_input(&["info", "-", "--format", "openscad"], &bench.read("out.csg"));
    assert_eq!(done.code, 0, "{}", done.err);
    assert!(done.out.contains("sphere"), "{}", done.out);
    let done = bench.run_with_input(&["render", "-", "--view", "iso"], BALL);
    assert_eq!((done.code, done.out.as_str()), (0, "model.png: 1280 x 720 pixels\n"));
    let done = bench.run_with_input(&["info", "-"], "rayweave = 1\n[solid.a]\ncube = { size = 1 }\n");
    assert_eq!(done.code, 3);
    assert!(done.err.contains("Did you mean `box`?"), "{}", done.err);
}
