//! Options of readers.

use rayweave_scene::Unit;
use std::path::PathBuf;

/// Options for reading models of other programs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Facets instead of round shapes, divided as in the original program, so that results are comparable. By default, round
    /// shapes are exactly round.
    pub facets: bool,
    /// Font files, and folders of font files, that are searched first for the fonts of texts.
    pub fonts: Vec<PathBuf>,
    /// Repair of meshes that are not closed or not consistently oriented, as far as that is safe.
    pub repair: bool,
    /// Additional files and folders that a model may read; it may always read those in its folder and below. For a model without
    /// a file, this is the current folder.
    pub allow: Vec<PathBuf>,
    /// Whether warnings count as errors.
    pub strict: bool,
    /// Unit of length for formats without units (STL, OBJ, PLY, OFF and OpenSCAD dumps); default: millimetres.
    pub unit: Option<Unit>,
    /// Whether only the scene of a native file is needed. Its document is then dropped while the scene is built, to save
    /// memory.
    pub scene_only: bool,
}
