//! Mesh topology: half-edges grouped by edge, and union-find with parity.

use crate::Mesh;

/// A half-edge: one side of an edge, owned by one triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct HalfEdge {
    /// The end vertices of the edge, the smaller index first.
    pub ends: [u32; 2],
    pub triangle: u32,
    /// True if the triangle traverses the edge from `ends[0]` to `ends[1]`.
    pub forward: bool,
}

/// The half-edges of all triangles with three different corners, sorted by edge, then by triangle.
pub(crate) fn half_edges(mesh: &Mesh) -> Vec<HalfEdge> {
    let mut found = Vec::with_capacity(3 * mesh.triangles().len());
    for (triangle, &corners) in mesh.triangles().iter().enumerate() {
        if !is_degenerate(corners) {
            found.extend((0..3).map(|k| half_edge(corners[k], corners[(k + 1) % 3], triangle as u32)));
        }
    }
    found.sort_unstable();
    found
}

fn half_edge(from: u32, to: u32, triangle: u32) -> HalfEdge {
    HalfEdge { ends: [from.min(to), from.max(to)], triangle, forward: from < to }
}

/// Groups sorted half-edges by edge.
pub(crate) fn by_edge(half_edges: &[HalfEdge]) -> impl Iterator<Item = &[HalfEdge]> {
    half_edges.chunk_by(|a, b| a.ends == b.ends)
}

/// True if two corners coincide. Removing such a triangle does not open a closed mesh.
pub(crate) fn is_degenerate([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// Disjoint sets of items (union-find) with a parity for each item relative to its set.
#[derive(Debug)]
pub(crate) struct ParityUnionFind {
    parent: Vec<u32>,
    flipped: Vec<bool>,
}

impl ParityUnionFind {
    /// Singleton sets.
    pub fn new(count: usize) -> ParityUnionFind {
        ParityUnionFind { parent: (0..count as u32).collect(), flipped: vec![false; count] }
    }

    /// The representative (smallest member) of the set of `item`, and the parity of `item` relative to it: true if
    /// they differ.
    pub fn find(&mut self, item: u32) -> (u32, bool) {
        let (mut root, mut flipped) = (item, false);
        while self.parent[root as usize] != root {
            flipped ^= self.flipped[root as usize];
            root = self.parent[root as usize];
        }
        self.compress(item, root, flipped);
        (root, flipped)
    }

    /// Path compression.
    fn compress(&mut self, mut item: u32, root: u32, mut flipped: bool) {
        while item != root {
            let (next, step) = (self.parent[item as usize], self.flipped[item as usize]);
            (self.parent[item as usize], self.flipped[item as usize]) = (root, flipped);
            (item, flipped) = (next, flipped ^ step);
        }
    }

    /// Merges the sets of `a` and `b` with the given relative parity; false if it contradicts earlier ones.
    pub fn union(&mut self, a: u32, b: u32, differ: bool) -> bool {
        let ((a, a_flipped), (b, b_flipped)) = (self.find(a), self.find(b));
        let flipped = a_flipped ^ b_flipped ^ differ;
        if a == b {
            return !flipped;
        }
        let (first, last) = (a.min(b), a.max(b));
        self.parent[last as usize] = first;
        self.flipped[last as usize] = flipped;
        true
    }
}
