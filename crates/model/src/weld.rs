//! From the exact list of changes to the crossings that are reported: one weld, and to whom a crossing belongs.
//!
//! Inside, booleans compare times exactly. That leaves slivers where two surfaces that should coincide differ
//! by rounding, so neighbouring crossings are *welded* where the piece of the ray between them keeps within
//! `delta` of both surfaces all along. This is done here once, on the final list, for every evaluator.

use crate::{Crossing, Event, Face, PlacementId, Program, RegionId, State};
use rayweave_shape::Ray;
use rayweave_shape::surface::hugs;
use std::ops::Range;

/// The leaf states of a group while it is swept; both directions, since a flip undoes itself.
pub trait Flips {
    /// Flips a leaf.
    fn flip(&mut self, leaf: u32);
    /// The number of the last output that is inside, from 1; 0 if none is.
    fn winner(&mut self) -> u32;
    /// True if output `k`, from 0, is inside.
    fn output(&mut self, k: u32) -> bool;
}

/// A time at which the state of the model changes.
#[derive(Clone, Copy, Debug)]
pub struct Change {
    /// When.
    pub t: f64,
    /// The flips at that time: events `first..end`.
    pub first: usize,
    /// One past the last of them.
    pub end: usize,
    /// The state just before.
    pub before: State,
    /// The state just after.
    pub after: State,
}

/// Neighbouring changes welded so far.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: Change,
    last: Change,
    /// The face of the last change alone.
    face: Face,
}

/// Welds the changes of one ray as they come.
pub struct Weld<'a> {
    program: &'a Program,
    ray: Ray,
    events: &'a [Event],
    pending: Option<Run>,
}

impl<'a> Weld<'a> {
    /// For one ray with all its events in order of time.
    pub fn new(program: &'a Program, ray: Ray, events: &'a [Event]) -> Self {
        Weld { program, ray, events, pending: None }
    }

    /// Takes the next change; answers with the crossing that it shows to be complete, if any. `flips` must be
    /// in the state just after the change, that is, with events `..change.end` flipped.
    pub fn change(&mut self, change: Change, flips: &mut impl Flips) -> Option<Crossing> {
        let face =
            attribute(self.events, change.first..change.end, change.end, flips, medium_state(self.program));
        let Some(run) = self.pending else {
            self.pending = Some(Run { first: change, last: change, face });
            return None;
        };
        if self.welded(&run, &change, face) {
            self.pending = Some(Run { first: run.first, last: change, face });
            return None;
        }
        self.pending = Some(Run { first: change, last: change, face });
        self.report(&run, change.end, flips)
    }

    /// The last crossing, once there are no more changes; `position` events are flipped in `flips`.
    pub fn finish(&mut self, position: usize, flips: &mut impl Flips) -> Option<Crossing> {
        let run = self.pending.take()?;
        self.report(&run, position, flips)
    }

    /// True if the piece between two neighbouring changes lies in both their surfaces.
    fn welded(&self, run: &Run, next: &Change, face: Face) -> bool {
        let (a, b) = (run.last.t, next.t);
        self.hugs(face, a, b) && (face == run.face || self.hugs(run.face, a, b))
    }

    fn hugs(&self, face: Face, a: f64, b: f64) -> bool {
        let entry = self.program.surface(face.surface);
        hugs(&entry.surface, entry.reach, &local_ray(self.program, &self.ray, face.placement), a, b)
    }

    /// The crossing that a complete run amounts to: none if the medium is the same before and after.
    fn report(&self, run: &Run, position: usize, flips: &mut impl Flips) -> Option<Crossing> {
        let (first, end) = (run.first.first, run.last.end);
        let (before, after) = (run.first.before, run.last.after);
        if before.medium == after.medium {
            return None;
        }
        let alone = end - first == 1;
        let face = match alone || run.first.first == run.last.first {
            true => run.face,
            false => attribute(self.events, first..end, position, flips, medium_state(self.program)),
        };
        let mut of_region = |region: RegionId| match alone || region == RegionId(0) {
            true => face,
            false => attribute(self.events, first..end, position, flips, region_state(region)),
        };
        let (mut left, mut entered) = (of_region(before.region), of_region(after.region));
        if before.region == RegionId(0) || after.region == RegionId(0) {
            (left, entered) = (face, face);
        }
        Some(Crossing { t: run.last.t, face, left, entered, before: before.region, after: after.region })
    }
}

/// The face that the flips `range` of `events` belong to: of those whose flip alone changes the state before
/// all of them, or whose flip undone changes the state after, the one of the lowest leaf; if there is none,
/// the lowest of all. `flips` has `position` events flipped, at least those up to the end of the range, and
/// is left as it was.
pub fn attribute<F: Flips>(
    events: &[Event],
    range: Range<usize>,
    position: usize,
    flips: &mut F,
    state: impl Fn(&mut F) -> u32,
) -> Face {
    let members = &events[range.clone()];
    if let [only] = members {
        return only.face;
    }
    let toggle = |flips: &mut F, range: Range<usize>| {
        events[range].iter().for_each(|event| flips.flip(event.leaf));
    };
    let mut best: Option<&Event> = None;
    toggle(flips, range.end..position);
    test_each(members, flips, &state, &mut best);
    toggle(flips, range.clone());
    test_each(members, flips, &state, &mut best);
    toggle(flips, range.start..position);
    let lowest = || members.iter().rev().min_by_key(|event| event.leaf);
    best.or_else(lowest).map_or(members[0].face, |event| event.face)
}

/// Flips each member alone and keeps the lowest leaf that makes a difference; of several flips of one leaf
/// the last.
fn test_each<'e, F: Flips>(
    members: &'e [Event],
    flips: &mut F,
    state: &impl Fn(&mut F) -> u32,
    best: &mut Option<&'e Event>,
) {
    let now = state(flips);
    for event in members {
        if best.is_some_and(|best| best.leaf < event.leaf) {
            continue;
        }
        flips.flip(event.leaf);
        let changed = state(flips) != now;
        flips.flip(event.leaf);
        if changed {
            *best = Some(event);
        }
    }
}

fn medium_state<F: Flips>(program: &Program) -> impl Fn(&mut F) -> u32 {
    |flips: &mut F| program.medium_of(RegionId(flips.winner()))
}

fn region_state<F: Flips>(region: RegionId) -> impl Fn(&mut F) -> u32 {
    move |flips: &mut F| u32::from(flips.output(region.0 - 1))
}

/// A ray of the world in the frame of a placement, by the same steps by which evaluators carried it there.
pub fn local_ray(program: &Program, ray: &Ray, placement: PlacementId) -> Ray {
    program.descend(placement).fold(*ray, |ray, local_from_world| ray.transformed(local_from_world))
}
