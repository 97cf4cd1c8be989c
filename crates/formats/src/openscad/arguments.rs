//! Arguments by name, with type checks.

use super::budget::{Budget, Exceeded};
use super::syntax::Node;
use super::value::{Argument, Value};
use rayweave_error::closest;
use rayweave_math::Vec3;
use rayweave_scene::{Diagnostic, Source};
use std::collections::HashSet;
use std::sync::Arc;

/// The reason why an item is refused.
pub(super) type Refusal = Box<Diagnostic>;

/// The arguments of an item. A missing or `undef` argument has its default.
#[derive(Clone, Copy)]
pub(super) struct Arguments<'a> {
    source: &'a Arc<Source>,
    node: &'a Node,
    budget: &'a Budget,
}

impl<'a> Arguments<'a> {
    pub fn new(source: &'a Arc<Source>, node: &'a Node, budget: &'a Budget) -> Arguments<'a> {
        Arguments { source, node, budget }
    }

    pub fn budget(&self) -> &'a Budget {
        self.budget
    }

    /// Counts steps of work on the item.
    pub fn spend(&self, steps: usize) -> Result<(), Refusal> {
        self.budget.spend(steps).map_err(|limit| self.exceeded(limit))
    }

    /// Counts points or triangles of the item, before they are made.
    pub fn hold(&self, items: usize) -> Result<(), Refusal> {
        self.budget.hold(items).map_err(|limit| self.exceeded(limit))
    }

    /// Converts an exceeded limit to a refusal of the item.
    pub fn limited<T>(&self, result: Result<T, Exceeded>) -> Result<T, Refusal> {
        result.map_err(|limit| self.exceeded(limit))
    }

    /// The error that this item exceeds the budget of the file.
    fn exceeded(&self, limit: Exceeded) -> Refusal {
        let problem = Diagnostic::error(format!("{}() exceeds the limits of the file", self.node.name));
        let advice = "Reduce `$fn`, the number of slices or the nesting".to_owned();
        let problem = problem.why(limit.reason()).suggest(Some(advice)).at(self.source, self.node.span);
        let refusal = Box::new(problem);
        self.budget.note(&refusal);
        refusal
    }

    /// A warning about the item as a whole, with the reason.
    pub fn refusal(&self, reason: &str) -> Refusal {
        let problem = Diagnostic::warning(format!("{}() is left out", self.node.name));
        Box::new(problem.why(reason).at(self.source, self.node.span))
    }

    /// An error: the dump is rejected as a whole.
    pub fn error(&self, reason: &str) -> Refusal {
        let problem = Diagnostic::error(format!("{}() cannot be read", self.node.name));
        Box::new(problem.why(reason).at(self.source, self.node.span))
    }

    /// A warning that the item was replaced by an approximation.
    pub fn approximation(&self, message: &str) -> Diagnostic {
        Diagnostic::warning(format!("{}() {message}", self.node.name)).at(self.source, self.node.span)
    }

    /// The argument with this name, or the unnamed one at its position.
    fn find(&self, name: &str) -> Option<&'a Argument> {
        let all = &self.node.arguments;
        let found = all.iter().find(|argument| argument.name == name).or_else(|| {
            let place = order(&self.node.name).iter().position(|other| *other == name)?;
            all.iter().filter(|argument| argument.name.is_empty()).nth(place)
        })?;
        (found.value != Value::Undefined).then_some(found)
    }

    fn wrong(&self, argument: &Argument, wanted: &str) -> Refusal {
        let problem = Diagnostic::warning(format!("{}() is left out", self.node.name));
        let name = if argument.name.is_empty() { "this argument" } else { &argument.name };
        let reason = format!("{name} must be {wanted}");
        Box::new(problem.why(reason).at(self.source, argument.span))
    }

    /// A value of some type, converted by the given function.
    pub fn get<T>(
        &self,
        name: &str,
        wanted: &str,
        read: impl FnOnce(&'a Value) -> Option<T>,
    ) -> Result<Option<T>, Refusal> {
        match self.find(name) {
            None => Ok(None),
            Some(argument) => read(&argument.value).map(Some).ok_or_else(|| self.wrong(argument, wanted)),
        }
    }

    /// A finite number.
    pub fn number(&self, name: &str, default: f64) -> Result<f64, Refusal> {
        let finite = |value: &Value| value.number().filter(|number| number.is_finite());
        Ok(self.get(name, "a finite number", finite)?.unwrap_or(default))
    }

    /// `true` or `false`; a number is true unless it is 0.
    pub fn boolean(&self, name: &str, default: bool) -> Result<bool, Refusal> {
        let boolean = |value: &Value| match value {
            Value::Boolean(boolean) => Some(*boolean),
            Value::Number(number) => Some(*number != 0.0),
            _ => None,
        };
        Ok(self.get(name, "true or false", boolean)?.unwrap_or(default))
    }

    /// N finite numbers, or one number repeated N times.
    pub fn point<const N: usize>(&self, name: &str, default: f64) -> Result<[f64; N], Refusal> {
        let point = |value: &Value| match value {
            Value::Number(number) => number.is_finite().then_some([*number; N]),
            other => finite(other),
        };
        let wanted = format!("a finite number, or {N} of them");
        Ok(self.get(name, &wanted, point)?.unwrap_or([default; N]))
    }
}

impl Arguments<'_> {
    /// A warning for each argument that is not read: with an unknown name, given twice, or with an excess position.
    pub fn unused(&self) -> Vec<Diagnostic> {
        let Some(known) = parameters(&self.node.name) else { return Vec::new() };
        let names = || known.iter().copied().chain(order(&self.node.name).iter().copied()).chain(ANYWHERE);
        let mut warnings = Vec::new();
        let mut seen: HashSet<&str> = HashSet::new();
        let mut places = order(&self.node.name).len();
        for argument in &self.node.arguments {
            let name = argument.name.as_str();
            let ignored = |what: String, why: String| {
                let problem = Diagnostic::warning(format!("{what} of {}() is ignored", self.node.name));
                problem.why(why).at(self.source, argument.span)
            };
            if name.is_empty() {
                match places.checked_sub(1) {
                    Some(rest) => places = rest,
                    None => warnings.push(ignored(
                        "an argument".to_owned(),
                        format!("at most {} of its arguments may be unnamed", order(&self.node.name).len()),
                    )),
                }
            } else if !names().any(|known| known == name) {
                let why = format!("it has no parameter `{name}`");
                // most names are short, so one edit is always allowed
                let edits = |known: &str| (name.len().max(known.len()) / 3).max(1);
                let meant = closest(name, names(), edits).first().copied();
                let meant = meant.map(|meant| format!("Did you mean `{meant}`?"));
                let meant = source_radius(&self.node.name, name).map(str::to_owned).or(meant);
                warnings.push(ignored(format!("the argument `{name}`"), why).suggest(meant));
            } else if !seen.insert(name) {
                warnings.push(ignored(format!("the second `{name}`"), "the first one counts".to_owned()));
            }
        }
        warnings
    }
}

/// A list of N finite numbers.
pub(super) fn finite<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let numbers = value.numbers()?;
    let all = <[f64; N]>::try_from(numbers).ok()?;
    all.iter().all(|number| number.is_finite()).then_some(all)
}

/// A vector of three finite numbers.
pub(super) fn vector(value: &Value) -> Option<Vec3> {
    finite::<3>(value).map(Vec3::from_array)
}

/// Advice for a radius or diameter that OpenSCAD accepts in a program and replaces in a dump.
fn source_radius(item: &str, parameter: &str) -> Option<&'static str> {
    Some(match (item, parameter) {
        ("cylinder", "r") => "Did you mean `r1` and `r2`?",
        ("cylinder", "d" | "d1" | "d2") => "Did you mean `r1` and `r2`, half of the diameters?",
        ("sphere" | "circle", "d") => "Did you mean `r`, half of the diameter?",
        _ => return None,
    })
}

/// Parameters that every item accepts, whether or not it is round.
const ANYWHERE: [&str; 4] = ["$fn", "$fa", "$fs", "convexity"];

/// Names of the other parameters of an item, apart from those that may be given by position; `None` for unknown items.
fn parameters(item: &str) -> Option<&'static [&'static str]> {
    Some(match item {
        "group" | "union" | "render" | "difference" | "intersection" | "hull" | "minkowski" => &[],
        "multmatrix" | "color" | "cube" | "square" | "sphere" | "circle" | "cylinder" => &[],
        "polygon" | "resize" => &[],
        "polyhedron" => &["triangles"],
        "text" => &["text", "size", "font", "spacing", "direction", "language", "script", "halign", "valign"],
        "linear_extrude" => {
            &["height", "center", "twist", "slices", "scale", "file", "layer", "origin", "timestamp"]
        }
        "rotate_extrude" => &["angle", "start", "file", "layer", "origin", "scale", "timestamp"],
        "offset" => &["r", "delta", "chamfer"],
        "import" => &["file", "layer", "origin", "scale", "center", "dpi", "timestamp"],
        "surface" => &["file", "center", "invert", "timestamp"],
        "projection" => &["cut"],
        _ => return None,
    })
}

/// Names of the arguments that may be given by position. OpenSCAD itself omits the names of two items only.
fn order(item: &str) -> &'static [&'static str] {
    match item {
        "multmatrix" => &["m"],
        "color" => &["c"],
        "cube" | "square" => &["size", "center"],
        "sphere" | "circle" => &["r"],
        "cylinder" => &["h", "r1", "r2", "center"],
        "polygon" => &["points", "paths"],
        "polyhedron" => &["points", "faces"],
        "resize" => &["newsize", "auto"],
        _ => &[],
    }
}
