//! Intersection: the next hits of a generation, by the evaluators of the solids and of the sheets.

use super::generation::Generation;
use super::hits::{Hits, SheetCandidates, SheetHit};
use crate::bundle::PredictedHit;
use crate::element::Action;
use crate::system::System;
use rayweave_model::{Evaluator, Limit, Query, RayAnswer};

/// Computes hits with one evaluator for the solids and one for each sheet, and keeps their memory.
pub(super) struct HitFinder<'t, E: Evaluator> {
    system: &'t System,
    solids: &'t E,
    sheets: &'t [E],
    scratch: E::Scratch,
    sheet_scratch: Vec<E::Scratch>,
    candidates: SheetCandidates,
    hits: Hits,
}

impl<'t, E: Evaluator> HitFinder<'t, E> {
    pub fn new(system: &'t System, solids: &'t E, sheets: &'t [E]) -> Self {
        HitFinder {
            system,
            solids,
            sheets,
            scratch: solids.scratch(),
            sheet_scratch: sheets.iter().map(Evaluator::scratch).collect(),
            candidates: SheetCandidates::default(),
            hits: Hits::default(),
        }
    }

    /// The next hits of all rays.
    pub fn find(&mut self, rays: &Generation) -> &Hits {
        self.hits.reset(rays.len());
        let query = Query { starts: rays.start_lists(), ..Query::nearest() };
        let (mut columns, between) = self.hits.columns();
        self.solids.nearest_from(rays.rays.rays(), &query, &mut self.scratch, &mut columns, between);
        for sheet in 0..self.sheets.len() {
            self.find_on_sheet(rays, sheet);
        }
        self.hits.sort();
        &self.hits
    }

    fn find_on_sheet(&mut self, rays: &Generation, sheet: usize) {
        let bounds = &self.system.sheets[sheet].lane_bounds;
        self.candidates.gather(rays, &self.hits, sheet, bounds);
        let candidates = &self.candidates;
        let query = Query { limit: Limit::All, starts: candidates.start_lists(), ..Query::nearest() };
        let found = &mut self.hits.sheets;
        let mut take = |answer: RayAnswer<'_>| {
            let through = answer.crossings.iter().filter(|c| c.before.0 != 0 && c.after.0 != 0);
            let ray = candidates.numbers[answer.ray];
            found.extend(through.map(|&crossing| SheetHit { ray, sheet, crossing }));
        };
        let scratch = &mut self.sheet_scratch[sheet];
        self.sheets[sheet].crossings(candidates.rays.rays(), &query, scratch, &mut take);
    }

    /// The next hit of the first eight rays as a prediction for others, if it is the same for all.
    pub fn common_hit(&mut self, rays: &Generation) -> Option<PredictedHit> {
        let system = self.system;
        let hits = self.find(rays);
        if let Some((sheet, surface)) = hits.common_sheet(0) {
            let compiled = &system.sheets[sheet];
            let surface = compiled.predictor.as_ref()?.slot(surface)?;
            return (compiled.action == Action::Absorb).then_some(PredictedHit::Sheet { sheet, surface });
        }
        let surface = system.faces[hits.common_face(0)?].surface;
        let surface = system.predictor.as_ref()?.slot(surface)?;
        Some(PredictedHit::Face { surface })
    }
}
