//! Cycles of a directed graph.

use std::collections::{BTreeMap, BTreeSet};

/// The strongly connected components that contain a cycle, each sorted.
pub fn cycles<'a>(edges: &BTreeMap<&'a str, BTreeSet<&'a str>>) -> Vec<Vec<&'a str>> {
    let reach: BTreeMap<&str, BTreeSet<&str>> =
        edges.keys().map(|&node| (node, reachable(edges, node))).collect();
    let mut found = BTreeSet::new();
    for (node, ahead) in &reach {
        let back = |other: &&&str| reach.get(**other).is_some_and(|ahead| ahead.contains(node));
        if ahead.contains(node) {
            found.insert(ahead.iter().filter(back).copied().collect());
        }
    }
    found.into_iter().collect()
}

/// The nodes that are reachable from a node.
fn reachable<'a>(edges: &BTreeMap<&'a str, BTreeSet<&'a str>>, from: &'a str) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut open = vec![from];
    while let Some(node) = open.pop() {
        let next = edges.get(node).into_iter().flatten();
        open.extend(next.filter(|other| found.insert(**other)));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_found() {
        let edges = [
            ("a", vec!["b"]),
            ("b", vec!["c", "d"]),
            ("c", vec!["a"]),
            ("d", vec!["e"]),
            ("f", vec!["f", "a"]),
        ];
        let edges = edges.into_iter().map(|(node, next)| (node, next.into_iter().collect())).collect();
        assert_eq!(cycles(&edges), [vec!["a", "b", "c"], vec!["f"]]);
        assert!(cycles(&BTreeMap::new()).is_empty());
    }
}
