//! The slowest test programs of a run, read from the output of `cargo test`.

use std::fmt;

/// The number of test programs in the list.
const LISTED: usize = 10;

/// Test programs with the seconds that their tests took.
#[derive(Debug, Default)]
pub struct Slowest {
    current: String,
    programs: Vec<(String, f64)>,
}

impl Slowest {
    /// Reads a line: the name of a test program, or the summary of its tests.
    pub fn read_cargo_line(&mut self, line: &str) {
        let line = line.trim_start();
        if let Some(program) = line.strip_prefix("Running ").and_then(|rest| rest.split_once(" (")) {
            self.current = format!("{} of {}", program.0, package(program.1));
        } else if let Some(name) = line.strip_prefix("Doc-tests ") {
            self.current = format!("documentation tests of {name}");
        } else if let Some(seconds) = line.strip_prefix("test result: ").and_then(seconds) {
            self.programs.push((self.current.clone(), seconds));
        }
    }

    /// True if there is no test program.
    pub fn is_empty(&self) -> bool {
        self.programs.is_empty()
    }
}

/// The stem of a test program's file without its hash: `target/debug/deps/rayweave_math-0123)` is `rayweave_math`.
fn package(path: &str) -> &str {
    let file = path.trim_end_matches(')').rsplit('/').next().unwrap_or_default();
    file.rsplit_once('-').map_or(file, |(name, _)| name)
}

/// The number in `...; finished in 1.25s`.
fn seconds(summary: &str) -> Option<f64> {
    summary.rsplit_once("finished in ")?.1.trim_end().strip_suffix('s')?.parse().ok()
}

impl fmt::Display for Slowest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut programs: Vec<&(String, f64)> = self.programs.iter().collect();
        programs.sort_by(|a, b| b.1.total_cmp(&a.1));
        writeln!(f, "slowest test programs:")?;
        programs.iter().take(LISTED).try_for_each(|(name, seconds)| writeln!(f, "{seconds:>8.1} s  {name}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_sorted_by_time() {
        let mut slowest = Slowest::default();
        assert!(slowest.is_empty());
        for line in [
            "     Running unittests src/lib.rs (target/debug/deps/rayweave_math-0a1b)",
            "test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.25s",
            "     Running tests/exact.rs (target/debug/deps/exact-77)",
            "test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 12.50s",
            "   Doc-tests rayweave_math",
            "test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 1.00s",
        ] {
            slowest.read_cargo_line(line);
        }
        let expected = "slowest test programs:\n    12.5 s  tests/exact.rs of exact\n     \
                        1.0 s  documentation tests of rayweave_math\n     0.2 s  unittests src/lib.rs of rayweave_math\n";
        assert_eq!(slowest.to_string(), expected);
    }
}
