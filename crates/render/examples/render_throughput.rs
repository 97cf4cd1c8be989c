//! Rendering throughput in pixels per second: a die and the biconvex lens at 1280 x 720.
//!
//! `cargo run --release -p rayweave-render --example render_throughput [THREADS]`

use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program, Solid};
use rayweave_render::{
    Camera, IdKind, Light, Lines, RenderOptions, Rgba, Run, Size, Style, View, depth, geometry, render,
};
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::Packets;
use std::error::Error;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

fn shape(name: &str, arguments: &[(&str, f64)]) -> Result<Solid, Box<dyn Error>> {
    let value = |&(name, value)| (name, Value::Number(value));
    let arguments: Vec<_> = arguments.iter().map(value).collect();
    Ok(Solid::from(build(name, &arguments)?))
}

/// A biconvex lens: two spheres for the faces, a cylinder for the rim.
fn lens() -> Result<Solid, Box<dyn Error>> {
    let ball = shape("sphere", &[("radius", 50.0)])?;
    let rim = shape("cylinder", &[("radius", 12.5)])?;
    Ok(ball.translate([0.0, 0.0, 47.0]) & ball.translate([0.0, 0.0, -47.0]) & rim)
}

/// The shortest of several runs, in seconds.
fn shortest<T>(mut run: impl FnMut() -> T) -> f64 {
    let once = |_| {
        let start = Instant::now();
        std::hint::black_box(run());
        start.elapsed().as_secs_f64()
    };
    (0..5).map(once).fold(f64::INFINITY, f64::min)
}

/// A rounded cube with three bores.
fn die() -> Result<Solid, Box<dyn Error>> {
    let cube = Solid::from(build("box", &[("size", Value::Number(2.0))])?);
    let bore = shape("cylinder", &[("radius", 0.5), ("height", 4.0)])?;
    let ball = shape("sphere", &[("radius", 1.35)])?;
    Ok((cube & ball) - &bore - bore.rotate_x(90.0) - bore.rotate_y(90.0))
}

fn main() -> Result<(), Box<dyn Error>> {
    let threads: Option<NonZeroUsize> = std::env::args().nth(1).map(|n| n.parse()).transpose()?;
    let size = Size::new(1280, 720)?;
    for (name, solid) in [("die", die()?), ("lens", lens()?)] {
        println!("{name}");
        let packets = Packets::new(Arc::new(Program::compile(&solid)?));
        let camera: Camera = View::Iso.fit(packets.program(), size);
        let run = || Run { threads, ..Run::default() };
        let report = |what: &str, seconds: f64| {
            let pixels = size.count() as f64 / seconds / 1e6;
            println!("  {what:36} {:7.2} ms {pixels:7.2} million pixels/s", 1e3 * seconds);
        };
        report("depth", shortest(|| depth(&packets, &camera, size, &mut run())));
        let all = || geometry(&packets, &camera, size, IdKind::Region, &mut run());
        report("depth, normals and ids", shortest(all));
        for (what, settings) in cases(size) {
            report(what, shortest(|| render(&packets, &camera, &settings, &mut run())));
        }
    }
    Ok(())
}

fn cases(size: Size) -> [(&'static str, RenderOptions); 6] {
    let plain =
        RenderOptions { samples: 1, style: Style::Headlight, lines: None, ..RenderOptions::new(size) };
    let sun = Light::along(Vec3::new(-1.0, 2.0, -3.0));
    let shadowed = RenderOptions { lights: vec![sun], shadows: true, ..plain.clone() };
    let lamp = Light::at(Vec3::new(100.0, -200.0, 300.0));
    let lit = RenderOptions { lights: vec![lamp], ..shadowed.clone() };
    let lined = RenderOptions { lines: Some(Lines::default()), ..plain.clone() };
    let clear = Rgba { alpha: 96, ..Rgba::opaque(91, 155, 245) };
    let glass = RenderOptions { colours: vec![clear], ..RenderOptions::new(size) };
    [
        ("headlight, 1 sample", plain),
        ("shadows of a directional light", shadowed),
        ("shadows of a point light", lit),
        ("headlight, 1 sample, lines", lined),
        ("gooch, lines, 3 x 3 samples", RenderOptions::new(size)),
        ("the same with clear glass", glass),
    ]
}
