//! Rays that leave a surface where they met it, a thousand times over: nothing is hit twice, nothing leaks.

use crate::models::{compiled, motion, shape};
use crate::rays::batch;
use crate::{Effort, Random, Tally, list};
use rayweave_math::{Affine, Vec3};
use rayweave_model::weld::local_ray;
use rayweave_model::{
    Collected, Crossing, Evaluator, Face, LeafKind, Limit, PlacementId, Program, Query, RegionId, Solid,
    Start, StartLists, dress,
};
use rayweave_shape::Ray;
use rayweave_shape::surface::delta;
use std::sync::Arc;

/// Inside mirrors of sizes from 1e-8 to 1e8 (a box, a ball, a rod, a ring, each also placed as an instance): every
/// bounce meets the wall from inside, at a place that is on it, and the box is seen as unfolded space.
pub fn in_mirrors<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("bounces in mirrors");
    for seed in 0..effort.of(120, 12_000) {
        let mut rng = Random::new(12_000_000 + seed);
        let size = libm::pow(10.0, rng.between(-8.0, 8.0));
        let frame = Affine::scale(Vec3::splat(size)).then(&motion(&mut rng).scaled_translation(size));
        let solid = mirror(&mut rng, seed);
        let solid = match rng.chance(0.3) {
            // a second copy, far away
            true => solid.place([frame, frame.then(&Affine::translate(Vec3::splat(30.0 * size)))]),
            false => solid.apply(frame),
        };
        let program = compiled(Program::compile(&solid));
        let start = first_ray(&mut rng, seed).transformed(&frame);
        let walk = Walk { program: &program, evaluator: make(program.clone()), seed, size };
        walk.run(start, 1000, &mut tally);
    }
    tally.finish(effort.of(100_000, 10_000_000));
}

trait ScaledTranslation {
    fn scaled_translation(self, by: f64) -> Self;
}

impl ScaledTranslation for Affine {
    fn scaled_translation(mut self, by: f64) -> Affine {
        self.translation *= by;
        self
    }
}

fn mirror(rng: &mut Random, seed: u64) -> Solid {
    match seed % 5 {
        0 | 1 => shape("box", &[("size", 2.0)]).scale([1.0, rng.between(0.1, 3.0), 1.0]),
        2 => shape("sphere", &[("radius", 1.0)]),
        3 => shape("cylinder", &[("radius", 1.0), ("height", 1.5)]),
        _ => shape("torus", &[("major", 1.0), ("minor", 0.4)]),
    }
}

/// From inside; into edges and corners, along walls, anywhere.
fn first_ray(rng: &mut Random, seed: u64) -> Ray {
    if seed % 5 == 4 {
        return Ray::new(Vec3::new(1.0, 0.0, 0.0), rng.direction());
    }
    let origin = if rng.chance(0.3) { Vec3::ZERO } else { 0.09 * rng.point(1.0) };
    let direction = match rng.below(5) {
        0 => Vec3::new(1.0, 1.0, 0.0),
        1 => Vec3::new(1.0, rng.magnitude(-15.0, -3.0), rng.magnitude(-15.0, -3.0)),
        2 => Vec3::ONE + rng.magnitude(-17.0, -12.0) * rng.direction(),
        _ => rng.direction(),
    };
    Ray::new(origin, direction)
}

struct Walk<'p, E> {
    program: &'p Program,
    evaluator: E,
    seed: u64,
    size: f64,
}

impl<E: Evaluator> Walk<'_, E> {
    fn run(&self, mut ray: Ray, bounces: usize, tally: &mut Tally) {
        let mut starts: Vec<Start> = Vec::new();
        let mut scratch = self.evaluator.scratch();
        let mut at_once = 0;
        for bounce in 0..bounces {
            let first = [0, starts.len() as u32];
            let lists = (!starts.is_empty()).then_some(StartLists { first: &first, entries: &starts });
            let query = Query { limit: Limit::First, starts: lists, ..Query::nearest() };
            let mut found = Collected::default();
            self.evaluator.crossings(batch(&[ray]).rays(), &query, &mut scratch, &mut found);
            let leaves = |c: &Crossing| c.before == RegionId(1) && c.after == RegionId(0);
            let crossing = found.of(0).first().copied().filter(leaves);
            at_once = match &crossing {
                Some(c) if c.t == 0.0 => at_once + 1,
                _ => 0,
            };
            // what is met at once was found near when the list was made, by the tolerance at that time
            let listed = |face: Face| {
                starts.iter().any(|s| (s.surface, s.placement) == (face.surface, face.placement))
            };
            let on_the_wall = crossing.is_some_and(|c| match c.t == 0.0 {
                true => listed(c.face),
                false => self.is_on(c.face, &ray, c.t),
            });
            let right = found.starts[0] == RegionId(1) && on_the_wall && at_once <= 3;
            tally.check(right, || {
                format!(
                    "seed {}, size {:e}, bounce {bounce}: {ray:?} from {starts:?}: {:?}{}",
                    self.seed,
                    self.size,
                    found.starts[0],
                    list(found.of(0))
                )
            });
            let (true, Some(crossing)) = (right, crossing) else { return };
            let (next, listed) = self.bounced(&ray, &crossing);
            // crossed at once: the point has not moved, so what it lay on it lies on still, though the tolerance
            // at t = 0 is smaller than the one at the time of arrival
            starts.retain(|_| crossing.t == 0.0);
            starts.extend(listed.into_iter().filter(|new| !starts.contains(new)).collect::<Vec<_>>());
            ray = next;
        }
    }

    fn is_on(&self, face: Face, ray: &Ray, t: f64) -> bool {
        let (local, reach) = local_ray(self.program, ray, face.placement);
        let entry = self.program.surface(face.surface);
        let (value, gradient) = entry.surface.value_and_gradient(local.at(t));
        value.abs() <= delta(entry.reach + reach, &local, t) * gradient.length()
    }

    /// The reflected ray from a point put onto the face by one Newton step, and the faces that it starts on: all
    /// within the tolerance, on the side where it was, that is inside.
    fn bounced(&self, ray: &Ray, crossing: &Crossing) -> (Ray, Vec<Start>) {
        let normal = dress::normal(self.program, ray, crossing);
        let mut starts = Vec::new();
        for placement in 0..self.program.prototypes()[0].placements {
            let placement = PlacementId(placement);
            let (_, group) = self.program.placement(placement);
            let leaves = self.program.prototype(group).leaves.clone();
            for leaf in &self.program.leaves()[leaves.start as usize..leaves.end as usize] {
                let LeafKind::Shape { facets, .. } = &leaf.kind else { continue };
                for facet in &self.program.facets()[facets.start as usize..facets.end as usize] {
                    let face = Face { surface: facet.surface, placement, ..crossing.face };
                    if self.is_on(face, ray, crossing.t) {
                        starts.push(Start { surface: facet.surface, placement, inside: facet.inside });
                    }
                }
            }
        }
        let (local, _) = local_ray(self.program, ray, crossing.face.placement);
        let surface = &self.program.surface(crossing.face.surface).surface;
        let (value, gradient) = surface.value_and_gradient(local.at(crossing.t));
        let steps = self.program.descend(crossing.face.placement);
        let across = steps.fold(normal, |n, place| place.local_from_world.vector(n));
        let point = ray.at(crossing.t) - value / gradient.dot(across) * normal;
        let direction = ray.direction - 2.0 * ray.direction.dot(normal) * normal;
        (Ray::new(point, direction * (ray.direction.length() / direction.length())), starts)
    }
}
