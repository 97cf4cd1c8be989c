//! Start surfaces: the surfaces on which a scattered ray starts, by a point query of the closest surfaces.
//!
//! Reflected or refracted light starts *on* a surface: the root there is divided out, with the side
//! known, so that the ray needs no offset (no ray epsilon) and hits nothing twice. At edges it
//! starts on several surfaces: all within `delta` of the point.

mod contact;
mod neighbours;

pub use self::contact::{Contact, project};

pub(crate) use self::contact::newton_step;

use self::contact::{Map, outer_gradient};
use self::neighbours::{Neighbours, SLACK};
use rayweave_bvh::ExactBvh;
use rayweave_math::{Affine, Bounds, Mat3, Vec3};
use rayweave_model::weld::local_ray;
use rayweave_model::{Crossing, LeafId, PlacementId, Program, Start, SurfaceId};
use rayweave_shape::Ray;
use rayweave_shape::surface::{Surface, delta, delta_of};
use std::collections::HashMap;
use std::ops::{ControlFlow, Range};
use std::sync::Arc;

/// The surfaces of a program, with the boxes in which they matter, for point queries.
#[derive(Clone, Debug, Default)]
pub struct StartSurfaces {
    /// Surfaces of one placement that matter in the same box, and these boxes.
    clusters: Vec<Cluster>,
    boxes: Vec<Bounds>,
    cores: Vec<Core>,
    surfaces: Vec<SurfaceId>,
    /// The same surfaces, each with its placement.
    placed: Vec<(SurfaceId, PlacementId)>,
    /// For each entry of the list of surfaces, a box in which no other surface is within reach; may be empty.
    alone: Vec<Bounds>,
    /// The first entry of each placement in that list, and for each surface its position in the entries of its placement.
    first_of_placement: Vec<u32>,
    position: Vec<u32>,
    /// For each entry of the list of surfaces, its place in the list of planes and spheres, `u32::MAX` for others.
    lane_contact_of: Vec<u32>,
    lane_contacts: Vec<LaneContact>,
    frames: Vec<Frame>,
    /// The maps into the frame of each placement, outermost first, one list after the other, and the first of each list.
    maps: Vec<Map>,
    first_map: Vec<u32>,
    tree: ExactBvh,
    neighbours: Neighbours,
}

/// Surfaces of one placement that matter in the same box.
#[derive(Clone, Debug)]
struct Cluster {
    placement: PlacementId,
    /// A range of the list of surfaces.
    surfaces: Range<u32>,
}

/// A box that is out of reach of all surfaces of a cluster, for points whose tolerance is not extreme; may be empty.
#[derive(Clone, Copy, Debug)]
struct Core {
    bounds: Bounds,
    /// The only surface beyond each side, low sides first; `None` if there are several.
    beyond: [Option<SurfaceId>; 6],
}

/// A sphere in the world.
#[derive(Clone, Copy, Debug)]
struct Ball {
    centre: Vec3,
    radius: f64,
}

/// The largest deviation from 1 or 0 of the products of the axes of a frame that is neither stretched nor sheared.
const RIGID: f64 = 1e-9;

impl Ball {
    /// True if points within `slack` of one sphere are out of reach of the other one: the values of f there exceed its gradient
    /// times half of the distance, which is more than `slack`.
    fn is_apart(&self, other: &Ball, slack: f64) -> bool {
        let (sum, distance) = (self.radius + other.radius, (self.centre - other.centre).length());
        let gap = (distance - sum).max((self.radius - other.radius).abs() - distance);
        gap > 4.0 * slack + RIGID * (sum + distance)
    }
}

/// The frame of a placement, for a conservative test whether a surface is out of reach.
#[derive(Clone, Copy, Debug)]
struct Frame {
    /// The composed map, which may differ by rounding from the maps that are applied to rays one after the other.
    local_from_world: Affine,
    /// Upper bound of the factor by which it scales a length.
    norm: f64,
    /// The lengths of the translations composed into it.
    path: f64,
}

/// A plane or a sphere that rays cross, in a frame that is not turned: for callers that evaluate the contacts of several rays at
/// once, by the operations of [`Contact`].
#[derive(Clone, Copy, Debug)]
pub struct LaneContact {
    /// The surface in its frame.
    pub shape: LaneShape,
    /// The translation into that frame; `None` in the world.
    pub shift: Option<Vec3>,
    /// A box of points on the surface that no other surface is within reach of: the start list of a ray that leaves such a point has
    /// the surface alone. It holds for an incident ray whose origin and way to the point have 1-norms with a sum of at most
    /// [`StartSurfaces::alone_lengths`], and may be empty.
    pub alone: Bounds,
}

/// The surface of a [`LaneContact`].
#[derive(Clone, Copy, Debug)]
pub enum LaneShape {
    /// The plane n p = c.
    Plane {
        /// The unit normal n.
        normal: Vec3,
        /// The offset c.
        offset: f64,
        /// The gradient in the world, up to a positive factor.
        gradient: Vec3,
    },
    /// The sphere |p - c|^2 = r^2.
    Sphere {
        /// The centre c.
        centre: Vec3,
        /// The square of the radius r.
        square: f64,
    },
}

/// The side of a surface on which a scattered ray leaves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExitSide {
    /// The side of the incident light: reflection.
    Incident,
    /// The other side: transmission.
    Transmitted,
}

/// Number of boxes that touch a face above which no part of the face is searched that is far from all of them.
const MANY: usize = 64;

/// Number of placements from which on their data do not fit into the cache.
const LARGE: usize = 1000;

/// Nesting depth up to which the bounds of a composed map are used; in deeper frames no surface counts as far.
const NESTED: usize = 4;

impl StartSurfaces {
    /// Collects the surfaces of a program.
    #[must_use]
    pub fn new(program: &Program) -> StartSurfaces {
        let mut found = StartSurfaces::default();
        let mut of_surface = vec![0; program.surfaces().len()];
        let mut position = vec![0; program.surfaces().len()];
        let mut of_placement = Vec::new();
        let mut matters = HashMap::new();
        let mut linear_parts = HashMap::<[u64; 9], Arc<Mat3>>::new();
        for placement in (0..program.prototypes()[0].placements).map(PlacementId) {
            let (world_from_local, id) = program.placement(placement);
            let group = program.prototype(id);
            let boxes_of_leaves = matters.entry(id).or_insert_with(|| program.matters(group));
            let mut known = HashMap::new();
            let mut placed: Vec<(Bounds, SurfaceId)> = Vec::new();
            for (leaf, bounds) in group.leaves.clone().map(LeafId).zip(&*boxes_of_leaves) {
                if bounds.is_empty() {
                    continue;
                }
                let bounds = bounds.transformed(&world_from_local);
                for surface in program.leaf(leaf).facets().iter().map(|facet| facet.surface()) {
                    let new = placed.len();
                    let at = *known.entry(surface).or_insert(new);
                    if at == new {
                        placed.push((bounds, surface));
                    } else {
                        placed[at].0 = placed[at].0.union(&bounds);
                    }
                }
            }
            of_placement.push(found.clusters.len() as u32);
            found.frames.push(Frame::new(program, placement));
            found.first_map.push(found.maps.len() as u32);
            found.maps.extend(program.descend(placement).map(|place| {
                let Affine { linear, translation } = place.local_from_world;
                let key = linear.to_cols_array().map(f64::to_bits);
                Map {
                    translation,
                    linear: linear_parts.entry(key).or_insert_with(|| Arc::new(linear)).clone(),
                }
            }));
            let first_of_placement = found.surfaces.len() as u32;
            found.first_of_placement.push(first_of_placement);
            for same in placed.chunk_by(|a, b| a.0 == b.0) {
                let first = found.surfaces.len() as u32;
                for (_, surface) in same {
                    position[surface.index()] = found.surfaces.len() as u32 - first_of_placement;
                    of_surface[surface.index()] =
                        found.clusters.len() as u32 - of_placement[placement.index()];
                    found.surfaces.push(*surface);
                    found.placed.push((*surface, placement));
                }
                found.clusters.push(Cluster { placement, surfaces: first..found.surfaces.len() as u32 });
                found.boxes.push(same[0].0);
            }
        }
        found.first_map.push(found.maps.len() as u32);
        found.position = position;
        found.list_lane_contacts(program);
        found.tree = ExactBvh::listed(&found.boxes);
        found.neighbours =
            Neighbours { of_placement, of_surface, ..Neighbours::new(&found.boxes, &found.tree) };
        found.cores = (0..found.clusters.len()).map(|k| found.core(program, k)).collect();
        found.alone = (0..found.clusters.len()).flat_map(|k| found.alone_in(program, k)).collect();
        let listed =
            found.alone.iter().zip(&found.lane_contact_of).filter(|(_, number)| **number != u32::MAX);
        for (contact, (alone, _)) in found.lane_contacts.iter_mut().zip(listed) {
            contact.alone = *alone;
        }
        found
    }

    /// Lists the planes and spheres in frames that are not turned.
    fn list_lane_contacts(&mut self, program: &Program) {
        for cluster in &self.clusters {
            let k = cluster.placement.index();
            let maps = &self.maps[self.first_map[k] as usize..self.first_map[k + 1] as usize];
            let shift = match maps {
                [] => Some(None),
                [map] => (*map.linear == Affine::IDENTITY.linear).then_some(Some(map.translation)),
                _ => None,
            };
            for &surface in &self.surfaces[cluster.surfaces.start as usize..cluster.surfaces.end as usize] {
                let shape = match &program.surface(surface).surface {
                    Surface::Plane(plane) => Some(LaneShape::Plane {
                        normal: plane.normal,
                        offset: plane.offset,
                        gradient: outer_gradient(plane.normal, maps.iter().map(Map::affine)),
                    }),
                    Surface::Sphere(sphere) => Some(LaneShape::Sphere {
                        centre: sphere.centre,
                        square: sphere.radius * sphere.radius,
                    }),
                    _ => None,
                };
                let contact =
                    shape.zip(shift).map(|(shape, shift)| LaneContact { shape, shift, alone: Bounds::EMPTY });
                self.lane_contact_of.push(contact.map_or(u32::MAX, |_| self.lane_contacts.len() as u32));
                self.lane_contacts.extend(contact);
            }
        }
    }

    /// The planes and spheres in frames that are not turned.
    #[must_use]
    pub fn lane_contacts(&self) -> &[LaneContact] {
        &self.lane_contacts
    }

    /// The place of a surface of a placement in [`lane_contacts`](StartSurfaces::lane_contacts), if it is one of them.
    #[must_use]
    #[inline]
    pub fn lane_contact(&self, surface: SurfaceId, placement: PlacementId) -> Option<u32> {
        let first = self.first_of_placement[placement.index()];
        let number = self.lane_contact_of[(first + self.position[surface.index()]) as usize];
        (number != u32::MAX).then_some(number)
    }

    /// The place of a surface of a placement in the list of all surfaces; `None` if the surface is nowhere on the boundary.
    #[must_use]
    #[inline]
    pub fn place(&self, surface: SurfaceId, placement: PlacementId) -> Option<u32> {
        let place = self.first_of_placement.get(placement.index())? + self.position.get(surface.index())?;
        (self.placed.get(place as usize) == Some(&(surface, placement))).then_some(place)
    }

    /// The surface and the placement at a [`place`](StartSurfaces::place) in the list.
    ///
    /// # Panics
    ///
    /// On places beyond the list.
    #[must_use]
    #[inline]
    pub fn placed(&self, place: u32) -> (SurfaceId, PlacementId) {
        self.placed[place as usize]
    }

    /// Reads what the contacts with some surfaces of placements need. Among thousands of copies it is not in the cache, and a loop
    /// without any other work waits for many of these reads at once.
    pub fn read_ahead(&self, surfaces: impl Iterator<Item = (SurfaceId, PlacementId)>) {
        if self.first_map.len() < LARGE {
            return;
        }
        let mut bits = 0;
        for (surface, placement) in surfaces {
            let k = placement.index();
            let at = self.first_of_placement[k] + self.position[surface.index()];
            if let Some(contact) = self.lane_contacts.get(self.lane_contact_of[at as usize] as usize) {
                let LaneContact { shift, alone, .. } = contact;
                bits ^=
                    shift.map_or(0, |shift| shift.x.to_bits()) ^ alone.lo.x.to_bits() ^ alone.hi.z.to_bits();
                continue;
            }
            if let Some(map) = self.maps.get(self.first_map[k] as usize) {
                bits ^= map.translation.x.to_bits() ^ Arc::as_ptr(&map.linear) as u64;
            }
            let alone = &self.alone[at as usize];
            bits ^= alone.lo.x.to_bits() ^ alone.hi.z.to_bits();
        }
        std::hint::black_box(bits);
    }

    /// The largest sum of a ray's lengths for which the boxes [`alone`](LaneContact::alone) hold.
    #[must_use]
    pub fn alone_lengths(&self) -> f64 {
        // the margin in `append_others`, with room for rounding
        self.neighbours.slack / reach(1.0) * (1.0 - 1e-9)
    }

    /// The surfaces with their boxes; `None` if some belong to placed solids.
    pub(crate) fn unplaced(&self) -> Option<impl Iterator<Item = (Bounds, SurfaceId)> + '_> {
        let is_unplaced = self.clusters.iter().all(|cluster| cluster.placement == PlacementId(0));
        let surfaces = self.clusters.iter().zip(&self.boxes).flat_map(|(cluster, &bounds)| {
            self.surfaces_of(cluster).iter().map(move |&surface| (bounds, surface))
        });
        is_unplaced.then_some(surfaces)
    }

    /// The largest box about the centre of a cluster that none of its surfaces intersects, if all are planes perpendicular to
    /// the world axes; otherwise an empty one.
    fn core(&self, program: &Program, k: usize) -> Core {
        let (cluster, bounds, slack) = (&self.clusters[k], &self.boxes[k], self.neighbours.slack);
        let frame = &self.frames[cluster.placement.index()];
        let magnitudes = self.surfaces_of(cluster).iter().map(|&surface| program.surface(surface).magnitude);
        let lengths = frame.norm * (slack / SLACK) + frame.path + magnitudes.fold(0.0, f64::max);
        let stretch = program.placement(cluster.placement).0.linear_norm();
        // tolerances in the frame are not much larger than in the world
        let is_certain = frame.norm * stretch < 100.0 && 1e3 * delta_of(lengths) * stretch <= slack;
        if !bounds.is_finite() || !is_certain {
            return Core::EMPTY;
        }
        let (centre, mut core) = (bounds.centre(), Core { bounds: Bounds::ALL, beyond: [None; 6] });
        let mut counts = [0; 6];
        for &surface in self.surfaces_of(cluster) {
            let Surface::Plane(plane) = &program.surface(surface).surface else { return Core::EMPTY };
            let Affine { linear, translation } = frame.local_from_world;
            let normal = linear.transpose() * plane.normal;
            let axis = normal.abs().max_position();
            let others = normal.abs().element_sum() - normal[axis].abs();
            if others > 1e-12 * normal[axis].abs() {
                return Core::EMPTY;
            }
            let at = (plane.offset - plane.normal.dot(translation)) / normal[axis];
            let is_high = at > centre[axis];
            match is_high {
                true => core.bounds.hi[axis] = core.bounds.hi[axis].min(at - slack),
                false => core.bounds.lo[axis] = core.bounds.lo[axis].max(at + slack),
            }
            let side = axis + 3 * usize::from(is_high);
            counts[side] += 1;
            core.beyond[side] = (counts[side] == 1).then_some(surface);
        }
        core
    }

    /// For each surface of a cluster, a box in which all other surfaces are out of reach: the part of its face that is far
    /// from the edges of its cluster and from its neighbours. Empty where no such box is found.
    fn alone_in(&self, program: &Program, k: usize) -> Vec<Bounds> {
        let slack = self.neighbours.slack;
        let Core { bounds: core, beyond } = self.cores[k];
        let surfaces = self.surfaces_of(&self.clusters[k]);
        let own = self.boxes[k].grown(slack);
        let alone = surfaces.iter().map(|surface| {
            let mut face = match surfaces {
                [_] => own,
                _ => {
                    let Some(side) = beyond.iter().position(|other| *other == Some(*surface)) else {
                        return Bounds::EMPTY;
                    };
                    let (mut face, axis) = (core, side % 3);
                    // the plane is `slack` beyond the core
                    match side < 3 {
                        true => (face.lo[axis], face.hi[axis]) = (core.lo[axis] - 2.0 * slack, core.lo[axis]),
                        false => {
                            (face.lo[axis], face.hi[axis]) = (core.hi[axis], core.hi[axis] + 2.0 * slack)
                        }
                    }
                    face.intersection(&own)
                }
            };
            // twice, for the rounding of the sums
            let (wide, mut near) = (face.grown(2.0 * slack), Vec::new());
            let is_near = |other: &Bounds| !other.intersection(&wide).is_empty();
            let all = self.tree.visit(is_near, |other| {
                near.push(other);
                if near.len() > MANY { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            if all.is_break() {
                return Bounds::EMPTY;
            }
            let ball = self.ball(program, k);
            for other in near.into_iter().filter(|&other| other != k) {
                // a ball within another one lies in its box
                if let (Some(ball), Some(other)) = (ball, self.ball(program, other))
                    && ball.is_apart(&other, slack)
                {
                    continue;
                }
                face = self.without(face, other);
            }
            face
        });
        alone.collect()
    }

    /// A large part of a box that a cluster does not reach.
    fn without(&self, face: Bounds, other: usize) -> Bounds {
        let around = self.boxes[other].grown(self.neighbours.slack);
        if face.is_empty() || face.intersection(&around).is_empty() {
            return face;
        }
        let mut parts = vec![face.intersection(&self.cores[other].bounds)];
        for axis in 0..3 {
            let (mut below, mut above) = (face, face);
            below.hi[axis] = below.hi[axis].min(around.lo[axis].next_down());
            above.lo[axis] = above.lo[axis].max(around.hi[axis].next_up());
            parts.extend([below, above]);
        }
        let volume = |part: &Bounds| {
            let size = (part.hi - part.lo).max(Vec3::ZERO);
            size.x * size.y * size.z
        };
        let largest = parts.into_iter().filter(|part| !part.is_empty());
        largest.max_by(|a, b| volume(a).total_cmp(&volume(b))).unwrap_or(Bounds::EMPTY)
    }

    /// The sphere of a cluster of only one surface, in the world, if its frame is neither stretched nor sheared.
    fn ball(&self, program: &Program, k: usize) -> Option<Ball> {
        let cluster = &self.clusters[k];
        let &[surface] = self.surfaces_of(cluster) else { return None };
        let Surface::Sphere(sphere) = &program.surface(surface).surface else { return None };
        let (up, _) = program.placement(cluster.placement);
        let square = up.linear.transpose() * up.linear;
        let is_rigid =
            (0..3).all(|i| (0..3).all(|j| (square.col(i)[j] - if i == j { 1.0 } else { 0.0 }).abs() < RIGID));
        is_rigid.then(|| Ball { centre: up.point(sphere.centre), radius: sphere.radius })
    }

    fn surfaces_of(&self, cluster: &Cluster) -> &[SurfaceId] {
        &self.surfaces[cluster.surfaces.start as usize..cluster.surfaces.end as usize]
    }

    /// Evaluates the surface of a crossing.
    #[must_use]
    #[inline]
    pub fn contact<'a>(&'a self, program: &'a Program, ray: &'a Ray, crossing: &Crossing) -> Contact<'a> {
        let k = crossing.face.placement.index();
        let maps = &self.maps[self.first_map[k] as usize..self.first_map[k + 1] as usize];
        Contact::new(program, ray, crossing, maps)
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
        match crossing {
            Some(crossing) => self.append_at(&self.contact(program, ray, crossing), side, known, starts),
            None => {
                let first = starts.len();
                self.append_others(program, (ray, t), first, side, starts);
                keep_sides((t, side), known, &mut starts[first..]);
            }
        }
    }

    /// Appends the start list of a ray that leaves a crossing: the surface of the crossing and all others within the
    /// tolerance. `known` is the start list of the incident ray, as for [`append`](StartSurfaces::append).
    pub fn append_at(&self, contact: &Contact<'_>, side: ExitSide, known: &[Start], starts: &mut Vec<Start>) {
        let &Contact { program, ray, t, face, .. } = contact;
        let inside = starts_inside(contact.slope(), 0.0, side);
        let own = Start { surface: face.surface, placement: face.placement, inside };
        self.append_on(program, (ray, t), (own, side), known, starts);
    }

    /// Like [`append_at`](StartSurfaces::append_at), for a known side of the surface of the crossing.
    pub fn append_on(
        &self,
        program: &Program,
        (ray, t): (&Ray, f64),
        (own, side): (Start, ExitSide),
        known: &[Start],
        starts: &mut Vec<Start>,
    ) {
        let first = starts.len();
        starts.push(own);
        self.append_others(program, (ray, t), first, side, starts);
        keep_sides((t, side), known, &mut starts[first + 1..]);
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
        let lengths = lengths(ray, t);
        let margin = reach(lengths);
        let own = starts.get(first).copied();
        if margin <= self.neighbours.slack && own.is_some_and(|own| self.is_alone(&own, point)) {
            return;
        }
        let is_around = |bounds: &Bounds| bounds.grown(margin).contains(point);
        let at = Departure { program, ray, t, point, lengths, side };
        let is_core = |k: usize| {
            let same = own.filter(|own| own.placement == self.clusters[k].placement);
            let except = same.map(|own| own.surface);
            margin <= self.neighbours.slack && self.cores[k].is_clear(point, except)
        };
        let near = own.and_then(|own| self.neighbours.of(&own));
        match near.filter(|(own, _)| self.neighbours.cover(&self.boxes[*own], point, margin)) {
            Some((_, near)) => {
                for k in near.iter().map(|&k| k as usize) {
                    if is_around(&self.boxes[k]) && !is_core(k) {
                        self.append_cluster(k, &at, first, starts);
                    }
                }
            }
            None => {
                let _ = self.tree.visit(is_around, |k| {
                    if !is_core(k) {
                        self.append_cluster(k, &at, first, starts);
                    }
                    ControlFlow::Continue(())
                });
            }
        }
    }

    /// True if no other surface is within reach of a point on a surface, for tolerances within the slack.
    fn is_alone(&self, own: &Start, point: Vec3) -> bool {
        let at = self.first_of_placement[own.placement.index()] + self.position[own.surface.index()];
        self.alone[at as usize].contains(point)
    }

    /// Appends the surfaces of a cluster that are within the tolerance.
    fn append_cluster(&self, k: usize, at: &Departure<'_>, first: usize, starts: &mut Vec<Start>) {
        let cluster = &self.clusters[k];
        let placement = cluster.placement;
        let frame = &self.frames[placement.index()];
        let (point, reach) = match placement {
            PlacementId(0) => (at.point, at.lengths),
            _ => (frame.local_from_world.point(at.point), frame.norm * at.lengths + frame.path),
        };
        for &surface in self.surfaces_of(cluster) {
            let listed = |s: &Start| (s.surface, s.placement) == (surface, placement);
            if is_far(at.program, surface, point, reach) || starts[first..].iter().any(listed) {
                continue;
            }
            let inside = at.side(surface, placement);
            starts.extend(inside.map(|inside| Start { surface, placement, inside }));
        }
    }
}

/// Sets the sides of surfaces of a reflected ray to those in the incident ray's start list, if the incident ray is
/// reflected where it starts: its direction does not show the sides.
fn keep_sides((t, side): (f64, ExitSide), known: &[Start], starts: &mut [Start]) {
    if side != ExitSide::Incident || t != 0.0 {
        return;
    }
    for start in starts {
        let own = |s: &&Start| (s.surface, s.placement) == (start.surface, start.placement);
        if let Some(known) = known.iter().find(own) {
            start.inside = known.inside;
        }
    }
}

/// Upper bound of the lengths of a ray's origin and of its path to a point: the 1-norm needs no square root.
#[inline]
fn lengths(ray: &Ray, t: f64) -> f64 {
    ray.origin.abs().element_sum() + t.abs() * ray.direction.abs().element_sum()
}

/// A margin far above every tolerance: a surface whose box, grown by it, does not contain a point of a ray is out of reach there.
/// `lengths` is an upper bound of the lengths to the point.
#[inline]
fn reach(lengths: f64) -> f64 {
    1e3 * delta_of(lengths)
}

/// True if the surface is certainly out of reach of a point that is known up to rounding: a conservative form of the test in
/// [`Departure::side`].
fn is_far(program: &Program, surface: SurfaceId, point: Vec3, reach: f64) -> bool {
    let entry = program.surface(surface);
    let (value, gradient) = entry.surface.value_and_gradient(point);
    value.abs() > 1e3 * delta_of(reach + entry.magnitude) * gradient.abs().element_sum()
}

/// A point at which a ray is scattered.
struct Departure<'a> {
    program: &'a Program,
    /// The incident ray and its time at the point.
    ray: &'a Ray,
    t: f64,
    point: Vec3,
    /// Upper bound of the lengths of the ray's origin and of its path to the point.
    lengths: f64,
    side: ExitSide,
}

impl Departure<'_> {
    /// Whether the scattered ray starts inside a surface, if that is within the tolerance of the point.
    fn side(&self, surface: SurfaceId, placement: PlacementId) -> Option<bool> {
        let (local, magnitude) = local_ray(self.program, self.ray, placement);
        let entry = self.program.surface(surface);
        let (value, gradient) = entry.surface.value_and_gradient(local.at(self.t));
        let near = value.abs() <= delta(entry.magnitude + magnitude, &local, self.t) * gradient.length();
        near.then(|| starts_inside(gradient.dot(local.direction), value, self.side))
    }
}

impl Core {
    const EMPTY: Core = Core { bounds: Bounds::EMPTY, beyond: [None; 6] };

    /// True if no surface of the cluster is within reach of a point, except for the given one.
    fn is_clear(&self, point: Vec3, except: Option<SurfaceId>) -> bool {
        let Bounds { lo, hi } = self.bounds;
        let (mut count, mut side) = (0, 0);
        for axis in 0..3 {
            for (k, is_beyond) in [(axis, point[axis] < lo[axis]), (axis + 3, point[axis] > hi[axis])] {
                count += usize::from(is_beyond);
                side = if is_beyond { k } else { side };
            }
        }
        // within reach of one plane, and out of reach of all others
        count == 0 || (count == 1 && except.is_some() && self.beyond[side] == except)
    }
}

impl Frame {
    fn new(program: &Program, placement: PlacementId) -> Frame {
        let mut frame = Frame { local_from_world: Affine::IDENTITY, norm: 1.0, path: 0.0 };
        for (depth, place) in program.descend(placement).enumerate() {
            let norm = place.local_from_world.linear_norm();
            frame.local_from_world = frame.local_from_world.then(&place.local_from_world);
            frame.norm *= norm;
            frame.path = norm * (frame.path + place.path);
            if depth == NESTED {
                // the bounds may not cover the rounding errors of deeper frames: no surface is far
                frame.norm = f64::INFINITY;
            }
        }
        frame
    }
}

/// Whether a scattered ray starts where f < 0, from the slope of f along the incident ray and its value.
pub(crate) fn starts_inside(slope: f64, value: f64, side: ExitSide) -> bool {
    match side {
        ExitSide::Incident => slope > 0.0 || (slope == 0.0 && value < 0.0),
        ExitSide::Transmitted => slope < 0.0 || (slope == 0.0 && value < 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_model::{Region, Solid};
    use rayweave_shape::primitive::{Value, build};

    fn shape(name: &str, argument: &str, value: f64) -> Solid {
        Solid::from(build(name, &[(argument, Value::Number(value))]).unwrap())
    }

    /// Touching boxes (plain, rotated and nested) and balls in a large box.
    fn model() -> Program {
        let cube = shape("box", "size", 2.0);
        let grid: Vec<Affine> = (0..27)
            .map(|k| {
                Affine::translate(2.0 * Vec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9)))
            })
            .collect();
        let turned = |angle: f64| {
            (0..4).map(move |k| {
                Affine::rotation(Vec3::Z, angle).then(&Affine::translate(Vec3::new(
                    -4.0,
                    3.0 * f64::from(k),
                    1.0,
                )))
            })
        };
        let maps: Vec<Affine> = turned(90.0).chain(turned(30.0)).collect();
        let inner = shape("box", "size", 1.0);
        let solids = [
            shape("box", "size", 40.0),
            cube.place(grid.clone()),
            cube.place(maps.clone()),
            inner.place(maps),
            shape("sphere", "radius", 1.0).place(grid.clone()),
            shape("sphere", "radius", 0.5).place(grid),
        ];
        let region =
            |(k, solid): (u32, &Solid)| Region { name: format!("{k}"), solid: solid.clone(), medium: k + 1 };
        Program::compile_regions(&(0..).zip(&solids).map(region).collect::<Vec<_>>()).unwrap()
    }

    /// The list of a point equals the result of testing all surfaces.
    #[test]
    fn lists_hold_all_surfaces_near_a_point() {
        let program = model();
        let all = StartSurfaces::new(&program);
        let mut state = 1u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let (mut longest, mut by_list, mut by_core, mut by_own_core, mut alone) = (0, 0, 0, 0, 0);
        for k in 0..all.clusters.len() {
            let (cluster, bounds) = (&all.clusters[k], all.boxes[k]);
            let (up, _) = program.placement(cluster.placement);
            for &surface in all.surfaces_of(cluster) {
                for _ in 0..20 {
                    let inside = Vec3::new(uniform(), uniform(), uniform());
                    // some of them on edges and corners
                    let inside = if uniform() < 0.3 { inside.round() } else { inside };
                    let place = bounds.lo + inside * (bounds.hi - bounds.lo);
                    let mut local = all.frames[cluster.placement.index()].local_from_world.point(place);
                    for _ in 0..6 {
                        let (f, gradient) = program.surface(surface).surface.value_and_gradient(local);
                        local -= gradient * (f / gradient.length_squared());
                    }
                    let origin = 6.0 * Vec3::new(uniform(), uniform(), uniform());
                    let ray = Ray::new(origin, up.point(local) - origin);
                    let side = ExitSide::Incident;
                    let own = Start { surface, placement: cluster.placement, inside: false };
                    let mut starts = vec![own];
                    all.append_others(&program, (&ray, 1.0), 0, side, &mut starts);
                    let point = ray.at(1.0);
                    let lengths = ray.origin.abs().element_sum() + ray.direction.abs().element_sum();
                    let at = Departure { program: &program, ray: &ray, t: 1.0, point, lengths, side };
                    let margin = 1e3 * delta_of(lengths);
                    let mut expected = vec![own];
                    for (j, other) in all.clusters.iter().enumerate() {
                        let is_near = all.boxes[j].grown(margin).contains(point);
                        for &surface in all.surfaces_of(other) {
                            let inside = at.side(surface, other.placement).filter(|_| is_near);
                            let start = |inside| Start { surface, placement: other.placement, inside };
                            let new = |start: &Start| {
                                (start.surface, start.placement) != (own.surface, own.placement)
                            };
                            expected.extend(inside.map(start).filter(new));
                        }
                        let is_clear = |except| is_near && all.cores[j].is_clear(point, except);
                        by_core += usize::from(is_clear(None));
                        let except = (other.placement == own.placement).then_some(own.surface);
                        by_own_core += usize::from(is_clear(except) && !is_clear(None));
                    }
                    let key = |start: &Start| (start.placement, start.surface);
                    starts.sort_by_key(key);
                    expected.sort_by_key(key);
                    assert_eq!(starts, expected, "at {point} on {own:?}");
                    longest = longest.max(starts.len());
                    by_list += usize::from(all.neighbours.of(&own).is_some());
                    alone += usize::from(all.is_alone(&own, point));
                }
            }
        }
        assert!(longest >= 6 && by_list > 1000, "{longest} {by_list}");
        assert!(by_core > 1000 && by_own_core > 1000 && alone > 500, "{by_core} {by_own_core} {alone}");
    }
}
