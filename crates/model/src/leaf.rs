//! The leaves of a program: the view that evaluators read, and the compact tables behind it.

use crate::instances::Instances;
use crate::label::Label;
use crate::{LeafId, Place, PrototypeId, SurfaceId};
use rayweave_math::{Affine, Bounds};
use std::borrow::Cow;
use std::ops::Range;

/// One occurrence of a primitive or of a placed solid.
#[derive(Clone, Copy, Debug)]
pub struct Leaf<'p> {
    table: &'p LeafTable,
    number: usize,
}

/// The kind of a leaf.
#[derive(Clone, Debug, PartialEq)]
pub enum LeafKind {
    /// A conjunction of half-spaces of surfaces.
    Shape {
        /// The facets: a range of the program's facet table.
        facets: Range<u32>,
    },
    /// A placed solid, compiled in its own frame.
    Instance {
        /// The group.
        prototype: PrototypeId,
        /// The number of this placement, relative to that of the group that the leaf belongs to.
        placement: u32,
    },
}

/// A facet of a leaf: a surface and the side of it on which the leaf lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeafFacet(u32);

impl LeafFacet {
    /// The side of a surface where f < 0 if `inside`, else the other side.
    pub(crate) fn new(surface: SurfaceId, inside: bool) -> LeafFacet {
        LeafFacet(surface.0 << 1 | u32::from(inside))
    }

    /// The surface.
    #[inline]
    pub fn surface(self) -> SurfaceId {
        SurfaceId(self.0 >> 1)
    }

    /// True if the leaf lies where f < 0.
    #[inline]
    pub fn inside(self) -> bool {
        self.0 & 1 == 1
    }

    /// The same side of the surface with a number greater by `by`.
    fn shifted(self, by: u32) -> LeafFacet {
        LeafFacet(self.0 + (by << 1))
    }
}

impl<'p> Leaf<'p> {
    /// The number of the leaf.
    pub fn id(&self) -> LeafId {
        LeafId::from(self.number)
    }

    /// Whether it is a shape or an instance.
    #[inline]
    pub fn kind(&self) -> LeafKind {
        let entry = self.table.entries[self.number];
        if entry.of & INSTANCE == 0 {
            return LeafKind::Shape { facets: entry.first..self.table.facets_before(self.number + 1) };
        }
        let (run, k) = self.table.copy(entry, self.number);
        LeafKind::Instance { prototype: run.prototype, placement: run.placement(k) }
    }

    /// The facets; empty for an instance.
    #[inline]
    pub fn facets(&self) -> &'p [LeafFacet] {
        &self.table.facets[self.first_facet()..self.table.facets_before(self.number + 1) as usize]
    }

    /// The index of its first facet in the program's table.
    #[inline]
    pub(crate) fn first_facet(&self) -> usize {
        self.table.entries[self.number].first as usize
    }

    /// The map into the frame of an instance; the identity for a shape.
    #[inline]
    pub fn place(&self) -> Place {
        match self.instance() {
            Some((run, k)) => run.place(k),
            None => Place { local_from_world: Affine::IDENTITY, path: 0.0 },
        }
    }

    /// False if simplification found that the leaf affects no output.
    pub fn is_used(&self) -> bool {
        self.table.entries[self.number].of & UNUSED == 0
    }

    /// True if the leaf is the complement of the solid that its facets bound.
    pub fn is_complement(&self) -> bool {
        self.table.entries[self.number].of & COMPLEMENT != 0
    }

    /// The name given to the leaf, or its kind; for an instance with its number, e.g. `place[7]`.
    pub fn name(&self) -> Cow<'p, str> {
        match (self.label(), self.instance()) {
            (Some(label), _) => Cow::Borrowed(&label.name),
            (None, Some((run, k))) => Cow::Owned(format!("{}[{k}]", run.name)),
            (None, None) => Cow::Borrowed(""),
        }
    }

    /// The name of the primitive; `None` for an instance.
    pub fn shape_name(&self) -> Option<&'static str> {
        self.label().map(|label| label.kind)
    }

    /// The name of a shape: the one given to it, or its kind after the name of the compound around it.
    pub(crate) fn given_name(&self) -> Option<&'p str> {
        self.label().map(|label| &*label.name)
    }

    /// The name of a facet, e.g. `rim.side`.
    pub fn face_name(&self, facet: usize) -> String {
        self.label().map_or_else(String::new, |label| label.face_name(facet))
    }

    /// The number of the label of a shape.
    pub(crate) fn label_number(&self) -> u32 {
        self.table.entries[self.number].of & NUMBER
    }

    pub(crate) fn instance(&self) -> Option<(&'p Instances, usize)> {
        let entry = self.table.entries[self.number];
        (entry.of & INSTANCE != 0).then(|| self.table.copy(entry, self.number))
    }

    fn label(&self) -> Option<&'p Label> {
        let is_shape = self.table.entries[self.number].of & INSTANCE == 0;
        is_shape.then(|| &self.table.labels[self.label_number() as usize])
    }

    /// The box of a shape.
    pub(crate) fn shape_bounds(&self) -> Bounds {
        self.table.bounds[self.number - self.table.instances_before(self.number)]
    }
}

/// The leaves of a program, or of a group while it is compiled.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeafTable {
    entries: Vec<Entry>,
    /// A box that holds the conjunction of the facets, for each leaf that is a shape, in order.
    bounds: Vec<Bounds>,
    pub facets: Vec<LeafFacet>,
    pub instances: Vec<Instances>,
    /// The names of the shapes of all groups.
    pub labels: Vec<Label>,
}

/// The record of one leaf.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// The number of facets of all leaves before it.
    first: u32,
    /// The number of the label, or of the run of instances, and flag bits.
    of: u32,
}

/// Flag of an instance.
const INSTANCE: u32 = 1 << 31;
/// Flag of a leaf that affects no output.
const UNUSED: u32 = 1 << 30;
/// Flag of a shape that is the complement of the solid that its facets bound.
const COMPLEMENT: u32 = 1 << 29;
const NUMBER: u32 = COMPLEMENT - 1;

/// Greatest number of leaves that fits the ids of a program.
pub(crate) const MAX_LEAVES: usize = NUMBER as usize;

impl LeafTable {
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    #[inline]
    pub fn leaf(&self, number: usize) -> Leaf<'_> {
        Leaf { table: self, number }
    }

    /// The leaf that a facet belongs to.
    pub fn leaf_of_facet(&self, facet: usize) -> Leaf<'_> {
        // of leaves that share this `first`, all but the last have no facets; partition_point finds the last
        let end = self.entries.partition_point(|entry| entry.first as usize <= facet);
        self.leaf(end.saturating_sub(1))
    }

    fn facets_before(&self, number: usize) -> u32 {
        self.entries.get(number).map_or(self.facets.len() as u32, |entry| entry.first)
    }

    fn copy(&self, entry: Entry, number: usize) -> (&Instances, usize) {
        let run = &self.instances[(entry.of & NUMBER) as usize];
        (run, number - run.first_leaf as usize)
    }

    fn instances_before(&self, number: usize) -> usize {
        let runs = self.instances.partition_point(|run| run.first_leaf as usize <= number);
        let last = runs.checked_sub(1).map(|k| &self.instances[k]);
        last.map_or(0, |run| run.before as usize + run.len().min(number - run.first_leaf as usize))
    }

    /// Adds a shape. Its facets and its box are pushed after it.
    pub fn push_shape(&mut self, label: u32, complement: bool) {
        let mark = if complement { COMPLEMENT } else { 0 };
        self.entries.push(Entry { first: self.facets.len() as u32, of: label | mark });
    }

    /// Adds the box of the last leaf.
    pub fn push_bounds(&mut self, bounds: Bounds) {
        self.bounds.push(bounds);
    }

    /// Adds a leaf for each of the copies.
    pub fn push_instances(&mut self, instances: Instances) {
        let entry = Entry { first: self.facets.len() as u32, of: self.instances.len() as u32 | INSTANCE };
        self.entries.resize(self.entries.len() + instances.len(), entry);
        self.instances.push(instances);
    }

    /// The number of leaves that are instances.
    pub fn instance_count(&self) -> usize {
        self.len() - self.bounds.len()
    }

    /// Marks a leaf as one that affects no output.
    pub fn mark_unused(&mut self, number: usize) {
        self.entries[number].of |= UNUSED;
    }

    /// Appends the leaves of another table. `surfaces` is added to its surface numbers, and `label` maps its
    /// label numbers to new ones.
    pub fn append(&mut self, other: LeafTable, surfaces: u32, label: impl Fn(u32) -> u32) {
        let (leaves, before) = (self.len() as u32, self.instance_count() as u32);
        let (facets, runs) = (self.facets.len() as u32, self.instances.len() as u32);
        self.entries.extend(other.entries.into_iter().map(|entry| {
            let (marks, number) = (entry.of & !NUMBER, entry.of & NUMBER);
            let number = if marks & INSTANCE != 0 { number + runs } else { label(number) };
            Entry { first: entry.first + facets, of: marks | number }
        }));
        self.bounds.extend(other.bounds);
        self.facets.extend(other.facets.iter().map(|facet| facet.shifted(surfaces)));
        self.instances.extend(other.instances.into_iter().map(|mut run| {
            (run.first_leaf, run.before) = (run.first_leaf + leaves, run.before + before);
            run
        }));
    }

    pub fn shrink_to_fit(&mut self) {
        self.entries.shrink_to_fit();
        self.bounds.shrink_to_fit();
        self.facets.shrink_to_fit();
        self.instances.shrink_to_fit();
        self.labels.shrink_to_fit();
    }

    /// Sizes in bytes, by part.
    pub fn bytes(&self) -> [(&'static str, usize); 5] {
        let copies: usize = self.instances.iter().map(Instances::bytes).sum();
        [
            ("leaves", size_of_val(&self.entries[..])),
            ("boxes", size_of_val(&self.bounds[..])),
            ("facets", size_of_val(&self.facets[..])),
            ("copies", copies + size_of_val(&self.instances[..])),
            ("names", size_of_val(&self.labels[..])),
        ]
    }
}
