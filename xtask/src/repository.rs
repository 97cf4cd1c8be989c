//! The repository: its root and its files.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::process;

/// The checkout that a command works on.
pub struct Repository {
    /// The folder of the workspace's Cargo.toml.
    pub root: PathBuf,
}

/// A text file of the repository.
pub struct Source {
    /// The path relative to the root, with `/` as separator.
    pub path: String,
    /// Contents of the file.
    pub text: String,
}

impl Repository {
    /// Finds the workspace in the current folder or the nearest parent.
    pub fn find() -> Result<Repository, String> {
        let here = env::current_dir().map_err(|error| format!("no current folder: {error}."))?;
        here.ancestors()
            .find(|folder| is_workspace(folder))
            .map(|folder| Repository { root: folder.to_owned() })
            .ok_or_else(|| format!("{}: no Cargo workspace here or above", here.display()))
    }

    /// The folder that cargo builds into.
    pub fn target(&self) -> PathBuf {
        match env::var_os("CARGO_TARGET_DIR") {
            Some(folder) => self.root.join(folder),
            None => self.root.join("target"),
        }
    }

    /// All files that git tracks or would track, sorted: tracked files, and new files that are not
    /// ignored.
    pub fn files(&self) -> Result<Vec<String>, String> {
        let mut git = Command::new("git");
        git.current_dir(&self.root).args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"]);
        let listing = process::output(&mut git)?;
        let mut files: Vec<String> = listing
            .split('\0')
            .filter(|path| !path.is_empty() && self.root.join(path).is_file())
            .map(str::to_owned)
            .collect();
        files.sort_unstable();
        files.dedup();
        Ok(files)
    }

    /// Reads one file of the repository; `None` if it is not UTF-8 text.
    pub fn source(&self, path: &str) -> Result<Option<Source>, String> {
        let bytes =
            fs::read(self.root.join(path)).map_err(|error| format!("{path}: cannot be read: {error}."))?;
        let text = String::from_utf8(bytes).ok();
        Ok(text.map(|text| Source { path: path.to_owned(), text }))
    }
}

impl Source {
    /// True if the path ends with a dot and this extension.
    pub fn is(&self, extension: &str) -> bool {
        Path::new(&self.path).extension().is_some_and(|found| found == extension)
    }
}

/// True if the Cargo.toml of this folder defines a workspace.
fn is_workspace(folder: &Path) -> bool {
    fs::read_to_string(folder.join("Cargo.toml"))
        .is_ok_and(|text| text.lines().any(|line| line.trim() == "[workspace]"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_repository_holds_this_very_file() {
        let repository = Repository::find().unwrap();
        let path = "xtask/src/repository.rs";
        assert!(repository.files().unwrap().iter().any(|file| file == path));
        let source = repository.source(path).unwrap().unwrap();
        assert!(source.text.contains("the_repository_holds_this_very_file"));
        assert!(source.is("rs") && !source.is("toml"));
    }

    #[test]
    fn a_missing_file_is_named() {
        let message = Repository::find().unwrap().source("no/such/file.rs").err().unwrap();
        assert!(message.starts_with("no/such/file.rs: cannot be read: "), "{message}");
    }
}
