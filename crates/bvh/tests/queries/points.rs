//! Queries by points and boxes against brute force.

use crate::common::{around, lists, scattered, vector};
use rand::{SeedableRng, rngs::ChaCha8Rng};
use rayweave_bvh::{Bvh, ExactBvh};
use rayweave_math::{Bounds, Vec3};
use std::ops::ControlFlow;

fn distance_squared(bounds: &Bounds, point: Vec3) -> f64 {
    (point - point.clamp(bounds.lo, bounds.hi)).length_squared()
}

/// Points in, on and near boxes, and far away.
fn points(seed: u64, boxes: &[Bounds]) -> Vec<Vec3> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let all = if boxes.is_empty() { Bounds::centred(Vec3::ZERO, Vec3::ONE) } else { around(boxes) };
    let size = all.size().max_element();
    let mut points: Vec<Vec3> = boxes
        .iter()
        .step_by(5)
        .flat_map(|bounds| [bounds.lo, bounds.hi, bounds.corners()[2], bounds.centre()])
        .collect();
    points.extend((0..20).map(|k| all.centre() + [0.5, 3.0, 1e6][k % 3] * size * vector(&mut rng)));
    points
}

#[test]
fn every_box_that_meets_another_is_found() {
    let meets = |a: &Bounds, b: &Bounds| a.lo.cmple(b.hi).all() && b.lo.cmple(a.hi).all();
    for (seed, boxes) in lists().into_iter().enumerate() {
        let tree = Bvh::of_items(&boxes, 1);
        let (clusters, order) = Bvh::<4>::of_clusters(&boxes);
        for point in points(seed as u64, &boxes) {
            for half in [0.0, 0.1 * tree.size()] {
                let query = Bounds { lo: point - Vec3::splat(half), hi: point + Vec3::splat(half) };
                let (mut found, mut of_clusters) = (Vec::new(), Vec::new());
                tree.overlapping(&query, 0.0, |item| found.push(item.start));
                clusters.overlapping(&query, 0.0, |places| of_clusters.extend_from_slice(&order[places]));
                for (k, bounds) in boxes.iter().enumerate().filter(|(_, bounds)| meets(bounds, &query)) {
                    assert!(found.contains(&k), "list {seed}: {bounds:?} meets {query:?}");
                    assert!(of_clusters.contains(&(k as u32)));
                }
                let near =
                    query.grown(1e-5 * tree.size() + 1e-12 * (point.length() + around(&boxes).lo.length()));
                assert!(found.iter().all(|&k| meets(&boxes[k], &near)), "list {seed}: {query:?}");
            }
        }
    }
}

#[test]
fn the_nearest_box_is_that_of_brute_force() {
    for (seed, boxes) in lists().into_iter().enumerate() {
        let (tree, order) = Bvh::<4>::of_clusters(&boxes);
        for point in points(seed as u64, &boxes) {
            let distances: Vec<f64> = boxes.iter().map(|bounds| distance_squared(bounds, point)).collect();
            let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
            for limit in [f64::INFINITY, least.next_up(), least] {
                let mut visits = 0;
                let mut best = limit;
                tree.nearest(point, 0.0, limit, |places, within| {
                    assert_eq!(within, best);
                    visits += places.len();
                    best = order[places].iter().map(|&k| distances[k as usize]).fold(within, f64::min);
                    best
                });
                assert_eq!(best, least.min(limit), "list {seed}: {point:?}");
                assert!(visits <= boxes.len());
            }
        }
    }
}

#[test]
fn few_boxes_are_visited_for_the_nearest() {
    let boxes = scattered(8, 2000, 0.02, Vec3::ZERO);
    let (tree, order) = Bvh::<4>::of_clusters(&boxes);
    let (mut visits, points) = (0, points(1, &boxes));
    for &point in &points {
        tree.nearest(point, 0.0, f64::INFINITY, |places, within| {
            visits += places.len();
            order[places].iter().map(|&k| distance_squared(&boxes[k as usize], point)).fold(within, f64::min)
        });
    }
    assert!(visits < 40 * points.len(), "{visits} for {} points", points.len());
}

#[test]
fn boxes_around_a_point_are_visited_in_the_order_of_the_list() {
    for (seed, mut boxes) in lists().into_iter().enumerate() {
        boxes.extend([Bounds::EMPTY, Bounds { lo: Vec3::splat(0.5), hi: Vec3::INFINITY }, Bounds::ALL]);
        boxes.rotate_left(seed % 7);
        let finite: Vec<Bounds> = boxes.iter().copied().filter(Bounds::is_finite).collect();
        let tree = ExactBvh::listed(&boxes);
        let (shuffled, order) = ExactBvh::sorted(&boxes);
        for point in points(seed as u64, &finite) {
            let visited = |tree: &ExactBvh| {
                let mut found = Vec::new();
                let flow = tree.visit(
                    |bounds| bounds.contains(point),
                    |k| {
                        found.push(k);
                        ControlFlow::Continue(())
                    },
                );
                assert_eq!(flow, ControlFlow::Continue(()));
                found
            };
            let expected: Vec<usize> = (0..boxes.len()).filter(|&k| boxes[k].contains(point)).collect();
            assert_eq!(visited(&tree), expected, "list {seed}");
            let mut found: Vec<usize> = visited(&shuffled).iter().map(|&k| order[k] as usize).collect();
            found.sort_unstable();
            assert_eq!(found, expected, "list {seed}");
        }
    }
}

#[test]
fn a_visit_ends_where_the_visitor_breaks() {
    let tree = ExactBvh::listed(&scattered(1, 100, 0.5, Vec3::ZERO));
    let mut count = 0;
    let flow = tree.visit(
        |_| true,
        |k| {
            count += 1;
            if k == 41 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
    );
    assert_eq!((flow, count), (ControlFlow::Break(()), 42));
}
