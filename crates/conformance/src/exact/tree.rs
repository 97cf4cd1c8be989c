//! Boolean trees of exact shapes, and the engine's solids for the same.

use super::{Map, Shape};
use rayweave_math::Affine;
use rayweave_model::{Region, Solid};

/// A boolean tree.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree {
    /// Nothing.
    Empty,
    /// All of space.
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
    /// Moved.
    Moved(Map, Box<Tree>),
    /// The union of several images, made by instancing.
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

    /// Moved.
    pub fn moved(self, map: Map) -> Tree {
        Tree::Moved(map, Box::new(self))
    }

    /// Shifted.
    pub fn at(self, x: f64, y: f64, z: f64) -> Tree {
        self.moved(Map::Move([x, y, z]))
    }

    /// The same as the engine builds it: by operators where there are two operands.
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

    /// The trees of which this one is made.
    pub fn operands(&self) -> Vec<&Tree> {
        match self {
            Tree::Empty | Tree::Universe | Tree::Leaf(_) => Vec::new(),
            Tree::Not(a) | Tree::Moved(_, a) | Tree::Placed(_, a) => vec![a],
            Tree::Any(trees) | Tree::All(trees) | Tree::Odd(trees) => trees.iter().collect(),
            Tree::Minus(a, b) => vec![a, b],
        }
    }
}

/// A solid of one medium; where several overlap the later one wins.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The solid.
    pub tree: Tree,
    /// Its medium; 0 is that of the world.
    pub medium: u32,
}

/// The parts as the engine's regions, under a map of the engine.
pub fn regions(parts: &[Part], frame: &Affine) -> Vec<Region> {
    let region = |(k, part): (usize, &Part)| {
        let solid = part.tree.solid();
        let solid = if *frame == Affine::IDENTITY { solid } else { solid.apply(*frame) };
        Region { name: format!("r{k}"), solid, medium: part.medium }
    };
    parts.iter().enumerate().map(region).collect()
}
