//! Lists of crossings: the boundary events of all leaves that the ray can touch, sorted once.

use super::{Level, Weave, WeaveScratch};
use crate::accel::Accel;
use rayweave_model::gate::NetworkState;
use rayweave_model::weld::{LeafStates, Trajectory, Weld};
use rayweave_model::{
    Crossing, Event, Face, GroupRay, LeafId, LeafKind, Limit, PrototypeId, Query, RegionId, Start, Sweep,
    Window, leaf_events,
};
use rayweave_shape::Ray;

/// Number of leaves whose data fit the processor's nearest caches.
const CACHED: usize = 16_000;

/// A query of a group.
#[derive(Clone, Copy)]
pub(crate) struct GroupQuery<'r> {
    pub group: PrototypeId,
    /// The ray in the frame of the group.
    pub ray: &'r GroupRay<'r>,
    /// The relevant part of the ray.
    pub window: Window,
    /// Number of groups around the group.
    pub depth: usize,
}

impl Weave {
    /// Appends the crossings of a ray, or the first one, from the boundary events of all leaves. Returns the
    /// region at its start.
    pub(super) fn list(
        &self,
        ray: Ray,
        query: &Query<'_>,
        starts: &[Start],
        scratch: &mut WeaveScratch,
    ) -> RegionId {
        let group = PrototypeId(0);
        let seen = GroupRay::world(&self.program, ray, starts);
        let mut state = scratch.take_state(&self.program, group);
        let group_query = GroupQuery { group, ray: &seen, window: query.window, depth: 0 };
        let level = self.gather(group_query, scratch, &mut state);
        self.swept(ray, (query, !starts.is_empty()), (level, state), scratch)
    }

    /// Appends the crossings, or the first one, from the sorted boundary events of all leaves that a ray touches. In `state` the
    /// leaves are toggled that are inside from the start.
    pub(crate) fn swept(
        &self,
        path: impl Trajectory,
        (query, has_starts): (&Query<'_>, bool),
        (level, mut state): (Box<Level>, Box<NetworkState>),
        scratch: &mut WeaveScratch,
    ) -> RegionId {
        let group = PrototypeId(0);
        let network = &self.program.prototype(group).network;
        let mut sweep = Sweep::new(network, &mut state, &level.events, query.window.t_max());
        while sweep.next_time().is_some_and(|t| query.is_past(t, has_starts)) {
            sweep.step();
        }
        let mut now = self.state(sweep.leaves.owner());
        let start = now.region;
        let mut weld = Weld::new(&self.program, path, &level.events);
        let enough = |found: &[Crossing]| query.limit == Limit::First && !found.is_empty();
        while !enough(&scratch.crossings)
            && let Some(change) = sweep.next_change(&mut now, |owner| self.state(owner))
        {
            scratch.crossings.extend(weld.change(change, &mut sweep.leaves));
        }
        if !enough(&scratch.crossings) {
            scratch.crossings.extend(weld.finish(sweep.position(), &mut sweep.leaves));
        }
        sweep.restore(level.touched.iter().copied());
        scratch.give_state(group, state);
        scratch.give_level(0, level);
        start
    }

    /// Appends the leaves of the model's own group that the ray can touch in the window.
    pub(crate) fn candidates(&self, ray: Ray, window: Window, out: &mut Vec<u32>) {
        self.accel[0].intersected_leaves(&ray, 0.0, window, out);
    }

    /// The search structure for the leaves of the model's own group.
    pub(crate) fn accel_of_leaves(&self) -> &Accel {
        &self.accel[0]
    }

    /// Collects the boundary events of the leaves of a group that the ray can touch in the window, sorted by
    /// time, and toggles in `state` the leaves that are inside from the start.
    pub(super) fn gather(
        &self,
        group_query: GroupQuery<'_>,
        scratch: &mut WeaveScratch,
        state: &mut NetworkState,
    ) -> Box<Level> {
        let mut level = scratch.take_level(group_query.depth);
        let GroupQuery { group, ray, window, .. } = group_query;
        self.accel[group.index()].intersected_leaves(&ray.ray, ray.magnitude, window, &mut level.touched);
        let network = &self.program.prototype(group_query.group).network;
        self.read_ahead(group_query.group, &level.touched, state);
        for k in 0..level.touched.len() {
            let leaf = level.touched[k];
            if self.leaf(group_query, leaf, scratch, &mut level) {
                network.toggle(state, leaf);
            }
        }
        level.sort();
        level
    }

    /// Prefetches the data that intersecting and flipping some leaves will read, table by table: cache misses
    /// of many leaves then overlap, instead of one after the other in three tables and a network.
    pub(super) fn read_ahead(&self, group: PrototypeId, leaves: &[u32], state: &NetworkState) {
        let (program, group) = (&*self.program, self.program.prototype(group));
        if group.leaves.len() <= CACHED || leaves.is_empty() {
            return;
        }
        let facet = |leaf: u32| match program.leaf(LeafId(group.leaves.start + leaf)).kind() {
            LeafKind::Shape { facets, .. } => facets.start,
            LeafKind::Instance { .. } => 0,
        };
        let surface =
            |leaf: u32| program.facets().get(facet(leaf) as usize).map_or(0, |facet| facet.surface().0);
        let degree =
            |leaf: u32| program.surfaces().get(surface(leaf) as usize).map_or(0, |s| s.surface.degree());
        let mut read =
            leaves.iter().fold(0, |read, &leaf| read ^ facet(leaf) ^ group.network.read_ahead(state, leaf));
        read = leaves.iter().fold(read, |read, &leaf| read ^ surface(leaf));
        read = leaves.iter().fold(read, |read, &leaf| read ^ u32::from(degree(leaf)));
        std::hint::black_box(read);
    }

    /// Appends the boundary events of a leaf of a group. Returns true if it is inside from the start. Outside
    /// of the window the events may differ from the exact ones, but the side of the leaf is correct where the
    /// window begins.
    pub(crate) fn leaf(
        &self,
        group_query: GroupQuery<'_>,
        leaf: u32,
        scratch: &mut WeaveScratch,
        level: &mut Level,
    ) -> bool {
        scratch.intersected_leaves += 1;
        let GroupQuery { ray, window, depth, .. } = group_query;
        let id = LeafId(self.program.prototype(group_query.group).leaves.start + leaf);
        match &self.program.leaf(id).kind() {
            LeafKind::Shape { facets, .. } => self.shape(id, leaf, facets, ray, level),
            LeafKind::Instance { prototype, placement } => {
                let place = &self.program.leaf(id).place();
                let local = ray.placed(place, self.program.prototype(*prototype), *placement);
                level.inner.clear();
                let inner = GroupQuery { group: *prototype, ray: &local, window, depth: depth + 1 };
                let starts = self.instance(inner, scratch, &mut level.inner);
                level.events.extend(level.inner.iter().map(|&(t, face)| Event { t, leaf, face }));
                starts
            }
        }
    }

    /// [`Weave::leaf`] for a shape.
    fn shape(
        &self,
        id: LeafId,
        leaf: u32,
        facets: &std::ops::Range<u32>,
        ray: &GroupRay<'_>,
        level: &mut Level,
    ) -> bool {
        let table = &self.program.facets()[facets.start as usize..facets.end as usize];
        leaf_events(&self.program, table, ray, &mut level.leaf);
        level.events.extend(level.leaf.list.iter().map(|&(t, facet)| {
            let surface = table[facet as usize].surface();
            Event { t, leaf, face: Face { leaf: id, facet, surface, placement: ray.placement } }
        }));
        level.leaf.starts_inside
    }

    /// The changes of a placed solid in the window, as boundary events of one leaf. Returns true if it is
    /// inside from the start.
    fn instance(
        &self,
        group_query: GroupQuery<'_>,
        scratch: &mut WeaveScratch,
        out: &mut Vec<(f64, Face)>,
    ) -> bool {
        let GroupQuery { group, window, depth, .. } = group_query;
        let mut state = scratch.take_state(&self.program, group);
        let level = self.gather(group_query, scratch, &mut state);
        let network = &self.program.prototype(group).network;
        let mut sweep = Sweep::new(network, &mut state, &level.events, window.t_max());
        // the faces before the window do not matter
        while sweep.next_time().is_some_and(|t| t < window.t_min()) {
            sweep.step();
        }
        let starts_inside = sweep.leaves.output(0);
        let mut inside = starts_inside;
        out.extend(std::iter::from_fn(|| sweep.next_event(&mut inside)));
        sweep.restore(level.touched.iter().copied());
        scratch.give_state(group, state);
        scratch.give_level(depth, level);
        starts_inside
    }
}
