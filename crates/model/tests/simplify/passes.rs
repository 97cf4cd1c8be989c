//! Every pass against truth tables: all small formulas, and thousands of larger ones.

use crate::written::{Choices, Written};
use rayweave_math::Bounds;
use rayweave_model::simplify::{
    Formula, FormulaSize, Op, Term, balance, flatten, fold, height, positive, prepare, prune, share,
};
use rayweave_model::{Edge, LeafId};
use std::collections::HashSet;

type Run = fn(&Formula) -> Formula;

const PASSES: [(&str, Run, Run); 7] = [
    ("positive", positive, keeps_positive),
    ("flatten", flatten, keeps_flat),
    ("fold", fold, keeps_folded),
    ("share", share, keeps_shared),
    ("balance", balance, keeps_balanced),
    ("prune", without_boxes, same),
    ("prepare", prepared, keeps_folded),
];

/// Boxes without information about the leaves: only constants may be pruned.
fn without_boxes(formula: &Formula) -> Formula {
    prune(formula, &[Bounds::ALL; 16]).0
}

fn prepared(formula: &Formula) -> Formula {
    prepare(formula, &[Bounds::ALL; 16])
}

fn same(formula: &Formula) -> Formula {
    formula.clone()
}

/// All nodes that an output reaches, with their operands.
fn used_nodes(formula: &Formula) -> Vec<(Term, Vec<Edge>)> {
    let uses = formula.uses();
    let used_nodes = formula.nodes().filter(|(node, ..)| uses[node.index()] > 0);
    used_nodes.map(|(_, term, operands)| (term, operands.to_vec())).collect()
}

fn keeps_positive(formula: &Formula) -> Formula {
    let plain = |edge: &Edge| {
        !edge.is_complemented()
            || matches!(formula.term(edge.node()), Term::Leaf(_) | Term::Join(Op::SymmetricDifference))
    };
    for (term, operands) in used_nodes(formula) {
        assert_ne!(term, Term::Join(Op::Difference));
        assert!(operands.iter().all(plain));
    }
    assert!(formula.outputs().iter().all(plain));
    formula.clone()
}

fn keeps_flat(formula: &Formula) -> Formula {
    let uses = formula.uses();
    for (term, operands) in used_nodes(formula) {
        for edge in operands {
            let below = formula.term(edge.node());
            let single = uses[edge.node().index()] == 1 && !edge.is_complemented();
            let single = single && !formula.operands(edge.node()).is_empty();
            let chain = matches!(below, Term::Join(Op::Union | Op::Intersection | Op::SymmetricDifference));
            assert!(!(single && chain && below == term), "{}", formula.text(edge));
        }
    }
    formula.clone()
}

fn keeps_folded(formula: &Formula) -> Formula {
    for (term, operands) in used_nodes(formula) {
        let Term::Join(op) = term else { continue };
        assert!(operands.len() > 1);
        assert!(operands.iter().all(|&edge| edge != Edge::EMPTY && edge != Edge::UNIVERSE));
        let different: HashSet<Edge> = operands.iter().copied().collect();
        assert!(different.len() == operands.len() || matches!(op, Op::AtLeast(_)));
        assert!(operands.iter().all(|edge| !different.contains(&edge.complement())));
    }
    formula.clone()
}

fn keeps_shared(formula: &Formula) -> Formula {
    let all = used_nodes(formula);
    let different: HashSet<_> = all.iter().collect();
    assert_eq!(different.len(), all.len());
    keeps_folded(formula)
}

fn keeps_balanced(formula: &Formula) -> Formula {
    for (term, operands) in used_nodes(formula) {
        assert!(operands.len() <= 2 || matches!(term, Term::Join(Op::AtLeast(_))));
    }
    formula.clone()
}

fn texts(formula: &Formula) -> Vec<String> {
    formula.outputs().iter().map(|&edge| formula.text(edge)).collect()
}

/// Checks that a pass keeps the value, satisfies its contract and is idempotent.
fn check(written: &Written) {
    for (name, run, contract) in PASSES {
        let once = run(&written.formula);
        written.check(&once, name);
        contract(&once);
        let twice = run(&once);
        assert_eq!(texts(&twice), texts(&once), "{name} twice, of {:?}", texts(&written.formula));
        assert_eq!(FormulaSize::of(&twice), FormulaSize::of(&once), "{name} twice");
    }
}

/// Operands of the smallest formulas: constants and three leaves, one of them also complemented.
const ATOMS: [(usize, bool); 6] = [(0, false), (1, false), (2, false), (2, true), (3, false), (4, false)];

const OPS: [Op; 5] = [Op::Union, Op::Intersection, Op::Difference, Op::SymmetricDifference, Op::AtLeast(2)];

#[test]
fn all_formulas_of_two_operators() {
    for (&first, &second) in OPS.iter().flat_map(|a| OPS.iter().map(move |b| (a, b))) {
        for number in 0..6 * 6 * 6 * 4 {
            let (x, y, z) = (ATOMS[number % 6], ATOMS[number / 6 % 6], ATOMS[number / 36 % 6]);
            let mut written = Written::new(3);
            written.join(first, &[x, y]);
            let below = (written.count() - 1, number / 216 % 2 == 1);
            let operands = if number / 432 == 1 { [below, z] } else { [z, below] };
            written.join(second, &operands);
            written.add_output((written.count() - 1, number % 5 == 0));
            check(&written);
        }
    }
}

#[test]
fn thousands_of_random_formulas() {
    let mut choices = Choices::new(3);
    for _ in 0..4000 {
        let (leaves, joins) = (1 + choices.below(7) as u32, 1 + choices.below(9));
        check(&choices.formula(leaves, joins));
    }
    for _ in 0..60 {
        check(&choices.formula(12, 14));
    }
}

#[test]
#[ignore = "long"]
fn long_many_random_formulas() {
    let mut choices = Choices::new(4);
    for _ in 0..300_000 {
        let (leaves, joins) = (1 + choices.below(9) as u32, 1 + choices.below(14));
        check(&choices.formula(leaves, joins));
    }
}

/// The leaves in the order of the text of a formula.
fn leaf_order(formula: &Formula) -> Vec<String> {
    let texts = texts(formula).join(",").replace("at_least_", "l");
    let words = texts.split(|c: char| !c.is_ascii_alphanumeric());
    words.filter(|word| word.parse::<u32>().is_ok()).map(str::to_owned).collect()
}

#[test]
fn chains_and_balance_keep_the_order_of_leaves() {
    let mut choices = Choices::new(5);
    for _ in 0..2000 {
        let written = choices.formula(6, 9);
        assert_eq!(leaf_order(&flatten(&written.formula)), leaf_order(&written.formula));
        assert_eq!(leaf_order(&balance(&written.formula)), leaf_order(&written.formula));
    }
}

#[test]
fn balanced_trees_are_as_low_as_can_be() {
    for count in 1..=130usize {
        let mut formula = Formula::default();
        let leaves: Vec<Edge> = (0..count).map(|k| formula.leaf(LeafId::from(k))).collect();
        let all = formula.join(Op::Intersection, &leaves);
        formula.add_output(all);
        let least = (0..).find(|&h| 1 << h >= count).unwrap();
        assert_eq!(height(&balance(&formula)), least.max(1), "{count} leaves");
    }
}
