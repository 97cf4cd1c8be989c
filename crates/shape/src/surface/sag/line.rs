//! Sag surface along a straight line: crossings within the aperture, before it and after it.

use super::Sag;
use super::isolate::{End, Smooth, root, sign_changes, sign_changes_after};
use super::profile::Along;
use crate::surface::object::Departing;
use rayweave_math::{Interval, UNIT_ROUNDOFF, Vec3};

/// `f(q + t d) - offset`.
pub(super) struct Line<'a> {
    sag: &'a Sag,
    q: Vec3,
    d: Vec3,
    /// Correction of f so that it is 0 at a start on the surface.
    offset: f64,
}

/// The interval of a line in which roots of f are isolated: in the aperture, between the lowest and the highest sag.
type Part = Option<(f64, f64)>;

impl<'a> Line<'a> {
    pub fn new(sag: &'a Sag, q: Vec3, d: Vec3, offset: f64) -> Line<'a> {
        Line { sag, q, d, offset }
    }

    /// All sign changes; true if f is negative at -inf.
    pub fn crossings(&self, emit: &mut dyn FnMut(f64)) -> bool {
        let first = self.is_negative_far(-1.0);
        let last = self.is_negative_far(1.0);
        let Some((a, b)) = self.part() else {
            self.beyond(first, last, (f64::NEG_INFINITY, f64::INFINITY), emit);
            return first;
        };
        let within = self.within();
        let from = End::of(&within, a).beside(first, &within);
        let to = End::of(&within, b).beside(last, &within);
        self.beyond(first, from.negative, (f64::NEG_INFINITY, a), emit);
        within.sign_changes(from, to, emit);
        self.beyond(to.negative, last, (b, f64::INFINITY), emit);
        first
    }

    /// Emits the sign changes for t >= 0 of a line that starts on the surface.
    pub fn crossings_from(&self, start: &Departing<'_>, emit: &mut dyn FnMut(f64)) {
        let (_, slope) = self.at(0.0);
        let part = self.part().filter(|(_, b)| *b > 0.0);
        let is_inside_after = match slope {
            0.0 => self.bends_inside(part).unwrap_or_else(|| (start.led_inside)()),
            slope => slope < 0.0,
        };
        if is_inside_after != start.inside_after {
            emit(0.0);
        }
        let emit = &mut |t: f64| emit(self.on_the_surface(t));
        let last = self.is_negative_far(1.0);
        let Some((a, b)) = part else {
            return self.beyond(is_inside_after, last, (0.0, f64::INFINITY), emit);
        };
        let within = self.within().bounded((a.max(0.0), b));
        let to = End::of(&within, b).beside(last, &within);
        let ends_negative = if a <= 0.0 {
            let from = End { t: 0.0, value: 0.0, slope, negative: is_inside_after };
            sign_changes_after(&within, from, to, emit)
        } else {
            let from = End::of(&within, a).beside(is_inside_after, &within);
            self.beyond(is_inside_after, from.negative, (0.0, a), emit);
            within.sign_changes(from, to, emit);
            to.negative
        };
        self.beyond(ends_negative, last, (b, f64::INFINITY), emit);
    }

    /// True if f becomes negative just after a start with slope 0; `None` if that is undecided.
    fn bends_inside(&self, part: Part) -> Option<bool> {
        let (a, b) = part.filter(|(a, _)| *a <= 0.0)?;
        let bend = self.within().bounded((a, b)).bend(0.0, 0.0);
        match bend.contains_zero() {
            true => None,
            false => Some(bend.hi < 0.0),
        }
    }

    /// Corrects a root of f - offset to a root of f by one Newton step. A large step is rejected, since it could lead back
    /// to the root at the start.
    fn on_the_surface(&self, t: f64) -> f64 {
        let step = self.offset / self.at(t).1;
        if step.abs() <= 1e-6 * t { t - step } else { t }
    }

    fn within(&self) -> Within<'_> {
        let Line { q, d, .. } = *self;
        Within { line: self, along: Along::new(&self.sag.profile, [q.x, d.x], [q.y, d.y]) }
    }

    /// True if f is negative as t goes to +inf (`way` = 1) or to -inf (`way` = -1).
    fn is_negative_far(&self, way: f64) -> bool {
        let Line { q, d, .. } = *self;
        if d.z != 0.0 {
            return d.z * way < 0.0;
        }
        let rim = self.sag.rim.unwrap_or_else(|| {
            let far = self.sag.aperture() / (d.x * d.x + d.y * d.y).sqrt();
            self.sag.profile.value_and_gradient(way * far * d.x, way * far * d.y)[0]
        });
        q.z - rim - self.offset < 0.0
    }

    fn part(&self) -> Part {
        let Line { q, d, .. } = *self;
        let radius = self.sag.aperture();
        let across = d.x * d.x + d.y * d.y;
        let closest = -(q.x * d.x + q.y * d.y) / across;
        let (x, y) = (q.x + closest * d.x, q.y + closest * d.y);
        let is_along_z = !(across > 0.0 && closest.is_finite());
        let distance = if is_along_z { q.x * q.x + q.y * q.y } else { x * x + y * y };
        if distance >= radius * radius {
            return None;
        }
        let half = ((radius * radius - distance) / across).sqrt();
        let all = (f64::NEG_INFINITY, f64::INFINITY);
        let (from, to) = if is_along_z { all } else { (closest - half, closest + half) };
        let (low, high) = self.times_between_extremes();
        let (from, to) = (from.max(low), to.min(high));
        (from < to && from.is_finite() && to.is_finite()).then_some((from, to))
    }

    /// The interval in which the line is between the lowest and the highest sag.
    fn times_between_extremes(&self) -> (f64, f64) {
        let (z, rate) = (self.q.z - self.offset, self.d.z);
        if rate == 0.0 {
            let is_between = self.sag.low <= z && z <= self.sag.high;
            return if is_between { (f64::NEG_INFINITY, f64::INFINITY) } else { (0.0, 0.0) };
        }
        let (low, high) = ((self.sag.low - z) / rate, (self.sag.high - z) / rate);
        (low.min(high), low.max(high))
    }

    /// Emits the sign change in an interval beyond the aperture, if the signs at its ends differ.
    fn beyond(&self, first: bool, last: bool, (from, to): (f64, f64), emit: &mut dyn FnMut(f64)) {
        if first == last {
            return;
        }
        let t = match self.sag.rim {
            Some(rim) => (rim + self.offset - self.q.z) / self.d.z,
            None => self.search(first, (from, to)),
        };
        let t = if t.is_nan() { if from.is_finite() { from } else { to } } else { t.clamp(from, to) };
        emit(t);
    }

    /// The sign change for a rim that is not level.
    fn search(&self, first: bool, (from, to): (f64, f64)) -> f64 {
        let (low, high) = self.times_between_extremes();
        let (mut a, mut b) = (from.max(low), to.min(high));
        let is_first = |t: f64| (self.at(t).0 < 0.0) == first;
        if !a.is_finite() && !b.is_finite() {
            (a, b) = if is_first(0.0) { (0.0, b) } else { (a, 0.0) };
        }
        let mut step = self.sag.aperture() / self.d.length();
        // along a level line f depends only on the direction from the axis, which hardly changes far out
        for _ in 0..128 {
            if a.is_finite() && b.is_finite() {
                let ends = [(a, first), (b, !first)];
                let [from, to] = ends.map(|(t, negative)| End { negative, ..End::of(self, t) });
                return root(self, from, to);
            }
            let next = if a.is_finite() { a + step } else { b - step };
            if is_first(next) {
                a = next
            } else {
                b = next
            }
            step *= 2.0;
        }
        if a.is_finite() { a } else { b }
    }
}

impl Smooth for Line<'_> {
    fn at(&self, t: f64) -> (f64, f64) {
        let p = self.q + t * self.d;
        let [sag, by_x, by_y] = self.sag.sag(p.x, p.y);
        (p.z - self.offset - sag, self.d.z - (by_x * self.d.x + by_y * self.d.y))
    }

    fn bend(&self, _: f64, _: f64) -> Interval {
        Interval::ALL
    }

    fn slopes(&self, _: f64, _: f64) -> Interval {
        Interval::ALL
    }

    fn is_upright(&self, _: f64, _: f64) -> bool {
        false
    }

    fn noise(&self) -> f64 {
        self.sag.noise
    }
}

/// The part of a line in the aperture.
struct Within<'a> {
    line: &'a Line<'a>,
    along: Along<'a>,
}

impl Within<'_> {
    fn bounded(self, part: (f64, f64)) -> Self {
        Within { along: self.along.bounded(part), ..self }
    }

    fn sign_changes(self, from: End, to: End, emit: &mut dyn FnMut(f64)) {
        let Line { sag, d, .. } = self.line;
        // fast path: nearly every ray is steeper than the surface, and crosses it once
        let across = (d.x * d.x + d.y * d.y).sqrt();
        if d.z.abs() > sag.steepest * across * (1.0 + 8.0 * UNIT_ROUNDOFF) {
            if from.negative != to.negative {
                emit(root(&self, from, to));
            }
            return;
        }
        sign_changes(&self.bounded((from.t, to.t)), from, to, emit);
    }
}

impl Smooth for Within<'_> {
    #[inline]
    fn at(&self, t: f64) -> (f64, f64) {
        let (sag, slope) = self.along.at(t);
        let Line { q, d, offset, .. } = *self.line;
        (q.z + t * d.z - offset - sag, d.z - slope)
    }

    fn bend(&self, from: f64, to: f64) -> Interval {
        -self.along.bend(from, to)
    }

    fn slopes(&self, from: f64, to: f64) -> Interval {
        Interval::point(self.line.d.z) - self.along.slopes(from, to)
    }

    fn is_upright(&self, from: f64, to: f64) -> bool {
        let (Line { sag, d, .. }, time) = (self.line, to - from);
        let (x, y) = (d.x * time, d.y * time);
        x.abs().max(y.abs()) <= 2.0 * UNIT_ROUNDOFF * sag.aperture()
    }

    fn noise(&self) -> f64 {
        self.line.sag.noise
    }
}

#[cfg(test)]
mod tests {
    use super::super::isolate::PIECES;
    use super::super::{Base, Description};
    use super::*;
    use std::cell::Cell;

    /// Counts evaluations of bounds.
    struct Counted<'a>(Within<'a>, Cell<u32>);

    impl Smooth for Counted<'_> {
        fn at(&self, t: f64) -> (f64, f64) {
            self.0.at(t)
        }

        fn bend(&self, from: f64, to: f64) -> Interval {
            self.1.set(self.1.get() + 1);
            self.0.bend(from, to)
        }

        fn slopes(&self, from: f64, to: f64) -> Interval {
            self.0.slopes(from, to)
        }

        fn is_upright(&self, from: f64, to: f64) -> bool {
            self.0.is_upright(from, to)
        }

        fn noise(&self) -> f64 {
            self.0.noise()
        }
    }

    /// Number of pieces along a line.
    fn pieces(sag: &Sag, q: Vec3, d: Vec3) -> u32 {
        let line = Line::new(sag, q, d, 0.0);
        let Some((a, b)) = line.part() else { return 0 };
        let counted = Counted(line.within().bounded((a, b)), Cell::new(0));
        sign_changes(&counted, End::of(&counted, a), End::of(&counted, b), &mut |_| {});
        counted.1.get()
    }

    fn hostile() -> Vec<Sag> {
        let base = |k: f64| Description::new(1.0, Base::Conic { curvature: 1.0, conic: k });
        let biconic =
            |c: [f64; 2]| Description::new(1.0, Base::Biconic { curvatures: c, conics: [0.0, 0.3] });
        let waves = |n: u32| (4.0 * f64::from(n)).sin();
        let list = [
            Description { odd: vec![0.3], ..base(0.0) },
            Description { odd: vec![-0.9, 2.0, -1.0], even: vec![0.0, -3.0, 5.0], ..base(0.0) },
            Description {
                odd: (0..12).map(waves).collect(),
                even: (0..12).map(waves).collect(),
                ..base(0.0)
            },
            Description {
                odd: vec![-0.5],
                ..Description::new(1.0, Base::Conic { curvature: 0.0, conic: 0.0 })
            },
            biconic([1.0, 0.2]),
            biconic([-1.0, 0.2]),
            Description {
                odd: vec![-0.4, 0.3],
                mixed: vec![(1, 2, 0.5), (3, 1, -1.5)],
                ..biconic([1.0, -0.4])
            },
            Description { mixed: vec![(3, 0, -3.0), (0, 5, 1.5)], ..base(0.0) },
        ];
        list.iter().map(|of| Sag::new(of).unwrap()).collect()
    }

    #[test]
    fn lines_through_tips_and_along_vertical_rims_need_few_pieces() {
        let offsets = [0.0, 1e-300, 1e-17, 1e-15, 1e-9, 1e-3];
        let mut most = 0;
        for (k, sag) in hostile().iter().enumerate() {
            for (place, offset) in [0.0, 1.0].iter().flat_map(|&place| offsets.map(|o| (place, o))) {
                for (along, tilt) in [Vec3::X, Vec3::Y, Vec3::Z].iter().flat_map(|&v| offsets.map(|o| (v, o)))
                {
                    let z = sag.sag(place - offset, 0.0)[0];
                    let q = Vec3::new(place - offset, 0.0, z);
                    for turned in [Vec3::X, Vec3::new(0.6, 0.8, 0.3), Vec3::Z, -Vec3::Z] {
                        let count = pieces(sag, q, along + tilt * turned);
                        assert!(count < PIECES / 16, "{count} {k} {q:?} {along:?} {tilt} {turned:?}");
                        most = most.max(count);
                    }
                }
            }
        }
        assert!(most > 4, "{most}");
        println!("at most {most}");
    }
}
