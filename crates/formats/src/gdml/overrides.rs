//! Numbers that the caller sets in place of the `value` of constants, variables, quantities and expressions.

use super::expression::{Fault, Names};
use rayweave_error::did_you_mean;
use rayweave_scene::{Diagnostic, Source, Span};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The number of names that a message lists.
const LISTED: usize = 20;

/// The overrides, with the names that the file defines.
#[derive(Debug, Default)]
pub struct Overrides {
    /// Names with their expressions.
    given: Vec<(String, String)>,
    /// The names of all definitions that can be overridden; empty without overrides.
    defined: BTreeSet<String>,
}

impl Overrides {
    pub fn new(given: &[(String, String)]) -> Overrides {
        Overrides { given: given.to_vec(), defined: BTreeSet::new() }
    }

    /// The value that replaces the `value` of a definition, if there is one. Its expression may use the names defined before.
    pub fn value(&mut self, name: &str, names: &Names) -> Option<Result<f64, Diagnostic>> {
        if self.given.is_empty() {
            return None;
        }
        self.defined.insert(name.to_owned());
        // of several values of one name the last one counts, as on the command line
        let (name, text) = self.given.iter().rev().find(|(own, _)| own == name)?;
        Some(names.evaluate(text).map_err(|fault| fault_in(name, text, fault, names)))
    }

    /// An error for each override that replaces nothing.
    pub fn unknown(&self) -> Vec<Diagnostic> {
        let unknown = self.given.iter().filter(|(name, _)| !self.defined.contains(name));
        let error = |(name, text): &(String, String)| {
            let listed: Vec<&str> = self.defined.iter().map(String::as_str).take(LISTED).collect();
            let more = match self.defined.len() - listed.len() {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            let reason = match listed.is_empty() {
                true => "the file defines no constant, variable or quantity".to_owned(),
                false => {
                    format!("the file's constants, variables and quantities are {}{more}", listed.join(", "))
                }
            };
            let near = did_you_mean(name, self.defined.iter().map(String::as_str));
            Diagnostic::error(format!("unknown parameter `{name}`"))
                .why(reason)
                .suggest(near.map(|near| format!("Did you mean `{near}`?")))
                .at(&source(name, text), Span::new(0, name.len()))
        };
        unknown.map(error).collect()
    }
}

/// The text of an override, for its problems.
fn source(name: &str, text: &str) -> Arc<Source> {
    Arc::new(Source::new(Some("<override>".into()), format!("{name}={text}")))
}

fn fault_in(name: &str, text: &str, fault: Fault, names: &Names) -> Diagnostic {
    let start = name.len() + 1;
    let span = Span::new(start + fault.span.start(), start + fault.span.end());
    let near = fault.unknown.as_ref().and_then(|unknown| did_you_mean(unknown, names.all()));
    Diagnostic::error(fault.problem)
        .suggest(near.map(|near| format!("Did you mean `{near}`?")))
        .at(&source(name, text), span)
}
