//! Boolean trees of exact shapes, and the engine's solids for them.

use super::{Map, Shape};
use crate::Random;
use rayweave_math::Affine;
use rayweave_model::{Region, Solid};

/// A boolean tree.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree {
    /// The empty solid.
    Empty,
    /// The universe.
    Universe,
    /// A shape.
    Leaf(Shape),
    /// The complement.
    Not(Box<Tree>),
    /// The union.
    Any(Vec<Tree>),
    /// The intersection.
    All(Vec<Tree>),
    /// The symmetric difference.
    Odd(Vec<Tree>),
    /// The difference.
    Minus(Box<Tree>, Box<Tree>),
    /// The image under a map.
    Moved(Map, Box<Tree>),
    /// The union of several images, as instances.
    Placed(Vec<Map>, Box<Tree>),
}

impl From<Shape> for Tree {
    fn from(shape: Shape) -> Tree {
        Tree::Leaf(shape)
    }
}

impl Tree {
    /// The complement.
    pub fn complement(self) -> Tree {
        Tree::Not(Box::new(self))
    }

    /// The difference.
    pub fn minus(self, other: Tree) -> Tree {
        Tree::Minus(Box::new(self), Box::new(other))
    }

    /// The image under a map.
    pub fn moved(self, map: Map) -> Tree {
        Tree::Moved(map, Box::new(self))
    }

    /// The image under a shift.
    pub fn at(self, x: f64, y: f64, z: f64) -> Tree {
        self.moved(Map::Move([x, y, z]))
    }

    /// True if a leaf is a mesh.
    pub fn has_mesh(&self) -> bool {
        matches!(self, Tree::Leaf(Shape::MeshCorners(..))) || self.operands().into_iter().any(Tree::has_mesh)
    }

    /// The tree with boxes as meshes, each with the given probability.
    pub fn meshed(&self, rng: &mut Random, chance: f64) -> Tree {
        let mut all = |trees: &[Tree]| trees.iter().map(|tree| tree.meshed(rng, chance)).collect::<Vec<_>>();
        match self {
            Tree::Empty => Tree::Empty,
            Tree::Universe => Tree::Universe,
            Tree::Any(trees) => Tree::Any(all(trees)),
            Tree::All(trees) => Tree::All(all(trees)),
            Tree::Odd(trees) => Tree::Odd(all(trees)),
            Tree::Leaf(shape) => Tree::Leaf(if rng.chance(chance) { shape.meshed() } else { shape.clone() }),
            Tree::Not(a) => a.meshed(rng, chance).complement(),
            Tree::Minus(a, b) => a.meshed(rng, chance).minus(b.meshed(rng, chance)),
            Tree::Moved(map, a) => a.meshed(rng, chance).moved(*map),
            Tree::Placed(maps, a) => Tree::Placed(maps.clone(), Box::new(a.meshed(rng, chance))),
        }
    }

    /// The tree as the engine's solid; nodes with two operands are made by operators.
    pub fn solid(&self) -> Solid {
        let all = |trees: &[Tree]| trees.iter().map(Tree::solid).collect::<Vec<_>>();
        match self {
            Tree::Empty => Solid::empty(),
            Tree::Universe => Solid::universe(),
            Tree::Leaf(shape) => shape.solid(),
            Tree::Not(a) => !a.solid(),
            Tree::Any(trees) => match &trees[..] {
                [a, b] => a.solid() | b.solid(),
                _ => Solid::union(all(trees)),
            },
            Tree::All(trees) => match &trees[..] {
                [a, b] => a.solid() & b.solid(),
                _ => Solid::intersection(all(trees)),
            },
            Tree::Odd(trees) => match &trees[..] {
                [a, b] => a.solid() ^ b.solid(),
                _ => Solid::symmetric_difference(all(trees)),
            },
            Tree::Minus(a, b) => a.solid() - b.solid(),
            Tree::Moved(map, a) => map.applied(&a.solid()),
            Tree::Placed(maps, a) => a.solid().place(maps.iter().map(Map::affine).collect::<Vec<_>>()),
        }
    }

    /// The operands of the root.
    pub fn operands(&self) -> Vec<&Tree> {
        match self {
            Tree::Empty | Tree::Universe | Tree::Leaf(_) => Vec::new(),
            Tree::Not(a) | Tree::Moved(_, a) | Tree::Placed(_, a) => vec![a],
            Tree::Any(trees) | Tree::All(trees) | Tree::Odd(trees) => trees.iter().collect(),
            Tree::Minus(a, b) => vec![a, b],
        }
    }
}

/// A solid of one medium; where several overlap, the later one has priority.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The solid.
    pub tree: Tree,
    /// Its medium; 0 is that of the world.
    pub medium: u32,
}

/// The parts as the engine's regions, transformed by `frame`.
pub fn regions(parts: &[Part], frame: &Affine) -> Vec<Region> {
    let region = |(k, part): (usize, &Part)| {
        let solid = part.tree.solid();
        let solid = if *frame == Affine::IDENTITY { solid } else { solid.apply(*frame) };
        Region { name: format!("r{k}"), solid, medium: part.medium }
    };
    parts.iter().enumerate().map(region).collect()
}
