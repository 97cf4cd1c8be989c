//! Kernels for eight leaves of one form at a time: a different leaf in each lane.
//!
//! Kernels for bundles have one surface for all lanes and a different ray in each. Here the parameters of the surfaces are in
//! lanes too, so that a ray that passes many leaves of a large model fills its lanes with these. The arithmetic is the same.

use super::axis;
use super::facet::{Kernel, LaneFacet, SlabTimes, certain_dot, cylinder_times, narrow_to_plane, or_empty};
use super::ray::{LaneRay, Uncertain};
use super::span::LaneSpan;
use super::vector::{LANES, Lanes, Vec3Lanes, splat};
use crate::surface::sphere;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Parameters of a leaf in memory, half a cache line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct FormRow([f64; WIDTH]);

/// The numbers in a row.
const WIDTH: usize = 4;

/// The form of a convex leaf: what remains of its facets without their parameters. Leaves of one form share their kernels.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafForm {
    facets: Vec<FacetForm>,
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
    Sphere,
    AxisCylinder { axis: u8 },
    AxisSlab { axis: u8 },
    Slab,
    AxisPlane { axis: u8, sign: f64, inside: bool },
    Plane { inside: bool },
}

impl LeafForm {
    /// The form of a leaf with these facets, whose faces are numbered from `first` on; appends its parameters. `None` if a kernel
    /// has no such form, or if a facet may cut a gap out of the leaf.
    pub fn of(facets: &[LaneFacet], first: f64, parameters: &mut Vec<FormRow>) -> Option<LeafForm> {
        let known = parameters.len();
        let mut form = LeafForm { facets: Vec::with_capacity(facets.len()), rows: 0 };
        for facet in facets {
            let Some((kernel, faces, numbers)) = facet_form(facet) else {
                parameters.truncate(known);
                return None;
            };
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

    /// The spans of rays in eight leaves, given by their parameters, with the numbers of faces within the leaves.
    #[inline(always)]
    pub fn spans<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        leaves: &[&[FormRow]; LANES],
        uncertain: &mut Uncertain<S>,
    ) -> LaneSpan<S> {
        let mut span = LaneSpan::line(simd);
        for facet in &self.facets {
            facet.narrow(simd, ray, leaves, &mut span, uncertain);
        }
        span
    }
}

/// The form of a facet, its faces, and its parameters.
fn facet_form(facet: &LaneFacet) -> Option<(KernelForm, [f64; 2], [f64; LANES])> {
    let inside = facet.inside;
    let mut numbers = [0.0; LANES];
    let mut put = |values: &[f64]| numbers[..values.len()].copy_from_slice(values);
    let mut faces = [facet.face; 2];
    let form = match &facet.kernel {
        Kernel::Sphere(sphere) if inside => {
            put(&[sphere.centre.x, sphere.centre.y, sphere.centre.z, sphere.radius]);
            KernelForm::Sphere
        }
        Kernel::AxisCylinder(cylinder) if inside => {
            put(&[cylinder.point[0], cylinder.point[1], cylinder.radius]);
            KernelForm::AxisCylinder { axis: cylinder.axis }
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

impl KernelForm {
    /// The number of parameters.
    fn width(self) -> usize {
        match self {
            KernelForm::AxisPlane { .. } => 1,
            KernelForm::AxisSlab { .. } => 2,
            KernelForm::AxisCylinder { .. } => 3,
            KernelForm::Sphere | KernelForm::Plane { .. } => 4,
            KernelForm::Slab => 5,
        }
    }
}

impl FacetForm {
    /// Narrows the spans of eight leaves to where this facet holds.
    #[inline(always)]
    fn narrow<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        leaves: &[&[FormRow]; LANES],
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) {
        let faces = [splat(simd, self.faces[0]), splat(simd, self.faces[1])];
        match self.kernel {
            KernelForm::Sphere => {
                let [x, y, z, radius] = self.gathered(simd, leaves, 0);
                let about = (Vec3Lanes { x, y, z }, radius);
                let approach = sphere::approach(ray.origin, ray.direction, ray.square, about);
                let (from, to) = or_empty(simd, &approach, approach.half());
                span.begin_after(from, faces[0]);
                span.end_before(to, faces[0]);
            }
            KernelForm::AxisCylinder { axis } => {
                let [x, y, radius] = self.gathered(simd, leaves, 0);
                let approach = axis::approach(ray, axis, [x, y], radius);
                let (from, to) = cylinder_times(simd, radius, &approach, ray, uncertain);
                span.begin_after(from, faces[0]);
                span.end_before(to, faces[0]);
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
