//! Regions that contain points.

use super::{Level, Weave, WeaveScratch};
use rayweave_model::gate::NetworkState;
use rayweave_model::{GroupPoint, LeafId, LeafKind, PrototypeId, RegionId, facets_contain};

impl Weave {
    /// The region that contains a point of the world.
    pub(super) fn region_at(&self, point: &GroupPoint, scratch: &mut WeaveScratch) -> RegionId {
        RegionId(self.value_at(PrototypeId(0), point, 0, scratch, |state| state.owner()))
    }

    /// Evaluates `value` on the network state of a group at a point.
    fn value_at<T>(
        &self,
        group: PrototypeId,
        point: &GroupPoint,
        depth: usize,
        scratch: &mut WeaveScratch,
        value: impl FnOnce(&NetworkState) -> T,
    ) -> T {
        let mut state = scratch.take_state(&self.program, group);
        let level = self.containing(group, point, depth, scratch);
        let network = &self.program.prototype(group).network;
        level.touched.iter().for_each(|&leaf| network.toggle(&mut state, leaf));
        let value = value(&state);
        level.touched.iter().for_each(|&leaf| network.toggle(&mut state, leaf));
        scratch.give_state(group, state);
        scratch.give_level(depth, level);
        value
    }

    /// The leaves of a group that contain a point, of those that can matter there.
    fn containing(
        &self,
        group: PrototypeId,
        point: &GroupPoint,
        depth: usize,
        scratch: &mut WeaveScratch,
    ) -> Box<Level> {
        let mut level = scratch.take_level(depth);
        let first = self.program.prototype(group).leaves.start;
        self.accel[group.index()].around(point, &mut level.touched);
        level.touched.retain(|&leaf| {
            let leaf = self.program.leaf(LeafId(first + leaf));
            match &leaf.kind() {
                LeafKind::Shape { facets, .. } => {
                    let table = &self.program.facets()[facets.start as usize..facets.end as usize];
                    facets_contain(&self.program, table, point)
                }
                LeafKind::Instance { prototype, .. } => {
                    self.instance_holds(*prototype, &point.placed(&leaf.place()), depth + 1, scratch)
                }
            }
        });
        level
    }

    fn instance_holds(
        &self,
        group: PrototypeId,
        point: &GroupPoint,
        depth: usize,
        scratch: &mut WeaveScratch,
    ) -> bool {
        self.value_at(group, point, depth, scratch, |state| state.output(0))
    }
}
