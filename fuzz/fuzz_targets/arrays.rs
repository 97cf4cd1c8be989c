//! See `crates/rayweave/tests/fuzz/arrays.rs`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/rayweave/tests/fuzz/arrays.rs"]
mod arrays;
#[path = "../../crates/rayweave/tests/fuzz/bytes.rs"]
mod bytes;

fuzz_target!(|data: &[u8]| arrays::run(data));
