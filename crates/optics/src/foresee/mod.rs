//! What eight rays meet next, foreseen: which surface that is, is guessed from what rays from the same face met before,
//! and proved for these rays.
//!
//! All surfaces here are convex: along a ray f is a convex function of time, so that a ray that is where f < 0 at two times
//! is there between them, and one where f > 0 that moves away at the first, or comes nearer at the second, is there between
//! them, too. If by that the rays keep to known sides of enough surfaces to tell the region that they are in up to where
//! they cross the guessed surface, and that behind it, that crossing is the next one: with the time that the kernel of the
//! surface gives to every evaluator. "Known" leaves [`ROOM`] that is far more than any tolerance, so that nothing of what
//! tolerances decide comes into it: neither the weld nor rays that lie in surfaces. What cannot be proved is asked.

mod regions;

pub(crate) use regions::{Sides, Step};

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd};
use rayweave_model::{Program, PrototypeId, RegionId, SurfaceId};
use rayweave_shape::lanes::{
    Facet, Kernel, LaneLimits, LaneRay, LaneStarts, Lanes, Mask, Span, Vec3Lanes, splat,
};
use rayweave_shape::surface::Surface;
use regions::{MOST, Regions};

/// What is nearer to a surface than this, relative to all lengths at hand, may be on either side.
const ROOM: f64 = 1e-9;

/// Points so many times farther away than the model is large are not foreseen.
const FAR: f64 = 1e4;

/// A program whose crossings can be foreseen.
#[derive(Clone, Debug)]
pub(crate) struct Foresight {
    surfaces: Vec<Facet>,
    /// For each surface of the program its number among these.
    slots: Vec<Option<usize>>,
    regions: Regions,
    limits: LaneLimits,
    pub level: Level,
}

/// Eight rays with what is known about them.
#[derive(Clone, Copy)]
pub(crate) struct Eight<S: Simd> {
    pub origin: Vec3Lanes<S>,
    pub direction: Vec3Lanes<S>,
    /// The surface on which all of them start, if they start on one, and whether they go where f < 0 from there.
    pub start: Option<(usize, bool)>,
    /// The sides of other surfaces at their origins.
    pub sides: Sides,
}

/// What eight rays meet.
pub(crate) struct Seen<S: Simd> {
    pub t: Lanes<S>,
    /// Where they are then.
    pub point: Vec3Lanes<S>,
    /// f and its gradient there.
    pub slope: (Lanes<S>, Vec3Lanes<S>),
    /// Along the gradient.
    pub normal: Vec3Lanes<S>,
    pub step: Step,
    /// The sides of all other surfaces there.
    pub sides: Sides,
    /// True if no other surface is near.
    pub is_alone: bool,
}

impl Foresight {
    /// `None` for programs with placed solids, with other than convex surfaces, or with too many, and with regions that
    /// are no plain conjunctions.
    pub fn new(program: &Program) -> Option<Foresight> {
        let group = program.prototype(PrototypeId(0));
        let (mut surfaces, mut slots) = (Vec::new(), vec![None; program.surfaces().len()]);
        for facet in program.leaves().flat_map(|leaf| leaf.facets()) {
            let id = facet.surface();
            if slots[id.index()].is_none() {
                slots[id.index()] = Some(surfaces.len());
                surfaces.push(convex(program, id)?);
            }
        }
        if surfaces.len() > MOST || group.ball.radius <= 0.0 {
            return None;
        }
        let regions = Regions::new(program, &slots)?;
        Some(Foresight { surfaces, slots, regions, limits: limits(program), level: Level::new() })
    }

    /// The number of a surface here.
    pub fn slot(&self, surface: SurfaceId) -> Option<usize> {
        self.slots.get(surface.index()).copied().flatten()
    }

    /// The crossing of a surface by eight rays, if it is sure that it is their next one.
    #[inline(always)]
    pub fn next<S: Simd>(&self, simd: S, eight: &Eight<S>, surface: usize) -> Option<Seen<S>> {
        let (t, inward) = self.time(simd, eight, surface, eight.sides)?;
        let (between, there) = self.sides_up_to(simd, eight, t, Some(surface))?;
        let before = self.regions.held(between.with(surface, !inward))?;
        let after = self.regions.held(there.with(surface, inward))?;
        let step = self.regions.step(surface, before, after)?;
        let point = eight.origin.plus(eight.direction.times(t));
        let slope @ (_, gradient) = self.surfaces[surface].kernel.value_and_gradient(simd, point);
        let normal = unit(simd, gradient);
        let climb = normal.dot(eight.direction);
        let rises = if inward { climb.simd_lt(0.0) } else { climb.simd_gt(0.0) };
        let sides = there.without(surface);
        let is_alone = (sides.known() | 1 << surface).count_ones() as usize == self.surfaces.len();
        rises.all_true().then_some(Seen { t, point, slope, normal, step, sides, is_alone })
    }

    /// The crossing of a surface by eight rays that start on none of these surfaces, whatever they met before, if it is their
    /// first one of this surface: when, and from which regions into which.
    #[inline(always)]
    pub fn through<S: Simd>(
        &self,
        simd: S,
        eight: &Eight<S>,
        surface: usize,
    ) -> Option<(Lanes<S>, [RegionId; 2])> {
        let eight = Eight { start: None, ..*eight };
        let sides = self.side(simd, surface, eight.origin, eight.origin.taxicab() + self.limits.reach);
        let (t, inward) = self.time(simd, &eight, surface, sides)?;
        let point = eight.origin.plus(eight.direction.times(t));
        let lengths = eight.origin.taxicab() + t * eight.direction.taxicab();
        let there = self.sides(simd, point, lengths);
        let held = |inside: bool| self.regions.held(there.with(surface, inside)).map(Regions::winner);
        lengths.simd_lt(self.limits.radius * FAR).all_true().then_some((t, [held(!inward)?, held(inward)?]))
    }

    /// The region in which rays are from their start up to some time, if it is the same for all.
    #[inline(always)]
    pub fn region_up_to<S: Simd>(&self, simd: S, eight: &Eight<S>, t: Lanes<S>) -> Option<RegionId> {
        let (between, _) = self.sides_up_to(simd, eight, t, None)?;
        self.regions.held(between).map(Regions::winner)
    }

    /// When eight rays cross a surface for the first time, and whether that is inward, from the sides at their origins.
    #[inline(always)]
    fn time<S: Simd>(
        &self,
        simd: S,
        eight: &Eight<S>,
        surface: usize,
        sides: Sides,
    ) -> Option<(Lanes<S>, bool)> {
        let facet = &self.surfaces[surface];
        let (ray, mut doubt) = LaneRay::new(simd, eight.origin, eight.direction, &self.limits);
        let mut span = Span::line(simd);
        let inward = match eight.start {
            Some((start, inside)) if start == surface => {
                if !inside {
                    return None;
                }
                let surface = splat(simd, facet.surfaces[0]);
                let starts = LaneStarts { surface, inside: !Mask::splat(simd, false) };
                facet.narrow_from(simd, &ray, &starts, &mut span, &mut doubt);
                false
            }
            _ => {
                facet.narrow(simd, &ray, &mut span, &mut doubt);
                match (sides.inside >> surface & 1, sides.outside >> surface & 1) {
                    (1, _) => false,
                    (_, 1) => true,
                    _ => return None,
                }
            }
        };
        let t = if inward { span.from } else { span.to };
        let is_ahead = t.simd_gt(0.0) & t.simd_lt(f64::INFINITY);
        // a chord may be so thin that it is none
        let ends = span.to.simd_lt(f64::INFINITY);
        if inward && (ends & ray.may_hug(span.from, span.to, &self.limits)).any_true() {
            return None;
        }
        (is_ahead & !doubt.always & !doubt.grazes).all_true().then_some((t, inward))
    }

    /// The sides to which eight rays keep up to some time, but for a surface that they cross there, and the sides at
    /// that time.
    #[inline(always)]
    fn sides_up_to<S: Simd>(
        &self,
        simd: S,
        eight: &Eight<S>,
        t: Lanes<S>,
        crossed: Option<usize>,
    ) -> Option<(Sides, Sides)> {
        let point = eight.origin.plus(eight.direction.times(t));
        let lengths = eight.origin.taxicab() + t * eight.direction.taxicab();
        if !lengths.simd_lt(self.limits.radius * FAR).all_true() {
            return None;
        }
        let there = self.sides(simd, point, lengths);
        let mut here = eight.sides;
        if let Some((start, inside)) = eight.start {
            here = here.without(start);
            let (slope, steepest) = self.slope(simd, start, eight.origin, eight.direction);
            let room = steepest * ROOM;
            let steep = if inside { slope.simd_lt(-room) } else { slope.simd_gt(room) };
            if !steep.all_true() {
                return None;
            }
            here = here.with(start, inside);
        }
        let mut between = here.and(there);
        let mut bulging = between.outside;
        while bulging != 0 {
            let surface = bulging.trailing_zeros() as usize;
            bulging &= bulging - 1;
            if Some(surface) != crossed && !self.stays_out(simd, surface, eight, point) {
                between = between.without(surface);
            }
        }
        Some((between, there))
    }

    /// True if rays that are outside of a surface at their origins and at later points are so between.
    #[inline(always)]
    fn stays_out<S: Simd>(&self, simd: S, surface: usize, eight: &Eight<S>, point: Vec3Lanes<S>) -> bool {
        if matches!(self.surfaces[surface].kernel, Kernel::AxisPlane { .. } | Kernel::Plane(_)) {
            return true;
        }
        let leaves = self.slope(simd, surface, eight.origin, eight.direction).0.simd_gt(0.0);
        let nears = self.slope(simd, surface, point, eight.direction).0.simd_lt(0.0);
        (leaves | nears).all_true()
    }

    /// How f changes along directions of unit length, and a bound of that.
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

    /// The sides of all surfaces on which eight points surely are that were reached over some lengths.
    #[inline(always)]
    pub fn sides<S: Simd>(&self, simd: S, point: Vec3Lanes<S>, lengths: Lanes<S>) -> Sides {
        let lengths = lengths + self.limits.reach;
        let mut sides = Sides::default();
        for surface in 0..self.surfaces.len() {
            let Sides { inside, outside } = self.side(simd, surface, point, lengths);
            (sides.inside, sides.outside) = (sides.inside | inside, sides.outside | outside);
        }
        sides
    }

    /// The side of one surface; the greatest reach is among the lengths.
    #[inline(always)]
    fn side<S: Simd>(&self, simd: S, surface: usize, point: Vec3Lanes<S>, lengths: Lanes<S>) -> Sides {
        let kernel = &self.surfaces[surface].kernel;
        let (value, _) = kernel.value_and_gradient(simd, point);
        let room = match kernel {
            Kernel::AxisPlane { .. } | Kernel::Plane(_) => lengths * ROOM,
            // gradients of spheres and cylinders are no longer than twice the lengths
            _ => lengths * lengths * (2.0 * ROOM),
        };
        Sides {
            inside: u64::from(value.simd_lt(-room).all_true()) << surface,
            outside: u64::from(value.simd_gt(room).all_true()) << surface,
        }
    }
}

/// The unit vectors along gradients, as [`rayweave_model::dress::normal`] finds them.
#[inline(always)]
fn unit<S: Simd>(simd: S, gradient: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let Vec3Lanes { x, y, z } = gradient;
    let largest = x.abs().max(y.abs()).max(z.abs());
    let scaled = Vec3Lanes { x: x / largest, y: y / largest, z: z / largest };
    scaled.times(splat(simd, 1.0) / scaled.length_squared().sqrt())
}

/// The inside of a surface, if it is convex.
fn convex(program: &Program, id: SurfaceId) -> Option<Facet> {
    let surface = &program.surface(id).surface;
    if !matches!(surface, Surface::Plane(_) | Surface::Sphere(_) | Surface::Cylinder(_)) {
        return None;
    }
    let surfaces = [f64::from(id.0); 2];
    let (face, gap) = (0.0, u32::MAX);
    Some(Facet { kernel: Kernel::of(surface)?, inside: true, face, surfaces, gap, is_one_piece: false })
}

/// What is said about rays that can be answered in lanes, for surfaces that are at most of the second degree.
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
        reach: entries.iter().map(|entry| entry.reach).fold(ball.centre.length() + ball.radius, f64::max),
        largest_radius: entries.iter().map(|entry| radius(&entry.surface)).fold(0.0, f64::max),
        bend: 0.0,
    }
}
