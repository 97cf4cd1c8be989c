//! Comparison with POV-Ray: rays per second and similarity of the pictures.
//!
//! `cargo run --release -p rayweave-render --example povray -- [WIDTHxHEIGHT] [RUNS] [FOLDER] [SCENE ...]`
//!
//! Without arguments the pictures are small and drawn once, as a check; published figures use `1280x720 5`.
//!
//! Both trace one ray through the centre of each pixel and, from each surface that faces the light, one ray
//! to the light; both use one thread. Every pixel counts as a ray, background included. The time is that of
//! tracing and shading alone, without starting, reading, compiling and writing, in processor seconds:
//! POV-Ray's own figure, and here the CPU time of the thread during the rendering call (wall-clock time where
//! the system does not report it). The two run alternately, and the shortest run is reported. POV-Ray runs
//! with its hierarchy of slabs and with its binary space partition, and the faster one is reported.

mod peer;
mod scenes;
mod similarity;

use peer::Peer;
use rayweave::picture::{PictureOptions, arrange};
use rayweave::render::{Image, RenderOptions, Run, Size, png, render};
use rayweave::{Compiled, scene};
use scenes::Comparison;
use std::error::Error;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Instant;

/// The command-line arguments.
struct Wish {
    size: Size,
    runs: usize,
    folder: PathBuf,
    only: Vec<String>,
}

impl Wish {
    fn from_arguments() -> Result<Wish, Box<dyn Error>> {
        let mut arguments = std::env::args().skip(1);
        let size = arguments.next().unwrap_or("160x90".to_owned());
        let (width, height) = size.split_once('x').ok_or("a size is WIDTHxHEIGHT")?;
        let size = Size::new(width.parse()?, height.parse()?)?;
        let runs = arguments.next().map_or(Ok(1), |runs| runs.parse())?;
        let folder = arguments.next().map_or_else(std::env::temp_dir, PathBuf::from);
        Ok(Wish { size, runs, folder, only: arguments.collect() })
    }

    fn includes(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|own| own == name)
    }
}

/// A row of the table.
struct Line {
    name: String,
    /// Rays per second.
    peer: f64,
    own: f64,
    similarity: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let wish = Wish::from_arguments()?;
    if std::process::Command::new("povray").arg("--version").output().is_err() {
        println!("POV-Ray is missing (on Debian: apt-get install povray); there is nothing to compare with");
        return Ok(());
    }
    println!("| scene | POV-Ray, Mray/s | Rayweave, Mray/s | ratio | similarity |");
    println!("| --- | --- | --- | --- | --- |");
    let mut ratios = Vec::new();
    for comparison in scenes::all() {
        if wish.includes(&comparison.name) {
            let line = compare(&comparison, &wish)?;
            let ratio = line.own / line.peer;
            println!(
                "| {} | {:.3} | {:.2} | {ratio:.1} | {:.4} |",
                line.name,
                1e-6 * line.peer,
                1e-6 * line.own,
                line.similarity
            );
            ratios.push(ratio);
        }
    }
    let mean = (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp();
    println!("\ngeometric mean of the ratios: {mean:.1}");
    Ok(())
}

/// Renders one scene alternately with both programs.
fn compare(comparison: &Comparison, wish: &Wish) -> Result<Line, Box<dyn Error>> {
    let mut scene = comparison.scene.clone();
    let compiled = Compiled::new(&scene)?;
    let evaluator = rayweave::trace::Packets::new(compiled.program.clone());
    let options =
        PictureOptions { size: Some(wish.size), field_of_view: Some(30.0), ..PictureOptions::default() };
    let (camera, _) = arrange(&scene, &compiled, &options)?;
    let (width, height) = (wish.size.width() as u32, wish.size.height() as u32);
    scene.camera = Some(scene::Camera {
        projection: scene::Projection::Perspective { fov: 30.0 },
        position: camera.position(),
        target: camera.position() + camera.forward(),
        up: camera.up(),
        size: Some((width, height)),
    });
    scene.lights = vec![comparison.light(&camera)];
    let (camera, settings) = arrange(&scene, &compiled, &PictureOptions::default())?;
    let peer = Peer::new(&scene.to_povray()?.text, &wish.folder, &comparison.name, wish.size)?;
    let (mut best_peer, mut best_own, mut image) = (f64::INFINITY, f64::INFINITY, None);
    for _ in 0..wish.runs {
        best_peer = best_peer.min(peer.draw()?);
        let (seconds, drawn) = draw(&evaluator, &camera, &settings)?;
        best_own = best_own.min(seconds);
        image = Some(drawn);
    }
    let image = image.ok_or("at least one run is needed")?;
    std::fs::write(wish.folder.join(format!("{}-rayweave.png", comparison.name)), png::encode(&image))?;
    let rays = wish.size.count() as f64;
    Ok(Line {
        name: comparison.name.clone(),
        peer: rays / best_peer,
        own: rays / best_own,
        similarity: similarity::structural(&image, &peer.picture()?),
    })
}

/// A clock for the processor time of this thread.
struct Clock {
    wall: Instant,
    thread: Option<u64>,
}

impl Clock {
    fn start() -> Clock {
        Clock { wall: Instant::now(), thread: thread_nanoseconds() }
    }

    fn seconds(&self) -> f64 {
        match (self.thread, thread_nanoseconds()) {
            (Some(start), Some(end)) => 1e-9 * (end - start) as f64,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// The CPU time of this thread in nanoseconds, reported by Linux.
fn thread_nanoseconds() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

/// The shortest of several renderings, in seconds, and the picture.
fn draw(
    evaluator: &impl rayweave::Evaluator,
    camera: &rayweave::render::Camera,
    settings: &RenderOptions,
) -> Result<(f64, Image), Box<dyn Error>> {
    let mut best = f64::INFINITY;
    let mut image = None;
    for _ in 0..3 {
        let mut run = Run { threads: Some(NonZeroUsize::MIN), ..Run::default() };
        let clock = Clock::start();
        let drawn = render(evaluator, camera, settings, &mut run)?;
        best = best.min(clock.seconds());
        image = Some(drawn);
    }
    Ok((best, image.ok_or("nothing was drawn")?))
}
