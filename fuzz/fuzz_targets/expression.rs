//! See `crates/rayweave/tests/fuzz/expression.rs`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/rayweave/tests/fuzz/expression.rs"]
mod expression;

fuzz_target!(|data: &[u8]| expression::run(data));
