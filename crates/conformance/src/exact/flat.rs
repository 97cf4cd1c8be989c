//! A model as surfaces in world coordinates, leaves, and boolean trees over leaf numbers.

use super::map::{Matrix, carried, identity, product};
use super::{Map, Part, Shape, Surface, Tree};
use rayweave_math::{Affine, Vec3};

/// A conjunction of sides of surfaces, or its complement.
#[derive(Clone, Debug)]
pub struct Leaf {
    /// Surface numbers, each with whether the leaf lies where the surface is negative.
    pub facets: Vec<(usize, bool)>,
    /// True for the complement.
    pub complement: bool,
    /// True for a triangle mesh, which the engine takes for one surface.
    pub is_mesh: bool,
}

/// A boolean tree over leaf numbers.
#[derive(Clone, Debug)]
pub enum Node {
    /// The universe (true) or empty.
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
    /// The value of the tree for given leaf values.
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

/// A model in exact form: surfaces in world coordinates, leaves, and one tree for each part.
#[derive(Clone, Debug, Default)]
pub struct Exact {
    /// The surfaces, each once.
    pub surfaces: Vec<Surface>,
    /// The leaves.
    pub leaves: Vec<Leaf>,
    /// Trees with their media, in order.
    pub parts: Vec<(Node, u32)>,
}

/// The map of a tree to the world.
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
            Tree::Empty => Node::Constant(false),
            Tree::Universe => Node::Constant(true),
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
                surface.magnitude = surface.distance().unwrap_or(surface.magnitude) + place.way;
                (self.surface(surface), facet.inside)
            })
            .collect();
        let is_mesh = matches!(shape, Shape::MeshCorners(..));
        self.leaves.push(Leaf { facets, complement, is_mesh });
        Node::Leaf(self.leaves.len() - 1)
    }

    /// The number of a surface. Surfaces with equal matrices, sign included, share one number.
    fn surface(&mut self, surface: Surface) -> usize {
        let known = self.surfaces.iter().position(|s| s.is_equal(&surface));
        let k = known.unwrap_or_else(|| {
            self.surfaces.push(surface.clone());
            self.surfaces.len() - 1
        });
        self.surfaces[k].magnitude = self.surfaces[k].magnitude.max(surface.magnitude);
        k
    }
}
