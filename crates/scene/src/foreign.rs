//! Reader of the extension tables of a model file, such as `[optics]`, which other crates define.
//!
//! A program obtains its table with [`Document::foreign`] and reads it with a [`Reader`]. Numbers may
//! be arithmetic expressions in the parameters; transforms have the same syntax as those of solids.
//! Every problem has a source span, and all problems are reported at once.
//!
//! ```
//! use rayweave_scene::foreign::Reader;
//!
//! let text = "rayweave = 1\n[parameters]\nR = 4\n[lamp]\nheight = '2 * R'\ncolor = 'red'\n";
//! let (document, scene) = rayweave_scene::parse(text)?;
//! let lamp = document.foreign("lamp").ok_or("no lamp")?;
//!
//! let mut reader = Reader::new(&document, &scene);
//! let mut keys = reader.keys("lamp", lamp.value.clone()).ok_or("no table")?;
//! let height = keys.take("height").and_then(|datum| reader.number("height", datum));
//! keys.take("colour");
//! reader.reject_unknown(keys);
//!
//! assert_eq!(height, Some(8.0));
//! let problems = reader.finish(height).unwrap_err();
//! let problem = problems.iter().next().ok_or("no problem")?;
//! assert_eq!(problem.line_column(), Some((6, 1)));
//! let message = "unknown key `color` in `lamp`: the keys are height, colour. Did you mean `colour`?";
//! assert_eq!(problem.message(), message);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::arithmetic::Arithmetic;
use crate::datum::Datum;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::document::Document;
use crate::formats::native::{Problems, transform};
use crate::number::{Number, written};
use crate::resolve::{Context, Numbers, product};
use crate::scene::Scene;
use crate::source::{Span, Spanned};
use crate::suggestion::did_you_mean;
use rayweave_math::Affine;
use std::collections::HashSet;
use std::fmt::Display;

pub use crate::keys::Keys;

/// Reads tables of a document and collects the problems.
///
/// Methods return `None` for values that they cannot read and report the problem; [`Reader::finish`] returns all problems.
pub struct Reader<'d> {
    document: &'d Document,
    numbers: Numbers,
    problems: Problems,
    unreadable: HashSet<String>,
}

impl<'d> Reader<'d> {
    /// Creates a reader of the tables of a document; the scene supplies the values of its parameters.
    pub fn new(document: &'d Document, scene: &Scene) -> Reader<'d> {
        let problems = Problems { source: document.source.clone(), list: Vec::new() };
        Reader { document, numbers: Numbers::known(&scene.parameters), problems, unreadable: HashSet::new() }
    }

    /// Reports a problem.
    pub fn report(&mut self, problem: Diagnostic, span: Span) {
        self.problems.push(problem, span);
    }

    /// Reports an unknown name and the known ones. `what` is the kind, such as "medium".
    pub fn unknown(&mut self, what: &str, name: &Spanned<String>, known: &[&str]) {
        let problem = Diagnostic::error(format!("unknown {what} `{}`", name.value));
        let suggestion = did_you_mean(&name.value, known.iter().copied());
        let reason = format!("the choices are {}", known.join(", "));
        self.report(problem.why(reason).suggest(suggestion), name.span);
    }

    /// Reports a value of the wrong kind; `wanted` is the expected kind, such as "a list of 2 numbers".
    pub fn wrong_type(&mut self, what: &str, datum: &Spanned<Datum>, wanted: &str) {
        self.problems.wrong_type(what, datum, wanted);
    }

    /// Returns the value, or reports its error at a span.
    pub fn accept<T, E: Display>(&mut self, made: Result<T, E>, span: Span) -> Option<T> {
        made.map_err(|error| self.report(Diagnostic::error(error.to_string()), span)).ok()
    }

    /// The keys of a table.
    pub fn keys(&mut self, name: &str, datum: Spanned<Datum>) -> Option<Keys> {
        match datum.value {
            Datum::Table(table) => Some(Keys::new(name, datum.span, table)),
            _ => {
                self.wrong_type(name, &datum, "a table");
                None
            }
        }
    }

    /// The tables of an array of tables, `[[name]]`.
    pub fn tables(&mut self, name: &str, datum: Spanned<Datum>) -> Vec<Keys> {
        match datum.value {
            Datum::List(list) => list.into_iter().filter_map(|item| self.keys(name, item)).collect(),
            _ => {
                self.wrong_type(name, &datum, &format!("a list of tables, such as [[{name}]]"));
                Vec::new()
            }
        }
    }

    /// Takes a required value.
    pub fn need(&mut self, keys: &mut Keys, key: &'static str) -> Option<Spanned<Datum>> {
        let datum = keys.take(key);
        if datum.is_none() {
            self.report(keys.missing(key), keys.span);
        }
        datum
    }

    /// Takes exactly one of several values, with its key; reports an error unless exactly one is present.
    pub fn one_of(
        &mut self,
        keys: &mut Keys,
        list: &[&'static str],
    ) -> Option<(Spanned<String>, Spanned<Datum>)> {
        let mut found: Vec<_> = list.iter().filter_map(|name| keys.take_entry(name)).collect();
        let names = list.join(", ");
        if let [_, (second, _), ..] = found.as_slice() {
            let problem = Diagnostic::error(format!("`{}` conflicts with another key", second.value));
            let reason = format!("`{}` has exactly one of {names}", keys.name);
            self.report(problem.why(reason), second.span);
            return None;
        }
        // the remaining keys are reported later, with suggestions for misspellings
        let is_slip = |(key, _): &(Spanned<String>, Spanned<Datum>)| {
            did_you_mean(&key.value, list.iter().copied()).is_some()
        };
        if found.is_empty() && !keys.rest.iter().any(is_slip) {
            self.report(keys.missing(&names.replace(", ", "` or `")), keys.span);
        }
        found.pop()
    }

    /// Reports every key that has not been taken.
    pub fn reject_unknown(&mut self, keys: Keys) {
        keys.unknown().into_iter().for_each(|(problem, span)| self.report(problem, span));
    }

    /// A number, or an arithmetic expression in the parameters.
    pub fn number(&mut self, what: &str, datum: Spanned<Datum>) -> Option<f64> {
        let number = self.problems.number(what, datum)?;
        self.within(|context, numbers| numbers.number(context, &number))
    }

    /// A number that satisfies a condition, such as "finite and greater than 0".
    pub fn checked(
        &mut self,
        what: &str,
        datum: Spanned<Datum>,
        condition: &str,
        holds: impl Fn(f64) -> bool,
    ) -> Option<f64> {
        let span = datum.span;
        let value = self.number(what, datum)?;
        if !holds(value) {
            let problem = Diagnostic::error(format!("`{what}` is {}", written(value)));
            self.report(problem.why(format!("it must be {condition}")), span);
            return None;
        }
        Some(value)
    }

    /// A whole number from `least` to `most`, at most 2^53.
    pub fn whole(&mut self, what: &str, datum: Spanned<Datum>, least: u64, most: u64) -> Option<u64> {
        let condition = format!("a whole number from {least} to {most}");
        let holds = |value: f64| value.fract() == 0.0 && (least as f64..=most as f64).contains(&value);
        self.checked(what, datum, &condition, holds).map(|value| value as u64)
    }

    /// `N` numbers.
    pub fn numbers<const N: usize>(&mut self, what: &str, datum: Spanned<Datum>) -> Option<[f64; N]> {
        let list: [Spanned<Number>; N] = self.problems.numbers(what, datum)?;
        let values = list.map(|number| self.within(|context, numbers| numbers.number(context, &number)));
        let known: Option<Vec<f64>> = values.into_iter().collect();
        known?.try_into().ok()
    }

    /// A string.
    pub fn text(&mut self, what: &str, datum: Spanned<Datum>) -> Option<Spanned<String>> {
        self.problems.text(what, datum)
    }

    /// A boolean.
    pub fn boolean(&mut self, what: &str, datum: Spanned<Datum>) -> Option<bool> {
        self.problems.boolean(what, datum).map(|boolean| boolean.value)
    }

    /// One of several words.
    pub fn choice<T: Copy>(&mut self, what: &str, datum: Spanned<Datum>, choices: &[(T, &str)]) -> Option<T> {
        self.problems.choice(what, datum, choices).map(|choice| choice.value)
    }

    /// The product of a list of transforms, of which the first is applied first, in the syntax of the `transform` of a solid.
    pub fn transform(&mut self, datum: Spanned<Datum>) -> Option<Affine> {
        let before = self.problems.list.len();
        let steps = transform(&mut self.problems, datum);
        let maps = self.within(|context, numbers| product(context, numbers, &steps));
        maps.filter(|_| self.problems.list.len() == before)
    }

    /// True if a string is an arithmetic expression in the parameters of the document.
    pub fn is_arithmetic(&self, text: &str) -> bool {
        let is_known =
            |name: &str| self.document.parameters.iter().any(|parameter| parameter.name.value == name);
        Arithmetic::parse(text).is_ok_and(|arithmetic| arithmetic.names().all(|(name, _)| is_known(name)))
    }

    /// Returns the value, unless there were problems.
    ///
    /// # Errors
    ///
    /// All problems that were reported, in the order of the file.
    pub fn finish<T>(self, read: Option<T>) -> Result<T, Diagnostics> {
        match read {
            Some(read) if self.problems.list.is_empty() => Ok(read),
            _ => Err(Diagnostics::new(self.problems.list)),
        }
    }

    fn within<T>(&mut self, ask: impl FnOnce(&mut Context, &Numbers) -> T) -> T {
        let problems = std::mem::take(&mut self.problems.list);
        let mut context = Context::new(self.document, problems, &self.unreadable);
        let answer = ask(&mut context, &self.numbers);
        self.problems.list = context.problems;
        answer
    }
}
