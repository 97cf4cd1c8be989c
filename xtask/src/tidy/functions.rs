//! The check of the lengths of functions.

use super::rust::is_test_file;
use super::violation::{Rule, Violation};
use crate::masked::{Masked, item_end};
use crate::repository::Source;

static FUNCTION_LENGTH: Rule = Rule { name: "function-length", why: "a function should fit on a screen" };

/// The maximum number of lines from `fn` to the closing brace.
const LONG_FUNCTION: usize = 80;

pub fn check(source: &Source) -> Vec<Violation> {
    if !source.is("rs") || !source.path.contains("src/") || is_test_file(&source.path) {
        return Vec::new();
    }
    let masked = Masked::new(&source.text);
    let starts =
        masked.library_code().filter_map(|(line, text)| function_name(text).map(|name| (line, name)));
    starts
        .map(|(line, name)| (line, name, item_end(&masked.code, line - 1) + 2 - line))
        .filter(|(_, _, length)| *length > LONG_FUNCTION)
        .map(|(line, name, length)| {
            let problem = format!("function {name} has {length} lines, the limit is {LONG_FUNCTION}");
            Violation::new(&FUNCTION_LENGTH, source, line, problem, "extract functions").about(name)
        })
        .collect()
}

/// The name of the function that begins on this line of code.
fn function_name(line: &str) -> Option<&str> {
    let before_is_word = |at: usize| line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
    let (at, _) = line.match_indices("fn ").find(|&(at, _)| !before_is_word(at))?;
    let name = line[at + 3..].trim_start();
    let end = name.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '$')).unwrap_or(name.len());
    (end > 0).then(|| &name[..end])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::found;

    fn with_body(lines: usize) -> String {
        format!(
            "//! A.\n\nimpl A {{\n    pub fn long(&self) {{\n{}    }}\n}}\n",
            "        f();\n".repeat(lines)
        )
    }

    #[test]
    fn long_functions_are_found() {
        assert_eq!(found("crates/a/src/b.rs", &with_body(78)), []);
        assert_eq!(found("crates/a/src/b.rs", &with_body(79)), [("function-length", 4)]);
    }

    #[test]
    fn tests_may_be_long() {
        assert_eq!(found("crates/a/tests/b.rs", &with_body(100)), []);
        let test = with_body(100).replace("impl A", "#[cfg(test)]\nmod tests");
        assert_eq!(found("crates/a/src/b.rs", &test), []);
    }

    #[test]
    fn names_are_read() {
        assert_eq!(function_name("    pub const fn solve<T>(x: T)"), Some("solve"));
        assert_eq!(function_name("fn $name() {"), Some("$name"));
        assert_eq!(function_name("let f: fn(f64) -> f64 = g;"), None);
        assert_eq!(function_name("often fn_like fnord"), None);
    }
}
