//! Eight rays abreast through one face: refraction, and where they go on, by the operations of
//! [`refract`](crate::interface::refract) and of the scalar loop in their order, so that the bits are the same.

use crate::near::Near;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use rayweave_math::Bounds;
use rayweave_model::{Program, Rays, SurfaceId};
use rayweave_shape::lanes::{Kernel, LANES, Lanes, Mask, Vec3Lanes, splat};
use rayweave_shape::surface::delta_of;

/// The surfaces of a system, ready for lanes, with the boxes in which they matter.
#[derive(Clone, Debug)]
pub(crate) struct Abreast {
    surfaces: Vec<Placed>,
    level: Level,
}

#[derive(Clone, Debug)]
struct Placed {
    surface: SurfaceId,
    kernel: Kernel,
    reach: f64,
    lo: [f64; 3],
    hi: [f64; 3],
}

/// Eight rays where they meet a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrived<'a> {
    pub rays: Rays<'a>,
    /// The number of the first.
    pub at: usize,
    pub t: &'a [f64],
    pub normal: [&'a [f64]; 3],
    pub path: &'a [f64],
    /// The indices before and behind.
    pub indices: [[f64; LANES]; 2],
    pub surface: SurfaceId,
}

/// Eight rays that go on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gone {
    /// Where they met the face.
    pub end: [[f64; LANES]; 3],
    /// Where they go on: put onto the face.
    origin: [[f64; LANES]; 3],
    direction: [[f64; LANES]; 3],
    /// Their optical paths up to there.
    pub path: [f64; LANES],
    /// Those that are where f < 0 behind the face, a bit each.
    pub inside: u64,
}

impl Gone {
    pub fn rays(&self) -> Rays<'_> {
        let ([x, y, z], [u, v, w]) = (&self.origin, &self.direction);
        Rays { origins: [x, y, z], directions: [u, v, w] }
    }
}

impl Abreast {
    /// `None` for a system with placed solids, or surfaces for which there is no kernel.
    pub fn new(program: &Program, near: &Near) -> Option<Abreast> {
        let placed = |(bounds, surface): (Bounds, SurfaceId)| {
            let entry = program.surface(surface);
            let kernel = Kernel::of(&entry.surface).filter(Kernel::has_value)?;
            let (lo, hi) = (bounds.lo.to_array(), bounds.hi.to_array());
            Some(Placed { surface, kernel, reach: entry.reach, lo, hi })
        };
        let surfaces: Option<Vec<Placed>> = near.own()?.map(placed).collect();
        Some(Abreast { surfaces: surfaces?, level: Level::new() })
    }

    /// Refracts eight rays; `None` if any of them has to be looked at alone: it is totally reflected, or another surface
    /// may be within the tolerance.
    pub fn refract(&self, arrived: &Arrived<'_>) -> Option<Gone> {
        let own = self.surfaces.iter().find(|placed| placed.surface == arrived.surface)?;
        dispatch!(self.level, simd => self.refract_here(simd, own, arrived))
    }

    #[inline(always)]
    fn refract_here<S: Simd>(&self, simd: S, own: &Placed, arrived: &Arrived<'_>) -> Option<Gone> {
        let (origin, direction) =
            (load(simd, arrived.rays.origins, arrived.at)?, load(simd, arrived.rays.directions, arrived.at)?);
        let t = Lanes::load_array_ref(simd, arrived.t.get(arrived.at..)?.first_chunk()?);
        let normal = against(simd, load(simd, arrived.normal, arrived.at)?, direction);
        let [before, behind] = &arrived.indices;
        let before = Lanes::load_array_ref(simd, before);
        let ratio = before / Lanes::load_array_ref(simd, behind);
        let c = -direction.dot(normal);
        let squared = splat(simd, 1.0) - ratio * ratio * (splat(simd, 1.0) - c * c);
        if !squared.simd_gt(0.0).all_true() {
            return None;
        }
        let bent = direction.times(ratio).plus(normal.times(ratio * c - squared.sqrt()));
        let length = bent.length_squared().sqrt();
        let bent = Vec3Lanes { x: bent.x / length, y: bent.y / length, z: bent.z / length };
        let end = origin.plus(direction.times(t));
        let lengths = origin.taxicab() + t.abs() * direction.taxicab();
        if self.are_near(simd, own, end, lengths) {
            return None;
        }
        let (value, gradient) = own.kernel.value_and_gradient(simd, end);
        let step = value / gradient.dot(normal);
        if !step.abs().simd_lt(f64::INFINITY).all_true() {
            return None;
        }
        let off = normal.times(step);
        let foot = Vec3Lanes { x: end.x - off.x, y: end.y - off.y, z: end.z - off.z };
        let path = Lanes::load_array_ref(simd, arrived.path.get(arrived.at..)?.first_chunk()?) + before * t;
        Some(Gone {
            end: stored(end),
            origin: stored(foot),
            direction: stored(bent),
            path: path.to_array(),
            inside: gradient.dot(direction).simd_lt(0.0).to_bitmask(),
        })
    }

    /// True if any other surface may be within the tolerance of a point: the rough test of [`Near::others`].
    #[inline(always)]
    fn are_near<S: Simd>(&self, simd: S, own: &Placed, at: Vec3Lanes<S>, lengths: Lanes<S>) -> bool {
        let margin = lengths * (1e3 * delta_of(1.0));
        for placed in self.surfaces.iter().filter(|placed| placed.surface != own.surface) {
            let Placed { lo, hi, kernel, reach, .. } = placed;
            let mut within = (at.x + margin).simd_ge(lo[0]) & (at.x - margin).simd_le(hi[0]);
            within &= (at.y + margin).simd_ge(lo[1]) & (at.y - margin).simd_le(hi[1]);
            within &= (at.z + margin).simd_ge(lo[2]) & (at.z - margin).simd_le(hi[2]);
            if !within.any_true() {
                continue;
            }
            let (value, gradient) = kernel.value_and_gradient(simd, at);
            let near = (lengths + *reach) * (2.0 * delta_of(1.0)) * gradient.taxicab();
            if (within & !value.abs().simd_gt(near)).any_true() {
                return true;
            }
        }
        false
    }
}

/// A box, ready for lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Around {
    lo: [f64; 3],
    hi: [f64; 3],
    /// Room around it, relative to all lengths at hand.
    room: f64,
    size: f64,
    level: Level,
}

impl Around {
    pub fn new(bounds: &Bounds, room: f64) -> Around {
        let (lo, hi) = (bounds.lo.to_array(), bounds.hi.to_array());
        Around { lo, hi, room, size: bounds.size().length(), level: Level::new() }
    }

    /// Those of eight rays that are not all on one side of the box, along some axis, from t = 0 to some times; a bit each.
    pub fn may_touch(&self, rays: Rays<'_>, at: usize, end: &[f64]) -> Option<u64> {
        dispatch!(self.level, simd => self.may_touch_here(simd, rays, at, end))
    }

    #[inline(always)]
    fn may_touch_here<S: Simd>(&self, simd: S, rays: Rays<'_>, at: usize, end: &[f64]) -> Option<u64> {
        let (origin, direction) = (load(simd, rays.origins, at)?, load(simd, rays.directions, at)?);
        let end = Lanes::load_array_ref(simd, end.get(at..)?.first_chunk()?);
        let (is_finite, zero) = (end.simd_lt(f64::INFINITY), splat(simd, 0.0));
        // for rays without end their directions tell
        let last = origin.plus(direction.times(is_finite.select(end, zero)));
        let room = (origin.taxicab() + last.taxicab() + self.size) * self.room;
        let mut may = !Mask::splat(simd, false);
        for k in 0..3 {
            let (o, d, l) = (origin.component(k), direction.component(k), last.component(k));
            let (lo, hi) = (splat(simd, self.lo[k]) - room, splat(simd, self.hi[k]) + room);
            let (below, above) = (o.max(l).simd_lt(lo), o.min(l).simd_gt(hi));
            let stays_below = is_finite | d.simd_le(zero);
            let stays_above = is_finite | d.simd_ge(zero);
            may &= !((below & stays_below) | (above & stays_above));
        }
        Some(may.to_bitmask())
    }
}

/// Normals turned against directions.
#[inline(always)]
fn against<S: Simd>(simd: S, normal: Vec3Lanes<S>, direction: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let one = splat(simd, 1.0);
    normal.times(normal.dot(direction).simd_gt(0.0).select(-one, one))
}

#[inline(always)]
fn load<S: Simd>(simd: S, [x, y, z]: [&[f64]; 3], at: usize) -> Option<Vec3Lanes<S>> {
    Some(Vec3Lanes {
        x: Lanes::load_array_ref(simd, x.get(at..)?.first_chunk()?),
        y: Lanes::load_array_ref(simd, y.get(at..)?.first_chunk()?),
        z: Lanes::load_array_ref(simd, z.get(at..)?.first_chunk()?),
    })
}

#[inline(always)]
fn stored<S: Simd>(v: Vec3Lanes<S>) -> [[f64; LANES]; 3] {
    [v.x.to_array(), v.y.to_array(), v.z.to_array()]
}
