//! Whether the two sides of a pair are the same.

use super::{DiffSettings, Difference, Pair, Spot};
use crate::{AnyEvaluator, Error, ErrorKind};
use rayweave_analysis::measure::{Chord, Estimate, Settings, measure};
use rayweave_analysis::survey::{Cancelled, Piece, Survey, shortest_at, survey};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, RegionId};
use std::sync::Arc;

const A_ONLY: RegionId = RegionId(2);
const B_ONLY: RegionId = RegionId(3);

/// Pieces that seem thick are looked at again, the thickest first, but not more than these.
const MOST_DOUBTS: usize = 4096;

/// The box of all that is compared.
pub fn bounds_of(pairs: &[Pair]) -> Result<Bounds, Error> {
    let mut whole = Bounds::EMPTY;
    for pair in pairs {
        whole = whole.union(&pair.program()?.bounds());
    }
    match whole.is_finite() || whole.is_empty() {
        true => Ok(whole),
        false => {
            let text = "the models have no end (rays cannot look everywhere) compare them within a box?";
            Err(Error::said(ErrorKind::Solid, text.to_owned()))
        }
    }
}

/// What compares.
pub struct Judge<'a> {
    settings: &'a DiffSettings,
    distance: f64,
    progress: &'a mut dyn FnMut(u64),
    asked: u64,
    pairs: u64,
}

/// A piece of a ray on one side alone.
#[derive(Clone, Copy)]
struct Doubt {
    chord: Chord,
    normals: [Vec3; 2],
    thickness: f64,
    is_a: bool,
}

impl<'a> Judge<'a> {
    pub fn new(settings: &'a DiffSettings, distance: f64, progress: &'a mut dyn FnMut(u64)) -> Judge<'a> {
        Judge { settings, distance, progress, asked: 0, pairs: 0 }
    }

    /// The number of rays that were asked.
    pub fn rays(&self) -> u64 {
        self.asked
    }

    pub fn compare(&mut self, pair: &Pair) -> Result<Difference, Error> {
        self.pairs += 1;
        let program = Arc::new(pair.program()?);
        let boxes = program.region_bounds();
        let doubtful = boxes[1].union(&boxes[2]);
        let evaluator = AnyEvaluator::new(None, program)?;
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
            self.look(&evaluator, &doubtful, &mut found)?;
        }
        self.measure(&evaluator, &mut found)?;
        Ok(found)
    }

    /// Looks for differences with rays.
    fn look(
        &mut self,
        evaluator: &AnyEvaluator,
        bounds: &Bounds,
        found: &mut Difference,
    ) -> Result<(), Error> {
        let settings = Survey {
            bounds: *bounds,
            across: self.settings.across,
            seed: self.settings.measure.seed,
            stream: self.pairs,
            threads: self.settings.measure.threads,
            cancel: self.settings.measure.cancel.clone(),
        };
        let mut doubts: Vec<Doubt> = Vec::new();
        let visit = |doubts: &mut Vec<Doubt>, piece: &Piece<'_>| {
            let is_a = piece.region() == A_ONLY;
            if is_a || piece.region() == B_ONLY {
                let (chord, normals, thickness) = (piece.chord(), piece.normals(), piece.thickness());
                doubts.push(Doubt { chord, normals, thickness, is_a });
            }
        };
        let (asked, progress) = (self.asked, &mut self.progress);
        let merge = |some: Vec<Doubt>| {
            doubts.extend(some);
            progress(asked);
        };
        self.asked += survey(evaluator, &settings, visit, merge).map_err(|Cancelled| Error::cancelled())?;
        doubts.sort_by(|a, b| b.thickness.total_cmp(&a.thickness));
        self.judge(evaluator, &doubts, found);
        Ok(())
    }

    /// The thickest of pieces that holds what it promises, looked at from other sides.
    fn judge(&self, evaluator: &AnyEvaluator, doubts: &[Doubt], found: &mut Difference) {
        let mut scratch = evaluator.scratch();
        let mut thickest: Option<Spot> = None;
        for doubt in doubts.iter().take(MOST_DOUBTS) {
            // those that follow are thinner than what is known
            if thickest.is_some_and(|spot| spot.thickness >= doubt.thickness) {
                break;
            }
            let spot = seen_again(evaluator, doubt, &mut scratch);
            if thickest.is_none_or(|known| spot.thickness > known.thickness) {
                thickest = Some(spot);
            }
        }
        found.spot = thickest;
        found.is_same = thickest.is_none_or(|spot| spot.thickness <= self.distance);
        if !found.is_same {
            let thick = doubts.iter().filter(|doubt| doubt.thickness > self.distance);
            let ends = thick.flat_map(|doubt| [doubt.chord.from, doubt.chord.to]);
            found.place = Some(ends.fold(Bounds::EMPTY, |all, end| all.union(&Bounds::new(end, end))));
        }
    }

    fn measure(&mut self, evaluator: &AnyEvaluator, found: &mut Difference) -> Result<(), Error> {
        // the box was cut out of the models before
        let settings = Settings { within: None, ..self.settings.measure.clone() };
        let (before, progress) = (self.asked, &mut self.progress);
        let measured = measure(evaluator, &settings, &mut |rays| progress(before + rays))?;
        self.asked += measured.rays;
        [found.both, found.a_only, found.b_only] = [0, 1, 2].map(|k| measured.regions[k].volume);
        Ok(())
    }
}

/// A piece seen along the axes and along the normals at its ends: the shortest way through tells best what is there.
fn seen_again(
    evaluator: &AnyEvaluator,
    doubt: &Doubt,
    scratch: &mut <AnyEvaluator as Evaluator>::Scratch,
) -> Spot {
    let Doubt { chord, normals, is_a, .. } = *doubt;
    let own = if is_a { A_ONLY } else { B_ONLY };
    let (thickness, chord) =
        thinnest(evaluator, (doubt.thickness, chord, normals), |region| region == own, scratch);
    Spot { at: 0.5 * (chord.from + chord.to), thickness, chord, is_a }
}

/// The thickness of a piece as it was seen, or the shortest way through its middle along the axes and the normals at its ends.
pub fn thinnest(
    evaluator: &AnyEvaluator,
    (thickness, chord, normals): (f64, Chord, [Vec3; 2]),
    is_in: impl Fn(RegionId) -> bool,
    scratch: &mut <AnyEvaluator as Evaluator>::Scratch,
) -> (f64, Chord) {
    let directions = [Vec3::X, Vec3::Y, Vec3::Z, normals[0], normals[1]];
    let middle = 0.5 * (chord.from + chord.to);
    match shortest_at(evaluator, middle, &directions, is_in, scratch) {
        // not there: what rounding makes of a film
        None => (0.0, chord),
        Some(around) if around.length() <= thickness * (1.0 + 1e-9) => (around.length(), around),
        Some(_) => (thickness, chord),
    }
}
