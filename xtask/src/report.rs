//! Counts of tests and times of stages, and their table.

use std::fmt;
use std::iter::Sum;
use std::ops::AddAssign;
use std::time::Duration;

/// Numbers of tests by outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Tests that passed.
    pub passed: u64,
    /// Tests that failed.
    pub failed: u64,
    /// Tests that were not run: ignored, part of the long mode, or without their requirements.
    pub skipped: u64,
}

/// Result of one stage.
pub struct Report {
    /// The stage's name.
    pub name: &'static str,
    /// Its tests.
    pub counts: Counts,
    /// Duration.
    pub time: Duration,
    /// The reason of a failure.
    pub failure: Option<String>,
}

impl Counts {
    /// One test that passed.
    pub const ONE: Counts = Counts { passed: 1, failed: 0, skipped: 0 };

    /// Adds the counts of a line of `cargo test`, if it has any.
    pub fn read_cargo_line(&mut self, line: &str) {
        if let Some((_, numbers)) =
            line.trim_start().strip_prefix("test result: ").and_then(|rest| rest.split_once(". "))
        {
            self.passed += number_before(numbers, "passed");
            self.failed += number_before(numbers, "failed");
            self.skipped += number_before(numbers, "ignored");
        }
        // printed by tests that cannot run on this machine
        self.skipped += u64::from(line.starts_with("SKIPPED: "));
    }

    /// Adds the counts of the summary line of pytest, if this is it.
    pub fn read_pytest_line(&mut self, line: &str) {
        let is_closing = line.contains(" in ") && line.trim_end_matches([' ', '=']).ends_with(['s', ')']);
        if is_closing {
            let summary = line.split(" in ").next().unwrap_or_default();
            self.passed += number_before(summary, "passed") + number_before(summary, "xfailed");
            self.failed += ["failed", "error", "errors", "xpassed"]
                .iter()
                .map(|word| number_before(summary, word))
                .sum::<u64>();
            self.skipped += number_before(summary, "skipped") + number_before(summary, "deselected");
        }
    }
}

/// The number before this word, or zero.
fn number_before(text: &str, word: &str) -> u64 {
    let words: Vec<&str> = text.split([' ', ',', ';', '=']).filter(|word| !word.is_empty()).collect();
    let pair = words.windows(2).find(|pair| pair[1] == word);
    pair.and_then(|pair| pair[0].parse().ok()).unwrap_or(0)
}

impl fmt::Display for Counts {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }
}

impl Sum for Counts {
    fn sum<I: Iterator<Item = Counts>>(counts: I) -> Counts {
        counts.fold(Counts::default(), |mut sum, next| {
            sum += next;
            sum
        })
    }
}

impl Report {
    /// Creates a report; a stage that failed without a failed test counts as one failed test.
    pub fn new(name: &'static str, mut counts: Counts, time: Duration, failure: Option<String>) -> Report {
        if failure.is_some() && counts.failed == 0 {
            counts.failed = 1;
        }
        Report { name, counts, time, failure }
    }
}

/// The table of all stages.
pub fn table(reports: &[Report]) -> String {
    let mut table = format!(
        "{:<10} {:<6} {:>8} {:>7} {:>7} {:>8}\n",
        "stage", "", "seconds", "passed", "failed", "skipped"
    );
    for report in reports {
        let Counts { passed, failed, skipped } = report.counts;
        let verdict = if report.failure.is_some() { "FAILED" } else { "ok" };
        let seconds = report.time.as_secs_f64();
        table += &format!(
            "{:<10} {verdict:<6} {seconds:>8.1} {passed:>7} {failed:>7} {skipped:>8}\n",
            report.name
        );
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cargo_lines_are_counted() {
        let mut counts = Counts::default();
        counts.read_cargo_line("running 3 tests");
        counts.read_cargo_line(
            "test result: ok. 5 passed; 0 failed; 1 ignored; 0 measured; 2 filtered out; finished in 0.00s",
        );
        counts.read_cargo_line(
            "test result: FAILED. 1 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out",
        );
        counts.read_cargo_line("test says: 9 passed; 9 failed");
        counts.read_cargo_line("SKIPPED: the font is not there");
        assert_eq!(counts, Counts { passed: 6, failed: 2, skipped: 2 });
    }

    #[test]
    fn pytest_lines_are_counted() {
        let count = |line: &str| {
            let mut counts = Counts::default();
            counts.read_pytest_line(line);
            counts
        };
        assert_eq!(count("12 passed in 0.31s"), Counts { passed: 12, failed: 0, skipped: 0 });
        let mixed = "=== 1 failed, 11 passed, 2 skipped, 1 xfailed, 1 error in 63.10s (0:01:03) ===";
        assert_eq!(count(mixed), Counts { passed: 12, failed: 2, skipped: 2 });
        assert_eq!(count("no tests ran in 0.00s"), Counts::default());
        assert_eq!(count("FAILED tests/test_a.py - 3 failed"), Counts::default());
    }

    #[test]
    fn a_failure_without_failed_tests_counts_as_one() {
        let report = Report::new("fmt", Counts::default(), Duration::ZERO, Some("no".to_owned()));
        assert_eq!(report.counts, Counts { passed: 0, failed: 1, skipped: 0 });
        let report = Report::new(
            "rust",
            Counts { passed: 1, failed: 3, skipped: 0 },
            Duration::ZERO,
            Some("no".to_owned()),
        );
        assert_eq!(report.counts.failed, 3);
    }

    #[test]
    fn the_closing_line_is_plain() {
        let counts: Counts = [Counts::ONE, Counts { passed: 2, failed: 3, skipped: 4 }].into_iter().sum();
        assert_eq!(counts.to_string(), "3 passed, 3 failed, 4 skipped");
    }

    #[test]
    fn the_table_names_every_stage() {
        let time = Duration::from_millis(1250);
        let reports = [
            Report::new("fmt", Counts::ONE, time, None),
            Report::new("rust", Counts::default(), time, Some("no".to_owned())),
        ];
        let table = table(&reports);
        assert!(table.lines().nth(1).unwrap().starts_with("fmt        ok          1.2"), "{table}");
        assert!(table.lines().nth(2).unwrap().starts_with("rust       FAILED"), "{table}");
    }
}
