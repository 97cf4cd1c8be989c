//! The stage of the Python package: build, install, test, check the types and their stub.

use crate::outcome::Outcome;
use crate::process;
use crate::python::{BINDING, Python, remove_old};
use crate::report::Counts;
use crate::stub;
use crate::workshop::Workshop;

/// A file that uses the whole typed interface, relative to the root.
const TYPED_SAMPLE: &str = "bindings/python/tests/typed_sample.py";

/// The tests of the argument `device`, relative to the folder of the bindings.
const GPU_TESTS: &str = "tests/test_device.py";

/// Names that stubtest is allowed to find different; the file is optional.
const STUBTEST_ALLOWLIST: &str = "bindings/python/stubtest-allowlist.txt";

pub fn run(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    workshop.python.install_package()?;
    workshop.python.install(&[
        "pytest",
        "numpy",
        "mypy",
        "matplotlib",
        "pandas",
        "pyarrow",
        "polars",
        "xarray",
        "distributed",
    ])?;
    let outcomes = [
        tests(workshop, counts),
        types(workshop, counts),
        stubs(workshop, counts),
        one(stub::compare(workshop.repository), counts),
    ];
    let failures: Vec<String> = outcomes.into_iter().filter_map(Result::err).collect();
    if failures.is_empty() { Ok(()) } else { Err(failures.join("\n")) }
}

/// Tests the package with the feature for graphics cards, in an environment of its own: the other stages use the package without it.
pub fn gpu(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    if !super::cargo::has_driver(counts) {
        return Ok(());
    }
    let target = workshop.repository.target();
    let mut python = Python::named(workshop.repository, "gpu-venv", false);
    let folder = target.join("gpu-wheels");
    remove_old(&folder)?;
    let wheel = python.build_wheel(&folder, |maturin| {
        maturin.args(["--features", "gpu"]).env("CARGO_TARGET_DIR", target)
    })?;
    python.install(&["pytest", "numpy", &wheel.to_string_lossy()])?;
    let mut pytest = python.program("python")?;
    pytest.args(["-m", "pytest", "-q", "-p", "no:cacheprovider"]).arg(format!("{BINDING}/{GPU_TESTS}"));
    process::run_reading(pytest.env("PYTHONDONTWRITEBYTECODE", "1"), |line| counts.read_pytest_line(line))
}

fn tests(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    let mut python = workshop.python.program("python")?;
    python
        .args(["-m", "pytest", "-q", "--durations=10", "-p", "no:cacheprovider"])
        .arg(format!("{BINDING}/tests"));
    process::run_reading(python.env("PYTHONDONTWRITEBYTECODE", "1"), |line| counts.read_pytest_line(line))
}

fn types(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    if !workshop.repository.root.join(TYPED_SAMPLE).is_file() {
        return Err(format!("{TYPED_SAMPLE}: no such file: the types are checked on it."));
    }
    let cache = workshop.repository.target().join("mypy");
    let mut python = workshop.python.program("python")?;
    python.args(["-m", "mypy", "--strict", TYPED_SAMPLE, "--cache-dir"]).arg(cache);
    one(process::run(&mut python), counts)
}

fn stubs(workshop: &mut Workshop<'_>, counts: &mut Counts) -> Outcome {
    let mut python = workshop.python.program("python")?;
    python.args(["-m", "mypy.stubtest", "rayweave"]);
    let allowlist = workshop.repository.root.join(STUBTEST_ALLOWLIST);
    if allowlist.is_file() {
        python.arg("--allowlist").arg(allowlist);
    }
    // run away from the sources, so that the installed package is imported
    one(process::run(python.current_dir(workshop.repository.target())), counts)
}

/// Counts an outcome as one test.
fn one(outcome: Outcome, counts: &mut Counts) -> Outcome {
    if outcome.is_ok() {
        counts.passed += 1
    } else {
        counts.failed += 1
    }
    outcome
}
