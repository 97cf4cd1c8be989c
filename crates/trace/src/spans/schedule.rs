//! The order in which the nodes of an expression are computed, and the slots of their results.

use rayweave_model::{Edge, Expression, Gate, Rule};
use rayweave_rootray::CountRule;
use std::ops::Range;

/// A sequence of steps, each of which writes its result to a numbered slot; a slot is reused after the last
/// use of its result.
///
/// Of a gate's operands, the one that needs the most slots is computed first (R. Sethi, J. D. Ullman, "The generation
/// of optimal code for arithmetic expressions", J. ACM 17, 1970). So a tree of n nodes whose gates have at most k
/// operands needs O(k log n) slots, and a chain of any depth needs three. Nodes with several users keep their slot up
/// to the last use.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    pub steps: Vec<Step>,
    operands: Vec<Operand>,
    outputs: Vec<Operand>,
    slots: u32,
}

/// The computation of one node.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Step {
    pub what: What,
    /// The slot of the result.
    pub slot: u32,
}

/// The operation of a step.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum What {
    /// Outside (`false`) or inside everywhere.
    Constant(bool),
    /// A leaf, by its number in the group.
    Leaf(u32),
    /// A gate over a range of operands.
    Join(CountRule, Range<u32>),
}

/// A result used as an operand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Operand {
    pub slot: u32,
    pub complemented: bool,
}

impl Schedule {
    /// The schedule of all nodes that the outputs depend on.
    pub fn new(expression: &Expression) -> Schedule {
        let (nodes, outputs): (&[Gate], _) = (&expression.nodes().collect::<Vec<_>>(), expression.outputs());
        let mut builder = Builder {
            nodes,
            needs: needs(nodes),
            uses: uses(nodes, outputs),
            slots: vec![None; nodes.len()],
            free: Vec::new(),
            schedule: Schedule { steps: Vec::new(), operands: Vec::new(), outputs: Vec::new(), slots: 0 },
        };
        outputs.iter().for_each(|edge| builder.visit(edge.node().index()));
        builder.schedule.outputs = outputs.iter().map(|&edge| builder.operand(edge)).collect();
        builder.schedule
    }

    /// The operands of a gate.
    pub fn operands(&self, range: &Range<u32>) -> &[Operand] {
        &self.operands[range.start as usize..range.end as usize]
    }

    /// The final results.
    pub fn outputs(&self) -> &[Operand] {
        &self.outputs
    }

    /// The number of slots: the largest number of results kept at a time.
    pub fn slots(&self) -> usize {
        self.slots as usize
    }
}

/// The number of users of each node; 0 if it is not reachable from an output.
fn uses(nodes: &[Gate], outputs: &[Edge]) -> Vec<u32> {
    let mut uses = vec![0; nodes.len()];
    outputs.iter().for_each(|edge| uses[edge.node().index()] += 1);
    for (node, gate) in nodes.iter().enumerate().rev() {
        if uses[node] > 0 {
            operands_of(gate).iter().for_each(|edge| uses[edge.node().index()] += 1);
        }
    }
    uses
}

/// The number of slots that each node needs if nothing is shared: while operand k, in order of falling need,
/// is computed, the results of k others are kept.
fn needs(nodes: &[Gate]) -> Vec<u32> {
    let (mut needs, mut below) = (Vec::with_capacity(nodes.len()), Vec::<u32>::new());
    for gate in nodes {
        let operands = operands_of(gate);
        below.clear();
        below.extend(operands.iter().map(|edge| needs[edge.node().index()]));
        below.sort_unstable_by(|a, b| b.cmp(a));
        let most = below.iter().zip(0..).map(|(need, kept)| need + kept).max();
        needs.push(most.unwrap_or(0).max(operands.len() as u32 + 1));
    }
    needs
}

fn operands_of<'g>(gate: &'g Gate) -> &'g [Edge] {
    match gate {
        Gate::Join(_, operands) => operands,
        _ => &[],
    }
}

struct Builder<'e> {
    nodes: &'e [Gate<'e>],
    needs: Vec<u32>,
    uses: Vec<u32>,
    /// The slot of each node's result, once it has been computed.
    slots: Vec<Option<u32>>,
    free: Vec<u32>,
    schedule: Schedule,
}

/// Pending work of the builder.
enum Task {
    Visit(usize),
    Compute(usize),
}

impl Builder<'_> {
    /// Schedules a node, after all nodes that it depends on.
    fn visit(&mut self, node: usize) {
        let mut tasks = vec![Task::Visit(node)];
        while let Some(task) = tasks.pop() {
            match task {
                Task::Visit(node) if self.slots[node].is_none() => {
                    tasks.push(Task::Compute(node));
                    let below = tasks.len();
                    let operands = operands_of(&self.nodes[node]).iter().map(|edge| edge.node().index());
                    tasks.extend(operands.map(Task::Visit));
                    // tasks are a stack: the last one is executed first
                    tasks[below..].sort_by_key(|task| match task {
                        Task::Visit(node) | Task::Compute(node) => self.needs[*node],
                    });
                }
                Task::Visit(_) => {}
                Task::Compute(node) => self.compute(node),
            }
        }
    }

    fn compute(&mut self, node: usize) {
        // allocated before the operands' slots are freed, so that a result never overwrites an operand
        let slot = self.free.pop().unwrap_or_else(|| {
            self.schedule.slots += 1;
            self.schedule.slots - 1
        });
        let what = match &self.nodes[node] {
            Gate::Empty => What::Constant(false),
            Gate::Universe => What::Constant(true),
            Gate::Leaf(leaf) => What::Leaf(leaf.0),
            Gate::Join(rule, operands) => self.join(*rule, operands),
        };
        self.slots[node] = Some(slot);
        self.schedule.steps.push(Step { what, slot });
    }

    fn join(&mut self, rule: Rule, operands: &[Edge]) -> What {
        let first = self.schedule.operands.len() as u32;
        for &edge in operands {
            let operand = self.operand(edge);
            self.schedule.operands.push(operand);
        }
        for edge in operands {
            let node = edge.node().index();
            self.uses[node] -= 1;
            if self.uses[node] == 0 {
                self.free.extend(self.slots[node]);
            }
        }
        let rule = match rule {
            Rule::AtLeast(least) => CountRule::AtLeast(least as usize),
            Rule::Odd => CountRule::Odd,
        };
        What::Join(rule, first..self.schedule.operands.len() as u32)
    }

    fn operand(&self, edge: Edge) -> Operand {
        // operands are computed first, so the slot exists
        Operand { slot: self.slots[edge.node().index()].unwrap_or(0), complemented: edge.is_complemented() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_model::LeafId;
    use rayweave_model::simplify::{Formula, Op};

    /// Runs a schedule on booleans and compares the outputs with an evaluation of the formula.
    fn check(formula: &Formula, leaves: u32) -> Schedule {
        let expression = Expression::new(formula, leaves as usize);
        let schedule = Schedule::new(&expression);
        for pattern in 0..1u32 << leaves {
            let inside = |leaf: u32| pattern >> leaf & 1 == 1;
            let mut slots = vec![false; schedule.slots()];
            let value = |slots: &[bool], o: &Operand| slots[o.slot as usize] ^ o.complemented;
            for step in &schedule.steps {
                slots[step.slot as usize] = match &step.what {
                    What::Constant(inside) => *inside,
                    What::Leaf(leaf) => inside(*leaf),
                    What::Join(rule, range) => rule.is_inside(
                        schedule.operands(range).iter().filter(|operand| value(&slots, operand)).count(),
                    ),
                };
            }
            let mut values = Vec::new();
            formula.evaluate(|leaf| inside(leaf.0), &mut values);
            let outputs = formula.outputs().iter();
            let expected = outputs.map(|edge| values[edge.node().index()] ^ edge.is_complemented());
            assert!(schedule.outputs().iter().map(|output| value(&slots, output)).eq(expected));
        }
        schedule
    }

    fn leaves(formula: &mut Formula, count: u32) -> Vec<Edge> {
        (0..count).map(|k| formula.leaf(LeafId(k))).collect()
    }

    #[test]
    fn a_chain_needs_three_slots() {
        let mut f = Formula::default();
        let x = leaves(&mut f, 12);
        // the deep operand is the last, and is computed first
        let chain = x.iter().skip(1).enumerate().fold(x[0], |below, (k, &next)| match k % 2 {
            0 => f.join(Op::Union, &[next, below]),
            _ => f.join(Op::Difference, &[next, below]),
        });
        f.add_output(chain);
        assert_eq!(check(&f, 12).slots(), 3);
    }

    #[test]
    fn a_balanced_tree_needs_a_slot_more_than_its_height() {
        let mut f = Formula::default();
        let mut level = leaves(&mut f, 16);
        for op in [Op::SymmetricDifference, Op::Intersection, Op::Union, Op::Difference] {
            level = level.chunks(2).map(|pair| f.join(op, pair)).collect();
        }
        f.add_output(level[0]);
        assert_eq!(check(&f, 16).slots(), 6);
    }

    #[test]
    fn shared_nodes_are_computed_once_and_kept() {
        let mut f = Formula::default();
        let x = leaves(&mut f, 4);
        let shared = f.join(Op::Union, &[x[0], x[1]]);
        let left = f.join(Op::AtLeast(2), &[shared, x[2], x[3].complement()]);
        let right = f.join(Op::SymmetricDifference, &[shared, x[3]]);
        let top = f.join(Op::Union, &[left, right.complement()]);
        let unused = f.join(Op::Union, &[top, x[0]]);
        assert_ne!(unused, top);
        let outputs = [top, shared.complement(), Edge::EMPTY, Edge::UNIVERSE, x[2], top.complement()];
        outputs.into_iter().for_each(|edge| f.add_output(edge));
        let schedule = check(&f, 4);
        assert_eq!(schedule.steps.iter().filter(|step| matches!(step.what, What::Join(..))).count(), 4);
    }
}
