//! Detection of import cycles between the files of a crate. Each permitted cycle has a reason in
//! ARCHITECTURE.md.

mod graph;
mod module;
mod resolve;
mod token;

use std::collections::{BTreeMap, BTreeSet};

use crate::masked::Masked;
use crate::repository::Repository;
use module::ModulePath;
use resolve::{Crate, Uses};

/// Marks of the table of exceptions in ARCHITECTURE.md.
const OPEN: &str = "<!-- cycles -->";
const CLOSE: &str = "<!-- /cycles -->";

/// A permitted cycle: the files of a folder, and the line of the table.
#[derive(Debug, PartialEq, Eq)]
struct Exception {
    folder: String,
    line: usize,
}

/// All import cycles that the table of exceptions does not list, and all exceptions without a
/// cycle. `text` is the text of `file`, which contains the table.
pub fn problems(repository: &Repository, file: &str, text: &str) -> Result<Vec<String>, String> {
    let exceptions = exceptions(text).map_err(|problem| format!("{file}:{problem}"))?;
    let mut used = vec![false; exceptions.len()];
    let mut problems = Vec::new();
    for (root, files) in crates(repository)? {
        let uses = Crate::read(&files).uses();
        for cycle in cycles(&uses) {
            let full: Vec<String> = cycle.iter().map(|name| format!("{root}/{name}")).collect();
            let covers = |exception: &Exception| full.iter().all(|path| path.starts_with(&exception.folder));
            match exceptions.iter().position(covers) {
                Some(number) => used[number] = true,
                None => problems.push(report(&root, &cycle, &uses)),
            }
        }
    }
    let unused = exceptions.iter().zip(used).filter(|(_, used)| !used);
    problems.extend(unused.map(|(exception, _)| {
        let Exception { folder, line } = exception;
        format!("{file}:{line}: no import cycle in {folder}: the exception is not needed. Delete the row.")
    }));
    Ok(problems)
}

/// The rows of the table of exceptions, each a folder or file and a reason; the table is optional.
fn exceptions(text: &str) -> Result<Vec<Exception>, String> {
    let rows = text.lines().enumerate().skip_while(|(_, line)| line.trim() != OPEN);
    // the marker, the heading and the rule below it
    let rows =
        rows.skip(1).take_while(|(_, line)| line.trim() != CLOSE).filter(|(_, line)| !line.trim().is_empty());
    let row = |(index, line): (usize, &str)| {
        let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        match cells[..] {
            [folder, reason] if !reason.is_empty() => {
                Ok(Exception { folder: folder.trim_matches('`').to_owned(), line: index + 1 })
            }
            _ => Err(format!("{}: a row has two cells, folder and reason", index + 1)),
        }
    };
    rows.skip(2).map(row).collect()
}

/// The files of each crate by its folder: paths within it, and texts.
fn crates(repository: &Repository) -> Result<BTreeMap<String, BTreeMap<String, String>>, String> {
    let mut crates: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
    for path in repository.files()? {
        let Some((root, name)) = path.split_once("/src/").filter(|(_, name)| name.ends_with(".rs")) else {
            continue;
        };
        if let Some(source) = repository.source(&path)? {
            crates.entry(format!("{root}/src")).or_default().insert(name.to_owned(), source.text);
        }
    }
    Ok(crates)
}

impl Crate {
    /// Reads all modules declared in `lib.rs`, `main.rs` and their descendants, except tests.
    fn read(files: &BTreeMap<String, String>) -> Crate {
        let mut modules = BTreeMap::new();
        for root in ["main.rs", "lib.rs"] {
            let mut open: Vec<(ModulePath, String)> = vec![(Vec::new(), root.to_owned())];
            while let Some((path, file)) = open.pop() {
                let Some(text) = files.get(&file) else { continue };
                let mut found = BTreeMap::new();
                module::read(&file, &path, &token::tokens(&Masked::new(text)), &mut found);
                for (parent, module) in &found {
                    let children = module
                        .children
                        .iter()
                        .map(|name| [parent.as_slice(), std::slice::from_ref(name)].concat());
                    let own = children.filter(|child| !found.contains_key(child));
                    open.extend(own.filter_map(|child| Some((child.clone(), file_of(files, &child)?))));
                }
                modules.extend(found);
            }
        }
        Crate { modules }
    }
}

/// The file of a module: `a/b.rs` or `a/b/mod.rs`.
fn file_of(files: &BTreeMap<String, String>, path: &[String]) -> Option<String> {
    let base = path.join("/");
    [format!("{base}.rs"), format!("{base}/mod.rs")].into_iter().find(|name| files.contains_key(name))
}

/// The groups of files that use each other's definitions, directly or indirectly.
fn cycles(uses: &Uses) -> Vec<Vec<&str>> {
    let edges: BTreeMap<&str, BTreeSet<&str>> =
        uses.iter().map(|(file, used)| (file.as_str(), used.keys().map(String::as_str).collect())).collect();
    graph::cycles(&edges)
}

/// A cycle with the lines at which its files use each other.
fn report(root: &str, cycle: &[&str], uses: &Uses) -> String {
    let mut text = format!(
        "{root}: {} files import each other: one of two files comes first. Move what they share into a file of its own.",
        cycle.len()
    );
    for file in cycle {
        let used = uses.get(*file).into_iter().flatten().filter(|(other, _)| cycle.contains(&other.as_str()));
        for (other, line) in used {
            text.push_str(&format!("\n  {root}/{file}:{line}: uses {other}"));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let files = files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
        let uses = Crate::read(&files).uses();
        cycles(&uses).into_iter().map(|cycle| cycle.into_iter().map(str::to_owned).collect()).collect()
    }

    #[test]
    fn files_that_import_each_other_are_found() {
        let two = [
            ("lib.rs", "mod a;\nmod b;"),
            ("a.rs", "use crate::b::B;\npub struct A(B);"),
            ("b.rs", "pub struct B;\nfn f() -> super::a::A {}"),
        ];
        assert_eq!(found(&two), [["a.rs", "b.rs"]]);
        let one = [two[0], two[1], ("b.rs", "pub struct B;")];
        assert!(found(&one).is_empty());
    }

    #[test]
    fn names_found_elsewhere_count_where_they_are_defined() {
        let parent = "mod b;\nmod c;\npub use b::B;\npub use c::*;";
        let files = [
            ("lib.rs", "mod a;"),
            ("a/mod.rs", parent),
            ("a/b.rs", "use super::C;\npub struct B(C);"),
            ("a/c.rs", "pub struct C;"),
        ];
        assert!(found(&files).is_empty());
        // the parent's own code uses B, and B uses a definition of the parent
        let own = format!("{parent}\npub struct D;\nfn f(b: B) {{}}");
        let files = [
            files[0],
            ("a/mod.rs", own.as_str()),
            ("a/b.rs", "use super::{C, D};\npub struct B(C, D);"),
            files[3],
        ];
        assert_eq!(found(&files), [["a/b.rs", "a/mod.rs"]]);
    }

    #[test]
    fn names_of_imported_modules_are_followed() {
        let files = [
            ("lib.rs", "mod a;\nmod b;"),
            ("a.rs", "use crate::b;\npub fn f() { b::g(); }"),
            ("b.rs", "use std::fmt;\nuse super::a as other;\npub fn g() { other::f(); fmt::Error; }"),
        ];
        assert_eq!(found(&files), [["a.rs", "b.rs"]]);
    }

    #[test]
    fn tests_do_not_count() {
        let files = [
            ("lib.rs", "mod a;\nmod b;\n#[cfg(test)]\nmod tests;"),
            ("a.rs", "use crate::b::B;\npub struct A(B);"),
            ("b.rs", "pub struct B;\n#[cfg(test)]\nmod tests {\n    use crate::a::A;\n}"),
            ("tests.rs", "use crate::a::A;"),
        ];
        assert!(found(&files).is_empty());
    }

    #[test]
    fn exceptions_are_read() {
        let text = format!(
            "# A\n{OPEN}\n| files | reason |\n| --- | --- |\n| `crates/a/src/b` | a reason |\n{CLOSE}\n"
        );
        assert_eq!(exceptions(&text).unwrap(), [Exception { folder: "crates/a/src/b".to_owned(), line: 5 }]);
        assert!(exceptions(&text.replace("a reason", "")).unwrap_err().starts_with("5: "));
        assert!(exceptions("# A\n").unwrap().is_empty());
    }
}
