//! Boolean trees of exact shapes, and the engine's solids for the same.

use super::map::{Matrix, carried, identity, product};
use super::{Map, Shape, Surface};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Region, Solid};

/// A boolean tree.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree {
    /// Nothing.
    Vacuum,
    /// All of space.
    Plenum,
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
            Tree::Vacuum => Solid::vacuum(),
            Tree::Plenum => Solid::plenum(),
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
            Tree::Vacuum | Tree::Plenum | Tree::Leaf(_) => Vec::new(),
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

/// A conjunction of sides of surfaces, or its complement.
#[derive(Clone, Debug)]
pub struct Leaf {
    /// (surface, inside where it is negative).
    pub facets: Vec<(usize, bool)>,
    /// True for the complement.
    pub complement: bool,
}

/// A tree with leaves by number.
#[derive(Clone, Debug)]
pub enum Node {
    /// Everywhere or nowhere.
    Constant(bool),
    /// A leaf.
    Leaf(usize),
    /// Not inside.
    Not(Box<Node>),
    /// Inside any.
    Any(Vec<Node>),
    /// Inside all.
    All(Vec<Node>),
    /// Inside an odd number.
    Odd(Vec<Node>),
}

impl Node {
    /// True if inside, for given leaves.
    pub fn holds(&self, leaves: &[bool]) -> bool {
        match self {
            Node::Constant(value) => *value,
            Node::Leaf(k) => leaves[*k],
            Node::Not(a) => !a.holds(leaves),
            Node::Any(all) => all.iter().any(|a| a.holds(leaves)),
            Node::All(all) => all.iter().all(|a| a.holds(leaves)),
            Node::Odd(all) => all.iter().filter(|a| a.holds(leaves)).count() % 2 == 1,
        }
    }
}

/// A model in exact form: surfaces in the world, leaves, and one tree for each part.
#[derive(Clone, Debug, Default)]
pub struct Exact {
    /// The surfaces, each once.
    pub surfaces: Vec<Surface>,
    /// The leaves.
    pub leaves: Vec<Leaf>,
    /// Trees with their media, in order.
    pub parts: Vec<(Node, u32)>,
}

/// Where a tree stands.
#[derive(Clone)]
struct Place {
    local_from_world: Matrix,
    world_from_local: Affine,
    way: f64,
}

impl Place {
    fn moved(&self, map: &Map) -> Place {
        let affine = map.affine();
        Place {
            local_from_world: product(&map.inverse(), &self.local_from_world),
            way: self.way + self.world_from_local.vector(affine.translation).length(),
            world_from_local: affine.then(&self.world_from_local),
        }
    }
}

impl Exact {
    /// The exact form of parts.
    pub fn new(parts: &[Part]) -> Exact {
        let mut exact = Exact::default();
        let world = Place { local_from_world: identity(), world_from_local: Affine::IDENTITY, way: 0.0 };
        for part in parts {
            let node = exact.node(&part.tree, &world);
            exact.parts.push((node, part.medium));
        }
        exact
    }

    fn node(&mut self, tree: &Tree, place: &Place) -> Node {
        match tree {
            Tree::Vacuum => Node::Constant(false),
            Tree::Plenum => Node::Constant(true),
            Tree::Leaf(shape) => self.leaf(shape, place),
            Tree::Not(a) => Node::Not(Box::new(self.node(a, place))),
            Tree::Any(trees) => Node::Any(self.nodes(trees, place)),
            Tree::All(trees) => Node::All(self.nodes(trees, place)),
            Tree::Odd(trees) => Node::Odd(self.nodes(trees, place)),
            Tree::Minus(a, b) => {
                let (a, b) = (self.node(a, place), self.node(b, place));
                Node::All(vec![a, Node::Not(Box::new(b))])
            }
            Tree::Moved(map, a) => self.node(a, &place.moved(map)),
            Tree::Placed(maps, a) => {
                Node::Any(maps.iter().map(|map| self.node(a, &place.moved(map))).collect())
            }
        }
    }

    fn nodes(&mut self, trees: &[Tree], place: &Place) -> Vec<Node> {
        trees.iter().map(|tree| self.node(tree, place)).collect()
    }

    fn leaf(&mut self, shape: &Shape, place: &Place) -> Node {
        let (facets, complement) = shape.facets();
        let scale = place.world_from_local.linear;
        let shortest =
            Vec3::AXES.map(|axis| (scale * axis).length()).into_iter().fold(f64::INFINITY, f64::min);
        let facets = facets
            .into_iter()
            .map(|facet| {
                let matrix = carried(&facet.matrix, &place.local_from_world);
                let anchor = place.world_from_local.point(facet.anchor);
                let mut surface = Surface::new(matrix, anchor.length() + shortest * facet.size);
                surface.reach = surface.distance().unwrap_or(surface.reach) + place.way;
                (self.surface(surface), facet.inside)
            })
            .collect();
        self.leaves.push(Leaf { facets, complement });
        Node::Leaf(self.leaves.len() - 1)
    }

    /// The number of a surface, the same for equal ones of equal sense.
    fn surface(&mut self, surface: Surface) -> usize {
        let known = self.surfaces.iter().position(|s| s.is_equal(&surface));
        let k = known.unwrap_or_else(|| {
            self.surfaces.push(surface.clone());
            self.surfaces.len() - 1
        });
        self.surfaces[k].reach = self.surfaces[k].reach.max(surface.reach);
        k
    }
}
