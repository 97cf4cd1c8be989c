//! Nearest points of other sets: a k-d tree of points that belong to sets, of which some are joined later.

use rayweave_math::{Bounds, Vec3};

/// The number of points of a leaf of the tree.
const LEAF: usize = 16;

/// A tree whose nodes are ranges of points; a node with more than [`LEAF`] points is followed by its two children.
#[derive(Clone, Debug)]
pub(super) struct Nearest {
    points: Vec<(Vec3, u32)>,
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    first: u32,
    last: u32,
    /// The number of a point, if all points of the node were in its set when the tree was built.
    one: Option<u32>,
    /// The second child; the first one follows the node. 0 for leaves.
    second: u32,
}

impl Nearest {
    /// The tree of points with their numbers; `set` is the set of a number.
    pub fn new(mut points: Vec<(Vec3, u32)>, mut set: impl FnMut(u32) -> u32) -> Nearest {
        let mut nodes: Vec<Node> = Vec::new();
        // a range, and the node whose second child it is
        let mut waiting = vec![(0, points.len(), None)];
        while let Some((first, last, parent)) = waiting.pop() {
            let own = &mut points[first..last];
            let bounds =
                own.iter().fold(Bounds::EMPTY, |all, (point, _)| all.union(&Bounds::new(*point, *point)));
            let mut sets = own.iter().map(|(_, number)| set(*number));
            let is_one = sets.next().is_some_and(|one| sets.all(|other| other == one));
            let one = own.first().filter(|_| is_one).map(|(_, number)| *number);
            let number = nodes.len();
            nodes.push(Node { bounds, first: first as u32, last: last as u32, one, second: 0 });
            if let Some(parent) = parent {
                let parent: &mut Node = &mut nodes[parent];
                parent.second = number as u32;
            }
            if own.len() <= LEAF {
                continue;
            }
            let size = bounds.size();
            let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
            let half = own.len() / 2;
            own.select_nth_unstable_by(half, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
            waiting.push((first + half, last, Some(number)));
            waiting.push((first, first + half, None));
        }
        Nearest { points, nodes }
    }

    /// The `most` nearest points to a place that are not in a set, the nearest first and of equal ones that with the smaller number.
    /// `set` returns the present set of a point: sets may have been joined since the tree was built.
    pub fn outside(&self, at: Vec3, own: u32, most: usize, mut set: impl FnMut(u32) -> u32) -> Vec<u32> {
        let mut found: Vec<(f64, u32)> = Vec::with_capacity(most + 1);
        let mut waiting = vec![(0.0, 0)];
        while let Some((least, number)) = waiting.pop() {
            let node = &self.nodes[number];
            let is_full = |found: &[(f64, u32)]| found.len() == most;
            if is_full(&found) && least > found[most - 1].0 || node.one.is_some_and(|one| set(one) == own) {
                continue;
            }
            if node.second == 0 {
                for &(point, number) in &self.points[node.first as usize..node.last as usize] {
                    let new = ((point - at).length(), number);
                    let place = found
                        .partition_point(|known| known.0 < new.0 || known.0 == new.0 && known.1 < number);
                    if place < most && set(number) != own {
                        found.insert(place, new);
                        found.truncate(most);
                    }
                }
                continue;
            }
            let mut children = [number + 1, node.second as usize].map(|child| (self.least(child, at), child));
            // the nearer one is searched first
            children.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
            waiting.extend(children);
        }
        found.into_iter().map(|(_, number)| number).collect()
    }

    /// A lower bound of the distance of a place from the points of a node.
    fn least(&self, node: usize, at: Vec3) -> f64 {
        let Bounds { lo, hi } = self.nodes[node].bounds;
        // rounding of this distance and of those of points, which are compared with it
        (at - at.max(lo).min(hi)).length() * (1.0 - 1e-12)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same points as by a comparison of all, also of points with equal distances, and after sets are joined.
    #[test]
    fn nearest_points_are_those_of_a_full_search() {
        let mut state = 1u64;
        let mut random = |n: u64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) % n
        };
        let points: Vec<(Vec3, u32)> =
            (0..3000).map(|k| (Vec3::from_array([0; 3].map(|_| random(20) as f64)), k)).collect();
        // slabs along x, which are coherent, and a few points of any other set
        let set = |k: u32| if k.is_multiple_of(50) { k % 7 } else { (points[k as usize].0.x / 4.0) as u32 };
        let tree = Nearest::new(points.clone(), set);
        for joined in [false, true] {
            let now = |set: u32| if joined && set < 2 { 0 } else { set };
            for _ in 0..200 {
                let at = Vec3::from_array([0; 3].map(|_| random(200) as f64 / 10.0));
                let own = now(random(7) as u32);
                let mut all: Vec<(f64, u32)> = points
                    .iter()
                    .filter(|(_, k)| now(set(*k)) != own)
                    .map(|(point, k)| ((*point - at).length(), *k))
                    .collect();
                all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                let all: Vec<u32> = all.into_iter().take(12).map(|(_, k)| k).collect();
                assert_eq!(tree.outside(at, own, 12, |k| now(set(k))), all);
            }
        }
    }

    /// A set far from all others: its own points are skipped as whole nodes.
    #[test]
    fn points_of_the_same_set_are_skipped_by_nodes() {
        let points: Vec<(Vec3, u32)> =
            (0..100_000).map(|k| (Vec3::new(f64::from(k % 1000), f64::from(k / 1000), 0.0), k)).collect();
        let of = |k: u32| u32::from(k % 1000 >= 900);
        let tree = Nearest::new(points, of);
        let mut visited = 0;
        let found = tree.outside(Vec3::ZERO, 0, 12, |k| {
            visited += 1;
            of(k)
        });
        assert!(found.len() == 12 && visited < 600, "{visited}");
    }
}
