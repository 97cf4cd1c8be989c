//! Lens files as optical systems: a sequential prescription converted to solids, with the light of its fields.

use crate::arguments::{ModelArguments, debug_hash};
use crate::failure::Failure;
use crate::lens_input;
use crate::terminal;
use rayweave::lens::analysis::{PupilQuadrature, needs_aiming};
use rayweave::lens::prescription::{IMAGE, Prescription, PrescriptionError};
use rayweave::optics::file::OpticalScene;
use rayweave::optics::source::{ListedRays, Pattern, Power, Source, Sources};
use rayweave::optics::{Beam, TraceSettings};

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

/// The solids of a lens file with the light of its fields.
pub fn load(model: &ModelArguments) -> Result<Bench, Failure> {
    let lens = model.lens()?;
    let wrong = |error: &dyn std::error::Error| lens_input::wrong(&model.model, error);
    let layout = lens.assembly().map_err(|error| wrong(&error))?;
    let (assembly, sequence) = (layout.assembly, layout.sequence);
    let name = model.model.display().to_string();
    let sources = (0..lens.fields.len()).map(|field| source(&lens, field, &name));
    let sources = sources.collect::<Result<Vec<_>, _>>().map_err(|error| wrong(error.as_ref()))?;
    let rays = (PupilQuadrature::gaussian(RINGS).points.len() * lens.lines.len()) as f64;
    let settings = TraceSettings { threshold: FAINTEST / rays, ..TraceSettings::default() };
    let optics = OpticalScene { assembly, sources: Sources::new(sources), settings };
    let (unit, fields) = (lens_input::unit(&lens), lens_input::field_texts(&lens));
    let identity = debug_hash(&lens);
    Ok(Bench { identity, optics, unit, image: Some(IMAGE), sequence, fields, lens: Some(Box::new(lens)) })
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
