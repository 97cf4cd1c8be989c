//! Paths of a crate resolved to the files that define what they name.

use super::module::{Import, Module, ModulePath};
use std::collections::{BTreeMap, BTreeSet};

/// The modules of a crate by their paths.
pub struct Crate {
    pub modules: BTreeMap<ModulePath, Module>,
}

/// What a path names.
enum Target {
    Module(ModulePath),
    /// An item, by the module that defines it.
    Item(ModulePath),
}

/// For each file, the files whose definitions it uses, each with the first line that does.
pub type Uses = BTreeMap<String, BTreeMap<String, usize>>;

impl Crate {
    /// Which files use definitions of which others.
    ///
    /// A name that one module imports and others find there counts as a use of the file that defines it. A public import
    /// counts for the module itself only if its own code has the name.
    pub fn uses(&self) -> Uses {
        let mut uses = Uses::new();
        for (path, module) in &self.modules {
            let own = uses.entry(module.file.clone()).or_default();
            let imports = module.imports.iter().filter(|(name, import)| is_own(module, name, import));
            let imports = imports.map(|(_, import)| (&import.path, import.line));
            let targets = imports.chain(module.paths.iter().map(|(path, line)| (path, *line))).filter_map(
                |(wanted, line)| match self.resolve(path, wanted, &mut BTreeSet::new())? {
                    Target::Item(found) => Some((found, line)),
                    Target::Module(_) => None,
                },
            );
            let globs = module.globs.iter().filter(|import| !import.is_public);
            let globs =
                globs.filter_map(|import| match self.resolve(path, &import.path, &mut BTreeSet::new())? {
                    Target::Item(found) | Target::Module(found) => Some((found, import.line)),
                });
            for (target, line) in targets.chain(globs) {
                let file = self.modules.get(&target).map(|module| &module.file);
                if let Some(file) = file.filter(|file| **file != module.file) {
                    let first = own.entry(file.clone()).or_insert(line);
                    *first = line.min(*first);
                }
            }
        }
        uses
    }

    /// What a path in a module names; nothing for names of other crates.
    fn resolve(
        &self,
        from: &[String],
        path: &[String],
        seen: &mut BTreeSet<(ModulePath, String)>,
    ) -> Option<Target> {
        let mut at = from.to_vec();
        let mut rest = path;
        loop {
            match rest.split_first()? {
                (word, tail) if word == "crate" => (at, rest) = (Vec::new(), tail),
                (word, tail) if word == "self" => rest = tail,
                (word, tail) if word == "super" => {
                    at.pop()?;
                    rest = tail;
                }
                _ => break,
            }
            if rest.is_empty() {
                return Some(Target::Module(at));
            }
        }
        let is_relative = rest.len() == path.len();
        while let Some((name, tail)) = rest.split_first() {
            let found = self.find(&at, name, seen);
            match found {
                Some(Target::Module(inner)) => (at, rest) = (inner, tail),
                Some(item) => return Some(item),
                // made by a macro, or an item of another crate
                None if is_relative && rest.len() == path.len() => return None,
                None if self.is_foreign(&at, name) => return None,
                None => return Some(Target::Item(at)),
            }
        }
        Some(Target::Module(at))
    }

    /// A name within a module, as an item, a child, an import or one of a glob.
    fn find(&self, at: &[String], name: &str, seen: &mut BTreeSet<(ModulePath, String)>) -> Option<Target> {
        let module = self.modules.get(at)?;
        if module.children.contains(name) {
            return Some(Target::Module(at.iter().cloned().chain([name.to_owned()]).collect()));
        }
        if module.items.contains(name) {
            return Some(Target::Item(at.to_vec()));
        }
        if !seen.insert((at.to_vec(), name.to_owned())) {
            return None;
        }
        if let Some(import) = module.imports.get(name) {
            return self.resolve(at, &import.path, seen);
        }
        module.globs.iter().find_map(|import| match self.resolve(at, &import.path, seen)? {
            Target::Module(inner) => self.find(&inner, name, seen),
            Target::Item(_) => None,
        })
    }

    /// True for a name that a module imports from another crate.
    fn is_foreign(&self, at: &[String], name: &str) -> bool {
        self.modules.get(at).is_some_and(|module| module.imports.contains_key(name))
    }
}

/// True for an import that the module's own code uses.
fn is_own(module: &Module, name: &str, import: &Import) -> bool {
    !import.is_public || module.words.contains(name)
}
