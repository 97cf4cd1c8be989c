//! Closed ways along edges that have one triangle.

use crate::Mesh;
use crate::topology::{EdgeUse, by_edge};
use rayweave_math::Vec3;
use std::collections::BTreeMap;

/// A closed way along edges that have one triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// The number of edges.
    pub edges: usize,
    /// The length of all edges.
    pub length: f64,
    /// The mean of its corners.
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

/// The rims of all holes, each as the corners in the order in which a lid turns.
///
/// Where rims touch in a vertex they are told apart in some way. What is no closed way, at a rim whose triangles do not turn
/// alike, is left out.
pub(crate) fn holes(mesh: &Mesh, uses: &[EdgeUse]) -> Vec<Vec<u32>> {
    debug_assert!(uses.len() <= 3 * mesh.triangles().len());
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for edge in by_edge(uses).filter(|edge| edge.len() == 1) {
        let [a, b] = edge[0].ends;
        // a lid turns against the triangle at the rim
        let (from, to) = if edge[0].forward { (b, a) } else { (a, b) };
        next.entry(from).or_default().push(to);
    }
    let mut rims = Vec::new();
    while let Some((&start, _)) = next.first_key_value() {
        rims.extend(follow(start, &mut next));
    }
    rims
}

/// Takes edges from a start on until a vertex is met again, which closes a rim; what led there is given back.
fn follow(start: u32, next: &mut BTreeMap<u32, Vec<u32>>) -> Option<Vec<u32>> {
    let mut way = vec![start];
    let mut places = BTreeMap::from([(start, 0)]);
    loop {
        let last = *way.last()?;
        let to = take(last, next)?;
        if let Some(&place) = places.get(&to) {
            for pair in way[..=place].windows(2) {
                next.entry(pair[0]).or_default().push(pair[1]);
            }
            return Some(way.split_off(place));
        }
        places.insert(to, way.len());
        way.push(to);
    }
}

fn take(from: u32, next: &mut BTreeMap<u32, Vec<u32>>) -> Option<u32> {
    let ends = next.get_mut(&from)?;
    let to = ends.pop();
    if ends.is_empty() {
        next.remove(&from);
    }
    to
}
