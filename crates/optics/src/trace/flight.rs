//! Light that goes its way eight rays at a time, as far as it is foreseen what they meet, and proved: event after event without
//! a look at the others. What cannot be proved is asked, with the rays that no eight are left of.

use super::Worker;
use super::eight::Spent;
use super::rows::Rows;
use crate::abreast::{Arrived, Gone, load, load_one, stored};
use crate::beam::Beam;
use crate::element::Action;
use crate::foresee::{Eight, Foresight, Step};
use crate::generation::Generation;
use crate::indices::{Indices, Optics};
use crate::segments::{Balance, EightRows, Event};
use crate::settings::{Keep, Settings};
use crate::system::System;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch};
use rayweave_model::{Evaluator, Face, RegionId};
use rayweave_shape::lanes::{LANES, Lanes, Vec3Lanes, splat};

/// What eight rays may meet.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Guess {
    /// A surface, by its number in the foresight of the solids.
    Face(usize),
    /// A sheet, and the number of the surface in its foresight.
    Sheet(usize, usize),
}

/// What others met that started in the same way.
#[derive(Clone, Copy, Debug, Default)]
struct Experience {
    guess: Option<Guess>,
    /// How often it was asked for.
    lessons: u32,
}

/// How often it is asked in a chunk what rays meet that start in the same way: guesses that depend on more than the chunk
/// would make results depend on threads.
const LESSONS: u32 = 4;

/// Experience by the surface on which rays start and the side to which they go, or neither.
#[derive(Debug, Default)]
struct Guesses(Vec<Experience>);

impl Guesses {
    fn at(&mut self, start: Option<(usize, bool)>) -> &mut Experience {
        let place = start.map_or(0, |(surface, inside)| 1 + 2 * surface + usize::from(inside));
        if self.0.len() <= place {
            self.0.resize(place + 1, Experience::default());
        }
        &mut self.0[place]
    }
}

/// Eight rays on their way.
struct Flight<S: Simd> {
    /// The number of the first in the beam.
    at: usize,
    eight: Eight<S>,
    path: Lanes<S>,
    power: [f64; LANES],
    /// How many events there were, and the face of the last.
    events: u32,
    face: Option<Face>,
    /// The row of the first for the last event; -1 for none.
    parent: i64,
    /// Their wavelength, if they have one in common.
    wavelength_nm: Option<f64>,
}

impl<S: Simd> Flight<S> {
    /// Appends the rays to others; the first of the beam has the number `first`.
    fn join(&self, rays: &mut Generation, (beam, first): (&Beam, u64)) {
        let gone = Gone {
            origin: stored(self.eight.origin),
            direction: stored(self.eight.direction),
            path: self.path.to_array(),
            inside: self.eight.start.map_or(0, |(_, inside)| if inside { 0xff } else { 0 }),
            ..Gone::default()
        };
        let parent = (self.parent >= 0).then_some(self.parent);
        rays.join((beam, first), self.at, (&self.power, &gone), (self.events, self.face), parent);
    }
}

/// What eight rays come to.
struct Reached<S: Simd> {
    end: Vec3Lanes<S>,
    path: Lanes<S>,
    /// The index on the way.
    index: Lanes<S>,
    /// The numbers of the element and of its surface.
    met: (usize, usize),
    event: Event,
}

/// What became of them.
enum Flown {
    On,
    Ended,
}

/// Answers what the first of some rays meet, if all eight meet the same.
type Ask<'a> = &'a mut dyn FnMut(&mut Generation) -> Option<Guess>;

impl<E: Evaluator> Worker<'_, E> {
    /// Takes the rays of the beam as far as they can go eight at a time; then they wait, as all others do, for the round in
    /// which it is asked what they meet.
    pub(super) fn fly(&mut self) {
        let system = self.tracer.system;
        let mut flown = 0;
        if let (Some(foresight), true) = (&system.foresight, self.settings.is_simple()) {
            flown = self.beam.len() / LANES * LANES;
            let mut pilot = Pilot {
                system,
                foresight,
                settings: self.settings,
                first: self.first,
                beam: std::mem::take(&mut self.beam),
                guesses: Guesses::default(),
                indices: std::mem::take(&mut self.indices),
                rows: std::mem::take(&mut self.rows),
                balance: std::mem::take(&mut self.balance),
                waiting: std::mem::take(&mut self.waiting),
            };
            pilot.fly(&mut |rays| {
                std::mem::swap(&mut self.now, rays);
                self.ask();
                self.guess()
            });
            (self.beam, self.indices, self.rows) = (pilot.beam, pilot.indices, pilot.rows);
            (self.balance, self.waiting) = (pilot.balance, pilot.waiting);
        }
        let waiting = waiting_for(&mut self.waiting, 0);
        waiting.set_out(&self.beam, flown..self.beam.len(), self.first, self.settings.polarised);
    }

    /// What the first eight rays met, if it was the same.
    fn guess(&self) -> Option<Guess> {
        let (system, met) = (self.tracer.system, &self.met);
        if let Some((sheet, surface)) = met.common_sheet(0) {
            let plate = &system.plates[sheet];
            let slot = plate.foresight.as_ref()?.slot(surface)?;
            return (plate.action == Action::Absorb).then_some(Guess::Sheet(sheet, slot));
        }
        let surface = system.faces[met.common_face(0)?].surface;
        system.foresight.as_ref()?.slot(surface).map(Guess::Face)
    }
}

/// Takes eight rays of a beam after the other on their way. Of no evaluator's type, so that its kernels are compiled once.
struct Pilot<'a> {
    system: &'a System,
    foresight: &'a Foresight,
    settings: &'a Settings,
    /// The number of the first ray of the beam.
    first: u64,
    beam: Beam,
    guesses: Guesses,
    indices: Indices,
    rows: Rows,
    balance: Balance,
    waiting: Vec<Generation>,
}

impl Pilot<'_> {
    fn fly(&mut self, ask: Ask<'_>) {
        dispatch!(self.foresight.level, simd => self.fly_all(simd, ask));
    }

    #[inline(always)]
    fn fly_all<S: Simd>(&mut self, simd: S, ask: Ask<'_>) {
        for at in (0..self.beam.len() / LANES * LANES).step_by(LANES) {
            let Some(mut flight) = self.take_off(simd, at) else { continue };
            if let Flown::On = self.fly_eight(simd, &mut flight, ask) {
                let waiting = waiting_for(&mut self.waiting, flight.events as usize);
                flight.join(waiting, (&self.beam, self.first));
            }
        }
    }

    #[inline(always)]
    fn take_off<S: Simd>(&self, simd: S, at: usize) -> Option<Flight<S>> {
        let (rays, wavelengths) = (self.beam.rays(), self.beam.wavelengths_nm());
        let (origin, direction) = (load(simd, rays.origins, at)?, load(simd, rays.directions, at)?);
        let direction = direction.times(splat(simd, 1.0) / direction.length_squared().sqrt());
        let (path, common) = (splat(simd, 0.0), *wavelengths.get(at)?);
        let is_common = load_one(simd, wavelengths, at)?.simd_eq(common).all_true();
        let sides = self.foresight.sides(simd, origin, origin.taxicab());
        let eight = Eight { origin, direction, start: None, sides };
        let (wavelength_nm, power) = (is_common.then_some(common), *self.beam.powers()[at..].first_chunk()?);
        Some(Flight { at, eight, path, power, events: 0, face: None, parent: -1, wavelength_nm })
    }

    /// Takes eight rays on until they end, or until it cannot be proved what comes next.
    #[inline(always)]
    fn fly_eight<S: Simd>(&mut self, simd: S, flight: &mut Flight<S>, ask: Ask<'_>) -> Flown {
        let power = Lanes::load_array_ref(simd, &flight.power);
        if !(power.simd_ge(self.settings.threshold) & power.simd_gt(0.0)).all_true() {
            return Flown::On;
        }
        loop {
            let guess = self.guesses.at(flight.eight.start).guess;
            let flown = match guess {
                Some(Guess::Face(surface)) => self.pass(simd, flight, surface),
                Some(Guess::Sheet(sheet, surface)) => self.end(simd, flight, (sheet, surface)),
                None => None,
            };
            match flown {
                Some(Flown::Ended) => return Flown::Ended,
                Some(Flown::On) => {}
                None if self.learn(flight, guess, ask) => {}
                None => return Flown::On,
            }
        }
    }

    /// Takes eight rays through a face between uniform media, if that is what they meet.
    #[inline(always)]
    fn pass<S: Simd>(&mut self, simd: S, flight: &mut Flight<S>, surface: usize) -> Option<Flown> {
        let system = self.system;
        let seen = self.foresight.next(simd, &flight.eight, surface)?;
        let (element, number) = polished(system, &seen.step)?;
        let (before, here) = self.index(simd, flight, seen.step.before)?;
        let (behind, _) = self.index(simd, flight, seen.step.after)?;
        let is_last = flight.events + 1 >= self.settings.generation_limit;
        if is_last || before.simd_eq(behind).any_true() {
            return None;
        }
        if may_touch_sheets(simd, system, &flight.eight, seen.t, usize::MAX) {
            return None;
        }
        let face = system.faces[seen.step.face];
        let arrived = Arrived {
            origin: flight.eight.origin,
            direction: flight.eight.direction,
            t: seen.t,
            end: seen.point,
            normal: seen.normal,
            slope: seen.slope,
            path: flight.path,
            surface: face.surface,
            is_alone: seen.is_alone,
        };
        let behind = system.abreast.as_ref()?.refract_here(simd, &arrived, [before, behind])?;
        let inside = match behind.inside {
            0 => false,
            0xff => true,
            _ => return None,
        };
        let spent = here.map(|here| Spent::new(&here, &flight.power, &seen.t.to_array()));
        if spent.as_ref().is_some_and(|spent| !spent.is_followed(self.settings.threshold)) {
            return None;
        }
        if self.settings.keep == Keep::All {
            let (end, path, met) = (seen.point, behind.path, (element, number));
            let reached = Reached { end, path, index: before, met, event: Event::Transmitted };
            self.record_eight(flight, &reached);
        }
        let start = Some((surface, inside));
        flight.eight = Eight { origin: behind.origin, direction: behind.direction, start, sides: seen.sides };
        (flight.path, flight.face) = (behind.path, Some(face));
        self.spend(flight, spent);
        flight.events += 1;
        Some(Flown::On)
    }

    /// Ends eight rays at an absorbing sheet, if that is what they meet.
    #[inline(always)]
    fn end<S: Simd>(
        &mut self,
        simd: S,
        flight: &mut Flight<S>,
        (sheet, surface): (usize, usize),
    ) -> Option<Flown> {
        let system = self.system;
        let plate = &system.plates[sheet];
        let (t, [before, after]) = plate.foresight.as_ref()?.through(simd, &flight.eight, surface)?;
        let region = self.foresight.region_up_to(simd, &flight.eight, t)?;
        let (index, here) = self.index(simd, flight, region)?;
        let is_through = before != RegionId(0) && after != RegionId(0);
        if !is_through || may_touch_sheets(simd, system, &flight.eight, t, sheet) {
            return None;
        }
        let (end, path) =
            (flight.eight.origin.plus(flight.eight.direction.times(t)), flight.path + index * t);
        let met = (plate.element, system.sheets_from() + sheet);
        self.record_eight(flight, &Reached { end, path, index, met, event: Event::Absorbed });
        self.spend(flight, here.map(|here| Spent::new(&here, &flight.power, &t.to_array())));
        for power in flight.power {
            self.balance.absorbed[plate.element] += power;
        }
        Some(Flown::Ended)
    }

    /// Takes from eight rays what a medium absorbs, if it does.
    #[inline(always)]
    fn spend<S: Simd>(&mut self, flight: &mut Flight<S>, spent: Option<Spent>) {
        if let Some(Spent { lost, left }) = spent {
            self.balance.absorbed_in_media += lost;
            flight.power = left;
        }
    }

    /// The index of a region for eight rays, if light goes straight on in it, and what they see of it if it absorbs.
    #[inline(always)]
    fn index<S: Simd>(
        &mut self,
        simd: S,
        flight: &Flight<S>,
        region: RegionId,
    ) -> Option<(Lanes<S>, Option<[Optics; LANES]>)> {
        let system = self.system;
        if !system.substance(region).is_uniform() {
            return None;
        }
        let medium = system.program.medium_of(region);
        if let Some(wavelength_nm) = flight.wavelength_nm {
            let optics = self.indices.of(system, medium, wavelength_nm);
            let absorbs = optics.absorption != 0.0;
            return Some((splat(simd, optics.index.re), absorbs.then_some([optics; LANES])));
        }
        let (mut found, mut absorbs) = ([Optics::default(); LANES], false);
        let wavelengths = self.beam.wavelengths_nm().get(flight.at..)?;
        for (found, &wavelength_nm) in found.iter_mut().zip(wavelengths) {
            *found = self.indices.of(system, medium, wavelength_nm);
            absorbs |= found.absorption != 0.0;
        }
        let index = found.map(|optics| optics.index.re);
        Some((Lanes::load_array_ref(simd, &index), absorbs.then_some(found)))
    }

    /// Appends a row for each of eight rays.
    #[inline(always)]
    fn record_eight<S: Simd>(&mut self, flight: &mut Flight<S>, reached: &Reached<S>) {
        let (at, beam, events, parent) = (flight.at, &self.beam, flight.events, flight.parent);
        let (Some(source), Some(wavelength_nm)) =
            (beam.sources()[at..].first_chunk(), beam.wavelengths_nm()[at..].first_chunk())
        else {
            return;
        };
        if self.settings.keep == Keep::All {
            flight.parent = self.rows.parent_abreast(events);
        }
        self.rows.abreast_at(events).extend(&EightRows {
            id: std::array::from_fn(|lane| (self.first + (at + lane) as u64) as i64),
            parent: std::array::from_fn(|lane| if parent < 0 { -1 } else { parent + lane as i64 }),
            generation: [events; LANES],
            source,
            wavelength_nm,
            intensity: &flight.power,
            index: reached.index.to_array(),
            start: stored(flight.eight.origin),
            end: stored(reached.end),
            direction: stored(flight.eight.direction),
            path: reached.path.to_array(),
            element: reached.met.0,
            surface: reached.met.1,
            event: reached.event,
        });
    }

    /// Asks what eight rays meet; false if nothing new is learnt.
    fn learn<S: Simd>(&mut self, flight: &Flight<S>, known: Option<Guess>, ask: Ask<'_>) -> bool {
        let experience = self.guesses.at(flight.eight.start);
        if experience.lessons == LESSONS {
            return false;
        }
        experience.lessons += 1;
        let mut rays = Generation::default();
        flight.join(&mut rays, (&self.beam, self.first));
        let guess = ask(&mut rays);
        experience.guess = guess.or(known);
        guess.is_some() && guess != known
    }
}

/// The rays that join those of a round.
pub(super) fn waiting_for(waiting: &mut Vec<Generation>, round: usize) -> &mut Generation {
    if waiting.len() <= round {
        waiting.resize_with(round + 1, Generation::default);
    }
    &mut waiting[round]
}

/// The numbers of the element and of its face at a crossing, if both sides of it are polished: the finish of what is entered
/// is what is met, or that of what is left.
pub(super) fn polished(system: &System, step: &Step) -> Option<(usize, usize)> {
    let left = system.polished(step.before, step.left).ok()?;
    match system.polished(step.after, step.entered).ok()? {
        Some(element) => Some((element, step.entered)),
        None => Some((left.unwrap_or(0), step.left)),
    }
}

/// Whether any of eight rays may meet a sheet up to some time, other than one of them.
#[inline(always)]
fn may_touch_sheets<S: Simd>(simd: S, system: &System, eight: &Eight<S>, t: Lanes<S>, but: usize) -> bool {
    // a loop: what iterators do with closures would be compiled for other instructions
    for (k, plate) in system.plates.iter().enumerate() {
        if k != but && plate.around.may_touch_up_to(simd, eight.origin, eight.direction, t) != 0 {
            return true;
        }
    }
    false
}
