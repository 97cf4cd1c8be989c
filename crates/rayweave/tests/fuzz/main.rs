//! Fuzz targets (see `fuzz/README.md`), run on the corpus and on random inputs.

mod arrays;
mod bytes;
mod expression;
mod glass;
mod imported;
mod model_file;
mod photons;
mod trees;

use std::fs;
use std::path::Path;

/// Runs a target on all files of a folder; a panic names the file.
fn replay(folder: &str, run: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder);
    let mut files: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.is_file());
    files.sort();
    assert!(files.len() > 10, "{}: {} files", folder.display(), files.len());
    for file in files {
        eprintln!("{}", file.display());
        run(&fs::read(&file).unwrap());
    }
}

/// Collects the keys of all objects of a schema.
fn keys(schema: &serde_json::Value, found: &mut Vec<String>) {
    if let Some(properties) = schema.get("properties").and_then(|value| value.as_object()) {
        found.extend(properties.keys().cloned());
    }
    let (list, table) = (schema.as_array(), schema.as_object());
    list.into_iter().flatten().for_each(|inner| keys(inner, found));
    table.into_iter().flatten().for_each(|(_, inner)| keys(inner, found));
}

#[test]
fn the_dictionary_knows_every_key() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/model_file.dict");
    let dictionary = fs::read_to_string(path).unwrap();
    let mut found = Vec::new();
    keys(&rayweave::scene::schema(), &mut found);
    assert!(found.len() > 50);
    for key in found {
        assert!(dictionary.lines().any(|line| line == format!("\"{key}\"")), "{key}");
    }
}

#[test]
fn model_files() {
    replay("fuzz/corpus/model_file", model_file::run);
    replay("models", model_file::run);
}

#[test]
fn expressions() {
    replay("fuzz/corpus/expression", expression::run);
}

#[test]
fn files_of_rays_and_hit_arrays() {
    replay("fuzz/corpus/arrays", arrays::run);
}

#[test]
fn trees_of_solids() {
    replay("fuzz/corpus/trees", trees::run);
}

#[test]
fn catalogues_of_glasses() {
    replay("fuzz/corpus/glass", glass::run);
}

#[test]
fn gdml_files() {
    replay("fuzz/corpus/gdml", imported::gdml);
}

#[test]
fn openscad_dumps() {
    replay("fuzz/corpus/openscad", imported::openscad);
}

#[test]
fn drawings_in_dumps() {
    replay("fuzz/corpus/drawing", imported::drawing);
}

#[test]
fn meshes() {
    replay("fuzz/corpus/mesh", imported::mesh);
}

#[test]
fn photons_in_detectors() {
    replay("fuzz/corpus/photons", photons::run);
}

#[test]
fn lens_files() {
    replay("fuzz/corpus/zmx", imported::zmx);
    replay("models/optics", imported::zmx);
}
