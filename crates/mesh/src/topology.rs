//! Mesh topology: half-edges grouped by edge, and union-find with parity.

use crate::Mesh;

/// A half-edge: one of the triangles at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct EdgeUse {
    /// The end vertices of the edge, the smaller index first.
    pub ends: [u32; 2],
    pub triangle: u32,
    /// True if the triangle runs from the first end to the second.
    pub forward: bool,
}

/// The half-edges of all triangles with three different corners, sorted by edge, then by triangle.
pub(crate) fn edge_uses(mesh: &Mesh) -> Vec<EdgeUse> {
    let mut uses = Vec::with_capacity(3 * mesh.triangles().len());
    for (triangle, &corners) in mesh.triangles().iter().enumerate() {
        if !is_collapsed(corners) {
            uses.extend((0..3).map(|k| edge_use(corners[k], corners[(k + 1) % 3], triangle as u32)));
        }
    }
    uses.sort_unstable();
    uses
}

fn edge_use(from: u32, to: u32, triangle: u32) -> EdgeUse {
    EdgeUse { ends: [from.min(to), from.max(to)], triangle, forward: from < to }
}

/// The half-edges, grouped by edge.
pub(crate) fn by_edge(uses: &[EdgeUse]) -> impl Iterator<Item = &[EdgeUse]> {
    uses.chunk_by(|a, b| a.ends == b.ends)
}

/// True if two corners coincide. Removing such a triangle does not open a closed mesh.
pub(crate) fn is_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// Disjoint sets of items (union-find) with a parity for each item relative to its set.
#[derive(Debug)]
pub(crate) struct SignedSets {
    parent: Vec<u32>,
    flipped: Vec<bool>,
}

impl SignedSets {
    /// Singleton sets.
    pub fn new(count: usize) -> SignedSets {
        SignedSets { parent: (0..count as u32).collect(), flipped: vec![false; count] }
    }

    /// The first member of the set of `item`, and whether their parities differ.
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

    /// Joins the sets of two items whose parities differ or not; false if this contradicts the known parities.
    pub fn join(&mut self, a: u32, b: u32, differ: bool) -> bool {
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
