//! The hits of the rays of one generation, as columns, and the rays that may hit a sheet.

use super::generation::Generation;
use crate::bundle::{FaceCrossing, LaneBounds};
use crate::system::System;
use rayweave_model::{
    Crossing, Face, FirstHitColumns, FirstHits, PlacementId, RayBatch, RegionId, Start, StartLists, SurfaceId,
};
use rayweave_shape::Ray;
use rayweave_shape::lanes::LANES;

/// The crossing of a sheet by a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SheetHit {
    pub ray: usize,
    pub sheet: usize,
    pub crossing: Crossing,
}

/// The nearest hits of the rays of a generation with the solids, and the crossings of sheets before them.
#[derive(Debug, Default)]
pub(crate) struct Hits {
    /// The nearest hits with the solids.
    pub solids: FirstHitColumns,
    /// Crossings between two regions that belong to different faces on their two sides, by ray.
    pub between: Vec<(usize, Crossing)>,
    /// Crossings of sheets, by ray and time.
    pub sheets: Vec<SheetHit>,
}

impl Hits {
    /// Resizes the columns for a number of rays, and removes all crossings of sheets.
    pub fn reset(&mut self, count: usize) {
        self.solids.resize(count);
        self.between.clear();
        self.sheets.clear();
    }

    /// The sheet and its surface that rays `at..at + 8` hit first, if it is the same for all and no
    /// solid is before it.
    pub fn common_sheet(&self, at: usize) -> Option<(usize, SurfaceId)> {
        let mut left = &self.sheets[self.sheets.partition_point(|hit| hit.ray < at)..];
        let (sheet, surface) = left.first().map(|hit| (hit.sheet, hit.crossing.face.surface))?;
        for i in at..at + LANES {
            let first = left.first().filter(|hit| hit.ray == i && hit.crossing.t < self.solids.t[i])?;
            if (first.sheet, first.crossing.face.surface) != (sheet, surface) {
                return None;
            }
            left = &left[left.partition_point(|hit| hit.ray == i)..];
        }
        Some((sheet, surface))
    }

    /// The face that rays `at..at + 8` hit, if it is the same for all.
    pub fn common_face(&self, at: usize) -> Option<usize> {
        let face = self.solids.face[at];
        let is_same = self.solids.face[at..at + LANES].iter().all(|&other| other == face);
        usize::try_from(face).ok().filter(|_| is_same)
    }

    /// The columns for the evaluator to fill.
    pub fn columns(&mut self) -> (FirstHits<'_>, &mut Vec<(usize, Crossing)>) {
        (self.solids.hits(), &mut self.between)
    }

    /// Sorts the crossings by ray, and those of sheets by time as well.
    pub fn sort(&mut self) {
        self.between.sort_by_key(|(ray, _)| *ray);
        self.sheets.sort_by(|a, b| a.ray.cmp(&b.ray).then(a.crossing.t.total_cmp(&b.crossing.t)));
    }

    /// The crossing of a ray with the solids.
    pub fn crossing(&self, system: &System, i: usize) -> Option<Crossing> {
        let face = *system.faces.get(usize::try_from(self.solids.face[i]).ok()?)?;
        if let Some((_, crossing)) = self.between(i) {
            return Some(*crossing);
        }
        let face = Face { placement: PlacementId(self.solids.placement[i]), ..face };
        let [before, after] = [self.solids.before[i], self.solids.after[i]].map(RegionId);
        Some(Crossing { t: self.solids.t[i], face, left: face, entered: face, before, after })
    }

    /// The crossing of rays `at..at + 8`, if all of them cross the same face between the same
    /// regions, and it is both the face that is left and the face that is entered; `None`
    /// otherwise.
    pub fn common_crossing(&self, at: usize) -> Option<FaceCrossing> {
        let here = at..at + LANES;
        let (face, before, after) =
            (*self.solids.face.get(at)?, self.solids.before[at], self.solids.after[at]);
        let is_same = self.solids.face.get(here.clone())?.iter().all(|&other| other == face)
            && self.solids.before[here.clone()].iter().all(|&other| other == before)
            && self.solids.after[here.clone()].iter().all(|&other| other == after)
            && self.solids.placement[here].iter().all(|&other| other == 0);
        let between = || self.between_from(at).is_some_and(|(ray, _)| *ray < at + LANES);
        let face = usize::try_from(face).ok().filter(|_| is_same && !between())?;
        let (before, after) = (RegionId(before), RegionId(after));
        Some(FaceCrossing { face, left: face, entered: face, before, after })
    }

    pub fn between(&self, i: usize) -> Option<&(usize, Crossing)> {
        self.between_from(i).filter(|(ray, _)| *ray == i)
    }

    /// The first of these crossings on the rays `i..`, after sorting.
    fn between_from(&self, i: usize) -> Option<&(usize, Crossing)> {
        self.between.get(self.between.partition_point(|(ray, _)| *ray < i))
    }
}

/// The rays of a generation that may hit a sheet.
#[derive(Debug, Default)]
pub(crate) struct SheetCandidates {
    pub rays: RayBatch,
    /// Their numbers in the generation.
    pub numbers: Vec<usize>,
    first: Vec<u32>,
    starts: Vec<Start>,
}

impl SheetCandidates {
    fn clear(&mut self) {
        self.rays.clear();
        self.numbers.clear();
        self.first.clear();
        self.starts.clear();
        self.first.push(0);
    }

    fn push(&mut self, ray: Ray, number: usize, starts: impl IntoIterator<Item = Start>) {
        self.rays.push(ray);
        self.numbers.push(number);
        self.starts.extend(starts);
        self.first.push(self.starts.len() as u32);
    }

    /// Collects the rays whose segment up to the nearest hit may intersect the bounding box of a
    /// sheet.
    pub fn gather(&mut self, now: &Generation, hits: &Hits, sheet: usize, bounds: &LaneBounds) {
        self.clear();
        let rays = now.rays.rays();
        let mut starts = now.sheet_starts.iter().filter(|start| start.sheet == sheet).peekable();
        for at in (0..now.len()).step_by(LANES) {
            let eight = if at + LANES <= now.len() { bounds.may_hit(rays, at, &hits.solids.t) } else { None };
            if eight == Some(0) {
                continue;
            }
            let may_hit = |i: &usize| eight.is_none_or(|eight| eight >> (i - at) & 1 == 1);
            for i in (at..now.len().min(at + LANES)).filter(may_hit) {
                while starts.next_if(|start| start.ray < i).is_some() {}
                self.push(rays.get(i), i, starts.next_if(|start| start.ray == i).map(|start| start.start));
            }
        }
    }

    pub fn start_lists(&self) -> Option<StartLists<'_>> {
        let lists = StartLists { first: &self.first, entries: &self.starts };
        (!self.starts.is_empty()).then_some(lists)
    }
}
