//! The check of the dependency count: the number of external crates of the library without its
//! optional features.

use std::collections::BTreeSet;
use std::process::Command;

use crate::Outcome;
use crate::process;
use crate::repository::Repository;

/// The maximum number of external crates of `rayweave` with `default-features = false`.
const MAX_CRATES: usize = 12;

/// Counts the external crates of the library without its default features, and fails above the
/// limit.
pub fn run(repository: &Repository) -> Outcome {
    let mut tree = Command::new("cargo");
    tree.current_dir(&repository.root).args(["tree", "--package", "rayweave", "--no-default-features"]);
    tree.args(["--edges", "normal", "--prefix", "none", "--format", "{p}"]);
    let crates = external(&process::output(&mut tree)?);
    let list = crates.iter().cloned().collect::<Vec<_>>().join(", ");
    if crates.len() > MAX_CRATES {
        return Err(format!(
            "the core needs {} external crates, at most {MAX_CRATES} are allowed: {list}",
            crates.len()
        ));
    }
    println!("core: {} external crates: {list}", crates.len());
    Ok(())
}

/// The names of external crates in the output of `cargo tree`: those without a path.
fn external(tree: &str) -> BTreeSet<String> {
    let lines = tree.lines().filter(|line| !line.contains(" (/") && !line.trim().is_empty());
    let names = lines.filter_map(|line| line.split(' ').next());
    names.filter(|name| !name.starts_with("rayweave")).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crates_without_a_path_are_external() {
        let tree = "rayweave v0.1.0 (/a/crates/rayweave)\nglam v0.34.2\nthiserror-impl v2.0.1 (proc-macro)\n\
                    rayweave-math v0.1.0 (/a/crates/math)\nglam v0.34.2 (*)\n";
        let expected: BTreeSet<String> = ["glam", "thiserror-impl"].map(str::to_owned).into();
        assert_eq!(external(tree), expected);
    }
}
