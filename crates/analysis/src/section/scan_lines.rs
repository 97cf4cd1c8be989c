//! Scan lines: the parallel rays that sweep a plane, refined where neighbours differ.

use super::refine::{Gap, Limits, Refinement, Relation};
use super::scan_line::{ScanLine, ScanLineTracer};
use super::{Cut, SectionError, SectionRun, SectionWindow};
use rayweave_math::Bounds;
use rayweave_model::drive::{Stopped, drive, thread_count};
use rayweave_model::memory::{Growth, Shortage};
use rayweave_model::{Evaluator, LeafId};
use std::ops::Range;

/// A scan line and its relation to the one before.
pub enum Step<'l> {
    /// All crossings continue.
    Smooth(&'l ScanLine),
    /// The two scan lines may differ, and the gap is not refined further: it is within the tolerance, or the limit of scan lines is
    /// reached.
    Jump(&'l ScanLine),
    /// All between the scan line before and this one is refined where they differ.
    Refined(&'l Gap, &'l ScanLine),
}

/// A scan line, and the state of the gap after it.
struct Placed {
    scan_line: ScanLine,
    gap: Relation,
}

/// Boxes of leaves give at most this number of scan lines.
const MAX_OF_LEAVES: usize = 1 << 17;

/// The number of bytes of scan lines, and of scan lines, from which gaps are refined one by one and only where the scan lines differ
/// ([`Refinement`]).
const MANY_BYTES: u64 = 16 << 20;
const MANY_LINES: usize = 1 << 14;

/// The number of scan lines of this refinement, and the least number in each gap; gaps that remain count as jumps. A corner takes
/// about ten, so that only where rounding errors make scan lines differ everywhere it is reached.
const MOST_LINES: usize = 1 << 20;
const LEAST_LINES: usize = 128;

/// Gaps per task of this refinement.
const GAPS: usize = 8;

/// The width of gaps with jumps, relative to the largest coordinate across the scan lines.
const FINEST: f64 = 1e-13;

/// The names of the boxes around the cells of an outline end with this.
const OUTLINE_CELL: &str = "contour.cell";

/// Scan lines per batch.
const CHUNK: usize = 1024;

/// The scan lines of one section.
pub struct ScanLines<'a, E: Evaluator> {
    evaluator: &'a E,
    scratch: E::Scratch,
    cut: &'a Cut,
    window: &'a SectionWindow,
    run: &'a SectionRun,
    /// The width of a gap that holds a jump: its position is that of corners and of edges along the scan lines.
    finest: f64,
    /// The size of all scan lines so far, in bytes.
    bytes: u64,
    /// The number of crossings of all scan lines.
    crossings: u64,
    growth: Growth,
}

impl<'a, E: Evaluator> ScanLines<'a, E> {
    pub fn new(
        evaluator: &'a E,
        cut: &'a Cut,
        window: &'a SectionWindow,
        run: &'a SectionRun,
    ) -> ScanLines<'a, E> {
        let (scratch, growth) = (evaluator.scratch(), Growth::default());
        // a few hundred roundings of the coordinates
        let finest = FINEST * window.lo[0].abs().max(window.hi[0].abs());
        ScanLines { evaluator, scratch, cut, window, run, finest, bytes: 0, crossings: 0, growth }
    }

    /// Traces and refines all scan lines; `take` receives them from left to right. Returns the number of crossings of all scan lines.
    pub fn swept(&mut self, take: &mut dyn FnMut(Step<'_>)) -> Result<u64, SectionError> {
        let places = self.first_places();
        let scan_lines = self.trace_scan_lines(&places)?;
        let mut row: Vec<Placed> =
            scan_lines.into_iter().map(|scan_line| Placed { scan_line, gap: Relation::Unknown }).collect();
        while row.len() < MANY_LINES && self.bytes < MANY_BYTES && self.halve(&mut row)? {}
        let Some(first) = row.first() else { return Ok(self.crossings) };
        take(Step::Jump(&first.scan_line));
        self.refine(&row, take)?;
        Ok(self.crossings)
    }

    /// Refines the remaining gaps of a row.
    fn refine(&mut self, row: &[Placed], take: &mut dyn FnMut(Step<'_>)) -> Result<(), SectionError> {
        let tracer = ScanLineTracer::new(self.evaluator, self.cut, self.window);
        let limits = self.limits();
        let gaps = row.len().saturating_sub(1);
        let open = row[..gaps].iter().filter(|placed| placed.gap == Relation::Unknown).count();
        let left = (MOST_LINES / open.max(1)).max(LEAST_LINES) as u32;
        let tasks = (0..gaps.div_ceil(GAPS)).map(|task| task * GAPS..gaps.min((task + 1) * GAPS));
        let work = |scratch: &mut E::Scratch, range: Range<usize>| {
            let mut crossings = 0;
            let refined = range.clone().map(|k| {
                (row[k].gap == Relation::Unknown).then(|| {
                    let (tracer, scratch) = (&tracer, &mut *scratch);
                    let mut refinement = Refinement { tracer, scratch, limits, left, crossings: 0 };
                    let gap = refinement.of(&row[k].scan_line, &row[k + 1].scan_line);
                    crossings += refinement.crossings;
                    gap
                })
            });
            let refined: Vec<Option<Gap>> = refined.collect();
            (range, refined, crossings)
        };
        let merge = |(range, refined, crossings): (Range<usize>, Vec<Option<Gap>>, u64)| {
            for (k, gap) in range.zip(&refined) {
                let next = &row[k + 1].scan_line;
                take(match (gap, row[k].gap) {
                    (Some(gap), _) => Step::Refined(gap, next),
                    (None, Relation::Smooth) => Step::Smooth(next),
                    (None, _) => Step::Jump(next),
                });
            }
            self.crossings += crossings;
            // the points of the edges stay
            self.bytes += crossings * size_of::<[f64; 2]>() as u64;
            self.growth.check(self.bytes)
        };
        let scratch = || self.evaluator.scratch();
        drive(thread_count(self.run.threads), &self.run.cancel, tasks, scratch, work, merge).map_err(stopped)
    }

    fn limits(&self) -> Limits {
        Limits { tolerance: self.window.tolerance, finest: self.finest }
    }

    /// Evenly spaced positions, and the start, middle and end of each leaf.
    fn first_places(&self) -> Vec<f64> {
        let (lo, hi) = (self.window.lo[0], self.window.hi[0]);
        let count = self.window.columns;
        let at = |k: u32| lo + (hi - lo) * (f64::from(k) + 0.5) / f64::from(count);
        let mut places: Vec<f64> = (0..count).map(at).collect();
        let program = self.evaluator.program();
        let model = &program.prototypes()[0];
        // the cells of an outline are no parts of the model, and their number is that of its corners
        let leaves = model.leaves.clone().map(LeafId);
        let leaves = leaves.filter(|&leaf| !program.leaf(leaf).name().ends_with(OUTLINE_CELL));
        let boxes = leaves.map(|leaf| program.leaf_bounds(leaf));
        let is_cut = |bounds: &Bounds| {
            let [below, above] = self.cut.range(bounds, 2);
            below <= self.window.tolerance && above >= -self.window.tolerance
        };
        for bounds in boxes.filter(is_cut).take(MAX_OF_LEAVES) {
            let [from, to] = self.cut.range(&bounds, 0);
            let beyond = 0.5 * self.window.tolerance;
            places.extend([from - beyond, from + beyond, 0.5 * (from + to), to - beyond, to + beyond]);
        }
        places.retain(|&u| lo < u && u < hi);
        places.sort_by(f64::total_cmp);
        places.dedup();
        places
    }

    /// Traces the middle of every undecided gap; false if there is none.
    fn halve(&mut self, row: &mut Vec<Placed>) -> Result<bool, SectionError> {
        let is_open = |pair: &[Placed]| pair[0].gap == Relation::Unknown;
        let middle = |pair: &[Placed]| 0.5 * (pair[0].scan_line.u + pair[1].scan_line.u);
        let places: Vec<f64> = row.windows(2).filter(|pair| is_open(pair)).map(middle).collect();
        if places.is_empty() {
            return Ok(false);
        }
        let (mut middles, limits) = (self.trace_scan_lines(&places)?.into_iter(), self.limits());
        let old = std::mem::take(row);
        let mut old = old.into_iter().peekable();
        while let Some(mut left) = old.next() {
            let open = left.gap == Relation::Unknown;
            let Some((right, scan_line)) =
                old.peek().filter(|_| open).and_then(|right| Some((right, middles.next()?)))
            else {
                row.push(left);
                continue;
            };
            let three = [&left.scan_line, &scan_line, &right.scan_line];
            let gap = limits.relation(three.map(|line| line.u), three.map(|line| &line.passes[..]));
            left.gap = gap;
            row.extend([left, Placed { scan_line, gap }]);
        }
        Ok(true)
    }

    /// Traces the scan lines at some positions; on this thread if they are few.
    fn trace_scan_lines(&mut self, places: &[f64]) -> Result<Vec<ScanLine>, SectionError> {
        let (evaluator, run) = (self.evaluator, self.run);
        let tracer = ScanLineTracer::new(evaluator, self.cut, self.window);
        if run.cancel.is_cancelled() {
            return Err(SectionError::Cancelled);
        }
        if places.len() <= 2 * CHUNK {
            let scan_lines = tracer.scan_lines(places, &mut self.scratch);
            self.count(&scan_lines);
            self.growth.check(self.bytes)?;
            return Ok(scan_lines);
        }
        let mut all = Vec::with_capacity(places.len());
        let work = |scratch: &mut E::Scratch, places: &[f64]| tracer.scan_lines(places, scratch);
        let merge = |scan_lines: Vec<ScanLine>| {
            self.count(&scan_lines);
            all.extend(scan_lines);
            self.growth.check(self.bytes)
        };
        let scratch = || evaluator.scratch();
        let outcome =
            drive(thread_count(run.threads), &run.cancel, places.chunks(CHUNK), scratch, work, merge);
        outcome.map(|()| all).map_err(stopped)
    }

    fn count(&mut self, scan_lines: &[ScanLine]) {
        let own = size_of::<Placed>() as u64;
        self.bytes += scan_lines.iter().map(|scan_line| own + scan_line.size()).sum::<u64>();
        self.crossings += scan_lines.iter().map(|scan_line| scan_line.passes.len() as u64).sum::<u64>();
    }
}

fn stopped(stopped: Stopped<Shortage>) -> SectionError {
    match stopped {
        Stopped::Cancelled => SectionError::Cancelled,
        Stopped::Failed(shortage) => SectionError::Memory(shortage),
    }
}
