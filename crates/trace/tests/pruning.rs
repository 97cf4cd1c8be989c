//! Pruning: models whose parts are disjoint, touch or overlap along rays. The prepared model is compared with
//! the original tree, evaluated from the crossings of each leaf alone.

use rayweave_conformance::Random;
use rayweave_math::Vec3;
use rayweave_model::simplify::{FormulaSize, Preparation};
use rayweave_model::{Evaluator, Program, Query, Region, RegionId, Solid};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::{Packets, Reference, SingleHit, Spans, Weave};
use std::sync::Arc;

fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|&(n, v)| (n, Value::Number(v))).collect();
    Solid::from(build(name, &arguments).unwrap())
}

/// A leaf at integer coordinates, so that many faces coincide.
fn leaf(rng: &mut Random) -> Solid {
    let size = 1.0 + rng.below(3) as f64;
    let at = Vec3::new(rng.below(9) as f64, rng.below(3) as f64, rng.below(3) as f64);
    let solid = match rng.below(8) {
        0 => shape("sphere", &[("radius", size)]),
        1 => shape("cylinder", &[("radius", size)]),
        2 => shape("cylinder", &[("radius", size), ("height", 2.0)]),
        3 => Solid::from(
            build(
                "half_space",
                &[("normal", Value::Vector(vec![1.0, 0.0, 0.0])), ("offset", Value::Number(0.0))],
            )
            .unwrap(),
        ),
        _ => shape("box", &[("size", 2.0 * size)]),
    };
    solid.translate(at)
}

/// An operator of the original tree; operands are indices of earlier nodes.
enum Written {
    Leaf(usize),
    Not(usize),
    Or(usize, usize),
    And(usize, usize),
    Less(usize, usize),
    Xor(usize, usize),
}

/// A random tree over leaves, and the same as a solid.
fn tree(rng: &mut Random, leaves: &[Solid]) -> (Vec<Written>, Solid) {
    let mut tree: Vec<Written> = (0..leaves.len()).map(Written::Leaf).collect();
    let mut solids: Vec<Solid> = leaves.to_vec();
    let mut open: Vec<usize> = (0..leaves.len()).collect();
    while open.len() > 1 {
        let a = open.swap_remove(rng.below(open.len()));
        // a part may be used twice
        let b = if rng.chance(0.2) { rng.below(tree.len()) } else { open.swap_remove(rng.below(open.len())) };
        let (left, right) = (solids[a].clone(), solids[b].clone());
        let (node, solid) = match rng.below(10) {
            0..3 => (Written::Or(a, b), left | right),
            3..5 => (Written::And(a, b), left & right),
            5..8 => (Written::Less(a, b), left - right),
            8 => (Written::Xor(a, b), left ^ right),
            _ => {
                open.push(b);
                (Written::Not(a), !left)
            }
        };
        open.push(tree.len());
        tree.push(node);
        solids.push(solid);
    }
    (tree, solids[open[0]].clone())
}

/// The value of node `root` of the tree.
fn value(tree: &[Written], root: usize, leaves: &[bool]) -> bool {
    let mut values: Vec<bool> = Vec::with_capacity(tree.len());
    for node in &tree[..=root] {
        values.push(match *node {
            Written::Leaf(k) => leaves[k],
            Written::Not(a) => !values[a],
            Written::Or(a, b) => values[a] || values[b],
            Written::And(a, b) => values[a] && values[b],
            Written::Less(a, b) => values[a] && !values[b],
            Written::Xor(a, b) => values[a] != values[b],
        });
    }
    values[root]
}

/// The side of a solid at the beginning of a ray, and the times of its crossings.
type Line = (bool, Vec<f64>);

fn trace(evaluator: &impl Evaluator, ray: Ray) -> Line {
    let found = evaluator.one(ray, &Query::default()).unwrap();
    (found.starts[0] != RegionId(0), found.crossings.iter().map(|crossing| crossing.t).collect())
}

/// The line of the tree, from the lines of the leaves: all boundary events at one time are applied at once.
fn by_long_hand(tree: &[Written], lines: &[Line]) -> Line {
    let root = tree.len() - 1;
    let mut inside: Vec<bool> = lines.iter().map(|line| line.0).collect();
    let start = value(tree, root, &inside);
    let mut times: Vec<f64> = lines.iter().flat_map(|line| line.1.iter().copied()).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let (mut now, mut crossings) = (start, Vec::new());
    for t in times {
        for (inside, line) in inside.iter_mut().zip(lines) {
            *inside ^= line.1.contains(&t);
        }
        if value(tree, root, &inside) != now {
            now = !now;
            crossings.push(t);
        }
    }
    (start, crossings)
}

/// A ray in a random direction, or along x through the interior of coincident faces.
fn ray(rng: &mut Random) -> Ray {
    let through = Vec3::new(4.0, 1.0, 1.0) + rng.point(4.0);
    if rng.chance(0.5) {
        let direction = rng.direction();
        return Ray::new(through - rng.between(-20.0, 20.0) * direction, direction);
    }
    // no face lies at these coordinates
    let half = |rng: &mut Random| rng.below(6) as f64 - 1.5 + 0.25 * rng.uniform();
    Ray::new(Vec3::new(-8.0, half(rng), half(rng)), Vec3::X)
}

fn check(models: u64, rays: usize) {
    let mut unused = 0;
    for seed in 0..models {
        let rng = &mut Random::new(seed);
        let leaves: Vec<Solid> = (0..2 + rng.below(7)).map(|_| leaf(rng)).collect();
        let (tree, solid) = tree(rng, &leaves);
        let alone: Vec<Weave> = leaves.iter().map(|leaf| Weave::new(compiled(leaf))).collect();
        let program = compiled(&solid);
        unused += program.leaves().filter(|leaf| !leaf.is_used()).count();
        let (reference, weave) = (Reference::new(program.clone()), Weave::new(program.clone()));
        let packets = Packets::new(program.clone());
        let (spans, single_hit) = (Spans::new(program.clone()), SingleHit::new(program).unwrap());
        for _ in 0..rays {
            let ray = ray(rng);
            let lines: Vec<Line> = alone.iter().map(|leaf| trace(leaf, ray)).collect();
            let expected = by_long_hand(&tree, &lines);
            let context = || format!("model {seed}, {ray:?}: {solid}");
            assert_eq!(trace(&reference, ray), expected, "reference, {}", context());
            assert_eq!(trace(&weave, ray), expected, "weave, {}", context());
            assert_eq!(trace(&packets, ray), expected, "packets, {}", context());
            assert_eq!(trace(&spans, ray), expected, "spans, {}", context());
            assert_eq!(trace(&single_hit, ray), expected, "single_hit, {}", context());
        }
    }
    assert!(unused as u64 > models / 2, "only {unused} leaves were pruned of {models} models");
}

fn compiled(solid: &Solid) -> Arc<Program> {
    Arc::new(Program::compile(solid).unwrap())
}

#[test]
fn unused_leaves_do_not_matter() {
    check(400, 30);
}

#[test]
#[ignore = "long"]
fn long_unused_leaves_do_not_matter() {
    check(40_000, 100);
}

#[test]
fn parts_within_rounding_of_each_other_are_used() {
    let unit = shape("box", &[("size", 2.0)]);
    // gaps from an ulp to a thousand tolerances, near the origin and far from it
    for (far, gap, used) in [
        (0.0, 0.0, 2),
        (0.0, 2.0_f64.powi(-50), 2),
        (1024.0, 2.0_f64.powi(-40), 2),
        (0.0, 1e-6, 1),
        (1024.0, 1e-6, 1),
        (1e9, 1e-6, 2),
    ] {
        let solid = unit.translate([far, 0.0, 0.0]) - unit.translate([far + 2.0 + gap, 0.0, 0.0]);
        let region = Region { name: "part".into(), solid, medium: 1 };
        let size = Preparation::of_regions(&[region]).unwrap()[0].sizes().1;
        let operators = used - 1;
        assert_eq!(
            size,
            FormulaSize { leaves: used, operators, complements: 0, height: operators as u32 },
            "{far} {gap}"
        );
    }
}
