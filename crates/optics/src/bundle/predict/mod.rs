//! Hit prediction: verification that a predicted surface is the next hit of a ray bundle.
//!
//! All surfaces here are convex: along a ray f is a convex function of time. So a ray with f < 0 at
//! two times has f < 0 between them, and a ray with f > 0 at two times has f > 0 between them if f
//! rises at the first time or falls at the second. These known signs of f, the [`Sides`] of
//! surfaces, determine the regions before and behind the predicted crossing. If they do, no other
//! crossing lies before it, and the verified hit equals the evaluator's: the same kernel computes
//! its time.
//!
//! A side counts as known only beyond a [margin](MARGIN) far above every tolerance, so that no
//! decision within a tolerance (welding, rays in a surface) takes part. Bundles whose prediction
//! cannot be verified fall back to the evaluator.

mod history;
mod regions;

pub(crate) use history::{PredictedHit, PredictionTable};
pub(crate) use regions::{FaceCrossing, Sides};

use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_model::{Program, PrototypeId, RegionId, SurfaceId};
use rayweave_shape::lanes::{
    Kernel, LaneFacet, LaneLimits, LaneRay, LaneSpan, LaneStarts, Lanes, Mask, Vec3Lanes, WideLevel, splat,
};
use rayweave_shape::surface::Surface;
use regions::{MAX_BITS, Regions};

/// The distance from a surface, relative to the lengths involved, within which the side of a point
/// counts as unknown.
const MARGIN: f64 = 1e-9;

/// The greatest distance of a verified hit, in units of the radius of the model.
const MAX_DISTANCE: f64 = 1e4;

/// The surfaces and regions of a program whose hits can be predicted.
#[derive(Clone, Debug)]
pub(crate) struct Predictor {
    surfaces: Vec<LaneFacet>,
    /// For each surface of the program, its number in this predictor.
    slots: Vec<Option<usize>>,
    regions: Regions,
    limits: LaneLimits,
    pub level: WideLevel,
}

/// Eight rays, with the known sides of surfaces at their origins.
#[derive(Clone, Copy)]
pub(crate) struct BundleRays<S: Simd> {
    pub origin: Vec3Lanes<S>,
    pub direction: Vec3Lanes<S>,
    /// The surface on which all rays start, and whether they leave it towards the side f < 0;
    /// `None` if they start on no surface.
    pub start: Option<(usize, bool)>,
    /// The sides of other surfaces at their origins.
    pub sides: Sides,
}

/// The verified next hit of a ray bundle.
pub(crate) struct VerifiedHit<S: Simd> {
    pub t: Lanes<S>,
    pub point: Vec3Lanes<S>,
    /// f and its gradient at the hit.
    pub slope: (Lanes<S>, Vec3Lanes<S>),
    /// The unit normal, along the gradient.
    pub normal: Vec3Lanes<S>,
    pub crossing: FaceCrossing,
    /// The sides of all other surfaces at the hit.
    pub sides: Sides,
    /// True if no other surface is within the tolerance of a hit.
    pub is_alone: bool,
}

impl Predictor {
    /// `None` for programs with placed solids, with surfaces that are not convex, with too many
    /// surfaces or regions, and with regions that are not in conjunctive normal form; and without a [`WideLevel`].
    pub fn new(program: &Program) -> Option<Predictor> {
        let level = WideLevel::widest()?;
        let group = program.prototype(PrototypeId(0));
        let (mut surfaces, mut slots) = (Vec::new(), vec![None; program.surfaces().len()]);
        for facet in program.leaves().flat_map(|leaf| leaf.facets()) {
            let id = facet.surface();
            if slots[id.index()].is_none() {
                slots[id.index()] = Some(surfaces.len());
                surfaces.push(convex(program, id)?);
            }
        }
        if surfaces.len() > MAX_BITS || group.ball.radius <= 0.0 {
            return None;
        }
        let regions = Regions::new(program, &slots)?;
        Some(Predictor { surfaces, slots, regions, limits: limits(program), level })
    }

    /// The index of a surface in this predictor.
    pub fn slot(&self, surface: SurfaceId) -> Option<usize> {
        self.slots.get(surface.index()).copied().flatten()
    }

    /// Verifies that the next hit of a bundle is on a surface, and returns the crossing; `None` if
    /// the proof fails.
    #[inline(always)]
    pub fn verify<S: Simd>(&self, simd: S, rays: &BundleRays<S>, surface: usize) -> Option<VerifiedHit<S>> {
        let (t, inward) = self.time(simd, rays, surface, rays.sides)?;
        let (between, there) = self.sides_up_to(simd, rays, t, Some(surface))?;
        let before = self.regions.containing(between.with(surface, !inward))?;
        let after = self.regions.containing(there.with(surface, inward))?;
        let crossing = self.regions.crossing(surface, before, after)?;
        let point = rays.origin.plus(rays.direction.times(t));
        let slope @ (_, gradient) = self.surfaces[surface].kernel.value_and_gradient(simd, point);
        let normal = unit(simd, gradient);
        let cosine = normal.dot(rays.direction);
        let crosses = if inward { cosine.simd_lt(0.0) } else { cosine.simd_gt(0.0) };
        let sides = there.without(surface);
        let is_alone = (sides.known() | 1 << surface).count_ones() as usize == self.surfaces.len();
        crosses.all_true().then_some(VerifiedHit { t, point, slope, normal, crossing, sides, is_alone })
    }

    /// The first crossing of a surface by a bundle that starts on none of these surfaces,
    /// regardless of what it crosses before: the times, and the regions before and behind it.
    #[inline(always)]
    pub fn verify_first<S: Simd>(
        &self,
        simd: S,
        rays: &BundleRays<S>,
        surface: usize,
    ) -> Option<(Lanes<S>, [RegionId; 2])> {
        let rays = BundleRays { start: None, ..*rays };
        let sides = self.side(simd, surface, rays.origin, rays.origin.taxicab() + self.limits.magnitude);
        let (t, inward) = self.time(simd, &rays, surface, sides)?;
        let point = rays.origin.plus(rays.direction.times(t));
        let lengths = rays.origin.taxicab() + t * rays.direction.taxicab();
        let there = self.sides(simd, point, lengths);
        let region = |inside: bool| self.regions.containing(there.with(surface, inside)).map(Regions::owner);
        let is_within_range = lengths.simd_lt(self.limits.radius * MAX_DISTANCE).all_true();
        is_within_range.then_some((t, [region(!inward)?, region(inward)?]))
    }

    /// The region of a bundle from its start up to times `t`; `None` if it is unknown or differs
    /// between rays.
    #[inline(always)]
    pub fn region_up_to<S: Simd>(&self, simd: S, rays: &BundleRays<S>, t: Lanes<S>) -> Option<RegionId> {
        let (between, _) = self.sides_up_to(simd, rays, t, None)?;
        self.regions.containing(between).map(Regions::owner)
    }

    /// The times of the first crossing of a surface, and whether it is inward; the sides at the
    /// origins determine both.
    #[inline(always)]
    fn time<S: Simd>(
        &self,
        simd: S,
        rays: &BundleRays<S>,
        surface: usize,
        sides: Sides,
    ) -> Option<(Lanes<S>, bool)> {
        let facet = &self.surfaces[surface];
        let (ray, mut uncertain) = LaneRay::new(simd, rays.origin, rays.direction, &self.limits);
        let mut span = LaneSpan::line(simd);
        let inward = match rays.start {
            Some((start, inside)) if start == surface => {
                if !inside {
                    return None;
                }
                let surface = splat(simd, facet.surfaces[0]);
                let starts = LaneStarts { surface, inside: !Mask::splat(simd, false) };
                facet.narrow_from(simd, &ray, &starts, &mut span, &mut uncertain);
                false
            }
            _ => {
                facet.narrow(simd, &ray, &mut span, &mut uncertain);
                match (sides.inside >> surface & 1, sides.outside >> surface & 1) {
                    (1, _) => false,
                    (_, 1) => true,
                    _ => return None,
                }
            }
        };
        let t = if inward { span.from } else { span.to };
        let is_ahead = t.simd_gt(0.0) & t.simd_lt(f64::INFINITY);
        // a chord may be so thin that both ends coincide within the tolerance
        let ends = span.to.simd_lt(f64::INFINITY);
        if inward && (ends & ray.may_coincide(span.from, span.to, &self.limits)).any_true() {
            return None;
        }
        (is_ahead & !uncertain.always & !uncertain.grazes).all_true().then_some((t, inward))
    }

    /// The sides on which a bundle stays up to given times, except for a surface that it crosses
    /// there, and the sides at those times.
    #[inline(always)]
    fn sides_up_to<S: Simd>(
        &self,
        simd: S,
        rays: &BundleRays<S>,
        t: Lanes<S>,
        crossed: Option<usize>,
    ) -> Option<(Sides, Sides)> {
        let point = rays.origin.plus(rays.direction.times(t));
        let lengths = rays.origin.taxicab() + t * rays.direction.taxicab();
        if !lengths.simd_lt(self.limits.radius * MAX_DISTANCE).all_true() {
            return None;
        }
        let there = self.sides(simd, point, lengths);
        let mut here = rays.sides;
        if let Some((start, inside)) = rays.start {
            here = here.without(start);
            let (slope, steepest) = self.slope(simd, start, rays.origin, rays.direction);
            let margin = steepest * MARGIN;
            let leaves = if inside { slope.simd_lt(-margin) } else { slope.simd_gt(margin) };
            if !leaves.all_true() {
                return None;
            }
            here = here.with(start, inside);
        }
        let mut between = here.and(there);
        let mut outside = between.outside;
        while outside != 0 {
            let surface = outside.trailing_zeros() as usize;
            outside &= outside - 1;
            if Some(surface) != crossed && !self.stays_outside(simd, surface, rays, point) {
                between = between.without(surface);
            }
        }
        Some((between, there))
    }

    /// True if rays with f > 0 at their origins and at later points have f > 0 between them.
    #[inline(always)]
    fn stays_outside<S: Simd>(
        &self,
        simd: S,
        surface: usize,
        rays: &BundleRays<S>,
        point: Vec3Lanes<S>,
    ) -> bool {
        if matches!(self.surfaces[surface].kernel, Kernel::AxisPlane { .. } | Kernel::Plane(_)) {
            return true;
        }
        let recedes = self.slope(simd, surface, rays.origin, rays.direction).0.simd_gt(0.0);
        let approaches = self.slope(simd, surface, point, rays.direction).0.simd_lt(0.0);
        (recedes | approaches).all_true()
    }

    /// The derivative of f along directions of unit length, and a bound of it.
    #[inline(always)]
    fn slope<S: Simd>(
        &self,
        simd: S,
        surface: usize,
        point: Vec3Lanes<S>,
        direction: Vec3Lanes<S>,
    ) -> (Lanes<S>, Lanes<S>) {
        let (_, gradient) = self.surfaces[surface].kernel.value_and_gradient(simd, point);
        (gradient.dot(direction), gradient.taxicab())
    }

    /// The known sides of all surfaces at eight points; `lengths` are the magnitudes of the origins
    /// plus the distances travelled, which scale the margin.
    #[inline(always)]
    pub fn sides<S: Simd>(&self, simd: S, point: Vec3Lanes<S>, lengths: Lanes<S>) -> Sides {
        let lengths = lengths + self.limits.magnitude;
        let mut sides = Sides::default();
        for surface in 0..self.surfaces.len() {
            let Sides { inside, outside } = self.side(simd, surface, point, lengths);
            (sides.inside, sides.outside) = (sides.inside | inside, sides.outside | outside);
        }
        sides
    }

    /// The known side of one surface; the lengths include the greatest magnitude of the surfaces.
    #[inline(always)]
    fn side<S: Simd>(&self, simd: S, surface: usize, point: Vec3Lanes<S>, lengths: Lanes<S>) -> Sides {
        let kernel = &self.surfaces[surface].kernel;
        let (value, _) = kernel.value_and_gradient(simd, point);
        let margin = match kernel {
            Kernel::AxisPlane { .. } | Kernel::Plane(_) => lengths * MARGIN,
            // gradients of spheres and cylinders are no longer than twice the lengths
            _ => lengths * lengths * (2.0 * MARGIN),
        };
        Sides {
            inside: u64::from(value.simd_lt(-margin).all_true()) << surface,
            outside: u64::from(value.simd_gt(margin).all_true()) << surface,
        }
    }
}

/// The unit vectors along gradients, by the operations of [`rayweave_model::attributes::normal`].
#[inline(always)]
fn unit<S: Simd>(simd: S, gradient: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let Vec3Lanes { x, y, z } = gradient;
    let largest = x.abs().max(y.abs()).max(z.abs());
    let scaled = Vec3Lanes { x: x / largest, y: y / largest, z: z / largest };
    scaled.times(splat(simd, 1.0) / scaled.length_squared().sqrt())
}

/// The inside of a surface, if it is convex.
fn convex(program: &Program, id: SurfaceId) -> Option<LaneFacet> {
    let surface = &program.surface(id).surface;
    if !matches!(surface, Surface::Plane(_) | Surface::Sphere(_) | Surface::Cylinder(_)) {
        return None;
    }
    let surfaces = [f64::from(id.0); 2];
    let (face, gap) = (0.0, u32::MAX);
    Some(LaneFacet { kernel: Kernel::of(surface)?, inside: true, face, surfaces, gap, is_one_piece: false })
}

/// The limits within which lane kernels are valid, for surfaces of degree 2 at most.
fn limits(program: &Program) -> LaneLimits {
    let ball = program.prototype(PrototypeId(0)).ball;
    let radius = |surface: &Surface| match surface {
        Surface::Sphere(sphere) => sphere.radius,
        Surface::Cylinder(cylinder) => cylinder.radius,
        _ => 0.0,
    };
    let entries = program.surfaces();
    LaneLimits {
        centre: ball.centre,
        radius: ball.radius,
        magnitude: entries
            .iter()
            .map(|entry| entry.magnitude)
            .fold(ball.centre.length() + ball.radius, f64::max),
        largest_radius: entries.iter().map(|entry| radius(&entry.surface)).fold(0.0, f64::max),
        bend: 0.0,
        is_spherical: false,
    }
}
