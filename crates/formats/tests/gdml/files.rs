//! GDML files from other programs, and files that include files.

use rayweave_conformance::skipped;
use rayweave_formats::{Imported, LossKind, Options, load};
use rayweave_model::Program;
use std::path::{Path, PathBuf};

fn read(path: &Path) -> Imported {
    load(path, None, &[], &Options::default())
        .unwrap_or_else(|problems| panic!("{}: {problems}", path.display()))
}

/// Files with their numbers of volumes placed in the world.
const FILES: [(&str, usize); 20] = [
    ("8x8SiPM_w_CSI_optial_grease.gdml", 7),
    ("cmse.gdml", 20),
    ("intersection-boxes.gdml", 2),
    ("multi-level.gdml", 4),
    ("opticks_raindrop_with_scintillation.gdml", 4),
    ("pfrich_min_FINAL.gdml", 8),
    ("raindrop.gdml", 4),
    ("sibling_pair.gdml", 4),
    ("simple-cms.gdml", 7),
    ("solids.gdml", 25),
    ("sphere_phicut_quarter_shell.gdml", 2),
    ("test_trap.gdml", 3),
    ("test_trd.gdml", 3),
    ("testem3.gdml", 5),
    ("three-spheres.gdml", 4),
    ("tilecal-plug.gdml", 3),
    ("transformed-box.gdml", 4),
    ("tube_phicut_quarter_shell.gdml", 2),
    ("wls_test.gdml", 3),
    ("znenv.gdml", 15),
];

/// Folder of real files, which are not part of the repository.
fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/gdml");
    if !folder.is_dir() {
        skipped(format!("GDML files from other programs are not at {}", folder.display()));
        return None;
    }
    Some(folder)
}

#[test]
fn files_of_others_are_read_and_compile() {
    let Some(folder) = folder() else {
        return;
    };
    for (name, regions) in FILES {
        let imported = read(&folder.join(name));
        assert_eq!(imported.report.count(LossKind::Refused), 0, "{name}: {}", imported.scene.warnings);
        assert_eq!(imported.scene.regions.len(), regions, "{name}");
        Program::compile_regions(&imported.scene.model_regions()).unwrap();
    }
}

/// A temporary folder for a test.
fn scratch(name: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("rayweave-gdml-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (file, text) in files {
        std::fs::write(folder.join(file), text).unwrap();
    }
    folder
}

const PART: &str = "<gdml><define/><solids><box name=\"b\" x=\"2\" y=\"2\" z=\"2\"/><box name=\"c\" x=\"1\" y=\"1\" z=\"1\"/></solids>\
    <structure><volume name=\"Inner\"><solidref ref=\"c\"/></volume>\
    <volume name=\"Part\"><solidref ref=\"b\"/><physvol><volumeref ref=\"Inner\"/></physvol></volume></structure>\
    <setup name=\"Default\" version=\"1.0\"><world ref=\"Part\"/></setup></gdml>";

fn outer(content: &str) -> String {
    format!(
        "<gdml><solids><box name=\"b\" x=\"20\" y=\"20\" z=\"20\"/></solids><structure><volume name=\"World\"><solidref ref=\"b\"/>\
        {content}</volume></structure><setup name=\"Default\" version=\"1.0\"><world ref=\"World\"/></setup></gdml>"
    )
}

#[test]
fn files_include_files_and_themselves_are_refused() {
    let twice = outer(
        "<physvol><file name=\"part.gdml\"/><position x=\"-5\"/></physvol><physvol><file name=\"part.gdml\"/><position x=\"5\"/>\
        </physvol><physvol><file name=\"part.gdml\" volname=\"Inner\"/><position y=\"7\"/></physvol>",
    );
    let ring = outer("<physvol><file name=\"ring.gdml\"/></physvol>");
    let folder = scratch("include", &[("part.gdml", PART), ("main.gdml", &twice), ("ring.gdml", &ring)]);
    let imported = read(&folder.join("main.gdml"));
    let names: Vec<&str> = imported.scene.regions.iter().map(|region| region.name.as_str()).collect();
    // a volume requested by name is read once more, as in Geant4
    assert_eq!(names, ["World", "Part", "Inner", "Inner2"]);
    let problems = load(folder.join("ring.gdml"), None, &[], &Options::default()).unwrap_err();
    assert!(problems.iter().next().unwrap().message().contains("includes itself"), "{problems}");
    std::fs::remove_dir_all(folder).unwrap();
}

/// A chain of different files is not a file that includes itself.
#[test]
fn files_may_be_included_only_so_deep() {
    let names: Vec<String> = (0..25).map(|k| format!("f{k}.gdml")).collect();
    let texts: Vec<String> =
        (1..=25).map(|k| outer(&format!("<physvol><file name=\"f{k}.gdml\"/></physvol>"))).collect();
    let mut files: Vec<(&str, &str)> =
        names.iter().map(String::as_str).zip(texts.iter().map(String::as_str)).collect();
    files[24].1 = PART;
    let folder = scratch("deep", &files);
    assert_eq!(read(&folder.join("f10.gdml")).scene.regions.len(), 16);
    let problems = load(folder.join("f0.gdml"), None, &[], &Options::default()).unwrap_err();
    let message = problems.iter().next().unwrap().message();
    assert!(message.contains("is included too deeply: at most 20 files"), "{problems}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn entities_may_be_files() {
    let text = "<!DOCTYPE gdml [\n<!ENTITY solids SYSTEM \"solids.xml\">\n<!ENTITY size \"20\">\n]>\n"
        .to_owned()
        + &outer("")
            .replace("<solids><box name=\"b\" x=\"20\"", "<solids>&solids;<box name=\"b\" x=\"&size;\"");
    let folder = scratch(
        "entity",
        &[("main.gdml", &text), ("solids.xml", "<box name=\"a\" x=\"1\" y=\"1\"\n z=\"1\"/>")],
    );
    assert_eq!(read(&folder.join("main.gdml")).scene.regions.len(), 1);
    // a problem in an included file is reported with its position there
    std::fs::write(folder.join("solids.xml"), "<box name=\"a\" x=\"1\" y=\"1\"\n z=\"one\"/>").unwrap();
    let problems = load(folder.join("main.gdml"), None, &[], &Options::default()).unwrap_err();
    let problem = problems.iter().next().unwrap();
    assert_eq!(problem.line_column(), Some((2, 5)));
    assert!(problem.path().unwrap().ends_with("solids.xml"));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn latin_1_is_read_where_it_is_declared() {
    let text = outer("").replace("World", "W\u{e4}lt");
    let declared = format!("<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>{text}");
    let latin: Vec<u8> = declared.chars().map(|c| c as u32 as u8).collect();
    let folder = scratch("latin", &[]);
    let path = folder.join("main.gdml");
    std::fs::write(&path, &latin).unwrap();
    assert_eq!(read(&path).scene.regions[0].name, "W\u{e4}lt");
    std::fs::write(&path, &latin[declared.find('>').unwrap() + 1..]).unwrap();
    let problems = load(&path, None, &[], &Options::default()).unwrap_err();
    assert!(problems.to_string().contains("UTF-8"));
    std::fs::remove_dir_all(folder).unwrap();
}
