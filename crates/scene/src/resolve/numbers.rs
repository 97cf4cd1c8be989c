//! Evaluation of parameters and of arithmetic expressions.

use super::context::Context;
use crate::arithmetic::{Arithmetic, CONSTANTS, FUNCTIONS};
use crate::diagnostic::Diagnostic;
use crate::document::{Document, Matrix, Vector};
use crate::fault::Fault;
use crate::number::{Number, written};
use crate::source::{Source, Span, Spanned};
use crate::suggestion::did_you_mean;
use rayweave_math::Vec3;
use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The values of all parameters.
pub(crate) struct Numbers {
    /// `None` for an invalid parameter, whose problem has been reported.
    values: HashMap<String, Option<f64>>,
    used: RefCell<HashSet<String>>,
}

/// The definition of a parameter, as given.
struct Given {
    source: Arc<Source>,
    span: Span,
    text: String,
    arithmetic: Option<Arithmetic>,
}

impl Numbers {
    /// Creates the table from parameters with known values.
    pub fn known(parameters: &[(String, f64)]) -> Numbers {
        let values = parameters.iter().map(|(name, value)| (name.clone(), Some(*value)));
        Numbers { values: values.collect(), used: RefCell::default() }
    }

    /// Evaluates the parameters, with overrides of some of them.
    pub fn new(context: &mut Context, overrides: &[(String, String)]) -> Numbers {
        let mut numbers = Numbers { values: HashMap::new(), used: RefCell::new(HashSet::new()) };
        let overrides = numbers.known_overrides(context, overrides);
        let mut given = HashMap::new();
        let document = context.document;
        for parameter in &document.parameters {
            let name = &parameter.name.value;
            numbers.check_name(context, &parameter.name);
            match (overrides.get(name.as_str()), &parameter.value.value) {
                (Some(text), _) => drop(given.insert(name.as_str(), from_command_line(context, name, text))),
                (None, Number::Text(text)) => {
                    let span = parameter.value.span;
                    let one = Given::new(context, document.source.clone(), span, text);
                    given.insert(name.as_str(), one);
                }
                (None, Number::Value(value)) => drop(numbers.values.insert(name.clone(), Some(*value))),
            }
        }
        for parameter in &document.parameters {
            numbers.settle(context, &given, &parameter.name.value);
        }
        numbers
    }

    /// The overrides of parameters that exist; others are reported as unknown.
    fn known_overrides<'o>(
        &self,
        context: &mut Context,
        overrides: &'o [(String, String)],
    ) -> HashMap<&'o str, &'o str> {
        let document = context.document;
        let names = || document.parameters.iter().map(|parameter| parameter.name.value.as_str());
        let mut known = HashMap::new();
        for (name, text) in overrides {
            if names().any(|other| other == name) {
                known.insert(name.as_str(), text.as_str());
            } else if !context.is_unreadable(name) {
                let reason = match names().collect::<Vec<_>>().join(", ") {
                    none if none.is_empty() => "the file has no parameters".to_owned(),
                    names => format!("the file's parameters are {names}"),
                };
                let source = Arc::new(Source::new(Some("<override>".into()), format!("{name}={text}")));
                let problem = Diagnostic::error(format!("unknown parameter `{name}`")).why(reason);
                let problem =
                    problem.suggest(did_you_mean(name, names())).at(&source, Span::new(0, name.len()));
                context.problems.push(problem);
            }
        }
        known
    }

    fn check_name(&self, context: &mut Context, name: &Spanned<String>) {
        let constant = CONSTANTS.iter().any(|(constant, _)| *constant == name.value);
        if constant {
            let problem = Diagnostic::error(format!("no parameter can be called `{}`", name.value));
            context.push(problem.why("it is a constant of arithmetic expressions"), name.span);
        }
    }

    /// Evaluates a parameter after its dependencies, without recursion.
    fn settle(&mut self, context: &mut Context, given: &HashMap<&str, Given>, name: &str) {
        let mut path: Vec<&str> = Vec::new();
        let mut on_path: HashSet<&str> = HashSet::new();
        let mut waiting = match given.get_key_value(name) {
            Some((name, _)) => vec![*name],
            None => return,
        };
        while let Some(&name) = waiting.last() {
            if path.last() == Some(&name) {
                // its dependencies have now been evaluated
                path.pop();
                on_path.remove(name);
                waiting.pop();
                let value = self.compute(context, given, name);
                self.values.entry(name.to_owned()).or_insert(value);
                continue;
            }
            if self.values.contains_key(name) {
                waiting.pop();
                continue;
            }
            path.push(name);
            on_path.insert(name);
            let arithmetic = given[name].arithmetic.iter();
            for (other, span) in arithmetic.flat_map(Arithmetic::names) {
                match given.get_key_value(other) {
                    Some((other, _)) if on_path.contains(other) => {
                        self.report_cycle(context, &given[name], &path, other, span);
                    }
                    Some((other, _)) if !self.values.contains_key(*other) => waiting.push(other),
                    _ => {}
                }
            }
        }
    }

    fn report_cycle(&mut self, context: &mut Context, given: &Given, path: &[&str], name: &str, span: Span) {
        let start = path.iter().position(|other| *other == name).unwrap_or(0);
        for name in &path[start..] {
            self.values.insert((*name).to_owned(), None);
        }
        let cycle = cycle_text(&path[start..]);
        let fault = Fault::new(span, format!("the parameter `{name}` depends on itself"), cycle);
        context.problems.push(fault.located(&given.source, &given.text, given.span));
    }

    fn compute(&self, context: &mut Context, given: &HashMap<&str, Given>, name: &str) -> Option<f64> {
        let given = &given[name];
        self.evaluate(context, &given.source, given.arithmetic.as_ref()?, &given.text, given.span)
    }

    /// The value of an arithmetic expression; all unknown names are reported.
    fn evaluate(
        &self,
        context: &mut Context,
        source: &Arc<Source>,
        arithmetic: &Arithmetic,
        text: &str,
        span: Span,
    ) -> Option<f64> {
        let mut complete = true;
        for (name, part) in arithmetic.names() {
            self.used.borrow_mut().insert(name.to_owned());
            match self.values.get(name) {
                Some(Some(_)) => {}
                Some(None) => complete = false,
                None => {
                    complete = false;
                    if !context.is_unreadable(name) {
                        let fault = self.unknown(context.document, name, part);
                        context.problems.push(fault.located(source, text, span));
                    }
                }
            }
        }
        if !complete {
            return None;
        }
        let value = arithmetic.evaluate(|name| self.values.get(name).copied().flatten().unwrap_or(f64::NAN));
        value.map_err(|fault| context.problems.push(fault.located(source, text, span))).ok()
    }

    fn unknown(&self, document: &Document, name: &str, span: Span) -> Fault {
        let parameters = document.parameters.iter().map(|parameter| parameter.name.value.as_str());
        let constants = CONSTANTS.iter().map(|(name, _)| *name);
        let function = FUNCTIONS.iter().find(|function| function.name == name);
        let suggestion = match function {
            Some(function) => Some(format!("Did you mean `{}(..)`?", function.name)),
            None => did_you_mean(name, parameters.chain(constants)),
        };
        let reason = "it is not defined in [parameters]";
        Fault::new(span, format!("unknown parameter `{name}`"), reason).suggest(suggestion)
    }

    /// The value of a number; `None` if there was a problem, which has been reported.
    pub fn number(&self, context: &mut Context, number: &Spanned<Number>) -> Option<f64> {
        match &number.value {
            Number::Value(value) => Some(*value),
            Number::Text(text) => self.text(context, text, number.span),
        }
    }

    /// The value of an arithmetic expression.
    pub fn text(&self, context: &mut Context, text: &str, span: Span) -> Option<f64> {
        let source = context.document.source.clone();
        let arithmetic = parsed(context, &source, text, span)?;
        self.evaluate(context, &source, &arithmetic, text, span)
    }

    /// The parameters of an arithmetic expression with their values, such as `hole = -1, t = 5`; `None` without parameters.
    pub fn parameters_of(&self, text: &str) -> Option<String> {
        let arithmetic = Arithmetic::parse(text).ok()?;
        let mut found: Vec<String> = Vec::new();
        for (name, _) in arithmetic.names() {
            let is_constant = CONSTANTS.iter().any(|(constant, _)| *constant == name);
            let value = self.values.get(name).copied().flatten().filter(|_| !is_constant);
            let text = value.map(|value| format!("{name} = {}", written(value)));
            found.extend(text.filter(|text| !found.contains(text)));
        }
        (!found.is_empty()).then(|| found.join(", "))
    }

    /// The values of a vector, which must be finite.
    pub fn vector(&self, context: &mut Context, vector: &Vector) -> Option<Vec3> {
        let [x, y, z] = vector.each_ref().map(|number| self.finite(context, number));
        Some(Vec3::new(x?, y?, z?))
    }

    /// A finite number.
    pub fn finite(&self, context: &mut Context, number: &Spanned<Number>) -> Option<f64> {
        self.checked(context, "the number", number, "finite", f64::is_finite)
    }

    /// A number that satisfies a condition; messages call it `what`.
    pub fn checked(
        &self,
        context: &mut Context,
        what: &str,
        number: &Spanned<Number>,
        condition: &str,
        holds: impl Fn(f64) -> bool,
    ) -> Option<f64> {
        let value = self.number(context, number)?;
        if !holds(value) {
            let problem = Diagnostic::error(format!("{what} is {}", written(value)));
            let cause = match &number.value {
                Number::Text(text) => self.parameters_of(text),
                Number::Value(_) => None,
            };
            let cause = cause.map_or_else(String::new, |cause| format!(", and it is computed with {cause}"));
            context.push(problem.why(format!("it must be {condition}{cause}")), number.span);
            return None;
        }
        Some(value)
    }

    /// A whole number from `least` to `most`; messages call it `what`.
    pub fn whole(
        &self,
        context: &mut Context,
        what: &str,
        number: &Spanned<Number>,
        least: u32,
        most: u32,
    ) -> Option<u32> {
        let (lo, hi) = (f64::from(least), f64::from(most));
        let condition = format!("a whole number from {least} to {most}");
        let holds = |value: f64| value.fract() == 0.0 && (lo..=hi).contains(&value);
        self.checked(context, what, number, &condition, holds).map(|value| value as u32)
    }

    /// The values of a matrix.
    pub fn matrix(&self, context: &mut Context, matrix: &Matrix) -> Option<[[f64; 4]; 4]> {
        let mut values = [[0.0; 4]; 4];
        let mut complete = true;
        for (row, numbers) in values.iter_mut().zip(matrix) {
            for (value, number) in row.iter_mut().zip(numbers) {
                let found = self.finite(context, number);
                complete &= found.is_some();
                *value = found.unwrap_or_default();
            }
        }
        complete.then_some(values)
    }

    /// Warns about unused parameters.
    pub fn warn_unused(&self, context: &mut Context) {
        let used = self.used.borrow();
        for parameter in &context.document.parameters {
            let name = &parameter.name;
            // the syntax of the tables of other programs is unknown here, so any occurrence of the
            // name counts
            let foreign = context.document.foreign.iter().any(|table| table.text.contains(&name.value));
            if !used.contains(&name.value) && !foreign {
                let problem = Diagnostic::warning(format!("the parameter `{}` is not used", name.value));
                context.push(problem.why("nothing in the file refers to it"), name.span);
            }
        }
    }

    /// The parameters with their values, in the order of the file.
    pub fn into_values(self, document: &Document) -> Vec<(String, f64)> {
        let names = document.parameters.iter().map(|parameter| &parameter.name.value);
        names.filter_map(|name| Some((name.clone(), (*self.values.get(name)?)?))).collect()
    }
}

impl Given {
    fn new(context: &mut Context, source: Arc<Source>, span: Span, text: &str) -> Given {
        let arithmetic = parsed(context, &source, text, span);
        Given { source, span, text: text.to_owned(), arithmetic }
    }
}

fn from_command_line(context: &mut Context, name: &str, text: &str) -> Given {
    let source = Arc::new(Source::new(Some("<override>".into()), format!("{name}={text}")));
    let start = name.len() + 1;
    Given::new(context, source, Span::new(start, start + text.len()), text)
}

fn parsed(context: &mut Context, source: &Arc<Source>, text: &str, span: Span) -> Option<Arithmetic> {
    match Arithmetic::parse(text) {
        Ok(arithmetic) => Some(arithmetic),
        Err(faults) => {
            context.problems.extend(faults.into_iter().map(|fault| fault.located(source, text, span)));
            None
        }
    }
}

/// A cycle as `a -> b -> a`; a long one is shortened to its beginning and its end.
pub(super) fn cycle_text(names: &[&str]) -> String {
    const MAX_LISTED: usize = 10;
    let mut shown: Vec<&str> = match names.len() {
        n if n > MAX_LISTED => [&names[..MAX_LISTED - 1], &["..", names[n - 1]]].concat(),
        _ => names.to_vec(),
    };
    shown.push(names[0]);
    shown.join(" -> ")
}
