//! Eight photons under way in boxes, and their steps.

use super::cell::{BOXES, CellRows, LoadedCell, NONE, PATHS};
use super::next::{Next, OnFaces, at_axis};
use crate::boundary::{BARE_EVENTS, BoundaryEvent, Group, PAINTED_EVENTS};
use crate::draws::{LEAST_EXPONENTIAL, Words, exponential, free_path_uniforms};
use crate::flight::End;
use crate::free_path::shortest;
use crate::rows::{Row, load, vector};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Bounds;
use rayweave_shape::lanes::{LANES, Lanes, Mask, splat};

/// The number of steps, and the events at their ends.
#[derive(Debug, Default)]
pub(crate) struct BoxStepCounts {
    pub steps: u64,
    bare: [u64; 3],
    painted: [u64; 3],
    /// The photons absorbed in materials, and at surfaces.
    absorbed: [u64; 2],
}

impl BoxStepCounts {
    /// The events that occurred, with their numbers.
    pub fn events(&self) -> impl Iterator<Item = (BoundaryEvent, u64)> {
        let bare = BARE_EVENTS.into_iter().zip(self.bare);
        let painted = PAINTED_EVENTS.into_iter().zip(self.painted);
        let absorbed = [(BoundaryEvent::Absorption, self.absorbed[1])];
        bare.chain(painted).chain(absorbed).filter(|(_, count)| *count > 0)
    }

    /// The ways in which photons ended, with their numbers.
    pub fn ends(&self) -> impl Iterator<Item = (End, u64)> {
        let ends = [End::Absorbed, End::SurfaceAbsorbed].into_iter().zip(self.absorbed);
        ends.filter(|(_, count)| *count > 0)
    }
}

/// Eight photons under way, with what they need of their cells.
#[derive(Debug)]
pub(super) struct Eight {
    /// Bit mask of the lanes in use, and of the photons that have made a step.
    pub active: u64,
    pub moved: u64,
    /// The places of the photons in their batch.
    pub at: [usize; LANES],
    pub cell: [u32; LANES],
    pub energy: Row,
    /// The last two cells of each lane, and the place of the last one: photons often go back to the one before.
    pub loaded: [[LoadedCell; 2]; LANES],
    pub last: [usize; LANES],
    pub position: [Row; 3],
    pub direction: [Row; 3],
    pub polarisation: [Row; 3],
    pub time: Row,
    /// The counters of the random numbers of the last step.
    pub counters: [Words; 3],
    /// The face on which each photon starts: the place of its box in the list of the cell, and the number of the axis, plus 3 for
    /// high faces.
    pub place: Row,
    pub face: Row,
    velocity: Row,
    /// The mean free paths of the processes; +inf for none.
    paths: [Row; PATHS],
    /// Bit masks of the processes that are absorption.
    absorbs: [u64; PATHS],
    pub boxes: CellRows,
}

/// The ends of the steps of eight photons.
pub(super) struct Ends {
    /// Bit masks of the photons that have made a step and go on, and of those behind the boundary.
    pub stepped: u64,
    pub behind: u64,
    /// Bit masks of the photons that were absorbed in a material, and at a surface.
    pub absorbed: [u64; 2],
    pub place: Row,
    pub face: Row,
}

/// The contacts of eight photons with faces.
struct FaceContact<S: Simd> {
    /// The numbers of the faces.
    face: Lanes<S>,
    /// The normals, against the photons.
    normal: [Row; 3],
    /// The points of the crossings, before and after their projection onto the faces.
    points: [Row; 3],
    on_face: [Row; 3],
    /// Bit mask of the photons for whose lengths the boxes of
    /// [`LaneContact`](rayweave_optics::start_surfaces::LaneContact) hold.
    near: u64,
}

/// Bit masks of the kinds of boundaries, as in [`CellRows::boundaries`].
struct Meetings {
    bare: u64,
    painted: u64,
    detecting: u64,
}

/// The common data of the steps of all photons.
pub(super) struct World<'d> {
    pub seed: u64,
    pub max_steps: u32,
    pub max_time: f64,
    /// See [`BoxCells`](rayweave_model::BoxCells).
    pub margin: f64,
    pub zeros: [f64; 2],
    /// See [`StartSurfaces`](rayweave_optics::start_surfaces::StartSurfaces).
    pub alone_lengths: f64,
    /// For each face of each box, the points out of reach of all surfaces but its own.
    pub alone: &'d [Bounds],
}

/// Writes vectors in some lanes.
#[inline(always)]
fn write<S: Simd>(simd: S, rows: &mut [Row; 3], some: Mask<S>, values: &[Row; 3]) {
    for k in 0..3 {
        some.select(load(simd, &values[k]), load(simd, &rows[k])).store_array(&mut rows[k]);
    }
}

impl Default for Eight {
    fn default() -> Eight {
        let (zero, one) = ([0.0; LANES], [1.0; LANES]);
        Eight {
            active: 0,
            moved: 0,
            at: [0; LANES],
            cell: [NONE; LANES],
            energy: zero,
            loaded: [[LoadedCell::NONE; 2]; LANES],
            last: [0; LANES],
            position: [zero; 3],
            // lanes that are not in use have a direction
            direction: [one; 3],
            polarisation: [one; 3],
            time: zero,
            counters: [[0; LANES]; 3],
            place: zero,
            face: zero,
            velocity: one,
            paths: [one; PATHS],
            absorbs: [0; PATHS],
            boxes: CellRows::default(),
        }
    }
}

impl Eight {
    /// Puts one of the last two cells of a lane into it.
    pub fn put(&mut self, lane: usize, place: usize) {
        let own = &self.loaded[lane][place];
        self.last[lane] = place;
        (self.cell[lane], self.energy[lane], self.velocity[lane]) = (own.cell, own.energy, own.velocity);
        for (k, &(mean, absorbs)) in own.paths.iter().enumerate() {
            self.paths[k][lane] = mean;
            self.absorbs[k] = self.absorbs[k] & !(1 << lane) | u64::from(absorbs) << lane;
        }
        self.boxes.put(lane, own);
    }

    /// Makes the steps that are certain.
    #[inline(always)]
    pub fn step<S: Simd>(&mut self, simd: S, world: &World<'_>, counts: &mut BoxStepCounts) -> Ends {
        let Eight { position, direction, place, face, .. } = &*self;
        let photons = OnFaces { position, direction, place, face, active: self.active };
        let next = self.boxes.next(simd, &photons, world.margin);
        let mut counters = self.counters;
        let (mut limited, limit) = (0, u64::from(world.max_steps));
        for lane in 0..LANES {
            limited |= u64::from(counters[2][lane] >= limit) << lane;
            counters[2][lane] += 1;
        }
        let known = self.active & !limited & !next.unsure.to_bitmask();
        let [long, absorbed] = self.free(simd, world, (known, &counters), next.t);
        counts.absorbed[0] += u64::from(absorbed.count_ones());
        let time = load(simd, &self.time) + next.t / load(simd, &self.velocity);
        let reached = known & long & time.simd_le(splat(simd, world.max_time)).to_bitmask();
        let contact = self.contact(simd, world, &next);
        let mut ends = Ends {
            stepped: 0,
            behind: 0,
            absorbed: [absorbed, 0],
            place: next.place.to_array(),
            face: contact.face.to_array(),
        };
        let mut group = Group {
            direction: self.direction,
            polarisation: self.polarisation,
            normal: contact.normal,
            counters,
            ..Group::default()
        };
        let met = self.boundaries(simd, next.place, &mut group);
        let met = Meetings { bare: met.bare & reached, painted: met.painted & reached, ..met };
        let alone = self.alone(world, (met.bare | met.painted) & contact.near, &ends, &contact.points);
        self.apply(simd, world.seed, (&mut group, &met, alone), (&mut ends, &mut *counts));
        let stepped = Mask::from_bitmask(simd, ends.stepped);
        write(simd, &mut self.position, stepped, &contact.on_face);
        stepped.select(time, load(simd, &self.time)).store_array(&mut self.time);
        // those that pass the boundary are on a box of another cell
        let stays = Mask::from_bitmask(simd, ends.stepped & !ends.behind);
        stays.select(next.place, load(simd, &self.place)).store_array(&mut self.place);
        stays.select(contact.face, load(simd, &self.face)).store_array(&mut self.face);
        for lane in 0..LANES {
            self.counters[2][lane] += ends.stepped >> lane & 1;
        }
        let ended = ends.absorbed[0] | ends.absorbed[1];
        counts.steps += u64::from((ends.stepped | ended).count_ones());
        ends
    }

    /// Of the photons in a bit mask those whose free paths lead to the boundary at the times `t`, and those that are absorbed before.
    /// The first bit mask may have others.
    #[inline(always)]
    fn free<S: Simd>(
        &self,
        simd: S,
        world: &World<'_>,
        (known, counters): (u64, &[Words; 3]),
        t: Lanes<S>,
    ) -> [u64; 2] {
        let uniforms = free_path_uniforms(*counters, world.seed);
        let mut is_long = Mask::splat(simd, true);
        for k in 0..PATHS {
            let rest = splat(simd, 1.0) - load(simd, &uniforms[k]);
            let least = load(simd, &self.paths[k]) * rest * LEAST_EXPONENTIAL;
            is_long &= least.simd_gt(t);
        }
        let (mut long, mut absorbed) = (is_long.to_bitmask(), 0);
        let short = known & !long;
        if short == 0 {
            return [long, absorbed];
        }
        let times = t.to_array();
        for lane in (0..LANES).filter(|lane| short >> lane & 1 == 1) {
            let paths = (0..PATHS).map(|k| (self.paths[k][lane], self.absorbs[k] >> lane & 1 == 1));
            let (free, absorbs) = shortest(paths, uniforms.map(|row| exponential(row[lane])));
            let absorbs = absorbs == Some(true);
            if free >= times[lane] {
                long |= 1 << lane;
            } else if absorbs && self.time[lane] + free / self.velocity[lane] <= world.max_time {
                absorbed |= 1 << lane;
            }
        }
        [long, absorbed]
    }

    /// The contacts with the faces, by the operations of [`Group::touch`].
    #[inline(always)]
    fn contact<S: Simd>(&self, simd: S, world: &World<'_>, next: &Next<S>) -> FaceContact<S> {
        let &Next { t, axis, offset, speed, leaves, is_high, .. } = next;
        let (origin, direction) = (vector(simd, &self.position), vector(simd, &self.direction));
        let point = origin.plus(direction.times(t));
        let lengths = origin.taxicab() + t.abs() * direction.taxicab();
        let near = lengths.simd_le(splat(simd, world.alone_lengths)).to_bitmask();
        let local = next.local + speed * t;
        let rises = speed.simd_gt(splat(simd, 0.0));
        let across = at_axis(axis, [point.x, point.y, point.z]);
        let on_face = is_high.select(across - (local - offset), across + (-local - offset));
        let (low, high) = (splat(simd, world.zeros[0]), splat(simd, world.zeros[1]));
        let flat = leaves.select(rises.select(-high, -low), rises.select(low, high));
        let against = rises.select(splat(simd, -1.0), splat(simd, 1.0));
        let points = [point.x.to_array(), point.y.to_array(), point.z.to_array()];
        let mut contact = FaceContact {
            face: is_high.select(axis + 3.0, axis),
            normal: points,
            on_face: points,
            points,
            near,
        };
        for k in 0..3 {
            let is_across = axis.simd_eq(splat(simd, k as f64));
            is_across.select(against, flat).store_array(&mut contact.normal[k]);
            is_across.select(on_face, load(simd, &points[k])).store_array(&mut contact.on_face[k]);
        }
        contact
    }

    /// The kinds of the boundaries at the boxes at some places; sets the values of the group.
    #[inline(always)]
    fn boundaries<S: Simd>(&self, simd: S, place: Lanes<S>, group: &mut Group) -> Meetings {
        let mut met = Meetings { bare: 0, painted: 0, detecting: 0 };
        let mut values = [splat(simd, 0.0); 3];
        for k in 0..BOXES {
            let here = place.simd_eq(splat(simd, k as f64));
            let bits = here.to_bitmask() & self.active;
            if bits == 0 {
                continue;
            }
            let [bare, painted, detecting] = self.boxes.boundaries(k);
            met.bare |= bare & bits;
            met.painted |= painted & bits;
            met.detecting |= detecting & bits;
            for j in 0..3 {
                values[j] = here.select(load(simd, &self.boxes.boxes[k].values[j]), values[j]);
            }
        }
        for j in 0..3 {
            values[j].store_array(&mut group.values[j]);
        }
        met
    }

    /// Applies the processes at the boundaries; `alone` is a bit mask of the photons out of reach of other surfaces.
    #[inline(always)]
    fn apply<S: Simd>(
        &mut self,
        simd: S,
        seed: u64,
        (group, met, alone): (&mut Group, &Meetings, u64),
        (ends, counts): (&mut Ends, &mut BoxStepCounts),
    ) {
        let (bare, painted) = (met.bare & alone, met.painted);
        if painted != 0 {
            let mut paint = *group;
            simd.vectorize(
                #[inline(always)]
                || paint.meet_paint(simd, seed),
            );
            // absorption needs no contact
            ends.absorbed[1] = painted & paint.lost & !paint.detected & !paint.unsure;
            counts.absorbed[1] += u64::from(ends.absorbed[1].count_ones());
            let stepped = painted & alone & !paint.unsure & !paint.lost;
            let stepped = stepped & !(paint.is_behind & met.detecting);
            ends.stepped = stepped;
            ends.behind = stepped & paint.is_behind;
            count(&mut counts.painted, stepped, paint.events);
            self.depart(simd, stepped, &paint);
        }
        if bare != 0 {
            simd.vectorize(
                #[inline(always)]
                || group.meet_interface(simd, seed, bare),
            );
            let stepped = bare & !group.unsure & !(group.is_behind & met.detecting);
            ends.stepped |= stepped;
            ends.behind |= stepped & group.is_behind;
            count(&mut counts.bare, stepped, group.events);
            self.depart(simd, stepped, group);
        }
    }

    /// Sets the directions and polarisations of the photons in a bit mask to those after their boundaries.
    #[inline(always)]
    fn depart<S: Simd>(&mut self, simd: S, some: u64, group: &Group) {
        let some = Mask::from_bitmask(simd, some);
        write(simd, &mut self.direction, some, &group.direction);
        write(simd, &mut self.polarisation, some, &group.polarisation);
    }

    /// Bit mask of those of the photons in `some` that reach points out of reach of all surfaces but their own.
    #[inline(always)]
    fn alone(&self, world: &World<'_>, some: u64, ends: &Ends, points: &[Row; 3]) -> u64 {
        let mut alone = 0;
        for lane in (0..LANES).filter(|lane| some >> lane & 1 == 1) {
            let number = self.boxes.boxes[ends.place[lane] as usize % BOXES].number[lane];
            let at = 6 * number as usize + ends.face[lane] as usize;
            let Some(Bounds { lo, hi }) = world.alone.get(at) else { continue };
            let mut is_alone = true;
            for k in 0..3 {
                // without branches, which nobody can predict
                is_alone &= (lo[k] <= points[k][lane]) & (points[k][lane] <= hi[k]);
            }
            alone |= u64::from(is_alone) << lane;
        }
        alone
    }
}

/// Counts the events of the photons in a bit mask.
#[inline(always)]
fn count(counts: &mut [u64; 3], some: u64, [first, second]: [u64; 2]) {
    let masks = [some & first, some & !first & second, some & !first & !second];
    for (count, mask) in counts.iter_mut().zip(masks) {
        *count += u64::from(mask.count_ones());
    }
}
