//! Checks of the text of all files, beyond those of the compiler and the linter.

mod english;
mod functions;
mod links;
mod manifest;
mod messages;
mod models;
mod rust;
pub mod text;
mod type_names;
mod violation;

use crate::allow::{self, Exception};
use crate::outcome::Outcome;
use crate::repository::{Repository, Source};
use violation::{Severity, Violation};

/// The file of exceptions, relative to the root.
const EXCEPTIONS: &str = "xtask/tidy-exceptions.txt";

/// Checks all files and prints every violation.
pub fn run(repository: &Repository) -> Outcome {
    let files = repository.files()?;
    let mut violations = Vec::new();
    let mut phrasings = english::Phrasings::default();
    let mut type_names = type_names::TypeNames::default();
    for path in &files {
        if let Some(source) = repository.source(path)? {
            phrasings.add(&source);
            type_names.add(&source);
            violations.extend(check(&source, &|path| repository.root.join(path).exists()));
        }
    }
    violations.extend(type_names.violations());
    let exceptions = read_exceptions(repository)?;
    let mut violations = without_exceptions(violations, &exceptions)?;
    violations.sort_by(|a, b| (&a.path, a.line).cmp(&(&b.path, b.line)));
    for violation in &violations {
        println!("{violation}");
    }
    println!("tidy: {phrasings}");
    let problems = phrasings.problems();
    problems.iter().for_each(|problem| println!("{problem}"));
    let errors = violations.iter().filter(|violation| violation.severity == Severity::Error).count();
    match errors + problems.len() {
        0 => {
            println!("tidy: {} files checked", files.len());
            Ok(())
        }
        errors => {
            Err(format!("tidy: {errors} problems. List exceptions in {EXCEPTIONS}, each with its reason."))
        }
    }
}

/// All violations in one file. `exists` returns whether a path relative to the root exists.
fn check(source: &Source, exists: &dyn Fn(&str) -> bool) -> Vec<Violation> {
    let mut violations = text::check(source);
    violations.extend(rust::check(source));
    violations.extend(functions::check(source));
    violations.extend(english::check(source));
    violations.extend(manifest::check(source));
    violations.extend(messages::check(source));
    violations.extend(models::check(source, exists));
    violations.extend(links::check(source, exists));
    violations
}

fn read_exceptions(repository: &Repository) -> Result<Vec<Exception>, String> {
    let text = repository.source(EXCEPTIONS)?.map(|source| source.text).unwrap_or_default();
    allow::read(&text).map_err(|line| {
        format!("{EXCEPTIONS}:{line}: not an exception: a line is 'RULE PATH[::ITEM] -- REASON'.")
    })
}

/// Removes the violations that an exception covers; an exception that covers nothing is an error.
fn without_exceptions(
    violations: Vec<Violation>,
    exceptions: &[Exception],
) -> Result<Vec<Violation>, String> {
    let covers = |exception: &Exception, found: &Violation| {
        exception.covers(found.rule.name, &found.path, &found.item)
    };
    let idle = exceptions.iter().find(|exception| !violations.iter().any(|found| covers(exception, found)));
    if let Some(Exception { line, rule, place }) = idle {
        return Err(format!("{EXCEPTIONS}:{line}: '{rule} {place}' covers nothing. Remove the line."));
    }
    Ok(violations
        .into_iter()
        .filter(|found| !exceptions.iter().any(|exception| covers(exception, found)))
        .collect())
}

/// The rules and lines of the violations of a snippet, for the tests of the checks.
#[cfg(test)]
fn found(path: &str, text: &str) -> Vec<(&'static str, usize)> {
    let source = Source { path: path.to_owned(), text: text.to_owned() };
    check(&source, &|path| path.contains("here")).iter().map(|found| (found.rule.name, found.line)).collect()
}

#[cfg(test)]
mod tests {
    use super::violation::Rule;
    use super::*;

    static RULE: Rule = Rule { name: "example", why: "it is an example" };

    fn violation() -> Violation {
        let source = Source { path: "a/b.rs".to_owned(), text: String::new() };
        Violation::new(&RULE, &source, 7, "something is odd".to_owned(), "make it even").about("f")
    }

    #[test]
    fn a_violation_says_where_what_why_and_what_now() {
        assert_eq!(violation().to_string(), "a/b.rs:7: something is odd: it is an example. Make it even.");
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
