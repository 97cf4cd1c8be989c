//! Refraction of a ray bundle at a face (Snell's law in SIMD lanes).
//!
//! An [`IncidentBundle`] is eight rays at their hits on a face, a [`TransmittedBundle`] the same
//! rays behind the face. The operations and their order are those of
//! [`refract`](crate::interface::refract) and of the scalar loop, so that results agree bit for
//! bit.

use crate::start_surfaces::StartSurfaces;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_bvh::ExactBvh;
use rayweave_math::Bounds;
use rayweave_model::{Program, Rays, SurfaceId};
use rayweave_shape::dispatch_wide;
use rayweave_shape::lanes::{Kernel, LANES, Lanes, Vec3Lanes, WideLevel, splat};
use rayweave_shape::surface::delta_of;
use std::ops::ControlFlow;

/// The surfaces of a system as lane kernels, with the boxes in which they matter.
#[derive(Clone, Debug)]
pub(crate) struct Refractor {
    surfaces: Vec<LaneSurface>,
    /// Index into `surfaces` by surface of the program; `None` for surfaces that no region uses.
    slots: Vec<Option<usize>>,
    tree: ExactBvh,
    level: WideLevel,
}

#[derive(Clone, Debug)]
struct LaneSurface {
    kernel: Kernel,
    magnitude: f64,
}

/// Eight rays at their hits on a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct IncidentBundle<S: Simd> {
    pub origin: Vec3Lanes<S>,
    pub direction: Vec3Lanes<S>,
    pub t: Lanes<S>,
    /// The points of the hits.
    pub end: Vec3Lanes<S>,
    /// The unit normals, of either sense.
    pub normal: Vec3Lanes<S>,
    /// f and its gradient at the hits.
    pub slope: (Lanes<S>, Vec3Lanes<S>),
    pub path: Lanes<S>,
    pub surface: SurfaceId,
    /// True if no other surface is within the tolerance of a hit. Conservative: true is definite,
    /// false is not.
    pub is_alone: bool,
}

/// Eight rays behind the face that refracted them.
#[derive(Clone, Copy, Debug)]
pub(super) struct TransmittedBundle<S: Simd> {
    /// The points of the hits, projected onto the face.
    pub origin: Vec3Lanes<S>,
    pub direction: Vec3Lanes<S>,
    /// The optical paths up to the hits.
    pub path: Lanes<S>,
    /// Bit mask of the rays that are on the side f < 0 behind the face.
    pub inside: u64,
}

/// A transmitted bundle as arrays.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TransmittedRays {
    /// The points of the hits.
    pub end: [[f64; LANES]; 3],
    pub origin: [[f64; LANES]; 3],
    pub direction: [[f64; LANES]; 3],
    pub path: [f64; LANES],
    pub inside: u64,
}

impl TransmittedRays {
    /// The rays behind the face.
    pub fn rays(&self) -> Rays<'_> {
        let ([x, y, z], [u, v, w]) = (&self.origin, &self.direction);
        Rays { origins: [x, y, z], directions: [u, v, w] }
    }
}

impl Refractor {
    /// `None` for a system with placed solids, or with surfaces that have no lane kernel, and without a [`WideLevel`].
    pub fn new(program: &Program, start_surfaces: &StartSurfaces) -> Option<Refractor> {
        let level = WideLevel::widest()?;
        let (mut surfaces, mut boxes) = (Vec::new(), Vec::new());
        let mut slots = vec![None; program.surfaces().len()];
        for (bounds, surface) in start_surfaces.unplaced()? {
            let entry = program.surface(surface);
            let kernel = Kernel::of(&entry.surface).filter(Kernel::has_value)?;
            slots[surface.index()] = Some(surfaces.len());
            surfaces.push(LaneSurface { kernel, magnitude: entry.magnitude });
            boxes.push(bounds);
        }
        Some(Refractor { surfaces, slots, tree: ExactBvh::listed(&boxes), level })
    }

    /// Refracts rays `at..at + 8` that hit a surface at times `t`, with normals of either sense;
    /// `None` if the bundle needs the scalar path: see [`Refractor::refract_lanes`].
    pub fn refract(
        &self,
        (rays, at): (Rays<'_>, usize),
        (t, normal): (&[f64], [&[f64]; 3]),
        path: &[f64],
        surface: SurfaceId,
        indices: &[[f64; LANES]; 2],
    ) -> Option<TransmittedRays> {
        let kernel = &self.surfaces[self.slot(surface)?].kernel;
        dispatch_wide!(self.level, simd => {
            let incident = IncidentBundle::load(simd, kernel, (rays, at), (t, normal), path, surface)?;
            let indices = indices.each_ref().map(|index| Lanes::load_array_ref(simd, index));
            let transmitted = self.refract_lanes(simd, &incident, indices)?;
            Some(TransmittedRays {
                end: stored(incident.end),
                origin: stored(transmitted.origin),
                direction: stored(transmitted.direction),
                path: transmitted.path.to_array(),
                inside: transmitted.inside,
            })
        })
    }

    fn slot(&self, surface: SurfaceId) -> Option<usize> {
        self.slots.get(surface.index()).copied().flatten()
    }

    /// Refracts a bundle at a face between media of the indices `before` and `behind`; `None` if a
    /// ray needs the scalar path: it undergoes total internal reflection, or another surface may be
    /// within the tolerance.
    #[inline(always)]
    pub(super) fn refract_lanes<S: Simd>(
        &self,
        simd: S,
        incident: &IncidentBundle<S>,
        [before, behind]: [Lanes<S>; 2],
    ) -> Option<TransmittedBundle<S>> {
        let &IncidentBundle { origin, direction, t, end, slope: (value, gradient), .. } = incident;
        let normal = oriented_against(simd, incident.normal, direction);
        let ratio = before / behind;
        let c = -direction.dot(normal);
        let squared = splat(simd, 1.0) - ratio * ratio * (splat(simd, 1.0) - c * c);
        if !squared.simd_gt(0.0).all_true() {
            return None;
        }
        let bent = direction.times(ratio).plus(normal.times(ratio * c - squared.sqrt()));
        let length = bent.length_squared().sqrt();
        let bent = Vec3Lanes { x: bent.x / length, y: bent.y / length, z: bent.z / length };
        if !incident.is_alone {
            let lengths = origin.taxicab() + t.abs() * direction.taxicab();
            if self.are_others_near(simd, self.slot(incident.surface)?, end, lengths) {
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
        Some(TransmittedBundle { origin, direction: bent, path: incident.path + before * t, inside })
    }

    /// True if a surface other than `own` may be within the tolerance of a point: the conservative
    /// test of [`StartSurfaces::append_others`].
    #[inline(always)]
    fn are_others_near<S: Simd>(&self, simd: S, own: usize, at: Vec3Lanes<S>, lengths: Lanes<S>) -> bool {
        let margin = lengths * (1e3 * delta_of(1.0));
        let is_near = self.tree.visit(
            // closures that are not inlined are compiled without the SIMD target features
            #[inline(always)]
            |bounds| contains_any(bounds, at, margin),
            #[inline(always)]
            |k| match k != own && self.surfaces[k].is_near(simd, at, lengths) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            },
        );
        is_near.is_break()
    }
}

impl LaneSurface {
    /// True if the surface may be within the tolerance of one of eight points.
    #[inline(always)]
    fn is_near<S: Simd>(&self, simd: S, at: Vec3Lanes<S>, lengths: Lanes<S>) -> bool {
        let (value, gradient) = self.kernel.value_and_gradient(simd, at);
        let near = (lengths + self.magnitude) * (2.0 * delta_of(1.0)) * gradient.taxicab();
        !value.abs().simd_gt(near).all_true()
    }
}

/// True if one of eight points is in a box or within a margin of it.
#[inline(always)]
fn contains_any<S: Simd>(Bounds { lo, hi }: &Bounds, at: Vec3Lanes<S>, margin: Lanes<S>) -> bool {
    let x = (at.x + margin).simd_ge(lo.x) & (at.x - margin).simd_le(hi.x);
    let y = (at.y + margin).simd_ge(lo.y) & (at.y - margin).simd_le(hi.y);
    let z = (at.z + margin).simd_ge(lo.z) & (at.z - margin).simd_le(hi.z);
    (x & y & z).any_true()
}

impl<S: Simd> IncidentBundle<S> {
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
        Some(IncidentBundle { origin, direction, t, end, normal, slope, path, surface, is_alone: false })
    }
}

/// Normals turned against directions.
#[inline(always)]
fn oriented_against<S: Simd>(simd: S, normal: Vec3Lanes<S>, direction: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let one = splat(simd, 1.0);
    normal.times(normal.dot(direction).simd_gt(0.0).select(-one, one))
}

/// Entries `at..at + 8` of a column.
#[inline(always)]
pub(super) fn load_one<S: Simd>(simd: S, column: &[f64], at: usize) -> Option<Lanes<S>> {
    Some(Lanes::load_array_ref(simd, column.get(at..)?.first_chunk()?))
}

/// Entries `at..at + 8` of three columns.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, [x, y, z]: [&[f64]; 3], at: usize) -> Option<Vec3Lanes<S>> {
    Some(Vec3Lanes { x: load_one(simd, x, at)?, y: load_one(simd, y, at)?, z: load_one(simd, z, at)? })
}

#[inline(always)]
pub(super) fn stored<S: Simd>(v: Vec3Lanes<S>) -> [[f64; LANES]; 3] {
    [v.x.to_array(), v.y.to_array(), v.z.to_array()]
}
