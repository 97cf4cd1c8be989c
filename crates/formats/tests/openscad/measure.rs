//! Volumes of imported models, measured with rays.

use rayweave_formats::{Format, Imported, LossKind, Options, parse};
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program, Query, RayBatch};
use rayweave_scene::Scene;
use rayweave_shape::Ray;
use rayweave_trace::Packets;
use std::sync::Arc;

/// Reads a text that must be a dump.
pub fn read(text: &str, facets: bool) -> Imported {
    let options = Options { facets, ..Options::default() };
    parse(text, Format::OpenScad, &[], &options).unwrap_or_else(|problems| {
        let start: String = text.chars().take(200).collect();
        panic!("{start}\n{problems}")
    })
}

/// Reads a text without losses.
pub fn whole(text: &str, facets: bool) -> Scene {
    let imported = read(text, facets);
    assert!(imported.report.is_empty(), "{text}\n{}", imported.report.warnings());
    imported.scene
}

/// Number of losses of a kind, and all messages.
pub fn losses(text: &str, kind: LossKind) -> (usize, String) {
    let report = read(text, false).report;
    (report.count(kind), report.warnings().to_string())
}

/// Volume of all regions together, by `side`^2 rays along a skew axis through the points of a Fibonacci lattice
/// (Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, 1992, section 5). Rows of a square grid would be
/// parallel to the strokes of letters. The axis is skew so that no face of a typical model is parallel to it.
pub fn volume(scene: &Scene, side: usize) -> f64 {
    let program = Arc::new(Program::compile_regions(&scene.model_regions()).expect("the solids compile"));
    let bounds = program.bounds();
    if bounds.is_empty() {
        return 0.0;
    }
    let (centre, half) = (0.5 * (bounds.lo + bounds.hi), 0.5 * (bounds.hi - bounds.lo));
    assert!(half.length().is_finite(), "{bounds:?}");
    let w = Vec3::new(0.131, 0.277, 1.0).normalize();
    let u = w.cross(Vec3::X).normalize();
    let v = w.cross(u);
    // the projection of the box lies within a rectangle
    let (wide, high) = (half.dot(u.abs()), half.dot(v.abs()));
    let at = |part: f64| 2.0 * part - 1.0;
    let (count, golden) = ((side * side) as f64, (5.0_f64.sqrt() - 1.0) / 2.0);
    let evaluator = Packets::new(program);
    let mut length = 0.0;
    for row in 0..side {
        let mut batch = RayBatch::default();
        for k in row * side..(row + 1) * side {
            let k = k as f64 + 0.5;
            batch.push(Ray::new(centre + wide * at(k / count) * u + high * at((k * golden).fract()) * v, w));
        }
        let answers = evaluator.collect(batch.rays(), &Query::default()).expect("the rays are fine");
        for ray in 0..side {
            for crossing in answers.of(ray) {
                if crossing.before.index() == 0 {
                    length -= crossing.t;
                }
                if crossing.after.index() == 0 {
                    length += crossing.t;
                }
            }
        }
    }
    length * 4.0 * wide * high / count
}

/// Compares the volume of a dump with the expected one, with a relative tolerance.
pub fn check_volume(text: &str, facets: bool, expected: f64, tolerance: f64) {
    let found = volume(&whole(text, facets), 300);
    assert!((found - expected).abs() <= tolerance * expected, "{text}: {found} instead of {expected}");
}
