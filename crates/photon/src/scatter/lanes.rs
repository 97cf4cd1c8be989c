//! Rayleigh scattering of eight photons at a time: the operations of [`rayleigh`](super::rayleigh) in the same order, and so the
//! same bits.

use crate::draws::{Words, around, scattering_uniforms, stream};
use crate::philox::{Counter, Purpose};
use crate::photon::Photon;
use crate::rows::{Row, lane_of, minus, negative, put, vector};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;
use rayweave_shape::dispatch_wide;
use rayweave_shape::lanes::{LANES, Lanes, WideLevel, splat};

/// Photons that are scattered together.
#[derive(Debug)]
pub(crate) struct LaneScattering {
    level: Option<WideLevel>,
    photons: Vec<Scattered>,
}

/// A photon before scattering, then after it.
#[derive(Clone, Copy, Debug)]
struct Scattered {
    direction: Vec3,
    polarisation: Vec3,
    counter: Counter,
}

/// Eight photons, each in one of its attempts: some directions are rejected.
struct Eight {
    /// Bit mask of the lanes in use.
    active: u64,
    at: [usize; LANES],
    direction: [Row; 3],
    polarisation: [Row; 3],
    counters: [Words; 3],
    /// The next block of the random numbers of each photon.
    blocks: Words,
}

impl LaneScattering {
    pub fn new() -> LaneScattering {
        LaneScattering { level: WideLevel::widest(), photons: Vec::new() }
    }

    pub fn clear(&mut self) {
        self.photons.clear();
    }

    /// Adds a photon; returns its number. `None` on processors without wide vectors.
    #[inline]
    pub fn push(&mut self, photon: &Photon, counter: Counter) -> Option<u32> {
        self.level?;
        let &Photon { direction, polarisation, .. } = photon;
        self.photons.push(Scattered { direction, polarisation, counter });
        Some(self.photons.len() as u32 - 1)
    }

    /// Scatters all photons.
    pub fn apply(&mut self, seed: u64) {
        let (Some(level), [_, ..]) = (self.level, &self.photons[..]) else { return };
        let photons = &mut self.photons[..];
        dispatch_wide!(level, simd => apply(simd, seed, photons));
    }

    /// The direction and the polarisation of a photon after scattering, by its number.
    #[inline]
    pub fn get(&self, number: u32) -> (Vec3, Vec3) {
        let Scattered { direction, polarisation, .. } = self.photons[number as usize];
        (direction, polarisation)
    }
}

impl Eight {
    /// Lanes that are not in use have a direction and a polarisation across it.
    fn new() -> Eight {
        let (zero, one) = ([0.0; LANES], [1.0; LANES]);
        Eight {
            active: 0,
            at: [0; LANES],
            direction: [zero, zero, one],
            polarisation: [one, zero, zero],
            counters: [[0; LANES]; 3],
            blocks: [0; LANES],
        }
    }

    fn put(&mut self, lane: usize, at: usize, photon: &Scattered) {
        self.active |= 1 << lane;
        self.at[lane] = at;
        put(&mut self.direction, lane, photon.direction);
        put(&mut self.polarisation, lane, photon.polarisation);
        for k in 0..3 {
            self.counters[k][lane] = u64::from(photon.counter[k]);
        }
        self.blocks[lane] = 0;
    }

    /// The next two uniform numbers of each photon.
    #[inline(always)]
    fn uniforms<S: Simd>(&mut self, simd: S, seed: u64) -> [Lanes<S>; 2] {
        let [first, second] = scattering_uniforms(self.counters, seed, &self.blocks);
        for block in &mut self.blocks {
            *block += 1;
        }
        [Lanes::load_array(simd, first), Lanes::load_array(simd, second)]
    }
}

/// A loop, not a closure, which would be compiled without the wide vectors.
#[inline(always)]
fn apply<S: Simd>(simd: S, seed: u64, photons: &mut [Scattered]) {
    let (mut eight, mut next) = (Eight::new(), 0);
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
    loop {
        for lane in 0..LANES {
            if eight.active >> lane & 1 == 0 && next < photons.len() {
                eight.put(lane, next, &photons[next]);
                next += 1;
            }
        }
        if eight.active == 0 {
            break;
        }
        let [cosine, azimuth] = eight.uniforms(simd, seed);
        let [sign, limit] = eight.uniforms(simd, seed);
        let (direction, polarisation) = (vector(simd, &eight.direction), vector(simd, &eight.polarisation));
        let scattered = around(simd, direction, cosine * 2.0 - 1.0, azimuth);
        let part = minus(polarisation, scattered.times(polarisation.dot(scattered)));
        let scale = one / part.length_squared().sqrt();
        let is_known = scale.simd_gt(zero) & scale.simd_lt(splat(simd, f64::INFINITY));
        let turned = part.times(scale);
        let is_turned = sign.simd_lt(splat(simd, 0.5));
        let turned = turned.or_where(is_turned, negative(turned));
        let overlap = turned.dot(polarisation);
        let accepted = (overlap * overlap).simd_ge(limit).to_bitmask();
        let known = is_known.to_bitmask();
        let done = eight.active & (accepted | !known);
        for lane in (0..LANES).filter(|lane| done >> lane & 1 == 1) {
            let photon = &mut photons[eight.at[lane]];
            (photon.direction, photon.polarisation) = match known >> lane & 1 {
                1 => (lane_of(&scattered, lane), lane_of(&turned, lane)),
                // scattered along the old polarisation
                _ => photon.scattered_alone(seed),
            };
        }
        eight.active &= !done;
    }
}

impl Scattered {
    #[cold]
    fn scattered_alone(&self, seed: u64) -> (Vec3, Vec3) {
        let mut stream = stream(seed, self.counter, Purpose::Scattering);
        super::rayleigh(self.direction, self.polarisation, &mut stream)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::philox::Stream;

    /// Lists of several lengths are scattered as one by one, also with polarisations that are not across the direction.
    #[test]
    fn photons_are_scattered_as_one_by_one() {
        let seed = 0x1234_5678_9abc_def0;
        for count in [0, 1, 7, 8, 9, 1000] {
            let mut lanes = LaneScattering::new();
            let mut expected = Vec::new();
            for k in 0..count {
                let mut stream = Stream::new(seed, k, 0, Purpose::Emission);
                let direction = stream.direction();
                let across = stream.polarisation(direction);
                let polarisation = if k % 50 == 3 { stream.direction() } else { across };
                let photon = Photon { position: Vec3::ONE, direction, polarisation, energy: 3e-6, time: 0.0 };
                let (number, steps) = (k * 0x1_0000_0001 + 7, (k % 5) as u32);
                let counter = [(number >> 32) as u32, number as u32, steps];
                if lanes.push(&photon, counter).is_none() {
                    // a processor without wide vectors
                    return;
                }
                let mut stream = Stream::new(seed, number, steps, Purpose::Scattering);
                expected.push(super::super::rayleigh(direction, polarisation, &mut stream));
            }
            lanes.apply(seed);
            for (k, (direction, polarisation)) in (0..).zip(expected) {
                let bits = |vector: Vec3| vector.to_array().map(f64::to_bits);
                let found = lanes.get(k);
                assert_eq!(bits(found.0), bits(direction), "photon {k} of {count}");
                assert_eq!(bits(found.1), bits(polarisation), "photon {k} of {count}");
            }
        }
    }
}
