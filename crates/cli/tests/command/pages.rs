//! Help, shapes, schema, manual pages, completions.

use crate::bench::Bench;

const COMMANDS: [&str; 21] = [
    "new",
    "render",
    "watch",
    "probe",
    "trace",
    "optics",
    "merge",
    "convert",
    "export",
    "infill",
    "volume",
    "section",
    "check",
    "diff",
    "thickness",
    "info",
    "shapes",
    "photons",
    "schema",
    "completions",
    "man",
];

#[test]
fn help_and_version() {
    let bench = Bench::new();
    let help = bench.says(&["--help"]);
    // a feature that is disabled by default
    let bench_command = cfg!(feature = "bench").then_some("bench");
    for command in COMMANDS.into_iter().chain(bench_command) {
        assert!(help.contains(&format!("\n  {command} ")), "{command}: {help}");
        let own = bench.says(&[command, "--help"]);
        assert!(own.contains(&format!("Usage: rayweave {command}")), "{own}");
    }
    assert!(help.contains("Exit codes:") && help.contains("  130  cancelled"), "{help}");
    let version = bench.says(&["--version"]);
    assert_eq!(version, concat!("rayweave ", env!("CARGO_PKG_VERSION"), "\n"));
}

#[test]
fn every_shape_has_a_page() {
    let bench = Bench::new();
    let list = bench.says(&["shapes"]);
    let names = "sphere ellipsoid box box_from_corners cylinder cone half_space slab torus paraboloid quadric tube \
                 wedge prism convex mesh asphere biconic freeform";
    for name in names.split_whitespace() {
        assert!(list.contains(&format!("\n{name}(")), "{name}: {list}");
        let page = bench.says(&["shapes", name]);
        assert!(page.starts_with(&format!("# {name}\n")) && page.contains("| parameter |"), "{page}");
    }
    for name in ["extrude", "revolve"] {
        assert!(list.contains(&format!("\n{name}(outline")), "{name}: {list}");
        // the example of the page is a model
        let page = bench.says(&["shapes", name]);
        let (_, example) = page.split_once("Example:\n").unwrap();
        bench.write("example.toml", format!("rayweave = 1\n{example}"));
        assert!(bench.says(&["info", "example.toml"]).contains("1 solid"));
    }
    let corner = bench.fails(2, &["shapes", "fillet"]);
    assert!(corner.contains("`rayweave shapes extrude` and `rayweave shapes revolve`"), "{corner}");
    let message = bench.fails(2, &["shapes", "torrus"]);
    assert!(message.contains("Did you mean `torus`?"), "{message}");
}

#[test]
fn the_schema_is_json_and_names_the_shapes() {
    let bench = Bench::new();
    let schema = bench.json(&["schema"]);
    assert!(schema["$schema"].as_str().unwrap().contains("json-schema.org"));
    let text = schema.to_string();
    for word in ["sphere", "half_space", "region", "medium", "camera", "transform"] {
        assert!(text.contains(&format!("\"{word}\"")), "{word}");
    }
}

#[test]
fn a_manual_page_for_every_command() {
    let bench = Bench::new();
    bench.says(&["man", "--out", "man"]);
    let page = bench.read("man/rayweave.1");
    assert!(page.contains("Exit codes"), "{page}");
    for command in COMMANDS {
        let page = bench.read(&format!("man/rayweave-{command}.1"));
        assert!(page.starts_with(".") && page.contains(".SH NAME"), "{page}");
    }
    bench.write("file", "");
    assert!(
        bench.fails(1, &["man", "--out", "file/man"]).contains("cannot write the manual pages to file/man")
    );
}

#[test]
fn completions_for_every_shell() {
    let bench = Bench::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = bench.says(&["completions", shell]);
        assert!(script.contains("rayweave") && script.contains("timeline"), "{shell}");
    }
    assert!(bench.fails(2, &["completions", "dos"]).contains("bash"));
}
