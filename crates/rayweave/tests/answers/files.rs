//! Hashes of the models imported from `models/` and `../shared/data`, by every reader.

use crate::hash::Hash;
use crate::{Answers, rays, root};
use rayweave::Compiled;
use rayweave::formats::{self, Options};
use std::fs;
use std::path::{Path, PathBuf};

/// Rays per model.
const RAYS: usize = 64;

/// Files that take too long to compile in the test profile, or have tests of their own.
const LEFT_OUT: [&str; 2] = ["cmse.gdml", "tilecal-plug.gdml"];

/// The folder of files shared between projects, if it exists.
pub fn shared() -> Option<PathBuf> {
    let folder = root().join("../shared/data");
    folder.is_dir().then_some(folder)
}

pub fn record(answers: &mut Answers, shared: Option<&Path>) {
    for path in listed(&root().join("models"), "toml") {
        one(answers, "file/models", &path, &Options::default());
    }
    for path in listed(&root().join("models/optics"), "toml") {
        one(answers, "file/optics", &path, &Options::default());
    }
    let Some(shared) = shared else { return };
    let facets = Options { facets: true, ..Options::default() };
    for path in listed(&shared.join("gdml"), "gdml") {
        one(answers, "file/shared/gdml", &path, &Options::default());
    }
    for path in listed(&shared.join("openscad"), "csg") {
        one(answers, "file/shared/openscad", &path, &Options::default());
        one(answers, "file/shared/facets", &path, &facets);
    }
}

/// The files of a folder with an extension, sorted, without those of [`LEFT_OUT`].
pub fn listed(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let files = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let is_wanted = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default();
        path.extension().is_some_and(|own| own == ending) && !LEFT_OUT.iter().any(|out| *out == name)
    };
    let mut files: Vec<PathBuf> = files.filter(is_wanted).collect();
    files.sort();
    files
}

/// The name of a file without folder and extension.
pub fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn one(answers: &mut Answers, group: &str, path: &Path, options: &Options) {
    let name = format!("{group}/{}", stem(path));
    let mut hash = Hash::new();
    match formats::load(path, None, &[], options) {
        // rejected files are recorded as such; the message may change
        Err(_) => hash.bytes(b"refused"),
        Ok(imported) => {
            let scene = &imported.scene;
            hash.count(scene.regions.len() as u64);
            for region in &scene.regions {
                hash.count(u64::from(region.medium));
                hash.bytes(&[
                    region.colour.red,
                    region.colour.green,
                    region.colour.blue,
                    region.colour.alpha,
                ]);
            }
            for medium in &scene.media {
                medium.numbers.iter().for_each(|(_, value)| hash.number(*value));
            }
            hash.number(scene.unit.metres());
            let compiled = Compiled::new(scene).unwrap();
            let batch = rays::through(&compiled.program.bounds(), RAYS);
            rays::answers(&mut hash, &compiled.program, batch.rays());
        }
    }
    answers.add(&name, hash);
}
