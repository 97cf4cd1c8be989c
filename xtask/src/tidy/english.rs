//! Checks of wording: retired words, and limits on the number of phrasings that are hard to read.

use std::fmt;

use super::text::has_word;
use super::violation::{Rule, Violation};
use crate::masked::Masked;
use crate::repository::Source;

static RETIRED_WORD: Rule = Rule { name: "retired-word", why: "the field has a standard term" };

/// Retired words in code and text, each with the standard term that replaces it.
///
/// Written in two parts, so that this file does not violate its own rule.
const RETIRED: [(&str, &str); 21] = [
    (concat!("fore", "see"), "predict"),
    (concat!("fore", "sight"), "prediction"),
    (concat!("a", "breast"), "bundle"),
    (concat!("hu", "gs"), "coincides_along"),
    (concat!("may_", "hug"), "may_coincide"),
    (concat!("LIE", "_DIRECTION"), "PERTURBATION_DIRECTION"),
    (concat!("lie", "_direction"), "perturbation_direction"),
    (concat!("Travel", "ler"), "RayState"),
    (concat!("Fl", "ips"), "LeafStates"),
    (concat!("win", "ner"), "owner"),
    (concat!("un", "ask"), "mark_unused"),
    (concat!("is_", "asked"), "is_used"),
    (concat!("As", "ked"), "Query"),
    (concat!("Ask", "Again"), "QueryAgain"),
    (concat!("Contend", "er"), "EvaluatorUnderTest"),
    (concat!("contend", "er"), "evaluator under test"),
    (concat!("re", "spawn"), "re-hit"),
    (concat!("Dou", "bt"), "Uncertain"),
    (concat!("is_", "settled"), "is_resolved"),
    (concat!("Ga", "ze"), "PrimaryRays"),
    (concat!("refuse_", "the_rest"), "reject_unknown"),
];

/// The maximum number of comment lines that begin with What, That, Where, How or Who.
const MAX_OPENINGS: usize = 10;
/// The maximum number of comment lines with a passive of the list of verbs below.
const MAX_PASSIVES: usize = 20;
/// The maximum number of comment lines with a form of the verb of telling.
const MAX_TELLINGS: usize = 10;

const OPENINGS: [&str; 5] = ["What", "That", "Where", "How", "Who"];
const AUXILIARIES: [&str; 6] = ["is", "are", "was", "were", "be", "been"];
const PARTICIPLES: [&str; 9] =
    ["asked", "wished", "told", "wanted", "met", "known", "gone", "said", "looked"];
const TELLING: [&str; 4] = ["tell", "tells", "told", "telling"];

/// The retired words of one file.
pub fn check(source: &Source) -> Vec<Violation> {
    let ours = ["rs", "md", "py", "pyi", "toml"].iter().any(|extension| source.is(extension));
    if !ours {
        return Vec::new();
    }
    let mut violations = Vec::new();
    for (index, line) in source.text.lines().enumerate() {
        for (word, term) in RETIRED.iter().filter(|(word, _)| has_word(line, word)) {
            let suggestion = format!("write '{term}'");
            violations.push(Violation::new(
                &RETIRED_WORD,
                source,
                index + 1,
                format!("'{word}'"),
                &suggestion,
            ));
        }
    }
    violations
}

/// Counts of comment lines in Rust files: all, and those with each kind of phrasing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Phrasings {
    comments: usize,
    openings: usize,
    passives: usize,
    telling: usize,
}

impl Phrasings {
    /// Adds the comments of a file.
    pub fn add(&mut self, source: &Source) {
        if !source.is("rs") {
            return;
        }
        for line in Masked::new(&source.text).comments {
            let text = line.trim_start().trim_start_matches(['/', '!']).trim_start();
            if text.is_empty() {
                continue;
            }
            let words: Vec<&str> = text.split(|c: char| !c.is_alphabetic()).collect();
            let is_one = |list: &[&str], word: &&str| list.iter().any(|own| own.eq_ignore_ascii_case(word));
            self.comments += 1;
            self.openings += usize::from(OPENINGS.contains(&words[0]));
            let passive = |pair: &[&str]| is_one(&AUXILIARIES, &pair[0]) && is_one(&PARTICIPLES, &pair[1]);
            self.passives += usize::from(words.windows(2).any(passive));
            self.telling += usize::from(words.iter().any(|word| is_one(&TELLING, word)));
        }
    }

    /// The counts that exceed their limits.
    pub fn problems(&self) -> Vec<String> {
        let limits = [
            (
                self.openings,
                MAX_OPENINGS,
                "begin with What, That, Where, How or Who",
                "begin with the subject",
            ),
            (self.passives, MAX_PASSIVES, "contain a passive such as 'is asked'", "name who does what"),
            (
                self.telling,
                MAX_TELLINGS,
                "let a program tell something",
                "write 'returns', 'reports' or 'states'",
            ),
        ];
        let exceeded = limits.into_iter().filter(|(count, most, ..)| count > most);
        exceeded
            .map(|(count, most, what, advice)| {
                format!("{count} comment lines {what}: the limit is {most}. Please {advice}.")
            })
            .collect()
    }
}

impl fmt::Display for Phrasings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Phrasings { comments, openings, passives, telling } = self;
        write!(
            f,
            "{comments} comment lines: {openings} begin with a question word, {passives} contain a vague passive, {telling} 'tell'"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::found;

    fn phrasings(text: &str) -> Phrasings {
        let mut phrasings = Phrasings::default();
        phrasings.add(&Source { path: "crates/a/src/b.rs".to_owned(), text: text.to_owned() });
        phrasings
    }

    #[test]
    fn retired_words_are_found_everywhere() {
        let (word, _) = RETIRED[0];
        assert_eq!(found("docs/a.md", &format!("One {word}.\n\nNo {word}n.\n")), [("retired-word", 1)]);
    }

    #[test]
    fn phrasings_are_counted_by_line() {
        let text = "//! What it is.\n\n/// The ray is asked, and told.\nfn f() {} // tells\n// That\n";
        let expected = Phrasings { comments: 4, openings: 2, passives: 1, telling: 2 };
        assert_eq!(phrasings(text), expected);
        assert_eq!(expected.problems().len(), 0);
    }

    #[test]
    fn exceeded_limits_are_reported() {
        let all = Phrasings { comments: 9999, openings: 9999, passives: 9999, telling: 9999 };
        assert_eq!(all.problems().len(), 3);
        assert!(all.problems()[0].starts_with("9999 comment lines begin with What"));
    }
}
