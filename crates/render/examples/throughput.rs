//! How fast pictures are drawn: the biconvex lens at 1280 x 720, in rays per second.
//!
//! `cargo run --release -p rayweave-render --example throughput [THREADS]`

use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program, Solid};
use rayweave_render::{Camera, Lines, Rgba, Run, Settings, Size, Style, View, depth, render};
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::Weave;
use std::error::Error;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

fn shape(name: &str, arguments: &[(&str, f64)]) -> Result<Solid, Box<dyn Error>> {
    let value = |&(name, value)| (name, Value::Number(value));
    let arguments: Vec<_> = arguments.iter().map(value).collect();
    Ok(Solid::from(build(name, &arguments)?))
}

/// Two spheres give the faces, a cylinder the rim.
fn lens() -> Result<Solid, Box<dyn Error>> {
    let ball = shape("sphere", &[("radius", 50.0)])?;
    let rim = shape("cylinder", &[("radius", 12.5)])?;
    Ok(ball.translate([0.0, 0.0, 47.0]) & ball.translate([0.0, 0.0, -47.0]) & rim)
}

/// The shortest of some runs, in seconds.
fn shortest<T>(mut run: impl FnMut() -> T) -> f64 {
    let once = |_| {
        let start = Instant::now();
        std::hint::black_box(run());
        start.elapsed().as_secs_f64()
    };
    (0..5).map(once).fold(f64::INFINITY, f64::min)
}

fn main() -> Result<(), Box<dyn Error>> {
    let threads: Option<NonZeroUsize> = std::env::args().nth(1).map(|n| n.parse()).transpose()?;
    let size = Size::new(1280, 720)?;
    let weave = Weave::new(Arc::new(Program::compile(&lens()?)?));
    let camera: Camera = View::Iso.fit(weave.program(), size);
    let run = || Run { threads, ..Run::default() };
    let report = |what: &str, seconds: f64| {
        let rays = size.count() as f64 / seconds / 1e6;
        println!("{what:32} {:7.1} ms {rays:7.2} million pixels/s", 1e3 * seconds);
    };
    report("depth", shortest(|| depth(&weave, &camera, size, &mut run())));
    let plain = Settings { samples: 1, style: Style::Headlight, lines: None, ..Settings::new(size) };
    let shadowed = Settings {
        lights: vec![rayweave_render::Light::along(Vec3::new(-1.0, 2.0, -3.0))],
        shadows: true,
        ..plain.clone()
    };
    let lined = Settings { lines: Some(Lines::default()), ..plain.clone() };
    let glass =
        Settings { colours: vec![Rgba { alpha: 96, ..Rgba::opaque(91, 155, 245) }], ..Settings::new(size) };
    let cases = [
        ("headlight, 1 sample", plain),
        ("the same with shadows", shadowed),
        ("headlight, 1 sample, lines", lined),
        ("gooch, lines, 3 x 3 samples", Settings::new(size)),
        ("the same of clear glass", glass),
    ];
    for (what, settings) in cases {
        report(what, shortest(|| render(&weave, &camera, &settings, &mut run())));
    }
    Ok(())
}
