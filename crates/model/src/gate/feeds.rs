//! The outputs that each node of a network feeds.

use super::BitSet;

/// The outputs of each node, found in constant time: the number of a node among those with outputs is the number of marked nodes
/// before it.
#[derive(Clone, Debug)]
pub(super) struct Feeds {
    feeds: BitSet,
    /// The number of marked nodes before each word of the set.
    before: Vec<u32>,
    /// The first output of each marked node, and the number of outputs.
    first: Vec<u32>,
    /// The outputs, and whether they take the complement, in the order of nodes.
    outputs: Vec<(u32, bool)>,
}

impl Feeds {
    /// The outputs that nodes feed, as (node, output, complemented).
    pub fn new(nodes: usize, mut fed: Vec<(u32, u32, bool)>) -> Feeds {
        fed.sort_unstable();
        let feeds = BitSet::new(nodes, fed.iter().map(|&(node, ..)| node));
        let before = feeds.0.iter().scan(0, |count, word| {
            let before = *count;
            *count += word.count_ones();
            Some(before)
        });
        let before = before.collect();
        let is_first = |k: usize| k == 0 || fed[k - 1].0 != fed[k].0;
        let starts = (0..fed.len()).filter(|&k| is_first(k)).map(|k| k as u32);
        let first = starts.chain([fed.len() as u32]).collect();
        let outputs = fed.into_iter().map(|(_, output, complemented)| (output, complemented)).collect();
        Feeds { feeds, before, first, outputs }
    }

    /// True if a node feeds an output.
    #[inline]
    pub fn any(&self, node: u32) -> bool {
        self.feeds.get(node)
    }

    /// The outputs of a node that feeds any.
    #[inline]
    pub fn of(&self, node: u32) -> &[(u32, bool)] {
        let word = node as usize / 64;
        let below = self.feeds.0[word] & ((1 << (node % 64)) - 1);
        let k = (self.before[word] + below.count_ones()) as usize;
        &self.outputs[self.first[k] as usize..self.first[k + 1] as usize]
    }

    /// Size in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.feeds.0[..])
            + size_of_val(&self.before[..])
            + size_of_val(&self.first[..])
            + size_of_val(&self.outputs[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same outputs as by a search of all, for nodes with none, one and several, at the ends of words too.
    #[test]
    fn outputs_of_nodes_are_those_of_a_full_search() {
        let nodes = [0, 63, 64, 65, 127, 128, 199];
        let fed: Vec<(u32, u32, bool)> =
            (0..20).map(|output| (nodes[output as usize * 3 % 7], output, output % 3 == 0)).collect();
        let feeds = Feeds::new(200, fed.clone());
        for node in 0..200 {
            let own: Vec<(u32, bool)> =
                fed.iter().filter(|fed| fed.0 == node).map(|&(_, output, by)| (output, by)).collect();
            assert_eq!(feeds.any(node), !own.is_empty());
            assert!(own.is_empty() || feeds.of(node) == own, "{node}");
        }
    }
}
