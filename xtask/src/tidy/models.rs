//! Checks of the models that documentation, tests and benchmarks share.

use super::violation::{Rule, Violation};
use crate::repository::Source;

static MODEL: Rule = Rule { name: "model", why: "readers find a model by its description and its picture" };

pub fn check(source: &Source, exists: &dyn Fn(&str) -> bool) -> Vec<Violation> {
    let Some(stem) = source.path.strip_prefix("models/").and_then(|name| name.strip_suffix(".toml")) else {
        return Vec::new();
    };
    let violation =
        |problem: &str, suggestion: &str| Violation::new(&MODEL, source, 1, problem.to_owned(), suggestion);
    let mut violations = Vec::new();
    if !source.text.starts_with("# ") {
        violations.push(violation("the model has no description", "begin with a comment of one line"));
    }
    let picture = format!("models/{stem}.png");
    if !exists(&picture) {
        let command = format!("run 'rayweave render models/{stem}.toml -o {picture}'");
        violations.push(violation("the model has no picture", &command));
    }
    violations
}

#[cfg(test)]
mod tests {
    use crate::tidy::found;

    #[test]
    fn models_have_words_and_pictures() {
        assert_eq!(found("models/here.toml", "# A lens.\nrayweave = 1\n"), []);
        assert_eq!(found("models/here.toml", "rayweave = 1\n"), [("model", 1)]);
        assert_eq!(found("models/gone.toml", "# A lens.\n"), [("model", 1)]);
        assert_eq!(found("other/gone.toml", "a = 1\n"), []);
    }
}
