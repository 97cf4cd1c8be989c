//! Checks of any text: white space, marks of unfinished work, paths of one machine.

use super::violation::{Rule, Violation};
use crate::masked::Masked;
use crate::repository::Source;

static BLANKS: Rule = Rule { name: "blanks", why: "diffs should show changes only" };
static UNFINISHED: Rule = Rule { name: "unfinished", why: "the repository contains finished work only" };
static MACHINE_PATH: Rule = Rule { name: "machine-path", why: "it exists on one machine only" };

// in two parts each, so that this file does not violate its own rules
const MARKS: [&str; 3] = [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("X", "XX")];
const MACHINE_PATHS: [&str; 4] =
    [concat!("/", "work"), concat!("/", "root"), concat!("/", "home"), concat!("/", "tmp")];

pub fn check(source: &Source) -> Vec<Violation> {
    let ours = ["rs", "toml", "md", "py", "pyi"].iter().any(|extension| source.is(extension));
    if !ours {
        return Vec::new();
    }
    let mut violations = blanks(source);
    violations.extend(marks(source));
    violations.extend(machine_paths(source));
    violations
}

fn blanks(source: &Source) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (index, line) in source.text.lines().enumerate() {
        if line.contains('\t') {
            violations.push(violation(&BLANKS, source, index, "tab character", "use spaces"));
        }
        if line.ends_with([' ', '\t', '\r']) {
            violations.push(violation(&BLANKS, source, index, "blank at the end of the line", "remove it"));
        }
    }
    if !source.text.is_empty() && !source.text.ends_with('\n') {
        let last = source.text.lines().count() - 1;
        violations.push(violation(&BLANKS, source, last, "no line break at the end of the file", "add one"));
    }
    violations
}

fn marks(source: &Source) -> Vec<Violation> {
    let comments = comments(source);
    let marked = |line: &str| MARKS.into_iter().find(|mark| has_word(line, mark));
    let found =
        comments.iter().enumerate().filter_map(|(index, line)| marked(line).map(|mark| (index, mark)));
    found
        .map(|(index, mark)| violation(&UNFINISHED, source, index, mark, "do it, or file it as an issue"))
        .collect()
}

/// The comments of each line; none for a Markdown file.
fn comments(source: &Source) -> Vec<String> {
    if source.is("rs") {
        return Masked::new(&source.text).comments;
    }
    let hash = |line: &str| line.split_once('#').map(|(_, comment)| comment.to_owned()).unwrap_or_default();
    if source.is("md") { Vec::new() } else { source.text.lines().map(hash).collect() }
}

fn machine_paths(source: &Source) -> Vec<Violation> {
    let absolute = |line: &str| MACHINE_PATHS.into_iter().find(|path| has_path(line, path));
    let lines = source.text.lines().enumerate();
    let found = lines.filter_map(|(index, line)| absolute(line).map(|path| (index, path)));
    found
        .map(|(index, path)| {
            let problem = format!("path under {path}");
            violation(&MACHINE_PATH, source, index, &problem, "use a relative path or temp_dir()")
        })
        .collect()
}

fn violation(
    rule: &'static Rule,
    source: &Source,
    index: usize,
    problem: &str,
    suggestion: &str,
) -> Violation {
    Violation::new(rule, source, index + 1, problem.to_owned(), suggestion)
}

/// True if the line contains the word, without a word character on either side.
pub fn has_word(line: &str, word: &str) -> bool {
    line.match_indices(word).any(|(at, _)| is_word(line, at, word))
}

/// True if the word at this index has no word character on either side.
pub fn is_word(line: &str, at: usize, word: &str) -> bool {
    let continues = |character: char| character.is_alphanumeric() || character == '_';
    !line[..at].ends_with(continues) && !line[at + word.len()..].starts_with(continues)
}

/// True if the line contains an absolute path to this folder or something in it.
fn has_path(line: &str, folder: &str) -> bool {
    let relative = |character: char| character.is_alphanumeric() || "_./~)}]>*-".contains(character);
    let longer = |character: char| character.is_alphanumeric() || "_-.".contains(character);
    line.match_indices(folder)
        .any(|(at, _)| !line[..at].ends_with(relative) && !line[at + folder.len()..].starts_with(longer))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::found;

    #[test]
    fn blanks_are_found() {
        assert_eq!(
            found("a.md", "one\t\ntwo \nthree"),
            [("blanks", 1), ("blanks", 1), ("blanks", 2), ("blanks", 3)]
        );
        assert_eq!(found("a.svg", "one\t\n"), []);
    }

    #[test]
    fn marks_are_found_in_comments_only() {
        let [mark, ..] = MARKS;
        let text =
            format!("//! {mark} write\n// method {mark}S\nfn f() {{ g(\"{mark}\"); }} // ({mark}: h)\n");
        assert_eq!(found("crates/a/src/b.rs", &text), [("unfinished", 1), ("unfinished", 3)]);
        assert_eq!(found("a.py", &format!("x = 1  # {mark}\ny = '{mark}'\n")), [("unfinished", 1)]);
    }

    #[test]
    fn machine_paths_are_found() {
        let [_, root, _, tmp] = MACHINE_PATHS;
        let text = format!("see {root}/a and {tmp}\n[x](crates{root}) {root}ray ../..{tmp}\n`{tmp}/x`\n");
        assert_eq!(found("docs.txt", &text), []);
        let lines: Vec<usize> = found("docs.py", &text)
            .iter()
            .filter(|found| found.0 == "machine-path")
            .map(|found| found.1)
            .collect();
        assert_eq!(lines, [1, 3]);
    }

    #[test]
    fn words_have_borders() {
        assert!(has_word("a unsafe {", "unsafe"));
        assert!(!has_word("unsafe_code", "unsafe"));
        assert!(!has_word("nounsafe", "unsafe"));
    }
}
