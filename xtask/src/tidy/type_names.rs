//! Check of type names: a name that several library crates export is listed in CONVENTIONS.md with its meanings.
//!
//! Exported are public structs, enums and traits in public modules of a crate, and those that a public module
//! re-exports from another module of the crate. This is an approximation: the name of a re-exported type is looked up
//! among all public types of the crate; `module::*` stands for the types that a child module defines itself; re-exports
//! from other crates and types that macros define do not count.

use std::collections::{BTreeMap, BTreeSet};

use syn::{Item, ItemMod, UseTree, Visibility};

use super::violation::{Rule, Violation};
use crate::repository::Source;

static TYPE_NAME: Rule =
    Rule { name: "type-name", why: "a type name has one meaning unless CONVENTIONS.md lists its meanings" };

/// The file with the table.
const TABLE_FILE: &str = "CONVENTIONS.md";

/// The heading of the table.
const HEADING: &str = "## Type names with more than one meaning";

/// Crates that are not libraries of their own: programs, test tools, and the facade, which only re-exports.
const OTHER_CRATES: [&str; 4] = ["bench", "cli", "conformance", "rayweave"];

/// The type names of all crates, and the table.
#[derive(Default)]
pub struct TypeNames {
    crates: BTreeMap<String, Crate>,
    table: Option<Source>,
}

/// The modules of a crate, by their paths.
type Crate = BTreeMap<Vec<String>, Module>;

/// The public part of a module.
#[derive(Default)]
struct Module {
    /// Public types.
    types: BTreeSet<String>,
    /// Modules declared `pub`.
    public_modules: BTreeSet<String>,
    /// Public imports: the path, and the name under which it is exported.
    exports: Vec<(Vec<String>, String)>,
}

impl TypeNames {
    /// Adds a file of the repository; files other than sources of library crates and the table are ignored.
    pub fn add(&mut self, source: &Source) {
        if source.path == TABLE_FILE {
            self.table = Some(Source { path: source.path.clone(), text: source.text.clone() });
        }
        let Some((name, module)) = module_of(&source.path) else { return };
        // The compiler reports syntax errors.
        let Ok(file) = syn::parse_file(&source.text) else { return };
        read(&file.items, &module, self.crates.entry(name.to_owned()).or_default());
    }

    /// Names that several crates export and the table lacks, and rows of the table whose name is not one of them.
    pub fn violations(&self) -> Vec<Violation> {
        let Some(table) = &self.table else { return Vec::new() };
        let mut users: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        for (name, modules) in &self.crates {
            exported(modules).into_iter().for_each(|exported| users.entry(exported).or_default().push(name));
        }
        users.retain(|_, crates| crates.len() > 1);
        let (heading, rows) = rows(&table.text);
        let unlisted = users.iter().filter(|(name, _)| !rows.iter().any(|(row, _)| row == *name));
        let unlisted = unlisted.map(|(name, crates)| {
            let problem = format!("the type name `{name}` is exported by the crates {}", crates.join(", "));
            Violation::new(&TYPE_NAME, table, heading, problem, "rename one type, or add a row to the table")
                .about(name)
        });
        let idle = rows.iter().filter(|(row, _)| !users.contains_key(row)).map(|(row, line)| {
            let problem = format!("the type name `{row}` is not exported by several crates");
            Violation::new(&TYPE_NAME, table, *line, problem, "remove the row").about(row)
        });
        unlisted.chain(idle).collect()
    }
}

/// The library crate and the module of a source file; `None` for any other file.
fn module_of(path: &str) -> Option<(&str, Vec<String>)> {
    let (name, file) = path.strip_prefix("crates/")?.split_once("/src/")?;
    let module = file.strip_suffix(".rs")?;
    let module = module.strip_suffix("/mod").unwrap_or(module);
    let is_library = !OTHER_CRATES.contains(&name) && module != "main";
    let module = if module == "lib" { Vec::new() } else { module.split('/').map(str::to_owned).collect() };
    is_library.then_some((name, module))
}

/// Adds the items of a module and its inline modules.
fn read(items: &[Item], path: &[String], modules: &mut Crate) {
    let mut module = Module::default();
    for item in items {
        match item {
            Item::Struct(item) if is_public(&item.vis) => _ = module.types.insert(item.ident.to_string()),
            Item::Enum(item) if is_public(&item.vis) => _ = module.types.insert(item.ident.to_string()),
            Item::Trait(item) if is_public(&item.vis) => _ = module.types.insert(item.ident.to_string()),
            Item::Use(item) if is_public(&item.vis) => {
                leaves(&item.tree, &mut Vec::new(), &mut module.exports)
            }
            Item::Mod(ItemMod { vis, ident, content, .. }) => {
                if is_public(vis) {
                    module.public_modules.insert(ident.to_string());
                }
                if let Some((_, items)) = content {
                    read(items, &[path, &[ident.to_string()]].concat(), modules);
                }
            }
            _ => {}
        }
    }
    modules.insert(path.to_vec(), module);
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// Appends the imported paths of a tree, each with the name that it has after the import.
fn leaves(tree: &UseTree, path: &mut Vec<String>, found: &mut Vec<(Vec<String>, String)>) {
    let mut leaf = |name: String, alias: String| found.push(([&path[..], &[name]].concat(), alias));
    match tree {
        UseTree::Name(name) => leaf(name.ident.to_string(), name.ident.to_string()),
        UseTree::Rename(name) => leaf(name.ident.to_string(), name.rename.to_string()),
        UseTree::Path(step) => {
            path.push(step.ident.to_string());
            leaves(&step.tree, path, found);
            path.pop();
        }
        UseTree::Group(group) => group.items.iter().for_each(|tree| leaves(tree, path, found)),
        UseTree::Glob(_) => leaf("*".to_owned(), "*".to_owned()),
    }
}

/// The names of the types that a crate exports.
fn exported(modules: &Crate) -> BTreeSet<String> {
    let types: BTreeSet<&String> = modules.values().flat_map(|module| &module.types).collect();
    let mut names = BTreeSet::new();
    let mut waiting = vec![Vec::new()];
    while let Some(path) = waiting.pop() {
        let Some(module) = modules.get(&path) else { continue };
        names.extend(module.types.iter().cloned());
        let of_crate = |name: &str| {
            matches!(name, "crate" | "self" | "super")
                || modules.contains_key(&[&path[..], &[name.to_owned()]].concat())
        };
        for (import, alias) in module.exports.iter().filter(|(import, _)| of_crate(&import[0])) {
            match import.split_last() {
                Some((last, parents)) if last == "*" => {
                    let parents = parents.strip_prefix(&["self".to_owned()]).unwrap_or(parents);
                    let source = modules.get(&[&path[..], parents].concat());
                    names.extend(source.into_iter().flat_map(|source| source.types.iter().cloned()));
                }
                Some((last, _)) if types.contains(last) => _ = names.insert(alias.clone()),
                _ => {}
            }
        }
        waiting.extend(
            module.public_modules.iter().map(|name| [&path[..], std::slice::from_ref(name)].concat()),
        );
    }
    names
}

/// The line of the heading of the table, 1 if there is none, and the names in the first column with their lines.
fn rows(text: &str) -> (usize, Vec<(String, usize)>) {
    let Some(heading) = text.lines().position(|line| line == HEADING) else { return (1, Vec::new()) };
    let section = text.lines().enumerate().skip(heading + 1).take_while(|(_, line)| !line.starts_with("## "));
    let name = |(index, line): (usize, &str)| {
        let name = line.strip_prefix("| `")?.split_once('`')?.0;
        Some((name.to_owned(), index + 1))
    };
    (heading + 1, section.filter_map(name).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names and lines of the violations of some files.
    fn found(files: &[(&str, &str)]) -> Vec<(String, usize)> {
        let mut names = TypeNames::default();
        for (path, text) in files {
            names.add(&Source { path: (*path).to_owned(), text: (*text).to_owned() });
        }
        names.violations().into_iter().map(|violation| (violation.item, violation.line)).collect()
    }

    const EMPTY: (&str, &str) = (TABLE_FILE, "# Conventions\n\n## Type names with more than one meaning\n");

    #[test]
    fn a_name_of_two_crates_needs_a_row() {
        let files = [("crates/a/src/lib.rs", "pub struct Ray;"), ("crates/b/src/lib.rs", "pub enum Ray {}")];
        assert_eq!(found(&[files[0], files[1], EMPTY]), [("Ray".to_owned(), 3)]);
        let table =
            (TABLE_FILE, "## Type names with more than one meaning\n\n| `Ray` | a: line; b: fish |\n");
        assert_eq!(found(&[files[0], files[1], table]), []);
        assert_eq!(found(&[files[0], table]), [("Ray".to_owned(), 3)]);
    }

    #[test]
    fn private_types_and_modules_do_not_count() {
        let public = ("crates/a/src/lib.rs", "pub trait Ray {}");
        for text in
            ["struct Ray;", "pub(crate) struct Ray;", "mod inner { pub struct Ray; }", "pub fn ray() {}"]
        {
            assert_eq!(found(&[public, ("crates/b/src/lib.rs", text), EMPTY]), [], "{text}");
        }
        assert_eq!(found(&[public, ("crates/bench/src/lib.rs", "pub struct Ray;"), EMPTY]), []);
        assert_eq!(found(&[public, ("crates/b/src/main.rs", "pub struct Ray;"), EMPTY]), []);
        assert_eq!(found(&[public, ("crates/b/tests/ray.rs", "pub struct Ray;"), EMPTY]), []);
    }

    #[test]
    fn types_are_found_in_public_modules_and_behind_re_exports() {
        let public = ("crates/a/src/lib.rs", "pub struct Ray;");
        let inner = ("crates/b/src/optics/mod.rs", "mod ray; pub use ray::{Fish as Ray, Other};");
        let files = [inner, ("crates/b/src/optics/ray.rs", "pub struct Fish; pub struct Other;")];
        let through = |root| found(&[public, ("crates/b/src/lib.rs", root), files[0], files[1], EMPTY]);
        assert_eq!(through("pub mod optics;"), [("Ray".to_owned(), 3)]);
        assert_eq!(through("mod optics;"), []);
        assert_eq!(through("mod optics; pub use optics::*;"), []);
        let inline = ("crates/b/src/lib.rs", "pub mod optics { pub struct Ray; }");
        assert_eq!(found(&[public, inline, EMPTY]), [("Ray".to_owned(), 3)]);
        let all = ("crates/b/src/lib.rs", "mod optics { pub struct Ray; } pub use optics::*;");
        assert_eq!(found(&[public, all, EMPTY]), [("Ray".to_owned(), 3)]);
    }

    #[test]
    fn re_exports_of_other_crates_do_not_count() {
        let files = [("crates/a/src/lib.rs", "pub struct Ray;"), ("crates/b/src/lib.rs", "pub use a::Ray;")];
        assert_eq!(found(&[files[0], files[1], EMPTY]), []);
    }
}
