//! Examples of OpenSCAD, against OpenSCAD's own results; skipped if the files are missing.

use crate::folder::Folder;
use crate::measure::volume;
use rayweave_conformance::skipped;
use rayweave_formats::{LossKind, Options, load};
use std::path::{Path, PathBuf};

/// Example, and the volume of the STL export of OpenSCAD 2021.01 (Debian 12) from the same dump; for plane examples the
/// area.
const VOLUMES: [(&str, f64); 22] = [
    ("CSG-modules", 3346.9065),
    ("LetterBlock", 11528.998),
    ("assert", 12375.9952),
    ("children", 12739.628),
    ("difference_cube", 2284.3854),
    ("example002", 12241.7321),
    ("example004", 2284.3854),
    ("example012", 32902.8816),
    ("example014", 5936.7648),
    ("example016", 10244.0),
    ("example018", 2573423.2277),
    ("example020", 915860.3783),
    ("example022", 45145.3991),
    ("example024", 203221.6422),
    ("hull", 8568.7068),
    ("linear_extrude", 12738.3007),
    ("logo", 18686.2167),
    ("polygon_areas", 1545.2409),
    ("recursion", 141.4282),
    ("rotate_extrude", 7724.9057),
    ("text_on_cube", 220008.705),
    ("union", 23750.0),
];

/// Relative tolerance: hinting changes the area of the letters of `recursion` by 4e-4; the rest is sampling error.
const NEAR: f64 = 1e-3;

/// Examples that refer to missing files, with the number of items refused for that reason.
const WITHOUT_FILES: [(&str, usize); 5] =
    [("example008", 5), ("example010", 2), ("example012", 1), ("example016", 4), ("surface", 2)];

/// Font of the reference volumes, as files and as the name that replaces the one in the dumps, since substitutes differ
/// between machines.
const FONTS: [&str; 2] = [
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf",
];
const FONT: &str = r#"font = "DejaVu Sans"#;

fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/openscad");
    if folder.is_dir() {
        return Some(folder);
    }
    skipped(format!("OpenSCAD's examples are not at {}", folder.display()));
    None
}

#[test]
fn volumes_are_those_of_openscad() {
    let Some(folder) = folder() else { return };
    let options = Options { facets: true, ..Options::default() };
    let dumps = Folder::new("volumes");
    for (name, expected) in VOLUMES {
        let dump = std::fs::read_to_string(folder.join(format!("{name}.csg"))).expect("a dump");
        let missing = FONTS.iter().find(|font| !Path::new(font).is_file());
        if let (true, Some(missing)) = (dump.contains("text("), missing) {
            skipped(format!("{name} needs {missing} (Debian: fonts-dejavu-core)"));
            continue;
        }
        let dump =
            dump.replace(r#"font = "Liberation Sans"#, FONT).replace(r#"font = """#, &format!("{FONT}\""));
        let read = dumps.read_with(&dump, &options);
        let found = volume(&read.scene, 300);
        assert!((found / expected - 1.0).abs() < NEAR, "{name}: {found} instead of {expected}");
    }
}

#[test]
fn only_missing_files_are_refused() {
    let Some(folder) = folder() else { return };
    let files = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut dumps = 0;
    for path in files.filter(|path| path.extension().is_some_and(|ending| ending == "csg")) {
        dumps += 1;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let read = load(&path, None, &[], &Options::default()).expect("it is a dump");
        let allowed = WITHOUT_FILES.iter().find(|(other, _)| *other == name).map_or(0, |(_, count)| *count);
        assert_eq!(read.report.count(LossKind::Refused), allowed, "{name}: {}", read.report.warnings());
        let refused = read.report.iter().filter(|loss| loss.kind == LossKind::Refused);
        assert!(refused.clone().all(|loss| loss.first.message().contains("there is no file")), "{name}");
    }
    assert_eq!(dumps, 27);
}
