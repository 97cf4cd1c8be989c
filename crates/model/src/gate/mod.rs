//! Boolean networks that follow single flips of leaves.
//!
//! A [`Network`] is the expression of a group laid out for sweeping along a ray: a leaf flips, and the
//! change runs upwards as far as it changes anything. Three layouts give the same answers:
//!
//! - counters, for trees: each gate counts the operands that are inside. A flip costs at most the depth.
//! - ordered counters, where a node has several users: gates are settled in topological order, each once.
//! - heavy paths, for deep trees: a flip costs O(log^2 n) whatever the depth (see `heavy`).

mod heavy;
mod winner;

use crate::{Edge, Expression, Gate, Rule};
use heavy::HeavyPaths;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

pub use winner::Winner;

/// Trees deeper than this are swept by heavy paths. A flip by counters costs a few nanoseconds a level and
/// one by heavy paths some hundred at once, so the border is not critical.
const DEEP: u32 = 64;

/// A boolean network over the leaves of a group, with one or more outputs.
#[derive(Clone, Debug)]
pub struct Network {
    /// Leaves first, then gates, operands before users.
    rules: Vec<Rule>,
    leaf_count: u32,
    /// Users of node k: `users[first_user[k]..first_user[k + 1]]`, bit 0 set where k is complemented.
    first_user: Vec<u32>,
    users: Vec<u32>,
    /// The outputs that a node feeds, as (node, output, complemented), sorted by node.
    fed: Vec<(u32, u32, bool)>,
    feeds: Vec<bool>,
    layout: Layout,
    initial: NetworkState,
}

#[derive(Clone, Debug)]
enum Layout {
    Counters,
    Ordered,
    Heavy(HeavyPaths),
}

/// The values of all nodes of a network: one per thread and group.
#[derive(Clone, Debug, Default)]
pub struct NetworkState {
    leaves: Vec<bool>,
    counts: Vec<u32>,
    winner: Winner,
    heavy: heavy::HeavyState,
    waiting: BinaryHeap<Reverse<u32>>,
}

impl NetworkState {
    /// The number of the last output that is inside, counted from 1; 0 if none is.
    pub fn winner(&self) -> u32 {
        self.winner.last()
    }

    /// True if output number `k`, counted from 0, is inside.
    pub fn output(&self, k: u32) -> bool {
        self.winner.get(k)
    }

    /// True if a leaf is inside.
    pub fn leaf(&self, leaf: u32) -> bool {
        self.leaves[leaf as usize]
    }
}

impl Network {
    /// Lays out an expression over `leaf_count` leaves for the given outputs.
    pub fn new(expression: &Expression, outputs: &[Edge], leaf_count: usize) -> Network {
        Builder::new(expression, outputs, leaf_count).finish()
    }

    /// The state in which every leaf is outside.
    pub fn start(&self) -> NetworkState {
        self.initial.clone()
    }

    /// The number of gates.
    pub fn gate_count(&self) -> usize {
        self.rules.len()
    }

    /// Flips a leaf and settles everything above it.
    pub fn flip(&self, state: &mut NetworkState, leaf: u32) {
        let inside = &mut state.leaves[leaf as usize];
        *inside = !*inside;
        let inside = *inside;
        match &self.layout {
            Layout::Counters => self.climb(state, leaf, inside),
            Layout::Ordered => self.settle(state, leaf, inside),
            Layout::Heavy(paths) => paths.flip(self, state, leaf),
        }
    }

    fn users_of(&self, node: u32) -> &[u32] {
        &self.users[self.first_user[node as usize] as usize..self.first_user[node as usize + 1] as usize]
    }

    /// Passes a node's new value on to the outputs that it feeds.
    fn feed(&self, winner: &mut Winner, node: u32, inside: bool) {
        if self.feeds[node as usize] {
            let first = self.fed.partition_point(|&(fed, ..)| fed < node);
            for &(_, output, complemented) in self.fed[first..].iter().take_while(|&&(fed, ..)| fed == node) {
                winner.set(output, inside ^ complemented);
            }
        }
    }

    /// Counts one operand of a gate in or out; `Some(value)` if that changes the gate.
    fn count(&self, counts: &mut [u32], gate: u32, operand_inside: bool) -> Option<bool> {
        let index = (gate - self.leaf_count) as usize;
        let (rule, before) = (self.rules[index], counts[index]);
        let after = if operand_inside { before + 1 } else { before - 1 };
        counts[index] = after;
        let value = rule.holds(after);
        (value != rule.holds(before)).then_some(value)
    }

    /// Every node has at most one user: follow the change upwards.
    fn climb(&self, state: &mut NetworkState, mut node: u32, mut inside: bool) {
        loop {
            self.feed(&mut state.winner, node, inside);
            let &[user] = self.users_of(node) else { return };
            match self.count(&mut state.counts, user >> 1, inside ^ (user & 1 == 1)) {
                Some(value) => (node, inside) = (user >> 1, value),
                None => return,
            }
        }
    }

    /// Some node has several users: settle gates in topological order. A gate waits until all its operands
    /// are final, so it changes at most once however the paths to it differ in length.
    fn settle(&self, state: &mut NetworkState, leaf: u32, inside: bool) {
        self.feed(&mut state.winner, leaf, inside);
        self.pass_on(state, leaf, inside);
        while let Some(Reverse(gate)) = state.waiting.pop() {
            while state.waiting.peek() == Some(&Reverse(gate)) {
                state.waiting.pop();
            }
            let index = (gate - self.leaf_count) as usize;
            let value = self.rules[index].holds(state.counts[index]);
            if state.heavy.changed(index, value) {
                self.feed(&mut state.winner, gate, value);
                self.pass_on(state, gate, value);
            }
        }
    }

    fn pass_on(&self, state: &mut NetworkState, node: u32, inside: bool) {
        for &user in self.users_of(node) {
            self.count(&mut state.counts, user >> 1, inside ^ (user & 1 == 1));
            state.waiting.push(Reverse(user >> 1));
        }
    }
}

/// Lays a network out.
struct Builder<'e> {
    expression: &'e Expression,
    outputs: &'e [Edge],
    leaf_count: u32,
    /// Number in the network of each node of the expression, where it is reached from an output.
    number: Vec<Option<u32>>,
    gates: Vec<usize>,
}

impl<'e> Builder<'e> {
    fn new(expression: &'e Expression, outputs: &'e [Edge], leaf_count: usize) -> Self {
        let mut reached = vec![false; expression.nodes().len()];
        outputs.iter().for_each(|edge| reached[edge.node().index()] = true);
        for (node, gate) in expression.nodes().iter().enumerate().rev() {
            if let (true, Gate::Join(_, operands)) = (reached[node], gate) {
                operands.iter().for_each(|edge| reached[edge.node().index()] = true);
            }
        }
        let mut builder = Builder {
            expression,
            outputs,
            leaf_count: leaf_count as u32,
            number: Vec::new(),
            gates: Vec::new(),
        };
        for (node, gate) in expression.nodes().iter().enumerate() {
            let number = match gate {
                Gate::Leaf(leaf) => Some(leaf.0),
                Gate::Join(..) if reached[node] => {
                    builder.gates.push(node);
                    Some((leaf_count + builder.gates.len() - 1) as u32)
                }
                _ => None,
            };
            builder.number.push(number);
        }
        builder
    }

    fn operands(&self, gate: usize) -> (Rule, &'e [Edge]) {
        match &self.expression.nodes()[self.gates[gate]] {
            Gate::Join(rule, operands) => (*rule, operands),
            _ => (Rule::AtLeast(1), &[]),
        }
    }

    fn number_of(&self, edge: Edge) -> u32 {
        self.number[edge.node().index()].unwrap_or(u32::MAX)
    }

    /// The user lists of all nodes, in compressed rows.
    fn users(&self) -> (Vec<u32>, Vec<u32>) {
        let nodes = self.leaf_count as usize + self.gates.len();
        let mut first = vec![0u32; nodes + 1];
        for gate in 0..self.gates.len() {
            for &edge in self.operands(gate).1 {
                first[self.number_of(edge) as usize + 1] += 1;
            }
        }
        for k in 0..nodes {
            first[k + 1] += first[k];
        }
        let (mut next, mut users) = (first.clone(), vec![0; first[nodes] as usize]);
        for gate in 0..self.gates.len() {
            for &edge in self.operands(gate).1 {
                let slot = &mut next[self.number_of(edge) as usize];
                users[*slot as usize] =
                    (self.leaf_count + gate as u32) << 1 | u32::from(edge.is_complemented());
                *slot += 1;
            }
        }
        (first, users)
    }

    /// Values with every leaf outside: `(count of operands inside, value)` of each gate.
    fn counts(&self) -> (Vec<u32>, Vec<bool>) {
        let (mut counts, mut values) = (Vec::new(), vec![false; self.leaf_count as usize]);
        for gate in 0..self.gates.len() {
            let (rule, operands) = self.operands(gate);
            let inside = |edge: &&Edge| values[self.number_of(**edge) as usize] ^ edge.is_complemented();
            let count = operands.iter().filter(inside).count() as u32;
            counts.push(count);
            values.push(rule.holds(count));
        }
        (counts, values)
    }

    fn depth(&self) -> u32 {
        let mut depth = vec![0u32; self.leaf_count as usize];
        for gate in 0..self.gates.len() {
            let below = self.operands(gate).1.iter().map(|&edge| depth[self.number_of(edge) as usize]).max();
            depth.push(below.unwrap_or(0) + 1);
        }
        depth.into_iter().max().unwrap_or(0)
    }

    fn finish(self) -> Network {
        let (first_user, users) = self.users();
        let (counts, values) = self.counts();
        let rules: Vec<Rule> = (0..self.gates.len()).map(|gate| self.operands(gate).0).collect();
        let mut winner = Winner::new(self.outputs.len());
        let mut fed = Vec::new();
        for (k, &edge) in self.outputs.iter().enumerate() {
            let output = k as u32;
            match self.number[edge.node().index()] {
                Some(node) => {
                    winner.set(output, values[node as usize] ^ edge.is_complemented());
                    fed.push((node, output, edge.is_complemented()));
                }
                None => winner.set(output, edge == Edge::PLENUM),
            }
        }
        fed.sort_unstable();
        let mut feeds = vec![false; values.len()];
        fed.iter().for_each(|&(node, ..)| feeds[node as usize] = true);
        let is_tree = first_user.windows(2).all(|pair| pair[1] - pair[0] <= 1);
        let mut initial = NetworkState {
            leaves: vec![false; self.leaf_count as usize],
            counts,
            winner,
            ..NetworkState::default()
        };
        let depth = self.depth();
        let mut network = Network {
            rules,
            leaf_count: self.leaf_count,
            first_user,
            users,
            fed,
            feeds,
            layout: Layout::Counters,
            initial: NetworkState::default(),
        };
        if !is_tree {
            network.layout = Layout::Ordered;
            initial.heavy = heavy::HeavyState::gate_values(&values[self.leaf_count as usize..]);
        } else if depth > DEEP {
            let (paths, state) = HeavyPaths::new(&network, &mut initial.counts, &values);
            network.layout = Layout::Heavy(paths);
            initial.heavy = state;
        }
        network.initial = initial;
        network
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LeafId;
    use crate::simplify::{Formula, Op, share};

    /// A small deterministic stream of numbers for random networks.
    struct Stream(u64);

    impl Stream {
        fn below(&mut self, n: usize) -> usize {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((self.0 >> 33) as usize) % n
        }
    }

    /// A random expression over `leaves` leaves; `deep` makes chains, `shared` uses nodes several times.
    fn random(stream: &mut Stream, leaves: usize, deep: bool, shared: bool) -> (Expression, Vec<Edge>) {
        let mut formula = Formula::default();
        let mut pool: Vec<Edge> = (0..leaves).map(|k| formula.leaf(LeafId::from(k))).collect();
        while pool.len() > 3 {
            let arity = if deep { 2 } else { 2 + stream.below(3) };
            let operands: Vec<Edge> = (0..arity.min(pool.len()))
                .map(|k| {
                    let at = if deep && k == 0 { pool.len() - 1 } else { stream.below(pool.len()) };
                    let edge = if shared && stream.below(4) == 0 { pool[at] } else { pool.swap_remove(at) };
                    if stream.below(3) == 0 { edge.complement() } else { edge }
                })
                .collect();
            let op = [Op::Union, Op::Intersection, Op::SymmetricDifference][stream.below(3)];
            pool.push(formula.join(op, &operands));
        }
        pool.into_iter().for_each(|edge| formula.ask(edge));
        let formula = share(&formula);
        (Expression::new(&formula), formula.outputs().to_vec())
    }

    fn check(seed: u64, leaves: usize, deep: bool, shared: bool) {
        let mut stream = Stream(seed);
        let (expression, outputs) = random(&mut stream, leaves, deep, shared);
        let network = Network::new(&expression, &outputs, leaves);
        let mut state = network.start();
        let (mut inside, mut values) = (vec![false; leaves], Vec::new());
        for _ in 0..60 {
            let leaf = stream.below(leaves);
            inside[leaf] = !inside[leaf];
            network.flip(&mut state, leaf as u32);
            expression.evaluate(|l| inside[l.index()], &mut values);
            let mut last = 0;
            for (k, edge) in outputs.iter().enumerate() {
                let value = values[edge.node().index()] ^ edge.is_complemented();
                assert_eq!(state.output(k as u32), value, "seed {seed}");
                last = if value { k as u32 + 1 } else { last };
            }
            assert_eq!(state.winner(), last);
        }
    }

    #[test]
    fn every_layout_agrees_with_plain_evaluation() {
        for seed in 0..150 {
            check(seed, 3 + seed as usize % 20, false, false);
            check(seed, 3 + seed as usize % 20, false, true);
            check(seed, 100 + seed as usize, true, false);
            check(seed, 100 + seed as usize, true, true);
        }
    }

    #[test]
    fn deep_chains_use_heavy_paths() {
        let (expression, outputs) = random(&mut Stream(7), 300, true, false);
        let network = Network::new(&expression, &outputs, 300);
        assert!(matches!(network.layout, Layout::Heavy(_)));
    }
}
