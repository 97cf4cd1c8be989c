//! Linking of scan lines to edges, and of edges to contours.

use super::corner_steps::CornerStep;
use super::scan_line::{ScanCrossing, ScanLine};
use super::{SectionEdge, SectionWindow};
use rayweave_model::RegionId;
use std::collections::HashMap;

/// The open lines at the last scan line.
pub struct Lines {
    last: ScanLine,
    /// One line for each crossing of the last scan line.
    open: Vec<Vec<[f64; 2]>>,
    /// Crossings of neighbouring scan lines within this distance are the same.
    reach: f64,
    ends: [f64; 2],
    is_begun: bool,
}

impl Lines {
    pub fn new(window: &SectionWindow) -> Lines {
        let (reach, ends) = (8.0 * window.tolerance, [window.lo[0], window.hi[0]]);
        Lines { last: ScanLine::default(), open: Vec::new(), reach, ends, is_begun: false }
    }

    /// Extends the lines to a scan line with the same crossings.
    pub fn go_on(&mut self, scan_line: &ScanLine, edges: &mut Vec<SectionEdge>) {
        if scan_line.passes.len() != self.open.len() {
            return self.jump(scan_line, edges);
        }
        let points = self.open.iter_mut().zip(&scan_line.passes);
        points.for_each(|(line, pass)| line.push([scan_line.u, pass.v]));
        self.last = scan_line.clone();
    }

    /// Extends the lines to a scan line next to the last one; lines that do not continue end or begin at a wall.
    pub fn jump(&mut self, scan_line: &ScanLine, edges: &mut Vec<SectionEdge>) {
        let u = if self.is_begun { 0.5 * (self.last.u + scan_line.u) } else { self.ends[0] };
        self.is_begun = true;
        let (open, last) = (std::mem::take(&mut self.open), std::mem::take(&mut self.last));
        self.open = self.joined(open, [&last.passes, &scan_line.passes], (u, RegionId(0)), edges);
        for (line, pass) in self.open.iter_mut().zip(&scan_line.passes) {
            line.push([scan_line.u, pass.v]);
        }
        self.last = scan_line.clone();
    }

    /// Extends the lines at a corner.
    pub fn corner(&mut self, step: &CornerStep, edges: &mut Vec<SectionEdge>) {
        let [before, after] = &step.sides;
        let range = step.first..step.first + before.passes.len();
        let Some(own) = self.open.get_mut(range.clone()) else { return };
        let mut own: Vec<Vec<[f64; 2]>> = own.iter_mut().map(std::mem::take).collect();
        for (line, pass) in own.iter_mut().zip(&before.passes) {
            line.push([before.u, pass.v]);
        }
        let u = 0.5 * (before.u + after.u);
        let mut next = self.joined(own, [&before.passes, &after.passes], (u, step.below), edges);
        for (line, pass) in next.iter_mut().zip(&after.passes) {
            line.push([after.u, pass.v]);
        }
        self.open.splice(range, next);
    }

    /// The lines after `u`, from the open ones before it; `below` is the region below all of them. Lines that do not continue end or
    /// begin at a wall.
    fn joined(
        &self,
        mut open: Vec<Vec<[f64; 2]>>,
        [left, right]: [&[ScanCrossing]; 2],
        (u, below): (f64, RegionId),
        edges: &mut Vec<SectionEdge>,
    ) -> Vec<Vec<[f64; 2]>> {
        let (mut left, mut right) = (left.to_vec(), right.to_vec());
        let mut next = vec![Vec::new(); right.len()];
        let pairs = self.paired(&left, &right);
        for &(k, j) in &pairs {
            let v = 0.5 * (left[k].v + right[j].v);
            (left[k].v, right[j].v) = (v, v);
            next[j] = std::mem::take(&mut open[k]);
            next[j].push([u, v]);
        }
        for (line, pass) in open.into_iter().zip(&left) {
            close(line, pass, u, edges);
        }
        for (line, pass) in next.iter_mut().zip(&right).filter(|(line, _)| line.is_empty()) {
            line.push([u, pass.v]);
        }
        walls((u, below), &left, &right, edges);
        next
    }

    /// Pairs crossings of two scan lines between the same regions within `reach`, in order: first those through the same surface, then
    /// others between these. Both ends of a thin part may be nearer to each other than the reach.
    fn paired(&self, left: &[ScanCrossing], right: &[ScanCrossing]) -> Vec<(usize, usize)> {
        let is_near = |a: &ScanCrossing, b: &ScanCrossing| (b.v - a.v).abs() <= self.reach;
        let same_surface = in_order(left, right, |a, b| is_near(a, b) && a.is_like(b));
        let (mut pairs, mut from) = (Vec::with_capacity(same_surface.len()), (0, 0));
        for (k, j) in same_surface.into_iter().chain([(left.len(), right.len())]) {
            let between = in_order(&left[from.0..k], &right[from.1..j], |a, b| {
                is_near(a, b) && a.is_between_regions_of(b)
            });
            pairs.extend(between.into_iter().map(|(a, b)| (from.0 + a, from.1 + b)));
            if k < left.len() {
                pairs.push((k, j));
            }
            from = (k + 1, j + 1);
        }
        pairs
    }

    /// Extends the lines to the right side of the window.
    pub fn end(mut self, edges: &mut Vec<SectionEdge>) {
        let u = self.ends[1];
        let passes = std::mem::take(&mut self.last.passes);
        for (line, pass) in self.open.into_iter().zip(&passes) {
            close(line, pass, u, edges);
        }
        walls((u, RegionId(0)), &passes, &[], edges);
    }
}

/// Pairs items of two lists, in their order: each with the first one that fits.
fn in_order(
    left: &[ScanCrossing],
    right: &[ScanCrossing],
    fits: impl Fn(&ScanCrossing, &ScanCrossing) -> bool,
) -> Vec<(usize, usize)> {
    let (mut pairs, mut from) = (Vec::new(), 0);
    for (k, pass) in left.iter().enumerate() {
        if let Some(j) = (from..right.len()).find(|&j| fits(pass, &right[j])) {
            pairs.push((k, j));
            from = j + 1;
        }
    }
    pairs
}

/// Ends a line at a wall.
fn close(mut line: Vec<[f64; 2]>, pass: &ScanCrossing, u: f64, edges: &mut Vec<SectionEdge>) {
    if !line.is_empty() {
        line.push([u, pass.v]);
        edges.push(SectionEdge { points: line, left: pass.after, right: pass.before });
    }
}

/// The region of a scan line just above a coordinate; `lowest` is the region below all crossings.
fn region_above(passes: &[ScanCrossing], v: f64, lowest: RegionId) -> RegionId {
    let below = passes.partition_point(|pass| pass.v <= v);
    below.checked_sub(1).map_or(lowest, |last| passes[last].after)
}

/// Adds edges along the scan lines where the regions of two neighbours differ; `lowest` is the region below all crossings.
fn walls(
    (u, lowest): (f64, RegionId),
    left: &[ScanCrossing],
    right: &[ScanCrossing],
    edges: &mut Vec<SectionEdge>,
) {
    let mut ends: Vec<f64> = left.iter().chain(right).map(|pass| pass.v).collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    for pair in ends.windows(2) {
        let [before, after] = [left, right].map(|passes| region_above(passes, pair[0], lowest));
        if before != after {
            edges.push(SectionEdge { points: vec![[u, pair[0]], [u, pair[1]]], left: before, right: after });
        }
    }
}

/// A point as bits: the ends of joined lines are equal to the last bit.
fn key([u, v]: [f64; 2]) -> [u64; 2] {
    // adding 0 turns -0 into 0
    [(u + 0.0).to_bits(), (v + 0.0).to_bits()]
}

/// Joins lines whose ends coincide into longer ones.
pub fn chains(lines: Vec<Vec<[f64; 2]>>) -> Vec<Vec<[f64; 2]>> {
    let mut begins: HashMap<[u64; 2], Vec<usize>> = HashMap::new();
    for (number, line) in lines.iter().enumerate().rev() {
        begins.entry(key(line[0])).or_default().push(number);
    }
    let ends: HashMap<[u64; 2], usize> = lines.iter().fold(HashMap::new(), |mut ends, line| {
        *ends.entry(key(line[line.len() - 1])).or_default() += 1;
        ends
    });
    let mut lines: Vec<Option<Vec<[f64; 2]>>> = lines.into_iter().map(Some).collect();
    let mut found = Vec::new();
    // lines that begin where no line ends come first; the others are closed, or parts of lines already used
    let is_loose =
        |line: &Option<Vec<[f64; 2]>>| line.as_ref().is_some_and(|line| !ends.contains_key(&key(line[0])));
    let loose: Vec<usize> = (0..lines.len()).filter(|&number| is_loose(&lines[number])).collect();
    for number in loose.into_iter().chain(0..lines.len()) {
        let Some(mut chain) = lines[number].take() else { continue };
        loop {
            let last = chain[chain.len() - 1];
            if key(last) == key(chain[0]) {
                break;
            }
            let Some(next) = next_line(&mut begins, &mut lines, last) else { break };
            chain.extend_from_slice(&next[1..]);
        }
        found.push(chain);
    }
    found
}

/// An unused line that begins at a point.
fn next_line(
    begins: &mut HashMap<[u64; 2], Vec<usize>>,
    lines: &mut [Option<Vec<[f64; 2]>>],
    at: [f64; 2],
) -> Option<Vec<[f64; 2]>> {
    let numbers = begins.get_mut(&key(at))?;
    while let Some(number) = numbers.pop() {
        let line = lines[number].take();
        if line.is_some() {
            return line;
        }
    }
    None
}

/// The contours of a region, which lies to their left.
pub fn contours(edges: &[SectionEdge], region: RegionId) -> Vec<Vec<[f64; 2]>> {
    let of = |edge: &SectionEdge| match () {
        () if edge.left == region => Some(edge.points.clone()),
        () if edge.right == region => Some(edge.points.iter().rev().copied().collect()),
        () => None,
    };
    let mut closed = chains(edges.iter().filter_map(of).collect());
    closed.iter_mut().for_each(|contour| _ = contour.pop());
    closed.retain(|contour| contour.len() > 2);
    closed
}
