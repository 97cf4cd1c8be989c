//! The parts of a tree that are known to be constant from here on.

use std::collections::BTreeMap;

/// Disjoint ranges of the post-order, keyed by their first node.
#[derive(Clone, Debug, Default)]
pub(super) struct Resolved(BTreeMap<usize, usize>);

impl Resolved {
    pub fn contains(&self, node: usize) -> bool {
        self.0.range(..=node).next_back().is_some_and(|(_, &end)| node < end)
    }

    /// Adds a sub-tree, which contains or is disjoint from each known one.
    pub fn add(&mut self, begin: usize, end: usize) {
        while let Some((&inner, _)) = self.0.range(begin..end).next() {
            self.0.remove(&inner);
        }
        self.0.insert(begin, end);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sub_trees_swallow_theirs() {
        let mut resolved = Resolved::default();
        resolved.add(2, 3);
        resolved.add(7, 9);
        resolved.add(0, 5);
        let inside: Vec<usize> = (0..12).filter(|&node| resolved.contains(node)).collect();
        assert_eq!(inside, [0, 1, 2, 3, 4, 7, 8]);
        assert_eq!(resolved.0.len(), 2);
    }
}
