//! See `crates/rayweave/tests/fuzz/photons.rs`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/rayweave/tests/fuzz/photons.rs"]
mod photons;

fuzz_target!(|data: &[u8]| photons::run(data));
