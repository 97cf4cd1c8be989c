//! Groups for the device: a group with everything that is placed in it, as one small boolean network over atoms.
//!
//! An *atom* is a set of points that a line enters and leaves at most once: a conjunction of convex facets, or a single facet
//! of degree two at most, inside or outside. A leaf is the conjunction of its atoms.

use crate::error::Unsupported;
use rayweave_model::{Edge, LeafFacet, LeafId, LeafKind, Place, Program, Prototype, PrototypeId, Rule};
use rayweave_shape::surface::Surface;
use std::collections::HashMap;

/// The greatest number of atoms and gates of a group.
pub(crate) const MOST_NODES: usize = 128;

/// The greatest depth of nested placements.
const MOST_DEPTH: usize = 16;

/// A facet of an atom, with the names that the CPU has for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatFacet {
    pub facet: LeafFacet,
    pub leaf: LeafId,
    /// The number of the facet in its leaf.
    pub number: u32,
    /// The placement of the leaf, relative to that of the group.
    pub placement: u32,
    /// True for the part of a torus that a line crosses after its first chord, and false for all other surfaces.
    pub second: bool,
}

/// The atoms of a torus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Tori {
    /// Two: the first chord of a line and the second one.
    #[default]
    Chords,
    /// One, for kernels that do not compute its roots.
    Opaque,
}

/// A maximal part of a leaf that a line enters and leaves once.
#[derive(Clone, Debug)]
pub(crate) struct Atom {
    pub facets: Vec<FlatFacet>,
    /// The number of its frame in [`Flat::frames`]; `None` for the frame of the group.
    pub frame: Option<usize>,
    /// The placed solid of the group that contains it, counted from 1; 0 if the group itself does.
    pub instance: u32,
}

/// An operand: a node, possibly complemented, or a constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Operand {
    Constant(bool),
    Atom(usize, bool),
    Gate(usize, bool),
}

impl Operand {
    fn complemented_if(self, complemented: bool) -> Operand {
        match self {
            Operand::Constant(value) => Operand::Constant(value != complemented),
            Operand::Atom(k, c) => Operand::Atom(k, c != complemented),
            Operand::Gate(k, c) => Operand::Gate(k, c != complemented),
        }
    }
}

/// A boolean function of operands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FlatGate {
    pub rule: Rule,
    pub operands: Vec<Operand>,
}

/// A frame in which atoms lie: the maps from that of the group, outermost first, and the group placed there.
#[derive(Clone, Debug)]
pub(crate) struct FlatFrame {
    pub places: Vec<Place>,
    pub group: PrototypeId,
}

/// A group with everything that is placed in it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Flat {
    pub atoms: Vec<Atom>,
    pub gates: Vec<FlatGate>,
    pub outputs: Vec<Operand>,
    pub frames: Vec<FlatFrame>,
    tori: Tori,
}

impl Flat {
    /// The network of some edges of a group.
    pub fn new(
        program: &Program,
        group: PrototypeId,
        edges: &[Edge],
        tori: Tori,
    ) -> Result<Flat, Unsupported> {
        let mut flat = Flat { tori, ..Flat::default() };
        flat.outputs = flat.add(program, group, edges, &mut Vec::new(), 0)?;
        // atoms and gates in the order of the leaves, which decides between faces at the same time: `add` visits leaves in order
        Ok(flat)
    }

    /// The number of nodes of the network.
    pub fn nodes(&self) -> usize {
        self.atoms.len() + self.gates.len()
    }

    fn check(&self) -> Result<(), Unsupported> {
        if self.nodes() > MOST_NODES { Err(Unsupported::Nodes { limit: MOST_NODES }) } else { Ok(()) }
    }

    /// Adds what edges of a group depend on; returns their operands.
    fn add(
        &mut self,
        program: &Program,
        group: PrototypeId,
        edges: &[Edge],
        places: &mut Vec<Place>,
        placement: u32,
    ) -> Result<Vec<Operand>, Unsupported> {
        if places.len() > MOST_DEPTH {
            return Err(Unsupported::Depth { limit: MOST_DEPTH });
        }
        let prototype = program.prototype(group);
        let leaves = (prototype.leaves.end - prototype.leaves.start) as usize;
        let has_gates = edges.iter().any(|edge| edge.node().index() >= leaves + 2);
        let joins: Vec<(Rule, &[Edge])> =
            if has_gates { prototype.expression.joins().collect() } else { Vec::new() };
        let needed = needed(&joins, leaves, edges)?;
        let mut operands: HashMap<u32, Operand> =
            HashMap::from([(0, Operand::Constant(false)), (1, Operand::Constant(true))]);
        for &node in &needed {
            let operand = if (node as usize) < leaves + 2 {
                self.leaf(program, prototype, node - 2, group, places, placement)?
            } else {
                let (rule, inputs) = joins[node as usize - leaves - 2];
                let inputs = inputs
                    .iter()
                    .map(|edge| operands[&edge.node().0].complemented_if(edge.is_complemented()))
                    .collect();
                self.gate(rule, inputs)
            };
            operands.insert(node, operand);
            self.check()?;
        }
        let of = |edge: &Edge| operands[&edge.node().0].complemented_if(edge.is_complemented());
        Ok(edges.iter().map(of).collect())
    }

    fn gate(&mut self, rule: Rule, operands: Vec<Operand>) -> Operand {
        self.gates.push(FlatGate { rule, operands });
        Operand::Gate(self.gates.len() - 1, false)
    }

    fn leaf(
        &mut self,
        program: &Program,
        prototype: &Prototype,
        number: u32,
        group: PrototypeId,
        places: &mut Vec<Place>,
        placement: u32,
    ) -> Result<Operand, Unsupported> {
        let leaf = program.leaf(LeafId(prototype.leaves.start + number));
        match leaf.kind() {
            LeafKind::Instance { prototype: inner, placement: offset } => {
                let first = self.atoms.len();
                places.push(leaf.place());
                let outputs = program.prototype(inner).expression.outputs().to_vec();
                let found = self.add(program, inner, &outputs[..1], places, placement + offset);
                places.pop();
                if places.is_empty() {
                    self.atoms[first..].iter_mut().for_each(|atom| atom.instance = number + 1);
                }
                Ok(found?[0])
            }
            LeafKind::Shape { .. } => {
                let frame = self.frame(places, group);
                let facet = |(number, &facet): (usize, &LeafFacet)| FlatFacet {
                    facet,
                    leaf: leaf.id(),
                    number: number as u32,
                    placement,
                    second: false,
                };
                let facets: Vec<FlatFacet> = leaf.facets().iter().enumerate().map(facet).collect();
                Ok(self.shape(program, facets, frame))
            }
        }
    }

    /// The atoms of a leaf and their conjunction.
    fn shape(&mut self, program: &Program, facets: Vec<FlatFacet>, frame: Option<usize>) -> Operand {
        // the CPU decides about the leaf as a whole if it decides about one of its facets
        let is_known = facets.iter().all(|f| has_kernel(program, f.facet, self.tori));
        let (convex, single): (Vec<FlatFacet>, Vec<FlatFacet>) =
            facets.into_iter().partition(|f| !is_known || is_convex(program, f.facet));
        let mut operands = Vec::new();
        if !convex.is_empty() {
            operands.push(self.atom(convex, frame));
        }
        for facet in single {
            let first = self.atom(vec![facet], frame);
            if !is_torus(program, facet.facet) {
                operands.push(first);
                continue;
            }
            let second = self.atom(vec![FlatFacet { second: true, ..facet }], frame);
            if facet.facet.inside() {
                operands.push(self.gate(Rule::AtLeast(1), vec![first, second]));
            } else {
                operands.extend([first, second]);
            }
        }
        match operands[..] {
            [only] => only,
            _ => self.gate(Rule::AtLeast(operands.len() as u32), operands),
        }
    }

    fn atom(&mut self, facets: Vec<FlatFacet>, frame: Option<usize>) -> Operand {
        self.atoms.push(Atom { facets, frame, instance: 0 });
        Operand::Atom(self.atoms.len() - 1, false)
    }

    /// The number of the frame of the current placement: solids with equal maps share it.
    fn frame(&mut self, places: &[Place], group: PrototypeId) -> Option<usize> {
        if places.is_empty() {
            return None;
        }
        let known = self.frames.iter().rposition(|frame| frame.places == places && frame.group == group);
        known.or_else(|| {
            self.frames.push(FlatFrame { places: places.to_vec(), group });
            Some(self.frames.len() - 1)
        })
    }
}

/// The leaves and joins that edges depend on, in ascending order; fails early if there are too many.
fn needed(joins: &[(Rule, &[Edge])], leaves: usize, edges: &[Edge]) -> Result<Vec<u32>, Unsupported> {
    let mut needed = std::collections::BTreeSet::new();
    let mut open: Vec<u32> = edges.iter().map(|edge| edge.node().0).collect();
    while let Some(node) = open.pop() {
        if node < 2 || !needed.insert(node) {
            continue;
        }
        if needed.len() > MOST_NODES {
            return Err(Unsupported::Nodes { limit: MOST_NODES });
        }
        if let Some(join) = (node as usize).checked_sub(leaves + 2) {
            if joins[join].1.len() > MOST_NODES {
                return Err(Unsupported::Nodes { limit: MOST_NODES });
            }
            open.extend(joins[join].1.iter().map(|edge| edge.node().0));
        }
    }
    Ok(needed.into_iter().collect())
}

/// True if a facet is convex: a line enters and leaves it at most once.
fn is_convex(program: &Program, facet: LeafFacet) -> bool {
    match &program.surface(facet.surface()).surface {
        Surface::Plane(_) => true,
        Surface::Sphere(_) | Surface::Cylinder(_) => facet.inside(),
        Surface::Quadric(quadric) => facet.inside() && quadric.weights.min_element() >= 0.0,
        _ => false,
    }
}

/// True if the device computes the roots of a facet.
pub(crate) fn has_kernel(program: &Program, facet: LeafFacet, tori: Tori) -> bool {
    let surface = &program.surface(facet.surface()).surface;
    !matches!(surface, Surface::Object(_)) && (tori == Tori::Chords || !is_torus(program, facet))
}

/// True if the surface of a facet is a torus or its affine image.
pub(crate) fn is_torus(program: &Program, facet: LeafFacet) -> bool {
    matches!(program.surface(facet.surface()).surface, Surface::Torus(_) | Surface::AffineTorus(_))
}
