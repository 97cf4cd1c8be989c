//! Hashes of random models of the conformance suite, generic and with coincident faces.

use crate::hash::Hash;
use crate::{Answers, rays};
use rayweave_conformance::rays::{batch, rays as random_rays};
use rayweave_conformance::{Model, Random, Style};

/// Models per style.
const MODELS: u64 = 120;

/// Rays per model.
const RAYS: usize = 48;

pub fn record(answers: &mut Answers) {
    for (style, name) in [(Style::Generic, "generic"), (Style::Grid, "grid"), (Style::Planes, "planes")] {
        for seed in 0..MODELS {
            let mut random = Random::new(9_000_000 + seed);
            let model = if seed % 3 == 0 {
                Model::random(&mut random, style)
            } else {
                Model::small(&mut random, style)
            };
            let program = model.compile().unwrap();
            let own = random_rays(&mut random, style, &model.frame, RAYS);
            let mut hash = Hash::new();
            rays::answers(&mut hash, &program, batch(&own).rays());
            answers.add(&format!("random/{name}/{seed:03}"), hash);
        }
    }
}
