//! Lens files as models: a sequential prescription converted to solids, with the light of its
//! fields.

use crate::arguments::{ModelArguments, debug_hash};
use crate::failure::Failure;
use crate::terminal::{self, short};
use rayweave::lens::analysis::{PupilQuadrature, needs_aiming};
use rayweave::lens::prescription::{FieldKind, IMAGE, Prescription, PrescriptionError, read_zmx};
use rayweave::optics::file::OpticalScene;
use rayweave::optics::source::{ListedRays, Pattern, Power, Source, Sources};
use rayweave::optics::{Beam, TraceSettings};
use rayweave::scene::{Unit, nearby_sentence, read_bytes};
use std::path::Path;

/// The number of rings of rays in the pupil, 880 rays for each field and wavelength: 20 rings leave an error of RMS radii
/// of about 1 % where half of the pupil is vignetted; a clear pupil needs fewer.
const RINGS: usize = 20;

/// The fraction of a ray's power below which ghosts are not traced: a lens that reflects at
/// every face has infinitely many ghosts.
const FAINTEST: f64 = 1e-6;

/// An optical system with its light.
pub struct Bench {
    /// A hash of the document or lens, the same on every machine; without the contents of files of rays.
    pub identity: String,
    pub optics: OpticalScene,
    /// The symbol of its unit of length.
    pub unit: &'static str,
    /// The name of the sheet at the image, if the model is a lens file.
    pub image: Option<&'static str>,
    /// The elements of a lens file in the order in which light reaches them; empty for other models.
    pub sequence: Vec<usize>,
    /// The coordinates of the fields of a lens file, one for each source; empty for other models.
    pub fields: Vec<String>,
    /// The prescription of a lens file.
    pub lens: Option<Box<Prescription>>,
}

/// True if a path has the extension of a lens file.
pub fn is_one(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("zmx"))
}

/// Reads a lens file; ignored and replaced entries are reported on standard error.
pub fn read(model: &ModelArguments) -> Result<Prescription, Failure> {
    let path = &model.model;
    if let Some((name, _)) = model.definitions.first() {
        let problem = format!("--define {name}: a lens file has no parameters");
        return Err(Failure::Usage(format!("{problem}: only Rayweave's own models have them.")));
    }
    let name = path.display();
    let unreadable =
        |reason| Failure::Input(format!("{name}: cannot be read: {reason}.{}", nearby_sentence(path)));
    let bytes = read_bytes(path).map_err(unreadable)?;
    let read = read_zmx(&bytes).map_err(|error| wrong(model, &error))?;
    if let (true, Some(note)) = (model.strict, read.notes.first()) {
        return Err(Failure::Input(format!("{name}: {note}")));
    }
    for note in &read.notes {
        terminal::caution(&format!("{name}: {note}"));
    }
    Ok(read.prescription)
}

/// The failure of an error about a lens file, line by line.
pub fn wrong(model: &ModelArguments, error: &dyn std::error::Error) -> Failure {
    let name = model.model.display();
    let lines: Vec<String> = error.to_string().lines().map(|line| format!("{name}: {line}")).collect();
    Failure::Input(lines.join("\nerror: "))
}

/// The solids of a lens file with the light of its fields.
pub fn load(model: &ModelArguments) -> Result<Bench, Failure> {
    let lens = read(model)?;
    let wrong = |error: &dyn std::error::Error| wrong(model, error);
    let layout = lens.assembly().map_err(|error| wrong(&error))?;
    let (assembly, sequence) = (layout.assembly, layout.sequence);
    let name = model.model.display().to_string();
    let sources = (0..lens.fields.len()).map(|field| source(&lens, field, &name));
    let sources = sources.collect::<Result<Vec<_>, _>>().map_err(|error| wrong(error.as_ref()))?;
    let rays = (PupilQuadrature::gaussian(RINGS).points.len() * lens.lines.len()) as f64;
    let settings = TraceSettings { threshold: FAINTEST / rays, ..TraceSettings::default() };
    let optics = OpticalScene { assembly, sources: Sources::new(sources), settings };
    let (unit, fields) = (unit(&lens), field_texts(&lens));
    let identity = debug_hash(&lens);
    Ok(Bench { identity, optics, unit, image: Some(IMAGE), sequence, fields, lens: Some(Box::new(lens)) })
}

/// The symbol of the unit of length of a lens; empty for an unusual one.
pub fn unit(lens: &Prescription) -> &'static str {
    Unit::of_metres(1e-9 * lens.unit_nm).map_or("", Unit::symbol)
}

/// The coordinates of the fields of a lens.
pub fn field_texts(lens: &Prescription) -> Vec<String> {
    lens.fields.iter().map(|&place| field_text(lens.field_kind, place, unit(lens))).collect()
}

/// The fields of a lens for legends: a number for a field along y.
pub fn field_names(lens: &Prescription) -> Vec<String> {
    let name = |&[x, y]: &[f64; 2]| match (x == 0.0, lens.field_kind) {
        (true, FieldKind::Angle) => format!("{}\u{b0}", short(y)),
        (true, _) => format!("{} {}", short(y), unit(lens)),
        (false, kind) => field_text(kind, [x, y], unit(lens)),
    };
    lens.fields.iter().map(name).collect()
}

/// The coordinates of a field with their unit.
fn field_text(kind: FieldKind, place: [f64; 2], unit: &str) -> String {
    let coordinates = place.map(short).join(", ");
    match kind {
        FieldKind::Angle => format!("({coordinates})\u{b0}"),
        FieldKind::ObjectHeight | FieldKind::ImageHeight => format!("({coordinates}) {unit}"),
    }
}

/// The light of a field, with a total power of 1, divided among the wavelengths by weight and among the rays by the area
/// of the pupil that they stand for, so that RMS radii do not depend on the number of rings.
fn source(lens: &Prescription, field: usize, name: &str) -> Result<Source, Box<dyn std::error::Error>> {
    let (mut origins, mut directions) = (Vec::new(), Vec::new());
    let (mut wavelengths, mut powers) = (Vec::new(), Vec::new());
    for line in &lens.lines {
        let (beam, weights) = beam(lens, field, line.wavelength_nm, name)?;
        for (k, weight) in weights.into_iter().enumerate() {
            let ray = beam.get(k).ray;
            origins.push(ray.origin);
            directions.push(ray.direction);
            wavelengths.push(line.wavelength_nm);
            powers.push(line.weight * weight);
        }
    }
    let rays = ListedRays::new(origins, directions, Some(wavelengths), Some(powers))?;
    let total = rays.power().unwrap_or(1.0);
    Ok(Source::new(Pattern::Rays(rays))?.power(Power::PerRay(1.0 / total))?)
}

/// Rays through the entrance pupil, aimed at the stop where the real pupil is far from the paraxial one, with their
/// weights.
fn beam(
    lens: &Prescription,
    field: usize,
    wavelength_nm: f64,
    name: &str,
) -> Result<(Beam, Vec<f64>), PrescriptionError> {
    let PupilQuadrature { points, weights } = PupilQuadrature::gaussian(RINGS);
    if !needs_aiming(lens, field, wavelength_nm)? {
        return Ok((lens.beam(field, wavelength_nm, &points)?, weights));
    }
    let aimed = points.iter().zip(&weights).filter_map(|(&point, &weight)| {
        lens.beam_at_stop(field, wavelength_nm, &[point]).ok().map(|beam| (beam.get(0), weight))
    });
    let (rays, kept): (Vec<_>, Vec<f64>) = aimed.unzip();
    let lost = points.len() - rays.len();
    let lost = if lost > 0 { format!("; {lost} rays do not reach it") } else { String::new() };
    let text = "rays are aimed at the stop, since the real entrance pupil is far from the paraxial one";
    terminal::caution(&format!("{name}: field {field}, {wavelength_nm} nm: {text}{lost}"));
    Ok((rays.into_iter().collect(), kept))
}
