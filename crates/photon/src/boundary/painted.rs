//! Paint and metal that reflect by one rule, eight photons at a time.

use super::event::BoundaryEvent;
use super::lanes::{Group, mirrored, normalised};
use crate::draws::{around, boundary_uniforms};
use crate::property::PropertyTable;
use crate::rows::{load, minus, negative, vector};
use crate::surface::{OpticalSurface, SurfaceFinish, SurfaceModel, SurfaceType};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_shape::lanes::{Lanes, Mask, splat};

/// The events, in the order of the masks of a group; there is no third one.
pub(crate) const EVENTS: [BoundaryEvent; 3] = [
    BoundaryEvent::SpikeReflection,
    BoundaryEvent::LambertianReflection,
    BoundaryEvent::LambertianReflection,
];

/// The rule by which a surface reflects all photons that it does not absorb or transmit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reflection {
    /// Like a mirror.
    Mirror,
    /// Diffusely, by paint.
    Paint,
    /// Diffusely, by a metal of the unified model without lobes, whose second random number chooses between the lobes.
    Metal,
}

impl Reflection {
    /// The rule of a surface; `None` if it has several or another one, or if it reflects few photons and transmits some: lanes
    /// repeat the work for those that it may transmit.
    pub fn of(surface: &OpticalSurface) -> Option<Reflection> {
        use SurfaceFinish::{Ground, GroundFrontPainted, Polished, PolishedFrontPainted};
        let all = |table: &Option<PropertyTable>, holds: fn(f64) -> bool| {
            table.as_ref().is_none_or(|table| table.values().iter().all(|&value| holds(value)))
        };
        let has_index = surface.reflectivity.is_none() && surface.metal_index.is_some();
        let reflects = all(&surface.reflectivity, |value| value >= 0.5);
        let is_opaque = surface.transmittance.is_none();
        if has_index || !(reflects || is_opaque) || !all(&surface.transmittance, |value| value >= 0.0) {
            return None;
        }
        let has_lobes =
            [&surface.lobe, &surface.spike, &surface.backscatter].iter().any(|lobe| lobe.is_some());
        match (surface.kind, surface.finish, surface.model) {
            (SurfaceType::DielectricDielectric, PolishedFrontPainted, _) => Some(Reflection::Mirror),
            (SurfaceType::DielectricDielectric, GroundFrontPainted, _) => Some(Reflection::Paint),
            (SurfaceType::DielectricMetal, Polished, _) => Some(Reflection::Mirror),
            (SurfaceType::DielectricMetal, Ground, SurfaceModel::Unified) if !has_lobes => {
                Some(Reflection::Metal)
            }
            _ => None,
        }
    }

    /// The values of a surface at an energy for lanes: the reflectivity, the number of the rule, and the efficiency, -1 for a surface
    /// that may transmit photons.
    #[inline]
    pub fn values(self, surface: &OpticalSurface, energy: f64) -> [f64; 3] {
        let at = |table: &Option<PropertyTable>, absent: f64| {
            table.as_ref().map_or(absent, |table| table.at(energy))
        };
        let efficiency = if surface.transmittance.is_none() { at(&surface.efficiency, 0.0) } else { -1.0 };
        [at(&surface.reflectivity, 1.0), self.number(), efficiency]
    }

    /// The number in a lane.
    fn number(self) -> f64 {
        f64::from(self as u8)
    }
}

impl Group {
    /// Applies the process to the photons.
    #[inline(always)]
    pub fn meet_paint<S: Simd>(&mut self, simd: S, seed: u64) {
        let (d, p, n) =
            (vector(simd, &self.direction), vector(simd, &self.polarisation), vector(simd, &self.normal));
        let [reflectivity, rule, efficiency] = [0, 1, 2].map(|k| load(simd, &self.values[k]));
        let is = |reflection: Reflection| rule.simd_eq(splat(simd, reflection.number()));
        let (is_mirror, is_metal) = (is(Reflection::Mirror), is(Reflection::Metal));
        let uniforms = |block: u32| {
            boundary_uniforms(self.counters, seed, block).map(|numbers| Lanes::load_array(simd, numbers))
        };
        let [loss, first] = uniforms(0);
        let [second, third] = uniforms(1);
        // as `Process::reflect` and `Process::leave_along`
        let (height, turns) = (is_metal.select(second, first), is_metal.select(third, second));
        let direction = around(simd, n, height.sqrt(), turns);
        let facet = normalised(simd, minus(direction, d));
        let direction = direction.or_where(is_mirror, mirrored(d, n));
        let facet = facet.or_where(is_mirror, n);
        let polarisation = negative(mirrored(p, facet));
        self.events = [is_mirror, !is_mirror].map(|mask| mask.to_bitmask());
        self.leave(simd, n, (direction, polarisation), Mask::splat(simd, false));
        self.unsure |= direction.dot(n).simd_lt(splat(simd, 0.0)).to_bitmask();
        // as `Process::is_lost`, `Process::metal` and `Process::absorb`
        let is_lost = loss.simd_gt(reflectivity);
        self.lost = is_lost.to_bitmask();
        self.detected = (is_lost & first.simd_lt(efficiency)).to_bitmask();
        let may_pass = (is_lost & efficiency.simd_lt(splat(simd, 0.0))).to_bitmask();
        self.unsure = (self.unsure & !self.lost) | may_pass;
    }
}
