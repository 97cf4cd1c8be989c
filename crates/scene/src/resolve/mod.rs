//! Evaluation of a document: from names and expressions to solids, regions, media and numbers.

mod context;
mod files;
mod numbers;
mod outline;
mod regions;
mod solids;
mod value;
mod view;

use crate::diagnostic::{Diagnostic, Diagnostics, Severity};
use crate::document::Document;
use crate::scene::Scene;
pub(crate) use context::Context;
pub use files::reason;
pub(crate) use numbers::Numbers;
pub(crate) use solids::Definitions;
use solids::Entries;
pub(crate) use solids::product;
use std::collections::HashSet;

/// Evaluates a document. Problems that are consequences of other problems are not reported.
///
/// `unreadable` are names in the file whose definitions are invalid: a reference to them is not a
/// new problem.
pub(crate) fn resolve(
    document: &Document,
    overrides: &[(String, String)],
    unreadable: &HashSet<String>,
    problems: Vec<Diagnostic>,
) -> Result<Scene, Diagnostics> {
    let names = document.solids.iter().map(|entry| entry.name.value.clone()).collect();
    let entries = Entries::Kept(&document.solids);
    evaluate(document, names, entries, overrides, unreadable, problems)
}

/// Evaluates a document whose solids are given as definitions, each of which is dropped once its solid is built. The document is
/// dropped too.
pub(crate) fn resolve_definitions(
    document: Document,
    definitions: Definitions,
    overrides: &[(String, String)],
    unreadable: &HashSet<String>,
    problems: Vec<Diagnostic>,
) -> Result<Scene, Diagnostics> {
    let (names, entries) = definitions.into_entries();
    evaluate(&document, names, entries, overrides, unreadable, problems)
}

fn evaluate(
    document: &Document,
    names: Vec<String>,
    entries: Entries<'_>,
    overrides: &[(String, String)],
    unreadable: &HashSet<String>,
    problems: Vec<Diagnostic>,
) -> Result<Scene, Diagnostics> {
    let mut context = Context::new(document, problems, unreadable);
    let mut numbers = Numbers::new(&mut context, overrides);
    let solids = solids::build(&mut context, &mut numbers, &names, entries);
    let (media, regions) = regions::build(&mut context, &mut numbers, &solids);
    let (camera, lights, render) = view::build(&mut context, &mut numbers);
    if context.problems.iter().any(|problem| problem.severity() == Severity::Error) {
        return Err(Diagnostics::new(context.problems));
    }
    // only after all expressions have been evaluated
    numbers.warn_unused(&mut context);
    // an optical model may consist of sheets alone
    if names.is_empty() && document.foreign("optics").is_none() {
        let problem = Diagnostic::warning("the model is empty")
            .why("it has no solid")
            .suggest(Some("define one, such as `[solid.ball]` with `sphere = { radius = 1 }`".to_owned()));
        context.problems.push(problem.in_file(&document.source));
    }
    let built = solids.built;
    let solids = names.into_iter().zip(built).filter_map(|(name, solid)| Some((name, solid?)));
    Ok(Scene {
        unit: document.unit.as_ref().map(|unit| unit.value).unwrap_or_default(),
        parameters: numbers.into_values(document),
        solids: solids.collect(),
        regions,
        media,
        camera,
        lights,
        render,
        warnings: Diagnostics::new(context.problems),
    })
}
