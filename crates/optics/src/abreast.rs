//! Eight rays abreast through one face: refraction, and where they go on, by the operations of
//! [`refract`](crate::interface::refract) and of the scalar loop in their order, so that the bits are the same.

use crate::near::{Near, Tree};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use rayweave_math::Bounds;
use rayweave_model::{Program, Rays, SurfaceId};
use rayweave_shape::lanes::{Kernel, LANES, Lanes, Mask, Vec3Lanes, splat};
use rayweave_shape::surface::delta_of;
use std::ops::ControlFlow;

/// The surfaces of a system, ready for lanes, with the boxes in which they matter.
#[derive(Clone, Debug)]
pub(crate) struct Abreast {
    surfaces: Vec<Placed>,
    /// For each surface of the program its number among these.
    slots: Vec<Option<usize>>,
    tree: Tree,
    level: Level,
}

#[derive(Clone, Debug)]
struct Placed {
    kernel: Kernel,
    reach: f64,
}

/// Eight rays where they meet a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrived<S: Simd> {
    pub origin: Vec3Lanes<S>,
    pub direction: Vec3Lanes<S>,
    pub t: Lanes<S>,
    /// Where they are then.
    pub end: Vec3Lanes<S>,
    /// Of either sense.
    pub normal: Vec3Lanes<S>,
    /// f and its gradient there.
    pub slope: (Lanes<S>, Vec3Lanes<S>),
    pub path: Lanes<S>,
    pub surface: SurfaceId,
    /// True if no other surface is near.
    pub is_alone: bool,
}

/// Eight rays behind a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refracted<S: Simd> {
    /// Where they go on: put onto the face.
    pub origin: Vec3Lanes<S>,
    pub direction: Vec3Lanes<S>,
    /// Their optical paths up to there.
    pub path: Lanes<S>,
    /// Those that are where f < 0 behind the face, a bit each.
    pub inside: u64,
}

/// The same as numbers.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Gone {
    /// Where they met the face.
    pub end: [[f64; LANES]; 3],
    pub origin: [[f64; LANES]; 3],
    pub direction: [[f64; LANES]; 3],
    pub path: [f64; LANES],
    pub inside: u64,
}

impl Gone {
    /// The rays that go on.
    pub fn rays(&self) -> Rays<'_> {
        let ([x, y, z], [u, v, w]) = (&self.origin, &self.direction);
        Rays { origins: [x, y, z], directions: [u, v, w] }
    }
}

impl Abreast {
    /// `None` for a system with placed solids, or surfaces for which there is no kernel.
    pub fn new(program: &Program, near: &Near) -> Option<Abreast> {
        let (mut surfaces, mut boxes) = (Vec::new(), Vec::new());
        let mut slots = vec![None; program.surfaces().len()];
        for (bounds, surface) in near.own()? {
            let entry = program.surface(surface);
            let kernel = Kernel::of(&entry.surface).filter(Kernel::has_value)?;
            slots[surface.index()] = Some(surfaces.len());
            surfaces.push(Placed { kernel, reach: entry.reach });
            boxes.push(bounds);
        }
        Some(Abreast { surfaces, slots, tree: Tree::new(&boxes), level: Level::new() })
    }

    /// Refracts rays `at..at + 8` that meet a surface at some times, with normals of either sense; `None` if any of them has
    /// to be looked at alone: see [`Abreast::refract_here`].
    pub fn refract(
        &self,
        (rays, at): (Rays<'_>, usize),
        (t, normal): (&[f64], [&[f64]; 3]),
        path: &[f64],
        surface: SurfaceId,
        indices: &[[f64; LANES]; 2],
    ) -> Option<Gone> {
        let kernel = &self.surfaces[self.slot(surface)?].kernel;
        dispatch!(self.level, simd => {
            let arrived = Arrived::load(simd, kernel, (rays, at), (t, normal), path, surface)?;
            let indices = indices.each_ref().map(|index| Lanes::load_array_ref(simd, index));
            let gone = self.refract_here(simd, &arrived, indices)?;
            Some(Gone {
                end: stored(arrived.end),
                origin: stored(gone.origin),
                direction: stored(gone.direction),
                path: gone.path.to_array(),
                inside: gone.inside,
            })
        })
    }

    fn slot(&self, surface: SurfaceId) -> Option<usize> {
        self.slots.get(surface.index()).copied().flatten()
    }

    /// Refracts eight rays that meet a face between media of some indices; `None` if any of them has to be looked at alone:
    /// it is totally reflected, or another surface may be within the tolerance.
    #[inline(always)]
    pub fn refract_here<S: Simd>(
        &self,
        simd: S,
        arrived: &Arrived<S>,
        [before, behind]: [Lanes<S>; 2],
    ) -> Option<Refracted<S>> {
        let &Arrived { origin, direction, t, end, slope: (value, gradient), .. } = arrived;
        let normal = against(simd, arrived.normal, direction);
        let ratio = before / behind;
        let c = -direction.dot(normal);
        let squared = splat(simd, 1.0) - ratio * ratio * (splat(simd, 1.0) - c * c);
        if !squared.simd_gt(0.0).all_true() {
            return None;
        }
        let bent = direction.times(ratio).plus(normal.times(ratio * c - squared.sqrt()));
        let length = bent.length_squared().sqrt();
        let bent = Vec3Lanes { x: bent.x / length, y: bent.y / length, z: bent.z / length };
        if !arrived.is_alone {
            let lengths = origin.taxicab() + t.abs() * direction.taxicab();
            if self.are_near(simd, self.slot(arrived.surface)?, end, lengths) {
                return None;
            }
        }
        let step = value / gradient.dot(normal);
        if !step.abs().simd_lt(f64::INFINITY).all_true() {
            return None;
        }
        let off = normal.times(step);
        let origin = Vec3Lanes { x: end.x - off.x, y: end.y - off.y, z: end.z - off.z };
        let inside = gradient.dot(direction).simd_lt(0.0).to_bitmask();
        Some(Refracted { origin, direction: bent, path: arrived.path + before * t, inside })
    }

    /// True if any other surface may be within the tolerance of a point: the rough test of [`Near::others`].
    #[inline(always)]
    fn are_near<S: Simd>(&self, simd: S, own: usize, at: Vec3Lanes<S>, lengths: Lanes<S>) -> bool {
        let margin = lengths * (1e3 * delta_of(1.0));
        let is_near = self.tree.visit(
            // closures that are not inlined would be compiled for other instructions
            #[inline(always)]
            |bounds| is_around(bounds, at, margin),
            #[inline(always)]
            |k| match k != own && self.surfaces[k].is_near(simd, at, lengths) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            },
        );
        is_near.is_break()
    }
}

impl Placed {
    /// True if the surface may be within the tolerance of some of eight points.
    #[inline(always)]
    fn is_near<S: Simd>(&self, simd: S, at: Vec3Lanes<S>, lengths: Lanes<S>) -> bool {
        let (value, gradient) = self.kernel.value_and_gradient(simd, at);
        let near = (lengths + self.reach) * (2.0 * delta_of(1.0)) * gradient.taxicab();
        !value.abs().simd_gt(near).all_true()
    }
}

/// True if some of eight points are in a box or no farther than a margin from it.
#[inline(always)]
fn is_around<S: Simd>(Bounds { lo, hi }: &Bounds, at: Vec3Lanes<S>, margin: Lanes<S>) -> bool {
    let x = (at.x + margin).simd_ge(lo.x) & (at.x - margin).simd_le(hi.x);
    let y = (at.y + margin).simd_ge(lo.y) & (at.y - margin).simd_le(hi.y);
    let z = (at.z + margin).simd_ge(lo.z) & (at.z - margin).simd_le(hi.z);
    (x & y & z).any_true()
}

impl<S: Simd> Arrived<S> {
    #[inline(always)]
    fn load(
        simd: S,
        kernel: &Kernel,
        (rays, at): (Rays<'_>, usize),
        (t, normal): (&[f64], [&[f64]; 3]),
        path: &[f64],
        surface: SurfaceId,
    ) -> Option<Self> {
        let (origin, direction) = (load(simd, rays.origins, at)?, load(simd, rays.directions, at)?);
        let t = load_one(simd, t, at)?;
        let end = origin.plus(direction.times(t));
        let (normal, slope) = (load(simd, normal, at)?, kernel.value_and_gradient(simd, end));
        let path = load_one(simd, path, at)?;
        Some(Arrived { origin, direction, t, end, normal, slope, path, surface, is_alone: false })
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

/// Room around the box of a sheet, relative to all lengths at hand: far more than any tolerance.
const ROOM: f64 = 1e-9;

impl Around {
    pub fn new(bounds: &Bounds) -> Around {
        let (lo, hi) = (bounds.lo.to_array(), bounds.hi.to_array());
        Around { lo, hi, room: ROOM, size: bounds.size().length(), level: Level::new() }
    }

    /// Those of eight rays that are not all on one side of the box, along some axis, from t = 0 to some times; a bit each.
    pub fn may_touch(&self, rays: Rays<'_>, at: usize, end: &[f64]) -> Option<u64> {
        dispatch!(self.level, simd => self.may_touch_at(simd, rays, at, end))
    }

    #[inline(always)]
    fn may_touch_at<S: Simd>(&self, simd: S, rays: Rays<'_>, at: usize, end: &[f64]) -> Option<u64> {
        let (origin, direction) = (load(simd, rays.origins, at)?, load(simd, rays.directions, at)?);
        let end = Lanes::load_array_ref(simd, end.get(at..)?.first_chunk()?);
        Some(self.may_touch_up_to(simd, origin, direction, end))
    }

    /// [`Around::may_touch`] for rays in lanes.
    #[inline(always)]
    pub fn may_touch_up_to<S: Simd>(
        &self,
        simd: S,
        origin: Vec3Lanes<S>,
        direction: Vec3Lanes<S>,
        end: Lanes<S>,
    ) -> u64 {
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
        may.to_bitmask()
    }
}

/// Normals turned against directions.
#[inline(always)]
fn against<S: Simd>(simd: S, normal: Vec3Lanes<S>, direction: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let one = splat(simd, 1.0);
    normal.times(normal.dot(direction).simd_gt(0.0).select(-one, one))
}

/// Eight numbers of a column from a place on.
#[inline(always)]
pub(crate) fn load_one<S: Simd>(simd: S, column: &[f64], at: usize) -> Option<Lanes<S>> {
    Some(Lanes::load_array_ref(simd, column.get(at..)?.first_chunk()?))
}

/// The same of three columns.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, [x, y, z]: [&[f64]; 3], at: usize) -> Option<Vec3Lanes<S>> {
    Some(Vec3Lanes { x: load_one(simd, x, at)?, y: load_one(simd, y, at)?, z: load_one(simd, z, at)? })
}

#[inline(always)]
pub(crate) fn stored<S: Simd>(v: Vec3Lanes<S>) -> [[f64; LANES]; 3] {
    [v.x.to_array(), v.y.to_array(), v.z.to_array()]
}
