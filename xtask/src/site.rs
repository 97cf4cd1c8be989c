//! `cargo xtask docs`: the documentation site, built from `docs/` by Sphinx.

use lexopt::prelude::*;

use crate::outcome::{Outcome, usage};
use crate::process;
use crate::python::{Python, remove_old};
use crate::repository::Repository;

/// The packages that build the site, and those that its examples use.
const PACKAGES: [&str; 10] = [
    "sphinx>=8,<10",
    "myst-parser>=4,<6",
    "pydata-sphinx-theme>=0.16,<1",
    "sphinx-gallery>=0.18,<1",
    "sphinx-design>=0.6,<1",
    "linkify-it-py>=2,<3",
    "numpy",
    "matplotlib",
    "pandas",
    "pyarrow",
];

/// Builds the site. With `--keep`, the environment of the last run is used again, with the package that is installed in it.
pub fn run(repository: &Repository, mut arguments: lexopt::Parser) -> Outcome {
    let mut keep = false;
    while let Some(argument) = arguments.next().map_err(|error| usage(&error.to_string()))? {
        match argument {
            Long("keep") => keep = true,
            other => return Err(usage(&other.unexpected().to_string())),
        }
    }
    let mut python = Python::named(repository, "docs-venv", keep);
    python.install(&PACKAGES)?;
    python.install_package()?;
    build(repository, &mut python)
}

/// Runs Sphinx, which executes the examples of the gallery, and checks the links within the site. Warnings are errors.
fn build(repository: &Repository, python: &mut Python) -> Outcome {
    let (source, site) = (repository.root.join("docs"), repository.target().join("site"));
    remove_old(&site)?;
    let mut sphinx = python.program("python")?;
    sphinx.args(["-m", "sphinx", "-b", "html", "-W", "--keep-going", "--quiet", "-d"]);
    sphinx.arg(repository.target().join("site-doctrees")).args([&source, &site]);
    process::run(&mut sphinx)?;
    process::run(python.program("python")?.arg(source.join("check_links.py")).arg(&site))?;
    println!("{}", site.join("index.html").display());
    Ok(())
}
