//! Reports of skipped tests.

use std::io::Write;

/// Prints why a test, or a part of it, is skipped, bypassing the capture of the test harness. `cargo xtask test` counts these lines.
pub fn skipped(why: impl std::fmt::Display) {
    // the harness may have started a line; a closed output is ignored
    let _ = writeln!(std::io::stdout(), "\nSKIPPED: {why}");
}
