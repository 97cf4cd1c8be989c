//! Reader of `[[optics.source]]`.

use super::values::{aperture, list, seed, transform};
use crate::source::{BeamProfile, Emission, ListedRays, Pattern, Power, Sampling, Source, Spectrum};
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Datum, Diagnostic, Span, Spanned};
use rayweave_table::AllowedFiles;

const PATTERNS: [&str; 9] = ["beam", "line", "circle", "cone", "wedge", "lamp", "point", "disc", "rays"];

/// A source, its range of wavelengths, and their location in the file.
pub(super) struct ReadSource {
    pub source: Source,
    pub range_nm: [f64; 2],
    pub span: Span,
}

/// The sources, with rays in the given files.
pub(super) fn read(reader: &mut Reader, keys: &mut Keys, files: &AllowedFiles) -> Vec<ReadSource> {
    let Some(datum) = keys.take("source") else { return Vec::new() };
    let tables = reader.tables("optics.source", datum);
    tables.into_iter().filter_map(|keys| source(reader, keys, files)).collect()
}

fn source(reader: &mut Reader, mut keys: Keys, files: &AllowedFiles) -> Option<ReadSource> {
    let span = keys.span();
    let emitter = pattern_source(reader, &mut keys, files);
    let own = emitter.as_ref().and_then(|(_, listed)| listed.clone());
    let (spectrum, spectrum_at) =
        with_span(reader, &mut keys, "wavelength_nm", Spectrum::default(), spectrum);
    let own_range = own.as_ref().and_then(ListedRays::range_nm);
    if own_range.is_some() && spectrum_at != span {
        let problem = Diagnostic::error("the rays have their own wavelengths");
        reader.report(problem.why("the file has a column of wavelengths"), spectrum_at);
    }
    let all = own.as_ref().and_then(ListedRays::power).unwrap_or(1.0);
    let (power, power_at) = with_span(reader, &mut keys, "power", all, power);
    let stokes = stokes(reader, &mut keys);
    let seed = seed(reader, &mut keys).unwrap_or(0);
    let map = transform(reader, &mut keys);
    reader.reject_unknown(keys);
    // check each of them, even if another is invalid
    let spectrum = spectrum.filter(|spectrum| reader.accept(spectrum.wavelengths(), spectrum_at).is_some());
    let powered = emitter.and_then(|(source, _)| reader.accept(source.power(Power::Total(power?)), power_at));
    let (source, spectrum) = (powered?.seed(seed), spectrum?);
    let source = reader.accept(source.spectrum(&spectrum), spectrum_at)?;
    let source = match stokes? {
        Some((parameters, span)) => reader.accept(source.stokes(parameters), span)?,
        None => source,
    };
    let source = reader.accept(source.apply(&map?), span)?;
    let range_nm = own_range.unwrap_or_else(|| range_nm(&spectrum));
    Some(ReadSource { source, range_nm, span: spectrum_at })
}

/// The Stokes parameters and their span: `Some(None)` if they are absent, `None` if they are
/// invalid.
fn stokes(reader: &mut Reader, keys: &mut Keys) -> Option<Option<([f64; 4], Span)>> {
    let Some(datum) = keys.take("stokes") else { return Some(None) };
    let span = datum.span;
    let parameters = reader.numbers("stokes", datum)?;
    Some(Some((parameters, span)))
}

/// A value and its span, or a default with the span of the table.
fn with_span<T>(
    reader: &mut Reader,
    keys: &mut Keys,
    key: &'static str,
    otherwise: T,
    read: impl FnOnce(&mut Reader, Spanned<Datum>) -> Option<T>,
) -> (Option<T>, Span) {
    match keys.take(key) {
        Some(datum) => {
            let span = datum.span;
            (read(reader, datum), span)
        }
        None => (Some(otherwise), keys.span()),
    }
}

fn power(reader: &mut Reader, datum: Spanned<Datum>) -> Option<f64> {
    let holds = |power: f64| power > 0.0 && power.is_finite();
    reader.checked("power", datum, "finite and greater than 0", holds)
}

/// The source of a pattern, and its rays if they are from a file.
fn pattern_source(
    reader: &mut Reader,
    keys: &mut Keys,
    files: &AllowedFiles,
) -> Option<(Source, Option<ListedRays>)> {
    let (kind, datum) = reader.one_of(keys, &PATTERNS)?;
    let span = datum.span;
    let mut own = reader.keys(&kind.value, datum)?;
    let pattern = match kind.value.as_str() {
        "rays" => listed(reader, &mut own, files),
        kind => pattern(reader, kind, &mut own),
    };
    reader.reject_unknown(own);
    let pattern = pattern?;
    let listed = if let Pattern::Rays(rays) = &pattern { Some(rays.clone()) } else { None };
    Some((reader.accept(Source::new(pattern), span)?, listed))
}

/// The rays of a file next to the model.
fn listed(reader: &mut Reader, keys: &mut Keys, files: &AllowedFiles) -> Option<Pattern> {
    let datum = reader.need(keys, "file")?;
    let file = reader.text("file", datum)?;
    reader
        .accept(ListedRays::read_allowed(files.folder().join(&file.value), files), file.span)
        .map(Pattern::Rays)
}

fn pattern(reader: &mut Reader, kind: &str, keys: &mut Keys) -> Option<Pattern> {
    let rays = reader.need(keys, "rays").and_then(|datum| reader.whole("rays", datum, 1, 1 << 53));
    let mut size = |key: &'static str| reader.need(keys, key).and_then(|datum| reader.number(key, datum));
    match kind {
        "line" => size("length").zip(rays).map(|(length, count)| Pattern::Line { length, count }),
        "circle" => size("diameter").zip(rays).map(|(diameter, count)| Pattern::Circle { diameter, count }),
        "cone" => {
            let cone = |(half_angle_degrees, count)| Pattern::Cone { half_angle_degrees, count };
            size("angle").zip(rays).map(cone)
        }
        "wedge" => {
            size("angle").zip(rays).map(|(angle_degrees, count)| Pattern::Wedge { angle_degrees, count })
        }
        "lamp" => {
            let [width, height, angle] = ["width", "height", "angle"].map(size);
            let (width, height, half_angle_degrees, count) = (width?, height?, angle?, rays?);
            Some(Pattern::Lamp { width, height, half_angle_degrees, count })
        }
        "point" => {
            let angle = size("angle");
            let sampling = sampling(reader, keys, rays);
            Some(Pattern::Point { half_angle_degrees: angle?, sampling: sampling? })
        }
        "disc" => disc(reader, keys, rays),
        _ => beam(reader, keys, rays),
    }
}

/// Rays from random points of an outline, isotropic or according to Lambert's cosine law.
fn disc(reader: &mut Reader, keys: &mut Keys, rays: Option<u64>) -> Option<Pattern> {
    let aperture = aperture(reader, keys);
    let angle = reader.need(keys, "angle").and_then(|datum| reader.number("angle", datum));
    let ways = [(Emission::Lambert, "lambert"), (Emission::Isotropic, "isotropic")];
    let emission = match keys.take("emission") {
        Some(datum) => reader.choice("emission", datum, &ways),
        None => Some(Emission::Lambert),
    };
    let (aperture, emission, half_angle_degrees, count) = (aperture?, emission?, angle?, rays?);
    Some(Pattern::Extended { aperture, emission, half_angle_degrees, count })
}

fn beam(reader: &mut Reader, keys: &mut Keys, rays: Option<u64>) -> Option<Pattern> {
    let aperture = aperture(reader, keys);
    let profile = match keys.take("waist") {
        Some(datum) => reader.number("waist", datum).map(|radius| BeamProfile::Gaussian { radius }),
        None => Some(BeamProfile::TopHat),
    };
    let sampling = sampling(reader, keys, rays);
    Some(Pattern::Beam { aperture: aperture?, profile: profile?, sampling: sampling? })
}

/// `sampling`, or `random = true`; a Fibonacci spiral by default.
fn sampling(reader: &mut Reader, keys: &mut Keys, rays: Option<u64>) -> Option<Sampling> {
    let ways = Sampling::NAMES.map(|name| (name, name));
    let random = keys.take("random");
    let name = match (keys.take("sampling"), random) {
        (Some(_), Some(random)) => {
            let problem = Diagnostic::error("`random` is superfluous").why("`sampling` has precedence");
            reader.report(problem, random.span);
            None
        }
        (Some(datum), None) => reader.choice("sampling", datum, &ways),
        (None, Some(datum)) => {
            reader.boolean("random", datum).map(|is_random| if is_random { "random" } else { "fibonacci" })
        }
        (None, None) => Some("fibonacci"),
    };
    Sampling::named(name?, rays?)
}

fn spectrum(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Spectrum> {
    match &datum.value {
        Datum::List(_) => pairs(reader, datum).map(Spectrum::Lines),
        Datum::Table(_) => distribution(reader, datum),
        _ => reader.number("wavelength_nm", datum).map(Spectrum::Line),
    }
}

fn distribution(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Spectrum> {
    let mut keys = reader.keys("wavelength_nm", datum)?;
    let found = reader.one_of(&mut keys, &["band", "black_body", "table"]);
    reader.reject_unknown(keys);
    let (kind, datum) = found?;
    match kind.value.as_str() {
        "band" => {
            let [from_nm, to_nm] = reader.numbers("band", datum)?;
            Some(Spectrum::Band { from_nm, to_nm })
        }
        "black_body" => {
            let [kelvin, from_nm, to_nm] = reader.numbers("black_body", datum)?;
            Some(Spectrum::BlackBody { kelvin, from_nm, to_nm })
        }
        _ => pairs(reader, datum).map(Spectrum::Table),
    }
}

/// Wavelengths with their weights.
fn pairs(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Vec<(f64, f64)>> {
    let wanted = "a list of pairs of a wavelength and its weight, such as [[486.1, 1], [656.3, 1]]";
    let items = list(reader, "wavelength_nm", datum, wanted)?;
    let pairs: Vec<Option<(f64, f64)>> =
        items.into_iter().map(|item| reader.numbers("wavelength_nm", item).map(|[a, b]| (a, b))).collect();
    pairs.into_iter().collect()
}

/// The shortest and the longest wavelength.
fn range_nm(spectrum: &Spectrum) -> [f64; 2] {
    match spectrum {
        Spectrum::Line(wavelength_nm) => [*wavelength_nm; 2],
        Spectrum::Band { from_nm, to_nm } | Spectrum::BlackBody { from_nm, to_nm, .. } => [*from_nm, *to_nm],
        Spectrum::Lines(pairs) | Spectrum::Table(pairs) => {
            let wavelengths = || pairs.iter().map(|(wavelength_nm, _)| *wavelength_nm);
            let [least, most] = [f64::INFINITY, f64::NEG_INFINITY];
            [wavelengths().fold(least, f64::min), wavelengths().fold(most, f64::max)]
        }
    }
}
