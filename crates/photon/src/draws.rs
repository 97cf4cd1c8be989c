//! The first random numbers of the steps of a batch of photons, and random directions of new photons, eight photons at a time.
//!
//! They are those of [`Stream`], bit for bit. The loops over eight lanes are compiled for the instruction set of the
//! processor.

use crate::in_flight::{Mark, Numbers};
use crate::philox::{COSINE, Counter, MULTIPLIERS, PURPOSE_SHIFT, Purpose, ROUNDS, SINE, Stream, UNIT, WEYL};
use crate::rows::lane_of;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use rayweave_math::Vec3;
use rayweave_shape::lanes::{Lanes, Mask, Vec3Lanes, splat};

/// The number of photons that are processed together.
const LANES: usize = 8;

/// A word of each of eight photons, in the lower half.
pub(crate) type Words = [u64; LANES];

/// The first random numbers of the photons of a batch in their next steps.
#[derive(Debug)]
pub(crate) struct Draws {
    level: Level,
    /// Two exponentially distributed numbers of each photon, for its free paths.
    paths: Vec<[f64; 2]>,
    /// The photons at boundaries that need random numbers, and the first block of each.
    asked: Vec<Counter>,
    boundary: Vec<[u32; 4]>,
}

/// The numbers of a photon in a step for a purpose.
pub(crate) fn stream(seed: u64, [high, low, step]: Counter, purpose: Purpose) -> Stream {
    Stream::new(seed, u64::from(high) << 32 | u64::from(low), step, purpose)
}

impl Draws {
    pub fn new() -> Draws {
        Draws { level: Level::new(), paths: Vec::new(), asked: Vec::new(), boundary: Vec::new() }
    }

    /// Computes the numbers for the free paths of some photons in their next steps.
    pub fn compute(&mut self, seed: u64, numbers: &Numbers, marks: &[Mark]) {
        self.paths.resize(marks.len().next_multiple_of(LANES), [0.0; 2]);
        let (paths, _) = self.paths.as_chunks_mut();
        let level = self.level;
        dispatch!(level, simd => compute(simd, seed, (numbers, marks), paths));
        self.asked.clear();
    }

    /// The first two exponentially distributed numbers for the free paths of a photon.
    #[inline]
    pub fn exponentials(&self, i: usize) -> [f64; 2] {
        self.paths[i]
    }

    /// The numbers for the free paths of a photon behind the first two.
    pub fn other_exponentials(seed: u64, counter: Counter) -> Stream {
        stream(seed, counter, Purpose::FreePath).after_block()
    }

    /// Asks for the numbers of the boundary process of a photon; returns the number of the request.
    pub fn ask(&mut self, counter: Counter) -> u32 {
        self.asked.push(counter);
        self.asked.len() as u32 - 1
    }

    /// Computes the numbers of all requests.
    pub fn answer(&mut self, seed: u64) {
        self.boundary.resize(self.asked.len().next_multiple_of(LANES), [0; 4]);
        let (boundary, _) = self.boundary.as_chunks_mut();
        let (level, asked) = (self.level, &self.asked[..]);
        dispatch!(level, simd => answer(simd, seed, asked, boundary));
    }

    /// The numbers of the boundary process of a photon; `request` is the number of its request, if there is one.
    pub fn boundary(&self, request: Option<u32>, seed: u64, counter: Counter) -> Stream {
        let stream = stream(seed, counter, Purpose::Boundary);
        match request.and_then(|number| self.boundary.get(number as usize)) {
            Some(&block) => stream.with_block(block),
            None => stream,
        }
    }
}

/// Passes on isotropic directions of photons and random polarisations, from the streams of their emission: those of
/// [`Stream::direction`] and then of [`Stream::polarisation`].
pub(crate) fn isotropic(seed: u64, numbers: impl Iterator<Item = u64>, put: impl FnMut([Vec3; 2])) {
    let level = Level::new();
    dispatch!(level, simd => isotropic_lanes(simd, seed, numbers, put));
}

#[inline(always)]
fn isotropic_lanes<S: Simd>(
    simd: S,
    seed: u64,
    mut numbers: impl Iterator<Item = u64>,
    mut put: impl FnMut([Vec3; 2]),
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let key = [seed as u32, (seed >> 32) as u32];
            loop {
                let (mut counter, mut count) = ([[0; LANES]; 4], 0);
                for number in numbers.by_ref().take(LANES) {
                    counter[0][count % LANES] = number >> 32;
                    counter[1][count % LANES] = number & WORD;
                    count += 1;
                }
                if count == 0 {
                    break;
                }
                let purpose = u64::from((Purpose::Emission as u32) << PURPOSE_SHIFT);
                counter[3] = [purpose; LANES];
                let first = blocks(counter, key);
                counter[3] = [purpose + 1; LANES];
                let second = blocks(counter, key);
                let load = |values: [f64; LANES]| Lanes::load_array(simd, values);
                let cosine = load(uniforms(&first[0], &first[1])) * 2.0 - 1.0;
                let axis = Vec3Lanes::splat(simd, Vec3::Z);
                let direction = around(simd, axis, cosine, load(uniforms(&first[2], &first[3])));
                let turns = load(uniforms(&second[0], &second[1]));
                let polarisation = around(simd, direction, splat(simd, 0.0), turns);
                for lane in 0..count {
                    put([lane_of(&direction, lane), lane_of(&polarisation, lane)]);
                }
            }
        },
    );
}

/// Eight uniform numbers from their upper and lower words, as [`Stream::uniform`].
#[inline(always)]
fn uniforms(high: &Words, low: &Words) -> [f64; LANES] {
    let mut values = [0.0; LANES];
    for lane in 0..LANES {
        let bits = high[lane] << 21 | low[lane] >> 11;
        values[lane] = (bits as f64 + 0.5) * UNIT;
    }
    values
}

/// [`Stream::around`] for eight axes, with the azimuth in turns.
#[inline(always)]
pub(crate) fn around<S: Simd>(
    simd: S,
    axis: Vec3Lanes<S>,
    cosine: Lanes<S>,
    turns: Lanes<S>,
) -> Vec3Lanes<S> {
    let (one, zero) = (splat(simd, 1.0), splat(simd, 0.0));
    let sine = (one - cosine * cosine).max(zero).sqrt();
    let (cos, sin) = cos_sin_turns(simd, turns);
    // as `philox::perpendicular`
    let sign = one.copysign(axis.z);
    let a = -one / (sign + axis.z);
    let b = axis.x * axis.y * a;
    let x = Vec3Lanes { x: one + sign * axis.x * axis.x * a, y: sign * b, z: -sign * axis.x };
    let y = Vec3Lanes { x: b, y: sign + axis.y * axis.y * a, z: -axis.y };
    let across = x.times(cos).plus(y.times(sin));
    let sum = across.times(sine).plus(axis.times(cosine));
    sum.times(one / sum.length_squared().sqrt())
}

/// [`cos_sin_turns`](crate::philox::cos_sin_turns) for eight numbers.
#[inline(always)]
fn cos_sin_turns<S: Simd>(simd: S, turns: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let quarters = (turns * 4.0 + 0.5).floor();
    let is = |value: f64| quarters.simd_eq(splat(simd, value));
    let angle = (turns * 4.0 - quarters) * std::f64::consts::FRAC_PI_2;
    let square = angle * angle;
    let series = |coefficients: &[f64; 7]| {
        coefficients.iter().rev().fold(splat(simd, 0.0), |sum, &c| sum * square + c)
    };
    let sin = angle + angle * square * series(&SINE);
    let cos = splat(simd, 1.0) - square * (splat(simd, 0.5) - square * series(&COSINE));
    let is_odd: Mask<S> = is(1.0) | is(3.0);
    let (x, y) = (is_odd.select(sin, cos), is_odd.select(cos, sin));
    let x = (is(1.0) | is(2.0)).select(-x, x);
    (x, (is(2.0) | is(3.0)).select(-y, y))
}

#[inline(always)]
fn compute<S: Simd>(
    simd: S,
    seed: u64,
    (numbers, marks): (&Numbers, &[Mark]),
    paths: &mut [[[f64; 2]; LANES]],
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for (marks, paths) in marks.chunks(LANES).zip(paths) {
                let mut counters = [[0; LANES]; 3];
                for (lane, mark) in marks.iter().enumerate() {
                    let number = numbers.number(mark);
                    counters[0][lane % LANES] = number >> 32;
                    counters[1][lane % LANES] = number & WORD;
                    counters[2][lane % LANES] = u64::from(mark.steps.wrapping_add(1));
                }
                let words = first_blocks(counters, seed, Purpose::FreePath);
                for k in 0..2 {
                    let numbers = uniforms(&words[2 * k], &words[2 * k + 1]);
                    for lane in 0..LANES {
                        paths[lane][k] = exponential(numbers[lane]);
                    }
                }
            }
        },
    );
}

#[inline(always)]
fn answer<S: Simd>(simd: S, seed: u64, asked: &[Counter], boundary: &mut [[[u32; 4]; LANES]]) {
    simd.vectorize(
        #[inline(always)]
        || {
            for (asked, boundary) in asked.chunks(LANES).zip(boundary) {
                let mut counters = [[0; LANES]; 3];
                for (lane, counter) in asked.iter().enumerate() {
                    for k in 0..3 {
                        counters[k][lane % LANES] = u64::from(counter[k]);
                    }
                }
                let words = first_blocks(counters, seed, Purpose::Boundary);
                for lane in 0..LANES {
                    for k in 0..4 {
                        boundary[lane][k] = words[k][lane] as u32;
                    }
                }
            }
        },
    );
}

/// The first blocks of the numbers of eight photons for a purpose.
#[inline(always)]
fn first_blocks(counters: [Words; 3], seed: u64, purpose: Purpose) -> [Words; 4] {
    numbered_blocks(counters, seed, (purpose, 0))
}

/// The blocks with a number of eight photons.
#[inline(always)]
fn numbered_blocks([a, b, c]: [Words; 3], seed: u64, (purpose, number): (Purpose, u32)) -> [Words; 4] {
    let last = [u64::from(((purpose as u32) << PURPOSE_SHIFT) + number); LANES];
    blocks([a, b, c, last], [seed as u32, (seed >> 32) as u32])
}

/// The first two uniform numbers for the free paths of eight photons.
#[inline(always)]
pub(crate) fn free_path_uniforms(counters: [Words; 3], seed: u64) -> [[f64; LANES]; 2] {
    let [a, b, c, d] = first_blocks(counters, seed, Purpose::FreePath);
    [uniforms(&a, &b), uniforms(&c, &d)]
}

/// The two uniform numbers in a block of the boundary process of eight photons.
#[inline(always)]
pub(crate) fn boundary_uniforms(counters: [Words; 3], seed: u64, block: u32) -> [[f64; LANES]; 2] {
    let [a, b, c, d] = numbered_blocks(counters, seed, (Purpose::Boundary, block));
    [uniforms(&a, &b), uniforms(&c, &d)]
}

/// The two uniform numbers in blocks of the scattering of eight photons; each photon has a block of its own number.
#[inline(always)]
pub(crate) fn scattering_uniforms([a, b, c]: [Words; 3], seed: u64, numbers: &Words) -> [[f64; LANES]; 2] {
    let mut last = [u64::from((Purpose::Scattering as u32) << PURPOSE_SHIFT); LANES];
    for lane in 0..LANES {
        last[lane] += numbers[lane];
    }
    let [a, b, c, d] = blocks([a, b, c, last], [seed as u32, (seed >> 32) as u32]);
    [uniforms(&a, &b), uniforms(&c, &d)]
}

/// [`philox4x32`](crate::philox::philox4x32) for eight counters.
#[inline(always)]
fn blocks(mut counter: [Words; 4], mut key: [u32; 2]) -> [Words; 4] {
    for round in 0..ROUNDS {
        if round > 0 {
            key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
        }
        let before = counter;
        // what is above the lower halves is not used
        for lane in 0..LANES {
            let a = u64::from(MULTIPLIERS[0]) * (before[0][lane] & WORD);
            let b = u64::from(MULTIPLIERS[1]) * (before[2][lane] & WORD);
            counter[0][lane] = b >> 32 ^ before[1][lane] ^ u64::from(key[0]);
            counter[1][lane] = b;
            counter[2][lane] = a >> 32 ^ before[3][lane] ^ u64::from(key[1]);
            counter[3][lane] = a;
        }
    }
    for row in &mut counter {
        for word in row {
            *word &= WORD;
        }
    }
    counter
}

/// The bits of a word.
const WORD: u64 = u32::MAX as u64;

/// A lower bound, relative to the value, of [`exponential`] divided by one minus its uniform number: the negative logarithm of u
/// is at least 1 - u, and all roundings are below this margin.
pub(crate) const LEAST_EXPONENTIAL: f64 = 1.0 - 1e-12;

/// The exponentially distributed number of a uniform one: [`Stream::exponential`].
#[inline(always)]
pub(crate) fn exponential(uniform: f64) -> f64 {
    -log(uniform)
}

/// The natural logarithm of a number from 2^-54 to 1, by the operations of `log` in the C library musl and in `libm`, without
/// branches.
#[inline(always)]
fn log(x: f64) -> f64 {
    let bits = x.to_bits() + TO_ONE;
    let power = (bits >> 52) as i32 - 0x3ff;
    let f = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) + ROOT) - 1.0;
    let half_square = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let even = w * (LOG[1] + w * (LOG[3] + w * LOG[5]));
    let odd = z * (LOG[0] + w * (LOG[2] + w * (LOG[4] + w * LOG[6])));
    let power = f64::from(power);
    s * (half_square + (odd + even)) + power * LN2_LOW - half_square + f + power * LN2_HIGH
}

/// The upper half of sqrt(1/2), and what brings it to that of 1.
pub(crate) const ROOT: u64 = 0x3fe6_a09e << 32;
pub(crate) const TO_ONE: u64 = (0x3ff0_0000 - 0x3fe6_a09e) << 32;

/// The coefficients of the polynomial, and ln 2 in two parts (FreeBSD, `e_log.c`).
pub(crate) const LOG: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];
pub(crate) const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
pub(crate) const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::in_flight::Place;
    use crate::photon::EventKey;

    /// Known words and numbers of batches of several lengths are those of the streams.
    #[test]
    fn the_numbers_are_those_of_the_streams() {
        let seed = 0x1234_5678_9abc_def0;
        let mut draws = Draws::new();
        for count in [1, 7, 8, 29] {
            let mut numbers = Numbers::new(EventKey { seed, event: 3 });
            numbers.begin(100);
            // some of the source, and some with numbers of their own
            let number =
                |k: u64| if k.is_multiple_of(3) { k * 0x1_0000_0001 + 5 } else { (3 << 32) + 100 + k };
            let mark = |k: u64| Mark {
                number: if k.is_multiple_of(3) { numbers.add(k, number(k)) } else { k as u32 },
                steps: (k % 7) as u32,
                place: Place::UNKNOWN,
            };
            let mut marks: Vec<Mark> = (0..count).map(mark).collect();
            draws.compute(seed, &numbers, &marks);
            for mark in &mut marks {
                mark.steps += 1;
                draws.ask(numbers.counter(mark));
            }
            draws.answer(seed);
            for (i, mark) in marks.iter().enumerate() {
                let stream = |purpose| Stream::new(seed, number(i as u64), mark.steps, purpose);
                let counter = numbers.counter(mark);
                let (mut known, mut expected) =
                    (draws.boundary(Some(i as u32), seed, counter), stream(Purpose::Boundary));
                let mut paths = (Draws::other_exponentials(seed, counter), stream(Purpose::FreePath));
                for known in draws.exponentials(i) {
                    assert_eq!(known.to_bits(), paths.1.exponential().to_bits());
                }
                for _ in 0..6 {
                    assert_eq!(known.uniform(), expected.uniform());
                    assert_eq!(paths.0.exponential().to_bits(), paths.1.exponential().to_bits());
                }
            }
        }
    }

    /// Directions and polarisations of lists of several lengths are those of the streams.
    #[test]
    fn directions_are_those_of_the_streams() {
        let seed = 0xfedc_ba98_7654_3210;
        for count in [0, 1, 7, 8, 29, 4000] {
            let numbers: Vec<u64> = (0..count).map(|k| k * 0x1_0000_0001 + 3).collect();
            let mut found = Vec::new();
            isotropic(seed, numbers.iter().copied(), |vectors| found.push(vectors));
            assert_eq!(found.len(), numbers.len());
            for (number, [direction, polarisation]) in numbers.into_iter().zip(found) {
                let mut stream = Stream::new(seed, number, 0, Purpose::Emission);
                let expected = stream.direction();
                let bits = |vector: Vec3| vector.to_array().map(f64::to_bits);
                assert_eq!(bits(direction), bits(expected), "{number}");
                assert_eq!(bits(polarisation), bits(stream.polarisation(expected)), "{number}");
            }
        }
    }

    /// The bound that spares logarithms holds, also next to 0 and 1.
    #[test]
    fn exponential_numbers_are_above_their_bound() {
        let mut rest = 0.5;
        while rest > f64::EPSILON / 4.0 {
            for u in [1.0 - rest, rest, (1.0 - rest).next_up(), rest.next_down()] {
                for mean in [1.0, 3.1e-7, 1e20] {
                    assert!(mean * exponential(u) >= mean * (1.0 - u) * LEAST_EXPONENTIAL, "{u:e}");
                }
            }
            rest *= 0.937;
        }
    }

    #[test]
    fn the_logarithm_is_that_of_libm() {
        let mut x = 1.0;
        while x > f64::EPSILON / 4.0 {
            for x in [x, x.next_down(), 0.999 * x, 0.75 * x, 0.707 * x, 0.5001 * x] {
                assert_eq!(log(x).to_bits(), libm::log(x).to_bits(), "{x:e}");
            }
            x *= 0.983;
        }
    }
}
