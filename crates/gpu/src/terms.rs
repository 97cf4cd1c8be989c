//! The model as a union of items, for models that are too large for one group.

use crate::error::Unsupported;
use crate::flat::MOST_NODES;
use rayweave_math::Bounds;
use rayweave_model::{Edge, LeafId, LeafKind, Place, Program, PrototypeId, Rule};

/// A part of a model: an edge of its group, or a placed solid. Points in several items belong to the one with the highest
/// priority.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    pub edge: Edge,
    /// The map, group and placement of a placed solid.
    pub instance: Option<(Place, PrototypeId, u32)>,
    /// The number of its region on the device, from 1.
    pub priority: u32,
    /// A box around it, in the frame of the model.
    pub bounds: Bounds,
}

/// A model as a list of items.
#[derive(Clone, Debug, Default)]
pub(crate) struct Top {
    pub items: Vec<Item>,
    /// The region of each priority; priority 0 is the world.
    pub regions: Vec<u32>,
}

/// The properties of a group for the search for items.
struct Group<'p> {
    program: &'p Program,
    leaves: usize,
    first: u32,
    joins: Vec<(Rule, &'p [Edge])>,
    /// Boxes of nodes, from node 2 on.
    boxes: Vec<Bounds>,
}

impl Top {
    /// The items of a model: the operands of its unions; for a single region also what is removed from it, as items with a
    /// higher priority that belong to the world.
    pub fn new(program: &Program) -> Result<Top, Unsupported> {
        let group = Group::new(program);
        let mut top = Top { items: Vec::new(), regions: vec![0] };
        let outputs = program.prototype(PrototypeId(0)).expression.outputs();
        if let [only] = outputs
            && let Some((kept, removed)) = group.carved(*only)
        {
            top.regions.extend([1, 0]);
            top.union(&group, &kept, 1)?;
            for edge in removed {
                top.union(&group, &[edge.complement()], 2)?;
            }
            return Ok(top);
        }
        for (k, &edge) in outputs.iter().enumerate() {
            let region = k as u32 + 1;
            top.regions.push(region);
            top.union(&group, &[edge], region)?;
        }
        Ok(top)
    }

    /// Adds the operands of a union.
    fn union(&mut self, group: &Group<'_>, edges: &[Edge], priority: u32) -> Result<(), Unsupported> {
        let mut open: Vec<Edge> = edges.iter().rev().copied().collect();
        while let Some(edge) = open.pop() {
            if edge == Edge::EMPTY {
                continue;
            }
            match group.operands_of_union(edge) {
                Some(operands) => open.extend(operands.iter().rev()),
                None => self.items.push(group.item(edge, priority)),
            }
            if self.items.len() > 1 << 26 {
                return Err(Unsupported::Nodes { limit: MOST_NODES });
            }
        }
        Ok(())
    }
}

impl<'p> Group<'p> {
    fn new(program: &'p Program) -> Group<'p> {
        let prototype = program.prototype(PrototypeId(0));
        let (first, leaves) = (prototype.leaves.start, prototype.leaves.len());
        let joins: Vec<(Rule, &[Edge])> = prototype.expression.joins().collect();
        let mut boxes: Vec<Bounds> =
            prototype.leaves.clone().map(|leaf| program.leaf_bounds(LeafId(leaf))).collect();
        for (rule, operands) in &joins {
            let of = |edge: &Edge| match edge.node().0 {
                _ if edge.is_complemented() => Bounds::ALL,
                0 => Bounds::EMPTY,
                1 => Bounds::ALL,
                node => boxes[node as usize - 2],
            };
            let is_all = *rule == Rule::AtLeast(operands.len() as u32);
            let bounds = operands.iter().map(of);
            boxes.push(match is_all {
                true => bounds.fold(Bounds::ALL, |a, b| a.intersection(&b)),
                false => bounds.fold(Bounds::EMPTY, |a, b| a.union(&b)),
            });
        }
        Group { program, leaves, first, joins, boxes }
    }

    fn join(&self, edge: Edge) -> Option<(Rule, &'p [Edge])> {
        let k = edge.node().index().checked_sub(self.leaves + 2)?;
        Some(self.joins[k])
    }

    fn operands_of_union(&self, edge: Edge) -> Option<&'p [Edge]> {
        match self.join(edge)? {
            (Rule::AtLeast(1), operands) if !edge.is_complemented() => Some(operands),
            _ => None,
        }
    }

    /// The kept operands and the removed ones, as edges that do not hold inside, of an intersection with many removed operands.
    /// There is one kept operand.
    fn carved(&self, edge: Edge) -> Option<(Vec<Edge>, Vec<Edge>)> {
        let (rule, operands) = self.join(edge)?;
        if edge.is_complemented() || rule != Rule::AtLeast(operands.len() as u32) {
            return None;
        }
        let (removed, kept): (Vec<Edge>, Vec<Edge>) =
            operands.iter().partition(|edge| edge.is_complemented());
        (kept.len() == 1 && !removed.is_empty()).then_some((kept, removed))
    }

    fn item(&self, edge: Edge, priority: u32) -> Item {
        let node = edge.node().index();
        let bounds = match (edge.is_complemented(), node.checked_sub(2)) {
            (false, Some(k)) => self.boxes[k],
            _ => Bounds::ALL,
        };
        let mut item = Item { edge, instance: None, priority, bounds };
        if !edge.is_complemented() && (2..self.leaves + 2).contains(&node) {
            let leaf = self.program.leaf(LeafId(self.first + node as u32 - 2));
            if let LeafKind::Instance { prototype, placement } = leaf.kind() {
                item.instance = Some((leaf.place(), prototype, placement));
            }
        }
        item
    }
}
