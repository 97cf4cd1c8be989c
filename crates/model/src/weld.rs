//! From the exact list of changes to the crossings that are reported: one weld, and to whom a crossing belongs.
//!
//! Inside, booleans compare times exactly. That leaves slivers where two surfaces that should coincide differ
//! by rounding, so neighbouring crossings are *welded* where the piece of the ray between them keeps within
//! `delta` of both surfaces all along. This is done here once, on the final list, for every evaluator.

use crate::{Crossing, Event, Face, PlacementId, Program, RegionId, State, carried};
use rayweave_shape::Ray;
use rayweave_shape::surface::{coincides_along, separated_along};
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

/// What runs through a model: a ray, or whatever else can tell where it keeps to a surface.
pub trait Trajectory {
    /// True if the piece between two times lies within `delta` of the surface of a face all along.
    fn coincides_along(&self, program: &Program, face: Face, a: f64, b: f64) -> bool;

    /// True only if no piece from `a` to a time in `ends` coincides_along the surface of a face: who can tell lets evaluators stop
    /// early.
    fn separated_along(&self, _program: &Program, _face: Face, _a: f64, _ends: (f64, f64)) -> bool {
        false
    }
}

impl Trajectory for Ray {
    fn coincides_along(&self, program: &Program, face: Face, a: f64, b: f64) -> bool {
        let entry = program.surface(face.surface);
        let (ray, magnitude) = local_ray(program, self, face.placement);
        coincides_along(&entry.surface, entry.magnitude + magnitude, &ray, a, b)
    }

    fn separated_along(&self, program: &Program, face: Face, a: f64, ends: (f64, f64)) -> bool {
        let entry = program.surface(face.surface);
        let (ray, magnitude) = local_ray(program, self, face.placement);
        separated_along(&entry.surface, entry.magnitude + magnitude, &ray, a, ends)
    }
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

/// Neighbouring changes of medium welded so far.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Its events, those of changes of region beside it among them.
    first: usize,
    end: usize,
    /// The states before and after it.
    before: State,
    after: State,
    /// The last change of medium, and its face alone.
    t: f64,
    face: Face,
    /// True if it is one change.
    single: bool,
    /// The last change of either kind.
    tail: (f64, Face),
}

/// Neighbouring changes of region, not of medium, that lie in each other's surfaces.
#[derive(Clone, Copy, Debug)]
struct Quiet {
    first: usize,
    before: State,
    tail: (f64, Face),
}

/// What a weld knows between two changes: for evaluators that find events as they go.
#[derive(Clone, Copy, Debug, Default)]
pub struct Paused(Option<Run>, Option<Quiet>);

impl Paused {
    /// True if there is no crossing that waits for what comes next.
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
    /// For one trajectory with all its events in order of time.
    pub fn new(program: &'a Program, path: T, events: &'a [Event]) -> Self {
        Weld { program, path, events, pending: None, quiet: None }
    }

    /// Goes on after a pause; `events` may have got more at its end since.
    pub fn resume(program: &'a Program, path: T, events: &'a [Event], paused: Paused) -> Self {
        Weld { program, path, events, pending: paused.0, quiet: paused.1 }
    }

    /// Lets go of the events.
    pub fn pause(self) -> Paused {
        Paused(self.pending, self.quiet)
    }

    /// Takes the next change of region; answers with the crossing that it shows to be complete, if any. `flips`
    /// must be in the state just after the change, that is, with events `..change.end` flipped.
    pub fn change(&mut self, change: Change, flips: &mut impl Flips) -> Option<Crossing> {
        if change.before.medium == change.after.medium {
            self.quiet_change(change, flips);
            return None;
        }
        let face =
            attribute(self.events, change.first..change.end, change.end, flips, medium_state(self.program));
        let (t, here) = (change.t, (change.t, face));
        let quiet = self.quiet.take().filter(|quiet| self.welded(quiet.tail, here));
        if let Some(run) = self.pending.filter(|run| self.welded((run.t, run.face), here)) {
            let Change { end, after, .. } = change;
            self.pending = Some(Run { end, after, t, face, single: false, tail: here, ..run });
            return None;
        }
        let (first, before) =
            quiet.map_or((change.first, change.before), |quiet| (quiet.first, quiet.before));
        let Change { end, after, .. } = change;
        let run = Run { first, end, before, after, t, face, single: quiet.is_none(), tail: here };
        let complete = self.pending.replace(run)?;
        self.report(&complete, end, flips)
    }

    /// A change of region within one medium is no crossing. But next to one, where both lie in each other's
    /// surfaces, the region between them is a sliver: that before or after both is the one to be named.
    fn quiet_change(&mut self, change: Change, flips: &mut impl Flips) {
        let winner = |flips: &mut _| Flips::winner(flips);
        let face = attribute(self.events, change.first..change.end, change.end, flips, winner);
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

    /// The last crossing, once there are no more changes; `position` events are flipped in `flips`.
    pub fn finish(&mut self, position: usize, flips: &mut impl Flips) -> Option<Crossing> {
        let run = self.pending.take()?;
        self.report(&run, position, flips)
    }

    /// True if there is a crossing that no change at a time in `ends` can be welded to, so that [`Weld::finish`] gives
    /// what is reported whatever comes then. All changes before have been taken.
    pub fn is_settled(&self, ends: (f64, f64)) -> bool {
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

    /// The crossing that a complete run amounts to: none if the medium is the same before and after.
    fn report(&self, run: &Run, position: usize, flips: &mut impl Flips) -> Option<Crossing> {
        let Run { first, end, before, after, .. } = *run;
        if before.medium == after.medium {
            return None;
        }
        let alone = end - first == 1;
        let face = match alone || run.single {
            true => run.face,
            false => attribute(self.events, first..end, position, flips, medium_state(self.program)),
        };
        // a region that goes on beneath the other one, or ended before, is left or entered at the same face
        let mut of_region = |region: RegionId| match alone || region == RegionId(0) {
            true => face,
            false => {
                responsible(self.events, first..end, position, flips, region_state(region)).unwrap_or(face)
            }
        };
        let (mut left, mut entered) = (of_region(before.region), of_region(after.region));
        if before.region == RegionId(0) || after.region == RegionId(0) {
            (left, entered) = (face, face);
        }
        Some(Crossing { t: run.t, face, left, entered, before: before.region, after: after.region })
    }
}

/// The face that the flips `range` of `events` belong to: of those whose flip alone changes the state before
/// all of them, or whose flip undone changes the state after, the one of the lowest leaf; if there is none, of
/// those that change the state as they come, one after the other. (Some do, as the state is another one in
/// the end; and leaves that cannot matter here never do, so it is the same whether an evaluator looks at
/// them or not.) `flips` has `position` events flipped, at least those up to the end of the range, and is left
/// as it was.
pub fn attribute<F: Flips>(
    events: &[Event],
    range: Range<usize>,
    position: usize,
    flips: &mut F,
    state: impl Fn(&mut F) -> u32,
) -> Face {
    match &events[range.clone()] {
        [only] => only.face,
        members => responsible(events, range, position, flips, state).unwrap_or(members[0].face),
    }
}

/// The same; `None` where the flips together change nothing.
fn responsible<F: Flips>(
    events: &[Event],
    range: Range<usize>,
    position: usize,
    flips: &mut F,
    state: impl Fn(&mut F) -> u32,
) -> Option<Face> {
    let members = &events[range.clone()];
    let toggle = |flips: &mut F, range: Range<usize>| {
        events[range].iter().for_each(|event| flips.flip(event.leaf));
    };
    let mut best: Option<&Event> = None;
    toggle(flips, range.end..position);
    let after = test_each(members, flips, &state, &mut best);
    toggle(flips, range.clone());
    let before = test_each(members, flips, &state, &mut best);
    if best.is_none() {
        test_all(members, flips, &state, &mut best);
    } else {
        toggle(flips, range.clone());
    }
    toggle(flips, range.end..position);
    best.filter(|_| before != after).map(|event| event.face)
}

/// Flips each member alone and keeps the lowest leaf that makes a difference; of several flips of one leaf
/// the last. The state without any flip.
fn test_each<'e, F: Flips>(
    members: &'e [Event],
    flips: &mut F,
    state: &impl Fn(&mut F) -> u32,
    best: &mut Option<&'e Event>,
) -> u32 {
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
    now
}

/// Flips the members one after the other, and leaves them flipped; keeps the lowest leaf that makes a difference.
fn test_all<'e, F: Flips>(
    members: &'e [Event],
    flips: &mut F,
    state: &impl Fn(&mut F) -> u32,
    best: &mut Option<&'e Event>,
) {
    let mut now = state(flips);
    for event in members {
        flips.flip(event.leaf);
        let next = state(flips);
        if next != now && best.is_none_or(|best| best.leaf >= event.leaf) {
            *best = Some(event);
        }
        now = next;
    }
}

fn medium_state<F: Flips>(program: &Program) -> impl Fn(&mut F) -> u32 {
    |flips: &mut F| program.medium_of(RegionId(flips.winner()))
}

fn region_state<F: Flips>(region: RegionId) -> impl Fn(&mut F) -> u32 {
    move |flips: &mut F| u32::from(flips.output(region.0 - 1))
}

/// A ray of the world in the frame of a placement, by the same steps by which evaluators carried it there, and
/// what they add to the reach of surfaces.
pub fn local_ray(program: &Program, ray: &Ray, placement: PlacementId) -> (Ray, f64) {
    program.descend(placement).fold((*ray, 0.0), |(ray, magnitude), place| carried(&place, &ray, magnitude))
}
