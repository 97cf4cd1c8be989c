//! Curves through the models: parabolas and helices.

use crate::files::{listed, stem};
use crate::hash::Hash;
use crate::{Answers, rays, root};
use rayweave::Compiled;
use rayweave::scene::load;
use rayweave::space::curve::{Helix, Parabola};
use rayweave::space::{Curve, trace_curve};

pub fn record(answers: &mut Answers) {
    for path in listed(&root().join("models"), "toml") {
        let (_, scene) = load(&path, &[]).unwrap();
        let program = Compiled::new(&scene).unwrap().program;
        let bounds = program.bounds();
        let batch = rays::through(&bounds, 4);
        let mut hash = Hash::new();
        for k in 0..batch.len() {
            let ray = batch.rays().get(k);
            let (from, along) = (ray.origin.to_array(), ray.direction.to_array());
            let parabola = Parabola::new(from, along, [0.5, 0.25, -2.0]);
            let helix = Helix::about(from, along, [from[0] + 1.5, from[1] + 0.5, from[2] + 0.25], 2.0);
            let mut follow = |curve: &dyn Curve<3>| match trace_curve(&program, curve, -4.0, 4.0) {
                Err(_) => hash.bytes(b"refused"),
                Ok(found) => {
                    hash.count(u64::from(found.start.0));
                    found
                        .crossings
                        .iter()
                        .for_each(|crossing| rays::add_crossing(&mut hash, &program, crossing));
                }
            };
            follow(&parabola);
            if let Ok(helix) = helix {
                follow(&helix);
            }
        }
        answers.add(&format!("curve/{}", stem(&path)), hash);
    }
}
