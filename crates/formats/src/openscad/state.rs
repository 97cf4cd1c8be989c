//! State of the conversion of a dump.

use super::arguments::Arguments;
use super::budget::Budget;
use super::facets::Fineness;
use super::flat::{Flat, Flats};
use super::part::Part;
use super::shared::Shared;
use super::shell::Shell;
use super::syntax::Tree;
use super::text::Fonts;
use crate::{Options, Report};
use rayweave_math::Affine;
use rayweave_scene::{Diagnostic, Source};
use rayweave_table::AllowedFiles;
use std::cell::OnceCell;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// The tree of a dump, with the geometry of the nodes that were read.
pub(super) struct Reader<'a> {
    pub source: &'a Arc<Source>,
    pub options: &'a Options,
    /// The files that the dump may read.
    pub files: AllowedFiles,
    pub tree: &'a Tree,
    /// Nodes that take part in the model.
    pub live: Vec<bool>,
    /// Geometry of each node that was read and not yet used by its parent.
    pub parts: Vec<Part>,
    pub flats: Flats,
    /// Profile of each extrusion.
    pub extruded: HashMap<usize, Flat>,
    /// Nodes that have an ancestor that needs their shells.
    pub wanted: Vec<bool>,
    /// Shells of these nodes, if they cannot be derived from the arguments.
    pub shells: HashMap<usize, Vec<Shell>>,
    /// The facets of equal differences and intersections below such an ancestor.
    pub shared: OnceCell<Shared>,
    /// Scaling map of each `resize`.
    pub resized: HashMap<usize, Affine>,
    pub fonts: Fonts,
    pub budget: &'a Budget,
    pub report: Report,
    /// Problems that reject the dump as a whole.
    pub errors: Vec<Diagnostic>,
}

impl<'a> Reader<'a> {
    pub fn new(
        source: &'a Arc<Source>,
        options: &'a Options,
        tree: &'a Tree,
        budget: &'a Budget,
    ) -> Reader<'a> {
        Reader {
            source,
            options,
            files: AllowedFiles::of_model(source.path().map(PathBuf::as_path), &options.allow),
            tree,
            live: vec![true; tree.nodes.len()],
            parts: vec![Part::Empty; tree.nodes.len()],
            flats: Flats::new(options.facets),
            extruded: HashMap::new(),
            wanted: wanted(tree),
            shells: HashMap::new(),
            shared: OnceCell::new(),
            resized: HashMap::new(),
            fonts: Fonts::new(&options.fonts),
            budget,
            report: Report::default(),
            errors: Vec::new(),
        }
    }

    /// The facets of equal subtrees. The tree is divided on the first use.
    pub fn shared(&self) -> &Shared {
        self.shared.get_or_init(|| Shared::new(self.tree, &self.wanted))
    }

    /// True if the shells of a node need not be computed again.
    pub fn is_known(&self, number: usize) -> bool {
        self.shells.contains_key(&number) || self.shared.get().is_some_and(|shared| shared.is_known(number))
    }

    /// True if a round item has the facets of OpenSCAD: by the option, or because it has the few sides of a polygon.
    pub fn is_faceted(&self, arguments: &Arguments) -> bool {
        self.options.facets || Fineness::of(arguments).is_ok_and(|fineness| fineness.is_polygon())
    }

    /// The arguments of a node.
    pub fn arguments(&self, number: usize) -> Arguments<'a> {
        Arguments::new(self.source, &self.tree.nodes[number], self.budget)
    }
}

/// Marks the nodes that have an ancestor that needs their shells.
fn wanted(tree: &Tree) -> Vec<bool> {
    let mut wanted = vec![false; tree.nodes.len()];
    for (number, node) in tree.nodes.iter().enumerate() {
        let asks =
            wanted[number] || ["projection", "resize", "hull", "minkowski"].contains(&node.name.as_str());
        node.children.iter().for_each(|child| wanted[*child as usize] = asks);
    }
    wanted
}
