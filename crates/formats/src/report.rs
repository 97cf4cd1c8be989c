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
    /// A reference names nothing in the file: a material, an optical surface, the matrix of a property, or the volume or placement of
    /// an optical surface. The geometry is complete.
    Undefined,
    /// A part of the geometry is missing.
    Refused,
}

impl fmt::Display for LossKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            LossKind::Approximated => "approximated",
            LossKind::Dropped => "dropped",
            LossKind::Undefined => "undefined",
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

impl Loss {
    /// The first position, as `file:line:column` or, in a text without a file, `line:column`.
    #[must_use]
    pub fn place(&self) -> Option<String> {
        let (line, column) = self.first.line_column()?;
        let file = self.first.path().map_or(String::new(), |path| format!("{}:", path.display()));
        Some(format!("{file}{line}:{column}"))
    }
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

    /// The undefined references that the lint of optical properties does not find: it finds the placements of border surfaces.
    pub fn undefined(&self) -> impl Iterator<Item = &Loss> {
        self.iter().filter(|loss| {
            loss.kind == LossKind::Undefined && !loss.first.message().starts_with("unknown placement")
        })
    }

    /// The losses of the given kinds as errors, each with its first position.
    pub fn errors(&self, kinds: &[LossKind]) -> Diagnostics {
        let found = self.iter().filter(|loss| kinds.contains(&loss.kind));
        Diagnostics::new(found.map(|loss| loss.first.clone()).collect()).into_errors()
    }

    /// One warning per kind of loss, in file order: construct, reason, first position, count. Losses of one construct whose messages
    /// differ only by numbers are of one kind.
    pub fn warnings(&self) -> Diagnostics {
        let mut kinds: HashMap<(LossKind, &str, String), usize> = HashMap::new();
        let mut groups: Vec<Vec<&Loss>> = Vec::new();
        for loss in self.iter() {
            // the names of undefined items differ by their numbers
            let is_counted = |c: &char| loss.kind != LossKind::Undefined && (c.is_ascii_digit() || *c == '.');
            let message = loss.first.message().chars().filter(|c| !is_counted(c)).collect();
            let group = *kinds.entry((loss.kind, &loss.what, message)).or_insert(groups.len());
            match groups.get_mut(group) {
                Some(group) => group.push(loss),
                None => groups.push(vec![loss]),
            }
        }
        let warning = |group: &Vec<&Loss>| {
            let first = group.iter().min_by_key(|loss| loss.first.span()).map(|loss| loss.first.clone());
            let how = if group.len() > 1 { " with different numbers" } else { "" };
            match group.iter().map(|loss| loss.count).sum() {
                1 => first,
                count => first.map(|first| first.why(format!("it occurs {count} times{how}, first here"))),
            }
        };
        Diagnostics::new(groups.iter().filter_map(warning).collect())
    }
}

/// Extensions of files that are no models, with what to do about them.
const NO_MODELS: [(&[&str], &str); 5] = [
    (&["png", "jpg", "jpeg", "gif", "webp", "bmp", "tif", "tiff", "pdf"], ""),
    (&["svg", "dxf"], "its outlines can be extruded: `extrude` in a model file or in Python"),
    (
        &["step", "stp", "iges", "igs", "brep", "fcstd", "sldprt", "f3d", "blend", "fbx", "dae"],
        "export a mesh, such as .stl or .3mf, in the program that wrote it",
    ),
    (
        &["zmx"],
        "`rayweave info`, `rayweave optics` and `rayweave.optics.Prescription.read_zmx` read Zemax lens files; `rayweave convert LENS.zmx LENS.toml` makes a model of one",
    ),
    (&["csv", "npy", "npz", "parquet", "json", "root"], ""),
];

/// Returns an error for a file that is no model by its extension, and for an OpenSCAD source file (`.scad`), unless a format is
/// given explicitly.
pub(crate) fn refuse_program(
    source: &Arc<Source>,
    path: &Path,
    format: Option<Format>,
) -> Result<(), Diagnostics> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let ending = ending.as_deref().unwrap_or_default();
    if format.is_none() && NO_MODELS.iter().any(|(endings, _)| endings.contains(&ending)) {
        let all: Vec<String> = Format::NAMES
            .into_iter()
            .filter_map(Format::from_name)
            .flat_map(|format| format.extensions().iter().map(|ending| format!(".{ending}")))
            .collect();
        let (_, advice) =
            NO_MODELS.iter().find(|(endings, _)| endings.contains(&ending)).unwrap_or(&NO_MODELS[0]);
        let problem = Diagnostic::error(format!("a .{ending} file is not a model"))
            .why(format!("models are read from {}", all.join(", ")))
            .suggest((!advice.is_empty()).then(|| (*advice).to_owned()));
        return Err(Diagnostics::new(vec![problem.in_file(source)]));
    }
    if ending != "scad" || format.is_some() {
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
    fn files_that_are_no_models_are_named() {
        let source = Arc::new(Source::new(None, String::new()));
        let said = |name: &str, format| {
            refuse_program(&source, Path::new(name), format).map_err(|problems| problems.to_string())
        };
        for (name, advice) in [("a.PNG", ".png file"), ("b.step", "Export a mesh"), ("c.dxf", "extrude")] {
            let text = said(name, None).unwrap_err();
            assert!(text.contains("models are read from .toml, .csg, ") && text.contains(advice), "{text}");
        }
        assert!(said("a.png", Some(Format::Native)).is_ok() && said("model", None).is_ok());
    }

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
        let numbers = |report: &mut Report| {
            for k in 0..4 {
                report.add(LossKind::Approximated, "c", Diagnostic::warning(format!("c of {k}.5 mm")));
            }
        };
        let mut varied = Report::default();
        numbers(&mut varied);
        let text = varied.warnings().to_string();
        assert_eq!(text, "warning: c of 0.5 mm: it occurs 4 times with different numbers, first here.");
        let warnings = report.warnings();
        let messages: Vec<&str> = warnings.iter().map(|warning| warning.message()).collect();
        assert_eq!(
            messages,
            ["no a: it occurs 3 times, first here.", "rough a: it occurs 3 times, first here.", "no b"]
        );
    }
}
