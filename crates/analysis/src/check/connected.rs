//! Separate pieces of regions, and closed cavities.
//!
//! Rays parallel to the axes through a grid divide every region, and the space around all of them, into chords. Two chords belong to
//! one piece if they cross each other, or if a straight line within the region joins them. What remains apart is connected, if at all,
//! only where no ray of the grid and none of those lines passes: by a bridge or an opening thinner than the distance of the rays.

use super::nearest::Nearest;
use super::probe::{IN_GRID, IN_JOINS, Probe};
use super::{Finding, FindingKind};
use crate::AnalysisError;
use crate::error::Cancelled;
use crate::measure::MeasuredChord;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::drive::Cancel;
use rayweave_model::{Crossing, Evaluator, Face, Query, RayAnswer, RayBatch, RegionId, attributes};
use rayweave_shape::Ray;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Models with more regions are not examined: in detectors, separate pieces are the usual case.
const MAX_REGIONS: u64 = 32;

/// The greatest number of rays along each side of the grid.
const MAX_ACROSS: usize = 96;

/// The position of the rays within their cells: off the planes of symmetry of a model.
const WITHIN: f64 = 0.5173;

/// Pieces with fewer chords are not reported: rounding may make them.
const LEAST_CHORDS: usize = 3;

/// The greatest number of pieces of a region that straight lines try to join, and of rays between the chords of the space and of the
/// regions: beyond them nothing is reported, and [`Scope`](super::Scope) says so.
const MAX_PIECES: usize = 200;
const MAX_RAYS: u64 = 1 << 17;

/// The most chords of the grid, for parts of differences and for checks: a model with more is examined with fewer rays.
const MAX_CHORDS: usize = 1 << 21;
const MAX_CHORDS_OF_CHECK: usize = 1 << 19;

/// A grid with fewer rays along each side than this shows too little of a part to report anything.
const LEAST_USEFUL: usize = 16;

/// The number of rays along each side of the grid that is reduced no further.
const LEAST_ACROSS: usize = 8;

/// Halvings of the distance between two chords of a thin wall, between parallel rays and along the wall. A straight line of length L
/// leaves a wall of thickness d and radius of curvature R if L^2 > 8 R d: for a wall of 1e-6 R that is 2.8e-3 R, and 256 lines
/// cover 0.7 R.
const HALVINGS: usize = 6;
const HALVINGS_ALONG: usize = 8;

/// The number of chords of a piece, and of chords near each of them, that are tried to be joined by straight lines.
const TRIED: usize = 12;

/// A part of a ray within one region.
#[derive(Clone, Copy, Debug)]
struct Chord {
    ray: Ray,
    region: RegionId,
    /// The faces at both ends; `None` at the ends of the grid.
    faces: [Option<Face>; 2],
    from: f64,
    to: f64,
    /// The regions before and after the chord; its own at the ends of the grid.
    beside: [RegionId; 2],
    /// The area that the ray represents.
    area: f64,
}

impl Chord {
    fn middle(&self) -> Vec3 {
        self.ray.at(0.5 * (self.from + self.to))
    }

    fn length(&self) -> f64 {
        self.to - self.from
    }

    /// True if both chords lie between the same two faces, as in a thin wall.
    fn has_faces_of(&self, other: &Chord) -> bool {
        self.region == other.region && self.faces == other.faces && self.faces[0].is_some()
    }

    /// True if both chords lie between the same two faces, in either direction.
    fn is_in_wall_of(&self, other: &Chord) -> bool {
        let [a, b] = other.faces;
        self.has_faces_of(other) || self.region == other.region && self.faces == [b, a] && b.is_some()
    }

    fn measured(&self) -> MeasuredChord {
        MeasuredChord { from: self.ray.at(self.from), to: self.ray.at(self.to) }
    }
}

/// Sets of connected chords.
struct Sets(Vec<u32>);

impl Sets {
    fn of(&mut self, mut node: u32) -> u32 {
        while self.0[node as usize] != node {
            // halve the path
            self.0[node as usize] = self.0[self.0[node as usize] as usize];
            node = self.0[node as usize];
        }
        node
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        // the lower number represents the set, whatever the order
        self.0[a.max(b) as usize] = a.min(b);
    }
}

/// The chords of a grid of rays along the three axes.
struct Chords<'a, E: Evaluator> {
    evaluator: &'a E,
    scratch: E::Scratch,
    frame: Bounds,
    across: usize,
    chords: Vec<Chord>,
    /// The chords of each ray: the one along axis a through cell (i, j) of the next two axes has the number (a n + j) n + i.
    first: Vec<u32>,
    sets: Sets,
    rays: u64,
    /// The number of rays at which a search gives up.
    limit: u64,
    /// The number of pairs of chords of neighbouring rays that were compared.
    compared: u64,
}

/// Findings about pieces and cavities of the regions with these names; `leaves` is the work of a ray, in units of that for a leaf.
pub fn findings<E: Evaluator>(
    names: &[&str],
    evaluator: &E,
    leaves: u64,
    probe: &mut Probe<'_, E>,
) -> Result<Vec<Finding>, AnalysisError> {
    if probe.frame.is_empty() || !probe.frame.is_finite() {
        return Ok(Vec::new());
    }
    // outside of the sampled box there is nothing to examine
    let regions = evaluator.program().region_bounds().iter().filter(|own| !own.is_empty()).count() as u64;
    if regions > MAX_REGIONS {
        (probe.scope.cavities_left_out, probe.scope.pieces_left_out) = (true, regions);
        return Ok(Vec::new());
    }
    let (leaves, most_across) = (leaves.max(1), (probe.settings.across as usize).min(MAX_ACROSS));
    // rays along three axes
    let affordable = (IN_GRID / (3 * leaves)).isqrt() as usize;
    if affordable < LEAST_USEFUL.min(most_across) {
        (probe.scope.cavities_left_out, probe.scope.pieces_left_out) = (true, regions);
        return Ok(Vec::new());
    }
    let across = most_across.min(affordable);
    let most_rays = MAX_RAYS.min(IN_JOINS / leaves);
    let cancel = &probe.settings.cancel;
    let mut found = Chords::of_grid(evaluator, probe.frame, across, MAX_CHORDS_OF_CHECK, cancel)?;
    found.join_at_crossings();
    // the space around the regions first: a region whose pieces need too many rays does not hide a cavity
    let (cavities, space_left_out) = found.search(names, true, most_rays, cancel)?;
    let (loose, pieces_left_out) = found.search(names, false, most_rays, cancel)?;
    probe.scope.rays += found.rays;
    (probe.scope.cavities_left_out, probe.scope.pieces_left_out) = (space_left_out > 0, pieces_left_out);
    Ok([cavities, loose].concat())
}

/// A connected part of a region, as far as the chords of a grid show it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConnectedPart {
    pub region: RegionId,
    pub volume: f64,
    pub centre: Vec3,
    pub bounds: Bounds,
    /// The length of its longest chord.
    pub longest: f64,
}

/// The connected parts of the selected regions within a box, none of which may be the space around all regions, and the number of
/// rays. `None` if it takes too many rays to join them.
pub(crate) fn connected_parts<E: Evaluator>(
    evaluator: &E,
    inner: Bounds,
    across: usize,
    is_selected: impl Fn(RegionId) -> bool,
    cancel: &Cancel,
) -> Result<(Option<Vec<ConnectedPart>>, u64), Cancelled> {
    let mut found = Chords::of_grid(evaluator, inner, across.min(MAX_ACROSS), MAX_CHORDS, cancel)?;
    found.join_at_crossings();
    found.limit = found.rays + MAX_RAYS;
    found.join_neighbours(false, cancel)?;
    found.join_by_lines(false, cancel)?;
    if found.has_given_up() {
        return Ok((None, found.rays));
    }
    let mut sets: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for k in 0..found.chords.len() as u32 {
        if is_selected(found.chords[k as usize].region) {
            sets.entry(found.sets.of(k)).or_default().push(k);
        }
    }
    let parts = sets.into_values().map(|chords| found.part(&chords)).collect();
    Ok((Some(parts), found.rays))
}

impl<'a, E: Evaluator> Chords<'a, E> {
    /// The chords of a grid of so many rays along each side of a box and the space around it, or of a coarser grid with at most
    /// `most` chords.
    fn of_grid(
        evaluator: &'a E,
        inner: Bounds,
        across: usize,
        most: usize,
        cancel: &Cancel,
    ) -> Result<Chords<'a, E>, Cancelled> {
        let mut found = Chords::new(evaluator, inner, across);
        while !found.trace(most, cancel)? {
            // the number of chords grows with the square
            let coarser = (found.across * 2 / 3).max(LEAST_ACROSS);
            found = Chords { rays: found.rays, ..Chords::new(evaluator, inner, coarser) };
        }
        Ok(found)
    }

    /// A grid without chords.
    fn new(evaluator: &'a E, inner: Bounds, across: usize) -> Chords<'a, E> {
        // the outermost cells are outside of the model
        let margin = 1.5 * inner.size() / across as f64;
        let frame = Bounds { lo: inner.lo - margin, hi: inner.hi + margin };
        Chords {
            evaluator,
            scratch: evaluator.scratch(),
            frame,
            across,
            chords: Vec::new(),
            first: vec![0],
            sets: Sets(Vec::new()),
            rays: 0,
            limit: 0,
            compared: 0,
        }
    }

    /// The findings in the space or in the regions, by a number of rays, and the number of regions whose pieces remain unknown.
    fn search(
        &mut self,
        names: &[&str],
        is_space: bool,
        most_rays: u64,
        cancel: &Cancel,
    ) -> Result<(Vec<Finding>, u64), Cancelled> {
        self.limit = self.rays + most_rays;
        self.join_neighbours(is_space, cancel)?;
        self.join_by_lines(is_space, cancel)?;
        let mut sizes = self.pieces(is_space, usize::MAX).into_values().map(|sets| sets.len());
        match self.has_given_up() {
            // a region in one piece stays in one piece
            true => Ok((Vec::new(), sizes.filter(|&sets| sets > 1).count() as u64)),
            false => {
                let left_out = sizes.by_ref().filter(|&sets| sets > MAX_PIECES).count() as u64;
                Ok((self.findings(names, is_space), left_out))
            }
        }
    }

    /// True if a search has used all of its rays: its result is then not complete.
    fn has_given_up(&self) -> bool {
        self.rays > self.limit
    }

    fn step(&self, axis: usize) -> f64 {
        self.frame.size()[axis] / self.across as f64
    }

    fn place(&self, axis: usize, cell: usize) -> f64 {
        self.frame.lo[axis] + self.step(axis) * (cell as f64 + WITHIN)
    }

    /// Traces the rays of the grid; false if there are more chords than `most`, unless there are only a few rays.
    fn trace(&mut self, most: usize, cancel: &Cancel) -> Result<bool, Cancelled> {
        let n = self.across;
        for axis in 0..3 {
            let [u, v] = [1, 2].map(|k| (axis + k) % 3);
            for row in 0..n {
                stop_if_cancelled(cancel)?;
                let rays = (0..n).map(|column| {
                    let mut origin = self.frame.lo;
                    origin[u] = self.place(u, column);
                    origin[v] = self.place(v, row);
                    Ray::new(origin, Vec3::AXES[axis])
                });
                let rays: Vec<Ray> = rays.collect();
                let area = self.step(u) * self.step(v);
                for chords in self.along(&rays, area, [0.0, self.frame.size()[axis]]) {
                    self.chords.extend(chords);
                    self.first.push(self.chords.len() as u32);
                }
                if self.chords.len() > most && n > LEAST_ACROSS {
                    return Ok(false);
                }
            }
        }
        self.sets = Sets((0..self.chords.len() as u32).collect());
        // all of the space that reaches the ends of the grid is outside
        let is_outside =
            |chord: &Chord| chord.region == RegionId(0) && chord.faces.iter().any(Option::is_none);
        let outside: Vec<u32> =
            (0..self.chords.len() as u32).filter(|&k| is_outside(&self.chords[k as usize])).collect();
        outside.windows(2).for_each(|pair| self.sets.join(pair[0], pair[1]));
        Ok(true)
    }

    /// The chords of rays between two times.
    fn along(&mut self, rays: &[Ray], area: f64, [lo, hi]: [f64; 2]) -> Vec<Vec<Chord>> {
        self.rays += rays.len() as u64;
        let batch = RayBatch::from_iter(rays.iter().copied());
        let mut all = vec![Vec::new(); rays.len()];
        let mut sink = |answer: RayAnswer<'_>| {
            let ray = rays[answer.ray];
            let inner: Vec<&Crossing> = answer.crossings.iter().filter(|c| lo < c.t && c.t < hi).collect();
            let started = answer.crossings.iter().take_while(|c| c.t <= lo).last();
            let mut region = started.map_or(answer.start, |crossing| crossing.after);
            let (mut from, mut face, mut before) = (lo, None, region);
            let mut add = |region, faces, from, to, beside| {
                all[answer.ray].push(Chord { ray, region, faces, from, to, beside, area });
            };
            for crossing in inner {
                add(region, [face, Some(crossing.face)], from, crossing.t, [before, crossing.after]);
                before = region;
                (region, from, face) = (crossing.after, crossing.t, Some(crossing.face));
            }
            add(region, [face, None], from, hi, [before, region]);
        };
        self.evaluator.crossings(batch.rays(), &Query::default(), &mut self.scratch, &mut sink);
        all
    }

    fn ray_number(&self, axis: usize, column: usize, row: usize) -> usize {
        (axis * self.across + row) * self.across + column
    }

    /// The chord of a ray of the grid that contains a time.
    fn chord_at(&self, ray: usize, t: f64) -> Option<u32> {
        let [first, last] = [self.first[ray], self.first[ray + 1]];
        let own = &self.chords[first as usize..last as usize];
        let k = own.partition_point(|chord| chord.to <= t);
        own.get(k).filter(|chord| chord.from < t).map(|_| first + k as u32)
    }

    /// Joins chords that cross each other at points of the grid.
    fn join_at_crossings(&mut self) {
        let n = self.across;
        for row in 0..n {
            for column in 0..n {
                // the ray along z through x cell `column` and y cell `row`
                let ray = self.ray_number(2, column, row);
                for own in self.first[ray]..self.first[ray + 1] {
                    let chord = self.chords[own as usize];
                    let cell = |t: f64| (t / self.step(2) - WITHIN).ceil().max(0.0) as usize;
                    for k in cell(chord.from)..cell(chord.to).min(n) {
                        let along_x = self.ray_number(0, row, k);
                        let along_y = self.ray_number(1, k, column);
                        let [x, y] = [(0, column), (1, row)]
                            .map(|(axis, cell)| self.step(axis) * (cell as f64 + WITHIN));
                        for other in
                            [self.chord_at(along_x, x), self.chord_at(along_y, y)].into_iter().flatten()
                        {
                            // rounding may put a point on the other side of a face
                            if self.chords[other as usize].region == chord.region {
                                self.sets.join(own, other);
                            }
                        }
                    }
                }
            }
        }
    }

    /// Joins chords of neighbouring rays by lines between them.
    fn join_neighbours(&mut self, is_space: bool, cancel: &Cancel) -> Result<(), Cancelled> {
        let n = self.across;
        for axis in 0..3 {
            for row in 0..n {
                stop_if_cancelled(cancel)?;
                for column in 0..n {
                    let ray = self.ray_number(axis, column, row);
                    let right = (column + 1 < n).then(|| self.ray_number(axis, column + 1, row));
                    let up = (row + 1 < n).then(|| self.ray_number(axis, column, row + 1));
                    for other in [right, up].into_iter().flatten() {
                        self.join_rays(ray, other, is_space);
                    }
                }
            }
        }
        Ok(())
    }

    fn join_rays(&mut self, ray: usize, other: usize, is_space: bool) {
        let others = self.first[other]..self.first[other + 1];
        let by_faces = self.by_faces(others.clone());
        let mut near: Vec<u32> = Vec::new();
        for a in self.first[ray]..self.first[ray + 1] {
            let one = self.chords[a as usize];
            if (one.region == RegionId(0)) != is_space {
                continue;
            }
            if self.has_given_up() {
                return;
            }
            self.beside(&one, others.clone(), &by_faces, &mut near);
            self.compared += near.len() as u64;
            for &b in &near {
                let two = self.chords[b as usize];
                if self.sets.of(a) != self.sets.of(b) && self.are_joined(&one, &two, HALVINGS) {
                    self.sets.join(a, b);
                }
            }
        }
    }

    /// The chords between two faces, in the order of these.
    fn by_faces(&self, chords: Range<u32>) -> Vec<u32> {
        let mut sorted: Vec<u32> =
            chords.filter(|&k| self.chords[k as usize].faces.iter().all(Option::is_some)).collect();
        sorted.sort_by_key(|&k| (self.chords[k as usize].faces, k));
        sorted
    }

    /// Those of the consecutive chords of a parallel ray, which are also given in the order of their faces, that overlap a chord within
    /// its region or have its faces.
    fn beside(&self, own: &Chord, chords: Range<u32>, by_faces: &[u32], found: &mut Vec<u32>) {
        found.clear();
        let of = |k: &u32| &self.chords[*k as usize];
        let all = &self.chords[chords.start as usize..chords.end as usize];
        let first = chords.start + all.partition_point(|other| other.to <= own.from) as u32;
        let overlapping = (first..chords.end).take_while(|k| of(k).from < own.to);
        found.extend(overlapping.filter(|k| of(k).region == own.region && overlaps(own, of(k))));
        let first = by_faces.partition_point(|k| of(k).faces < own.faces);
        let same = by_faces[first..].iter().take_while(|k| of(k).faces == own.faces);
        found.extend(same.filter(|k| of(k).has_faces_of(own)));
        found.sort_unstable();
        found.dedup();
    }

    /// True if a line within the region joins two chords of parallel rays, or a sequence of lines through chords between them.
    fn are_joined(&mut self, one: &Chord, two: &Chord, halvings: usize) -> bool {
        if overlaps(one, two) {
            let (from, to) = (one.from.max(two.from), one.to.min(two.to));
            return [0.5, 0.25, 0.75].into_iter().any(|part| {
                let t = from + part * (to - from);
                self.is_within(one.ray.at(t), two.ray.at(t), one.region)
            });
        }
        if halvings == 0 || !one.has_faces_of(two) || self.has_given_up() {
            return false;
        }
        let origin = 0.5 * (one.ray.origin + two.ray.origin);
        let middle = Ray::new(origin, one.ray.direction);
        let (lo, hi) = (one.from.min(two.from), one.to.max(two.to));
        // the chord between may begin or end beyond both, and others of the same faces are farther away
        let ends = [lo - (hi - lo), hi + (hi - lo)];
        let off = |own: &Chord| (own.from + own.to - lo - hi).abs();
        let own = self.along(&[middle], one.area, ends).into_iter().flatten();
        let own = own.filter(|own| own.has_faces_of(one));
        let between = own.min_by(|a, b| off(a).total_cmp(&off(b)));
        between.is_some_and(|between| {
            self.are_joined(one, &between, halvings - 1) && self.are_joined(&between, two, halvings - 1)
        })
    }

    /// True if a line within the region joins the middles of two chords or, between the same two faces, a sequence of lines between
    /// the middles of chords along the wall.
    fn are_in_one_wall(&mut self, one: &Chord, two: &Chord, halvings: usize) -> bool {
        if self.is_within(one.middle(), two.middle(), one.region) {
            return true;
        }
        if halvings == 0 || !one.is_in_wall_of(two) || self.has_given_up() {
            return false;
        }
        self.between(one, two).is_some_and(|between| {
            self.are_in_one_wall(one, &between, halvings - 1)
                && self.are_in_one_wall(&between, two, halvings - 1)
        })
    }

    /// A chord of the wall of two others between them, across the wall.
    fn between(&mut self, one: &Chord, two: &Chord) -> Option<Chord> {
        let (from, to) = (one.middle(), two.middle());
        let evaluator = self.evaluator;
        let program = evaluator.program();
        let across = |chord: &Chord| {
            let face = chord.faces[0]?;
            let normal = attributes::world_gradient(program, &chord.ray, face, chord.from).try_normalize()?;
            Some(if normal.dot(chord.ray.direction) < 0.0 { -normal } else { normal })
        };
        let (mut first, second) = (across(one)?, across(two)?);
        if one.faces != two.faces {
            first = -first;
        }
        let ray = Ray::new(0.5 * (from + to), (first + second).try_normalize()?);
        let far = (to - from).length();
        let near = |own: &Chord| (own.from + own.to).abs();
        let found = self.along(&[ray], one.area, [-far, far]).into_iter().flatten();
        let found = found.filter(|own| own.is_in_wall_of(one));
        found.min_by(|a, b| near(a).total_cmp(&near(b)))
    }

    /// True if the line between two points stays in a region.
    fn is_within(&mut self, from: Vec3, to: Vec3, region: RegionId) -> bool {
        self.rays += 1;
        let batch = RayBatch::from_iter([Ray::new(from, to - from)]);
        let mut is_within = false;
        let mut sink = |answer: RayAnswer<'_>| {
            let before = answer.crossings.iter().take_while(|crossing| crossing.t <= 0.0).last();
            let start = before.map_or(answer.start, |crossing| crossing.after);
            is_within = start == region && !answer.crossings.iter().any(|c| 0.0 < c.t && c.t < 1.0);
        };
        self.evaluator.crossings(batch.rays(), &Query::default(), &mut self.scratch, &mut sink);
        is_within
    }

    /// The chords of each set of the space or of the regions, the largest volume first, for regions with up to `most` sets.
    fn pieces(&mut self, is_space: bool, most: usize) -> BTreeMap<RegionId, Vec<Vec<u32>>> {
        let mut by_set: BTreeMap<(RegionId, u32), Vec<u32>> = BTreeMap::new();
        for k in 0..self.chords.len() as u32 {
            if (self.chords[k as usize].region == RegionId(0)) != is_space {
                continue;
            }
            by_set.entry((self.chords[k as usize].region, self.sets.of(k))).or_default().push(k);
        }
        let mut pieces: BTreeMap<RegionId, Vec<Vec<u32>>> = BTreeMap::new();
        for ((region, _), chords) in by_set {
            pieces.entry(region).or_default().push(chords);
        }
        pieces.retain(|_, own| own.len() <= most);
        for own in pieces.values_mut() {
            let mut sized: Vec<(f64, Vec<u32>)> =
                own.drain(..).map(|chords| (self.volume(&chords), chords)).collect();
            sized.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
            own.extend(sized.into_iter().map(|(_, chords)| chords));
        }
        pieces
    }

    /// Joins sets by straight lines between their chords, and by chords along other axes through the middles of their chords.
    fn join_by_lines(&mut self, is_space: bool, cancel: &Cancel) -> Result<(), Cancelled> {
        for sets in self.pieces(is_space, MAX_PIECES).into_values().filter(|sets| sets.len() > 1) {
            let middles = sets.iter().flatten().map(|&k| (self.chords[k as usize].middle(), k));
            let nearest = Nearest::new(middles.collect(), |k| self.sets.of(k));
            for small in sets.iter().skip(1) {
                stop_if_cancelled(cancel)?;
                for own in self.longest_of(small) {
                    if self.has_given_up() {
                        return Ok(());
                    }
                    self.join_across(own);
                    self.join_nearest(own, &nearest);
                }
            }
        }
        Ok(())
    }

    /// The longest chords of a piece.
    fn longest_of(&self, chords: &[u32]) -> Vec<u32> {
        let mut sorted: Vec<(f64, u32)> =
            chords.iter().map(|&k| (self.chords[k as usize].length(), k)).collect();
        sorted.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        sorted.into_iter().take(TRIED).map(|(_, k)| k).collect()
    }

    /// Joins a chord with the nearest ones of other sets, by lines between their middles.
    fn join_nearest(&mut self, own: u32, nearest: &Nearest) {
        let chord = self.chords[own as usize];
        let set = self.sets.of(own);
        for other in nearest.outside(chord.middle(), set, TRIED, |k| self.sets.of(k)) {
            let near = self.chords[other as usize];
            if self.sets.of(other) != self.sets.of(own) && self.are_in_one_wall(&chord, &near, HALVINGS_ALONG)
            {
                self.sets.join(own, other);
            }
        }
    }

    /// Joins a chord with those of the nearest rays along the other axes, by a ray through its middle.
    fn join_across(&mut self, own: u32) {
        let (chord, n) = (self.chords[own as usize], self.across);
        let middle = chord.middle();
        for axis in (0..3).filter(|&axis| chord.ray.direction[axis] == 0.0) {
            let [u, v] = [1, 2].map(|k| (axis + k) % 3);
            let mut origin = middle;
            origin[axis] = self.frame.lo[axis];
            let size = self.frame.size()[axis];
            let through = self.along(&[Ray::new(origin, Vec3::AXES[axis])], chord.area, [0.0, size]);
            let at = middle[axis] - self.frame.lo[axis];
            let Some(through) = through.into_iter().flatten().find(|c| c.from < at && at < c.to) else {
                continue;
            };
            if through.region != chord.region {
                continue;
            }
            let cells = [u, v].map(|k| ((middle[k] - self.frame.lo[k]) / self.step(k) - WITHIN).floor());
            for (right, up) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                let [column, row] = [cells[0] + right, cells[1] + up];
                if column < 0.0 || row < 0.0 || column >= n as f64 || row >= n as f64 {
                    continue;
                }
                let ray = self.ray_number(axis, column as usize, row as usize);
                for other in self.first[ray]..self.first[ray + 1] {
                    let two = self.chords[other as usize];
                    let may_join = two.region == chord.region
                        && (overlaps(&through, &two) || through.has_faces_of(&two));
                    if may_join
                        && self.sets.of(other) != self.sets.of(own)
                        && self.are_joined(&through, &two, HALVINGS)
                    {
                        self.sets.join(own, other);
                    }
                }
            }
        }
    }

    /// The volume that chords represent: each of the three directions of rays covers it once.
    fn volume(&self, chords: &[u32]) -> f64 {
        let of = |&k: &u32| self.chords[k as usize].length() * self.chords[k as usize].area;
        chords.iter().map(of).sum::<f64>() / 3.0
    }

    /// The part that consists of these chords, at least one.
    fn part(&self, chords: &[u32]) -> ConnectedPart {
        let own = || chords.iter().map(|&k| &self.chords[k as usize]);
        let (mut moment, mut weight, mut bounds, mut longest) = (Vec3::ZERO, 0.0, Bounds::EMPTY, 0.0f64);
        for chord in own() {
            let size = chord.length() * chord.area;
            moment += size * chord.middle();
            weight += size;
            longest = longest.max(chord.length());
            for end in [chord.from, chord.to].map(|t| chord.ray.at(t)) {
                bounds = bounds.union(&Bounds::new(end, end));
            }
        }
        let region = own().next().map_or(RegionId(0), |chord| chord.region);
        ConnectedPart { region, volume: weight / 3.0, centre: moment / weight, bounds, longest }
    }

    fn findings(&mut self, names: &[&str], is_space: bool) -> Vec<Finding> {
        let mut found = Vec::new();
        for (region, mut sets) in self.pieces(is_space, MAX_PIECES) {
            sets.retain(|chords| chords.len() >= LEAST_CHORDS);
            match region.index().checked_sub(1).and_then(|k| names.get(k)) {
                Some(name) if sets.len() > 1 => found.push(self.loose(name, &sets)),
                Some(_) => {}
                None => {
                    let is_open = |chords: &Vec<u32>| {
                        let mut ends = chords.iter().flat_map(|&k| self.chords[k as usize].faces);
                        ends.any(|face| face.is_none())
                    };
                    let closed: Vec<Vec<u32>> = sets.into_iter().filter(|chords| !is_open(chords)).collect();
                    found.extend(closed.iter().map(|chords| self.cavity(names, chords)));
                }
            }
        }
        found
    }

    /// The longest chord of a piece.
    fn longest(&self, chords: &[u32]) -> Chord {
        let all = chords.iter().map(|&k| self.chords[k as usize]);
        let longest = all.reduce(|best, next| if next.length() > best.length() { next } else { best });
        longest.unwrap_or_else(|| unreachable!("a piece has chords"))
    }

    fn loose(&self, name: &str, sets: &[Vec<u32>]) -> Finding {
        let smallest = &sets[sets.len() - 1];
        let volume = rayweave_math::round_to_digits(self.volume(smallest), 2);
        let text = format!(
            "{name} consists of {} separate pieces; the smallest has a volume of about {volume}",
            sets.len()
        );
        let chord = self.longest(smallest);
        let finding = Finding::new(FindingKind::Loose, &[name], text);
        Finding { at: Some(chord.middle()), ray: Some(chord.measured()), ..finding }
    }

    /// A cavity in one region, or between several.
    fn cavity(&self, names: &[&str], chords: &[u32]) -> Finding {
        let chord = self.longest(chords);
        let beside: BTreeSet<RegionId> =
            chords.iter().flat_map(|&k| self.chords[k as usize].beside).collect();
        let around: Vec<&str> = beside
            .iter()
            .filter_map(|region| region.index().checked_sub(1).and_then(|k| names.get(k)).copied())
            .collect();
        let volume = rayweave_math::round_to_digits(self.volume(chords), 2);
        let cavity = format!("a closed cavity with a volume of about {volume}");
        let text = match &around[..] {
            [] => format!("the model has {cavity}"),
            [name] => format!("{name} has {cavity}"),
            [first @ .., last] => format!("{} and {last} enclose {cavity}", first.join(", ")),
        };
        let finding = Finding::new(FindingKind::Cavity, &around, text);
        Finding { at: Some(chord.middle()), ray: Some(chord.measured()), ..finding }
    }
}

fn stop_if_cancelled(cancel: &Cancel) -> Result<(), Cancelled> {
    if cancel.is_cancelled() { Err(Cancelled) } else { Ok(()) }
}

/// True if two chords of parallel rays overlap along the rays.
fn overlaps(one: &Chord, two: &Chord) -> bool {
    one.from.max(two.from) < one.to.min(two.to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::counted::Counted;
    use rayweave_model::{Program, Solid};
    use rayweave_shape::primitive::{BoxFromCorners, Primitive};
    use std::sync::Arc;

    /// Fins of thickness 1 at distances of 1.
    fn fins(count: usize) -> Counted {
        let fin = |k: usize| {
            let lo = Vec3::new(2.0 * k as f64, 0.0, 0.0);
            let own = BoxFromCorners::new(lo, lo + Vec3::new(1.0, 20.0, 20.0)).unwrap();
            Solid::from(Primitive::from(own))
        };
        Counted::new(Arc::new(Program::compile(&Solid::union((0..count).map(fin))).unwrap()))
    }

    fn grid(evaluator: &Counted, across: usize, most: usize) -> Chords<'_, Counted> {
        let frame = evaluator.program().bounds();
        let mut found = Chords::of_grid(evaluator, frame, across, most, &Cancel::new()).unwrap();
        found.join_at_crossings();
        found.limit = u64::MAX;
        found
    }

    /// Each of 401 chords of a ray along the row overlaps one chord of the next ray.
    #[test]
    fn chords_are_compared_with_those_beside_them() {
        let evaluator = fins(200);
        let mut found = grid(&evaluator, 24, usize::MAX);
        for is_space in [false, true] {
            found.join_neighbours(is_space, &Cancel::new()).unwrap();
        }
        let chords = found.chords.len() as u64;
        assert!(chords > 200 * 24 * 24 && found.compared <= 4 * chords, "{chords} {}", found.compared);
    }

    #[test]
    fn chords_beside_a_chord_are_those_of_a_full_comparison() {
        let evaluator = fins(5);
        let found = grid(&evaluator, 16, usize::MAX);
        let mut near = Vec::new();
        for ray in 0..3 * 16 * 16 - 16 {
            let others = found.first[ray + 16]..found.first[ray + 17];
            let by_faces = found.by_faces(others.clone());
            for own in found.first[ray]..found.first[ray + 1] {
                let own = found.chords[own as usize];
                found.beside(&own, others.clone(), &by_faces, &mut near);
                let is_beside = |k: &u32| {
                    let other = &found.chords[*k as usize];
                    own.region == other.region && (overlaps(&own, other) || own.has_faces_of(other))
                };
                assert_eq!(near, others.clone().filter(is_beside).collect::<Vec<u32>>(), "{ray}");
            }
        }
    }

    /// Without rays for lines between chords the pieces of the region, and only they, remain unknown; more than 200 are not counted.
    #[test]
    fn regions_whose_pieces_remain_unknown_are_counted() {
        let names = &["fins"];
        let searched = |count: usize, is_space: bool, most_rays: u64| {
            let evaluator = fins(count);
            let mut found = grid(&evaluator, 24, usize::MAX);
            let (found, left_out) = found.search(names, is_space, most_rays, &Cancel::new()).unwrap();
            (found.len(), left_out)
        };
        assert_eq!(searched(100, false, 0), (0, 1));
        assert_eq!(searched(100, false, MAX_RAYS), (1, 0));
        assert_eq!(searched(201, false, MAX_RAYS), (0, 1));
        assert_eq!(searched(201, true, MAX_RAYS), (0, 0));
    }

    /// A coarser grid, whose rays still find all fins.
    #[test]
    fn the_number_of_chords_is_limited() {
        let evaluator = fins(100);
        let all = grid(&evaluator, 48, usize::MAX);
        assert!(all.across == 48 && all.chords.len() > 100 * 48 * 48, "{}", all.chords.len());
        let mut some = grid(&evaluator, 48, 50_000);
        assert!(some.across < 48 && some.chords.len() <= 50_000, "{} {}", some.across, some.chords.len());
        some.join_neighbours(false, &Cancel::new()).unwrap();
        some.join_by_lines(false, &Cancel::new()).unwrap();
        assert_eq!(
            some.pieces(false, MAX_PIECES).into_values().map(|sets| sets.len()).collect::<Vec<_>>(),
            [100]
        );
        // a grid of a few rays is not reduced further
        assert_eq!(grid(&evaluator, 48, 1).across, LEAST_ACROSS);
    }
}
