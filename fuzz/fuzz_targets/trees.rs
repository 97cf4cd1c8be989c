//! See `crates/rayweave/tests/fuzz/trees.rs`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/rayweave/tests/fuzz/bytes.rs"]
mod bytes;
#[path = "../../crates/rayweave/tests/fuzz/trees.rs"]
mod trees;

fuzz_target!(|data: &[u8]| trees::run(data));
