//! The medium of a `GLAS` line: a glass of a catalogue, or a model glass of the index in the file.

use super::words::number;
use crate::prescription::Behind;
use rayweave_optics::glass::{Glass, GlassError, glass, glasses};
use std::collections::BTreeSet;

/// Index and Abbe number that programs write as placeholders.
const DUMMY: [f64; 2] = [1.5, 40.0];

/// The wavelength of the index in a file, the d line, and those of its Abbe number, F and C, in nanometres.
pub(super) const D_NM: f64 = 587.5618;
pub(super) const F_NM: f64 = 486.1327;
pub(super) const C_NM: f64 = 656.2725;

/// The largest difference between the index in a file and that of the same glass. Programs write indices to five
/// digits or more, and melts of a type differ by a few 1e-5 between editions of a catalogue; different glasses
/// of one name differ by more than 1e-3.
const INDEX_TOLERANCE: f64 = 1e-4;

/// The largest difference between the Abbe number in a file and that of the same glass: files state two digits after
/// the point or more. F2 of Schott (36.366) and of Hikari (36.331) have the same index.
const ABBE_TOLERANCE: f64 = 0.02;

/// The medium behind a surface, with a note if it is a substitute or may be another glass than in the file. `makers` are the catalogues that the file names,
/// in the order in which they are searched.
pub(super) fn behind(words: &[&str], makers: &[String]) -> Result<(Behind, Option<String>), String> {
    let data = number(words, 3).and_then(|n_d| Ok([n_d, number(words, 4)?]));
    let name = match words.first().copied() {
        None => return Err("GLAS has no name".to_owned()),
        Some("MIRROR") => return Ok((Behind::Mirror, None)),
        Some("___BLANK") => return data.map(|data| (model(data), None)),
        Some(name) => name,
    };
    let stated = data.as_ref().ok().copied().filter(|data| *data != DUMMY && model(*data).medium().is_ok());
    let plain = match glass(name) {
        Ok(plain) => plain,
        Err(problem) => return substitute(name, &problem, stated),
    };
    let known = known_makers();
    let found = candidates(name, makers, &known, &plain);
    let first = found.first().unwrap_or(&plain);
    let as_named = |glass: &Glass| (named(name, glass), unlisted(glass, makers, &known));
    let Some([n_d, v_d]) = stated else { return Ok(as_named(first)) };
    if let Some(same) = found.iter().find(|glass| has_index(glass, n_d)) {
        let (behind, note) = as_named(same);
        return Ok((behind, note.filter(|_| !has_abbe(same, v_d))));
    }
    // materials for the infrared have no index at the d line: that in the file is of another wavelength
    let Ok(own) = first.index(D_NM) else { return Ok(as_named(first)) };
    let note = format!(
        "the index of {name} is {n_d} here and {own:.6} in the catalogue ({}); a model glass of index {n_d} and Abbe number {v_d} is used",
        maker(first)
    );
    Ok((model([n_d, v_d]), Some(note)))
}

/// True if a glass has this index at the d line.
fn has_index(glass: &Glass, n_d: f64) -> bool {
    glass.index(D_NM).is_ok_and(|own| (own - n_d).abs() <= INDEX_TOLERANCE)
}

/// True if a glass has this Abbe number.
fn has_abbe(glass: &Glass, v_d: f64) -> bool {
    let [Ok(f), Ok(d), Ok(c)] = [F_NM, D_NM, C_NM].map(|line| glass.index(line)) else { return false };
    ((d - 1.0) / (f - c) - v_d).abs() <= ABBE_TOLERANCE
}

/// The glasses of a name: those of the makers in their order, that of the highest precedence, and the others.
fn candidates(name: &str, makers: &[String], known: &[&str], plain: &Glass) -> Vec<Glass> {
    let of = |maker: &str| glass(&format!("{maker} {name}")).ok();
    let stated = makers.iter().filter_map(|entry| of(catalogue(entry, known)?));
    stated.chain([plain.clone()]).chain(known.iter().filter_map(|maker| of(maker))).collect()
}

/// The makers of the built-in catalogue.
fn known_makers() -> Vec<&'static str> {
    let makers: BTreeSet<&str> =
        glasses().iter().map(Glass::maker).filter(|maker| !maker.is_empty()).collect();
    makers.into_iter().collect()
}

/// The maker of a catalogue that a file names, such as `SCHOTT` or `SCHOTT_2012`.
fn catalogue<'a>(entry: &str, known: &[&'a str]) -> Option<&'a str> {
    let letters: String = entry.chars().take_while(char::is_ascii_alphabetic).collect();
    known.iter().copied().find(|maker| maker.eq_ignore_ascii_case(&letters))
}

/// A glass by its name; with its maker where the name alone is another glass.
fn named(name: &str, found: &Glass) -> Behind {
    let is_first = glass(name).is_ok_and(|first| first.maker() == found.maker());
    Behind::Glass(if is_first { name.to_owned() } else { format!("{} {name}", found.maker()) })
}

/// The maker of a glass, for messages.
fn maker(found: &Glass) -> &str {
    if found.maker().is_empty() { "no maker" } else { found.maker() }
}

/// A note that a glass is not of a maker that the file names, or that the file names a catalogue before that maker
/// that is not built in: the glass of this name may be another one there.
fn unlisted(found: &Glass, entries: &[String], known: &[&str]) -> Option<String> {
    if found.maker().is_empty() || entries.is_empty() {
        return None;
    }
    let makers: Vec<Option<&str>> = entries.iter().map(|entry| catalogue(entry, known)).collect();
    let place = makers.iter().position(|maker| *maker == Some(found.maker()));
    let searched = &makers[..place.unwrap_or(makers.len())];
    let missing = entries.iter().zip(searched).filter(|(_, maker)| maker.is_none());
    let missing: Vec<&str> = missing.map(|(entry, _)| entry.as_str()).collect();
    let without: Vec<&str> = searched.iter().copied().flatten().collect();
    let used = format!("{} of {} is used", found.name(), maker(found));
    let verb = if missing.len() == 1 { "is" } else { "are" };
    let first = format!("{} {verb} not among the built-in catalogues", missing.join(", "));
    match (missing.is_empty(), place, without.is_empty()) {
        (true, Some(_), _) => None,
        (true, None, _) => Some(format!("{used}: {} has none", without.join(", "))),
        (false, Some(_), _) => Some(format!("{used}: {first}, and the file searches it first")),
        (false, None, true) => Some(format!("{used}: {first}")),
        (false, None, false) => Some(format!("{used}: {} has none, and {first}", without.join(", "))),
    }
}

/// The substitute for a glass that no catalogue has: its successor, unless the file states another index or Abbe
/// number; then a model glass.
fn substitute(
    name: &str,
    error: &GlassError,
    stated: Option<[f64; 2]>,
) -> Result<(Behind, Option<String>), String> {
    // the suggestions of the error would run into what is used instead
    let problem = match error {
        GlassError::Unknown { name, .. } => format!("no glass is named {name:?}"),
        other => other.to_string(),
    };
    if let (Some([n_d, v_d]), Some((behind, glass))) = (stated, successor(name))
        && has_index(&glass, n_d)
        && has_abbe(&glass, v_d)
    {
        let note = format!("{problem}; its successor N-{name} is used, which has its index and Abbe number");
        return Ok((behind, Some(note)));
    }
    if let Some([n_d, v_d]) = stated {
        let note = format!("{problem}; a model glass of its index {n_d} and Abbe number {v_d} is used");
        return Ok((model([n_d, v_d]), Some(note)));
    }
    match successor(name) {
        Some((successor, _)) => {
            let note = format!("{problem}; its successor N-{name} is used");
            Ok((successor, Some(note)))
        }
        None => Err(error.to_string()),
    }
}

/// The lead- and arsenic-free successor (`N-`) of an older Schott glass.
fn successor(name: &str) -> Option<(Behind, Glass)> {
    let name = format!("N-{name}");
    let found = glass(&name).ok()?;
    Some((Behind::Glass(name), found))
}

fn model([n_d, v_d]: [f64; 2]) -> Behind {
    if v_d == 0.0 { Behind::Index(n_d) } else { Behind::Abbe { n_d, v_d } }
}
