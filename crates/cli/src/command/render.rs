//! `rayweave render`: a picture of a model.

use crate::arguments::{GlobalArguments, ModelArguments, PartArguments, SubjectArguments, debug_hash};
use crate::device::{Chosen, DeviceArguments};
use crate::drawing;
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal::{self, Unit};
use clap::Args;
use clap::builder::PossibleValuesParser;
use rayweave::draw::DrawError;
use rayweave::draw::technical::{ProjectionMethod, TechnicalOptions, technical_drawing};
use rayweave::picture::{
    CutAway, Explosion, Opacity, Picture, PictureKind, PictureOptions, PictureSheet, SheetKind, WholeModel,
    arrange,
};
use rayweave::render::{RenderOptions, Run, Size, Style, View};
use rayweave::scene::Scene;
use rayweave::table::{Part, TableWriter};
use rayweave::{AnyEvaluator, Compiled};
use std::path::{Path, PathBuf};

/// Render a picture of a model
///
/// Uses the camera of the model file; without one, or with --view, the picture shows the whole model.
#[derive(Args)]
pub struct Render {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    subject: SubjectArguments,

    /// Output file: .png or .jpg, and .svg or .pdf for sheets and legends; - is standard output [default: the name of the model file with .png, in the current folder]
    #[arg(short, long, value_name = "OUT")]
    out: Option<PathBuf>,

    /// Width and height in pixels [default: as in the model's camera, else 1280x720]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<Size>,

    /// View the whole model from this side, without perspective; `sheet` draws four views to scale and a legend; with --cut, the views that look onto a cut face are cut
    #[arg(long, value_parser = PossibleValuesParser::new(View::ALL.map(View::name).into_iter().chain([SHEET])))]
    view: Option<String>,

    /// Make --view sheet a technical drawing to a standard scale: visible edges, centre lines, hidden edges, overall sizes, distances of steps and radial holes, diameters of holes and shafts, sizes of polygonal holes, depths, circles of holes, fillets, chamfers. The size is in units of 1/96 inch [default: A4, 1123x794]
    #[arg(long, requires = "view", conflicts_with_all = ["legend", "explode", "kind", "range"])]
    dimensions: bool,

    /// Arrangement of the views of --dimensions: `first` places the view from above below that from the front, as in Europe, `third` above it
    #[arg(long, value_name = "ANGLE", requires = "dimensions", default_value = "third", value_parser = PossibleValuesParser::new(ProjectionMethod::ALL.map(|(_, name)| name)))]
    projection: String,

    /// Title of the drawing of --dimensions [default: the name of the model file]
    #[arg(long, value_name = "TEXT", requires = "dimensions")]
    title: Option<String>,

    /// Add a legend of the media's colours below the picture
    #[arg(long)]
    legend: bool,

    /// Remove the parts on these sides of planes to show the interior: x>0 removes one half, x>50%,y<50% a quarter of the model
    #[arg(long, value_name = "PLANES")]
    cut: Option<String>,

    /// Explode the regions along this axis, with gaps given as a fraction of the model's longest side: z or x:0.3, for example
    #[arg(long, value_name = "AXIS[:GAP]")]
    explode: Option<String>,

    /// Draw the regions of this name or medium (or all) with this opacity: from 0 (clear) to 1 (opaque). May be repeated
    #[arg(long, value_name = "[NAME=]OPACITY")]
    opacity: Vec<String>,

    /// View the whole model in perspective, with this vertical field of view
    #[arg(long, value_name = "DEGREES")]
    fov: Option<f64>,

    /// Quantity to draw
    #[arg(long, default_value = "colour", value_parser = PossibleValuesParser::new(PictureKind::ALL.map(|(_, name)| name)))]
    kind: String,

    /// Shading of surfaces [default: as in the model, else gooch]
    #[arg(long, value_parser = PossibleValuesParser::new(STYLES.map(|(name, _)| name)))]
    shading: Option<String>,

    /// Draw edges [default: as in the model, else yes]
    #[arg(long, overrides_with = "no_edges")]
    edges: bool,

    /// Draw no edges
    #[arg(long)]
    no_edges: bool,

    /// Lights cast shadows; a model without lights gets one next to the camera
    #[arg(long, overrides_with = "no_shadows")]
    shadows: bool,

    /// Lights cast no shadows
    #[arg(long)]
    no_shadows: bool,

    /// Supersample edge pixels with N x N rays [default: as in the model, else 3]
    #[arg(long, value_name = "N", value_parser = crate::arguments::count::<u32, 1, { RenderOptions::MAX_SAMPLES as u64 }>)]
    samples: Option<u32>,

    #[command(flatten)]
    device: DeviceArguments,

    #[command(flatten)]
    part: PartArguments,
}

/// The value of `--view` for a sheet of several views.
const SHEET: &str = "sheet";

/// The picture.
enum Drawn {
    Picture(Picture),
    PictureSheet(PictureSheet),
}

const STYLES: [(&str, Style); 3] =
    [("gooch", Style::Gooch), ("headlight", Style::Headlight), ("flat", Style::Flat)];

impl Render {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let out = self.out()?;
        if self.dimensions && self.cut.is_some() {
            return Err(Failure::Usage(self.advice_for_cut_drawings()));
        }
        let scene = self.scene(true)?;
        let compiled = Compiled::new(&scene)?;
        if self.dimensions {
            return self.draw_technical(&scene, &compiled, &out, global);
        }
        let part = self.part(&scene, &compiled, &out)?;
        if self.part.is_done(part.iter().map(|part| (out.as_path(), part)), global.quiet) {
            return Ok(());
        }
        let chosen = self.on_device(&compiled, global)?;
        let evaluator = chosen.evaluator.evaluator();
        let bar = terminal::progress_bar(Some(100), Unit::Percent, global.quiet);
        let mut progress = |part: f64| bar.set_position((100.0 * part) as u64);
        let mut run =
            Run { threads: global.threads, cancel: interrupt::token(), progress: Some(&mut progress) };
        let drawn = match self.sheet() {
            Some(kind) => self
                .draw_sheet(kind, (&scene, &compiled, evaluator), global, &mut run)
                .map(Drawn::PictureSheet),
            None => self
                .picture(&scene, &compiled, evaluator, &mut run)
                .map(Drawn::Picture)
                .map_err(Failure::from),
        };
        bar.finish_and_clear();
        let drawn = drawn?;
        chosen.finish()?;
        let size = match drawn {
            Drawn::Picture(picture) => {
                match &part {
                    Some(part) => part.write(&out, &picture.to_png())?,
                    None => drawing::save_picture(&out, &picture)?,
                }
                picture.size()
            }
            Drawn::PictureSheet(sheet) => {
                drawing::save_sheet(&out, &sheet, &self.model.name())?;
                sheet.size()
            }
        };
        if global.quiet || out == Path::new("-") {
            return Ok(());
        }
        let (width, height) = (size.width(), size.height());
        terminal::print(&format!("{}: {width} x {height} pixels\n{}", out.display(), chosen.summary()))
    }

    /// The error for a technical drawing of a part, with the command that draws it, for a cut such as `x>0` as a section at `x=0`.
    fn advice_for_cut_drawings(&self) -> String {
        let cut = self.cut.as_deref().unwrap_or_default();
        let is_side = |text: &str| text.chars().filter(|c| matches!(c, '<' | '>')).count() == 1;
        let plane = match cut.replace(' ', "") {
            plane if is_side(&plane) => plane.replace(['<', '>'], "="),
            _ => "x=0".to_owned(),
        };
        format!(
            "--cut and --dimensions are given: a technical drawing shows the whole model. For a section with dimensions, use \
             `rayweave section {} --plane {plane} --hatch --dimensions -o section.svg`. For views that are cut, leave out --dimensions.",
            self.model.name()
        )
    }

    /// Writes a technical drawing.
    fn draw_technical(
        &self,
        scene: &Scene,
        compiled: &Compiled,
        out: &Path,
        global: &GlobalArguments,
    ) -> Result<(), Failure> {
        if self.sheet() != Some(SheetKind::Views) {
            return Err(Failure::Usage(
                "--dimensions: only sheets have dimensions. Add --view sheet.".to_owned(),
            ));
        }
        let chosen = self.on_device(compiled, global)?;
        let mut run = Run { threads: global.threads, cancel: interrupt::token(), progress: None };
        let projection = self.projection.parse().unwrap_or_default();
        let options = TechnicalOptions { size: self.size, projection };
        let name = self.title.clone().unwrap_or_else(|| self.model.name());
        let evaluator = chosen.evaluator.evaluator();
        let drawn = technical_drawing(evaluator, &name, scene.unit, &options, &mut run)?;
        chosen.finish()?;
        drawn.notes.iter().for_each(|note| terminal::note(&format!("note: {note}")));
        drawing::save(out, &drawn.svg, &name)?;
        terminal::wrote(out, global.quiet)
    }

    /// The evaluator of a model on the chosen device.
    fn on_device(&self, compiled: &Compiled, global: &GlobalArguments) -> Result<Chosen, Failure> {
        self.device.choose(self.subject.evaluator.as_deref(), compiled.program.clone(), global.quiet)
    }

    /// Rejects arguments with which a picture cannot be drawn again and again.
    pub fn check_repeatable(&self) -> Result<(), Failure> {
        let text = match () {
            () if self.model_file() == Path::new("-") => {
                "standard input ends after one model: watch a file instead."
            }
            () if self.out.as_deref() == Some(Path::new("-")) => {
                "standard output holds one picture: give the name of a file with -o."
            }
            () if self.part.range.is_some() => "--range draws a part of a picture: use `rayweave render`.",
            () => return Ok(()),
        };
        Err(Failure::Usage(text.to_owned()))
    }

    /// The name of the model file.
    pub fn model_file(&self) -> &Path {
        &self.model.model
    }

    /// The part to remove.
    fn cut_away(&self) -> Result<Option<CutAway>, DrawError> {
        self.cut.as_deref().map(str::parse).transpose()
    }

    /// Draws a sheet; views that do not look onto a cut face show the whole model.
    fn draw_sheet(
        &self,
        kind: SheetKind,
        (scene, compiled, evaluator): (&Scene, &Compiled, &AnyEvaluator),
        global: &GlobalArguments,
        run: &mut Run<'_>,
    ) -> Result<PictureSheet, Failure> {
        let options = self.options();
        let Some(cut) = self.cut_away()?.filter(|_| kind == SheetKind::Views) else {
            return Ok(PictureSheet::draw(kind, scene, compiled, evaluator, &options, run)?);
        };
        let whole = Compiled::new(&self.scene(false)?)?;
        let chosen = self.on_device(&whole, global)?;
        let whole = WholeModel { cut: &cut, evaluator: chosen.evaluator.evaluator() };
        let sheet = PictureSheet::draw_cut(kind, scene, compiled, evaluator, whole, &options, run)?;
        chosen.finish()?;
        Ok(sheet)
    }

    /// The model to draw, or one of its solids, exploded and, with `is_cut`, cut as requested.
    fn scene(&self, is_cut: bool) -> Result<Scene, Failure> {
        let cut = self.cut_away()?.filter(|_| is_cut);
        let explosion: Option<Explosion> = self.explode.as_deref().map(str::parse).transpose()?;
        let opacities = self.opacity.iter().map(|text| text.parse());
        let opacities: Vec<Opacity> = opacities.collect::<Result<_, _>>()?;
        let mut scene = self.model.import_scene()?;
        if let Some(name) = &self.subject.solid {
            scene = scene.alone(name)?;
        }
        opacities.iter().try_for_each(|opacity| opacity.apply(&mut scene))?;
        scene = scene.seen();
        if let Some(cut) = cut {
            self.note_missed_cut(&cut, &scene)?;
            scene = cut.apply(&scene)?;
        }
        if let Some(explosion) = explosion {
            scene = explosion.apply(&scene)?;
        }
        Ok(scene)
    }

    /// Prints a note if a cut removes nothing of the model.
    fn note_missed_cut(&self, cut: &CutAway, scene: &Scene) -> Result<(), Failure> {
        let bounds = Compiled::new(scene)?.program.bounds();
        if !bounds.is_empty() && cut.misses(&bounds)? {
            let corner = |p: rayweave::Vec3| terminal::short_point(p.to_array());
            let (lo, hi) = (corner(bounds.lo), corner(bounds.hi));
            let cut = self.cut.as_deref().unwrap_or_default();
            terminal::note(&format!(
                "note: --cut {cut} removes nothing: the model reaches from {lo} to {hi}. Give conditions within it."
            ));
        }
        Ok(())
    }

    /// The views of the sheet, if requested.
    fn sheet(&self) -> Option<SheetKind> {
        match self.view.as_deref() {
            Some(SHEET) => Some(SheetKind::Views),
            _ => self.legend.then_some(SheetKind::One),
        }
    }

    fn picture(
        &self,
        scene: &Scene,
        compiled: &Compiled,
        evaluator: &AnyEvaluator,
        run: &mut Run<'_>,
    ) -> Result<Picture, DrawError> {
        let (camera, mut settings) = arrange(scene, compiled, &self.options())?;
        settings.rows = self.part.range.as_ref().map(|range| range.start as u32..range.end as u32);
        Picture::draw(self.kind.parse()?, evaluator, &camera, &settings, run)
    }

    /// The part that is drawn, rows of pixels, if a range is given.
    fn part(&self, scene: &Scene, compiled: &Compiled, out: &Path) -> Result<Option<Part>, Failure> {
        let Some(range) = &self.part.range else { return Ok(None) };
        if self.sheet().is_some() || self.kind != "colour" {
            let text = "--range draws rows of one picture in colour: leave out --legend, --kind and sheets.";
            return Err(Failure::Usage(text.to_owned()));
        }
        TableWriter::check_part(out)?;
        let (camera, settings) = arrange(scene, compiled, &self.options())?;
        let height = settings.size.height() as u64;
        if range.end > height || range.is_empty() {
            let (start, end) = (range.start, range.end);
            let text = format!(
                "--range is {start}:{end}: it is a range of the {height} rows of pixels, and not empty."
            );
            return Err(Failure::Usage(text));
        }
        let own = [("model", scene.content_hash()), ("picture", debug_hash(&(camera, settings)))];
        Ok(self.part.part("render", own, height))
    }

    /// The output file.
    fn out(&self) -> Result<PathBuf, Failure> {
        if self.sheet().is_some() && self.kind != "colour" {
            let (kind, why) = (&self.kind, "the pictures of sheets and legends are in colour");
            return Err(Failure::Usage(format!("--kind {kind} on a sheet: {why}. Leave it out.")));
        }
        let Some(out) = &self.out else {
            let out = Path::new(self.model.stem()).with_added_extension("png");
            return crate::outputs::check_unnamed(&out).map(|()| out);
        };
        if self.sheet().is_some() {
            return drawing::check(out).map(|()| out.clone());
        }
        let is_png = out.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        let text = match () {
            () if is_png || out == Path::new("-") => return Ok(out.clone()),
            () if !drawing::is_jpeg(out) => "unknown picture format: pictures are written as .png or .jpg",
            () if self.kind != "colour" => "JPEG changes numbers: write them as .png",
            () if self.part.range.is_some() => "rows of a JPEG picture cannot be joined: write them as .png",
            () => return Ok(out.clone()),
        };
        Err(Failure::Usage(format!("{}: {text}.", out.display())))
    }

    fn options(&self) -> PictureOptions {
        let choice = |yes: bool, no: bool| (yes || no).then_some(yes);
        let style = |name: &str| STYLES.iter().find(|(own, _)| *own == name);
        PictureOptions {
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

/// Parses a size such as `640x480`.
pub fn size(text: &str) -> Result<Size, String> {
    let numbers = text.split_once(['x', 'X']).map(|(w, h)| (w.trim().parse(), h.trim().parse()));
    match numbers {
        Some((Ok(width), Ok(height))) => Size::new(width, height).map_err(|error| error.to_string()),
        _ => Err("a size is width x height in pixels, such as 640x480".to_owned()),
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
