//! The check of the files of a release, each as its user: in an empty folder, with an empty home, without Rust.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::release::{Dist, FAST_BUILD, files, make};
use crate::outcome::Outcome;
use crate::process;
use crate::python::{MATURIN, Python, remove_old, scripts};

/// The packages that the examples of the README use.
const PACKAGES: [&str; 3] = ["matplotlib", "pandas", "pyarrow"];

/// Checks the files in `dist/` that run on this machine, and names those that do not.
pub fn run(dist: &mut Dist<'_>) -> Outcome {
    let (folder, sums, for_python) = (dist.folder.clone(), dist.checksums(), dist.for_python());
    process::run(dist.script("archive.py")?.arg("verify").args([&folder, &sums]))?;
    let mut checked = Vec::new();
    if dist.has("command") {
        for archive in [files(&folder, ".tar.gz")?, files(&folder, ".zip")?].concat() {
            checked.push(command(dist, &archive)?);
        }
    }
    if dist.has("wheel") {
        for path in files(&for_python, ".whl")? {
            checked.push(wheel(dist, &path)?);
        }
    }
    let sources = for_python.join(format!("rayweave-{}.tar.gz", dist.version));
    if dist.has("sdist") && sources.is_file() {
        checked.push(sdist(dist, &sources)?);
    }
    checked.iter().for_each(|line| println!("checked: {line}"));
    match checked.is_empty() && dist.parts != ["sbom"] {
        false => Ok(()),
        true => Err(format!("{}: nothing to check. Run cargo xtask dist first.", folder.display())),
    }
}

/// Unpacks the command and runs the commands of the README.
fn command(dist: &mut Dist<'_>, archive: &Path) -> Result<String, String> {
    let title = title(archive);
    let Some(runner) = runner(&title) else {
        return Ok(format!("{title}: only built, it does not run here"));
    };
    let scratch = empty(dist, "check-command")?;
    process::run(dist.script("archive.py")?.arg("unpack").args([archive, &scratch]))?;
    let name = title.trim_end_matches(".tar.gz").trim_end_matches(".zip");
    let program = scratch.join(name).join(format!("rayweave{}", env::consts::EXE_SUFFIX));
    let mut readme = dist.script("readme.py")?;
    readme.arg("command").arg(&dist.repository.root).args(runner).arg(&program);
    process::run(clean(&mut readme, &empty(dist, "check-home")?).current_dir(empty(dist, "check-run")?))?;
    Ok(format!("{title}: runs the commands of the README"))
}

/// Installs a wheel and runs the Python of the README.
fn wheel(dist: &mut Dist<'_>, path: &Path) -> Result<String, String> {
    let title = title(path);
    if title.contains("linux") {
        dist.python.install(&["auditwheel"])?;
        let report = process::output(dist.python.program("auditwheel")?.arg("show").arg(path))?;
        println!("{report}");
        if !report.contains("manylinux_2_17_") {
            return Err(format!("{title}: it needs a newer Linux than manylinux_2_17."));
        }
    }
    if runner(&title).is_none_or(|runner| !runner.is_empty()) {
        return Ok(format!("{title}: only built, it does not run here"));
    }
    let mut python = fresh(dist)?;
    let path = path.to_string_lossy();
    let mut pip = python.program("python")?;
    pip.args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--only-binary",
        ":all:",
        &path,
    ]);
    process::run(without_rust(pip.args(PACKAGES), &empty(dist, "check-path")?))?;
    run_readme(dist, &mut python)?;
    Ok(format!("{title}: installs without Rust, and runs the Python of the README"))
}

/// Builds the Python package from its sources, without a network where the system can cut it off, and runs the Python of the README.
fn sdist(dist: &mut Dist<'_>, archive: &Path) -> Result<String, String> {
    let mut python = fresh(dist)?;
    python.install(&[MATURIN, "numpy"])?;
    python.install(&PACKAGES)?;
    let scratch = empty(dist, "check-sdist")?;
    process::run(dist.script("archive.py")?.arg("unpack").args([archive, &scratch]))?;
    let sources = scratch.join(format!("rayweave-{}", dist.version));
    let sysroot = process::output(Command::new("rustc").args(["--print", "sysroot"]))?;
    let mut pip = python.program("python")?;
    pip.args(["-m", "pip", "install", "--no-index", "--no-build-isolation", "--no-deps", "--verbose"])
        // the wheel of a build without optimisation must not be found by anybody else
        .arg("--no-cache-dir")
        .arg(&sources);
    let cut_off = process::output(Command::new("unshare").args(["--net", "true"])).is_ok();
    let mut pip = if cut_off { inside("unshare", &["--net"], &pip) } else { pip };
    // the folder of the environment's programs holds maturin
    let folders = [scripts(&dist.work.join("check-venv")), Path::new(sysroot.trim()).join("bin")];
    let system = env::var_os("PATH").unwrap_or_default();
    let path = env::join_paths(folders.into_iter().chain(env::split_paths(&system)));
    pip.env("PATH", path.map_err(|error| error.to_string())?);
    pip.env("CARGO_HOME", empty(dist, "check-cargo-home")?).env("CARGO_NET_OFFLINE", "true");
    pip.env("CARGO_TARGET_DIR", dist.work.join("check-target")).envs(FAST_BUILD);
    pip.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS").current_dir(&scratch);
    process::run(&mut pip)?;
    run_readme(dist, &mut python)?;
    let network =
        if cut_off { "without a network" } else { "with an empty CARGO_HOME and CARGO_NET_OFFLINE" };
    Ok(format!("{}: builds {network}, and runs the Python of the README", title(archive)))
}

/// Runs the Python of the README in an environment.
fn run_readme(dist: &Dist<'_>, python: &mut Python) -> Outcome {
    let mut readme = python.program("python")?;
    readme
        .arg(dist.repository.root.join("xtask/src/dist/readme.py"))
        .arg("python")
        .arg(&dist.repository.root);
    clean(&mut readme, &empty(dist, "check-home")?).env("MPLBACKEND", "Agg");
    process::run(readme.current_dir(empty(dist, "check-run")?))
}

/// A new environment.
fn fresh(dist: &Dist<'_>) -> Result<Python, String> {
    remove_old(&dist.work.join("check-venv"))?;
    Ok(Python::named(dist.repository, "dist/check-venv", false))
}

/// Removes all variables and programs of the user.
fn clean<'a>(command: &'a mut Command, home: &Path) -> &'a mut Command {
    command.env_clear().env("HOME", home).env("PATH", home).env("PYTHONDONTWRITEBYTECODE", "1");
    // Windows programs start only with the first, and write temporary files with the second
    let kept = ["SYSTEMROOT", "TEMP"].into_iter().filter_map(|name| Some((name, env::var_os(name)?)));
    command.envs(kept)
}

/// Removes all programs of the user, Rust among them, but not the settings of pip.
fn without_rust<'a>(command: &'a mut Command, path: &Path) -> &'a mut Command {
    for (name, _) in env::vars_os() {
        let text = name.to_string_lossy().into_owned();
        if text.starts_with("CARGO") || text.starts_with("RUST") {
            command.env_remove(&name);
        }
    }
    command.env("PATH", path)
}

/// The same call as an argument of another program.
fn inside(program: &str, options: &[&str], command: &Command) -> Command {
    let mut outer = Command::new(program);
    outer.args(options).arg(command.get_program()).args(command.get_args());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => outer.env(name, value),
            None => outer.env_remove(name),
        };
    }
    if let Some(folder) = command.get_current_dir() {
        outer.current_dir(folder);
    }
    outer
}

/// What precedes the program of a file for another machine: nothing if it is for this one, an emulator if there is one.
fn runner(name: &str) -> Option<Vec<PathBuf>> {
    let system = match env::consts::OS {
        "macos" => name.contains("darwin") || name.contains("macos"),
        "windows" => name.contains("windows") || name.contains("-win"),
        other => name.contains(other),
    };
    let is_arm = name.contains("aarch64") || name.contains("arm64");
    match (system, is_arm == (env::consts::ARCH == "aarch64"), is_arm) {
        (false, ..) => None,
        (true, true, _) => Some(Vec::new()),
        (true, false, true) => process::on_path("qemu-aarch64-static").map(|emulator| vec![emulator]),
        (true, false, false) => process::on_path("qemu-x86_64-static").map(|emulator| vec![emulator]),
    }
}

/// An empty folder among the intermediate files.
fn empty(dist: &Dist<'_>, name: &str) -> Result<PathBuf, String> {
    let folder = dist.work.join(name);
    remove_old(&folder)?;
    make(&folder)?;
    fs::canonicalize(&folder).map_err(|error| format!("{}: {error}.", folder.display()))
}

fn title(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_of_the_user_are_removed() {
        let mut command = Command::new("anything");
        clean(command.env("RUSTFLAGS", "-g"), Path::new("/empty"));
        let names: Vec<_> = command.get_envs().map(|(name, _)| name.to_str().unwrap()).collect();
        assert!(names.contains(&"HOME") && !names.contains(&"RUSTFLAGS"), "{names:?}");
        let path = command.get_envs().find(|(name, _)| *name == "PATH").unwrap().1;
        assert_eq!(path, Some("/empty".as_ref()));
    }

    #[test]
    fn calls_move_into_another_program() {
        let mut command = Command::new("pip");
        command.args(["install", "x"]).env("A", "1").env_remove("B").current_dir("below");
        let outer = inside("unshare", &["--net"], &command);
        assert_eq!(outer.get_program(), "unshare");
        assert_eq!(outer.get_args().collect::<Vec<_>>(), ["--net", "pip", "install", "x"]);
        let expected = [("A".as_ref(), Some("1".as_ref())), ("B".as_ref(), None)];
        assert_eq!(outer.get_envs().collect::<Vec<_>>(), expected);
        assert_eq!(outer.get_current_dir(), Some(Path::new("below")));
    }

    #[test]
    #[cfg(all(target_os = "linux", target_arch = "x86_64"))]
    fn files_for_this_machine_run() {
        let none = Some(Vec::new());
        assert_eq!(runner("rayweave-1.0.0-cp311-abi3-manylinux_2_17_x86_64.manylinux2014_x86_64.whl"), none);
        assert_eq!(runner("rayweave-1.0.0-x86_64-unknown-linux-musl.tar.gz"), none);
        assert_ne!(runner("rayweave-1.0.0-aarch64-unknown-linux-musl.tar.gz"), none);
        assert_eq!(runner("rayweave-1.0.0-x86_64-pc-windows-msvc.zip"), None);
        assert_eq!(runner("rayweave-1.0.0-cp311-abi3-macosx_11_0_x86_64.whl"), None);
    }
}
