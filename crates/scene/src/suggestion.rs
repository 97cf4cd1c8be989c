//! Suggestions for misspelt names.

/// The question "Did you mean ..?" with the most similar name, if there is one.
pub(crate) fn did_you_mean<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    rayweave_error::did_you_mean(name, names).map(|other| format!("Did you mean `{other}`?"))
}
