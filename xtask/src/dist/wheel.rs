//! The wheels: one per processor, for Python 3.11 and everything newer.

use std::env;

use super::release::{Dist, copy};
use crate::outcome::Outcome;
use crate::process;
use crate::python::{MATURIN, remove_old};

/// The oldest Linux systems that the wheels run on: glibc 2.17 (PEP 599), the oldest that Rust supports.
const COMPATIBILITY: &str = "manylinux2014";

/// The targets of this system: on Linux, both processors, the own one first.
pub fn targets() -> Vec<String> {
    let arch = env::consts::ARCH;
    let other = if arch == "x86_64" { "aarch64" } else { "x86_64" };
    match env::consts::OS {
        "linux" => vec![format!("{arch}-unknown-linux-gnu"), format!("{other}-unknown-linux-gnu")],
        "macos" => vec!["aarch64-apple-darwin".to_owned(), "x86_64-apple-darwin".to_owned()],
        _ => vec![format!("{arch}-pc-windows-msvc")],
    }
}

pub fn build(dist: &mut Dist<'_>, target: &str) -> Outcome {
    dist.need_target(target)?;
    dist.python.install(if target.contains("linux") { &[MATURIN, "ziglang"] } else { &[MATURIN] })?;
    let folder = dist.work.join("wheel").join(target);
    remove_old(&folder)?;
    let mut python = dist.python.clone();
    let wheel = python.build_wheel(&folder, |maturin| {
        maturin.args(["--locked", "--target", target]);
        if target.contains("linux") {
            maturin.args(["--zig", "--compatibility", COMPATIBILITY]);
        }
        dist.configure(maturin)
    })?;
    let unpacked = folder.join("unpacked");
    process::run(dist.script("archive.py")?.arg("unpack").args([&wheel, &unpacked]))?;
    dist.local.check(&unpacked)?;
    let name = wheel.file_name().ok_or("a wheel without a name.")?;
    copy(&wheel, &dist.for_python().join(name))
}
