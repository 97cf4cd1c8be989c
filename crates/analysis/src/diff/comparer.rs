//! Comparison of the two solids of a pair.

use super::pairs::{A_ONLY, B_ONLY, Pair};
use super::places::{self, Scrap};
use super::{DiffSettings, Difference, ThickestSpot};
use crate::AnalysisError;
use crate::error::Make;
use crate::measure::{Estimate, MeasureProgress, MeasureSettings, MeasuredChord, measure_with_progress};
use crate::survey::{Across, Faces, Piece, Survey, survey, thickness_at_middle};
use rayweave_error::Message;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::Evaluator;
use std::sync::Arc;

/// The number of pieces that are kept until they are measured again. It bounds the memory, about 100 MB.
const MAX_WAITING: usize = 1 << 20;

/// The number of pieces, of those that are waiting, that are measured again because of their length although their estimated
/// thickness is below the largest one found.
const MAX_DOUBTFUL: usize = 512;

/// The number of pieces within the accepted thickness that are measured again. They do not make models different, but the
/// thickest of them is reported.
const MAX_ACCEPTED: usize = 4096;

/// The box of both models.
pub fn bounds_of(pairs: &[Pair]) -> Result<Bounds, AnalysisError> {
    let mut whole = Bounds::EMPTY;
    for pair in pairs {
        whole = whole.union(&pair.program()?.bounds());
    }
    match whole.is_finite() || whole.is_empty() {
        true => Ok(whole),
        false => {
            let message = Message::new("the models are unbounded", "rays cannot search all of space");
            Err(AnalysisError::Solid(
                message.suggest("Compare the parts within a box: --within LO HI, in Python within=(lo, hi)."),
            ))
        }
    }
}

/// Compares pairs, one after the other.
pub struct PairComparer<'a, E> {
    make: &'a Make<'a, E>,
    settings: &'a DiffSettings,
    distance: f64,
    /// Receives the number of rays, the number of finished pairs and the precision reached.
    progress: &'a mut dyn FnMut(u64, usize, f64),
    traced: u64,
    pairs: u64,
}

/// A piece of a ray inside only one of the solids.
#[derive(Clone, Copy)]
struct Candidate {
    chord: MeasuredChord,
    normals: [Vec3; 2],
    thickness: f64,
    area: f64,
    is_a: bool,
}

impl<'a, E: Evaluator> PairComparer<'a, E> {
    pub fn new(
        make: &'a Make<'a, E>,
        settings: &'a DiffSettings,
        distance: f64,
        progress: &'a mut dyn FnMut(u64, usize, f64),
    ) -> PairComparer<'a, E> {
        PairComparer { make, settings, distance, progress, traced: 0, pairs: 0 }
    }

    /// The number of rays so far.
    pub fn rays(&self) -> u64 {
        self.traced
    }

    /// The number of pairs before the current one.
    fn finished(&self) -> usize {
        self.pairs as usize - 1
    }

    pub fn compare(&mut self, pair: &Pair) -> Result<Difference, AnalysisError> {
        self.pairs += 1;
        let program = Arc::new(pair.program()?);
        let boxes = program.region_bounds();
        let doubtful = boxes[1].union(&boxes[2]);
        let evaluator = (self.make)(program)?;
        let mut found = Difference {
            name: pair.name.clone(),
            is_in: [0, 1].map(|k| pair.sides[k].is_some()),
            is_same: true,
            is_proved: true,
            both: Estimate::default(),
            a_only: Estimate::default(),
            b_only: Estimate::default(),
            spot: None,
            place: None,
            places: Vec::new(),
        };
        if !pair.is_written_alike() && !doubtful.is_empty() {
            found.is_proved = false;
            self.search(&evaluator, &doubtful, &mut found)?;
        }
        self.measure(&evaluator, &mut found)?;
        Ok(found)
    }

    /// Searches for differences with rays.
    fn search(
        &mut self,
        evaluator: &E,
        bounds: &Bounds,
        found: &mut Difference,
    ) -> Result<(), AnalysisError> {
        let settings = Survey {
            bounds: *bounds,
            across: self.settings.across,
            seed: self.settings.measure.seed,
            stream: self.pairs,
            threads: self.settings.measure.threads,
            cancel: self.settings.measure.cancel.clone(),
        };
        let visit = |candidates: &mut Vec<Candidate>, piece: &Piece<'_>| {
            let is_a = piece.region() == A_ONLY;
            if is_a || piece.region() == B_ONLY {
                let (chord, normals, thickness) = (piece.chord(), piece.normals(), piece.thickness());
                candidates.push(Candidate { chord, normals, thickness, area: piece.area, is_a });
            }
        };
        let mut remeasurement = Remeasurement::new(evaluator, self.distance);
        let (traced, done, progress) = (self.traced, self.finished(), &mut self.progress);
        let merge = |some: Vec<Candidate>| {
            remeasurement.add(some);
            progress(traced, done, f64::INFINITY);
        };
        self.traced += survey(evaluator, &settings, visit, merge)?;
        remeasurement.measure();
        found.spot = remeasurement.thickest;
        found.is_same = found.spot.is_none_or(|spot| spot.thickness <= self.distance);
        if !found.is_same {
            found.place = Some(remeasurement.place);
            let across = (self.settings.across as usize, self.distance);
            let measuring = &self.settings.measure;
            let (places, rays) =
                places::of(evaluator, remeasurement.place, across, &remeasurement.scraps, measuring)?;
            found.places = places;
            self.traced += rays;
        }
        Ok(())
    }

    fn measure(&mut self, evaluator: &E, found: &mut Difference) -> Result<(), AnalysisError> {
        // the models are already clipped to the box
        let settings = MeasureSettings { within: None, ..self.settings.measure.clone() };
        let (before, done, progress) = (self.traced, self.finished(), &mut self.progress);
        let mut report = |now: MeasureProgress| progress(before + now.rays, done, now.precision);
        let measured = measure_with_progress(evaluator, &settings, &mut report)?;
        self.traced += measured.rays;
        [found.both, found.a_only, found.b_only] = [0, 1, 2].map(|k| measured.regions[k].volume);
        Ok(())
    }
}

/// Pieces that are measured along several directions, and the thickest of them.
struct Remeasurement<'a, E: Evaluator> {
    evaluator: &'a E,
    scratch: E::Scratch,
    distance: f64,
    waiting: Vec<Candidate>,
    thickest: Option<ThickestSpot>,
    /// A box around the pieces thicker than the accepted distance.
    place: Bounds,
    /// Some of these pieces.
    scraps: Vec<Scrap>,
}

impl<'a, E: Evaluator> Remeasurement<'a, E> {
    fn new(evaluator: &'a E, distance: f64) -> Remeasurement<'a, E> {
        let (scratch, waiting) = (evaluator.scratch(), Vec::new());
        Remeasurement {
            evaluator,
            scratch,
            distance,
            waiting,
            thickest: None,
            place: Bounds::EMPTY,
            scraps: Vec::new(),
        }
    }

    fn add(&mut self, candidates: Vec<Candidate>) {
        self.waiting.extend(candidates);
        if self.waiting.len() >= MAX_WAITING {
            self.measure();
        }
    }

    /// Measures the waiting pieces, the thickest first. All pieces beyond the accepted thickness are measured, unless one of them
    /// stays thicker than the rest; of the others, at most [`MAX_ACCEPTED`].
    fn measure(&mut self) {
        self.waiting.sort_by(|a, b| b.thickness.total_cmp(&a.thickness));
        let (mut accepted, mut doubtful) = (0, 0);
        for candidate in self.waiting.drain(..) {
            if candidate.thickness > self.distance {
                for end in [candidate.chord.from, candidate.chord.to] {
                    self.place = self.place.union(&Bounds::new(end, end));
                }
                if self.scraps.len() < places::MAX_SCRAPS {
                    let Candidate { chord, area, is_a, .. } = candidate;
                    self.scraps.push(Scrap { chord, volume: chord.length() * area / 3.0, is_a });
                }
            } else {
                accepted += 1;
            }
            // a piece is at most as thick as it is long, and seldom thicker than estimated
            let known = self.thickest.map_or(f64::NEG_INFINITY, |spot| spot.thickness);
            let may_exceed = known < candidate.chord.length() && doubtful < MAX_DOUBTFUL;
            doubtful += usize::from(known >= candidate.thickness && may_exceed);
            if (known < candidate.thickness || may_exceed) && accepted <= MAX_ACCEPTED {
                let spot = seen_again(self.evaluator, &candidate, &mut self.scratch);
                if spot.thickness > known {
                    self.thickest = Some(spot);
                }
            }
        }
    }
}

/// Measures the local thickness at the middle of a piece; 0 for a piece that exists only because of rounding.
fn seen_again<E: Evaluator>(evaluator: &E, candidate: &Candidate, scratch: &mut E::Scratch) -> ThickestSpot {
    let Candidate { chord, normals, is_a, .. } = *candidate;
    let own = if is_a { A_ONLY } else { B_ONLY };
    let is_own = |region| region == own;
    let found = thickness_at_middle(evaluator, Across::new(chord, normals), &is_own, Faces::Any, scratch);
    let (thickness, chord) = found.map_or((0.0, chord), |found| (found.chord.length(), found.chord));
    ThickestSpot { at: 0.5 * (chord.from + chord.to), thickness, chord, is_a }
}
