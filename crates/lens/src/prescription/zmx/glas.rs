//! The medium of a `GLAS` line: a glass of a catalogue, or a model glass of the index in the file.

use super::words::number;
use crate::prescription::Behind;
use rayweave_optics::glass::{Glass, glass, glasses};
use std::collections::BTreeSet;

/// Index and Abbe number that programs write as placeholders.
const DUMMY: [f64; 2] = [1.5, 40.0];

/// The wavelength of the index in a file, the d line, in nanometres.
const D_NM: f64 = 587.5618;

/// The largest difference between the index in a file and that of the same glass. Programs write indices to five
/// digits or more, and melts of a type differ by a few 1e-5 between editions of a catalogue; different glasses
/// of one name differ by more than 1e-3.
const INDEX_TOLERANCE: f64 = 1e-4;

/// The medium behind a surface, with a note if it is a substitute. `makers` are the catalogues that the file names,
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
        Err(problem) => return substitute(name, &problem.to_string(), stated),
    };
    let known = known_makers();
    let makers: Vec<Option<&str>> = makers.iter().map(|entry| catalogue(entry, &known)).collect();
    let found = candidates(name, &makers, &known, &plain);
    let first = found.first().unwrap_or(&plain);
    let Some([n_d, v_d]) = stated else { return Ok((named(name, first), others(first, &makers))) };
    let is_same = |glass: &Glass| glass.index(D_NM).is_ok_and(|own| (own - n_d).abs() <= INDEX_TOLERANCE);
    if let Some(same) = found.iter().find(|glass| is_same(glass)) {
        return Ok((named(name, same), None));
    }
    // materials for the infrared have no index at the d line: that in the file is of another wavelength
    let Ok(own) = first.index(D_NM) else { return Ok((named(name, first), others(first, &makers))) };
    let note = format!(
        "the index of {name} is {n_d} here and {own:.6} in the catalogue ({}); a model glass of index {n_d} and Abbe number {v_d} is used",
        maker(first)
    );
    Ok((model([n_d, v_d]), Some(note)))
}

/// The glasses of a name: those of the makers in their order, that of the highest precedence, and the others.
fn candidates(name: &str, makers: &[Option<&str>], known: &[&str], plain: &Glass) -> Vec<Glass> {
    let of = |maker: &str| glass(&format!("{maker} {name}")).ok();
    let stated = makers.iter().flatten().filter_map(|maker| of(maker));
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

/// A note that a glass is not of a maker that the file names, unless one of its catalogues is not known.
fn others(found: &Glass, makers: &[Option<&str>]) -> Option<String> {
    let stated: Option<Vec<&str>> = makers.iter().copied().collect();
    let stated = stated.filter(|stated| !stated.is_empty() && !stated.contains(&found.maker()))?;
    let text = format!("{} of {} is used: {} has none", found.name(), maker(found), stated.join(", "));
    (!found.maker().is_empty()).then_some(text)
}

/// The substitute for a glass that no catalogue has.
fn substitute(
    name: &str,
    problem: &str,
    stated: Option<[f64; 2]>,
) -> Result<(Behind, Option<String>), String> {
    if let Some([n_d, v_d]) = stated {
        let note = format!("{problem}; a model glass of its index {n_d} and Abbe number {v_d} is used");
        return Ok((model([n_d, v_d]), Some(note)));
    }
    match successor(name) {
        Some(successor) => {
            let note = format!("{problem}; its successor N-{name} is used");
            Ok((successor, Some(note)))
        }
        None => Err(problem.to_owned()),
    }
}

/// The lead- and arsenic-free successor (`N-`) of an older Schott glass.
fn successor(name: &str) -> Option<Behind> {
    let glass = Behind::Glass(format!("N-{name}"));
    glass.medium().is_ok().then_some(glass)
}

fn model([n_d, v_d]: [f64; 2]) -> Behind {
    if v_d == 0.0 { Behind::Index(n_d) } else { Behind::Abbe { n_d, v_d } }
}
