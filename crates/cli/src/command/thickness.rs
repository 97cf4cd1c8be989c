//! `rayweave thickness`: path lengths through each medium, as a picture or a table.

use crate::arguments::{GlobalArguments, ModelArguments, PartArguments, SubjectArguments, debug_hash};
use crate::command::render::size;
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal::{self, Unit};
use clap::Args;
use clap::builder::PossibleValuesParser;
use rayweave::picture::{PictureOptions, arrange};
use rayweave::render::{PixelGrid, RenderOptions, Size, View, png};
use rayweave::scene::Scene;
use rayweave::table::{Part, TableWriter};
use rayweave::thickness::{FAINTEST, ThicknessMap, ThicknessRun, check_attenuations};
use rayweave::{AnyEvaluator, Compiled, Ray, Vec3};
use std::path::{Path, PathBuf};

/// Measure path lengths through each medium: a radiograph, or a table
///
/// One ray per pixel runs through its centre and through the whole model. A .png file shows the transmitted fraction of X-rays,
/// computed from `attenuation` (per length) in the tables of the media. If no medium has an attenuation, it is proportional to
/// `density`, or else equal in all media, and scaled such that 5 % pass through the most absorbing pixel. Other files are tables of
/// path lengths, one column per medium; the column of the world counts the length between a ray's first and last crossing.
/// If little is transmitted, --line-integral shows more: the attenuation times the length, black in empty space.
#[derive(Args)]
pub struct Thickness {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    subject: SubjectArguments,

    /// Radiograph, .png, or table: .csv, .npy or .parquet (if built in)
    #[arg(short, long, value_name = "OUT")]
    out: PathBuf,

    /// Show the path length through this medium, white where it is longest
    #[arg(long, value_name = "NAME")]
    medium: Option<String>,

    /// Show the line integral of the attenuation, -ln of the transmitted fraction, white where it is largest
    #[arg(long, conflicts_with = "medium")]
    line_integral: bool,

    /// Width and height in pixels [default: as in the model's camera, else 1280x720]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<Size>,

    /// View the whole model from this side, along parallel rays [default: the camera of the model]
    #[arg(long, value_parser = PossibleValuesParser::new(View::ALL.map(View::name)))]
    view: Option<String>,

    #[command(flatten)]
    part: PartArguments,
}

impl Thickness {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let is_picture = self.out.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        if !is_picture && (self.medium.is_some() || self.line_integral) {
            let option = if self.line_integral { "--line-integral" } else { "--medium" };
            let text = format!(
                "{option} selects what a picture shows, but a table lists all media. Write a .png file."
            );
            return Err(Failure::Usage(text));
        }
        if is_picture && self.part.range.is_some() {
            let text =
                "--range writes a part of the table; the grey levels of a picture depend on all pixels.";
            return Err(Failure::Usage(text.to_owned()));
        }
        let scene = self.model.load_for(self.subject.solid.as_deref())?;
        let compiled = Compiled::named(&scene, self.subject.solid.as_deref())?;
        if is_picture && self.medium.is_none() {
            let remarks = check_attenuations(&scene)?;
            remarks.iter().filter(|_| !global.quiet).for_each(|remark| terminal::note(remark));
        }
        let evaluator = AnyEvaluator::new(self.subject.evaluator.as_deref(), compiled.program.clone())?;
        let view = self.view.as_deref().and_then(|name| name.parse().ok());
        let options = PictureOptions { size: self.size, view, ..PictureOptions::default() };
        let (camera, RenderOptions { size, .. }) = arrange(&scene, &compiled, &options)?;
        let part = self.part(&scene, size, debug_hash(&camera))?;
        if self.part.is_done(part.iter().map(|part| (self.out.as_path(), part)), global.quiet) {
            return Ok(());
        }
        let rows =
            part.as_ref().map_or(0..size.height(), |part| part.range.start as usize..part.range.end as usize);
        let bar =
            terminal::progress_bar(Some((size.width() * rows.len()) as u64), Unit::Percent, global.quiet);
        let mut progress = |done: usize| bar.set_position(done as u64);
        let mut run = ThicknessRun {
            threads: global.threads,
            cancel: interrupt::token(),
            progress: Some(&mut progress),
            ..ThicknessRun::default()
        };
        let ray = |x: usize, y: usize| camera.ray(size, x as f64 + 0.5, y as f64 + 0.5);
        let map = ThicknessMap::of_rows(&compiled, &evaluator, size.width(), rows, ray, &mut run);
        bar.finish_and_clear();
        let map = map?;
        let note = match is_picture {
            true => self.draw(&scene, &map, size)?,
            false => {
                map.write_part(&self.out, scene.unit.symbol(), part.as_ref())?;
                let count = map.path_lengths().len();
                let grid = parallel_rays(size, ray);
                format!("path lengths of {count} rays{}", grid.unwrap_or_default())
            }
        };
        match global.quiet || self.out == Path::new("-") {
            true => Ok(()),
            false => terminal::print(&format!("{}: {note}\n", self.out.display())),
        }
    }

    /// The part to compute, rows of pixels, if a range is given.
    fn part(&self, scene: &Scene, size: Size, camera: String) -> Result<Option<Part>, Failure> {
        let Some(range) = &self.part.range else { return Ok(None) };
        TableWriter::check_part(&self.out)?;
        let height = size.height() as u64;
        if range.end > height {
            let text = format!("--range ends at {}: the picture has {height} rows of pixels.", range.end);
            return Err(Failure::Usage(text));
        }
        let settings = [
            ("model", scene.content_hash()),
            ("solid", self.subject.solid.clone().unwrap_or_default()),
            ("camera", camera),
            ("width", size.width().to_string()),
        ];
        Ok(self.part.part("thickness", settings, height))
    }

    /// Writes the picture and prints the meaning of its grey levels.
    fn draw(&self, scene: &Scene, map: &ThicknessMap, size: Size) -> Result<String, Failure> {
        let unit = scene.unit.symbol();
        let save = |pixels: Vec<f64>, white: f64| {
            // a map has a value for each pixel
            let plane = PixelGrid::from_values(size, pixels).unwrap_or_else(|| PixelGrid::filled(size, 0.0));
            terminal::save(&self.out, &png::encode_grey(&plane, white))
        };
        if let Some(medium) = &self.medium {
            let lengths = map.of_medium(medium)?;
            let longest = longest(&lengths);
            save(lengths, longest)?;
            return Ok(format!("white is {} {unit} of {medium}", terminal::short(longest)));
        }
        let is_given = |key| scene.media.iter().any(|medium| medium.number(key).is_some());
        let white = if self.line_integral {
            let integrals = map.line_integrals(scene);
            let largest = longest(&integrals);
            save(integrals, largest)?;
            format!("white is a line integral of {}", terminal::short(largest))
        } else {
            let transmissions = map.radiograph(scene);
            let least = transmissions.iter().copied().filter(|part| part.is_finite()).fold(1.0, f64::min);
            save(transmissions, 1.0)?;
            match is_given("attenuation") && least < BLACK {
                true => format!(
                    "white is full transmission; the darkest pixel transmits {}, which is black here. --line-integral shows such parts",
                    terminal::short(least)
                ),
                false => "white is full transmission".to_owned(),
            }
        };
        if is_given("attenuation") {
            return Ok(white);
        }
        let percent = terminal::short(100.0 * FAINTEST);
        let by = if is_given("density") { "proportional to the density" } else { "equal in all media" };
        Ok(format!(
            "{white}, the darkest pixel {percent} %: no medium has an attenuation, so it is taken as {by}."
        ))
    }
}

/// The places of parallel rays in space, in words; `None` in perspective.
fn parallel_rays(size: Size, ray: impl Fn(usize, usize) -> Ray) -> Option<String> {
    let (first, last) = (ray(0, 0), ray(size.width() - 1, size.height() - 1));
    let (next, below) = (ray(size.width().min(2) - 1, 0), ray(0, size.height().min(2) - 1));
    let point = |p: Vec3| terminal::short_point(p.to_array().map(|x| terminal::rounded(x, 6)));
    (first.direction == last.direction).then(|| {
        let (start, direction) = (first.origin, point(first.direction));
        let (x, y) = (point(next.origin - start), point(below.origin - start));
        let start = point(start);
        format!(" along {direction}: the ray of column x and row y starts at {start} + x {x} + y {y}")
    })
}

/// The transmission below which a pixel looks black.
const BLACK: f64 = 1.0 / 256.0;

/// The longest finite path; 1 if there is none.
fn longest(lengths: &[f64]) -> f64 {
    let longest = lengths.iter().copied().filter(|length| length.is_finite()).fold(0.0, f64::max);
    if longest > 0.0 { longest } else { 1.0 }
}
