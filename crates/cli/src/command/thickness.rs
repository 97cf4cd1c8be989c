//! `rayweave thickness`: how far rays go through each medium, as a picture or a table.

use crate::arguments::{Cli, ModelArguments, SubjectArguments};
use crate::command::render::size;
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal::{self, Unit};
use clap::Args;
use clap::builder::PossibleValuesParser;
use rayweave::picture::Wishes;
use rayweave::render::{Plane, Size, View, png};
use rayweave::scene::Scene;
use rayweave::thickness::{FAINTEST, Run, ThicknessMap};
use rayweave::{AnyEvaluator, Compiled};
use std::path::{Path, PathBuf};

/// Measure how far rays go through each medium: a radiograph, or a table of path lengths
///
/// One ray goes through the centre of each pixel, and all the way through the model. A .png shows which part of an X-ray comes
/// through, by the numbers `attenuation` (per length) in the tables of the media; if there are none, by their `density`, or all
/// media alike, so that 5 % come through the place that weakens most. Any other file is a table of the path lengths, a column for each medium; that of
/// the world is the way between a ray's first and last crossing.
#[derive(Args)]
pub struct Thickness {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    subject: SubjectArguments,

    /// The radiograph, .png, or the table, .csv, .npy or .parquet if built so
    #[arg(short, long, value_name = "OUT")]
    out: PathBuf,

    /// The picture shows the path length through this medium, white where it is longest
    #[arg(long, value_name = "NAME")]
    medium: Option<String>,

    /// Width and height in pixels [default: what the model's camera says, else 1280x720]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<Size>,

    /// Look from this side at all of the model, along parallel rays [default: the camera of the model]
    #[arg(long, value_parser = PossibleValuesParser::new(View::ALL.map(View::name)))]
    view: Option<String>,
}

impl Thickness {
    pub fn run(&self, cli: &Cli) -> Result<(), Failure> {
        let is_picture = self.out.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        if self.medium.is_some() && !is_picture {
            let text = "--medium chooses what a picture shows (the table has all media) write a .png?";
            return Err(Failure::Usage(text.to_owned()));
        }
        let scene = self.model.load()?;
        let compiled = Compiled::named(&scene, self.subject.solid.as_deref())?;
        let evaluator = AnyEvaluator::new(self.subject.evaluator.as_deref(), compiled.program.clone())?;
        let view = self.view.as_deref().and_then(|name| name.parse().ok());
        let wishes = Wishes { size: self.size, view, ..Wishes::default() };
        let bar = terminal::progress_bar(None, Unit::Percent, cli.quiet);
        let mut progress = |done: usize| bar.set_position(done as u64);
        let mut run =
            Run { threads: cli.threads, cancel: interrupt::token()?, progress: Some(&mut progress) };
        let map = ThicknessMap::new(&scene, &compiled, &evaluator, &wishes, &mut run);
        bar.finish_and_clear();
        let map = map?;
        let note = match is_picture {
            true => self.draw(&scene, &map)?,
            false => {
                map.write(&self.out, scene.unit.symbol())?;
                format!("path lengths of {} rays", map.size().count())
            }
        };
        match cli.quiet || self.out == Path::new("-") {
            true => Ok(()),
            false => terminal::print(&format!("{}: {note}\n", self.out.display())),
        }
    }

    /// Writes the picture and says what its grey is.
    fn draw(&self, scene: &Scene, map: &ThicknessMap) -> Result<String, Failure> {
        let unit = scene.unit.symbol();
        if let Some(medium) = &self.medium {
            let plane = map.of_medium(medium)?;
            let longest = longest(&plane);
            terminal::save(&self.out, &png::encode_grey(&plane, longest))?;
            return Ok(format!("white is {} {unit} of {medium}", terminal::short(longest)));
        }
        terminal::save(&self.out, &png::encode_grey(&map.radiograph(scene), 1.0))?;
        let is_said = |key| scene.media.iter().any(|m| m.numbers.iter().any(|(name, _)| name == key));
        let white = "white is where all comes through";
        if is_said("attenuation") {
            return Ok(white.to_owned());
        }
        let percent = terminal::short(100.0 * FAINTEST);
        let by = if is_said("density") { "they weaken by their density" } else { "they weaken alike" };
        Ok(format!("{white}, {percent} % where most is lost (no medium has an attenuation: {by})"))
    }
}

/// The longest path that has an end; 1 if there is none.
fn longest(plane: &Plane<f64>) -> f64 {
    let longest = plane.values().iter().copied().filter(|length| length.is_finite()).fold(0.0, f64::max);
    if longest > 0.0 { longest } else { 1.0 }
}
