//! Reader of the `[optics]` tables of a model file.
//!
//! [`optics_of`] reads an [`Assembly`], its light sources and its settings. The solids are the
//! regions of the model, in their order; lengths are in the unit of the document. Every number may
//! also be an arithmetic expression of the parameters.
//!
//! ```toml
//! [optics]
//! branches = "both"         # at partial reflection: ideal (default) transmits without loss, both traces both, random chooses one
//! polarised = false         # whether polarisation is traced; by default if a sheet or source needs it
//! generation_limit = 1000   # the number of events after which a ray is dropped
//! threshold = 0             # the power below which a ray is dropped
//! seed = 0                  # of random numbers
//!
//! [optics.medium]           # materials of the media of the model; otherwise the index of [medium.NAME]
//! glass = "N-BK7"           # a material of the catalogue, an index, { n = 1.5, k = 1e-6 }, "mirror", "absorber"
//! world = "air"             # vacuum by default
//! rod = { glass = "N-BK7", gradient = { selfoc = 0.3 } }   # a gradient index, or with n = 1.5
//!
//! [optics.face]             # finishes by region, or by region and face
//! "lens.front" = { coated = [[1.38, 0, 99.6]] }   # films as n, k, thickness in nm, the outermost first
//! "lens.rim" = "absorber"   # polished, absorber, or { mirror = 0.95 }, { splitter = 0.5 }, { diffuse = 0.8 }, { rough = 0.02 }
//!
//! [[optics.sheet]]          # centred at the origin, with the normal along z
//! name = "screen"
//! circle = 40               # the diameter; or rectangle = [40, 30], ellipse = [40, 30]
//! opening = { circle = 10 } # an optional central hole; a curved sheet has radius = -80 and conic = 0 too
//! action = "absorb"         # record, or { mirror = 0.9 }, { splitter = 0.5 }, { thin_lens = 50 }, { polariser = 30 },
//!                           # { retarder = [90, 45] }, { grating = { lines = [600, 0], order = 1, reflects = true } }
//! transform = [{ translate = [0, 0, 50] }]
//!
//! [[optics.source]]         # at the origin, emitting along z
//! beam = { circle = 20, rays = 1000, waist = 5 }
//! wavelength_nm = 587.6     # or [[486.1, 1], [656.3, 1]], { band = [400, 700] }, { black_body = [5772, 400, 700] }
//! power = 1                 # of all rays together
//! stokes = [1, 1, 0, 0]     # polarised along x; unpolarised by default
//! seed = 0
//! transform = [{ translate = [0, 0, -60] }]
//! ```
//!
//! The gradients are those of [`Gradient`](crate::gradient::Gradient): `selfoc = g`,
//! `squared = [a0, a1, ..]`, `radial = [r0, r1, ..]`, `axial = [c0, c1, ..]`, `fish_eye = radius`,
//! `luneburg = radius`; a `transform` next to the gradient places it.
//!
//! The key of a face is its name, the leading parts of that name (parts are separated by dots), or
//! any single part; if several entries apply to a face, the longest key has precedence. Angles are
//! in degrees; the angle of a polariser, and the second number of a retarder (after its
//! retardance), are measured from x towards y. The lines of a grating are per unit of length, along
//! x and y of the sheet.
//!
//! The other sources are `line = { length, rays }`, `circle = { diameter, rays }`,
//! `cone = { angle, rays }`, `wedge = { angle, rays }`, `lamp = { width, height, angle, rays }` and
//! `point = { angle, rays }`. The angle of a wedge is that between its outermost rays, all other
//! angles are measured from the axis. A beam is Gaussian with a `waist`, the distance at which its
//! irradiance has fallen to 1/e^2, and uniform without one; `sampling` of beams and points is a
//! `"fibonacci"` spiral, `"random"`, a `"grid"` or `"hexapolar"` rings, the last two with about
//! `rays` rays. A `disc = { circle, angle, rays }` emits from random points of an outline according
//! to Lambert's cosine law, or isotropically with `emission = "isotropic"`.
//! `rays = { file = "light.csv" }` reads a file next to the model
//! ([`ListedRays::read`](crate::source::ListedRays::read)), optionally with wavelengths and powers.

mod face;
mod gradient;
mod medium;
mod sheet;
mod source;
mod values;

use source::ReadSource;
use values::seed;

use crate::element::Element;
use crate::settings::{Branches, TraceSettings};
use crate::source::Sources;
use crate::system::Assembly;
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Diagnostic, Diagnostics, Document, Scene};

/// The optics of a model: assembly, sources and settings.
#[derive(Clone, Debug)]
pub struct OpticalScene {
    /// The regions of the model as solids, then the sheets.
    pub assembly: Assembly,
    /// The light.
    pub sources: Sources,
    /// The settings of the trace.
    pub settings: TraceSettings,
}

/// Reads the `[optics]` tables of a model.
///
/// # Errors
/// All problems at once: a missing table, unknown or missing keys, values out of range, unknown
/// materials, media and faces, duplicate names, wavelengths outside the range of a medium.
///
/// ```
/// let text = r#"
/// rayweave = 1
/// [solid.ball]
/// sphere = { radius = 10 }
/// [optics.medium]
/// ball = "N-BK7"
/// [[optics.source]]
/// beam = { circle = 1, rays = 100 }
/// wavelength_nm = 587.6
/// transform = [{ translate = [0, 0, -50] }]
/// "#;
/// let (document, scene) = rayweave_scene::parse(text)?;
/// let optics = rayweave_optics::file::optics_of(&document, &scene)?;
/// assert_eq!(optics.sources.count(), 100);
/// let system = optics.assembly.compile()?;
/// assert_eq!(system.element_names(), ["ball"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn optics_of(document: &Document, scene: &Scene) -> Result<OpticalScene, Diagnostics> {
    let Some(table) = document.foreign("optics") else {
        let problem =
            Diagnostic::error("the model has no [optics] table").why("it defines sources and materials");
        return Err(problem.in_file(&document.source).into());
    };
    let mut reader = Reader::new(document, scene);
    let read = reader.keys("optics", table.value.clone());
    let read = read.and_then(|keys| optics(&mut reader, document, scene, keys));
    reader.finish(read)
}

fn optics(reader: &mut Reader, document: &Document, scene: &Scene, mut keys: Keys) -> Option<OpticalScene> {
    let (mut settings, polarised) = settings(reader, &mut keys);
    let media = medium::read(reader, document, scene, &mut keys);
    let elements = face::read(reader, scene, &media, &mut keys);
    let taken = scene.regions.iter().map(|region| region.name.clone()).collect();
    let sheets = sheet::read(reader, &mut keys, taken);
    let sources = source::read(reader, &mut keys, &document.files());
    sources.iter().for_each(|source| check_wavelengths(reader, source, &media));
    reader.reject_unknown(keys);
    let is_polarised = |source: &ReadSource| source.source.is_polarised();
    settings.polarised = polarised
        .unwrap_or_else(|| sheets.iter().any(Element::polarises) || sources.iter().any(is_polarised));
    let world = media.world()?;
    let empty = Assembly::new().world(world).unit_nm(1e9 * scene.unit.metres());
    let assembly = elements.into_iter().chain(sheets).fold(empty, Assembly::add);
    let sources = Sources::new(sources.into_iter().map(|read| read.source).collect());
    Some(OpticalScene { assembly, sources, settings })
}

/// The settings, and whether polarisation is traced; `None` to trace it where an element or source needs it.
fn settings(reader: &mut Reader, keys: &mut Keys) -> (TraceSettings, Option<bool>) {
    let default = TraceSettings::default();
    let choices = [(Branches::Ideal, "ideal"), (Branches::Both, "both"), (Branches::Random, "random")];
    let branches = keys.take("branches").and_then(|datum| reader.choice("branches", datum, &choices));
    let polarised = keys.take("polarised").and_then(|datum| reader.boolean("polarised", datum));
    let limit = keys.take("generation_limit");
    let limit = limit.and_then(|datum| reader.whole("generation_limit", datum, 0, u64::from(u32::MAX)));
    let threshold = keys.take("threshold").and_then(|datum| {
        reader.checked("threshold", datum, "finite and at least 0", |value| value >= 0.0 && value.is_finite())
    });
    let settings = TraceSettings {
        branches: branches.unwrap_or(default.branches),
        generation_limit: limit.map_or(default.generation_limit, |limit| limit as u32),
        threshold: threshold.unwrap_or(default.threshold),
        seed: seed(reader, keys).unwrap_or(default.seed),
        ..default
    };
    (settings, polarised)
}

/// Reports the first medium whose range does not contain all wavelengths of a source.
fn check_wavelengths(reader: &mut Reader, source: &ReadSource, media: &medium::Media) {
    let [shortest, longest] = source.range_nm;
    let is_unknown = |[from, to]: [f64; 2]| shortest < from || longest > to;
    let Some(medium) = media.dispersive().find(|medium| is_unknown(medium.range_nm())) else { return };
    let [from, to] = medium.range_nm();
    let light = match shortest == longest {
        true => format!("{shortest} nm"),
        false => format!("{shortest} nm to {longest} nm"),
    };
    let problem = Diagnostic::error(format!("the source emits at {light}"));
    let reason = format!("the index of `{}` is known from {from} nm to {to} nm", medium.name());
    reader.report(problem.why(reason), source.span);
}
