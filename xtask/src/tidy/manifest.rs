//! Checks of Cargo.toml files: lints are inherited, and every external dependency has a comment
//! with its purpose.

use super::violation::{Rule, Violation};
use crate::repository::Source;

static LINTS: Rule = Rule { name: "lints", why: "every crate follows the same rules" };
static DEPENDENCY: Rule = Rule { name: "dependency", why: "each one costs build time and trust" };

pub fn check(source: &Source) -> Vec<Violation> {
    if source.path != "Cargo.toml" && !source.path.ends_with("/Cargo.toml") {
        return Vec::new();
    }
    let mut violations = unexplained(source);
    violations.extend(lints(source));
    violations
}

/// The lines of a manifest, each with the header of its table, such as `[lints]`.
fn entries(text: &str) -> impl Iterator<Item = (usize, &str, &str)> {
    let mut table = "";
    text.lines().enumerate().filter_map(move |(index, line)| {
        let line = line.trim();
        if line.starts_with('[') {
            table = line;
        }
        let is_entry = !line.starts_with(['[', '#']) && line.contains('=');
        is_entry.then_some((index, table, line))
    })
}

fn lints(source: &Source) -> Option<Violation> {
    let is_package = source.text.lines().any(|line| line.trim() == "[package]");
    let plain = |line: &str| line.split_whitespace().collect::<String>();
    let inherits = entries(&source.text).any(|(_, table, line)| match table {
        "[lints]" => plain(line).starts_with("workspace=true"),
        _ => plain(line).starts_with("lints.workspace=true"),
    });
    (is_package && !inherits).then(|| {
        let problem = "the lints of the workspace are not inherited".to_owned();
        Violation::new(&LINTS, source, 1, problem, "add '[lints]' with 'workspace = true'")
    })
}

/// External dependencies with a version in this file and no comment directly above.
fn unexplained(source: &Source) -> Vec<Violation> {
    let lines: Vec<&str> = source.text.lines().collect();
    let explained = |index: usize| index > 0 && lines[index - 1].trim().starts_with('#');
    let ours = |line: &str| {
        line.contains("path =") || line.contains("workspace = true") || line.contains(".workspace")
    };
    entries(&source.text)
        .filter(|(_, table, line)| table.ends_with("dependencies]") && !ours(line))
        .filter(|(index, _, _)| !explained(*index))
        .map(|(index, _, line)| {
            let name = line.split('=').next().unwrap_or_default().trim();
            let problem = format!("dependency {name} has no comment right above it");
            Violation::new(&DEPENDENCY, source, index + 1, problem, "state its purpose")
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::tidy::found;

    #[test]
    fn lints_are_inherited() {
        assert_eq!(found("a/Cargo.toml", "[package]\nname = \"a\"\n"), [("lints", 1)]);
        assert_eq!(found("a/Cargo.toml", "[package]\nname = \"a\"\n\n[lints]\nworkspace = true\n"), []);
        assert_eq!(found("a/Cargo.toml", "[package]\nlints.workspace = true\n"), []);
        assert_eq!(found("Cargo.toml", "[workspace]\nmembers = [\"a\"]\n"), []);
    }

    #[test]
    fn dependencies_are_explained() {
        let text = "[workspace.dependencies]\na = { path = \"a\", version = \"1\" }\n# numbers\nb = \"1\"\nc = \"2\"\n\
                    \n[profile.dev]\nd = 1\n[dev-dependencies]\ne.workspace = true\nf = { workspace = true }\ng = \"1\"\n";
        assert_eq!(found("Cargo.toml", text), [("dependency", 5), ("dependency", 12)]);
    }
}
