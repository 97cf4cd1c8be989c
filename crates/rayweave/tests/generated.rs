//! Files that are generated from the registry of primitives, compared with the current registry.
//!
//! `cargo xtask generated --accept` rewrites them after a primitive has been added or changed.

use rayweave::shape::primitive::{MANUALS, Manual, Parameter, ParameterKind, ParameterUnit};
use std::fs;
use std::path::{Path, PathBuf};

/// The environment variable that makes the test write files instead of comparing them.
const ACCEPT: &str = "RAYWEAVE_ACCEPT_GENERATED";

const COMMAND: &str = "cargo xtask generated --accept";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Compares a generated text with its file, or writes the file if [`ACCEPT`] is set.
fn compare(path: &str, text: &str) {
    let file = root().join(path);
    if std::env::var_os(ACCEPT).is_some_and(|value| value == "1") {
        if fs::read_to_string(&file).is_ok_and(|old| old == text) {
            return;
        }
        fs::write(&file, text).unwrap();
        println!("{path}: written");
        return;
    }
    let found = fs::read_to_string(&file).unwrap_or_default();
    let different = found.lines().zip(text.lines()).position(|(found, expected)| found != expected);
    assert!(
        found == text,
        "{path}:{}: the file differs from the registry of primitives. Run {COMMAND}.",
        different.unwrap_or(found.lines().count().min(text.lines().count())) + 1
    );
}

/// The manual pages in the order of their names.
fn sorted() -> Vec<&'static Manual> {
    let mut pages: Vec<&Manual> = MANUALS.iter().collect();
    pages.sort_by_key(|page| page.name);
    pages
}

// ---- Rust ----

/// The Rust type of a parameter, and the conversion of an argument `@` to a value.
fn rust_type(parameter: &Parameter) -> (&'static str, &'static str) {
    let is_index = parameter.unit == ParameterUnit::Count;
    match parameter.kind {
        ParameterKind::Number => ("f64", "@.into()"),
        ParameterKind::Count => ("u32", "@.into()"),
        ParameterKind::Vector3 | ParameterKind::NumberOrVector3 => ("impl Into<Vec3>", "@.into().into()"),
        ParameterKind::Planes => ("&[[f64; 4]]", "@.into()"),
        ParameterKind::Triples if is_index => ("&[[u32; 3]]", "indices(@).as_slice().into()"),
        ParameterKind::Triples => ("&[[f64; 3]]", "@.into()"),
        ParameterKind::Matrix4 => ("[[f64; 4]; 4]", "@.as_slice().into()"),
        ParameterKind::Numbers => ("&[f64]", "@.into()"),
    }
}

fn constructor(page: &Manual) -> String {
    let mut text = format!("/// {}\n///\n", page.summary);
    for Parameter { name, unit, range, summary, .. } in page.parameters {
        let unit = if matches!(unit, ParameterUnit::None | ParameterUnit::Count) {
            String::new()
        } else {
            format!("{unit}, ")
        };
        text += &format!("/// - `{name}`: {summary}; {unit}{range}.\n");
    }
    text += &format!("///\n/// Inside: `{}`. See [the manual page](crate::shape::primitive::", page.equation);
    text += &format!("{}).\n", module(page.name));
    let parameters = page.parameters.iter().map(|own| format!("{}: {}", own.name, rust_type(own).0));
    let values = page
        .parameters
        .iter()
        .map(|own| format!("(\"{}\", {})", own.name, rust_type(own).1.replace('@', own.name)));
    let (parameters, values) = (parameters.collect::<Vec<_>>(), values.collect::<Vec<_>>());
    let function = if page.name == "box" { "box_" } else { page.name };
    text + &format!(
        "pub fn {function}({}) -> Result<Solid, Error> {{\n    make(\"{}\", &[{}])\n}}\n",
        parameters.join(", "),
        page.name,
        values.join(", ")
    )
}

/// The module of a primitive: that of the box cannot have its name, a keyword.
fn module(name: &str) -> &str {
    if name == "box" { "centred_box" } else { name }
}

#[test]
fn rust_constructors() {
    let head = format!(
        "//! Constructors of primitives, generated from their registry: run `{COMMAND}` instead of editing.\n\n\
         use super::{{indices, make}};\nuse crate::Error;\nuse rayweave_math::Vec3;\nuse rayweave_model::Solid;\n"
    );
    let functions: Vec<String> = MANUALS.iter().map(constructor).collect();
    compare("crates/rayweave/src/shapes/primitives.rs", &format!("{head}\n{}", functions.join("\n")));
}

// ---- Python ----

fn stub(page: &Manual) -> String {
    let parameters = page.parameters.iter().map(|own| {
        let optional = own.default_value().is_some();
        format!("    {}: {}{},\n", own.name, own.kind.python_type(), if optional { " = ..." } else { "" })
    });
    format!("def {}(\n{}) -> Solid: ...\n", page.name, parameters.collect::<String>())
}

#[test]
fn python_stubs() {
    let pages = sorted();
    let names: String = pages.iter().map(|page| format!("    \"{}\",\n", page.name)).collect();
    let functions: String = pages.iter().map(|page| stub(page)).collect();
    let text = format!(
        "# Generated from the registry of primitives: run `{COMMAND}` instead of editing.\n\n\
         from numpy.typing import ArrayLike\n\nfrom rayweave._core import Solid\n\n__all__ = [\n{names}]\n\n{functions}"
    );
    compare("bindings/python/python/rayweave/_shapes.pyi", &text);
}

// ---- documentation ----

#[test]
fn reference_page() {
    let contents: String =
        MANUALS.iter().map(|page| format!("| [`{0}`](#{0}) | {1} |\n", page.name, page.summary)).collect();
    let pages: Vec<String> =
        MANUALS.iter().map(|page| format!("## {}\n\n{}\n", page.name, page.text.trim())).collect();
    let text = format!(
        "# Primitives\n\n\
         Each primitive is a solid with named faces. The names and parameters are the same in model\n\
         files, in Python and in Rust (`rayweave::shapes`). `rayweave shapes` prints the same pages, and\n\
         [gallery.toml](../../models/gallery.toml) shows every primitive.\n\n\
         This page is generated from the registry of primitives by `{COMMAND}`.\n\n\
         | primitive | solid |\n| --- | --- |\n{contents}\n{}",
        pages.join("\n")
    );
    compare("docs/reference/primitives.md", &text);
}

#[test]
fn the_gallery_shows_every_primitive() {
    let gallery = fs::read_to_string(root().join("models/gallery.toml")).unwrap();
    // meshes are read from files
    for page in MANUALS.iter().filter(|page| page.name != "mesh") {
        let key = format!("{} = {{", page.name);
        assert!(
            gallery.lines().any(|line| line.starts_with(&key)),
            "models/gallery.toml: no `{}`",
            page.name
        );
    }
}
