//! What the nodes of a tree are called, and sentences about them.

use super::explain::Operand;
use super::{Kind, Node, Op, SingleHit, Step, Tree, Verdict};
use rayweave_model::{Evaluator, LeafId, Program, PrototypeId};
use std::collections::HashMap;

/// Operands over more nodes than this are not written out in a formula: three leaves.
const WRITTEN_OUT: usize = 5;

/// The names of the nodes of a model's tree.
pub(super) struct Names<'a> {
    program: &'a Program,
    tree: &'a Tree,
    /// How many leaves have the same name.
    namesakes: HashMap<&'a str, u32>,
    /// The number of the output at a node.
    outputs: HashMap<usize, usize>,
}

impl<'a> Names<'a> {
    pub fn new(evaluator: &'a SingleHit) -> Names<'a> {
        let (program, tree) = (evaluator.program(), evaluator.tree(PrototypeId(0)));
        let mut namesakes = HashMap::new();
        let leaves = &program.prototype(PrototypeId(0)).leaves;
        for leaf in &program.leaves()[leaves.start as usize..leaves.end as usize] {
            *namesakes.entry(&*leaf.name).or_insert(0) += 1;
        }
        let outputs = (0..program.regions().len()).map(|k| (tree.output(k as u32), k)).collect();
        Names { program, tree, namesakes, outputs }
    }

    pub fn program(&self) -> &'a Program {
        self.program
    }

    pub fn node(&self, node: usize) -> &'a Node {
        &self.tree.nodes()[node]
    }

    pub fn operands(&self, gate: usize) -> [usize; 2] {
        self.tree.operands(gate)
    }

    /// The number of the leaf at a node.
    pub fn leaf(&self, node: usize) -> Option<u32> {
        match self.node(node).kind {
            Kind::Leaf(leaf) => Some(leaf),
            _ => None,
        }
    }

    pub fn leaf_id(&self, leaf: u32) -> LeafId {
        LeafId(self.program.prototype(PrototypeId(0)).leaves.start + leaf)
    }

    /// The name of a node, its complement not counted: `a`, `a | b`, `(a ... k) - l`.
    pub fn of(&self, node: usize) -> String {
        match self.node(node).kind {
            Kind::Constant(0) => "vacuum".to_owned(),
            Kind::Constant(_) => "plenum".to_owned(),
            Kind::Leaf(leaf) => self.leaf_name(leaf),
            Kind::Gate(Op::Last) => self.regions_name(node),
            Kind::Gate(op) => self.formula(op, node),
        }
    }

    fn leaf_name(&self, leaf: u32) -> String {
        let name = &*self.program.leaf(self.leaf_id(leaf)).name;
        match self.namesakes.get(name) {
            Some(&count) if count > 1 => format!("{name} {leaf}"),
            _ => name.to_owned(),
        }
    }

    fn regions_name(&self, node: usize) -> String {
        let range = self.node(node).begin as usize..=node;
        let mut inside: Vec<_> =
            self.outputs.iter().filter(|(at, _)| range.contains(at)).map(|x| *x.1).collect();
        inside.sort_unstable();
        let name = |k: usize| &*self.program.regions()[k].name;
        match inside[..] {
            [first, last] => format!("{} then {}", name(first), name(last)),
            [first, .., last] => format!("the regions {} to {}", name(first), name(last)),
            _ => "the regions".to_owned(),
        }
    }

    fn formula(&self, op: Op, node: usize) -> String {
        let [a, b] = self.operands(node);
        let sign = match op {
            Op::AtLeast { least: 1, most: [1, 1] } => "|",
            Op::AtLeast { least: 2, most: [1, 1] } if self.node(b).complemented => {
                return format!("{} - {}", self.operand(a, op), self.bracketed(b, None));
            }
            Op::AtLeast { least: 2, most: [1, 1] } => "&",
            Op::Odd => "^",
            Op::AtLeast { least, .. } => return format!("at least {least} of {}", self.ends(node)),
            Op::Sum | Op::Last => return format!("the number of {}", self.ends(node)),
        };
        format!("{} {sign} {}", self.operand(a, op), self.operand(b, op))
    }

    /// An operand in a formula, with its complement.
    fn operand(&self, node: usize, above: Op) -> String {
        if self.node(node).complemented {
            format!("~{}", self.bracketed(node, None))
        } else {
            self.bracketed(node, Some(above))
        }
    }

    /// In brackets, but for leaves and gates like the one above.
    fn bracketed(&self, node: usize, above: Option<Op>) -> String {
        match self.node(node).kind {
            Kind::Gate(_) if node + 1 - self.node(node).begin as usize > WRITTEN_OUT => self.ends(node),
            Kind::Gate(op) if Some(op) != above || self.is_difference(node) => format!("({})", self.of(node)),
            _ => self.of(node),
        }
    }

    fn is_difference(&self, node: usize) -> bool {
        let and = matches!(self.node(node).kind, Kind::Gate(Op::AtLeast { least: 2, .. }));
        and && self.node(self.operands(node)[1]).complemented
    }

    /// The first and the last of the leaves below a node.
    fn ends(&self, node: usize) -> String {
        let leaf = |node: usize| self.leaf(node).map(|leaf| self.leaf_name(leaf));
        let mut below = self.node(node).begin as usize..node;
        let (first, last) = (below.find_map(leaf), below.rev().find_map(leaf));
        format!("({} ... {})", first.unwrap_or_default(), last.unwrap_or_default())
    }

    /// What a value of a node means.
    fn value(&self, node: usize, value: u32) -> String {
        match self.node(node).kind {
            Kind::Gate(Op::Sum) => format!("at {value}"),
            Kind::Gate(Op::Last) => match value.checked_sub(1) {
                Some(region) => format!("in {}", self.program.regions()[region as usize].name),
                None => "in the world".to_owned(),
            },
            _ if value == 0 => "outside".to_owned(),
            _ => "inside".to_owned(),
        }
    }

    /// What an answer of a node means; as a verb.
    fn answer(&self, node: usize, answer: Step) -> String {
        if let Kind::Gate(Op::Sum | Op::Last) = self.node(node).kind {
            return match answer.settled() {
                Some(value) => format!("is {} for good", self.value(node, value)),
                None => format!("changes to {} at {}", self.value(node, answer.after), answer.t),
            };
        }
        format!("is {}", answer.next())
    }

    /// The sentence about a decision.
    pub fn sentence(&self, gate: usize, operands: &[Operand; 2], verdict: Verdict) -> String {
        let name = self.of(gate);
        match verdict {
            Verdict::Fixed(value) => {
                let [a, b] = operands.each_ref().map(|x| x.answer.settled().map(|_| self.own_answer(x)));
                let reason = match (a, b) {
                    (Some(a), Some(b)) => format!("{a}, and {b}"),
                    (a, b) => format!("{}, whatever comes of the other", a.or(b).unwrap_or_default()),
                };
                format!("{name} {}: {reason}.", self.answer(gate, Step::constant(value)))
            }
            Verdict::Changes(step) => {
                format!("{name} {}: {}.", self.answer(gate, step), self.who(operands, step.t))
            }
            Verdict::AskAgain { t, first, second } => {
                let value = self.value(gate, self.gate_value(gate, operands));
                let asked = operands.iter().zip([first, second]).filter(|x| x.1).map(|x| &*x.0.name);
                let asked = asked.collect::<Vec<_>>().join(" and ");
                let who = self.who(operands, t);
                format!("{name} stays {value} at {t}: {who}, which changes nothing. Ask {asked} again.")
            }
        }
    }

    fn gate_value(&self, gate: usize, operands: &[Operand; 2]) -> u32 {
        match self.node(gate).kind {
            Kind::Gate(op) => op.of(operands[0].answer.before, operands[1].answer.before),
            _ => 0,
        }
    }

    /// Which operands change at a time.
    fn who(&self, operands: &[Operand; 2], t: f64) -> String {
        let names: Vec<&str> = operands.iter().filter(|x| x.answer.t == t).map(|x| &*x.name).collect();
        match names[..] {
            [only] => format!("{only} comes first"),
            _ => format!("{} come together", names.join(" and ")),
        }
    }

    /// What an operand says of itself, without the complement and the weight that the gate sees it with.
    fn own_answer(&self, operand: &Operand) -> String {
        let own = operand.answer.map(|value| match self.node(operand.node).kind {
            Kind::Gate(Op::Sum | Op::Last) => value,
            _ => u32::from((value != 0) != operand.complemented),
        });
        format!("{} {}", operand.name, self.answer(operand.node, own))
    }
}
