//! The list of the crates that are linked into a program, as a software bill of materials (SBOM): CycloneDX 1.5, JSON.
//!
//! The specification is <https://cyclonedx.org/docs/1.5/json/>. The list names each crate with its version, licence and package URL,
//! and with the SHA-256 of its published archive, which Cargo.lock records.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use crate::dependencies::{Graph, Kind, is_external};

/// The list of the program that the package `root` builds. `metadata` is the output of `cargo metadata`, `compiled` names the packages
/// that its build compiles, and `lock` is the text of Cargo.lock.
pub fn write(metadata: &Value, compiled: &BTreeSet<String>, lock: &str, root: &str) -> Result<Value, String> {
    let graph = Graph::new(metadata, compiled)?;
    let packages = graph.reachable(&[root], Kind::Linked);
    let main = packages.iter().find(|package| package["name"] == root);
    let main = main.ok_or(format!("{root}: the workspace has no such package."))?;
    let checksums = checksums(lock);
    let mut components = Vec::new();
    for package in packages.iter().filter(|package| package["name"] != root) {
        components.push(component(package, "library", &checksums)?);
    }
    let references: BTreeMap<&str, String> =
        packages.iter().map(|package| (word(package, "id"), url(package))).collect();
    let edges = packages.iter().map(|package| {
        let others = graph.dependencies(word(package, "id"), Kind::Linked);
        let others: Vec<&String> = others.iter().filter_map(|id| references.get(id)).collect();
        json!({"ref": url(package), "dependsOn": others})
    });
    Ok(json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": component(main, "application", &checksums)?},
        "components": components,
        "dependencies": edges.collect::<Vec<_>>(),
    }))
}

fn component(package: &Value, kind: &str, checksums: &BTreeMap<(&str, &str), &str>) -> Result<Value, String> {
    let (name, version) = (word(package, "name"), word(package, "version"));
    let mut component = json!({
        "type": kind,
        "bom-ref": url(package),
        "name": name,
        "version": version,
        "purl": url(package),
        "licenses": [{"expression": expression(word(package, "license"))}],
    });
    if let Some(repository) = package["repository"].as_str() {
        component["externalReferences"] = json!([{"type": "vcs", "url": repository}]);
    }
    if is_external(package) {
        let sum = checksums.get(&(name, version)).ok_or(format!("{name} {version}: not in Cargo.lock."))?;
        component["hashes"] = json!([{"alg": "SHA-256", "content": sum}]);
    }
    Ok(component)
}

/// A licence as an SPDX expression. Old manifests write a slash for `OR`.
fn expression(licence: &str) -> String {
    licence.replace(" / ", " OR ").replace('/', " OR ")
}

/// The package URL of a crate (<https://github.com/package-url/purl-spec>).
fn url(package: &Value) -> String {
    format!("pkg:cargo/{}@{}", word(package, "name"), word(package, "version").replace('+', "%2B"))
}

fn word<'a>(package: &'a Value, key: &str) -> &'a str {
    package[key].as_str().unwrap_or_default()
}

/// The checksums in a Cargo.lock, by name and version.
fn checksums(lock: &str) -> BTreeMap<(&str, &str), &str> {
    fn value<'a>(block: &'a str, key: &str) -> Option<&'a str> {
        block.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = \"")?.strip_suffix('"'))
    }
    let entry = |block| Some(((value(block, "name")?, value(block, "version")?), value(block, "checksum")?));
    lock.split("[[package]]").filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOCK: &str = "version = 4\n\n[[package]]\nname = \"main\"\nversion = \"0.1.0\"\ndependencies = [\n \"glass\",\n]\n\n\
        [[package]]\nname = \"glass\"\nversion = \"2.0.0+a\"\nsource = \"registry\"\nchecksum = \"beef\"\n";

    fn metadata() -> Value {
        json!({
            "packages": [
                {"id": "m", "name": "main", "version": "0.1.0", "license": "MIT", "source": null, "targets": []},
                {"id": "g", "name": "glass", "version": "2.0.0+a", "license": "MIT/Apache-2.0", "source": "registry",
                 "targets": [], "repository": "https://example.org/glass"},
                {"id": "t", "name": "tests", "version": "1.0.0", "license": "MIT", "source": "registry", "targets": []}],
            "resolve": {"nodes": [{"id": "m", "deps": [
                {"pkg": "g", "dep_kinds": [{"kind": null}]}, {"pkg": "t", "dep_kinds": [{"kind": "dev"}]}]}]},
        })
    }

    fn compiled() -> BTreeSet<String> {
        ["main 0.1.0", "glass 2.0.0+a"].map(str::to_owned).into()
    }

    #[test]
    fn linked_crates_have_versions_licences_and_checksums() {
        let list = write(&metadata(), &compiled(), LOCK, "main").unwrap();
        assert_eq!(list["metadata"]["component"]["bom-ref"], "pkg:cargo/main@0.1.0");
        let expected = json!([{
            "type": "library", "bom-ref": "pkg:cargo/glass@2.0.0%2Ba", "name": "glass", "version": "2.0.0+a",
            "purl": "pkg:cargo/glass@2.0.0%2Ba", "licenses": [{"expression": "MIT OR Apache-2.0"}],
            "externalReferences": [{"type": "vcs", "url": "https://example.org/glass"}],
            "hashes": [{"alg": "SHA-256", "content": "beef"}],
        }]);
        assert_eq!(list["components"], expected);
        let edges = json!([
            {"ref": "pkg:cargo/glass@2.0.0%2Ba", "dependsOn": []},
            {"ref": "pkg:cargo/main@0.1.0", "dependsOn": ["pkg:cargo/glass@2.0.0%2Ba"]}]);
        assert_eq!(list["dependencies"], edges);
    }

    #[test]
    fn unknown_packages_and_missing_checksums_are_errors() {
        assert!(
            write(&metadata(), &compiled(), LOCK, "no-such")
                .unwrap_err()
                .starts_with("no-such: the workspace has no")
        );
        let message = write(&metadata(), &compiled(), "", "main").unwrap_err();
        assert_eq!(message, "glass 2.0.0+a: not in Cargo.lock.");
    }
}
