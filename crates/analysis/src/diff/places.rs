//! Connected places of differences.

use super::DifferencePlace;
use super::pairs::{A_ONLY, B_ONLY};
use crate::check::{ConnectedPart, connected_parts};
use crate::error::Cancelled;
use crate::measure::MeasuredChord;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::Evaluator;
use rayweave_model::drive::Cancel;

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

/// The connected places of differences within a box, the largest first, and the number of rays. `across` is the number of rays along each
/// side of the box, with the accepted thickness.
///
/// A grid of rays finds places and what connects them. Pieces of random rays show the places that lie between its rays; those near each
/// other are one place. The largest places are measured again with a grid of their own.
pub fn of<E: Evaluator>(
    evaluator: &E,
    place: Bounds,
    (across, distance): (usize, f64),
    scraps: &[Scrap],
    cancel: &Cancel,
) -> Result<(Vec<DifferencePlace>, u64), Cancelled> {
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
    for own in places.iter_mut().take(MAX_REFINED) {
        if (own.bounds.size() / frame.size()).min_element() < 0.5 {
            let bounds = Bounds { lo: own.bounds.lo - step, hi: own.bounds.hi + step };
            let (parts, rays) = connected_parts(evaluator, bounds, REFINED, is_selected, cancel)?;
            all_rays += rays;
            let is_own = |part: &&ConnectedPart| {
                (part.region == A_ONLY) == own.is_a && !part.bounds.intersection(&own.bounds).is_empty()
            };
            let parts = parts.unwrap_or_default();
            let best = parts.iter().filter(is_own).max_by(|a, b| a.volume.total_cmp(&b.volume));
            if let Some(best) = best {
                (own.volume, own.centre, own.bounds) = (best.volume, best.centre, best.bounds);
            }
        }
    }
    places.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    Ok((places, all_rays))
}
