//! The name that was probably meant.

/// The nearest of the names, if it is near enough to be a slip of the fingers: at most a third of the
/// letters wrong, by the Damerau-Levenshtein distance (letters left out, put in, changed, or swapped with
/// their neighbour).
pub fn nearest<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    let lower = name.to_lowercase();
    let allowed = |other: &str| length.max(other.chars().count()) / 3;
    names
        .into_iter()
        // the distance is at least the difference of the lengths, which costs much less to know
        .filter(|other| other.chars().count().abs_diff(length) <= allowed(other))
        .map(|other| (strsim::damerau_levenshtein(&lower, &other.to_lowercase()), other))
        .filter(|(wrong, other)| *wrong <= allowed(other) && *other != name)
        .min_by_key(|(wrong, _)| *wrong)
        .map(|(_, other)| other)
}

/// The question that names it, or nothing.
pub(crate) fn did_you_mean<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(name, names).map(|other| format!("did you mean `{other}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised_and_strangers_are_not() {
        let names = ["front", "back", "rim", "R"];
        assert_eq!(nearest("frnt", names), Some("front"));
        assert_eq!(nearest("FRONT", names), Some("front"));
        assert_eq!(nearest("bakc", names), Some("back"));
        assert_eq!(nearest("r", names), Some("R"));
        assert_eq!(nearest("elephant", names), None);
        assert_eq!(nearest("x", names), None);
        assert_eq!(nearest("", names), None);
        assert_eq!(nearest("rim", ["rim"]), None);
    }
}
