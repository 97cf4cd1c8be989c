//! The name that was probably meant.

/// The question that names it, or nothing.
pub(crate) fn did_you_mean<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    rayweave_error::did_you_mean(name, names).map(|other| format!("Did you mean `{other}`?"))
}
