//! Every pass on small examples, compared as text.

use rayweave_math::{Bounds, Vec3};
use rayweave_model::simplify::{
    Formula, Op, balance, flatten, fold, height, positive, prepare, prune, share,
};
use rayweave_model::{Edge, LeafId};

/// Five leaves and an output made of them.
fn formula_of(make: impl Fn(&mut Formula, [Edge; 5]) -> Edge) -> Formula {
    let mut formula = Formula::default();
    let leaves = std::array::from_fn(|k| formula.leaf(LeafId::from(k)));
    let output = make(&mut formula, leaves);
    formula.add_output(output);
    formula
}

fn text(formula: &Formula) -> String {
    formula.text(formula.outputs()[0])
}

#[track_caller]
fn check(
    pass: fn(&Formula) -> Formula,
    make: impl Fn(&mut Formula, [Edge; 5]) -> Edge,
    before: &str,
    after: &str,
) {
    let written = formula_of(make);
    assert_eq!(text(&written), before);
    assert_eq!(text(&pass(&written)), after);
}

use Op::{AtLeast, Difference, Intersection, SymmetricDifference, Union};

#[test]
fn complements_sink_to_the_leaves() {
    let nested = |f: &mut Formula, [a, b, c, ..]: [Edge; 5]| {
        let less = f.join(Difference, &[b, c]);
        f.join(Difference, &[a, less])
    };
    check(positive, nested, "minus{0, minus{1, 2}}", "all{0, any{~1, 2}}");
    let neither = |f: &mut Formula, [a, b, ..]: [Edge; 5]| f.join(Union, &[a, b]).complement();
    check(positive, neither, "~any{0, 1}", "all{~0, ~1}");
    let count = |f: &mut Formula, [a, b, c, d, _]: [Edge; 5]| {
        let both = f.join(Intersection, &[a, b]);
        f.join(AtLeast(2), &[both, c.complement(), d]).complement()
    };
    check(positive, count, "~at_least_2{all{0, 1}, ~2, 3}", "at_least_2{any{~0, ~1}, 2, ~3}");
    let parity = |f: &mut Formula, [a, b, c, ..]: [Edge; 5]| {
        let less = f.join(Difference, &[b, c]);
        f.join(SymmetricDifference, &[a.complement(), less.complement(), c.complement()])
    };
    check(positive, parity, "odd{~0, ~minus{1, 2}, ~2}", "~odd{0, all{1, ~2}, 2}");
}

#[test]
fn chains_become_flat() {
    let chain = |f: &mut Formula, [a, b, c, d, e]: [Edge; 5]| {
        let left = f.join(Union, &[a, b]);
        let right = f.join(Union, &[c, d]);
        let single = f.join(Intersection, &[right]);
        f.join(Union, &[left, single, e])
    };
    check(flatten, chain, "any{any{0, 1}, all{any{2, 3}}, 4}", "any{0, 1, 2, 3, 4}");
    let minus = |f: &mut Formula, [a, b, c, d, e]: [Edge; 5]| {
        let left = f.join(Difference, &[a, b]);
        let right = f.join(Union, &[c, d]);
        f.join(Difference, &[left, right, e])
    };
    check(flatten, minus, "minus{minus{0, 1}, any{2, 3}, 4}", "minus{0, 1, 2, 3, 4}");
    let parity = |f: &mut Formula, [a, b, c, ..]: [Edge; 5]| {
        let pair = f.join(SymmetricDifference, &[a, b]);
        f.join(SymmetricDifference, &[pair.complement(), c])
    };
    check(flatten, parity, "odd{~odd{0, 1}, 2}", "~odd{0, 1, 2}");
    let shared = |f: &mut Formula, [a, b, c, ..]: [Edge; 5]| {
        let pair = f.join(Union, &[a, b]);
        let more = f.join(Union, &[pair, c]);
        f.join(Intersection, &[pair, more])
    };
    check(flatten, shared, "all{any{0, 1}, any{any{0, 1}, 2}}", "all{any{0, 1}, any{any{0, 1}, 2}}");
}

#[test]
fn constants_and_repetitions_vanish() {
    let nothing = |f: &mut Formula, [a, b, ..]: [Edge; 5]| {
        let empty = f.join(Difference, &[a, a]);
        f.join(Union, &[empty, b, Edge::EMPTY, b])
    };
    check(fold, nothing, "any{minus{0, 0}, 1, empty, 1}", "1");
    let parity = |f: &mut Formula, [a, b, c, ..]: [Edge; 5]| {
        f.join(SymmetricDifference, &[c, a, Edge::UNIVERSE, b.complement(), a, b, b])
    };
    check(fold, parity, "odd{2, 0, universe, ~1, 0, 1, 1}", "odd{1, 2}");
    let count = |f: &mut Formula, [a, b, c, d, _]: [Edge; 5]| {
        f.join(AtLeast(4), &[d, a, b, a.complement(), c, Edge::UNIVERSE])
    };
    check(fold, count, "at_least_4{3, 0, 1, ~0, 2, universe}", "at_least_2{1, 2, 3}");
    let all = |f: &mut Formula, [a, b, ..]: [Edge; 5]| f.join(Union, &[a, b, a.complement()]);
    check(fold, all, "any{0, 1, ~0}", "universe");
}

#[test]
fn equal_parts_are_stored_once() {
    let twice = formula_of(|f, [a, b, c, ..]| {
        let (ab, ba) = (f.join(Intersection, &[a, b]), f.join(Intersection, &[b, a]));
        let (x, y) = (f.join(Union, &[ab, c]), f.join(Union, &[c, ba]));
        f.join(SymmetricDifference, &[x, y.complement(), c])
    });
    let shared = share(&twice);
    // the two unions cancel, which leaves the complement of the third operand
    assert_eq!(text(&shared), "~2");
    let used = formula_of(|f, [a, b, c, d, _]| {
        let (ab, ba) = (f.join(Intersection, &[a, b]), f.join(Intersection, &[b, a]));
        let (x, y) = (f.join(Union, &[ab, c]), f.join(Union, &[ba, d]));
        f.join(Difference, &[x, y])
    });
    let shared = share(&used);
    // two constants, four leaves, one intersection, two unions and the root
    assert_eq!(
        (shared.node_count(), text(&shared).as_str()),
        (10, "all{any{2, all{0, 1}}, ~any{3, all{0, 1}}}")
    );
}

#[test]
fn wide_nodes_become_binary_trees() {
    let wide = |f: &mut Formula, [a, b, c, d, e]: [Edge; 5]| f.join(Union, &[a, b, c.complement(), d, e]);
    check(balance, wide, "any{0, 1, ~2, 3, 4}", "any{any{0, 1}, any{~2, any{3, 4}}}");
    let minus = |f: &mut Formula, [a, b, c, d, _]: [Edge; 5]| f.join(Difference, &[a, b, c, d]);
    check(balance, minus, "minus{0, 1, 2, 3}", "minus{0, any{1, any{2, 3}}}");
    let count = |f: &mut Formula, [a, b, c, ..]: [Edge; 5]| {
        let some = f.join(AtLeast(2), &[a, b, c]);
        let all = f.join(AtLeast(3), &[a, b, c]);
        f.join(SymmetricDifference, &[some, all, a])
    };
    check(
        balance,
        count,
        "odd{at_least_2{0, 1, 2}, at_least_3{0, 1, 2}, 0}",
        "odd{at_least_2{0, 1, 2}, odd{all{0, all{1, 2}}, 0}}",
    );
}

#[test]
fn heights_count_operators() {
    assert_eq!(height(&formula_of(|_, [a, ..]| a.complement())), 0);
    assert_eq!(height(&formula_of(|_, _| Edge::UNIVERSE)), 0);
    let chain = formula_of(|f, [a, b, c, d, e]| {
        [b, c, d, e].iter().fold(a, |chain, &leaf| f.join(Union, &[chain, leaf]).complement())
    });
    assert_eq!((height(&chain), height(&flatten(&chain)), height(&positive(&chain))), (4, 4, 4));
    assert_eq!(height(&prepare(&chain, &[Bounds::ALL; 5])), 4);
}

/// Unit intervals 0..1, 2..3, ... along x; intervals in contact share an end.
fn row() -> [Bounds; 5] {
    std::array::from_fn(|k| {
        let x = 2.0 * k as f64;
        Bounds::new(Vec3::new(x, 0.0, 0.0), Vec3::new(x + 1.0, 1.0, 1.0))
    })
}

#[track_caller]
fn check_pruned(make: impl Fn(&mut Formula, [Edge; 5]) -> Edge, after: &str) {
    let (pruned, _) = prune(&formula_of(make), &row());
    assert_eq!(text(&fold(&pruned)), after);
}

#[test]
fn what_bounds_show_not_to_matter_vanishes() {
    check_pruned(|f, [a, b, ..]| f.join(Intersection, &[a, b]), "empty");
    check_pruned(|f, [a, b, c, ..]| f.join(Difference, &[a, b, c]), "0");
    check_pruned(|f, [a, b, ..]| f.join(Union, &[a, b]), "any{0, 1}");
    // all of space except the first, which contains everything elsewhere
    check_pruned(|f, [a, b, ..]| f.join(Union, &[a.complement(), b]), "~0");
    check_pruned(|f, [a, b, ..]| f.join(Union, &[a.complement(), b.complement()]), "universe");
    // an odd number of complements: inside beyond both, where the third part is
    let parity = |f: &mut Formula, [a, b, c, ..]: [Edge; 5]| {
        let odd = f.join(SymmetricDifference, &[a.complement(), b]);
        f.join(Union, &[odd, c])
    };
    check_pruned(parity, "~odd{0, 1}");
    // only the fourth is near any part of the other operand, at any depth
    let deep = |f: &mut Formula, [a, b, c, d, e]: [Edge; 5]| {
        let pair = f.join(Union, &[b, d]);
        let less = f.join(Difference, &[pair, a]);
        let more = f.join(Union, &[less, c]);
        let near = f.join(Union, &[d, e]);
        f.join(Intersection, &[more, near])
    };
    check_pruned(deep, "3");
}
