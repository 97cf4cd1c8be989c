//! Streams of rays against an oracle in rational numbers, and the order of the items.

use crate::common::{Ray, around, lists, passes, rays};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8};
use rayweave_bvh::{RayStreams, WideBvh};
use rayweave_math::{Bounds, Vec3};

/// The items of each of up to eight rays, from front to back, up to a part of the end of its window; `None` for rays that start outside
/// of the box of the tree, and for those with too many items.
fn found(tree: &WideBvh, rays: &[Ray], part: f64) -> Vec<Option<Vec<u32>>> {
    dispatch!(Level::new(), simd => found_by(simd, tree, rays, part))
}

fn found_by<S: Simd>(simd: S, tree: &WideBvh, rays: &[Ray], part: f64) -> Vec<Option<Vec<u32>>> {
    let lanes = |of: &dyn Fn(&Ray) -> f64| {
        let last = rays.len() - 1;
        f64x8::load_array(simd, std::array::from_fn(|lane| of(&rays[lane.min(last)])))
    };
    let origin = [0, 1, 2].map(|k| lanes(&|ray| ray.origin[k]));
    let direction = [0, 1, 2].map(|k| lanes(&|ray| ray.direction[k]));
    let window = [0, 1].map(|k| lanes(&|ray| ray.window[k]));
    let prepared = tree.rays(simd, origin, direction, window);
    let known: Vec<_> = (0..rays.len()).filter_map(|k| Some((k, prepared.ray(k)?))).collect();
    let mut streams = RayStreams::default();
    // again, since the memory is used again
    for _ in 0..2 {
        let mut streaming: Vec<_> = known.iter().map(|(_, (ray, _))| *ray).collect();
        streams.find(simd, tree, &mut streaming);
    }
    let mut all = vec![None; rays.len()];
    for (number, (k, (_, pace))) in known.into_iter().enumerate() {
        let until = part * rays[k].window[1];
        let items = streams
            .of_ray(number)
            .map(|mut at| std::iter::from_fn(|| streams.next(&mut at, until, pace)).collect::<Vec<u32>>());
        all[k] = items;
    }
    all
}

/// Rays in a row of boxes find them from front to back, and leave those beyond a time; a ray along the whole row has too many.
#[test]
fn rays_in_a_stream_find_boxes_from_front_to_back() {
    let boxes: Vec<Bounds> =
        (0..300).map(|k| Bounds::centred(Vec3::new(f64::from(k), 0.0, 0.0), Vec3::splat(0.25))).collect();
    let tree = WideBvh::new(&boxes, &around(&boxes).grown(10.0), 1e-12);
    let ray = |x: f64, z: f64, direction: [f64; 3], until: f64| Ray {
        origin: Vec3::new(x, 0.0, z),
        direction: Vec3::from_array(direction),
        window: [0.0, until],
    };
    let (along, across) = ([2.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let row = [
        ray(-9.0, 0.0, along, 500.0),
        ray(100.5, 0.0, along, 3.0),
        ray(299.5, 0.0, along, 500.0),
        ray(3.0, -9.0, [0.5, 0.0, 1.0], 500.0),
        ray(3.0, -9.0, across, 500.0),
        ray(3.0, 9.0, across, 500.0),
        ray(280.5, 0.0, along, 500.0),
        ray(0.0, 1e4, across, 500.0),
    ];
    // the box of the fourth ray is at x = 3 + 4.5
    let expected = [
        None,
        Some((101..=106).collect()),
        Some(vec![]),
        Some(vec![]),
        Some(vec![3]),
        Some(vec![]),
        None,
        None,
    ];
    assert_eq!(found(&tree, &row, 1.0), expected);
    assert_eq!(found(&tree, &row, 0.5)[1], Some((101..=103).collect()));
    assert_eq!(found(&WideBvh::new(&[], &around(&boxes), 0.0), &row[1..2], 1.0), [Some(vec![])]);
}

/// No item on the way of a ray is missed, and those that are found are near.
#[test]
fn a_stream_visits_a_superset_of_the_exact_answers() {
    let (mut met, mut too_many) = (0, 0);
    for (seed, mut boxes) in lists().into_iter().enumerate() {
        boxes.retain(Bounds::is_finite);
        let all = around(&boxes);
        if boxes.is_empty() {
            continue;
        }
        boxes.push(Bounds::EMPTY);
        let size = all.size().max_element();
        let tree = WideBvh::new(&boxes, &all.grown(0.5 * size), 0.0);
        let unit = if size > 0.0 { size } else { 1.0 };
        let growth = 1e-5 * unit + 1e-12 * all.lo.abs().max(all.hi.abs()).max_element();
        for (k, eight) in rays(seed as u64 + 300, &boxes, 216).chunks(8).enumerate() {
            let eight = &eight[..=k % 8];
            for (ray, items) in eight.iter().zip(found(&tree, eight, 1.0)) {
                let exact =
                    |item: &u32| !boxes[*item as usize].is_empty() && passes(ray, &boxes[*item as usize]);
                let expected: Vec<u32> = (0..boxes.len() as u32).filter(exact).collect();
                let Some(items) = items else {
                    too_many += 1;
                    continue;
                };
                for item in &expected {
                    assert!(items.contains(item), "list {seed}: {ray:?} misses {item}");
                    met += 1;
                }
                for item in items {
                    let near = boxes[item as usize].grown(growth);
                    assert!(passes(ray, &near), "list {seed}: {ray:?} finds {item} at {near:?}");
                }
            }
        }
    }
    assert!(met > 500 && too_many > 10, "{met}, {too_many}");
}
