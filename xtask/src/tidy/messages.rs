//! Check of error messages: `problem: reason. Suggestion.`

use super::violation::{Rule, Violation};
use crate::repository::Source;

static MESSAGE: Rule = Rule { name: "message", why: "messages are 'problem: reason. Suggestion.'" };

const ATTRIBUTE: &str = "#[error(";

/// The violations of the grammar in the `#[error("...")]` attributes of a file.
pub fn check(source: &Source) -> Vec<Violation> {
    if !source.is("rs") || !source.path.contains("/src/") || source.path.starts_with("xtask/") {
        return Vec::new();
    }
    let starts = source.text.match_indices(ATTRIBUTE).map(|(at, _)| at);
    let faults = starts.filter_map(|at| {
        let message = literal(&source.text[at + ATTRIBUTE.len()..])?;
        let line = source.text[..at].matches('\n').count() + 1;
        fault(&message).map(|suggestion| {
            Violation::new(&MESSAGE, source, line, format!("the message \"{message}\""), suggestion)
        })
    });
    faults.collect()
}

/// The text of the string literal at the start of `code`, with continued lines joined.
fn literal(code: &str) -> Option<String> {
    let mut text = String::new();
    let mut rest = code.trim_start().strip_prefix('"')?.chars();
    while let Some(c) = rest.next() {
        match c {
            '"' => return Some(text),
            '\\' => match rest.next()? {
                '\n' => rest = rest.as_str().trim_start().chars(),
                other => text.push(other),
            },
            other => text.push(other),
        }
    }
    None
}

/// A suggestion for a message that breaks the grammar.
fn fault(message: &str) -> Option<&'static str> {
    let begins_with_word = message.split(' ').next().is_some_and(|word| {
        word.len() > 1 && word.starts_with(char::is_uppercase) && word.chars().skip(1).all(char::is_lowercase)
    });
    let is_sentence = message.ends_with(['.', '?', '}']);
    match () {
        () if begins_with_word => Some("begin with a small letter"),
        () if message.ends_with(')') => Some("write the reason after a colon, not in parentheses"),
        () if message.contains(": ") && !is_sentence => Some("end the reason with a period"),
        () => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::tidy::found;

    fn is_accepted(message: &str) -> bool {
        let text = format!("//! A.\n\n#[error({message})]\nstruct A;\n");
        let violations = found("crates/a/src/b.rs", &text);
        assert!(violations.iter().all(|&(rule, line)| rule == "message" && line == 3), "{violations:?}");
        violations.is_empty()
    }

    #[test]
    fn messages_have_one_grammar() {
        for good in [
            r#""root {index} is NaN""#,
            r#""the file is empty: a model is needed. Write one.""#,
            r#""{0}: {1}""#,
            "transparent",
            "\n\"the radius is {0}: \\\n   it must be positive.\"\n, 1",
        ] {
            assert!(is_accepted(good), "{good}");
        }
        for bad in [
            r#""The file is empty""#,
            r#""the file is empty (a model is needed)""#,
            r#""the file is empty: a model is needed""#,
            "\n\"the radius is {0}: \\\n   it must be positive\"\n, 1",
        ] {
            assert!(!is_accepted(bad), "{bad}");
        }
    }
}
