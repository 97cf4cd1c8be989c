//! Solids that are one span less a few others along every ray, such as a convex body with bores: the most frequent form of
//! machine parts.
//!
//! An end of one of the other spans is a crossing if it lies within the first span and in none of the rest; an end of the
//! first span is a crossing if it lies in none of the others. The code is compiled for each number of spans and works at the
//! width of the registers, so that all ends stay in them and nothing is left to decide per bundle.

use super::group::{Memory, Row, WHOLE};
use super::network::sort_few;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_shape::lanes::LANES;

/// Largest number of spans, each with two ends.
pub(super) const MOST_SPANS: usize = 5;

/// The low bits of a key, which hold the number of a face.
pub(super) const NUMBER: u64 = 63;

/// The key of no crossing: greater than that of any crossing, with the number 63.
pub(super) const NOTHING: f64 = f64::MAX;

/// The indices of the spans of such a solid; the first one is the span that contains the solid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Remainder {
    pub spans: [usize; MOST_SPANS],
    /// The number of spans, from 1.
    pub count: usize,
}

/// The window of eight rays: lower bounds of t, and one upper bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds<'a> {
    pub from: &'a Row,
    pub t_max: f64,
}

/// The ends of the spans and the window, for as many rays as a register holds.
struct Ends<S: Simd, const N: usize> {
    /// Each span begins at an even index and ends at the next one.
    t: [S::f64s; N],
    from: S::f64s,
    t_max: S::f64s,
}

/// The ends that are crossings, and the rays on which two ends that matter coincide.
struct Changes<S: Simd, const N: usize> {
    kept: [S::mask64s; N],
    ties: S::mask64s,
}

#[inline(always)]
fn part<S: Simd>(simd: S, row: &Row, at: usize) -> S::f64s {
    S::f64s::from_slice(simd, &row.0[at..at + S::f64s::LEN])
}

#[inline(always)]
fn put<S: Simd>(value: S::f64s, row: &mut Row, at: usize) {
    value.store_slice(&mut row.0[at..at + S::f64s::LEN]);
}

impl<S: Simd, const N: usize> Ends<S, N> {
    #[inline(always)]
    fn load(simd: S, memory: &Memory, shape: &Remainder, bounds: Bounds<'_>, at: usize) -> Self {
        let from = part(simd, bounds.from, at);
        let mut t = [from; N];
        for k in 0..N {
            t[k] = part(simd, memory.end(2 * shape.spans[k / 2] + k % 2), at);
        }
        Ends { t, from, t_max: S::f64s::splat(simd, bounds.t_max) }
    }

    /// True where `t` lies within span `k`.
    #[inline(always)]
    fn holds(&self, k: usize, t: S::f64s) -> S::mask64s {
        self.t[2 * k].simd_lt(t) & t.simd_lt(self.t[2 * k + 1])
    }

    /// True where `t` is an end of span `k`.
    #[inline(always)]
    fn meets(&self, k: usize, t: S::f64s) -> S::mask64s {
        self.t[2 * k].simd_eq(t) | t.simd_eq(self.t[2 * k + 1])
    }

    #[inline(always)]
    fn changes(&self, simd: S) -> Changes<S, N> {
        let (low, high) = (self.t[0].max(self.from), self.t[1].min(self.t_max));
        let nowhere = S::mask64s::splat(simd, false);
        let (mut kept, mut ties) = ([nowhere; N], nowhere);
        for k in 0..2 {
            let t = self.t[k];
            let queried = self.from.simd_lt(t) & t.simd_lt(self.t_max);
            let (mut is_free, mut meets) = (queried, nowhere);
            for other in 1..N / 2 {
                is_free &= !self.holds(other, t);
                meets |= self.meets(other, t);
            }
            kept[k] = is_free;
            ties |= meets & queried;
        }
        for k in 2..N {
            let t = self.t[k];
            let within = low.simd_lt(t) & t.simd_lt(high);
            let (mut is_free, mut meets) = (within, nowhere);
            for other in (1..N / 2).filter(|&other| other != k / 2) {
                is_free &= !self.holds(other, t);
                // each pair of spans once
                if other > k / 2 {
                    meets |= self.meets(other, t);
                }
            }
            kept[k] = is_free;
            ties |= meets & within;
        }
        Changes { kept, ties }
    }
}

/// Writes all crossings of eight rays to `memory.times` and `memory.keys`, in order of time: [`NOTHING`] is the key of no
/// crossing, others hold the number of the face in their low bits. Writes the length of the shortest piece between two
/// crossings to `memory.shortest`. Returns the rays on which two ends that matter coincide.
#[inline(always)]
fn all<S: Simd, const N: usize>(simd: S, memory: &mut Memory, shape: &Remainder, bounds: Bounds<'_>) -> u64 {
    let mut tied = 0;
    for at in (0..LANES).step_by(S::f64s::LEN) {
        let ends = Ends::<S, N>::load(simd, memory, shape, bounds, at);
        let Changes { kept, ties } = ends.changes(simd);
        tied |= ties.to_bitmask() << at;
        let never = S::f64s::splat(simd, f64::INFINITY);
        let (mut times, mut keys) = ([never; N], [never; N]);
        for k in 0..N {
            times[k] = kept[k].select(ends.t[k], never);
            let face = part(simd, memory.face(2 * shape.spans[k / 2] + k % 2), at);
            keys[k] = kept[k].select(key::<S>(ends.t[k], face), S::f64s::splat(simd, NOTHING));
        }
        sort_few::<S, N>(&mut times);
        let mut shortest = never;
        for k in 0..N {
            put::<S>(times[k], &mut memory.times[k], at);
            if k > 0 {
                // infinite or NaN after the last crossing
                let piece = times[k] - times[k - 1];
                shortest = piece.simd_lt(shortest).select(piece, shortest);
            }
        }
        put::<S>(shortest, &mut memory.shortest, at);
        sort_few::<S, N>(&mut keys);
        for k in 0..N {
            put::<S>(keys[k], &mut memory.keys[k], at);
        }
    }
    tied
}

/// A time with its low bits replaced by the number of a face, 0 to 62.
#[inline(always)]
fn key<S: Simd>(t: S::f64s, face: S::f64s) -> S::f64s {
    let number = (face + WHOLE).to_bits() & NUMBER;
    S::f64s::from_bits((t.to_bits() & !NUMBER) | number)
}

/// Writes the first crossings to `memory.times[0]` and their faces to `memory.face`, -1 for none, the second ones to
/// `memory.times[1]`, and to `memory.inside` 1 for the rays that start inside, 0 for others. Returns the rays on which two
/// ends that matter coincide.
#[inline(always)]
fn first<S: Simd, const N: usize>(
    simd: S,
    memory: &mut Memory,
    shape: &Remainder,
    bounds: Bounds<'_>,
) -> u64 {
    let mut tied = 0;
    for at in (0..LANES).step_by(S::f64s::LEN) {
        let ends = Ends::<S, N>::load(simd, memory, shape, bounds, at);
        let Changes { kept, ties } = ends.changes(simd);
        tied |= ties.to_bitmask() << at;
        let never = S::f64s::splat(simd, f64::INFINITY);
        let (mut first, mut second, mut face) = (never, never, S::f64s::splat(simd, -1.0));
        for k in 0..N {
            let t = kept[k].select(ends.t[k], never);
            let is_first = t.simd_lt(first);
            face = is_first.select(part(simd, memory.face(2 * shape.spans[k / 2] + k % 2), at), face);
            second = second.min(first.max(t));
            first = first.min(t);
        }
        let starts_within = ends.t[0].simd_le(ends.from) & ends.from.simd_lt(ends.t[1]);
        let mut inside = S::f64s::splat(simd, 0.0);
        if starts_within.any_true() {
            let mut is_inside = starts_within;
            for k in 1..N / 2 {
                let is_in = ends.t[2 * k].simd_le(ends.from) & ends.from.simd_lt(ends.t[2 * k + 1]);
                is_inside &= !is_in;
            }
            inside = is_inside.select(S::f64s::splat(simd, 1.0), inside);
        }
        put::<S>(first, &mut memory.times[0], at);
        put::<S>(second, &mut memory.times[1], at);
        put::<S>(face, &mut memory.face, at);
        put::<S>(inside, &mut memory.inside, at);
    }
    tied
}

/// Calls a function that is compiled for each number of ends, for a shape with any number of spans.
macro_rules! for_spans {
    ($of:ident($simd:ident, $memory:ident, $shape:ident, $bounds:ident)) => {
        match $shape.count {
            1 => $of::<S, 2>($simd, $memory, $shape, $bounds),
            2 => $of::<S, 4>($simd, $memory, $shape, $bounds),
            3 => $of::<S, 6>($simd, $memory, $shape, $bounds),
            4 => $of::<S, 8>($simd, $memory, $shape, $bounds),
            _ => $of::<S, 10>($simd, $memory, $shape, $bounds),
        }
    };
}

/// [`all`] for any number of spans.
#[inline(always)]
pub(super) fn all_of<S: Simd>(simd: S, memory: &mut Memory, shape: &Remainder, bounds: Bounds<'_>) -> u64 {
    for_spans!(all(simd, memory, shape, bounds))
}

/// [`first`] for any number of spans.
#[inline(always)]
pub(super) fn first_of<S: Simd>(simd: S, memory: &mut Memory, shape: &Remainder, bounds: Bounds<'_>) -> u64 {
    for_spans!(first(simd, memory, shape, bounds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    /// A pseudo-random number below `n`.
    fn below(state: &mut u64, n: u64) -> u64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 33) % n
    }

    /// Spans with whole ends, some of them empty; the face at each end is the index of the end.
    fn random_spans(state: &mut u64, memory: &mut Memory, count: usize) {
        for span in 0..count {
            for lane in 0..LANES {
                let from = below(state, 40) as f64;
                let to = from + below(state, 30) as f64;
                let ends = if from < to { [from, to] } else { [f64::INFINITY, f64::NEG_INFINITY] };
                for (k, end) in ends.into_iter().enumerate() {
                    memory.ends[2 * span + k].0[lane] = end;
                    memory.faces[2 * span + k].0[lane] = (2 * span + k) as f64;
                }
            }
        }
    }

    /// True if t, not an end, lies in the first span and in none of the others.
    fn inside(memory: &Memory, count: usize, lane: usize, t: f64) -> bool {
        let holds = |span: usize| memory.ends[2 * span].0[lane] < t && t < memory.ends[2 * span + 1].0[lane];
        holds(0) && !(1..count).any(holds)
    }

    /// The changes within the window: times and faces.
    fn expected(memory: &Memory, count: usize, lane: usize, from: f64) -> Vec<(f64, usize)> {
        let mut changes = Vec::new();
        for t in (0..80).map(f64::from).filter(|&t| from < t) {
            if inside(memory, count, lane, t - 0.5) != inside(memory, count, lane, t + 0.5) {
                let end = (0..2 * count).find(|&end| memory.ends[end].0[lane] == t);
                changes.push((t, end.expect("the inside changes at an end")));
            }
        }
        changes
    }

    fn are_distinct(memory: &Memory, count: usize, lane: usize) -> bool {
        let mut ends: Vec<f64> = memory.ends[..2 * count].iter().map(|row| row.0[lane]).collect();
        ends.retain(|end| end.is_finite());
        ends.sort_by(f64::total_cmp);
        ends.windows(2).all(|pair| pair[0] < pair[1])
    }

    #[test]
    fn changes_are_those_of_the_boolean_function() {
        let (mut state, mut memory, mut compared) = (5, Memory::default(), 0);
        for round in 0..2000 {
            let count = 1 + round % MOST_SPANS;
            random_spans(&mut state, &mut memory, count);
            let from = if round % 3 == 0 { 20.5 } else { f64::NEG_INFINITY };
            let row = Row([from; LANES]);
            let shape = Remainder { spans: [0, 1, 2, 3, 4], count };
            let bounds = Bounds { from: &row, t_max: f64::INFINITY };
            let tied = dispatch!(Level::new(), simd => all_of(simd, &mut memory, &shape, bounds));
            let lists: Vec<_> = (0..LANES).map(|lane| expected(&memory, count, lane, from)).collect();
            for lane in (0..LANES).filter(|lane| tied >> lane & 1 == 0) {
                let found = (0..2 * count).map(|k| (memory.times[k].0[lane], memory.keys[k].0[lane]));
                let found: Vec<_> = found.map(|(t, key)| (t, (key.to_bits() & NUMBER) as usize)).collect();
                let (changes, rest) = found.split_at(lists[lane].len());
                assert_eq!(changes, lists[lane]);
                assert!(rest.iter().all(|&(t, number)| t == f64::INFINITY && number == 63));
                let pieces = lists[lane].windows(2).map(|pair| pair[1].0 - pair[0].0);
                assert_eq!(memory.shortest.0[lane], pieces.fold(f64::INFINITY, f64::min));
                compared += 1;
            }
            let also_tied = dispatch!(Level::new(), simd => first_of(simd, &mut memory, &shape, bounds));
            assert_eq!(tied, also_tied);
            for lane in (0..LANES).filter(|lane| tied >> lane & 1 == 0) {
                let at = |k: usize| lists[lane].get(k).map_or(f64::INFINITY, |change| change.0);
                let [first, second] = [0, 1].map(|k| memory.times[k].0[lane]);
                assert_eq!([first, second], [at(0), at(1)]);
                let face = lists[lane].first().map_or(-1.0, |change| change.1 as f64);
                assert_eq!(memory.face.0[lane], face);
                assert_eq!(memory.inside.0[lane] == 1.0, inside(&memory, count, lane, from.max(-1.0)));
            }
            let distinct = (0..LANES).filter(|&lane| are_distinct(&memory, count, lane));
            assert_eq!(distinct.filter(|lane| tied >> lane & 1 == 1).count(), 0);
        }
        assert!(compared > 8000, "{compared}");
    }
}
