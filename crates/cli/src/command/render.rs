//! `rayweave render`: a picture of a model.

use crate::arguments::{Cli, ModelArguments, SubjectArguments};
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal::{self, Unit};
use clap::Args;
use clap::builder::PossibleValuesParser;
use rayweave::picture::{Picture, PictureKind, Wishes, arrange};
use rayweave::render::{Run, Settings, Size, Style, View};
use rayweave::{AnyEvaluator, Compiled};
use std::path::{Path, PathBuf};

/// Draw a picture of a model
///
/// The camera is that of the model file; if it has none, or --view is given, all of the model is shown.
#[derive(Args)]
pub struct Render {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    subject: SubjectArguments,

    /// The picture, .png; - is standard output [default: the name of the model file with .png, in the current folder]
    #[arg(short, long, value_name = "OUT.png")]
    out: Option<PathBuf>,

    /// Width and height in pixels [default: what the model's camera says, else 1280x720]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<Size>,

    /// Look from this side at all of the model, without perspective
    #[arg(long, value_parser = PossibleValuesParser::new(View::ALL.map(View::name)))]
    view: Option<String>,

    /// See all of the model in perspective, with this vertical field of view
    #[arg(long, value_name = "DEGREES")]
    fov: Option<f64>,

    /// What the picture shows
    #[arg(long, default_value = "colour", value_parser = PossibleValuesParser::new(PictureKind::ALL.map(|(_, name)| name)))]
    kind: String,

    /// How surfaces are shaded [default: what the model says, else gooch]
    #[arg(long, value_parser = PossibleValuesParser::new(STYLES.map(|(name, _)| name)))]
    shading: Option<String>,

    /// Draw edges [default: what the model says, else yes]
    #[arg(long, overrides_with = "no_edges")]
    edges: bool,

    /// Draw no edges
    #[arg(long)]
    no_edges: bool,

    /// Let lights cast shadows; without a light in the model there is one beside the camera
    #[arg(long, overrides_with = "no_shadows")]
    shadows: bool,

    /// Let no light cast shadows
    #[arg(long)]
    no_shadows: bool,

    /// Look at pixels at edges along N x N rays [default: what the model says, else 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(Settings::MOST_SAMPLES)))]
    samples: Option<u32>,
}

const STYLES: [(&str, Style); 3] =
    [("gooch", Style::Gooch), ("headlight", Style::Headlight), ("flat", Style::Flat)];

impl Render {
    pub fn run(&self, cli: &Cli) -> Result<(), Failure> {
        let out = self.out()?;
        let scene = self.model.load()?.seen();
        let compiled = Compiled::named(&scene, self.subject.solid.as_deref())?;
        let evaluator = AnyEvaluator::new(self.subject.evaluator.as_deref(), compiled.program.clone())?;
        let (camera, settings) = arrange(&scene, &compiled, &self.wishes())?;
        let kind: PictureKind = self.kind.parse()?;
        let bar = terminal::progress_bar(Some(100), Unit::Percent, cli.quiet);
        let mut progress = |part: f64| bar.set_position((100.0 * part) as u64);
        let mut run =
            Run { threads: cli.threads, cancel: interrupt::token()?, progress: Some(&mut progress) };
        let drawn = Picture::draw(kind, &evaluator, &camera, &settings, &mut run);
        bar.finish_and_clear();
        terminal::save(&out, &drawn?.to_png())?;
        if cli.quiet || out == Path::new("-") {
            return Ok(());
        }
        let (width, height) = (settings.size.width(), settings.size.height());
        terminal::print(&format!("{}: {width} x {height} pixels\n", out.display()))
    }

    /// Where the picture goes.
    fn out(&self) -> Result<PathBuf, Failure> {
        let Some(out) = &self.out else {
            let name = self.model.model.file_stem().unwrap_or_default();
            return Ok(Path::new(name).with_added_extension("png"));
        };
        let is_png = out.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        match is_png || out == Path::new("-") {
            true => Ok(out.clone()),
            false => Err(Failure::Usage(format!(
                "{}: unknown picture format (pictures are written as .png)",
                out.display()
            ))),
        }
    }

    fn wishes(&self) -> Wishes {
        let choice = |yes: bool, no: bool| (yes || no).then_some(yes);
        let style = |name: &str| STYLES.iter().find(|(own, _)| *own == name);
        Wishes {
            size: self.size,
            view: self.view.as_deref().and_then(|name| name.parse().ok()),
            field_of_view: self.fov,
            style: self.shading.as_deref().and_then(style).map(|(_, style)| *style),
            edges: choice(self.edges, self.no_edges),
            shadows: choice(self.shadows, self.no_shadows),
            samples: self.samples,
        }
    }
}

/// `640x480`.
pub fn size(text: &str) -> Result<Size, String> {
    let numbers = text.split_once(['x', 'X']).map(|(w, h)| (w.trim().parse(), h.trim().parse()));
    match numbers {
        Some((Ok(width), Ok(height))) => Size::new(width, height).map_err(|error| error.to_string()),
        _ => Err("a size is width x height in pixels, as in 640x480".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("640x480"), Ok(Size::new(640, 480).unwrap()));
        assert!(size("0x480").unwrap_err().contains("0 x 480"));
        for text in ["640", "640x", "x", "-1x5", "6.4x4.8", "640x480x3"] {
            assert!(size(text).unwrap_err().contains("640x480"), "{text}");
        }
    }
}
