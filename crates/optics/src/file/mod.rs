//! The `[optics]` tables of a model file.
//!
//! [`optics_of`] makes an [`Assembly`], its light and its settings of them. The solids are the regions of the model, in
//! their order; lengths are in the unit of the document. Wherever a number stands, arithmetic text over the parameters may
//! stand.
//!
//! ```toml
//! [optics]
//! branches = "both"         # where light is split: ideal (default) goes on, both follows both, random chooses one
//! polarised = false         # whether polarisation is followed; as a rule if a sheet or source asks for it
//! generation_limit = 1000   # after so many events a ray is dropped
//! threshold = 0             # below this power a ray is dropped
//! seed = 0                  # of random choices
//!
//! [optics.medium]           # what the media of the model are; otherwise the index of [medium.NAME] holds
//! glass = "N-BK7"           # a material of the catalogue, an index, { n = 1.5, k = 1e-6 }, "mirror", "absorber"
//! world = "air"             # vacuum if nothing is said of it
//! rod = { glass = "N-BK7", gradient = { selfoc = 0.3 } }   # an index that changes from place to place, or with n = 1.5
//!
//! [optics.face]             # finishes by region, or by region and face
//! "lens.front" = { coated = [[1.38, 0, 99.6]] }   # films as n, k, thickness in nm, the outermost first
//! "lens.rim" = "absorber"   # polished, absorber, or { mirror = 0.95 }, { splitter = 0.5 }, { diffuse = 0.8 }, { rough = 0.02 }
//!
//! [[optics.sheet]]          # made about the origin, with the normal along z
//! name = "screen"
//! circle = 40               # the diameter; or rectangle = [40, 30], ellipse = [40, 30]
//! opening = { circle = 10 } # a hole in the middle, if there is one; or, of a curved sheet, radius = -80 and conic = 0
//! action = "absorb"         # record, or { mirror = 0.9 }, { splitter = 0.5 }, { thin_lens = 50 }, { polariser = 30 },
//!                           # { retarder = [90, 45] }, { grating = { lines = [600, 0], order = 1, reflects = true } }
//! transform = [{ translate = [0, 0, 50] }]
//!
//! [[optics.source]]         # made about the origin, shining along z
//! beam = { circle = 20, rays = 1000, waist = 5 }
//! wavelength_nm = 587.6     # or [[486.1, 1], [656.3, 1]], { band = [400, 700] }, { black_body = [5772, 400, 700] }
//! power = 1                 # of all rays together
//! stokes = [1, 1, 0, 0]     # polarised along x; unpolarised if nothing is said
//! seed = 0
//! transform = [{ translate = [0, 0, -60] }]
//! ```
//!
//! The gradients are those of [`Gradient`](crate::gradient::Gradient): `selfoc = g`, `squared = [a0, a1, ..]`, `radial = [r0, r1, ..]`,
//! `axial = [c0, c1, ..]`, `fish_eye = radius`, `luneburg = radius`; a `transform` beside the gradient places it.
//!
//! A face is called by its name, by the first words of it between dots, or by any one of them; where several entries name a
//! face, the longest holds. Angles are in degrees: that of a polariser and the second of a retarder (after its retardance)
//! from x towards y; the lines of a grating are per unit of length, along x and y of the sheet.
//!
//! The other sources are `line = { length, rays }`, `circle = { diameter, rays }`, `cone = { angle, rays }`,
//! `wedge = { angle, rays }`, `lamp = { width, height, angle, rays }` and `point = { angle, rays }`. The angle of a wedge is
//! that between its outermost rays, all others are from the axis. A beam is Gaussian with a `waist`, the distance at which its
//! irradiance has fallen to 1/e^2, and even without; its rays, and those of a point, lie as `sampling` says: on a
//! `"fibonacci"` spiral, at `"random"`, on a `"grid"` or on `"hexapolar"` rings, of the last two about as many as `rays` says.
//! A `disc = { circle, angle, rays }` shines from random points of an outline by Lambert's law, or evenly with
//! `emission = "isotropic"`. `rays = { file = "light.csv" }` are those of a file beside the model
//! ([`ListedRays::read`](crate::source::ListedRays::read)), with their wavelengths and powers if it has them.

mod face;
mod gradient;
mod medium;
mod sheet;
mod source;

use crate::element::Element;
use crate::settings::{Branches, Settings};
use crate::source::{Source, Sources};
use crate::system::Assembly;
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Datum, Diagnostic, Diagnostics, Document, Scene, Span, Spanned};
use std::path::Path;

/// What the `[optics]` tables of a model say.
#[derive(Clone, Debug)]
pub struct OpticalScene {
    /// The regions of the model as solids, then the sheets.
    pub assembly: Assembly,
    /// The light.
    pub sources: Sources,
    /// How it is followed.
    pub settings: Settings,
}

/// Reads the `[optics]` tables of a model.
///
/// # Errors
/// All problems at once: no such table, keys that are unknown or missing, values out of range, materials, media and faces
/// that do not exist, names that are given twice, wavelengths at which the index of a medium is not known.
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
            Diagnostic::error("the model has no [optics] table").why("it says what shines, and on what");
        return Err(problem.in_file(&document.source).into());
    };
    let mut reader = Reader::new(document, scene);
    let read = reader.keys("optics", table.value.clone());
    let read = read.and_then(|keys| optics(&mut reader, document, scene, keys));
    reader.finish(read)
}

/// A source, the wavelengths that it sends out, and where they are said.
struct ReadSource {
    source: Source,
    range_nm: [f64; 2],
    span: Span,
}

fn optics(reader: &mut Reader, document: &Document, scene: &Scene, mut keys: Keys) -> Option<OpticalScene> {
    let (mut settings, polarised) = settings(reader, &mut keys);
    let media = medium::read(reader, document, scene, &mut keys);
    let elements = face::read(reader, scene, &media, &mut keys);
    let taken = scene.regions.iter().map(|region| region.name.clone()).collect();
    let sheets = sheet::read(reader, &mut keys, taken);
    let folder = document.source.path().and_then(|path| path.parent()).unwrap_or(Path::new(""));
    let sources = source::read(reader, &mut keys, folder);
    sources.iter().for_each(|source| check_wavelengths(reader, source, &media));
    reader.refuse_the_rest(keys);
    let is_polarised = |source: &ReadSource| source.source.is_polarised();
    settings.polarised = polarised
        .unwrap_or_else(|| sheets.iter().any(Element::polarises) || sources.iter().any(is_polarised));
    let world = media.world()?;
    let empty = Assembly::new().world(world).unit_nm(1e9 * scene.unit.metres());
    let assembly = elements.into_iter().chain(sheets).fold(empty, Assembly::add);
    let sources = Sources::new(sources.into_iter().map(|read| read.source).collect());
    Some(OpticalScene { assembly, sources, settings })
}

/// The settings, and whether they say that polarisation is followed: if they do not, it is where anything asks for it.
fn settings(reader: &mut Reader, keys: &mut Keys) -> (Settings, Option<bool>) {
    let default = Settings::default();
    let choices = [(Branches::Ideal, "ideal"), (Branches::Both, "both"), (Branches::Random, "random")];
    let branches = keys.take("branches").and_then(|datum| reader.choice("branches", datum, &choices));
    let polarised = keys.take("polarised").and_then(|datum| reader.truth("polarised", datum));
    let limit = keys.take("generation_limit");
    let limit = limit.and_then(|datum| reader.whole("generation_limit", datum, 0, u64::from(u32::MAX)));
    let threshold = keys.take("threshold").and_then(|datum| {
        reader.checked("threshold", datum, "finite and at least 0", |value| value >= 0.0 && value.is_finite())
    });
    let settings = Settings {
        branches: branches.unwrap_or(default.branches),
        generation_limit: limit.map_or(default.generation_limit, |limit| limit as u32),
        threshold: threshold.unwrap_or(default.threshold),
        seed: seed(reader, keys).unwrap_or(default.seed),
        ..default
    };
    (settings, polarised)
}

fn seed(reader: &mut Reader, keys: &mut Keys) -> Option<u64> {
    keys.take("seed").and_then(|datum| reader.whole("seed", datum, 0, 1 << 53))
}

/// Reports the first medium whose index is not known at all wavelengths of a source.
fn check_wavelengths(reader: &mut Reader, source: &ReadSource, media: &medium::Media) {
    let [shortest, longest] = source.range_nm;
    let is_unknown = |[from, to]: [f64; 2]| shortest < from || longest > to;
    let Some(medium) = media.dispersive().find(|medium| is_unknown(medium.range_nm())) else { return };
    let [from, to] = medium.range_nm();
    let light = match shortest == longest {
        true => format!("{shortest} nm"),
        false => format!("{shortest} nm to {longest} nm"),
    };
    let problem = Diagnostic::error(format!("the source shines at {light}"));
    let reason = format!("the index of `{}` is known from {from} nm to {to} nm", medium.name());
    reader.report(problem.why(reason), source.span);
}

/// A word, or a table of one key: `"absorb"`, `{ mirror = 0.9 }`.
enum Said {
    Word(Spanned<String>),
    Of(Spanned<String>, Spanned<Datum>),
}

/// What is said of `what`: one of the words, or one of the keys with its value.
fn said(
    reader: &mut Reader,
    what: &str,
    datum: Spanned<Datum>,
    words: &[&str],
    keys: &[&str],
) -> Option<Said> {
    match datum.value {
        Datum::Text(word) => {
            let word = Spanned::new(word, datum.span);
            let is_known = words.contains(&word.value.as_str());
            if keys.contains(&word.value.as_str()) {
                let problem = Diagnostic::error(format!("{what} `{}` has no value", word.value));
                let suggestion = format!("{{ {} = ... }}", word.value);
                reader.report(problem.why("it is a table of one key").suggest(Some(suggestion)), datum.span);
            } else if !is_known {
                reader.unknown(what, &word, &[words, keys].concat());
            }
            is_known.then_some(Said::Word(word))
        }
        Datum::Table(mut table) if table.len() == 1 => {
            let (key, value) = table.pop()?;
            let is_known = keys.contains(&key.value.as_str());
            if words.contains(&key.value.as_str()) {
                let problem = Diagnostic::error(format!("{what} `{}` takes no value", key.value));
                let suggestion = format!("\"{}\"", key.value);
                reader.report(problem.why("it is a word").suggest(Some(suggestion)), key.span);
            } else if !is_known {
                reader.unknown(what, &key, &[words, keys].concat());
            }
            is_known.then_some(Said::Of(key, value))
        }
        _ => {
            let [words, keys] = [words, keys].map(|names| names.join(", "));
            let wanted = format!("one of the words {words}, or a table of one of {keys}");
            reader.wrong_type(what, &datum, &wanted);
            None
        }
    }
}

/// A part of the power, from 0 to 1.
fn fraction(reader: &mut Reader, what: &str, datum: Spanned<Datum>) -> Option<f64> {
    reader.checked(what, datum, "from 0 to 1", |value| (0.0..=1.0).contains(&value))
}

/// A finite number.
fn finite(reader: &mut Reader, what: &str, datum: Spanned<Datum>) -> Option<f64> {
    reader.checked(what, datum, "finite", f64::is_finite)
}

/// The items of a list.
fn list(reader: &mut Reader, what: &str, datum: Spanned<Datum>, wanted: &str) -> Option<Vec<Spanned<Datum>>> {
    match datum.value {
        Datum::List(list) => Some(list),
        _ => {
            reader.wrong_type(what, &datum, wanted);
            None
        }
    }
}
