//! The columns of hit arrays: rays or points.

use crate::accel::Accel;
use rayweave_model::{
    GroupPoint, GroupRay, LeafEvents, LeafFacet, Place, PlacementId, Program, Prototype, Query,
    facets_contain, leaf_events,
};

/// A ray or a point in the frame of a group.
pub(super) trait ColumnQuery: Copy {
    /// Appends the leaves that it can touch.
    fn intersected_leaves(&self, accel: &Accel, query: &Query<'_>, out: &mut Vec<u32>);

    /// The side at the start, and the boundary events, of a leaf that is a conjunction of facets.
    fn leaf(&self, program: &Program, facets: &[LeafFacet], query: &Query<'_>, events: &mut LeafEvents);

    /// The ray or point in the frame of a solid placed in the group; `placement` is relative to that of the
    /// group.
    fn placed(&self, place: &Place, inner: &Prototype, placement: u32) -> Self;

    /// The placement of the group.
    fn placement(&self) -> PlacementId;
}

/// A ray of a batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColumnRay {
    /// The ray, without its start list.
    pub ray: GroupRay<'static>,
    /// Its index in the batch, which finds its start list.
    pub number: usize,
}

impl ColumnQuery for ColumnRay {
    fn intersected_leaves(&self, accel: &Accel, query: &Query<'_>, out: &mut Vec<u32>) {
        accel.intersected_leaves(&self.ray.ray, self.ray.magnitude, query.window, out);
    }

    fn leaf(&self, program: &Program, facets: &[LeafFacet], query: &Query<'_>, events: &mut LeafEvents) {
        let starts = query.starts.map_or(&[][..], |lists| lists.of(self.number));
        leaf_events(program, facets, &GroupRay { starts, ..self.ray }, events);
    }

    fn placed(&self, place: &Place, inner: &Prototype, placement: u32) -> Self {
        ColumnRay { ray: self.ray.placed(place, inner, placement), number: self.number }
    }

    fn placement(&self) -> PlacementId {
        self.ray.placement
    }
}

/// A point is a ray without crossings: its side is that at the start.
impl ColumnQuery for GroupPoint {
    fn intersected_leaves(&self, accel: &Accel, _: &Query<'_>, out: &mut Vec<u32>) {
        accel.around(self, out);
    }

    fn leaf(&self, program: &Program, facets: &[LeafFacet], _: &Query<'_>, events: &mut LeafEvents) {
        events.list.clear();
        events.starts_inside = facets_contain(program, facets, self);
    }

    fn placed(&self, place: &Place, _: &Prototype, _: u32) -> Self {
        GroupPoint::placed(self, place)
    }

    fn placement(&self) -> PlacementId {
        PlacementId(0)
    }
}
