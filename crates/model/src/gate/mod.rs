//! Boolean networks with incremental update: the values of the outputs after each change of a leaf.
//!
//! A [`Network`] is the expression of a group, laid out for a sweep along a ray: a leaf changes, and the change
//! propagates upwards as long as values change. Three layouts give the same results:
//! - counters, for trees: each gate counts the operands that are inside. A change costs at most the depth.
//! - ordered counters, if a node has several users: gates are updated in topological order, each once.
//! - heavy paths, for deep trees: a change costs O(log^2 n) at any depth (see `heavy`).

mod feeds;
mod heavy;
mod output_set;

use crate::{Edge, Expression, Rule};
use feeds::Feeds;
use heavy::HeavyPaths;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

pub use output_set::OutputSet;

/// The mean number of gates above a leaf from which on trees use heavy paths, and the largest number. A change by counters costs a few
/// nanoseconds per gate, and ends at the first one whose value stays the same; one by heavy paths costs some hundred. So one long
/// chain does not slow down the changes of many short ones beside it.
const DEEP: u64 = 64;
const DEEPEST: u64 = 1024;

/// The number of other gates whose updates take as long as the changes that a parity gate passes on: it passes on every change, of each
/// of its operands, and most other gates few. Measured: a volume of a star of 10,000 corners, whose cells have parity gates, takes 2.4
/// to 2.8 times as long for each leaf that a ray reaches as one of a union of 5,000 balls.
const PARITY: u64 = 20;

/// A boolean network over the leaves of a group, with one or more outputs.
#[derive(Clone, Debug)]
pub struct Network {
    /// One rule per gate, operands before users. Nodes are numbered leaves first, then gates.
    rules: Vec<Rule>,
    leaf_count: u32,
    users: Users,
    feeds: Feeds,
    layout: Layout,
    /// The state in which every leaf is outside, without the leaf values.
    initial: NetworkState,
}

/// The users of each node; bit 0 is set if the user takes the complement.
#[derive(Clone, Debug)]
enum Users {
    /// At most one user per node; [`NO_USER`] if there is none.
    One(Vec<u32>),
    /// The users of node k: `users[first[k]..first[k + 1]]`.
    Many { first: Vec<u32>, users: Vec<u32> },
}

/// Marks a node without user: greater than twice the number of any gate.
const NO_USER: u32 = u32::MAX;

impl Users {
    #[inline]
    fn of(&self, node: u32) -> &[u32] {
        match self {
            Users::One(users) => match &users[node as usize] {
                &NO_USER => &[],
                user => std::slice::from_ref(user),
            },
            Users::Many { first, users } => {
                &users[first[node as usize] as usize..first[node as usize + 1] as usize]
            }
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Users::One(users) => size_of_val(&users[..]),
            Users::Many { first, users } => size_of_val(&first[..]) + size_of_val(&users[..]),
        }
    }
}

/// A set of small integers.
#[derive(Clone, Debug)]
struct BitSet(Vec<u64>);

impl BitSet {
    fn new(size: usize, members: impl Iterator<Item = u32>) -> BitSet {
        let mut words = vec![0; size.div_ceil(64)];
        members.for_each(|k| words[k as usize / 64] |= 1 << (k % 64));
        BitSet(words)
    }

    #[inline]
    fn get(&self, k: u32) -> bool {
        self.0[k as usize / 64] >> (k % 64) & 1 == 1
    }
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
    output_set: OutputSet,
    heavy: heavy::HeavyPathsState,
    waiting: BinaryHeap<Reverse<u32>>,
}

impl NetworkState {
    /// The number of the last output that is inside, counted from 1; 0 if none is.
    pub fn owner(&self) -> u32 {
        self.output_set.last()
    }

    /// True if output number `k`, counted from 0, is inside.
    pub fn output(&self, k: u32) -> bool {
        self.output_set.get(k)
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.leaves[..])
            + size_of_val(&self.counts[..])
            + self.output_set.bytes()
            + self.heavy.bytes()
    }

    /// True if a leaf is inside.
    pub fn leaf(&self, leaf: u32) -> bool {
        self.leaves[leaf as usize]
    }
}

impl Network {
    /// Lays out an expression for its outputs.
    pub fn new(expression: &Expression) -> Network {
        Builder::new(expression).finish()
    }

    /// The state in which every leaf is outside.
    pub fn start(&self) -> NetworkState {
        NetworkState { leaves: vec![false; self.leaf_count as usize], ..self.initial.clone() }
    }

    /// The number of gates.
    pub fn gate_count(&self) -> usize {
        self.rules.len()
    }

    /// The mean number of gates above a leaf, which a change of it may update; of several users of a node, the first counts. A parity
    /// gate counts as 20 gates, since it passes on every change.
    ///
    /// Computed on each call, in time linear in the size of the network.
    pub fn mean_depth(&self) -> f64 {
        let weight = |gate: usize| if self.rules[gate] == Rule::Odd { PARITY } else { 1 };
        let leaves = gates_above(&self.users, self.leaf_count as usize, self.rules.len(), weight);
        leaves.iter().sum::<u64>() as f64 / (leaves.len() as f64).max(1.0)
    }

    /// Inverts the side of a leaf and updates every node above it.
    pub fn toggle(&self, state: &mut NetworkState, leaf: u32) {
        let inside = &mut state.leaves[leaf as usize];
        *inside = !*inside;
        let inside = *inside;
        match &self.layout {
            Layout::Counters => self.climb(state, leaf, inside),
            Layout::Ordered => self.propagate(state, leaf, inside),
            Layout::Heavy(paths) => paths.toggle(self, state, leaf),
        }
    }

    /// Reads the memory that a change of a leaf will read; the result is meaningless. Calls for many leaves
    /// before their changes let the processor fetch all of it in parallel, if the network is too large for its
    /// caches.
    #[inline]
    pub fn read_ahead(&self, state: &NetworkState, leaf: u32) -> u32 {
        let user = self.users_of(leaf).first().copied().unwrap_or(0);
        user ^ u32::from(state.leaves[leaf as usize]) ^ u32::from(self.feeds.any(leaf))
    }

    /// Size in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let heavy = if let Layout::Heavy(paths) = &self.layout { paths.bytes() } else { 0 };
        size_of_val(&self.rules[..]) + self.feeds.bytes() + self.users.bytes() + self.initial.bytes() + heavy
    }

    #[inline]
    fn users_of(&self, node: u32) -> &[u32] {
        self.users.of(node)
    }

    /// Writes a node's new value to the outputs that it feeds.
    #[inline]
    fn feed(&self, output_set: &mut OutputSet, node: u32, inside: bool) {
        if self.feeds.any(node) {
            for &(output, complemented) in self.feeds.of(node) {
                output_set.set(output, inside ^ complemented);
            }
        }
    }

    /// Increments or decrements the count of a gate; `Some(value)` if that changes the value of the gate.
    #[inline]
    fn count(&self, counts: &mut [u32], gate: u32, operand_inside: bool) -> Option<bool> {
        let index = (gate - self.leaf_count) as usize;
        let (rule, before) = (self.rules[index], counts[index]);
        let after = if operand_inside { before + 1 } else { before - 1 };
        counts[index] = after;
        let value = rule.holds(after);
        (value != rule.holds(before)).then_some(value)
    }

    /// Propagates a change upwards in a tree, where every node has at most one user.
    #[inline]
    fn climb(&self, state: &mut NetworkState, mut node: u32, mut inside: bool) {
        loop {
            self.feed(&mut state.output_set, node, inside);
            let &[user] = self.users_of(node) else { return };
            match self.count(&mut state.counts, user >> 1, inside ^ (user & 1 == 1)) {
                Some(value) => (node, inside) = (user >> 1, value),
                None => return,
            }
        }
    }

    /// Propagates a change in topological order, for networks in which some node has several users. A gate
    /// waits until all its operands are final, so it changes at most once, whatever the lengths of the paths
    /// to it.
    fn propagate(&self, state: &mut NetworkState, leaf: u32, inside: bool) {
        self.feed(&mut state.output_set, leaf, inside);
        self.pass_on(state, leaf, inside);
        while let Some(Reverse(gate)) = state.waiting.pop() {
            while state.waiting.peek() == Some(&Reverse(gate)) {
                state.waiting.pop();
            }
            let index = (gate - self.leaf_count) as usize;
            let value = self.rules[index].holds(state.counts[index]);
            if state.heavy.changed(index, value) {
                self.feed(&mut state.output_set, gate, value);
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

/// The number of gates above each leaf, by the first user of each node, each gate with its weight.
fn gates_above(
    users: &Users,
    leaf_count: usize,
    gate_count: usize,
    weight: impl Fn(usize) -> u64,
) -> Vec<u64> {
    let mut above = vec![0u64; leaf_count + gate_count];
    // users have higher numbers
    for node in (0..above.len()).rev() {
        let user = users.of(node as u32).first().map(|user| (user >> 1) as usize);
        above[node] = user.map_or(0, |user| above[user] + weight(user - leaf_count));
    }
    above.truncate(leaf_count);
    above
}

/// Builds a network. Its nodes are the leaves and the joins of the expression that are reachable from an
/// output.
struct Builder<'e> {
    outputs: &'e [Edge],
    leaf_count: u32,
    /// The number in the network of each join of the expression; [`NO_NODE`] if it is unreachable.
    number: Vec<u32>,
    gates: Vec<(Rule, &'e [Edge])>,
}

/// Marks a constant or an unreachable join, which have no node in the network.
const NO_NODE: u32 = u32::MAX;

impl<'e> Builder<'e> {
    fn new(expression: &'e Expression) -> Self {
        let first_join = expression.leaf_count() + 2;
        let mut number = vec![NO_NODE; expression.joins().len()];
        let mark_reachable = |edges: &[Edge], number: &mut Vec<u32>| {
            let joins = edges.iter().filter_map(|edge| edge.node().index().checked_sub(first_join));
            joins.for_each(|join| number[join] = 0);
        };
        mark_reachable(expression.outputs(), &mut number);
        for (join, (_, operands)) in expression.joins().enumerate().rev() {
            if number[join] != NO_NODE {
                mark_reachable(operands, &mut number);
            }
        }
        let mut gates = Vec::new();
        for (join, number) in expression.joins().zip(&mut number).filter(|(_, number)| **number != NO_NODE) {
            *number = (expression.leaf_count() + gates.len()) as u32;
            gates.push(join);
        }
        Builder { outputs: expression.outputs(), leaf_count: expression.leaf_count() as u32, number, gates }
    }

    fn operands(&self, gate: usize) -> (Rule, &'e [Edge]) {
        self.gates[gate]
    }

    /// The number of a node in the network; [`NO_NODE`] for a constant.
    fn number_of(&self, edge: Edge) -> u32 {
        match edge.node().0.checked_sub(2) {
            None => NO_NODE,
            Some(leaf) if leaf < self.leaf_count => leaf,
            Some(other) => self.number[(other - self.leaf_count) as usize],
        }
    }

    fn uses(&self) -> impl Iterator<Item = (u32, u32)> {
        let user = |gate: usize, edge: Edge| {
            (self.leaf_count + gate as u32) << 1 | u32::from(edge.is_complemented())
        };
        let of = move |(gate, (_, operands)): (usize, &(Rule, &'e [Edge]))| {
            operands.iter().map(move |&edge| (self.number_of(edge), user(gate, edge)))
        };
        self.gates.iter().enumerate().flat_map(of)
    }

    fn users(&self) -> Users {
        let nodes = self.leaf_count as usize + self.gates.len();
        let mut one = vec![NO_USER; nodes];
        let is_first = |(node, user): (u32, u32)| std::mem::replace(&mut one[node as usize], user) == NO_USER;
        if self.uses().all(is_first) { Users::One(one) } else { self.many_users(nodes) }
    }

    /// The user lists of all nodes, in compressed sparse row form.
    fn many_users(&self, nodes: usize) -> Users {
        let mut first = vec![0u32; nodes + 1];
        self.uses().for_each(|(node, _)| first[node as usize + 1] += 1);
        for k in 0..nodes {
            first[k + 1] += first[k];
        }
        let (mut next, mut users) = (first.clone(), vec![0; first[nodes] as usize]);
        for (node, user) in self.uses() {
            let slot = &mut next[node as usize];
            users[*slot as usize] = user;
            *slot += 1;
        }
        Users::Many { first, users }
    }

    /// The number of operands inside for each gate, and the value of each node, with every leaf outside.
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

    /// True if a tree has so many gates above its leaves that heavy paths are faster than counters.
    fn is_deep(&self, users: &Users) -> bool {
        let leaves = gates_above(users, self.leaf_count as usize, self.gates.len(), |_| 1);
        let all: u64 = leaves.iter().sum();
        all > DEEP * leaves.len() as u64 || leaves.iter().any(|&count| count > DEEPEST)
    }

    fn finish(self) -> Network {
        let users = self.users();
        let (counts, values) = self.counts();
        let rules: Vec<Rule> = self.gates.iter().map(|gate| gate.0).collect();
        let mut output_set = OutputSet::new(self.outputs.len());
        let mut fed = Vec::new();
        for (k, &edge) in self.outputs.iter().enumerate() {
            let output = k as u32;
            match self.number_of(edge) {
                NO_NODE => output_set.set(output, edge == Edge::UNIVERSE),
                node => {
                    output_set.set(output, values[node as usize] ^ edge.is_complemented());
                    fed.push((node, output, edge.is_complemented()));
                }
            }
        }
        let feeds = Feeds::new(values.len(), fed);
        let is_tree = matches!(users, Users::One(_));
        let is_deep = is_tree && self.is_deep(&users);
        let mut initial = NetworkState { counts, output_set, ..NetworkState::default() };
        let mut network = Network {
            rules,
            leaf_count: self.leaf_count,
            users,
            feeds,
            layout: Layout::Counters,
            initial: NetworkState::default(),
        };
        if !is_tree {
            network.layout = Layout::Ordered;
            initial.heavy = heavy::HeavyPathsState::gate_values(&values[self.leaf_count as usize..]);
        } else if is_deep {
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

    /// A deterministic stream of random numbers.
    struct Stream(u64);

    impl Stream {
        fn below(&mut self, n: usize) -> usize {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((self.0 >> 33) as usize) % n
        }
    }

    /// A random expression over `leaves` leaves; `deep` makes chains, `shared` uses nodes several times.
    fn random(stream: &mut Stream, leaves: usize, deep: bool, shared: bool) -> Expression {
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
        pool.into_iter().for_each(|edge| formula.add_output(edge));
        Expression::new(&share(&formula), leaves)
    }

    fn check(seed: u64, leaves: usize, deep: bool, shared: bool) {
        let mut stream = Stream(seed);
        let expression = random(&mut stream, leaves, deep, shared);
        let network = Network::new(&expression);
        let mut state = network.start();
        let (mut inside, mut values) = (vec![false; leaves], Vec::new());
        for _ in 0..60 {
            let leaf = stream.below(leaves);
            inside[leaf] = !inside[leaf];
            network.toggle(&mut state, leaf as u32);
            expression.evaluate(|l| inside[l.index()], &mut values);
            let mut last = 0;
            for (k, edge) in expression.outputs().iter().enumerate() {
                let value = values[edge.node().index()] ^ edge.is_complemented();
                assert_eq!(state.output(k as u32), value, "seed {seed}");
                last = if value { k as u32 + 1 } else { last };
            }
            assert_eq!(state.owner(), last);
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
        let network = Network::new(&random(&mut Stream(7), 300, true, false));
        assert!(matches!(network.layout, Layout::Heavy(_)));
        assert!(matches!(chain_beside_pairs(DEEPEST as usize + 2, 100_000).layout, Layout::Heavy(_)));
    }

    /// A chain of alternating operators, and a union of that and many intersections of two leaves.
    fn chain_beside_pairs(length: usize, pairs: usize) -> Network {
        let mut formula = Formula::default();
        let mut all = vec![formula.leaf(LeafId(0))];
        for k in 1..length {
            let leaf = formula.leaf(LeafId::from(k));
            all[0] = formula.join([Op::Union, Op::Intersection][k % 2], &[all[0], leaf]);
        }
        for k in 0..pairs {
            let both = [0, 1].map(|j| formula.leaf(LeafId::from(length + 2 * k + j)));
            all.push(formula.join(Op::Intersection, &both));
        }
        let whole = formula.join(Op::Union, &all);
        formula.add_output(whole);
        Network::new(&Expression::new(&share(&formula), length + 2 * pairs))
    }

    /// As in an outline by cells, of which one has many edges.
    #[test]
    fn one_long_chain_beside_many_short_ones_uses_counters() {
        assert!(matches!(chain_beside_pairs(200, 10_000).layout, Layout::Counters));
        assert!(matches!(chain_beside_pairs(200, 10).layout, Layout::Heavy(_)));
    }
}
