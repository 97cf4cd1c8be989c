//! Boolean functions of a few spans, as straight-line programs over lane masks.
//!
//! A function is built once as a graph of two-input gates with common subexpressions shared and constants
//! folded. At run time two things are evaluated: its value, and its *boolean difference* with respect to a
//! span, which is true where the function changes if that span alone does (Akers, "On a theory of Boolean
//! functions", 1959).

use super::plan::STEPS;
use rayweave_model::{Edge, Expression, Gate, LeafId, NodeId, Rule};
use std::collections::HashMap;

/// A gate or its complement: the number of the gate, doubled, plus 1 for the complement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Wire(u32);

impl Wire {
    pub const FALSE: Wire = Wire(0);
    pub const TRUE: Wire = Wire(1);

    pub fn not(self) -> Wire {
        Wire(self.0 ^ 1)
    }

    fn gate(self) -> usize {
        (self.0 >> 1) as usize
    }

    fn is_complemented(self) -> bool {
        self.0 & 1 == 1
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Node {
    Constant,
    Input(u32),
    And(Wire, Wire),
    Xor(Wire, Wire),
}

/// A graph of gates.
#[derive(Clone, Debug)]
pub(super) struct Logic {
    nodes: Vec<Node>,
    known: HashMap<Node, Wire>,
}

impl Logic {
    pub fn new() -> Logic {
        Logic { nodes: vec![Node::Constant], known: HashMap::new() }
    }

    fn node(&mut self, node: Node) -> Wire {
        let fresh = Wire((self.nodes.len() as u32) << 1);
        let wire = *self.known.entry(node).or_insert(fresh);
        if wire == fresh {
            self.nodes.push(node);
        }
        wire
    }

    pub fn input(&mut self, k: usize) -> Wire {
        self.node(Node::Input(k as u32))
    }

    pub fn and(&mut self, a: Wire, b: Wire) -> Wire {
        let (a, b) = (a.min(b), a.max(b));
        match () {
            () if a == Wire::FALSE || a == b.not() => Wire::FALSE,
            () if a == Wire::TRUE || a == b => b,
            () => self.node(Node::And(a, b)),
        }
    }

    pub fn or(&mut self, a: Wire, b: Wire) -> Wire {
        self.and(a.not(), b.not()).not()
    }

    pub fn xor(&mut self, a: Wire, b: Wire) -> Wire {
        let complement = a.is_complemented() != b.is_complemented();
        let (a, b) = (Wire(a.0 & !1), Wire(b.0 & !1));
        let (a, b) = (a.min(b), a.max(b));
        let plain = match () {
            () if a == b => Wire::FALSE,
            () if a == Wire::FALSE => b,
            () => self.node(Node::Xor(a, b)),
        };
        if complement { plain.not() } else { plain }
    }

    /// The functions below some edges of an expression; `leaf` returns the function of a leaf. `None` if a
    /// leaf has none, or if there would be more than `most` gates.
    pub fn outputs(
        &mut self,
        expression: &Expression,
        outputs: &[Edge],
        most: usize,
        mut leaf: impl FnMut(&mut Logic, LeafId) -> Option<Wire>,
    ) -> Option<Vec<Wire>> {
        let mut wires: HashMap<NodeId, Wire> = HashMap::new();
        let mut waiting: Vec<NodeId> = outputs.iter().rev().map(|edge| edge.node()).collect();
        while let Some(&node) = waiting.last() {
            let before = waiting.len();
            let wire = match expression.node(node) {
                _ if wires.contains_key(&node) => None,
                Gate::Empty => Some(Wire::FALSE),
                Gate::Universe => Some(Wire::TRUE),
                Gate::Leaf(id) => Some(leaf(self, id)?),
                Gate::Join(_, operands) if operands.len() > most => return None,
                Gate::Join(rule, operands) => {
                    let missing = operands.iter().rev().map(|edge| edge.node());
                    waiting.extend(missing.filter(|node| !wires.contains_key(node)));
                    let operands: Option<Vec<_>> = operands.iter().map(|&edge| along(&wires, edge)).collect();
                    operands.map(|operands| self.join(rule, &operands))
                }
            };
            if self.nodes.len() > most || waiting.len() > 2 * most {
                return None;
            }
            if waiting.len() == before {
                waiting.pop();
                wires.extend(wire.map(|wire| (node, wire)));
            }
        }
        outputs.iter().map(|&edge| along(&wires, edge)).collect()
    }

    fn join(&mut self, rule: Rule, operands: &[Wire]) -> Wire {
        let fold = |logic: &mut Logic, start: Wire, gate: fn(&mut Logic, Wire, Wire) -> Wire| {
            operands.iter().fold(start, |all, &next| gate(logic, all, next))
        };
        match rule {
            Rule::Odd => fold(self, Wire::FALSE, Logic::xor),
            Rule::AtLeast(0) => Wire::TRUE,
            Rule::AtLeast(1) => fold(self, Wire::FALSE, Logic::or),
            Rule::AtLeast(least) if least as usize == operands.len() => fold(self, Wire::TRUE, Logic::and),
            Rule::AtLeast(least) => self.at_least(least as usize, operands),
        }
    }

    /// True if at least `least` of the operands are. `reached[k]` is "at least k + 1 of the operands so far".
    fn at_least(&mut self, least: usize, operands: &[Wire]) -> Wire {
        let mut reached = vec![Wire::FALSE; least];
        for &operand in operands {
            for k in (0..least).rev() {
                let below = if k == 0 { Wire::TRUE } else { reached[k - 1] };
                let more = self.and(below, operand);
                reached[k] = self.or(reached[k], more);
            }
        }
        reached[least - 1]
    }

    /// The functions with some inputs set to constants.
    pub fn with(&mut self, outputs: &[Wire], constant: impl Fn(usize) -> Option<Wire>) -> Vec<Wire> {
        let mut images: Vec<Wire> = Vec::with_capacity(self.nodes.len());
        let image = |images: &[Wire], wire: Wire| {
            let image = images[wire.gate()];
            if wire.is_complemented() { image.not() } else { image }
        };
        for at in 0..self.nodes.len() {
            let node = self.nodes[at];
            let wire = match node {
                Node::Constant => Wire::FALSE,
                Node::Input(input) => constant(input as usize).unwrap_or(Wire((at as u32) << 1)),
                Node::And(a, b) => {
                    let (a, b) = (image(&images, a), image(&images, b));
                    self.and(a, b)
                }
                Node::Xor(a, b) => {
                    let (a, b) = (image(&images, a), image(&images, b));
                    self.xor(a, b)
                }
            };
            images.push(wire);
        }
        outputs.iter().map(|&wire| image(&images, wire)).collect()
    }

    /// The boolean difference of the owner (the last function that is true) with respect to input `k`.
    pub fn difference(&mut self, outputs: &[Wire], k: usize) -> Wire {
        let without = self.with(outputs, |input| (input == k).then_some(Wire::FALSE));
        let with = self.with(outputs, |input| (input == k).then_some(Wire::TRUE));
        let (mut open, mut changes) = (Wire::TRUE, Wire::FALSE);
        for (a, b) in without.into_iter().zip(with).rev() {
            let differs = self.xor(a, b);
            let here = self.and(open, differs);
            changes = self.or(changes, here);
            let decided = self.or(a, b);
            open = self.and(open, decided.not());
        }
        changes
    }

    /// The literals, (input, true if not complemented), whose conjunction the function is; `None` if it is
    /// not a conjunction.
    pub fn cube(&self, function: Wire) -> Option<Vec<(u32, bool)>> {
        let (mut literals, mut waiting) = (Vec::new(), vec![function]);
        while let Some(wire) = waiting.pop() {
            match (self.nodes[wire.gate()], wire.is_complemented()) {
                (Node::Constant, true) => {}
                (Node::Input(k), complement) => literals.push((k, !complement)),
                (Node::And(a, b), false) => waiting.extend([a, b]),
                _ => return None,
            }
        }
        literals.sort_unstable();
        literals.dedup();
        Some(literals)
    }

    /// Compiles functions to a straight-line program.
    pub fn tape(&self, outputs: &[Wire]) -> Tape {
        let mut used = vec![false; self.nodes.len()];
        outputs.iter().for_each(|wire| used[wire.gate()] = true);
        for at in (0..self.nodes.len()).rev() {
            if let (true, Node::And(a, b) | Node::Xor(a, b)) = (used[at], self.nodes[at]) {
                used[a.gate()] = true;
                used[b.gate()] = true;
            }
        }
        let mut tape = Tape::default();
        let mut slots = vec![0u16; self.nodes.len()];
        for at in (0..self.nodes.len()).filter(|&at| used[at]) {
            let operand = |wire: Wire| (slots[wire.gate()], wire.is_complemented());
            let step = match self.nodes[at] {
                Node::Constant => Step::Constant,
                Node::Input(k) => {
                    tape.inputs |= 1 << k;
                    Step::Input(k as u16)
                }
                Node::And(a, b) => match (operand(a), operand(b)) {
                    ((a, false), (b, false)) => Step::And(a, b),
                    ((a, false), (b, true)) | ((b, true), (a, false)) => Step::AndNot(a, b),
                    ((a, true), (b, true)) => Step::Nor(a, b),
                },
                Node::Xor(a, b) => Step::Xor(operand(a).0, operand(b).0),
            };
            slots[at] = tape.steps.len() as u16;
            tape.steps.push(step);
        }
        tape.outputs = outputs.iter().map(|wire| (slots[wire.gate()], wire.is_complemented())).collect();
        tape
    }
}

/// The function of an edge; `None` if that of its node is not known yet.
fn along(wires: &HashMap<NodeId, Wire>, edge: Edge) -> Option<Wire> {
    let wire = *wires.get(&edge.node())?;
    Some(if edge.is_complemented() { wire.not() } else { wire })
}

/// An instruction of a tape; operands are indices of earlier instructions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    Constant,
    Input(u16),
    And(u16, u16),
    AndNot(u16, u16),
    Nor(u16, u16),
    Xor(u16, u16),
}

/// A straight-line program.
#[derive(Clone, Debug, Default)]
pub(super) struct Tape {
    pub steps: Vec<Step>,
    /// The instructions that give the outputs, and whether each is complemented.
    pub outputs: Vec<(u16, bool)>,
    /// Bit mask of the inputs that are read.
    pub inputs: u64,
}

impl Tape {
    /// The owner for one set of inputs, given as a bit mask: the number, from 1, of the last output that is
    /// true; 0 if none is.
    pub fn owner(&self, inputs: u64) -> u32 {
        let mut values = [false; STEPS];
        for (at, step) in self.steps.iter().enumerate() {
            let value = |k: u16| values[k as usize];
            values[at] = match *step {
                Step::Constant => false,
                Step::Input(k) => inputs >> k & 1 == 1,
                Step::And(a, b) => value(a) && value(b),
                Step::AndNot(a, b) => value(a) && !value(b),
                Step::Nor(a, b) => !(value(a) || value(b)),
                Step::Xor(a, b) => value(a) != value(b),
            };
        }
        let holds = |&(k, complement): &(u16, bool)| values[k as usize] != complement;
        self.outputs.iter().rposition(holds).map_or(0, |k| k as u32 + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random functions of six inputs, compared with their truth tables of 64 bits.
    #[test]
    fn tapes_and_differences_agree_with_truth_tables() {
        let mut state = 11u64;
        let mut below = |n: usize| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((state >> 33) as usize) % n
        };
        for _ in 0..300 {
            let mut logic = Logic::new();
            let column =
                |k: usize| (0..64).filter(|row| row >> k & 1 == 1).fold(0u64, |all, row| all | 1 << row);
            let mut pool: Vec<(Wire, u64)> = (0..6).map(|k| (logic.input(k), column(k))).collect();
            for _ in 0..12 {
                let ((a, ta), (b, tb)) = (pool[below(pool.len())], pool[below(pool.len())]);
                pool.push(match below(4) {
                    0 => (logic.and(a, b), ta & tb),
                    1 => (logic.or(a, b), ta | tb),
                    2 => (logic.xor(a, b), ta ^ tb),
                    _ => (a.not(), !ta),
                });
            }
            let outputs: Vec<(Wire, u64)> =
                (0..1 + below(3)).map(|_| pool[pool.len() - 1 - below(8)]).collect();
            let wires: Vec<Wire> = outputs.iter().map(|output| output.0).collect();
            let owner = |row: u64| outputs.iter().rposition(|output| output.1 >> row & 1 == 1);
            let tape = logic.tape(&wires);
            for row in 0..64 {
                assert_eq!(tape.owner(row), owner(row).map_or(0, |k| k as u32 + 1));
            }
            for k in 0..6 {
                let difference = logic.difference(&wires, k);
                let tape = logic.tape(&[difference]);
                for row in 0..64 {
                    assert_eq!(tape.owner(row) == 1, owner(row) != owner(row ^ 1 << k));
                }
            }
        }
    }

    #[test]
    fn cubes_are_conjunctions_of_inputs() {
        let mut logic = Logic::new();
        let [a, b, c]: [Wire; 3] = std::array::from_fn(|k| logic.input(k));
        let neither = logic.or(b, c).not();
        let cube = logic.and(neither, a);
        assert_eq!(logic.cube(cube), Some(vec![(0, true), (1, false), (2, false)]));
        assert_eq!(logic.cube(Wire::TRUE), Some(Vec::new()));
        assert_eq!(logic.cube(Wire::FALSE), None);
        let either = logic.or(a, b);
        assert_eq!(logic.cube(either), None);
    }

    #[test]
    fn thresholds_count() {
        for least in 1..=5 {
            let mut logic = Logic::new();
            let operands: Vec<Wire> = (0..5).map(|k| logic.input(k)).collect();
            let wire = logic.join(Rule::AtLeast(least), &operands);
            let tape = logic.tape(&[wire]);
            for row in 0..32u64 {
                assert_eq!(tape.owner(row) == 1, row.count_ones() >= least);
            }
        }
    }
}
