//! Bounds and pruning on a grid: leaves are arbitrary sets of points within their boxes, many of them in
//! contact.

use crate::written::Choices;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::LeafId;
use rayweave_model::simplify::{
    Formula, Reason, bounds, leaf_needs, needs, output_bounds, prepare, prune, reason,
};

/// Number of grid points along x and y. They have integer coordinates, as have the corners of boxes.
const SIDE: usize = 7;

fn points() -> impl Iterator<Item = Vec3> {
    let far = [-1e300, 1e300].map(Vec3::splat);
    let grid = |n: usize| Vec3::new((n % SIDE) as f64, (n / SIDE % SIDE) as f64, (n / SIDE / SIDE) as f64);
    (0..SIDE * SIDE * 2).map(grid).chain(far)
}

/// Sets of points within boxes.
struct Sets {
    boxes: Vec<Bounds>,
    /// A bit mask for each leaf; each point selects one bit, so that any subset of the box may occur.
    members: Vec<u64>,
}

impl Sets {
    fn new(leaves: u32, choices: &mut Choices) -> Sets {
        let boxes = (0..leaves).map(|_| a_box(choices)).collect();
        let members = (0..leaves).map(|_| if choices.chance(2) { u64::MAX } else { bits(choices) });
        Sets { boxes, members: members.collect() }
    }

    fn holds(&self, leaf: LeafId, point: Vec3) -> bool {
        let number = (point.x + 7.0 * point.y + 49.0 * point.z).abs() as u64 % 64;
        self.boxes[leaf.index()].contains(point) && self.members[leaf.index()] >> number & 1 == 1
    }
}

fn bits(choices: &mut Choices) -> u64 {
    (0..64).map(|k| u64::from(choices.chance(2)) << k).sum()
}

/// A box with integer corners; sometimes flat, unbounded on some sides, all of space or empty.
fn a_box(choices: &mut Choices) -> Bounds {
    let mut side = || {
        let at = choices.below(SIDE) as f64;
        let size = choices.below(4) as f64;
        match choices.below(9) {
            0 => (f64::NEG_INFINITY, at),
            1 => (at, f64::INFINITY),
            _ => (at, at + size),
        }
    };
    let ([x, y], z) = ([side(), side()], if side().0 > 3.0 { (0.0, 0.0) } else { (0.0, 1.0) });
    match choices.below(12) {
        0 => Bounds::ALL,
        1 => Bounds::EMPTY,
        _ => Bounds::new(Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1)),
    }
}

fn values(formula: &Formula, inside: impl Fn(LeafId) -> bool) -> Vec<bool> {
    let mut values = Vec::new();
    formula.evaluate(inside, &mut values);
    values
}

fn answers(formula: &Formula, values: &[bool]) -> Vec<bool> {
    formula.outputs().iter().map(|e| values[e.node().index()] ^ e.is_complemented()).collect()
}

/// Checks the properties of bounds, needs and pruning at every point.
fn check(formula: &Formula, sets: &Sets) {
    let nodes = bounds(formula, &sets.boxes);
    let around = output_bounds(formula, &nodes);
    let near = leaf_needs(formula, &nodes, sets.boxes.len());
    let needs = needs(formula, &nodes);
    let (pruned, cuts) = prune(formula, &sets.boxes);
    let prepared = prepare(formula, &sets.boxes);
    for point in points() {
        let plain = values(formula, |leaf| sets.holds(leaf, point));
        let expected = answers(formula, &plain);
        let context = || format!("at {point} of {}", formula.text(formula.outputs()[0]));
        for (node, beyond) in nodes.iter().enumerate() {
            assert!(beyond.within.contains(point) || plain[node] == beyond.inside, "{}", context());
        }
        assert!(around.contains(point) || !expected.contains(&true), "{}", context());
        for other in [&pruned, &prepared] {
            let found = answers(other, &values(other, |leaf| sets.holds(leaf, point)));
            assert_eq!(found, expected, "{}, pruned to {}", context(), other.text(other.outputs()[0]));
        }
        // leaves count as outside where they do not matter
        let contains = |leaf: LeafId| near[leaf.index()].contains(point) && sets.holds(leaf, point);
        assert_eq!(answers(formula, &values(formula, contains)), expected, "{}", context());
    }
    for cut in &cuts {
        let within = nodes[cut.part.node().index()].within;
        let here = cut
            .user
            .map_or(Bounds::ALL, |user| needs[user.index()].intersection(&nodes[user.index()].within));
        assert!(within.intersection(&here).is_empty());
        if let Reason::Apart(other) | Reason::Absorbed(other) = reason(formula, &nodes, *cut) {
            assert!(within.intersection(&nodes[other.node().index()].within).is_empty());
        }
    }
    let (again, none) = prune(&prepared, &sets.boxes);
    assert!(none.len() <= cuts.len() && again.node_count() <= prepared.node_count());
}

#[test]
fn sets_of_points_in_touching_boxes() {
    let mut choices = Choices::new(7);
    for _ in 0..2500 {
        let (leaves, joins) = (1 + choices.below(6) as u32, 1 + choices.below(8));
        let written = choices.formula(leaves, joins);
        check(&written.formula, &Sets::new(leaves, &mut choices));
    }
}

#[test]
#[ignore = "long"]
fn long_many_sets_of_points() {
    let mut choices = Choices::new(8);
    for _ in 0..100_000 {
        let (leaves, joins) = (1 + choices.below(9) as u32, 1 + choices.below(12));
        let written = choices.formula(leaves, joins);
        check(&written.formula, &Sets::new(leaves, &mut choices));
    }
}
