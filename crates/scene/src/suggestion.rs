//! Suggestions for misspelt names.

/// The question "Did you mean ..?" with the most similar name, if there is one.
pub(crate) fn did_you_mean<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let names: Vec<&str> = names.into_iter().collect();
    let unit = UNITS.iter().find(|(word, _)| name.eq_ignore_ascii_case(word)).map(|(_, unit)| *unit);
    let found = unit
        .filter(|unit| names.contains(unit))
        .or_else(|| rayweave_error::did_you_mean(name, names.iter().copied()))
        .or_else(|| abbreviation(name, &names));
    found.map(|other| format!("Did you mean `{other}`?"))
}

/// Names of units, with their symbols.
const UNITS: [(&str, &str); 12] = [
    ("inch", "in"),
    ("inches", "in"),
    ("foot", "ft"),
    ("feet", "ft"),
    ("nanometre", "nm"),
    ("micron", "um"),
    ("micrometre", "um"),
    ("millimetre", "mm"),
    ("millimeter", "mm"),
    ("centimetre", "cm"),
    ("metre", "m"),
    ("meter", "m"),
];

/// The only name of at least three letters that a name begins with, or that begins with it: `key` for `keyway`.
fn abbreviation<'a>(name: &str, names: &[&'a str]) -> Option<&'a str> {
    const LEAST: usize = 3;
    let is_short_form = |other: &&&str| {
        name.len().min(other.len()) >= LEAST
            && name != **other
            && (name.starts_with(**other) || other.starts_with(name))
    };
    let mut found = names.iter().filter(is_short_form);
    found.next().copied().filter(|_| found.next().is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_short_forms_are_suggested() {
        let said = |name: &str, names: &[&str]| did_you_mean(name, names.iter().copied());
        assert_eq!(said("inch", &["mm", "in", "ft"]).unwrap(), "Did you mean `in`?");
        assert_eq!(said("keyway", &["body", "key"]).unwrap(), "Did you mean `key`?");
        assert_eq!(said("bolt", &["bolt_circle", "plate"]).unwrap(), "Did you mean `bolt_circle`?");
        // two candidates, and a short one
        assert_eq!(said("keyway", &["key", "keyway_of_the_hub"]), None);
        assert_eq!(said("keyway", &["ke", "body"]), None);
    }
}
