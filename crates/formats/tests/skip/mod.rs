//! Reports of skipped tests.

use std::io::Write;

/// Prints why a test, or a part of it, was skipped, bypassing the capture of the test harness. `cargo xtask test` counts
/// these lines.
pub fn tell(why: &str) {
    // the harness may have started a line; a closed output is ignored
    let _ = writeln!(std::io::stdout(), "\nSKIPPED: {why}");
}
