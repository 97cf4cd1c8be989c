//! Re-hit test: rays that continue from the surface they hit, a thousand times. None hits a surface twice or
//! leaks.

use crate::models::{block, compiled, motion, shape};
use crate::oracle::{Oracle, Probe, Side};
use crate::rays::batch;
use crate::{Effort, Random, Tally, list};
use rayweave_math::{Affine, Vec3};
use rayweave_model::weld::local_ray;
use rayweave_model::{
    Collected, Crossing, Evaluator, Face, LeafId, Limit, PlacementId, Program, Query, RegionId, Solid, Start,
    StartLists, attributes,
};
use rayweave_shape::Ray;
use rayweave_shape::primitive::Primitive;
use rayweave_shape::surface::delta;
use std::sync::Arc;

/// Bounces inside mirrors of sizes from 1e-8 to 1e8: each of the shapes, boxes with rays into edges and
/// corners, solids of parts in contact; each also placed as an instance. Every bounce hits the wall from
/// inside, at a point on it, and no face between parts.
pub fn in_mirrors<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("bounces in mirrors");
    let rounds = effort.of(5, 500);
    for seed in 0..rounds * KINDS {
        let mut rng = Random::new(12_000_000 + seed);
        let size = libm::pow(10.0, rng.between(-8.0, 8.0));
        let frame = Affine::scale(Vec3::splat(size)).then(&motion(&mut rng).scaled_translation(size));
        let (solid, start) = mirror(&mut rng, seed % KINDS);
        let solid = match rng.chance(0.3) {
            // a second copy, far away
            true => solid.place([frame, frame.then(&Affine::translate(Vec3::splat(300.0 * size)))]),
            false => solid.apply(frame),
        };
        let program = compiled(Program::compile(&solid));
        let walk = Walk { program: &program, evaluator: make(program.clone()), seed, size };
        walk.run(start.transformed(&frame), 1000, &mut tally);
    }
    tally.finish(900 * rounds * KINDS);
}

/// Number of kinds of mirrors: arrangements and shapes.
const KINDS: u64 = ARRANGED + 15;

/// Number of arrangements among them.
const ARRANGED: u64 = 10;

trait ScaledTranslation {
    fn scaled_translation(self, by: f64) -> Self;
}

impl ScaledTranslation for Affine {
    fn scaled_translation(mut self, by: f64) -> Affine {
        self.translation *= by;
        self
    }
}

/// A solid whose boundary is the mirror, and a ray inside.
fn mirror(rng: &mut Random, kind: u64) -> (Solid, Ray) {
    let ball = shape("sphere", &[("radius", 1.0)]);
    let rod = shape("cylinder", &[("radius", 1.0), ("height", 1.5)]);
    match kind {
        0..4 => {
            let half = Vec3::new(1.0, rng.between(0.1, 3.0), 1.0);
            (block(-half, half), into_the_corner(rng, kind, half))
        }
        4 => (ball, ray_from(rng, Vec3::ZERO)),
        5 => (rod, ray_from(rng, Vec3::ZERO)),
        6 => (shape("torus", &[("major", 1.0), ("minor", 0.4)]), ray_from(rng, Vec3::X)),
        // parts in contact: boxes in a row, sectors of a rod, a pin in its hole
        7 => {
            let half = Vec3::new(0.5, 1.0, 1.0);
            let cells = [-1.0, 0.0, 1.0].map(|x| block(Vec3::X * x - half, Vec3::X * x + half));
            (Solid::union(cells), into_the_corner(rng, 1, Vec3::new(1.5, 1.0, 1.0)))
        }
        8 => {
            let sector = |start: f64| shape("wedge", &[("start_degrees", start), ("sweep_degrees", 120.0)]);
            (
                Solid::union([10.0, 130.0, 250.0].map(|start| sector(start) & &rod)),
                ray_from(rng, Vec3::new(0.3, 0.2, 0.1)),
            )
        }
        9 => {
            let pin = shape("cylinder", &[("radius", 0.5), ("height", 2.0)]);
            let cube = block(Vec3::splat(-1.0), Vec3::ONE);
            ((cube - &pin) | pin, into_the_corner(rng, 1, Vec3::ONE))
        }
        _ => example(rng, (kind - ARRANGED) as usize),
    }
}

/// The example of a shape, intersected with a box if it is unbounded, and a ray from a point inside.
fn example(rng: &mut Random, kind: usize) -> (Solid, Ray) {
    let solid = Solid::from(Primitive::examples().swap_remove(kind));
    let bounds = compiled(Program::compile(&solid)).bounds();
    let sizes = [bounds.lo.to_array(), bounds.hi.to_array()].concat().into_iter().map(f64::abs);
    let half = Vec3::splat(1.25 * sizes.filter(|x| x.is_finite()).fold(1.0, f64::max));
    let solid = if bounds.is_finite() { solid } else { solid & block(-half, half) };
    let inside = Oracle::new(&solid);
    let drawn = std::iter::repeat_with(|| rng.point(half.x));
    let point = drawn.take(100_000).find(|&point| inside.side(Probe { point, origin: 0.0 }) == Side::Inside);
    let point = point.unwrap_or_else(|| panic!("no point is inside {solid:?}"));
    (solid, Ray::new(point, rng.direction()))
}

/// A ray from near a point, in any direction or nearly along an axis.
fn ray_from(rng: &mut Random, point: Vec3) -> Ray {
    let origin = if rng.chance(0.3) { point } else { point + 0.09 * rng.point(1.0) };
    let direction = match rng.below(3) {
        0 => Vec3::new(1.0, rng.magnitude(-15.0, -3.0), rng.magnitude(-15.0, -3.0)),
        _ => rng.direction(),
    };
    Ray::new(origin, direction)
}

/// A ray from the middle of a box into an edge or a corner, exactly or nearly, or in a random direction.
fn into_the_corner(rng: &mut Random, kind: u64, half: Vec3) -> Ray {
    let signs = Vec3::new(rng.pick(&[1.0, -1.0]), rng.pick(&[1.0, -1.0]), rng.pick(&[1.0, -1.0]));
    let corner = half * signs;
    match kind {
        0 => Ray::new(Vec3::ZERO, Vec3::new(corner.x, corner.y, rng.pick(&[0.0, 0.0, 0.3]))),
        1 => Ray::new(Vec3::ZERO, corner),
        2 => Ray::new(Vec3::ZERO, corner + rng.magnitude(-17.0, -12.0) * rng.direction()),
        _ => ray_from(rng, Vec3::ZERO),
    }
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
            // a crossing at t = 0 belongs to a face that was listed as near, by the tolerance at the time of
            // arrival
            let listed = |face: Face| {
                starts.iter().any(|s| (s.surface, s.placement) == (face.surface, face.placement))
            };
            let on_the_wall = crossing.is_some_and(|c| match c.t == 0.0 {
                true => listed(c.face),
                false => self.is_on(c.face, &ray, c.t),
            });
            // at most once for each listed face
            let right = found.starts[0] == RegionId(1) && on_the_wall && at_once <= starts.len();
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
            // after a crossing at t = 0 the point has not moved, so it still lies on the listed faces,
            // although the tolerance at t = 0 is smaller than the one at the time of arrival
            starts.retain(|_| crossing.t == 0.0);
            starts.extend(listed.into_iter().filter(|new| !starts.contains(new)).collect::<Vec<_>>());
            ray = next;
        }
    }

    fn is_on(&self, face: Face, ray: &Ray, t: f64) -> bool {
        let (local, magnitude) = local_ray(self.program, ray, face.placement);
        let entry = self.program.surface(face.surface);
        let (value, gradient) = entry.surface.value_and_gradient(local.at(t));
        value.abs() <= delta(entry.magnitude + magnitude, &local, t) * gradient.length()
    }

    /// The reflected ray, from the point projected onto the face by one Newton step, and the faces on which
    /// it starts: all within the tolerance, with the ray on their inner side.
    fn bounced(&self, ray: &Ray, crossing: &Crossing) -> (Ray, Vec<Start>) {
        let normal = attributes::normal(self.program, ray, crossing);
        let mut starts = Vec::new();
        for placement in 0..self.program.prototypes()[0].placements {
            let placement = PlacementId(placement);
            let (_, group) = self.program.placement(placement);
            let leaves = self.program.prototype(group).leaves.clone();
            for leaf in leaves {
                for facet in self.program.leaf(LeafId(leaf)).facets() {
                    let face = Face { surface: facet.surface(), placement, ..crossing.face };
                    if self.is_on(face, ray, crossing.t) {
                        starts.push(Start { surface: facet.surface(), placement, inside: facet.inside() });
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
