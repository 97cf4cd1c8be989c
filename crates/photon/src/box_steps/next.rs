//! The next crossings of eight photons with the boxes of their cells.

use super::cell::{BOXES, CellRows, Listed};
use crate::rows::{Row, load, vector};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_model::BoxCells;
use rayweave_shape::lanes::{Lanes, Mask, splat};

/// The next crossings of eight photons.
pub(super) struct Next<S: Simd> {
    pub t: Lanes<S>,
    /// The time of the next crossing after it, or an earlier one, up to rounding.
    second: Lanes<S>,
    /// The place of the box in the list of the cell.
    pub place: Lanes<S>,
    pub axis: Lanes<S>,
    /// The translation into the frame of the box along this axis, and the offset of the face.
    shift: Lanes<S>,
    pub offset: Lanes<S>,
    /// The direction, and the position in the frame of the box, along the axis.
    pub speed: Lanes<S>,
    pub local: Lanes<S>,
    /// The photons that leave a box, and those at high faces.
    pub leaves: Mask<S>,
    pub is_high: Mask<S>,
    pub unsure: Mask<S>,
}

/// Eight photons on faces.
pub(super) struct OnFaces<'e> {
    pub position: &'e [Row; 3],
    pub direction: &'e [Row; 3],
    /// The places of the boxes in the lists of their cells, and the faces: the number of the axis, plus 3 for high faces.
    pub place: &'e Row,
    pub face: &'e Row,
    /// Bit mask of the lanes in use.
    pub active: u64,
}

/// The lines of flight of eight photons, by axes.
struct Lines<S: Simd> {
    origin: [Lanes<S>; 3],
    /// The absolute values of the directions, their inverses, and the axes along which they are positive.
    size: [Lanes<S>; 3],
    inverse: [Lanes<S>; 3],
    rises: [Mask<S>; 3],
    /// The least time between two crossings that are certainly separate.
    apart: Lanes<S>,
}

/// One of three numbers, by the number of an axis.
#[inline(always)]
pub(super) fn at_axis<S: Simd>(axis: Lanes<S>, [x, y, z]: [Lanes<S>; 3]) -> Lanes<S> {
    axis.simd_eq(0.0).select(x, axis.simd_eq(1.0).select(y, z))
}

impl Listed {
    /// The heights of the photons above the low faces and below the high ones, in the frames of the boxes, by axes.
    #[inline(always)]
    fn heights<S: Simd>(&self, simd: S, origin: [Lanes<S>; 3]) -> [[Lanes<S>; 2]; 3] {
        let mut heights = [[origin[0]; 2]; 3];
        for k in 0..3 {
            let local = origin[k] + load(simd, &self.shift[k]);
            heights[k] = [local + load(simd, &self.low[k]), load(simd, &self.high[k]) - local];
        }
        heights
    }

    /// Bit mask of the photons that [`CellRows::meet`] certainly has nothing to say about: the box is behind them, or they enter it
    /// after the time `t`. Most boxes are.
    #[inline(always)]
    fn out_of_reach<S: Simd>(
        &self,
        simd: S,
        &Lines { origin, size, rises, apart, .. }: &Lines<S>,
        near: Lanes<S>,
        t: Lanes<S>,
    ) -> u64 {
        let heights = self.heights(simd, origin);
        // twice the least time between crossings, and more than the rounding errors of quotients
        let until = (t.max(splat(simd, 0.0)) + apart * 2.0) * (1.0 + 1e-9);
        let mut out = Mask::splat(simd, false);
        for k in 0..3 {
            let [below, above] = heights[k];
            out |= rises[k].select(above, below).simd_lt(near * -2.0);
            out |= (-rises[k].select(below, above)).simd_gt(until * size[k]);
        }
        out.to_bitmask()
    }
}

impl CellRows {
    /// The first face that each photon crosses.
    ///
    /// The order of crossings is found by times up to rounding, from the inverses of the directions: only crossings that are much
    /// farther apart are certain.
    #[inline(always)]
    pub fn next<S: Simd>(&self, simd: S, photons: &OnFaces<'_>, margin: f64) -> Next<S> {
        let (position, direction) = (vector(simd, photons.position), vector(simd, photons.direction));
        let (origin, d) = ([position.x, position.y, position.z], [direction.x, direction.y, direction.z]);
        let size = [d[0].abs(), d[1].abs(), d[2].abs()];
        let one = splat(simd, 1.0);
        let inverse = [one / size[0], one / size[1], one / size[2]];
        let speed = size[0] + size[1] + size[2];
        let zero = splat(simd, 0.0);
        let rises = [d[0].simd_gt(zero), d[1].simd_gt(zero), d[2].simd_gt(zero)];
        let (near, apart) = (splat(simd, margin), splat(simd, margin) / speed);
        let (infinity, slow) = (splat(simd, f64::INFINITY), speed * BoxCells::SLOW);
        let (place, face) = (load(simd, photons.place), load(simd, photons.face));
        let starts_on_own = place.simd_eq(zero);
        let mut next = Next {
            t: infinity,
            second: infinity,
            place: zero,
            axis: zero,
            shift: zero,
            offset: zero,
            speed: zero,
            local: zero,
            leaves: starts_on_own,
            is_high: starts_on_own,
            unsure: Mask::splat(simd, false),
        };
        let own = &self.boxes[0];
        let heights = own.heights(simd, origin);
        for k in 0..3 {
            let [below, above] = heights[k];
            // well within the box, or on one of its faces and away from it
            let (is_above, is_below) = (below.simd_gt(near), above.simd_gt(near));
            let is_across = face.simd_eq(k as f64) | face.simd_eq(k as f64 + 3.0);
            let leaves = starts_on_own
                & is_across
                & (is_above | (rises[k] & below.simd_gt(-near)))
                & (is_below | (!rises[k] & above.simd_gt(-near)));
            next.unsure |= !((is_above & is_below) | leaves) | !size[k].simd_gt(slow);
            let t = rises[k].select(above, below) * inverse[k];
            let is_closer = t.simd_lt(next.t);
            next.second = is_closer.select(next.t, next.second.min(t));
            next.t = is_closer.select(t, next.t);
            next.axis = is_closer.select(splat(simd, k as f64), next.axis);
            let offset = rises[k].select(load(simd, &own.high[k]), load(simd, &own.low[k]));
            next.offset = is_closer.select(offset, next.offset);
            next.shift = is_closer.select(load(simd, &own.shift[k]), next.shift);
        }
        let lines = Lines { origin, size, inverse, rises, apart };
        for other in 1..BOXES {
            let met = self.present(other) & photons.active;
            if met == 0 {
                continue;
            }
            let met = met & !place.simd_eq(other as f64).to_bitmask();
            let met = met & !self.boxes[other].out_of_reach(simd, &lines, near, next.t);
            if met != 0 {
                self.meet(simd, other, met, &lines, &mut next);
            }
        }
        next.speed = at_axis(next.axis, d);
        next.local = at_axis(next.axis, origin) + next.shift;
        let rises = next.speed.simd_gt(zero);
        next.leaves = next.place.simd_eq(zero);
        next.is_high = !(next.leaves ^ rises);
        let height = next.is_high.select(next.offset - next.local, next.local + next.offset);
        next.t = next.leaves.select(height, -height) / next.speed.abs() + 0.0;
        next.unsure |= !next.second.simd_gt(next.t + apart);
        next
    }

    /// The entries of photons in a bit mask into the other boxes at a place.
    #[inline(always)]
    fn meet<S: Simd>(
        &self,
        simd: S,
        place: usize,
        met: u64,
        &Lines { origin, inverse, rises, apart, .. }: &Lines<S>,
        next: &mut Next<S>,
    ) {
        let other = &self.boxes[place];
        let heights = other.heights(simd, origin);
        let (infinity, zero) = (splat(simd, f64::INFINITY), splat(simd, 0.0));
        let (mut from, mut to, mut axis) = (-infinity, infinity, zero);
        let (mut shift, mut offset) = (zero, zero);
        for k in 0..3 {
            let [below, above] = heights[k];
            let enter = -(rises[k].select(below, above) * inverse[k]);
            to = to.min(rises[k].select(above, below) * inverse[k]);
            let is_later = enter.simd_gt(from);
            from = is_later.select(enter, from);
            axis = is_later.select(splat(simd, k as f64), axis);
            let face = rises[k].select(load(simd, &other.low[k]), load(simd, &other.high[k]));
            offset = is_later.select(face, offset);
            shift = is_later.select(load(simd, &other.shift[k]), shift);
        }
        // also those at an edge, up to rounding
        let passes = Mask::from_bitmask(simd, met) & from.simd_lt(to + apart) & !to.simd_lt(-apart);
        let is_ahead = from.simd_gt(apart);
        next.unsure |= passes & !is_ahead;
        let t = (passes & is_ahead).select(from, infinity);
        let is_closer = t.simd_lt(next.t);
        next.second = next.second.min(is_closer.select(next.t.min(to), t));
        next.unsure |= is_closer & Mask::from_bitmask(simd, self.lower(place));
        next.t = is_closer.select(t, next.t);
        next.place = is_closer.select(splat(simd, place as f64), next.place);
        next.axis = is_closer.select(axis, next.axis);
        next.offset = is_closer.select(offset, next.offset);
        next.shift = is_closer.select(shift, next.shift);
    }
}
