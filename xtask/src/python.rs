//! Python for the tests: an interpreter, a fresh virtual environment, and the package built and
//! installed in it.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::process;
use crate::profile::Profile;
use crate::repository::Repository;

/// The folder of the bindings, relative to the root.
pub const BINDING: &str = "bindings/python";

/// The program that builds the package, as a requirement of pip.
pub const MATURIN: &str = "maturin>=1.16,<2";

/// Names of interpreters on the PATH, in the order in which they are tried.
const INTERPRETERS: [&str; 6] = ["python3", "python3.14", "python3.13", "python3.12", "python3.11", "python"];

/// Script that checks an interpreter: its version, and whether it can create a virtual environment.
const PROBE: &str = "import sys\nif sys.version_info < (3, 11): sys.exit('old')\nimport ensurepip, venv\n";

/// A virtual environment that is created at the first use in a run, and replaced in the next run.
#[derive(Clone)]
pub struct Python {
    root: PathBuf,
    target: PathBuf,
    /// The name of the folder of the environment.
    name: &'static str,
    /// Cargo's profile for the package.
    profile: Profile,
    environment: Option<Result<PathBuf, String>>,
    package: Option<Result<(), String>>,
}

impl Python {
    /// Creates the handle; the environment is created at the first use.
    pub fn new(repository: &Repository, profile: Profile) -> Python {
        Python {
            root: repository.root.clone(),
            target: repository.target(),
            name: "venv",
            profile,
            environment: None,
            package: None,
        }
    }

    /// The handle of an environment of another name, which the tests do not use, with a package built for release. With `keep`, an existing environment stays,
    /// with the package that is installed in it.
    pub fn named(repository: &Repository, name: &'static str, keep: bool) -> Python {
        let mut python = Python { name, ..Python::new(repository, Profile::Release) };
        let folder = python.target.join(name);
        if keep && folder.is_dir() {
            python.environment = Some(Ok(folder));
            python.package = Some(Ok(()));
        }
        python
    }

    /// A program of the environment, such as `python` or `maturin`.
    pub fn program(&mut self, name: &str) -> Result<Command, String> {
        let folder = self.environment()?;
        let programs = scripts(&folder);
        let mut command = Command::new(programs.join(name));
        // the programs that this one calls are those of the environment, too, such as the linker zig
        let path = env::var_os("PATH").unwrap_or_default();
        let path = env::join_paths(std::iter::once(programs).chain(env::split_paths(&path)));
        command.env("PATH", path.map_err(|error| format!("PATH: {error}."))?);
        command.current_dir(&self.root).env("VIRTUAL_ENV", &folder);
        // environment variables of the user's Python must not affect the tests
        command.env_remove("PYTHONPATH").env_remove("PYTHONHOME").env_remove("CONDA_PREFIX");
        Ok(command)
    }

    /// Installs packages into the environment.
    pub fn install(&mut self, packages: &[&str]) -> Result<(), String> {
        let mut pip = self.program("python")?;
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(packages);
        process::run(&mut pip)
    }

    /// The folder of the environment; the first call creates it.
    fn environment(&mut self) -> Result<PathBuf, String> {
        if self.environment.is_none() {
            self.environment = Some(make_environment(&self.target.join(self.name)));
        }
        self.environment.clone().unwrap_or_else(|| Err("no environment".to_owned()))
    }

    /// Builds and installs the wheel, once per run.
    pub fn install_package(&mut self) -> Result<(), String> {
        if self.package.is_none() {
            let outcome = self.build_and_install();
            self.package = Some(outcome);
        }
        self.package.clone().unwrap_or(Ok(()))
    }

    fn build_and_install(&mut self) -> Result<(), String> {
        let (wheels, target) = (self.target.join("wheels"), self.target.clone());
        remove_old(&wheels)?;
        let wheel = self.build_wheel(&wheels, |maturin| maturin.env("CARGO_TARGET_DIR", target))?;
        self.install(&[&wheel.to_string_lossy()])
    }

    /// Builds the wheel into a folder without other wheels; `configure` completes the call of maturin.
    pub fn build_wheel(
        &mut self,
        folder: &Path,
        configure: impl FnOnce(&mut Command) -> &mut Command,
    ) -> Result<PathBuf, String> {
        let project = self.root.join(BINDING).join("pyproject.toml");
        if !project.is_file() {
            return Err(format!("{BINDING}/pyproject.toml: no such file: the package is built from it."));
        }
        self.install(&[MATURIN])?;
        let interpreter = scripts(&self.environment()?).join("python");
        let mut maturin = self.program("maturin")?;
        maturin.current_dir(self.root.join(BINDING));
        maturin.args(["build", "--profile", self.profile.name(), "--interpreter"]).arg(interpreter);
        maturin.arg("--out").arg(folder);
        process::run(configure(&mut maturin))?;
        the_wheel(folder)
    }
}

/// The folder of the programs of a virtual environment.
pub fn scripts(environment: &Path) -> PathBuf {
    environment.join(if cfg!(windows) { "Scripts" } else { "bin" })
}

/// The first interpreter that is new enough and can create virtual environments.
fn interpreter(
    candidates: impl Iterator<Item = PathBuf>,
    probe: impl Fn(&Path) -> Result<String, String>,
) -> Result<PathBuf, String> {
    let mut without_venv = None;
    for path in candidates {
        match probe(&path) {
            Ok(_) => return Ok(path),
            Err(message) if message.contains("ModuleNotFoundError") => {
                without_venv.get_or_insert(path);
            }
            Err(_) => {}
        }
    }
    Err(match without_venv {
        Some(path) => format!(
            "{}: makes no virtual environments (Debian keeps venv in a package of its own) \
             apt-get install python3-venv",
            path.display()
        ),
        None => "no Python on the PATH: 3.11 or newer is needed. Run apt-get install python3 python3-venv"
            .to_owned(),
    })
}

fn make_environment(folder: &Path) -> Result<PathBuf, String> {
    let candidates = INTERPRETERS.iter().filter_map(|name| process::on_path(name));
    let probe = |path: &Path| process::output(Command::new(path).args(["-c", PROBE]));
    let interpreter = interpreter(candidates, probe)?;
    remove_old(folder)?;
    process::run(Command::new(interpreter).args(["-m", "venv"]).arg(folder))?;
    Ok(folder.to_owned())
}

/// Removes a folder of an earlier run.
pub fn remove_old(folder: &Path) -> Result<(), String> {
    match fs::remove_dir_all(folder) {
        Err(error) if folder.exists() => Err(format!("{}: cannot be removed: {error}.", folder.display())),
        _ => Ok(()),
    }
}

/// The only wheel in the folder.
fn the_wheel(folder: &Path) -> Result<PathBuf, String> {
    let entries =
        fs::read_dir(folder).map_err(|error| format!("{}: cannot be read: {error}.", folder.display()))?;
    let mut wheels: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "whl"))
        .collect();
    match (wheels.pop(), wheels.is_empty()) {
        (Some(wheel), true) => Ok(wheel),
        _ => Err(format!("{}: not exactly one wheel", folder.display())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exactly_one_wheel_is_wanted() {
        let folder = std::env::temp_dir().join(format!("xtask-wheels-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        assert!(the_wheel(&folder).unwrap_err().ends_with("not exactly one wheel"));
        fs::write(folder.join("a.whl"), "").unwrap();
        fs::write(folder.join("notes.txt"), "").unwrap();
        assert_eq!(the_wheel(&folder).unwrap(), folder.join("a.whl"));
        fs::write(folder.join("b.whl"), "").unwrap();
        assert!(the_wheel(&folder).is_err());
        remove_old(&folder).unwrap();
        assert!(the_wheel(&folder).unwrap_err().contains("cannot be read"));
        remove_old(&folder).unwrap();
    }

    #[test]
    fn an_interpreter_is_chosen_or_the_missing_package_named() {
        let probe = |path: &Path| match path.to_str() {
            Some("good") => Ok(String::new()),
            Some("bare") => Err("ModuleNotFoundError: No module named 'ensurepip'".to_owned()),
            _ => Err("old".to_owned()),
        };
        let choose = |names: &[&str]| interpreter(names.iter().map(PathBuf::from), probe);
        assert_eq!(choose(&["old", "bare", "good"]).unwrap(), Path::new("good"));
        assert!(choose(&["old", "bare"]).unwrap_err().ends_with("apt-get install python3-venv"));
        assert!(choose(&["old"]).unwrap_err().ends_with("apt-get install python3 python3-venv"));
    }
}
