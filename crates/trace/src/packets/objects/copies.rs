//! All crossings of a ray with copies of solids: the copies on its way are intersected eight at a time, one in each lane.
//!
//! If the copies that a ray passes neither overlap nor touch, its crossings with their union are those with the copies, one
//! copy after the other. The weave traces all other rays.

use super::super::group::{BundleEvaluation, Memory};
use super::super::places::Carried;
use super::{Method, Objects, Part};
use crate::Weave;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_model::{Crossing, Face, PlacementId, RegionId, Window};
use rayweave_shape::Ray;
use rayweave_shape::lanes::{LANES, Vec3Lanes, splat};

/// No solid.
const NONE: u32 = u32::MAX;

/// The solid of each leaf of the model's own group.
#[derive(Clone, Debug)]
pub(super) struct Copies(Vec<u32>);

/// The memory for the crossings of a ray.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct CopiesScratch {
    leaves: Vec<u32>,
    /// The solids on the way of the ray, each with its part.
    items: Vec<(u32, u32)>,
    passages: Vec<Passage>,
    /// The changes of all solids, as times and numbers of faces.
    changes: Vec<(f64, i32)>,
}

/// The way of a ray through a solid.
#[derive(Clone, Copy, Debug)]
struct Passage {
    /// The first change, or -inf if the ray starts inside.
    enter: f64,
    /// The changes: a range of all.
    changes: [u32; 2],
    starts_inside: bool,
    item: u32,
    /// The length of pieces that may be welded at a face of the solid.
    longest: f64,
}

impl Copies {
    /// The copies of a union of one region; `None` unless each solid has a plan and is placed by a leaf of its own of the model's
    /// own group.
    pub fn new(objects: &Objects, leaf_count: usize, regions: usize) -> Option<Copies> {
        let is_plan = |part: &Part| matches!(part.method, Method::Plan(_));
        if regions != 1 || !objects.parts.iter().all(is_plan) {
            return None;
        }
        let mut solids = vec![NONE; leaf_count];
        for (item, object) in objects.objects.iter().enumerate() {
            let place = solids.get_mut(object.top?.index()).filter(|place| **place == NONE)?;
            *place = item as u32;
        }
        Some(Copies(solids))
    }
}

impl Objects {
    /// True if [`Objects::list`] applies.
    pub fn has_copies(&self) -> bool {
        self.copies.is_some()
    }

    /// Writes the crossings of a ray in a window, in order. Returns the region at its start; `None` if the ray must be traced by
    /// the weave.
    #[inline(always)]
    pub fn list<S: Simd>(
        &self,
        (simd, memory): (S, &mut Memory),
        weave: &Weave,
        (ray, window): (Ray, Window),
        scratch: &mut CopiesScratch,
        crossings: &mut Vec<Crossing>,
    ) -> Option<RegionId> {
        let Copies(solids) = self.copies.as_ref()?;
        let CopiesScratch { leaves, items, passages, changes } = scratch;
        crossings.clear();
        leaves.clear();
        items.clear();
        passages.clear();
        changes.clear();
        weave.candidates(ray, window, leaves);
        for &leaf in &*leaves {
            let item = *solids.get(leaf as usize)?;
            if item != NONE {
                items.push((self.objects[item as usize].part, item));
            }
        }
        if self.parts.len() > 1 {
            items.sort_unstable();
        }
        let mut group = BundleEvaluation::new(simd, memory);
        for items in items.chunk_by(|a, b| a.0 == b.0) {
            for items in items.chunks(LANES) {
                self.pass_copies(&mut group, (ray, window), items, passages, changes)?;
            }
        }
        passages.sort_unstable_by(|a, b| a.enter.total_cmp(&b.enter));
        self.joined(passages, changes, crossings)
    }

    /// Adds the ways of a ray through up to eight copies of one part; `None` if one of them is uncertain.
    #[inline(always)]
    fn pass_copies<S: Simd>(
        &self,
        group: &mut BundleEvaluation<'_, S>,
        (ray, window): (Ray, Window),
        items: &[(u32, u32)],
        passages: &mut Vec<Passage>,
        changes: &mut Vec<(f64, i32)>,
    ) -> Option<()> {
        let (simd, (part, lead)) = (group.simd, *items.first()?);
        let part = &self.parts[part as usize];
        let Method::Plan(plan) = &part.method else { return None };
        let lead = self.steps(&self.objects[lead as usize]);
        let mut steps = [lead; LANES];
        for (steps, &(_, item)) in steps.iter_mut().zip(items) {
            *steps = self.steps(&self.objects[item as usize]);
            if steps.len() != lead.len() {
                return None;
            }
        }
        let (origin, direction) = (Vec3Lanes::splat(simd, ray.origin), Vec3Lanes::splat(simd, ray.direction));
        let carried = Carried::each(simd, origin, direction, &steps);
        let (local, mut uncertain) = carried.ready(simd, &part.limits);
        let found = group.run_copies(plan, (&local, &mut uncertain), &part.limits, window);
        let grazes = uncertain.grazes.to_bitmask();
        if found.uncertain & ((1 << items.len()) - 1) != 0 {
            return None;
        }
        // no change is farther than that: the ball of the limits is around the model
        let limits = &self.model.limits;
        let farthest = ray.closest_time(limits.centre).abs() + 2.0 * limits.radius / ray.direction.length();
        let longest = local.longest_coincident(splat(simd, farthest), &part.limits).to_array();
        for (lane, &(_, item)) in items.iter().enumerate() {
            let first = changes.len();
            for (times, numbers) in group.memory.times.iter().zip(&group.memory.numbers).take(found.most) {
                if numbers[lane] < 0 {
                    break;
                }
                changes.push((times.0[lane], numbers[lane]));
            }
            let starts_inside = found.starts[lane] != 0.0;
            let enter = if starts_inside { Some(f64::NEG_INFINITY) } else { changes.get(first).map(|c| c.0) };
            if let Some(enter) = enter {
                // the bound of welded pieces holds for other faces
                if grazes >> lane & 1 == 1 {
                    return None;
                }
                let changes = [first as u32, changes.len() as u32];
                passages.push(Passage { enter, changes, starts_inside, item, longest: longest[lane] });
            }
        }
        Some(())
    }

    /// Writes the crossings of solids in the order in which a ray enters them; `None` if two of them may overlap or touch.
    #[inline(always)]
    fn joined(
        &self,
        passages: &[Passage],
        changes: &[(f64, i32)],
        crossings: &mut Vec<Crossing>,
    ) -> Option<RegionId> {
        let starts_inside = passages.first().is_some_and(|passage| passage.starts_inside);
        let (mut inside, mut last) = (starts_inside, f64::NEG_INFINITY);
        for (k, passage) in passages.iter().enumerate() {
            // not if a time is not a number
            let is_apart = !inside && !passage.starts_inside && passage.enter - last > passage.longest;
            if k > 0 && !is_apart {
                return None;
            }
            let [first, end] = passage.changes.map(|k| k as usize);
            let placement = PlacementId(self.objects[passage.item as usize].placement);
            for &(t, number) in &changes[first..end] {
                let face = Face { placement, ..self.model.faces[number as usize] };
                let (before, after) = (RegionId(u32::from(inside)), RegionId(u32::from(!inside)));
                crossings.push(Crossing { t, face, left: face, entered: face, before, after });
                (inside, last) = (!inside, t);
            }
        }
        Some(RegionId(u32::from(starts_inside)))
    }
}
