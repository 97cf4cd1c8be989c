//! Coincidence welding: turns the exact list of changes of a ray into the crossings that are reported, and
//! attributes each to a face.
//!
//! Boolean operations compare times exactly. Where two surfaces that should coincide differ by rounding, this
//! leaves slivers. Neighbouring crossings are therefore *welded* if the piece of the ray between them stays
//! within `delta` of both surfaces over its whole length. Every evaluator uses this one implementation, on
//! the final list.

use crate::{Crossing, Event, Face, GroupRay, PlacementId, Program, RegionId, State, carried};
use rayweave_shape::Ray;
use rayweave_shape::surface::{coincides_along, separated_along};
use std::ops::Range;

/// The leaf states of a group during a sweep. Toggling a leaf twice has no effect.
pub trait LeafStates {
    /// Inverts the side of a leaf.
    fn toggle(&mut self, leaf: u32);
    /// The number of the last output that is inside, counted from 1; 0 if none is.
    fn owner(&mut self) -> u32;
    /// True if output `k`, counted from 0, is inside.
    fn output(&mut self, k: u32) -> bool;
}

/// A path through a model: a ray, or another curve that can be tested for coincidence with a surface.
pub trait Trajectory {
    /// True if the piece between two times lies within `delta` of the surface of a face over its whole
    /// length.
    fn coincides_along(&self, program: &Program, face: Face, a: f64, b: f64) -> bool;

    /// True only if no piece from `a` to a time in `ends` coincides with the surface of a face. May always
    /// return false; returning true lets evaluators stop early.
    fn separated_along(&self, _program: &Program, _face: Face, _a: f64, _ends: (f64, f64)) -> bool {
        false
    }
}

impl Trajectory for Ray {
    fn coincides_along(&self, program: &Program, face: Face, a: f64, b: f64) -> bool {
        let entry = program.surface(face.surface);
        let (ray, magnitude) = local_ray(program, self, face.placement);
        let magnitude = entry.magnitude + magnitude;
        coincides_along(&entry.surface, magnitude, &ray, a, b)
            && (a == b
                || !entry.surface.turns_along_rulings()
                || is_short_if_in_surface(program, self, face, (a, b)))
    }

    fn separated_along(&self, program: &Program, face: Face, a: f64, ends: (f64, f64)) -> bool {
        let entry = program.surface(face.surface);
        let (ray, magnitude) = local_ray(program, self, face.placement);
        separated_along(&entry.surface, entry.magnitude + magnitude, &ray, a, ends)
    }
}

/// False if the ray lies in the surface and the piece between two times is long enough to have a side: then it is not a
/// sliver. (Along a common ruling of two tangent cones, for example, the ray may leave them at different times.)
fn is_short_if_in_surface(program: &Program, ray: &Ray, face: Face, piece: (f64, f64)) -> bool {
    let mut group = GroupRay::world(program, *ray, &[]);
    for (place, prototype) in program.descend_groups(face.placement) {
        group = group.placed(&place, program.prototype(prototype), 0);
    }
    let entry = program.surface(face.surface);
    let magnitude = entry.magnitude + group.magnitude;
    !group.chord.lies_in(&entry.surface, magnitude, &group.ray)
        || group.chord.side_is_uncertain(&entry.surface, magnitude, &group.ray, piece)
}

/// A time at which the state of the model changes.
#[derive(Clone, Copy, Debug)]
pub struct Change {
    /// The time.
    pub t: f64,
    /// Index of the first event at that time: the events are `first..end`.
    pub first: usize,
    /// Index one past the last of them.
    pub end: usize,
    /// The state just before.
    pub before: State,
    /// The state just after.
    pub after: State,
}

/// A run of changes of medium welded so far.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Its events, including adjacent changes of region within a medium.
    first: usize,
    end: usize,
    /// The states before and after it.
    before: State,
    after: State,
    /// The last change of medium, with the face of that change alone.
    t: f64,
    face: Face,
    /// True if it is a single change.
    single: bool,
    /// The last change, of medium or of region.
    tail: (f64, Face),
}

/// A chain of changes of region within one medium, in which neighbours lie in each other's surfaces.
#[derive(Clone, Copy, Debug)]
struct Quiet {
    first: usize,
    before: State,
    tail: (f64, Face),
}

/// The state of a weld between two changes, for evaluators that compute events incrementally.
#[derive(Clone, Copy, Debug, Default)]
pub struct Paused(Option<Run>, Option<Quiet>);

impl Paused {
    /// True if no crossing is pending.
    pub fn is_idle(&self) -> bool {
        self.0.is_none()
    }
}

/// Welds the changes along one trajectory as they come.
pub struct Weld<'a, T = Ray> {
    program: &'a Program,
    path: T,
    events: &'a [Event],
    pending: Option<Run>,
    quiet: Option<Quiet>,
}

impl<'a, T: Trajectory> Weld<'a, T> {
    /// Starts a weld for one trajectory, with all its events in order of time.
    pub fn new(program: &'a Program, path: T, events: &'a [Event]) -> Self {
        Weld { program, path, events, pending: None, quiet: None }
    }

    /// Continues after a pause; events may have been appended to `events` since.
    pub fn resume(program: &'a Program, path: T, events: &'a [Event], paused: Paused) -> Self {
        Weld { program, path, events, pending: paused.0, quiet: paused.1 }
    }

    /// Releases the borrow of the events and returns the state.
    pub fn pause(self) -> Paused {
        Paused(self.pending, self.quiet)
    }

    /// Adds the next change of region; returns the crossing that this change completes, if any. `leaves` must
    /// be in the state just after the change, with events `..change.end` applied.
    pub fn change(&mut self, change: Change, leaves: &mut impl LeafStates) -> Option<Crossing> {
        if change.before.medium == change.after.medium {
            self.quiet_change(change, leaves);
            return None;
        }
        let face =
            attribute(self.events, change.first..change.end, change.end, leaves, medium_state(self.program));
        let (t, here) = (change.t, (change.t, face));
        let quiet = match &self.quiet {
            None => None,
            Some(_) => self.quiet.take().filter(|quiet| self.welded(quiet.tail, here)),
        };
        // by reference: a run is large, and nearly all are single changes
        if let Some(run) = &self.pending
            && self.welded((run.t, run.face), here)
        {
            let Change { end, after, .. } = change;
            self.pending = Some(Run { end, after, t, face, single: false, tail: here, ..*run });
            return None;
        }
        let (first, before) =
            quiet.map_or((change.first, change.before), |quiet| (quiet.first, quiet.before));
        let Change { end, after, .. } = change;
        let run = Run { first, end, before, after, t, face, single: quiet.is_none(), tail: here };
        let complete = self.pending.replace(run)?;
        self.report(&complete, end, leaves)
    }

    /// Handles a change of region within one medium, which is not a crossing by itself. If it is next to a
    /// crossing and both lie in each other's surfaces, the region between them is a sliver: the region
    /// reported is the one before or after both.
    fn quiet_change(&mut self, change: Change, leaves: &mut impl LeafStates) {
        let owner = |leaves: &mut _| LeafStates::owner(leaves);
        let face = attribute(self.events, change.first..change.end, change.end, leaves, owner);
        let here = (change.t, face);
        let touched = self.pending.filter(|run| run.after == change.before && self.welded(run.tail, here));
        if let Some(run) = touched {
            let Change { end, after, .. } = change;
            self.pending = Some(Run { end, after, tail: here, single: false, ..run });
        }
        let fresh = Quiet { first: change.first, before: change.before, tail: here };
        let chain = self.quiet.filter(|quiet| self.welded(quiet.tail, here));
        self.quiet = Some(chain.map_or(fresh, |quiet| Quiet { tail: here, ..quiet }));
    }

    /// Returns the last crossing after the final change; `position` events are applied to `leaves`.
    pub fn finish(&mut self, position: usize, leaves: &mut impl LeafStates) -> Option<Crossing> {
        let run = self.pending.take()?;
        self.report(&run, position, leaves)
    }

    /// True if a crossing is pending and no change at a time in `ends` can be welded to it, so that
    /// [`Weld::finish`] returns the crossing that is reported in any case. All earlier changes must have been
    /// added.
    pub fn is_resolved(&self, ends: (f64, f64)) -> bool {
        let separated_along = |(a, face): (f64, Face)| self.path.separated_along(self.program, face, a, ends);
        self.pending.is_some_and(|run| {
            separated_along((run.t, run.face)) && (run.tail == (run.t, run.face) || separated_along(run.tail))
        })
    }

    /// True if the piece between two changes lies in both their surfaces.
    fn welded(&self, (a, first): (f64, Face), (b, second): (f64, Face)) -> bool {
        let coincides_along = |face: Face| self.path.coincides_along(self.program, face, a, b);
        coincides_along(second) && (first == second || coincides_along(first))
    }

    /// The crossing of a complete run; `None` if the medium is the same before and after.
    #[inline]
    fn report(&self, run: &Run, position: usize, leaves: &mut impl LeafStates) -> Option<Crossing> {
        let Run { first, end, before, after, t, face, .. } = *run;
        if before.medium == after.medium {
            return None;
        }
        if end - first == 1 {
            let (before, after) = (before.region, after.region);
            return Some(Crossing { t, face, left: face, entered: face, before, after });
        }
        Some(self.report_several(run, position, leaves))
    }

    /// The crossing of a complete run of several events.
    fn report_several(&self, run: &Run, position: usize, leaves: &mut impl LeafStates) -> Crossing {
        let Run { first, end, before, after, .. } = *run;
        let face = match run.single {
            true => run.face,
            false => attribute(self.events, first..end, position, leaves, medium_state(self.program)),
        };
        // a region that continues below the other one, or ended before, is left or entered at the same face
        let mut of_region = |region: RegionId| match region {
            RegionId(0) => face,
            _ => responsible(self.events, first..end, position, leaves, region_state(region)).unwrap_or(face),
        };
        let (mut left, mut entered) = (of_region(before.region), of_region(after.region));
        if before.region == RegionId(0) || after.region == RegionId(0) {
            (left, entered) = (face, face);
        }
        Crossing { t: run.t, face, left, entered, before: before.region, after: after.region }
    }
}

/// The face to which the events `range` belong: the face of the lowest leaf whose event alone
/// changes the state before all of them, or whose event undone changes the state after. If there is none, the
/// lowest leaf whose event changes the state when they are applied one after the other. (Some event does,
/// because the states before and after differ. Leaves that cannot matter here never do, so the result is the
/// same whether or not an evaluator includes them.) `leaves` has `position` events applied, at least those up
/// to the end of the range, and is restored.
#[inline]
pub fn attribute<F: LeafStates>(
    events: &[Event],
    range: Range<usize>,
    position: usize,
    leaves: &mut F,
    state: impl Fn(&mut F) -> u32,
) -> Face {
    match &events[range.clone()] {
        [only] => only.face,
        members => responsible(events, range, position, leaves, state).unwrap_or(members[0].face),
    }
}

/// Like [`attribute`]; `None` if the events together change nothing.
fn responsible<F: LeafStates>(
    events: &[Event],
    range: Range<usize>,
    position: usize,
    leaves: &mut F,
    state: impl Fn(&mut F) -> u32,
) -> Option<Face> {
    let members = &events[range.clone()];
    let toggle = |leaves: &mut F, range: Range<usize>| {
        events[range].iter().for_each(|event| leaves.toggle(event.leaf));
    };
    let mut best: Option<&Event> = None;
    toggle(leaves, range.end..position);
    let after = test_each(members, leaves, &state, &mut best);
    toggle(leaves, range.clone());
    let before = test_each(members, leaves, &state, &mut best);
    if best.is_none() {
        test_all(members, leaves, &state, &mut best);
    } else {
        toggle(leaves, range.clone());
    }
    toggle(leaves, range.end..position);
    best.filter(|_| before != after).map(|event| event.face)
}

/// Toggles each member alone and keeps in `best` the lowest leaf that changes the state; of several events of
/// one leaf the last. Returns the state without any of them.
fn test_each<'e, F: LeafStates>(
    members: &'e [Event],
    leaves: &mut F,
    state: &impl Fn(&mut F) -> u32,
    best: &mut Option<&'e Event>,
) -> u32 {
    let now = state(leaves);
    for event in members {
        if best.is_some_and(|best| best.leaf < event.leaf) {
            continue;
        }
        leaves.toggle(event.leaf);
        let changed = state(leaves) != now;
        leaves.toggle(event.leaf);
        if changed {
            *best = Some(event);
        }
    }
    now
}

/// Toggles the members one after the other and leaves them toggled; keeps the lowest leaf that changes the
/// state.
fn test_all<'e, F: LeafStates>(
    members: &'e [Event],
    leaves: &mut F,
    state: &impl Fn(&mut F) -> u32,
    best: &mut Option<&'e Event>,
) {
    let mut now = state(leaves);
    for event in members {
        leaves.toggle(event.leaf);
        let next = state(leaves);
        if next != now && best.is_none_or(|best| best.leaf >= event.leaf) {
            *best = Some(event);
        }
        now = next;
    }
}

fn medium_state<F: LeafStates>(program: &Program) -> impl Fn(&mut F) -> u32 {
    |leaves: &mut F| program.medium_of(RegionId(leaves.owner()))
}

fn region_state<F: LeafStates>(region: RegionId) -> impl Fn(&mut F) -> u32 {
    move |leaves: &mut F| u32::from(leaves.output(region.0 - 1))
}

/// A world ray in the frame of a placement, by the same steps as in evaluators, and the length to add to the
/// magnitude of surfaces there: see [`carried`].
pub fn local_ray(program: &Program, ray: &Ray, placement: PlacementId) -> (Ray, f64) {
    if placement == PlacementId(0) {
        return (*ray, 0.0);
    }
    program.descend(placement).fold((*ray, 0.0), |(ray, magnitude), place| carried(&place, &ray, magnitude))
}
