//! Names that are spelt alike.

use std::cell::Cell;

/// The maximum length in characters of names that are compared: an edit distance takes time in proportion to the product of
/// the lengths.
const MAX_CHARACTERS: usize = 64;

/// The work that [`with_limited_suggestions`] allows: pairs of characters compared, and candidates looked at. It takes about a
/// second.
const MAX_WORK: usize = 20_000_000;

thread_local! {
    /// The work that is left for suggestions on this thread; without a limit, `None`.
    static LEFT: Cell<Option<usize>> = const { Cell::new(None) };
}

/// Restores the limit of this thread, even after a panic.
struct Restore(Option<usize>);

impl Drop for Restore {
    fn drop(&mut self) {
        LEFT.set(self.0);
    }
}

/// Reads a file with a limit for the work on suggestions: a file with many misspelt names gets them for the first ones only. Where
/// calls are nested, the outermost one sets the limit.
pub fn with_limited_suggestions<T>(read: impl FnOnce() -> T) -> T {
    if LEFT.get().is_some() {
        return read();
    }
    let _restore = Restore(LEFT.replace(Some(MAX_WORK)));
    read()
}

/// Reads one of several parts of a file with its share of the limit of [`with_limited_suggestions`], on any thread: the suggestions
/// do not depend on the order in which the parts are read.
pub fn with_limited_suggestions_of_part<T>(parts: usize, read: impl FnOnce() -> T) -> T {
    let _restore = Restore(LEFT.replace(Some(MAX_WORK / parts.max(1))));
    read()
}

/// Uses up some work; false if there is not enough left.
fn take_work(amount: usize) -> bool {
    let Some(left) = LEFT.get() else { return true };
    let rest = left.checked_sub(amount);
    LEFT.set(Some(rest.unwrap_or(0)));
    rest.is_some()
}

/// The candidate that a name is probably a misspelling of, if there is one: at most a third of the letters differ, ignoring
/// case. A word that other programs use for a candidate, such as `cube` for `box`, has priority. `None` for names of more than 64
/// characters.
///
/// ```
/// use rayweave_error::did_you_mean;
///
/// assert_eq!(did_you_mean("lesn", ["lens", "rim"]), Some("lens"));
/// assert_eq!(did_you_mean("mirror", ["lens", "rim"]), None);
/// ```
pub fn did_you_mean<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    let others: Vec<&str> = candidates.into_iter().filter(|candidate| *candidate != name).collect();
    let synonym = others.iter().copied().find(|candidate| is_synonym(name, candidate));
    synonym.or_else(|| {
        closest(name, others, |candidate| length.max(candidate.chars().count()) / 3).first().copied()
    })
}

/// Words of other programs (OpenSCAD, CadQuery, Geant4, trimesh) with the words of Rayweave for the same thing. They come before
/// similar spellings: `cube` means `box`, although `tube` is closer.
const SYNONYMS: [(&str, &[&str]); 30] = [
    ("ball", &["sphere"]),
    ("block", &["box"]),
    ("color", &["colour"]),
    ("cuboid", &["box"]),
    ("cube", &["box"]),
    ("d", &["radius"]),
    ("dia", &["radius"]),
    ("diameter", &["radius"]),
    ("dim", &["size"]),
    ("dimensions", &["size"]),
    ("extents", &["size"]),
    ("h", &["height"]),
    ("halfspace", &["half_space"]),
    ("inner", &["inner_radius"]),
    ("ior", &["index"]),
    ("len", &["length", "height"]),
    ("lathe", &["revolve"]),
    ("length", &["height"]),
    ("linear_extrude", &["extrude"]),
    ("material", &["medium"]),
    ("n", &["index", "normal"]),
    ("outer", &["outer_radius"]),
    ("pipe", &["tube"]),
    ("plane", &["half_space"]),
    ("r", &["radius"]),
    ("rmax", &["outer_radius"]),
    ("rmin", &["inner_radius"]),
    ("rod", &["cylinder"]),
    ("rotate_extrude", &["revolve"]),
    ("refractive_index", &["index"]),
];

/// True if a word means the same as a candidate.
fn is_synonym(name: &str, candidate: &str) -> bool {
    SYNONYMS.iter().any(|(word, meant)| name.eq_ignore_ascii_case(word) && meant.contains(&candidate))
}

/// The candidates with the fewest edits from a name, ignoring case; first those that share the most pairs of letters with
/// it (`n-bk7` rather than `k7` for `bk7`), then in alphabetical order. `most_edits` bounds the edits of a candidate. Names
/// of more than 64 characters match nothing, and no name does after the work that [`with_limited_suggestions`] allows.
///
/// Edits are the Damerau-Levenshtein distance: letters left out, added, changed, or swapped with their neighbour.
pub fn closest<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
    most_edits: impl Fn(&str) -> usize,
) -> Vec<&'a str> {
    let length = name.chars().count();
    if length > MAX_CHARACTERS {
        return Vec::new();
    }
    let lower = name.to_lowercase();
    let mut found: Vec<(Unlikeness, &str)> = Vec::new();
    for candidate in candidates {
        if !take_work(1) {
            return Vec::new();
        }
        let (most, other) = (most_edits(candidate), candidate.chars().count());
        // the distance is at least the difference of the lengths, which costs much less to compute
        if other > MAX_CHARACTERS || other.abs_diff(length) > most {
            continue;
        }
        if !take_work(length * other) {
            return Vec::new();
        }
        let unlikeness = Unlikeness::between(&lower, &candidate.to_lowercase());
        if unlikeness.edits <= most {
            found.push((unlikeness, candidate));
        }
    }
    let least = found.iter().map(|(unlikeness, _)| unlikeness.edits).min();
    found.retain(|(unlikeness, _)| Some(unlikeness.edits) == least);
    found.sort_unstable();
    found.into_iter().map(|(_, candidate)| candidate).collect()
}

/// How much two names differ.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Unlikeness {
    edits: usize,
    /// Per mille of the pairs of letters (Sørensen-Dice coefficient).
    unshared: u32,
}

impl Unlikeness {
    fn between(name: &str, candidate: &str) -> Unlikeness {
        Unlikeness {
            edits: strsim::damerau_levenshtein(name, candidate),
            unshared: (1000.0 * (1.0 - strsim::sorensen_dice(name, candidate))) as u32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised_and_strangers_are_not() {
        let names = ["front", "back", "rim", "R"];
        assert_eq!(did_you_mean("frnt", names), Some("front"));
        assert_eq!(did_you_mean("FRONT", names), Some("front"));
        assert_eq!(did_you_mean("bakc", names), Some("back"));
        assert_eq!(did_you_mean("r", names), Some("R"));
        assert_eq!(did_you_mean("elephant", names), None);
        assert_eq!(did_you_mean("x", names), None);
        assert_eq!(did_you_mean("", names), None);
        assert_eq!(did_you_mean("rim", ["rim"]), None);
    }

    #[test]
    fn words_of_other_programs_come_before_similar_spellings() {
        assert_eq!(did_you_mean("cube", ["sphere", "tube", "box"]), Some("box"));
        assert_eq!(did_you_mean("Cube", ["sphere", "tube"]), Some("tube"));
        assert_eq!(did_you_mean("h", ["radius", "height"]), Some("height"));
        assert_eq!(did_you_mean("diameter", ["radius", "height"]), Some("radius"));
    }

    #[test]
    fn ties_go_to_shared_pairs_of_letters_then_to_the_alphabet() {
        assert_eq!(closest("bk7", ["k7", "nbk7", "sf11"], |_| 1), ["nbk7", "k7"]);
        assert_eq!(closest("az", ["ac", "ab"], |_| 1), ["ab", "ac"]);
    }

    #[test]
    fn the_work_for_one_file_has_a_limit() {
        let names: Vec<String> = (0..2000).map(|k| format!("volume_with_a_long_name_{k:04}")).collect();
        let ask = |k: usize| {
            did_you_mean(&format!("volume_with_a_lnog_name_{k:04}"), names.iter().map(String::as_str))
        };
        let found = with_limited_suggestions(|| (0..2000).filter(|&k| ask(k).is_some()).count());
        assert!((1..100).contains(&found), "{found}");
        // the next file has a limit of its own, and there is none outside
        assert!(with_limited_suggestions(|| ask(7)).is_some());
        assert_eq!(ask(7), Some(names[7].as_str()));
        let nested = with_limited_suggestions(|| {
            (0..2000).filter(|&k| with_limited_suggestions(|| ask(k)).is_some()).count()
        });
        assert_eq!(nested, found);
    }

    #[test]
    fn long_names_are_not_compared() {
        let long = "a".repeat(MAX_CHARACTERS + 1);
        let edge = "a".repeat(MAX_CHARACTERS);
        assert_eq!(did_you_mean(&long, [edge.as_str()]), None);
        assert_eq!(did_you_mean(&edge, [long.as_str()]), None);
        let slip = format!("b{}", &edge[1..]);
        assert_eq!(did_you_mean(&slip, [edge.as_str()]), Some(edge.as_str()));
    }
}
