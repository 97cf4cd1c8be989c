//! Solids in R^3, compared with the engine for three dimensions on equal trees and lines.

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{Affine as SpaceMap, Mat3, Vec3};
use rayweave_model::{Evaluator, Program, Query, RayBatch, Solid as Engine, Window};
use rayweave_rootray::{RootRay, Side};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{BoxFromCorners, Cylinder, HalfSpace, Primitive, Quadric, Slab, Sphere};
use rayweave_space::{Point, Solid, Tracer};
use rayweave_trace::Reference;
use std::sync::Arc;

type Rng = ChaCha8Rng;

#[derive(Clone)]
struct Pair {
    engine: Engine,
    space: Solid<3>,
}

fn pair(primitive: impl Into<Primitive>, space: Solid<3>) -> Pair {
    Pair { engine: Engine::from(primitive.into()), space }
}

/// A random number, optionally on a coarse grid, so that faces touch and lines lie in them.
fn number(rng: &mut Rng, grid: bool) -> f64 {
    if grid { f64::from(rng.random_range(-2..=2i32)) } else { rng.random_range(-2.0..2.0) }
}

fn point(rng: &mut Rng, grid: bool) -> Point<3> {
    std::array::from_fn(|_| number(rng, grid))
}

fn leaf(rng: &mut Rng, grid: bool) -> Pair {
    let radius = if grid { f64::from(rng.random_range(1..3u8)) } else { rng.random_range(0.3..2.0) };
    match rng.random_range(0..6u8) {
        0 => pair(Sphere::new(radius).unwrap(), Solid::ball(radius).unwrap()),
        1 => pair(Cylinder::new(radius, f64::INFINITY).unwrap(), Solid::cylinder(2, radius).unwrap()),
        2 => {
            let lo = point(rng, grid);
            let hi = lo.map(|x| x + radius);
            let engine = BoxFromCorners::new(Vec3::from_array(lo), Vec3::from_array(hi)).unwrap();
            pair(engine, Solid::box_from_corners(lo, hi).unwrap())
        }
        3 => {
            let normal = [1.0, number(rng, grid), number(rng, grid)];
            let offset = number(rng, grid);
            let engine = HalfSpace::new(Vec3::from_array(normal), offset).unwrap();
            pair(engine, Solid::half_space_below(normal, offset).unwrap())
        }
        4 => {
            let lo = number(rng, grid);
            let engine = Slab::new(Vec3::Y, lo, lo + radius).unwrap();
            pair(engine, Solid::slab(1, lo, lo + radius).unwrap())
        }
        _ => {
            let bias = number(rng, grid);
            let mut matrix = [[0.0; 4]; 4];
            [1.0, 1.0, -1.0, bias].into_iter().enumerate().for_each(|(k, entry)| matrix[k][k] = entry);
            pair(Quadric::new(matrix).unwrap(), Solid::quadric(3, 2, bias).unwrap())
        }
    }
}

/// The pair under the identity, a translation, a rotation, a scale or a shear.
fn moved(rng: &mut Rng, grid: bool, pair: Pair) -> Pair {
    let mut matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    match rng.random_range(0..5u8) {
        0 => return pair,
        1 => {}
        2 if grid => matrix = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        2 => {
            let turn = SpaceMap::rotation(Vec3::from_array(point(rng, false)), rng.random_range(0.0..360.0));
            matrix = turn.linear.transpose().to_cols_array_2d();
        }
        3 => matrix[rng.random_range(0..3usize)][rng.random_range(0..3usize)] = 2.0,
        _ => matrix.iter_mut().flatten().for_each(|entry| *entry += 0.4 * number(rng, grid)),
    }
    let shift = point(rng, grid);
    let map = SpaceMap {
        linear: Mat3::from_cols_array_2d(&matrix).transpose(),
        translation: Vec3::from_array(shift),
    };
    match pair.space.affine(matrix, shift) {
        Ok(space) => Pair { engine: pair.engine.apply(map), space },
        Err(_) => pair,
    }
}

fn tree(rng: &mut Rng, grid: bool) -> Pair {
    let mut pool: Vec<Pair> = (0..rng.random_range(1..8))
        .map(|_| {
            let leaf = leaf(rng, grid);
            moved(rng, grid, leaf)
        })
        .collect();
    while pool.len() > 1 {
        let a = pool.swap_remove(rng.random_range(0..pool.len()));
        let b = pool.swap_remove(rng.random_range(0..pool.len()));
        let (x, y) = (&a.engine, &b.engine);
        let joined = match rng.random_range(0..5u8) {
            0 => Pair { engine: x | y, space: a.space | b.space },
            1 => Pair { engine: x & y, space: a.space & b.space },
            2 => Pair { engine: x - y, space: a.space - b.space },
            3 => Pair { engine: x ^ y, space: a.space ^ b.space },
            _ => Pair { engine: !x | !y, space: !a.space | !b.space },
        };
        pool.push(joined);
    }
    pool.remove(0)
}

/// Lines along an asymptote of a cone cross it at a time of about 1e15 or never, by the rounding of their direction.
const FAR: f64 = 1e6;

#[derive(Debug, Default)]
struct Count {
    lines: usize,
    crossings: usize,
    /// Lines with different numbers of crossings or different sides.
    touching: usize,
    /// Lines with differences after removal of spans shorter than 1e-6.
    differ: Vec<String>,
}

fn equal(a: &RootRay, b: &RootRay) -> bool {
    let close = |(t, s): (f64, f64)| (t - s).abs() <= 2e-6 * (1.0 + t.abs());
    a.start() == b.start() && a.roots().len() == b.roots().len() && a.times().zip(b.times()).all(close)
}

fn compare(pair: &Pair, rng: &mut Rng, grid: bool, lines: usize, count: &mut Count) {
    let Ok(program) = Program::compile(&pair.engine) else { return };
    let reference = Reference::new(Arc::new(program));
    let mut tracer = Tracer::new(&pair.space).unwrap();
    for _ in 0..lines {
        let (p, mut q) = (point(rng, grid), point(rng, grid));
        if p == q {
            q[1] += 1.0;
        }
        let direction = Vec3::from_array(q) - Vec3::from_array(p);
        let ray = Ray::new(Vec3::from_array(p), direction);
        let query = Query { window: Window::new(-FAR, FAR).unwrap(), ..Query::default() };
        let want = reference.collect(RayBatch::from_iter([ray]).rays(), &query).unwrap();
        let got = tracer.trace(p, q).unwrap().clip(-FAR, FAR).unwrap();
        count.lines += 1;
        count.crossings += want.crossings.len();
        let side = if want.starts[0].0 == 0 { Side::Outside } else { Side::Inside };
        let want = RootRay::from_times(side, want.crossings.iter().map(|c| c.t)).unwrap();
        let got = got.map_surfaces(|_| ());
        if !equal(&got, &want) {
            // by rounding, a tangent of a sphere may have two crossings
            count.touching += 1;
            let coarse = |ray: &RootRay| ray.weld(|_, _| 1e-6);
            if !equal(&coarse(&got), &coarse(&want)) {
                count.differ.push(format!("{p:?} {q:?}\n  {got}\n  {want}"));
            }
        }
    }
}

fn compare_trees(seed: u64, trees: usize, lines: usize) -> Count {
    let (mut rng, mut count) = (Rng::seed_from_u64(seed), Count::default());
    for k in 0..trees {
        let grid = k % 2 == 1;
        let pair = tree(&mut rng, grid);
        compare(&pair, &mut rng, grid, lines, &mut count);
    }
    count.differ.iter().take(3).for_each(|text| println!("{text}\n"));
    println!("{} lines, {} crossings, {} touching", count.lines, count.crossings, count.touching);
    count
}

#[test]
fn trees_agree_with_the_engine() {
    let count = compare_trees(1, 600, 40);
    assert!(count.lines > 20_000 && count.crossings > count.lines);
    assert!(count.differ.is_empty(), "{} of {} differ", count.differ.len(), count.lines);
    assert!(count.touching * 1000 < count.lines);
}

#[test]
#[ignore = "long"]
fn long_trees_agree_with_the_engine() {
    let count = compare_trees(2, 40_000, 50);
    assert!(count.differ.is_empty(), "{} of {} differ", count.differ.len(), count.lines);
    assert!(count.touching * 1000 < count.lines);
}
