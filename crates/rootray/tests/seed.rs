//! The functions under the names of the module *rootray*.

mod common;

use common::{rng, tied_ray};
use rand::RngExt;
use rayweave_rootray::{Problem, RootRayError, seed};

fn pair(sign: i64, times: &[f64]) -> rayweave_rootray::RootRay {
    seed::from_pair(sign, times).unwrap()
}

#[test]
fn pairs_go_there_and_back() {
    assert_eq!(seed::to_pair(&seed::vacuum()), (1, vec![]));
    assert_eq!(seed::to_pair(&seed::plenum()), (-1, vec![]));
    assert_eq!(seed::to_pair(&pair(-1, &[1.0, 2.0])), (-1, vec![1.0, 2.0]));
    assert_eq!(seed::to_pair(&seed::complement(&pair(1, &[1.0]))), (-1, vec![1.0]));
    assert_eq!(seed::from_pair(0, &[]), Err(RootRayError::Sign { sign: 0 }));
    assert_eq!(seed::from_pair(1, &[f64::NAN]), Err(RootRayError::Nan { index: 0 }));
}

#[test]
fn well_separated_times_give_the_exact_algebra() {
    let mut rng = rng(8);
    for _ in 0..1000 {
        let (f, g) = (tied_ray(&mut rng), tied_ray(&mut rng));
        assert_eq!(seed::union(&f, &g), f.union(&g));
        assert_eq!(seed::intersection(&f, &g), f.intersection(&g));
        assert_eq!(seed::difference(&f, &g), f.difference(&g));
        assert_eq!(seed::symmetric_difference(&f, &g), f.symmetric_difference(&g));
    }
}

#[test]
fn thin_gaps_and_layers_disappear() {
    let next = 1.0 + f64::EPSILON;
    let (left, right) = (pair(1, &[0.0, 1.0]), pair(1, &[next, 2.0]));
    assert_eq!(seed::union(&left, &right), pair(1, &[0.0, 2.0]));
    assert_eq!(seed::intersection(&pair(1, &[0.0, next]), &pair(1, &[1.0, 2.0])), seed::vacuum());
    assert_eq!(seed::difference(&pair(1, &[0.0, next]), &left), seed::vacuum());
    assert_eq!(seed::symmetric_difference(&pair(1, &[0.0, next]), &left), seed::vacuum());
    assert_eq!(seed::clip_time(&pair(1, &[0.0, 1.0, next, 2.0]), -1.0, 3.0), Ok(pair(1, &[0.0, 2.0])));
    let thin = pair(1, &[1.0, next]);
    assert!(matches!(seed::validate(&thin)[..], [Problem::TooClose { index: 1, .. }]));
    assert_eq!(seed::validate(&seed::union(&thin, &seed::vacuum())), []);
}

/// Clipping by the definition in the module's documentation: at each end, a union or an intersection with a root-ray of a
/// single root. Beyond an end the side inside the window is continued.
fn clip_by_operations(f: &rayweave_rootray::RootRay, tmin: f64, tmax: f64) -> rayweave_rootray::RootRay {
    let (first, last) = (f.side_at(tmin).unwrap(), f.side_at((tmax - 0.25).max(tmin)).unwrap());
    let after = pair(1, &[tmin]);
    let before = pair(-1, &[tmax]);
    let cut = if first.is_inside() { f | &!after } else { f & &after };
    if last.is_inside() { cut | !before } else { cut & before }
}

#[test]
fn clipping_is_two_operations_with_single_roots() {
    let mut rng = rng(9);
    for _ in 0..3000 {
        let f = tied_ray(&mut rng);
        // integers and half-integers: ends at roots and between them
        let tmin = f64::from(rng.random_range(-10..10)) / 2.0;
        let tmax = tmin + f64::from(rng.random_range(1..10)) / 2.0;
        assert_eq!(
            seed::clip_time(&f, tmin, tmax),
            Ok(clip_by_operations(&f, tmin, tmax)),
            "{f} {tmin} {tmax}"
        );
    }
    assert!(matches!(seed::clip_time(&seed::vacuum(), 1.0, 1.0), Err(RootRayError::EmptyWindow { .. })));
}
