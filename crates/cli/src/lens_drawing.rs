//! The layout of a lens file: a few rays of each field, evenly spaced in the pupil, up to the image.

use rayweave::lens::analysis::{Study, fan_x, fan_y, needs_aiming};
use rayweave::lens::prescription::{MOUNT, Prescription, PrescriptionError, PrescriptionLayout};
use rayweave::optics::source::{ListedRays, Pattern, Source, Sources};
use rayweave::optics::{Assembly, Light, System, Tracer};
use rayweave::{Packets, Vec3};

type Problem = Box<dyn std::error::Error>;

/// The default number of rays of each field.
const RAYS: usize = 5;

/// A lens with the light of its drawing.
pub struct LensDrawing {
    pub system: System,
    /// The elements in the order in which light reaches them; the image is the last one.
    pub sequence: Vec<usize>,
    /// A source for each field.
    pub light: Sources,
    /// The edges of the stop.
    pub stop: Vec<[Vec3; 2]>,
}

/// The contents of a drawing.
#[derive(Clone, Copy)]
pub struct DrawingOptions {
    /// The number of rays of all fields together.
    pub rays: Option<usize>,
    /// True for a section along x instead of y.
    pub is_along_x: bool,
    /// True for rays of all wavelengths instead of the primary one.
    pub has_all_wavelengths: bool,
}

impl LensDrawing {
    /// The lens with an image as wide as its light.
    pub fn new(lens: &Prescription, options: DrawingOptions) -> Result<LensDrawing, Problem> {
        let lines: Vec<f64> = match options.has_all_wavelengths {
            true => lens.lines.iter().map(|line| line.wavelength_nm).collect(),
            false => vec![lens.primary_nm()],
        };
        let bundles = lens.fields.len() * lines.len();
        let count = options.rays.map_or(RAYS, |rays| (rays / bundles.max(1)).max(1));
        let points = match (count, options.is_along_x) {
            (1, _) => vec![[0.0; 2]],
            (_, true) => fan_x(count),
            (_, false) => fan_y(count),
        };
        let mut drawn = lens.clone();
        drawn.image.semi_diameter = Some(image_semi_diameter(lens, &points)?);
        let PrescriptionLayout { assembly, mut sequence, semi_diameters, .. } = drawn.assembly()?;
        // the drawing has the edges of the stop in place of the plate around a lens, which is wider than all lenses
        let parts = assembly.elements().iter().filter(|element| element.name() != MOUNT);
        let system =
            parts.fold(Assembly::new().unit_nm(lens.unit_nm), |all, part| all.add(part.clone())).compile()?;
        if let Some(image) = sequence.last_mut() {
            *image = system.element_names().len() - 1;
        }
        let front = front(lens, &system);
        let light = (0..lens.fields.len()).map(|field| source(lens, field, &lines, &points, front));
        let light = Sources::new(light.collect::<Result<_, _>>()?);
        let stop = stop(lens, &semi_diameters, options.is_along_x)?;
        Ok(LensDrawing { system, sequence, light, stop })
    }
}

/// The stated semi-diameter of the image, or that of the light of all fields plus 2 %; at least a twentieth of that of the
/// largest surface, so that a point is visible.
fn image_semi_diameter(lens: &Prescription, points: &[[f64; 2]]) -> Result<f64, Problem> {
    let layout = lens.assembly()?;
    let system = layout.assembly.compile()?;
    let tracer = Tracer::new(&system, Packets::new);
    let nm = lens.primary_nm();
    let mut widest: f64 = 0.0;
    for field in 0..lens.fields.len() {
        let study = Study::new(lens, &layout, &tracer);
        let study = if needs_aiming(lens, field, nm)? { study.aimed() } else { study };
        // a field without light does not count
        for arrival in study.arrivals(field, nm, points).unwrap_or_default() {
            widest = widest.max(libm::hypot(arrival.position.x, arrival.position.y));
        }
    }
    let (_, surfaces) = layout.semi_diameters.split_last().unwrap_or((&0.0, &[]));
    let largest = surfaces.iter().copied().fold(0.0, f64::max);
    Ok(lens.image.semi_diameter.unwrap_or(1.02 * widest).max(0.05 * largest))
}

/// The place along z where rays start: a little in front of the solids if the object is far away, so that the lens is not
/// tiny in the drawing.
fn front(lens: &Prescription, system: &System) -> Option<f64> {
    let track: f64 = lens.surfaces.iter().map(|surface| surface.thickness.abs()).sum();
    let bounds = system.program().bounds();
    let is_distant = lens.object_distance > 2.0 * track && bounds.is_finite() && !bounds.is_empty();
    is_distant.then_some(bounds.lo.z - 0.2 * (bounds.hi.z - bounds.lo.z))
}

fn source(
    lens: &Prescription,
    field: usize,
    lines: &[f64],
    points: &[[f64; 2]],
    front: Option<f64>,
) -> Result<Source, Problem> {
    let (mut origins, mut directions, mut wavelengths) = (Vec::new(), Vec::new(), Vec::new());
    for &nm in lines {
        for light in rays(lens, field, nm, points)? {
            let (origin, direction) = (light.ray.origin, light.ray.direction);
            let step = front.map_or(0.0, |z| (z - origin.z) / direction.z);
            // a ray across the axis never gets there
            let step = if step.is_finite() { step } else { 0.0 };
            origins.push(origin + step * direction);
            directions.push(direction);
            wavelengths.push(nm);
        }
    }
    Ok(Source::new(Pattern::Rays(ListedRays::new(origins, directions, Some(wavelengths), None)?))?)
}

/// The rays of a field at a wavelength, aimed where this is needed; without those that do not reach the stop.
fn rays(
    lens: &Prescription,
    field: usize,
    nm: f64,
    points: &[[f64; 2]],
) -> Result<Vec<Light>, PrescriptionError> {
    if !needs_aiming(lens, field, nm)? {
        let beam = lens.beam(field, nm, points)?;
        return Ok((0..beam.len()).map(|k| beam.get(k)).collect());
    }
    let aimed = points.iter().filter_map(|&point| lens.beam_at_stop(field, nm, &[point]).ok());
    Ok(aimed.map(|beam| beam.get(0)).collect())
}

/// The edges of the stop as lines away from the axis; none behind a coordinate break.
fn stop(
    lens: &Prescription,
    semi_diameters: &[f64],
    is_along_x: bool,
) -> Result<Vec<[Vec3; 2]>, PrescriptionError> {
    let place = lens.stop - 1;
    if lens.breaks.iter().any(|own| own.before <= lens.stop) {
        return Ok(Vec::new());
    }
    let surface = &lens.surfaces[place];
    let height = match surface.semi_diameter {
        Some(stated) => stated,
        None => lens.first_order(lens.primary_nm())?.stop_semi_diameter,
    };
    let at = |height: f64| if is_along_x { [height, 0.0] } else { [0.0, height] };
    let sag = surface.form().sag(at(height)).filter(|_| height.is_finite());
    let Some(sag) = sag else { return Ok(Vec::new()) };
    let z = lens.surfaces[..place].iter().map(|surface| surface.thickness).sum::<f64>() + sag;
    let end = 1.35 * semi_diameters.get(place).copied().unwrap_or(0.0).max(height);
    let edge = |side: f64| {
        [height, end].map(|height| {
            let [x, y] = at(side * height);
            Vec3::new(x, y, z)
        })
    };
    Ok(vec![edge(1.0), edge(-1.0)])
}
