//! Roots of eight straight lines with a torus: the operations of the scalar torus lines in [`surface`](crate::surface),
//! which document the method.

use super::vector::{Lanes, Mask, Vec3Lanes, splat};
use crate::surface::Torus;
use crate::surface::torus_line::{
    AXIS, CERTAIN, CUBE_LEAST, CUBE_MAGIC, CUBE_ONE, MARGIN, POLISH, TorusLine,
};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::{UNIT_ROUNDOFF, Vec3};

/// A torus about the origin, in units in which major + minor is about 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    /// Factor to these units.
    pub scale: f64,
    /// Unit vector along the axis.
    pub axis: Vec3,
    /// Radius of the centre circle.
    pub major: f64,
    /// Radius of the tube.
    pub minor: f64,
}

impl Ring {
    /// A torus in these units, about the origin.
    pub fn of(torus: &Torus) -> Ring {
        let scale = TorusLine::scale(torus);
        Ring { scale, axis: torus.axis, major: scale * torus.major, minor: scale * torus.minor }
    }
}

/// Eight lines, parameterised by arc length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines<'r, S: Simd> {
    ring: &'r Ring,
    across: Vec3Lanes<S>,
    along: Vec3Lanes<S>,
    z: Lanes<S>,
    rise: Lanes<S>,
    alpha: Lanes<S>,
    beta: Lanes<S>,
    twist_squared: Lanes<S>,
}

/// A point of each line, with g and its derivatives there: half of the slope, `major twist^2 / rho^3`, and `1 / rho`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet<S: Simd> {
    pub s: Lanes<S>,
    pub value: Lanes<S>,
    pub slope: Lanes<S>,
    pub turn: Lanes<S>,
    pub inverse: Lanes<S>,
}

/// Roots of the lines: first entry, first exit, second entry, last exit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roots<S: Simd> {
    /// Lines that pass through the torus.
    pub some: Mask<S>,
    /// Lines that pass through it twice.
    pub two: Mask<S>,
    /// First and last root.
    pub ends: [Root<S>; 2],
    /// The two roots in between, if any line has them.
    pub gap: Option<[Root<S>; 2]>,
    /// Uncertain lines, which fall back to the scalar kernel.
    pub unsure: Mask<S>,
}

/// A root of each line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root<S: Simd> {
    /// Position of the root.
    pub s: Lanes<S>,
    /// Half of the slope of g and 1 / rho at the last evaluation, and the distance of that from the root.
    pub slope: Lanes<S>,
    pub inverse: Lanes<S>,
    pub step: Lanes<S>,
}

/// Two points that bracket a root.
#[derive(Clone, Copy, Debug)]
struct Bracket<S: Simd> {
    lo: Jet<S>,
    hi: Jet<S>,
    /// Start at the first point, or at the second; otherwise at the one with smaller |g|.
    at_lo: Mask<S>,
    at_hi: Mask<S>,
}

/// A root search on each line.
#[derive(Clone, Copy, Debug)]
struct Search<S: Simd> {
    lo: Lanes<S>,
    hi: Lanes<S>,
    /// Point of the last evaluation.
    jet: Jet<S>,
    root: Root<S>,
    /// Lines without a result yet.
    active: Mask<S>,
    /// True for roots where lines enter.
    enters: bool,
}

/// Ends of the three pieces, and points of the other sign between some of them.
struct Points<S: Simd> {
    ends: [Jet<S>; 4],
    /// A point inside between two outside ends of the first piece, or else a point outside between two inside ends of the
    /// second.
    middle: Jet<S>,
    dips: Mask<S>,
    bumps: Mask<S>,
    /// A point inside the third piece.
    last: Jet<S>,
    dips_last: Mask<S>,
    /// True if g < 0 at each inflection.
    below: [Mask<S>; 2],
}

/// The largest number of steps of a search; longer ones are left to the scalar kernel.
const STEPS: usize = 24;

/// Margin of the hole, relative to its size.
const ROOM: f64 = 1e-3;

impl<S: Simd> Jet<S> {
    #[inline(always)]
    fn curvature(&self) -> Lanes<S> {
        1.0 - self.turn
    }

    #[inline(always)]
    fn is_below(&self) -> Mask<S> {
        self.value.simd_lt(0.0)
    }
}

#[inline(always)]
fn pick<S: Simd>(mask: Mask<S>, a: &Jet<S>, b: &Jet<S>) -> Jet<S> {
    Jet {
        s: mask.select(a.s, b.s),
        value: mask.select(a.value, b.value),
        slope: mask.select(a.slope, b.slope),
        turn: mask.select(a.turn, b.turn),
        inverse: mask.select(a.inverse, b.inverse),
    }
}

/// `s` if it is strictly between the bounds, else the midpoint.
#[inline(always)]
fn within<S: Simd>(lo: Lanes<S>, hi: Lanes<S>, s: Lanes<S>) -> Lanes<S> {
    (lo.simd_lt(s) & s.simd_lt(hi)).select(s, lo * 0.5 + hi * 0.5)
}

/// Root of the local parabola nearest to 0; NaN if there is none.
#[inline(always)]
fn parabola_step<S: Simd>(jet: &Jet<S>) -> Lanes<S> {
    let discriminant = jet.slope * jet.slope - jet.curvature() * jet.value;
    -jet.value / (jet.slope + discriminant.sqrt().copysign(jet.slope))
}

/// Lane version of the scalar cube root.
#[inline(always)]
fn cube_root<S: Simd>(simd: S, x: Lanes<S>) -> Lanes<S> {
    let high = Lanes::from_bits((x.to_bits() >> 32) | CUBE_ONE.to_bits()) - CUBE_ONE;
    let guess = (CUBE_MAGIC - high * (1.0 / 3.0)) + CUBE_ONE;
    let mut y: Lanes<S> = Lanes::from_bits(guess.to_bits() << 32);
    for _ in 0..2 {
        let rest = 1.0 - x * (y * y * y);
        y += y * rest * (1.0 / 3.0 + rest * (2.0 / 9.0 + rest * (14.0 / 81.0)));
    }
    let zero = splat(simd, 0.0);
    x.simd_lt(CUBE_LEAST).select(zero, x * (y * y))
}

impl<'r, S: Simd> Lines<'r, S> {
    /// The lines through the points q (relative to the torus's centre) along the directions d, which have the given
    /// lengths, and the factors from times to arc lengths.
    #[inline(always)]
    pub fn new(ring: &'r Ring, q: Vec3Lanes<S>, d: Vec3Lanes<S>, length: Lanes<S>) -> (Self, Lanes<S>) {
        let q = Vec3Lanes { x: q.x * ring.scale, y: q.y * ring.scale, z: q.z * ring.scale };
        let d = d.times(1.0 / length);
        let (z, rise) = (q.dot_all(ring.axis), d.dot_all(ring.axis));
        let (across, along) = (q.without(z, ring.axis), d.without(rise, ring.axis));
        let twist = across.cross(along).dot_all(ring.axis);
        let (alpha, beta) = (along.length_squared(), across.dot(along));
        let lines = Lines { ring, across, along, z, rise, alpha, beta, twist_squared: twist * twist };
        (lines, length * ring.scale)
    }

    #[inline(always)]
    fn jet(&self, simd: S, s: Lanes<S>) -> Jet<S> {
        let Ring { major, minor, .. } = *self.ring;
        let p = self.across.plus(self.along.times(s));
        let z = self.z + s * self.rise;
        let rho = p.length_squared().sqrt();
        let (ring, inverse) = (rho - major, 1.0 / rho);
        let outwards = rho.simd_gt(AXIS).select(p.dot(self.along) * inverse, splat(simd, f64::NAN));
        Jet {
            s,
            value: ring * ring + (z * z - minor * minor),
            slope: ring * outwards + z * self.rise,
            turn: self.twist_squared * major * (inverse * inverse * inverse),
            inverse,
        }
    }

    /// Bounds of the lines within the ball and the slab that contain the torus, and a mask of the lines that have any.
    #[inline(always)]
    fn window(&self, simd: S) -> ([Lanes<S>; 2], Mask<S>) {
        let outer = (self.ring.major + self.ring.minor) * (1.0 + MARGIN);
        let middle = -(self.beta + self.z * self.rise);
        let height = self.z + middle * self.rise;
        let nearest = self.across.plus(self.along.times(middle)).length_squared() + height * height;
        let square = splat(simd, outer * outer) - nearest;
        let half = square.sqrt();
        let thick = self.ring.minor + MARGIN * outer;
        let (a, b) = ((-thick - self.z) / self.rise, (thick - self.z) / self.rise);
        let (first, last) = (middle - half, middle + half);
        let flat = self.rise.simd_eq(0.0);
        let from = flat.select(first, a.min(b).max(first));
        let to = flat.select(last, a.max(b).min(last));
        let level = !flat | self.z.abs().simd_lt(thick);
        ([from, to], square.simd_gt(0.0) & level & from.simd_lt(to))
    }

    /// The two inflections; +inf if there are none.
    #[inline(always)]
    fn inflections(&self, simd: S) -> [Lanes<S>; 2] {
        let (rho, inverse) = (cube_root(simd, self.twist_squared * self.ring.major), 1.0 / self.alpha);
        let square = (rho * rho - self.twist_squared * inverse) * inverse;
        let closest = -self.beta * inverse;
        let half = square.sqrt();
        let infinity = splat(simd, f64::INFINITY);
        let some = square.simd_ge(0.0) & half.simd_lt(infinity) & !self.alpha.simd_eq(0.0);
        [some.select(closest - half, infinity), some.select(closest + half, infinity)]
    }

    /// Sign changes of g on the lines of a mask.
    #[inline(always)]
    pub fn roots(&self, simd: S, queried: Mask<S>) -> Option<Roots<S>> {
        let ([from, to], some) = self.window(simd);
        let queried = queried & some;
        if !queried.any_true() {
            return None;
        }
        let (first, last) = (self.jet(simd, from), self.jet(simd, to));
        // rho is convex, so its maximum is at an end
        let hole = (self.ring.major - self.ring.minor) * (1.0 - ROOM);
        let queried = queried & !(first.inverse.min(last.inverse) * hole).simd_gt(1.0);
        if !queried.any_true() {
            return None;
        }
        let mut unsure = queried & (first.is_below() | last.is_below());
        let points = self.points(simd, queried, [first, last], &mut unsure);
        points.any(queried).then(|| points.roots(self, simd, queried, unsure))
    }

    /// Points of both signs.
    #[inline(always)]
    fn points(
        &self,
        simd: S,
        queried: Mask<S>,
        [first, last]: [Jet<S>; 2],
        unsure: &mut Mask<S>,
    ) -> Points<S> {
        let [a, b] = self.inflections(simd);
        let one = self.jet(simd, a.max(first.s).min(last.s));
        let two = self.jet(simd, b.max(first.s).min(last.s));
        let below = [one.is_below(), two.is_below()];
        let may_dip = queried & !below[0] & first.s.simd_lt(one.s);
        let may_bump = queried & below[0] & below[1] & one.s.simd_lt(two.s);
        let may_dip_last = queried & !below[1] & two.s.simd_lt(last.s);
        let (left, right) = (pick(may_bump, &one, &first), pick(may_bump, &two, &one));
        let ones = splat(simd, 1.0);
        let up = may_bump.select(-ones, ones);
        let (middle, found) = self.other_side(simd, may_dip | may_bump, up, [&left, &right], unsure);
        let (last_dip, found_last) = self.other_side(simd, may_dip_last, ones, [&two, &last], unsure);
        Points {
            ends: [first, one, two, last],
            middle,
            dips: found & may_dip,
            bumps: found & may_bump,
            last: last_dip,
            dips_last: found_last,
            below,
        }
    }

    /// Points of the opposite sign between two ends that both have the sign of the curvature, `up`.
    #[inline(always)]
    fn other_side(
        &self,
        simd: S,
        queried: Mask<S>,
        up: Lanes<S>,
        [from, to]: [&Jet<S>; 2],
        unsure: &mut Mask<S>,
    ) -> (Jet<S>, Mask<S>) {
        let mut found = Mask::splat(simd, false);
        let mut place = *from;
        let away = (up * from.slope).simd_ge(0.0) | (up * to.slope).simd_le(0.0);
        let mut active = queried & !away;
        if !active.any_true() {
            return (place, found);
        }
        let (mut lo, mut hi) = (from.s, to.s);
        let mut s = within(lo, hi, lo - from.slope * (hi - lo) / (to.slope - from.slope));
        let convex = up.simd_gt(0.0);
        for _ in 0..STEPS {
            let jet = self.jet(simd, s);
            let other = active & !(jet.is_below() ^ convex);
            place = pick(other, &jet, &place);
            found |= other;
            let slope = up * jet.slope;
            let is_nan = !jet.slope.simd_eq(jet.slope);
            let rising = slope.simd_gt(0.0) | (is_nan & (hi - s).simd_lt(s - lo));
            (lo, hi) = (rising.select(lo, s), rising.select(s, hi));
            let room = rising.select(s - lo, hi - s);
            let out_of_reach = (up * jet.value).simd_gt(jet.slope.abs() * 2.0 * room);
            let next = within(lo, hi, s - jet.slope / jet.curvature());
            let stuck = (next - s).abs().simd_le((s.abs() + 1.0) * UNIT_ROUNDOFF);
            active &= !(other | out_of_reach | stuck);
            if !active.any_true() {
                break;
            }
            s = next;
        }
        *unsure |= active;
        (place, found)
    }

    /// Two root searches per line, interleaved to hide latency.
    #[inline(always)]
    fn search(&self, simd: S, [mut one, mut two]: [Search<S>; 2], unsure: &mut Mask<S>) -> [Root<S>; 2] {
        for _ in 0..STEPS {
            let next = [one.step(self.ring.minor), two.step(self.ring.minor)];
            if !(one.active | two.active).any_true() {
                break;
            }
            (one.jet, two.jet) = (self.jet(simd, next[0]), self.jet(simd, next[1]));
        }
        *unsure |= one.active | two.active;
        [one.root, two.root]
    }
}

impl<S: Simd> Search<S> {
    #[inline(always)]
    fn new(simd: S, active: Mask<S>, bracket: &Bracket<S>, enters: bool) -> Self {
        let jet = bracket.start();
        let root = Root { s: jet.s, slope: jet.slope, inverse: jet.inverse, step: splat(simd, 0.0) };
        Search { lo: bracket.lo.s, hi: bracket.hi.s, jet, root, active, enters }
    }

    /// Stores the roots of finished lines, and returns the next positions of the others.
    #[inline(always)]
    fn step(&mut self, minor: f64) -> Lanes<S> {
        let jet = &self.jet;
        let s = jet.s;
        let before = if self.enters { !jet.is_below() } else { jet.is_below() };
        (self.lo, self.hi) = (before.select(s, self.lo), before.select(self.hi, s));
        let step = parabola_step(jet);
        let near = s + step;
        let between = self.lo.simd_lt(near) & near.simd_lt(self.hi);
        let certain = between & is_certain(jet, step, minor);
        let moved = (near - s).abs();
        let is_noise = jet.value.abs().simd_le(UNIT_ROUNDOFF * minor);
        let is_opposite = if self.enters { jet.slope.simd_gt(0.0) } else { jet.slope.simd_lt(0.0) };
        let recedes =
            is_opposite & (jet.slope * jet.slope).simd_gt(jet.curvature().abs() * (UNIT_ROUNDOFF * minor));
        let settled = (is_noise | moved.simd_le(s.abs() * UNIT_ROUNDOFF)) & !recedes;
        let next = between.select(near, self.lo * 0.5 + self.hi * 0.5);
        let done = self.active & (certain | settled | next.simd_eq(s));
        let takes = certain | (settled & between & moved.simd_le(POLISH));
        let at = takes.select(near, s);
        self.root.s = done.select(at, self.root.s);
        self.root.step = done.select((at - s).abs(), self.root.step);
        self.root.slope = done.select(jet.slope, self.root.slope);
        self.root.inverse = done.select(jet.inverse, self.root.inverse);
        self.active &= !done;
        next
    }
}

/// True if the root of the parabola equals the root of g up to noise.
#[inline(always)]
fn is_certain<S: Simd>(jet: &Jet<S>, step: Lanes<S>, minor: f64) -> Mask<S> {
    let step = step.abs();
    let error = (jet.turn * jet.inverse) * 2.0 * (step * step * step);
    jet.value.abs().simd_le(minor * minor)
        & (step * 8.0 * jet.inverse).simd_le(1.0)
        & error.simd_le(CERTAIN * UNIT_ROUNDOFF * minor)
}

impl<S: Simd> Bracket<S> {
    /// Start of the search.
    #[inline(always)]
    fn start(&self) -> Jet<S> {
        let nearer = self.lo.value.abs().simd_lt(self.hi.value.abs());
        pick(self.at_lo | (nearer & !self.at_hi), &self.lo, &self.hi)
    }
}

impl<S: Simd> Points<S> {
    /// True if any line passes through the torus.
    #[inline(always)]
    fn any(&self, queried: Mask<S>) -> bool {
        (queried & (self.below[0] | self.below[1] | self.dips | self.dips_last)).any_true()
    }

    #[inline(always)]
    fn roots(&self, lines: &Lines<'_, S>, simd: S, queried: Mask<S>, mut unsure: Mask<S>) -> Roots<S> {
        let ([one, two], never) = (self.below, Mask::splat(simd, false));
        let some = queried & (one | two | self.dips | self.dips_last);
        let twice = (self.dips & (two | self.dips_last)) | self.bumps | (one & self.dips_last);
        let twice = some & twice;
        let first = Search::new(simd, some, &self.first(never), true);
        let last = Search::new(simd, some, &self.last(never), false);
        let ends = lines.search(simd, [first, last], &mut unsure);
        let mut gap = None;
        if twice.any_true() {
            let leaves = Search::new(simd, twice, &self.leaves(), false);
            let enters = Search::new(simd, twice, &self.enters_again(), true);
            gap = Some(lines.search(simd, [leaves, enters], &mut unsure));
        }
        Roots { some, two: twice, ends, gap, unsure }
    }

    /// Bracket of the first entry: the first point inside, and its predecessor.
    #[inline(always)]
    fn first(&self, never: Mask<S>) -> Bracket<S> {
        let ([a, b, c, _], [one, two]) = (&self.ends, self.below);
        let early = self.dips | one;
        let lo = pick(early, a, &pick(two, b, c));
        let hi = pick(self.dips, &self.middle, &pick(one, b, &pick(two, c, &self.last)));
        Bracket { lo, hi, at_lo: never, at_hi: self.dips | !(one | two) }
    }

    /// Bracket of the last exit: the last point inside, and its successor.
    #[inline(always)]
    fn last(&self, never: Mask<S>) -> Bracket<S> {
        let ([_, b, c, d], [one, two]) = (&self.ends, self.below);
        let late = self.dips_last | two;
        let lo = pick(self.dips_last, &self.last, &pick(two, c, &pick(one, b, &self.middle)));
        let hi = pick(late, d, &pick(one, c, b));
        Bracket { lo, hi, at_lo: self.dips_last | !(one | two), at_hi: never }
    }

    /// Bracket of the first of two exits.
    #[inline(always)]
    fn leaves(&self) -> Bracket<S> {
        let [_, b, c, _] = &self.ends;
        let lo = pick(self.dips, &self.middle, b);
        let hi = pick(self.dips, b, &pick(self.bumps, &self.middle, c));
        Bracket { lo, hi, at_lo: self.dips, at_hi: self.bumps }
    }

    /// Bracket of the second of two entries.
    #[inline(always)]
    fn enters_again(&self) -> Bracket<S> {
        let [_, b, c, _] = &self.ends;
        let lo = pick(self.bumps, &self.middle, &pick(self.dips_last, c, b));
        let hi = pick(self.dips_last, &self.last, c);
        Bracket { lo, hi, at_lo: self.bumps, at_hi: self.dips_last }
    }
}
