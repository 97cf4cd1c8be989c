//! The lint in progress: what it reads, and what it has found.

use super::contacts::Contacts;
use super::finding::LintFinding;
use crate::detector::Optics;
use crate::detector::properties::Owner;
use crate::energies::points;
use rayweave_error::Message;
use rayweave_math::Bounds;
use rayweave_scene::{Datum, Scene};

/// The lint in progress.
pub(super) struct Lint<'a> {
    pub scene: &'a Scene,
    pub table: &'a Datum,
    pub optics: &'a Optics,
    /// The box of each region.
    pub boxes: Vec<Bounds>,
    /// The contacts of regions, as far as lines have found them, in the direction of the light.
    pub contacts: Contacts,
    pub places: &'a dyn Fn(&'static str, &str, &str) -> Option<String>,
    pub findings: Vec<LintFinding>,
}

impl<'a> Lint<'a> {
    /// Adds a finding about a property of an element, or about the element itself (an empty property).
    pub fn find(&mut self, owner: &Owner, property: &str, message: Message) {
        let place = (self.places)(owner.element, &owner.name, property)
            .or_else(|| (self.places)(owner.element, &owner.name, ""));
        self.findings.push(LintFinding { place, is_unused: false, message });
    }

    pub fn find_unused(&mut self, owner: &Owner, property: &str, message: Message) {
        self.find(owner, property, message);
        self.findings.iter_mut().next_back().into_iter().for_each(|finding| finding.is_unused = true);
    }

    /// The rows of materials and optical surfaces with their owners.
    pub fn owners(&self) -> Vec<(Owner, &'a Datum)> {
        let rows = |element, list| {
            let owner = move |row: &'a Datum| (Owner::new(element, row.text("name")), row);
            self.table.list(list).map(owner)
        };
        rows("material", "material").chain(rows("surface", "surface")).collect()
    }

    /// The energies and values of a property: see [`points`].
    pub fn points(&self, property: &Datum) -> Vec<(f64, f64)> {
        points(self.table, property)
    }

    /// The value of a constant property.
    pub fn constant(&self, property: &Datum) -> Option<f64> {
        if let Some(number) = property.as_number() {
            return Some(number);
        }
        let matrix = self.table.list("matrix").find(|row| Some(row.text("name")) == property.as_text())?;
        let first = matrix.list("values").next().and_then(Datum::as_number);
        first.filter(|_| matrix.get("columns").and_then(Datum::as_number) == Some(1.0))
    }
}
