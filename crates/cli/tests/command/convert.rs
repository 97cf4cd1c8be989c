//! `rayweave convert`, and meshes given as models.

use crate::bench::Bench;

const PART: &str = "rayweave = 1\n[solid.plate]\nbox = { size = [4, 4, 2] }\n[solid.bore]\ncylinder = { radius = 1 }\n\
    [solid.part]\nexpr = 'plate - bore'\n";

/// The number of crossings of a probe through the part.
fn crossings(bench: &Bench, file: &str) -> usize {
    let crossings = bench.says(&["probe", file, "--from", "-9,0.1,0.2", "--to", "9,0.1,0.2"]);
    crossings.matches("> world\n").count() + crossings.matches("  world > ").count()
}

#[test]
fn every_format_is_written_and_read() {
    let bench = Bench::new();
    bench.write("part.toml", PART);
    for ending in ["toml", "csg", "gdml", "stl", "obj", "ply", "off", "3mf"] {
        let out = format!("out.{ending}");
        let done = bench.run(&["convert", "part.toml", &out, "--tolerance", "0.01"]);
        assert_eq!((done.code, done.out), (0, format!("wrote {out}\n")), "{ending}: {}", done.err);
        let is_mesh = !["toml", "csg", "gdml"].contains(&ending);
        assert_eq!(
            done.err.contains("approximated: curved faces, with triangles within 1.000e-2"),
            is_mesh,
            "{}",
            done.err
        );
        assert_eq!(crossings(&bench, &out), 4, "{ending}");
    }
    // format given by name, output to standard output
    let done = bench.run(&["convert", "part.toml", "-", "--to", "openscad", "--quiet"]);
    assert!(
        done.code == 0 && done.out.contains("difference() {") && done.out.contains("cylinder("),
        "{}",
        done.out
    );
    // --quiet suppresses changes of form, but not losses
    assert!(done.err.starts_with("dropped: names of regions"), "{}", done.err);
    let strict = bench.fails(3, &["convert", "part.toml", "part.csg", "--strict", "-q"]);
    assert!(
        strict.contains("dropped: names of regions") && strict.contains("part.csg is not written"),
        "{strict}"
    );
    // triangles within the tolerance are no loss
    let done = bench.run(&["convert", "part.toml", "part.stl", "--tolerance", "0.01", "--strict", "-q"]);
    assert!(done.code == 0 && done.err.contains("approximated: curved faces"), "{}", done.err);
    bench.says(&["convert", "part.toml", "same.toml", "--strict"]);
}

/// A fillet built of a torus and the cone through the ends of its arc: facets that are tangent to each other.
#[test]
fn one_solid_of_a_model() {
    let bench = Bench::new();
    let volume = |file: &str| bench.json(&["volume", file, "--json", "-q"]);
    bench.write(
        "part.toml",
        &(PART.to_owned() + "[solid.pin]\ncylinder = { radius = 1, height = 2 }\n[[region]]\nsolid = 'part'\n[[region]]\nsolid = 'pin'\n"),
    );
    for (solid, expected) in [("plate", 32.0), ("part", 32.0 - 2.0 * std::f64::consts::PI)] {
        for ending in ["toml", "csg", "obj"] {
            let out = format!("one-{solid}.{ending}");
            let done = bench.run(&["convert", "part.toml", &out, "--solid", solid, "--tolerance", "0.001"]);
            assert_eq!(done.code, 0, "{}", done.err);
            let found = volume(&out);
            let found = found["regions"][0]["volume"]["value"].as_f64().unwrap_or_else(|| panic!("{found}"));
            assert!((found - expected).abs() < 0.02 * expected, "{out} {found}");
        }
    }
    let unknown = bench.fails(2, &["convert", "part.toml", "x.stl", "--solid", "prat"]);
    assert!(
        unknown.contains("no solid is called `prat`") && unknown.contains("Did you mean `part`?"),
        "{unknown}"
    );
    // one body for all regions, and where they stay apart
    let done = bench.run(&["convert", "part.toml", "all.stl"]);
    let hint = "dropped: the division into regions: the file contains one body, their union; 3MF, OBJ and glTF keep the regions apart";
    assert!(done.code == 0 && done.err.contains(hint), "{}", done.err);
    let said = bench.says(&["check", "part.toml", "--solid", "plate", "--cells", "16"]);
    assert!(said.contains("\nsampled with ") && said.contains(" rays: one part, 0 operands\n"), "{said}");
}

/// A converted lens has the stop, image, fields and wavelengths of its file: for each field, the centroid and the RMS radius of the
/// light are those of the file, whose rays are others.
#[test]
fn lens_files_become_models_with_their_light() {
    let bench = Bench::new();
    let triplet = std::fs::read_to_string("../../models/optics/cooke-triplet.zmx").unwrap();
    let mut compared = 0;
    for field in ["0", "14", "20"] {
        let file: Vec<String> = triplet
            .lines()
            .map(|line| match line.split_whitespace().next() {
                Some("YFLN") => format!("YFLN {field}"),
                Some("XFLN") => "XFLN 0".to_owned(),
                Some("FTYP") => "FTYP 0 0 1 3".to_owned(),
                _ => line.to_owned(),
            })
            .collect();
        bench.write("lens.zmx", file.join("\n"));
        bench.says(&["convert", "lens.zmx", "lens.toml"]);
        let [own, model] = ["lens.zmx", "lens.toml"].map(|name| {
            let found = bench.json(&["optics", name, "--json"]);
            let sheets = found["sheets"].as_array().unwrap().clone();
            sheets.into_iter().find(|sheet| sheet["sheet"] == "image").unwrap()
        });
        let number = |value: &serde_json::Value, what: &str| value[what].as_f64().unwrap();
        // a lens file has a radius for its field, in order of the surfaces
        let expected = number(&own["fields"][0], "rms_radius");
        let found = number(&model, "rms_radius");
        assert!((found / expected - 1.0).abs() < 0.03, "{field}: {found}, not {expected}");
        let height = |sheet: &serde_json::Value| sheet["centroid"][1].as_f64().unwrap();
        assert!((height(&model) - height(&own["fields"][0])).abs() < 0.1 * expected, "{model} {own}");
        compared += 1;
    }
    assert_eq!(compared, 3);
    let text = bench.read("lens.toml");
    assert!(text.contains("name = \"image\"") && text.contains("\"N-SK16\""), "{text}");
    // the stop is a ring on the back of the second lens, and a plane around that lens
    let stop = text.split("[[optics.sheet]]").find(|sheet| sheet.contains("name = \"stop\"")).unwrap();
    assert!(stop.contains("opening = ") && stop.contains("radius = 20.29192"), "{stop}");
    assert!(text.contains("name = \"mount\""), "{text}");
    // other formats have the solids only
    let done = bench.run(&["convert", "lens.zmx", "lens.stl"]);
    assert!(
        done.code == 0 && done.err.contains("the fields and the wavelengths are left out"),
        "{}",
        done.err
    );
    bench.fails(3, &["convert", "lens.zmx", "lens.stl", "--strict"]);
}

/// The first lens of the triplet between its faces: the volume of each command is that of the model file that the lens becomes.
#[test]
fn commands_take_one_lens_of_a_lens_file() {
    let bench = Bench::new();
    bench.write("lens.zmx", std::fs::read_to_string("../../models/optics/cooke-triplet.zmx").unwrap());
    assert_eq!(bench.run(&["convert", "lens.zmx", "lens.toml"]).code, 0);
    let volume = |name: &str, extra: &[&str]| {
        let found = bench.json(&[&["volume", name, "--json", "-q"], extra].concat());
        let regions = found["regions"].as_array().unwrap();
        assert_eq!(regions.len(), 1, "{found}");
        regions[0]["volume"]["value"].as_f64().unwrap()
    };
    let expected = volume("lens.toml", &["--solid", "lens 1-2"]);
    assert_eq!(volume("lens.zmx", &["--solid", "lens 1-2"]), expected);
    for part in ["front.stl", "front.toml"] {
        let done = bench.run(&["convert", "lens.zmx", part, "--solid", "lens 1-2"]);
        assert_eq!(done.code, 0, "{}", done.err);
        let found = volume(part, &[]);
        assert!((found / expected - 1.0).abs() < 3e-3, "{part}: {found}, not {expected}");
    }
    let unknown = bench.fails(2, &["convert", "lens.zmx", "front.stl", "--solid", "lens 9-10"]);
    assert!(unknown.contains("lens 9-10") && unknown.contains("lens 1-2"), "{unknown}");
    let options: [&[&str]; 4] = [&["--unit", "cm"], &["--facets"], &["--repair"], &["--define", "R=1"]];
    for option in options {
        for command in [
            &["convert", "lens.zmx", "x.stl"][..],
            &["optics", "lens.zmx"],
            &["volume", "lens.zmx"],
            &["info", "lens.zmx"],
        ] {
            let refused = bench.fails(2, &[command, option].concat());
            let begin = format!("error: {} has no effect on lens.zmx: ", option[0]);
            assert!(refused.starts_with(&begin) && refused.ends_with("Leave it out.\n"), "{refused}");
        }
    }
}

#[test]
fn meshes_that_are_not_sound_are_refused_unless_allowed() {
    let bench = Bench::new();
    let model = "rayweave = 1\n[solid.rod]\ncylinder = { radius = 20, height = 10 }\n\
        transform = [{ translate = [0, 0, 5] }]\n[solid.chord]\n\
        cone = { radius1 = 37, radius2 = 7, height = 30 }\ntransform = [{ translate = [0, 0, 5] }]\n\
        [solid.ring]\ntorus = { major = 17, minor = 3 }\ntransform = [{ translate = [0, 0, 7] }]\n\
        [solid.part]\nexpr = '(rod & chord) | (ring - chord)'\n";
    // solids of revolution about one axis are combined by their profiles
    bench.write("part.toml", model);
    let done = bench.run(&["convert", "part.toml", "part.obj", "--tolerance", "0.05"]);
    assert_eq!((done.code, done.out.as_str()), (0, "wrote part.obj\n"), "{}", done.err);
    std::fs::remove_file(bench.path("part.obj")).unwrap();
    // not if they are stretched
    let model = &(model.to_owned() + "transform = { scale = [1, 1.5, 1] }\n");
    bench.write("part.toml", model);
    let refused = bench.fails(1, &["convert", "part.toml", "part.obj", "--tolerance", "0.05"]);
    assert!(refused.contains("the mesh of region `part` is not sound: "), "{refused}");
    assert!(refused.contains("the first is at (") && refused.contains("--allow-unsound"), "{refused}");
    assert!(!bench.path("part.obj").exists());
    let allowed = bench.run(&["convert", "part.toml", "part.obj", "--tolerance", "0.05", "--allow-unsound"]);
    assert!(allowed.code == 0 && allowed.err.contains("the mesh of `part` is not sound"), "{}", allowed.err);
    assert!(bench.path("part.obj").exists());
}

#[test]
fn a_failed_write_leaves_no_file() {
    let bench = Bench::new();
    bench.write("part.toml", PART);
    bench.write("rod.toml", "rayweave = 1\n[solid.rod]\ncylinder = { radius = 1 }\n");
    assert!(bench.fails(3, &["convert", "rod.toml", "rod.stl"]).contains("region `rod` is unbounded"));
    let endings = [
        ("part.step", "part.step: .step files cannot be written: "),
        ("part.xyz", "part.xyz: the extension .xyz is unknown. Set the format with --to: native, "),
    ];
    for (name, problem) in endings {
        let said = bench.fails(2, &["convert", "part.toml", name]);
        assert!(said.contains(problem), "{said}");
    }
    assert!(
        bench.fails(2, &["convert", "part.toml", "part.stl", "--tolerance", "0"]).contains("tolerance is 0")
    );
    assert!(
        bench
            .fails(2, &["convert", "part.toml", "./part.toml", "--to", "stl"])
            .contains("would be overwritten")
    );
    assert_eq!(bench.read("part.toml"), PART);
    assert!(!bench.path("rod.stl").exists() && !bench.path("part.stl").exists());
}

#[test]
fn open_meshes_are_refused_with_position_and_count_or_repaired() {
    let bench = Bench::new();
    bench.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
    let refused = bench.fails(3, &["volume", "open.obj"]);
    assert!(refused.contains("3 edges belong to an odd number of triangles, the first at"), "{refused}");
    assert!(refused.contains("holes: 1") && refused.contains("--repair"), "{refused}");
    let mended = bench.run(&["info", "open.obj", "--repair", "--unit", "in"]);
    assert!(mended.err.contains("the mesh was repaired: 1 plane hole filled"), "{}", mended.err);
    assert!(mended.code == 0 && mended.out.contains("lengths in in"), "{}", mended.out);
}

#[test]
#[cfg(target_os = "linux")]
fn a_mesh_too_large_for_memory_is_refused_before_it_is_read() {
    let bench = Bench::new();
    // ten million triangles according to the header, in a sparse file
    let file = std::fs::File::create(bench.path("huge.stl")).unwrap();
    file.set_len(84 + 50 * 10_000_000).unwrap();
    let mut head = vec![b' '; 80];
    head.extend(10_000_000u32.to_le_bytes());
    std::os::unix::fs::FileExt::write_all_at(&file, &head, 0).unwrap();
    let command = format!("ulimit -v 1000000; exec '{}' info huge.stl", env!("CARGO_BIN_EXE_rayweave"));
    let output =
        std::process::Command::new("sh").current_dir(bench.path("")).args(["-c", &command]).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{errors}");
    assert!(
        errors.contains("10000000 triangles: the limit is") && errors.contains("not enough memory"),
        "{errors}"
    );
}
