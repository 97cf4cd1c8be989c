//! The dependencies of a program, read from `cargo metadata`: those that are linked into it, and those that its build compiles.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::process;

/// The output of `cargo metadata` for the workspace in a folder.
pub fn metadata(root: &Path) -> Result<Value, String> {
    let mut cargo = Command::new("cargo");
    cargo.current_dir(root).args(["metadata", "--format-version", "1", "--locked"]);
    serde_json::from_str(&process::output(&mut cargo)?).map_err(|error| format!("cargo metadata: {error}"))
}

/// The packages that builds of these packages of a workspace compile, on all platforms, as `NAME VERSION`.
///
/// `cargo metadata` lists more: also dependencies of features that nothing enables.
pub fn compiled(root: &Path, packages: &[&str]) -> Result<BTreeSet<String>, String> {
    let mut cargo = Command::new("cargo");
    cargo.current_dir(root).args(["tree", "--locked", "--edges", "normal,build", "--target", "all"]);
    cargo
        .args(["--prefix", "none", "--format", "{p}"])
        .args(packages.iter().flat_map(|name| ["--package", name]));
    Ok(names(&process::output(&mut cargo)?))
}

/// The packages in the output of `cargo tree`.
fn names(tree: &str) -> BTreeSet<String> {
    let name = |line: &str| {
        let mut words = line.split_whitespace();
        Some(format!("{} {}", words.next()?, words.next()?.strip_prefix('v')?))
    };
    tree.lines().filter_map(name).collect()
}

/// Packages of `cargo metadata` and the edges between them, on all platforms.
pub struct Graph<'a> {
    packages: BTreeMap<&'a str, &'a Value>,
    nodes: BTreeMap<&'a str, &'a Value>,
}

/// Which dependencies count.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// Those whose code is in the program: no procedural macros, build scripts and tests.
    Linked,
    /// Those that a build compiles: the linked ones, procedural macros and dependencies of build scripts, but not those of tests.
    Compiled,
}

impl<'a> Graph<'a> {
    /// The graph of the packages that [`compiled`] lists.
    pub fn new(metadata: &'a Value, compiled: &BTreeSet<String>) -> Result<Graph<'a>, String> {
        let by_id = |list: &'a Value, what: &str| -> Result<BTreeMap<&'a str, &'a Value>, String> {
            let list = list.as_array().ok_or(format!("cargo metadata has no {what}"))?;
            Ok(list.iter().filter_map(|entry| Some((entry["id"].as_str()?, entry))).collect())
        };
        let mut packages = by_id(&metadata["packages"], "packages")?;
        packages.retain(|_, package| compiled.contains(&title(package)));
        Ok(Graph { packages, nodes: by_id(&metadata["resolve"]["nodes"], "graph")? })
    }

    /// The packages with these names and all their dependencies, sorted by name and version.
    pub fn reachable(&self, roots: &[&str], kind: Kind) -> Vec<&'a Value> {
        let is_root = |package: &Value| roots.iter().any(|name| package["name"] == *name);
        let mut waiting: Vec<&str> =
            self.packages.iter().filter(|(_, package)| is_root(package)).map(|(id, _)| *id).collect();
        let mut met: BTreeSet<&str> = waiting.iter().copied().collect();
        while let Some(id) = waiting.pop() {
            let new = self.dependencies(id, kind).into_iter().filter(|other| met.insert(other));
            waiting.extend(new);
        }
        let mut packages: Vec<&Value> = met.into_iter().map(|id| self.packages[id]).collect();
        packages.sort_by_key(|package| (package["name"].to_string(), package["version"].to_string()));
        packages
    }

    /// The identifiers of the direct dependencies of a package.
    pub fn dependencies(&self, id: &str, kind: Kind) -> Vec<&'a str> {
        let entries = self.nodes.get(id).and_then(|node| node["deps"].as_array()).into_iter().flatten();
        let counts = |entry: &&Value| {
            list(&entry["dep_kinds"]).any(|of| match kind {
                Kind::Linked => of["kind"].is_null(),
                Kind::Compiled => of["kind"].is_null() || of["kind"] == "build",
            })
        };
        let ids = entries.filter(counts).filter_map(|entry| entry["pkg"].as_str());
        ids.filter(|id| {
            self.packages.get(id).is_some_and(|package| kind == Kind::Compiled || !is_macro(package))
        })
        .collect()
    }
}

/// Name and version of a package.
pub fn title(package: &Value) -> String {
    let word = |key: &str| package[key].as_str().unwrap_or_default();
    format!("{} {}", word("name"), word("version"))
}

/// True for packages that are not part of this repository.
pub fn is_external(package: &Value) -> bool {
    !package["source"].is_null()
}

fn is_macro(package: &Value) -> bool {
    list(&package["targets"]).any(|target| list(&target["kind"]).any(|kind| kind == "proc-macro"))
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn macros_and_build_scripts_are_compiled_but_not_linked() {
        let edge = |to: &str, kind: Value| serde_json::json!({"pkg": to, "dep_kinds": [{"kind": kind}]});
        let package = |name: &str, kind: &str| serde_json::json!({"id": name, "name": name, "version": "1.0.0", "targets": [{"kind": [kind]}]});
        let metadata = serde_json::json!({
            "packages": [package("main", "bin"), package("lib", "lib"), package("derive", "proc-macro"),
                package("cc", "lib"), package("check", "lib"), package("below", "lib"), package("other", "lib"), package("off", "lib")],
            "resolve": {"nodes": [
                {"id": "main", "deps": [edge("lib", Value::Null), edge("derive", Value::Null), edge("cc", "build".into()),
                    edge("check", "dev".into()), edge("off", Value::Null)]},
                {"id": "lib", "deps": [edge("below", Value::Null), edge("main", "dev".into())]}]},
        });
        let tree = "main v1.0.0 (/a/main)\nlib v1.0.0\nderive v1.0.0 (proc-macro)\ncc v1.0.0\n\nbelow v1.0.0\nlib v1.0.0 (*)\n";
        let graph = Graph::new(&metadata, &super::names(tree)).unwrap();
        let names = |kind| {
            let packages = graph.reachable(&["main"], kind);
            packages.iter().map(|package| package["name"].as_str().unwrap()).collect::<Vec<_>>()
        };
        assert_eq!(names(Kind::Linked), ["below", "lib", "main"]);
        assert_eq!(names(Kind::Compiled), ["below", "cc", "derive", "lib", "main"]);
    }
}
