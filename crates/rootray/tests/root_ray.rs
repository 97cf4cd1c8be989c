//! Construction, queries, clipping, welding and validation of root-rays.

mod common;

use common::{rng, tied_ray};
use rand::RngExt;
use rayweave_rootray::{
    Problem, Root, RootRay, RootRayError, Side, SurfaceCount, min_sep, next_run, surface_count,
    validate_times, weld_runs,
};

const INF: f64 = f64::INFINITY;

fn ray(start: Side, times: &[f64]) -> RootRay {
    RootRay::from_times(start, times.iter().copied()).unwrap()
}

fn times<S>(ray: &RootRay<S>) -> Vec<f64> {
    ray.times().collect()
}

#[test]
fn bad_roots_are_rejected_with_their_place() {
    let made =
        |times: &[f64]| RootRay::from_times(Side::Outside, times.iter().copied()).map(|ray| times_of(&ray));
    fn times_of(ray: &RootRay) -> Vec<f64> {
        ray.times().collect()
    }
    assert_eq!(made(&[]), Ok(vec![]));
    assert_eq!(made(&[-1e308, -0.0, 5e-324]), Ok(vec![-1e308, 0.0, 5e-324]));
    assert_eq!(made(&[0.0, f64::NAN]), Err(RootRayError::Nan { index: 1 }));
    assert_eq!(made(&[0.0, INF]), Err(RootRayError::Infinite { index: 1, t: INF }));
    assert_eq!(made(&[-INF]), Err(RootRayError::Infinite { index: 0, t: -INF }));
    let backwards = RootRayError::NotIncreasing { index: 2, previous: 2.0, t: 1.0 };
    assert_eq!(made(&[0.0, 2.0, 1.0, f64::NAN]), Err(backwards));
    let twice = RootRayError::NotIncreasing { index: 1, previous: 0.0, t: 0.0 };
    assert_eq!(made(&[-0.0, 0.0]), Err(twice));
    let message = backwards.to_string();
    assert_eq!(message, "root 2 is 1, not greater than 2 before it: root times must be strictly increasing.");
}

#[test]
fn flips_of_equal_times_cancel_in_pairs() {
    let from_events = |list: &[(f64, char)]| {
        let list = list.iter().map(|&(t, surface)| Root::new(t, surface)).collect();
        RootRay::from_events(Side::Inside, list)
    };
    let ray =
        from_events(&[(3.0, 'a'), (1.0, 'b'), (3.0, 'c'), (-0.0, 'd'), (0.0, 'e'), (0.0, 'f')]).unwrap();
    let roots: Vec<_> = ray.roots().iter().map(|root| (root.t, root.surface)).collect();
    assert_eq!((ray.start(), roots), (Side::Inside, vec![(0.0, 'd'), (1.0, 'b')]));
    assert!(ray.roots()[0].t.is_sign_positive());
    assert_eq!(from_events(&[(1.0, 'a'), (f64::NAN, 'b')]), Err(RootRayError::Nan { index: 1 }));
    assert_eq!(from_events(&[(-INF, 'a')]), Err(RootRayError::Infinite { index: 0, t: -INF }));
}

#[test]
fn sides_are_those_just_after_a_time() {
    let ray = ray(Side::Inside, &[1.0, 2.0]);
    let side = |t| ray.side_at(t).unwrap();
    assert_eq!((ray.start(), ray.end()), (Side::Inside, Side::Inside));
    assert_eq!([side(-INF), side(0.9), side(1.0)], [Side::Inside, Side::Inside, Side::Outside]);
    assert_eq!([side(1.9), side(2.0), side(INF)], [Side::Outside, Side::Inside, Side::Inside]);
    assert_eq!(ray.side_at(f64::NAN), Err(RootRayError::NanTime));
    let sides: Vec<Side> = ray.crossings().map(|(_, side)| side).collect();
    assert_eq!(sides, [Side::Outside, Side::Inside]);
}

#[test]
fn spans_reach_to_infinity() {
    let spans = |start, times: &[f64]| ray(start, times).spans().collect::<Vec<_>>();
    assert_eq!(spans(Side::Outside, &[]), []);
    assert_eq!(spans(Side::Inside, &[]), [(-INF, INF)]);
    assert_eq!(spans(Side::Outside, &[1.0]), [(1.0, INF)]);
    assert_eq!(spans(Side::Inside, &[1.0]), [(-INF, 1.0)]);
    assert_eq!(spans(Side::Outside, &[1.0, 2.0, 3.0]), [(1.0, 2.0), (3.0, INF)]);
    assert_eq!(spans(Side::Inside, &[1.0, 2.0]), [(-INF, 1.0), (2.0, INF)]);
}

#[test]
fn short_forms_and_parts() {
    let ray = RootRay::new(Side::Outside, vec![Root::new(0.5, 7), Root::new(1e300, 8)]).unwrap();
    assert_eq!(ray.to_string(), format!("outside [0.5, {}]", 1e300));
    assert_eq!(RootRay::<u8>::default(), RootRay::empty());
    let named = ray.map_surfaces(|surface| surface * 2);
    assert_eq!(named.into_parts(), (Side::Outside, vec![Root::new(0.5, 14), Root::new(1e300, 16)]));
}

#[test]
fn clipping_drops_roots_at_both_ends() {
    let ray = ray(Side::Outside, &[1.0, 2.0, 3.0, 4.0]);
    let clip = |t_min, t_max| ray.clip(t_min, t_max).unwrap().to_string();
    assert_eq!(clip(-INF, INF), "outside [1, 2, 3, 4]");
    assert_eq!(clip(1.0, 3.0), "inside [2]");
    assert_eq!(clip(2.0, 4.0), "outside [3]");
    assert_eq!(clip(1.5, INF), "inside [2, 3, 4]");
    assert_eq!(clip(-INF, 1.0), "outside []");
    assert_eq!(clip(4.0, INF), "outside []");
    assert_eq!(clip(1.25, 1.75), "inside []");
}

#[test]
fn bad_windows_are_rejected() {
    let ray = ray(Side::Outside, &[1.0]);
    let empty = |t_min, t_max| Err(RootRayError::EmptyWindow { t_min, t_max });
    for (t_min, t_max) in [(1.0, 1.0), (2.0, 1.0), (INF, INF), (-INF, -INF), (INF, -INF), (0.0, -0.0)] {
        assert_eq!(ray.clip(t_min, t_max), empty(t_min, t_max));
    }
    for (t_min, t_max) in [(f64::NAN, 1.0), (1.0, f64::NAN)] {
        assert!(matches!(ray.clip(t_min, t_max), Err(RootRayError::NanWindow { .. })));
    }
}

#[test]
fn min_sep_is_symmetric_monotonic_and_small() {
    let sizes = [0.0, 5e-324, 1e-310, 1e-300, 1.0, 1.5, 1e8, 1e300, f64::MAX];
    for (k, &a) in sizes.iter().enumerate() {
        for &b in &sizes {
            let sep = min_sep(a, b);
            assert!(sep > 0.0 && sep.is_finite());
            assert_eq!(sep, min_sep(b, a));
            assert_eq!([sep; 3], [min_sep(-a, b), min_sep(a, -b), min_sep(-a, -b)]);
            assert!(sizes[k..].iter().all(|&c| min_sep(c, b) >= sep));
        }
    }
    // at 1: 32 times the unit roundoff, 16 units in the last place
    assert_eq!(min_sep(1.0, 1.0), 16.0 * f64::EPSILON);
    assert_eq!(min_sep(0.0, 0.0), 16.0 * 5e-324);
}

#[test]
fn a_run_becomes_nothing_or_its_last_member() {
    let weld = |times: &[f64]| ray(Side::Outside, times).weld(|_, _| 0.5).to_string();
    assert_eq!(weld(&[0.0, 1.0, 2.0]), "outside [0, 1, 2]");
    assert_eq!(weld(&[0.0, 1.0, 1.25, 2.0]), "outside [0, 2]");
    assert_eq!(weld(&[0.0, 1.0, 1.25, 1.5, 2.0]), "outside [0, 1.5, 2]");
    assert_eq!(weld(&[0.0, 0.25, 0.5, 0.75]), "outside []");
    assert_eq!(weld(&[0.0, 0.25, 0.5]), "outside [0.5]");
    assert_eq!(weld(&[]), "outside []");
    let zero = ray(Side::Inside, &[0.0, 5e-324]);
    assert_eq!(zero.weld(|_, _| 0.0), zero);
    assert_eq!(zero.weld(min_sep), RootRay::universe());
}

#[test]
fn welding_twice_changes_nothing_and_complement_commutes() {
    let mut rng = rng(5);
    for _ in 0..3000 {
        // steps from far below to far above the least separation, on both sides of zero
        let mut t: f64 = [-1.0, -1e-321, 1.0][rng.random_range(0..3)];
        let mut list = Vec::new();
        for _ in 0..rng.random_range(0..30) {
            list.push(t);
            t += t.abs() * 10_f64.powf(rng.random_range(-16.0..-14.0)) + 5e-324 * rng.random_range(1.0..30.0);
        }
        list.dedup();
        let ray = ray(Side::Outside, &list);
        let once = ray.weld(min_sep);
        assert_eq!(once.weld(min_sep), once, "{list:?}");
        assert_eq!(once.validate(), []);
        assert_eq!((!&ray).weld(min_sep), !&once);
        assert_eq!((once.start(), once.end()), (ray.start(), ray.end()));
    }
}

/// Runs by the definition: a cut wherever two neighbours are not welded.
fn runs_by_cuts(items: &[i32]) -> Vec<Vec<i32>> {
    let mut runs: Vec<Vec<i32>> = Vec::new();
    for (k, &item) in items.iter().enumerate() {
        if k == 0 || item - items[k - 1] > 1 {
            runs.push(Vec::new());
        }
        runs.last_mut().unwrap().push(item);
    }
    runs
}

#[test]
fn runs_are_maximal_and_cover_everything() {
    let mut rng = rng(6);
    for _ in 0..1000 {
        let items: Vec<i32> = (0..20).filter(|_| rng.random_bool(0.6)).collect();
        let expected = runs_by_cuts(&items);
        let mut compared = 0;
        let runs: Vec<Vec<i32>> = weld_runs(&items, |a, b| {
            compared += 1;
            b - a <= 1
        })
        .map(|run| items[run].to_vec())
        .collect();
        assert_eq!(runs, expected);
        assert_eq!(compared, items.len().saturating_sub(1), "each pair is compared once");

        let (mut stream, mut run, mut streamed) = (items.iter().copied().peekable(), vec![99], Vec::new());
        while next_run(&mut stream, &mut run, |a, b| b - a <= 1) {
            streamed.push(run.clone());
        }
        assert_eq!(streamed, expected);
        assert_eq!(run, []);
    }
}

#[test]
fn validation_reports_every_problem() {
    let near = 1.0 + f64::EPSILON;
    let found = validate_times([0.0, f64::NAN, 1.0, near, 0.5, INF, INF, 3.0]);
    let expected = [
        Problem::Nan { index: 1 },
        Problem::TooClose { index: 3, previous: 1.0, t: near, min_sep: min_sep(1.0, near) },
        Problem::NotIncreasing { index: 4, previous: near, t: 0.5 },
        Problem::Infinite { index: 5, t: INF },
        Problem::Infinite { index: 6, t: INF },
        Problem::NotIncreasing { index: 6, previous: INF, t: INF },
        Problem::NotIncreasing { index: 7, previous: INF, t: 3.0 },
    ];
    assert_eq!(found, expected);
    assert_eq!(expected[2].to_string(), format!("root 4 is 0.5, not greater than {near} before it"));
    assert_eq!(validate_times([-1.0, 0.0, 1.0]), []);
    assert_eq!(validate_times([f64::NAN]), [Problem::Nan { index: 0 }]);
    let ray = ray(Side::Outside, &[1.0, near]);
    assert_eq!(
        ray.validate(),
        [Problem::TooClose { index: 1, previous: 1.0, t: near, min_sep: min_sep(1.0, near) }]
    );
}

#[test]
fn counts_agree_with_sides() {
    let mut rng = rng(7);
    for _ in 0..500 {
        let rays: Vec<RootRay> = (0..rng.random_range(0..6)).map(|_| tied_ray(&mut rng)).collect();
        let count_at = |t: f64| rays.iter().filter(|ray| ray.side_at(t).unwrap().is_inside()).count();
        let count = surface_count(&rays);
        assert_eq!(count.start, count_at(-INF));
        let mut all: Vec<f64> = rays.iter().flat_map(times).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        let expected: Vec<(f64, usize)> = all.into_iter().map(|t| (t, count_at(t))).collect();
        assert_eq!(count.steps, expected);
    }
}

#[test]
fn a_count_that_stays_is_still_a_step() {
    let (a, b) = (ray(Side::Outside, &[1.0, 2.0]), ray(Side::Outside, &[2.0, 3.0]));
    let expected = SurfaceCount { start: 0, steps: vec![(1.0, 1), (2.0, 1), (3.0, 0)] };
    assert_eq!(surface_count([&a, &b]), expected);
}
