//! The text of an error.

use crate::did_you_mean;
use std::fmt;

/// The text of an error, printed as `problem: reason. Suggestion.`
///
/// Missing full stops are added.
///
/// ```
/// use rayweave_error::Message;
///
/// let message = Message::new("region `floor` is unbounded", "a volume needs a bounded solid");
/// assert_eq!(message.to_string(), "region `floor` is unbounded: a volume needs a bounded solid.");
/// let message = message.suggest("Intersect it with a box");
/// assert!(message.to_string().ends_with("needs a bounded solid. Intersect it with a box."));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Message {
    problem: String,
    reason: String,
    suggestion: Option<String>,
}

/// The largest number of names that a message about an unknown name lists.
const MAX_LISTED: usize = 12;

impl Message {
    /// A problem and its reason.
    pub fn new(problem: impl Into<String>, reason: impl Into<String>) -> Message {
        Message { problem: problem.into(), reason: reason.into(), suggestion: None }
    }

    /// Adds a suggestion: a sentence or a question.
    pub fn suggest(self, suggestion: impl Into<String>) -> Message {
        Message { suggestion: Some(suggestion.into()), ..self }
    }

    /// The message for a name that no candidate has. `what` is the noun for a candidate. Lists the candidates, shortened where
    /// there are many, and suggests the one that was probably meant ([`did_you_mean`]).
    ///
    /// ```
    /// use rayweave_error::Message;
    ///
    /// let message = Message::unknown("solid", "lesn", ["lens", "rim"]);
    /// assert_eq!(message.to_string(), "no solid is called `lesn`: the names are lens, rim. Did you mean `lens`?");
    /// ```
    pub fn unknown<'a>(what: &str, name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Message {
        let names: Vec<&str> = candidates.into_iter().collect();
        let reason = match names[..] {
            [] => format!("there is no {what}"),
            [only] => format!("the only name is {only}"),
            _ if names.len() <= MAX_LISTED => format!("the names are {}", names.join(", ")),
            _ => {
                let (listed, more) = names.split_at(MAX_LISTED - 2);
                format!("the names are {}, ... and {} more", listed.join(", "), more.len())
            }
        };
        let message = Message::new(format!("no {what} is called `{name}`"), reason);
        match did_you_mean(name, names) {
            Some(meant) => message.suggest(format!("Did you mean `{meant}`?")),
            None => message,
        }
    }

    /// The problem alone.
    pub fn problem(&self) -> &str {
        &self.problem
    }

    /// The reason alone.
    pub fn reason(&self) -> &str {
        &self.reason
    }

    /// The suggestion alone.
    pub fn suggestion(&self) -> Option<&str> {
        self.suggestion.as_deref()
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}{}", self.problem, self.reason, full_stop(&self.reason))?;
        match &self.suggestion {
            Some(suggestion) => write!(f, " {suggestion}{}", full_stop(suggestion)),
            None => Ok(()),
        }
    }
}

/// The full stop that a sentence lacks.
fn full_stop(sentence: &str) -> &'static str {
    if sentence.ends_with(['.', '!', '?']) { "" } else { "." }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unknown(name: &str, known: &[&str]) -> String {
        Message::unknown("solid", name, known.iter().copied()).to_string()
    }

    #[test]
    fn full_stops_are_added_where_they_lack() {
        let text = |reason: &str, suggestion: &str| Message::new("p", reason).suggest(suggestion).to_string();
        assert_eq!(text("r", "S"), "p: r. S.");
        assert_eq!(text("r.", "S?"), "p: r. S?");
        assert_eq!(Message::new("p", "r").to_string(), "p: r.");
    }

    #[test]
    fn a_slip_gets_a_suggestion() {
        assert_eq!(
            unknown("lesn", &["lens", "rim"]),
            "no solid is called `lesn`: the names are lens, rim. Did you mean `lens`?"
        );
        assert_eq!(
            unknown("mirror", &["lens", "rim"]),
            "no solid is called `mirror`: the names are lens, rim."
        );
        assert_eq!(unknown("x", &["lens"]), "no solid is called `x`: the only name is lens.");
        assert_eq!(unknown("x", &[]), "no solid is called `x`: there is no solid.");
        let many: Vec<String> = (0..20).map(|k| format!("tile{k}")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert!(unknown("q", &many).contains("tile9, ... and 10 more"));
    }
}
