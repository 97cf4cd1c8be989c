//! The graph of volumes.

use super::materials::Materials;
use super::optical::Surfaces;
use super::problem::Place;
use super::solids::Shape;
use rayweave_math::Affine;
use rayweave_model::Solid;
use rayweave_scene::{Table, bare_name};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// All volumes of a file and of the files that it includes.
#[derive(Debug, Default)]
pub(super) struct Graph {
    pub volumes: Vec<Volume>,
    pub materials: Materials,
    pub surfaces: Surfaces,
    pub auxiliary: Vec<Auxiliary>,
    /// Rows of solids without a native twin, in file order.
    pub origins: Vec<Table>,
    /// Number of copies from replica volumes and divisions.
    pub copies: usize,
    /// Volumes of included files, by path and name.
    pub included: BTreeMap<(PathBuf, String), Option<usize>>,
}

/// A logical volume, or an assembly, which has no solid.
#[derive(Clone, Debug)]
pub(super) struct Volume {
    pub name: String,
    /// `None` for assemblies and for refused solids.
    pub shape: Option<Shape>,
    /// Index of the material.
    pub material: Option<usize>,
    pub daughters: Vec<Daughter>,
    /// Index of the volume that has the daughters: its own index, except for copies with different dimensions.
    pub content: usize,
    pub auxiliary: Vec<Auxiliary>,
    pub place: Place,
}

/// Placements (physical volumes) of a volume in its mother.
#[derive(Clone, Debug)]
pub(super) struct Daughter {
    pub name: String,
    pub volume: usize,
    /// Maps from the frame of the daughter to that of the mother, one per copy.
    pub maps: Vec<Affine>,
    /// Copy number of the first copy.
    pub copy: Option<i64>,
    pub place: Place,
}

/// An auxiliary tag, for user data.
#[derive(Clone, Debug)]
pub(super) struct Auxiliary {
    pub kind: String,
    pub value: String,
    pub unit: String,
    pub children: Vec<Auxiliary>,
}

impl Graph {
    /// Creates a graph of volumes without materials.
    pub fn of(volumes: Vec<Volume>) -> Graph {
        Graph { volumes, ..Graph::default() }
    }

    /// Daughters of a volume.
    pub fn daughters(&self, volume: usize) -> &[Daughter] {
        &self.volumes[self.volumes[volume].content].daughters
    }
}

impl Volume {
    /// The solid, if it has one.
    pub fn solid(&self) -> Option<&Solid> {
        self.shape.as_ref().map(|shape| &shape.solid)
    }

    /// The name without a pointer suffix.
    pub fn bare_name(&self) -> &str {
        bare_name(&self.name)
    }
}
