//! Fuzz targets: bytes as a file of another program, read as a scene, compiled, queried, and written as a native
//! model file.

use crate::model_file::trace;
use rayweave::formats::{Format, Imported, Options, parse};
use rayweave::lens::prescription::{read_zmx, write_zmx};
use rayweave::mesh_io::{MeshFormat, ReadOptions, read_bytes};
use rayweave::scene::{self, Diagnostics};
use std::fs;

/// GDML.
pub fn gdml(data: &[u8]) {
    // no input that refers to other files
    let Some(text) = std::str::from_utf8(data).ok().filter(|text| !text.contains("file")) else { return };
    check(text, parse(text, Format::Gdml, &[], &Options::default()));
}

/// Dumps of OpenSCAD; the first byte selects round shapes or facets.
pub fn openscad(data: &[u8]) {
    let Some((&first, rest)) = data.split_first() else { return };
    let Some(text) = std::str::from_utf8(rest).ok().filter(|text| !text.contains("file")) else { return };
    check(
        text,
        parse(text, Format::OpenScad, &[], &Options { facets: first % 2 == 1, ..Options::default() }),
    );
}

/// Drawings that a dump of OpenSCAD imports; the first byte selects DXF or SVG, and round shapes or facets.
pub fn drawing(data: &[u8]) {
    let Some((&first, rest)) = data.split_first() else { return };
    let name = if first % 2 == 0 { "in.dxf" } else { "in.svg" };
    let folder = std::env::temp_dir().join(format!("rayweave-fuzz-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    fs::write(&path, rest).unwrap();
    let text = format!(
        "linear_extrude(height = 3) {{ import(file = {:?}, scale = 1); }}",
        path.display().to_string()
    );
    let options = Options { facets: first % 4 > 1, allow: vec![folder.clone()], ..Options::default() };
    check(&text, parse(&text, Format::OpenScad, &[], &options));
    fs::remove_dir_all(&folder).unwrap();
}

/// Meshes; the first byte selects the format and whether defects are repaired.
///
/// The property: a file is rejected with a reason, or its triangles have finite corners.
pub fn mesh(data: &[u8]) {
    let Some((&first, rest)) = data.split_first() else { return };
    let first = usize::from(first);
    let format = MeshFormat::ALL[first % MeshFormat::ALL.len()];
    match read_bytes(rest, format, &ReadOptions::default()) {
        Ok(loaded) => {
            for object in &loaded.objects {
                assert!(object.triangles.end <= loaded.mesh.triangles().len(), "{format:?}");
            }
            assert!(loaded.mesh.vertices().iter().all(|point| point.is_finite()), "{format:?}");
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    if let Ok(text) = std::str::from_utf8(rest) {
        let options = Options { repair: first / MeshFormat::ALL.len() % 2 == 1, ..Options::default() };
        check(text, parse(text, Format::Mesh(format), &[], &options));
    }
}

/// Lens files of Zemax.
///
/// The property: a file is rejected with a message, or, if it can be written, it can be read again.
pub fn zmx(data: &[u8]) {
    match read_zmx(data) {
        Ok(read) => {
            if let Ok(text) = write_zmx(&read.prescription) {
                read_zmx(text.as_bytes()).unwrap_or_else(|error| panic!("{text}\n{error}"));
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// The property of a model: it is rejected with reasons at positions in the file, or all evaluators return the same finite
/// results for it, and the native file written from it is read as the same regions.
fn check(text: &str, read: Result<Imported, Diagnostics>) {
    match read {
        Ok(imported) => {
            let written = imported.document().to_toml();
            let (_, again) =
                scene::parse(&written).unwrap_or_else(|problems| panic!("{written}\n{problems}"));
            let names = |scene: &scene::Scene| -> Vec<String> {
                scene.regions.iter().map(|region| region.name.clone()).collect()
            };
            assert_eq!(names(&again), names(&imported.scene), "{written}");
            trace(&imported.scene);
        }
        Err(problems) => {
            assert!(problems.has_errors());
            assert!(!problems.render(true).is_empty());
            for problem in problems.iter().filter(|problem| problem.path().is_none()) {
                let Some(span) = problem.span() else { continue };
                assert!(span.start() <= span.end() && span.end() <= text.len(), "{span:?}");
            }
        }
    }
}
