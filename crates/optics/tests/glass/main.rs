//! Tests of the module `glass`.

mod agf;
mod air;
mod catalogue;
mod dispersion;
mod material;
mod yaml;

/// The rows of a file in `reference/`, without comments and the head, cut at commas.
fn rows(text: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').collect())
}
