//! Import losses: constructs of a file that the scene does not represent exactly.

use crate::{Format, Options};
use rayweave_scene::{Diagnostic, Diagnostics, Source};
use std::collections::HashMap;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// Kinds of losses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LossKind {
    /// The scene holds an approximation.
    Approximated,
    /// Something other than geometry is missing.
    Dropped,
    /// A part of the geometry is missing.
    Refused,
}

impl fmt::Display for LossKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            LossKind::Approximated => "approximated",
            LossKind::Dropped => "dropped",
            LossKind::Refused => "refused",
        })
    }
}

/// A loss, counted over all occurrences that have the same reason.
#[derive(Clone, Debug)]
pub struct Loss {
    /// Kind of the loss.
    pub kind: LossKind,
    /// The construct as the format names it, such as `minkowski()` or `twistedbox`.
    pub what: String,
    /// Reason, with the first position in the file.
    pub first: Diagnostic,
    /// Number of occurrences.
    pub count: usize,
}

/// All losses, in order of occurrence.
#[derive(Clone, Debug, Default)]
pub struct Report {
    losses: Vec<Loss>,
    /// Index of each loss by kind, construct and message: the same construct may be lost for several reasons.
    known: HashMap<(LossKind, String, String), usize>,
}

impl Report {
    /// Adds a loss. `why` is a warning with its position; among equal messages the first position in the file is kept.
    pub fn add(&mut self, kind: LossKind, what: &str, why: Diagnostic) {
        let key = (kind, what.to_owned(), why.message().to_owned());
        let next = self.losses.len();
        let index = *self.known.entry(key).or_insert(next);
        match self.losses.get_mut(index) {
            Some(loss) => {
                loss.count += 1;
                if why.span() < loss.first.span() {
                    loss.first = why;
                }
            }
            None => self.losses.push(Loss { kind, what: what.to_owned(), first: why, count: 1 }),
        }
    }

    /// All losses.
    pub fn iter(&self) -> std::slice::Iter<'_, Loss> {
        self.losses.iter()
    }

    /// True if nothing was lost.
    pub fn is_empty(&self) -> bool {
        self.losses.is_empty()
    }

    /// Number of losses of a kind, counting repetitions.
    pub fn count(&self, kind: LossKind) -> usize {
        self.iter().filter(|loss| loss.kind == kind).map(|loss| loss.count).sum()
    }

    /// One warning per loss, in file order: construct, reason, first position, count.
    pub fn warnings(&self) -> Diagnostics {
        let warning = |loss: &Loss| match loss.count {
            1 => loss.first.clone(),
            count => loss.first.clone().why(format!("it occurs {count} times, first here")),
        };
        Diagnostics::new(self.iter().map(warning).collect())
    }
}

/// Returns an error for an OpenSCAD source file (`.scad`), unless a format is given explicitly.
pub(crate) fn refuse_program(
    source: &Arc<Source>,
    path: &Path,
    format: Option<Format>,
) -> Result<(), Diagnostics> {
    let is_program = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("scad"));
    if !is_program || format.is_some() {
        return Ok(());
    }
    let problem = Diagnostic::error("OpenSCAD source files are not read")
        .why("only CSG dumps are supported")
        .suggest(Some("create one with `openscad -o model.csg model.scad`".to_owned()));
    Err(Diagnostics::new(vec![problem.in_file(source)]))
}

/// Returns an error for each parameter override, in formats without parameters.
pub(crate) fn refuse_overrides(
    source: &Arc<Source>,
    format: Format,
    overrides: &[(String, String)],
) -> Result<(), Diagnostics> {
    let problem = |(name, _): &(String, String)| {
        Diagnostic::error(format!("the parameter `{name}` cannot be set"))
            .why(format!("files in the format {format} have no parameters"))
            .in_file(source)
    };
    match overrides.is_empty() {
        true => Ok(()),
        false => Err(Diagnostics::new(overrides.iter().map(problem).collect())),
    }
}

/// Returns an error if a unit is given for a file that has its own.
pub(crate) fn refuse_unit(
    source: &Arc<Source>,
    format: Format,
    options: &Options,
) -> Result<(), Diagnostics> {
    let Some(unit) = options.unit else {
        return Ok(());
    };
    let problem = Diagnostic::error(format!("the unit cannot be set to {unit}"));
    Err(problem.why(format!("files in the format {format} specify their unit")).in_file(source).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_losses_are_counted() {
        let mut report = Report::default();
        for _ in 0..3 {
            report.add(LossKind::Refused, "a", Diagnostic::warning("no a"));
            report.add(LossKind::Approximated, "a", Diagnostic::warning("rough a"));
        }
        report.add(LossKind::Refused, "b", Diagnostic::warning("no b"));
        let rows: Vec<_> = report.iter().map(|loss| (loss.kind, loss.what.as_str(), loss.count)).collect();
        let expected =
            [(LossKind::Refused, "a", 3), (LossKind::Approximated, "a", 3), (LossKind::Refused, "b", 1)];
        assert_eq!(rows, expected);
        assert_eq!(report.count(LossKind::Refused), 4);
        let warnings = report.warnings();
        let messages: Vec<&str> = warnings.iter().map(|warning| warning.message()).collect();
        assert_eq!(
            messages,
            ["no a: it occurs 3 times, first here.", "rough a: it occurs 3 times, first here.", "no b"]
        );
    }
}
