//! Hashes of rendered pixels: colours, depths, normals, region ids.

use crate::files::{listed, stem};
use crate::hash::Hash;
use crate::{Answers, root};
use rayweave::picture::{Picture, PictureKind, PictureOptions, arrange};
use rayweave::render::{Run, Size};
use rayweave::scene::load;
use rayweave::{Compiled, Weave};

pub fn record(answers: &mut Answers) {
    for path in listed(&root().join("models"), "toml") {
        let (_, scene) = load(&path, &[]).unwrap();
        let compiled = Compiled::new(&scene).unwrap();
        let weave = Weave::new(compiled.program.clone());
        for (kind, name) in PictureKind::ALL {
            let options = PictureOptions {
                size: Some(Size::new(96, 72).unwrap()),
                shadows: Some(true),
                ..PictureOptions::default()
            };
            let (camera, settings) = arrange(&scene, &compiled, &options).unwrap();
            let picture = Picture::draw(kind, &weave, &camera, &settings, &mut Run::default()).unwrap();
            answers.add(&format!("picture/{}/{name}", stem(&path)), pixels(&picture));
        }
    }
}

fn pixels(picture: &Picture) -> Hash {
    let mut hash = Hash::new();
    match picture {
        Picture::Colour(image) => image.values().iter().for_each(|pixel| hash.bytes(pixel)),
        Picture::Depth(plane) => hash.numbers(plane.values()),
        Picture::Normal(plane) => hash.numbers(plane.values().iter().flatten()),
        Picture::Id(plane) => plane.values().iter().for_each(|id| hash.bytes(&id.to_le_bytes())),
    }
    hash
}
