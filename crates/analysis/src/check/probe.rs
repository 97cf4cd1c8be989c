//! Ray sampling of a box for the checks.

use super::report::CheckProgress;
use super::share::{CheckShare, Outcome, Thickest, Work};
use super::{CheckSettings, Scope};
use crate::AnalysisError;
use crate::error::Make;
use crate::measure::{Estimate, MeasureSettings, MeasuredChord, measure};
use crate::subject::clipped;
use crate::survey::{Across, Faces, Piece, Survey, survey, task_count, thickness_at_middle};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Program, Region, RegionId, Solid, expanded_size};
use std::ops::Range;
use std::sync::Arc;

/// The maximum number of pieces per search that are measured again, the thickest first.
const MAX_CANDIDATES: usize = 256;

/// Number of cells along an edge of the cross-section of the box of a small part.
pub const FEW: u32 = 10;

/// The same for a first look.
const FEWER: u32 = 4;

/// The work that all searches of one kind may take: a constant, and more for each pair of [`CheckSettings::most_pairs`]. It is counted
/// in rays times leaves that each may cross, and two for the search itself. All pairs of simple parts stay below it; a few thousand
/// operands of one union that all overlap do not. Volumes of findings take far more rays than searches.
const IN_PAIRS: [u64; 2] = [4_000_000, 2_500];
const IN_OPERANDS: [u64; 2] = [4_000_000, 5_000];
const IN_FINDINGS: [u64; 2] = [4_000_000, 500];

/// The work of the searches for walls and gaps in the same unit: at faces, at edges with rays through the whole model and with those
/// through the boxes of all regions, and from the places to start from. It does not grow with the number of pairs.
const IN_WALLS: u64 = 4_000_000;
pub const IN_EDGES: u64 = 4_000_000;
pub const IN_STARTS: u64 = 4_000_000;

/// The work of the rays of the grid that shows separate pieces and cavities, and of those that join its chords, for pieces and for
/// cavities.
pub const IN_GRID: u64 = 4_000_000;
pub const IN_JOINS: u64 = 4_000_000;

/// The most rays of a volume, and their usual number, for estimates of the work.
const MOST_VOLUME_RAYS: u64 = 1 << 16;
pub const VOLUME_RAYS: u64 = 1 << 14;

/// The most leaves of a solid that are counted.
const MAX_LEAVES: u64 = 1 << 32;

/// The work still allowed to a kind of search. It is counted before each search, so that it does not depend on which searches run
/// here.
pub struct Budget {
    left: u64,
}

impl Budget {
    pub fn of(work: u64) -> Budget {
        Budget { left: work }
    }

    fn new([constant, per_pair]: [u64; 2], settings: &CheckSettings) -> Budget {
        let of_pairs = per_pair.saturating_mul(settings.most_pairs as u64);
        Budget { left: of_pairs.saturating_add(constant) }
    }

    /// True if there is enough left for this many rays through solids with this many leaves, which then counts as done.
    pub fn affords(&mut self, rays: u64, leaves: u64) -> bool {
        self.takes(rays.saturating_mul(leaves.saturating_add(2)))
    }

    /// True if there is enough left for this work, which then counts as done.
    pub fn takes(&mut self, work: u64) -> bool {
        let left = self.left.checked_sub(work);
        self.left = left.unwrap_or(self.left);
        left.is_some()
    }

    /// Moves one n-th of the work that is left into another budget.
    pub fn part(&mut self, n: u64) -> Budget {
        let left = self.left.div_ceil(n.max(1));
        self.left -= left;
        Budget { left }
    }

    /// Adds what is left of another budget.
    pub fn add(&mut self, rest: Budget) {
        self.left = self.left.saturating_add(rest.left);
    }
}

/// Traces rays for the checks, and counts them.
pub struct Probe<'a, E> {
    pub make: &'a Make<'a, E>,
    pub settings: &'a CheckSettings,
    /// The sampled box.
    pub frame: Bounds,
    pub scope: Scope,
    progress: &'a mut dyn FnMut(CheckProgress),
    /// The work of all searches, of those that are finished with the rays of the one that runs, and of all up to that one.
    planned: u64,
    done: u64,
    end: u64,
    searches: u64,
    /// The independent searches, by number: those that run here, and the results of the others.
    pub work: Work<'a>,
    /// The number of the next independent search.
    pub next_search: u64,
    /// The stream of random numbers of the independent search that runs, if one does.
    stream: Option<u64>,
    /// The work of the searches in pairs, of those in operands, of those beyond mothers, of those for regions that no ray
    /// crossed, and of those that examine what they found.
    pub in_pairs: Budget,
    pub in_operands: Budget,
    pub in_outside: Budget,
    pub in_unseen: Budget,
    pub in_findings: Budget,
    /// The work of the searches for walls and gaps between faces.
    pub in_walls: Budget,
}

/// The number of random streams before those of independent searches: other searches are counted from 1.
const STREAMS: u64 = 1 << 32;

impl<'a, E: Evaluator> Probe<'a, E> {
    pub fn new(
        make: &'a Make<'a, E>,
        settings: &'a CheckSettings,
        frame: Bounds,
        progress: &'a mut dyn FnMut(CheckProgress),
    ) -> Probe<'a, E> {
        let diagonal = if frame.is_empty() { 0.0 } else { frame.size().length() };
        let or = |length: Option<f64>, part: f64| length.unwrap_or(part * diagonal);
        let scope = Scope {
            wall: or(settings.wall, 1e-5),
            gap: or(settings.gap, 1e-5),
            distance: or(settings.distance, 1e-9),
            ..Scope::default()
        };
        let (work, stream) = (Work::All, None);
        Probe {
            make,
            settings,
            frame,
            scope,
            progress,
            planned: 0,
            done: 0,
            end: 0,
            searches: 0,
            work,
            next_search: 0,
            stream,
            in_pairs: Budget::new(IN_PAIRS, settings),
            in_operands: Budget::new(IN_OPERANDS, settings),
            in_outside: Budget::new(IN_PAIRS, settings),
            in_unseen: Budget::new(IN_FINDINGS, settings),
            in_findings: Budget::new(IN_FINDINGS, settings),
            in_walls: Budget::of(IN_WALLS),
        }
    }

    /// Adds searches with this many rays to the planned work. Those of a range count one each: see [`plan_range`](Self::plan_range).
    pub fn plan(&mut self, rays: u64) {
        if !matches!(self.work, Work::Range(..)) {
            self.planned += rays;
        }
    }

    /// Runs the independent searches of a range only.
    pub fn plan_range(&mut self, range: &Range<u64>) {
        self.planned = range.end.saturating_sub(range.start);
        self.work = Work::Range(range.clone(), CheckShare::default());
    }

    /// Begins a planned search with this many rays; all searches before it are finished.
    pub fn begin(&mut self, rays: u64) {
        if !matches!(self.work, Work::Range(..)) {
            self.advance(rays);
        }
    }

    /// Reports that all searches are finished.
    pub fn finish(&mut self) {
        self.end = self.planned;
        self.advance(0);
    }

    fn advance(&mut self, work: u64) {
        self.done = self.end;
        self.end += work;
        let (rays, done, total) = (self.scope.rays, self.done.min(self.planned), self.planned);
        (self.progress)(CheckProgress { rays, done, total });
    }

    /// Runs a search with the random numbers of an independent one, whose number is given.
    pub fn with_numbers_of<T>(&mut self, number: u64, search: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.stream.replace(STREAMS + number);
        let found = search(self);
        self.stream = before;
        found
    }

    /// Runs an independent search, or takes its result from elsewhere. Its random numbers depend on its number only.
    pub fn independent(
        &mut self,
        search: impl FnOnce(&mut Self) -> Result<Outcome, AnalysisError>,
    ) -> Result<Outcome, AnalysisError> {
        let number = self.next_search;
        self.next_search += 1;
        let outcome = match &self.work {
            Work::Range(range, _) if !range.contains(&number) => return Ok(Outcome::Nothing),
            Work::Range(..) => {
                self.advance(1);
                None
            }
            Work::Known(share) => share.get(number),
            _ => None,
        };
        if let Some((rays, outcome)) = outcome {
            self.scope.rays += rays;
            return Ok(outcome);
        }
        let before = self.scope.rays;
        let outcome = self.with_numbers_of(number, search);
        let (rays, outcome) = (self.scope.rays - before, outcome?);
        if let Work::Range(_, share) = &mut self.work {
            share.add(number, rays, outcome);
        }
        Ok(outcome)
    }

    /// Traces the rays of a survey through a box.
    pub fn survey<T: Default + Send>(
        &mut self,
        evaluator: &E,
        bounds: &Bounds,
        across: u32,
        visit: impl Fn(&mut T, &Piece<'_>) + Sync,
        mut merge: impl FnMut(T),
    ) -> Result<(), AnalysisError> {
        let bounds = if bounds.is_finite() { *bounds } else { bounds.intersection(&self.frame) };
        if bounds.is_empty() {
            return Ok(());
        }
        self.searches += u64::from(self.stream.is_none());
        let survey_settings = Survey {
            bounds,
            across,
            seed: self.settings.seed,
            stream: self.stream.unwrap_or(self.searches),
            threads: self.settings.threads,
            cancel: self.settings.cancel.clone(),
        };
        let Probe { progress, done, end, planned, scope, .. } = self;
        let (before, all, tasks) = (scope.rays, rays_of(across), task_count(across));
        let mut merged = 0;
        let merge = |found| {
            merge(found);
            let rays = all * merged / tasks;
            merged += 1;
            let rays_now = all * merged / tasks;
            *done = (*done + rays_now - rays).min(*end).min(*planned);
            progress(CheckProgress { rays: before + rays_now, done: *done, total: *planned });
        };
        scope.rays += survey(evaluator, &survey_settings, visit, merge)?;
        Ok(())
    }

    /// The thickest place of a solid along rays through a box; `None` if no ray crosses it.
    pub fn thickest(
        &mut self,
        solid: &Solid,
        bounds: &Bounds,
        across: u32,
    ) -> Result<Option<Thickest>, AnalysisError> {
        match self.evaluator_within(solid, bounds)? {
            Some(evaluator) => self.thickest_of_evaluator(&evaluator, bounds, across),
            None => Ok(None),
        }
    }

    /// An evaluator of a solid; `None` if the solid does not reach into a box.
    fn evaluator_within(&self, solid: &Solid, bounds: &Bounds) -> Result<Option<E>, AnalysisError> {
        let program = Program::compile(solid)?;
        match bounds.intersection(&program.bounds()).is_empty() {
            true => Ok(None),
            false => Ok(Some((self.make)(Arc::new(program))?)),
        }
    }

    /// Like [`thickest`](Self::thickest), for a solid that is searched in many boxes.
    pub fn thickest_of_evaluator(
        &mut self,
        evaluator: &E,
        bounds: &Bounds,
        across: u32,
    ) -> Result<Option<Thickest>, AnalysisError> {
        let bounds = bounds.intersection(&evaluator.program().bounds());
        if bounds.is_empty() {
            return Ok(None);
        }
        let mut candidates: Vec<(f64, MeasuredChord, [Vec3; 2])> = Vec::new();
        let visit = |found: &mut Vec<_>, piece: &Piece<'_>| {
            if piece.region() != RegionId(0) {
                found.push((piece.thickness(), piece.chord(), piece.normals()));
            }
        };
        self.survey(evaluator, &bounds, across, visit, |some: Vec<_>| candidates.extend(some))?;
        candidates.sort_by(|a, b| b.0.total_cmp(&a.0));
        Ok(thickest_of(evaluator, &candidates))
    }

    /// The thickest place, if its thickness exceeds rounding error.
    pub fn is_there(
        &mut self,
        solid: &Solid,
        bounds: &Bounds,
        across: u32,
    ) -> Result<Option<Thickest>, AnalysisError> {
        let met = self.thickest(solid, bounds, across)?;
        Ok(met.filter(|met| met.thickness > self.scope.distance))
    }

    /// Like [`is_there`](Self::is_there), by a few rays, and by `across` cells only where these find nothing: the place is a deep
    /// one, but perhaps not the deepest.
    pub fn is_anywhere(
        &mut self,
        solid: &Solid,
        bounds: &Bounds,
        across: u32,
    ) -> Result<Option<Thickest>, AnalysisError> {
        let Some(evaluator) = self.evaluator_within(solid, bounds)? else { return Ok(None) };
        let least = self.scope.distance;
        for across in [FEWER, across] {
            let met = self.thickest_of_evaluator(&evaluator, bounds, across)?;
            if met.is_some_and(|met| met.thickness > least) {
                return Ok(met);
            }
        }
        Ok(None)
    }

    /// The volume of a solid in a box, to about 2 %; `None` if it is unbounded there.
    pub fn volume(&mut self, solid: &Solid) -> Result<Option<Estimate>, AnalysisError> {
        let frame = clipped(
            vec![Region { name: String::new(), solid: solid.clone(), medium: 1 }],
            Some(self.frame.grown(1e-6 * self.frame.size().length())),
        )?;
        let program = Program::compile_regions(&frame)?;
        if !program.bounds().is_finite() {
            return Ok(None);
        }
        let settings = MeasureSettings {
            precision: 0.02,
            confidence: self.settings.confidence,
            most_rays: MOST_VOLUME_RAYS,
            most_reached: Some(16 * MOST_VOLUME_RAYS),
            seed: self.settings.seed,
            threads: self.settings.threads,
            cancel: self.settings.cancel.clone(),
            within: None,
        };
        let measured = measure(&(self.make)(Arc::new(program))?, &settings, &mut |_| ())?;
        self.scope.rays += measured.rays;
        Ok(Some(measured.regions[0].volume))
    }
}

/// The number of rays of a survey.
pub fn rays_of(across: u32) -> u64 {
    6 * u64::from(across) * u64::from(across)
}

/// The number of leaves of a solid.
pub fn leaves_of(solid: &Solid) -> u64 {
    expanded_size(solid, MAX_LEAVES)
}

/// The thickest piece, measured along several directions.
fn thickest_of<E: Evaluator>(
    evaluator: &E,
    candidates: &[(f64, MeasuredChord, [Vec3; 2])],
) -> Option<Thickest> {
    let mut scratch = evaluator.scratch();
    let mut best: Option<Thickest> = None;
    for (thickness, chord, normals) in candidates.iter().take(MAX_CANDIDATES) {
        // all further pieces are thinner
        if best.is_some_and(|best| best.thickness >= *thickness) {
            break;
        }
        let is_in = |region| region != RegionId(0);
        let piece = Across::new(*chord, *normals);
        let found = thickness_at_middle(evaluator, piece, &is_in, Faces::Any, &mut scratch);
        let (thickness, chord) = found.map_or((0.0, *chord), |found| (found.chord.length(), found.chord));
        if best.is_none_or(|best| thickness > best.thickness) {
            best = Some(Thickest { thickness, chord });
        }
    }
    best
}
