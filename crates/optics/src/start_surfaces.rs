//! Start surfaces: the surfaces on which a scattered ray starts, by a point query of the closest surfaces.
//!
//! Reflected or refracted light starts *on* a surface: the root there is divided out, with the side
//! known, so that the ray needs no offset (no ray epsilon) and hits nothing twice. At edges it
//! starts on several surfaces: all within `delta` of the point.

use rayweave_bvh::ExactBvh;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::weld::local_ray;
use rayweave_model::{Crossing, LeafId, PlacementId, Program, Start, SurfaceId, attributes};
use rayweave_shape::Ray;
use rayweave_shape::surface::{delta, delta_of};
use std::collections::HashMap;
use std::ops::ControlFlow;

/// The surfaces of a program, with the boxes in which they matter, for point queries.
#[derive(Clone, Debug, Default)]
pub struct StartSurfaces {
    entries: Vec<PlacedSurface>,
    /// The boxes in which they matter.
    boxes: Vec<Bounds>,
    tree: ExactBvh,
}

#[derive(Clone, Copy, Debug)]
struct PlacedSurface {
    placement: PlacementId,
    surface: SurfaceId,
}

/// The side of a surface on which a scattered ray leaves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExitSide {
    /// The side of the incident light: reflection.
    Incident,
    /// The other side: transmission.
    Transmitted,
}

impl StartSurfaces {
    /// Collects the surfaces of a program.
    #[must_use]
    pub fn new(program: &Program) -> StartSurfaces {
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
                        entries.push(PlacedSurface { placement, surface });
                        boxes.push(bounds);
                    } else {
                        boxes[at] = boxes[at].union(&bounds);
                    }
                }
            }
        }
        let tree = ExactBvh::listed(&boxes);
        StartSurfaces { entries, boxes, tree }
    }

    /// The surfaces with their boxes; `None` if some belong to placed solids.
    pub(crate) fn unplaced(&self) -> Option<impl Iterator<Item = (Bounds, SurfaceId)> + '_> {
        let is_unplaced = self.entries.iter().all(|entry| entry.placement == PlacementId(0));
        let surfaces = self.entries.iter().map(|entry| entry.surface);
        is_unplaced.then(|| self.boxes.iter().copied().zip(surfaces))
    }

    /// Appends the start list of a ray that leaves a point of an incident ray: the surface of the
    /// crossing there, if there is one, and all other surfaces within the tolerance.
    ///
    /// `known` is the start list of the incident ray; empty if the ray does not begin at t = 0. At an
    /// edge a ray is reflected by one face and then, at t = 0, by the next: its direction does not show
    /// on which side of the first face it is, but its start list does.
    pub fn append(
        &self,
        program: &Program,
        (ray, t): (&Ray, f64),
        crossing: Option<&Crossing>,
        side: ExitSide,
        known: &[Start],
        starts: &mut Vec<Start>,
    ) {
        let first = starts.len();
        if let Some(Crossing { face, .. }) = crossing {
            let gradient = attributes::world_gradient(program, ray, *face, t);
            let inside = starts_inside(gradient.dot(ray.direction), 0.0, side);
            starts.push(Start { surface: face.surface, placement: face.placement, inside });
        }
        let others = starts.len();
        self.append_others(program, (ray, t), first, side, starts);
        if side == ExitSide::Incident && t == 0.0 {
            for start in &mut starts[others..] {
                let own = |s: &&Start| (s.surface, s.placement) == (start.surface, start.placement);
                if let Some(known) = known.iter().find(own) {
                    start.inside = known.inside;
                }
            }
        }
    }

    /// Appends the surfaces within the tolerance of a point of an incident ray to a start list that
    /// begins at `first`, except for those already in it.
    pub(crate) fn append_others(
        &self,
        program: &Program,
        (ray, t): (&Ray, f64),
        first: usize,
        side: ExitSide,
        starts: &mut Vec<Start>,
    ) {
        let point = ray.at(t);
        // the 1-norm bounds the length and needs no square root
        let lengths = ray.origin.abs().element_sum() + t.abs() * ray.direction.abs().element_sum();
        // far above every tolerance: a surface whose grown box does not contain the point is out of
        // reach
        let margin = 1e3 * delta_of(lengths);
        let is_around = |bounds: &Bounds| bounds.grown(margin).contains(point);
        let mut add = |entry: &PlacedSurface| {
            let listed = |s: &Start| (s.surface, s.placement) == (entry.surface, entry.placement);
            if entry.is_far(program, point, lengths) || starts[first..].iter().any(listed) {
                return;
            }
            let inside = entry.side(program, ray, t, side);
            starts.extend(inside.map(|inside| Start {
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

impl PlacedSurface {
    /// True if the surface is certainly out of reach: a conservative form of the test in
    /// [`PlacedSurface::side`].
    fn is_far(&self, program: &Program, point: Vec3, lengths: f64) -> bool {
        let entry = program.surface(self.surface);
        let (value, gradient) = entry.surface.value_and_gradient(point);
        let near = 2.0 * delta_of(lengths + entry.magnitude) * gradient.abs().element_sum();
        self.placement == PlacementId(0) && value.abs() > near
    }

    /// Whether the scattered ray starts inside the surface, if that is within the tolerance of the point.
    fn side(&self, program: &Program, ray: &Ray, t: f64, side: ExitSide) -> Option<bool> {
        let (local, magnitude) = local_ray(program, ray, self.placement);
        let entry = program.surface(self.surface);
        let (value, gradient) = entry.surface.value_and_gradient(local.at(t));
        let near = value.abs() <= delta(entry.magnitude + magnitude, &local, t) * gradient.length();
        near.then(|| starts_inside(gradient.dot(local.direction), value, side))
    }
}

/// Whether a scattered ray starts where f < 0, from the slope of f along the incident ray and its value.
pub(crate) fn starts_inside(slope: f64, value: f64, side: ExitSide) -> bool {
    match side {
        ExitSide::Incident => slope > 0.0 || (slope == 0.0 && value < 0.0),
        ExitSide::Transmitted => slope < 0.0 || (slope == 0.0 && value < 0.0),
    }
}

/// The point of a crossing, projected onto its surface by one Newton step along the normal.
#[must_use]
pub fn project(program: &Program, ray: &Ray, crossing: &Crossing, normal: Vec3) -> Vec3 {
    let (local, _) = local_ray(program, ray, crossing.face.placement);
    let surface = &program.surface(crossing.face.surface).surface;
    let (value, gradient) = surface.value_and_gradient(local.at(crossing.t));
    let steps = program.descend(crossing.face.placement);
    let along = steps.fold(normal, |n, place| place.local_from_world.vector(n));
    newton_step(ray.at(crossing.t), normal, value / gradient.dot(along))
}

/// A point after a step against a direction; a step that is not finite is ignored.
pub(crate) fn newton_step(point: Vec3, normal: Vec3, step: f64) -> Vec3 {
    if step.is_finite() { point - step * normal } else { point }
}
