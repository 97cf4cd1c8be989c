//! Self-intersections of a mesh: pairs of triangles that cross or overlap.

use super::Findings;
use crate::Mesh;
use crate::topology::is_degenerate;
use crate::tree::TriangleTree;
use crate::triangle::{self, Meeting, Triangle};
use rayweave_math::Vec3;
use rustc_hash::FxHashSet;

/// A pair of triangles that have more in common than corners and edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// The indices of the triangles, the smaller one first.
    pub triangles: [u32; 2],
    /// A point near the intersection: the centre of the intersection of their boxes.
    pub at: Vec3,
}

/// The number of pairs of triangles that the diagnoses of one file may compare, so that meshes of many triangles close together do
/// not take quadratic time.
#[derive(Clone, Copy, Debug)]
pub struct PairBudget {
    left: usize,
}

impl PairBudget {
    /// Pairs for every file. Of these, half are compared (each two triangles once), in up to two microseconds each.
    const BASE: usize = 2_000_000;
    /// Further pairs for each triangle. In meshes of real parts the boxes of about ten others overlap that of a triangle.
    const PER_TRIANGLE: usize = 64;

    /// A budget of this many pairs; each mesh adds 64 for each of its triangles.
    pub fn of(pairs: usize) -> PairBudget {
        PairBudget { left: pairs }
    }
}

impl Default for PairBudget {
    /// The budget of a file that is yet to be diagnosed.
    fn default() -> PairBudget {
        PairBudget::of(Self::BASE)
    }
}

/// The intersecting pairs of triangles.
#[derive(Default)]
pub(crate) struct Intersections {
    /// The pairs that cross, sorted.
    pub crossings: Findings<Intersection>,
    /// The coplanar pairs that overlap, sorted.
    pub overlaps: Findings<Intersection>,
    /// The pairs that touch beyond common corners and edges, sorted.
    pub contacts: Findings<Intersection>,
    /// The first triangle whose pairs were not compared, because too many boxes overlap.
    pub end: Option<u32>,
    /// The components that cross or overlap another one.
    pub mixed: FxHashSet<u32>,
}

/// The intersections of all triangles except duplicates (`is_duplicate`, by number), which the first triangle with the same
/// corners represents. `component_of` is the component of each triangle.
pub(crate) fn intersections(
    mesh: &Mesh,
    component_of: &[u32],
    is_duplicate: impl Fn(u32) -> bool,
    budget: &mut PairBudget,
) -> Intersections {
    let (tree, order) = TriangleTree::new(mesh);
    let mut found = Intersections::default();
    let count = mesh.triangles().len();
    budget.left += PairBudget::PER_TRIANGLE * count;
    let left = &mut budget.left;
    let mut others: Vec<u32> = Vec::new();
    let is_compared =
        |number: u32| !is_duplicate(number) && !is_degenerate(mesh.triangles()[number as usize]);
    for number in (0..count as u32).filter(|&number| is_compared(number)) {
        others.clear();
        let bounds = triangle::bounds(mesh.corners(number as usize));
        let mut seen = 0;
        tree.within(&bounds, |range| {
            seen += range.len();
            if seen <= *left {
                others.extend(order[range].iter().filter(|&&other| other > number && is_compared(other)));
            }
        });
        if seen > *left {
            found.end = Some(number);
            *left = 0;
            break;
        }
        *left -= seen;
        others.sort_unstable();
        for &other in &others {
            let meeting = meeting_of(mesh, number, other);
            let shells = [number, other].map(|number| component_of[number as usize]);
            if shells[0] != shells[1] && meeting != Meeting::Touching {
                found.mixed.extend(shells);
            }
            match meeting {
                Meeting::Touching if is_in_contact(mesh, number, other) => {
                    found.contacts.add(intersection(mesh, [number, other]));
                }
                Meeting::Touching => {}
                Meeting::Crossing => found.crossings.add(intersection(mesh, [number, other])),
                Meeting::Overlapping => found.overlaps.add(intersection(mesh, [number, other])),
            }
        }
    }
    found
}

fn intersection(mesh: &Mesh, triangles: [u32; 2]) -> Intersection {
    let [a, b] = triangles.map(|number| triangle::bounds(mesh.corners(number as usize)));
    Intersection { triangles, at: a.intersection(&b).centre() }
}

/// Classifies the intersection of two triangles with three different corners each. Triangles with the same corners are
/// duplicates, which count as touching.
fn meeting_of(mesh: &Mesh, first: u32, second: u32) -> Meeting {
    let [a, b] = [first, second].map(|number| mesh.corners(number as usize));
    if triangle::bounds(a).intersection(&triangle::bounds(b)).is_empty() {
        return Meeting::Touching;
    }
    let [p, q] = [first, second].map(|number| mesh.triangles()[number as usize]);
    let common: Vec<u32> = p.into_iter().filter(|vertex| q.contains(vertex)).collect();
    match common.len() {
        3 => Meeting::Touching,
        shared => triangle::meeting(common_first(mesh, p, &common), common_first(mesh, q, &common), shared),
    }
}

/// True if two triangles that neither cross nor overlap touch beyond their common corners and edges.
fn is_in_contact(mesh: &Mesh, first: u32, second: u32) -> bool {
    let [p, q] = [first, second].map(|number| mesh.triangles()[number as usize]);
    let common: Vec<u32> = p.into_iter().filter(|vertex| q.contains(vertex)).collect();
    let [a, b] = [p, q].map(|corners| common_first(mesh, corners, &common));
    common.len() < 3 && triangle::is_in_contact(a, b, common.len())
}

/// The corners of a triangle, the common ones first.
fn common_first(mesh: &Mesh, corners: [u32; 3], common: &[u32]) -> Triangle {
    let mut corners = corners;
    corners.sort_by_key(|vertex| common.iter().position(|other| other == vertex).unwrap_or(3));
    corners.map(|vertex| mesh.vertices()[vertex as usize])
}
