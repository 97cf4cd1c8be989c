//! The models of the repository are read without warnings, and round-trip.

use rayweave_scene::{Document, Scene, load, parse};
use rayweave_shape::primitive::MANUALS;
use std::path::{Path, PathBuf};

fn models() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut models: Vec<PathBuf> =
        files.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    models.sort();
    models
}

fn read(path: &Path) -> (Document, Scene) {
    load(path, &[]).unwrap_or_else(|problems| panic!("{problems}"))
}

#[test]
fn every_model_is_read_without_a_word() {
    let models = models();
    assert!(models.len() >= 12, "{}", models.len());
    for path in models {
        let (document, scene) = read(&path);
        assert!(scene.warnings.is_empty(), "{}", scene.warnings);
        assert_eq!(document.heading.len(), 1, "{}", path.display());
        assert!(scene.camera.is_some() && !scene.lights.is_empty() && !scene.regions.is_empty());
    }
}

#[test]
fn every_model_survives() {
    for path in models() {
        let (document, scene) = read(&path);
        let (again, scene_again) = parse(&document.to_toml()).unwrap();
        assert_eq!((again, scene_again), (document, scene.clone()), "{}", path.display());
        let (_, rebuilt) = parse(&Document::from_scene(&scene).to_toml()).unwrap();
        assert_eq!(rebuilt.regions, scene.regions, "{}", path.display());
        assert_eq!(rebuilt.media, scene.media, "{}", path.display());
    }
}

#[test]
fn the_gallery_shows_every_shape() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/gallery.toml");
    let (_, scene) = read(&path);
    let shown: Vec<&str> = scene.regions.iter().map(|region| region.name.as_str()).collect();
    // all shapes except meshes, whose shape is arbitrary
    let shapes = MANUALS.iter().map(|manual| manual.name).filter(|name| *name != "mesh");
    assert_eq!(shown, shapes.collect::<Vec<_>>());
}
