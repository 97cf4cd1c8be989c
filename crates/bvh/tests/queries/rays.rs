//! Queries by rays against an oracle in rational numbers: no item on the way is missed, and few others are found.

use crate::common::{ALL, Ray, around, lists, passes, rays, scattered};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8, mask64x8};
use rayweave_bvh::{
    BundleSlabs, BundleTraversal, BundleWindow, Bvh, ExactBvh, ForwardSearch, FrontToBack, Probe,
    RayTraversals,
};
use rayweave_math::{Bounds, UNIT_ROUNDOFF, Vec3};

fn probe<const LEAF: usize>(tree: &Bvh<LEAF>, ray: &Ray) -> Probe {
    tree.probe(ray.origin, ray.direction, 0.0, ray.window)
}

fn on_the_way(ray: &Ray, boxes: &[Bounds]) -> Vec<u32> {
    let met = |&k: &u32| !boxes[k as usize].is_empty() && passes(ray, &boxes[k as usize]);
    (0..boxes.len() as u32).filter(met).collect()
}

fn sorted(mut numbers: Vec<u32>) -> Vec<u32> {
    numbers.sort_unstable();
    numbers
}

fn touched(tree: &Bvh, ray: &Ray) -> Vec<u32> {
    let mut found = tree.unbounded().to_vec();
    tree.intersected_items(&probe(tree, ray), &mut found);
    sorted(found)
}

#[test]
fn a_ray_visits_a_superset_of_the_exact_answer() {
    let mut met = 0;
    for (seed, boxes) in lists().into_iter().enumerate() {
        let single = Bvh::of_items(&boxes, 1);
        let (clusters, order) = Bvh::<4>::of_clusters(&boxes);
        for ray in rays(seed as u64, &boxes, 60) {
            let expected = on_the_way(&ray, &boxes);
            let found = touched(&single, &ray);
            let mut of_clusters = Vec::new();
            clusters
                .traverse(&probe(&clusters, &ray), |places| of_clusters.extend_from_slice(&order[places]));
            for item in &expected {
                assert!(found.binary_search(item).is_ok(), "list {seed}: {ray:?} misses {item}");
                assert!(of_clusters.contains(item), "list {seed}: {ray:?} misses {item} in clusters");
            }
            assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "an item is found twice");
            met += expected.len();
        }
    }
    assert!(met > 5000, "{met}");
}

/// The items of a search in the order in which they are found, up to a time.
fn searched(tree: &Bvh, ray: &Ray, until: f64) -> Vec<u32> {
    dispatch!(Level::new(), simd => {
        let mut search = ForwardSearch::default();
        search.begin(simd, tree, probe(tree, ray));
        std::iter::from_fn(|| search.next(simd, tree, until)).collect()
    })
}

#[test]
fn a_forward_search_finds_all_items_up_to_a_time() {
    let (mut met, mut all, mut ends) = (0, 0, 0);
    for (seed, boxes) in lists().into_iter().enumerate() {
        let tree = Bvh::of_items(&boxes, 1);
        for (k, ray) in rays(seed as u64, &boxes, 60).into_iter().enumerate() {
            let expected = on_the_way(&ray, &boxes);
            let found = sorted(searched(&tree, &ray, ray.window[1]));
            assert_eq!(found, touched(&tree, &ray), "list {seed}: {ray:?}");
            assert!(expected.iter().all(|item| found.binary_search(item).is_ok()), "list {seed}: {ray:?}");
            // the time at which the ray passes the middle of some item, within its window
            let Some(&item) = expected.get(k % expected.len().max(1)) else { continue };
            let towards = boxes[item as usize].centre() - ray.origin;
            let until = (towards.dot(ray.direction) / ray.direction.length_squared()).min(ray.window[1]);
            let sooner = Ray { window: [ray.window[0], until], ..ray };
            let found = sorted(searched(&tree, &ray, until));
            for item in on_the_way(&sooner, &boxes) {
                assert!(found.binary_search(&item).is_ok(), "list {seed}: {ray:?} misses {item}");
                met += 1;
            }
            (all, ends) = (all + expected.len(), ends + found.len());
        }
    }
    assert!(met > 2000 && ends < all, "{met} {ends} {all}");
}

#[test]
fn few_items_beside_the_ray_are_found() {
    let boxes = scattered(3, 900, 0.2, Vec3::ZERO);
    let tree = Bvh::of_items(&boxes, 1);
    let (mut met, mut found) = (0, 0);
    for ray in rays(9, &boxes, 120) {
        met += on_the_way(&ray, &boxes).len();
        found += touched(&tree, &ray).len();
    }
    // rays through corners and in faces barely touch many boxes
    assert!(met > 1000 && found <= met + met / 50 + 60, "{found} of {met}");
}

#[test]
fn front_to_back_traversal_returns_the_same_items_in_order_of_entry() {
    let mut front = FrontToBack::default();
    for (seed, boxes) in lists().into_iter().enumerate() {
        let tree = Bvh::of_items(&boxes, 1);
        for ray in rays(seed as u64 + 100, &boxes, 60) {
            let (mut found, mut time) = (Vec::new(), f64::NEG_INFINITY);
            front.begin(&tree, probe(&tree, &ray));
            while front.time() < f64::INFINITY {
                assert!(front.time() >= time && front.time() <= front.end());
                time = front.time();
                let Some(item) = front.next(&tree) else { continue };
                // the ray, cut off before the entry time, misses the box except for its growth
                let slack = 1e-5 * tree.size() / ray.direction.length();
                let before = Ray { window: [f64::NEG_INFINITY, time - slack], ..ray };
                let from_start = ray.window == ALL && slack > 1e-9 * time.abs();
                assert!(
                    !from_start || !passes(&before, &boxes[item as usize]),
                    "{ray:?} enters {item} earlier"
                );
                found.push(item);
            }
            assert_eq!(sorted(found), touched(&tree, &ray));
        }
    }
}

#[test]
fn empty_and_unbounded_boxes_are_kept_apart() {
    let mut boxes = scattered(1, 40, 0.3, Vec3::ZERO);
    let pillar =
        Bounds { lo: Vec3::new(-0.1, -0.1, f64::NEG_INFINITY), hi: Vec3::new(0.1, 0.1, f64::INFINITY) };
    boxes.extend([Bounds::EMPTY, Bounds::ALL, pillar]);
    let tree = Bvh::of_items(&boxes, 1);
    assert_eq!(tree.unbounded(), [41, 42]);
    for ray in rays(4, &boxes, 60) {
        let found = touched(&tree, &ray);
        assert!(on_the_way(&ray, &boxes).iter().all(|item| found.contains(item)));
        assert!(!found.contains(&40));
    }
    let tree = Bvh::of_items(&[Bounds::EMPTY, Bounds::ALL], 1);
    assert_eq!((touched(&tree, &rays(0, &boxes, 1)[0]), tree.bytes()), (vec![1], 4));
}

#[test]
fn a_ray_that_is_none_passes_no_box() {
    let boxes = scattered(1, 100, 0.5, Vec3::ZERO);
    let tree = Bvh::of_items(&boxes, 1);
    let none = [
        (Vec3::ZERO, Vec3::ZERO),
        (Vec3::ZERO, Vec3::NAN),
        (Vec3::NAN, Vec3::X),
        (Vec3::INFINITY, Vec3::X),
        (Vec3::ZERO, Vec3::INFINITY),
    ];
    for (origin, direction) in none {
        assert_eq!(touched(&tree, &Ray { origin, direction, window: ALL }), []);
    }
    // far outside the range of f32
    for origin in [1e100 * Vec3::X, 1e60 * Vec3::Y] {
        let ray = Ray { origin, direction: -origin, window: ALL };
        assert_eq!(touched(&tree, &ray).len(), 100);
    }
}

/// The items that some rays visit.
struct Visited {
    /// As a bundle.
    bundle: Vec<u32>,
    /// Each ray on its own.
    apart: Vec<Vec<u32>>,
}

/// The items that a bundle of up to eight rays visits.
fn in_a_bundle(tree: &ExactBvh, order: &[u32], rays: &[Ray], size: f64) -> Visited {
    let found = dispatch!(Level::new(), simd => visited_by(simd, tree, rays, size));
    let items = |places: Vec<u32>| sorted(places.into_iter().map(|k| order[k as usize]).collect());
    Visited { bundle: items(found.bundle), apart: found.apart.into_iter().map(items).collect() }
}

fn visited_by<S: Simd>(simd: S, tree: &ExactBvh, rays: &[Ray], size: f64) -> Visited {
    let lanes = |of: &dyn Fn(&Ray) -> f64| {
        let last = rays.len() - 1;
        f64x8::load_array(simd, std::array::from_fn(|lane| of(&rays[lane.min(last)])))
    };
    let origin = [0, 1, 2].map(|k| lanes(&|ray| ray.origin[k]));
    let direction = [0, 1, 2].map(|k| lanes(&|ray| ray.direction[k]));
    let margin = lanes(&|ray| 64.0 * UNIT_ROUNDOFF * (ray.origin.abs().element_sum() + size));
    let slabs = BundleSlabs::new(simd, origin, direction, margin);
    let bits = (1u64 << rays.len()) - 1;
    let window = BundleWindow {
        rays: mask64x8::from_bitmask(simd, bits),
        from: (
            lanes(&|ray| ray.window[0]),
            rays.iter().map(|ray| ray.window[0]).fold(f64::INFINITY, f64::min),
        ),
        until: (
            lanes(&|ray| ray.window[1]),
            rays.iter().map(|ray| ray.window[1]).fold(f64::NEG_INFINITY, f64::max),
        ),
    };
    let (bundle, mut traversal, mut found) =
        (slabs.bundle(simd, bits), BundleTraversal::default(), Vec::new());
    traversal.begin(simd, tree, &bundle, &window);
    while let Some(place) = traversal.next(simd, tree, (&slabs, &bundle), &window) {
        found.push(place);
    }
    let mut apart = RayTraversals::default();
    apart.begin(simd, tree, &slabs, &window);
    let each = rays
        .iter()
        .enumerate()
        .map(|(lane, ray)| std::iter::from_fn(|| apart.next(simd, tree, lane, ray.window[1])).collect());
    let each = each.collect();
    Visited { bundle: found, apart: each }
}

#[test]
fn a_bundle_visits_a_superset_of_the_exact_answers_of_its_rays() {
    let mut met = 0;
    for (seed, mut boxes) in lists().into_iter().enumerate() {
        if seed % 2 == 0 {
            let half = Bounds { lo: Vec3::new(0.5, f64::NEG_INFINITY, -1.0), hi: Vec3::INFINITY };
            boxes.extend([Bounds::EMPTY, half, Bounds::ALL]);
        }
        let all = around(&boxes);
        let size = if all.is_empty() { 0.0 } else { all.lo.abs().max(all.hi.abs()).element_sum() };
        let (tree, order) = ExactBvh::sorted(&boxes);
        for (k, bundle) in rays(seed as u64 + 200, &boxes, 72).chunks(8).enumerate() {
            let bundle = &bundle[..=k % 8];
            let Visited { bundle: found, apart } = in_a_bundle(&tree, &order, bundle, size);
            let lists = std::iter::once(&found).chain(&apart);
            for list in lists {
                assert!(list.windows(2).all(|pair| pair[0] < pair[1]), "an item is found twice");
            }
            for (ray, own) in bundle.iter().zip(&apart) {
                for item in on_the_way(ray, &boxes) {
                    assert!(found.binary_search(&item).is_ok(), "list {seed}: {ray:?} misses {item}");
                    assert!(own.binary_search(&item).is_ok(), "list {seed}: {ray:?} alone misses {item}");
                    met += 1;
                }
            }
            // each bounded item that is found is on the path of a ray, up to the growth of the boxes
            let growth = 1e-9 * (size + around(&boxes).size().max_element());
            let is_near = |ray: &Ray, item: &u32| {
                passes(&Ray { window: ALL, ..*ray }, &boxes[*item as usize].grown(growth))
            };
            let far = bundle.iter().map(|ray| ray.origin.length()).fold(0.0, f64::max) > 1e3 * size;
            let is_bounded = |item: &&u32| !far && boxes[**item as usize].is_finite();
            for item in found.iter().filter(is_bounded) {
                let is_near = bundle.iter().any(|ray| is_near(ray, item));
                assert!(is_near, "list {seed}: {:?} for {bundle:?}", boxes[*item as usize]);
            }
            for (ray, own) in bundle.iter().zip(&apart) {
                for item in own.iter().filter(is_bounded) {
                    assert!(is_near(ray, item), "list {seed}: {:?} for {ray:?}", boxes[*item as usize]);
                }
            }
        }
    }
    assert!(met > 2000, "{met}");
}
