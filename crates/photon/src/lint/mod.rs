//! Lint of optical properties: probable mistakes in the GDML file of a detector.
//!
//! The rules compare the input with the magnitudes that light has, with the names and conventions of Geant4 11.4, and
//! volumes, surfaces and sensors with each other. A finding does not prove a mistake; each has its reason.

mod contacts;
mod covered;
mod finding;
mod properties;
mod sensors;
mod state;
mod surfaces;
mod values;
mod volumes;

pub use finding::LintFinding;

use crate::detector::former_names::successor;
use crate::detector::{OpticalTable, Optics, regions};
use crate::tables::SurfaceTables;
use contacts::contacts;
use rayweave_model::{Evaluator, Program};
use rayweave_scene::{Document, Scene};
use state::Lint;
use std::sync::Arc;

/// Checks the optical properties in the `[gdml]` or `[photons]` table of a document. `places` returns the place of an element (`material`,
/// `surface`, `skin` or `border`) by name, or of one of its properties; an empty property means the element.
///
/// `evaluator` makes an evaluator of a program, which finds volumes that touch: random lines in the boxes of the volumes, 65,536
/// in all or at least 256 for each of up to 4,096 volumes, and fewer for each of more volumes. A contact that is a small part of the
/// box of both volumes may be missed; a daughter counts as touching its mother in any case.
///
/// The findings are in the order of the rules; none if the model has no such table, or no optical property.
#[must_use]
pub fn lint<E: Evaluator>(
    scene: &Scene,
    document: &Document,
    tables: &SurfaceTables,
    evaluator: impl FnOnce(Arc<Program>) -> E,
    places: &dyn Fn(&'static str, &str, &str) -> Option<String>,
) -> Vec<LintFinding> {
    let Ok(own) = OpticalTable::of(scene, document) else { return Vec::new() };
    let table = own.table.as_ref();
    let has_properties = |list: &str| table.list(list).any(|row| row.get("properties").is_some());
    if !has_properties("material") && table.list("surface").next().is_none() {
        return Vec::new();
    }
    let optics = Optics::read(&own, scene, tables);
    // a scene that does not compile has neither sizes nor contacts
    let program = Program::compile_regions(&regions(scene)).map(Arc::new).ok();
    let boxes = program.as_ref().map(|program| program.region_bounds()).unwrap_or_default();
    let contacts = program.map(|program| {
        let surface = |crossing: &_| optics.boundaries.find(&program, crossing);
        contacts(&evaluator(program.clone()), &boxes, surface)
    });
    let contacts = contacts.unwrap_or_default();
    let mut lint = Lint { scene, table, optics: &optics, boxes, contacts, places, findings: Vec::new() };
    for problem in &optics.properties.problems {
        // a rule about magnitudes explains what is wrong with the value
        if lint.implausible(&problem.owner, &problem.property).is_some() {
            continue;
        }
        lint.find(&problem.owner, &problem.property, problem.message.clone());
    }
    lint.properties();
    lint.surfaces();
    lint.volumes();
    for note in &optics.properties.notes {
        match () {
            () if note.is_mistake() => lint.find(&note.owner, &note.property, note.message.clone()),
            () if successor(&note.property).is_some() => {}
            () => lint.find_unused(&note.owner, &note.property, note.message.clone()),
        }
    }
    lint.findings
}
