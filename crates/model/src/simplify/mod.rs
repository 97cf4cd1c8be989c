//! The preparation of formulas: from the tree as it was written to the one that programs hold.
//!
//! Each pass is a free function in a file of its own with a one-line promise; each keeps the answer. [`prepare`] is how they
//! follow one another when a model is compiled. No pass uses the call stack for depth, and each takes time linear in the
//! size of the formula ([`fold`](fold()) and [`share`](share()) sort operands).

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

pub use balance::{Step, balance, balanced};
pub use bounds::{Beyond, bounds, leaf_needs, needs, output_bounds};
pub use flatten::flatten;
pub use fold::fold;
pub use formula::{Formula, Op, Term};
pub use height::height;
pub use positive::positive;
pub use prune::{Cut, Reason, prune, reason};
pub use report::{PassReport, Preparation, Removal, Size};
pub use share::share;

use rayweave_math::Bounds;
use std::borrow::Cow;

/// A step of the preparation, as [`prepare`] reports it.
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
    /// [`prune`](prune()) and what it leaves to the passes before it.
    Prune,
}

impl Pass {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Pass::Positive => "positive",
            Pass::Flatten => "flatten",
            Pass::Fold => "fold",
            Pass::Share => "share",
            Pass::Prune => "prune",
        }
    }

    /// What it makes sure of, while it keeps the answer.
    pub fn promise(self) -> &'static str {
        match self {
            Pass::Positive => "complements at leaves and symmetric differences only (De Morgan)",
            Pass::Flatten => "chains of one operator as one",
            Pass::Fold => "no constants, repeated or contradictory operands",
            Pass::Share => "equal parts once",
            Pass::Prune => "no parts that bounds show not to matter",
        }
    }
}

/// What looks on while a formula is prepared.
pub(crate) trait Watch {
    /// A pass made the second formula from the first one.
    fn pass(&mut self, _pass: Pass, _before: &Formula, _after: &Formula) {}
    /// These operands are to be cut from a formula.
    fn cuts(&mut self, _formula: &Formula, _leaves: &[Bounds], _cuts: &[Cut]) {}
    /// All is done; the boxes of the leaves, and the box of what is asked for.
    fn finish(&mut self, _written: &Formula, _kept: &Formula, _leaves: &[Bounds], _tight: Bounds) {}
}

/// Nobody looks on.
impl Watch for () {}

/// All passes in order: De Morgan, chains, constants, sharing, bounds; and what the last one leaves to the ones before.
///
/// `leaves` are the boxes that [`prune`](prune()) asks for.
pub fn prepare(formula: &Formula, leaves: &[Bounds]) -> Formula {
    prepare_watched(formula, leaves, &mut ())
}

pub(crate) fn prepare_watched(formula: &Formula, leaves: &[Bounds], watch: &mut impl Watch) -> Formula {
    let formula = tidy(formula, watch);
    let (pruned, cuts) = prune(&formula, leaves);
    if cuts.is_empty() {
        watch.pass(Pass::Prune, &formula, &formula);
        return formula;
    }
    watch.cuts(&formula, leaves, &cuts);
    let after = tidy(&fold(&pruned), &mut ());
    watch.pass(Pass::Prune, &formula, &after);
    after
}

type Run = fn(&Formula) -> Formula;

/// The passes that need no bounds.
const TIDYING: [(Pass, Run); 4] =
    [(Pass::Positive, positive), (Pass::Flatten, flatten), (Pass::Fold, fold), (Pass::Share, share)];

/// So often the passes that need no bounds are run at most: a bound on time. One round is enough unless one pass gives
/// another one before it something to do, and that a third one, and so on.
const ROUNDS: usize = 4;

/// The passes that need no bounds, until there is nothing left for them.
fn tidy(formula: &Formula, watch: &mut impl Watch) -> Formula {
    let mut formula = Cow::Borrowed(formula);
    for _ in 0..ROUNDS {
        for (pass, run) in TIDYING {
            let after = run(&formula);
            watch.pass(pass, &formula, &after);
            formula = Cow::Owned(after);
        }
        if positive::is_positive(&formula) && flatten::is_flat(&formula) {
            break;
        }
    }
    formula.into_owned()
}
