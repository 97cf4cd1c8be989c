//! Sources.

use super::sheet::{aperture, place};
use super::{ReadSource, list, seed};
use crate::source::{BeamProfile, Pattern, Power, Sampling, Source, Spectrum};
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Datum, Span, Spanned};

const PATTERNS: [&str; 7] = ["beam", "line", "circle", "cone", "wedge", "lamp", "point"];

pub(super) fn read(reader: &mut Reader, keys: &mut Keys) -> Vec<ReadSource> {
    let Some(datum) = keys.take("source") else { return Vec::new() };
    let tables = reader.tables("optics.source", datum);
    tables.into_iter().filter_map(|keys| source(reader, keys)).collect()
}

fn source(reader: &mut Reader, mut keys: Keys) -> Option<ReadSource> {
    let span = keys.span();
    let shining = shining(reader, &mut keys);
    let (spectrum, spectrum_at) = placed(reader, &mut keys, "wavelength_nm", Spectrum::default(), spectrum);
    let (power, power_at) = placed(reader, &mut keys, "power", 1.0, power);
    let seed = seed(reader, &mut keys).unwrap_or(0);
    let map = place(reader, &mut keys);
    reader.refuse_the_rest(keys);
    // each of them is checked, whatever is wrong with the others
    let spectrum = spectrum.filter(|spectrum| reader.accept(spectrum.wavelengths(), spectrum_at).is_some());
    let powered = shining.and_then(|source| reader.accept(source.power(Power::Total(power?)), power_at));
    let (source, spectrum) = (powered?.seed(seed), spectrum?);
    let source = reader.accept(source.spectrum(&spectrum), spectrum_at)?;
    let source = reader.accept(source.apply(&map?), span)?;
    Some(ReadSource { source, range_nm: range_nm(&spectrum), span: spectrum_at })
}

/// A value and where it stands; another one, which stands where the table does, if it is not there.
fn placed<T>(
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

/// The source of a pattern.
fn shining(reader: &mut Reader, keys: &mut Keys) -> Option<Source> {
    let (kind, datum) = reader.one_of(keys, &PATTERNS)?;
    let span = datum.span;
    let mut own = reader.keys(&kind.value, datum)?;
    let pattern = pattern(reader, &kind.value, &mut own);
    reader.refuse_the_rest(own);
    reader.accept(Source::new(pattern?), span)
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
        _ => beam(reader, keys, rays),
    }
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

fn sampling(reader: &mut Reader, keys: &mut Keys, rays: Option<u64>) -> Option<Sampling> {
    let is_random = match keys.take("random") {
        Some(datum) => reader.truth("random", datum)?,
        None => false,
    };
    let count = rays?;
    Some(if is_random { Sampling::Random { count } } else { Sampling::Fibonacci { count } })
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
    reader.refuse_the_rest(keys);
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
    let wanted = "a list of pairs of a wavelength and its weight, as [[486.1, 1], [656.3, 1]]";
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
