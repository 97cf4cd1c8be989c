//! Arguments that several sub-commands share.

use crate::failure::Failure;
use crate::lens_input;
use crate::lens_model::LensModel;
use crate::outputs;
use clap::Args;
use rayweave::formats::{self, Format, Imported, LossKind, Options, Report};
use rayweave::lens::prescription::Prescription;
use rayweave::scene::{Document, Scene, Unit};
use rayweave::table::{ContentHash, Part};
use rayweave::{Bounds, Vec3};
use std::ffi::OsStr;
use std::fmt::{self, Write};
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The arguments of all sub-commands.
#[derive(Args)]
pub struct GlobalArguments {
    /// Number of threads [default: the variable RAYWEAVE_THREADS, else all cores]
    #[arg(long, global = true, value_name = "N", value_parser = at_least_one)]
    pub threads: Option<NonZeroUsize>,

    /// Show no progress bar, no messages of success and no warnings; errors stay
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

/// A model file and the values of its parameters.
#[derive(Args)]
pub struct ModelArguments {
    #[arg(help = model_help())]
    pub model: PathBuf,

    /// Format of the model file [default: by the file extension, else native]
    #[arg(long, value_name = "NAME", value_parser = Format::NAMES)]
    pub format: Option<String>,

    /// Use OpenSCAD's facets for round shapes instead of exact surfaces
    #[arg(long)]
    pub facets: bool,

    /// Font file or folder, searched before the system's fonts. May be repeated
    #[arg(long = "font", value_name = "PATH")]
    pub fonts: Vec<PathBuf>,

    /// Repair meshes that are not solids, as far as this is safe, and report the changes
    #[arg(long)]
    pub repair: bool,

    /// Unit of length for files without a unit (meshes, OpenSCAD) [default: mm]
    #[arg(long, value_name = "UNIT", value_parser = Unit::ALL.map(|(_, symbol, _)| symbol))]
    pub unit: Option<String>,

    /// Let the model read this file, or the files in this folder and below; otherwise it reads only files in its own folder and
    /// below. May be repeated
    #[arg(long = "allow-path", value_name = "PATH")]
    pub allow: Vec<PathBuf>,

    /// Treat warnings as errors
    #[arg(long)]
    pub strict: bool,

    /// Continue although parts of the model are missing, such as imported files or unsupported items, and for photons the materials,
    /// matrices and surfaces of undefined references
    #[arg(long)]
    pub allow_missing: bool,

    /// Set a parameter of the model, or a constant, variable or quantity of a GDML file; the value may be an arithmetic expression in
    /// other parameters. May be repeated
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = definition)]
    pub definitions: Vec<(String, String)>,
}

/// The help of the model file: the extensions of all formats, with the names of those that are called otherwise.
fn model_help() -> String {
    let formats = Format::NAMES.into_iter().filter_map(Format::from_name).map(|format| {
        let extensions = format.extensions().join(", .");
        match format.extensions().contains(&format.name()) {
            true => format!(".{extensions}"),
            false => format!(".{extensions} ({format})"),
        }
    });
    let formats = formats.collect::<Vec<_>>().join(", ");
    format!("Model file: {formats}, .zmx (Zemax lens file); - is standard input, in the format of --format")
}

/// The name of standard input as a model file.
const STANDARD_INPUT: &str = "-";

/// The text on standard input.
fn standard_input() -> Result<String, Failure> {
    let read = rayweave::scene::read_stream(std::io::stdin().lock());
    let bytes = read.map_err(|reason| Failure::Input(format!("standard input cannot be read: {reason}.")))?;
    String::from_utf8(bytes).map_err(|_| {
        let problem = "standard input is not text: binary models are read from files only";
        Failure::Input(format!("{problem}. Give the name of the file."))
    })
}

impl ModelArguments {
    /// Reads the model file for a result that depends on all of its geometry. Warnings go to standard error.
    pub fn load(&self) -> Result<Scene, Failure> {
        let scene = self.all_of(&self.model, self.import_scene_only()?)?.scene;
        // handles that are never dropped: at the end of the program, the system frees the nodes of a large model faster than their
        // destructors do
        scene.regions.iter().for_each(|region| std::mem::forget(region.solid.clone()));
        Ok(scene)
    }

    /// Reads the model file like [`load`](Self::load), for answers about one of its solids or about its regions. Without a solid the
    /// scene has no named solids: the parts of its regions are then used once, which takes less memory to compile.
    pub fn load_for(&self, solid: Option<&str>) -> Result<Scene, Failure> {
        let mut scene = self.load()?;
        if solid.is_none() {
            scene.solids = Vec::new();
        }
        Ok(scene)
    }

    /// Reads the model file like [`load`](Self::load) and records the losses of the import.
    pub fn import_all(&self) -> Result<Imported, Failure> {
        self.all_of(&self.model, self.import()?)
    }

    /// Rejects a model with missing geometry: results computed from it would be wrong.
    fn all_of(&self, path: &Path, imported: Imported) -> Result<Imported, Failure> {
        let missing = imported.report.count(LossKind::Refused);
        if missing == 0 || self.allow_missing {
            return Ok(imported);
        }
        let items = if missing == 1 { "one item is left out" } else { "several items are left out" };
        let text = format!(
            "{}: a part of the geometry is missing: {items}, and the answer would be wrong. Correct the model, or accept it \
             with --allow-missing.",
            path.display()
        );
        Err(Failure::Input(text))
    }

    /// Reads the model file, even with missing geometry, and records the losses of the import. Warnings go to standard error.
    pub fn import(&self) -> Result<Imported, Failure> {
        self.read(&self.model, self.format.as_deref(), self.unit.as_deref(), &self.definitions, false)
    }

    /// Reads the model file, even with missing geometry, without its document. Warnings go to standard error.
    pub fn import_scene(&self) -> Result<Scene, Failure> {
        self.import_scene_only().map(|imported| imported.scene)
    }

    fn import_scene_only(&self) -> Result<Imported, Failure> {
        self.read(&self.model, self.format.as_deref(), self.unit.as_deref(), &self.definitions, true)
    }

    /// Reads a second model with the same options, except format and unit; its parameters keep their
    /// own values.
    pub fn load_other(
        &self,
        path: &Path,
        format: Option<&str>,
        unit: Option<&str>,
    ) -> Result<Scene, Failure> {
        self.all_of(path, self.read(path, format, unit, &[], true)?).map(|imported| imported.scene)
    }

    /// True if the model is a lens file.
    pub fn is_lens(&self) -> bool {
        self.format.is_none() && lens_input::is_one(&self.model)
    }

    /// Reads the model as a lens file. Ignored and replaced entries are reported on standard error.
    pub fn lens(&self) -> Result<Prescription, Failure> {
        let refused = [
            (!self.definitions.is_empty(), "--define", "a lens file has no parameters"),
            (self.unit.is_some(), "--unit", "a lens file states its unit"),
            (self.facets, "--facets", "the surfaces of a lens file are exact"),
            (self.repair, "--repair", "a lens file has no meshes"),
            (!self.fonts.is_empty(), "--font", "a lens file has no text"),
        ];
        if let Some((_, option, reason)) = refused.iter().find(|(is_given, ..)| *is_given) {
            let name = self.model.display();
            let text = format!("{option} has no effect on {name}: {reason}. Leave it out.");
            return Err(Failure::Usage(text));
        }
        lens_input::read(&self.model, self.strict)
    }

    /// The solids of a lens file, a region for each lens and mirror.
    fn lens_solids(&self, path: &Path, unit: Option<&str>) -> Result<Imported, Failure> {
        let lens = match path == self.model {
            true => self.lens()?,
            false if unit.is_some() => {
                let name = path.display();
                let text =
                    format!("the unit of {name} cannot be set: a lens file states its unit. Leave it out.");
                return Err(Failure::Usage(text));
            }
            false => lens_input::read(path, self.strict)?,
        };
        Ok(Imported::from_scene(LensModel::of(&lens)?.scene, Report::default()))
    }

    /// The options of the reader.
    pub fn options(&self) -> Options {
        Options {
            facets: self.facets,
            fonts: self.fonts.clone(),
            repair: self.repair,
            allow: self.allow.clone(),
            strict: self.strict,
            unit: self.unit.as_deref().and_then(Unit::parse),
            scene_only: false,
        }
    }

    fn read(
        &self,
        path: &Path,
        format: Option<&str>,
        unit: Option<&str>,
        definitions: &[(String, String)],
        scene_only: bool,
    ) -> Result<Imported, Failure> {
        if format.is_none() && lens_input::is_one(path) {
            return self.lens_solids(path, unit);
        }
        let options = Options { unit: unit.and_then(Unit::parse), scene_only, ..self.options() };
        let format = format.and_then(Format::from_name);
        let text = (path == Path::new(STANDARD_INPUT)).then(standard_input).transpose()?;
        let imported = outputs::reading(|| match &text {
            Some(text) => formats::parse(text, format.unwrap_or(Format::Native), definitions, &options),
            None => formats::load(path, format, definitions, &options),
        })?;
        let imported = imported.map_err(rayweave::Error::from)?;
        crate::terminal::warn(&imported.scene.warnings);
        Ok(imported)
    }

    /// Reads the model file and keeps its document, for commands that read additional tables.
    pub fn load_document(&self) -> Result<(Document, Scene), Failure> {
        let imported = self.import_all()?;
        Ok((imported.document(), imported.scene))
    }

    /// Reads the model file for the simulation of photons: undefined materials, properties and surfaces are rejected, or counted
    /// where they are allowed.
    pub fn load_optical_document(&self) -> Result<(Document, Scene, usize), Failure> {
        let imported = self.import_all()?;
        let undefined = imported.report.count(LossKind::Undefined);
        if undefined > 0 && !self.allow_missing {
            let references = if undefined == 1 {
                "a reference names".to_owned()
            } else {
                format!("{undefined} references name")
            };
            let text = format!(
                "{}: {references} nothing in the file: the optical model is incomplete, and the answer would be wrong. Geant4 rejects \
                 the file. Correct it, or accept it with --allow-missing.",
                self.model.display()
            );
            return Err(Failure::Input(text));
        }
        Ok((imported.document(), imported.scene, undefined))
    }

    /// The name of the file without its extension, for output files.
    pub fn stem(&self) -> &OsStr {
        match self.model == Path::new(STANDARD_INPUT) {
            true => OsStr::new("model"),
            false => self.model.file_stem().unwrap_or_default(),
        }
    }

    /// The name of the file, for headings.
    pub fn name(&self) -> String {
        match self.model == Path::new(STANDARD_INPUT) {
            true => "standard input".to_owned(),
            false => self.model.display().to_string(),
        }
    }
}

/// The part of a run that is computed.
#[derive(Args)]
pub struct PartArguments {
    /// Compute only the items A to B - 1 and write a part: the file and its description FILE.part.json. `rayweave merge` joins parts
    /// to the whole
    #[arg(long, value_name = "A:B", value_parser = range)]
    pub range: Option<Range<u64>>,

    /// Compute nothing if the part is already complete: the file is intact, and model, seed and settings are the same
    #[arg(long, requires = "range")]
    pub resume: bool,
}

impl PartArguments {
    /// The part with these settings that is to be written to a file, if a range is given.
    pub fn part(
        &self,
        query: &str,
        settings: impl IntoIterator<Item = (&'static str, String)>,
        total: u64,
    ) -> Option<Part> {
        let settings = settings.into_iter().map(|(name, value)| (name.to_owned(), value));
        self.range.clone().map(|range| Part::new(query, settings, range, total))
    }

    /// True if nothing has to be computed: all parts are complete and --resume is given.
    pub fn is_done<'a>(&self, mut parts: impl Iterator<Item = (&'a Path, &'a Part)>, quiet: bool) -> bool {
        let is_done = self.resume && parts.all(|(file, part)| part.is_in(file));
        if is_done && !quiet {
            crate::terminal::note("the part is complete already: nothing is computed.");
        }
        is_done
    }
}

/// A range of numbers, `A:B`.
pub fn range(text: &str) -> Result<Range<u64>, String> {
    let ends = text.split_once(':').and_then(|(a, b)| Some(whole_number(a).ok()?..whole_number(b).ok()?));
    match ends {
        Some(range) if range.start <= range.end => Ok(range),
        _ => Err("give two whole numbers as A:B, with A at most B".to_owned()),
    }
}

/// A whole number, also as `1e5`.
pub fn whole_number(text: &str) -> Result<u64, String> {
    let text = text.trim();
    if let Ok(number) = text.parse() {
        return Ok(number);
    }
    match text.parse::<f64>() {
        Ok(value) if value > MOST_EXACT && value.is_finite() => {
            Err(format!("it is too large: the limit is {} in full, or 9e15 with an exponent", u64::MAX))
        }
        Ok(value) if value.fract() == 0.0 && value >= 0.0 => Ok(value as u64),
        _ => Err("it must be a whole number from 0, as 100000 or 1e5".to_owned()),
    }
}

/// 2^53: floating-point numbers up to here are exact if they are whole.
const MOST_EXACT: f64 = 9_007_199_254_740_992.0;

/// A whole number from `LOW` to `HIGH`, in any form of [`whole_number`].
pub fn count<T: TryFrom<u64>, const LOW: u64, const HIGH: u64>(text: &str) -> Result<T, String> {
    let number = whole_number(text)?;
    let in_range = Some(number).filter(|number| (LOW..=HIGH).contains(number));
    let problem = || match HIGH {
        u64::MAX => format!("{number} is not in {LOW}.."),
        _ => format!("{number} is not in {LOW}..={HIGH}"),
    };
    in_range.and_then(|number| T::try_from(number).ok()).ok_or_else(problem)
}

/// A whole number from 1, in any form of [`whole_number`].
pub fn at_least_one(text: &str) -> Result<NonZeroUsize, String> {
    NonZeroUsize::new(any_count(text)?).ok_or_else(|| "it must be at least 1".to_owned())
}

/// A whole number from 0, in any form of [`whole_number`].
pub fn any_count<T: TryFrom<u64>>(text: &str) -> Result<T, String> {
    T::try_from(whole_number(text)?).map_err(|_| "it is too large".to_owned())
}

/// A hash of a value by its debug output, which has all digits of its numbers. Not for compiled systems: they contain the SIMD level of
/// the processor, and parts from different machines have to agree.
pub fn debug_hash(value: &impl fmt::Debug) -> String {
    debug_assert!(!format!("{value:?}").contains(" level: "), "the hash depends on the processor");
    let mut hash = ContentHash::new();
    // writing to a hash cannot fail
    let _ = write!(hash, "{value:?}");
    hash.finish()
}

/// The part of a model that a command works on.
#[derive(Args)]
pub struct OnlyArguments {
    /// Use this solid instead of all regions
    #[arg(long, value_name = "NAME")]
    solid: Option<String>,
}

impl OnlyArguments {
    /// True if a solid is chosen.
    pub fn is_one(&self) -> bool {
        self.solid.is_some()
    }

    /// The model or, if a solid is chosen, a model with this solid as its only region.
    pub fn of(&self, scene: Scene) -> Result<Scene, Failure> {
        match &self.solid {
            Some(name) => Ok(scene.alone(name)?),
            None => Ok(scene),
        }
    }

    /// Like [`of`](Self::of), for the second of two models. A model whose only solid has another name, or none, is taken as a
    /// whole: the part in a mesh file has the name of the file.
    pub fn of_other(&self, scene: Scene) -> Result<Scene, Failure> {
        match &self.solid {
            Some(name)
                if scene.find_solid(name).is_err() && scene.solids.len() <= 1 && scene.regions.len() == 1 =>
            {
                let region = &scene.regions[0].name;
                crate::terminal::note(&format!(
                    "note: the second model has no solid `{name}`. Its only solid, `{region}`, is compared instead."
                ));
                Ok(scene)
            }
            _ => self.of(scene),
        }
    }

    /// Like [`of`](Self::of), for a model with its document, which a part of it does not have: the document has the other solids
    /// and regions.
    pub fn of_import(&self, imported: Imported) -> Result<Imported, Failure> {
        let stated = imported.stated.filter(|_| self.solid.is_none());
        Ok(Imported { scene: self.of(imported.scene)?, stated, ..imported })
    }
}

/// The solid that a command works on, and the evaluator.
#[derive(Args)]
pub struct SubjectArguments {
    /// Use this solid instead of all regions
    #[arg(long, value_name = "NAME")]
    pub solid: Option<String>,

    /// Evaluator: packets (many rays at a time), weave (one sweep along a ray), reference (direct) or single_hit (step by step); all return the same answers, bit for bit
    #[arg(long, value_name = "NAME", value_parser = rayweave::AnyEvaluator::NAMES)]
    pub evaluator: Option<String>,
}

/// Accuracy of measured volumes.
#[derive(Args)]
pub struct SamplingArguments {
    /// Stop when the half-width of the interval is at most this fraction of the volume
    #[arg(long, value_name = "P", default_value_t = 1e-3)]
    pub precision: f64,

    /// Confidence level of the intervals
    #[arg(long, value_name = "C", default_value_t = 0.99)]
    pub confidence: f64,

    /// Trace at most this many rays for a region, or for all regions together in a model of more than 32 regions; a first round for all
    /// regions does not count [default: 2^24, fewer if all rays would reach more than 2^23 shapes]
    #[arg(long, value_name = "N", value_parser = whole_number)]
    pub rays: Option<u64>,

    /// Seed of random numbers
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = any_count::<u64>)]
    pub seed: u64,
}

/// A box that limits a query.
#[derive(Args)]
pub struct WithinArguments {
    /// Consider only the part within a box from a lower to an upper corner, as -1,-1,0 1,1,2
    #[arg(long, num_args = 2, value_names = ["LO", "HI"], value_parser = point, allow_hyphen_values = true)]
    pub within: Option<Vec<[f64; 3]>>,
}

impl WithinArguments {
    /// The box.
    pub fn bounds(&self) -> Option<Bounds> {
        match self.within.as_deref() {
            Some(&[lo, hi]) => Some(Bounds { lo: Vec3::from(lo), hi: Vec3::from(hi) }),
            _ => None,
        }
    }
}

/// Parses `NAME=VALUE`.
fn definition(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("a definition is a name and a value, such as R=60".to_owned()),
    }
}

/// Parses three finite numbers, such as `1,-2.5,1e3`.
pub fn point(text: &str) -> Result<[f64; 3], String> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [x, y, z] = parts[..] else {
        let found = parts.len();
        let verb = if found == 1 { "was" } else { "were" };
        return Err(format!("a point is three numbers, such as 1,-2.5,1e3, but {found} {verb} given"));
    };
    Ok([number(x)?, number(y)?, number(z)?])
}

fn number(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if f64::is_finite(number) => Ok(number),
        Ok(_) => Err(format!("`{text}` is not finite")),
        Err(_) => Err(format!("`{text}` is not a number")),
    }
}

/// Parses a time, which may be infinite but not NaN.
pub fn time(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(t) if !t.is_nan() => Ok(t),
        _ => Err("a time is a finite number, inf or -inf".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points() {
        assert_eq!(point("1,-2.5,1e3"), Ok([1.0, -2.5, 1000.0]));
        assert_eq!(point(" 0 , .5 , -0 "), Ok([0.0, 0.5, 0.0]));
        assert_eq!(point("1,2,inf"), Err("`inf` is not finite".to_owned()));
        assert_eq!(point("1,2,nan"), Err("`nan` is not finite".to_owned()));
        assert_eq!(point("1,2,"), Err("`` is not a number".to_owned()));
        assert!(point("1,2").unwrap_err().ends_with("but 2 were given"));
        assert!(point("").unwrap_err().ends_with("but 1 was given"));
    }

    #[test]
    fn definitions() {
        let pair = |name: &str, value: &str| Ok((name.to_owned(), value.to_owned()));
        assert_eq!(definition("R=60"), pair("R", "60"));
        assert_eq!(definition(" R = 2*a = "), pair("R", "2*a ="));
        assert!(definition("R").is_err() && definition("=1").is_err() && definition("R=").is_err());
    }

    #[test]
    fn ranges() {
        assert_eq!(range("3:10"), Ok(3..10));
        for bad in ["", "3", "10:3", "-1:2", "a:b", "1:2:3"] {
            assert!(range(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn times() {
        assert_eq!(time("-inf"), Ok(f64::NEG_INFINITY));
        assert_eq!(time("1e-3"), Ok(0.001));
        assert!(time("nan").is_err() && time("soon").is_err());
    }
}
