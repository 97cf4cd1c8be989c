//! Models that were read, with reports of losses.

use crate::Report;
use rayweave_scene::{Document, Scene};

/// An imported model.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The document of the model where the scene does not hold everything: a native file, or tables beside the scene.
    pub stated: Option<Document>,
    /// The scene, ready for queries. Its warnings include those of the report.
    pub scene: Scene,
    /// Everything that was approximated, dropped or refused; empty for native files.
    pub report: Report,
}

impl Imported {
    /// An import without a document: a scene made from another program's file, and the losses.
    pub fn from_scene(mut scene: Scene, report: Report) -> Imported {
        scene.warnings = report.warnings();
        Imported { stated: None, scene, report }
    }

    /// A document of the model, for writing it as a native model file.
    pub fn document(&self) -> Document {
        self.stated.clone().unwrap_or_else(|| Document::from_scene(&self.scene))
    }
}
