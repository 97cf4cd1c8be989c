//! Boundary events of one leaf along a ray. All evaluators share them: they define the geometry of a leaf.

use crate::{
    Face, LeafFacet, Place, PlacementId, Program, Prototype, PrototypeId, Start, SurfaceEntry, chord,
};
use rayweave_math::Vec3;
use rayweave_math::roots::Crossings;
use rayweave_shape::Ray;
use rayweave_shape::surface::{Chord, Perturbation, Surface, SurfaceCrossings};

/// A boundary event: a change of side of one leaf of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// The time, in units of the ray's direction.
    pub t: f64,
    /// The leaf, by its number in its group.
    pub leaf: u32,
    /// The face that is crossed.
    pub face: Face,
}

/// Boundary events of one leaf along a ray: its side at -inf and the times in order, each with its facet. A reusable
/// buffer.
#[derive(Clone, Debug, Default)]
pub struct LeafEvents {
    /// True if the leaf is inside as t -> -inf.
    pub starts_inside: bool,
    /// `(t, facet)`, strictly increasing in t.
    pub list: Vec<(f64, u32)>,
    unsorted: Vec<(f64, u32)>,
    holds: Vec<bool>,
}

/// A ray in the frame of a group.
#[derive(Clone, Copy, Debug)]
pub struct GroupRay<'a> {
    /// The ray in the frame of the group.
    pub ray: Ray,
    /// The chord that decides whether the ray lies in a surface.
    pub chord: Chord,
    /// Added to the magnitude of every surface for the maps from the world's frame into this one: see
    /// [`carried`].
    pub magnitude: f64,
    /// The placement of the group.
    pub placement: PlacementId,
    /// Surfaces that the ray starts on.
    pub starts: &'a [Start],
}

/// A ray in the frame of a placed solid, and the length to add there to the magnitude of every surface.
/// The times of the ray are unchanged, but it was rounded on the way: in proportion to the position of its
/// origin and to the lengths of the translations, which may be large in the outer frame and cancel in the
/// inner one. `magnitude` is the length added by earlier steps, in the outer frame.
pub fn carried(place: &Place, ray: &Ray, magnitude: f64) -> (Ray, f64) {
    let down = &place.local_from_world;
    (ray.transformed(down), down.linear_norm() * (ray.origin.length() + place.path + magnitude))
}

/// A point in the frame of a group.
#[derive(Clone, Copy, Debug)]
pub struct GroupPoint {
    /// The point in the frame of the group.
    pub point: Vec3,
    /// Decides the side of a point that lies on a surface.
    pub perturbation: Perturbation,
    /// Length that bounds the rounding error of the point after the maps from the world's frame: see
    /// [`carried`].
    pub magnitude: f64,
}

impl GroupPoint {
    /// A point of the world.
    pub fn world(point: Vec3) -> GroupPoint {
        GroupPoint { point, perturbation: Perturbation::WORLD, magnitude: 0.0 }
    }

    /// The same point in the frame of a solid placed in the group.
    pub fn placed(&self, place: &Place) -> GroupPoint {
        let down = &place.local_from_world;
        let magnitude = down.linear_norm() * (self.point.length() + place.path + self.magnitude);
        GroupPoint {
            point: down.point(self.point),
            perturbation: self.perturbation.transformed(down, magnitude),
            magnitude,
        }
    }
}

impl<'a> GroupRay<'a> {
    /// A ray of the world in the frame of the model itself.
    pub fn world(program: &Program, ray: Ray, starts: &'a [Start]) -> GroupRay<'a> {
        let chord = chord(&program.prototype(PrototypeId(0)).ball, &ray);
        GroupRay { ray, chord, magnitude: 0.0, placement: PlacementId(0), starts }
    }

    /// The same ray in the frame of a solid placed in the group; `placement` is relative to that of the
    /// group.
    pub fn placed(&self, place: &Place, inner: &Prototype, placement: u32) -> GroupRay<'a> {
        let (ray, magnitude) = carried(place, &self.ray, self.magnitude);
        let mut chord = chord(&inner.ball, &ray);
        chord.perturbation = self.chord.perturbation.transformed(&place.local_from_world, magnitude);
        let placement = PlacementId(self.placement.0 + placement);
        GroupRay { ray, chord, magnitude, placement, starts: self.starts }
    }

    /// The crossings of a facet, with its sides as "inside the facet"; `None` if there are more than four.
    fn crossings(&self, program: &Program, facet: LeafFacet) -> Option<SurfaceCrossings> {
        let entry = program.surface(facet.surface());
        let crossings = match self.start(facet) {
            Some(start) => {
                entry.surface.few_crossings_from(&self.ray, start.inside, &self.chord.perturbation)
            }
            None => match self.crossings_in(entry) {
                Some(crossings) => Some(crossings),
                None => entry.surface.few_crossings_in(&self.ray, &self.chord.perturbation),
            },
        };
        if facet.inside() { crossings } else { crossings.map(Crossings::negated) }
    }

    /// The crossing of a facet in a plane: true if the ray starts inside the facet, and the time. `None` for any other facet, and
    /// if the ray may lie in the plane, start on it, or be parallel to it.
    #[inline]
    fn crossing_of_plane(&self, program: &Program, facet: LeafFacet) -> Option<(bool, f64)> {
        let entry = program.surface(facet.surface());
        let Surface::Plane(plane) = &entry.surface else { return None };
        let magnitude = entry.magnitude + self.magnitude;
        if !self.starts.is_empty() || self.chord.may_lie_in_plane(plane, magnitude) {
            return None;
        }
        let crossings = plane.crossings(&self.ray);
        crossings.times().first().map(|&t| (crossings.starts_negative() == facet.inside(), t))
    }

    /// The crossings of the perturbed ray if the ray lies in the surface.
    fn crossings_in(&self, entry: &SurfaceEntry) -> Option<SurfaceCrossings> {
        self.chord.crossings_in(&entry.surface, entry.magnitude + self.magnitude, &self.ray)
    }

    fn start(&self, facet: LeafFacet) -> Option<&Start> {
        self.starts.iter().find(|s| s.surface == facet.surface() && s.placement == self.placement)
    }

    /// Like `crossings` for any number of crossings: passes them to `emit` and returns whether the ray starts
    /// inside the facet.
    fn all_crossings(&self, program: &Program, facet: LeafFacet, emit: &mut dyn FnMut(f64)) -> bool {
        let entry = program.surface(facet.surface());
        let inside = match self.start(facet) {
            Some(start) => {
                entry.surface.all_crossings_from(&self.ray, start.inside, &self.chord.perturbation, emit);
                start.inside
            }
            None => match self.crossings_in(entry) {
                Some(crossings) => {
                    crossings.times().iter().for_each(|&t| emit(t));
                    crossings.starts_negative()
                }
                None => entry.surface.all_crossings_in(&self.ray, &self.chord.perturbation, emit),
            },
        };
        inside == facet.inside()
    }
}

/// Boundary events of a leaf that is a conjunction of facets.
/// If several facets change at the same time, the event belongs to the one with the lowest number. All of them
/// are candidates: undoing any one of them on entry, or doing any one alone on exit, puts the leaf outside.
pub fn leaf_events(program: &Program, facets: &[LeafFacet], ray: &GroupRay, events: &mut LeafEvents) {
    events.list.clear();
    events.starts_inside = false;
    let (mut enter, mut leave) = ((f64::NEG_INFINITY, 0u32), (f64::INFINITY, 0u32));
    for (k, &facet) in facets.iter().enumerate() {
        // planes, which most leaves have several of, without the list of crossings
        match ray.crossing_of_plane(program, facet) {
            Some((true, t)) => leave = earlier(leave, (t, k as u32)),
            Some((false, t)) => enter = later(enter, (t, k as u32)),
            None => {
                let Some(crossings) = ray.crossings(program, facet) else {
                    return general_events(program, facets, ray, events);
                };
                match (crossings.starts_negative(), crossings.times()) {
                    (true, []) => {}
                    (false, []) => return,
                    (true, &[t]) => leave = earlier(leave, (t, k as u32)),
                    (false, &[t]) => enter = later(enter, (t, k as u32)),
                    (false, &[a, b]) => {
                        enter = later(enter, (a, k as u32));
                        leave = earlier(leave, (b, k as u32));
                    }
                    _ => return general_events(program, facets, ray, events),
                }
            }
        }
        // the interval is open: it is empty once it shrinks to a point
        if enter.0 >= leave.0 {
            return;
        }
    }
    events.starts_inside = enter.0 == f64::NEG_INFINITY;
    events.list.extend([enter, leave].into_iter().filter(|(t, _)| t.is_finite()));
}

fn later(a: (f64, u32), b: (f64, u32)) -> (f64, u32) {
    if b.0 > a.0 { b } else { a }
}

fn earlier(a: (f64, u32), b: (f64, u32)) -> (f64, u32) {
    if b.0 < a.0 { b } else { a }
}

/// Like [`leaf_events`] if some facet is inside in more than one piece.
fn general_events(program: &Program, facets: &[LeafFacet], ray: &GroupRay, events: &mut LeafEvents) {
    events.conjunction(facets.len(), |k, emit| ray.all_crossings(program, facets[k], emit));
}

impl LeafEvents {
    /// Boundary events of a conjunction of `count` facets with any number of crossings each: counts the
    /// facets that do not hold, over all events in order of time. `crossings(k, emit)` passes the times at
    /// which facet `k` changes to `emit` and returns whether it holds at the start. Of facets that change at the
    /// same time the lowest number is reported.
    pub fn conjunction(
        &mut self,
        count: usize,
        mut crossings: impl FnMut(usize, &mut dyn FnMut(f64)) -> bool,
    ) {
        let LeafEvents { list, unsorted, holds, starts_inside } = self;
        list.clear();
        unsorted.clear();
        holds.clear();
        for k in 0..count {
            holds.push(crossings(k, &mut |t| unsorted.push((t, k as u32))));
        }
        unsorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut failing = holds.iter().filter(|&&holds| !holds).count();
        *starts_inside = failing == 0;
        let mut inside = *starts_inside;
        let mut rest = &unsorted[..];
        while let Some(&(t, first)) = rest.first() {
            let same = rest.iter().take_while(|event| event.0 == t).count();
            for &(_, facet) in &rest[..same] {
                let holds = &mut holds[facet as usize];
                *holds = !*holds;
                failing = if *holds { failing - 1 } else { failing + 1 };
            }
            if inside != (failing == 0) {
                inside = !inside;
                list.push((t, first));
            }
            rest = &rest[same..];
        }
    }
}

/// True if a point is inside a conjunction of facets. On a surface (f = 0) the symbolic perturbation decides
/// the side, as for a ray that lies in the surface.
pub fn facets_contain(program: &Program, facets: &[LeafFacet], point: &GroupPoint) -> bool {
    facets.iter().all(|facet| {
        let (value, gradient) = program.surface(facet.surface()).surface.value_and_gradient(point.point);
        let negative = if value == 0.0 { point.perturbation.leads_inside(gradient) } else { value < 0.0 };
        negative == facet.inside()
    })
}
