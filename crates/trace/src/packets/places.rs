//! Transforms of eight rays into the frames of placed solids, and normals of hits there.

use super::group::whole;
use super::normal::{Slope, Slopes, scaled_to_unit};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_bvh::BundleSlabs;
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_model::{MARGIN, Place, Program};
use rayweave_shape::lanes::{LANES, LaneLimits, LaneRay, Lanes, Uncertain, Vec3Lanes, splat};
use rayweave_shape::surface::Surface;
use std::collections::HashMap;
use std::sync::Arc;

/// A transform on the path into the frame of a placed solid, in less than a cache line: among many solids, rays wait for it.
#[derive(Clone, Debug)]
pub(super) struct Step {
    translation: Vec3,
    /// See [`Place::path`].
    path: f64,
    /// Largest factor by which it scales a length: the norm of the linear part.
    norm: f64,
    /// Copies that are turned alike share it.
    linear: Arc<Mat3>,
}

/// The distinct linear parts of transforms.
#[derive(Clone, Debug, Default)]
pub(super) struct LinearParts(HashMap<[u64; 9], Arc<Mat3>>);

/// Eight rays in the frame of a placed solid.
#[derive(Clone, Copy)]
pub(super) struct Carried<S: Simd> {
    pub origin: Vec3Lanes<S>,
    pub direction: Vec3Lanes<S>,
    /// The amount that the transforms add to the magnitude bound of every surface.
    magnitude: Lanes<S>,
}

impl<S: Simd> Carried<S> {
    /// Applies the transforms, outermost first, as [`rayweave_model::carried`] does. The amount added to
    /// magnitude bounds may be slightly larger than there.
    #[inline(always)]
    pub fn new(simd: S, origin: Vec3Lanes<S>, direction: Vec3Lanes<S>, steps: &[Step]) -> Self {
        let mut ray = Carried { origin, direction, magnitude: splat(simd, 0.0) };
        for Step { translation, path, norm, linear } in steps {
            ray = Carried {
                origin: turned(linear, ray.origin).plus_all(*translation),
                direction: turned(linear, ray.direction),
                magnitude: (ray.origin.taxicab() + *path + ray.magnitude) * *norm,
            };
        }
        ray
    }

    /// Like [`Carried::new`], with transforms of its own for each ray: equally many for all.
    #[inline(always)]
    pub fn each(simd: S, origin: Vec3Lanes<S>, direction: Vec3Lanes<S>, steps: &[&[Step]; LANES]) -> Self {
        let mut ray = Carried { origin, direction, magnitude: splat(simd, 0.0) };
        for depth in 0..steps[0].len() {
            let here = at_depth(steps, depth);
            let [x, y, z, path] = gathered(simd, &here, |Step { translation, path, .. }| {
                let Vec3 { x, y, z } = *translation;
                [x, y, z, *path]
            });
            let shift = Vec3Lanes { x, y, z };
            let lengths = ray.origin.taxicab() + path + ray.magnitude;
            // copies are rarely turned: a translation gathers less
            ray = if is_parallel(&here) {
                let down = &here[0].linear;
                Carried {
                    origin: turned(down, ray.origin).plus(shift),
                    direction: turned(down, ray.direction),
                    magnitude: lengths * here[0].norm,
                }
            } else {
                let [xx, xy, xz, yx, yy, yz, zx, zy, zz, norm] = gathered(simd, &here, |step| {
                    let linear = &step.linear;
                    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
                    [x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z, step.norm]
                });
                let x = Vec3Lanes { x: xx, y: xy, z: xz };
                let y = Vec3Lanes { x: yx, y: yy, z: yz };
                let z = Vec3Lanes { x: zx, y: zy, z: zz };
                Carried {
                    origin: dots(ray.origin, [x, y, z]).plus(shift),
                    direction: dots(ray.direction, [x, y, z]),
                    magnitude: lengths * norm,
                }
            };
        }
        ray
    }

    /// Prepares slab tests against the boxes of a group with this condition.
    #[inline(always)]
    pub fn slabs(&self, simd: S, condition: f64) -> BundleSlabs<S> {
        let margin = (self.origin.taxicab() + self.magnitude) * (condition * MARGIN);
        slabs(simd, self.origin, self.direction, margin)
    }

    /// Prepares the rays for the kernels.
    #[inline(always)]
    pub fn ready(&self, simd: S, limits: &LaneLimits) -> (LaneRay<S>, Uncertain<S>) {
        LaneRay::carried(simd, self.origin, self.direction, limits, self.magnitude)
    }
}

/// Prepares slab tests of rays against boxes that are grown by `margin`.
#[inline(always)]
pub(super) fn slabs<S: Simd>(
    simd: S,
    origin: Vec3Lanes<S>,
    direction: Vec3Lanes<S>,
    margin: Lanes<S>,
) -> BundleSlabs<S> {
    let components = |v: Vec3Lanes<S>| [v.x, v.y, v.z];
    BundleSlabs::new(simd, components(origin), components(direction), margin)
}

/// The images of vectors, as [`Affine::vector`].
#[inline(always)]
fn turned<S: Simd>(linear: &Mat3, v: Vec3Lanes<S>) -> Vec3Lanes<S> {
    v.dots([linear.row(0), linear.row(1), linear.row(2)])
}

/// One transform for each of eight rays, from their lists: those at a depth.
#[inline(always)]
fn at_depth<'s>(steps: &[&'s [Step]; LANES], depth: usize) -> [&'s Step; LANES] {
    let mut here = [&steps[0][depth]; LANES];
    for lane in 1..LANES {
        if let Some(step) = steps[lane].get(depth) {
            here[lane] = step;
        }
    }
    here
}

/// True if the transforms have one linear part.
#[inline(always)]
fn is_parallel(steps: &[&Step; LANES]) -> bool {
    let mut is_same = true;
    for step in steps {
        is_same &= Arc::ptr_eq(&step.linear, &steps[0].linear);
    }
    is_same
}

/// Some numbers of the transforms of eight rays, each in lanes.
#[inline(always)]
fn gathered<S: Simd, const N: usize>(
    simd: S,
    steps: &[&Step; LANES],
    values: impl Fn(&Step) -> [f64; N],
) -> [Lanes<S>; N] {
    let mut columns = [[0.0; LANES]; N];
    for lane in 0..LANES {
        let values = values(steps[lane]);
        for k in 0..N {
            columns[k][lane] = values[k];
        }
    }
    // no `map`, whose closure would not be compiled for the instruction set
    let mut lanes = [splat(simd, 0.0); N];
    for k in 0..N {
        lanes[k] = Lanes::load_array_ref(simd, &columns[k]);
    }
    lanes
}

/// Dot products with three vectors of each ray.
#[inline(always)]
fn dots<S: Simd>(v: Vec3Lanes<S>, [x, y, z]: [Vec3Lanes<S>; 3]) -> Vec3Lanes<S> {
    Vec3Lanes { x: v.dot(x), y: v.dot(y), z: v.dot(z) }
}

/// Upper bound, up to rounding, of the factor by which a map lengthens vectors, sharp for maps that are not sheared: the square
/// root of a row sum of A^T A bounds its greatest eigenvalue (Gershgorin 1931).
pub(super) fn stretch(map: &Affine) -> f64 {
    let square = map.linear.transpose() * map.linear;
    let rows = [square.x_axis, square.y_axis, square.z_axis].map(|row| row.abs().element_sum());
    rows.into_iter().fold(0.0, f64::max).sqrt()
}

impl Step {
    pub fn new(place: Place, parts: &mut LinearParts) -> Step {
        let Affine { linear, translation } = place.local_from_world;
        let key = std::array::from_fn(|k| linear.col(k / 3)[k % 3].to_bits());
        let linear = parts.0.entry(key).or_insert_with(|| Arc::new(linear)).clone();
        Step { translation, path: place.path, norm: place.local_from_world.linear_norm(), linear }
    }

    /// See [`stretch`].
    pub fn stretch(&self) -> f64 {
        stretch(&self.map())
    }

    /// See [`Place::path`].
    pub fn path(&self) -> f64 {
        self.path
    }

    fn map(&self) -> Affine {
        Affine { linear: *self.linear, translation: self.translation }
    }

    /// The translation, if it is nothing else.
    pub fn translation_only(&self) -> Option<Vec3> {
        (*self.linear == Mat3::IDENTITY).then_some(self.translation)
    }

    /// The image of a point.
    pub fn point(&self, point: Vec3) -> Vec3 {
        self.map().point(point)
    }

    /// Transforms a gradient to the outer frame, by the transpose.
    fn back_one(&self, gradient: Vec3) -> Vec3 {
        let down = &self.linear;
        Vec3::from_array([down.x_axis, down.y_axis, down.z_axis].map(|axis| gradient.dot(axis)))
    }

    /// Transforms gradients to the outer frames, by the transposes.
    #[inline(always)]
    fn back<S: Simd>(simd: S, steps: &[&Step; LANES], gradient: Vec3Lanes<S>) -> Vec3Lanes<S> {
        if is_parallel(steps) {
            let down = &steps[0].linear;
            return gradient.dots([down.x_axis, down.y_axis, down.z_axis]);
        }
        let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = gathered(simd, steps, |step| {
            let down = &step.linear;
            let [x, y, z] = [down.x_axis, down.y_axis, down.z_axis];
            [x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z]
        });
        let x = Vec3Lanes { x: xx, y: xy, z: xz };
        let y = Vec3Lanes { x: yx, y: yy, z: yz };
        let z = Vec3Lanes { x: zx, y: zy, z: zz };
        dots(gradient, [x, y, z])
    }
}

/// The unit gradient, in the frame of the world, of a plane with this normal, by the operations of [`unit_gradient`].
pub(super) fn unit_of_plane(normal: Vec3, steps: &[Step]) -> Vec3 {
    let gradient = steps.iter().rev().fold(normal, |gradient, step| step.back_one(gradient));
    let scaled = gradient / gradient.abs().max_element();
    scaled * (1.0 / scaled.length_squared().sqrt())
}

/// The unit gradients, in the frame of the world, of a face hit by rays at times `t`, by the operations of
/// [`rayweave_model::attributes::world_gradient`] and of its normalisation. Each ray hits the face of a copy of its own.
/// `None` for faces whose normals are computed one by one.
#[inline(always)]
pub(super) fn unit_gradient<S: Simd>(
    simd: S,
    (program, slopes): (&Program, &Slopes),
    face: f64,
    ray: &Carried<S>,
    t: Lanes<S>,
    steps: &[&[Step]; LANES],
) -> Option<Vec3Lanes<S>> {
    let place = ray.origin.plus(ray.direction.times(t));
    let two = splat(simd, 2.0);
    let mut gradient = match &slopes.methods[whole(face) as usize] {
        Slope::Centre(centre) => place.minus_all(*centre).times(two),
        Slope::Axis(axis) => place.minus_all(axis.point).perpendicular(axis.axis).times(two),
        // a separate function, so that the common cases stay in registers
        Slope::Curved(gradient) => simd.vectorize(
            #[inline(always)]
            || gradient.at(simd, place),
        ),
        Slope::Unit(_) | Slope::Other => {
            let facet = &program.facets()[whole(face) as usize];
            let Surface::Plane(plane) = &program.surface(facet.surface()).surface else { return None };
            Vec3Lanes::splat(simd, plane.normal)
        }
    };
    for depth in (0..steps[0].len()).rev() {
        gradient = Step::back(simd, &at_depth(steps, depth), gradient);
    }
    Some(scaled_to_unit(simd, gradient))
}
