//! Normals of eight hits at a time, by the operations of [`rayweave_model::attributes::normal`] in their order.

use super::group::{Row, whole};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;
use rayweave_model::Program;
use rayweave_shape::lanes::{Gradient, LANES, Lanes, Mask, Vec3Lanes, splat};
use rayweave_shape::surface::{Cylinder, Surface};

/// How the normals of a face are found.
#[derive(Clone, Debug)]
pub(super) enum Slope {
    /// The same everywhere, up to its sense.
    Unit(Vec3),
    /// Along the line from the centre of a sphere.
    Centre(Vec3),
    /// Along the perpendicular from the axis of a cylinder.
    Axis(Cylinder),
    /// Along the gradient of any other surface.
    Curved(Gradient),
    /// One by one.
    Other,
}

impl Slope {
    /// For every face of a program by its number.
    pub fn all(program: &Program) -> Vec<Slope> {
        let of_face = |facet: &rayweave_model::LeafFacet| match &program.surface(facet.surface()).surface {
            Surface::Plane(plane) => unit(plane.normal),
            Surface::Sphere(sphere) => Slope::Centre(sphere.centre),
            Surface::Cylinder(cylinder) => Slope::Axis(*cylinder),
            curved => Gradient::of(curved).map_or(Slope::Other, Slope::Curved),
        };
        program.facets().iter().map(of_face).collect()
    }
}

fn unit(gradient: Vec3) -> Slope {
    let largest = gradient.abs().max_element();
    (gradient / largest).try_normalize().map_or(Slope::Other, Slope::Unit)
}

/// The hits whose normals are asked for.
pub(super) struct Hits<S: Simd> {
    pub origin: Vec3Lanes<S>,
    pub direction: Vec3Lanes<S>,
    pub t: Lanes<S>,
    /// The numbers of the faces.
    pub face: Row,
    /// Those that leave a region for the world.
    pub leaves: Mask<S>,
    /// The lanes that have a hit, a bit each.
    pub hit: u64,
}

impl<S: Simd> Hits<S> {
    /// The normals, NaN where there is no hit, and the lanes whose normals have to be found one by one.
    #[inline(always)]
    pub fn normals(&self, simd: S, slopes: &[Slope]) -> (Vec3Lanes<S>, u64) {
        let mut normals = Vec3Lanes::splat(simd, Vec3::NAN);
        let (mut left, mut others) = (self.hit, 0);
        let faces = Lanes::load_array_ref(simd, &self.face.0);
        let place = self.origin.plus(self.direction.times(self.t));
        while left != 0 {
            let face = self.face.0[left.trailing_zeros() as usize % LANES];
            let here = faces.simd_eq(splat(simd, face));
            let gradient = match &slopes[whole(face) as usize] {
                Slope::Unit(unit) => Some(Vec3Lanes::splat(simd, *unit)),
                Slope::Centre(centre) => Some(normalised(simd, place.minus_all(*centre))),
                Slope::Axis(axis) => {
                    Some(normalised(simd, place.minus_all(axis.point).perpendicular(axis.axis)))
                }
                Slope::Curved(gradient) => {
                    // a function of its own: what is asked most often stays in registers
                    let along = simd.vectorize(
                        #[inline(always)]
                        || scaled_to_unit(simd, gradient.at(simd, place)),
                    );
                    Some(along)
                }
                Slope::Other => None,
            };
            match gradient {
                Some(unit) => normals = normals.or_where(here, unit),
                None => others |= left & here.to_bitmask(),
            }
            left &= !here.to_bitmask();
        }
        self.oriented(simd, normals, others)
    }

    /// Unit gradients as normals; the lanes that have to be asked one by one, `others` and those that only graze.
    #[inline(always)]
    pub fn oriented(&self, simd: S, normals: Vec3Lanes<S>, others: u64) -> (Vec3Lanes<S>, u64) {
        let slope = normals.dot(self.direction);
        // against the ray where it enters, along it where it leaves
        let turns = slope.simd_gt(0.0) ^ self.leaves;
        let one = splat(simd, 1.0);
        let sense = turns.select(-one, one);
        // a ray that only grazes, and what has no tangent plane
        let unsure = !(slope.abs().simd_gt(0.0)) & Mask::from_bitmask(simd, self.hit);
        (normals.times(sense), (others | unsure.to_bitmask()) & self.hit)
    }
}

/// The unit vectors along twice an offset.
#[inline(always)]
fn normalised<S: Simd>(simd: S, offset: Vec3Lanes<S>) -> Vec3Lanes<S> {
    scaled_to_unit(simd, offset.times(splat(simd, 2.0)))
}

/// The unit vectors along gradients, first brought to a largest component of 1.
#[inline(always)]
pub(super) fn scaled_to_unit<S: Simd>(simd: S, gradient: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let Vec3Lanes { x, y, z } = gradient;
    let largest = x.abs().max(y.abs()).max(z.abs());
    let scaled = Vec3Lanes { x: x / largest, y: y / largest, z: z / largest };
    scaled.times(splat(simd, 1.0) / scaled.length_squared().sqrt())
}
