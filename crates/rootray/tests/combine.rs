//! Boolean functions of many hit arrays against sides at sampled times, one ray at a time.

mod common;

use rand::RngExt;
use rayweave_rootray::hit_array::{HitArrayBuf, MergedHits, combine};
use rayweave_rootray::{CountRule, RootRay, Side};

const INF: f64 = f64::INFINITY;

/// One operand: its rays, and whether it is complemented.
type Operand = (Vec<RootRay>, bool);

fn array(rays: &[RootRay]) -> HitArrayBuf {
    let mut array = HitArrayBuf::default();
    array.reset(rays.len());
    for (column, ray) in rays.iter().enumerate() {
        array.fill_column(column, ray.start(), ray.times());
    }
    array
}

/// The column that follows from the sides between the integers, where no random ray has a root.
fn expected(rule: CountRule, operands: &[Operand], column: usize) -> Vec<f64> {
    let side = |t: f64| {
        let inside =
            |ray: &RootRay| ray.start().is_inside() ^ (ray.times().filter(|&root| root < t).count() % 2 == 1);
        rule.is_inside(
            operands.iter().filter(|(rays, complemented)| inside(&rays[column]) ^ complemented).count(),
        )
    };
    let start = side(-4.5).then_some(-INF);
    let crossings = (-4..=4).map(f64::from).filter(|t| side(t - 0.5) != side(t + 0.5));
    start.into_iter().chain(crossings).collect()
}

#[test]
fn columns_are_those_of_sampled_sides() {
    let mut rng = common::rng(17);
    let (mut merged, mut out) = (MergedHits::default(), HitArrayBuf::default());
    let mut crossings = 0;
    for _ in 0..3000 {
        let columns = rng.random_range(0..5);
        let count = rng.random_range(0..7);
        let operands: Vec<Operand> = (0..count)
            .map(|_| ((0..columns).map(|_| common::tied_ray(&mut rng)).collect(), rng.random()))
            .collect();
        let rule = match rng.random_range(0..3) {
            0 => CountRule::Odd,
            _ => CountRule::AtLeast(rng.random_range(0..=count + 1)),
        };
        let arrays: Vec<(HitArrayBuf, bool)> = operands.iter().map(|o| (array(&o.0), o.1)).collect();
        combine(rule, columns, arrays.iter().map(|(array, c)| (array, *c)), &mut merged, &mut out);
        let expected: Vec<_> = (0..columns).map(|column| expected(rule, &operands, column)).collect();
        let fullest = expected.iter().map(Vec::len).max().unwrap_or(0);
        assert_eq!((out.rows(), out.columns()), (fullest.next_multiple_of(2), columns));
        for (column, mut expected) in expected.into_iter().enumerate() {
            crossings += expected.len();
            expected.resize(out.rows(), INF);
            assert_eq!(out.as_array().column(column).collect::<Vec<_>>(), expected, "{rule:?} {operands:?}");
        }
    }
    assert!(crossings > 10_000, "{crossings}");
}

/// A thousand nested solids in both orders, for which an insertion sort would take quadratic time.
#[test]
fn many_operands_count_up_and_down() {
    let arrays: Vec<HitArrayBuf> = (1..=1000)
        .map(|k| {
            array(&[
                RootRay::empty(),
                RootRay::from_times(Side::Outside, [-f64::from(k), f64::from(k)]).unwrap(),
            ])
        })
        .collect();
    let (mut merged, mut out) = (MergedHits::default(), HitArrayBuf::default());
    let mut column = |rule, complemented| {
        combine(rule, 2, arrays.iter().map(|array| (array, complemented)), &mut merged, &mut out);
        [0, 1].map(|k| out.as_array().column(k).filter(|&t| t < INF).collect::<Vec<_>>())
    };
    // at least k of them contain the points inside the k-th from outside
    assert_eq!(column(CountRule::AtLeast(300), false), [vec![], vec![-701.0, 701.0]]);
    assert_eq!(column(CountRule::AtLeast(701), true), [vec![-INF], vec![-INF, -701.0, 701.0]]);
    let [none, odd] = column(CountRule::Odd, false);
    assert_eq!((none.len(), odd.len(), odd[0], odd[1999]), (0, 2000, -1000.0, 1000.0));
}

#[test]
fn zeros_have_no_sign_and_columns_that_are_not_there_stay_so() {
    let (mut merged, mut out) = (MergedHits::default(), HitArrayBuf::default());
    let mut a = HitArrayBuf::default();
    a.reset(1);
    a.fill_column(0, Side::Outside, [-0.0, 1.0]);
    a.fill_column(1, Side::Outside, [5.0]);
    combine(CountRule::AtLeast(1), 1, [(&a, false)].into_iter(), &mut merged, &mut out);
    assert_eq!(out.as_array().data().iter().map(|t| t.to_bits()).collect::<Vec<_>>(), [0, 1f64.to_bits()]);
    let mut b = HitArrayBuf::default();
    b.reset(1);
    b.fill_column(0, Side::Outside, [0.0, 2.0]);
    combine(CountRule::Odd, 1, [(&a, false), (&b, false)].into_iter(), &mut merged, &mut out);
    assert_eq!(out.as_array().data(), [1.0, 2.0]);
}
