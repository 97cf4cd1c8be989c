//! Scan lines: the parallel rays that sweep a plane, refined where neighbours differ.

use super::corner_steps::{CornerStep, CornerSteps};
use super::corners::Corners;
use super::same_curve::SameCurve;
use super::scan_line::ScanLine;
use super::tracer::ScanLineTracer;
use super::{Cut, SectionError, SectionRun, SectionWindow};
use rayweave_model::drive::{Stopped, drive, thread_count};
use rayweave_model::memory::Growth;
use rayweave_model::{Evaluator, LeafId};
use rayweave_polygon::is_outline_cell;

/// A scan line and its relation to the one before.
pub enum Step {
    /// All crossings continue.
    Smooth(ScanLine),
    /// The two scan lines may differ, and the gap is not refined further.
    Jump(ScanLine),
    /// Some crossings change at a corner; all others continue.
    Corner(CornerStep),
}

/// A scan line, and the state of the gap after it.
struct Placed {
    scan_line: ScanLine,
    gap: Gap,
    /// The corners in a smooth gap.
    steps: Vec<CornerStep>,
}

impl Placed {
    fn new(scan_line: ScanLine, gap: Gap) -> Placed {
        Placed { scan_line, gap, steps: Vec::new() }
    }
}

/// The memory of a scan line in bytes.
fn memory(scan_line: &ScanLine) -> u64 {
    (size_of::<Placed>() + size_of_val(scan_line.passes.as_slice())) as u64
}

fn size_of_row(row: &[Placed]) -> u64 {
    let steps = |placed: &Placed| placed.steps.iter().map(CornerStep::bytes).sum::<u64>();
    row.iter().map(|placed| memory(&placed.scan_line) + steps(placed)).sum()
}

#[derive(Clone, Copy, PartialEq)]
enum Gap {
    Unknown,
    Smooth,
    Jump,
}

/// Refinement stops at this number of scan lines. A sweep has fewer than twice as many, apart from those beside corners.
const MAX_COLUMNS: usize = 1 << 20;

/// The width of gaps with jumps, relative to the largest coordinate across the scan lines.
const FINEST: f64 = 1e-13;

/// The width, relative to the distance of the first scan lines, down to which gaps with unexplained corners of flat faces are halved.
const HALVED: f64 = 1.0 / 32.0;

/// Scan lines per batch, and gaps per task.
const CHUNK: usize = 1024;
const GAPS: usize = 32;

/// The memory in bytes from which on a row of scan lines is divided, and the largest number of its scan lines before they are refined.
const ROW_MEMORY: u64 = 48 << 20;
const FIRST_ROW: usize = 1 << 14;

/// The scan lines of one section.
pub struct ScanLines<'a, E: Evaluator> {
    evaluator: &'a E,
    scratch: E::Scratch,
    cut: &'a Cut,
    window: &'a SectionWindow,
    run: &'a SectionRun,
    /// The width of a gap that holds a jump: its position is that of corners and of edges along the scan lines.
    finest: f64,
    /// The size of the scan lines that are kept, in bytes.
    bytes: u64,
    growth: Growth,
    /// The memory in bytes from which on a row of scan lines is divided.
    row_memory: u64,
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
        ScanLines { evaluator, scratch, cut, window, run, finest, bytes: 0, growth, row_memory: ROW_MEMORY }
    }

    /// Traces and refines all scan lines, and passes them on from left to right. Gaps are refined independently: a row of scan lines that
    /// takes too much memory is divided, and its right half waits.
    pub fn sweep(&mut self, mut take: impl FnMut(Step)) -> Result<(), SectionError> {
        let (mut places, mut count, mut gap) = (self.first_places(), 0, Gap::Jump);
        let mut pass_on = |placed: Placed| {
            let before = std::mem::replace(&mut gap, placed.gap);
            take(match before {
                Gap::Smooth => Step::Smooth(placed.scan_line),
                _ => Step::Jump(placed.scan_line),
            });
            placed.steps.into_iter().for_each(|step| take(Step::Corner(step)));
        };
        places.reverse();
        let mut waiting: Vec<Vec<Placed>> = Vec::new();
        let mut last: Option<Placed> = None;
        while !(waiting.is_empty() && places.is_empty()) {
            let mut row = match waiting.pop() {
                Some(row) => row,
                None => {
                    let next = places.split_off(places.len().saturating_sub(FIRST_ROW));
                    let next: Vec<f64> = next.into_iter().rev().collect();
                    let unknown = |scan_line| Placed::new(scan_line, Gap::Unknown);
                    last.take()
                        .into_iter()
                        .chain(self.trace_scan_lines(&next)?.into_iter().map(unknown))
                        .collect()
                }
            };
            let is_open = |row: &[Placed]| row.iter().rev().skip(1).any(|placed| placed.gap == Gap::Unknown);
            while count + row.len() < MAX_COLUMNS
                && (row.len() <= 2 || size_of_row(&row) <= self.row_memory)
                && self.halve(&mut row)?
            {}
            if row.len() > 2
                && size_of_row(&row) > self.row_memory
                && is_open(&row)
                && count + row.len() < MAX_COLUMNS
            {
                let right = row.split_off(row.len() / 2);
                // the gap between both halves belongs to the left one
                row.push(Placed::new(right[0].scan_line.clone(), Gap::Unknown));
                waiting.extend([right, row]);
                continue;
            }
            // at the limit, an open gap is harmless if it is within the tolerance
            let is_wide = |pair: &[Placed]| {
                pair[0].gap == Gap::Unknown
                    && pair[1].scan_line.u - pair[0].scan_line.u > self.window.tolerance
            };
            if row.windows(2).any(is_wide) {
                return Err(SectionError::TooManyScanLines { limit: MAX_COLUMNS });
            }
            // the last scan line is the first one of the next row
            let end = row.pop();
            last = if waiting.is_empty() { end } else { None };
            count += row.len();
            row.into_iter().for_each(&mut pass_on);
            self.bytes = waiting.iter().map(|row| size_of_row(row)).sum();
        }
        last.into_iter().for_each(pass_on);
        Ok(())
    }

    /// Evenly spaced positions, and the start, middle and end of each leaf, except for the cells of outlines.
    fn first_places(&self) -> Vec<f64> {
        let (lo, hi) = (self.window.lo[0], self.window.hi[0]);
        let count = self.window.columns;
        let at = |k: u32| lo + (hi - lo) * (f64::from(k) + 0.5) / f64::from(count);
        let mut places: Vec<f64> = (0..count).map(at).collect();
        let program = self.evaluator.program();
        let model = &program.prototypes()[0];
        let leaves = model.leaves.clone().map(LeafId);
        let leaves = leaves.filter(|leaf| !is_outline_cell(&program.leaf(*leaf).name()));
        let boxes = leaves.map(|leaf| program.leaf_bounds(leaf));
        let is_cut = |bounds: &rayweave_math::Bounds| {
            let [below, above] = self.cut.range(bounds, 2);
            below <= self.window.tolerance && above >= -self.window.tolerance
        };
        for bounds in boxes.filter(is_cut).take(MAX_COLUMNS / 8) {
            let [from, to] = self.cut.range(&bounds, 0);
            let beyond = 0.5 * self.window.tolerance;
            places.extend([from - beyond, from + beyond, 0.5 * (from + to), to - beyond, to + beyond]);
        }
        places.retain(|&u| lo < u && u < hi);
        places.sort_by(f64::total_cmp);
        places.dedup();
        places
    }

    /// The search for corners.
    fn corners(&self) -> Corners<'a> {
        let narrow = self.window.tolerance.min(self.finest);
        let size = [self.window.lo, self.window.hi]
            .as_flattened()
            .iter()
            .fold(0.0, |size: f64, x| size.max(x.abs()));
        Corners { program: self.evaluator.program(), cut: self.cut, narrow, size }
    }

    /// The search for steps over corners.
    fn steps(&self) -> CornerSteps<'a, E> {
        CornerSteps {
            corners: self.corners(),
            tracer: ScanLineTracer::new(self.evaluator, self.cut, self.window),
            sampled: 0.5 * (self.window.hi[0] - self.window.lo[0]) / f64::from(self.window.columns),
        }
    }

    /// Closes the undecided gaps in which corners of flat faces are the only difference.
    fn step_over_corners(&mut self, row: &mut [Placed]) -> Result<(), SectionError> {
        let (evaluator, run, search) = (self.evaluator, self.run, self.steps());
        let open = |k: &usize| row[*k].gap == Gap::Unknown && search.may_step(&row[*k].scan_line);
        let gaps: Vec<usize> = (0..row.len().saturating_sub(1)).filter(open).collect();
        if gaps.is_empty() {
            return Ok(());
        }
        let mut found: Vec<(usize, Vec<CornerStep>)> = Vec::new();
        let work = |scratch: &mut E::Scratch, gaps: &[usize]| -> Vec<(usize, Vec<CornerStep>)> {
            let steps =
                |&k: &usize| Some((k, search.between(&row[k].scan_line, &row[k + 1].scan_line, scratch)?));
            gaps.iter().filter_map(steps).collect()
        };
        let merge = |steps: Vec<(usize, Vec<CornerStep>)>| {
            found.extend(steps);
            Ok::<(), SectionError>(())
        };
        let (threads, tasks) = (thread_count(run.threads), gaps.chunks(GAPS));
        drive(threads, &run.cancel, tasks, || evaluator.scratch(), work, merge).map_err(|stopped| {
            match stopped {
                Stopped::Cancelled => SectionError::Cancelled,
                Stopped::Failed(error) => error,
            }
        })?;
        for (k, steps) in found {
            (row[k].gap, row[k].steps) = (Gap::Smooth, steps);
        }
        Ok(())
    }

    /// Traces the middle of every undecided gap, or scan lines on both sides of the corners in it; false if there is none.
    fn halve(&mut self, row: &mut Vec<Placed>) -> Result<bool, SectionError> {
        self.step_over_corners(row)?;
        let is_open = |pair: &[Placed]| pair[0].gap == Gap::Unknown;
        let (corners, steps) = (self.corners(), self.steps());
        // corners that explain no step so far may do so between nearer scan lines
        let halved = HALVED * (self.window.hi[0] - self.window.lo[0]) / f64::from(self.window.columns);
        let within = |pair: &[Placed]| {
            let [left, right] = [&pair[0].scan_line, &pair[1].scan_line];
            let is_halved = right.u - left.u > halved && steps.may_step(left) && steps.may_step(right);
            let corners = if is_halved { Vec::new() } else { corners.between(left, right) };
            match corners.is_empty() {
                true => vec![0.5 * (pair[0].scan_line.u + pair[1].scan_line.u)],
                false => corners,
            }
        };
        let inserted: Vec<Vec<f64>> = row.windows(2).filter(|pair| is_open(pair)).map(within).collect();
        if inserted.is_empty() {
            return Ok(false);
        }
        let mut traced = self.trace_scan_lines(&inserted.concat())?.into_iter();
        let mut inserted = inserted.into_iter();
        let old = std::mem::take(row);
        let mut old = old.into_iter().peekable();
        while let Some(mut left) = old.next() {
            let open = left.gap == Gap::Unknown;
            let of_gap = old.peek().filter(|_| open).and_then(|right| Some((right, inserted.next()?)));
            let Some((right, places)) = of_gap else {
                row.push(left);
                continue;
            };
            if places.len() > 1 {
                row.push(left);
                // pairs of scan lines, one on each side of a corner
                for (k, scan_line) in traced.by_ref().take(places.len()).enumerate() {
                    let gap = if k % 2 == 0 { Gap::Jump } else { Gap::Unknown };
                    row.push(Placed::new(scan_line, gap));
                }
                continue;
            }
            let Some(scan_line) = traced.next() else {
                row.push(left);
                continue;
            };
            let gap = self.classified(&left.scan_line, &scan_line, &right.scan_line);
            left.gap = gap;
            row.extend([left, Placed::new(scan_line, gap)]);
        }
        Ok(true)
    }

    /// The state of both gaps next to a scan line between two others.
    fn classified(&self, left: &ScanLine, middle: &ScanLine, right: &ScanLine) -> Gap {
        let tolerance = self.window.tolerance;
        let is_straight = |k: usize| {
            let chord = 0.5 * (left.passes[k].v + right.passes[k].v);
            (middle.passes[k].v - chord).abs() <= tolerance
        };
        let same_curve = SameCurve { program: self.evaluator.program(), cut: self.cut };
        let is_smooth = same_curve.joins(left, middle) && same_curve.joins(middle, right);
        match () {
            () if is_smooth && (0..middle.passes.len()).all(is_straight) => Gap::Smooth,
            () if right.u - left.u <= 2.0 * tolerance.min(self.finest) => Gap::Jump,
            // the gap is as narrow as f64 can represent
            () if middle.u <= left.u || middle.u >= right.u => Gap::Jump,
            () => Gap::Unknown,
        }
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
            self.bytes += scan_lines.iter().map(memory).sum::<u64>();
            self.growth.check(self.bytes)?;
            return Ok(scan_lines);
        }
        let mut all = Vec::with_capacity(places.len());
        let work = |scratch: &mut E::Scratch, places: &[f64]| tracer.scan_lines(places, scratch);
        let merge = |scan_lines: Vec<ScanLine>| {
            self.bytes += scan_lines.iter().map(memory).sum::<u64>();
            all.extend(scan_lines);
            self.growth.check(self.bytes)
        };
        let scratch = || evaluator.scratch();
        let outcome =
            drive(thread_count(run.threads), &run.cancel, places.chunks(CHUNK), scratch, work, merge);
        match outcome {
            Ok(()) => Ok(all),
            Err(Stopped::Cancelled) => Err(SectionError::Cancelled),
            Err(Stopped::Failed(shortage)) => Err(SectionError::Memory(shortage)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::counted::Counted;
    use rayweave_math::Vec3;
    use rayweave_model::{Program, Solid};
    use rayweave_shape::primitive::{CentredBox, Primitive, Sphere};
    use std::sync::Arc;

    /// The same scan lines, whether all are refined together or row by row; the memory of rows stays small.
    #[test]
    fn divided_rows_have_the_same_scan_lines() {
        let ball = Solid::from(Primitive::from(Sphere::new(1.0).unwrap()));
        let cube = Solid::from(Primitive::from(CentredBox::new(Vec3::splat(1.0)).unwrap())).rotate_z(30.0);
        let all = Solid::union((0..20).map(|k| {
            let own = if k % 2 == 0 { &ball } else { &cube };
            own.translate(Vec3::new(0.7 * f64::from(k % 5), 1.3 * f64::from(k / 5), 0.1 * f64::from(k)))
        }));
        let evaluator = Counted::new(Arc::new(Program::compile(&all).unwrap()));
        let (cut, window) = (
            Cut::new(Vec3::new(0.0, 0.0, 0.9), Vec3::X, Vec3::Y).unwrap(),
            SectionWindow::new([-3.0; 2], [7.0; 2]),
        );
        let run = SectionRun::default();
        let swept = |row_memory: u64| {
            let mut found = Vec::new();
            let mut lines = ScanLines { row_memory, ..ScanLines::new(&evaluator, &cut, &window, &run) };
            let take = |step: Step| match step {
                Step::Smooth(line) => found.push((true, line)),
                Step::Jump(line) => found.push((false, line)),
                Step::Corner(step) => found.extend(step.sides.map(|line| (false, line))),
            };
            lines.sweep(take).unwrap();
            found
        };
        let together = swept(u64::MAX);
        assert!(together.len() > 1000 && together.iter().any(|(is_smooth, _)| !is_smooth));
        for row_memory in [0, 2_000, 100_000] {
            assert!(swept(row_memory) == together, "{row_memory}");
        }
    }
}
