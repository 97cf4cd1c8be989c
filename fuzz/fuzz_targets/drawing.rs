//! See `crates/rayweave/tests/fuzz/imported.rs`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/rayweave/tests/fuzz/imported.rs"]
#[allow(dead_code, reason = "each program is one of its targets")]
mod imported;
#[path = "../../crates/rayweave/tests/fuzz/model_file.rs"]
#[allow(dead_code, reason = "the target shares only the check of compiled models")]
mod model_file;

fuzz_target!(|data: &[u8]| imported::drawing(data));
