//! The compiled model: flat, immutable, read by every evaluator.

use crate::gate::Network;
use crate::{Ball, Expression, LeafId, PlacementId, PrototypeId, RegionId, SurfaceId};
use rayweave_math::{Affine, Bounds, Transform, UNIT_ROUNDOFF};
use rayweave_shape::primitive::Primitive;
use rayweave_shape::surface::Surface;
use std::sync::Arc;

/// A compiled model.
///
/// Shared by reference among any number of threads and evaluators; nothing about it fails or changes after
/// [`Program::compile`].
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) prototypes: Vec<Prototype>,
    pub(crate) surfaces: Vec<SurfaceEntry>,
    pub(crate) leaves: Vec<Leaf>,
    pub(crate) facets: Vec<LeafFacet>,
    pub(crate) regions: Vec<RegionInfo>,
}

/// A group of leaves compiled in one frame: the model itself, or a solid that is placed many times.
#[derive(Clone, Debug)]
pub struct Prototype {
    /// The leaves of this group: a range of the program's leaf table, in the order of declaration.
    pub leaves: std::ops::Range<u32>,
    /// The boolean skeleton over the group's leaves.
    pub network: Network,
    /// The same as plain expression: the meaning of `network`.
    pub expression: Expression,
    /// What is asked of the group: one edge per region for the model, one for a placed solid.
    pub outputs: Vec<crate::Edge>,
    /// A box that holds the solid (of the model: all regions).
    pub bounds: Bounds,
    /// The ball whose chords say whether a ray lies in a surface.
    pub ball: Ball,
    /// The most by which a rounding in this group's frame can be magnified on the way into a placed solid and
    /// back, at least 1: the factor for a ray's share in the growth of boxes.
    pub condition: f64,
    /// The number of placements that one occurrence of the group stands for, itself included.
    pub placements: u32,
    /// The instances among the leaves, as (number of the placement within the group, leaf), in order.
    pub instances: Vec<(u32, LeafId)>,
}

/// Boxes are grown by this times the lengths involved.
pub const MARGIN: f64 = 256.0 * UNIT_ROUNDOFF;

/// A surface in the frame of its group.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceEntry {
    /// The surface, in canonical form.
    pub surface: Surface,
    /// The size and position of the surface plus the lengths of all translations composed on the way.
    pub reach: f64,
}

/// One occurrence of a primitive or of a placed solid.
#[derive(Clone, Debug)]
pub struct Leaf {
    /// The name given to it, or its kind.
    pub name: Arc<str>,
    /// What it is.
    pub kind: LeafKind,
    /// A box, in the frame of the group, that holds the conjunction of its facets.
    pub bounds: Bounds,
    /// How far that box has to be grown to hold everything that may be found of the leaf on a ray that starts
    /// near the origin; a ray from far away adds its share.
    ///
    /// It is [`MARGIN`] of the lengths involved, four times the distance at which a computed root may lie off
    /// its surface. Among these lengths is the group's ball: whether a ray lies in a face is judged along it.
    pub margin: f64,
    /// The part of the box, grown by the margin, where the leaf can matter to what is asked of the group.
    pub matters: Bounds,
    /// Its place in its group.
    pub transform: Transform,
}

/// What a leaf is.
#[derive(Clone, Debug)]
pub enum LeafKind {
    /// A conjunction of sides of surfaces.
    Shape {
        /// The facets: a range of the program's facet table.
        facets: std::ops::Range<u32>,
        /// The shape in its own frame.
        primitive: Primitive,
        /// True if the shape is the complement of the conjunction.
        complement: bool,
    },
    /// A solid compiled on its own, in its own frame.
    Instance {
        /// The group.
        prototype: PrototypeId,
        /// The number of this placement, counted from that of the group that the leaf belongs to.
        placement: u32,
    },
}

/// A side of a surface that bounds a leaf.
#[derive(Clone, Debug)]
pub struct LeafFacet {
    /// The surface.
    pub surface: SurfaceId,
    /// True if the leaf lies where f < 0.
    pub inside: bool,
    /// The name of the face, as `rim.side`.
    pub name: Arc<str>,
}

/// A region of the model, or the solid that was compiled.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionInfo {
    /// What the region is called.
    pub name: String,
    /// The number of its medium; 0 is the medium of the world.
    pub medium: Medium,
}

/// A number of a medium; 0 is the medium of the world.
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
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// A leaf by its number.
    pub fn leaf(&self, id: LeafId) -> &Leaf {
        &self.leaves[id.index()]
    }

    /// All facets, leaf by leaf: the faces that answers name.
    pub fn facets(&self) -> &[LeafFacet] {
        &self.facets
    }

    /// The number of a face in [`Program::facets`], from its leaf and its number there.
    pub fn face_number(&self, leaf: LeafId, facet: u32) -> u32 {
        match &self.leaf(leaf).kind {
            LeafKind::Shape { facets, .. } => facets.start + facet,
            LeafKind::Instance { .. } => facet,
        }
    }

    /// The regions in order; number k of this list is [`RegionId`] k + 1.
    pub fn regions(&self) -> &[RegionInfo] {
        &self.regions
    }

    /// The medium of a region; that of the world for region 0.
    pub fn medium_of(&self, region: RegionId) -> Medium {
        region.index().checked_sub(1).map_or(0, |k| self.regions[k].medium)
    }

    /// What is asked of a group as text, one line for each region: `all{0, 1, ~2}`, leaves by their number in
    /// the group.
    pub fn expression_text(&self, id: PrototypeId) -> String {
        let group = self.prototype(id);
        let lines: Vec<_> = group.outputs.iter().map(|&edge| group.expression.text(edge)).collect();
        lines.join("\n")
    }

    /// A box that holds all regions.
    pub fn bounds(&self) -> Bounds {
        self.prototypes[0].bounds
    }

    /// The map from a placement's frame to the world and the group that is placed there.
    pub fn placement(&self, id: PlacementId) -> (Affine, PrototypeId) {
        let (mut rest, mut group, mut map) = (id.0, PrototypeId(0), Affine::IDENTITY);
        while rest > 0 {
            let Some((leaf, child, first)) = self.instance_before(group, rest) else {
                break;
            };
            map = leaf.transform.world_from_local.then(&map);
            (rest, group) = (rest - first, child);
        }
        (map, group)
    }

    /// The steps by which a world ray is carried into a placement's frame, outermost first.
    pub fn descend(&self, id: PlacementId) -> impl Iterator<Item = &Transform> {
        let (mut rest, mut group) = (id.0, PrototypeId(0));
        std::iter::from_fn(move || {
            if rest == 0 {
                return None;
            }
            let (leaf, child, first) = self.instance_before(group, rest)?;
            (rest, group) = (rest - first, child);
            Some(&leaf.transform)
        })
    }

    /// The last instance of a group whose first placement number is not above `rest`.
    fn instance_before(&self, group: PrototypeId, rest: u32) -> Option<(&Leaf, PrototypeId, u32)> {
        let instances = &self.prototype(group).instances;
        let at = instances.partition_point(|&(first, _)| first <= rest);
        let &(first, leaf) = instances[..at].last()?;
        match &self.leaf(leaf).kind {
            LeafKind::Instance { prototype, .. } => Some((self.leaf(leaf), *prototype, first)),
            LeafKind::Shape { .. } => None,
        }
    }
}
