//! The imports of the stub: the modules of the names in its types.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Names without import.
const BUILT_IN: [&str; 12] =
    ["None", "True", "False", "bool", "bytes", "dict", "float", "int", "list", "object", "str", "tuple"];

/// Modules of the standard library and their names.
const STANDARD: [(&str, &[&str]); 3] = [
    ("collections.abc", &["Callable", "Iterable", "Iterator", "Mapping", "Sequence"]),
    ("os", &["PathLike"]),
    ("typing", &["Any", "Literal", "NoReturn", "Self", "final", "overload"]),
];

/// Other packages and their names.
const PACKAGES: [(&str, &[&str]); 2] =
    [("numpy.typing", &["ArrayLike", "NDArray"]), ("typing_extensions", &["disjoint_base"])];

/// The name under which NumPy is imported.
const NUMPY: &str = "np";

/// The names that a type consists of; neither those after a dot nor the words of a `Literal`.
pub fn names(annotation: &str) -> Vec<&str> {
    let mut names = Vec::new();
    for (k, outside) in annotation.split(['"', '\'']).enumerate() {
        if k % 2 == 1 {
            continue;
        }
        let mut before = None;
        for word in outside.split_inclusive(|c: char| !(c.is_alphanumeric() || c == '_')) {
            let name = word.trim_end_matches(|c: char| !(c.is_alphanumeric() || c == '_'));
            if name.starts_with(|c: char| c.is_alphabetic() || c == '_') && before != Some('.') {
                names.push(name);
            }
            before = word.chars().last();
        }
    }
    names
}

/// The modules of the Python package that define a name at their top level.
pub struct Package(BTreeMap<String, BTreeSet<String>>);

impl Package {
    /// Reads the modules below a folder, that of the package.
    pub fn read(folder: &Path, package: &str) -> Result<Package, String> {
        let mut names = BTreeMap::new();
        let mut waiting = vec![(folder.to_owned(), package.to_owned())];
        while let Some((folder, module)) = waiting.pop() {
            let failed = |error: std::io::Error| format!("{}: cannot be read: {error}.", folder.display());
            for entry in fs::read_dir(&folder).map_err(failed)? {
                let path = entry.map_err(failed)?.path();
                let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                if path.is_dir() {
                    waiting.push((path, format!("{module}.{stem}")));
                } else if path.extension().is_some_and(|extension| extension == "py") {
                    let module = if stem == "__init__" { module.clone() } else { format!("{module}.{stem}") };
                    add(&mut names, &module, &fs::read_to_string(&path).map_err(failed)?);
                }
            }
        }
        Ok(Package(names))
    }

    /// The only module that defines a name.
    fn module(&self, name: &str) -> Option<&str> {
        let modules = self.0.get(name)?;
        modules.first().filter(|_| modules.len() == 1).map(String::as_str)
    }
}

/// Adds the names that a module defines.
fn add(names: &mut BTreeMap<String, BTreeSet<String>>, module: &str, text: &str) {
    for line in text.lines() {
        let class = line.strip_prefix("class ").map(|rest| rest.split([':', '(']).next().unwrap_or(rest));
        let assigned =
            line.split_once([' ', ':']).filter(|(_, rest)| rest.contains('=')).map(|(name, _)| name);
        let Some(name) = class.or(assigned) else { continue };
        if !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_') {
            names.entry(name.to_owned()).or_default().insert(module.to_owned());
        }
    }
}

/// The import statements for names; `own` are those of the stub itself. The error lists unknown names.
pub fn statements(
    used: &BTreeSet<&str>,
    own: &BTreeSet<&str>,
    package: &Package,
) -> Result<String, Vec<String>> {
    let (mut standard, mut others, mut ours) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
    let mut unknown = Vec::new();
    for &name in
        used.iter().filter(|name| !own.contains(*name) && !BUILT_IN.contains(name) && **name != NUMPY)
    {
        let module = |list: &'static [(&'static str, &'static [&'static str])]| {
            list.iter().find(|(_, names)| names.contains(&name)).map(|(module, _)| *module)
        };
        let (group, module) = match (module(&STANDARD), module(&PACKAGES), package.module(name)) {
            (Some(module), _, _) => (&mut standard, module),
            (None, Some(module), _) => (&mut others, module),
            (None, None, Some(module)) => (&mut ours, module),
            (None, None, None) => {
                unknown.push(format!(
                    "'{name}' in a type of the stub: no module defines it, or several do. Is it misspelt?"
                ));
                continue;
            }
        };
        group.entry(module).or_insert_with(Vec::new).push(name);
    }
    if !unknown.is_empty() {
        return Err(unknown);
    }
    let lines = |group: BTreeMap<&str, Vec<&str>>| {
        let line = |(module, mut names): (&str, Vec<&str>)| {
            // capitals first, as formatters of Python sort them
            names.sort_by_key(|name| (name.starts_with(|c: char| c.is_lowercase()), *name));
            format!("from {module} import {}\n", names.join(", "))
        };
        group.into_iter().map(line).collect::<String>()
    };
    let numpy = if used.contains(NUMPY) { "import numpy as np\n" } else { "" };
    let groups = [lines(standard), format!("{numpy}{}", lines(others)), lines(ours)];
    Ok(groups.into_iter().filter(|group| !group.is_empty()).collect::<Vec<_>>().join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_outside_of_words_and_attributes() {
        let found = names("NDArray[np.float64] | Literal[\"natural\", 'x'] | tuple[float, ...] | None");
        assert_eq!(found, ["NDArray", "np", "Literal", "tuple", "float", "None"]);
    }

    #[test]
    fn each_name_is_imported_from_its_module() {
        let mut modules = BTreeMap::new();
        add(&mut modules, "rayweave._model", "class Region(Base):\n    x = 1\nimport numpy as np\n");
        add(&mut modules, "rayweave._check", "CheckRow = tuple[int, str]\n");
        let package = Package(modules);
        let used = BTreeSet::from(["np", "NDArray", "Any", "Region", "CheckRow", "Solid", "int", "final"]);
        let text = statements(&used, &BTreeSet::from(["Solid"]), &package).unwrap();
        let expected = "from typing import Any, final\n\nimport numpy as np\nfrom numpy.typing import NDArray\n\n\
                        from rayweave._check import CheckRow\nfrom rayweave._model import Region\n";
        assert_eq!(text, expected);
        let used = BTreeSet::from(["Regoin"]);
        assert_eq!(statements(&used, &BTreeSet::new(), &package).unwrap_err().len(), 1);
    }
}
