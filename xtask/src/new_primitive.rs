//! `cargo xtask new-primitive`: the first version of a primitive's file.
//!
//! The file is a copy of the sphere under another name, so it compiles and passes its tests, and
//! there is no template that could become outdated. The stage `primitive` of the tests verifies it.

use std::fs;

use crate::outcome::Outcome;
use crate::repository::Repository;
use crate::tidy::text::is_word;

/// The folder of the primitives, from the root.
pub const FOLDER: &str = "crates/shape/src/primitive";

/// Keywords, which cannot name a module.
const KEYWORDS: [&str; 50] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop",
    "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static",
    "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual",
    "where", "while",
];

/// Writes the file of a new primitive and prints the instructions to register it.
pub fn run(repository: &Repository, name: &str) -> Outcome {
    check_name(name)?;
    let path = format!("{FOLDER}/{name}.rs");
    if repository.root.join(&path).exists() {
        return Err(format!(
            "{path}: the file exists already, and is not overwritten. Choose a different name."
        ));
    }
    let text = derive(&sphere(repository)?, name);
    fs::write(repository.root.join(&path), text)
        .map_err(|error| format!("{path}: cannot be written: {error}."))?;
    let [module, entry] = registration(name);
    println!("{path} is written: a copy of the ball with the new name. Register it in {FOLDER}/mod.rs:");
    println!("    {module}    below the other modules");
    println!("    {entry}    in the list primitives!");
    println!("Then describe the primitive in the first lines, and adapt parameters, lower() and tests.");
    Ok(())
}

/// The text of the sphere's file.
fn sphere(repository: &Repository) -> Result<String, String> {
    let path = format!("{FOLDER}/sphere.rs");
    let source = repository.source(&path)?;
    source.map(|source| source.text).ok_or_else(|| format!("{path}: no text"))
}

/// The two lines that register a primitive: the module, and the entry in the list.
pub fn registration(name: &str) -> [String; 2] {
    [format!("pub mod {name};"), format!("{name}::{},", type_name(name))]
}

fn check_name(name: &str) -> Outcome {
    let snake_case = name.starts_with(|first: char| first.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    if !snake_case {
        return Err(format!("'{name}' is not a module name: snake_case is needed, such as lens_mount."));
    }
    if KEYWORDS.contains(&name) {
        return Err(format!("'{name}' is a keyword of Rust. Choose a different name."));
    }
    Ok(())
}

/// `lens_mount` becomes `LensMount`.
fn type_name(name: &str) -> String {
    let capital = |word: &str| word[..1].to_ascii_uppercase() + &word[1..];
    name.split('_').filter(|word| !word.is_empty()).map(capital).collect()
}

/// The sphere's file under another name. The manual page keeps the sphere's parameters; only its
/// first line changes.
fn derive(sphere: &str, name: &str) -> String {
    let type_name = type_name(name);
    let rest = sphere.split_once('\n').map_or("", |(_, rest)| rest);
    let lines = rest.lines().map(|line| match line.starts_with("//!") {
        true => line.to_owned(),
        false => replace_word(line, "Sphere", &type_name).replace("\"sphere", &format!("\"{name}")),
    });
    let first = format!("//! A {}, for now a ball centred at the origin.", name.replace('_', " "));
    std::iter::once(first).chain(lines).map(|line| line + "\n").collect()
}

/// Replaces whole occurrences of a word.
fn replace_word(line: &str, word: &str, other: &str) -> String {
    let mut replaced = String::new();
    let mut from = 0;
    for (at, _) in line.match_indices(word) {
        if is_word(line, at, word) {
            replaced += &line[from..at];
            replaced += other;
            from = at + word.len();
        }
    }
    replaced + &line[from..]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_checked() {
        assert_eq!(check_name("lens_mount2"), Ok(()));
        for name in ["", "Lens", "2lens", "lens-mount", "_lens", "../lens", "länge"] {
            assert!(check_name(name).unwrap_err().contains("snake_case"), "{name}");
        }
        assert!(check_name("box").unwrap_err().contains("a keyword of Rust"));
    }

    #[test]
    fn types_are_in_camel_case() {
        assert_eq!(type_name("lens_mount2"), "LensMount2");
        assert_eq!(type_name("a__b_"), "AB");
        assert_eq!(registration("lens_mount"), ["pub mod lens_mount;", "lens_mount::LensMount,"]);
    }

    #[test]
    fn only_the_name_changes() {
        let sphere = "//! A ball.\n//!\n//! Sphere.\nstruct Sphere(Surface::Spheres); // \"sphere: sphere\"\nuse sphere;\n";
        let text = "//! A lens mount, for now a ball centred at the origin.\n//!\n//! Sphere.\n\
                    struct LensMount(Surface::Spheres); // \"lens_mount: sphere\"\nuse sphere;\n";
        assert_eq!(derive(sphere, "lens_mount"), text);
    }

    #[test]
    fn what_exists_is_not_overwritten() {
        let message = run(&Repository::find().unwrap(), "sphere").unwrap_err();
        assert!(message.contains("sphere.rs: the file exists already"), "{message}");
    }
}
