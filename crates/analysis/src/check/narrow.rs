//! The narrowest place of a wall or gap.

use crate::survey::{Across, Faces, Leaves, Piece, confirmed, narrowest};
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, RegionId};
use std::collections::BTreeMap;

/// Chords with an estimated width below this multiple of a limit for walls are candidates: a chord beside the narrowest place of a
/// wall, or slanted, may be wider than the limit.
pub(super) const SEARCHED: f64 = 2.0;

/// The number of chords kept for each side.
const PER_SIDE: usize = 4;

/// The number of sides kept for a wall or gap. The lists are shortened when they have reached twice this number.
const MAX_SIDES: usize = 256;

/// The largest number of steps towards the narrowest place. Each one reduces the distance from it by half or more, unless the curvature
/// of the faces changes over that distance.
const STEPS: usize = 128;

/// The usual number of rays that lead to the narrowest place of a side.
pub(super) const RAYS_PER_SIDE: u64 = 600;

/// The narrowest chords in a wall or gap. They are kept separately for each side of the body, so that thick walls with rays
/// across them do not displace thinner ones that all rays cross at a slant. The narrowest of all chords is always kept.
#[derive(Clone, Debug, Default)]
pub(super) struct Narrow(BTreeMap<Side, Vec<Candidate>>);

/// The faces that chords join, and the direction of the normals: the axis of its largest component, and the ratios of the others
/// to it, in units of 1/2.
type Side = (Option<Leaves>, [u32; 2], u8, [i8; 2]);

/// Faces with numbers from here on count as one: those of meshes and of solids with many sides.
pub(super) const MANY_FACETS: u32 = 16;

/// A chord of a region, with its width.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    width: f64,
    region: RegionId,
    across: Across,
}

impl Narrow {
    /// Adds a chord.
    pub fn add(&mut self, piece: &Piece<'_>) {
        let across = piece.across();
        let width = across.width(Faces::Wall);
        self.insert(side(&across), Candidate { width, region: piece.region(), across });
    }

    /// Adds the chords of later rays.
    pub fn append(&mut self, other: Narrow) {
        for (side, candidates) in other.0 {
            candidates.into_iter().for_each(|candidate| self.insert(side, candidate));
        }
    }

    /// Adds a candidate, unless a narrower one is beside it.
    fn insert(&mut self, side: Side, new: Candidate) {
        let kept = self.0.entry(side).or_default();
        let is_beside = |a: &Candidate, b: &Candidate| {
            (a.across.middle() - b.across.middle()).length() < 0.5 * a.width.max(b.width)
        };
        keep_smallest(kept, new, PER_SIDE, |candidate| candidate.width, is_beside);
        if self.0.len() > 2 * MAX_SIDES {
            self.shorten(MAX_SIDES);
        }
    }

    /// The widths of the narrowest chord of each side.
    pub fn widths(&self) -> impl Iterator<Item = f64> {
        self.0.values().map(|kept| kept[0].width)
    }

    /// Drops the sides with the widest chords beyond a number; of equal ones, the last.
    pub fn shorten(&mut self, most: usize) {
        let mut sides: Vec<(f64, Side)> = self.0.iter().map(|(side, kept)| (kept[0].width, *side)).collect();
        sides.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, side) in sides.iter().skip(most) {
            self.0.remove(side);
        }
    }

    /// The narrowest place of each side, the narrowest first: a chord of the region, perpendicular to the faces as far as they allow it.
    /// The first is at most as wide as each chord that was added, except for those that exist only because of rounding.
    /// Chords for which `is_edge` is true are left out: faces that meet at an edge have chords of any width, and a search would go all
    /// the way to the edge.
    pub fn measured_by_side<E: Evaluator>(
        &self,
        evaluator: &E,
        is_edge: &mut impl FnMut(&Across, &mut E::Scratch) -> bool,
        scratch: &mut E::Scratch,
    ) -> Vec<Across> {
        let mut all: Vec<Across> = Vec::new();
        for candidates in self.0.values() {
            let mut best: Option<(f64, RegionId, Across)> = None;
            // one step for each candidate, all steps for the best one
            for Candidate { region, across, .. } in candidates {
                let is_in = |other: RegionId| other == *region;
                let Some(across) = confirmed(evaluator, across, &is_in, scratch) else { continue };
                if is_edge(&across, scratch) {
                    continue;
                }
                let across = narrowest(evaluator, across, &is_in, 1, scratch);
                let width = across.width(Faces::Wall);
                if best.is_none_or(|(least, ..)| width < least) {
                    best = Some((width, *region, across));
                }
            }
            let Some((_, region, across)) = best else { continue };
            all.push(narrowest(evaluator, across, &|other| other == region, STEPS, scratch));
        }
        all.sort_by(|a, b| a.width(Faces::Wall).total_cmp(&b.width(Faces::Wall)));
        all
    }
}

/// Adds an item to a list of the smallest ones, in ascending order, of which none is beside another: of two that are, the smaller one is
/// kept, and of equal ones the first.
pub(super) fn keep_smallest<T>(
    kept: &mut Vec<T>,
    new: T,
    most: usize,
    size: impl Fn(&T) -> f64,
    is_beside: impl Fn(&T, &T) -> bool,
) {
    let at = kept.partition_point(|known| size(known) <= size(&new));
    if at == most || kept[..at].iter().any(|known| is_beside(known, &new)) {
        return;
    }
    let larger = kept.split_off(at);
    let apart: Vec<T> = larger.into_iter().filter(|known| !is_beside(known, &new)).collect();
    kept.push(new);
    kept.extend(apart);
    kept.truncate(most);
}

/// The side of a chord.
fn side(across: &Across) -> Side {
    let normal: Vec3 = across.normals[1] - across.normals[0];
    let [x, y, z] = normal.to_array();
    let (axis, by, others) = if x.abs() >= y.abs().max(z.abs()) {
        (0, x, [y, z])
    } else if y.abs() >= z.abs() {
        (1, y, [z, x])
    } else {
        (2, z, [x, y])
    };
    // the quotient has the same sign for both directions of the chord
    (across.leaves, facets_of(across), axis, others.map(|other| (2.0 * other / by).round() as i8))
}

/// The faces that a chord joins, those of meshes and of solids with many sides as one.
fn facets_of(across: &Across) -> [u32; 2] {
    across.facets.map(|facet| facet.min(MANY_FACETS))
}
