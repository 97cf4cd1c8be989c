//! The neighbours of the surfaces of a placement: those whose boxes touch theirs.

use rayweave_bvh::ExactBvh;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::Start;
use std::ops::ControlFlow;

/// For each cluster with few neighbours, the clusters whose boxes touch its box.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours {
    /// The lists, one after the other, and the first of each cluster; empty for clusters with too many neighbours.
    pub lists: Vec<u32>,
    pub first: Vec<u32>,
    /// The first cluster of each placement, and for each surface the position of its cluster in that placement.
    pub of_placement: Vec<u32>,
    pub of_surface: Vec<u32>,
    /// The margin by which all boxes in the lists are grown.
    pub slack: f64,
}

/// Number of neighbours above which the tree is faster than a list.
const FEW: usize = 16;

/// The margin of boxes in lists of neighbours, relative to the size of the model; it covers the tolerances of rays up to
/// 10^5 times as long as the model.
pub(super) const SLACK: f64 = 1e-6;

impl Neighbours {
    pub fn new(boxes: &[Bounds], tree: &ExactBvh) -> Neighbours {
        let finite = boxes.iter().filter(|bounds| bounds.is_finite());
        let all = finite.fold(Bounds::EMPTY, |all, bounds| all.union(bounds));
        let mut found = Neighbours { first: vec![0], ..Neighbours::default() };
        if !all.is_empty() {
            found.slack = SLACK * all.lo.abs().max(all.hi.abs()).max_element();
        }
        for bounds in boxes {
            let own = bounds.grown(2.0 * found.slack);
            let first = found.lists.len();
            let _ = tree.visit(
                |other| !other.intersection(&own).is_empty(),
                |k| {
                    found.lists.push(k as u32);
                    if found.lists.len() - first > FEW {
                        ControlFlow::Break(())
                    } else {
                        ControlFlow::Continue(())
                    }
                },
            );
            if found.lists.len() - first > FEW {
                found.lists.truncate(first);
            }
            found.first.push(found.lists.len() as u32);
        }
        found
    }

    /// The cluster of a surface and its neighbours, itself included; `None` if it has too many.
    pub fn of(&self, start: &Start) -> Option<(usize, &[u32])> {
        let own = self.cluster(start);
        let list = &self.lists[self.first[own] as usize..self.first[own + 1] as usize];
        (!list.is_empty()).then_some((own, list))
    }

    /// The cluster of a surface.
    pub fn cluster(&self, start: &Start) -> usize {
        (self.of_placement[start.placement.index()] + self.of_surface[start.surface.index()]) as usize
    }

    /// True if the neighbours of a box include all clusters whose boxes, grown by a margin, contain a point.
    pub fn cover(&self, own: &Bounds, point: Vec3, margin: f64) -> bool {
        margin <= self.slack && own.grown(self.slack).contains(point)
    }
}
