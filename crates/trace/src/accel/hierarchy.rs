//! A binary tree of boxes, split by the surface area heuristic in bins (Wald, "On fast construction of
//! SAH-based bounding volume hierarchies", 2007).

use super::Probe;
use rayweave_math::{Bounds, Vec3};

/// Boxes in a tree; nodes stand in the order of a walk, each with the place to go on where it is missed.
#[derive(Clone, Debug, Default)]
pub(super) struct Hierarchy {
    nodes: Vec<Node>,
    leaves: Vec<(Bounds, u32)>,
}

#[derive(Clone, Debug)]
struct Node {
    bounds: Bounds,
    /// The node after everything below this one.
    next: u32,
    /// The leaves of this node: none for inner nodes.
    leaves: std::ops::Range<u32>,
}

/// Up to this many boxes are tested one by one: a node more costs as much as two boxes.
const FEW: usize = 4;
const BINS: usize = 16;

impl Hierarchy {
    pub fn new(mut leaves: Vec<(Bounds, u32)>) -> Hierarchy {
        let mut nodes: Vec<Node> = Vec::new();
        let mut waiting = vec![(0..leaves.len(), false)];
        let mut open: Vec<usize> = Vec::new();
        while let Some((range, closes)) = waiting.pop() {
            if closes {
                if let Some(node) = open.pop() {
                    nodes[node].next = nodes.len() as u32;
                }
                continue;
            }
            if range.is_empty() {
                continue;
            }
            let bounds = around(&leaves[range.clone()]);
            let here = nodes.len();
            nodes.push(Node { bounds, next: here as u32 + 1, leaves: 0..0 });
            match split(&mut leaves[range.clone()]) {
                None => nodes[here].leaves = range.start as u32..range.end as u32,
                Some(at) => {
                    open.push(here);
                    waiting.push((0..0, true));
                    waiting.push((range.start + at..range.end, false));
                    waiting.push((range.start..range.start + at, false));
                }
            }
        }
        Hierarchy { nodes, leaves }
    }

    pub fn touched(&self, probe: &Probe, out: &mut Vec<u32>) {
        self.walk(|bounds| probe.hits(bounds), out);
    }

    pub fn around(&self, point: Vec3, margin: f64, out: &mut Vec<u32>) {
        self.walk(|bounds| bounds.grown(margin).contains(point), out);
    }

    fn walk(&self, hits: impl Fn(&Bounds) -> bool, out: &mut Vec<u32>) {
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            if !hits(&node.bounds) {
                at = node.next as usize;
                continue;
            }
            let leaves = &self.leaves[node.leaves.start as usize..node.leaves.end as usize];
            out.extend(leaves.iter().filter(|(bounds, _)| hits(bounds)).map(|(_, leaf)| leaf));
            at += 1;
        }
    }
}

fn around(leaves: &[(Bounds, u32)]) -> Bounds {
    leaves.iter().fold(Bounds::EMPTY, |all, (bounds, _)| all.union(bounds))
}

fn area(bounds: &Bounds) -> f64 {
    let size = bounds.size();
    if bounds.is_empty() { 0.0 } else { size.x * size.y + size.y * size.z + size.z * size.x }
}

/// Reorders the boxes and says where to part them; `None` for few, or where no plane parts their centres.
fn split(leaves: &mut [(Bounds, u32)]) -> Option<usize> {
    if leaves.len() <= FEW {
        return None;
    }
    let centres = leaves
        .iter()
        .fold(Bounds::EMPTY, |all, (b, _)| all.union(&Bounds { lo: b.centre(), hi: b.centre() }));
    let size = centres.size();
    let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    if size[axis] == 0.0 || !size[axis].is_finite() {
        // all in one place: halves, so that the tree stays shallow
        return Some(leaves.len() / 2);
    }
    let bin = |b: &Bounds| {
        (((b.centre()[axis] - centres.lo[axis]) / size[axis] * BINS as f64) as usize).min(BINS - 1)
    };
    let border = best_border(leaves, bin)?;
    // stable, so that the tree does not depend on how a sort breaks ties
    leaves.sort_by_key(|(b, _)| bin(b) >= border);
    Some(leaves.partition_point(|(b, _)| bin(b) < border))
}

/// The bin border with the least expected cost.
fn best_border(leaves: &[(Bounds, u32)], bin: impl Fn(&Bounds) -> usize) -> Option<usize> {
    let mut bins = [(Bounds::EMPTY, 0usize); BINS];
    for (bounds, _) in leaves {
        let slot = &mut bins[bin(bounds)];
        *slot = (slot.0.union(bounds), slot.1 + 1);
    }
    let cost = |border: usize| {
        let side = |bins: &[(Bounds, usize)]| {
            let (bounds, count) = bins
                .iter()
                .fold((Bounds::EMPTY, 0), |(all, n), (bounds, count)| (all.union(bounds), n + count));
            (area(&bounds) * count as f64, count)
        };
        let (left, right) = (side(&bins[..border]), side(&bins[border..]));
        (left.1 > 0 && right.1 > 0).then_some(left.0 + right.0)
    };
    let costs = (1..BINS).filter_map(|border| cost(border).map(|c| (border, c)));
    costs.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(border, _)| border)
}
