//! Tests for algorithms that are not evaluators: binary trees of convex leaves, rays, and the exact answers.
//!
//! The models suit algorithms from the literature: closed, bounded, convex leaves (boxes, balls, rods), each
//! with two crossings or none, under unions, intersections and differences of two operands.

use super::{Answer, Exact, Line, Part, Shape, Span, Tree, answer, draw};
use crate::Random;
use rayweave_math::Affine;
use rayweave_model::{Program, Solid};
use rayweave_shape::Ray;

/// A binary operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// In either operand.
    Union,
    /// In both operands.
    Intersection,
    /// In the first operand, not in the second.
    Difference,
}

/// A binary tree over leaf numbers.
#[derive(Clone, Debug)]
pub enum Binary {
    /// A leaf.
    Leaf(usize),
    /// The join of two trees.
    Join(Operator, Box<[Binary; 2]>),
}

/// A family of random models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Two to eight leaves and rays at arbitrary positions.
    Generic,
    /// Two to eight leaves on a grid of pitch 0.5, and rays mostly along its lines and through its points.
    Planted,
    /// Balanced unions of eight leaves at arbitrary positions.
    Unions,
}

impl Family {
    /// All families.
    pub const ALL: [Family; 3] = [Family::Generic, Family::Planted, Family::Unions];

    /// The name of the family.
    pub fn name(self) -> &'static str {
        match self {
            Family::Generic => "generic",
            Family::Planted => "planted coincidences",
            Family::Unions => "unions of eight leaves",
        }
    }
}

/// A model with rays whose exact answers are certain.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The tree.
    pub tree: Binary,
    /// Its leaves.
    pub leaves: Vec<Solid>,
    /// The whole model as a solid.
    pub solid: Solid,
    /// The rays.
    pub rays: Vec<Ray>,
    /// The exact answer for each ray.
    pub answers: Vec<Answer>,
}

fn model(rng: &mut Random, family: Family) -> (Binary, Vec<Tree>) {
    let count = if family == Family::Unions { 8 } else { 2 + rng.below(7) };
    let leaves: Vec<Tree> = (0..count).map(|_| leaf(rng, family)).collect();
    (random(rng, family, 0..count), leaves)
}

/// A solid of the generic family.
pub(super) fn generic(rng: &mut Random) -> Tree {
    let (tree, leaves) = model(rng, Family::Generic);
    joined(&tree, &leaves)
}

/// The model and the rays of a seed; `None` if the model does not compile.
pub fn trial(family: Family, seed: u64, rays: usize) -> Option<Trial> {
    let mut rng = Random::new(4 << 40 | seed);
    let (tree, leaves) = model(&mut rng, family);
    let whole = joined(&tree, &leaves);
    let (solid, exact) = (whole.solid(), Exact::new(&[Part { tree: whole, medium: 1 }]));
    let ball = Program::compile(&solid).ok()?.prototypes()[0].ball;
    let mut trial = Trial {
        tree,
        leaves: leaves.iter().map(Tree::solid).collect(),
        solid,
        rays: vec![],
        answers: vec![],
    };
    for _ in 0..rays {
        let ray = match family {
            Family::Planted => draw::ray(&mut rng),
            _ => through(&mut rng),
        };
        let span = Span::new(&ray, &[(Affine::IDENTITY, ball)]);
        if let Ok(answer) = answer(&exact, &Line::new(ray), &span) {
            trial.rays.push(ray);
            trial.answers.push(answer);
        }
    }
    Some(trial)
}

impl Answer {
    /// True if a list agrees with the answer: in the side at -inf, the number of crossings, and each time
    /// within the range that a backward stable computation may give.
    pub fn agrees_with(&self, starts_inside: bool, times: &[f64]) -> bool {
        let near = |(t, e): (&f64, &super::Expected)| e.times.0 <= *t && *t <= e.times.1;
        starts_inside == (self.start != 0)
            && times.len() == self.crossings.len()
            && times.iter().zip(&self.crossings).all(near)
    }
}

fn random(rng: &mut Random, family: Family, leaves: std::ops::Range<usize>) -> Binary {
    if leaves.len() == 1 {
        return Binary::Leaf(leaves.start);
    }
    let (operator, first) = match family {
        Family::Unions => (Operator::Union, leaves.len() / 2),
        _ => {
            let all = [Operator::Union, Operator::Intersection, Operator::Difference];
            (rng.pick(&all), 1 + rng.below(leaves.len() - 1))
        }
    };
    let middle = leaves.start + first;
    let both = [random(rng, family, leaves.start..middle), random(rng, family, middle..leaves.end)];
    Binary::Join(operator, Box::new(both))
}

fn joined(tree: &Binary, leaves: &[Tree]) -> Tree {
    match tree {
        Binary::Leaf(k) => leaves[*k].clone(),
        Binary::Join(operator, both) => {
            let [a, b] = [joined(&both[0], leaves), joined(&both[1], leaves)];
            match operator {
                Operator::Union => Tree::Any(vec![a, b]),
                Operator::Intersection => Tree::All(vec![a, b]),
                Operator::Difference => a.minus(b),
            }
        }
    }
}

/// A box, a ball or a rod. The lengths have few enough bits for their squares to be exact.
fn leaf(rng: &mut Random, family: Family) -> Tree {
    let grid = family == Family::Planted;
    let mut length = |lo: f64, hi: f64| match grid {
        true => rng.pick(&[1.0, 2.0]),
        false => (1024.0 * rng.between(lo, hi)).round() / 1024.0,
    };
    let sizes = [length(0.5, 2.0), length(0.5, 2.0), length(0.5, 2.0)];
    let shape = match rng.below(if grid { 6 } else { 3 }) {
        0 | 3.. => Shape::Box(sizes),
        1 => Shape::Sphere(0.5 * sizes[0]),
        _ => Shape::Cylinder(0.5 * sizes[0], sizes[1]),
    };
    let tree = Tree::Leaf(shape).moved(super::Map::Turn(rng.below(3), rng.below(4) as u8));
    let mut place = || match grid {
        true => 0.5 * (rng.below(5) as f64 - 2.0),
        false => rng.between(-1.5, 1.5),
    };
    tree.at(place(), place(), place())
}

/// A ray through two random points near the origin.
pub(super) fn through(rng: &mut Random) -> Ray {
    let (a, b) = (rng.point(2.0), rng.point(2.0));
    Ray::new(a - 3.0 * (b - a), b - a)
}
