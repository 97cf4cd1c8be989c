//! Comparison of the two solids of a pair.

use super::pairs::Pair;
use super::{DiffSettings, Difference, ThickestSpot};
use crate::AnalysisError;
use crate::error::Make;
use crate::measure::{Estimate, MeasureSettings, MeasuredChord, measure};
use crate::survey::{Piece, Survey, remeasured, survey};
use rayweave_error::Message;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, RegionId};
use std::sync::Arc;

const A_ONLY: RegionId = RegionId(2);
const B_ONLY: RegionId = RegionId(3);

/// The maximum number of pieces that are measured again, the thickest first.
const MAX_CANDIDATES: usize = 4096;

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
    progress: &'a mut dyn FnMut(u64),
    traced: u64,
    pairs: u64,
}

/// A piece of a ray inside only one of the solids.
#[derive(Clone, Copy)]
struct Candidate {
    chord: MeasuredChord,
    normals: [Vec3; 2],
    thickness: f64,
    is_a: bool,
}

impl<'a, E: Evaluator> PairComparer<'a, E> {
    pub fn new(
        make: &'a Make<'a, E>,
        settings: &'a DiffSettings,
        distance: f64,
        progress: &'a mut dyn FnMut(u64),
    ) -> PairComparer<'a, E> {
        PairComparer { make, settings, distance, progress, traced: 0, pairs: 0 }
    }

    /// The number of rays so far.
    pub fn rays(&self) -> u64 {
        self.traced
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
        let mut candidates: Vec<Candidate> = Vec::new();
        let visit = |candidates: &mut Vec<Candidate>, piece: &Piece<'_>| {
            let is_a = piece.region() == A_ONLY;
            if is_a || piece.region() == B_ONLY {
                let (chord, normals, thickness) = (piece.chord(), piece.normals(), piece.thickness());
                candidates.push(Candidate { chord, normals, thickness, is_a });
            }
        };
        let (traced, progress) = (self.traced, &mut self.progress);
        let merge = |some: Vec<Candidate>| {
            candidates.extend(some);
            progress(traced);
        };
        self.traced += survey(evaluator, &settings, visit, merge)?;
        candidates.sort_by(|a, b| b.thickness.total_cmp(&a.thickness));
        self.measure_candidates(evaluator, &candidates, found);
        Ok(())
    }

    /// Measures the pieces along several directions and records the thickest.
    fn measure_candidates(&self, evaluator: &E, candidates: &[Candidate], found: &mut Difference) {
        let mut scratch = evaluator.scratch();
        let mut thickest: Option<ThickestSpot> = None;
        for candidate in candidates.iter().take(MAX_CANDIDATES) {
            // all further pieces are thinner
            if thickest.is_some_and(|spot| spot.thickness >= candidate.thickness) {
                break;
            }
            let spot = seen_again(evaluator, candidate, &mut scratch);
            if thickest.is_none_or(|known| spot.thickness > known.thickness) {
                thickest = Some(spot);
            }
        }
        found.spot = thickest;
        found.is_same = thickest.is_none_or(|spot| spot.thickness <= self.distance);
        if !found.is_same {
            let thick = candidates.iter().filter(|candidate| candidate.thickness > self.distance);
            let ends = thick.flat_map(|candidate| [candidate.chord.from, candidate.chord.to]);
            found.place = Some(ends.fold(Bounds::EMPTY, |all, end| all.union(&Bounds::new(end, end))));
        }
    }

    fn measure(&mut self, evaluator: &E, found: &mut Difference) -> Result<(), AnalysisError> {
        // the models are already clipped to the box
        let settings = MeasureSettings { within: None, ..self.settings.measure.clone() };
        let (before, progress) = (self.traced, &mut self.progress);
        let measured = measure(evaluator, &settings, &mut |rays| progress(before + rays))?;
        self.traced += measured.rays;
        [found.both, found.a_only, found.b_only] = [0, 1, 2].map(|k| measured.regions[k].volume);
        Ok(())
    }
}

/// Measures a piece again along the axes and along the normals at its ends: the shortest length is the
/// thickness.
fn seen_again<E: Evaluator>(evaluator: &E, candidate: &Candidate, scratch: &mut E::Scratch) -> ThickestSpot {
    let Candidate { chord, normals, is_a, .. } = *candidate;
    let own = if is_a { A_ONLY } else { B_ONLY };
    let (thickness, chord) =
        remeasured(evaluator, (candidate.thickness, chord, normals), |region| region == own, scratch);
    ThickestSpot { at: 0.5 * (chord.from + chord.to), thickness, chord, is_a }
}
