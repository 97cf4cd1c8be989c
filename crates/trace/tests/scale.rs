//! Models of hundreds of leaves: culling, early termination and piecewise tracing of placed solids change no
//! bit of any answer.

use rayweave_conformance::{Random, scale};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{
    Crossing, Evaluator, Limit, Program, Query, RayBatch, Region, RegionId, Solid, Start, StartLists, Window,
};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::{Reference, Weave};
use std::sync::Arc;

fn shape(name: &str, arguments: &[(&str, Value)]) -> Solid {
    Solid::from(build(name, arguments).unwrap())
}

fn cube(size: f64, at: Vec3) -> Solid {
    shape("box", &[("size", Value::Number(size))]).translate(at)
}

/// Cubes on a grid that share faces, combined by union, difference and symmetric difference.
fn tiles(rng: &mut Random) -> Solid {
    let mut solid = Solid::empty();
    let cells = (0..343).map(|k| Vec3::new((k % 7) as f64, (k / 7 % 7) as f64, (k / 49) as f64));
    for cell in cells {
        let tile = cube(2.0 / 7.0, (cell - 3.0) * (2.0 / 7.0));
        solid = match rng.below(8) {
            0 => continue,
            1 => solid - tile.translate([1.0 / 7.0, 0.0, 0.0]),
            2 => solid ^ tile.scale(Vec3::splat(2.0)),
            _ => solid | tile,
        };
    }
    solid
}

/// A lattice of lattices: placed solids with enough leaves to be traced piece by piece.
fn nested(rng: &mut Random) -> Solid {
    let small = scale::lattice(125) - scale::spheres(50, 5);
    let half = |at: Vec3| Affine::scale(Vec3::splat(0.4)).then(&Affine::translate(at));
    let turned = |at: Vec3, rng: &mut Random| Affine::rotation(rng.direction(), 50.0).then(&half(at));
    let mut maps: Vec<Affine> =
        (0..8).map(|k| half(Vec3::new((k % 2) as f64, (k / 2 % 2) as f64, (k / 4) as f64) - 0.5)).collect();
    maps.extend((0..4).map(|_| turned(rng.point(0.5), rng)));
    small.place(maps)
}

/// Solids with unbounded parts, some of them cut to boxes.
fn endless(rng: &mut Random) -> Solid {
    let half = |rng: &mut Random| {
        shape(
            "half_space",
            &[("normal", rng.direction().into()), ("offset", Value::Number(rng.between(-0.5, 0.5)))],
        )
    };
    let rod = |rng: &mut Random| {
        let rod = shape("cylinder", &[("radius", Value::Number(0.05))]);
        rod.apply(
            Affine::rotation(rng.direction(), rng.between(0.0, 180.0))
                .then(&Affine::translate(rng.point(1.0))),
        )
    };
    let rods = Solid::union((0..60).map(|_| rod(rng)));
    let most = scale::spheres(200, 9) & half(rng);
    (most ^ (rods.clone() & cube(1.5, Vec3::ZERO))) | (rods - half(rng) - cube(2.0, Vec3::ZERO))
}

/// Parts with media, later ones over earlier ones.
fn regions(rng: &mut Random) -> Vec<Region> {
    let region = |k: usize, solid: Solid| Region { name: format!("r{k}"), solid, medium: k as u32 % 3 };
    let solids = [scale::plate(100), tiles(rng), scale::spheres(100, 3), nested(rng), scale::sponge(60)];
    solids.into_iter().enumerate().map(|(k, solid)| region(k, solid)).collect()
}

fn models() -> Vec<(&'static str, Vec<Region>)> {
    let rng = &mut Random::new(1);
    let alone = |solid: Solid| vec![Region { name: "solid".into(), solid, medium: 1 }];
    let cloud = scale::spheres(400, 2);
    vec![
        ("spheres", alone(cloud.clone())),
        ("far", alone(cloud.scale(Vec3::splat(1e-6)).translate([3.0, -1e3, 10.0]))),
        ("plate", alone(scale::plate(300))),
        ("sponge", alone(scale::sponge(300))),
        ("lattice", alone(scale::lattice(216))),
        ("affine", alone(scale::lattice_affine(216, 4))),
        ("tiles", alone(tiles(rng))),
        ("nested", alone(nested(rng))),
        ("nested twice", alone(nested(rng).place([Affine::IDENTITY, Affine::scale(Vec3::splat(1.5))]))),
        ("endless", alone(endless(rng))),
        ("regions", regions(rng)),
    ]
}

/// Rays in random directions and along the grids, from inside, outside and far away.
fn rays(rng: &mut Random, program: &Program, count: usize) -> Vec<Ray> {
    let bounds = program.bounds();
    let (centre, half) = match bounds.is_finite() {
        true => (bounds.centre(), 0.5 * bounds.size().max_element()),
        false => (Vec3::ZERO, 1.0),
    };
    let ray = |k: usize| {
        let through = centre + rng.point(half);
        let grid = |rng: &mut Random| (rng.below(29) as f64 - 14.0) / 14.0 * half;
        let direction = match k % 3 {
            0 => rng.pick(&[Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Z]),
            1 => rng.direction() * rng.magnitude(-3.0, 3.0),
            _ => rng.direction(),
        };
        let through = match k % 6 {
            0 => centre + Vec3::new(grid(rng), grid(rng), grid(rng)),
            _ => through,
        };
        let way = rng.pick(&[0.0, 1.0, 3.0, 1e4]) * half / direction.length();
        Ray::new(through - way * direction, direction)
    };
    (0..count).map(ray).collect()
}

/// A model with both evaluators.
struct Pair {
    name: &'static str,
    ours: Weave,
    theirs: Reference,
}

type Found = (RegionId, Vec<Crossing>);

impl Pair {
    /// The common answer of both evaluators; panics if they differ.
    fn trace(&self, ray: Ray, query: &Query<'_>) -> Found {
        let theirs = self.theirs.one(ray, query).unwrap();
        let ours = self.ours.one(ray, query).unwrap();
        assert_eq!(ours, theirs, "{}: {ray:?}, {query:?}", self.name);
        (ours.starts[0], ours.crossings)
    }

    fn windows(&self, ray: Ray, all: &[Crossing], rng: &mut Random) {
        let unit = 1.0 / ray.direction.length();
        let time = |rng: &mut Random| match rng.below(4) {
            0 | 1 if !all.is_empty() => {
                let t = all[rng.below(all.len())].t;
                rng.pick(&[t, t.next_up(), t.next_down()])
            }
            2 if all.len() > 1 => {
                let k = rng.below(all.len() - 1);
                0.5 * (all[k].t + all[k + 1].t)
            }
            _ => rng.between(-4.0, 4.0) * unit,
        };
        for _ in 0..3 {
            let (a, b) = (time(rng), time(rng));
            let b = if rng.chance(0.4) { f64::INFINITY } else { b };
            let Ok(window) = Window::new(a.min(b), a.max(b)) else { continue };
            for limit in [Limit::All, Limit::First] {
                self.trace(ray, &Query { window, limit, starts: None });
            }
        }
    }

    /// Traces from crossing to crossing, one query each.
    fn steps(&self, ray: Ray, all: &[Crossing]) {
        let (mut t_min, mut steps) = (f64::NEG_INFINITY, Vec::new());
        while let Ok(window) = Window::new(t_min, f64::INFINITY) {
            let query = Query { window, limit: Limit::First, starts: None };
            let (_, found) = self.trace(ray, &query);
            let Some(&crossing) = found.first() else { break };
            (t_min, _) = (crossing.t, steps.push(crossing));
            if steps.len() > 12 {
                break;
            }
        }
        let end = steps.len().min(12);
        assert_eq!(steps[..end], all[..end], "{}: {ray:?}", self.name);
    }

    /// Traces rays that leave the surface of a crossing, forwards or reversed.
    fn leaving_a_surface(&self, ray: Ray, all: &[Crossing], rng: &mut Random) {
        let Some(crossing) = (!all.is_empty()).then(|| all[rng.below(all.len())]) else { return };
        let direction = if rng.chance(0.5) { ray.direction } else { -ray.direction };
        let face = crossing.face;
        let start = Start { surface: face.surface, placement: face.placement, inside: rng.chance(0.5) };
        let starts = StartLists { first: &[0, 1], entries: &[start] };
        let window = Window::new(rng.pick(&[0.0, -1.0, 1e-3]), f64::INFINITY).unwrap();
        for limit in [Limit::All, Limit::First] {
            self.trace(
                Ray::new(ray.at(crossing.t), direction),
                &Query { window, limit, starts: Some(starts) },
            );
        }
    }

    fn check(&self, ray: Ray, rng: &mut Random) -> usize {
        let (_, all) = self.trace(ray, &Query::default());
        self.steps(ray, &all);
        self.windows(ray, &all, rng);
        self.leaving_a_surface(ray, &all, rng);
        all.len()
    }
}

fn check(count: usize) {
    for (name, regions) in models() {
        let program = Arc::new(Program::compile_regions(&regions).unwrap());
        let pair = Pair { name, ours: Weave::new(program.clone()), theirs: Reference::new(program.clone()) };
        let rng = &mut Random::new(3);
        let crossings: usize = rays(rng, &program, count).into_iter().map(|ray| pair.check(ray, rng)).sum();
        assert!(crossings > count, "{name}: only {crossings} crossings");
    }
}

#[test]
fn answers_are_those_of_the_reference() {
    check(60);
}

#[test]
#[ignore = "long"]
fn long_answers_are_those_of_the_reference() {
    check(1000);
}

#[test]
fn points_are_in_the_regions_of_the_reference() {
    for (name, regions) in models() {
        let program = Arc::new(Program::compile_regions(&regions).unwrap());
        let (ours, theirs) = (Weave::new(program.clone()), Reference::new(program.clone()));
        let rng = &mut Random::new(4);
        let bounds = program.bounds();
        let bounds =
            if bounds.is_finite() { bounds } else { rayweave_math::Bounds::centred(Vec3::ZERO, Vec3::ONE) };
        let (mut inside, count) = (0, 60);
        for _ in 0..count {
            let point = bounds.centre() + 0.5 * bounds.size() * rng.point(1.0);
            let both = (ours.contains(point), theirs.contains(point));
            assert_eq!(both.0, both.1, "{name}: {point}");
            inside += usize::from(both.0.unwrap());
        }
        assert!(inside > 0 && inside < count, "{name}: {inside} of {count} points");
    }
}

/// A ray that slowly descends into a block, and leaves it again where cubes are subtracted whose tops are
/// within rounding of the block's: the two faces are far apart along the ray, and the boxes of the cubes
/// begin after the first. The piece between them is a sliver, so that the traversal must look ahead.
#[test]
fn slivers_far_along_the_ray_are_seen() {
    let rng = &mut Random::new(8);
    let block = cube(2.0, Vec3::ZERO);
    // placed solids do not share their faces with others
    let mut tooth = |k: usize| Vec3::new(-0.5 + 0.1 * k as f64, 0.0, 0.5 - rng.between(0.0, 4e-14));
    let teeth = shape(
        "box_from_corners",
        &[("lo", Vec3::new(-0.02, -1.0, -0.5).into()), ("hi", Vec3::new(0.02, 1.0, 0.5).into())],
    );
    let solid = block - teeth.place((0..15).map(&mut tooth).map(Affine::translate).collect::<Vec<_>>());
    let program = Arc::new(Program::compile(&solid).unwrap());
    let pair = Pair { name: "slivers", ours: Weave::new(program.clone()), theirs: Reference::new(program) };
    let mut slivers = 0;
    for _ in 0..3000 {
        let slope = libm::pow(10.0, rng.between(-14.0, -12.5));
        let direction = Vec3::new(1.0, 0.0, -slope);
        let enters = Vec3::new(rng.between(-0.6, 1.0), rng.between(-0.9, 0.9), 1.0);
        let ray = Ray::new(enters - 1.5 * direction, direction);
        let query = Query { limit: Limit::First, ..Query::nearest() };
        let (_, found) = pair.trace(ray, &query);
        // the time at which the ray crosses the top of the block
        let top = (1.0 - ray.origin.z) / direction.z;
        let in_tooth = (0..15).any(|k| (enters.x + 0.5 - 0.1 * k as f64).abs() < 0.03);
        slivers += usize::from(!in_tooth && found.first().is_none_or(|crossing| crossing.t > top + 0.01));
    }
    assert!(slivers > 50, "{slivers} slivers");
}

/// A scratch used for all rays gives the answers of a fresh one: early termination leaves no state behind.
#[test]
fn a_walk_that_stops_leaves_nothing_behind() {
    let program =
        Arc::new(Program::compile(&(nested(&mut Random::new(6)) | endless(&mut Random::new(7)))).unwrap());
    let weave = Weave::new(program.clone());
    let mut scratch = weave.scratch();
    let rng = &mut Random::new(5);
    for ray in rays(rng, &program, 300) {
        let limit = rng.pick(&[Limit::All, Limit::First]);
        let query = Query { limit, ..Query::nearest() };
        let mut again = rayweave_model::Collected::default();
        weave.crossings(RayBatch::from_iter([ray]).rays(), &query, &mut scratch, &mut again);
        assert_eq!(again, weave.one(ray, &query).unwrap(), "{ray:?}");
    }
}
