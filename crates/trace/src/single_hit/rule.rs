//! The rule that combines the next changes of two operands into that of their node.
//!
//! Let s be the values of the operands just after t_min, t their next times, f the node's function.
//!
//! 1. If operands that never change again already determine f, the result is that constant.
//! 2. Take the earliest of the times, and change *every* operand whose time it is.
//! 3. If f has changed, that change is the result.
//! 4. Otherwise query all operands that have changed again, after that time, and start over.
//!
//! The rule is the same for union, intersection, difference, symmetric difference, k of n and priority of the
//! last region, for complements and unbounded operands, and for any number of coincident faces.
//!
//! After A. Kensler, "Ray tracing CSG objects using single hit intersections" (2006), whose tables of nine
//! entries are the special case without ties, except for one entry: see the module `seed_view`.

use super::ValueStep;

/// A function of two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GateOp {
    /// 1 if the sum of the values is at least `least`, else 0: union (1) and intersection (2) of two solids,
    /// k of n for two sums.
    AtLeast {
        /// The least sum.
        least: u32,
        /// The largest values that the two operands can take.
        most: [u32; 2],
    },
    /// 1 if the sum of the values is odd, else 0.
    Odd,
    /// The sum of the values.
    Sum,
    /// The second value, or the first where the second is 0: the last region that contains the ray.
    Last,
}

impl GateOp {
    /// The value for these values of the operands.
    pub fn of(self, a: u32, b: u32) -> u32 {
        match self {
            GateOp::AtLeast { least, .. } => u32::from(a + b >= least),
            GateOp::Odd => (a + b) & 1,
            GateOp::Sum => a + b,
            GateOp::Last => {
                if b == 0 {
                    a
                } else {
                    b
                }
            }
        }
    }

    /// The value if the operands that never change again determine it.
    fn fixed(self, a: Option<u32>, b: Option<u32>) -> Option<u32> {
        match (self, a, b) {
            (_, Some(a), Some(b)) => Some(self.of(a, b)),
            (GateOp::AtLeast { least, most }, Some(a), None) => decided(least, a, most[1]),
            (GateOp::AtLeast { least, most }, None, Some(b)) => decided(least, b, most[0]),
            (GateOp::Last, None, Some(b)) if b > 0 => Some(b),
            _ => None,
        }
    }
}

/// The value of `sum >= least` if it is certain: `known` of the sum is constant, and up to `open` more may
/// come and go.
fn decided(least: u32, known: u32, open: u32) -> Option<u32> {
    match () {
        () if known >= least => Some(1),
        () if known + open < least => Some(0),
        () => None,
    }
}

/// Result of the rule for two operands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Rule 1: constant from here on, as determined by operands that never change again.
    Fixed(u32),
    /// Rule 3: a change.
    Changes(ValueStep),
    /// Rule 4: the value does not change at `t`, so the operands that do are queried again, after it.
    QueryAgain {
        /// The time of the change of an operand that leaves the value unchanged.
        t: f64,
        /// True if the first operand must be queried again.
        first: bool,
        /// True if the second operand must be queried again.
        second: bool,
    },
}

/// Applies the rule to the next changes of two operands.
pub fn decide(op: GateOp, a: ValueStep, b: ValueStep) -> Verdict {
    if let Some(value) = op.fixed(a.resolved(), b.resolved()) {
        return Verdict::Fixed(value);
    }
    let t = a.t.min(b.t);
    let (first, second) = (a.t == t, b.t == t);
    let before = op.of(a.before, b.before);
    let at = |step: ValueStep, changes: bool| if changes { step.after } else { step.before };
    let after = op.of(at(a, first), at(b, second));
    if after == before {
        Verdict::QueryAgain { t, first, second }
    } else {
        Verdict::Changes(ValueStep { before, after, t })
    }
}
