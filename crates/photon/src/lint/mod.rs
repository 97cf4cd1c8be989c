//! Lint of optical properties: probable mistakes in the GDML file of a detector.
//!
//! The rules compare the input with the magnitudes that light has, with the names and conventions of Geant4 11.4, and
//! volumes, surfaces and sensors with each other. A finding is no proof of a mistake; each has its reason.

mod properties;
mod surfaces;
mod values;
mod volumes;

use crate::detector::properties::Owner;
use crate::detector::{Optics, foreign};
use crate::tables::SurfaceTables;
use rayweave_error::Message;
use rayweave_math::Bounds;
use rayweave_model::Program;
use rayweave_scene::{Datum, Document, Scene};
use std::fmt;

/// A probable mistake in the optical part of a detector.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LintFinding {
    /// The place of the element or property, as `file:line:column`, if it is known.
    pub place: Option<String>,
    /// True for input without an effect: no process uses it.
    pub is_unused: bool,
    /// The problem, its reason and a suggestion.
    pub message: Message,
}

impl fmt::Display for LintFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => self.message.fmt(f),
        }
    }
}

/// Checks the optical properties in the `[gdml]` table of a document. `places` returns the place of an element (`material`,
/// `surface`, `skin` or `border`) by name, or of one of its properties; an empty property means the element.
///
/// The findings are in the order of the rules; none if the model has no such table, or no optical property.
#[must_use]
pub fn lint(
    scene: &Scene,
    document: &Document,
    tables: &SurfaceTables,
    places: &dyn Fn(&'static str, &str, &str) -> Option<String>,
) -> Vec<LintFinding> {
    let Some(table) = foreign(document) else { return Vec::new() };
    let has_properties = |list: &str| table.list(list).any(|row| row.get("properties").is_some());
    if !has_properties("material") && table.list("surface").next().is_none() {
        return Vec::new();
    }
    let optics = Optics::read(table, scene, tables);
    let boxes = Program::compile_regions(&scene.model_regions()).map(|program| program.region_bounds());
    // a scene that does not compile has no sizes to compare with
    let boxes = boxes.unwrap_or_default();
    let mut lint = Lint { scene, table, optics: &optics, boxes, places, findings: Vec::new() };
    for (owner, property, problem) in &optics.properties.problems {
        lint.find(owner, property, problem.clone());
    }
    lint.properties();
    lint.surfaces();
    lint.volumes();
    for (owner, property, note) in &optics.properties.notes {
        if properties::successor(property).is_none() {
            lint.find_unused(owner, property, note.clone());
        }
    }
    lint.findings
}

/// The lint in progress.
struct Lint<'a> {
    scene: &'a Scene,
    table: &'a Datum,
    optics: &'a Optics,
    /// The box of each region.
    boxes: Vec<Bounds>,
    places: &'a dyn Fn(&'static str, &str, &str) -> Option<String>,
    findings: Vec<LintFinding>,
}

impl<'a> Lint<'a> {
    /// Adds a finding about a property of an element, or about the element itself (an empty property).
    fn find(&mut self, owner: &Owner, property: &str, message: Message) {
        let place = (self.places)(owner.element, &owner.name, property)
            .or_else(|| (self.places)(owner.element, &owner.name, ""));
        self.findings.push(LintFinding { place, is_unused: false, message });
    }

    fn find_unused(&mut self, owner: &Owner, property: &str, message: Message) {
        self.find(owner, property, message);
        self.findings.iter_mut().next_back().into_iter().for_each(|finding| finding.is_unused = true);
    }

    /// The rows of materials and optical surfaces with their owners.
    fn owners(&self) -> Vec<(Owner, &'a Datum)> {
        let rows = |element, list| {
            let owner = move |row: &'a Datum| (Owner::new(element, row.text("name")), row);
            self.table.list(list).map(owner)
        };
        rows("material", "material").chain(rows("surface", "surface")).collect()
    }

    /// The energies and values of a property, in the order of the file; none if its matrix has not two columns.
    fn points(&self, property: &Datum) -> Vec<(f64, f64)> {
        let Some(name) = property.as_text() else { return Vec::new() };
        let matrix = self.table.list("matrix").find(|row| row.text("name") == name);
        let matrix = matrix.filter(|row| row.get("columns").and_then(Datum::as_number) == Some(2.0));
        let values: Vec<f64> =
            matrix.into_iter().flat_map(|row| row.list("values")).filter_map(Datum::as_number).collect();
        values.as_chunks::<2>().0.iter().map(|[energy, value]| (*energy, *value)).collect()
    }

    /// The value of a constant property.
    fn constant(&self, property: &Datum) -> Option<f64> {
        if let Some(number) = property.as_number() {
            return Some(number);
        }
        let matrix = self.table.list("matrix").find(|row| Some(row.text("name")) == property.as_text())?;
        let first = matrix.list("values").next().and_then(Datum::as_number);
        first.filter(|_| matrix.get("columns").and_then(Datum::as_number) == Some(1.0))
    }
}
