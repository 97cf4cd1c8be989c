//! The boolean algebra against an oracle that samples midpoints, its laws with ties, and the attribution of crossings.

mod common;

use common::{rng, tied_ray};
use rand::RngExt;
use rayweave_rootray::{Root, RootRay, Side};

const ROUNDS: usize = 3000;

/// Inside at `t`, by counting the roots before it.
fn inside(ray: &RootRay, t: f64) -> bool {
    let before = ray.roots().iter().filter(|root| root.t < t).count();
    (before % 2 == 1) != (ray.start() == Side::Inside)
}

/// The root-ray of any boolean function of rays with integer times from -4 to 4, by sampling the midpoints between integers.
fn oracle(rays: &[RootRay], op: impl Fn(&[bool]) -> bool) -> RootRay {
    let sample = |t: f64| op(&rays.iter().map(|ray| inside(ray, t)).collect::<Vec<_>>());
    let times: Vec<f64> = (-4..=4).map(f64::from).filter(|t| sample(t - 0.5) != sample(t + 0.5)).collect();
    RootRay::from_times(Side::from_inside(sample(-100.0)), times).unwrap()
}

#[test]
fn binary_operations_agree_with_midpoints() {
    let mut rng = rng(1);
    for _ in 0..ROUNDS {
        let [a, b] = [tied_ray(&mut rng), tied_ray(&mut rng)];
        let pair = [a.clone(), b.clone()];
        assert_eq!(&a | &b, oracle(&pair, |s| s[0] || s[1]), "{a} | {b}");
        assert_eq!(&a & &b, oracle(&pair, |s| s[0] && s[1]), "{a} & {b}");
        assert_eq!(&a - &b, oracle(&pair, |s| s[0] && !s[1]), "{a} - {b}");
        assert_eq!(&a ^ &b, oracle(&pair, |s| s[0] != s[1]), "{a} ^ {b}");
        assert_eq!(!&a, oracle(&pair, |s| !s[0]), "!{a}");
    }
}

#[test]
fn n_ary_operations_agree_with_midpoints_and_folds() {
    let mut rng = rng(2);
    for _ in 0..ROUNDS {
        let n = rng.random_range(0..8);
        let rays: Vec<RootRay> = (0..n).map(|_| tied_ray(&mut rng)).collect();
        let count = |s: &[bool]| s.iter().filter(|&&s| s).count();
        let fold =
            |neutral, op: fn(&RootRay, &RootRay) -> RootRay| rays.iter().fold(neutral, |a, b| op(&a, b));

        let union = RootRay::union_all(&rays);
        assert_eq!(union, oracle(&rays, |s| count(s) > 0));
        assert_eq!(union, fold(RootRay::empty(), RootRay::union));
        let intersection = RootRay::intersection_all(&rays);
        assert_eq!(intersection, oracle(&rays, |s| count(s) == n));
        assert_eq!(intersection, fold(RootRay::universe(), RootRay::intersection));
        let odd = RootRay::symmetric_difference_all(&rays);
        assert_eq!(odd, oracle(&rays, |s| count(s) % 2 == 1));
        assert_eq!(odd, fold(RootRay::empty(), RootRay::symmetric_difference));
        let threshold = rng.random_range(0..=n + 1);
        assert_eq!(RootRay::at_least(threshold, &rays), oracle(&rays, |s| count(s) >= threshold));
    }
}

#[test]
fn operations_on_nothing() {
    let none: [RootRay; 0] = [];
    assert_eq!(RootRay::union_all(&none), RootRay::empty());
    assert_eq!(RootRay::intersection_all(&none), RootRay::universe());
    assert_eq!(RootRay::symmetric_difference_all(&none), RootRay::empty());
}

#[test]
fn laws_of_two_hold_bit_for_bit() {
    let mut rng = rng(3);
    let (empty, universe) = (RootRay::empty(), RootRay::universe());
    for _ in 0..ROUNDS {
        let [a, b] = [tied_ray(&mut rng), tied_ray(&mut rng)];
        assert_eq!(!(&a | &b), !&a & !&b, "De Morgan");
        assert_eq!(!(&a & &b), !&a | !&b, "De Morgan");
        assert_eq!(&a | &b, &b | &a);
        assert_eq!(&a & &b, &b & &a);
        assert_eq!(&a ^ &b, &b ^ &a);
        assert_eq!(&a | &(&a & &b), a, "absorption");
        assert_eq!(&a & &(&a | &b), a, "absorption");
        assert_eq!(&a - &b, &a & &!&b);
        assert_eq!(&a ^ &b, (&a - &b) | (&b - &a));
        assert_eq!((&a | &a, &a & &a), (a.clone(), a.clone()), "idempotence");
        assert_eq!((&a ^ &a, &a - &a), (empty.clone(), empty.clone()));
        assert_eq!((&a | &!&a, &a & &!&a), (universe.clone(), empty.clone()), "complement");
        assert_eq!((&a | &empty, &a & &universe, &a ^ &empty), (a.clone(), a.clone(), a.clone()));
        assert_eq!((&a | &universe, &a & &empty, &a ^ &universe), (universe.clone(), empty.clone(), !&a));
        assert_eq!(!!&a, a);
    }
}

#[test]
fn laws_of_three_hold_bit_for_bit() {
    let mut rng = rng(4);
    for _ in 0..ROUNDS {
        let [a, b, c] = [tied_ray(&mut rng), tied_ray(&mut rng), tied_ray(&mut rng)];
        assert_eq!(&(&a | &b) | &c, &a | &(&b | &c), "associativity");
        assert_eq!(&(&a & &b) & &c, &a & &(&b & &c), "associativity");
        assert_eq!(&(&a ^ &b) ^ &c, &a ^ &(&b ^ &c), "associativity");
        assert_eq!(&a & &(&b | &c), (&a & &b) | (&a & &c), "distributivity");
        assert_eq!(&a | &(&b & &c), (&a | &b) & (&a | &c), "distributivity");
        assert_eq!(&a & &(&b ^ &c), (&a & &b) ^ (&a & &c), "distributivity");
        assert_eq!(&a - &(&b | &c), (&a - &b) & (&a - &c));
    }
}

#[test]
fn signed_zeros_are_one_time_with_one_bit_pattern() {
    let a = RootRay::from_times(Side::Outside, [-0.0, 1.0]).unwrap();
    let b = RootRay::from_times(Side::Outside, [0.0, 2.0]).unwrap();
    assert_eq!((&a ^ &b).to_string(), "outside [1, 2]");
    for ray in [&a | &b, &b | &a, &a & &b, &b & &a] {
        assert_eq!(ray.roots()[0].t.to_bits(), 0.0_f64.to_bits());
    }
}

/// A ray with one root at 0 that belongs to `surface`.
fn step(start: Side, surface: char) -> RootRay<char> {
    RootRay::new(start, vec![Root::new(0.0, surface)]).unwrap()
}

fn surfaces(ray: &RootRay<char>) -> String {
    ray.roots().iter().map(|root| root.surface).collect()
}

#[test]
fn crossings_keep_the_surface_that_they_come_from() {
    let ray = |t: [f64; 2], s: [char; 2]| {
        RootRay::new(Side::Outside, vec![Root::new(t[0], s[0]), Root::new(t[1], s[1])]).unwrap()
    };
    let (a, b) = (ray([1.0, 3.0], ['a', 'A']), ray([2.0, 4.0], ['b', 'B']));
    assert_eq!(surfaces(&(&a | &b)), "aB");
    assert_eq!(surfaces(&(&a & &b)), "bA");
    assert_eq!(surfaces(&(&a - &b)), "ab");
    assert_eq!(surfaces(&(&b - &a)), "AB");
    assert_eq!(surfaces(&(&a ^ &b)), "abAB");
    assert_eq!(surfaces(&!&a), "aA");
}

#[test]
fn ties_go_to_the_lowest_operand_that_decides() {
    use Side::{Inside, Outside};
    let union = |a: Side, b: Side| (step(a, 'a') | step(b, 'b'), step(b, 'b') | step(a, 'a'));
    // both enter: either alone would
    let (ab, ba) = union(Outside, Outside);
    assert_eq!((surfaces(&ab), surfaces(&ba)), ("a".into(), "b".into()));
    // one leaves as the other enters: no crossing
    let (ab, ba) = union(Inside, Outside);
    assert_eq!((surfaces(&ab), surfaces(&ba)), (String::new(), String::new()));
    // a enters, b leaves, c enters: the symmetric difference changes three times; the first decides
    let three = [step(Outside, 'a'), step(Inside, 'b'), step(Outside, 'c')];
    assert_eq!(surfaces(&RootRay::symmetric_difference_all(&three)), "a");
    // intersection with a solid that is left while the others are entered: nothing
    assert_eq!(surfaces(&RootRay::intersection_all(&three)), "");
    // two of three: from {b} to {a, c}; b is not a candidate, because without its event all three would be inside
    let two = [step(Inside, 'b'), step(Outside, 'a'), step(Outside, 'c')];
    assert_eq!(surfaces(&RootRay::at_least(2, &two)), "a");
    // from all four to none: neither one event alone nor one event undone changes "at least two", so the lowest of all
    let four = ['w', 'x', 'y', 'z'].map(|surface| step(Inside, surface));
    assert_eq!(surfaces(&RootRay::at_least(2, &four)), "w");
    // difference: both operands decide
    assert_eq!(surfaces(&(step(Outside, 'a') - step(Inside, 'b'))), "a");
}

/// The rule of attribution, spelt out for any boolean function of operands that all change at 0.
fn attributed(starts: &[bool], toggles: &[bool], op: impl Fn(&[bool]) -> bool) -> Option<usize> {
    let after: Vec<bool> = starts.iter().zip(toggles).map(|(s, f)| s != f).collect();
    let after_toggle = |states: &[bool], k: usize| {
        let mut states = states.to_vec();
        states[k] = !states[k];
        op(&states)
    };
    let toggled: Vec<usize> = (0..starts.len()).filter(|&k| toggles[k]).collect();
    let decides =
        |k: &usize| after_toggle(starts, *k) != op(starts) || after_toggle(&after, *k) != op(&after);
    let first = toggled.iter().copied().find(|k| decides(k)).or(toggled.first().copied());
    first.filter(|_| op(starts) != op(&after))
}

#[test]
fn attribution_agrees_with_the_rule_for_all_ties_of_four() {
    for bits in 0..1 << 8_u32 {
        let starts: Vec<bool> = (0..4).map(|k| bits >> k & 1 == 1).collect();
        let toggles: Vec<bool> = (4..8).map(|k| bits >> k & 1 == 1).collect();
        let ray = |k: usize| {
            let roots = if toggles[k] { vec![Root::new(0.0, k)] } else { vec![] };
            RootRay::new(Side::from_inside(starts[k]), roots).unwrap()
        };
        let rays: Vec<RootRay<usize>> = (0..4).map(ray).collect();
        let found = |ray: RootRay<usize>| ray.roots().first().map(|root| root.surface);
        let count = |s: &[bool]| s.iter().filter(|&&s| s).count();
        for threshold in 0..=5 {
            let expected = attributed(&starts, &toggles, |s| count(s) >= threshold);
            assert_eq!(found(RootRay::at_least(threshold, &rays)), expected);
        }
        let expected = attributed(&starts, &toggles, |s| count(s) % 2 == 1);
        assert_eq!(found(RootRay::symmetric_difference_all(&rays)), expected);
        let expected = attributed(&starts[..2], &toggles[..2], |s| s[0] && !s[1]);
        assert_eq!(found(&rays[0] - &rays[1]), expected);
    }
}

#[test]
fn a_hundred_thousand_operands_take_n_log_n() {
    // intervals (k, k + 1.5) overlap their neighbours, so their union is one span; quadratic time would take minutes
    let n = 50_000_u32;
    let ray = |k: u32| RootRay::from_times(Side::Outside, [f64::from(k), f64::from(k) + 1.5]).unwrap();
    let rays: Vec<RootRay> = (0..n).rev().map(ray).collect();
    let union = RootRay::union_all(&rays);
    assert_eq!(union.times().collect::<Vec<_>>(), [0.0, f64::from(n) + 0.5]);
    let pairs = RootRay::at_least(2, &rays);
    assert_eq!(pairs.spans().count(), n as usize - 1);
    assert!(pairs.spans().enumerate().all(|(k, (a, b))| a == k as f64 + 1.0 && b == a + 0.5));
    assert_eq!(RootRay::intersection_all(&rays), RootRay::empty());
    assert_eq!(RootRay::symmetric_difference_all(&rays).roots().len(), 2 * n as usize);

    let comb =
        |shift: f64| RootRay::from_times(Side::Outside, (0..100_000).map(|k| f64::from(k) + shift)).unwrap();
    assert_eq!((comb(0.0) & comb(0.5)).spans().count(), 50_000);
    assert_eq!((comb(0.0) ^ comb(0.0)).roots(), []);
}
