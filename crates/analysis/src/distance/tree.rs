//! The boolean expression of a program over signs of surfaces, without groups.

use rayweave_math::{Affine, Transform};
use rayweave_model::{Edge, Gate, Leaf, LeafId, LeafKind, Program, PrototypeId, RegionId, Rule, SurfaceId};
use rayweave_shape::surface::Surface;
use std::collections::HashMap;

/// The number of surfaces, with one copy for each placement, that a field may have.
const MOST_SURFACES: usize = 1_000_000;

/// A node of a [`Tree`], or its complement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    node: u32,
    is_complement: bool,
}

impl Link {
    const NONE: Link = Link { node: 0, is_complement: false };
    const ALL: Link = Link { node: 0, is_complement: true };

    fn complement_if(self, flag: bool) -> Link {
        Link { is_complement: self.is_complement ^ flag, ..self }
    }

    fn constant(value: bool) -> Link {
        if value { Link::ALL } else { Link::NONE }
    }
}

/// What a node computes.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Outside everywhere; node 0.
    Nothing,
    /// Inside where f < 0 for a surface.
    Surface(u32),
    /// A gate over the operands up to this index; they begin where those of the node before it end.
    Join(Rule),
}

/// A boolean function of the signs of surfaces: nodes in topological order, and one output.
#[derive(Clone, Debug)]
pub struct Tree {
    nodes: Vec<(Kind, u32)>,
    operands: Vec<Link>,
    output: Link,
}

/// Knowledge about a point, or about all points of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Outside,
    Inside,
    Unknown,
}

impl Place {
    pub fn of(is_inside: bool) -> Place {
        if is_inside { Place::Inside } else { Place::Outside }
    }

    fn complement_if(self, flag: bool) -> Place {
        match self {
            Place::Unknown => Place::Unknown,
            known => Place::of((known == Place::Inside) ^ flag),
        }
    }
}

impl Tree {
    fn empty() -> Tree {
        Tree { nodes: vec![(Kind::Nothing, 0)], operands: Vec::new(), output: Link::NONE }
    }

    /// The solids of a program whose medium is not that of the world, as [`of_regions`](Self::of_regions) returns them.
    pub fn of(program: &Program) -> Option<(Tree, Vec<(Surface, f64)>)> {
        Tree::of_regions(program, &|region| program.medium_of(region) != 0)
    }

    /// The part of space that belongs to the selected regions, and the surfaces in the world's frame. `None` if there are too many
    /// placements.
    pub fn of_regions(
        program: &Program,
        is_selected: &dyn Fn(RegionId) -> bool,
    ) -> Option<(Tree, Vec<(Surface, f64)>)> {
        let mut builder = Builder { program, tree: Tree::empty(), surfaces: Vec::new() };
        let regions = builder.group(PrototypeId(0), None)?;
        let mut whole = Link::NONE;
        for (k, &solid) in regions.iter().enumerate() {
            // a later region has priority over all before it
            whole = match is_selected(RegionId::from(k + 1)) {
                false => builder.tree.join(Rule::AtLeast(2), &[whole, solid.complement_if(true)]),
                true => builder.tree.join(Rule::AtLeast(1), &[whole, solid]),
            };
        }
        builder.tree.output = whole;
        let nothing_is_known = vec![Place::Unknown; builder.surfaces.len()];
        let tree = builder.tree.reduced(&nothing_is_known, &mut Vec::new());
        Some((tree, builder.surfaces))
    }

    fn push(&mut self, kind: Kind) -> Link {
        self.nodes.push((kind, self.operands.len() as u32));
        Link { node: self.nodes.len() as u32 - 1, is_complement: false }
    }

    fn join(&mut self, rule: Rule, operands: &[Link]) -> Link {
        self.operands.extend_from_slice(operands);
        self.push(Kind::Join(rule))
    }

    fn operands(&self, node: usize) -> &[Link] {
        let first = node.checked_sub(1).map_or(0, |before| self.nodes[before].1);
        &self.operands[first as usize..self.nodes[node].1 as usize]
    }

    /// The value everywhere, if the tree is a constant.
    pub fn constant(&self) -> Option<bool> {
        (self.output.node == 0).then_some(self.output.is_complement)
    }

    /// Whether a point is inside, from the sides of the surfaces: true where f < 0.
    pub fn is_inside(&self, is_negative: impl Fn(u32) -> bool, values: &mut Vec<bool>) -> bool {
        values.clear();
        for (number, &(kind, _)) in self.nodes.iter().enumerate() {
            let value = match kind {
                Kind::Nothing => false,
                Kind::Surface(surface) => is_negative(surface),
                Kind::Join(rule) => {
                    let holds = |link: &&Link| values[link.node as usize] ^ link.is_complement;
                    rule.holds(self.operands(number).iter().filter(holds).count() as u32)
                }
            };
            values.push(value);
        }
        values[self.output.node as usize] ^ self.output.is_complement
    }

    /// The places of all nodes, from those of the surfaces by their numbers.
    fn places(&self, surfaces: &[Place], places: &mut Vec<Place>) {
        places.clear();
        for (number, &(kind, _)) in self.nodes.iter().enumerate() {
            let place = match kind {
                Kind::Nothing => Place::Outside,
                Kind::Surface(surface) => surfaces[surface as usize],
                Kind::Join(rule) => {
                    let (mut inside, mut unknown) = (0, 0);
                    for link in self.operands(number) {
                        match places[link.node as usize].complement_if(link.is_complement) {
                            Place::Inside => inside += 1,
                            Place::Unknown => unknown += 1,
                            Place::Outside => {}
                        }
                    }
                    joined(rule, inside, unknown)
                }
            };
            places.push(place);
        }
    }

    /// The same function for known places of some surfaces. `surfaces` has a place for each surface number of the tree.
    pub fn reduced(&self, surfaces: &[Place], places: &mut Vec<Place>) -> Tree {
        self.places(surfaces, places);
        let value = |link: Link| places[link.node as usize].complement_if(link.is_complement);
        if value(self.output) != Place::Unknown {
            let output = Link::constant(value(self.output) == Place::Inside);
            return Tree { output, ..Tree::empty() };
        }
        let mut is_needed = vec![false; self.nodes.len()];
        is_needed[self.output.node as usize] = true;
        for number in (0..self.nodes.len()).rev().filter(|&number| places[number] == Place::Unknown) {
            if is_needed[number] {
                self.operands(number).iter().for_each(|link| is_needed[link.node as usize] = true);
            }
        }
        let mut tree = Tree::empty();
        let mut links = vec![Link::NONE; self.nodes.len()];
        let mut open = Vec::new();
        for number in (0..self.nodes.len()).filter(|&k| is_needed[k] && places[k] == Place::Unknown) {
            links[number] = match self.nodes[number].0 {
                Kind::Nothing => Link::NONE,
                Kind::Surface(surface) => tree.push(Kind::Surface(surface)),
                Kind::Join(rule) => {
                    let operands = self.operands(number);
                    let inside = operands.iter().filter(|&&link| value(link) == Place::Inside).count() as u32;
                    open.clear();
                    let unknown = operands.iter().filter(|&&link| value(link) == Place::Unknown);
                    open.extend(
                        unknown.map(|link| links[link.node as usize].complement_if(link.is_complement)),
                    );
                    tree.rest(rule, inside, &open)
                }
            };
        }
        tree.output = links[self.output.node as usize].complement_if(self.output.is_complement);
        tree
    }

    /// A gate over its unknown operands; `inside` of the others lie inside.
    fn rest(&mut self, rule: Rule, inside: u32, open: &[Link]) -> Link {
        match (rule, open) {
            (Rule::AtLeast(_), [single]) => *single,
            (Rule::AtLeast(least), _) => self.join(Rule::AtLeast(least - inside), open),
            (Rule::Odd, [single]) => single.complement_if(inside % 2 == 1),
            (Rule::Odd, _) => self.join(Rule::Odd, open).complement_if(inside % 2 == 1),
        }
    }

    /// The surfaces that occur in the tree, in increasing order.
    pub fn surfaces(&self) -> Vec<u32> {
        let surface = |&(kind, _): &(Kind, u32)| match kind {
            Kind::Surface(surface) => Some(surface),
            _ => None,
        };
        let mut surfaces: Vec<u32> = self.nodes.iter().filter_map(surface).collect();
        surfaces.sort_unstable();
        surfaces.dedup();
        surfaces
    }

    /// A number with the sign of the solid whose magnitude is at most the distance from its boundary, from such numbers of the
    /// surfaces: the k-th smallest of the operands for "at least k", which is the minimum for unions and the maximum for
    /// intersections.
    pub fn signed_bound(&self, surfaces: &[f64]) -> f64 {
        let (mut values, mut sorted) = (Vec::with_capacity(self.nodes.len()), Vec::new());
        for (number, &(kind, _)) in self.nodes.iter().enumerate() {
            let value = match kind {
                Kind::Nothing => f64::INFINITY,
                Kind::Surface(surface) => surfaces[surface as usize],
                Kind::Join(rule) => {
                    sorted.clear();
                    sorted.extend(self.operands(number).iter().map(|link| signed(&values, *link)));
                    match rule {
                        Rule::AtLeast(least) => {
                            sorted.sort_unstable_by(f64::total_cmp);
                            match (least as usize).checked_sub(1) {
                                None => f64::NEG_INFINITY,
                                Some(k) => sorted.get(k).copied().unwrap_or(f64::INFINITY),
                            }
                        }
                        Rule::Odd => sorted.iter().fold(f64::INFINITY, |a, &b| a.min(b).max(-a.max(b))),
                    }
                }
            };
            values.push(value);
        }
        signed(&values, self.output)
    }
}

/// The value of a link from those of the nodes.
fn signed(values: &[f64], link: Link) -> f64 {
    let value = values[link.node as usize];
    if link.is_complement { -value } else { value }
}

/// The place of a gate with these numbers of operands that are inside and unknown.
fn joined(rule: Rule, inside: u32, unknown: u32) -> Place {
    match rule {
        Rule::AtLeast(least) if inside >= least => Place::Inside,
        Rule::AtLeast(least) if inside + unknown < least => Place::Outside,
        Rule::Odd if unknown == 0 => Place::of(rule.holds(inside)),
        _ => Place::Unknown,
    }
}

/// Copies the groups of a program, one copy for each placement.
struct Builder<'p> {
    program: &'p Program,
    tree: Tree,
    surfaces: Vec<(Surface, f64)>,
}

impl Builder<'_> {
    /// The outputs of a group under a map.
    fn group(&mut self, id: PrototypeId, map: Option<&Affine>) -> Option<Vec<Link>> {
        let prototype = self.program.prototype(id);
        let transform = map.map(|map| Transform::from_affine(*map)).transpose().ok()?;
        let mut numbers = HashMap::new();
        let mut links = Vec::with_capacity(prototype.expression.node_count());
        for gate in prototype.expression.nodes() {
            let link = match gate {
                Gate::Empty => Link::NONE,
                Gate::Universe => Link::ALL,
                Gate::Leaf(local) => {
                    let leaf = self.program.leaf(LeafId(prototype.leaves.start + local.0));
                    match leaf.kind() {
                        _ if !leaf.is_used() => Link::NONE,
                        LeafKind::Instance { prototype, .. } => {
                            let inner = leaf.place().local_from_world.inverse().ok()?;
                            let inner = map.map_or(inner, |map| inner.then(map));
                            *self.group(prototype, Some(&inner))?.first()?
                        }
                        LeafKind::Shape { .. } => self.shape(&leaf, map, transform.as_ref(), &mut numbers),
                    }
                }
                Gate::Join(rule, operands) => {
                    let own: Vec<Link> = operands.iter().map(|&edge| linked(&links, edge)).collect();
                    self.tree.join(rule, &own)
                }
            };
            links.push(link);
            if self.surfaces.len() > MOST_SURFACES {
                return None;
            }
        }
        Some(prototype.expression.outputs().iter().map(|&edge| linked(&links, edge)).collect())
    }

    /// The conjunction of the facets of a leaf. `numbers` has the nodes of surfaces of the group.
    ///
    /// A leaf that is the complement of this conjunction, such as a wedge of more than 180 degrees, is complemented by the
    /// edges of the group's expression, so its flag is not read here.
    fn shape(
        &mut self,
        leaf: &Leaf<'_>,
        map: Option<&Affine>,
        transform: Option<&Transform>,
        numbers: &mut HashMap<SurfaceId, Link>,
    ) -> Link {
        let mut sides = Vec::with_capacity(leaf.facets().len());
        for facet in leaf.facets() {
            let node = *numbers.entry(facet.surface()).or_insert_with(|| {
                let entry = self.program.surface(facet.surface());
                let placed =
                    transform.map_or_else(|| entry.surface.clone(), |to| entry.surface.transformed(to));
                let placed_size =
                    |map: &Affine| entry.magnitude * map.linear_norm() + map.translation.length();
                self.surfaces.push((placed, map.map_or(entry.magnitude, placed_size)));
                self.tree.push(Kind::Surface(self.surfaces.len() as u32 - 1))
            });
            sides.push(node.complement_if(!facet.inside()));
        }
        self.tree.join(Rule::AtLeast(sides.len() as u32), &sides)
    }
}

fn linked(links: &[Link], edge: Edge) -> Link {
    links[edge.node().index()].complement_if(edge.is_complemented())
}
