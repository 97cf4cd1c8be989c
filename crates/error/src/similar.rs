//! Names that are spelt alike.

/// The most characters of a name that is compared: an edit distance takes time in proportion to the product of the lengths.
const MOST_CHARACTERS: usize = 64;

/// The candidate that a name is probably a misspelling of, if there is one: at most a third of the letters differ, whatever
/// their case. `None` for names of more than 64 characters.
///
/// ```
/// use rayweave_error::did_you_mean;
///
/// assert_eq!(did_you_mean("lesn", ["lens", "rim"]), Some("lens"));
/// assert_eq!(did_you_mean("mirror", ["lens", "rim"]), None);
/// ```
pub fn did_you_mean<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    let others = candidates.into_iter().filter(|candidate| *candidate != name);
    closest(name, others, |candidate| length.max(candidate.chars().count()) / 3).first().copied()
}

/// The candidates with the fewest edits from a name, whatever the case of letters; first those that share the most pairs of
/// letters with it (`n-bk7` rather than `k7` for `bk7`), then in alphabetical order. `most_edits` bounds the edits of a
/// candidate. Names of more than 64 characters match nothing.
///
/// Edits are the Damerau-Levenshtein distance: letters left out, added, changed, or swapped with their neighbour.
pub fn closest<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
    most_edits: impl Fn(&str) -> usize,
) -> Vec<&'a str> {
    let length = name.chars().count();
    if length > MOST_CHARACTERS {
        return Vec::new();
    }
    let lower = name.to_lowercase();
    let mut found: Vec<(Unlikeness, &str)> = Vec::new();
    for candidate in candidates {
        let (most, other) = (most_edits(candidate), candidate.chars().count());
        // the distance is at least the difference of the lengths, which costs much less to compute
        if other > MOST_CHARACTERS || other.abs_diff(length) > most {
            continue;
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
    fn ties_go_to_shared_pairs_of_letters_then_to_the_alphabet() {
        assert_eq!(closest("bk7", ["k7", "nbk7", "sf11"], |_| 1), ["nbk7", "k7"]);
        assert_eq!(closest("az", ["ac", "ab"], |_| 1), ["ab", "ac"]);
    }

    #[test]
    fn long_names_are_not_compared() {
        let long = "a".repeat(MOST_CHARACTERS + 1);
        let edge = "a".repeat(MOST_CHARACTERS);
        assert_eq!(did_you_mean(&long, [edge.as_str()]), None);
        assert_eq!(did_you_mean(&edge, [long.as_str()]), None);
        let slip = format!("b{}", &edge[1..]);
        assert_eq!(did_you_mean(&slip, [edge.as_str()]), Some(edge.as_str()));
    }
}
