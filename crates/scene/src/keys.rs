//! Tables taken apart key by key.

use crate::datum::{Datum, Table};
use crate::diagnostic::Diagnostic;
use crate::source::{Span, Spanned};
use crate::suggestion::did_you_mean;

/// A table that is being taken apart, so that what nobody asked for is noticed.
#[derive(Clone, Debug)]
pub struct Keys {
    /// The table's name, for messages.
    pub(crate) name: String,
    /// Where the table stands.
    pub(crate) span: Span,
    /// What has not been taken.
    pub(crate) rest: Table,
    asked: Vec<&'static str>,
}

impl Keys {
    pub(crate) fn new(name: &str, span: Span, rest: Table) -> Keys {
        Keys { name: name.to_owned(), span, rest, asked: Vec::new() }
    }

    /// Where the table stands.
    pub fn span(&self) -> Span {
        self.span
    }

    /// Takes a value out.
    pub fn take(&mut self, key: &'static str) -> Option<Spanned<Datum>> {
        self.take_entry(key).map(|(_, datum)| datum)
    }

    /// Takes a value out, with its key.
    pub fn take_entry(&mut self, key: &'static str) -> Option<(Spanned<String>, Spanned<Datum>)> {
        self.asked.push(key);
        let at = self.rest.iter().position(|(name, _)| name.value == key)?;
        Some(self.rest.remove(at))
    }

    /// That a value is missing.
    pub(crate) fn missing(&self, what: &str) -> Diagnostic {
        Diagnostic::error(format!("`{}` has no `{what}`", self.name)).why("it is needed")
    }

    /// Everything that nobody asked for.
    pub(crate) fn unknown(self) -> Vec<(Diagnostic, Span)> {
        let reason = format!("the keys are {}", self.asked.join(", "));
        let problem = |key: Spanned<String>| {
            let problem = Diagnostic::error(format!("unknown key `{}` in `{}`", key.value, self.name));
            let suggestion = did_you_mean(&key.value, self.asked.iter().copied());
            (problem.why(&reason).suggest(suggestion), key.span)
        };
        self.rest.into_iter().map(|(key, _)| problem(key)).collect()
    }
}
