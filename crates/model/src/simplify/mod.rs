//! Simplification of boolean formulas, before they are stored in a program.
//!
//! Each pass is a free function in its own file. Every
//! pass keeps the value of the formula. [`prepare`] runs them in the order used for compilation. No pass is
//! recursive, and each takes time linear in the size of the formula ([`fold`](fold()) and [`share`](share())
//! sort operands).

mod balance;
mod bounds;
mod flatten;
mod fold;
mod formula;
mod height;
mod positive;
mod prune;
mod report;
mod share;

pub use balance::{BalanceStep, balance, balanced};
pub use bounds::{Beyond, bounds, leaf_needs, needs, output_bounds};
pub use flatten::flatten;
pub use fold::fold;
pub use formula::{Formula, Op, Term};
pub use height::height;
pub use positive::positive;
pub use prune::{PrunedPart, Reason, prune, reason};
pub use report::{FormulaSize, PassReport, Preparation, Removal};
pub use share::share;

use rayweave_math::Bounds;
use std::borrow::Cow;

/// A pass of the simplification, as [`Preparation`] reports it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// [`positive`](positive()).
    Positive,
    /// [`flatten`](flatten()).
    Flatten,
    /// [`fold`](fold()).
    Fold,
    /// [`share`](share()).
    Share,
    /// [`prune`](prune()), followed by the other passes on its result.
    Prune,
}

impl Pass {
    /// The name of the pass.
    pub fn name(self) -> &'static str {
        match self {
            Pass::Positive => "positive",
            Pass::Flatten => "flatten",
            Pass::Fold => "fold",
            Pass::Share => "share",
            Pass::Prune => "prune",
        }
    }

    /// The property that it establishes, while it keeps the value.
    pub fn contract(self) -> &'static str {
        match self {
            Pass::Positive => "only leaves and symmetric differences are complemented (negation normal form)",
            Pass::Flatten => "nested equal operators are merged",
            Pass::Fold => "no constants, and no repeated or contradictory operands",
            Pass::Share => "each distinct part is stored once",
            Pass::Prune => "no parts that bounding boxes prove irrelevant",
        }
    }
}

/// An observer of the simplification of a formula.
pub(crate) trait Observer {
    /// Called after a pass made the second formula from the first one.
    fn pass(&mut self, _pass: Pass, _before: &Formula, _after: &Formula) {}
    /// Receives the operands that are pruned from `formula`.
    fn cuts(&mut self, _formula: &Formula, _leaves: &[Bounds], _cuts: &[PrunedPart]) {}
    /// Called at the end, with the boxes of the leaves and the box of the outputs.
    fn finish(&mut self, _written: &Formula, _kept: &Formula, _leaves: &[Bounds], _tight: Bounds) {}
}

/// No observer.
impl Observer for () {}

/// Repeats `positive`, `flatten`, `fold` and `share` (after one `fold` if a part has several uses), then runs `prune`. If
/// that removes anything, it folds and repeats the four passes again.
///
/// `leaves` are the boxes that [`prune`](prune()) takes.
pub fn prepare(formula: &Formula, leaves: &[Bounds]) -> Formula {
    prepare_observed(formula, leaves, &mut ())
}

pub(crate) fn prepare_observed(
    formula: &Formula,
    leaves: &[Bounds],
    observer: &mut impl Observer,
) -> Formula {
    let formula = tidy(formula, observer);
    let (pruned, cuts) = prune(&formula, leaves);
    if cuts.is_empty() {
        observer.pass(Pass::Prune, &formula, &formula);
        return formula;
    }
    observer.cuts(&formula, leaves, &cuts);
    let after = tidy(&fold(&pruned), &mut ());
    observer.pass(Pass::Prune, &formula, &after);
    after
}

type Run = fn(&Formula) -> Formula;

/// The passes that need no bounds.
const TIDYING: [(Pass, Run); 4] =
    [(Pass::Positive, positive), (Pass::Flatten, flatten), (Pass::Fold, fold), (Pass::Share, share)];

/// Maximum number of rounds of the passes that need no bounds; limits the time. A second round is needed only if a pass
/// creates work for an earlier one, a third only if that happens again, and so on.
const ROUNDS: usize = 4;

/// Repeats the passes that need no bounds until the formula is in negation normal form and flat, at most [`ROUNDS`]
/// times.
fn tidy(formula: &Formula, observer: &mut impl Observer) -> Formula {
    let mut formula = Cow::Borrowed(formula);
    // De Morgan's laws split the complement of a part, which then no longer cancels the part: `s - s` for a union s
    let first = repeats_parts(&formula).then_some((Pass::Fold, fold as Run));
    for round in 0..ROUNDS {
        for (pass, run) in first.into_iter().filter(|_| round == 0).chain(TIDYING) {
            let after = run(&formula);
            observer.pass(pass, &formula, &after);
            formula = Cow::Owned(after);
        }
        if positive::is_positive(&formula) && flatten::is_flat(&formula) {
            break;
        }
    }
    formula.into_owned()
}

/// True if a node other than a leaf has several uses.
fn repeats_parts(formula: &Formula) -> bool {
    let uses = formula.uses();
    formula.nodes().any(|(node, term, _)| uses[node.index()] > 1 && matches!(term, Term::Join(_)))
}
