//! Refinement of the gap between two long scan lines, only where they differ.
//!
//! A scan line through a detailed outline has thousands of crossings, and a corner concerns one or two of them. Between scan lines
//! whose other crossings continue, only the *zones* around those that do not are traced, as short scan lines in windows of their
//! own. The position of a corner follows from the tangents of the edges that meet there, so that a few scan lines beside it
//! replace a bisection.

use super::scan_line::{Frame, ScanCrossing, ScanLine, ScanLineTracer};
use rayweave_math::UNIT_ROUNDOFF;
use rayweave_model::{Evaluator, RegionId};
use std::ops::Range;

/// The relation of two neighbouring scan lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relation {
    Unknown,
    /// All crossings continue.
    Smooth,
    /// They may differ, and the gap is not refined further.
    Jump,
}

/// The relation of two neighbouring scan lines, with all scan lines between them.
pub enum Gap {
    /// All crossings continue.
    Smooth,
    /// They may differ; the gap is not refined further.
    Jump,
    /// A scan line between them.
    Split(Box<(Gap, ScanLine, Gap)>),
    /// The crossings outside of the zones continue.
    Zones(Vec<Zone>),
}

/// A part of the gap between two scan lines that is refined on its own.
pub struct Zone {
    /// The crossings of the scan line to the left of the gap.
    pub left: Range<usize>,
    /// The crossings of the one to the right.
    pub right: Range<usize>,
    /// The region below.
    pub below: RegionId,
    pub gap: Gap,
}

/// The accuracy of refinement.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// The largest distance of an edge from the curve.
    pub tolerance: f64,
    /// The width of a gap with a jump.
    pub finest: f64,
}

/// Scan lines with fewer crossings are not divided into zones.
const LONG: usize = 16;

/// Crossings that continue are found among this number of crossings after a difference.
const REACH: usize = 24;

/// Refines a gap.
pub struct Refinement<'a, 'e, E: Evaluator> {
    pub tracer: &'a ScanLineTracer<'e, E>,
    pub scratch: &'a mut E::Scratch,
    pub limits: Limits,
    /// The number of scan lines that may still be traced.
    pub left: u32,
    /// The number of crossings of all scan lines.
    pub crossings: u64,
}

/// A gap between two scan lines, or between parts of them.
#[derive(Clone, Copy)]
struct Pair<'l> {
    places: [f64; 2],
    passes: [&'l [ScanCrossing]; 2],
}

impl<E: Evaluator> Refinement<'_, '_, E> {
    /// Refines the gap between two scan lines of the whole window.
    pub fn of(&mut self, left: &ScanLine, right: &ScanLine) -> Gap {
        let pair = Pair { places: [left.u, right.u], passes: [&left.passes, &right.passes] };
        let frame = self.tracer.frame;
        // scan lines of the whole window are always complete
        self.refined(pair, &frame, true).unwrap_or(Gap::Jump)
    }

    /// `None` if a scan line shows that the frame cuts off a part of the zone.
    fn refined(&mut self, pair: Pair<'_>, frame: &Frame, may_guess: bool) -> Option<Gap> {
        let [left, right] = pair.places;
        let middle = 0.5 * (left + right);
        if self.left == 0 || middle <= left || middle >= right {
            return Some(Gap::Jump);
        }
        if may_guess && let Some(places) = self.beside_corner(&pair) {
            let [before, after] = places.map(|u| self.traced(u, frame));
            return self.split_twice(pair, [before?, after?], frame);
        }
        let middle = self.traced(middle, frame)?;
        let passes = [pair.passes[0], &middle.passes, pair.passes[1]];
        match self.limits.relation([left, middle.u, right], passes) {
            Relation::Smooth => Some(Gap::Smooth),
            Relation::Jump => Some(Gap::Jump),
            Relation::Unknown => match self.zones(&pair, &middle, frame) {
                Some(zones) => Some(Gap::Zones(zones)),
                None => self.split(pair, middle, frame),
            },
        }
    }

    fn traced(&mut self, u: f64, frame: &Frame) -> Option<ScanLine> {
        self.left = self.left.saturating_sub(1);
        let scan_line = self.tracer.within(u, frame, self.scratch);
        self.crossings += scan_line.as_ref().map_or(1, |scan_line| scan_line.passes.len() as u64);
        scan_line
    }

    fn split(&mut self, pair: Pair<'_>, middle: ScanLine, frame: &Frame) -> Option<Gap> {
        let [first, second] = pair.at(&middle);
        let (first, second) = (self.refined(first, frame, true)?, self.refined(second, frame, true)?);
        Some(Gap::Split(Box::new((first, middle, second))))
    }

    /// Three gaps around two scan lines at a guess. The outer ones are bisected next, in case that it was wrong.
    fn split_twice(&mut self, pair: Pair<'_>, [before, after]: [ScanLine; 2], frame: &Frame) -> Option<Gap> {
        let [first, rest] = pair.at(&before);
        let [second, third] = rest.at(&after);
        let gaps = [first, second, third].map(|gap| self.refined(gap, frame, false));
        let [Some(first), Some(second), Some(third)] = gaps else { return None };
        let rest = Gap::Split(Box::new((second, after, third)));
        Some(Gap::Split(Box::new((first, before, rest))))
    }

    /// The zones where the crossings do not continue; `None` if they are most of the scan lines.
    fn zones(&mut self, pair: &Pair<'_>, middle: &ScanLine, frame: &Frame) -> Option<Vec<Zone>> {
        let [left, right] = pair.passes;
        if left.len() + right.len() < LONG {
            return None;
        }
        let stretches = stretches(pair, &middle.passes, frame, &self.limits)?;
        let mut zones = Vec::new();
        for stretch in stretches {
            let parts = [&left[stretch.left.clone()], &right[stretch.right.clone()]];
            let gap = self.refined(Pair { passes: parts, ..*pair }, &stretch.frame, false)?;
            zones.push(Zone { left: stretch.left, right: stretch.right, below: stretch.frame.below, gap });
        }
        Some(zones)
    }

    /// Places on both sides of the only corner in a gap, as the tangents of its edges predict it.
    fn beside_corner(&self, pair: &Pair<'_>) -> Option<[f64; 2]> {
        let [from, to] = pair.places;
        let [left, right] = pair.passes;
        let differences = differences(left, right);
        let [(a, b)] = &differences[..] else { return None };
        let on = |side: usize, k: usize| (pair.places[side], pair.passes[side][k]);
        let lines = match (a.len(), b.len()) {
            (1, 1) => [on(0, a.start), on(1, b.start)],
            (2, 0) => [on(0, a.start), on(0, a.start + 1)],
            (0, 2) => [on(1, b.start), on(1, b.start + 1)],
            _ => return None,
        };
        let [(u, p), (w, q)] = lines;
        let turn = p.slope - q.slope;
        let corner = from + ((q.v - p.v) + q.slope * (from - w) - p.slope * (from - u)) / turn;
        // the rounding of the positions of both edges, seen along their angle
        let lengths =
            p.v.abs() + q.v.abs() + from.abs().max(to.abs()) * (1.0 + p.slope.abs() + q.slope.abs());
        let error = 16.0 * UNIT_ROUNDOFF * lengths / turn.abs();
        let beside = error.max(0.9 * self.limits.finest.min(self.limits.tolerance));
        let places = [corner - beside, corner + beside];
        let is_useful =
            16.0 * beside < to - from && places[0] > from && places[1] < to && places[0] < places[1];
        is_useful.then_some(places)
    }
}

impl<'l> Pair<'l> {
    /// The gaps on both sides of a scan line.
    fn at(&self, middle: &'l ScanLine) -> [Pair<'l>; 2] {
        let ([from, to], [left, right]) = (self.places, self.passes);
        let first = Pair { places: [from, middle.u], passes: [left, &middle.passes] };
        [first, Pair { places: [middle.u, to], passes: [&middle.passes, right] }]
    }
}

impl Limits {
    /// True if three crossings of evenly spaced scan lines are on a straight edge.
    fn is_straight(&self, left: &ScanCrossing, middle: &ScanCrossing, right: &ScanCrossing) -> bool {
        (middle.v - 0.5 * (left.v + right.v)).abs() <= self.tolerance
    }

    /// The relation of two scan lines by that in the middle between them.
    pub fn relation(&self, places: [f64; 3], [left, middle, right]: [&[ScanCrossing]; 3]) -> Relation {
        let is_smooth = left.len() == middle.len()
            && middle.len() == right.len()
            && left.iter().zip(middle).zip(right).all(|((left, middle), right)| {
                left.is_like(middle) && middle.is_like(right) && self.is_straight(left, middle, right)
            });
        match () {
            () if is_smooth => Relation::Smooth,
            () if places[2] - places[0] <= 2.0 * self.tolerance.min(self.finest) => Relation::Jump,
            // the gap is as narrow as f64 can represent
            () if places[1] <= places[0] || places[1] >= places[2] => Relation::Jump,
            () => Relation::Unknown,
        }
    }
}

/// The ranges of crossings of two scan lines that do not continue: those between crossings that do.
fn differences(left: &[ScanCrossing], right: &[ScanCrossing]) -> Vec<(Range<usize>, Range<usize>)> {
    let (mut found, mut i, mut j) = (Vec::new(), 0, 0);
    while i < left.len() || j < right.len() {
        if i < left.len() && j < right.len() && left[i].is_like(&right[j]) {
            (i, j) = (i + 1, j + 1);
            continue;
        }
        let goes_on = |i: usize, j: usize| match (left.get(i), right.get(j)) {
            (None, None) => true,
            (Some(a), Some(b)) => a.is_like(b),
            _ => false,
        };
        let offsets = (1..=2 * REACH).flat_map(|sum| (0..=sum).map(move |a| (a, sum - a)));
        let next = offsets.map(|(a, b)| (i + a, j + b)).find(|&(i, j)| goes_on(i, j));
        let (to, up_to) = next.unwrap_or((left.len(), right.len()));
        found.push((i..to, j..up_to));
        (i, j) = (to, up_to);
    }
    found
}

/// A range of crossings of both scan lines with the window around them.
struct Stretch {
    left: Range<usize>,
    right: Range<usize>,
    frame: Frame,
}

/// The stretches of two scan lines that have to be refined, in windows that hold nothing else; `None` if they are most of the scan
/// lines, or if the scan line in the middle has other crossings outside of them.
fn stretches(
    pair: &Pair<'_>,
    middle: &[ScanCrossing],
    frame: &Frame,
    limits: &Limits,
) -> Option<Vec<Stretch>> {
    let [left, right] = pair.passes;
    let mut items = items(left, right);
    let most = (left.len() + right.len()) / 2;
    // the middle decides which crossings are on straight edges
    let mut k = 0;
    for item in &mut items {
        if !item.continues {
            continue;
        }
        let own = &left[item.left.start];
        let skipped = middle.get(k..)?.iter().take(2 * REACH).position(|other| own.is_like(other))?;
        let at = &middle[k + skipped];
        item.continues = limits.is_straight(own, at, &right[item.right.start]);
        k += skipped + 1;
    }
    // grow zones until a window along the scan lines separates each from its neighbours
    loop {
        let merged = merged(items);
        let refined: usize =
            merged.iter().filter(|item| !item.continues).map(|item| item.left.len() + item.right.len()).sum();
        if refined > most {
            return None;
        }
        let joined: Vec<usize> = (0..merged.len()).filter(|&k| overlaps_zone(&merged, k, pair)).collect();
        items = merged;
        if joined.is_empty() {
            break;
        }
        joined.into_iter().for_each(|k| items[k].continues = false);
    }
    let zones = (0..items.len()).filter(|&k| !items[k].continues);
    let zones: Vec<Stretch> = zones.map(|k| stretch(&items, k, pair, frame)).collect();
    is_middle_elsewhere_alike(&items, &zones, left, middle).then_some(zones)
}

/// A crossing that continues, or crossings that do not.
#[derive(Clone)]
struct Item {
    left: Range<usize>,
    right: Range<usize>,
    continues: bool,
}

fn items(left: &[ScanCrossing], right: &[ScanCrossing]) -> Vec<Item> {
    let (mut items, mut i, mut j) = (Vec::new(), 0, 0);
    let end = (left.len()..left.len(), right.len()..right.len());
    for (a, b) in differences(left, right).into_iter().chain([end]) {
        while i < a.start {
            items.push(Item { left: i..i + 1, right: j..j + 1, continues: true });
            (i, j) = (i + 1, j + 1);
        }
        if !a.is_empty() || !b.is_empty() {
            (i, j) = (a.end, b.end);
            items.push(Item { left: a, right: b, continues: false });
        }
    }
    items
}

/// The items with adjacent differences as one.
fn merged(items: Vec<Item>) -> Vec<Item> {
    let mut all: Vec<Item> = Vec::with_capacity(items.len());
    for item in items {
        match all.last_mut() {
            Some(last) if !last.continues && !item.continues => {
                (last.left.end, last.right.end) = (item.left.end, item.right.end);
            }
            _ => all.push(item),
        }
    }
    all
}

/// The smallest and largest coordinate of the crossings of an item.
fn range(item: &Item, pair: &Pair<'_>) -> [f64; 2] {
    let [left, right] = pair.passes;
    let all = left[item.left.clone()].iter().chain(&right[item.right.clone()]).map(|pass| pass.v);
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)])
}

/// True for a crossing that continues and that no window separates from an adjacent zone.
fn overlaps_zone(items: &[Item], k: usize, pair: &Pair<'_>) -> bool {
    if !items[k].continues {
        return false;
    }
    let [lo, hi] = range(&items[k], pair);
    let is_zone = |item: &&Item| !item.continues;
    let below =
        k.checked_sub(1).map(|k| &items[k]).filter(is_zone).is_some_and(|item| range(item, pair)[1] >= lo);
    let above = items.get(k + 1).filter(is_zone).is_some_and(|item| range(item, pair)[0] <= hi);
    below || above
}

/// A zone with its window: it ends next to the crossings below and above, so that it holds all between them.
fn stretch(items: &[Item], k: usize, pair: &Pair<'_>, frame: &Frame) -> Stretch {
    let (item, [lo, hi]) = (&items[k], range(&items[k], pair));
    let left = pair.passes[0];
    let mut own = *frame;
    if let Some(below) = k.checked_sub(1).map(|k| &items[k]) {
        let end = range(below, pair)[1];
        (own.ends[0], own.below) = (end + (lo - end) / 16.0, left[below.left.start].after);
    }
    if let Some(above) = items.get(k + 1) {
        let end = range(above, pair)[0];
        (own.ends[1], own.above) = (end - (end - hi) / 16.0, left[above.left.start].before);
    }
    Stretch { left: item.left.clone(), right: item.right.clone(), frame: own }
}

/// True if the crossings of the scan line in the middle that are in no zone are those that continue.
fn is_middle_elsewhere_alike(
    items: &[Item],
    zones: &[Stretch],
    left: &[ScanCrossing],
    middle: &[ScanCrossing],
) -> bool {
    let (mut zones, mut outside) = (zones.iter().peekable(), Vec::new());
    for pass in middle {
        while zones.next_if(|zone| zone.frame.ends[1] < pass.v).is_some() {}
        if zones.peek().is_none_or(|zone| pass.v < zone.frame.ends[0]) {
            outside.push(pass);
        }
    }
    let going_on = items.iter().filter(|item| item.continues).map(|item| &left[item.left.start]);
    going_on.clone().count() == outside.len() && going_on.zip(outside).all(|(own, other)| own.is_like(other))
}
