//! Bare polished interfaces between two dielectrics, eight photons at a time.

use super::event::BoundaryEvent;
use super::lanes::{Group, mirrored, normalised};
use super::process::GRAZING;
use crate::draws::boundary_uniforms;
use crate::rows::{load, minus, negative, vector};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_shape::lanes::{Lanes, Mask, Vec3Lanes, splat};

/// The events, in the order of the masks of a group.
pub(crate) const EVENTS: [BoundaryEvent; 3] = [
    BoundaryEvent::FresnelRefraction,
    BoundaryEvent::TotalInternalReflection,
    BoundaryEvent::FresnelReflection,
];

impl Group {
    /// Applies the process to the photons in a bit mask of lanes.
    #[inline(always)]
    pub fn meet_interface<S: Simd>(&mut self, simd: S, seed: u64, used: u64) {
        let d = vector(simd, &self.direction);
        let (p, f) = (vector(simd, &self.polarisation), vector(simd, &self.normal));
        let [index, behind] = [0, 1].map(|k| load(simd, &self.values[k]));
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        // as `Process::wave`
        let cosine = -d.dot(f);
        let is_oblique = cosine.abs().simd_lt(splat(simd, 1.0 - GRAZING));
        let sin1 = is_oblique.select((one - cosine * cosine).sqrt(), zero);
        let sin2 = sin1 * index / behind;
        let is_total = sin2.simd_ge(one);
        let mirror = mirrored(d, f);
        if is_total.to_bitmask() & used == used {
            // light guides: no random numbers, no amplitudes
            self.events = [0, used];
            let polarisation = negative(mirrored(p, f));
            return self.leave(simd, f, (mirror, polarisation), Mask::splat(simd, false));
        }
        let cosine2 = (one - sin2 * sin2).sqrt().copysign(cosine);
        let across = p.or_where(is_oblique, normalised(simd, d.cross(f)));
        let s = p.dot(across);
        let rest = minus(p, across.times(s));
        let (s, p1) = (is_oblique.select(s, zero), is_oblique.select(rest.length_squared().sqrt(), one));
        let flux = index * 2.0 * cosine;
        let s2 = flux * s / (index * cosine + behind * cosine2);
        let p2 = flux * p1 / (behind * cosine + index * cosine2);
        let (flux1, flux2) = (index * cosine, behind * cosine2);
        let transmittance = flux2 * (s2 * s2 + p2 * p2) / flux1;
        // the first number decides about losses at the surface: there are none
        let uniform = Lanes::load_array(simd, boundary_uniforms(self.counters, seed, 0)[1]);
        let transmittance = cosine.simd_eq(zero).select(zero, transmittance);
        let is_through = !is_total & uniform.simd_lt(transmittance);
        // as `Process::refract`, `Process::reflect_wave` and `Process::mirror`
        let bend = cosine - cosine2 * (behind / index);
        let bent = normalised(simd, d.plus(f.times(bend)));
        let direction = mirror.or_where(is_through, d.or_where(is_oblique, bent));
        let (s, p1) = (is_through.select(s2, s2 - s), is_through.select(p2, behind * p2 / index - p1));
        let along = normalised(simd, direction.cross(across));
        let length = (s * s + p1 * p1).sqrt();
        let sum = along.times(p1).plus(across.times(s));
        let turned = Vec3Lanes { x: sum.x / length, y: sum.y / length, z: sum.z / length };
        let is_denser = behind.simd_gt(index);
        let upright = p.or_where(!is_through & is_denser, negative(p));
        let polarisation = upright.or_where(is_oblique, turned);
        let polarisation = polarisation.or_where(is_total, negative(mirrored(p, f)));
        self.events = [is_through, is_total].map(|mask| mask.to_bitmask());
        self.leave(simd, f, (direction, polarisation), is_through);
    }
}
