//! Self-intersections of a mesh: pairs of triangles that cross or overlap.

use super::Findings;
use crate::Mesh;
use crate::topology::is_collapsed;
use crate::tree::TriangleTree;
use crate::triangle::{self, Meeting, Triangle};
use rayweave_math::Vec3;

/// A pair of triangles that have more in common than corners and edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// The indices of the triangles, the smaller one first.
    pub triangles: [u32; 2],
    /// A point near the intersection: the centre of the intersection of their boxes.
    pub at: Vec3,
}

/// The pairs that cross, and the coplanar pairs that overlap; both sorted.
pub(super) fn intersections(mesh: &Mesh) -> (Findings<Intersection>, Findings<Intersection>) {
    let (tree, order) = TriangleTree::new(mesh);
    let (mut crossings, mut overlaps) = (Findings::default(), Findings::default());
    let mut others: Vec<u32> = Vec::new();
    for number in 0..mesh.triangles().len() as u32 {
        others.clear();
        let bounds = triangle::bounds(mesh.corners(number as usize));
        tree.within(&bounds, |range| {
            others.extend(order[range].iter().filter(|&&other| other > number));
        });
        others.sort_unstable();
        for &other in &others {
            match meeting_of(mesh, number, other) {
                Meeting::Touching => {}
                Meeting::Crossing => crossings.add(intersection(mesh, [number, other])),
                Meeting::Overlapping => overlaps.add(intersection(mesh, [number, other])),
            }
        }
    }
    (crossings, overlaps)
}

fn intersection(mesh: &Mesh, triangles: [u32; 2]) -> Intersection {
    let [a, b] = triangles.map(|number| triangle::bounds(mesh.corners(number as usize)));
    Intersection { triangles, at: a.intersection(&b).centre() }
}

/// Classifies the intersection of two triangles. Triangles with the same corners are duplicates, which count
/// as touching.
fn meeting_of(mesh: &Mesh, first: u32, second: u32) -> Meeting {
    let [a, b] = [first, second].map(|number| mesh.corners(number as usize));
    if triangle::bounds(a).intersection(&triangle::bounds(b)).is_empty() {
        return Meeting::Touching;
    }
    let [p, q] = [first, second].map(|number| mesh.triangles()[number as usize]);
    if is_collapsed(p) || is_collapsed(q) {
        return Meeting::Touching;
    }
    let common: Vec<u32> = p.into_iter().filter(|vertex| q.contains(vertex)).collect();
    match common.len() {
        3 => Meeting::Touching,
        shared => triangle::meeting(common_first(mesh, p, &common), common_first(mesh, q, &common), shared),
    }
}

/// The corners of a triangle, the common ones first.
fn common_first(mesh: &Mesh, corners: [u32; 3], common: &[u32]) -> Triangle {
    let mut corners = corners;
    corners.sort_by_key(|vertex| common.iter().position(|other| other == vertex).unwrap_or(3));
    corners.map(|vertex| mesh.vertices()[vertex as usize])
}
