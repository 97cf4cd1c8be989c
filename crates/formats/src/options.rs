//! Options of readers.

use rayweave_scene::Unit;
use std::path::PathBuf;

/// Options for reading models of other programs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Facets instead of round shapes, divided as the original program divides them, so that results are comparable. By
    /// default round shapes are exactly round.
    pub facets: bool,
    /// Font files, and folders of font files, that are searched first for the fonts of texts.
    pub fonts: Vec<PathBuf>,
    /// Repair of meshes that are not closed or not consistently oriented, as far as that is safe.
    pub repair: bool,
    /// Files and folders that a model may read besides those in its folder and below. A model without a file may read files in
    /// the current folder and below.
    pub allow: Vec<PathBuf>,
    /// Whether warnings are errors.
    pub strict: bool,
    /// Unit of length for formats without units (STL, OBJ, PLY, OFF and OpenSCAD dumps); default: millimetres.
    pub unit: Option<Unit>,
    /// Whether the scene of a native file is enough. Its document is then dropped while the scene is made, which takes less
    /// memory.
    pub scene_only: bool,
}
