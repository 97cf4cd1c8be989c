//! Worst cases: deep, wide and heavily shared formulas, on a small stack and in linear time.

use rayweave_math::{Bounds, Vec3};
use rayweave_model::simplify::{
    Formula, FormulaSize, Op, balance, flatten, fold, height, positive, prepare, prune, share,
};
use rayweave_model::{Edge, LeafId};

const LEVELS: usize = 100_000;

/// Limit that separates linear work (a fraction of a second) from quadratic work (hours).
fn on_a_small_stack(work: impl FnOnce() + Send) {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(256 << 10).spawn_scoped(scope, work).unwrap();
        assert!(thread.join().is_ok());
    });
}

fn chain(levels: usize, mut op: impl FnMut(usize) -> (Op, bool)) -> Formula {
    let mut formula = Formula::default();
    let mut chain = formula.leaf(LeafId(0));
    for level in 1..levels {
        let leaf = formula.leaf(LeafId::from(level));
        let (op, complemented) = op(level);
        chain = formula.join(op, &if level % 3 == 0 { [leaf, chain] } else { [chain, leaf] });
        chain = if complemented { chain.complement() } else { chain };
    }
    formula.add_output(chain);
    formula
}

fn run_all(formula: &Formula, leaves: usize) {
    for pass in [positive, flatten, fold, share, balance] {
        assert!(pass(formula).node_count() <= 2 * formula.node_count());
    }
    let far = |k: usize| Vec3::new(2.0 * k as f64, 0.0, 0.0);
    let boxes: Vec<Bounds> = (0..leaves).map(|k| Bounds::new(far(k), far(k) + Vec3::ONE)).collect();
    assert!(prune(formula, &boxes).0.node_count() <= formula.node_count());
    prepare(formula, &boxes);
    prepare(formula, &vec![Bounds::ALL; leaves]);
}

#[test]
fn chains_of_all_kinds() {
    on_a_small_stack(|| {
        for op in [Op::Union, Op::Intersection, Op::Difference, Op::SymmetricDifference, Op::AtLeast(2)] {
            run_all(&chain(LEVELS, |_| (op, false)), LEVELS);
        }
        let ops = [Op::Union, Op::Difference, Op::SymmetricDifference, Op::Intersection];
        let mixed = chain(LEVELS, |level| (ops[level % 4], level % 5 == 0));
        run_all(&mixed, LEVELS);
        assert_eq!(height(&mixed), LEVELS as u32 - 1);
        assert_eq!(mixed.text(mixed.outputs()[0]).matches('{').count(), LEVELS - 1);
    });
}

#[test]
fn a_long_chain_of_one_operator_becomes_a_low_tree() {
    let union = chain(LEVELS, |_| (Op::Union, false));
    let prepared = prepare(&union, &vec![Bounds::ALL; LEVELS]);
    let size = FormulaSize::of(&prepared);
    assert_eq!((size.leaves, size.operators, size.height), (LEVELS, 1, 1));
    assert_eq!(FormulaSize::of(&balance(&prepared)).height, 17);
}

#[test]
fn parts_that_are_shared_again_and_again() {
    // doubled at each level: as a tree it would have 2^4000 leaves
    let mut formula = Formula::default();
    let [mut part, a, b] = [0, 1, 2].map(|k| formula.leaf(LeafId(k)));
    for _ in 0..4000 {
        let (left, right) = (formula.join(Op::Union, &[part, a]), formula.join(Op::Difference, &[part, b]));
        part = formula.join(Op::SymmetricDifference, &[left, right]);
    }
    formula.add_output(part.complement());
    for pass in [positive, flatten, fold, share, balance] {
        assert!(pass(&formula).node_count() <= 2 * formula.node_count());
    }
    assert!(prepare(&formula, &[Bounds::ALL; 3]).node_count() <= formula.node_count());
}

#[test]
fn every_member_of_a_chain_is_used() {
    // quadratic if chains were merged into each of their users
    let mut formula = Formula::default();
    let leaves: Vec<Edge> = (0..20_000).map(|k| formula.leaf(LeafId::from(k))).collect();
    let mut chain = leaves[0];
    for &leaf in &leaves[1..] {
        chain = formula.join(Op::Union, &[chain, leaf]);
        formula.add_output(chain);
    }
    let flat = prepare(&formula, &vec![Bounds::ALL; leaves.len()]);
    let operands: usize = flat.nodes().map(|(_, _, operands)| operands.len()).sum();
    assert_eq!(operands, 2 * (leaves.len() - 1));
}
