//! Slivers between a solid that a ray leaves and one that it enters: the gap between touching faces whose positions differ by
//! rounding.
//!
//! A ray that leaves the solid of its cell and enters another one within the tolerance crosses both faces at once. The decisions
//! are those of [`Weld`](rayweave_model::weld::Weld), for exactly two changes with one event each, or one change with two events.

use super::within::Met;
use super::{First, Objects};
use rayweave_model::weld::Trajectory;
use rayweave_model::{Crossing, Face, LeafId, Program, RegionId};
use rayweave_shape::Ray;

/// An end of the way of one ray through a solid.
#[derive(Clone, Copy)]
struct End {
    t: f64,
    solid: usize,
    is_entry: bool,
    /// True for the first change of the ray at the solid.
    is_first: bool,
}

impl Objects {
    /// The crossing of a ray that leaves the first of some solids, where a second change is so close that it may have to be
    /// welded to the first one. `None` if more than two changes are involved, or if it is uncertain.
    ///
    /// All events up to the time `horizon` are those of the solids in `met`, and the later ones end at `end`.
    pub(super) fn welded_exit(
        &self,
        program: &Program,
        ray: &Ray,
        (first, lane): (&First, usize),
        met: &[Met],
        (horizon, end): (f64, f64),
    ) -> Option<Crossing> {
        let (a, own, after) = (first.t.0[lane], first.object.0[lane], first.region.0[lane]);
        let bit = |mask: u64| mask >> lane & 1 == 1;
        let mut ends: Vec<End> = Vec::new();
        for (solid, Met { first, second, inside, single, region, .. }) in met.iter().enumerate() {
            if region.0[lane] == 0.0 {
                continue;
            }
            let is_entry = !bit(*inside);
            ends.push(End { t: first.0[lane], solid, is_entry, is_first: true });
            // further changes at a solid in several pieces are behind its second one, whose time is a lower bound
            if is_entry || !bit(*single) {
                ends.push(End { t: second.0[lane], solid, is_entry: !is_entry, is_first: false });
            }
        }
        ends.retain(|end| end.t >= a && end.t < f64::INFINITY);
        ends.sort_by(|x, y| x.t.total_cmp(&y.t));
        let [leaves, enters, later @ ..] = ends.as_slice() else { return None };
        let (front, behind) = (&met[leaves.solid], &met[enters.solid]);
        let region = behind.region.0[lane];
        let is_exit = leaves.is_first && !leaves.is_entry && front.object.0[lane] == own && leaves.t == a;
        let next = later.first().map_or(f64::INFINITY, |end| end.t).min(horizon);
        let before = first.before.0[lane];
        // a solid that begins at the time of the exit is included in the region after it
        // the exit into another copy of the region that the ray is in is no crossing
        let owns = region != before && if enters.t == a { region == after } else { region > after };
        let is_another = enters.is_first && enters.is_entry;
        if !is_exit || !is_another || !owns || enters.t >= next {
            return None;
        }
        let (b, end) = (enters.t, end.max(next));
        let faces = [(front, front.face.0[lane]), (behind, behind.face.0[lane])];
        let [left, entered] = faces.map(|(met, face)| self.face_of(met.object.0[lane], face));
        let coincides = |face: Face| ray.coincides_along(program, face, a, b);
        let before = RegionId(before as u32);
        if a != b && !(coincides(entered) && coincides(left)) {
            let after = RegionId(after as u32);
            return Some(Crossing { t: a, face: left, left, entered: left, before, after });
        }
        let [first_leaf, second_leaf] =
            faces.map(|(met, face)| self.leaf_of(program, met.object.0[lane], face));
        let face = match first_leaf.cmp(&second_leaf) {
            std::cmp::Ordering::Less => left,
            std::cmp::Ordering::Greater => entered,
            std::cmp::Ordering::Equal => return None,
        };
        // the face of the last change: events at one time are one change
        let last = if a == b { face } else { entered };
        if !ray.separated_along(program, last, b, (next, end)) {
            return None;
        }
        Some(Crossing { t: b, face, left, entered, before, after: RegionId(region as u32) })
    }

    /// The leaf of the model's own group that a face belongs to.
    fn leaf_of(&self, program: &Program, object: f64, face: f64) -> LeafId {
        let first = program.prototypes()[0].leaves.start;
        match self.objects[object as usize].top {
            Some(leaf) => leaf,
            None => LeafId(self.model.faces[face as usize].leaf.0 - first),
        }
    }
}
