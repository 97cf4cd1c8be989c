//! Invalid command lines and invalid models.

use crate::bench::{Bench, done};

#[test]
fn wrong_command_lines() {
    let bench = Bench::new();
    assert!(bench.fails(2, &[]).contains("Usage: rayweave"));
    assert!(bench.fails(2, &["rendre", "ball.toml"]).contains("'render'"));
    assert!(bench.fails(2, &["info"]).contains("<MODEL>"));
    assert!(bench.fails(2, &["info", "ball.toml", "--jsn"]).contains("'--json'"));
    // a file name that begins with two hyphens is not what was meant
    let unknown = bench.fails(2, &["info", "ball.toml", "--region", "left"]);
    assert!(
        unknown.contains("unexpected argument '--region' found") && !unknown.contains("as a value"),
        "{unknown}"
    );
    assert!(bench.fails(2, &["info", "-x.toml"]).contains("'-- -x'"));
    let file = bench.fails(2, &["render", "ball.toml", "sheet.svg"]);
    assert!(
        file.contains("unexpected argument 'sheet.svg' found") && file.contains("-o sheet.svg"),
        "{file}"
    );
    let hyphen = bench.fails(2, &["info", "ball.toml", "--json", "-"]);
    assert!(hyphen.contains("--json take no value and write to standard output"), "{hyphen}");
    assert!(bench.fails(2, &["info", "ball.toml", "-D", "R"]).contains("such as R=60"));
    assert!(bench.fails(2, &["info", "ball.toml", "--threads", "0"]).contains("--threads"));
}

#[test]
fn models_that_cannot_be_read() {
    let bench = Bench::new();
    let missing = bench.fails(3, &["info", "no-such-model.toml"]);
    assert!(
        missing.starts_with("error: the model file cannot be read: there is no such file. This folder has `"),
        "{missing}"
    );
    assert!(missing.contains("no-such-model.toml"), "{missing}");
    for command in ["info", "check"] {
        let missing = bench.fails(3, &[command, "bal.toml"]);
        assert!(missing.contains("Did you mean `ball.toml`?"), "{missing}");
    }
    std::fs::create_dir(bench.path("folder.toml")).unwrap();
    assert!(bench.fails(3, &["info", "folder.toml"]).contains("it is a folder"));
    bench.write("binary.toml", b"\xff\xfe\x00");
    assert!(bench.fails(3, &["info", "binary.toml"]).contains("UTF-8"));
}

#[test]
fn all_problems_of_a_model_with_their_places() {
    let bench = Bench::new();
    bench.write(
        "wrong.toml",
        "rayweave = 1\n[solid.a]\nspere = { radius = 1 }\n[solid.b]\nsphere = { radius = -1 }\n[solid.c]\nexpr = \"a & d\"\n",
    );
    let message = bench.fails(3, &["probe", "wrong.toml", "--from", "0,0,0", "--to", "1,0,0"]);
    for part in ["wrong.toml:3:", "`sphere`", "wrong.toml:5:", "wrong.toml:7:"] {
        assert!(message.contains(part), "{part}: {message}");
    }
    assert!(!message.contains('\x1b'), "colours without a terminal: {message}");
}

#[test]
fn an_unknown_parameter() {
    let bench = Bench::new();
    let message = bench.fails(3, &["info", "ball.toml", "-D", "r=2"]);
    assert!(message.contains("unknown parameter `r`"), "{message}");
    let message = bench.fails(3, &["info", "ball.toml", "-D", "R=-2"]);
    assert!(message.contains("radius"), "{message}");
}

#[test]
fn a_singular_transform() {
    let bench = Bench::new();
    bench.write(
        "flat.toml",
        "rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\ntransform = [{ scale = [1, 1, 0] }]\n",
    );
    for arguments in [&["info", "flat.toml"][..], &["render", "flat.toml", "--size", "8x8"]] {
        let message = bench.fails(3, arguments);
        assert!(message.contains("singular") && message.contains("scale"), "{message}");
    }
}

#[test]
fn a_closed_reader_is_not_an_error() {
    let bench = Bench::new();
    for arguments in [&["schema"][..], &["shapes"], &["info", "ball.toml"]] {
        let mut child = bench.command(arguments).spawn().unwrap();
        drop(child.stdout.take());
        let done = done(child.wait_with_output().unwrap());
        assert_eq!((done.code, done.err.as_str()), (0, ""), "{arguments:?}");
    }
}

/// A full disk is reported also for the version and the help.
#[test]
#[cfg(target_os = "linux")]
fn output_that_cannot_be_written_is_a_failure() {
    for option in ["--version", "--help"] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_rayweave"));
        let done = command.arg(option).stdout(full).output().unwrap();
        assert_eq!(done.status.code(), Some(1), "{option}");
        let message = String::from_utf8(done.stderr).unwrap();
        assert!(message.contains("cannot write to standard output"), "{message}");
    }
}

#[test]
fn commands_of_other_programs_get_advice() {
    let bench = Bench::new();
    let said = bench.fails(2, &["mtf", "lens.zmx"]);
    assert!(said.contains("lens.diffraction_mtf()") && said.contains("docs/guides/lens-design.md"), "{said}");
    assert!(bench.fails(2, &["slice", "ball.toml"]).contains("rayweave section MODEL --plane z=0"));
    assert!(bench.fails(2, &["rendr", "ball.toml"]).contains("render"));
}
