//! `rayweave convert`: conversion of a model to another format.

use crate::arguments::{GlobalArguments, ModelArguments, OnlyArguments};
use crate::failure::Failure;
use crate::lens_model::LensModel;
use crate::terminal;
use clap::Args;
use rayweave::formats::{self, Format, RemarkKind, WriteOptions};
use std::path::{Path, PathBuf};

/// Write a model in another format: native, OpenSCAD, GDML, or a mesh
///
/// Shapes that the format supports are written exactly, others as triangles within a tolerance. Standard error lists the parts that
/// were approximated, dropped or, unless --quiet, written in another form, and the losses when the model was read. With --strict, a
/// model that the format cannot hold is not written; triangles within the tolerance are no reason. A mesh that is not the boundary of
/// a solid is not written either.
///
/// A sequential Zemax lens file (.zmx) becomes a native model with lenses, mirrors, stop and image, and a source for each field with all
/// wavelengths, which fills the paraxial entrance pupil: rays are not aimed at the stop. Other formats, and files of one solid, get the
/// solids only.
#[derive(Args)]
#[command(after_help = "\
Examples:
  rayweave convert part.csg part.toml
  rayweave convert lens.toml lens.gdml
  rayweave convert lens.toml lens.3mf --tolerance 0.001
  rayweave convert pump.toml housing.stl --solid housing
  rayweave convert cooke-triplet.zmx triplet.toml
  rayweave convert cooke-triplet.zmx front.stl --solid 'lens 1-2'")]
pub struct Convert {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    only: OnlyArguments,

    /// Output file; - is standard output
    #[arg(value_name = "OUT")]
    out: PathBuf,

    /// Output format [default: by the extension of OUT]
    #[arg(long, value_name = "NAME", value_parser = Format::NAMES)]
    to: Option<String>,

    /// Maximum distance between a curved face and its triangles, in the unit of the model [default: 1/5000 of the model's
    /// diagonal]
    #[arg(long, value_name = "LENGTH")]
    tolerance: Option<f64>,

    /// Write STL and PLY as text instead of binary; text STL names the regions
    #[arg(long)]
    text: bool,

    /// Write meshes that are not sound: edges without two triangles, or triangles that intersect each other
    #[arg(long)]
    allow_unsound: bool,
}

/// Extensions of formats of CAD programs, which hold boundary representations.
const CAD: [&str; 13] =
    ["step", "stp", "iges", "igs", "brep", "sat", "x_t", "x_b", "sldprt", "ipt", "f3d", "fcstd", "dwg"];

impl Convert {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let format = self.format()?;
        if self.model.is_lens() {
            return self.lens(format, global);
        }
        let imported = self.only.of_import(self.model.import()?)?;
        let options =
            WriteOptions { tolerance: self.tolerance, text: self.text, allow_unsound: self.allow_unsound };
        let written = formats::write(&imported.scene, imported.stated.as_ref(), format, &options);
        let written = written.map_err(rayweave::Error::from)?;
        // approximations are reported even with --quiet
        let (changes, losses): (Vec<_>, Vec<_>) =
            written.remarks.iter().partition(|remark| remark.kind == RemarkKind::Changed);
        if !global.quiet {
            changes.iter().for_each(|change| terminal::note(&change.to_string()));
        }
        losses.iter().for_each(|loss| terminal::note(&loss.to_string()));
        if self.model.strict && losses.iter().any(|loss| !loss.is_expected) {
            return Err(crate::failure::lossy(&self.out));
        }
        terminal::save(&self.out, &written.bytes)?;
        terminal::wrote(&self.out, global.quiet)
    }

    /// Writes the solids of a lens file and, into a native file, its stop, its image and the light of its fields.
    fn lens(&self, format: Format, global: &GlobalArguments) -> Result<(), Failure> {
        let LensModel { scene, optics, mut losses } = LensModel::of(&self.model.lens()?)?;
        let scene = self.only.of(scene)?;
        let options =
            WriteOptions { tolerance: self.tolerance, text: self.text, allow_unsound: self.allow_unsound };
        let written = formats::write(&scene, None, format, &options).map_err(rayweave::Error::from)?;
        let mut bytes = written.bytes;
        match format {
            Format::Native if !self.only.is_one() => bytes.extend_from_slice(optics.as_bytes()),
            _ => losses.push("the stop, the image, the fields and the wavelengths are left out.".to_owned()),
        }
        losses.extend(
            written
                .remarks
                .iter()
                .filter(|remark| remark.kind != RemarkKind::Changed)
                .map(ToString::to_string),
        );
        losses.iter().for_each(|loss| terminal::note(loss));
        if self.model.strict && !losses.is_empty() {
            return Err(crate::failure::lossy(&self.out));
        }
        terminal::save(&self.out, &bytes)?;
        terminal::wrote(&self.out, global.quiet)
    }

    fn format(&self) -> Result<Format, Failure> {
        if let Some(format) = self.to.as_deref().and_then(Format::from_name) {
            return Ok(format);
        }
        let unknown = || {
            let problem = match (self.out.to_str(), self.out.extension()) {
                (Some("-"), _) => "the output format is unknown: standard output has no extension".to_owned(),
                (_, Some(extension)) => {
                    format!("{}: the extension .{} is unknown", self.out.display(), extension.display())
                }
                (_, None) => {
                    format!("{}: the format is unknown: the file has no extension", self.out.display())
                }
            };
            let known = Format::NAMES.join(", ");
            let ending = self.out.extension().map(|own| own.to_string_lossy().to_ascii_lowercase());
            if let Some(ending) = ending.filter(|own| CAD.contains(&own.as_str())) {
                return Failure::Usage(format!(
                    "{}: .{ending} files cannot be written: they hold surfaces with trimmed edges, and Rayweave writes shapes or \
                     triangles. For other CAD programs write .3mf or .stl, or .csg for OpenSCAD and FreeCAD.",
                    self.out.display()
                ));
            }
            Failure::Usage(format!("{problem}. Set the format with --to: {known}."))
        };
        match self.out == Path::new("-") {
            true => Err(unknown()),
            false => Format::from_path(&self.out).ok_or_else(unknown),
        }
    }
}
