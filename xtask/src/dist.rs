//! `cargo xtask dist`: the release builds of the command and of the Python package in `dist/`, without paths of this machine, and
//! their checksums.
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
use crate::python::{Python, remove_old};
use crate::repository::Repository;

/// Folders of this machine, with the paths that replace them. If several contain a path, the last one applies.
#[derive(Debug, PartialEq)]
struct LocalPaths(Vec<(PathBuf, &'static str)>);

/// Script that writes the SHA-256 of all files in a folder, in the form of `sha256sum`.
const CHECKSUMS: &str = "\
import hashlib, pathlib, sys
folder = pathlib.Path(sys.argv[1])
digest = lambda path: hashlib.sha256(path.read_bytes()).hexdigest()
lines = [f'{digest(path)}  {path.name}\\n' for path in sorted(folder.iterdir())]
(folder / 'SHA256SUMS').write_text(''.join(lines))
";

/// Builds and checks everything.
pub fn run(repository: &Repository) -> Outcome {
    let (folder, target) = (repository.root.join("dist"), repository.target().join("dist"));
    let local = LocalPaths::find(repository, &target)?;
    remove_old(&folder)?;
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}.", folder.display()))?;

    let mut cargo = Command::new("cargo");
    cargo.current_dir(&repository.root).args(["build", "--release", "--locked", "--package", "rayweave-cli"]);
    process::run(local.hide(&mut cargo, &target))?;
    let name = format!("rayweave{}", env::consts::EXE_SUFFIX);
    let command = folder.join(&name);
    fs::copy(target.join("release").join(&name), &command)
        .map_err(|error| format!("{}: {error}.", command.display()))?;

    let mut python = Python::new(repository);
    let wheel = python.build_wheel(&folder, |maturin| local.hide(maturin.arg("--locked"), &target))?;
    let unpacked = target.join("wheel");
    remove_old(&unpacked)?;
    process::run(python.program("python")?.args(["-m", "zipfile", "-e"]).args([&wheel, &unpacked]))?;

    local.check(&command)?;
    local.check(&unpacked)?;
    process::run(python.program("python")?.args(["-c", CHECKSUMS]).arg(&folder))?;
    println!("{}: the command, the wheel and SHA256SUMS", folder.display());
    Ok(())
}

impl LocalPaths {
    fn find(repository: &Repository, target: &Path) -> Result<LocalPaths, String> {
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
    fn hide<'a>(&self, cargo: &'a mut Command, target: &Path) -> &'a mut Command {
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
    fn check(&self, path: &Path) -> Outcome {
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
