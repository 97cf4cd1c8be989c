//! Models that were read, with reports of losses.

use crate::Report;
use rayweave_scene::{Document, Scene};
use std::collections::HashMap;

/// Positions of the optical elements of a GDML file, for messages about them.
#[derive(Clone, Debug, Default)]
pub struct Places {
    by_name: HashMap<(&'static str, String, String), String>,
}

impl Places {
    /// The position, as `file:line:column`, of an element (`material`, `surface`, `skin` or `border`) by name, or of one of its
    /// properties; an empty property means the element. `None` for elements that are in no file.
    pub fn find(&self, element: &'static str, name: &str, property: &str) -> Option<&str> {
        self.by_name.get(&(element, name.to_owned(), property.to_owned())).map(String::as_str)
    }

    /// Adds a position. Of several properties with the same name the last one counts, of several elements the first one.
    pub(crate) fn add(&mut self, element: &'static str, name: &str, property: &str, place: String) {
        let key = (element, name.to_owned(), property.to_owned());
        if property.is_empty() {
            self.by_name.entry(key).or_insert(place);
        } else {
            self.by_name.insert(key, place);
        }
    }
}

/// An imported model.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The document of the model, if the scene does not hold everything: that of a native file, or one with additional tables.
    pub stated: Option<Document>,
    /// The scene, ready for queries. Its warnings include those of the report.
    pub scene: Scene,
    /// Everything that was approximated, dropped or refused; empty for native files.
    pub report: Report,
    /// The positions of optical materials and surfaces in a GDML file; empty for other formats.
    pub places: Places,
}

impl Imported {
    /// Creates an import without a document, from the scene of another program's file and the losses.
    pub fn from_scene(mut scene: Scene, report: Report) -> Imported {
        scene.warnings = report.warnings();
        Imported { stated: None, scene, report, places: Places::default() }
    }

    /// A document of the model, for writing it as a native model file.
    pub fn document(&self) -> Document {
        self.stated.clone().unwrap_or_else(|| Document::from_scene(&self.scene))
    }
}
