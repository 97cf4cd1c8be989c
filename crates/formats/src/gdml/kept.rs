//! The elements in the table `[gdml]` of a document, read back for the writer.

use super::attributes::Numbers;
use super::context::Context;
use super::problem::Place;
use super::solids::{Sizes, primitive};
use super::stated::{rows, text};
use super::xml::{Attribute, Element, Name};
use rayweave_model::Solid;
use rayweave_scene::{Datum, Table, lookup};
use std::fmt::Write as _;

/// The solid of a row, as the reader makes it from the element.
pub(crate) fn solid(row: &Table) -> Option<Solid> {
    let mut context = Context::default();
    let element = Element {
        children: rows(row, "children").into_iter().map(element).collect::<Option<_>>()?,
        ..element(row)?
    };
    primitive(&mut Numbers::new(&mut context), &element, &mut Sizes::default()).ok()
}

fn element(row: &Table) -> Option<Element> {
    let place = Place::default();
    let attributes = attributes(row).map(|(name, value)| {
        Some(Attribute { name: Name::new(name), value: value?, place, verbatim: false })
    });
    let name = Name::new(text(row, "kind"));
    let attributes = attributes.collect::<Option<_>>()?;
    Some(Element { name, place, attributes, children: Vec::new(), content: None })
}

/// Names and texts of the attributes of a row.
fn attributes(row: &Table) -> impl Iterator<Item = (&str, Option<String>)> {
    let own = row.iter().filter(|(key, _)| !["name", "kind", "children"].contains(&key.value.as_str()));
    own.map(|(key, value)| {
        let value = match &value.value {
            Datum::Number(number) => Some(format!("{number:?}")),
            Datum::Text(text) => Some(text.clone()),
            _ => None,
        };
        (key.value.as_str(), value)
    })
}

/// The XML text of a row under a name, both with escapes.
pub(crate) fn written(row: &Table, name: &str, escaped: impl Fn(&str) -> String) -> String {
    let head = |row: &Table| {
        let mut head = escaped(text(row, "kind"));
        for (name, value) in attributes(row) {
            let _ = write!(head, " {}=\"{}\"", escaped(name), escaped(&value.unwrap_or_default()));
        }
        head
    };
    let own = head(row);
    let own = own.split_once(' ').unwrap_or((&own, ""));
    let opening = format!("    <{} name=\"{name}\" {}", own.0, own.1);
    if lookup(row, "children").is_none() {
        return opening + "/>\n";
    }
    let children: String =
        rows(row, "children").into_iter().map(|child| format!("      <{}/>\n", head(child))).collect();
    format!("{opening}>\n{children}    </{}>\n", own.0)
}
