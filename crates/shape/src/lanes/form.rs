//! Kernels for eight leaves of one form at a time: a different leaf in each lane.
//!
//! Kernels for bundles have one surface for all lanes and a different ray in each. Here the parameters of the surfaces are in
//! lanes too, so that a ray that passes many leaves of a large model fills its lanes with these. The arithmetic is the same.

use super::axis;
use super::cone::{self, ConeLanes};
use super::facet::{
    CurvedSide, Kernel, LaneFacet, SlabTimes, certain_dot, cylinder_times, narrow_to_plane, or_empty,
};
use super::quadric::QuadricLanes;
use super::ray::{LaneRay, Uncertain};
use super::span::{Gap, LaneSpan};
use super::vector::{LANES, Lanes, Vec3Lanes, splat};
use crate::surface::{Quadric, cylinder, sphere};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;

/// Parameters of a leaf in memory, half a cache line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct FormRow([f64; WIDTH]);

/// The numbers in a row.
const WIDTH: usize = 4;

/// The largest number of parameters of a facet: those of a quadric.
const MOST: usize = 5 * WIDTH;

/// The form of a leaf that is convex, or convex less one gap on each ray (a tube): what remains of its facets without their
/// parameters. Leaves of one form share their kernels.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafForm {
    facets: Vec<FacetForm>,
    /// True if one of the facets may cut a gap out of the leaf.
    can_gap: bool,
    /// The number of rows of the parameters of a leaf.
    rows: usize,
}

/// A facet, or two opposite faces of a box, of all leaves of a form.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FacetForm {
    kernel: KernelForm,
    /// The number of the face within the leaf; for two faces of a box, those of the lower and the higher one.
    faces: [f64; 2],
    /// The row and the column of its first parameter; the others follow in the same row or, after its end, in the next.
    at: (usize, usize),
}

/// A kernel without its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
enum KernelForm {
    Sphere { inside: bool },
    AxisCylinder { axis: u8, inside: bool },
    Cylinder { inside: bool },
    Cone,
    Quadric { is_ruled: bool, is_one_piece: bool },
    AxisSlab { axis: u8 },
    Slab,
    AxisPlane { axis: u8, sign: f64, inside: bool },
    Plane { inside: bool },
}

impl LeafForm {
    /// The form of a leaf with these facets, whose faces are numbered from `first` on; appends its parameters. `None` if a kernel
    /// has no such form, or if more than one facet may cut a gap out of the leaf.
    pub fn of(facets: &[LaneFacet], first: f64, parameters: &mut Vec<FormRow>) -> Option<LeafForm> {
        let known = parameters.len();
        let mut form = LeafForm { facets: Vec::with_capacity(facets.len()), can_gap: false, rows: 0 };
        for facet in facets {
            let found = facet_form(facet).filter(|(kernel, ..)| !kernel.can_gap() || !form.can_gap);
            let Some((kernel, faces, numbers)) = found else {
                parameters.truncate(known);
                return None;
            };
            if kernel.can_gap() {
                form.can_gap = true;
            }
            let (width, last) = (kernel.width(), form.facets.last());
            let end = last.map_or(WIDTH, |last| last.at.1 + last.kernel.width());
            let is_same_row = end + width <= WIDTH;
            let column = if is_same_row { end } else { 0 };
            let row = parameters.len() - known - usize::from(is_same_row);
            parameters.resize(known + row + (column + width).div_ceil(WIDTH), FormRow::default());
            for (k, &number) in numbers[..width].iter().enumerate() {
                parameters[known + row + (column + k) / WIDTH].0[(column + k) % WIDTH] = number;
            }
            form.facets.push(FacetForm { kernel, faces: faces.map(|face| face - first), at: (row, column) });
        }
        form.rows = parameters.len() - known;
        Some(form)
    }

    /// The number of rows of the parameters of a leaf.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// True if there may be a gap in the spans.
    pub fn can_gap(&self) -> bool {
        self.can_gap
    }

    /// The spans of rays in eight leaves, given by their parameters, with the numbers of faces within the leaves, and the gaps in
    /// the spans with the number of their face, if there can be any.
    #[inline(always)]
    pub fn spans<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        leaves: &[&[FormRow]; LANES],
        uncertain: &mut Uncertain<S>,
    ) -> (LaneSpan<S>, Option<(Gap<S>, f64)>) {
        let (mut span, mut gaps) = (LaneSpan::line(simd), None);
        for facet in &self.facets {
            let gap = facet.narrow(simd, ray, leaves, &mut span, uncertain);
            if let Some(gap) = gap {
                gaps = Some((gap, facet.faces[0]));
            }
        }
        (span, gaps)
    }
}

/// The form of a facet, its faces, and its parameters.
fn facet_form(facet: &LaneFacet) -> Option<(KernelForm, [f64; 2], [f64; MOST])> {
    let (inside, is_one_piece) = (facet.inside, facet.is_one_piece);
    let mut numbers = [0.0; MOST];
    let mut put = |values: &[f64]| numbers[..values.len()].copy_from_slice(values);
    let mut faces = [facet.face; 2];
    let form = match &facet.kernel {
        Kernel::Sphere(sphere) => {
            put(&row(sphere.centre, sphere.radius));
            KernelForm::Sphere { inside }
        }
        Kernel::AxisCylinder(cylinder) => {
            put(&[cylinder.point[0], cylinder.point[1], cylinder.radius]);
            KernelForm::AxisCylinder { axis: cylinder.axis, inside }
        }
        Kernel::Cylinder(cylinder) => {
            put([row(cylinder.point, cylinder.radius), row(cylinder.axis, 0.0)].as_flattened());
            KernelForm::Cylinder { inside }
        }
        Kernel::Cone(cone) if inside && is_one_piece => {
            put([row(cone.apex, cone.slope), row(cone.axis, 0.0)].as_flattened());
            KernelForm::Cone
        }
        Kernel::Quadric(quadric) if inside && (is_one_piece || !quadric.may_open) => {
            let Quadric { centre, axes: [a, b, c], weights, linear, constant } = *quadric.quadric();
            let axes = [row(a, weights.x), row(b, weights.y), row(c, weights.z)];
            let rows = [row(centre, constant), row(linear, quadric.linear), axes[0], axes[1], axes[2]];
            put(rows.as_flattened());
            KernelForm::Quadric { is_ruled: quadric.is_ruled, is_one_piece }
        }
        Kernel::AxisSlab(slab) => {
            put(&[slab.low.0, slab.high.0]);
            faces = [slab.low.1, slab.high.1];
            KernelForm::AxisSlab { axis: slab.axis }
        }
        Kernel::Slab(slab) => {
            put(&[slab.normal.x, slab.normal.y, slab.normal.z, slab.low.0, slab.high.0]);
            faces = [slab.low.1, slab.high.1];
            KernelForm::Slab
        }
        &Kernel::AxisPlane { axis, sign, offset } => {
            put(&[offset]);
            KernelForm::AxisPlane { axis, sign, inside }
        }
        Kernel::Plane(plane) => {
            put(&[plane.normal.x, plane.normal.y, plane.normal.z, plane.offset]);
            KernelForm::Plane { inside }
        }
        _ => return None,
    };
    Some((form, faces, numbers))
}

/// A row of parameters: a vector and a number.
fn row(vector: Vec3, number: f64) -> [f64; WIDTH] {
    [vector.x, vector.y, vector.z, number]
}

impl KernelForm {
    /// The number of parameters.
    fn width(self) -> usize {
        match self {
            KernelForm::AxisPlane { .. } => 1,
            KernelForm::AxisSlab { .. } => 2,
            KernelForm::AxisCylinder { .. } => 3,
            KernelForm::Sphere { .. } | KernelForm::Plane { .. } => 4,
            KernelForm::Slab => 5,
            KernelForm::Cylinder { .. } | KernelForm::Cone => 7,
            KernelForm::Quadric { .. } => MOST,
        }
    }

    /// True if the facet may hold before and after some interval, but not within it.
    fn can_gap(self) -> bool {
        match self {
            KernelForm::Sphere { inside }
            | KernelForm::AxisCylinder { inside, .. }
            | KernelForm::Cylinder { inside } => !inside,
            _ => false,
        }
    }
}

impl FacetForm {
    /// Narrows the spans of eight leaves to where this facet holds, or returns gaps in which it does not hold.
    #[inline(always)]
    fn narrow<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        leaves: &[&[FormRow]; LANES],
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) -> Option<Gap<S>> {
        let faces = [splat(simd, self.faces[0]), splat(simd, self.faces[1])];
        match self.kernel {
            KernelForm::Sphere { inside } => {
                let [x, y, z, radius] = self.gathered(simd, leaves, 0);
                let about = (Vec3Lanes { x, y, z }, radius);
                let approach = sphere::approach(ray.origin, ray.direction, ray.square, about);
                let (from, to) = or_empty(simd, &approach, approach.half());
                return one_side((from, to), (inside, faces[0]), span);
            }
            KernelForm::AxisCylinder { axis, inside } => {
                let [x, y, radius] = self.gathered(simd, leaves, 0);
                let approach = axis::approach(ray, axis, [x, y], radius);
                let (from, to) = cylinder_times(simd, radius, &approach, ray, uncertain);
                return one_side((from, to), (inside, faces[0]), span);
            }
            KernelForm::Cylinder { inside } => {
                let [x, y, z, radius] = self.gathered(simd, leaves, 0);
                let line = (Vec3Lanes { x, y, z }, self.vectors(simd, leaves, 1));
                let rays = (ray.origin, ray.direction);
                let approach = cylinder::approach(rays, ray.slow_square, line, radius);
                let (from, to) = cylinder_times(simd, radius, &approach, ray, uncertain);
                return one_side((from, to), (inside, faces[0]), span);
            }
            KernelForm::Cone | KernelForm::Quadric { .. } => {
                // out of line and on copies, so that the most frequent kernels stay in registers
                let (ray, mut copies) = (*ray, (*span, *uncertain));
                simd.vectorize(
                    #[inline(always)]
                    || self.narrow_curved(simd, &ray, leaves, &mut copies.0, &mut copies.1),
                );
                (*span, *uncertain) = copies;
            }
            KernelForm::AxisSlab { axis } => {
                let axis = usize::from(axis);
                let course = [ray.origin.component(axis), ray.direction.component(axis)];
                let offsets = self.gathered(simd, leaves, 0);
                SlabTimes::new(simd, ray, course, offsets, uncertain).narrow(faces, span, uncertain);
            }
            KernelForm::Slab => {
                let [x, y, z, low] = self.gathered(simd, leaves, 0);
                let [high] = self.gathered(simd, leaves, 1);
                let normal = Vec3Lanes { x, y, z };
                let course = [ray.origin.dot(normal), certain_dot(simd, ray, normal)];
                SlabTimes::new(simd, ray, course, [low, high], uncertain).narrow(faces, span, uncertain);
            }
            KernelForm::AxisPlane { axis, sign, inside } => {
                let [offset] = self.gathered(simd, leaves, 0);
                let height = offset - ray.origin.component(axis.into()) * sign;
                let speed = ray.direction.component(axis.into()) * sign;
                narrow_to_plane(simd, ray, [height, speed], (inside, faces[0]), span, uncertain);
            }
            KernelForm::Plane { inside } => {
                let [x, y, z, offset] = self.gathered(simd, leaves, 0);
                let normal = Vec3Lanes { x, y, z };
                let (height, speed) = (offset - ray.origin.dot(normal), certain_dot(simd, ray, normal));
                narrow_to_plane(simd, ray, [height, speed], (inside, faces[0]), span, uncertain);
            }
        }
        None
    }

    /// Lane version of [`FacetForm::narrow`] for surfaces with long kernels.
    #[inline(always)]
    fn narrow_curved<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        leaves: &[&[FormRow]; LANES],
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) {
        let [x, y, z, number] = self.gathered(simd, leaves, 0);
        let centre = Vec3Lanes { x, y, z };
        let face = splat(simd, self.faces[0]);
        if let KernelForm::Quadric { is_ruled, is_one_piece } = self.kernel {
            let [x, y, z, slope] = self.gathered(simd, leaves, 1);
            let linear = Vec3Lanes { x, y, z };
            let [x, y, z, p] = self.gathered(simd, leaves, 2);
            let first = Vec3Lanes { x, y, z };
            let [x, y, z, q] = self.gathered(simd, leaves, 3);
            let second = Vec3Lanes { x, y, z };
            let [x, y, z, r] = self.gathered(simd, leaves, 4);
            let axes = [first, second, Vec3Lanes { x, y, z }];
            let weights = Vec3Lanes { x: p, y: q, z: r };
            let quadric = QuadricLanes { centre, axes, weights, linear, constant: number, slope };
            let roots = quadric.roots(simd, ray, is_ruled, uncertain);
            let side = CurvedSide { inside: true, is_one_piece, face };
            side.narrow(simd, ray, (&roots, splat(simd, 1.0)), span, uncertain);
            return;
        }
        let cone = ConeLanes { apex: centre, axis: self.vectors(simd, leaves, 1), slope: number };
        let roots = cone::roots(simd, &cone, ray, uncertain);
        let side = CurvedSide { inside: true, is_one_piece: true, face };
        side.narrow(simd, ray, (&roots, cone.bend()), span, uncertain);
    }

    /// Vectors of eight leaves, in the row `after` the first one.
    #[inline(always)]
    fn vectors<S: Simd>(&self, simd: S, leaves: &[&[FormRow]; LANES], after: usize) -> Vec3Lanes<S> {
        let [x, y, z] = self.gathered(simd, leaves, after);
        Vec3Lanes { x, y, z }
    }

    /// Parameters of eight leaves, from the first one on in the row `after` its row.
    #[inline(always)]
    fn gathered<S: Simd, const N: usize>(
        &self,
        simd: S,
        leaves: &[&[FormRow]; LANES],
        after: usize,
    ) -> [Lanes<S>; N] {
        let (row, column) = self.at;
        let mut columns = [[0.0; LANES]; N];
        for lane in 0..LANES {
            let FormRow(numbers) = &leaves[lane][row + after];
            for k in 0..N {
                columns[k][lane] = numbers[(column + k) % WIDTH];
            }
        }
        // no `map`, whose closure would not be compiled for the instruction set
        let mut lanes = [splat(simd, 0.0); N];
        for k in 0..N {
            lanes[k] = Lanes::load_array(simd, columns[k]);
        }
        lanes
    }
}

/// Narrows spans to an interval, or returns it as a gap.
#[inline(always)]
fn one_side<S: Simd>(
    (from, to): (Lanes<S>, Lanes<S>),
    (inside, face): (bool, Lanes<S>),
    span: &mut LaneSpan<S>,
) -> Option<Gap<S>> {
    if !inside {
        return Some(Gap { from, to });
    }
    span.begin_after(from, face);
    span.end_before(to, face);
    None
}
