//! Checks of the text of all files: what the compiler and the linter do not see.

mod functions;
mod links;
mod manifest;
mod models;
mod rust;
pub mod text;

use std::fmt;

use crate::Outcome;
use crate::allow::{self, Exception};
use crate::repository::{Repository, Source};

/// The file of exceptions, from the root.
const EXCEPTIONS: &str = "xtask/tidy-exceptions.txt";

/// A rule: its name in the list of exceptions, and why it is there.
pub struct Rule {
    name: &'static str,
    why: &'static str,
}

/// One place where a rule is broken.
pub struct Violation {
    rule: &'static Rule,
    path: String,
    line: usize,
    /// The function or other item, where the rule is about one; else empty.
    item: String,
    problem: String,
    suggestion: String,
    severity: Severity,
}

/// Whether a violation fails the check.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Severity {
    Warning,
    Error,
}

impl Violation {
    /// An error at a line of a file, the first line being 1.
    fn new(
        rule: &'static Rule,
        source: &Source,
        line: usize,
        problem: String,
        suggestion: &str,
    ) -> Violation {
        let (path, item, suggestion) = (source.path.clone(), String::new(), suggestion.to_owned());
        Violation { rule, path, line, item, problem, suggestion, severity: Severity::Error }
    }

    /// The same about one item of the file.
    fn about(mut self, item: &str) -> Violation {
        item.clone_into(&mut self.item);
        self
    }

    /// The same, but only a warning.
    fn mild(mut self) -> Violation {
        self.severity = Severity::Warning;
        self
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Violation { rule, path, line, problem, suggestion, severity, .. } = self;
        let mild = if *severity == Severity::Warning { "warning: " } else { "" };
        write!(formatter, "{path}:{line}: {mild}{problem} ({}) {suggestion}", rule.why)
    }
}

/// Checks all files and prints every violation.
pub fn run(repository: &Repository) -> Outcome {
    let files = repository.files()?;
    let mut violations = Vec::new();
    for path in &files {
        if let Some(source) = repository.source(path)? {
            violations.extend(check(&source, &|path| repository.root.join(path).exists()));
        }
    }
    let exceptions = read_exceptions(repository)?;
    let mut violations = without_exceptions(violations, &exceptions)?;
    violations.sort_by(|a, b| (&a.path, a.line).cmp(&(&b.path, b.line)));
    for violation in &violations {
        println!("{violation}");
    }
    match violations.iter().filter(|violation| violation.severity == Severity::Error).count() {
        0 => {
            println!("tidy: {} files checked", files.len());
            Ok(())
        }
        errors => {
            Err(format!("tidy: {errors} problems (exceptions go into {EXCEPTIONS}, each with its reason)"))
        }
    }
}

/// All violations in one file. `exists` tells whether a path from the root is there.
fn check(source: &Source, exists: &dyn Fn(&str) -> bool) -> Vec<Violation> {
    let mut violations = text::check(source);
    violations.extend(rust::check(source));
    violations.extend(functions::check(source));
    violations.extend(manifest::check(source));
    violations.extend(models::check(source, exists));
    violations.extend(links::check(source, exists));
    violations
}

fn read_exceptions(repository: &Repository) -> Result<Vec<Exception>, String> {
    let text = repository.source(EXCEPTIONS)?.map(|source| source.text).unwrap_or_default();
    allow::read(&text).map_err(|line| {
        format!("{EXCEPTIONS}:{line}: no exception (a line is 'RULE PATH[::ITEM] -- REASON')")
    })
}

/// Leaves out what an exception covers; an exception that covers nothing is an error.
fn without_exceptions(
    violations: Vec<Violation>,
    exceptions: &[Exception],
) -> Result<Vec<Violation>, String> {
    let covers = |exception: &Exception, found: &Violation| {
        exception.covers(found.rule.name, &found.path, &found.item)
    };
    let idle = exceptions.iter().find(|exception| !violations.iter().any(|found| covers(exception, found)));
    if let Some(Exception { line, rule, place }) = idle {
        return Err(format!(
            "{EXCEPTIONS}:{line}: '{rule} {place}' covers nothing (any more) remove the line"
        ));
    }
    Ok(violations
        .into_iter()
        .filter(|found| !exceptions.iter().any(|exception| covers(exception, found)))
        .collect())
}

/// The rules and lines of the violations of a snippet: what every check's tests compare.
#[cfg(test)]
fn found(path: &str, text: &str) -> Vec<(&'static str, usize)> {
    let source = Source { path: path.to_owned(), text: text.to_owned() };
    check(&source, &|path| path.contains("here")).iter().map(|found| (found.rule.name, found.line)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    static RULE: Rule = Rule { name: "example", why: "it is an example" };

    fn violation() -> Violation {
        let source = Source { path: "a/b.rs".to_owned(), text: String::new() };
        Violation::new(&RULE, &source, 7, "something is odd".to_owned(), "make it even").about("f")
    }

    #[test]
    fn a_violation_says_where_what_why_and_what_now() {
        assert_eq!(violation().to_string(), "a/b.rs:7: something is odd (it is an example) make it even");
        assert!(violation().mild().to_string().starts_with("a/b.rs:7: warning: something"));
    }

    #[test]
    fn exceptions_cover_and_idle_ones_are_found() {
        let covered = allow::read("example a/b.rs::f -- because").unwrap();
        assert_eq!(without_exceptions(vec![violation()], &covered).unwrap().len(), 0);
        let idle = allow::read("example a/b.rs::g -- because").unwrap();
        let message = without_exceptions(vec![violation()], &idle).err().unwrap();
        assert!(message.contains("'example a/b.rs::g' covers nothing"), "{message}");
    }

    #[test]
    fn a_clean_file_passes() {
        assert_eq!(found("crates/a/src/lib.rs", "//! A crate.\n\nfn f() {}\n"), []);
    }
}
