//! Keys of a table, taken one by one, so that unknown keys are detected.

use crate::datum::{Datum, Table};
use crate::diagnostic::Diagnostic;
use crate::source::{Span, Spanned};
use crate::suggestion::did_you_mean;

/// The steps of transforms.
pub(crate) const STEPS: [&str; 8] =
    ["translate", "rotate_x", "rotate_y", "rotate_z", "rotate", "scale", "mirror", "matrix"];

/// The keyword of extruded outlines.
pub(crate) const EXTRUDE: &str = "extrude";

/// The keyword of revolved outlines.
pub(crate) const REVOLVE: &str = "revolve";

/// The remaining keys of a table. After all known keys have been taken, the rest is unknown.
#[derive(Clone, Debug)]
pub struct Keys {
    /// The table's name, for messages.
    pub(crate) name: String,
    /// The span of the table.
    pub(crate) span: Span,
    /// The entries that have not been taken.
    pub(crate) rest: Table,
    known: Vec<&'static str>,
}

impl Keys {
    pub(crate) fn new(name: &str, span: Span, rest: Table) -> Keys {
        Keys { name: name.to_owned(), span, rest, known: Vec::new() }
    }

    /// The span of the table.
    pub fn span(&self) -> Span {
        self.span
    }

    /// Removes and returns a value.
    pub fn take(&mut self, key: &'static str) -> Option<Spanned<Datum>> {
        self.take_entry(key).map(|(_, datum)| datum)
    }

    /// Removes and returns a value with its key.
    pub fn take_entry(&mut self, key: &'static str) -> Option<(Spanned<String>, Spanned<Datum>)> {
        self.known.push(key);
        let at = self.rest.iter().position(|(name, _)| name.value == key)?;
        Some(self.rest.remove(at))
    }

    /// The diagnostic of a missing value.
    pub(crate) fn missing(&self, what: &str) -> Diagnostic {
        Diagnostic::error(format!("`{}` has no `{what}`", self.name)).why("it is required")
    }

    /// The diagnostics of all keys that have not been taken.
    pub(crate) fn unknown(self) -> Vec<(Diagnostic, Span)> {
        // nearly always, and the reason below takes longer than reading the table
        if self.rest.is_empty() {
            return Vec::new();
        }
        let reason = format!("the keys are {}", self.known.join(", "));
        let problem = |key: Spanned<String>| {
            let problem = Diagnostic::error(format!("unknown key `{}` in `{}`", key.value, self.name));
            let is_step = self.known.contains(&"transform") && STEPS.contains(&key.value.as_str());
            let suggestion = match is_step {
                true => Some(format!("Write `transform = [{{ {} = .. }}]`", key.value)),
                false => did_you_mean(&key.value, self.known.iter().copied()),
            };
            (problem.why(&reason).suggest(suggestion), key.span)
        };
        self.rest.into_iter().map(|(key, _)| problem(key)).collect()
    }
}
