//! Connected places of differences.

use super::DifferencePlace;
use super::pairs::{A_ONLY, B_ONLY};
use crate::AnalysisError;
use crate::check::{ConnectedPart, connected_parts};
use crate::measure::{MeasureSettings, MeasuredChord, measure};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::Evaluator;

/// A piece of a random ray in a difference, with the volume that it represents.
#[derive(Clone, Copy)]
pub struct Scrap {
    pub chord: MeasuredChord,
    pub volume: f64,
    pub is_a: bool,
}

/// The greatest number of pieces that are kept, and of places that are reported.
pub const MAX_SCRAPS: usize = 1 << 16;
const MAX_PLACES: usize = 1000;

/// The number of places that are measured again, each with a grid of this many rays along its sides.
const MAX_REFINED: usize = 50;
const REFINED: usize = 24;

/// The number of places whose volumes are measured, their precision, and the greatest number of rays for each of them.
const MAX_MEASURED: usize = 20;
const PRECISION: f64 = 2e-3;
const MAX_RAYS: u64 = 1 << 15;

/// The connected places of differences within a box, the largest first, and the number of rays. `across` is the number of rays along each
/// side of the box, with the accepted thickness.
///
/// A grid of rays finds places and what connects them. Pieces of random rays show the places that lie between its rays; those near each
/// other are one place. The largest places are measured again with a grid of their own, and their volumes with random rays: the rows of a
/// grid that end at a flat face give the same error for all places of one size. `measuring` are the options of these volumes.
pub fn of<E: Evaluator>(
    evaluator: &E,
    place: Bounds,
    (across, distance): (usize, f64),
    scraps: &[Scrap],
    measuring: &MeasureSettings,
) -> Result<(Vec<DifferencePlace>, u64), AnalysisError> {
    let cancel = &measuring.cancel;
    // a difference may be flat
    let margin = Vec3::splat(0.01 * place.size().max_element());
    let frame = Bounds { lo: place.lo - margin, hi: place.hi + margin };
    let is_selected = |region| region == A_ONLY || region == B_ONLY;
    let (parts, rays) = connected_parts(evaluator, frame, across, is_selected, cancel)?;
    let Some(parts) = parts else { return Ok((Vec::new(), rays)) };
    let mut places: Vec<DifferencePlace> = parts
        .iter()
        .filter(|part| part.longest > distance)
        .map(|part| {
            let (is_a, volume, centre) = (part.region == A_ONLY, part.volume, part.centre);
            DifferencePlace { is_a, volume, centre, bounds: part.bounds }
        })
        .collect();
    // the distance of rays in a grid whose outermost rays are outside
    let step = 2.0 * frame.size() / across as f64;
    let is_near = |own: &DifferencePlace, scrap: &Scrap| {
        let bounds = Bounds { lo: own.bounds.lo - step, hi: own.bounds.hi + step };
        own.is_a == scrap.is_a && [scrap.chord.from, scrap.chord.to].iter().all(|&end| bounds.contains(end))
    };
    let seen = places.len();
    for scrap in scraps {
        if places.len() > MAX_PLACES || places[..seen].iter().any(|own| is_near(own, scrap)) {
            continue;
        }
        let middle = 0.5 * (scrap.chord.from + scrap.chord.to);
        let bounds = Bounds::new(scrap.chord.from, scrap.chord.from)
            .union(&Bounds::new(scrap.chord.to, scrap.chord.to));
        match places[seen..].iter_mut().find(|own| is_near(own, scrap)) {
            Some(own) => {
                let volume = own.volume + scrap.volume;
                own.centre = (own.volume * own.centre + scrap.volume * middle) / volume;
                (own.volume, own.bounds) = (volume, own.bounds.union(&bounds));
            }
            None => places.push(DifferencePlace {
                is_a: scrap.is_a,
                volume: scrap.volume,
                centre: middle,
                bounds,
            }),
        }
    }
    places.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    places.truncate(MAX_PLACES);
    let mut all_rays = rays;
    let around = Around { evaluator, frame, parts: &parts, step, measuring };
    for (k, own) in places.iter_mut().take(MAX_REFINED).enumerate() {
        all_rays += around.refine(own, k < MAX_MEASURED)?;
    }
    places.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    Ok((places, all_rays))
}

/// The connected parts of differences by a grid of rays at a distance `step` in a frame.
struct Around<'a, E> {
    evaluator: &'a E,
    frame: Bounds,
    parts: &'a [ConnectedPart],
    step: Vec3,
    measuring: &'a MeasureSettings,
}

impl<E: Evaluator> Around<'_, E> {
    /// Measures a place with a grid of its own if it is small, and its volume with random rays if `is_measured`; returns the number of
    /// rays.
    fn refine(&self, own: &mut DifferencePlace, is_measured: bool) -> Result<u64, AnalysisError> {
        let region = if own.is_a { A_ONLY } else { B_ONLY };
        let is_small = (own.bounds.size() / self.frame.size()).min_element() < 0.5;
        let bounds = match is_small {
            true => Bounds { lo: own.bounds.lo - self.step, hi: own.bounds.hi + self.step },
            false => self.frame,
        };
        // the volumes of all parts of the region in the box, by the grid
        let volumes = |parts: &[ConnectedPart]| {
            parts.iter().filter(|part| part.region == region).map(|part| part.volume).sum::<f64>()
        };
        let (mut in_grid, mut rays) = (volumes(self.parts), 0);
        if is_small {
            let is_selected = |region| region == A_ONLY || region == B_ONLY;
            let (parts, traced) =
                connected_parts(self.evaluator, bounds, REFINED, is_selected, &self.measuring.cancel)?;
            rays += traced;
            let is_own = |part: &&ConnectedPart| {
                part.region == region && !part.bounds.intersection(&own.bounds).is_empty()
            };
            let parts = parts.unwrap_or_default();
            let best = parts.iter().filter(is_own).max_by(|a, b| a.volume.total_cmp(&b.volume));
            let Some(best) = best else { return Ok(rays) };
            (own.volume, own.centre, own.bounds) = (best.volume, best.centre, best.bounds);
            in_grid = volumes(&parts);
        }
        if is_measured {
            let settings = MeasureSettings {
                precision: PRECISION,
                most_rays: MAX_RAYS,
                within: Some(bounds),
                ..self.measuring.clone()
            };
            let measured = measure(self.evaluator, &settings, &mut |_| ())?;
            rays += measured.rays;
            let all = measured.regions[region.index() - 1].volume;
            // another part in the box takes its share
            if in_grid > 0.0 && all.half_width < 0.1 * all.value {
                own.volume *= all.value / in_grid;
            }
        }
        Ok(rays)
    }
}
