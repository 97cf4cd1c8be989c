//! The surfaces on which a ray starts that leaves an interface.
//!
//! Light that was reflected or refracted starts *on* the surface: the root there is divided out, with the side known, so
//! that no offset is needed and nothing is met twice. At edges it starts on several surfaces at a time: on all within
//! `delta` of the point.

mod tree;

use rayweave_math::{Bounds, Vec3};
use rayweave_model::weld::local_ray;
use rayweave_model::{Crossing, LeafId, PlacementId, Program, Start, SurfaceId, dress};
use rayweave_shape::Ray;
use rayweave_shape::surface::{delta, delta_of};
use std::collections::HashMap;
use std::ops::ControlFlow;
pub(crate) use tree::Tree;

/// All surfaces of a program with the boxes in which they matter.
#[derive(Clone, Debug, Default)]
pub(crate) struct Near {
    entries: Vec<Entry>,
    /// Where they matter.
    boxes: Vec<Bounds>,
    tree: Tree,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    placement: PlacementId,
    surface: SurfaceId,
}

/// How a ray goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Leaves {
    /// On the side from which it came: no surface is crossed.
    Here,
    /// On the other side.
    Beyond,
}

impl Near {
    pub fn new(program: &Program) -> Near {
        let (mut entries, mut boxes) = (Vec::new(), Vec::<Bounds>::new());
        let mut matters = HashMap::new();
        for placement in (0..program.prototypes()[0].placements).map(PlacementId) {
            let (world_from_local, id) = program.placement(placement);
            let group = program.prototype(id);
            let boxes_of_leaves = matters.entry(id).or_insert_with(|| program.matters(group));
            let mut known = HashMap::new();
            for (leaf, bounds) in group.leaves.clone().map(LeafId).zip(&*boxes_of_leaves) {
                if bounds.is_empty() {
                    continue;
                }
                let bounds = bounds.transformed(&world_from_local);
                for surface in program.leaf(leaf).facets().iter().map(|facet| facet.surface()) {
                    let new = entries.len();
                    let at = *known.entry(surface).or_insert(new);
                    if at == new {
                        entries.push(Entry { placement, surface });
                        boxes.push(bounds);
                    } else {
                        boxes[at] = boxes[at].union(&bounds);
                    }
                }
            }
        }
        let tree = Tree::new(&boxes);
        Near { entries, boxes, tree }
    }

    /// The surfaces with their boxes; `None` if some belong to placed solids.
    pub fn own(&self) -> Option<impl Iterator<Item = (Bounds, SurfaceId)> + '_> {
        let is_own = self.entries.iter().all(|entry| entry.placement == PlacementId(0));
        let surfaces = self.entries.iter().map(|entry| entry.surface);
        is_own.then(|| self.boxes.iter().copied().zip(surfaces))
    }

    /// Adds the surfaces at a time of a ray to a start list, that of a crossing, if there is one there, in any case.
    pub fn list(
        &self,
        program: &Program,
        (ray, t): (&Ray, f64),
        crossing: Option<&Crossing>,
        leaves: Leaves,
        starts: &mut Vec<Start>,
    ) {
        let first = starts.len();
        if let Some(Crossing { face, .. }) = crossing {
            let gradient = dress::world_gradient(program, ray, *face, t);
            let inside = is_inside(gradient.dot(ray.direction), 0.0, leaves);
            starts.push(Start { surface: face.surface, placement: face.placement, inside });
        }
        self.others(program, (ray, t), first, leaves, starts);
    }

    /// Adds the surfaces at a time of a ray to a start list that begins at `first`, but for those that it holds.
    pub fn others(
        &self,
        program: &Program,
        (ray, t): (&Ray, f64),
        first: usize,
        leaves: Leaves,
        starts: &mut Vec<Start>,
    ) {
        let point = ray.at(t);
        // sums of components are lengths at least, and need no root
        let lengths = ray.origin.abs().element_sum() + t.abs() * ray.direction.abs().element_sum();
        // boxes are grown by more than any tolerance: only those matter within which the point may lie
        let margin = 1e3 * delta_of(lengths);
        let is_around = |bounds: &Bounds| bounds.grown(margin).contains(point);
        let mut add = |entry: &Entry| {
            let listed = |s: &Start| (s.surface, s.placement) == (entry.surface, entry.placement);
            if entry.is_far(program, point, lengths) || starts[first..].iter().any(listed) {
                return;
            }
            let side = entry.side(program, ray, t, leaves);
            starts.extend(side.map(|inside| Start {
                surface: entry.surface,
                placement: entry.placement,
                inside,
            }));
        };
        let _ = self.tree.visit(is_around, |k| {
            add(&self.entries[k]);
            ControlFlow::Continue(())
        });
    }
}

impl Entry {
    /// True if the surface is sure to be out of reach: a rough form of the test in [`Entry::side`].
    fn is_far(&self, program: &Program, point: Vec3, lengths: f64) -> bool {
        let entry = program.surface(self.surface);
        let (value, gradient) = entry.surface.value_and_gradient(point);
        let near = 2.0 * delta_of(lengths + entry.reach) * gradient.abs().element_sum();
        self.placement == PlacementId(0) && value.abs() > near
    }

    /// If the surface is within the tolerance of the point: the side on which the ray goes on.
    fn side(&self, program: &Program, ray: &Ray, t: f64, leaves: Leaves) -> Option<bool> {
        let (local, reach) = local_ray(program, ray, self.placement);
        let entry = program.surface(self.surface);
        let (value, gradient) = entry.surface.value_and_gradient(local.at(t));
        let near = value.abs() <= delta(entry.reach + reach, &local, t) * gradient.length();
        near.then(|| is_inside(gradient.dot(local.direction), value, leaves))
    }
}

/// The side after the event: along the ray f falls where it goes in.
pub(crate) fn is_inside(slope: f64, value: f64, leaves: Leaves) -> bool {
    match leaves {
        Leaves::Here => slope > 0.0 || (slope == 0.0 && value < 0.0),
        Leaves::Beyond => slope < 0.0 || (slope == 0.0 && value < 0.0),
    }
}

/// The point of a crossing, put onto its surface by one Newton step along a direction that is not in it.
pub(crate) fn foot(program: &Program, ray: &Ray, crossing: &Crossing, normal: Vec3) -> Vec3 {
    let (local, _) = local_ray(program, ray, crossing.face.placement);
    let surface = &program.surface(crossing.face.surface).surface;
    let (value, gradient) = surface.value_and_gradient(local.at(crossing.t));
    let steps = program.descend(crossing.face.placement);
    let along = steps.fold(normal, |n, place| place.local_from_world.vector(n));
    stepped(ray.at(crossing.t), normal, value / gradient.dot(along))
}

/// A point after a step against a direction; one that is not finite is none.
pub(crate) fn stepped(point: Vec3, normal: Vec3, step: f64) -> Vec3 {
    if step.is_finite() { point - step * normal } else { point }
}
