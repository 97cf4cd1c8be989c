//! Transforms of eight rays into the frames of placed solids, and normals of hits there.

use super::group::whole;
use super::normal::{Slope, Slopes, scaled_to_unit};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_bvh::BundleSlabs;
use rayweave_math::{Affine, Vec3};
use rayweave_model::{MARGIN, Place, Program};
use rayweave_shape::lanes::{LANES, LaneLimits, LaneRay, Lanes, Uncertain, Vec3Lanes, splat};
use rayweave_shape::surface::Surface;

/// A transform on the path into the frame of a placed solid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    place: Place,
    /// Largest factor by which it scales a length: the norm of the linear part.
    norm: f64,
}

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
        for Step { place, norm } in steps {
            let down = &place.local_from_world;
            ray = Carried {
                origin: turned(down, ray.origin).plus_all(down.translation),
                direction: turned(down, ray.direction),
                magnitude: (ray.origin.taxicab() + place.path + ray.magnitude) * *norm,
            };
        }
        ray
    }

    /// Like [`Carried::new`], with transforms of its own for each ray: equally many for all.
    #[inline(always)]
    pub fn each(simd: S, origin: Vec3Lanes<S>, direction: Vec3Lanes<S>, steps: &[&[Step]; LANES]) -> Self {
        let mut ray = Carried { origin, direction, magnitude: splat(simd, 0.0) };
        for depth in 0..steps[0].len() {
            let mut columns = [[0.0; LANES]; 14];
            for (lane, steps) in steps.iter().enumerate() {
                let Some(step) = steps.get(depth) else { continue };
                let Affine { linear, translation } = &step.place.local_from_world;
                let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
                let values = [x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z];
                for k in 0..9 {
                    columns[k][lane] = values[k];
                }
                (columns[9][lane], columns[10][lane]) = (translation.x, translation.y);
                (columns[11][lane], columns[12][lane]) = (translation.z, step.place.path);
                columns[13][lane] = step.norm;
            }
            let load = |k: usize| Lanes::load_array_ref(simd, &columns[k]);
            let turned = |v: Vec3Lanes<S>| {
                let row = |k: usize| v.dot(Vec3Lanes { x: load(k), y: load(k + 1), z: load(k + 2) });
                Vec3Lanes { x: row(0), y: row(3), z: row(6) }
            };
            let [x, y, z, path, norm] = [load(9), load(10), load(11), load(12), load(13)];
            ray = Carried {
                origin: turned(ray.origin).plus(Vec3Lanes { x, y, z }),
                direction: turned(ray.direction),
                magnitude: (ray.origin.taxicab() + path + ray.magnitude) * norm,
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
fn turned<S: Simd>(map: &Affine, v: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let linear = &map.linear;
    v.dots([linear.row(0), linear.row(1), linear.row(2)])
}

impl Step {
    pub fn new(place: Place) -> Step {
        Step { place, norm: place.local_from_world.linear_norm() }
    }

    /// The image of a point.
    pub fn point(&self, point: Vec3) -> Vec3 {
        self.place.local_from_world.point(point)
    }

    /// [`Step::back`] for one gradient.
    fn back_one(&self, gradient: Vec3) -> Vec3 {
        let down = &self.place.local_from_world.linear;
        Vec3::from_array([down.x_axis, down.y_axis, down.z_axis].map(|axis| gradient.dot(axis)))
    }

    /// Transforms gradients to the outer frame, by the transpose.
    #[inline(always)]
    fn back<S: Simd>(&self, gradient: Vec3Lanes<S>) -> Vec3Lanes<S> {
        let down = &self.place.local_from_world.linear;
        gradient.dots([down.x_axis, down.y_axis, down.z_axis])
    }
}

/// The unit gradient, in the frame of the world, of a plane with this normal, by the operations of [`unit_gradient`].
pub(super) fn unit_of_plane(normal: Vec3, steps: &[Step]) -> Vec3 {
    let gradient = steps.iter().rev().fold(normal, |gradient, step| step.back_one(gradient));
    let scaled = gradient / gradient.abs().max_element();
    scaled * (1.0 / scaled.length_squared().sqrt())
}

/// The unit gradients, in the frame of the world, of a face hit by rays at times `t`, by the operations of
/// [`rayweave_model::attributes::world_gradient`] and of its normalisation. `None` for faces whose normals
/// are computed one by one.
#[inline(always)]
pub(super) fn unit_gradient<S: Simd>(
    simd: S,
    (program, slopes): (&Program, &Slopes),
    face: f64,
    ray: &Carried<S>,
    t: Lanes<S>,
    steps: &[Step],
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
    for step in steps.iter().rev() {
        gradient = step.back(gradient);
    }
    Some(scaled_to_unit(simd, gradient))
}
