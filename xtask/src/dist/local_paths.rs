//! Folders of this machine, which must not be in the programs that are distributed.
//!
//! The compiler embeds the paths of source files in panic messages: those of dependencies are in Cargo's folder, which
//! reveals the name of the user. Cargo's `trim-paths` is not stable, and the compiler's flag that replaces paths needs
//! the actual paths, so no setting of the repository can contain it.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::outcome::Outcome;
use crate::process;
use crate::repository::Repository;

/// Folders of this machine, with the paths that replace them. If several contain a path, the last one applies.
#[derive(Debug, PartialEq)]
pub struct LocalPaths(Vec<(PathBuf, &'static str)>);

impl LocalPaths {
    pub fn find(repository: &Repository, target: &Path) -> Result<LocalPaths, String> {
        let home = env::home_dir().filter(|home| home.parent().is_some());
        let cargo = env::var_os("CARGO_HOME").map(PathBuf::from);
        let cargo = cargo.or_else(|| home.as_ref().map(|home| home.join(".cargo")));
        let sysroot = process::output(Command::new("rustc").args(["--print", "sysroot"]))?;
        let all = [
            (home, "/anon"),
            (cargo, "/cargo"),
            (Some(PathBuf::from(sysroot.trim())), "/rust"),
            (Some(repository.root.clone()), "/rayweave"),
            (Some(target.to_owned()), "/target"),
        ];
        Ok(LocalPaths(all.into_iter().filter_map(|(path, short)| Some((path?, short))).collect()))
    }

    /// Makes a cargo build replace these paths, also in the C code of dependencies.
    pub fn hide<'a>(&self, cargo: &'a mut Command, target: &Path) -> &'a mut Command {
        let flags = |flag: &str| -> Vec<String> {
            self.0.iter().map(|(path, short)| format!("{flag}={}={short}", path.display())).collect()
        };
        // flags in the environment would replace those of the configuration
        cargo.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
        let own = env::var("CFLAGS").unwrap_or_default();
        cargo.env("CFLAGS", format!("{own} {}", flags("-ffile-prefix-map").join(" ")));
        cargo.env("CARGO_TARGET_DIR", target);
        // in addition to the flags in .cargo/config.toml
        let rust = serde_json::json!(flags("--remap-path-prefix"));
        cargo.arg("--config").arg(format!("target.'cfg(all())'.rustflags={rust}"))
    }

    /// Fails if one of these paths is in a file, or in a file of a folder.
    pub fn check(&self, path: &Path) -> Outcome {
        let unreadable = |error: std::io::Error| format!("{}: {error}.", path.display());
        if path.is_dir() {
            let entries = fs::read_dir(path).map_err(unreadable)?;
            return entries.into_iter().try_for_each(|entry| self.check(&entry.map_err(unreadable)?.path()));
        }
        match self.first_in(&fs::read(path).map_err(unreadable)?) {
            Some(found) => Err(format!("{}: it contains {found:?}, a path of this machine.", path.display())),
            None => Ok(()),
        }
    }

    /// The first of these paths in the bytes of a file, with the text that follows it.
    fn first_in(&self, bytes: &[u8]) -> Option<String> {
        self.0.iter().find_map(|(path, _)| {
            let text = format!("{}{}", path.display(), std::path::MAIN_SEPARATOR);
            let at = bytes.windows(text.len()).position(|window| window == text.as_bytes())?;
            let end = bytes.len().min(at + text.len() + 40);
            Some(String::from_utf8_lossy(&bytes[at..end]).into_owned())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::python::remove_old;

    fn paths() -> LocalPaths {
        LocalPaths(vec![("/users/ann".into(), "/anon"), ("/users/ann/.cargo".into(), "/cargo")])
    }

    #[test]
    fn paths_in_files_are_found() {
        assert_eq!(paths().first_in(b"\x7fELF /anon/x /cargo/y.rs /users/anna/z.rs"), None);
        let found = paths().first_in(b"\x7fELF\0/users/ann/.cargo/registry/x.rs:1").unwrap();
        assert!(found.starts_with("/users/ann/.cargo/registry/x.rs"), "{found}");
        let folder = env::temp_dir().join(format!("xtask-dist-{}", std::process::id()));
        fs::create_dir_all(folder.join("inner")).unwrap();
        fs::write(folder.join("inner/good"), "/cargo/x.rs").unwrap();
        assert_eq!(paths().check(&folder), Ok(()));
        fs::write(folder.join("inner/bad"), "/users/ann/x.rs").unwrap();
        let message = paths().check(&folder).unwrap_err();
        assert!(
            message.contains("inner") && message.contains("bad: it contains \"/users/ann/x.rs\""),
            "{message}"
        );
        remove_old(&folder).unwrap();
    }

    #[test]
    fn builds_replace_paths() {
        let mut cargo = Command::new("cargo");
        paths().hide(&mut cargo, Path::new("/t"));
        let arguments: Vec<_> = cargo.get_args().map(|word| word.to_str().unwrap()).collect();
        let flags =
            "[\"--remap-path-prefix=/users/ann=/anon\",\"--remap-path-prefix=/users/ann/.cargo=/cargo\"]";
        assert_eq!(arguments, ["--config", &format!("target.'cfg(all())'.rustflags={flags}")]);
    }
}
