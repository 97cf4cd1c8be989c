//! Light in media with a gradient, against closed forms.

#[path = "../common/mod.rs"]
mod common;
mod eye;
mod laws;
mod picture;
mod profiles;

use common::{D_NM, ball, block, near, plane, trace};
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_optics::gradient::Gradient;
use rayweave_optics::{Beam, Light, Medium, Segment, System, TraceSettings};

/// A rod along z from 0 to its length.
fn rod(radius: f64, length: f64) -> Solid {
    common::rod(radius, length).translate(Vec3::Z * (length / 2.0))
}

fn graded(index: f64, gradient: Gradient) -> Medium {
    Medium::constant("graded", index, 0.0).unwrap().graded(gradient)
}

/// The rows of one ray.
fn one(system: &System, light: Light) -> Vec<Segment> {
    trace(system, &Beam::from_iter([light]), &TraceSettings::default()).segments.iter().collect()
}

fn close(found: Vec3, expected: Vec3, tolerance: f64) {
    assert!((found - expected).length() <= tolerance, "{found} is not {expected}");
}

/// Directions all over the sphere (Fibonacci's lattice).
fn directions(count: usize) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
        let (s, c) = (2.399_963_229_728_653 * k as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * c, r * s, z)
    })
}
