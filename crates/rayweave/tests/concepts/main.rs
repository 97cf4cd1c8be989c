//! The pictures of `docs/concepts/algebra.md`: drawn from results of the engine, and compared with the files
//! of the page.
//!
//! Nothing is placed by hand: times, counts, masks and tables are computed by the algebra, the evaluators and
//! the decision rule while the pictures are drawn. `cargo xtask golden --accept` rewrites them: review them
//! before committing.

mod accumulation;
mod chain;
mod complement;
mod kit;
mod rule;
mod tables;
mod time_lines;
mod truth;
mod weld;

use std::fs;
use std::path::{Path, PathBuf};

/// The environment variable that makes the test write pictures instead of comparing them.
const ACCEPT: &str = "RAYWEAVE_ACCEPT_GOLDEN";

/// A picture: file name and text.
type Picture = (&'static str, String);

/// All pictures, in the order of the page.
fn pictures() -> Vec<Picture> {
    vec![
        ("time-lines", time_lines::operations()),
        ("truth", truth::picture()),
        ("accumulation", accumulation::picture()),
        ("complement", complement::picture()),
        ("inverted-counts", time_lines::inverted()),
        ("weld", weld::picture()),
        ("ray-in-a-face", time_lines::ray_in_a_face()),
        ("single-hit-rule", rule::picture()),
        ("chain", chain::picture()),
        ("farther-exit", tables::picture()),
        ("partition", time_lines::partition()),
    ]
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/concepts")
}

/// The text of a file, with normalised line ends.
fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_default().replace("\r\n", "\n")
}

#[test]
fn pictures_are_those_of_the_page() {
    let folder = docs().join("pictures");
    let accepts = std::env::var_os(ACCEPT).is_some_and(|value| value == "1");
    let mut stale = Vec::new();
    for (name, svg) in pictures() {
        let path = folder.join(name).with_extension("svg");
        if read(&path) != svg {
            if accepts {
                fs::create_dir_all(&folder).unwrap();
                fs::write(&path, svg).unwrap();
            } else {
                stale.push(name);
            }
        }
    }
    let advice = "if the change is intended, accept it with 'cargo xtask golden --accept'";
    assert!(stale.is_empty(), "the files differ from the current drawings: {stale:?}\n{advice}");
}

#[test]
fn every_picture_is_drawn_and_shown() {
    let names: Vec<String> = pictures().iter().map(|(name, _)| format!("{name}.svg")).collect();
    let files = fs::read_dir(docs().join("pictures")).unwrap();
    for file in files {
        let file = file.unwrap().file_name().to_string_lossy().into_owned();
        assert!(names.contains(&file), "{file} is not drawn by any test");
    }
    let page = read(&docs().join("algebra.md"));
    for name in names {
        let shown = page.split("![").skip(1).find_map(|rest| {
            let (words, target) = rest.split_once("](")?;
            target.starts_with(&format!("pictures/{name})")).then_some(words)
        });
        assert!(
            shown.is_some_and(|words| words.len() > 40),
            "{name} is not shown on the page, or has no alternative text"
        );
    }
}

#[test]
fn pictures_are_complete_documents() {
    for (name, svg) in pictures() {
        let width = svg
            .split_once("viewBox=\"0 0 ")
            .and_then(|(_, rest)| rest.split(' ').next()?.parse::<f64>().ok());
        assert!(width.is_some_and(|width| width <= 960.0), "{name}: {width:?}");
        assert!(svg.ends_with("</svg>\n") && svg.contains("<title>"), "{name}");
        assert!(svg.len() < 40_000, "{name} takes {} bytes", svg.len());
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{name}");
    }
}
