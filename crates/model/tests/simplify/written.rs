//! Random formulas with their truth tables, computed independently.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_model::simplify::{Formula, Op};
use rayweave_model::{Edge, LeafId};

/// A truth table with one bit for each assignment: leaf k is bit k of the assignment's number.
pub type Table = Vec<u64>;

/// A formula with the table of each of its edges, computed independently of the library, 64 assignments at a
/// time.
pub struct Written {
    pub formula: Formula,
    leaves: u32,
    tables: Vec<(Edge, Table)>,
    pub outputs: Vec<Table>,
}

impl Written {
    pub fn new(leaves: u32) -> Written {
        let mut formula = Formula::default();
        let constant = |bits| vec![bits; words(leaves)];
        let mut tables = vec![(Edge::EMPTY, constant(0)), (Edge::UNIVERSE, constant(u64::MAX))];
        for leaf in 0..leaves {
            tables.push((formula.leaf(LeafId(leaf)), leaf_table(leaf, leaves)));
        }
        Written { formula, leaves, tables, outputs: Vec::new() }
    }

    /// The number of possible operands: empty, universe, the leaves, and the joins so far.
    pub fn count(&self) -> usize {
        self.tables.len()
    }

    fn operand(&self, (number, complemented): (usize, bool)) -> (Edge, Table) {
        let (edge, table) = &self.tables[number];
        match complemented {
            true => (edge.complement(), table.iter().map(|word| !word).collect()),
            false => (*edge, table.clone()),
        }
    }

    /// Joins operands, each given with whether it is complemented.
    pub fn join(&mut self, op: Op, operands: &[(usize, bool)]) {
        let operands: Vec<(Edge, Table)> = operands.iter().map(|&operand| self.operand(operand)).collect();
        let edges: Vec<Edge> = operands.iter().map(|operand| operand.0).collect();
        let table = (0..words(self.leaves))
            .map(|word| join_words(op, operands.iter().map(|operand| operand.1[word]).collect()))
            .collect();
        self.tables.push((self.formula.join(op, &edges), table));
    }

    pub fn add_output(&mut self, operand: (usize, bool)) {
        let (edge, table) = self.operand(operand);
        self.formula.add_output(edge);
        self.outputs.push(table);
    }

    /// Compares the outputs of a formula that should be equivalent with the tables.
    #[track_caller]
    pub fn check(&self, prepared: &Formula, what: &str) {
        let mut values = Vec::new();
        assert_eq!(prepared.outputs().len(), self.outputs.len());
        for assignment in 0..1usize << self.leaves {
            prepared.evaluate(|leaf| assignment >> leaf.0 & 1 == 1, &mut values);
            for (&edge, table) in prepared.outputs().iter().zip(&self.outputs) {
                let value = values[edge.node().index()] ^ edge.is_complemented();
                let expected = table[assignment / 64] >> (assignment % 64) & 1 == 1;
                if value != expected {
                    let texts = self.formula.outputs().iter().map(|&edge| self.formula.text(edge));
                    panic!("{what} of {:?} is {}", texts.collect::<Vec<_>>(), prepared.text(edge));
                }
            }
        }
    }
}

fn words(leaves: u32) -> usize {
    (1usize << leaves).div_ceil(64)
}

fn leaf_table(leaf: u32, leaves: u32) -> Table {
    let bit = |assignment: usize| (assignment >> leaf & 1) as u64;
    (0..words(leaves)).map(|word| (0..64).map(|k| bit(64 * word + k) << k).sum()).collect()
}

/// The truth table of an operation by its definition, 64 assignments at a time.
fn join_words(op: Op, words: Vec<u64>) -> u64 {
    match op {
        Op::Union => words.iter().fold(0, |a, b| a | b),
        Op::Intersection => words.iter().fold(u64::MAX, |a, b| a & b),
        Op::Difference => match words.split_first() {
            None => 0,
            Some((first, rest)) => rest.iter().fold(*first, |a, b| a & !b),
        },
        Op::SymmetricDifference => words.iter().fold(0, |a, b| a ^ b),
        Op::AtLeast(least) => (0..64)
            .filter(|k| words.iter().filter(|&word| word >> k & 1 == 1).count() >= least as usize)
            .map(|k| 1u64 << k)
            .sum(),
    }
}

/// A stream of random choices.
pub struct Choices(ChaCha8Rng);

impl Choices {
    pub fn new(seed: u64) -> Choices {
        Choices(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn below(&mut self, n: usize) -> usize {
        self.0.random_range(0..n)
    }

    pub fn chance(&mut self, one_in: usize) -> bool {
        self.below(one_in) == 0
    }

    fn op(&mut self, count: usize) -> Op {
        match self.below(9) {
            0..3 => Op::Union,
            3..5 => Op::Intersection,
            5 | 6 => Op::Difference,
            7 => Op::SymmetricDifference,
            _ => Op::AtLeast(self.below(count + 2) as u32),
        }
    }

    /// A formula with nodes used once, several times and never, constants, and operators with no, one and
    /// many operands.
    pub fn formula(&mut self, leaves: u32, joins: usize) -> Written {
        let mut written = Written::new(leaves);
        let mut unused: Vec<usize> = (2..written.count()).collect();
        for _ in 0..joins {
            let count = [0, 1, 1, 2, 2, 2, 2, 2, 3, 3, 4, 5][self.below(12)];
            let operands: Vec<(usize, bool)> = (0..count)
                .map(|_| {
                    let any = unused.is_empty() || self.chance(4);
                    let number = match any {
                        true => self.below(written.count()),
                        false => unused.swap_remove(self.below(unused.len())),
                    };
                    (number, self.chance(3))
                })
                .collect();
            unused.push(written.count());
            let op = self.op(count);
            written.join(op, &operands);
        }
        for _ in 0..1 + self.below(3) {
            let number = if self.chance(5) { self.below(written.count()) } else { written.count() - 1 };
            let complemented = self.chance(3);
            written.add_output((number, complemented));
        }
        written
    }
}
