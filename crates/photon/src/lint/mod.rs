//! Lint of optical properties: probable mistakes in the GDML file of a detector.
//!
//! The rules compare the input with the magnitudes that light has, with the names and conventions of Geant4 11.4, and
//! volumes, surfaces and sensors with each other. A finding does not prove a mistake; each has its reason.

mod finding;
mod properties;
mod state;
mod surfaces;
mod values;
mod volumes;

pub use finding::LintFinding;

use crate::detector::{OpticalTable, Optics};
use crate::tables::SurfaceTables;
use rayweave_model::Program;
use rayweave_scene::{Document, Scene};
use state::Lint;

/// Checks the optical properties in the `[gdml]` or `[photons]` table of a document. `places` returns the place of an element (`material`,
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
    let Ok(own) = OpticalTable::of(scene, document) else { return Vec::new() };
    let table = own.table.as_ref();
    let has_properties = |list: &str| table.list(list).any(|row| row.get("properties").is_some());
    if !has_properties("material") && table.list("surface").next().is_none() {
        return Vec::new();
    }
    let optics = Optics::read(&own, scene, tables);
    let boxes = Program::compile_regions(&scene.model_regions()).map(|program| program.region_bounds());
    // a scene that does not compile has no sizes to compare with
    let boxes = boxes.unwrap_or_default();
    let mut lint = Lint { scene, table, optics: &optics, boxes, places, findings: Vec::new() };
    for problem in &optics.properties.problems {
        lint.find(&problem.owner, &problem.property, problem.message.clone());
    }
    lint.properties();
    lint.surfaces();
    lint.volumes();
    for note in &optics.properties.notes {
        if properties::successor(&note.property).is_none() {
            lint.find_unused(&note.owner, &note.property, note.message.clone());
        }
    }
    lint.findings
}
