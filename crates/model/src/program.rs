//! The compiled model: flat, immutable, read by every evaluator.

use crate::boxes::{Boxes, Extent};
use crate::gate::Network;
use crate::instances::Instances;
use crate::leaf::LeafTable;
use crate::simplify::{self, leaf_needs};
use crate::trail::Trail;
use crate::{
    Ball, Expression, Face, Leaf, LeafFacet, LeafId, Place, PlacementId, PrototypeId, RegionId, SurfaceId,
};
use rayweave_math::{Affine, Bounds, UNIT_ROUNDOFF};
use rayweave_shape::surface::Surface;
use std::ops::Range;

/// A compiled model.
///
/// Shared by reference among any number of threads and evaluators. It never changes after
/// [`Program::compile`], and its methods do not fail.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) prototypes: Vec<Prototype>,
    pub(crate) surfaces: Vec<SurfaceEntry>,
    pub(crate) leaves: LeafTable,
    pub(crate) regions: Vec<RegionInfo>,
    /// The names around the leaves, group by group.
    pub(crate) trails: Vec<Trail>,
}

/// A group of leaves compiled in one frame: the model itself, or a solid that is placed many times.
#[derive(Clone, Debug)]
pub struct Prototype {
    /// The leaves of this group: a range of the program's leaf table, in the order of declaration.
    pub leaves: std::ops::Range<u32>,
    /// The boolean network over the group's leaves, with one output per region for the model, one for a
    /// placed solid.
    pub network: Network,
    /// The expression that `network` computes, as a list of gates.
    pub expression: Expression,
    /// A box that holds the solid (of the model: all regions).
    pub bounds: Bounds,
    /// The ball whose chords decide whether a ray lies in a surface.
    pub ball: Ball,
    /// Upper bound of the factor by which a rounding error in this group's frame grows on the way into a
    /// placed solid and back, at least 1. A ray's own lengths, times [`MARGIN`] and this factor, grow boxes.
    pub condition: f64,
    /// The number of placements in one occurrence of the group, itself included.
    pub placements: u32,
    /// Bounds and error factors for the groups that place this one.
    pub(crate) extent: Extent,
    /// The runs of instances among the leaves: a range of the program's list.
    pub(crate) instances: std::ops::Range<u32>,
}

/// Boxes are grown by this factor times the lengths involved.
pub const MARGIN: f64 = 256.0 * UNIT_ROUNDOFF;

/// A surface in the frame of its group.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceEntry {
    /// The surface, in canonical form.
    pub surface: Surface,
    /// The size and position of the surface plus the lengths of all translations composed into its map.
    pub magnitude: f64,
}

/// A region of the model, or the solid that was compiled.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionInfo {
    /// The name of the region.
    pub name: String,
    /// The number of its medium; 0 is the medium of the world.
    pub medium: Medium,
}

/// The number of a medium; 0 is the medium of the world.
pub type Medium = u32;

impl Program {
    /// The groups; the first is the model itself.
    pub fn prototypes(&self) -> &[Prototype] {
        &self.prototypes
    }

    /// A group by its number.
    pub fn prototype(&self, id: PrototypeId) -> &Prototype {
        &self.prototypes[id.index()]
    }

    /// All surfaces, group by group.
    pub fn surfaces(&self) -> &[SurfaceEntry] {
        &self.surfaces
    }

    /// A surface by its number.
    pub fn surface(&self, id: SurfaceId) -> &SurfaceEntry {
        &self.surfaces[id.index()]
    }

    /// All leaves, group by group in the order of declaration.
    pub fn leaves(&self) -> impl DoubleEndedIterator<Item = Leaf<'_>> + ExactSizeIterator {
        (0..self.leaves.len()).map(|k| self.leaves.leaf(k))
    }

    /// A leaf by its number.
    #[inline]
    pub fn leaf(&self, id: LeafId) -> Leaf<'_> {
        self.leaves.leaf(id.index())
    }

    /// For each leaf of a group the part of its grown box where the leaf can affect an output of the group;
    /// empty if there is none.
    ///
    /// Computed on each call, in time linear in the size of the group.
    pub fn matters(&self, group: &Prototype) -> Vec<Bounds> {
        let inner = |id: PrototypeId| self.prototype(id).extent;
        let boxes = Boxes { leaves: &self.leaves, surfaces: &self.surfaces, inner };
        let grown: Vec<Bounds> =
            group.leaves.clone().map(|leaf| boxes.grown(leaf as usize, &group.ball).0).collect();
        let formula = group.expression.formula();
        leaf_needs(&formula, &simplify::bounds(&formula, &grown), grown.len())
    }

    /// A box for each region that holds it up to rounding, without regard to the priority of later regions.
    /// Infinite if no bound is known.
    ///
    /// Computed on each call, in time linear in the size of the model.
    pub fn region_bounds(&self) -> Vec<Bounds> {
        let group = self.prototype(PrototypeId(0));
        let inner = |id: PrototypeId| self.prototype(id).extent;
        let boxes = Boxes { leaves: &self.leaves, surfaces: &self.surfaces, inner };
        let leaves: Vec<Bounds> = group.leaves.clone().map(|leaf| boxes.bounds(leaf as usize)).collect();
        let formula = group.expression.formula();
        let nodes = simplify::bounds(&formula, &leaves);
        let outputs = formula.outputs().iter();
        outputs.map(|&edge| simplify::Beyond::of(edge, &nodes).bounds()).collect()
    }

    /// Transforms a box from the frame of the solid placed as leaf `id` to the frame of the group, and grows
    /// it by the margin of that leaf. For a leaf that is a shape it returns the box unchanged.
    pub fn placed_bounds(&self, group: &Prototype, id: LeafId, inner: &Bounds) -> Bounds {
        let Some((run, k)) = self.leaf(id).instance() else { return *inner };
        let extent = |id: PrototypeId| self.prototype(id).extent;
        let boxes = Boxes { leaves: &self.leaves, surfaces: &self.surfaces, inner: extent };
        let (_, margin) = boxes.grown(id.index(), &group.ball);
        inner.transformed(&run.world_from_local(k)).grown(margin)
    }

    /// A box, in the frame of its group, that holds the conjunction of the facets of a leaf.
    pub fn leaf_bounds(&self, id: LeafId) -> Bounds {
        let inner = |id: PrototypeId| self.prototype(id).extent;
        Boxes { leaves: &self.leaves, surfaces: &self.surfaces, inner }.bounds(id.index())
    }

    /// All facets, leaf by leaf: the faces that crossings refer to by number.
    #[inline]
    pub fn facets(&self) -> &[LeafFacet] {
        &self.leaves.facets
    }

    /// The number of a face in [`Program::facets`], from its leaf and its facet number there.
    pub fn face_number(&self, leaf: LeafId, facet: u32) -> u32 {
        self.leaf(leaf).first_facet() as u32 + facet
    }

    /// The name of a face by its number in [`Program::facets`], e.g. `rim.side`.
    pub fn face_name(&self, face: u32) -> String {
        let leaf = self.leaves.leaf_of_facet(face as usize);
        leaf.face_name(face as usize - leaf.first_facet())
    }

    /// The name of the face that a crossing refers to, e.g. `rim.side`.
    pub fn name_of(&self, face: &Face) -> String {
        self.face_name(self.face_number(face.leaf, face.facet))
    }

    /// The names of all faces, in the order of their numbers.
    pub fn face_names(&self) -> impl Iterator<Item = String> {
        self.leaves().flat_map(|leaf| (0..leaf.facets().len()).map(move |k| leaf.face_name(k)))
    }

    /// The regions in order; number k of this list is [`RegionId`] k + 1.
    pub fn regions(&self) -> &[RegionInfo] {
        &self.regions
    }

    /// The medium of a region; 0 for region 0.
    pub fn medium_of(&self, region: RegionId) -> Medium {
        region.index().checked_sub(1).map_or(0, |k| self.regions[k].medium)
    }

    /// The outputs of a group as text, one line for each region: `all{0, 1, ~2}`, leaves by their number in
    /// the group.
    pub fn expression_text(&self, id: PrototypeId) -> String {
        let group = self.prototype(id);
        let lines: Vec<_> =
            group.expression.outputs().iter().map(|&edge| group.expression.text(edge)).collect();
        lines.join("\n")
    }

    /// A box that holds all regions. It is found from the shapes and may be larger than the model: `sphere - half_space` has the box of
    /// the sphere. `features::extent` of the facade computes how far a model extends.
    pub fn bounds(&self) -> Bounds {
        self.prototypes[0].bounds
    }

    /// The map from a placement's frame to the world, and the group that is placed there.
    pub fn placement(&self, id: PlacementId) -> (Affine, PrototypeId) {
        let (mut rest, mut group, mut map) = (id.0, PrototypeId(0), Affine::IDENTITY);
        while let Some((run, k)) = self.instance_before(group, rest) {
            map = run.world_from_local(k).then(&map);
            (rest, group) = (rest - run.placement(k), run.prototype);
        }
        (map, group)
    }

    /// The maps that take a world ray into a placement's frame, outermost first.
    pub fn descend(&self, id: PlacementId) -> impl Iterator<Item = Place> {
        self.descend_groups(id).map(|(place, _)| place)
    }

    /// Like [`Program::descend`], each map with the group into whose frame it leads.
    pub(crate) fn descend_groups(&self, id: PlacementId) -> impl Iterator<Item = (Place, PrototypeId)> {
        let (mut rest, mut group) = (id.0, PrototypeId(0));
        std::iter::from_fn(move || {
            let (run, k) = self.instance_before(group, rest)?;
            (rest, group) = (rest - run.placement(k), run.prototype);
            Some((run.place(k), group))
        })
    }

    /// The last instance of a group whose first placement number is at most `rest`; `None` for the group
    /// itself.
    fn instance_before(&self, group: PrototypeId, rest: u32) -> Option<(&Instances, usize)> {
        let (run, k) = self.instance_run_before(group, rest)?;
        Some((&self.instances_of(group)[run], k))
    }

    /// Like `instance_before`, with the number of the run of instances in the group.
    pub(crate) fn instance_run_before(&self, group: PrototypeId, rest: u32) -> Option<(usize, usize)> {
        let runs = self.instances_of(group);
        let number = runs.partition_point(|run| run.first_placement <= rest).checked_sub(1)?;
        let run = &runs[number];
        let k = (rest - run.first_placement) / run.placements_each;
        Some((number, (k as usize).min(run.len() - 1)))
    }

    /// The runs of instances of a group.
    pub(crate) fn instances_of(&self, group: PrototypeId) -> &[Instances] {
        let Range { start, end } = self.prototype(group).instances;
        &self.leaves.instances[start as usize..end as usize]
    }

    /// Sizes in bytes, by part. Names that are shared with solids are not counted.
    pub fn bytes(&self) -> Vec<(&'static str, usize)> {
        let sum = |of: fn(&Prototype) -> usize| self.prototypes.iter().map(of).sum();
        let mut parts = vec![
            ("surfaces", size_of_val(&self.surfaces[..])),
            ("network", sum(|group| group.network.bytes())),
            ("expression", sum(|group| group.expression.bytes())),
        ];
        parts.extend(self.leaves.bytes());
        parts.push(("paths", self.trails.iter().map(Trail::bytes).sum()));
        parts
    }
}
