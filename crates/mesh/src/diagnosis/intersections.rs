//! Triangles that go through each other.

use super::Findings;
use crate::Mesh;
use crate::hierarchy::Hierarchy;
use crate::topology::is_collapsed;
use crate::triangle::{self, Meeting, Triangle};
use rayweave_math::Vec3;

/// Two triangles that have more in common than corners and edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// The two, the smaller number first.
    pub triangles: [u32; 2],
    /// A place near to what they have in common: the middle of what their boxes share.
    pub at: Vec3,
}

/// Pairs that go through each other, and pairs that lie in each other; sorted.
pub(super) fn intersections(mesh: &Mesh) -> (Findings<Intersection>, Findings<Intersection>) {
    let (hierarchy, order) = Hierarchy::new(mesh);
    let (mut crossings, mut overlaps) = (Findings::default(), Findings::default());
    let mut others: Vec<u32> = Vec::new();
    for number in 0..mesh.triangles().len() as u32 {
        others.clear();
        let bounds = triangle::bounds(mesh.corners(number as usize));
        hierarchy.within(&bounds, |range| {
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

/// How two triangles meet. Those with the same corners are duplicates, and none of these.
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

/// The corners of a triangle, those that are common first.
fn common_first(mesh: &Mesh, corners: [u32; 3], common: &[u32]) -> Triangle {
    let mut corners = corners;
    corners.sort_by_key(|vertex| common.iter().position(|other| other == vertex).unwrap_or(3));
    corners.map(|vertex| mesh.vertices()[vertex as usize])
}
