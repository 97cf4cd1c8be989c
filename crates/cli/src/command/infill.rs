//! `rayweave infill`: tool traces that fill the layers of a solid, or a region of the plane.

use crate::arguments::{GlobalArguments, ModelArguments, SubjectArguments};
use crate::drawing;
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal::{self, short};
use clap::Args;
use rayweave::infill::{
    Fillable, Filling, InfillPicture, InfillRun, Layers, Raster, Slices, Summary, read_region, write_infill,
};
use rayweave::rootray::Side;
use rayweave::{AnyEvaluator, Compiled};
use std::path::{Path, PathBuf};

/// Fill the layers of a solid with tool paths (parallel traces)
///
/// Layers lie at the heights given by --layer-height or --z. In each layer, parallel scan lines run through the solid; a trace is a
/// piece of a scan line inside it. Instead of a model, a .csv file with the columns contour, x, y describes a region of the
/// plane, filled as one layer: outlines run counter-clockwise, holes clockwise.
///
/// The table has the columns layer, z, scanline, component, x0, y0, x1, y1. In every layer, scan line k lies (k + phase) spacings
/// from the origin, measured to the left of the direction. Overlapping traces on adjacent scan lines belong to one component of
/// their layer. Without -o and --svg, the command prints only the totals.
#[derive(Args)]
#[command(after_help = "\
Examples:
  rayweave infill bracket.toml --spacing 0.4 --layer-height 0.2 --turn 90 --alternate -o traces.csv
  rayweave infill bracket.toml --spacing 0.4 --z 1.5 --angle 45 --svg layer.svg
  rayweave infill contours.csv --spacing 0.1 --phase 0.5 -o traces.npy")]
pub struct Infill {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    subject: SubjectArguments,

    /// Distance between scan lines
    #[arg(long, value_name = "S", value_parser = number, allow_hyphen_values = true)]
    spacing: f64,

    /// Direction of scan lines, in degrees from +x towards +y
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = number, allow_hyphen_values = true)]
    angle: f64,

    /// Shift all scan lines by this fraction of the spacing, 0 to 1
    #[arg(long, value_name = "P", default_value = "0", value_parser = number, allow_hyphen_values = true)]
    phase: f64,

    /// Turn each layer by this many degrees relative to the one below
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = number, allow_hyphen_values = true)]
    turn: f64,

    /// Run odd scan lines backwards
    #[arg(long)]
    alternate: bool,

    /// Layer thickness: layers are cut at mid-height, from the lowest point of the solid upwards
    #[arg(long, value_name = "H", value_parser = number, allow_hyphen_values = true, conflicts_with = "z")]
    layer_height: Option<f64>,

    /// Cut at this height. May be repeated, or a list: --z 1,2.5
    #[arg(long, value_name = "Z", value_parser = number, allow_hyphen_values = true, value_delimiter = ',')]
    z: Vec<f64>,

    /// Table: .csv, .npy or .parquet (if built in); - writes CSV to standard output
    #[arg(short, long, value_name = "TRACES")]
    out: Option<PathBuf>,

    /// SVG drawing of the layers side by side, one colour per component
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
}

impl Infill {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        self.svg.as_deref().map_or(Ok(()), drawing::check_svg)?;
        let raster = Raster::new(self.spacing, self.angle, self.phase)?;
        let filling = Filling { raster, turn: self.turn, alternate: self.alternate };
        let mut picture = InfillPicture::new(self.spacing);
        if self.is_flat() {
            self.reject_options_of_solids()?;
            let region = read_region(&self.model.model, Side::Outside)?;
            picture.outline(&region);
            return self.fill(global, &region, &filling, &Layers::At(vec![0.0]), "", picture);
        }
        let layers = self.layers()?;
        let scene = self.model.load_for(self.subject.solid.as_deref())?;
        let compiled = Compiled::named(&scene, self.subject.solid.as_deref())?;
        let evaluator = AnyEvaluator::new(self.subject.evaluator.as_deref(), compiled.program.clone())?;
        self.fill(global, &Slices(&evaluator), &filling, &layers, scene.unit.symbol(), picture)
    }

    /// True if the file describes a region of the plane.
    fn is_flat(&self) -> bool {
        self.model.model.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"))
    }

    fn reject_options_of_solids(&self) -> Result<(), Failure> {
        let given = [
            ("--layer-height", self.layer_height.is_some()),
            ("--z", !self.z.is_empty()),
            ("--solid", self.subject.solid.is_some()),
            ("--evaluator", self.subject.evaluator.is_some()),
            ("--define", !self.model.definitions.is_empty()),
        ];
        match given.iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) => Err(Failure::Usage(format!(
                "{option} does not apply to {}: a region of the plane is one layer, without solids and parameters. Leave it out.",
                self.model.name()
            ))),
            None => Ok(()),
        }
    }

    fn layers(&self) -> Result<Layers, Failure> {
        match self.layer_height {
            Some(height) => Ok(Layers::Every(height)),
            None if !self.z.is_empty() => Ok(Layers::At(self.z.clone())),
            None => Err(Failure::Usage(
                "no layers are requested: a solid is filled layer by layer. Give --layer-height or --z."
                    .to_owned(),
            )),
        }
    }

    fn fill<F: Fillable>(
        &self,
        global: &GlobalArguments,
        fillable: &F,
        filling: &Filling,
        layers: &Layers,
        unit: &str,
        mut picture: InfillPicture,
    ) -> Result<(), Failure> {
        let run = InfillRun { threads: global.threads, cancel: interrupt::token() };
        let mut lost = Vec::new();
        let summary = write_infill(fillable, filling, layers, &run, unit, self.out.as_deref(), |layer| {
            if layer.traces.is_empty() {
                lost.push((layer.layer, layer.z));
            }
            if self.svg.is_some() {
                picture.layer(layer);
            }
        })?;
        if let Some(path) = &self.svg {
            terminal::save(path, picture.to_svg(&self.heading()).as_bytes())?;
        }
        let goes_to_output = [&self.out, &self.svg].into_iter().flatten().any(|path| path == Path::new("-"));
        if global.quiet || goes_to_output {
            return Ok(());
        }
        let mut text = self.totals(&summary, unit);
        text += &empty_layers(&lost, fillable);
        if picture.left_out() > 0 {
            let most = InfillPicture::MAX_LAYERS;
            text += &format!("the picture shows only the first {most} layers; --z selects others.\n");
        }
        terminal::print(&text)
    }

    fn heading(&self) -> String {
        let name = self.subject.solid.as_deref().map(|solid| format!(", {solid}")).unwrap_or_default();
        format!("{}{name}: traces {} apart", self.model.name(), short(self.spacing))
    }

    fn totals(&self, summary: &Summary, unit: &str) -> String {
        let place = match (&self.out, &self.svg) {
            (Some(path), _) | (None, Some(path)) => path.display().to_string(),
            (None, None) => self.model.name(),
        };
        let (traces, length) = (summary.traces, short(summary.length));
        let space = if unit.is_empty() { "" } else { " " };
        let layers = match summary.layers {
            1 => "1 layer".to_owned(),
            n => format!("{n} layers"),
        };
        format!("{place}: {traces} traces in {layers}, {length}{space}{unit} in total\n")
    }
}

/// A note about layers without traces.
fn empty_layers(lost: &[(usize, f64)], fillable: &impl Fillable) -> String {
    let Some(&(layer, z)) = lost.first() else { return String::new() };
    let bounds = fillable.extent();
    let others = match lost.len() {
        1 => String::new(),
        n => format!(" (and {} more)", n - 1),
    };
    let reason = match z < bounds.lo.z || z > bounds.hi.z {
        true => {
            format!("the filled solid lies between z = {} and {}", short(bounds.lo.z), short(bounds.hi.z))
        }
        false => "no scan line crosses the solid there".to_owned(),
    };
    format!("layer {layer} at z = {}{others} has no traces: {reason}\n", short(z))
}

/// Parses a number; the option that uses it checks its range.
fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("`{text}` is not a number"))
}
