//! GDML, the Geometry Description Markup Language of Geant4.
//!
//! *Sources*: R. Chytracek, J. McCormick, W. Pokorski, G. Santin, "Geometry Description Markup Language for physics
//! simulation and analysis applications", IEEE Trans. Nucl. Sci. 53 (2006) 2892; the GDML User's Guide 2.7; Geant4's Book
//! For Application Developers, section 4.1, for the definitions of the solids.
//!
//! **Reading** is a single pass in file order, as in Geant4: `<define>` assigns names to numbers, each solid becomes a
//! [`rayweave_model::Solid`] in its own frame, exact if its surfaces are quadrics or tori, and each volume becomes a node
//! of a graph. References to volumes are resolved at the end.
//!
//! **The hierarchy** of logical and physical volumes becomes a list of regions, one per logical volume that the world
//! contains, regardless of the number of its placements. Mothers precede their daughters, and the later region has priority,
//! so that a daughter is cut out of its mother. A volume with many placements is one prototype with many maps, nested in
//! those of its mother: memory grows with the file, not with the number of copies. The world volume is the first region,
//! unless the writer of this crate added it around the regions of a scene. A daughter that protrudes from its mother is kept
//! whole; Geant4 leaves its meaning undefined.
//!
//! **Media** are the materials, with density (`density`, g/cm3), temperature (K), pressure (Pa) and, if there is a refractive
//! index, its value at the sodium D line (589.3 nm). All other data of a file are stored in the table `[gdml]` of the
//! document: the volume tree with the names of all placements, optical surfaces, property matrices and auxiliary tags.

mod attributes;
mod context;
mod define;
mod expression;
mod graph;
mod hierarchy;
pub(crate) mod kept;
mod links;
mod materials;
mod optical;
mod origin;
mod overrides;
mod problem;
mod schema;
mod shape;
mod solids;
mod source;
pub(crate) mod stated;
mod structure;
mod table;
mod units;
mod xml;

use crate::{Imported, Options, Places};
use context::Context;
use overrides::Overrides;
use rayweave_model::memory;
use rayweave_scene::{Diagnostic, Diagnostics, Foreign, Scene, Source};
use rayweave_table::AllowedFiles;
use std::path::PathBuf;
use std::sync::Arc;

pub(crate) use hierarchy::{NO_REGION, UNSPECIFIED};
pub(crate) use source::source;

/// Bytes of memory per byte of a file. Measured: for a file of placements, 15 for reading and compiling, and 19 for writing
/// it as a native file; for a file of solids whose elements are kept, 34 for reading.
const MEMORY_PER_BYTE: u64 = 36;

/// Reads the text of a GDML file. Names of included files are relative to its folder. `overrides` (name, expression) replace the
/// `value` of constants, variables, quantities and expressions; a quantity keeps its unit.
///
/// # Errors
///
/// A file too large for the available memory, or XML that is not well-formed; else all problems at once: references to undefined
/// solids and volumes, numbers that cannot be computed. Other undefined references are losses
/// ([`LossKind::Undefined`](crate::LossKind::Undefined)).
pub fn read(
    source: &Arc<Source>,
    overrides: &[(String, String)],
    options: &Options,
) -> Result<Imported, Diagnostics> {
    check_memory(source, memory::available())?;
    let mut context = Context { overrides: Overrides::new(overrides), ..Context::default() };
    context.files.allowed = AllowedFiles::of_model(source.path().map(PathBuf::as_path), &options.allow);
    match context.model(source) {
        Some((scene, table, places)) if context.problems.is_empty() => {
            let mut imported = Imported { places, ..Imported::from_scene(scene, context.report) };
            let warnings = imported.scene.warnings.iter().cloned().chain(context.warnings.finish());
            imported.scene.warnings = Diagnostics::new(warnings.collect());
            let mut document = imported.document();
            document.foreign.push(Foreign::new("gdml", table));
            imported.stated = Some(document);
            Ok(imported)
        }
        _ => Err(Diagnostics::new(context.problems.finish())),
    }
}

/// Rejects a file whose model would not fit into memory, before it is parsed.
fn check_memory(source: &Arc<Source>, available: Option<u64>) -> Result<(), Diagnostics> {
    let needed = MEMORY_PER_BYTE * source.text().len() as u64;
    match available {
        Some(available) if needed > available => {
            let mebibytes = |bytes: u64| bytes.div_ceil(1 << 20);
            let why = format!(
                "reading it may take {} MiB of memory, but only {} MiB are available",
                mebibytes(needed),
                mebibytes(available)
            );
            Err(Diagnostic::error("the file is too large").why(why).in_file(source).into())
        }
        _ => Ok(()),
    }
}

impl Context {
    /// The scene, the table `[gdml]` and the positions of its data; `None` after an error.
    fn model(&mut self, source: &Arc<Source>) -> Option<(Scene, rayweave_scene::Table, Places)> {
        let mut volumes = graph::Graph::default();
        self.open.extend(source.path().cloned());
        let world = structure::read_file(self, source.clone(), None, &mut volumes)?;
        links::check(self, &volumes);
        self.overrides.unknown().into_iter().for_each(|error| self.error_in_override(error));
        // after an error, some daughters may have no volume
        if !self.problems.is_empty() {
            return None;
        }
        let (scene, table) = hierarchy::scene(self, &volumes, world)?;
        Some((scene, table, self.places(&volumes)))
    }

    /// The positions of materials, optical surfaces and their attachments.
    fn places(&self, graph: &graph::Graph) -> Places {
        let mut places = Places::default();
        let mut add = |element, name: &str, property: &str, place| {
            let located = self.files.locate(Diagnostic::warning(""), place);
            let Some((line, column)) = located.line_column() else { return };
            let file = located.path().map_or(String::new(), |path| format!("{}:", path.display()));
            places.add(element, name, property, format!("{file}{line}:{column}"));
        };
        for material in &graph.materials.list {
            material.places.iter().for_each(|(name, place)| add("material", &material.name, name, *place));
        }
        for surface in &graph.surfaces.optical {
            surface.places.iter().for_each(|(name, place)| add("surface", &surface.name, name, *place));
        }
        for link in &graph.surfaces.links {
            add(if link.is_skin { "skin" } else { "border" }, &link.name, "", link.place);
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_too_large_for_memory_is_an_error() {
        let source = Arc::new(Source::new(None, " ".repeat(1 << 20)));
        assert!(check_memory(&source, Some(36 << 20)).is_ok() && check_memory(&source, None).is_ok());
        let text = check_memory(&source, Some((36 << 20) - 1)).unwrap_err().to_string();
        assert!(text.contains("36 MiB"), "{text}");
    }
}
