//! Checks of Rust files: module documentation, length, and forbidden calls.

use super::text::has_word;
use super::violation::{Rule, Violation};
use crate::masked::Masked;
use crate::repository::Source;

static MODULE_DOCS: Rule = Rule { name: "module-docs", why: "every file states its contents" };
static FILE_LENGTH: Rule = Rule { name: "file-length", why: "one file, one noun" };
static UNFINISHED: Rule = Rule { name: "unfinished", why: "the repository contains finished work only" };
static MUL_ADD: Rule = Rule { name: "mul-add", why: "its rounding differs between processors" };
static TRANSCENDENTAL: Rule =
    Rule { name: "transcendental", why: "the standard library's bits differ between platforms" };
static CAPTURED: Rule = Rule {
    name: "captured",
    why: "the test harness captures the line, and a skipped test looks like one that passed",
};
static UNSAFE: Rule = Rule { name: "unsafe", why: "nothing here needs it" };

/// The maximum number of lines of a file, and the number above which there is a warning.
const LONG_FILE: usize = 1000;
const LONGISH_FILE: usize = 700;

/// Methods of f64 and f32 whose last bits depend on the platform's mathematical library.
const TRANSCENDENTAL_METHODS: [&str; 25] = [
    "sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh",
    "acosh", "atanh", "exp", "exp2", "exp_m1", "ln", "ln_1p", "log", "log2", "log10", "powf", "hypot",
    "cbrt",
];

/// Macros of unfinished work and of debugging.
const UNFINISHED_MACROS: [&str; 3] = ["todo", "unimplemented", "dbg"];

pub fn check(source: &Source) -> Vec<Violation> {
    if !source.is("rs") {
        return Vec::new();
    }
    let masked = Masked::new(&source.text);
    let mut violations: Vec<Violation> = module_docs(source).into_iter().collect();
    violations.extend(file_length(source));
    violations.extend(unfinished(source, &masked));
    violations.extend(mul_add(source, &masked));
    violations.extend(transcendental(source, &masked));
    violations.extend(unsafe_code(source, &masked));
    violations.extend(captured(source));
    violations
}

/// True if the file contains only tests, benchmarks or examples.
pub fn is_test_file(path: &str) -> bool {
    ["/tests/", "/benches/", "/examples/"].iter().any(|folder| path.contains(folder))
        || path.ends_with("/tests.rs")
}

fn module_docs(source: &Source) -> Option<Violation> {
    let documented = source.text.starts_with("//!") || source.text.starts_with("#![doc");
    let problem = || "the file does not begin with documentation".to_owned();
    (!documented).then(|| Violation::new(&MODULE_DOCS, source, 1, problem(), "begin with a line of '//!'"))
}

fn file_length(source: &Source) -> Option<Violation> {
    let lines = source.text.lines().count();
    let problem = format!("{lines} lines, the limit is {LONG_FILE}");
    let violation = Violation::new(&FILE_LENGTH, source, lines, problem, "split the file by concept");
    match lines {
        _ if lines > LONG_FILE => Some(violation),
        _ if lines > LONGISH_FILE => Some(violation.mild()),
        _ => None,
    }
}

fn unfinished(source: &Source, masked: &Masked) -> Vec<Violation> {
    let calls = |line: &str, name: &str| line.contains(&format!("{name}!")) && has_word(line, name);
    let lines = masked.code.iter().enumerate();
    let found = lines.filter_map(|(index, line)| {
        UNFINISHED_MACROS.into_iter().find(|name| calls(line, name)).map(|name| (index + 1, name))
    });
    found
        .map(|(line, name)| Violation::new(&UNFINISHED, source, line, format!("{name}!"), "write the code"))
        .collect()
}

/// Reports of skipped tests that `cargo xtask test` does not see.
fn captured(source: &Source) -> Vec<Violation> {
    let is_report = |line: &str| {
        let text = line.split_once("println!(\"").map_or("", |(_, text)| text.trim_start_matches("\\n"));
        text.to_ascii_lowercase().starts_with("skipped:")
    };
    let lines = source.text.lines().enumerate().filter(|(_, line)| is_report(line));
    let found = lines.filter(|_| source.path.starts_with("crates/"));
    let advice = "call rayweave_conformance::skipped";
    found
        .map(|(at, _)| {
            Violation::new(&CAPTURED, source, at + 1, "println! of a skipped test".to_owned(), advice)
        })
        .collect()
}

fn mul_add(source: &Source, masked: &Masked) -> Vec<Violation> {
    let lines = masked.code.iter().enumerate().filter(|(_, line)| uses_method(line, "mul_add"));
    lines
        .map(|(index, _)| {
            let problem = "fused multiply-add".to_owned();
            Violation::new(&MUL_ADD, source, index + 1, problem, "write the product and the sum")
        })
        .collect()
}

fn transcendental(source: &Source, masked: &Masked) -> Vec<Violation> {
    let library =
        source.path.starts_with("crates/") && source.path.contains("/src/") && !is_test_file(&source.path);
    if !library {
        return Vec::new();
    }
    let lines = masked.library_code().filter(|(_, line)| !line.contains("libm"));
    let used = |line: &str| TRANSCENDENTAL_METHODS.into_iter().find(|name| uses_method(line, name));
    lines
        .filter_map(|(number, line)| used(line).map(|name| (number, name)))
        .map(|(number, name)| {
            let problem = format!("{name} of the standard library");
            Violation::new(
                &TRANSCENDENTAL,
                source,
                number,
                problem,
                &format!("use libm::{}", libm_name(name)),
            )
        })
        .collect()
}

fn unsafe_code(source: &Source, masked: &Masked) -> Vec<Violation> {
    let lines = masked.code.iter().enumerate().filter(|(_, line)| has_word(line, "unsafe"));
    lines
        .map(|(index, _)| {
            Violation::new(&UNSAFE, source, index + 1, "unsafe code".to_owned(), "find a safe way")
        })
        .collect()
}

/// True if the line calls this method of a float, as `x.name(` or by its path, as `f64::name`.
fn uses_method(line: &str, name: &str) -> bool {
    let by_path = ["f64::", "f32::"].iter().any(|prefix| {
        let path = format!("{prefix}{name}");
        line.contains(&path) && has_word(line, &path)
    });
    by_path || line.contains(&format!(".{name}("))
}

/// The name in libm of a method of the standard library.
fn libm_name(method: &str) -> &str {
    match method {
        "powf" => "pow",
        "ln" => "log",
        "ln_1p" => "log1p",
        "exp_m1" => "expm1",
        "sin_cos" => "sincos",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::found;

    const LIBRARY: &str = "crates/a/src/b.rs";

    #[test]
    fn documentation_comes_first() {
        assert_eq!(found(LIBRARY, "fn f() {}\n"), [("module-docs", 1)]);
        assert_eq!(found(LIBRARY, "#![doc = include_str!(\"here.md\")]\n"), []);
    }

    #[test]
    fn long_files_are_found() {
        let text = |lines: usize| "//! Long.\n".repeat(lines);
        assert_eq!(found(LIBRARY, &text(700)), []);
        assert_eq!(found(LIBRARY, &text(1001)), [("file-length", 1001)]);
        let source = Source { path: LIBRARY.to_owned(), text: text(701) };
        assert!(file_length(&source).unwrap().to_string().contains("warning"));
    }

    #[test]
    fn unfinished_code_is_found() {
        let text =
            "//! A.\nfn f() { todo!() }\n// todo!()\nfn g() { unimplemented!(\"x\") }\nfn h() { dbg!(1); }\n";
        assert_eq!(found(LIBRARY, text), [("unfinished", 2), ("unfinished", 4), ("unfinished", 5)]);
    }

    #[test]
    fn fused_and_transcendental_calls_are_found() {
        let text = "//! A.\nfn f(x: f64) -> f64 { x.mul_add(x, x) }\nfn g(x: f64) -> f64 { x.sin() }\n\
                    fn h(x: f64) -> f64 { libm::sin(x) + x.sqrt() + x.single() }\nfn i() { map(f64::atan2) }\n\
                    #[cfg(test)]\nmod tests { fn j(x: f64) { x.cos(); } }\n";
        assert_eq!(found(LIBRARY, text), [("mul-add", 2), ("transcendental", 3), ("transcendental", 5)]);
        assert_eq!(found("crates/a/tests/b.rs", "//! A.\nfn f(x: f64) { x.sin(); }\n"), []);
        assert_eq!(found("xtask/src/b.rs", "//! A.\nfn f(x: f64) { x.sin(); }\n"), []);
    }

    #[test]
    fn the_suggestion_is_the_name_in_libm() {
        let source =
            Source { path: LIBRARY.to_owned(), text: "//! A.\nfn f(x: f64) { x.powf(2.0); }\n".to_owned() };
        assert!(check(&source)[0].to_string().ends_with("Use libm::pow."));
    }

    #[test]
    fn captured_reports_of_skipped_tests_are_found() {
        let text = "//! A.\nfn f() { println!(\"skipped: no adapter\"); }\nfn g() { println!(\"\\nSKIPPED: {}\", 1); }\n\
                    fn h() { println!(\"2 skipped\"); }\n";
        assert_eq!(found("crates/a/tests/b.rs", text), [("captured", 2), ("captured", 3)]);
        assert_eq!(found("xtask/src/b.rs", text), []);
    }

    #[test]
    fn unsafe_code_is_found() {
        let text = "//! No unsafe code.\n#![forbid(unsafe_code)]\nfn f() { unsafe { g() } }\n";
        assert_eq!(found(LIBRARY, text), [("unsafe", 3)]);
    }
}
