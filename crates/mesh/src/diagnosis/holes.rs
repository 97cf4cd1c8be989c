//! Holes: closed loops of boundary edges, which belong to one triangle only.

use crate::Mesh;
use crate::topology::{HalfEdge, by_edge};
use rayweave_math::Vec3;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// A hole: a closed loop of edges that belong to one triangle only.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// The number of edges.
    pub edges: usize,
    /// The total length of the edges.
    pub length: f64,
    /// The mean of the corners.
    pub centre: Vec3,
}

impl Hole {
    pub(super) fn new(mesh: &Mesh, corners: Vec<u32>) -> Hole {
        let points: Vec<Vec3> = corners.iter().map(|&vertex| mesh.vertices()[vertex as usize]).collect();
        let count = points.len();
        let length = (0..count).map(|k| (points[(k + 1) % count] - points[k]).length()).sum();
        Hole { edges: count, length, centre: points.iter().sum::<Vec3>() / count as f64 }
    }
}

/// The boundary loops of all holes, with corners in the order that orients a cap consistently with the mesh.
///
/// Loops that touch in a vertex are separated arbitrarily. Chains that do not close, where neighbouring triangles have
/// inconsistent orientations, are left out.
pub(crate) fn boundary_loops(mesh: &Mesh, half_edges: &[HalfEdge]) -> Vec<Vec<u32>> {
    debug_assert!(half_edges.len() <= 3 * mesh.triangles().len());
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for edge in by_edge(half_edges).filter(|edge| edge.len() == 1) {
        let [a, b] = edge[0].ends;
        // a cap runs along the edge in the direction opposite to the triangle's
        let (from, to) = if edge[0].forward { (b, a) } else { (a, b) };
        next.entry(from).or_default().push(to);
    }
    let mut loops = Vec::new();
    while let Some((&start, _)) = next.first_key_value() {
        follow(start, &mut next, &mut loops);
    }
    loops
}

/// Follows edges from a start and removes them. Where a vertex repeats, the path since its first visit is a loop, and the walk
/// continues from the rest of the path. It ends if no path is left, or if the path has no next edge.
fn follow(start: u32, next: &mut BTreeMap<u32, Vec<u32>>, loops: &mut Vec<Vec<u32>>) {
    let mut path = vec![start];
    let mut positions: FxHashMap<u32, usize> = FxHashMap::from_iter([(start, 0)]);
    while let Some(to) = path.last().and_then(|&last| take(last, next)) {
        match positions.get(&to) {
            Some(&position) => {
                let found = path.split_off(position);
                found.iter().for_each(|vertex| _ = positions.remove(vertex));
                loops.push(found);
                // the loop's first vertex is also the end of the path before it
                if path.is_empty() {
                    return;
                }
                positions.insert(to, path.len());
                path.push(to);
            }
            None => {
                positions.insert(to, path.len());
                path.push(to);
            }
        }
    }
}

/// Removes and returns the end of an edge from a vertex.
fn take(from: u32, next: &mut BTreeMap<u32, Vec<u32>>) -> Option<u32> {
    let ends = next.get_mut(&from)?;
    let to = ends.pop();
    if ends.is_empty() {
        next.remove(&from);
    }
    to
}
