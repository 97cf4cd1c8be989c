//! Eight photons at boundaries, and what the kernels of all kinds of boundaries have in common: the contact with a plane or a
//! sphere, and the departure.

use super::process::GRAZING;
use crate::draws::Words;
use crate::rows::{Row, load, minus, store, vector};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;
use rayweave_optics::start_surfaces::{LaneContact, LaneShape};
use rayweave_shape::lanes::{LANES, Lanes, Mask, Vec3Lanes, splat};

/// Planes and spheres, and the lengths for which their boxes hold.
pub(super) type Contacts<'c> = (&'c [LaneContact], f64);

/// Eight photons: before the process, then after it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Group {
    pub direction: [Row; 3],
    pub polarisation: [Row; 3],
    pub normal: [Row; 3],
    /// At interfaces the indices in front of them and behind them; at painted surfaces those of
    /// [`Reflection::values`](super::Reflection::values).
    pub values: [Row; 3],
    /// The counters of the random numbers.
    pub counters: [Words; 3],
    pub position: [Row; 3],
    /// The time of the crossing.
    pub t: Row,
    /// The place of the surface in the list of planes and spheres, for photons at one.
    pub contact: [u32; LANES],
    /// Bit masks of the photons at such surfaces, and of those that move along and against the gradient there.
    pub has_contact: u64,
    pub rising: u64,
    pub falling: u64,
    /// Bit mask of the photons at points of these surfaces without other surfaces in reach.
    pub alone: u64,
    /// Bit masks of the photons with the first and with the second of the events of a kind; the others have the third.
    pub events: [u64; 2],
    /// Bit masks of the photons that the surface does not reflect, and of those that it detects.
    pub lost: u64,
    pub detected: u64,
    /// Bit mask of the photons behind the boundary.
    pub is_behind: u64,
    /// Bit mask of the photons that need the scalar process.
    pub unsure: u64,
}

#[inline(always)]
pub(super) fn normalised<S: Simd>(simd: S, vector: Vec3Lanes<S>) -> Vec3Lanes<S> {
    vector.times(splat(simd, 1.0) / vector.length_squared().sqrt())
}

/// [`mirrored`](super::process::mirrored) for eight vectors.
#[inline(always)]
pub(super) fn mirrored<S: Simd>(vector: Vec3Lanes<S>, normal: Vec3Lanes<S>) -> Vec3Lanes<S> {
    minus(vector, normal.times(vector.dot(normal) * 2.0))
}

/// [`renormalised`](super::renormalised) for eight vectors, and the lanes in which they are unit vectors up to rounding.
#[inline(always)]
pub(super) fn renormalised<S: Simd>(simd: S, vector: Vec3Lanes<S>) -> (Vec3Lanes<S>, Mask<S>) {
    let square = vector.length_squared();
    let is_near = (square - 1.0).abs().simd_lt(splat(simd, 1e-8));
    (vector.times(splat(simd, 1.5) - square * 0.5), is_near)
}

/// The image of a vector under the identity matrix, by the operations of a product: without negative zeros.
#[inline(always)]
pub(super) fn unturned<S: Simd>(v: Vec3Lanes<S>) -> Vec3Lanes<S> {
    Vec3Lanes {
        x: v.x + v.y * 0.0 + v.z * 0.0,
        y: v.x * 0.0 + v.y + v.z * 0.0,
        z: v.x * 0.0 + v.y * 0.0 + v.z,
    }
}

/// A gradient divided by its largest component, as that of a [`Contact`](rayweave_optics::start_surfaces::Contact) in the world.
#[inline(always)]
fn outer_gradient<S: Simd>(simd: S, v: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let (largest, zero) = (v.x.abs().max(v.y.abs().max(v.z.abs())), splat(simd, 0.0));
    let is_some = largest.simd_gt(zero);
    let divided = |component: Lanes<S>| is_some.select(component / largest, zero);
    Vec3Lanes { x: divided(v.x), y: divided(v.y), z: divided(v.z) }
}

impl Group {
    /// Projects the photons onto their planes and spheres, as [`Contact`](rayweave_optics::start_surfaces::Contact).
    #[inline(always)]
    pub fn touch<S: Simd>(&mut self, simd: S, (contacts, alone_lengths): Contacts<'_>) {
        let (mut rows, mut shifted, mut spheres) = ([[0.0; LANES]; 16], 0u64, 0u64);
        for lane in 0..LANES {
            let Some(contact) = contacts.get(self.contact[lane] as usize) else { continue };
            let (vector, number, gradient) = match contact.shape {
                LaneShape::Plane { normal, offset, gradient } => (normal, offset, gradient),
                LaneShape::Sphere { centre, square } => (centre, square, Vec3::ZERO),
            };
            let shift = contact.shift.unwrap_or(Vec3::ZERO);
            for k in 0..3 {
                rows[k][lane] = vector[k];
                rows[3 + k][lane] = gradient[k];
                rows[6 + k][lane] = shift[k];
                rows[9 + k][lane] = contact.alone.lo[k];
                rows[12 + k][lane] = contact.alone.hi[k];
            }
            rows[15][lane] = number;
            shifted |= u64::from(contact.shift.is_some()) << lane;
            spheres |= u64::from(matches!(contact.shape, LaneShape::Sphere { .. })) << lane;
        }
        let at = |k: usize| Vec3Lanes {
            x: load(simd, &rows[k]),
            y: load(simd, &rows[k + 1]),
            z: load(simd, &rows[k + 2]),
        };
        let [given, gradient, shift, low, high] = [at(0), at(3), at(6), at(9), at(12)];
        let (origin, direction) = (vector(simd, &self.position), vector(simd, &self.direction));
        let (t, number) = (load(simd, &self.t), load(simd, &rows[15]));
        let shifted = Mask::from_bitmask(simd, shifted);
        let local_origin = origin.or_where(shifted, unturned(origin).plus(shift));
        let local_direction = direction.or_where(shifted, unturned(direction));
        let local = local_origin.plus(local_direction.times(t));
        let (mut value, mut slope) = (local.dot(given) - number, given);
        let mut gradient = gradient;
        if spheres & self.has_contact != 0 {
            let spheres = Mask::from_bitmask(simd, spheres);
            let offset = minus(local, given);
            let outward = offset.times(splat(simd, 2.0));
            value = spheres.select(offset.length_squared() - number, value);
            slope = slope.or_where(spheres, outward);
            let outer = outer_gradient(simd, outward.or_where(shifted, unturned(outward)));
            gradient = gradient.or_where(spheres, outer);
        }
        let out = vector(simd, &self.normal);
        let along = out.or_where(shifted, unturned(out));
        let step = value / slope.dot(along);
        let is_finite = step.abs().simd_lt(splat(simd, f64::INFINITY));
        let point = origin.plus(direction.times(t));
        let length = |v: Vec3Lanes<S>| v.x.abs() + v.y.abs() + v.z.abs();
        let is_near = (length(origin) + t.abs() * length(direction)).simd_le(splat(simd, alone_lengths));
        let is_above = low.x.simd_le(point.x) & low.y.simd_le(point.y) & low.z.simd_le(point.z);
        let is_below = point.x.simd_le(high.x) & point.y.simd_le(high.y) & point.z.simd_le(high.z);
        self.alone = (is_near & is_above & is_below).to_bitmask();
        let rise = gradient.dot(direction);
        let zero = splat(simd, 0.0);
        self.rising = rise.simd_gt(zero).to_bitmask();
        self.falling = rise.simd_lt(zero).to_bitmask();
        store(point.or_where(is_finite, minus(point, out.times(step))), &mut self.position);
    }

    /// Stores the directions and polarisations after the process; `f` are the normals. Photons whose directions are not on their side
    /// of the boundary need the scalar process.
    #[inline(always)]
    pub fn leave<S: Simd>(
        &mut self,
        simd: S,
        f: Vec3Lanes<S>,
        (direction, polarisation): (Vec3Lanes<S>, Vec3Lanes<S>),
        is_through: Mask<S>,
    ) {
        // as `Process::has_left`
        let (rise, zero) = (direction.dot(f), splat(simd, 0.0));
        let has_left =
            (is_through & rise.simd_le(zero)) | (!is_through & rise.simd_ge(splat(simd, -GRAZING)));
        let (direction, is_unit) = renormalised(simd, direction);
        let (polarisation, is_unit_too) = renormalised(simd, polarisation);
        self.unsure = !(has_left & is_unit & is_unit_too).to_bitmask();
        self.is_behind = direction.dot(f).simd_lt(zero).to_bitmask();
        store(direction, &mut self.direction);
        store(polarisation, &mut self.polarisation);
    }
}
