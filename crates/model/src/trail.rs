//! The names around the leaves of a group, from which occurrence paths are computed on demand.
//!
//! A trail is a tree of names in compact form: leaves under the same name share one record, and the copies
//! of a placed solid share one, whatever their number.

use crate::copies::CopyLabel;
use crate::name_map::NameMap;
use std::sync::Arc;

/// The parent of a node at the top of its group.
pub(crate) const TOP: u32 = u32::MAX;

/// The names around the leaves and the copies of a group.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trail {
    nodes: Vec<TrailNode>,
    /// Consecutive shapes with one name under one node, by their number in the group.
    leaves: Vec<LeafRun>,
    /// The names of the copies, one record for each run of instances.
    pub copies: Vec<CopyNames>,
    /// The node of the name of the whole group. Copies repeat that name, unless they have one of their own.
    pub own: Option<u32>,
}

/// A name around leaves, or around the only copy of a solid that has a name as a copy.
#[derive(Clone, Debug)]
pub(crate) struct TrailNode {
    pub parent: u32,
    pub name: Arc<str>,
    pub copy: Option<i64>,
    /// The number of nodes before this one that have equal names in the same place.
    pub ordinal: u32,
    pub is_placed: bool,
}

/// The origin of the last step of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Naming {
    /// The kind of shape.
    Kind,
    /// The name of the leaf.
    Name,
    /// None: the node is the leaf.
    Node,
}

/// Consecutive leaves with equal names.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafRun {
    first: u32,
    pub node: u32,
    pub naming: Naming,
    /// The number of leaves before the first one that have equal names in the same place.
    ordinal: u32,
}

/// The names of the copies of a placed solid.
#[derive(Clone, Debug)]
pub(crate) struct CopyNames {
    pub node: u32,
    pub name: Arc<str>,
    /// True if the name is not that of the placed solid.
    pub is_labelled: bool,
    /// The number of the first copy, where copies are counted.
    first: i64,
    numbers: Option<Arc<[i64]>>,
    /// For each copy the number of copies before it with the same number; `None` if all numbers differ.
    ordinals: Option<Box<[u32]>>,
}

impl CopyNames {
    /// The number of a copy, and the number of copies before it with the same number.
    pub fn number(&self, k: usize) -> (i64, u32) {
        let given = self.numbers.as_ref().and_then(|numbers| numbers.get(k));
        let ordinal = self.ordinals.as_ref().map_or(0, |ordinals| ordinals[k]);
        (given.copied().unwrap_or(self.first + k as i64), ordinal)
    }
}

impl Trail {
    /// The record of a shape by its number in the group, and the number of leaves before it with equal names.
    pub fn leaf(&self, number: u32) -> (LeafRun, u32) {
        let end = self.leaves.partition_point(|run| run.first <= number);
        let run = self.leaves[end.saturating_sub(1)];
        (run, run.ordinal + (number - run.first))
    }

    /// The nodes from one up to the top of the group.
    pub fn above(&self, node: u32) -> impl Iterator<Item = (u32, &TrailNode)> {
        let get = |node: u32| self.nodes.get(node as usize).map(|found| (node, found));
        std::iter::successors(get(node), move |(_, found)| get(found.parent))
    }

    /// Size in bytes; names are shared with solids.
    pub fn bytes(&self) -> usize {
        let numbers =
            |names: &CopyNames| names.ordinals.as_ref().map_or(0, |ordinals| size_of_val(&**ordinals));
        size_of_val(&self.nodes[..])
            + size_of_val(&self.leaves[..])
            + size_of_val(&self.copies[..])
            + self.copies.iter().map(numbers).sum::<usize>()
    }
}

/// A labelled copy: the node above it, its name, its number, and the stated number of copies before it with the same number.
type LabelKey<'n> = (u32, &'n str, Option<i64>, Option<u32>);

/// Builds the trail of a group, part by part in the order of the leaves.
#[derive(Default)]
pub(crate) struct TrailBuilder<'n> {
    trail: Trail,
    /// Number of nodes with equal names, by parent, name and copy number.
    nodes: NameMap<(u32, &'n str, Option<i64>), u32>,
    /// Nodes of labelled copies: equal labels mean the same copy, e.g. in files in which each volume repeats the
    /// placements of its mother volumes.
    labelled: NameMap<LabelKey<'n>, u32>,
    /// Number of leaves with equal names, by node and name.
    leaves: NameMap<(u32, &'n str), u32>,
    /// Number of counted copies with equal names, by node and name.
    copies: NameMap<(u32, &'n str), i64>,
    /// The name of the leaves of the last run, and the number after it.
    last: Option<(&'n str, u32)>,
}

impl<'n> TrailBuilder<'n> {
    /// Adds a node for a name of a solid: each occurrence of the name gets its own node.
    pub fn named(&mut self, parent: u32, name: &'n Arc<str>) -> u32 {
        self.node(parent, name, None, false)
    }

    /// The node of a single copy with a label.
    pub fn labelled(&mut self, parent: u32, label: &'n CopyLabel) -> u32 {
        let copy = label.number(0, 1);
        let key = (parent, &*label.name, copy, label.ordinal(0));
        if let Some(&known) = self.labelled.get(&key) {
            return known;
        }
        let node = self.node(parent, &label.name, copy, true);
        if let Some(ordinal) = label.ordinal(0) {
            self.trail.nodes[node as usize].ordinal = ordinal;
        }
        self.labelled.insert(key, node);
        node
    }

    fn node(&mut self, parent: u32, name: &'n Arc<str>, copy: Option<i64>, is_placed: bool) -> u32 {
        let ordinal = next(&mut self.nodes, (parent, &**name, copy), 1);
        self.trail.nodes.push(TrailNode { parent, name: name.clone(), copy, ordinal, is_placed });
        self.trail.nodes.len() as u32 - 1
    }

    /// Sets the node of the name of the whole group.
    pub fn own(&mut self, node: u32) {
        self.trail.own = Some(node);
    }

    /// Adds shape `number` of the group. `name` is the text that `naming` refers to.
    pub fn leaf(&mut self, number: u32, node: u32, naming: Naming, name: &'n str) {
        let last = self.trail.leaves.last().zip(self.last);
        let continues = last.is_some_and(|(run, (text, end))| {
            run.node == node && run.naming == naming && end == number && text == name
        });
        if !continues {
            self.finish_run();
            let ordinal = self.leaves.get(&(node, name)).copied().unwrap_or(0);
            self.trail.leaves.push(LeafRun { first: number, node, naming, ordinal });
        }
        self.last = Some((name, number + 1));
    }

    /// Counts the leaves of the last run.
    fn finish_run(&mut self) {
        if let Some((run, (name, end))) = self.trail.leaves.last().zip(self.last.take()) {
            next(&mut self.leaves, (run.node, name), end - run.first);
        }
    }

    /// Adds the copies of a placed solid, with a label or the name of the solid.
    pub fn copies(&mut self, node: u32, count: usize, label: Option<&'n CopyLabel>, name: &'n Arc<str>) {
        let names = match label {
            Some(CopyLabel { name, numbers, .. }) => CopyNames {
                node,
                name: name.clone(),
                is_labelled: true,
                first: 0,
                numbers: numbers.clone(),
                ordinals: numbers.as_ref().and_then(|_| ordinals(label?, count)),
            },
            None => CopyNames {
                node,
                name: name.clone(),
                is_labelled: false,
                first: next(&mut self.copies, (node, &**name), count as i64),
                numbers: None,
                ordinals: None,
            },
        };
        self.trail.copies.push(names);
    }

    pub fn finish(mut self) -> Trail {
        self.trail.nodes.shrink_to_fit();
        self.trail.leaves.shrink_to_fit();
        self.trail.copies.shrink_to_fit();
        self.trail
    }
}

/// The count of a key, which is then increased.
fn next<K: std::hash::Hash + Eq, N: Copy + Default + std::ops::AddAssign>(
    counts: &mut NameMap<K, N>,
    key: K,
    by: N,
) -> N {
    let count = counts.entry(key).or_default();
    let before = *count;
    *count += by;
    before
}

/// For each copy the number of copies before it with the same number; `None` if all numbers differ.
fn ordinals(label: &CopyLabel, count: usize) -> Option<Box<[u32]>> {
    let mut seen: NameMap<Option<i64>, u32> = NameMap::with_capacity_and_hasher(count, Default::default());
    let ordinals: Box<[u32]> = (0..count)
        .map(|k| {
            let counted = next(&mut seen, label.number(k, count), 1);
            label.ordinal(k).unwrap_or(counted)
        })
        .collect();
    ordinals.iter().any(|&ordinal| ordinal > 0).then_some(ordinals)
}
