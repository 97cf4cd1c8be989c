//! Tests that cannot run here say so.

use std::io::Write;

/// Tells why a test, or a part of it, does not run: past the harness, which shows nothing of tests that pass. `cargo xtask test` counts
/// these lines.
pub fn tell(why: &str) {
    // the harness may have begun a line; where nobody listens there is nobody to tell
    let _ = writeln!(std::io::stdout(), "\nSKIPPED: {why}");
}
