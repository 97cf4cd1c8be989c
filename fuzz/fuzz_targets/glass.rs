//! See `crates/rayweave/tests/fuzz/glass.rs`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/rayweave/tests/fuzz/glass.rs"]
mod glass;

fuzz_target!(|data: &[u8]| glass::run(data));
