//! Connected components (shells) of a mesh: closedness, orientability, volume and nesting depth.

use super::Findings;
use crate::polyhedron::MAX_COMPARISONS;
use crate::topology::{HalfEdge, ParityUnionFind, by_edge};
use crate::triangle;
use crate::{Line, Mesh, Polyhedron};
use rayweave_math::Vec3;
use rustc_hash::FxHashSet;

/// A component: triangles connected by edges that belong to two of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Component {
    /// The index of its first triangle.
    pub first: u32,
    /// The number of triangles.
    pub triangles: usize,
    /// True if each of its edges has an even number of its triangles.
    pub is_closed: bool,
    /// False if it is one-sided, like a Möbius strip.
    pub is_orientable: bool,
    /// The signed volume with all triangles oriented like the majority: negative if these are clockwise seen from outside.
    pub volume: f64,
    /// The nesting depth: the number of closed shells around one of its points; 0 if the component or the mesh is not closed.
    pub depth: usize,
    /// True if its triangles cross or overlap those of another component: its points differ in their depths then.
    pub is_mixed: bool,
}

impl Component {
    /// True if it is closed, has a depth, and its orientation contradicts this depth. Triangles should be counter-clockwise seen
    /// from the outside of the solid.
    pub fn is_inside_out(&self) -> bool {
        self.is_closed
            && !self.is_mixed
            && self.volume != 0.0
            && (self.volume > 0.0) != self.depth.is_multiple_of(2)
    }
}

/// The component of each triangle, and its orientation relative to the majority of the component.
#[derive(Debug)]
pub(crate) struct Shells {
    /// The first triangle of each component, in increasing order.
    firsts: Vec<u32>,
    /// The component of each triangle.
    pub component_of: Vec<u32>,
    /// True for a triangle whose orientation differs from the majority of its component.
    pub is_flipped: Vec<bool>,
    one_sided: Vec<bool>,
}

impl Shells {
    pub fn new(mesh: &Mesh, half_edges: &[HalfEdge]) -> Shells {
        let count = mesh.triangles().len();
        let mut sets = ParityUnionFind::new(count);
        let mut contradictions = Vec::new();
        for edge in by_edge(half_edges).filter(|edge| edge.len() == 2) {
            // consistently oriented neighbours run along their edge in opposite directions
            if !sets.union(edge[0].triangle, edge[1].triangle, edge[0].forward == edge[1].forward) {
                contradictions.push(edge[0].triangle);
            }
        }
        let mut shells = Shells {
            firsts: Vec::new(),
            component_of: vec![0; count],
            is_flipped: vec![false; count],
            one_sided: Vec::new(),
        };
        for triangle in 0..count as u32 {
            let (root, flipped) = sets.find(triangle);
            shells.assign(triangle, root, flipped);
        }
        shells.one_sided = vec![false; shells.firsts.len()];
        contradictions
            .iter()
            .for_each(|&triangle| shells.one_sided[shells.component_of[triangle as usize] as usize] = true);
        shells.orient_by_majority();
        shells
    }

    /// Assigns a triangle to the component of its set's root, which is the first triangle of the set.
    fn assign(&mut self, triangle: u32, root: u32, flipped: bool) {
        if root == triangle {
            self.firsts.push(triangle);
        }
        let component =
            if root == triangle { self.firsts.len() as u32 - 1 } else { self.component_of[root as usize] };
        self.component_of[triangle as usize] = component;
        self.is_flipped[triangle as usize] = flipped;
    }

    /// Makes orientations relative to the majority of each component.
    fn orient_by_majority(&mut self) {
        let mut lead = vec![0i64; self.firsts.len()];
        for (triangle, &component) in self.component_of.iter().enumerate() {
            lead[component as usize] += if self.is_flipped[triangle] { -1 } else { 1 };
        }
        for (triangle, &component) in self.component_of.iter().enumerate() {
            self.is_flipped[triangle] ^= lead[component as usize] < 0;
        }
    }

    /// The number of components.
    pub fn count(&self) -> usize {
        self.firsts.len()
    }

    /// The largest triangle of each component.
    pub fn largest(&self, area: impl Fn(u32) -> f64) -> Vec<u32> {
        let mut largest = self.firsts.clone();
        for (triangle, &shell) in self.component_of.iter().enumerate() {
            let best = &mut largest[shell as usize];
            if area(triangle as u32) > area(*best) {
                *best = triangle as u32;
            }
        }
        largest
    }

    /// The triangles of each component.
    fn members(&self) -> Vec<Vec<usize>> {
        let mut members = vec![Vec::new(); self.firsts.len()];
        self.component_of
            .iter()
            .enumerate()
            .for_each(|(triangle, &shell)| members[shell as usize].push(triangle));
        members
    }

    pub fn flipped(&self) -> Findings<u32> {
        (0..self.component_of.len() as u32).filter(|&triangle| self.is_flipped[triangle as usize]).collect()
    }

    pub fn components(&self, mesh: &Mesh, half_edges: &[HalfEdge]) -> Vec<Component> {
        let oriented = mesh.clone().reversed(|triangle| self.is_flipped[triangle]);
        let (is_closed, middle) = (self.closed(half_edges), mesh.middle());
        let members = self.members();
        let depths = self.depths(mesh, &members, &is_closed);
        let component = |shell: usize| Component {
            first: self.firsts[shell],
            triangles: members[shell].len(),
            is_closed: is_closed[shell],
            is_orientable: !self.one_sided[shell],
            volume: oriented.volume_of(members[shell].iter().copied(), middle),
            depth: depths[shell],
            is_mixed: false,
        };
        (0..self.firsts.len()).map(component).collect()
    }

    /// For each component: true if it has an even number of triangles at each of its edges.
    fn closed(&self, half_edges: &[HalfEdge]) -> Vec<bool> {
        let mut closed = vec![true; self.firsts.len()];
        // triangles without three different corners have no edges: each is a component that is not closed
        let mut has_edges = vec![false; self.firsts.len()];
        for edge in by_edge(half_edges) {
            let mut shells: Vec<u32> =
                edge.iter().map(|edge| self.component_of[edge.triangle as usize]).collect();
            shells.sort_unstable();
            for same in shells.chunk_by(|a, b| a == b) {
                has_edges[same[0] as usize] = true;
                closed[same[0] as usize] &= same.len() % 2 == 0;
            }
        }
        closed.iter().zip(has_edges).map(|(&closed, has_edges)| closed && has_edges).collect()
    }

    /// The nesting depth of each component, by the crossings of a line through one of its triangles with the other components. When
    /// these lines have been compared with [`MAX_COMPARISONS`] triangles, those of earlier components decide for the ones that they crossed.
    fn depths(&self, mesh: &Mesh, members: &[Vec<usize>], is_closed: &[bool]) -> Vec<usize> {
        let mut depths = vec![0; members.len()];
        let Some(solid) = (members.len() > 1).then(|| Polyhedron::new(mesh).ok()).flatten() else {
            return depths;
        };
        let (mut left, mut found) = (MAX_COMPARISONS, Vec::new());
        let mut crossed: Vec<Option<usize>> = vec![None; members.len()];
        let mut odd: FxHashSet<u32> = FxHashSet::default();
        for shell in (0..members.len()).filter(|&shell| is_closed[shell]) {
            if let (0, Some(depth)) = (left, crossed[shell]) {
                depths[shell] = depth;
                continue;
            }
            let largest =
                members[shell].iter().copied().max_by(|&a, &b| area(mesh, a).total_cmp(&area(mesh, b)));
            let corners = mesh.corners(largest.unwrap_or(self.firsts[shell] as usize));
            let line = Line { origin: triangle::middle(corners), direction: GENERIC_DIRECTION };
            let ways = [GENERIC_DIRECTION, Vec3::X, Vec3::Y, Vec3::Z];
            left = left.saturating_sub(solid.crossings(&line, &ways, &mut found));
            odd.clear();
            // from the far end: the components that are crossed an odd number of times up to here are around this point
            for crossing in found.iter().rev().filter(|crossing| crossing.t > 0.0) {
                let other = self.component_of[crossing.triangle as usize];
                let around = odd.len() - usize::from(odd.contains(&other));
                crossed[other as usize].get_or_insert(around);
                if !odd.remove(&other) {
                    odd.insert(other);
                }
            }
            depths[shell] = odd.len() - usize::from(odd.contains(&(shell as u32)));
        }
        depths
    }
}

/// A direction that faces of man-made models are unlikely to contain.
const GENERIC_DIRECTION: Vec3 =
    Vec3::new(0.317_837_245_195_782_2, 0.754_877_666_246_692_7, 0.569_840_290_998_053_2);

fn area(mesh: &Mesh, triangle: usize) -> f64 {
    triangle::cross(mesh.corners(triangle)).length_squared()
}

/// Vertices whose triangles form more than one fan connected by edges.
pub(super) fn non_manifold_vertices(mesh: &Mesh, half_edges: &[HalfEdge]) -> impl Iterator<Item = u32> {
    let mut corners = ParityUnionFind::new(3 * mesh.triangles().len());
    for pair in half_edges.windows(2).filter(|pair| pair[0].ends == pair[1].ends) {
        for vertex in pair[0].ends {
            let [a, b] = [0, 1].map(|k| corner(mesh, pair[k].triangle, vertex));
            corners.union(a, b, false);
        }
    }
    let mut fans = vec![0u32; mesh.vertices().len()];
    // triangles without three different corners are in no fan
    let mut counted = vec![false; 3 * mesh.triangles().len()];
    for HalfEdge { ends, triangle, .. } in half_edges {
        for vertex in ends {
            let (fan, _) = corners.find(corner(mesh, *triangle, *vertex));
            if !std::mem::replace(&mut counted[fan as usize], true) {
                fans[*vertex as usize] += 1;
            }
        }
    }
    (0..fans.len() as u32).filter(move |&vertex| fans[vertex as usize] > 1)
}

/// The index of a corner: three per triangle.
fn corner(mesh: &Mesh, triangle: u32, vertex: u32) -> u32 {
    let place = mesh.triangles()[triangle as usize].iter().position(|&other| other == vertex);
    3 * triangle + place.unwrap_or(0) as u32
}
