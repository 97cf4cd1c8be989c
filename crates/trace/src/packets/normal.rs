//! Normals of eight hits at a time, by the same operations in the same order as
//! [`rayweave_model::attributes::normal`].

use super::group::{Row, whole};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;
use rayweave_model::Program;
use rayweave_shape::lanes::{LANES, LaneGradient, Lanes, Mask, Vec3Lanes, splat};
use rayweave_shape::surface::{Cylinder, Surface};

/// Method for the normals of a face.
#[derive(Clone, Debug)]
pub(super) enum Slope {
    /// Constant up to the sign.
    Unit(Vec3),
    /// From the centre of a sphere to the point.
    Centre(Vec3),
    /// From the axis of a cylinder, perpendicularly, to the point.
    Axis(Cylinder),
    /// Gradient of any other surface with a SIMD kernel.
    Curved(LaneGradient),
    /// No SIMD kernel: one by one.
    Other,
}

impl Slope {
    /// The methods for all faces of a program, by face number.
    pub fn all(program: &Program) -> Vec<Slope> {
        let of_face = |facet: &rayweave_model::LeafFacet| match &program.surface(facet.surface()).surface {
            Surface::Plane(plane) => unit(plane.normal),
            Surface::Sphere(sphere) => Slope::Centre(sphere.centre),
            Surface::Cylinder(cylinder) => Slope::Axis(*cylinder),
            curved => LaneGradient::of(curved).map_or(Slope::Other, Slope::Curved),
        };
        program.facets().iter().map(of_face).collect()
    }
}

fn unit(gradient: Vec3) -> Slope {
    let largest = gradient.abs().max_element();
    (gradient / largest).try_normalize().map_or(Slope::Other, Slope::Unit)
}

/// Eight hits whose normals are to be computed.
pub(super) struct Hits<S: Simd> {
    pub origin: Vec3Lanes<S>,
    pub direction: Vec3Lanes<S>,
    pub t: Lanes<S>,
    /// The numbers of the faces.
    pub face: Row,
    /// Lanes that leave a region into the world.
    pub leaves: Mask<S>,
    /// Bit mask of the lanes that have a hit.
    pub hit: u64,
}

impl<S: Simd> Hits<S> {
    /// The normals, NaN where there is no hit, and a bit mask of the lanes whose normals must be computed one
    /// by one.
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
                    // a separate function, so that the common cases stay in registers
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

    /// Turns unit gradients into normals. Also returns the lanes that must be computed one by one: `others`
    /// and grazing rays.
    #[inline(always)]
    pub fn oriented(&self, simd: S, normals: Vec3Lanes<S>, others: u64) -> (Vec3Lanes<S>, u64) {
        let slope = normals.dot(self.direction);
        // against the ray where it enters, along the ray where it leaves
        let turns = slope.simd_gt(0.0) ^ self.leaves;
        let one = splat(simd, 1.0);
        let sense = turns.select(-one, one);
        // grazing rays, and points without a tangent plane
        let unsure = !(slope.abs().simd_gt(0.0)) & Mask::from_bitmask(simd, self.hit);
        (normals.times(sense), (others | unsure.to_bitmask()) & self.hit)
    }
}

/// The unit vectors along twice an offset.
#[inline(always)]
fn normalised<S: Simd>(simd: S, offset: Vec3Lanes<S>) -> Vec3Lanes<S> {
    scaled_to_unit(simd, offset.times(splat(simd, 2.0)))
}

/// The unit vectors along gradients, which are first scaled to a largest component of 1.
#[inline(always)]
pub(super) fn scaled_to_unit<S: Simd>(simd: S, gradient: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let Vec3Lanes { x, y, z } = gradient;
    let largest = x.abs().max(y.abs()).max(z.abs());
    let scaled = Vec3Lanes { x: x / largest, y: y / largest, z: z / largest };
    scaled.times(splat(simd, 1.0) / scaled.length_squared().sqrt())
}
