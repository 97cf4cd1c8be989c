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

/// Methods for the normals of all faces of a program, by face number.
#[derive(Clone, Debug)]
pub(super) struct Slopes {
    pub methods: Vec<Slope>,
    simple: Vec<Simple>,
}

/// The data of the three frequent methods, in one form for all, so that eight faces can be processed at a time.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Simple {
    /// The unit normal, the centre, or a point of the axis.
    point: [f64; 3],
    /// The axis.
    axis: [f64; 3],
    kind: f64,
}

impl Simple {
    const UNIT: f64 = 0.0;
    const CENTRE: f64 = 1.0;
    const AXIS: f64 = 2.0;
    const OTHER: f64 = 3.0;

    fn of(slope: &Slope) -> Simple {
        let (point, axis, kind) = match slope {
            Slope::Unit(normal) => (*normal, Vec3::ZERO, Simple::UNIT),
            Slope::Centre(centre) => (*centre, Vec3::ZERO, Simple::CENTRE),
            Slope::Axis(cylinder) => (cylinder.point, cylinder.axis, Simple::AXIS),
            Slope::Curved(_) | Slope::Other => (Vec3::ZERO, Vec3::ZERO, Simple::OTHER),
        };
        Simple { point: point.to_array(), axis: axis.to_array(), kind }
    }
}

impl Slopes {
    pub fn new(program: &Program) -> Slopes {
        let of_face = |facet: &rayweave_model::LeafFacet| match &program.surface(facet.surface()).surface {
            Surface::Plane(plane) => unit(plane.normal),
            Surface::Sphere(sphere) => Slope::Centre(sphere.centre),
            Surface::Cylinder(cylinder) => Slope::Axis(*cylinder),
            curved => LaneGradient::of(curved).map_or(Slope::Other, Slope::Curved),
        };
        let methods: Vec<Slope> = program.facets().iter().map(of_face).collect();
        Slopes { simple: methods.iter().map(Simple::of).collect(), methods }
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
    pub fn normals(&self, simd: S, slopes: &Slopes) -> (Vec3Lanes<S>, u64) {
        let place = self.origin.plus(self.direction.times(self.t));
        let simple: [&Simple; LANES] = std::array::from_fn(|lane| {
            // any face where there is no hit
            let face = whole(self.face.0[lane]).max(0) as usize;
            &slopes.simple[face]
        });
        let kind = Lanes::load_array(simd, std::array::from_fn(|lane| simple[lane].kind));
        let point = gathered(simd, |lane, k| simple[lane].point[k]);
        let is_unit = kind.simd_eq(Simple::UNIT);
        let mut normals = point;
        if !is_unit.all_true() {
            let mut offset = minus(place, point);
            let is_axis = kind.simd_eq(Simple::AXIS);
            if is_axis.any_true() {
                let axis = gathered(simd, |lane, k| simple[lane].axis[k]);
                let across = minus(offset, axis.times(offset.dot(axis)));
                offset = offset.or_where(is_axis, across);
            }
            normals = normalised(simd, offset).or_where(is_unit, point);
        }
        let hit = Mask::from_bitmask(simd, self.hit);
        normals = Vec3Lanes::splat(simd, Vec3::NAN).or_where(hit, normals);
        let left = kind.simd_eq(Simple::OTHER).to_bitmask() & self.hit;
        let others =
            if left == 0 { 0 } else { self.curved(simd, &slopes.methods, left, place, &mut normals) };
        self.oriented(simd, normals, others)
    }

    /// Computes the unit gradients of the lanes of a bit mask, face by face. Returns the lanes that must be computed one by
    /// one.
    #[inline(always)]
    fn curved(
        &self,
        simd: S,
        methods: &[Slope],
        mut left: u64,
        place: Vec3Lanes<S>,
        normals: &mut Vec3Lanes<S>,
    ) -> u64 {
        let (faces, mut others) = (Lanes::load_array_ref(simd, &self.face.0), 0);
        while left != 0 {
            let face = self.face.0[left.trailing_zeros() as usize % LANES];
            let here = faces.simd_eq(splat(simd, face));
            if let Slope::Curved(gradient) = &methods[whole(face) as usize] {
                // a separate function, so that the common cases stay in registers
                let along = simd.vectorize(
                    #[inline(always)]
                    || scaled_to_unit(simd, gradient.at(simd, place)),
                );
                *normals = normals.or_where(here, along);
            } else {
                others |= left & here.to_bitmask();
            }
            left &= !here.to_bitmask();
        }
        others
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

/// A vector for each lane, component by component.
#[inline(always)]
fn gathered<S: Simd>(simd: S, component: impl Fn(usize, usize) -> f64) -> Vec3Lanes<S> {
    let [x, y, z] = [0, 1, 2].map(
        #[inline(always)]
        |k| {
            let values: [f64; LANES] = std::array::from_fn(|lane| component(lane, k));
            Lanes::load_array(simd, values)
        },
    );
    Vec3Lanes { x, y, z }
}

#[inline(always)]
fn minus<S: Simd>(a: Vec3Lanes<S>, b: Vec3Lanes<S>) -> Vec3Lanes<S> {
    Vec3Lanes { x: a.x - b.x, y: a.y - b.y, z: a.z - b.z }
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
