//! See `crates/rayweave/tests/fuzz/model_file.rs`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/rayweave/tests/fuzz/model_file.rs"]
mod model_file;

fuzz_target!(|data: &[u8]| model_file::run(data));
