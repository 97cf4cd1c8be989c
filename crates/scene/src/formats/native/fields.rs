//! Reading of a table key by key, with a report of unknown keys.

use crate::colour::Colour;
use crate::colour_names::COLOUR_NAMES;
use crate::datum::Datum;
use crate::diagnostic::Diagnostic;
use crate::document::{Matrix, Vector};
use crate::keys::Keys;
use crate::number::Number;
use crate::source::{Source, Span, Spanned};
use crate::suggestion::did_you_mean;
use std::sync::Arc;

/// Collected problems.
pub(crate) struct Problems {
    pub source: Arc<Source>,
    pub list: Vec<Diagnostic>,
}

impl Problems {
    pub fn push(&mut self, problem: Diagnostic, span: Span) {
        let source = self.source.clone();
        self.list.push(problem.at(&source, span));
    }

    /// A value of the wrong type.
    pub fn wrong_type(&mut self, what: &str, datum: &Spanned<Datum>, wanted: &str) {
        let problem = format!("`{what}` is {}", datum.value.description());
        self.push(Diagnostic::error(problem).why(format!("it must be {wanted}")), datum.span);
    }

    pub fn number(&mut self, what: &str, datum: Spanned<Datum>) -> Option<Spanned<Number>> {
        match datum.value {
            Datum::Number(value) if value.is_nan() => {
                let problem = Diagnostic::error(format!("`{what}` is nan")).why("it must be a number");
                self.push(problem, datum.span);
                None
            }
            Datum::Number(value) => Some(Spanned::new(Number::Value(value), datum.span)),
            Datum::Text(text) => Some(Spanned::new(Number::Text(text), datum.span)),
            _ => {
                self.wrong_type(what, &datum, "a number or an arithmetic expression");
                None
            }
        }
    }

    pub fn numbers<const N: usize>(
        &mut self,
        what: &str,
        datum: Spanned<Datum>,
    ) -> Option<[Spanned<Number>; N]> {
        match datum.value {
            Datum::List(list) if list.len() == N => {
                let mut numbers = [(); N].map(|()| Spanned::default());
                let mut complete = true;
                for (place, item) in numbers.iter_mut().zip(list) {
                    match self.number(what, item) {
                        Some(number) => *place = number,
                        None => complete = false,
                    }
                }
                complete.then_some(numbers)
            }
            _ => {
                self.wrong_type(what, &datum, &format!("a list of {N} numbers"));
                None
            }
        }
    }

    pub fn matrix(&mut self, what: &str, datum: Spanned<Datum>) -> Option<Matrix> {
        match datum.value {
            Datum::List(rows) if rows.len() == 4 => {
                let rows: Vec<Option<_>> = rows.into_iter().map(|row| self.numbers(what, row)).collect();
                let rows: Option<Vec<_>> = rows.into_iter().collect();
                rows?.try_into().ok()
            }
            _ => {
                self.wrong_type(what, &datum, "4 rows of 4 numbers");
                None
            }
        }
    }

    pub fn text(&mut self, what: &str, datum: Spanned<Datum>) -> Option<Spanned<String>> {
        match datum.value {
            Datum::Text(text) => Some(Spanned::new(text, datum.span)),
            _ => {
                self.wrong_type(what, &datum, "a string");
                None
            }
        }
    }

    pub fn boolean(&mut self, what: &str, datum: Spanned<Datum>) -> Option<Spanned<bool>> {
        match datum.value {
            Datum::Boolean(boolean) => Some(Spanned::new(boolean, datum.span)),
            _ => {
                self.wrong_type(what, &datum, "true or false");
                None
            }
        }
    }

    pub fn colour(&mut self, what: &str, datum: Spanned<Datum>) -> Option<Spanned<Colour>> {
        let text = self.text(what, datum)?;
        let colour = Colour::parse(&text.value);
        if colour.is_none() {
            let problem = format!("`{}` is not a colour", text.value);
            let reason =
                "colours are names such as `red`, or #rgb, #rrggbb or #rrggbbaa in hexadecimal digits";
            let suggestion = did_you_mean(&text.value, COLOUR_NAMES.iter().map(|(name, _)| *name));
            let suggestion = suggestion.or(Some("Did you mean `#88aaff`?".to_owned()));
            self.push(Diagnostic::error(problem).why(reason).suggest(suggestion), text.span);
        }
        Some(Spanned::new(colour?, text.span))
    }

    /// One of several words.
    pub fn choice<T: Copy>(
        &mut self,
        what: &str,
        datum: Spanned<Datum>,
        choices: &[(T, &str)],
    ) -> Option<Spanned<T>> {
        let text = self.text(what, datum)?;
        if let Some((value, _)) = choices.iter().find(|(_, name)| *name == text.value) {
            return Some(Spanned::new(*value, text.span));
        }
        let names: Vec<&str> = choices.iter().map(|(_, name)| *name).collect();
        let problem = Diagnostic::error(format!("unknown {what} `{}`", text.value));
        let suggestion = did_you_mean(&text.value, names.iter().copied());
        self.push(
            problem.why(format!("the choices are {}", names.join(", "))).suggest(suggestion),
            text.span,
        );
        None
    }
}

/// A table whose keys are taken one by one, with the list of problems.
pub(super) struct Fields<'p> {
    pub problems: &'p mut Problems,
    pub keys: Keys,
}

impl<'p> Fields<'p> {
    /// Creates the reader of a table; `None`, with a problem reported, if the value is not a table.
    pub fn new(problems: &'p mut Problems, name: &str, datum: Spanned<Datum>) -> Option<Fields<'p>> {
        match datum.value {
            Datum::Table(rest) => Some(Fields { problems, keys: Keys::new(name, datum.span, rest) }),
            _ => {
                problems.wrong_type(name, &datum, "a table");
                None
            }
        }
    }

    /// Removes and returns a value.
    pub fn take(&mut self, key: &'static str) -> Option<Spanned<Datum>> {
        self.keys.take(key)
    }

    /// Removes and returns a value with its key.
    pub fn take_entry(&mut self, key: &'static str) -> Option<(Spanned<String>, Spanned<Datum>)> {
        self.keys.take_entry(key)
    }

    /// Removes and returns the only entry that is left, if its key has a property. In a table without unknown keys, this is faster
    /// than a search for each key.
    pub fn take_last(
        &mut self,
        is_wanted: impl Fn(&str) -> bool,
    ) -> Option<(Spanned<String>, Spanned<Datum>)> {
        match self.keys.rest.as_slice() {
            [(key, _)] if is_wanted(&key.value) => self.keys.rest.pop(),
            _ => None,
        }
    }

    /// Removes and returns a required value.
    pub fn need(&mut self, key: &'static str) -> Option<Spanned<Datum>> {
        let datum = self.take(key);
        if datum.is_none() {
            self.missing(key);
        }
        datum
    }

    /// Reports that a value is missing.
    pub fn missing(&mut self, what: &str) {
        self.problems.push(self.keys.missing(what), self.keys.span);
    }

    pub fn number(&mut self, key: &'static str) -> Option<Spanned<Number>> {
        let datum = self.take(key)?;
        self.problems.number(key, datum)
    }

    pub fn vector(&mut self, key: &'static str) -> Option<Vector> {
        let datum = self.take(key)?;
        self.problems.numbers(key, datum)
    }

    pub fn text(&mut self, key: &'static str) -> Option<Spanned<String>> {
        let datum = self.take(key)?;
        self.problems.text(key, datum)
    }

    pub fn colour(&mut self, key: &'static str) -> Option<Spanned<Colour>> {
        let datum = self.take(key)?;
        self.problems.colour(key, datum)
    }

    pub fn boolean(&mut self, key: &'static str) -> Option<Spanned<bool>> {
        let datum = self.take(key)?;
        self.problems.boolean(key, datum)
    }

    /// True if everything has been taken.
    pub fn is_exhausted(&self) -> bool {
        self.keys.rest.is_empty()
    }

    /// Reports every key that has not been taken.
    pub fn finish(self) {
        for (problem, span) in self.keys.unknown() {
            self.problems.push(problem, span);
        }
    }
}
